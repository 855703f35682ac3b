"""The time left of planned jobs, by a clock that is made up: what is told is right within a factor of two."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.processes.progress import Step, pace, time_left
from flexstage.show.command.progress import ProgressBar
from tests.conftest import examples

SECONDS = st.floats(5.0, 300.0)
PHASES = st.lists(st.lists(SECONDS, min_size=1, max_size=6), min_size=1, max_size=4)


def run(phases: list[dict[str, float]], lanes: int) -> tuple[dict[str, tuple[float, float]], float]:
    """When each job begins and ends, given to whoever is free first, a phase after the other; and when all are done."""
    now, times = 0.0, dict[str, tuple[float, float]]()
    for phase in phases:
        free = [now] * lanes
        for name, seconds in phase.items():
            begun = free.index(min(free))
            times[name] = free[begun], free[begun] + seconds
            free[begun] += seconds
        now = max(free)
    return times, now


def at(instant: float, times: dict[str, tuple[float, float]]) -> tuple[dict[str, float], dict[str, float]]:
    """What was spent on jobs that are done at an instant, and what the running ones have had."""
    spent = {name: end - begun for name, (begun, end) in times.items() if end <= instant}
    return spent, {name: instant - begun for name, (begun, end) in times.items() if begun <= instant < end}


def named(phases: list[list[float]]) -> list[dict[str, float]]:
    return [{f"{number}.{job}": seconds for job, seconds in enumerate(phase)} for number, phase in enumerate(phases)]


@given(PHASES, st.integers(1, 4))
def test_a_plan_that_is_right_is_told_to_the_second(planned: list[list[float]], lanes: int) -> None:
    phases = named(planned)
    times, whole = run(phases, lanes)
    assert time_left(phases, {}, lanes=lanes) == pytest.approx(whole)
    for instant in (end for _, end in times.values()):
        told = time_left(phases, *at(instant, times), lanes)
        assert told == pytest.approx(whole - instant, abs=1e-6 * whole + 0.1 * sum(map(max, planned)))


@given(PHASES, st.floats(0.2, 5.0), st.integers(1, 3), st.integers(0, 2**32 - 1))
@examples(30, 500)
def test_another_machine_and_jobs_off_by_a_fifth_are_told_within_a_factor_of_two(
    planned: list[list[float]], machine: float, lanes: int, seed: int
) -> None:
    """From the first job's end on, as long as a third is left: what single jobs are off by weighs more at the end."""
    phases, random = named(planned), np.random.default_rng(seed)
    really = [{name: machine * seconds * random.uniform(0.8, 1.25) for name, seconds in phase.items()} for phase in phases]
    times, whole = run(really, lanes)
    first = min(end for _, end in times.values())
    for instant in np.linspace(first, 0.67 * whole, 7) if first < 0.67 * whole else ():
        told = time_left(phases, *at(float(instant), times), lanes)
        assert 0.5 <= told / (whole - instant) <= 2.0, (instant, told, whole)


def test_a_job_that_takes_long_slows_the_pace_before_it_ends() -> None:
    assert pace({"a": 10.0, "b": 10.0}, {}, {"a": 50.0}) == pytest.approx(50.5 / 10.5)
    assert time_left([{"a": 10.0, "b": 10.0}], {}, {"a": 50.0}) > 40.0


def test_the_bar_tells_of_the_whole_plan_what_each_computation_tells_of_its_own() -> None:
    shown = ProgressBar(None)
    shown.follow([{"a": 10.0}, {"b": 30.0}], 1)
    shown.step(Step("a", 1.0, 0.0, spent={"a": 20.0}))
    assert shown.left == pytest.approx(30.0 * 20.5 / 10.5)
    shown.step(Step("b", 0.0, 60.0, running={"b": 0.0, "c": 0.0}, planned={"b": 60.0, "c": 10.0}))
    assert shown.left == pytest.approx(70.0 * 20.5 / 10.5)
