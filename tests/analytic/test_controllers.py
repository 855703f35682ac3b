"""Controllers against closed forms: frequency responses, notches, integral resonant damping, back-calculation, separation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from flexstage.analysis.dynamics.modes import modes
from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import case
from flexstage.control.controllers.decentralised import Decentralised
from flexstage.control.controllers.loops import actuator_loops, modal_loops, platform_loops
from flexstage.control.controllers.lqg import Disturbances, Weights, lqg
from flexstage.control.controllers.notch import Notch, notch_of_mode
from flexstage.control.controllers.pi import PI
from flexstage.control.controllers.pid import PID
from flexstage.control.controllers.pose_plant import pose_plant
from flexstage.control.controllers.resonant import IntegralResonant, resonant_law
from flexstage.control.plant_models.coordinates import coordinates
from flexstage.control.plant_models.electronics import Hardware
from flexstage.control.plant_models.plants import plant
from flexstage.control.systems.closed import loop
from flexstage.control.systems.system import System, connect, rename, select
from flexstage.models.ideal import ideal
from flexstage.models.linear.model import Channel
from flexstage.models.lumped import lumped
from flexstage.models.mapped import mapped

FREQUENCIES = np.geomspace(0.1, 4000.0, 60)
STEP = 1e-4
PLAIN = {"rtol": 1e-11}
S = 2j * np.pi * FREQUENCIES
TUSTIN = 2.0 / STEP * np.tanh(0.5 * S * STEP)


def _response(system: System, entry: str = "error") -> np.ndarray:
    return system.transfer(FREQUENCIES)[:, 0, system.input_names.index(entry)]


def _oscillator(frequency: float, ratio: float = 0.0, feedthrough: float = 0.0) -> System:
    omega = 2.0 * np.pi * frequency
    A = np.array([[0.0, omega], [-omega, -2.0 * ratio * omega]])
    parts = np.array([[0.0], [omega]]), np.array([[1.0, 0.0]]), np.array([[-feedthrough]])
    return System(A, *parts, (Channel("u", "m"),), (Channel("pose", "m"),))


@pytest.mark.parametrize(("step", "s"), [(None, S), (STEP, TUSTIN)])
def test_pi_and_pid_have_their_frequency_response(step, s):
    """k_p + k_i/s + k_d s/(1 + s/w_f), with s as it is and as Tustin's rule has it."""
    np.testing.assert_allclose(_response(PI(0.3, 200.0).system(step)), 0.3 + 200.0 / s, **PLAIN)
    control = PID(0.3, 200.0, 2e-3, 1500.0)
    expected = 0.3 + 200.0 / s + 2e-3 * s / (1.0 + s / (2.0 * np.pi * 1500.0))
    np.testing.assert_allclose(_response(control.system(step)), expected, **PLAIN)


def test_laws_without_an_integral_part_have_no_integrator():
    """Otherwise a loop would show a pole at rest that nothing moves."""
    assert not len(PI(0.5).system().A)
    assert len(PID(0.5, 0.0, 1e-3, 500.0).system().A) == 1
    assert len(IntegralResonant(100.0, 2.0).system().A) == 1


def test_a_notch_is_as_deep_and_as_wide_as_stated():
    """Depth at its frequency, continuous and sampled; gain 1/sqrt(2) at two frequencies 2 zeta f apart whose product is f^2."""
    for step in (None, STEP):
        system = Notch(1110.9, 0.03, 0.4).system(step)
        gains = system.transfer(np.array([0.0, 1110.9, 5000.0 if step else 1e12]))[:, 0, 0]
        np.testing.assert_allclose(gains, [1.0, 0.03, 1.0], rtol=1e-8)
    half = 110.9 * (np.array([-0.3, 0.3]) + np.sqrt(1.0 + 0.09))
    gains = np.abs(Notch(110.9, 0.0, 0.3).system().transfer(half))
    np.testing.assert_allclose(gains, np.sqrt(0.5), rtol=1e-12)


def test_a_notch_of_a_mode_takes_its_poles_away():
    """N G is the oscillator with the notch's damping in place of the mode's."""
    product = notch_of_mode(110.9, 0.01, 0.6).system().transfer(FREQUENCIES) * _oscillator(110.9, 0.01).transfer(FREQUENCIES)
    np.testing.assert_allclose(product, _oscillator(110.9, 0.6).transfer(FREQUENCIES), rtol=1e-11)


@pytest.mark.parametrize("damping", [0.05, 0.2, 0.4, 0.8])
def test_integral_resonant_control_damps_as_the_literature_says(damping):
    """Poles of an undamped mode under it: ratio (w_p/w_z - 1)/2 at sqrt(w_p w_z), and that is the most over all gains."""
    control = resonant_law(110.9, damping)
    assert 0.5 / np.sqrt(1.0 - 1.0 / control.feedthrough) - 0.5 == pytest.approx(damping, rel=1e-12)
    pair = _damped(control)
    zeros = 110.9 / (1.0 + 2.0 * damping)
    assert abs(pair) == pytest.approx(2.0 * np.pi * np.sqrt(110.9 * zeros), rel=1e-7)
    ratios = [_ratio(_damped(IntegralResonant(control.gain * factor, control.feedthrough))) for factor in (0.7, 0.95, 1.0, 1.05, 1.4)]
    assert np.argmax(ratios) == 2
    assert ratios[2] == pytest.approx(damping, rel=1e-7)


def _damped(control: IntegralResonant) -> complex:
    """The oscillating pole of a mode under the law's positive feedback (tracking aside)."""
    parts = [_oscillator(110.9), control.system()]
    closed = connect(parts, {"u": {"command": 1.0}, "error": {}, "applied": {}}, (Channel("none", "m"),), ["pose"])
    return max(closed.poles, key=lambda pole: pole.imag)


def _ratio(pole: complex) -> float:
    return -pole.real / abs(pole)


def test_integral_resonant_control_is_an_integrator_around_a_fed_through_plant():
    """Q = k/(s + k d) around G has the poles of k/s around G - d."""
    control = IntegralResonant(600.0, 2.5)
    integrator = System(np.zeros((1, 1)), np.eye(1), 600.0 * np.eye(1), np.zeros((1, 1)), (Channel("pose", "m"),), (Channel("u", "m"),))
    first = connect([_oscillator(90.0, 0.01, 2.5), integrator], {}, (Channel("none", "m"),), ["pose"])
    parts = [_oscillator(90.0, 0.01), control.system()]
    second = connect(parts, {"u": {"command": 1.0}, "error": {}, "applied": {}}, (Channel("none", "m"),), ["pose"])
    np.testing.assert_allclose(np.sort_complex(first.poles), np.sort_complex(second.poles), rtol=1e-9)


@pytest.mark.parametrize("law", [PI(0.2, 300.0, 0.004), PID(0.2, 300.0, 1e-4, 900.0, 0.004), IntegralResonant(200.0, 2.0, 300.0, 0.004)])
def test_integrators_stop_where_the_actuator_stops(law):
    """Constant error e above a limit u: the integrator rests where u - command = -k_i T_t e, far from running away."""
    system, error, limit = law.system(STEP), 1e-6, 5e-6
    assert not np.any(system.D[:, 2])  # known only after the command
    state, gap = np.zeros(len(system.A)), 0.0
    for _ in range(3000):
        command = (system.C @ state + system.D @ [error, 0.0, gap])[0]
        state = system.A @ state + system.B @ [error, 0.0, gap]
        gap = min(command, limit) - command
    assert gap == pytest.approx(-300.0 * 0.004 * error, rel=1e-9)


def test_modal_loops_decouple_a_stage_of_massless_units():
    """Every loop an oscillator of static gain 1, and nothing crosses, by the mapped model."""
    stage = double_triangle()
    model, kinematics = mapped(stage), ideal(stage)
    found = modes(model)
    loops = modal_loops(coordinates(kinematics), found.platform_shapes[:, list(found.platform)])
    response = pose_plant(plant(model, kinematics, Hardware())).transfer(FREQUENCIES)
    seen = loops.sense @ response @ loops.drive
    oscillators = [_oscillator(each, 0.01).transfer(FREQUENCIES)[:, 0, 0] for each in found.platform_frequencies]
    expected = np.array(oscillators).T[:, :, None] * np.eye(6)
    np.testing.assert_allclose(seen, expected, atol=1e-9 * np.max(np.abs(expected)))


def test_loops_of_a_stage_are_in_metres_and_of_gain_one():
    """By the ideal stage, sense (R_a^-1 drive) is the unit matrix in all coordinates, for two motions as for six."""
    for stage in (double_triangle(), case("xy-stage")):
        given = coordinates(ideal(stage))
        shapes = np.random.default_rng(1).normal(size=(6, len(given.names)))
        for loops in (actuator_loops(given), platform_loops(given), modal_loops(given, shapes)):
            np.testing.assert_allclose(loops.sense @ given.back @ loops.drive, np.eye(len(loops.names)), atol=1e-12)


def test_the_loops_add_up_to_the_controller():
    """C(s) = drive diag(C_i N_i) sense, and the fed-forward strokes beside it."""
    given = coordinates(ideal(case("xy-stage")))
    loops = modal_loops(given, np.random.default_rng(2).normal(size=(6, 2)))
    laws, notches = (PI(0.2, 100.0), PID(0.1, 50.0, 1e-4, 800.0)), ((Notch(200.0),), ())
    ahead = np.array([[1.1, 0.2], [0.0, 0.9]])
    system = Decentralised(loops, laws, notches, ahead).system(STEP)
    assert system.input_names == ("error.x", "error.y", "reference.x", "reference.y", *(f"applied.{name}" for name in given.actuators))
    single = [_response(law.system(STEP)) for law in laws]
    single[0] = single[0] * Notch(200.0).system(STEP).transfer(FREQUENCIES)[:, 0, 0]
    diagonal = np.array(single).T[:, :, None] * np.eye(2)
    response = system.transfer(FREQUENCIES)
    np.testing.assert_allclose(response[:, :, :2], loops.drive @ diagonal @ loops.sense, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(response[:, :, 2:4], np.broadcast_to(ahead, (len(FREQUENCIES), 2, 2)), atol=1e-12)


@pytest.fixture(scope="module")
def given():
    """The shipped two-axis stage, sampled with a delay and lags."""
    stage = case("xy-stage")
    return plant(lumped(stage), ideal(stage), Hardware(rate=5e3, delay=130e-6), modes=5)


def test_regulator_and_observer_keep_their_poles_apart(given):
    """Poles of the closed loop are those of the regulator with its integrators and those of the observer (separation)."""
    model = pose_plant(given)
    control = lqg(model, given.coordinates, Weights(30.0, 0.1), Disturbances(1e-9, dict.fromkeys(given.gauges, 1e-11)))
    step, states = model.step, len(model.A)
    closed = loop(given, control.system(step)).system.poles
    A = np.block([[model.A, np.zeros((states, 2))], [-step * model.C, np.eye(2)]])
    B = np.vstack([model.B, -step * model.D])
    regulator = np.linalg.eigvals(A - B @ np.hstack([control.regulator, -control.integral]))
    expected = np.concatenate([regulator, np.linalg.eigvals(model.A - model.A @ control.observer @ model.C)])
    # multiple poles of the hold's registers lie at 0, where eigenvalues are known to a root of rounding only
    distance = np.abs(closed[:, None] - expected)
    assert np.max(np.min(distance, axis=1)) < 1e-3
    np.testing.assert_allclose(np.poly(closed)[:12], np.poly(expected)[:12], rtol=1e-7)


def test_fed_forward_strokes_bring_the_pose_without_the_integrators(given):
    """With F = (static gain)^-1 a reference is reached at rest, and neither integrators nor observer have anything to add."""
    model = pose_plant(given)
    static = model.transfer(np.array([0.0]))[0].real
    noise = Disturbances(1e-9, dict.fromkeys(given.gauges, 1e-11))
    control = lqg(model, given.coordinates, Weights(30.0), noise, np.linalg.inv(static))
    whole = loop(given, control.system(model.step)).system
    columns = [f"reference.{name}" for name in given.coordinates.names]
    found = select(whole, columns, [f"command.{name}" for name in given.actuators]).transfer(np.array([1e-3]))[0]
    np.testing.assert_allclose(found, np.linalg.inv(static), rtol=1e-3)
    last = np.eye(len(whole.A))[-2:]
    integrators = replace(select(whole, columns, ["error.x", "error.y"]), C=last, D=np.zeros((2, 2)))
    assert np.max(np.abs(integrators.transfer(np.array([1e-5]))[0])) < 1e-7 / (2.0 * np.pi * 30.0)


def test_what_was_applied_reaches_the_observer(given):
    """Saturated commands: the observer's pose follows the strokes applied, not those commanded."""
    model = pose_plant(given)
    control = lqg(model, given.coordinates, Weights(30.0), Disturbances(1e-9, dict.fromkeys(given.gauges, 1e-11)))
    system, states = control.system(model.step), len(model.A)
    columns = [system.input_names.index(f"applied.{name}") for name in given.actuators]
    np.testing.assert_allclose(system.B[:states, columns], model.B, atol=1e-15)
    assert not np.any(system.D[:, columns])


def test_renamed_law_is_the_same_law():
    """A law's channels are free to be called otherwise."""
    law = PI(0.5, 100.0).system()
    np.testing.assert_array_equal(rename(law, {"error": "e"}).transfer(FREQUENCIES), law.transfer(FREQUENCIES))


BAD = {
    "integral is -3 1/s": lambda: PI(0.1, -3.0),
    "proportional is -0.1": lambda: PID(-0.1, 3.0, 0.0, 100.0),
    "derivative filter without a positive corner (got 0 Hz)": lambda: PID(0.1, 3.0, 1e-3, 0.0),
    "half the sampling rate, 500 Hz": lambda: PID(0.1, 3.0, 1e-3, 700.0).system(1e-3),
    "not below half the sampling rate, 100 Hz": lambda: Notch(110.9).system(5e-3),
    "tracking rate 4000 1/s is too high": lambda: PI(0.0, 4000.0, 1.0 / 4000.0).system(1e-3),
    "depth out of range (got -0.5": lambda: Notch(100.0, -0.5),
    "feed-through must be positive (got -2)": lambda: IntegralResonant(100.0, -2.0),
    "damping must be positive (got 0)": lambda: resonant_law(100.0, 0.0),
    "1 control laws for 2 loops (x, y)": lambda: Decentralised(platform_loops(coordinates(ideal(case("xy-stage")))), (PI(),)),
    "wrong shape (got (1, 1), expected": lambda: Decentralised(
        platform_loops(coordinates(ideal(case("xy-stage")))), (PI(), PI()), (), np.eye(1)
    ),
    "wrong number of modes (got 3, expected 2: x, y)": lambda: modal_loops(coordinates(ideal(case("xy-stage"))), np.eye(6)[:, :3]),
    "not independent": lambda: modal_loops(coordinates(ideal(case("xy-stage"))), np.ones((6, 2))),
}


@pytest.mark.parametrize("said", BAD)
def test_bad_controllers_are_named_with_their_numbers(said):
    """What cannot be is refused, and both numbers are said."""
    with pytest.raises(DesignError) as error:
        BAD[said]()
    assert said in str(error.value)


def test_the_least_cost_of_samples_by_doubling_is_that_of_a_schur_form(given, monkeypatch):
    """Regulator and observer by both; they differ by the rounding of a Schur form."""
    model, noise = pose_plant(given), Disturbances(1e-9, dict.fromkeys(given.gauges, 1e-11))
    doubled = lqg(model, given.coordinates, Weights(30.0, 0.1), noise)
    monkeypatch.setattr("flexstage.control.controllers.lqg.DOUBLINGS", 0)
    found = lqg(model, given.coordinates, Weights(30.0, 0.1), noise)
    for own, other in ((doubled.regulator, found.regulator), (doubled.integral, found.integral), (doubled.observer, found.observer)):
        assert np.max(np.abs(own - other)) < 1e-9 * np.max(np.abs(other))


def test_what_lqg_cannot_do_is_said(given):
    """Another rate, no rate."""
    model, noise = pose_plant(given), Disturbances(1e-9, dict.fromkeys(given.gauges, 1e-11))
    with pytest.raises(DesignError, match=r"sampled every 0.0002 s \(expected sampled every 0.0001 s\)"):
        lqg(model, given.coordinates, Weights(30.0), noise).system(1e-4)
    with pytest.raises(DesignError, match="the model is continuous"):
        lqg(replace(model, step=None), given.coordinates, Weights(30.0), noise)
