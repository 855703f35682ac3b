"""Guides for motions that no architecture has: existence by a theorem, elements by their stiffness, drawings without clashes."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import bench_of
from flexstage.base.finding import DesignError
from flexstage.base.number import Array
from flexstage.mechanism.addresses.address import set_value
from flexstage.mechanism.geometry.contact import contact_findings
from flexstage.spatial.frame import COMPONENTS, spatial_rotation, transport
from flexstage.spatial.rotation import exponential
from flexstage.studies.synthesis.architecture import (
    architectures,
    catalogue_actuators,
    draw,
    scope,
    variables,
)
from flexstage.studies.synthesis.constraint_space import has_parallel_guide, pure_force_span, reciprocal_space, serial_guides, twists_of
from flexstage.studies.synthesis.ground_structure import find_guide, stiffness_ratio
from flexstage.studies.synthesis.specification import Specification, loads_specification
from flexstage.studies.synthesis.synthesised import find_architectures, nominal_block, symmetries
from tests.conftest import FULL

SETS = [frozenset(each) for count in range(1, 7) for each in combinations(COMPONENTS, count)]
KNOWN = {
    "x": True, "y": True, "rz": True, "z rx ry": True, "x y rz": True, "rx ry": True, "x rx": True, "rx ry rz": True,
    "x y": False, "x z": False, "x y z": False, "x y z rz": False,
}  # fmt: skip
SERVED = {each for one in architectures().values() for each in one.serves} | {frozenset(each) for each in "xyz"}
GUIDED = [each for each in SETS if has_parallel_guide(twists_of(each))]
NEW = [each for each in GUIDED if each not in SERVED]
SERIES = [each for each in SETS if each not in GUIDED and each not in SERVED]
SPEC = """
format = "flexstage specification 1"
name = "synthesis"
motion = { MOTION }
payload = { mass = "50 g", size = ["30 mm", "30 mm", "5 mm"] }
box.size = ["260 mm", "260 mm", "200 mm"]
requirements.frequency = "at least 150 Hz"
"""
COIL = """
[coils.small]
force_constant = "4 N/A"
continuous_current = "0.5 A"
resistance = "6 ohm"
mass = "10 g"
magnet_mass = "40 g"
travel = "2 mm"
"""


def named(motions: frozenset[str]) -> str:
    return " ".join(sorted(motions, key=COMPONENTS.index))


def specification(motions: frozenset[str], more: str = "", *, folder: Path | None = None) -> Specification:
    """A specification of 10 um and 300 urad; with coils if the catalogue is written to a folder."""
    moved = ", ".join(f'{axis} = "{"300 urad" if axis.startswith("r") else "10 um"}"' for axis in named(motions).split())
    text = SPEC.replace("MOTION", moved) + more
    if folder is None:
        return loads_specification(text)
    (folder / "lab.toml").write_text(COIL)
    text = text.replace('name = "synthesis"', 'name = "synthesis"\ncatalogue = "lab.toml"')
    return loads_specification(text, where=str(folder / "spec.toml"))


def sampled_rank(wrenches: list[Array]) -> int:
    """Rank of pure forces, a check of what they are included."""
    found = np.array([each for each in wrenches if np.linalg.norm(each[:3]) > 1e-6])
    if not len(found):
        return 0
    assert np.max(np.abs(np.einsum("ni,ni->n", found[:, :3], found[:, 3:]))) < 1e-9
    return int(np.linalg.matrix_rank(found, tol=1e-6))


@pytest.mark.parametrize("motions", SETS, ids=named)
def test_pure_forces_reciprocal_to_motions_along_axes(motions: frozenset[str]) -> None:
    """Brute force: many lines of random direction, some components zero, with random moments across them."""
    rng = np.random.default_rng(1)
    held = np.array([axis not in motions for axis in COMPONENTS], dtype=float)
    forces = []
    for _ in range(200):
        force = held[:3] * rng.normal(size=3) * rng.integers(0, 2, 3)
        moment = held[3:] * rng.normal(size=3)
        along = held[3:] * force
        if np.linalg.norm(along) > 1e-3:
            moment -= along * (force @ moment) / (along @ along)
        if abs(force @ moment) < 1e-12:
            forces.append(np.concatenate([force, moment]))
    span = pure_force_span(reciprocal_space(twists_of(motions)))
    assert sampled_rank(forces) == span.shape[1]
    assert (sampled_rank(forces) == np.count_nonzero(held)) == has_parallel_guide(twists_of(motions))
    assert KNOWN.get(named(motions), has_parallel_guide(twists_of(motions))) == has_parallel_guide(twists_of(motions))


def test_pure_forces_in_any_space_of_screws() -> None:
    """Screws along three axes with pitches of all signs and zero, moved rigidly: sum h a^2 = 0 is solved for the amounts a directly."""
    rng = np.random.default_rng(2)
    for number in range(200 if FULL else 40):
        count = int(rng.integers(1, 4))
        pitches = rng.integers(-1, 2, count) * rng.uniform(0.5, 2.0, count)
        moved = transport(rng.normal(size=3)).T @ spatial_rotation(exponential(rng.normal(size=3)))
        screws = moved @ np.concatenate([np.eye(3)[:, :count], np.eye(3)[:, :count] * pitches])
        forces = []
        for _ in range(60):
            amounts = rng.normal(size=count)
            up, down = pitches > 0.0, pitches < 0.0
            energy = [float(np.sum(np.abs(pitches[each]) * amounts[each] ** 2)) for each in (up, down)]
            amounts[down] *= np.sqrt(energy[0] / energy[1]) if energy[1] else 0.0
            amounts[up] *= 1.0 if energy[1] else 0.0
            forces.append(screws @ amounts)
        span = pure_force_span(screws @ rng.normal(size=(count, count)))
        assert sampled_rank(forces) == span.shape[1], number
        assert np.allclose(span @ span.T @ np.array(forces).T, np.array(forces).T, atol=1e-9)


def test_existence_does_not_depend_on_the_frame() -> None:
    rng = np.random.default_rng(3)
    for motions in SETS:
        moved = transport(rng.normal(size=3)) @ spatial_rotation(exponential(rng.normal(size=3)))
        assert has_parallel_guide(moved @ twists_of(motions)) == has_parallel_guide(twists_of(motions))


def test_guides_in_series_have_all_motions() -> None:
    for motions in SETS:
        for guides in serial_guides(motions):
            assert frozenset().union(*guides) == motions
            assert sum(map(len, guides)) == len(motions)
            assert all(each in GUIDED for each in guides)
            assert (len(guides) == 1) == (motions in GUIDED)


@pytest.mark.parametrize("motions", SETS[:-1] if FULL else SETS[:-1:7], ids=named)
def test_the_ground_structure_has_a_guide_if_and_only_if_one_exists(motions: frozenset[str]) -> None:
    """No search proves that there is none: the theorem and the search are independent."""
    spec = specification(motions)
    block = nominal_block(spec, catalogue_actuators(spec)["piezo"][0], (-1, 0, 1))
    guide = find_guide(block, motions, symmetries(spec), (-1, 0, 1))
    assert (guide is not None and guide.ratio > 20.0) == (motions in GUIDED)


@pytest.mark.parametrize("motions", NEW if FULL else NEW[::6], ids=named)
def test_the_drawn_guide_has_the_stiffness_of_its_elements(motions: frozenset[str], tmp_path: Path) -> None:
    """With coils, which have no stiffness: the ratio, the ideal motions, and the lowest modes are those required."""
    spec = specification(motions, 'actuators.kinds = ["voice_coil"]\n', folder=tmp_path)
    (architecture,), (coil,) = find_architectures(spec), catalogue_actuators(spec)["voice_coil"]
    stage = fs.loads(draw(architecture, spec, coil))
    model = fs.lumped(replace(stage, gravity=(0.0, 0.0, 0.0)))
    rows = (-1, 0, 1) if "gap_z" in stage.numbers else (0,)
    block = nominal_block(spec, coil, rows)
    guide = find_guide(block, motions, symmetries(spec), rows)
    assert guide is not None
    stiffness = np.linalg.inv(fs.statics(model).compliance.values)
    elements = np.sum([block.stiffness(each) for each in guide.elements], axis=0)
    assert np.allclose(stiffness, elements, rtol=1e-6, atol=1e-6 * np.max(stiffness))
    assert stiffness_ratio(stiffness, motions, block.scale) == pytest.approx(guide.ratio, rel=1e-6)
    assert guide.ratio > 20.0
    for symmetry in symmetries(spec):
        image = np.kron(np.diag([1.0, np.linalg.det(symmetry)]), symmetry)
        assert np.allclose(image @ stiffness @ image.T, stiffness, rtol=1e-6, atol=1e-6 * np.max(stiffness))
    assert set(bench_of(stage).kinematics.commanded) == motions
    shapes = fs.modes(model)
    assert shapes.frequencies[len(motions)] > 2.0 * shapes.frequencies[len(motions) - 1]


@pytest.mark.parametrize("motions", SERIES if FULL else SERIES[::6], ids=named)
def test_guides_in_series_permit_exactly_the_motions(motions: frozenset[str], tmp_path: Path) -> None:
    """The platform's whole stiffness, over all trays, with coils, which have no stiffness."""
    spec = specification(motions, 'actuators.kinds = ["voice_coil"]\n', folder=tmp_path)
    (architecture,), (coil,) = find_architectures(spec), catalogue_actuators(spec)["voice_coil"]
    stage = fs.loads(draw(architecture, spec, coil))
    model = fs.lumped(replace(stage, gravity=(0.0, 0.0, 0.0)))
    stiffness, scale = np.linalg.inv(fs.statics(model).compliance.values), nominal_block(spec, coil, (0,)).scale
    assert set(bench_of(stage).kinematics.commanded) == motions
    assert stiffness_ratio(stiffness, motions, scale) > 10.0
    shapes = fs.modes(model)
    assert shapes.frequencies[len(motions)] > 3.0 * shapes.frequencies[len(motions) - 1]
    assert "guides in series" in architecture.text


@pytest.mark.parametrize("motions", [*NEW[::6], *SERIES[::6]], ids=named)
def test_synthesised_guides_have_no_clash_for_any_values(motions: frozenset[str], tmp_path: Path) -> None:
    """Stacks of all sizes and coils, the smallest gaps with the smallest and largest elements, then random values in the ranges.

    No outlines overlap or touch, and every end lies on a face.
    """
    spec, rng = specification(motions, folder=tmp_path), np.random.default_rng(4)
    known = catalogue_actuators(spec)
    for architecture in find_architectures(spec):
        assert contact_findings(fs.loads(architecture.text)) == ()
        actuators = known[architecture.kind]
        for number in range(200 if FULL else 3):
            actuator = actuators[number % len(actuators)]
            stage = fs.loads(draw(architecture, spec, actuator), checked=False)
            for each in variables(architecture, scope(architecture, spec, actuator)):
                share = rng.random() if number > 1 else 0.0 if each.name.startswith(("gap", "skin")) else float(number)
                stage = set_value(stage, f"numbers.{each.name}", each.low * (each.high / each.low) ** share)
            assert contact_findings(stage) == ()


@pytest.mark.parametrize("motions", ["x rx", "x z", "rx", "y rz", "z rx", "rx ry rz", "x y z"] if FULL else ["x rx", "x z"])
def test_an_answer_of_a_synthesised_guide_keeps_its_requirements(motions: str) -> None:
    axes = frozenset(motions.split())
    found = fs.design(specification(axes, 'starts = 1\nactuators.like = "PiezoDrive SA050536"\n'))
    answer = found.best
    assert answer is not None
    assert (answer.architecture, found.failed, found.impossible) == ("synthesised-stacks", (), ())
    assert all(bool(verdict.passed) for verdict in fs.analyse(answer.stage).verdicts)
    assert not [each for each in answer.warnings if "flexibility" not in each]
    assert answer.elastic["frequency.1"] >= 150.0
    assert answer.values["frequency.1"] == pytest.approx(float(fs.modes(fs.lumped(answer.stage)).frequencies[0]), rel=1e-3)
    assert set(bench_of(answer.stage).kinematics.commanded) == axes


REFUSED = {
    "unknown": ("x rx", "", ("guides",), 'unknown architecture "guides"'),
    "other": ("x rx", "", ("guide",), "no architecture of those specified has exactly the motions x, rx. Use another --architecture."),
    "opening": ("x rx", 'box.opening = ["9 mm", "9 mm"]\n', (), "box.opening: the guide for the motions x, rx has no opening"),
    "kinds": ("x rx", 'actuators.kinds = ["amplified"]\n', (), 'Allow actuators of kind "piezo" or "voice_coil", or'),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_specifications(name: str) -> None:
    motions, more, architecture, words = REFUSED[name]
    with pytest.raises(DesignError) as caught:
        fs.design(specification(frozenset(motions.split()), more), architecture)
    assert words in str(caught.value)
