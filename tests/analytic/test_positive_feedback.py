"""Positive position and velocity feedback: poles where they are placed, the limit of stability, and what the literature's tunings reach."""

import numpy as np
import pytest

from flexstage.base.finding import DesignError
from flexstage.cases.parallelogram import parallelogram
from flexstage.control.controllers.positive_feedback import PositiveFeedback, place_poles
from flexstage.control.robustness.stability_margins import bandwidths, peaks
from flexstage.control.study.choices import ControllerKind, OfferedKind
from flexstage.control.study.control import make_controller
from flexstage.control.study.resolve import resolve
from flexstage.control.study.setup import ControllerSetup, LoopSetup
from flexstage.control.systems.closed import LoopBreak, loop


def poles_around(law, frequency, static):
    """Poles [1/s] of an undamped mode of that static gain under the law's feedback alone."""
    w = 2.0 * np.pi * frequency
    inner = law.system()
    A, B, C = inner.A, inner.B[:, [1]], inner.C
    mode = np.array([[0.0, 1.0], [-(w**2), 0.0]])
    entry, seen = np.array([[0.0], [static * w**2]]), np.array([[1.0, 0.0]])
    return np.linalg.eigvals(np.block([[mode, entry @ C], [B @ seen, A]]))


@pytest.mark.parametrize("damping", [0.05, 0.2, 0.4])
@pytest.mark.parametrize("static", [0.5, 1.0])
def test_velocity_and_position_feedback_places_all_four_poles(damping, static):
    found = poles_around(place_poles(130.0, damping, static), 130.0, static)
    wanted = 260.0 * np.pi * (-damping + 1j * np.array([1.0, 1.0, -1.0, -1.0]))
    assert np.poly(found) == pytest.approx(np.real(np.poly(wanted)), rel=1e-9)


def test_position_feedback_is_stable_up_to_the_static_gain():
    """Fanson and Caughey: b g < 1, whatever the frequencies."""
    for frequency in (40.0, 130.0, 400.0):
        for share, stable in ((0.999, True), (1.001, False)):
            law = PositiveFeedback(share / 0.7, frequency, 0.5)
            assert bool(np.max(poles_around(law, 130.0, 0.7).real) < 0.0) is stable


def test_resonant_control_follows_as_far_as_published():
    """490 Hz of a resonance at 934 Hz (Fleming, Aphale and Moheimani, IEEE Trans. Nanotechnol. 9 (2010) 438), within a peak of S of 2."""
    for kind in (ControllerKind.RESONANT, OfferedKind("ppf")):
        given = resolve(parallelogram(), LoopSetup(controller=ControllerSetup(kind=kind)))
        closed = loop(given.plant, make_controller(given, given.plant.coordinates.strokes).system)
        assert bandwidths(closed).tracking[0] > 490.0 / 934.0 * given.highest
        assert peaks(closed, LoopBreak.POSE).sensitivity.value <= 2.0


def test_what_cannot_be_is_said():
    with pytest.raises(DesignError, match=r"frequency must be positive \(got -3\)"):
        PositiveFeedback(0.5, -3.0, 0.5)
    with pytest.raises(DesignError, match="not below half the sampling rate"):
        PositiveFeedback(0.5, 600.0, 0.5).system(1e-3)
