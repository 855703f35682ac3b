"""Optimisation of one objective within ranges and limits, from several starts."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.processes.threads import one_thread
from flexstage.studies.optimisation.problem import OptimisationProblem
from flexstage.studies.optimisation.result import Contradiction, Optimum, Rounded, Start
from flexstage.studies.optimisation.rounding import round_to_steps
from flexstage.studies.optimisation.search.binding import binding
from flexstage.studies.optimisation.search.contradiction import contradictions
from flexstage.studies.optimisation.search.problem import SPARE, Problem
from flexstage.studies.optimisation.search.search import Trace, run_searches, search
from flexstage.studies.optimisation.setting import Setting, setting
from flexstage.studies.optimisation.values import Point
from flexstage.studies.sweeps.definition import Study

_ALIKE = 1e-4

Progress = Callable[[str], None]
"""Function that is called with a text: the current task and the number of evaluated designs."""


@check_arguments
@one_thread
def optimise(study: Study, definition: OptimisationProblem, progress: Progress | None = None, *, contradictory: int = 6) -> Optimum:
    """Find the best design within the variables' ranges that meets all limits.

    From every start, a sequence of convex models with exact derivatives is solved. The convex models represent the frequencies of
    neighbouring modes as eigenvalues of a matrix; the modes may therefore be repeated or cross. The method is local; `Optimum.agreeing`
    counts the starts that end at an equally good design. If no design meets all limits, at most `contradictory` sets of contradicting
    limits are found. A keyboard interrupt ends the search with the best design so far. Raises `DesignError` for a study that cannot be
    optimised.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> found = optimise(*leaf_study())
    >>> found.agreeing, [each.name for each in found.binding]
    (2, ['stroke.x at least 18 um'])
    """
    if len(definition.objectives) != 1:
        raise refuse("optimise", f"needs one objective (got {len(definition.objectives)})", "Use `pareto_front` for two objectives")
    begun = time.monotonic()
    set_up = setting(study, definition)
    problem, begins = set_up.problem, set_up.starts()
    counted = Count(progress, "searching")
    traces = [Trace() for _ in begins]
    interrupted = _search_all(set_up, begins, traces, counted)
    point = best_of(problem, traces)
    against, near, broken = (), None, interrupted
    if not broken:
        against, near, interrupted = _conclude(set_up, point, traces, counted, contradictory)
    starts = tuple(_start(set_up, begin, trace, point) for begin, trace in zip(begins, traces, strict=True))
    return Optimum(
        study=study,
        definition=definition,
        limits=set_up.kept,
        before=set_up.before,
        point=point,
        starts=starts,
        binding=() if point is None or broken else binding(set_up, problem, point),  # only for an optimum
        rounded=near,
        contradictions=against,
        idle=set_up.idle,
        evaluated=1 + counted.done + (0 if near is None else near.tried),
        seconds=time.monotonic() - begun,
        interrupted=interrupted,
    )


def _search_all(set_up: Setting, begins: Array, traces: list[Trace], counted: Count) -> bool:
    """Search from all starts; return whether it was interrupted. The traces keep the results."""
    try:
        run_searches([search(set_up.problem, start, trace) for start, trace in zip(begins, traces, strict=True)], set_up.values, counted)
    except KeyboardInterrupt:
        return True
    return False


def _conclude(
    set_up: Setting, point: Point | None, traces: list[Trace], counted: Count, sets: int
) -> tuple[tuple[Contradiction, ...], Rounded | None, bool]:
    """Limits that contradict where there is no design, else the design rounded; whether that was interrupted."""
    try:
        if point is not None:
            counted.about = "rounding"
            return (), round_to_steps(set_up, set_up.problem, point), False
        counted.about = "contradictory limits"
        ends = [trace.point.shares for trace in traces if trace.point is not None]
        return contradictions(set_up, ends, counted, most=sets), None, False
    except KeyboardInterrupt:
        return (), None, True


class Count:
    """Counts evaluated designs and reports their number."""

    def __init__(self, progress: Progress | None, about: str) -> None:
        self.progress, self.about, self.done = progress, about, 0

    def __call__(self, more: int) -> None:
        """Count `more` further designs."""
        self.done += more
        if self.progress is not None:
            self.progress(f"{self.about}: {self.done} designs")


def best_of(problem: Problem, traces: list[Trace]) -> Point | None:
    """Select the best feasible design of all searches.

    >>> best_of(Problem((), ()), []) is None
    True
    """
    points = [point for trace in traces for point in trace.history if problem.excess(point) <= SPARE]
    return min(points, key=problem.worth, default=None)


def _start(set_up: Setting, begin: Array, trace: Trace, best: Point | None) -> Start:
    problem, unit = set_up.problem, set_up.definition.objectives[0].measure.quantity.si
    if trace.point is None:
        return Start(
            begin,
            begin,
            np.nan,
            np.nan,
            trace.evaluated,
            converged=False,
            history=np.zeros((0, 2)),
            agrees=False,
            unit=unit,
            reason=trace.reason,
        )
    ended = best_of(problem, [trace]) or trace.point
    history = np.array([[point.values[0], problem.violation(point)] for point in trace.history])
    agrees = (
        best is not None
        and problem.excess(ended) <= SPARE
        and problem.worth(ended) - problem.worth(best) <= _ALIKE * max(1.0, abs(problem.worth(best)))
    )
    return Start(
        begin, ended.shares, float(ended.values[0]), problem.violation(ended), trace.evaluated, trace.converged, history, agrees, unit
    )
