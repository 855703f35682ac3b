"""A loop from its set-up: every number reaches its place, and what the study says is what its parts say."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.analysis.workspace.drive import drive
from flexstage.analysis.workspace.small import second_order
from flexstage.base.finding import DesignError
from flexstage.base.labelled import Matrix
from flexstage.base.storage.document import plain
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.control.plant_models.coordinates import coordinates
from flexstage.control.plant_models.reduction import reduce_modes, resonances
from flexstage.control.show.playing import response_motions
from flexstage.control.show.sections import _sampler as sampler_text
from flexstage.control.show.sections import loop_section, margin_points, margin_spots, time_section
from flexstage.control.show.tables import margin_tables, noise_table, static_error_tables, time_tables
from flexstage.control.simulation.result import Excursion, other_motions
from flexstage.control.study.choices import Axis, Compensation, ControllerKind, StackKind
from flexstage.control.study.control import make_controller
from flexstage.control.study.course import courses, sampled_course
from flexstage.control.study.resolve import default_rate, resolve
from flexstage.control.study.runs import StepAnswer, driven_machine, rest_rms, runs
from flexstage.control.study.setup import (
    AmplifierSetup,
    AxisAmplitudes,
    ControllerSetup,
    DampingSetup,
    Floor,
    GaugeSetup,
    HystereticStacks,
    LoopSetup,
    RasterMotion,
    SineMotion,
    SpiralMotion,
    StepMotion,
    VibrationSetup,
)
from flexstage.control.study.stacks import stacks_of, sweep_stacks
from flexstage.control.study.study import LoopStudy, loop_study
from flexstage.control.systems.closed import loop
from flexstage.models.ideal import ideal
from flexstage.models.lumped import lumped
from flexstage.models.mapped import mapped
from flexstage.parts.gauge import Gauge
from flexstage.show.display import percent
from flexstage.show.page import Prose
from flexstage.show.viewer.data import stage_data
from flexstage.solid.results.modes import fea_modes

CALM = ControllerSetup(integral=300.0)


def test_every_number_of_the_set_up_reaches_the_hardware() -> None:
    amplifier = AmplifierSetup(bandwidth=900.0, current=0.1, slew=1e3, noise=2e-6, bits=16)
    gauges = GaugeSetup(noise=1e-10, resolution=2e-9, bandwidth=3e3, filter_order=2, filter_corner=4e3)
    given = resolve(parallelogram(), LoopSetup(rate=12e3, delay=1e-4, amplifier=amplifier, gauges=gauges)).plant.hardware
    (power,), (sensor,) = given.amplifiers.values(), given.sensors.values()
    span = power.high - power.low
    volts = float(drive(parallelogram()).gain[0])
    assert (given.rate, given.delay, power.bandwidth) == (12e3, 1e-4, 900.0)
    assert power.noise_density == pytest.approx(2e-6 * volts, abs=0.0)
    assert power.step == pytest.approx(span / 2**16)
    assert power.slew == pytest.approx(1e3 * volts)  # slower than 0.1 A into the stack lets it
    assert (sensor.noise_density, sensor.resolution, sensor.bandwidth) == (1e-10, 2e-9, 3e3)
    assert (sensor.filter_order, sensor.filter_corner) == (2, 4e3)
    assert sensor.half_range == 0.5 * parallelogram().sensors["probe"].range
    weak = resolve(parallelogram(), LoopSetup(rate=12e3, amplifier=AmplifierSetup(current=1e-4, slew=1e3))).plant.hardware
    capacitance = float(drive(parallelogram()).capacitance[0])
    assert weak.amplifiers["B"].slew == pytest.approx(1e-4 / capacitance * volts)  # I = C dV/dt


@cache
def _calm() -> LoopStudy:
    return loop_study(parallelogram(), LoopSetup(rate=10e3, controller=CALM))


def test_margins_are_marked_where_the_open_loop_has_them() -> None:
    found = _calm()
    spots = tuple(margin_spots(found))
    assert found.curves is not None
    assert {each.text.split(" margin")[0] for each in spots} == {"x: gain", "x: phase", "x: delay"}
    for spot in spots:
        opened = 1.0 / found.curves.response.transfer(np.array([spot.x]))[0, 0, 0] - 1.0
        assert spot.y == pytest.approx(abs(opened), rel=1e-6)
    for point in margin_points(found):  # of gain on the negative real axis, of phase and delay on the unit circle
        assert min(abs(point.imag) + (point.real > 0.0), abs(abs(point) - 1.0)) < 1e-4
    table = margin_tables(found)[1]
    assert table is not None
    told = dict(zip(*table.texts(), strict=True))
    assert found.margins is not None
    own = found.margins.of("x")
    assert float(told["delay margin [ms]"]) == pytest.approx(1e3 * own.delay.value, rel=1e-3)
    assert float(told["phase margin [deg]"]) == pytest.approx(180.0 / np.pi * own.phase.value, rel=1e-3)


def test_how_far_small_displacements_hold_is_told_of_what_is_simulated() -> None:
    found = _calm()
    stepped = {found.plant.coordinates.names[0]: np.max(found.runs[0].simulated.reference)}
    assert found.second_order == second_order(found.settled.mechanism, found.settled.kinematics, stepped)
    assert found.second_order is not None
    time = time_section(found)
    assert time is not None
    assert time.blocks[0] == Prose(found.second_order.text)


def test_what_plays_is_where_the_platform_truly_went() -> None:
    """The farthest instant by the bodies' twists, every instant by the weights of the coordinates."""
    stage = parallelogram()
    found = loop_study(stage, LoopSetup(controller=CALM, gauges=GaugeSetup(resolution=0.0), seconds=0.05))
    shown = stage_data(stage)
    (motion,) = response_motions(found, shown)
    assert motion.response is not None
    place, bone = shown.bodies.index("platform"), shown.bones.references["platform"]
    seen = found.runs[0].simulated
    true = (seen.reference - seen.true_error)[:, 0]
    times = motion.response.curves[0].values / {"s": 1.0, "ms": 1e3}[motion.response.curves[0].unit]
    np.testing.assert_allclose(motion.response.weights[:, 0], np.interp(times, seen.times, true), rtol=0.0, atol=1e-15)
    far = int(np.argmax(np.abs(motion.response.weights[:, 0])))
    moved = motion.twists[place, :3] + np.cross(motion.twists[place, 3:], bone)
    np.testing.assert_allclose(moved, [motion.response.weights[far, 0], 0.0, 0.0], rtol=0.0, atol=1e-15)
    basis = motion.response.basis[0, place]
    np.testing.assert_allclose(basis[:3] + np.cross(basis[3:], bone), [1.0, 0.0, 0.0], rtol=0.0, atol=1e-9)


def test_a_trajectory_is_played_with_its_error_as_many_times_too_large_as_its_name_says() -> None:
    stage = parallelogram()
    found = loop_study(stage, LoopSetup(controller=CALM, gauges=GaugeSetup(resolution=0.0), trajectory=SineMotion(1.0, 1.0)))
    (motion,) = response_motions(found, stage_data(stage))
    assert motion.response is not None
    factor = float(motion.label.rpartition("error magnified ")[2].removesuffix(" times"))
    wanted, error = (next(each for each in motion.response.curves if each.name == name) for name in ("reference of x", "error of x"))
    scales = {"m": 1.0, "um": 1e-6, "µm": 1e-6, "nm": 1e-9, "pm": 1e-12}
    played = wanted.values * scales[wanted.unit] - factor * error.values * scales[error.unit]
    np.testing.assert_allclose(motion.response.weights[:, 0], played, rtol=0.0, atol=1e-15)


def test_rasters_and_spirals_go_along_any_two_motions() -> None:
    loops = coordinates(ideal(double_triangle()))
    for first, second in ((Axis.RX, Axis.RY), (Axis.Z, Axis.RZ)):
        for asked in (RasterMotion(fast=first, slow=second), SpiralMotion(first=first, second=second)):
            (course,) = courses(asked, loops)
            assert course.plane == (first.value, second.value)
            _, poses = sampled_course(course, loops, 1e-3, course.duration)
            moved = np.ptp(poses, axis=0) > 0.0
            assert [name for name, each in zip(loops.names, moved, strict=True) if each] == sorted(course.plane, key=loops.names.index)


def test_static_errors_are_by_coordinate_reached_and_commanded() -> None:
    found = _calm().static_errors
    assert found is not None
    table, corrected = static_error_tables(found)
    assert {cell.text for row in corrected.rows for cell in row[1:]} == {"0"}
    assert float(table.rows[0][1].text) == pytest.approx(found.ideal_map.error.at("x", "x").item(), rel=1e-4)
    assert any(f"{percent(found.ideal_map.largest, 3)} with the ideal mapping R_a" in note for note in table.notes)


def test_crosstalk_is_told_in_every_unit() -> None:
    """Lengths and angles are each told, and the largest of each, whatever their numbers in metres and radians are."""
    found = _calm().static_errors
    assert found is not None
    units = (("1", "m/rad"), ("1", "m/rad"), ("rad/m", "1"))
    error = Matrix(np.array([[0.01, 0.0], [0.002, 0.0], [5.0, 0.0]]), ("x", "y", "rz"), ("x", "rz"), units)
    one = replace(found.ideal_map, error=error)
    table = static_error_tables(replace(found, ideal_map=one, lost_motion_gains=one))[0]
    assert table.texts()[2:] == [["y [um]", "0.002", "0"], ["rz [urad]", "5", "0"]]
    moved = {"x": Excursion(1e-9, "m"), "y": Excursion(3e-9, "m"), "rx": Excursion(2e-9, "rad"), "rz": Excursion(5e-8, "rad")}
    answer = StepAnswer(1e-6, "m", 0.1, 0.0, 0.0, moved, np.zeros(1))
    assert answer.cross_axis_error == ("3 nm y", "50 nrad rz")


def test_rates_are_round_and_fast_enough() -> None:
    for highest in (3.0, 173.0, 999.0, 1000.0, 1001.0, 5e3, 7.7e4):
        rate = default_rate(highest)
        assert rate >= max(10e3, 10.0 * highest)
        assert f"{rate:.0e}"[0] in "125"
        assert float(f"{rate:.0e}") == rate


def test_a_reduced_plant_keeps_its_static_gains_and_the_loop_its_poles() -> None:
    given = resolve(double_triangle(), LoopSetup())
    few, whole = given.plant.system, given.whole.system
    assert len(few.A) < 0.4 * len(whole.A)
    at_rest = [each.transfer(np.zeros(1))[0] for each in (few, whole)]
    np.testing.assert_allclose(at_rest[0], at_rest[1], rtol=1e-7, atol=1e-9 * np.max(np.abs(at_rest[1])))
    assert float(np.min(resonances(given.plant))) >= 0.01
    assert reduce_modes(given.plant, resonances(given.plant) >= 0.01) is given.plant
    lines = np.geomspace(1.0, 0.45 * given.rate, 200)
    pair = [
        given.plant.coordinates.scale[:, None] * (given.plant.coordinates.pose @ each.transfer(lines)[:, :6, :6]) for each in (few, whole)
    ]
    assert np.max(np.abs(pair[0] - pair[1])) < 0.02


def test_a_loop_of_stated_numbers_settles_as_its_integrator_does() -> None:
    found = loop_study(parallelogram(), LoopSetup(controller=CALM, gauges=GaugeSetup(resolution=0.0), seconds=0.1))
    (run,) = found.runs
    assert run.figures is not None
    assert run.figures.settling[0] == pytest.approx(np.log(50.0) / 300.0, rel=0.05)  # and the delay
    assert found.growth_all_modes == pytest.approx(loop(found.settled.whole, found.controller.system).system.growth)


def test_open_loop_errors_are_those_at_rest() -> None:
    """A step in open loop ends where the static errors say, by the map alone and corrected."""
    for compensate, wanted in (((), 0.012938), ((Compensation.LOST_MOTION,), 0.0)):
        setup = LoopSetup(controller=ControllerSetup(kind=ControllerKind.NONE), compensate=compensate, gauges=GaugeSetup(resolution=0.0))
        found = loop_study(parallelogram(), setup)
        error = found.runs[0].simulated.true_error[:, 0] / 1e-6
        late = error[len(error) // 2 :]
        shown = found.static_errors.ideal_map if not compensate else found.static_errors.lost_motion_gains
        assert float(np.asarray(shown.error.values)[0, 0]) == pytest.approx(wanted, abs=1e-5)
        assert float(np.mean(late)) == pytest.approx(wanted, abs=3e-3)  # what still rings averages out


def test_the_inverse_of_the_stacks_own_model_is_exact_and_helps_others_fivefold() -> None:
    own, other = (sweep_stacks(stacks_of(parallelogram(), HystereticStacks(width=0.15, plant=kind))) for kind in StackKind)
    assert float(own.rms_error_inverse[0]) < 1e-9
    assert float(other.rms_error_inverse[0]) < 0.2 * float(other.rms_error[0])


def test_stacks_creep_by_their_law() -> None:
    """In open loop a step goes on by as much a decade as is stated, from a tenth of a second on."""
    still, creeping = (HystereticStacks(width=0.01, creep=creep) for creep in (None, 0.02))
    asked = LoopSetup(
        controller=ControllerSetup(kind=ControllerKind.NONE), trajectory=StepMotion(amplitude=AxisAmplitudes(x=1e-6)), seconds=0.6
    )
    first, second = (
        loop_study(parallelogram(), LoopSetup(**{**asked.__dict__, "hysteresis": each})).runs[0].simulated for each in (still, creeping)
    )
    places = [int(np.searchsorted(first.times, time)) for time in (0.1, 0.2, 0.4)]
    ratio = (1.0 - second.true_error[places, 0] / 1e-6) / (1.0 - first.true_error[places, 0] / 1e-6)
    np.testing.assert_allclose(ratio, 1.0 + 0.02 * np.log10(first.times[places] / 0.1), atol=2e-4)


def test_loads_that_are_carried_take_of_the_strokes() -> None:
    """290 of 300 um are there for a command, but not beside the 16 um that carry the platform's weight."""
    slow, far = ControllerSetup(integral=5.0), StepMotion(amplitude=AxisAmplitudes(z=290e-6))
    assert loop_study(double_triangle(), LoopSetup(controller=slow, trajectory=far, compensate=(), seconds=0.01)).runs
    with pytest.raises(DesignError, match="trajectory z: beyond the strokes from"):
        loop_study(double_triangle(), LoopSetup(controller=slow, trajectory=far, compensate=(Compensation.LOAD,), seconds=0.01))


def test_strokes_that_carry_loads_take_of_the_simulated_range() -> None:
    """Voltages are counted from those of the load strokes, also in exported controllers, and a step ends where the stack ends."""
    asked = LoopSetup(controller=CALM, trajectory=StepMotion(amplitude=AxisAmplitudes(x=1e-6)), seconds=0.05)
    given = resolve(parallelogram(), asked)
    control, electric = make_controller(given, given.plant.coordinates.strokes), drive(parallelogram())
    carried = electric.gain * (electric.high - electric.bias) - 1.0001e-6
    given = replace(given, carried=carried)
    assert driven_machine(given, control).amplifiers.bias == pytest.approx(electric.high - 1.0001e-6 / electric.gain)
    (run,) = runs(given, control, loop(given.plant, control.system))
    seen = run.simulated
    assert seen.volts == pytest.approx(electric.bias + (carried + seen.given) / electric.gain)
    assert np.max(seen.given) == pytest.approx(1.0001e-6, rel=1e-9)  # the integrator goes to the end


def test_fractions_at_limits_are_those_of_the_shown_samples() -> None:
    """The noise starts before a trajectory, at rest within all limits: this time does not count."""
    fast = SineMotion(amplitude=AxisAmplitudes(x=5e-6), frequency=100.0)
    asked = LoopSetup(
        controller=CALM, compensate=(Compensation.REFERENCE,), gauges=GaugeSetup(noise=1e-10), amplifier=AmplifierSetup(slew=2000.0)
    )
    given = resolve(parallelogram(), replace(asked, trajectory=fast))
    control = make_controller(given, given.plant.coordinates.strokes)
    (run,) = runs(given, control, loop(given.plant, control.system))
    share = np.mean(run.simulated.given != run.simulated.asked)
    assert share > 0.1
    assert run.simulated.saturated + run.simulated.slewing == pytest.approx(share)


def test_steps_of_angular_gauges_are_angles() -> None:
    """A reading in radians is rounded to steps in radians, also in the block diagram."""
    given = resolve(parallelogram(), LoopSetup(controller=CALM, gauges=GaugeSetup(resolution=5e-10)))
    turned = replace(given.plant, coordinates=replace(given.plant.coordinates, gauge_units=("rad",)))
    told = [sampler_text(SimpleNamespace(plant=each), "10 kHz") for each in (given.plant, turned)]  # type: ignore[arg-type]
    assert told == ["10 kHz\nsteps 500 pm", "10 kHz\nsteps 0.5 nrad"]


def test_the_crossover_of_a_loop_is_told_as_that_of_the_slowest() -> None:
    """An optimised controller has another crossover in every loop; the lowest is shown."""
    found = loop_study(parallelogram(), LoopSetup(controller=ControllerSetup(quick=True), seconds=0.05))
    shown = loop_section(found)
    assert shown is not None
    assert "slowest loop" in str(shown)


def test_the_same_seed_gives_the_same_noise() -> None:
    setup = LoopSetup(controller=CALM, gauges=GaugeSetup(noise=1e-9), trajectory=SineMotion(frequency=50.0), seconds=0.05)
    first, again = (loop_study(parallelogram(), setup).runs[0].simulated.true_error for _ in range(2))
    other = loop_study(parallelogram(), LoopSetup(**{**setup.__dict__, "seed": 1})).runs[0].simulated.true_error
    np.testing.assert_array_equal(first, again)
    assert np.any(first != other)


def resting(density: float) -> LoopStudy:
    """A gauge of 0.5 nm on a floor that sways at 1 to 5 Hz, which the loop follows."""
    swaying = Floor(x=VibrationSetup(acceleration=(0.023, 0.023), frequencies=(1.0, 5.0)))
    return loop_study(
        parallelogram(), LoopSetup(controller=CALM, floor=swaying, gauges=GaugeSetup(noise=density, resolution=5e-10), seconds=0.05)
    )


def test_slow_rounding_is_told_and_its_rms_simulated() -> None:
    """The loop waits until the reading moves by a step: rounding is no white noise, and what the budget says is far off."""
    found = resting(1e-14)
    assert found.noise.slowly_rounding == ("S",)
    assert found.noise.changes[0] < 0.01
    assert found.resting is not None
    assert 2.0 * found.noise.rms[0] < found.resting.low[0] < found.resting.rms[0] < found.resting.high[0] < 5e-10
    assert any("rounding is not white" in each.what for each in found.warnings)
    table = noise_table(found)
    assert [column.head for column in table.columns] == [
        "coordinate",
        "rms",
        "95 %, low",
        "95 %, high",
        "white quantisation",
        "floor",
        "gauge noise",
        "gauge rounding",
    ]
    assert any("counted as white noise, but it is not white" in note for note in table.notes)
    document = plain(found)
    assert document["noise"]["rounding_is_white"] is False
    assert document["simulated_interval"] == [found.resting.low.tolist(), found.resting.high.tolist()]
    assert document["simulated_rms"] == found.resting.rms.tolist()


def test_a_loop_at_rest_strays_to_the_edge_of_its_gauges_step() -> None:
    """Held u steps off the middle, a loop without noise ends where the reading changes, (1/2 - |u|) away: over all u, 1/sqrt(12) rms."""
    step = 5e-9
    found = loop_study(parallelogram(), LoopSetup(controller=CALM, gauges=GaugeSetup(noise=1e-14, resolution=step), seconds=0.05)).resting
    assert found is not None
    assert found.low[0] < step / np.sqrt(12.0) < found.high[0]
    assert found.rms[0] > 0.1 * step


def test_steps_alone_are_simulated_too() -> None:
    """Without any noise the budget of white rounding is as wrong, and nothing else would tell."""
    silent = replace(parallelogram(), sensors={"probe": Gauge(range=1e-4, resolution=5e-9)})
    found = loop_study(silent, LoopSetup(controller=CALM, seconds=0.05))
    assert found.still is None
    assert found.resting is not None
    assert found.resting.low[0] < 5e-9 / np.sqrt(12.0) < found.resting.high[0]
    assert found.simulated_rms is found.resting.rms


def test_rounding_in_noise_of_its_step_is_white() -> None:
    """Noise of half a step and more leaves the budget as it is, and simulations hold it."""
    found = resting(1e-11)
    assert not found.noise.slowly_rounding
    assert found.resting is None
    repeated = rest_rms(found.settled, found.controller, found.closed)
    assert repeated.low[0] < found.noise.rms[0] < repeated.high[0]
    assert [column.head for column in noise_table(found).columns][-1] == "simulated"
    assert found.simulated_interval is None


def test_steps_tell_what_every_other_axis_does() -> None:
    """A stage of one loop turns and sways as well: the table names the most of both, the document all."""
    found = loop_study(parallelogram(), LoopSetup(controller=CALM, seconds=0.05))
    run = found.runs[0]
    told = other_motions(run.simulated, "x")
    assert set(told) == {"y", "z", "rx", "ry", "rz"}
    for name, each in told.items():
        assert each.unit == ("rad" if name.startswith("r") else "m")
        assert each.largest == np.max(np.abs(run.simulated.motion(f"relative.{name}")))
    turned = max((each.largest, name) for name, each in told.items() if each.unit == "rad")
    assert turned[0] > 1e-9
    table = time_tables(found.runs)[0]
    assert table is not None
    (cell,) = (row[[column.head for column in table.columns].index("cross-axis error")].text for row in table.rows)
    assert cell.endswith(f"{1e9 * turned[0]:.3g} nrad {turned[1]}")
    assert plain(found)["runs"][0]["step"]["others"][turned[1]]["largest"] == turned[0]


def test_others_count_departures_from_what_was_asked() -> None:
    """Of six loops: along the axis itself nothing, along others the error."""
    setup = LoopSetup(controller=ControllerSetup(integral=5.0), trajectory=StepMotion(amplitude=AxisAmplitudes(x=1e-6)), seconds=0.02)
    found = loop_study(double_triangle(), setup)
    seen = found.runs[0].simulated
    told = other_motions(seen, "x")
    assert set(told) == {"y", "z", "rx", "ry", "rz"}
    assert told["y"].largest == np.max(np.abs(seen.true_error[:, 1]))


def test_a_plant_of_finite_elements_is_taken_as_it_is():
    """The same matrices called solid: the same loop, and it says what it is a model by."""
    stage = parallelogram()
    model = lumped(stage)
    asked = LoopSetup(controller=ControllerSetup(integral=300.0))
    drawn = loop_study(stage, asked)
    found = loop_study(stage, asked, solid=FeaModes(platform_modes(stage, model), model, 3))
    assert np.array_equal(found.closed.system.A, drawn.closed.system.A)
    assert (drawn.model_name, found.model_name) == ("lumped", "solid, elements of order 3")
    with pytest.raises(DesignError, match="provides no forces"):
        loop_study(stage, replace(asked, damping=DampingSetup()), solid=FeaModes(platform_modes(stage, mapped(stage)), mapped(stage), 3))


@pytest.mark.full
def test_a_loop_on_finite_elements_of_a_guide_is_the_loop_of_theory_as_far_as_their_modes_are_the_same():
    """The guide's mode by both within 5 % (docs/validation), so is its rejection."""
    stage = parallelogram()
    asked = LoopSetup(controller=ControllerSetup(integral=300.0))
    theory, solid = loop_study(stage, asked), loop_study(stage, asked, solid=fea_modes(stage))
    assert solid.settled.highest == pytest.approx(theory.settled.highest, rel=0.05)
    assert solid.bandwidths.rejection == pytest.approx(theory.bandwidths.rejection, rel=0.05)


@pytest.mark.parametrize(("name", "motions"), [("mirror-mount", 0), ("telescope-mount", 0)])
def test_a_stage_without_motion_or_drive_has_no_loop(name: str, motions: int) -> None:
    with pytest.raises(DesignError, match=f"{motions} ideal motions and 0 actuators"):
        resolve(case(name), LoopSetup())
