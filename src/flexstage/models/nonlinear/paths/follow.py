"""Path following to the first critical point, or to a known equilibrium (docs/nonlinear.md, 25)."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy

from flexstage.base.finding import Finding, LowerBoundError
from flexstage.base.number import Array
from flexstage.models.nonlinear.newton import USUAL, EquilibriumSolution, Task, search
from flexstage.models.nonlinear.paths.arc import Point, ProportionalLoading, first_point, march, misfit, point_at, step_along
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Pose, SolverOptions, Status
from flexstage.spatial.rotation import logarithm

FIRST = 1e-4
"""Length of the first step in body motion: translations divided by the stage size, rotations in radians."""
NEAR = SolverOptions(halvings=0, iterations=15, arcs=0)
"""Solver options for solutions that start from a neighbouring state."""
_POINTS, _JUMPS = 400, 8
"""Maximum number of equilibria along a path, and of steps onto another path."""
VANISHED = 1e-5
"""Stiffness, divided by its start value, below which it counts as zero. After a step onto another path, the quotient is larger."""
_SAME = 1e-6
"""Distance of two equal poses, over the stage size and in radians."""
_FLAT, _SOON, _WELL = 0.01, 1.01, 1.25
"""Slope over the steepest so far at which a path bends off; minimum and maximum factor, over the one there, of its continuation."""
_BESIDE = (1.0, 1.0 - 1e-8, 1.0 - 1e-7, 1.0 - 1e-6, 1.0 - 1e-5)
"""Fractions of a step to try for an equilibrium near a singular one."""
_NEXT, _ROUND = 1e-9, 1e-7
"""Last stable state before a critical one, over the last step; permitted rounding of the factor between them."""

Reserve = Callable[[Point], tuple[float, str]]
"""Function that returns the unused fraction of the laws' range at a point (negative outside the range), and a clause naming the limit."""


@dataclass(frozen=True, eq=False)
class FollowedPath:
    """Followed path: last stable point, first critical point (`event`), load factor of an imperfect bifurcation (`bend`), final factor."""

    last: Point
    event: Point | None
    bend: float | None
    factor: float


def follow_to_event(
    loading: ProportionalLoading, begin: Point, most: float, tolerance: float, *, length: float = FIRST, reserve: Reserve | None = None
) -> FollowedPath:
    """Follow a path to the first zero of the stiffness, or to the factor `most`; `length` is the length of the first step.

    Raises `LowerBoundError` if the path ends earlier, without a further equilibrium. If `reserve` is specified, the path also ends where
    the returned fraction is zero, or well beyond an imperfect bifurcation.
    """
    last, bent = begin, None
    for _ in range(_JUMPS):
        for point in itertools.islice(march(loading, last, length), _POINTS):
            length = 0.1 * float(np.linalg.norm(point.step))
            if point.motions:
                event = _first_event(loading, last, point, bent, tolerance)
                if event is None:
                    break  # the step changed to another path
                _require_lawful(loading, event.event or point, last, bent, reserve)
                if event.factor <= most:
                    return event
                return replace(event, last=_zero(loading, last, event.event or point, lambda each: each.factor - most, 1e-6) or last)
            _require_lawful(loading, point, last, bent, reserve)
            if bent is None and _excess(point) < 0.0:
                bent = _zero(loading, last, point, _excess, 1e-4) or point
            last = point
            if reserve is not None:
                _require_unbent(last, bent, most)
            if last.factor >= most:
                return FollowedPath(last, None, _bend(bent, last), last.factor)
        else:
            break
    if abs(last.stiffness) < VANISHED:  # Newton's method has no solution at a zero own stiffness of a flexure
        return FollowedPath(last, last, _bend(bent, last), last.factor)
    raise _not_followed(last, "no equilibrium was found near the last equilibrium", None if reserve is None else bent)


def _first_event(loading: ProportionalLoading, last: Point, point: Point, bent: Point | None, tolerance: float) -> FollowedPath | None:
    """The critical point between a stable and an unstable point; `None` if no stiffness is zero between them."""
    event = _zero(loading, last, point, _stiffness, tolerance)
    if event is None or abs(event.stiffness) > VANISHED:
        return None
    length = float(np.linalg.norm(event.step))
    before = step_along(loading, last, (1.0 - _NEXT) * length) if event.motions else None
    if before is None or before.motions or abs(before.factor - event.factor) > _ROUND * abs(event.factor):
        before = event
    slope = float(np.nan_to_num(event.slope))  # exactly singular: no residual stiffness
    factor = event.factor + slope * length * event.stiffness / (last.stiffness - event.stiffness)
    return FollowedPath(before, event, _bend(bent, event), factor)


def continued(start: Task, end: Task) -> EquilibriumSolution:
    """Compute the equilibrium of one case that is reached from `start` if all loads and fixed coordinates change linearly to `end`.

    The equilibrium `end` is returned unchanged if it is near the start, or if its path starts unstable. An unstable `end` is also returned
    unchanged if the path has an imperfect bifurcation.

    If the path does not reach the full load, `status` is `CRITICAL` (a limit point or a bifurcation) or `NOT_FOLLOWED` (the path ends).
    `reached` is then the load fraction at the limit point, the bifurcation or the end.
    """
    model, hold = end.model, end.hold
    whole = EquilibriumSolution(end.start, np.array([Status.CONVERGED]), np.zeros(1, int), np.zeros(1), np.ones(1))
    kept = [*range(model.freedoms + len(model.hinges.locked) + len(hold.body))]
    if pose_distance(model, start.start, end.start) < _SAME:
        return whole
    loading = ProportionalLoading(
        model, start.loads, start.hold, end.loads.plus(start.loads, -1.0), hold.value - start.hold.value, NEAR, kept
    )
    begin = first_point(loading, start.start, 0.0)
    if begin.motions or not np.isfinite(begin.slope):
        return whole
    after = point_at(loading, whole, 1.0, step=loading.scale * between(start.start, end.start), start=begin)
    if not after.motions and misfit(loading.scale, None, begin, after) <= 1.0:  # one step of `march` would end there
        return whole

    def lost(status: Status, reached: float) -> EquilibriumSolution:
        return replace(whole, status=np.array([status]), reached=np.array([reached]))

    try:
        followed = follow_to_event(loading, begin, 1.0, 1e-6, length=1.0 / begin.slope)
    except LowerBoundError as error:
        return lost(Status.NOT_FOLLOWED, error.bound)
    if followed.event is not None and followed.factor <= 1.0:
        return lost(Status.CRITICAL, followed.factor)
    if after.motions and followed.bend:
        return whole
    solution = search(model, followed.last.found.pose, end.loads, hold, USUAL)
    return whole if solution.status[0] == Status.CONVERGED and pose_distance(model, solution.pose, end.start) < _SAME else solution


def pose_distance(model: Nonlinear, one: Pose, other: Pose) -> float:
    """Return the largest change between two poses: positions divided by `model.size`, and entries of rotation matrices."""
    shift = np.max(np.abs(one.position - other.position)) / model.size
    return float(max(shift, np.max(np.abs(one.turn - other.turn))))


def between(one: Pose, other: Pose) -> Array:
    """Return the body motions (n,) from one pose to another."""
    motions = np.concatenate([other.position - one.position, logarithm(other.turn @ one.turn.mT)], axis=-1)
    return np.append(motions[0, :-1], np.zeros(other.held.shape[1]))


def _stiffness(point: Point) -> float:
    return point.stiffness


def _excess(point: Point) -> float:
    """Excess of the slope over that of a path that bends off."""
    return point.slope / point.steepest - _FLAT


def _require_lawful(loading: ProportionalLoading, point: Point, last: Point, bent: Point | None, reserve: Reserve | None) -> None:
    """Refuse a point beyond the range of the laws."""
    if reserve is None:
        return
    left, why = reserve(point)
    if left < 0.0:
        raise _not_followed(_zero(loading, last, point, lambda each: reserve(each)[0], 1e-4) or last, why, bent)


def _require_unbent(last: Point, bent: Point | None, most: float) -> None:
    """Refuse points well beyond a bend, and the end of a path that has bent off."""
    if bent is not None and (last.factor > _WELL * bent.factor or (last.factor >= most and _bend(bent, last) is not None)):
        raise _not_followed(last, "", bent)


def _not_followed(last: Point, why: str, bent: Point | None) -> LowerBoundError:
    """Error of a path that ends without a critical point: stable up to its end, or up to its bend."""
    bend = _bend(bent, last)
    bound = last.factor if bend is None else bend
    reason = why if bend is None else f"an imperfect bifurcation, where motion per unit of load becomes {1.0 / _FLAT:g} times larger"
    what = f"stable up to {bound:.6g} times the load; the path is not followed beyond: {reason}"
    return LowerBoundError([Finding("load", what, "Follow the load with fs.continuation, or use another load")], bound)


def _bend(bent: Point | None, last: Point) -> float | None:
    """The factor at which a path has bent off, unless it ends soon after."""
    return None if bent is None or last.factor < _SOON * bent.factor else bent.factor


def _zero(loading: ProportionalLoading, last: Point, after: Point, measure: Callable[[Point], float], tolerance: float) -> Point | None:
    """The point between two at which a measure of points changes sign; `None` without an equilibrium between them."""
    length = float(np.linalg.norm(after.step))

    def at(part: float) -> Point:
        if part in (0.0, length):
            return after if part else last
        for share in _BESIDE:  # Newton's method has no solution at zero stiffness
            point = step_along(loading, last, share * part)
            if point is not None:
                return point
        raise ValueError

    try:
        return at(float(scipy.optimize.brentq(lambda part: measure(at(part)), 0.0, length, xtol=min(tolerance, 1e-6) * length)))
    except ValueError:
        return None
