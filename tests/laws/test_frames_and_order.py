"""Results follow a stage that is mounted in a turned pose, and do not depend on the order in which its entries stand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.mount import mount
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import Mechanism
from flexstage.spatial.frame import axes, spatial_rotation

TURN = axes((2.0, -1.0, 2.0), (1.0, 2.0, 0.0))
"""The mounted stage's axes, columns, in the carrying one."""


def loaded(name: str) -> Mechanism:
    """A case with a payload beside its middle, a force, and a warm platform."""
    stage = fs.case(name)
    load = fs.Payload("platform", mass=0.2, at=(0.02, 0.01, 0.03), inertia=fs.Inertia(1e-4, 2e-4, 1.5e-4, 1e-5, 0.0, 2e-5))
    force = fs.Force("platform", at=(0.01, 0.02, 0.0), force=(1.0, -2.0, 0.5))
    return replace(stage, payloads={**stage.payloads, "more": load}, forces={"push": force}, requirements={}, paths={})


def turned(stage: Mechanism) -> Mechanism:
    """The stage mounted in a turned pose, the gravity that it is in turned with it."""
    pose = Pose((0.0, 0.0, 0.0), tuple(TURN[:, 0].tolist()), tuple(TURN[:, 2].tolist()))
    gravity = tuple((TURN @ np.array(stage.gravity)).tolist())
    return mount(
        Mechanism("top", gravity=gravity, damping=stage.damping, max_mode_frequency=stage.max_mode_frequency), "s", stage, pose=pose
    )


def close(found: Array, expected: Array, tolerance: float = 1e-7) -> None:
    """Twists, their translations and rotations each by the largest."""
    size = np.max(np.abs(expected.reshape(2, 3)), axis=1).repeat(3)
    assert np.all(np.abs(found - expected) <= tolerance * size + 1e-15)


@pytest.mark.parametrize("name", ["z-stage", "double-triangle", "tilt-stage"])
def test_results_turn_with_a_mounted_stage(name: str) -> None:
    stage = loaded(name)
    there, six = turned(stage), spatial_rotation(TURN)
    assert not [each for each in fs.check(there) if each.severity.value == "error"]
    one, other = fs.lumped(stage), fs.lumped(there)
    compliance = fs.statics(one).compliance.values
    size = np.sqrt(np.max(np.diag(compliance).reshape(2, 3), axis=1)).repeat(3)
    found = six.T @ fs.statics(other).compliance.values @ six
    assert np.max(np.abs(found - compliance) / np.outer(size, size)) < 1e-9
    np.testing.assert_allclose(fs.modes(other).frequencies, fs.modes(one).frequencies, rtol=1e-7)
    close(platform(fs.deflection(there, other).by_cause).sum(axis=1), six @ platform(fs.deflection(stage, one).by_cause).sum(axis=1))
    drifts = [fs.drift(each, model) for each, model in ((stage, one), (there, other))]
    close(platform(drifts[1].motion)[:, 0], six @ platform(drifts[0].motion)[:, 0])
    readings = [each.gauges.values[:, 0] for each in drifts]
    np.testing.assert_allclose(readings[1], readings[0], rtol=1e-7, atol=1e-15)
    states = [fs.equilibrium(fs.nonlinear(each, temperature=2.0)) for each in (stage, there)]
    close(states[1].twist(), six @ states[0].twist(), 1e-6)
    near = [fs.modes(fs.linearise(each)).frequencies[:6] for each in states]
    np.testing.assert_allclose(near[1], near[0], rtol=1e-6)


def platform(matrix: Matrix) -> Array:
    return np.stack([matrix.values[matrix.rows.index(f"platform.{axis}")] for axis in ("x", "y", "z", "rx", "ry", "rz")])


def reordered(stage: Mechanism) -> Mechanism:
    """The stage with the entries of all its tables in reverse order."""

    def back(table: Any) -> dict[str, Any]:
        return dict(reversed(list(table.items())))

    units = {name: replace(unit, bodies=back(unit.bodies), links=back(unit.links)) for name, unit in stage.units.items()}
    sections = ("materials", "parts", "bodies", "links", "placements", "sensors", "gauges", "payloads", "forces", "stops", "temperatures")
    return replace(stage, **{each: back(getattr(stage, each)) for each in sections}, units=back(units))


def entries(matrix: Matrix) -> Iterator[tuple[tuple[str, str], float]]:
    for row, values in zip(matrix.rows, matrix.values, strict=True):
        yield from (((row, column), float(value)) for column, value in zip(matrix.columns, values, strict=True))


def require_same(found: Matrix, expected: Matrix) -> None:
    """The same entries by name, against the largest one of each row."""
    one, other = dict(entries(found)), dict(entries(expected))
    assert set(one) == set(other)
    sizes = {
        row: np.max(np.abs(values[np.isfinite(values)]), initial=0.0) for row, values in zip(expected.rows, expected.values, strict=True)
    }
    for (row, column), value in other.items():
        assert one[row, column] == pytest.approx(value, rel=1e-7, abs=1e-7 * sizes[row] + 1e-13, nan_ok=True), (row, column)


@pytest.mark.parametrize("name", ["double-triangle", "voice-coil-xy", "tip-tilt-four", "bridge", "z-stage", "three-rrr"])
def test_results_by_name_do_not_depend_on_the_order_of_entries(name: str) -> None:
    stage = loaded(name)
    one, other = (fs.analyse(each) for each in (stage, reordered(stage)))
    assert one.modes is not None
    assert other.modes is not None
    np.testing.assert_allclose(other.modes.frequencies, one.modes.frequencies, rtol=1e-7)
    pairs: list[tuple[Matrix, Matrix]] = []
    for section, field in PARTS:
        results = [getattr(each, section, None) for each in (other, one)]
        assert (results[0] is None) == (results[1] is None)
        if results[1] is not None:
            pairs.append((getattr(results[0], field), getattr(results[1], field)))
    for found, expected in pairs:
        require_same(found, expected)
    assert len(pairs) > 2
    states = [fs.equilibrium(fs.nonlinear(each)).twist() for each in (stage, reordered(stage))]
    np.testing.assert_allclose(states[1], states[0], rtol=1e-7, atol=1e-13)


PARTS = (("statics", "compliance"), ("deflection", "by_cause"), ("drift", "motion"), ("drift", "gauges"), ("lost_motion", "gain"),
         ("lost_motion", "loss"), ("force_workspace", "per_motion"), ("force_workspace", "bounds"))  # fmt: skip
"""Results with names on both axes."""


def test_channels_stand_in_the_order_of_the_design_whatever_was_analysed_before() -> None:
    stage = fs.case("double-triangle")
    other = replace(stage, placements=dict(reversed(list(stage.placements.items()))))
    first, second = fs.ideal(stage).actuators, fs.ideal(other).actuators
    assert first != second
    assert set(first) == set(second)
    assert second[0] in {"B4", "B5", "B6"}


def test_links_of_units_may_have_names_of_several_words() -> None:
    stage = replace(fs.case("parallelogram"), requirements={}, paths={}, overrides={})
    unit = stage.units["drive"]
    other = replace(stage, units={"drive": replace(unit, links={f"left/{name}": link for name, link in unit.links.items()})})
    assert "B/left/back" in expand(other).links
    assert fs.modes(fs.lumped(other)).frequencies == pytest.approx(fs.modes(fs.lumped(stage)).frequencies, rel=1e-12)
