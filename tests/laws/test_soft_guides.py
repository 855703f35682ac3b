"""Loops of soft guides and free masses: a guide that a loop overrules bounds nothing, and a search is no worse than the tuner's loop."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy

import flexstage as fs
from flexstage.base.number import Table
from flexstage.control.controllers.loops import platform_loops
from flexstage.control.controllers.lqg import Disturbances
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.plant_models.electronics import Hardware, Sensor
from flexstage.control.plant_models.plants import Plant
from flexstage.control.study.choices import ControllerKind
from flexstage.control.study.control import Control, make_controller
from flexstage.control.study.resolve import resolve
from flexstage.control.study.setup import ControllerSetup, GoalSetup, LoopSetup
from flexstage.control.systems.sampling import discretise
from flexstage.control.systems.system import System
from flexstage.control.tuning import search
from flexstage.control.tuning.find import find
from flexstage.control.tuning.laws import LQG_FAMILY, PID_FAMILY
from flexstage.control.tuning.objective import TuningObjective
from flexstage.control.tuning.outcome import outcome
from flexstage.control.tuning.search import field, variants
from flexstage.control.tuning.spec import Tuning, TuningSpec
from flexstage.control.tuning.tune import tune
from flexstage.control.tuning.view import view
from flexstage.control.tuning.weigh import merit
from flexstage.models.linear.model import Channel
from tests.conftest import FULL

MASS = 1.3
RATIO = 0.012
NOISE = 6e-11


def guided(stiffness: float, rate: float = 8e3, late: float = 1.0) -> tuple[Plant, float]:
    """A mass on a spring, pushed by a force, `late` samples; and the force [N] per metre of a loop's command, none of it by the spring."""
    omega = np.sqrt(stiffness / MASS)
    unit = stiffness or MASS
    A, B = np.array([[0.0, 1.0], [-(omega**2), -2.0 * RATIO * omega]]), np.array([[0.0], [1.0 / MASS]])
    outputs = (Channel("gap.S", "m"), Channel("relative.x", "m"))
    system = System(A, B, np.array([[1.0, 0.0], [1.0, 0.0]]), np.zeros((2, 1)), (Channel("F", "N"),), outputs)
    one = np.eye(1)
    coordinates = Coordinates(("x",), ("m",), ("F",), ("S",), one, unit * one, one / unit, 0.1, ("m",), ("N",))
    hardware = Hardware(rate, late / rate, Table({}), Table({"S": Sensor(noise_density=NOISE)}))
    mode, ratio = np.array([omega / (2.0 * np.pi)]), np.array([RATIO])
    return Plant(system, ("mode1", "mode1'"), coordinates, hardware, mode, ratio, 0, "a mass", "test"), unit


def pid(stiffness: float, goal: TuningSpec, late: float = 1.0) -> tuple[Tuning, np.ndarray]:
    """The tuned loop, with k_p [N/m], k_i [N/(m s)], k_d [N s/m], where it passes 1 [Hz] and its peak of S."""
    one, unit = guided(stiffness, late=late)
    found = tune(one, platform_loops(one.coordinates), goal)
    (law,) = found.controller.laws
    gains = unit * np.array([law.proportional, law.integral, law.derivative])
    return found, np.array([*gains, found.bandwidth, found.judgement.peak])


@pytest.mark.parametrize(("late", "sensitivity"), [(1.0, 2.0), pytest.param(0.3, 1.7, marks=pytest.mark.full), (2.5, 2.2)])
def test_a_guide_far_below_the_crossing_changes_nothing(late, sensitivity):
    """From a free mass to 1e4 N/m: gains in newtons per metre, crossing and peak of S stay within 2 %."""
    _, free = pid(0.0, TuningSpec(PID_FAMILY, None, sensitivity), late)
    for stiffness in (1e-3, 1.0, 1e2, 1e4) if FULL else (1e-3, 1e4):
        found, numbers = pid(stiffness, TuningSpec(PID_FAMILY, None, sensitivity), late)
        assert guided(stiffness)[0].frequencies[0] < 0.1 * found.bandwidth
        np.testing.assert_allclose(numbers, free, rtol=0.02)


def test_a_free_mass_by_closed_forms():
    """Zero-order hold of 1/(m s^2), one sample late, P = T^2 (z + 1)/(2 m z (z - 1)^2): crossing, peak of S, and stability by roots.

    A grid of PID laws on it, two zeros apart, of Tustin's rule too, reaches no more than a fifth more.
    """
    found, (*gains, crossing, peak) = pid(0.0, TuningSpec(PID_FAMILY, None, 2.0, 0.0))
    step, corner = 1.0 / 8e3, found.controller.laws[0].filter
    frequencies = np.geomspace(0.5, 3.99e3, 3000)
    left = _sensitivity(np.array(gains), corner, step, frequencies)
    assert np.max(np.abs(left)) == pytest.approx(peak, rel=0.005)
    assert abs(1.0 / _sensitivity(np.array(gains), corner, step, np.array([crossing]))[0] - 1.0) == pytest.approx(1.0, rel=0.01)
    assert np.max(np.abs(_roots(np.array(gains), corner, step))) < 1.0
    reached = []
    for far in np.geomspace(0.7, 1.6, 18) * crossing:
        for zero in (0.2, 0.3, 0.4):
            for slow in (0.05, 0.1, 0.2):
                law = _two_zeros(2.0 * np.pi * far, zero, slow)
                gain = np.abs(1.0 / _sensitivity(law, corner, step, np.array([far]))[0] - 1.0)
                if np.max(np.abs(_roots(law / gain, corner, step))) < 1.0:
                    reached += [far] * bool(np.max(np.abs(_sensitivity(law / gain, corner, step, frequencies))) <= 2.0)
    assert max(reached) < 1.2 * crossing


def _two_zeros(crossing: float, zero: float, slow: float) -> np.ndarray:
    """k_p, k_i, k_d of (1 + s/(zero w)) (1 + slow w/s)."""
    return np.array([1.0 + slow / zero, slow * crossing, 1.0 / (zero * crossing)])


def _polynomials(gains: np.ndarray, corner: float, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Numerator and denominator of C P in z, from s = 2 (z - 1)/(T (z + 1))."""
    proportional, integral, derivative = gains
    up, down = np.array([1.0, 1.0]), 2.0 / step * np.array([1.0, -1.0])
    lag = np.polyadd(up, down / (2.0 * np.pi * corner))
    above = np.polyadd(np.polymul(np.polyadd(proportional * down, integral * up), lag), derivative * np.polymul(down, down))
    below = np.polymul(down, lag)
    return step**2 / (2.0 * MASS) * np.polymul(above, [1.0, 1.0]), np.polymul(below, np.poly([0.0, 1.0, 1.0]))


def _roots(gains: np.ndarray, corner: float, step: float) -> np.ndarray:
    return np.roots(np.polyadd(*_polynomials(gains, corner, step)))


def _sensitivity(gains: np.ndarray, corner: float, step: float, frequencies: np.ndarray) -> np.ndarray:
    above, below = _polynomials(gains, corner, step)
    z = np.exp(2j * np.pi * frequencies * step)
    return 1.0 / (1.0 + np.polyval(above, z) / np.polyval(below, z))


def test_what_is_tried_depends_on_rate_and_delay_alone():
    """The same mass at twice the rate, as many samples late: twice the crossing, the same peak."""
    once, twice = (tune(one, platform_loops(one.coordinates), TuningSpec(PID_FAMILY)) for one, _ in (guided(1.0), guided(1.0, 16e3)))
    assert twice.bandwidth == pytest.approx(2.0 * once.bandwidth, rel=0.005)
    assert twice.judgement.peak == pytest.approx(once.judgement.peak, rel=0.005)


STAGE = """
format = "flexstage 1"
name = "soft guide"
gravity = ["0 m/s^2", "0 m/s^2", "0 m/s^2"]
damping = {{ law = "modal", ratio = 0.02 }}
[parts.guide]
kind = "spring"
diagonal = ["{stiffness} N/m", "80 N/um", "80 N/um", "8 N m/mrad", "8 N m/mrad", "8 N m/mrad"]
free = ["x"]
[parts.motor]
kind = "voice_coil"
force_constant = "14 N/A"
peak_current = "6 A"
[bodies.platform]
mass = "0.8 kg"
inertia = {{ xx = "4e-3 kg m^2", yy = "4e-3 kg m^2", zz = "4e-3 kg m^2" }}
[links]
guide = {{ joins = ["ground", "platform"], part = "guide", at = ["0 mm", "0 mm", "0 mm"], along = "x", bends = "z" }}
motor = {{ joins = ["ground", "platform"], part = "motor", at = ["0 mm", "0 mm", "0 mm"], along = "x" }}
[sensors.scale]
kind = "gauge"
range = "10 mm"
resolution = "2 nm"
[gauges]
S = {{ gauge = "scale", body = "platform", pose = {{ at = ["40 mm", "0 mm", "0 mm"], along = "-x" }}, positive = "opens" }}
"""


def _of_stage(stiffness: float, **controller) -> Control:
    given = resolve(fs.loads(STAGE.format(stiffness=stiffness)), LoopSetup(controller=ControllerSetup(**controller)))
    return make_controller(given, given.plant.coordinates.strokes)


def test_a_stage_on_a_soft_guide_is_tuned_as_on_none():
    """The usual controller of a stage by its file: gains times the guide's stiffness, from 1e-3 to 1e4 N/m."""
    tuned = [_of_stage(stiffness, quick=True) for stiffness in (1e-3, 10.0, 1e4)]
    numbers = []
    for found, stiffness in zip(tuned, (1e-3, 10.0, 1e4), strict=True):
        law = found.loops["x"].law
        gains = stiffness * np.array([law.proportional, law.integral, law.derivative])
        numbers.append([*gains, found.bandwidth, found.tuning.judgement.peak])
    np.testing.assert_allclose(numbers[1:], [numbers[0]] * 2, rtol=0.02)
    assert tuned[0].bandwidth > 450.0  # 0.2 of the rate turns by 108 deg; PID with two equal zeros keeps 6 dB up to a quarter of that


@cache
def _rejects_to(kind: ControllerKind, aim: TuningObjective | None, stiffness: float) -> float:
    """Where |S| first passes 1 [Hz], by the response of the plant times that of the law; not by the search's own numbers."""
    goal = None if aim is None else GoalSetup(objective=aim)
    found = _of_stage(stiffness, kind=kind, goal=goal)
    single, frequencies = found.loops["x"], np.geomspace(1e-3, 4e3, 4000)
    step = 1e-4
    z = np.exp(2j * np.pi * frequencies * step)
    s = 2.0 / step * (z - 1.0) / (z + 1.0)
    law = single.law
    response = law.proportional + law.integral / s
    if kind is ControllerKind.PID:
        response = response + law.derivative * s / (1.0 + s / (2.0 * np.pi * law.filter))
    for notch in single.notches:
        response = response * notch.system(step).transfer(frequencies)[:, 0, 0]
    omega = np.sqrt(stiffness / 0.8)
    modal = System(
        np.array([[0.0, 1.0], [-(omega**2), -0.04 * omega]]), np.array([[0.0], [omega**2]]), np.eye(2)[:1], np.zeros((1, 1)),
        (Channel("u", "m"),), (Channel("y", "m"),),
    )  # fmt: skip
    plant = discretise(modal, step, step).transfer(frequencies)[:, 0, 0]
    left = np.abs(1.0 / (1.0 + response * plant))
    return float(frequencies[np.argmax(left >= 1.0)])


@pytest.mark.parametrize(
    ("kind", "aim", "stiffness"),
    [
        (ControllerKind.PID, TuningObjective.REJECTION, 50.0),
        pytest.param(ControllerKind.PID, TuningObjective.BALANCE, 50.0, marks=pytest.mark.full),
        pytest.param(ControllerKind.PID, TuningObjective.REJECTION, 2e3, marks=pytest.mark.full),
        pytest.param(ControllerKind.PI, TuningObjective.BALANCE, 50.0, marks=pytest.mark.full),
    ],
)
def test_a_search_rejects_as_far_as_the_tuner_it_begins_from(kind, aim, stiffness):
    assert _rejects_to(kind, aim, stiffness) >= 0.999 * _rejects_to(kind, None, stiffness)


def test_a_search_that_finds_nothing_better_returns_what_it_began_from(monkeypatch):
    """Also where what it finds is worse."""
    one, _ = guided(100.0)
    loops = platform_loops(one.coordinates)
    plain = tune(one, loops, TuningSpec(PID_FAMILY))
    worse = replace(plain.controller.laws[0], proportional=0.1 * plain.controller.laws[0].proportional)
    known = search.known_loops
    monkeypatch.setattr(
        "flexstage.control.tuning.find.advance",
        lambda within, controller: known(within, replace(controller, laws=(worse,))),
    )
    found = find(one, loops, TuningSpec(PID_FAMILY, objective=TuningObjective.REJECTION))
    assert found.controller.laws == plain.controller.laws
    assert "no better controller was found" in found.reason


@pytest.mark.parametrize("late", [1.0, 0.4])
def test_linear_quadratic_control_does_not_depend_on_a_soft_guide(late):
    """Weights are searched over twelve decades: crossing and peak of S from a free mass to 1e3 N/m, within 2 %.

    At 1e4 N/m the mode is near the observer's own frequency, a tenth of the crossing: 4 %.
    """
    found = []
    for stiffness in (0.0, 1e-3, 1e3, 1e4):
        one, _ = guided(stiffness, late=late)
        noise = Disturbances(1e-9, {"S": NOISE})
        tuned = tune(one, platform_loops(one.coordinates), TuningSpec(LQG_FAMILY, expected=noise))
        found.append([tuned.bandwidth, tuned.judgement.peak])
        assert tuned.judgement.peak <= 2.0
        assert tuned.judgement.growth < -0.2 * tuned.bandwidth  # observers too are not slower by decades than the loop
        assert tuned.controller.tracking == pytest.approx(1.0 / (2.0 * np.pi * tuned.bandwidth), rel=0.02)
    np.testing.assert_allclose(found[1:3], [found[0]] * 2, rtol=0.02)
    np.testing.assert_allclose(found[3], found[0], rtol=0.04)


def test_linear_quadratic_control_reaches_as_far_as_a_grid_of_riccati_solutions():
    """Regulators and observers by scipy's discrete equation, on a model made here: none of the grid within 6 dB crosses higher."""
    stiffness, step = 100.0, 1.0 / 8e3
    one, _ = guided(stiffness)
    tuned = tune(one, platform_loops(one.coordinates), TuningSpec(LQG_FAMILY, None, 2.0, 0.0, expected=Disturbances(1e-9, {"S": NOISE})))
    omega = np.sqrt(stiffness / MASS)
    flow = np.array([[0.0, 1.0, 0.0], [-(omega**2), -2.0 * RATIO * omega, 1.0 / MASS], [0.0, 0.0, 0.0]])
    held = scipy.linalg.expm(flow * step)
    A, B, C = np.zeros((3, 3)), np.array([[0.0], [0.0], [1.0]]), np.array([[1.0, 0.0, 0.0]])
    A[:2] = held[:2]
    both, entry = np.zeros((4, 4)), np.vstack([B, [[0.0]]])
    both[:3, :3], both[3, 0], both[3, 3] = A, step, 1.0
    frequencies = np.geomspace(1.0, 3.99e3, 900)
    z = np.exp(2j * np.pi * frequencies * step)
    reached = [0.0]
    for weight in np.geomspace(1e10, 1e15, 11):
        for slow in (30.0, 300.0):
            K = _gain(both, entry, np.diag([weight, 0.0, 0.0, weight * slow**2]), np.eye(1))
            for trust in (1e-3, 1.0, 1e3):
                L = _gain(A.T, C.T, trust * np.outer(held[:3, 2] * [1.0, 1.0, 0.0], held[:3, 2] * [1.0, 1.0, 0.0]), 1e-10 * np.eye(1)).T
                inner = np.block([[A - L @ C - B @ K[:, :3], -B @ K[:, 3:]], [np.zeros((1, 3)), np.eye(1)]])
                fed, out = np.vstack([L, [[step]]]), K
                whole = np.block([[A, -B @ out], [fed @ C, inner]])
                if np.max(np.abs(np.linalg.eigvals(whole))) >= 1.0:
                    continue
                plant = C @ np.linalg.solve(z[:, None, None] * np.eye(3) - A, B)
                open_loop = (plant * (out @ np.linalg.solve(z[:, None, None] * np.eye(4) - inner, fed)))[:, 0, 0]
                if np.max(1.0 / np.abs(1.0 + open_loop)) <= 2.0:
                    reached.append(float(frequencies[np.argmax(np.abs(open_loop) < 1.0)]))
    assert max(reached) > 30.0
    assert tuned.bandwidth >= max(reached)


def _gain(A: np.ndarray, B: np.ndarray, cost: np.ndarray, effort: np.ndarray) -> np.ndarray:
    """(R + B' X B)^-1 B' X A."""
    found = scipy.linalg.solve_discrete_are(A, B, cost + 1e-24 * np.eye(len(A)), effort)
    return np.linalg.solve(effort + B.T @ found @ B, B.T @ found @ A)


@pytest.mark.full
@pytest.mark.parametrize("aim", list(TuningObjective))
def test_weights_by_search_serve_the_aim_no_worse_than_those_they_begin_from(aim):
    """By the merit of both, from responses."""
    one, _ = guided(100.0)
    loops, noise = platform_loops(one.coordinates), Disturbances(1e-9, {"S": NOISE})
    plain = tune(one, loops, TuningSpec(LQG_FAMILY, expected=noise))
    spec = TuningSpec(LQG_FAMILY, objective=aim, expected=noise)
    found = find(one, loops, spec)
    seen = view(one, loops, 0.02, tuple(dict.fromkeys(each.offset for each in variants(spec))))
    within = field(seen, spec, fast=plain.bandwidth)
    merits = [merit(spec, outcome(within, each.controller.system(seen.step))) for each in (plain, found)]
    assert merits[1] >= merits[0]
    assert found.judgement.peak <= 2.0
