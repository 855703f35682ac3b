"""Following a path of equilibria to its first critical point, or to loads whose equilibrium is known (docs/nonlinear.md, 25)."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy

from flexstage.base.finding import Finding, LowerBoundError
from flexstage.base.number import Array
from flexstage.models.nonlinear.newton import USUAL, Found, Task, search
from flexstage.models.nonlinear.paths.arc import Course, Point, first_point, march, misfit, point_at, step_along
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Loads, Pose, SolverOptions, Status
from flexstage.spatial.rotation import logarithm

FIRST = 1e-4
"""The first step in the motion of bodies, over the stage's size and in radians."""
NEAR = SolverOptions(halvings=0, iterations=15, arcs=0)
"""Each state starts from one next to it."""
_POINTS, _JUMPS = 400, 8
"""Equilibria along a path, and steps over to another one, before it is given up."""
VANISHED = 1e-5
"""Stiffness over that at the start which counts as zero; what is left where a step changes to another path is more."""
_SAME = 1e-6
"""Distance of two poses, over the stage's size and in radians, that are the same."""
_FLAT, _SOON, _WELL = 0.01, 1.01, 1.25
"""Slope over the steepest so far below which a path bends off; times the factor there, how far it is followed at least and at most."""
_BESIDE = (1.0, 1.0 - 1e-8, 1.0 - 1e-7, 1.0 - 1e-6, 1.0 - 1e-5)
"""Shares of a step at which an equilibrium is looked for where it is singular."""
_NEXT, _ROUND = 1e-9, 1e-7
"""Of the last step: the last stable state before a critical one; of the factor, how far that may be from there by rounding of the step."""

Reserve = Callable[[Point], tuple[float, str]]
"""How much of the range of its laws a point has left, negative beyond it, and what is first beyond."""


@dataclass(frozen=True, eq=False)
class Followed:
    """A path from its start: its last stable point, its first critical one, if there is one, the factors of its bend and of its end."""

    last: Point
    event: Point | None
    bend: float | None
    factor: float


def follow_to_event(
    course: Course, begin: Point, most: float, tolerance: float, *, length: float = FIRST, reserve: Reserve | None = None
) -> Followed:
    """Follow a path to the first point where its stiffness vanishes, or to the factor `most`; its first step has a `length`.

    Raises `LowerBoundError` where the path is not followed so far: where no equilibrium is found, and if it has a `reserve`, where that
    ends and well beyond an imperfect bifurcation.
    """
    last, bent = begin, None
    for _ in range(_JUMPS):
        for point in itertools.islice(march(course, last, length), _POINTS):
            length = 0.1 * float(np.linalg.norm(point.step))
            if point.motions:
                found = _first_event(course, last, point, bent, tolerance)
                if found is None:
                    break  # the step went over to another path
                _require_lawful(course, found.event or point, last, bent, reserve)
                if found.factor <= most:
                    return found
                return replace(found, last=_zero(course, last, found.event or point, lambda each: each.factor - most, 1e-6) or last)
            _require_lawful(course, point, last, bent, reserve)
            if bent is None and _excess(point) < 0.0:
                bent = _zero(course, last, point, _excess, 1e-4) or point
            last = point
            if reserve is not None:
                _require_unbent(last, bent, most)
            if last.factor >= most:
                return Followed(last, None, _bend(bent, last), last.factor)
        else:
            break
    if abs(last.stiffness) < VANISHED:  # Newton's method has no equilibrium where a flexure's own stiffness is zero
        return Followed(last, last, _bend(bent, last), last.factor)
    raise _not_followed(last, "no equilibrium is found next to the last one", None if reserve is None else bent)


def _first_event(course: Course, last: Point, point: Point, bent: Point | None, tolerance: float) -> Followed | None:
    """The critical point between a stable point and one that is not; `None` where no stiffness vanishes between them."""
    event = _zero(course, last, point, _stiffness, tolerance)
    if event is None or abs(event.stiffness) > VANISHED:
        return None
    length = float(np.linalg.norm(event.step))
    before = step_along(course, last, (1.0 - _NEXT) * length) if event.motions else None
    if before is None or before.motions or abs(before.factor - event.factor) > _ROUND * abs(event.factor):
        before = event
    slope = float(np.nan_to_num(event.slope))  # singular to the bit, it has none, and no stiffness is left
    factor = event.factor + slope * length * event.stiffness / (last.stiffness - event.stiffness)
    return Followed(before, event, _bend(bent, event), factor)


def continued(start: Task, end: Task) -> Found:
    """The equilibrium (of one case) that continues that of `start` as loads and held coordinates go in proportion to those of `end`.

    An equilibrium of `end` that is next to the start, or the path of which begins at one that is not stable, is returned as it is. So is
    one that is not stable where the path bends off before. Else `status` is `CRITICAL` where the path has a limit
    point or a bifurcation, and `NOT_FOLLOWED` where it ends, each at the share `reached`.
    """
    model, hold = end.model, end.hold
    whole = Found(end.start, np.array([Status.CONVERGED]), np.zeros(1, int), np.zeros(1), np.ones(1))
    kept = [*range(model.freedoms + len(model.hinges.locked) + len(hold.body))]
    if apart(model, start.start, end.start) < _SAME:
        return whole
    gain = Loads(*(getattr(end.loads, name) - getattr(start.loads, name) for name in ("inputs", "gravity", "constant")))
    course = Course(model, start.loads, start.hold, gain, hold.value - start.hold.value, NEAR, kept)
    begin = first_point(course, start.start, 0.0)
    if begin.motions or not np.isfinite(begin.slope):
        return whole
    after = point_at(course, whole, 1.0, step=course.scale * between(start.start, end.start), start=begin)
    if not after.motions and misfit(course.scale, None, begin, after) <= 1.0:  # one step of `march` would end there
        return whole

    def lost(status: Status, reached: float) -> Found:
        return replace(whole, status=np.array([status]), reached=np.array([reached]))

    try:
        followed = follow_to_event(course, begin, 1.0, 1e-6, length=1.0 / begin.slope)
    except LowerBoundError as error:
        return lost(Status.NOT_FOLLOWED, error.bound)
    if followed.event is not None and followed.factor <= 1.0:
        return lost(Status.CRITICAL, followed.factor)
    if after.motions and followed.bend:
        return whole
    found = search(model, followed.last.found.pose, end.loads, hold, USUAL)
    return whole if found.status[0] == Status.CONVERGED and apart(model, found.pose, end.start) < _SAME else found


def apart(model: Nonlinear, one: Pose, other: Pose) -> float:
    """How far bodies are from where another pose has them, over the stage's size and in radians."""
    moved = np.max(np.abs(one.position - other.position)) / model.size
    return float(max(moved, np.max(np.abs(one.turn - other.turn))))


def between(one: Pose, other: Pose) -> Array:
    """The motion of bodies (n,) from one pose to another, reactions left out."""
    moved = np.concatenate([other.position - one.position, logarithm(other.turn @ np.swapaxes(one.turn, -1, -2))], axis=-1)
    return np.append(moved[0, :-1], np.zeros(other.held.shape[1]))


def _stiffness(point: Point) -> float:
    return point.stiffness


def _excess(point: Point) -> float:
    """How far the slope is above that of a path that has bent off."""
    return point.slope / point.steepest - _FLAT


def _require_lawful(course: Course, point: Point, last: Point, bent: Point | None, reserve: Reserve | None) -> None:
    """Refuse a point beyond the range of the laws, where that is."""
    if reserve is None:
        return
    left, why = reserve(point)
    if left < 0.0:
        raise _not_followed(_zero(course, last, point, lambda each: reserve(each)[0], 1e-4) or last, why, bent)


def _require_unbent(last: Point, bent: Point | None, most: float) -> None:
    """Refuse what is well beyond a bend, and the end of a path that has bent off."""
    if bent is not None and (last.factor > _WELL * bent.factor or (last.factor >= most and _bend(bent, last) is not None)):
        raise _not_followed(last, "", bent)


def _not_followed(last: Point, why: str, bent: Point | None) -> LowerBoundError:
    """A path that ends without a critical point: stable up to its end, or to where it bends off."""
    bend = _bend(bent, last)
    bound = last.factor if bend is None else bend
    reason = why if bend is None else f"it bends off there, an imperfect bifurcation, and moves {1.0 / _FLAT:g} times as far per load"
    what = f"it is stable up to {bound:.6g} times the load, and not followed beyond: {reason}"
    return LowerBoundError([Finding("load", what, "Follow the load with fs.continuation, or name another one")], bound)


def _bend(bent: Point | None, last: Point) -> float | None:
    """The factor at which a path has bent off, if it has not ended soon after."""
    return None if bent is None or last.factor < _SOON * bent.factor else bent.factor


def _zero(course: Course, last: Point, after: Point, measure: Callable[[Point], float], tolerance: float) -> Point | None:
    """The point between two at which a measure of points changes its sign; `None` where one between them is not found."""
    length = float(np.linalg.norm(after.step))

    def at(part: float) -> Point:
        if part in (0.0, length):
            return after if part else last
        for share in _BESIDE:  # where stiffness vanishes Newton's method has none
            point = step_along(course, last, share * part)
            if point is not None:
                return point
        raise ValueError

    try:
        return at(float(scipy.optimize.brentq(lambda part: measure(at(part)), 0.0, length, xtol=min(tolerance, 1e-6) * length)))
    except ValueError:
        return None
