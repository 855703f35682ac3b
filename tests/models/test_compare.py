"""Theory against experiment: records of a known stage give its differences back, whatever their channels' order, units and signs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.modes import modal_assurance
from flexstage.analysis.dynamics.pairing import gyration
from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.analysis.workspace.stroke import stacks
from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.experiment.channels import Residues, gain_doubts
from flexstage.experiment.comparison import Compared, ComparedMode, Measured, compare
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.pipeline import identification, usable_measurement
from flexstage.experiment.records.record import Channel, InMemory, Record, Role, in_memory
from flexstage.experiment.shapes_on_stage import stage_shapes
from flexstage.experiment.virtual_rig.plan import volts_per_metre
from flexstage.experiment.virtual_rig.rig import rig
from flexstage.experiment.virtual_rig.setup import NoiseDrive, RigSetup
from flexstage.mechanism.addresses.address import assign, set_value
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.parts.body import Body, Inertia
from flexstage.parts.spring import Spring
from tests.models.made_tests import Noise, made
from tests.models.stage_records import stage_record

STAGE = double_triangle()
BUILT = assign(STAGE, "horizontal/front.thickness=1.8mm")
"""The stage as it was made: not as it was drawn."""


def identified(record: Record) -> Identified:
    return identification(usable_measurement([record])).found


@pytest.fixture(scope="module")
def record() -> Record:
    return stage_record(BUILT)


@pytest.fixture(scope="module")
def experiment(record: Record) -> Identified:
    return identified(record)


@pytest.fixture(scope="module")
def compared(experiment: Identified) -> Compared:
    return compare(STAGE, experiment)


def frequency(row: ComparedMode) -> float:
    assert row.experiment is not None
    return row.experiment.frequency


def expected() -> np.ndarray:
    drawn, built = (platform_modes(each, lumped(each)).platform_frequencies for each in (STAGE, BUILT))
    return drawn / built - 1.0


def test_the_stage_differs_as_it_was_made_to(compared: Compared) -> None:
    assert max(abs(expected())) > 0.005
    for row, known in zip(compared.modes, expected(), strict=True):
        assert row.difference == pytest.approx(known, abs=3.0 * (row.uncertainty or 0.0) + 1e-12)
        assert 0.0 < (row.uncertainty or 0.0) < 1e-3
        assert (row.assurance or 0.0) > 0.99
        assert row.experiment is not None
        assert compared.experiment.modes[row.experiment.index].number == row.experiment.number


def test_a_difference_stands_beside_half_of_the_interval_it_is_known_to() -> None:
    row = ComparedMode(1, "z", 103.0, fea=99.0, experiment=Measured(0, 100.0, (98.0, 103.0), 0.01, (0.009, 0.011), 1.0))
    assert (row.difference, row.fea_difference, row.uncertainty) == pytest.approx((0.03, -0.01, 0.025), rel=1e-12)


def test_repeated_modes_are_one_plane(compared: Compared) -> None:
    assert [group.numbers for group in compared.repeated] == [(1, 2), (5, 6)]
    for group in compared.repeated:
        assert group.seen == 2
        assert (group.angle or 0.0) < np.deg2rad(3.0)
    assert compared.further == ()
    assert compared.data_warnings == ()


def test_shapes_turned_by_an_angle_have_its_squared_cosine(experiment: Identified) -> None:
    """z turned by 20 degrees towards another motion: MAC cos^2; one tilt turned by 10 degrees out of their plane: that is the angle."""
    model = lumped(STAGE)
    theory = platform_modes(STAGE, model)
    rows = list(model.output_index(tuple(each.name for each in experiment.outputs)))
    sensed = model.output[rows] @ theory.shapes[:, list(theory.platform)]
    shapes = sensed / np.linalg.norm(sensed, axis=0)
    plane = np.linalg.qr(shapes[:, :2])[0]
    z, tilt = np.deg2rad(20.0), np.deg2rad(10.0)
    beside, above = (_across(shapes[:, 3], shapes[:, 2:3]), _across(shapes[:, 2], plane))
    made = shapes.copy()
    made[:, 2] = np.cos(z) * shapes[:, 2] + np.sin(z) * beside
    made[:, 0], made[:, 1] = plane[:, 0], np.cos(tilt) * plane[:, 1] + np.sin(tilt) * above
    found = compare(STAGE, replace(experiment, shapes=made.astype(complex), frequencies=theory.platform_frequencies))
    assert found.modes[2].assurance == pytest.approx(np.cos(z) ** 2, abs=1e-9)
    assert sorted(row.assurance or 0.0 for row in found.modes[:2]) == pytest.approx([np.cos(tilt) ** 2, 1.0], abs=1e-9)
    assert found.repeated[0].angle == pytest.approx(tilt, abs=1e-6)


def _across(shape: np.ndarray, basis: np.ndarray) -> np.ndarray:
    """The part of a shape across a basis, of unit length."""
    rest = shape - basis @ (basis.T @ shape)
    return rest / np.linalg.norm(rest)


def test_channels_are_told_by_name(record: Record, compared: Compared) -> None:
    turned = record.select(record.names[::-1])
    again = compare(STAGE, identified(turned))
    for row, known in zip(again.modes, compared.modes, strict=True):
        assert frequency(row) == pytest.approx(frequency(known), rel=1e-5)
        assert row.assurance == pytest.approx(known.assurance, abs=1e-3)


def test_units_do_not_matter(record: Record, compared: Compared) -> None:
    values = record.values.copy()
    values[:, record.names.index("S2")] *= 1e-3
    channels = tuple(replace(each, unit="mm") if each.name == "S2" else each for each in record.channels)
    again = compare(STAGE, identified(replace(record, channels=channels, samples=InMemory(values))))
    assert [row.assurance for row in again.modes] == pytest.approx([row.assurance for row in compared.modes], abs=1e-3)


def test_a_gauge_the_wrong_way_round_shows(record: Record) -> None:
    values = record.values.copy()
    values[:, record.names.index("S4")] *= -1.0
    again = compare(STAGE, identified(replace(record, samples=InMemory(values))))
    assert min(row.assurance or 0.0 for row in again.modes) < 0.9
    assert any("MAC" in text or "not found" in text for text in again.data_warnings)


def test_fea_stands_beside_them(experiment: Identified, compared: Compared) -> None:
    softer = assign(STAGE, "vertical/pivot.thickness=0.9mm")
    model = lumped(softer)
    errors = (0.001,) * 6
    found = compare(STAGE, experiment, FeaModes(platform_modes(softer, model), model, 3, errors))
    known = platform_modes(softer, model).platform_frequencies
    assert sorted(row.fea or 0.0 for row in found.modes) == pytest.approx(sorted(known.tolist()))
    assert [row.experiment for row in found.modes] == [row.experiment for row in compared.modes]
    assert all((row.fea_assurance or 0.0) > 0.9 and row.fea_error == 0.001 for row in found.modes)


def test_one_actuator_shows_one_of_a_pair() -> None:
    # The two tilts of this stage are driven by the vertical units alike: one alone drives one combination.
    found = compare(STAGE, identified(stage_record(BUILT, active=(3,))))
    assert any("only B4 was driven" in text for text in found.data_warnings)
    assert any("repeated" in text or "not found" in text for text in found.data_warnings)


def test_a_record_of_one_actuator_takes_no_local_mode_for_a_platform_mode() -> None:
    """The rig shakes all modes of the stage: what B1 alone does not move stays without a partner, local modes go to local ones."""
    setup = RigSetup(seconds=10.0, drive=NoiseDrive(actuators=("B1",)))
    found = compare(STAGE, identified(rig(STAGE, lumped(STAGE), setup)))
    for row in found.modes:
        assert row.experiment is None or abs(row.difference or 0.0) < 1e-3
    assert [row.number for row in found.modes if row.experiment is None] == [2, 6]
    assert found.further
    for mode in found.further:
        assert mode.theory is None or mode.theory == pytest.approx(mode.experiment.frequency, rel=0.01)


def test_too_few_gauges_are_told(record: Record) -> None:
    few = identified(record.select(["B1", "B2", "B3", "B4", "B5", "B6", "S4", "S5", "S6"]))
    found = compare(STAGE, few)
    assert any("3 sensors" in text for text in found.data_warnings)
    assert "3 of the 6 motions" in stage_shapes(ideal(STAGE), few).missing


def test_names_that_are_none_of_the_stage(record: Record) -> None:
    renamed = replace(record, channels=tuple(Channel(f"probe {each.name}", each.unit, each.role) for each in record.channels))
    with pytest.raises(
        DesignError, match=r"probe S1: unknown output; record and stage have no output in common\. Use S1, S2, S3, S4, S5 or S6"
    ):
        compare(STAGE, identified(renamed))


@pytest.mark.parametrize(("ratio", "is_pair"), [(1.59, True), (1.61, False), (1.0 / 1.59, True), (1.0 / 1.61, False)])
def test_modes_more_than_1_6_times_apart_are_no_pair(ratio: float, *, is_pair: bool) -> None:
    exact = made(STAGE, noise=Noise(frequency=0.0, model=0.0))
    moved = exact.frequencies * np.where(np.arange(6) == 2, ratio, 1.0)
    found = compare(STAGE, replace(exact, frequencies=moved))
    assert [row.experiment is not None for row in found.modes] == [True, True, is_pair, True, True, True]
    assert is_pair == (not found.further)


@pytest.mark.parametrize(("assurance", "is_pair"), [(0.51, True), (0.49, False)])
def test_modes_that_share_less_than_half_of_their_shape_are_no_pair(assurance: float, *, is_pair: bool) -> None:
    """z, turned towards what no other mode does: two of the gauges' motions are left out of the test."""
    exact = made(STAGE, noise=Noise(frequency=0.0, model=0.0))
    kept = [0, 1, 2, 3]
    shapes = np.real(exact.shapes[:, kept] / np.linalg.norm(exact.shapes[:, kept], axis=0))
    beside = np.linalg.qr(np.hstack([np.real(exact.shapes[:, kept]), np.real(exact.shapes[:, 4:5])]))[0][:, 4]
    shapes[:, 2] = np.sqrt(assurance) * shapes[:, 2] + np.sqrt(1.0 - assurance) * beside
    fewer = {name: getattr(exact, name)[kept] for name in ("frequencies", "damping", "participation", "frequency_deviations")}
    fewer |= {name: getattr(exact, name)[kept] for name in ("damping_deviations", "widening", "significance")}
    few = replace(exact, **fewer, shapes=shapes.astype(complex), shape_deviations=exact.shape_deviations[:, kept])
    found = compare(STAGE, few)
    assert (found.modes[2].experiment is not None) == is_pair
    if is_pair:
        assert found.modes[2].assurance == pytest.approx(assurance, abs=1e-9)


def test_what_sensors_cannot_tell_apart_goes_to_the_nearer_mode() -> None:
    """One upright gauge sees z and both tilts alike: a measured mode at the frequency of z is that one."""
    exact = made(STAGE, noise=Noise(frequency=0.0, model=0.0))
    row = [channel.name for channel in exact.outputs].index("S4")
    names = ("frequencies", "damping", "participation", "frequency_deviations", "damping_deviations", "widening", "significance")
    one = {name: getattr(exact, name)[2:3] for name in names}
    few = replace(
        exact,
        **one,
        shapes=np.ones((1, 1), complex),
        shape_deviations=np.full((1, 1), 1e-3),
        outputs=exact.outputs[row : row + 1],
        noise=np.ones(1),
    )
    assert [each.number for each in compare(STAGE, few).modes if each.experiment is not None] == [3]


def test_noise_alone_is_compared_with_nothing() -> None:
    silent = stage_record(STAGE)
    noise = np.random.default_rng(5).standard_normal(silent.values.shape)
    found = compare(STAGE, identified(in_memory(silent.channels, silent.rate, noise)))
    assert all(row.experiment is None for row in found.modes)
    assert any("no mode exceeds the noise" in text for text in found.data_warnings)
    assert any("not found in the experiment: 1 (tilt" in text for text in found.data_warnings)


def test_shapes_move_the_platform_as_the_model_does(experiment: Identified) -> None:
    """Through R_s^-1 the measured shapes are the platform's own, modes that are not repeated one by one."""
    found = stage_shapes(ideal(STAGE), experiment)
    model = lumped(BUILT)
    known = platform_modes(BUILT, model).platform_shapes
    mass = model.inertia["platform"].law
    alike = modal_assurance(found.motions["platform"], known, mass).values
    assert alike[2, 2] > 0.99
    assert alike[3, 3] > 0.99
    assert np.allclose(alike[:2, :2].sum(axis=1), 1.0, atol=0.02)
    assert found.explained == pytest.approx(np.ones(6), abs=1e-9)


def test_bodies_move_with_the_platform(experiment: Identified) -> None:
    found = stage_shapes(ideal(STAGE), experiment)
    kinematics = ideal(STAGE)
    names = [f"B4/pole.{axis}" for axis in ("x", "y", "z", "rx", "ry", "rz")]
    rows = kinematics.bodies[[kinematics.body_coordinates.index(name) for name in names]]
    platform = np.linalg.lstsq(kinematics.motion, found.motions["platform"], rcond=None)[0]
    assert found.motions["B4/pole"] == pytest.approx(rows @ platform, abs=1e-12)


def test_angles_are_compared_by_the_platforms_radius_of_gyration() -> None:
    """Of a platform so heavy that what it carries of its hinges is nothing."""
    body = Body(mass=9e9, centre=(0.0, 0.0, 0.0), inertia=Inertia(1e8, 2e8, 3e8))
    stage = replace(double_triangle(), bodies={**double_triangle().bodies, "platform": body})
    assert gyration(lumped(stage)) == pytest.approx(np.sqrt(0.2 / 9.0), rel=1e-8)


def test_a_rigid_body_with_equal_inertias_has_modes_apart_at_its_sensors() -> None:
    """Modes of a body with inertia m r^2 about all axes are orthogonal at its sensors: two modes mixed by an angle have the MAC cos^2."""
    turn, pair = np.deg2rad(20.0), [1, 2]
    body = Body(mass=1.0, centre=(0.01, 0.005, -0.008), inertia=Inertia(4e-4, 4e-4, 4e-4))
    hung = Mechanism(
        "body on a spring beside its centre",
        parts={"spring": Spring(diagonal=(1e8, 2e8, 3e8, 5e4, 7e4, 9e4))},
        bodies={"platform": body},
        links={"spring": Link(("ground", "platform"), "spring", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))},
    )
    theory = platform_modes(hung, lumped(hung))
    shapes = theory.platform_shapes
    motions = ("x", "y", "z", "rx", "ry", "rz")
    outputs = tuple(Channel(f"platform.{name}", "rad" if "r" in name else "m", Role.OUTPUT) for name in motions)
    mixed = shapes.copy()
    mixed[:, pair] = shapes[:, pair] @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    exact = made(STAGE, noise=Noise(frequency=0.0, model=0.0))
    found = compare(hung, replace(exact, shapes=mixed.astype(complex), frequencies=theory.platform_frequencies, outputs=outputs))
    wanted = [np.cos(turn) ** 2 if mode in pair else 1.0 for mode in range(6)]
    assert [row.assurance for row in found.modes] == pytest.approx(wanted, abs=1e-6)


# --- channels that are not what they are called ---

SOUND = made(STAGE)


def renamed(channels: tuple[Channel, ...], **names: str) -> tuple[Channel, ...]:
    return tuple(replace(channel, name=names.get(channel.name, channel.name)) for channel in channels)


def times(values: np.ndarray, index: int, factor: float) -> np.ndarray:
    changed = values.copy()
    changed[index] *= factor
    return changed


MISNAMED = {
    "B4 and B1 look exchanged": replace(SOUND, inputs=renamed(SOUND.inputs, B1="B4", B4="B1")),
    "B4, B1 and B2 look exchanged": replace(SOUND, inputs=renamed(SOUND.inputs, B1="B4", B4="B2", B2="B1")),
    "S4 and S1 look exchanged": replace(SOUND, outputs=renamed(SOUND.outputs, S1="S4", S4="S1")),
    "B3 looks inverted": replace(SOUND, participation=times(SOUND.participation.T, 2, -1.0).T),
    "S4 looks inverted": replace(SOUND, shapes=times(SOUND.shapes, 3, -1.0)),
    "B3 looks scaled: its modal gains are 2 times": replace(SOUND, participation=times(SOUND.participation.T, 2, 2.0).T),
    "S4 (0.1": replace(SOUND, shapes=times(SOUND.shapes, 3, 0.1)),
    "looks scaled relative to the other": replace(SOUND, shapes=times(SOUND.shapes, 0, 1e3)),
    "look scaled relative to the other": replace(SOUND, shapes=times(times(times(SOUND.shapes, 3, 1e3), 4, 1e3), 5, 1e3)),
    "S1 and S2 look inverted": replace(SOUND, shapes=times(times(SOUND.shapes, 0, -1.0), 1, -1.0)),
    "S1 looks inverted": replace(SOUND, shapes=times(SOUND.shapes, 0, -1.0), participation=times(SOUND.participation.T, 0, -1.0).T),
    "B6 looks scaled: its modal gains are 0.001 times": replace(
        SOUND, participation=np.concatenate([SOUND.participation[:, :3], 1e-3 * SOUND.participation[:, 3:]], axis=1)
    ),
    "all modal gains are 1e+03 times as large": replace(SOUND, shapes=1e3 * SOUND.shapes),
    "all modal gains are 0.001 times as large": replace(SOUND, participation=1e-3 * SOUND.participation),
}


@pytest.mark.parametrize("told", MISNAMED)
def test_channels_that_are_not_what_they_are_called_are_named(told: str) -> None:
    found = compare(STAGE, MISNAMED[told])
    wanted = "look exchanged: " if told.startswith("B4, ") else told
    assert [each for each in found.misnamed if wanted in each], found.misnamed
    assert any(wanted in each for each in found.data_warnings)


def test_outputs_and_inputs_are_named_together_each_as_if_the_others_were_right() -> None:
    exchanged = renamed(SOUND.outputs, S1="S4", S4="S1")
    both = replace(SOUND, outputs=exchanged, participation=times(SOUND.participation.T, 2, -1.0).T)
    doubts = compare(STAGE, both).misnamed
    assert [each.split(":")[0] for each in doubts] == ["S4 and S1 look exchanged", "B3 looks inverted"]
    two = replace(SOUND, outputs=exchanged, shapes=times(SOUND.shapes, 4, -1.0))
    [doubt] = compare(STAGE, two).misnamed
    what, right = doubt.split(": ")
    assert sorted(what.split(" and ")) == ["S1 look exchanged", "S4", "S5 looks inverted"]
    assert right.startswith("after both corrections, the similarity of measured shapes and theory is 1.00")


def test_outputs_that_shapes_cannot_doubt_are_named_by_their_part_in_the_modes() -> None:
    theory = np.random.default_rng(4).standard_normal((4, 3, 3))
    measured = theory[:, [1, 0, 2]] * np.array([[1.0], [1.0], [-1.0]])
    doubts = gain_doubts(Residues(("S1", "S2", "S3"), ("B1", "B2", "B3"), theory, measured, *np.ones((2, 3), dtype=bool)))
    assert [each.split(":")[0] for each in doubts] == ["S1 and S2 look exchanged", "S3 looks inverted"]


@pytest.mark.parametrize("seed", [3, *(pytest.param(seed, marks=pytest.mark.full) for seed in (0, 1, 2))])
def test_sound_channels_are_not_doubted(seed: int) -> None:
    """Modes off by some per cent, a weak drive, other units: nothing of that is a channel's fault."""
    built = set_value(STAGE, "parts.neck.thickness", (1.0 + 0.05 * seed) * 1.54e-3)
    plain = made(built, seed)
    volts = tuple(replace(channel, unit="V") for channel in plain.inputs)
    assert compare(STAGE, plain).misnamed == ()
    assert compare(STAGE, replace(plain, inputs=tuple(replace(each, unit="") for each in plain.inputs))).misnamed == ()
    known = stacks(STAGE)
    rated = np.array([1.0 / volts_per_metre(known[channel.name]) for channel in volts]) * 1e6
    assert compare(STAGE, replace(plain, inputs=volts, participation=plain.participation * rated)).misnamed == ()


def test_two_outputs_of_three_are_compared_without_doubts() -> None:
    one = replace(SOUND, outputs=SOUND.outputs[:1], shapes=SOUND.shapes[:1], shape_deviations=SOUND.shape_deviations[:1])
    assert compare(STAGE, one).misnamed == ()
