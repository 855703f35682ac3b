"""Pareto fronts of two objectives: one objective is bounded, the other is optimised."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from flexstage.analysis.assessment.requirements import Sense
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.processes.threads import one_thread
from flexstage.studies.optimisation.problem import OptimisationProblem
from flexstage.studies.optimisation.result import Contradiction, Front
from flexstage.studies.optimisation.search.contradiction import contradictions
from flexstage.studies.optimisation.search.optimum import Count, Progress, best_of
from flexstage.studies.optimisation.search.problem import SPARE, Problem, Side
from flexstage.studies.optimisation.search.search import Trace, run_searches, search
from flexstage.studies.optimisation.setting import Setting, setting
from flexstage.studies.optimisation.values import Point
from flexstage.studies.sweeps.definition import Study

_KEEP = 1e-6
"""Largest relative loss of an objective while the other is improved at an end of the front."""


@check_arguments
@one_thread
def pareto_front(study: Study, definition: OptimisationProblem, progress: Progress | None = None) -> Front:
    """Compute the Pareto front of two objectives within ranges and limits (epsilon-constraint method: Haimes, Lasdon & Wismer 1971).

    Each objective is optimised alone. Then the other objective is optimised, while the objective optimised first keeps its value. The two
    resulting designs are the ends of the front. Between these ends, objective 1 is optimised under equally spaced bounds on objective 2,
    with a search from each end design. Dominated designs are left out. An interruption ends the search; the result then contains the
    designs found so far.
    """
    if len(definition.objectives) != 2:
        raise refuse("optimise", f"a front needs two objectives (got {len(definition.objectives)})", "Use `optimise` for one objective")
    begun = time.monotonic()
    set_up = setting(study, definition)
    counted = Count(progress, "ends of the front")
    found = list[Point]()
    against: tuple[Contradiction, ...] = ()
    interrupted = False
    try:
        found, traces = _ends(set_up, counted)
        if found:
            counted.about = "front"
            found += _between(set_up, found, counted)
        else:
            counted.about = "contradictory limits"
            against = contradictions(set_up, [trace.point.shares for trace in traces if trace.point is not None], counted)
    except KeyboardInterrupt:
        interrupted = True
    return Front(
        study=study,
        definition=definition,
        limits=set_up.kept,
        before=set_up.before,
        points=tuple(non_dominated(set_up, found)),
        contradictions=against,
        idle=set_up.idle,
        evaluated=1 + counted.done,
        seconds=time.monotonic() - begun,
        interrupted=interrupted,
    )


def _ends(set_up: Setting, counted: Count) -> tuple[list[Point], list[Trace]]:
    """The best design in each objective; nothing without a feasible design."""
    ends = list[Point]()
    all_traces = list[Trace]()
    for number in (0, 1):
        problem = Problem((set_up.objective(number),), set_up.problem.limits)
        traces = run_searches([search(problem, start) for start in set_up.starts()], set_up.values, counted)
        best = best_of(problem, traces)
        all_traces += traces
        if best is None:
            return [], traces
        other = Problem((set_up.objective(1 - number),), (*problem.limits, _bound(set_up, number, best)))
        again = run_searches([search(other, best.shares)], set_up.values, counted)
        ends.append(best_of(other, again) or best)
    return ends, all_traces


def _bound(set_up: Setting, number: int, point: Point) -> Side:
    """An objective bounded by its value in a design, with a tolerance of a millionth."""
    aim, value = set_up.objective(number), float(point.values[number])
    give = _KEEP * (abs(value) or aim.scale)
    return replace(aim, limit=value - give if aim.sense is Sense.AT_LEAST else value + give)


def _between(set_up: Setting, ends: list[Point], counted: Count) -> list[Point]:
    """Designs between the ends."""
    first, last = (float(end.values[1]) for end in ends)
    levels = np.linspace(first, last, set_up.definition.points)[1:-1]
    if abs(last - first) <= _KEEP * set_up.scale(1):
        return []  # one design is best in both
    problems = [
        Problem((set_up.objective(0),), (*set_up.problem.limits, replace(set_up.objective(1), limit=float(level)))) for level in levels
    ]
    walks = [search(problem, end.shares) for problem in problems for end in ends]
    traces = run_searches(walks, set_up.values, counted)
    found = [best_of(problem, traces[2 * number : 2 * number + 2]) for number, problem in enumerate(problems)]
    return [point for point in found if point is not None]


def non_dominated(set_up: Setting, points: Iterable[Point]) -> list[Point]:
    """Select the non-dominated points, sorted from the best to the worst in the first objective."""
    points = list(points)
    worth = np.array([[set_up.objective(number).at(point) for number in (0, 1)] for point in points]).reshape(-1, 2)
    kept = [number for number in range(len(points)) if not _is_dominated(worth, number)]
    return [points[number] for number in sorted(kept, key=lambda each: tuple(worth[each]))]


def _is_dominated(worth: Array, number: int) -> bool:
    """Whether another design is as good in both and better in one, beyond rounding; of equal ones the first remains."""
    own = worth[number]
    better = np.all(worth <= own + SPARE, axis=1) & np.any(worth < own - 10.0 * SPARE, axis=1)
    same = np.all(np.abs(worth - own) <= 10.0 * SPARE, axis=1)
    return bool(np.any(better) or np.any(same[:number]))
