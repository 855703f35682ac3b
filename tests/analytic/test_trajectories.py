"""Trajectories: closed forms, and the limits they state, found again by differences."""

from __future__ import annotations

import re

import numpy as np
import pytest
import scipy
from hypothesis import given
from hypothesis import strategies as st

from flexstage.analysis.workspace.polytope import reachable
from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.base.finding import DesignError
from flexstage.base.labelled import Matrix
from flexstage.control.trajectory.check import reach_findings, speed_findings
from flexstage.control.trajectory.path import Trajectory, reference
from flexstage.control.trajectory.pieces import join, smooth
from flexstage.control.trajectory.profile import Limits, profile
from flexstage.control.trajectory.raster import Raster
from flexstage.control.trajectory.sine import Sine
from flexstage.control.trajectory.spiral import Spiral
from flexstage.control.trajectory.step import Step
from flexstage.control.trajectory.table import Table, from_file

POSITIVE = st.floats(1e-3, 1e3)


def differences(trajectory: Trajectory, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest speeds and accelerations by differences of samples: never above the true ones, and close to them for fine samples."""
    step = times[1] - times[0]
    speeds = np.diff(trajectory.at(times), axis=0) / step
    return np.max(np.abs(speeds), axis=0), np.max(np.abs(np.diff(speeds, axis=0)), axis=0) / step


@given(POSITIVE, POSITIVE, POSITIVE, POSITIVE)
def test_profiles_keep_their_limits_and_arrive(distance, speed, acceleration, jerk):
    limits = Limits(speed, acceleration, jerk)
    move = profile(distance, limits)
    times = np.linspace(0.0, move.duration, 2001)
    assert move.at(times[-1:])[0, 0] == pytest.approx(distance, rel=1e-12)
    for order, limit in ((1, speed), (2, acceleration), (3, jerk)):
        assert np.max(np.abs(move.at(times, order))) <= limit * (1.0 + 1e-9)
    assert np.max(np.abs(move.at(times[[0, -1]], 1))) <= 1e-9 * speed
    assert np.all(np.diff(move.at(times)[:, 0]) >= -1e-12 * distance)


@given(POSITIVE, POSITIVE, POSITIVE, POSITIVE)
def test_profiles_take_the_least_time(distance, speed, acceleration, jerk):
    # Bang-bang: some limit is reached at every moment, so no profile is shorter. Jerk runs +j, 0, -j, 0, -j, 0, +j and rests only where
    # acceleration or speed is at its limit.
    move = profile(distance, Limits(speed, acceleration, jerk))
    middles = 0.5 * (move.knots[1:] + move.knots[:-1])
    reached = [np.abs(move.at(middles, order)[:, 0]) / limit for order, limit in ((1, speed), (2, acceleration), (3, jerk))]
    long = np.diff(move.knots) > 1e-6 * move.duration
    assert np.all(np.max(reached, axis=0)[long] >= 1.0 - 1e-6)


def test_jerk_alone_has_the_closed_form():
    move = profile(2.0, Limits(1e9, 1e9, 8.0))
    assert move.duration == pytest.approx(4.0 * (2.0 / 16.0) ** (1.0 / 3.0), rel=1e-14)


def test_smooth_moves_have_their_stated_extremes():
    move = join([(0.5, smooth(np.zeros(1), np.array([3.0]), 0.5))])
    times = np.linspace(0.0, 0.5, 20001)
    for order, most in ((1, 15.0 / 8.0 * 3.0 / 0.5), (2, 10.0 / 3.0**0.5 * 3.0 / 0.25)):
        assert np.max(np.abs(move.at(times, order))) == pytest.approx(most, rel=1e-7)


RASTERS = [
    Raster(length=20e-6, pitch=0.5e-6, lines=5, speed=1e-3, acceleration=10.0),
    Raster(length=20e-6, pitch=5e-6, lines=4, speed=1e-3, acceleration=1.0),  # turns wait for the slow step
    Raster(length=20e-6, pitch=0.5e-6, lines=1, speed=1e-3, acceleration=10.0),
]


def extremes(trajectory, end):
    """Largest speed and acceleration of each coordinate, by differences."""
    return differences(trajectory, np.linspace(0.0, end, 40_001))


@pytest.mark.parametrize("limits", [Limits(1e-4, 0.1, 200.0), Limits(1e-2, 1e-2, 200.0), Limits(1e-2, 1.0, 20.0)])
def test_steps_keep_to_their_limits_and_reach_one(limits):
    step = Step({"x": 3e-6, "y": -4e-6, "rz": 1e-5}, start=1e-3, limits=limits)
    speed, acceleration = extremes(step, 1.05 * step.duration)
    path, most = np.hypot(*speed[:2]), np.hypot(*acceleration[:2])
    assert path <= limits.speed * (1.0 + 1e-6)
    assert most <= limits.acceleration * 1.001
    assert path >= limits.speed * (1.0 - 2e-3) or most >= limits.acceleration * (1.0 - 2e-3) or limits.jerk < 100.0
    assert speed[2] / speed[0] == pytest.approx(10.0 / 3.0, rel=1e-9)


def test_sines_fade_in_to_their_speed():
    sine = Sine({"x": 1e-6, "y": 2e-6}, 37.0, fade=0.02)
    speed, acceleration = extremes(sine, 0.2)
    turning, rate = 2.0 * np.pi * 37.0, 15.0 / 8.0 / 0.02
    size = np.array([1e-6, 2e-6])
    assert np.all(speed >= size * turning * (1.0 - 2e-3))
    assert np.all(speed <= size * (turning + rate) * (1.0 + 1e-6))
    assert np.all(acceleration <= size * (turning**2 + 2.0 * turning * rate + 10.0 / 3.0**0.5 / 0.02**2) * 1.001)


def test_spirals_speed_up_gently():
    spiral, growth = Spiral(10e-6, 1e-6, 1e-3, ramp=2e-3), 1e-6 / (2.0 * np.pi)
    speed, acceleration = extremes(spiral, 1.05 * spiral.duration)
    assert np.all(speed <= 1e-3 * (1.0 + 1e-6))
    assert np.all(acceleration <= (2.0 * 1e-3**2 / growth + 1e-3 / 2e-3) * 1.001)


@pytest.mark.parametrize("raster", RASTERS)
def test_rasters_turn_within_their_acceleration(raster):
    speed, acceleration = extremes(raster, 1.05 * raster.duration)
    assert np.all(acceleration <= raster.acceleration * 1.001)
    assert speed[0] >= raster.speed * (1.0 - 2e-3)


@pytest.mark.parametrize("raster", RASTERS)
def test_rasters_pass_their_lines_at_even_speed(raster):
    for number, begin in enumerate(raster.line_starts):
        inside = begin + raster.length / raster.speed * np.linspace(0.0, 1.0, 7)
        way = raster.at(inside)
        sign = -1.0 if number % 2 else 1.0
        assert way[:, 0] == pytest.approx(sign * raster.length * np.linspace(-0.5, 0.5, 7), abs=1e-16)
        assert way[:, 1] == pytest.approx((number - 0.5 * (raster.lines - 1)) * raster.pitch * np.ones(7), abs=1e-16)
    assert raster.at(np.array([0.0, raster.duration])) == pytest.approx(np.zeros((2, 2)), abs=1e-18)
    reach = np.max(np.abs(raster.at(np.linspace(0.0, raster.duration, 20_001))[:, 0]))
    assert reach == pytest.approx(0.5 * raster.length + raster.overshoot, rel=1e-4)


def test_spirals_keep_their_pace_and_their_pitch():
    even = Spiral(10e-6, 1e-6, 2e-3)
    times = np.linspace(0.0, even.duration, 20_001)
    speed = np.linalg.norm(np.diff(even.at(times), axis=0), axis=1) / times[1]
    assert speed[100:] == pytest.approx(2e-3 * np.ones(len(speed) - 100), rel=1e-4)  # chords of a bent way
    way = even.at(np.linspace(0.0, even.duration, 2001))
    radius, angle = np.hypot(*way.T), np.unwrap(np.arctan2(way[:, 1], way[:, 0])[1:])
    assert np.diff(radius[1:]) == pytest.approx(1e-6 / (2.0 * np.pi) * np.diff(angle), abs=1e-15)
    assert radius[-1] == pytest.approx(10e-6, rel=1e-12)


def test_the_path_of_an_even_spiral_is_as_long_as_its_time():
    spiral, growth = Spiral(10e-6, 1e-6, 2e-3), 1e-6 / (2.0 * np.pi)
    times = spiral.duration * np.array([1e-4, 1e-3, 0.02, 0.3, 1.0])
    angles = np.hypot(*spiral.at(times).T) / growth
    lengths = [
        growth * scipy.integrate.quad(lambda angle: np.sqrt(1.0 + angle**2), 0.0, angle, epsabs=0.0, epsrel=1e-13)[0] for angle in angles
    ]
    assert lengths == pytest.approx(2e-3 * times, rel=1e-11)


def test_steps_keep_to_the_straight_path():
    step = Step({"x": 3e-6, "y": -4e-6}, start=0.5, limits=Limits(1e-4, 0.1, 200.0))
    way = step.at(np.linspace(0.0, 1.0, 501))
    assert way[:, 1] == pytest.approx(-4.0 / 3.0 * way[:, 0], abs=1e-20)
    assert np.hypot(*way[-1]) == pytest.approx(5e-6, rel=1e-12)


def test_what_the_strokes_do_not_reach_is_refused_with_numbers():
    span = StrokeLimits(("B1", "B2"), -1e-6 * np.ones(2), np.array([1e-6, 3e-6]))
    room = reachable(Matrix(np.array([[1.0, 0.05], [1.0, -0.05]]), ("B1", "B2"), ("x", "rz"), "1"), span)
    times = np.linspace(0.0, 1.0, 1001)
    asked = reference(Sine({"x": 2e-6}, 1.0), ("x", "rz"), times)
    (found,) = reach_findings(asked, times, room)
    assert re.search(r"from 0\.084 s on; at 0\.25 s, x = 2 um needs 2 times the stroke\. Multiply the trajectory by 0\.5,", str(found))
    assert not reach_findings(0.5 * asked, times, room)


def test_strokes_that_start_at_an_end_are_told_with_numbers():
    """A stack biased at its lowest voltage has no stroke downwards: a pose at rest needs none of it, a pose below needs infinitely more."""
    span = StrokeLimits(("B",), np.zeros(1), np.array([1e-6]))
    room = reachable(Matrix(np.eye(1), ("B",), ("x",), "1"), span)
    times = np.array([0.0, 1.0])
    (above,) = reach_findings(np.array([[0.0], [2e-6]]), times, room)
    assert "at 1 s, x = 2 um needs 2 times the stroke" in above.what
    (below,) = reach_findings(np.array([[0.0], [-1e-6]]), times, room)
    assert "at 1 s, x = -1 um needs inf times the stroke" in below.what
    assert below.advice.startswith("Multiply the trajectory by 0,")


def test_speed_is_compared_with_the_amplifiers():
    times = np.linspace(0.0, 1.0, 20_001)
    asked = reference(Sine({"x": 1e-6}, 10.0), ("x",), times)
    lever = Matrix(np.array([[2.0]]), ("B1",), ("x",), "1")
    most = 2.0 * 2.0 * np.pi * 10.0 * 1e-6
    assert not speed_findings(asked, times, lever, np.array([most]))
    found = speed_findings(asked, times, lever, np.array([0.5 * most]))
    assert found[0].where == "B1"
    assert "62.83 um/s" in found[0].what
    assert "Multiply the speed by 0.5" in found[0].advice


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time [s], x\n0, 0\n1, 2\n", 'x: wrong unit (got "", expected m)'),
        ("time [s], x [V]\n0, 0\n1, 2\n", 'x: wrong unit (got "V", expected m)'),
        ("time [V], x [um]\n0, 0\n1, 2\n", 'time: wrong unit (got "V", expected s)'),
        ("time [s], speed [um]\n0, 0\n1, 2\n", "no column is a coordinate"),
        ("x [um], y [um]\n0, 0\n1, 2\n", 'wrong first column (got "x"'),
        ("time [s], x [um]\n0, 0\n1, 2\n1, 3\n", "times must increase (got 1 s in row 3 after 1 s). Sort the rows"),
        ("time [s], x [um]\n0, 0\n1, \n2, 3\n", "x: the value in row 2 is not finite"),
    ],
)
def test_bad_tables_are_named(tmp_path, text, message):
    (tmp_path / "way.csv").write_text(text)
    with pytest.raises(DesignError) as caught:
        from_file(tmp_path / "way.csv")
    assert message in str(caught.value)


def test_unknown_coordinates_are_named():
    with pytest.raises(DesignError, match=r"trajectory: rx: unknown coordinate.*The loop's coordinates are x, y"):
        reference(Step({"rx": 1e-6}), ("x", "y"), np.zeros(1))
    with pytest.raises(DesignError, match="2 times"):
        Table(np.array([0.0, 1.0]), np.zeros((3, 1)), ("x",))
