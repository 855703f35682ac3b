"""The controller of a quick loop keeps what docs/loop.md promises of it: law, order, coordinates, sampling, peak."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from flexstage.cases.registry import case
from flexstage.control.controllers.decentralised import Decentralised, loop_systems
from flexstage.control.robustness.stability_margins import shifted_peaks
from flexstage.control.study.control import Control
from flexstage.control.study.resolve import ResolvedSetup, resolve
from flexstage.control.study.retained import control_and_modes
from flexstage.control.study.setup import ControllerSetup, LoopSetup
from flexstage.control.study.study import LoopStudy, loop_study
from flexstage.control.systems.closed import loop
from flexstage.control.tuning.outcome import outcome
from flexstage.control.tuning.search import field
from flexstage.control.tuning.view import view
from flexstage.control.tuning.weigh import merit
from flexstage.mechanism.mechanism import Mechanism
from tests.laws.test_retained_modes import random_stage

SINGLE = ("parallelogram", "voice-coil-stage")
STAGES = (*SINGLE, "tip-tilt")
ALLOWED = 10.0 ** (6.03 / 20.0)
"""Peak sensitivity of 6 dB, 2 to three digits."""


@cache
def default(name: str) -> LoopStudy:
    return loop_study(case(name), LoopSetup(controller=ControllerSetup(quick=True)))


def made_of(found: LoopStudy) -> Decentralised:
    assert isinstance(found.controller.made_of, Decentralised)
    return found.controller.made_of


def law_gain(law: object, s: np.ndarray) -> np.ndarray:
    """k_p + k_i/s, with T_d s / (1 + s / (2 pi f)) of a PID."""
    lead = getattr(law, "derivative", 0.0)
    return law.proportional + law.integral / s + (lead * s / (1.0 + s / (2.0 * np.pi * law.filter)) if lead else 0.0)


@pytest.mark.parametrize("name", STAGES)
def test_the_law_is_pi_on_stacks_and_pid_on_forces_sampled_by_tustin_with_notches(name) -> None:
    """Each loop's response is that of textbook terms, whatever the classes that made it: bilinear, notches prewarped."""
    found = default(name)
    step, turn = 1.0 / found.settled.rate, np.geomspace(1e-3, 3.0, 40)
    bilinear = 2.0 / step * 1j * np.tan(0.5 * turn)
    for single, system in zip(found.controller.loops.values(), loop_systems(made_of(found), step), strict=True):
        wanted = law_gain(single.law, bilinear)
        for notch in single.notches:
            own = 1j * np.tan(0.5 * turn) / np.tan(np.pi * notch.frequency * step)  # s / w
            wanted = wanted * (own**2 + 2.0 * notch.depth * notch.damping * own + 1.0) / (own**2 + 2.0 * notch.damping * own + 1.0)
        np.testing.assert_allclose(system.transfer(turn / (2.0 * np.pi * step))[:, 0, 0], wanted, rtol=1e-9)
        assert min(single.law.proportional, single.law.integral) > 0.0
        assert (getattr(single.law, "derivative", 0.0) > 0.0) == (name == "voice-coil-stage")


@pytest.mark.parametrize("name", STAGES)
def test_its_order_is_an_integrator_a_loop_and_what_filters_and_notches_add(name) -> None:
    found = default(name)
    leads = len(found.controller.loops) if name == "voice-coil-stage" else 0
    A = found.controller.system.A
    assert len(A) == len(found.controller.loops) + leads + 2 * len(found.controller.notches)
    integrators = np.abs(np.linalg.eigvals(A) - 1.0) < 1e-9
    assert np.count_nonzero(integrators) == len(found.controller.loops)


@pytest.mark.parametrize("name", STAGES)
def test_its_loops_are_the_platform_s_motions_one_sample_late(name) -> None:
    found = default(name)
    assert tuple(found.controller.loops) == found.plant.coordinates.names
    sense = made_of(found).loops.sense  # diagonal: turns in metres of the platform's size
    np.testing.assert_array_equal(sense, np.diag(np.diag(sense)))
    rate = found.settled.rate
    assert rate >= max(10e3, 10.0 * found.highest_platform_mode) * (1.0 - 1e-9)
    assert rate <= max(10e3, 2.5 * 10.0 * found.highest_platform_mode)
    assert found.plant.hardware.delay == pytest.approx(1.0 / rate, rel=1e-12)
    assert found.controller.system.step == pytest.approx(1.0 / rate, rel=1e-12)


def peak(name: str, *, integral: float = 1.0, gain: float = 1.0) -> float:
    """Peak of |S| with all modes as modelled and 2 % off; of a loop with another integral gain or another gain."""
    found = default(name)
    (law,), (notched,) = made_of(found).laws, loop_systems(made_of(found), 1.0 / found.settled.rate)
    seen = view(found.settled.plant, made_of(found).loops, 0.02)
    s = 2.0 / seen.step * 1j * np.tan(np.pi * seen.frequencies * seen.step)
    control = gain * notched.transfer(seen.frequencies)[:, 0, 0] * (1.0 + (integral - 1.0) * law.integral / s / law_gain(law, s))
    opened = [seen.loops.sense @ each.transfer(seen.frequencies) @ seen.loops.drive for each in seen.systems]
    assert len(opened) == 3
    return max(float(np.max(1.0 / np.abs(1.0 + each[:, 0, 0] * control))) for each in opened)


@pytest.mark.parametrize("name", SINGLE)
def test_it_is_as_fast_as_a_peak_of_6_db_allows(name) -> None:
    """The peak is reached; 5 % more gain break it; for PI, 10 % more integral gain does too."""
    assert default(name).stability.stable
    assert 0.97 * ALLOWED < peak(name) < ALLOWED
    assert peak(name, gain=1.05) > ALLOWED
    assert name != "parallelogram" or peak(name, integral=1.1) > ALLOWED


def test_strokes_are_corrected_for_lost_motion() -> None:
    """Commanded in open loop, the lumped stage comes to the pose itself, at rest."""
    for name in ("parallelogram", "tip-tilt"):
        found = default(name)
        stage = found.settled.plant
        still = view(stage, made_of(found).loops, 0.0).systems[0].transfer(np.array([1e-6]))[0]
        np.testing.assert_allclose(still @ found.controller.gains, np.eye(len(stage.coordinates.names)), atol=2e-3)


QUICK = {name: case(name) for name in SINGLE}
FULL = {"xy-stage": case("xy-stage"), **{f"random {seed}": random_stage(seed) for seed in (3, 24)}}


def tuned(stage: Mechanism, *, quick: bool) -> tuple[ResolvedSetup, Control]:
    given = resolve(stage, LoopSetup(controller=ControllerSetup(quick=quick)))
    return control_and_modes(given, given.plant.coordinates.strokes)[:2]


def worst_peaks(given: ResolvedSetup, control: Control) -> list[float]:
    """Exact peak sensitivity with all modes off by up to 2 %, and by up to 10 %."""
    closed = loop(given.plant, control.system)
    return [max(each.peak for each in shifted_peaks(closed, shifts)) for shifts in ((0.0, 0.01, 0.02), (0.05, 0.07, 0.1))]


@pytest.mark.parametrize(
    "stage",
    [
        *(pytest.param(stage, id=name) for name, stage in QUICK.items()),
        *(pytest.param(stage, id=name, marks=pytest.mark.full) for name, stage in FULL.items()),
    ],
)
def test_the_default_is_robust_to_shifted_modes_and_no_worse_than_the_plain_controller(stage) -> None:
    """By exact peaks, at shifts of its own; worse in what a balance is about, of plain controllers as robust as it."""
    given, found = tuned(stage, quick=False)
    near, far = worst_peaks(given, found)
    assert near <= 2.01
    assert np.isfinite(far)
    plain = tuned(stage, quick=True)[1]
    if np.isfinite(worst_peaks(given, plain)[1]):
        spec = found.tuning.spec
        offsets = (0.0, -0.02, 0.02, -0.05, 0.05, -0.1, 0.1)
        within = field(view(given.plant, made_of_loops(found), spec.spread, offsets), spec)
        merits = [merit(spec, outcome(within, each.system)) for each in (found, plain)]
        assert merits[0] >= merits[1] - 1e-3


def made_of_loops(control: Control):
    assert isinstance(control.made_of, Decentralised)
    return control.made_of.loops
