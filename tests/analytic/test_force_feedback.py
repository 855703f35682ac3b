"""Force feedback in the legs: closed forms of Preumont, poles by an independent eigenvalue solve, and what stiffness it costs."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy

from flexstage.base.finding import DesignError
from flexstage.cases.registry import case
from flexstage.control.damping.damped_plant import close_damping, describe_damping, with_series_stiffness
from flexstage.control.damping.force_feedback import ForceFeedback, most_damping
from flexstage.control.damping.legs import legs, pair_zeros
from flexstage.control.damping.sampled import sample_legs
from flexstage.control.example import integral
from flexstage.control.noise import disturbance_response, noise_budget
from flexstage.control.plant_models.electronics import AmplifierSettings, sampling_chain
from flexstage.control.plant_models.plants import plant
from flexstage.control.plant_models.reduction import reduce_modes, resonances
from flexstage.control.show.tables import _damping_tables as loop_tables_of_damping
from flexstage.control.study.control import make_controller
from flexstage.control.study.resolve import resolve
from flexstage.control.study.runs import runs
from flexstage.control.study.setup import KINDS, AmplifierSetup, AxisAmplitudes, ControllerSetup, DampingSetup, LoopSetup, StepMotion
from flexstage.control.study.study import loop_study
from flexstage.control.systems.closed import loop
from flexstage.mechanism.store import dumps, loads
from flexstage.models.ideal import ideal
from flexstage.models.linear.eigen import eigen
from flexstage.models.lumped import lumped

ONE_LEG = """
format = "flexstage 1"
name = "a block on one stack and a spring"
[materials.steel]
density = "7850 kg/m^3"
young = "200 GPa"
poisson = 0.3
[damping]
law = "modal"
ratio = 1e-9
[parts.stack]
kind = "piezo"
stroke = "15 um"
stiffness = "2 N/um"
length = "20 mm"
diameter = "10 mm"
[parts.coil]
kind = "spring"
diagonal = ["{guide} N/um", "0 N/um", "0 N/um", "0 N m/rad", "0 N m/rad", "0 N m/rad"]
[sensors.probe]
range = "100 um"
[bodies.platform]
solids = {{ block = {{ shape = "block", material = "steel", size = ["40 mm", "40 mm", "40 mm"] }} }}
[links]
leg = {{ joins = ["ground", "platform"], part = "stack", at = ["0 mm", "0 mm", "0 mm"], along = "x" }}
guide = {{ joins = ["ground", "platform"], part = "coil", at = ["0 mm", "0 mm", "0 mm"], along = "x" }}
[gauges]
S = {{ gauge = "probe", body = "platform", pose = {{ at = ["20 mm", "0 mm", "0 mm"] }}, positive = "opens" }}
"""


def damped_by(stage, law, **given):
    """The plant of a stage's lumped model without clock, with the inner loops closed, and what they do."""
    model = lumped(stage)
    found = legs(stage, model)
    bare = plant(model, ideal(stage), sampling_chain(stage, **given), links=tuple(each.sensed for each in found))
    felt = with_series_stiffness(bare, found)
    closed = close_damping(bare, law, felt)
    return model, felt, bare, closed


def nodal_poles(model, legs, law):
    """Poles [1/s] by one descriptor of all nodal coordinates: M q'' + D q' + K q = sum b k u, u = G (g q - u) of every leg."""
    K, M = model.stiffness_matrix, model.inertia_matrix
    size, order = len(K), len(law.denominator) - 1
    inverse, shapes = scipy.linalg.eigh(M, K)
    moving = inverse > 1e-9 * inverse[-1]
    omega, shapes = inverse[moving] ** -0.5, shapes[:, moving] * inverse[moving] ** -0.5
    D = M @ shapes @ np.diag(2.0 * model.damping.ratio * omega) @ shapes.T @ M
    whole, even, unit = 2 * size + order * len(legs), np.diag(K) ** -0.5, omega[0]  # all numbers of one size: small poles stay exact
    A, E = np.zeros((whole, whole)), np.eye(whole)
    A[:size, size : 2 * size] = np.eye(size)
    A[size : 2 * size, :size] = -K * even * even[:, None]
    A[size : 2 * size, size : 2 * size] = -D * even * even[:, None] * unit
    E[size : 2 * size, size : 2 * size] = M * even * even[:, None] * unit**2
    bottom, top = law.denominator / law.denominator[0], law.numerator / law.denominator[0]
    powers = unit ** np.arange(1.0, order + 1.0)
    for number, leg in enumerate(legs):
        stretch = np.asarray(model.stiffness[leg.link].operator)[0] * even
        axial = np.asarray(model.stiffness[leg.link].law)[0, 0]
        at, reads = 2 * size + order * number, np.zeros(order)
        reads[order - len(top) :] = top
        A[size : 2 * size, at : at + order] += axial * np.outer(stretch, reads / powers)
        A[at, :size] += stretch * axial / leg.stiffness
        A[at, at : at + order] += (-bottom[1:] - axial / leg.stiffness * reads) / powers
        A[at + 1 : at + order, at : at + order - 1] = np.eye(order - 1)
    poles = unit * scipy.linalg.eigvals(A, E)
    return poles[np.isfinite(poles) & (np.abs(poles) < 1e7)]


@pytest.mark.parametrize("gain", [700.0, 7000.0])
def test_a_leg_keeps_half_of_its_stiffness_below_the_first_gain_of_one(gain):
    """|G| = g w / (w^2 + a^2) rises through 1 at a^2 / g but for (a / g)^2; without the second high pass it is below g / a everywhere."""
    law = ForceFeedback(gain, 4.0)
    passed = np.abs(law.at(2j * np.pi * law.kept_below))
    assert passed == pytest.approx(1.0, abs=2.0 * (8.0 * np.pi / gain) ** 2)
    assert (replace(law, order=1).kept_below, replace(law, order=1, gain=8.0).kept_below) == (0.0, np.inf)


@pytest.mark.parametrize("guide", [0.7, 1.0, 20.0])
def test_one_leg_reaches_its_closed_form(guide):
    """(w - z)/(2 z) at w (w/z)^(1/2), by the whole plant."""
    stage = loads(ONE_LEG.format(guide=guide))
    model, felt, bare, _ = damped_by(stage, ForceFeedback(1.0, 1e-3, order=1))
    pairs = pair_zeros(model, felt)
    place = int(np.argmax(pairs.frequencies / pairs.others))
    w, z = pairs.frequencies[place], pairs.others[place]
    assert w / z == pytest.approx(np.sqrt((2.0 + guide) / guide), rel=1e-7)

    def least(gain):
        law = ForceFeedback(float(gain), 1e-4 * z, order=1)
        poles = close_damping(bare, law, felt).system.poles
        pair = poles[(poles.imag > 1e-3 * np.abs(poles)) & (np.abs(poles) < 2.5 * np.pi * w) & (np.abs(poles) > 1.8 * np.pi * z)]
        return -np.max(-pair.real / np.abs(pair), initial=0.0)

    best_gain = 2.0 * np.pi * w * np.sqrt(w / z)
    best = scipy.optimize.minimize_scalar(least, bounds=(0.5 * best_gain, 1.5 * best_gain), method="bounded")
    wanted = most_damping(w, z)
    assert -best.fun == pytest.approx(wanted, rel=1e-3)
    assert best.x == pytest.approx(best_gain, rel=0.05)


STAGES = ["double-triangle-a", "double-triangle-refitted", "xy-stage", "bridge", "hexapod", "tip-tilt", "tip-tilt-four"]
STAGES += ["three-rrr", "stewart", "scott-russell", "scanner", "pointing-stage"]


def full_of(names):
    return [pytest.param(name, marks=pytest.mark.full) for name in names]


@pytest.mark.parametrize("name", ["parallelogram", "double-triangle", *full_of(STAGES)])
def test_poles_of_stages_are_those_of_an_independent_solve(name):
    stage = case(name)
    law = ForceFeedback(900.0, 2.0, lag=20e3)
    model, felt, _, closed = damped_by(stage, law)
    wanted, found = nodal_poles(model, felt, law), closed.system.poles
    distance = np.min(np.abs(found[:, None] - wanted[None, :]), axis=0)
    assert len(wanted) > 20
    assert np.max(distance / np.abs(wanted)) < 1e-6


KEEP = ["double-triangle-a", "double-triangle-refitted", "stewart", "scott-russell", "pointing-stage"]


@pytest.mark.parametrize("name", ["parallelogram", "double-triangle", "xy-stage", *full_of(KEEP)])
def test_modes_apart_are_damped_as_if_alone(name):
    """Within 10 % where modes lie further apart than their damping and keep their shape without the stacks; repeated ones count as one."""
    found = resolve(case(name), LoopSetup(damping=DampingSetup(ratio=0.04))).damping
    gained = [each for each in found.modes if each.alone > 0.005]
    assert gained
    for each in gained:
        others = [abs(other.frequency / each.frequency - 1.0) for other in gained]
        if min((gap for gap in others if gap > 1e-3), default=1.0) > each.damped_ratio:
            assert each.damped_ratio - each.ratio == pytest.approx(each.alone, rel=0.1), each


@pytest.mark.parametrize("name", ["scanner", *full_of(["bridge", "tip-tilt", "hexapod"])])
def test_to_first_order_modes_are_damped_by_their_strain_energy_in_the_legs(name):
    """g/(2 w) times its share, also where modes change their shape without the stacks, and z of one mode does not tell it alone.

    Modes that symmetry repeats are damped alike, and are no neighbours of each other, whether or not rounding tells them apart.
    """
    law = ForceFeedback(1.0, 1e-3, order=1)
    model, felt, _, closed = damped_by(case(name), law)
    found, poles, compared = eigen(model), closed.system.poles, 0
    for value, shape in zip(found.values, found.shapes.T, strict=True):
        w, share = np.sqrt(value), 0.0
        for leg in felt:
            axial = float(np.asarray(model.stiffness[leg.link].law)[0, 0])
            share += (axial * float(np.asarray(model.stiffness[leg.link].operator)[0] @ shape)) ** 2 / (leg.stiffness * value)
        near = np.abs(np.sqrt(found.values) / w - 1.0)
        if share > 0.02 and np.min(near[near > 1e-9], initial=1.0) > 1e-2:
            pole = poles[np.argmin(np.abs(poles - w * (1j - model.damping.ratio)))]
            gained = -pole.real / np.abs(pole) - model.damping.ratio
            assert gained == pytest.approx(0.5 * share / w, rel=1e-2), (name, w / (2.0 * np.pi))
            compared += 1
    assert compared >= 2


def test_stiffness_at_rest_is_that_of_legs_with_what_is_left_of_theirs():
    stage = case("double-triangle")
    model = lumped(stage)
    for order in (1, 2):
        law = ForceFeedback(300.0, 4.0, order)
        _, felt, bare, _ = damped_by(stage, law)
        bare = reduce_modes(bare, resonances(bare) >= 0.01)
        closed = close_damping(bare, law, felt)
        told = describe_damping(bare, closed, law, felt, pair_zeros(model, felt))
        K = model.stiffness_matrix.copy()
        for leg in felt:
            stretch, axial = np.asarray(model.stiffness[leg.link].operator)[0], leg.stiffness
            left = 1.0 / (1.0 + law.gain / (2.0 * np.pi * law.corner)) if order == 1 else 1.0
            K -= (1.0 - left) * axial * np.outer(stretch, stretch)
        rows = [[each.name for each in model.outputs].index(f"platform.{name}") for name in told.coordinates]
        seen = model.output[rows]
        soft, stiff = (np.diag(seen @ np.linalg.solve(matrix, seen.T)) for matrix in (K, model.stiffness_matrix))
        assert told.left_at_rest == pytest.approx(stiff / soft, rel=1e-6)
        assert np.all(told.softest <= told.left_at_rest + 1e-12)


def test_a_slow_amplifier_bounds_the_gain_and_says_so():
    asked = LoopSetup(damping=DampingSetup(gain=2e4, delay=1e-3))
    with pytest.raises(DesignError, match=r"unstable \(growth rate"):
        resolve(case("double-triangle"), asked)
    lagging = damped_by(case("parallelogram"), ForceFeedback(500.0, 5.0), amplifiers=AmplifierSettings(bandwidth=3e3))[3]
    assert lagging.system.growth < 0.0


def test_strain_gauges_in_the_legs_sense_what_sensors_of_force_do():
    """On the stack, with its stroke taken off, and on the hinge in series: the same poles; their noise is the gauge's times the link."""
    text = dumps(case("parallelogram")).replace("[gauges]\n", '[gauges]\nG = { gauge = "strain", link = "B/LINK" }\n')
    text = text.replace(
        "[sensors.probe]", '[sensors.strain]\nkind = "strain"\nrange = "1 um"\nnoise_density = "1e-3 nm/Hz^0.5"\n\n[sensors.probe]'
    )
    bare = resolve(case("parallelogram"), LoopSetup(damping=DampingSetup(gain=900.0)))
    for link in ("pzt", "front"):
        stage = loads(text.replace("B/LINK", f"B/{link}"))
        found = resolve(stage, LoopSetup(damping=DampingSetup(gain=900.0, gauges=("G",))))
        axial = np.asarray(lumped(stage).stiffness[f"B/{link}"].law)[0, 0]
        assert found.damping.sensed[0].noise == pytest.approx(1e-12 * axial)
        assert found.plant.heard == {"sensed.B": found.damping.sensed[0].noise}
        closed = loop(found.plant, integral(found.plant, 20.0))
        budget = noise_budget(closed, {}, (10.0, 1000.0), ("relative.x",))
        lines = np.geomspace(10.0, 1000.0, 20_001)
        gain = np.abs(disturbance_response(closed, ("sensed.B",), ("relative.x",), lines)[:, 0, 0]) ** 2
        share = budget.squares[0, [source.channel for source in budget.sources].index("sensed.B")]
        np.testing.assert_allclose(share, np.trapezoid(gain * found.damping.sensed[0].noise ** 2, lines), rtol=1e-3)
        if link == "pzt":
            assert found.damping.modes[0].damped_ratio == pytest.approx(bare.damping.modes[0].damped_ratio, rel=1e-9)


def test_what_is_added_is_the_law_of_the_tension():
    """added / stroke = x / (1 - x), x = G T / k of the tension T per stroke without the inner loop."""
    law = ForceFeedback(700.0, 4.0)
    _, (leg,), bare, closed = damped_by(case("parallelogram"), law)
    lines = np.geomspace(0.3, 3e3, 25)
    place = bare.system.output_names.index(f"{leg.sensed}.fx"), bare.system.input_names.index("B")
    opened = law.at(2j * np.pi * lines) * bare.system.transfer(lines)[:, place[0], place[1]] / leg.stiffness
    seen = closed.system.output_names.index("added.B"), closed.system.input_names.index("B")
    np.testing.assert_allclose(closed.system.transfer(lines)[:, seen[0], seen[1]], opened / (1.0 - opened), rtol=1e-9)


@pytest.mark.parametrize(("size", "held"), [(0.3e-6, True), (4e-6, False)])
def test_both_loops_are_held_against_the_amplifiers_speed(size, held):
    asked = LoopSetup(
        controller=ControllerSetup(integral=600.0),
        amplifier=AmplifierSetup(slew=1800.0),
        damping=DampingSetup(ratio=0.4),
        trajectory=StepMotion(amplitude=AxisAmplitudes(x=size)),
    )
    given = resolve(case("parallelogram"), asked)
    control = make_controller(given, given.plant.coordinates.strokes)
    (run,) = runs(given, control, loop(given.plant, control.system))
    use = run.legs["B"]
    assert use.slew == pytest.approx(1800.0 * 38e-6 / 140.0)
    assert use.is_held == held
    assert any("the simulation does not apply these limits" in each.what for each in run.warnings) != held


def test_a_stack_biased_at_an_end_uses_what_it_has_on_the_other_side():
    """Without a stroke below the bias, the load of the amplifier is the largest stroke above it, although the stack starts at its limit."""
    stage = loads(dumps(case("parallelogram")).replace('bias = "50 V"', 'bias = "-20 V"'))
    smooth = StepMotion(amplitude=AxisAmplitudes(x=1e-6), speed=1e-3, acceleration=1.0, jerk=1e3)
    asked = LoopSetup(controller=ControllerSetup(integral=600.0), damping=DampingSetup(ratio=0.4), trajectory=smooth, seconds=0.02)
    given = resolve(stage, asked)
    (run,) = runs(given, make_controller(given, given.plant.coordinates.strokes), loop(given.plant, integral(given.plant, 600.0)))
    both = run.simulated.given[:, 0] + run.simulated.motion("added.B")
    assert both[0] == 0.0
    assert run.legs["B"].largest == pytest.approx(np.max(both))
    assert run.legs["B"].stroke_share == pytest.approx(np.max(both) / 38e-6)


LIMITED = {
    "ppf": AmplifierSetup(slew=1800.0),
    "pvf": AmplifierSetup(current=3e-3),
}


@pytest.mark.parametrize("kind", ["ppf", pytest.param("pvf", marks=pytest.mark.full)])
def test_positive_feedback_keeps_within_the_amplifiers_limits(kind):
    """Slew, or the current that charges the stack's capacitance: what is given never changes faster, and the loop settles all the same."""
    asked = LoopSetup(
        rate=40e3,
        controller=ControllerSetup(kind=KINDS.parse(kind, "kind")),
        amplifier=LIMITED[kind],
        trajectory=StepMotion(amplitude=AxisAmplitudes(x=5e-6)),
    )
    given = resolve(case("parallelogram"), asked)
    control = make_controller(given, given.plant.coordinates.strokes)
    (run,) = runs(given, control, loop(given.plant, control.system))
    most = given.plant.hardware.amplifiers["B"].slew * given.step
    assert run.simulated.slewing[0] > 0.0
    assert np.max(np.abs(np.diff(run.simulated.given[:, 0]))) <= most * (1.0 + 1e-9)
    assert abs(run.simulated.true_error[-1, 0]) < 0.02 * 5e-6


@pytest.mark.parametrize("order", [1, 2])
def test_a_computers_law_is_the_bilinear_one(order):
    law, rate = ForceFeedback(900.0, 3.0, order), 40e3
    _, felt, _, _ = damped_by(case("double-triangle"), law)
    made = sample_legs(law, felt, rate, 4)
    tensions = np.random.default_rng(2).normal(size=(300, len(felt)))
    top, bottom = scipy.signal.bilinear(law.numerator, law.denominator, rate)
    wanted = scipy.signal.lfilter(top, bottom, tensions, axis=0) / [each.stiffness for each in felt]
    np.testing.assert_allclose(made.strokes(tensions), wanted, rtol=0.0, atol=1e-9 * np.max(np.abs(wanted)))


def sampled_pole(bare, leg, law, step):
    """The pole of the leg's mode where a computer senses, computes a sample late and holds, exactly: by the matrix exponential."""
    system = bare.system
    row, column = system.output_names.index(f"{leg.sensed}.fx"), system.input_names.index(leg.actuator)
    assert system.D[row, column] == 0.0
    stage = scipy.signal.cont2discrete((system.A, system.B[:, [column]], system.C[[row]], np.zeros((1, 1))), step)
    held = scipy.signal.tf2ss(*scipy.signal.bilinear(law.numerator, law.denominator, 1.0 / step))
    F, G, H, J = held[0], held[1], held[2] / leg.stiffness, held[3] / leg.stiffness
    n, m = len(system.A), len(F)
    whole = np.block([[stage[0], stage[1], np.zeros((n, m))], [J @ stage[2], np.zeros((1, 1)), H], [G @ stage[2], np.zeros((m, 1)), F]])
    return np.log(scipy.linalg.eigvals(whole).astype(complex)) / step


def test_a_computers_delay_and_hold_are_those_of_one_and_a_half_samples():
    """The damped mode as told by the continuous plant; what it is off falls with the square of the step."""
    amplifiers, off = AmplifierSettings(bandwidth=5e3), []
    for rate in (50e3, 100e3, 200e3):
        law = ForceFeedback(3000.0, 19.0)
        _, (leg,), bare, told = damped_by(case("parallelogram"), replace(law, delay=1.5 / rate), amplifiers=amplifiers)
        poles = told.system.poles
        mode = poles[np.argmin(np.abs(poles - 2j * np.pi * 1700.0))]
        found = sampled_pole(bare, leg, law, 1.0 / rate)
        off.append(np.min(np.abs(found - mode)) / np.abs(mode))
    assert off[0] < 1e-3
    np.testing.assert_allclose(np.divide(off[:-1], off[1:]), 4.0, rtol=0.15)


def test_lost_stiffness_is_told_relative_to_the_stiffness_without_feedback():
    """The fraction is one of dynamic stiffnesses at the same frequency, not one of the static stiffness."""
    study = loop_study(case("parallelogram"), LoopSetup(controller=ControllerSetup(integral=300.0), damping=DampingSetup(ratio=0.3)))
    (told,) = [each.what for each in study.warnings if "stiffness" in each.what]
    share = f"{100.0 * study.damping.softest[0]:.3g} %"
    assert told == f"force feedback reduces the platform's dynamic stiffness to {share} along x, at {study.damping.softest_at[0]:.3g} Hz"


def test_modes_that_force_feedback_hardly_damps_are_said_to_be_omitted():
    """The table has only the modes that the legs can damp by more than 1 %, and says so."""
    found = resolve(case("parallelogram"), LoopSetup(controller=ControllerSetup(integral=300.0), damping=DampingSetup(ratio=0.3))).damping
    still = replace(found, modes=(*found.modes, replace(found.modes[0], most=0.01)))
    table = loop_tables_of_damping(SimpleNamespace(damping=still))[0]
    assert len(table.rows) == len(found.modes)
    assert "Modes with a maximum damping of 1 % or less are omitted." in table.notes


def test_damping_that_is_not_reached_is_said():
    """At the rate of the loop itself, delay and hold turn a mode at a sixth of it by 90 degrees: nothing is left to damp it."""
    for rate, reached in ((None, 0.3), (10e3, 0.01)):
        study = loop_study(
            case("parallelogram"), LoopSetup(controller=ControllerSetup(quick=True), damping=DampingSetup(ratio=0.3, rate=rate))
        )
        assert study.damping.reached == pytest.approx(reached, rel=0.15)
        told = [each.where for each in study.warnings if "of a dominant mode too low" in each.what]
        assert told == (["damping.ratio"] if rate else [])


BAD = {
    "no actuator has a stack in its leg": ("voice-coil-stage", DampingSetup()),
    r"damping\.gauges Q: unknown strain gauge\. None is defined": ("parallelogram", DampingSetup(gauges=("Q",))),
    "ratio and gain are both specified": ("parallelogram", DampingSetup(ratio=0.3, gain=100.0)),
    r"damping\.rate: must be a multiple of the loop's sampling rate \(got 25000 Hz, 2\.5 times 10000 Hz\)\. Use 20000 Hz": (
        "parallelogram",
        DampingSetup(rate=25e3),
    ),
}


@pytest.mark.parametrize("told", BAD)
def test_what_cannot_be_is_said(told):
    name, asked = BAD[told]
    with pytest.raises(DesignError, match=told):
        resolve(case(name), LoopSetup(damping=asked))
