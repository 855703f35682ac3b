"""A search from one design: steps of the convex model within a trust region, until convergence."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field

import numpy as np

from flexstage.base.number import Array
from flexstage.studies.optimisation.search.problem import Problem, Weights, lagrangian
from flexstage.studies.optimisation.search.step import Bounds, Step, step
from flexstage.studies.optimisation.values import Point

_RADIUS, _SMALLEST = 0.25, 1e-8
_PENALTY, _MOST = 10.0, 1e5
_GAIN, _KEPT = 1e-9, 2e-9
_CURVED = 0.75
"""Ratio of actual and predicted gain below which an infeasible step gets a second-order correction."""
_CURVATURE, _CURVATURES = 0.1, (1e-4, 1e4)
STEPS = 80
"""Largest number of steps of a search."""

Evaluate = Callable[[Array], "list[Point | str]"]
"""Function that evaluates s designs. It returns the point, or the reason for the failure, of each design."""

Walk = Generator[Array, "Point | str", "Trace"]
"""A search as a generator: it yields a design to evaluate, receives its point or the reason for its failure, and returns a trace."""


@dataclass(eq=False)
class Trace:
    """History of a search: the best `point`, its multipliers `weights`, the `history` of accepted points, the number of `evaluated` points.

    `converged` is true if no change improves the objective to first order. `reason` explains a missing point.
    """

    point: Point | None = None
    weights: tuple[Weights, ...] = ()
    history: list[Point] = field(default_factory=list)
    evaluated: int = 0
    converged: bool = False
    reason: str = ""


def search(problem: Problem, start: Array, trace: Trace | None = None, *, enough: float = -np.inf) -> Walk:
    """Search from a `start` (n,), given by fractions of the ranges.

    The objective is the largest constraint value c of its sides (see `Side`). The search ends early if the objective is at most `enough`.
    The method is sequential quadratic programming with an exact penalty for the largest violation (Fletcher & de la Maza, Mathematical
    Programming 43 (1989) 235). The Lagrangian's curvature is estimated by damped BFGS updates (Powell 1978). The multipliers of modes are
    transferred to the next design by the overlap of mode shapes. `trace` can be read during the search.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> from flexstage.studies.optimisation.setting import setting
    >>> found = setting(*leaf_study())
    >>> trace, = run_searches([search(found.problem, found.before.shares)], found.values)
    >>> trace.converged, trace.point.shares.round(3).tolist()
    (True, [0.733])
    """
    trace = Trace() if trace is None else trace
    found = yield start
    trace.evaluated += 1
    if isinstance(found, str):
        trace.reason = found
        return trace
    point, hessian, radius, penalty = found, _CURVATURE * np.eye(len(start)), _RADIUS, _PENALTY
    trace.point, fresh = point, True
    trace.history.append(point)
    while len(trace.history) <= STEPS and trace.evaluated < 2 * STEPS:
        if problem.worth(point) <= enough:
            break
        move, penalty = _penalty_step(problem, point, hessian, Bounds(radius, penalty))
        trace.weights = move.weights
        if move.gain <= _GAIN and not move.held:
            trace.converged = True
            break
        if radius < _SMALLEST or move.gain <= 0.0:
            break
        answer = yield np.clip(point.shares + move.change, 0.0, 1.0)
        trace.evaluated += 1
        ratio = _ratio(problem, point, answer, move, penalty)
        if isinstance(answer, Point) and ratio < _CURVED and problem.violation(answer) > max(move.excess, _KEPT):
            again = step(problem, point, hessian, Bounds(radius, penalty), answer)
            second = yield np.clip(point.shares + again.change, 0.0, 1.0)
            trace.evaluated += 1
            other = _ratio(problem, point, second, move, penalty)
            answer, ratio = (second, other) if other > ratio else (answer, ratio)
        radius = _update_radius(radius, ratio, move)
        if isinstance(answer, str) or ratio <= 1e-4:
            continue
        hessian = _bfgs_update(problem, hessian, point, answer, move.weights, fresh=fresh)
        point, fresh = answer, False
        trace.point = point
        trace.history.append(point)
    return trace


def _merit(problem: Problem, point: Point, penalty: float) -> float:
    return problem.worth(point) + penalty * problem.violation(point)


def _ratio(problem: Problem, before: Point, after: Point | str, move: Step, penalty: float) -> float:
    """Actual over predicted gain of a step; -1 without a design."""
    return -1.0 if isinstance(after, str) else (_merit(problem, before, penalty) - _merit(problem, after, penalty)) / move.gain


def _penalty_step(problem: Problem, point: Point, hessian: Array, bounds: Bounds) -> tuple[Step, float]:
    """A step that removes at least a tenth of the removable violation, with the penalty raised as needed."""
    radius, penalty = bounds.radius, bounds.penalty
    move = step(problem, point, hessian, bounds)
    if move.excess <= _KEPT or penalty >= _MOST:
        return move, penalty
    now = problem.violation(point)
    least = step(problem, point, hessian, Bounds(radius, _MOST)).excess
    while now - move.excess < 0.5 * (now - least) and penalty < _MOST:
        penalty *= 10.0
        move = step(problem, point, hessian, Bounds(radius, penalty))
    return move, penalty


def _update_radius(radius: float, ratio: float, move: Step) -> float:
    if ratio < 0.25:
        return (0.25 if ratio < 0.0 else 0.5) * min(radius, float(np.max(np.abs(move.change))))
    return min(1.0, 2.0 * radius) if ratio > 0.7 and move.held else radius


def _bfgs_update(problem: Problem, hessian: Array, before: Point, now: Point, weights: tuple[Weights, ...], *, fresh: bool) -> Array:
    """The BFGS update of the Lagrangian's curvature, damped to remain positive definite."""
    change = now.shares - before.shares
    late, early = lagrangian(problem, now, weights, before), lagrangian(problem, before, weights)
    if late is None or early is None or not np.any(change):
        return hessian
    bend = late - early
    if fresh and float(bend @ change) > 0.0:
        hessian = np.clip(float(bend @ bend) / float(bend @ change), 1e-3, 1e3) * np.eye(len(change))
    pushed = hessian @ change
    own, seen = float(change @ pushed), float(change @ bend)
    share = 1.0 if seen >= 0.2 * own else 0.8 * own / (own - seen)
    bend = share * bend + (1.0 - share) * pushed
    updated = hessian - np.outer(pushed, pushed) / own + np.outer(bend, bend) / float(change @ bend)
    values, vectors = np.linalg.eigh(0.5 * (updated + updated.T))  # kinks of changing pieces: bounded
    return (vectors * np.clip(values, *_CURVATURES)) @ vectors.T


def run_searches(
    walks: Sequence[Walk], evaluate: Callable[[Array], list[Point | str]], told: Callable[[int], None] | None = None
) -> list[Trace]:
    """Run searches in parallel. The designs requested by the searches are evaluated together as one batch.

    >>> def still():
    ...     yield np.zeros(1)
    ...     return Trace(reason="no step")
    >>> run_searches([still()], lambda shares: ["no point"] * len(shares))[0].reason
    'no step'
    """
    traces: list[Trace | None] = [None] * len(walks)
    waiting = {number: next(walk) for number, walk in enumerate(walks)}
    while waiting:
        answers = evaluate(np.stack(list(waiting.values())))
        if told is not None:
            told(len(answers))
        following = dict[int, Array]()
        for number, answer in zip(waiting, answers, strict=True):
            try:
                following[number] = walks[number].send(answer)
            except StopIteration as end:
                traces[number] = end.value
        waiting = following
    return [trace for trace in traces if trace is not None]
