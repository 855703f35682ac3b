"""Laws of simulated loops: limits hold exactly, nothing is known before its time, what is linear adds up, integrators leave no error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.workspace.drive import drive
from flexstage.base.finding import DesignError
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.controllers.pi import PI
from flexstage.control.example import integral_loop
from flexstage.control.hysteresis.creep import Creep
from flexstage.control.plant_models.creep_plant import add_creep
from flexstage.control.simulation.machine import Machine, machine
from flexstage.control.simulation.result import step_figures, tracking
from flexstage.control.simulation.run import simulate
from flexstage.control.simulation.running import RunningLoop
from flexstage.control.systems.system import System, static
from flexstage.control.trajectory.profile import Limits
from flexstage.control.trajectory.step import Step
from flexstage.models.linear.model import Channel
from tests.conftest import examples
from tests.elsewhere.loops import full_loop, plays, six_axes, way, without_limits

SIZES = st.floats(1e-6, 150e-6)


def stepped(found: Machine, size: float, count: int = 1500) -> np.ndarray:
    """A reference of steps: out on the first axis, back after half of it."""
    reference = np.zeros((count, len(found.names)))
    reference[: count // 2, 0] = size
    return reference


@examples(6)
@given(SIZES, st.integers(0, 5), st.booleans())
def test_limits_hold_exactly(size, axis, inverse):
    known = full_loop(inverse=inverse)
    reference = np.roll(stepped(known, size if axis < 3 else 2.0 * size, 400), axis, axis=1)
    found, amplifiers = simulate(known, reference), known.amplifiers
    assert np.all(found.given >= amplifiers.low)
    assert np.all(found.given <= amplifiers.high)
    most, last = amplifiers.slew * known.step, np.vstack([np.zeros(6), found.given[:-1]])
    assert np.all(found.given <= last + most)  # to the bit: this is how it is computed
    assert np.all(found.given >= last - most)
    steps = found.readings / known.resolution
    assert np.max(np.abs(steps - np.rint(steps))) < 1e-6
    free = (found.given != found.asked).any(axis=1)
    assert np.array_equal(found.given[~free], found.asked[~free])


def test_range_and_speed_are_both_reached_and_counted():
    known = full_loop()
    found = simulate(known, stepped(known, 150e-6, 2000))
    assert np.any(found.saturated > 0.01)
    assert np.any(found.slewing > 0.01)
    np.testing.assert_allclose(found.saturated + found.slewing, np.mean(found.given != found.asked, axis=0), rtol=1e-12)  # one or the other
    assert np.max(found.given) == np.max(known.amplifiers.high[:3])
    assert np.nanmax(found.volts) == pytest.approx(1000.0, rel=1e-12)


def test_nothing_is_known_before_its_time():
    known = full_loop(inverse=True)
    reference, disturbances = way(known, 300)
    changed = reference.copy()
    changed[200:] *= -1.0
    one, other = simulate(known, reference, disturbances), simulate(known, changed, disturbances)
    assert np.array_equal(one.given[:200], other.given[:200])
    assert np.array_equal(one.motions[:200], other.motions[:200])
    assert not np.array_equal(one.given[200], other.given[200])
    assert np.array_equal(one.motions[200], other.motions[200])  # the stroke of a sample is on its way


def test_parts_leave_no_trace():
    """A loop that runs on in parts gives what it gives in one, to the bit: nothing but its state is carried over."""
    known = full_loop(inverse=True)
    reference, disturbances = way(known, 300)
    whole, running = simulate(known, reference, disturbances), RunningLoop(known, disturbances)
    parts = [running.advance(reference[start : start + 7]) for start in range(0, 300, 7)]
    for name in ("pose", "given", "readings"):
        assert np.array_equal(getattr(whole, name), np.concatenate([getattr(each, name) for each in parts]))
    for name in ("stroke", "motions"):  # products of many rows at once
        parted = np.concatenate([getattr(each, name) for each in parts])
        assert np.max(np.abs(getattr(whole, name) - parted)) <= 1e-13 * np.max(np.abs(getattr(whole, name)))


@examples(4)
@given(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_linear_loops_add_up(one, other):
    known = without_limits(full_loop())
    reference, disturbances = way(known, 200)
    nothing = np.zeros_like(reference)
    together = simulate(known, one * reference, {name: other * values for name, values in disturbances.items()})
    apart = one * simulate(known, reference).motions + other * simulate(known, nothing, disturbances).motions
    assert np.max(np.abs(together.motions - apart)) <= 1e-12 * max(np.max(np.abs(apart)), 1e-9)


def test_constant_commands_lead_to_the_static_motion():
    wired = six_axes()
    actuators = wired.plant.actuators
    through = static(
        wired.plant.coordinates.strokes,
        tuple(Channel(f"reference.{name}", unit) for name, unit in zip(wired.plant.coordinates.names, "mmm" + "rrr", strict=True)),
        tuple(Channel(f"command.{name}", "m") for name in actuators),
        wired.step,
    )
    known = without_limits(machine(wired.plant, through))
    reference = np.tile(1e-6 * np.arange(1.0, 7.0), (20_000, 1))
    found = simulate(known, reference)
    plant = wired.plant.system
    columns = [plant.input_names.index(name) for name in actuators]
    gain = (plant.D - plant.C @ np.linalg.solve(plant.A, plant.B))[len(wired.plant.gauges) :, columns]
    assert np.max(np.abs(found.motions[-1] - gain @ found.command[-1])) < 1e-4 * np.max(np.abs(found.motions[-1]))  # 2 s of ringing at 1 %


def test_integrators_leave_no_error_but_rounding():
    known = full_loop()
    found = simulate(known, np.full((12_000, 6), 5e-6))
    assert np.all(np.abs(np.mean(found.error[-500:], axis=0)) < np.max(np.abs(known.pose) @ known.resolution))


def one_axis(tracking_time: float, current: float = 1.0) -> Machine:
    wired = integral_loop()
    stage = parallelogram()
    law = Decentralised(platform_loops(wired.plant.coordinates), (PI(0.0, 100.0, tracking=tracking_time),)).system(wired.step)
    found = machine(wired.plant, law, drive(stage))
    return replace(found, resolution=np.zeros(1), amplifiers=replace(found.amplifiers, high=np.full(1, 10e-6), low=np.full(1, -10e-6)))


def test_overshoot_is_beyond_the_step_not_ahead_of_the_reference():
    """A motion ahead of a slow reference has not passed the end of the step; one that first goes backwards undershoots."""
    reference = np.linspace(0.0, 1e-6, 11)[:, None]
    found = simulate(replace(one_axis(1e9), resolution=np.zeros(1)), reference)
    place = [channel.name for channel in found.channels].index("relative.x")

    def moved(true: np.ndarray) -> tuple[float, float]:
        motions = found.motions.copy()
        motions[:, place] = true
        seen = step_figures(replace(found, motions=motions))
        return float(seen.overshoot[0]), float(seen.undershoot[0])

    assert moved(np.minimum(reference[:, 0] + 0.3e-6, 1e-6)) == pytest.approx((0.0, 0.0), abs=1e-12)
    assert moved(np.where(np.arange(11) == 1, -0.2e-6, reference[:, 0])) == pytest.approx((0.0, 0.2), abs=1e-12)
    assert moved(1.1 * reference[:, 0]) == pytest.approx((0.1, 0.0), abs=1e-12)


def test_anti_windup_recovers():
    """Asked for twice the stroke, then for half of it: with back-calculation the loop turns back at once, without it stays at its end."""
    times = 1e-4 * np.arange(4000)
    known, wound = one_axis(0.01), one_axis(1e9)
    reach = float(simulate(known, np.full((4000, 1), 1.0)).pose[-1, 0])
    reference = np.where(times < 0.2, 2.0 * reach, 0.5 * reach)[:, None]
    good, bad = simulate(known, reference), simulate(wound, reference)
    settled = [step_figures(found, 0.02, start=0.2).settling[0] for found in (good, bad)]
    assert settled[0] < 0.08
    assert settled[1] > 2.0 * settled[0]
    assert good.saturated[0] > 0.4
    assert abs(good.error[-1, 0]) < 1e-3 * reach


def test_the_inverse_undoes_the_hysteresis_and_is_not_lost_behind_a_limit():
    known = full_loop(inverse=True)
    amplifiers = replace(known.amplifiers, step=np.zeros(6))
    wired = six_axes()
    loop = wired.plant.coordinates
    entering = tuple(Channel(f"reference.{name}", unit) for name, unit in zip(loop.names, loop.units, strict=True))
    through = static(loop.strokes, entering, tuple(Channel(f"command.{name}", "m") for name in loop.actuators), wired.step)
    opened = replace(known, controller=through, amplifiers=amplifiers)
    reference, _ = way(opened, 1500, size=10e-6)
    reference[300:500, 0] = 200e-6  # far beyond the strokes
    found = simulate(opened, reference)
    free = np.all(found.given == found.asked, axis=1)
    assert np.any(~free[300:500])
    assert np.sum(free[500:]) > 500
    assert np.max(np.abs(found.stroke - found.command)[free]) < 1e-12 * np.max(np.abs(found.command))
    uncompensated = simulate(replace(opened, compensation=None), reference)
    assert np.max(np.abs(uncompensated.stroke - uncompensated.command)[free]) > 1e-6


def test_creep_is_run_between_stack_and_stage():
    wired = six_axes()
    creep = Creep(np.full(6, 1.0), np.full((6, 2), [0.02, 0.03]), np.full((6, 2), [1e-3, 1e-2]))
    loop = wired.plant.coordinates
    entering = tuple(Channel(f"reference.{name}", unit) for name, unit in zip(loop.names, loop.units, strict=True))
    through = static(loop.strokes, entering, tuple(Channel(f"command.{name}", "m") for name in loop.actuators), wired.step)
    reference, _ = way(full_loop(), 400)
    whole = simulate(without_limits(machine(add_creep(wired.plant, creep), through)), reference)
    crept, states, risen = np.empty_like(whole.stroke), np.zeros_like(creep.times), -np.expm1(-1e-4 / creep.times)
    for row, stroke in enumerate(whole.stroke):
        crept[row] = creep.instant * stroke + np.sum(creep.gains * states, axis=1)
        states += risen * (stroke[:, None] - states)
    # Creep and the amplifiers' lag may change places: fed with what creep makes of the held strokes, the plain plant moves nearly alike
    # (its hold keeps the value a sample takes at its start; the creep goes on within it).
    fine = simulate(without_limits(machine(wired.plant, replace(through, D=np.eye(6)))), crept)
    assert np.max(np.abs(fine.motions - whole.motions)) < 5e-3 * np.max(np.abs(whole.motions))
    assert np.max(np.abs(whole.stroke - crept)) > 0.02 * np.max(np.abs(crept))


def test_settling_and_overshoot_of_a_known_answer():
    """A plant of gain 1 and one sample of delay under an integrator k: e[n+1] = e[n] - k T e[n-1], a difference equation by hand."""
    gain, step, one = 0.3, 1e-3, np.eye(1)
    stroke, error, command = ((Channel(name, "m"),) for name in ("B", "error.x", "command.B"))
    motions = (Channel("gap.S", "m"), Channel("platform.x", "m"))
    plant = System(0.0 * one, one, np.ones((2, 1)), np.zeros((2, 1)), stroke, motions, step)
    control = System(one, gain * one, one, gain * one, error, command, step)
    free = np.array([np.inf])
    amplifiers = full_loop().amplifiers
    amplifiers = replace(amplifiers, low=-free, high=free, slew=free, step=np.zeros(1), gain=np.ones(1), bias=np.zeros(1))
    known = Machine(plant, control, (Channel("x", "m"),), ("B",), ("S",), one, amplifiers, np.zeros(1))
    found = simulate(known, np.ones((60, 1)))
    expected, u, y = [], 0.0, 0.0
    for _ in range(60):
        expected.append(y)
        u += gain * (1.0 - y)
        y = u
    assert found.motion("platform.x") == pytest.approx(expected, rel=1e-14)
    figures = step_figures(found, 0.02)
    assert figures.settling[0] == pytest.approx(step * int(np.ceil(np.log(0.02) / np.log(1.0 - gain))), rel=1e-12)  # e = 0.7^n
    assert figures.overshoot[0] == 0.0
    assert tracking(found).at("x", "peak") == 1.0


def test_what_goes_the_other_way_first_is_undershoot():
    """Answers given by hand, to a step up and to one down: a fifth the wrong way, then three tenths beyond."""
    known = without_limits(machine(integral_loop().plant, integral_loop().controller, motions=("platform.x",)))
    found = simulate(known, np.zeros((6, 1)))
    answer = np.array([0.0, -0.2, 0.6, 1.3, 0.99, 1.0])[:, None]
    for size in (2e-6, -2e-6):
        given = replace(found, reference=np.full((6, 1), size), motions=size * answer)
        figures = step_figures(given, 0.02)
        assert (figures.overshoot[0], figures.undershoot[0]) == pytest.approx((0.3, 0.2), rel=1e-12)
        assert figures.settling[0] == pytest.approx(4.0 * known.step, rel=1e-12)
        late = step_figures(given, 0.02, start=2.0 * known.step)
        assert (late.overshoot[0], late.undershoot[0]) == pytest.approx((0.3, 0.0), rel=1e-12)
        assert late.settling[0] == pytest.approx(2.0 * known.step, rel=1e-12)
        assert step_figures(given, 0.02, start=5.0 * known.step).settling[0] == 0.0


def test_jerk_limited_steps_ring_less_than_steps_at_once():
    known = without_limits(full_loop())
    times = known.step * np.arange(4000)
    reference = np.zeros((4000, 6))
    step = Step({"x": 10e-6}, limits=Limits(1e-3, 0.5, 50.0))
    answers = []
    for course in (Step({"x": 10e-6}), step):
        reference[:, 0] = course.at(times)[:, 0]
        answers.append(step_figures(simulate(known, reference)).overshoot[0])
    assert answers[1] < 0.5 * answers[0]


def test_unstable_loops_are_told_with_the_time():
    wired = integral_loop(gain=20_000.0)
    with pytest.raises(DesignError, match=r"loop: the simulation diverged .* s after the start: the loop is unstable"):
        simulate(without_limits(machine(wired.plant, wired.controller)), np.full((20_000, 1), 1e-6))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"reference": np.zeros((5, 2))}, r"reference: wrong shape \(got \(5, 2\)\)"),
        ({"reference": np.full((5, 6), np.nan)}, r"reference at index 0, 0: must be a finite number \(got nan\)"),
        ({"named": {"ground.q": np.zeros(5)}}, r"ground\.q: unknown input of the loop\. Use ground\.x, ground\.y"),
        ({"named": {"noise.S1": np.zeros(4)}}, r"noise.S1: wrong length \(got \(4,\), expected 5 samples"),
    ],
)
def test_wrong_series_are_named(change, message):
    reference = change.get("reference", np.zeros((5, 6)))
    with pytest.raises(DesignError, match=message):
        simulate(full_loop(), reference, change.get("named", {}))


def test_motions_that_were_not_kept_are_named():
    found = simulate(full_loop(motions=("platform.x",)), np.zeros((3, 6)))
    with pytest.raises(DesignError, match=r"platform\.y: not recorded in the simulation\. Use platform\.x"):
        tracking(found)


def test_machines_that_cannot_be_are_named():
    known = full_loop()
    with pytest.raises(DesignError, match=r"got 0\.0001 s for the plant, 0\.001 s for the controller"):
        replace(known, controller=replace(known.controller, step=1e-3))
    with pytest.raises(
        DesignError, match=r"hysteresis: wrong number of axes \(got 1, expected 6, the actuators\)\. Use one axis per actuator"
    ):
        replace(known, hysteresis=plays().__class__([0.0], [1.0]))
    with pytest.raises(DesignError, match=r"B1: hysteresis needs the stack's voltage range, which is missing"):
        replace(known, amplifiers=replace(known.amplifiers, gain=np.full(6, np.nan)))
    with pytest.raises(DesignError, match="the readings depend on the stroke of the same sample"):
        replace(known, plant=replace(known.plant, D=np.ones_like(known.plant.D)))
    one = six_axes().plant
    with pytest.raises(DesignError, match="the loop is continuous, but the simulation needs samples"):
        machine(replace(one, hardware=replace(one.hardware, rate=None, delay=0.0)), known.controller)
