"""From a specification to stages: bounds that no mechanism exceeds, architectures without clashes, answers that keep their requirements."""

from __future__ import annotations

import re
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import flexstage as fs
from flexstage.analysis.assessment.judge import Estimate, bench_of, required_values
from flexstage.analysis.assessment.requirements import measure
from flexstage.base.finding import DesignError, Finding
from flexstage.base.storage.document import as_text
from flexstage.mechanism.addresses.address import set_value
from flexstage.mechanism.geometry.contact import contact_findings
from flexstage.models.flexible_bodies import body_flexibilities
from flexstage.studies.sweeps.execution.run import Run
from flexstage.studies.synthesis import answers, bounds
from flexstage.studies.synthesis.answers import design, joint_front
from flexstage.studies.synthesis.architecture import architectures, catalogue_actuators, draw, scope, variables
from flexstage.studies.synthesis.corrections import displaced_values, elastic_values, missed_limits
from flexstage.studies.synthesis.pairs import CandidatePair, shortfalls
from flexstage.studies.synthesis.search import Answer, FailedPair, relaxations, search
from flexstage.studies.synthesis.show.report import answer_report
from flexstage.studies.synthesis.show.tables import answer_tables
from flexstage.studies.synthesis.specification import EXAMPLE, ActuatorTable, Specification, loads_specification
from flexstage.studies.tolerances.file import loads_tolerance
from tests.conftest import FULL

SCANNER = """
format = "flexstage specification 1"
name = "scanner"
motion = { x = "50 um", y = "50 um" }
payload = { mass = "30 g", size = ["30 mm", "30 mm", "5 mm"] }
box = { size = ["260 mm", "260 mm", "40 mm"] }
actuators.like = "PSt 1000/10/150 VS18"
requirements.frequency = "at least 500 Hz"
"""
SHELL = """
[amplified.ours]
stroke = "300 um"
diagonal = ["2 N/um", "1.4 N/um", "3 N/um", "160 N m/rad", "96 N m/rad", "64 N m/rad"]
mass = "160 g"
"""
COIL = """
[coils.ours]
force_constant = "32 N/A"
continuous_current = "2.5 A"
resistance = "5 ohm"
mass = "180 g"
magnet_mass = "950 g"
travel = "26 mm"
"""
COIL_SPEC = """
format = "flexstage specification 1"
name = "far"
catalogue = "THERE"
motion.y = "0.5 mm"
payload = { mass = "0.3 kg", size = ["30 mm", "30 mm", "5 mm"] }
box = { size = ["300 mm", "300 mm", "100 mm"] }
requirements.unwanted = "at least 10 Hz"
"""
MOTIONS = {
    "guide": 'motion.z = "15 um"',
    "folded": 'motion.y = "0.5 mm"',
    "lever": 'motion.x = "60 um"',
    "bridge": 'motion.x = "60 um"',
    "guide-amplified": 'motion.y = "100 um"',
    "carriages-amplified": 'motion = { x = "60 um", y = "60 um" }',
    "pivot": 'motion.rz = "0.4 mrad"',
    "steering": 'motion = { rx = "5 mrad", ry = "5 mrad" }',
    "three-rrr": 'motion = { x = "20 um", y = "20 um", rz = "300 urad" }',
    "carriages": 'motion = { x = "20 um", y = "20 um" }',
    "nested": 'motion = { x = "15 um", y = "15 um" }',
    "travel": 'motion = { x = "2 mm", y = "2 mm" }',
    "tilt": 'motion = { rx = "1 mrad", ry = "1 mrad" }',
    "hexapod": "motion = " + '{ x = "30 um", y = "30 um", z = "60 um", rx = "300 urad", ry = "300 urad", rz = "100 urad" }',
    "double-triangle": "motion = " + '{ x = "30 um", y = "30 um", z = "60 um", rx = "300 urad", ry = "300 urad", rz = "100 urad" }',
}


SPARE = 1.0005
"""Factor by which corrected limits are stricter."""


def specification(name: str, folder: Path) -> Specification:
    """A specification for an architecture, in a large box."""
    (folder / "lab.toml").write_text(SHELL + COIL)
    text = (
        SCANNER.replace('motion = { x = "50 um", y = "50 um" }', MOTIONS[name]).replace("260 mm", "500 mm").replace('"40 mm"', '"400 mm"')
    )
    text = text.replace('actuators.like = "PSt 1000/10/150 VS18"', 'catalogue = "lab.toml"').replace("500 Hz", "10 Hz")
    return loads_specification(text, where=str(folder / "spec.toml"))


def used_share(rng: np.random.Generator) -> float:
    """K X^2 over the stroke energy of a random mechanism: any stroke ratios of any actuators, elastic guides, free internal coordinates.

    K is the stiffness against the whole displaced shape, which bounds that along any motion from above: the sharper test.
    """
    coordinates, actuators = int(rng.integers(1, 6)), int(rng.integers(1, 7))
    ratios = rng.normal(size=(actuators, coordinates)) * np.exp(rng.normal(size=(actuators, 1)))
    stiffness, strokes = np.exp(rng.normal(size=actuators)), np.exp(rng.normal(size=actuators))
    guides = rng.normal(size=(coordinates, coordinates))
    whole = ratios.T @ np.diag(stiffness) @ ratios + rng.choice([1e-6, 0.1, 1.0]) * (guides @ guides.T + 1e-3 * np.eye(coordinates))
    moved = np.linalg.solve(whole, ratios.T @ (stiffness * rng.choice([-1.0, 1.0], actuators) * strokes))
    return float(moved @ whole @ moved) / float(np.sum(stiffness * strokes**2))


def test_no_mechanism_exceeds_the_bound_of_stiffness_and_displacement() -> None:
    rng = np.random.default_rng(1)
    shares = [used_share(rng) for _ in range(20_000 if FULL else 1000)]
    assert max(shares) <= 1.0 + 1e-9
    assert max(shares) > 0.95


def test_negative_stiffness_raises_the_bound_and_breaks_the_simple_one() -> None:
    """A stack of stiffness k and stroke s with a spring of -n in parallel: K = k - n, X = k (s/2) / (k - n) reaches the bound exactly."""
    rng = np.random.default_rng(2)
    for _ in range(100):
        stiffness, stroke = np.exp(rng.normal(size=2))
        negative = rng.uniform(0.05, 0.95) * stiffness
        energy, displacement = bounds.stroke_energy(stroke, stiffness), stiffness * 0.5 * stroke / (stiffness - negative)
        assert bounds.stiffness_bound(energy, displacement, negative) == pytest.approx(stiffness - negative, rel=1e-9)
        assert (stiffness - negative) * displacement**2 > energy


def test_bounds_of_an_impossible_scanner() -> None:
    """+-0.5 mm, 1 kg, one amplified actuator of 1 mm and 0.35 N/um an axis: 94.2 Hz, or 94 um at 500 Hz; two of them: sqrt(2) times."""
    both = {"x": 0.5e-3, "y": 0.5e-3}, {"x": 1.0, "y": 1.0}
    energy = bounds.stroke_energy(1e-3, 0.35e6, 2)
    assert bounds.frequency_bound(energy, *both) == pytest.approx(94.2, rel=5e-3)
    assert 0.5e-3 * bounds.displacement_factor(energy, *both, 500.0) == pytest.approx(94e-6, rel=5e-3)
    assert bounds.frequency_bound(2.0 * energy, *both) == pytest.approx(2.0**0.5 * bounds.frequency_bound(energy, *both), rel=1e-12)
    coil = bounds.ForceSource(73.9, 0.18, 26e-3)
    assert bounds.force_frequency_bound(coil, 0.5e-3, 1.0) == pytest.approx(66.4, rel=2e-3)
    assert bounds.force_frequency_bound(replace(coil, travel=1e-3), 0.5e-3, 1.0) == pytest.approx(56.3, rel=2e-3)


def test_levers_with_mass_do_not_exceed_the_bound_of_forces() -> None:
    rng = np.random.default_rng(3)
    for _ in range(300):
        force, mass, payload, displacement = np.exp(rng.normal(size=4))
        count, lever = int(rng.integers(1, 4)), 0.1 * rng.random()
        ratio = np.exp(np.linspace(-3.0, 3.0, 1001)) * (payload / mass) ** 0.5
        stiffness = count * force * ratio / displacement  # the stiffest that the forces still displace so far
        bound = bounds.force_frequency_bound(bounds.ForceSource(force, mass, count=count), displacement, payload)
        for own in (0.0, lever):
            found = np.sqrt(stiffness / (payload + own + count * mass * ratio**2)) / (2.0 * np.pi)
            assert np.max(found) <= bound * (1.0 + 1e-12)
            assert own or np.max(found) == pytest.approx(bound, rel=1e-4)


@pytest.mark.parametrize("name", architectures())
def test_architectures_have_no_clash_for_any_values(name: str, tmp_path: Path) -> None:
    """Random values in the ranges: no clash, every end lies on a face, every body is connected, and no stage exceeds its bound."""
    spec = specification(name, tmp_path)
    architecture, rng = architectures()[name], np.random.default_rng(4)
    actuators = catalogue_actuators(spec)[architecture.kind]
    assert contact_findings(fs.loads(architecture.text)) == ()
    for number in range(200 if FULL else 2):
        actuator = actuators[number % len(actuators)]
        stage = fs.loads(draw(architecture, spec, actuator))
        for each in variables(architecture, scope(architecture, spec, actuator)):
            share = rng.random()
            value = each.low + share * (each.high - each.low) if each.low <= 0.0 else each.low * (each.high / each.low) ** share
            stage = set_value(stage, f"numbers.{each.name}", value)
        if any(float(stage.numbers[name].value) < 0.0 for name in ("rim", "gap", "lap") if name in stage.numbers):
            continue  # excluded by a limit of the architecture
        assert contact_findings(stage) == ()
        if "stoutness" not in stage.numbers or float(stage.numbers["stoutness"].value) > 0.25:
            assert body_flexibilities(stage).reasons == {}  # every body is connected, and none too thin for the estimate
        if actuator.kind != "voice_coil":
            with suppress_unstable():
                assert_below_bound(stage, spec, bounds.stroke_energy(actuator.stroke, actuator.stiffness, architecture.count))


@contextmanager
def suppress_unstable() -> Generator[None]:
    """Pass over stages that buckle under their weight: they have no frequency."""
    try:
        yield
    except DesignError as error:
        if "unstable" not in str(error):
            raise


def assert_below_bound(stage: fs.Mechanism, spec: Specification, energy: float) -> None:
    """The first frequency of a stage is at most the bound for each single-axis stroke that it reaches."""
    bench = bench_of(stage)
    values = {key: float(each.kind.value(bench, each)) for key in stage.requirements if (each := measure(stage, key, "here"))}
    for key, reached in values.items():
        if key.startswith("stroke."):  # the axes of a turned stage are its own: translations of the same payload
            axis = next(iter(spec.displacements)) if len(spec.displacements) == 1 else key.removeprefix("stroke.")
            assert values["frequency.1"] <= bounds.frequency_bound(energy, {axis: reached}, spec.masses) * (1.0 + 1e-9)


def test_a_rotation_reaches_its_bound_with_the_motion_that_has_least_energy() -> None:
    """One freedom: a rotation about x with the rotations about y and z that lower its kinetic energy most, and its energy stored."""
    rng = np.random.default_rng(5)
    spec = loads_specification(SCANNER.replace('{ x = "50 um", y = "50 um" }', '{ rx = "1 mrad" }'))
    for _ in range(100):
        points = rng.normal(size=(4, 3))
        block = np.einsum("pi,pi->", points, points) * np.eye(3) - points.T @ points
        names = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
        inertia = fs.Inertia(**{name: float(block[at]) for name, at in names.items()})
        own = replace(spec, payload=replace(spec.payload, inertia=inertia))
        motion = np.linalg.solve(block, np.eye(3)[0])
        motion /= motion[0]
        energy, angle = np.exp(rng.normal(size=2))
        frequency = np.sqrt(energy / angle**2 / (motion @ block @ motion)) / (2.0 * np.pi)
        assert bounds.frequency_bound(energy, {"rx": angle}, own.masses) == pytest.approx(frequency, rel=1e-9)


def test_an_answer_keeps_its_requirements_and_stays_below_its_bound() -> None:
    spec = loads_specification(SCANNER)
    found = fs.design(spec, ("carriages",))
    answer = found.best
    assert answer is not None
    analysed = fs.analyse(answer.stage)
    assert all(bool(verdict.passed) for verdict in analysed.verdicts)
    assert analysed.modes is not None
    assert answer.goal == pytest.approx(float(analysed.modes.frequencies[0]), rel=1e-6)
    assert answer.efficiency is not None
    assert 0.0 < answer.efficiency <= 1.0
    assert not [each for each in answer.warnings if "flexibility" not in each]


def test_an_unknown_flexibility_is_not_taken_as_rigid() -> None:
    """A lug that does not reach its disc: the values with elastic bodies are unknown, not those of rigid bodies."""
    text = architectures()["tilt"].text
    apart = fs.loads(text.replace('leaf_length = "14 mm"', 'leaf_length = "30 mm"'))
    assert elastic_values(fs.loads(text)).values["frequency.1"] < required_values(fs.loads(text))["frequency.1"]
    with pytest.raises(DesignError, match=r"bodies.platform: unknown flexibility: its outlines are not connected"):
        elastic_values(apart)


def test_elastic_bodies_keep_the_required_frequency() -> None:
    """The smallest guide just keeps the frequency with rigid bodies; with elastic ones a second search has to aim higher."""
    text = SCANNER.replace('{ x = "50 um", y = "50 um" }', '{ x = "20 um" }').replace('"PSt 1000/10/150 VS18"', '"PiezoDrive SA050536"')
    text = text.replace('name = "scanner"', 'name = "scanner"\nstarts = 1\ngoals.minimise = "envelope.z"')
    spec = loads_specification(text.replace("500 Hz", "1 kHz"))
    pair = CandidatePair(architectures()["guide"], catalogue_actuators(spec)["piezo"][0])
    answer = search(spec, pair)
    assert isinstance(answer, Answer)
    assert answer.rounds > 1
    assert answer.values["frequency.1"] > answer.elastic["frequency.1"] >= 1000.0


def test_the_price_of_a_requirement_is_what_its_relaxation_gives() -> None:
    """1 % less displacement along x and y: the frequency rises by the mean price of both answers, though their limits are corrected."""
    text = f'{SCANNER}make.step = "1 nm"'  # the prices are those before rounding
    before, after = (fs.design(loads_specification(each), ("carriages",)).best for each in (text, text.replace('"50 um"', '"49.5 um"')))
    assert before is not None
    assert after is not None
    assert before.rounds > 1
    first = [each.binding[0].name.replace("stroke.y", "stroke.x") for each in (before, after)]  # equal by symmetry
    assert first == ["stroke.x at least 50 um", "stroke.x at least 49.5 um"]
    price = 0.5 * (before.binding[0].price + after.binding[0].price)
    assert after.goal - before.goal == pytest.approx(-0.5e-6 * price, rel=1e-2)
    assert before.active == tuple(each.name for each in before.binding)


def with_density(bodies: Mapping[str, fs.Body], factor: float) -> dict[str, fs.Body]:
    """Bodies of a stage or unit, all but the platform of a denser material."""
    return {
        name: body
        if name == "platform" or body.of
        else replace(
            body, solids={key: replace(cast("Any", solid), material=f"{solid.material} {factor:g}") for key, solid in body.solids.items()}
        )
        for name, body in bodies.items()
    }


@pytest.mark.parametrize("name", architectures())
def test_heavier_bodies_and_payloads_do_not_raise_the_frequency(name: str, tmp_path: Path) -> None:
    """Carriages, levers and the like, up to 1000 times as heavy; then a payload 10 times as heavy."""
    spec = specification(name, tmp_path)
    architecture = architectures()[name]
    stage = fs.loads(draw(architecture, spec, catalogue_actuators(spec)[architecture.kind][0]))
    platform, before = measure(stage, "frequency.platform.1", "here"), np.inf
    stages = []
    for factor in (1.0, 10.0, 100.0, 1000.0) if FULL else (1.0, 1000.0):
        denser = {f"{key} {factor:g}": replace(each, density=factor * each.density) for key, each in stage.materials.items()}
        units = {key: replace(unit, bodies=with_density(unit.bodies, factor)) for key, unit in stage.units.items()}
        own = replace(stage, materials={**stage.materials, **denser}, bodies=with_density(stage.bodies, factor), units=units, formulas={})
        stages.append(own)
    for own in (*stages, set_value(stages[-1], "payloads.load.mass", 10.0 * spec.payload.mass)):
        found = float(platform.kind.value(bench_of(own), platform))
        assert found <= before * (1.0 + 1e-9)
        before = found


def test_the_page_lists_all_architectures() -> None:
    page = Path("docs/specification.md").read_text(encoding="utf-8").partition("## Architectures")[2].partition("## ")[0]
    rows = dict(re.findall(r"^\| `([\w-]+)` \| ([^|]+) \|", page, re.MULTILINE))
    sets = {name: {frozenset(each.split(", ")) for each in text.split("; ")} for name, text in rows.items()}
    turned = {frozenset({"one of x", "y", "z"})}
    assert sets == {name: turned if each.turns else set(each.serves) for name, each in architectures().items()}


@pytest.mark.parametrize("name", ["parallelogram", "xy-stage", "hexapod", "double-triangle", "voice-coil-xy"])
def test_the_first_unwanted_frequency_interlaces(name: str) -> None:
    """With n motions held, the lowest frequency is between the first and the n + 1st of the free stage."""
    stage = fs.case(name)
    bench = bench_of(stage)
    unwanted = measure(stage, "frequency.unwanted", "here")
    found, free = float(unwanted.kind.value(bench, unwanted)), bench.modes.frequencies
    assert free[0] * (1.0 - 1e-9) <= found <= free[len(bench.command)] * (1.0 + 1e-9)


def test_named_numbers_are_measures() -> None:
    stage = fs.case("parallelogram")
    number = measure(stage, "numbers.inset", "here")
    assert float(number.kind.value(bench_of(stage), number)) == pytest.approx(6.5e-3)
    assert number.quantity.shown == "mm"
    with pytest.raises(DesignError, match=r"numbers\.leaf_length"):
        measure(stage, "numbers.leaf_lenth", "here")


def test_a_relaxed_value_gives_an_answer() -> None:
    """The box is too short for the stack; with the length that the search names there is a stage."""
    text = SCANNER.replace('{ x = "50 um", y = "50 um" }', '{ x = "20 um" }').replace('"PSt 1000/10/150 VS18"', '"PiezoDrive SA050536"')
    text = text.replace('"260 mm", "260 mm"', '"60 mm", "200 mm"').replace('name = "scanner"', 'name = "scanner"\nstarts = 1')
    hard = loads_specification(text)
    found = fs.design(hard, ("guide",))
    assert found.best is None
    (relaxed,) = found.failed[0].relaxed
    assert relaxed.measure == "envelope.x"
    box = replace(hard.box, size=(1.001 * relaxed.value, *hard.box.size[1:]))
    pair = CandidatePair(architectures()["guide"], catalogue_actuators(hard)["piezo"][0])
    assert isinstance(search(replace(hard, box=box), pair), Answer)
    assert isinstance(search(replace(hard, box=replace(box, size=(0.99 * relaxed.value, *box.size[1:]))), pair), FailedPair)


def test_a_relaxed_frequency_holds_with_better_models() -> None:
    """Elastic bodies lower the frequency and the stroke: the value that the search names for the frequency is one with both corrected."""
    text = SCANNER.replace('{ x = "50 um", y = "50 um" }', '{ z = "8 um" }').replace('"PSt 1000/10/150 VS18"', '"PiezoDrive SA070718"')
    text = text.replace('"260 mm", "260 mm", "40 mm"', '"150 mm", "150 mm", "80 mm"').replace("500 Hz", "5 kHz")
    text = text.replace('"30 g", size = ["30 mm", "30 mm", "5 mm"]', '"0.1 kg", size = ["40 mm", "40 mm", "10 mm"]')
    hard = loads_specification(text)
    pair = CandidatePair(architectures()["guide"], catalogue_actuators(hard)["piezo"][0])
    (relaxed,) = relaxations(hard, pair, FailedPair("guide", pair.actuator.name, None, {"frequency.1": "at least 5 kHz"}, ""))
    for factor, found in ((0.999, Answer), (1.02, FailedPair)):
        assert isinstance(search(loads_specification(text.replace("5 kHz", f"{factor * relaxed.value:.9g} Hz")), pair), found)


def test_strict_limits_of_other_requirements_do_not_exclude_a_design_that_meets_all() -> None:
    """The ratio of elastic to rigid bodies is worst at the first optimum: the limit of the goal by this ratio would exclude the next."""
    text = SCANNER.replace('{ x = "50 um", y = "50 um" }', '{ x = "60 um" }').replace('"PSt 1000/10/150 VS18"', '"PiezoDrive SA070742"')
    text = text.replace('"260 mm", "260 mm", "40 mm"', '"200 mm", "200 mm", "60 mm"').replace("500 Hz", "1060 Hz")
    spec = loads_specification(text.replace('"30 g", size = ["30 mm", "30 mm", "5 mm"]', '"50 g", size = ["30 mm", "30 mm", "10 mm"]'))
    pair = CandidatePair(architectures()["lever"], next(each for each in catalogue_actuators(spec)["piezo"] if "070742" in each.name))
    answer = search(replace(spec, starts=1), pair)
    assert isinstance(answer, Answer)
    assert answer.rounds > 1
    assert answer.elastic["frequency.1"] > 1060.0


@pytest.mark.parametrize(("share", "excluded"), [(0.7, ()), (0.72, (False,)), (1.01, (True, False))])
def test_a_bound_of_an_architecture_is_not_one_of_all_mechanisms(share: float, excluded: tuple[bool, ...]) -> None:
    """Carriages have one actuator for each axis: half of the energy. Only what all actuators together cannot reach is impossible."""
    spec = loads_specification(SCANNER)
    (actuator,) = catalogue_actuators(spec)["piezo"]
    most = bounds.frequency_bound(bounds.stroke_energy(actuator.stroke, actuator.stiffness, 2), {"x": 50e-6}, {"x": 0.03})
    hard = replace(spec, requirements={"frequency": f"at least {share * most} Hz"})
    found = {each.universal for each in shortfalls(hard, CandidatePair(architectures()["carriages"], actuator)) if each.unit == "Hz"}
    assert found == set(excluded)


def test_heat_limits_the_force_of_a_coil(tmp_path: Path) -> None:
    (tmp_path / "lab.toml").write_text(COIL + 'thermal_resistance = "8 K/W"\ntemperature_rise = "40 K"\n')
    text = SCANNER.replace('actuators.like = "PSt 1000/10/150 VS18"', 'catalogue = "lab.toml"')
    (coil,) = catalogue_actuators(loads_specification(text, where=str(tmp_path / "spec.toml")))["voice_coil"]
    assert coil.force == pytest.approx(32.0 * (40.0 / 8.0 / 5.0) ** 0.5)


def test_the_force_in_the_reason_of_a_bound_is_that_of_each_coil(tmp_path: Path) -> None:
    """Of 32 N/A and 2.5 A each: the two coils of the travel stage have 160 N together."""
    (tmp_path / "lab.toml").write_text(COIL)
    text = (
        SCANNER.replace('actuators.like = "PSt 1000/10/150 VS18"', 'catalogue = "lab.toml"').replace("50 um", "2 mm").replace("500", "5000")
    )
    spec = loads_specification(text, where=str(tmp_path / "spec.toml"))
    pair = CandidatePair(architectures()["travel"], catalogue_actuators(spec)["voice_coil"][0])
    reasons = {each.reason for each in shortfalls(spec, pair) if each.requirement == "frequency"}
    assert reasons == {"the continuous force of 2 coils, 80 N each, is too small even with the best lever"}


def test_the_energy_of_an_amplified_actuator_is_that_of_its_blocked_deformation(tmp_path: Path) -> None:
    """It contracts and turns: (s/2)^2 u'ku, as for its whole free deformation held at the ends, half of the stroke either way."""
    (tmp_path / "lab.toml").write_text(SHELL + 'deformation = ["-300 um", 0, 0, 0, 0, "1 mrad"]\n')
    text = SCANNER.replace('actuators.like = "PSt 1000/10/150 VS18"', 'catalogue = "lab.toml"')
    (actuator,) = catalogue_actuators(loads_specification(text, where=str(tmp_path / "spec.toml")))["amplified"]
    energy = 0.25 * (2e6 * 300e-6**2 + 64.0 * 1e-3**2)
    assert bounds.stroke_energy(actuator.stroke, actuator.stiffness) == pytest.approx(energy, rel=1e-9)


def test_motions_of_one_axis_are_turned(tmp_path: Path) -> None:
    """A motion along y or z is that of the file's x; payload, box and gravity follow."""
    spec = replace(specification("guide", tmp_path), actuators=loads_specification(SCANNER).actuators)
    stage = fs.loads(draw(architectures()["guide"], spec, catalogue_actuators(spec)["piezo"][0]), checked=False)
    assert stage.gravity[0] == pytest.approx(-9.80665)
    assert stage.envelope is not None
    assert tuple(stage.envelope) == pytest.approx((0.4, 0.5, 0.5))
    assert set(stage.requirements) >= {"stroke.x", "frequency.1"}


BAD = {
    "motion = {": ("motions = {", "motion"),
    'x = "50 um", y = "50 um"': ("", "required displacement missing"),
    'x = "50 um"': ('x = "-50 um"', "motion.x"),
    'x = "50 um", ': ('x = "200 mm", ', "the displacement exceeds the box"),
    '"30 g"': ('"30 mm"', "must be a mass"),
    '"5 mm"]': ('"50 mm"]', "the payload is wider than the box along z"),
    "at least 500 Hz": ("at least 500 mm", "must be a frequency"),
    'requirements.frequency = "at least 500 Hz"': ("", "required frequency or stiffness missing"),
    '"PSt 1000/10/150 VS18"': ('"PSt 1000/10/155"', 'unknown actuator "PSt 1000/10/155"'),
    'requirements.frequency = "at least': (
        'requirements.safety = "at most 3"\nrequirements.frequency = "at least',
        "requirements.safety: ",
    ),
    'name = "scanner"': ('name = "scanner"\ncatalogue = "nowhere.toml"', "file not found"),
    "specification 1": ("study 1", "a study file, expected a specification file"),
    "requirements.": (
        'requirements.stifness.x = "at least 1 N/um"\nrequirements.',
        'requirements.stifness.x: unknown measure "stifness.x". Use',
    ),
    'requirements.frequency = "': (
        'requirements.stroke.x = "at least 1 um"\nrequirements.frequency = "',
        "strokes belong in the section motion",
    ),
    'actuators.like = "': ('goals.maximise = "width"\nactuators.like = "', 'goals.maximise: unknown measure "width"'),
    "requirements.f": (
        'requirements."loss.x" = "at most 1"\nrequirements.loss.x = "at most 1"\nrequirements.f',
        "loss.x: specified twice",
    ),
}


@pytest.mark.parametrize("old", BAD)
def test_bad_specifications(old: str) -> None:
    new, words = BAD[old]
    with pytest.raises(DesignError) as caught:
        design(loads_specification(SCANNER.replace(old, new, 1)))
    assert words in str(caught.value)


def test_one_run_names_unreadable_numbers_and_those_out_of_bounds() -> None:
    text = SCANNER.replace('"30 g"', '"30 mm"').replace('x = "50 um"', 'x = "-50 um"').replace('"40 mm"', '"0 mm"')
    text = text.replace("500 Hz", "500 mm")
    with pytest.raises(DesignError) as caught:
        loads_specification(text)
    assert [str(each).split(": ")[1] for each in caught.value.findings] == [
        "payload.mass",
        "motion.x",
        "box.size.z",
        "requirements.frequency",
    ]


def guide_specification(goal: str = 'goals.minimise = "envelope.z"') -> Specification:
    """A guide along x whose stack just keeps 1 kHz."""
    text = SCANNER.replace('{ x = "50 um", y = "50 um" }', '{ x = "20 um" }').replace('"PSt 1000/10/150 VS18"', '"PiezoDrive SA050536"')
    return loads_specification(text.replace('name = "scanner"', f'name = "scanner"\nstarts = 1\n{goal}').replace("500 Hz", "1 kHz"))


def test_finite_elements_raise_the_limits_of_the_next_search(tmp_path: Path) -> None:
    """A verification that is always a fifth lower: the lumped model has to reach 1250 Hz, and the stroke that it loses."""
    spec, tried = guide_specification(), []

    def verify(stage: fs.Mechanism) -> Estimate:
        tried.append(stage)
        lumped = required_values(stage)
        return Estimate({"frequency.1": 0.8 * lumped["frequency.1"], "stroke.x": 0.9 * lumped["stroke.x"]}, {"frequency.1": 0.01})

    answer = fs.design(spec, ("guide",), verify=verify, tolerance=FULL).best
    assert answer is not None
    assert answer.verified["frequency.1"] >= 1000.0 * (1.0 - 1e-9)
    assert answer.verified["stroke.x"] >= 20e-6 * (1.0 - 1e-9)
    assert answer.values["frequency.1"] >= 1250.0 * (1.0 - 1e-9)
    assert (answer.rounds, len(tried)) == (3, 2)  # the first two searches for elastic bodies
    assert answer.errors == {"frequency.1": 0.01}
    assert 'frequency.1" = "at least 1 kHz"' in answer.design
    assert not FULL or 0.5 < (answer.manufactured or 0.0) <= 1.0  # the lumped model, which has a margin of a quarter
    (tmp_path / "stage.toml").write_text(answer.design)
    assert "frequency.1" in {each.key for each in loads_tolerance(answer.scatter, folder=tmp_path).limits}


def test_an_answer_that_cannot_be_verified_says_why() -> None:
    def verify(stage: fs.Mechanism) -> Estimate:
        raise DesignError([Finding(stage.name, "no mesh", "Thicken it")])

    found = fs.design(guide_specification(), ("guide",), verify=verify)
    assert found.best is not None
    assert not found.best.verified
    assert any("is not verified: scanner" in note for note in next(iter(answer_tables(found))).notes)


def coil_stage(folder: Path) -> fs.Mechanism:
    """A stage with a required safety at its strokes."""
    spec = specification("folded", folder)
    return fs.loads(draw(architectures()["folded"], spec, catalogue_actuators(spec)["voice_coil"][0]), checked=False)


def test_corrected_limits_of_strokes_and_stresses(tmp_path: Path) -> None:
    """A stroke that is 20 % shorter is required 25 % longer: there the stress is 25 % higher, which the limit of its safety allows."""
    stage = coil_stage(tmp_path)
    drawn = {"stroke.x": 0.5e-3, "safety.at_strokes": 2.0, "frequency.1": 20.0}
    better = {"stroke.x": 0.8 * drawn["stroke.x"], "safety.at_strokes": 2.2, "frequency.1": 25.0}
    limits = missed_limits(stage, drawn, (better,))
    expected = {"stroke.x": SPARE * 625.0, "safety.at_strokes": SPARE * 1.6}
    assert {key: float(text.split()[2]) for key, text in limits.items()} == pytest.approx(expected)
    weaker = missed_limits(stage, drawn, ({**better, "safety.at_strokes": 1.0},))
    assert float(weaker["safety.at_strokes"].split()[2]) == pytest.approx(SPARE * 3.2)
    assert missed_limits(stage, drawn, ({"stroke.x": 0.5e-3}, {"stroke.x": 0.6e-3})) == {}


def test_a_requirement_without_a_value_is_not_met(tmp_path: Path) -> None:
    stage = replace(coil_stage(tmp_path), requirements={"loss": "at most 1 %"})
    assert missed_limits(stage, {"loss": 0.0}, ({"loss": 0.005},)) == {}
    with pytest.raises(DesignError, match="zero in the lumped model with rigid bodies"):
        missed_limits(stage, {"loss": 0.0}, ({"loss": 0.02},))


def test_large_displacements_reduce_the_stroke_as_the_force_that_holds_them_grows(tmp_path: Path) -> None:
    """Folded leaves, far out: linear force over the force that holds the stage there (an operating point), and its frequencies there."""
    spec = specification("folded", tmp_path)
    far = loads_specification(
        COIL_SPEC.replace("THERE", str(tmp_path / "lab.toml")).replace('"0.5 mm"', '"6 mm"'), where=str(tmp_path / "spec.toml")
    )
    (coil,) = catalogue_actuators(spec)["voice_coil"]
    stage = fs.loads(draw(architectures()["folded"], far, coil), checked=False)
    drawn, found = required_values(stage), displaced_values(stage).values
    held = fs.operating_point(stage, {"platform.x": 6e-3})
    assert held.held is not None
    ratio = drawn["stroke.x"] / found["stroke.x"]
    stiffness = 1.0 / float(fs.statics(fs.lumped(stage)).compliance.values[0, 0])
    assert ratio > 1.001
    assert ratio == pytest.approx(float(held.held.at("platform.x", "force")) / (stiffness * 6e-3), rel=2e-3)


def test_results_of_pairs_are_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Resumed without a search: the same bytes; as by two processes."""
    spec = replace(loads_specification(SCANNER), actuators=ActuatorTable(like=("PSt 1000/10/150 VS18", "PSt 1000/16/200 VS25")), starts=1)
    heard = list[Answer | FailedPair]()
    found = fs.design(spec, ("carriages",), keep=tmp_path, how=Run(workers=2), finished=heard.append)
    first = as_text(found)
    assert {id(each) for each in (*found.answers, *found.failed)} == {id(each) for each in heard}
    assert len(list(tmp_path.iterdir())) == 2
    monkeypatch.setattr(answers, "search", None)
    assert as_text(fs.design(spec, ("carriages",), keep=tmp_path, how=Run(workers=1, resume=True), finished=heard.append)) == first
    assert len(heard) == 4
    monkeypatch.undo()
    assert not FULL or as_text(fs.design(spec, ("carriages",))) == first


def test_an_interrupted_design_returns_its_answers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    spec = replace(loads_specification(SCANNER), actuators=ActuatorTable(like=("PSt 1000/10/150 VS18", "PSt 1000/16/200 VS25")), starts=1)
    real = answers.search

    def once(spec: Specification, pair: CandidatePair, said: object) -> Answer | FailedPair:
        if any(tmp_path.iterdir()):
            raise KeyboardInterrupt
        return real(spec, pair)

    monkeypatch.setattr(answers, "search", once)
    found = fs.design(spec, ("carriages",), keep=tmp_path)
    assert found.interrupted
    assert len(found.answers) + len(found.failed) == 1


def test_a_front_has_the_goal_at_its_first_end(tmp_path: Path) -> None:
    """Two goals: the answer maximises the first; along the front both fall, and no design of it breaks a requirement."""
    found = fs.design(guide_specification('goals = { maximise = "frequency", minimise = "envelope.z" }'), ("guide",))
    points = joint_front(found)
    assert found.best is not None
    assert points[0][1].goal == pytest.approx(found.best.goal, rel=2e-3)
    for key in ("goal", "second"):
        values = [getattr(point, key) for _, point in points]
        assert len(values) > 2
        assert values == sorted(values, reverse=True)
    assert "Front of both goals" in [each.title for each in answer_tables(found)]
    report = answer_report(found)
    assert "front of both goals" in report
    assert f"Binding limits of 1: {found.best.architecture} with {found.best.actuator}" in report


def test_rotations_need_an_inertia() -> None:
    text = SCANNER.replace('{ x = "50 um", y = "50 um" }', '{ rx = "1 mrad", ry = "1 mrad" }').replace(
        ', size = ["30 mm", "30 mm", "5 mm"]', ""
    )
    with pytest.raises(DesignError, match="no moment of inertia about an axis"):
        loads_specification(text)


def test_a_yield_below_all_and_the_first_frequency_are_printed() -> None:
    """One stage of 512 that fails is not 100 %; the frequency with elastic bodies is the first one, also if `unwanted` is listed before."""
    values = {"frequency.unwanted": 900.0, "frequency.1": 100.0, "envelope.x": 0.1, "envelope.y": 0.1, "envelope.z": 0.1}
    one = Answer("guide", "stack", 100.0, "Hz", values, (), None, 1, 1, 1, (), elastic=values, manufactured=511 / 512)
    spec = loads_specification(EXAMPLE)
    row = next(answer_tables(answers.Answers(spec, (one,), (), ()))).texts()[1]
    assert row[4:6] == ["100 Hz", "99.8 %"]
