"""Stability: how many ways a state would leave its equilibrium, and the load at which the first opens (docs/nonlinear.md, 22 to 24)."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import scipy

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, LowerBoundError, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.models.nonlinear.arc import Course, Point, first_point, load_rate, march, step_along
from flexstage.models.nonlinear.equilibrium import State, equilibrium, state
from flexstage.models.nonlinear.graph import assemble
from flexstage.models.nonlinear.inertia import count_descents, kept_rows, lowest_stiffness, weakest_flexure
from flexstage.models.nonlinear.newton import USUAL, search
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import STATED, WEIGHT, Effort, Loads, Pose, Status
from flexstage.models.nonlinear.strain import strains

_MOST, _FIRST = 1e12, 1e-4
"""The largest factor, and the first step in the motion of bodies, over the stage's size and in radians."""
_NEAR = Effort(halvings=0, iterations=15, arcs=0)
"""Each state starts from one next to it."""
_POINTS, _JUMPS = 400, 8
"""Equilibria along a path, and steps over to another one, before it is given up."""
_STRAINED = 0.05
"""Strain of a flexure from which on a path is not followed: no linear elastic law is physics there."""
_VANISHED = 1e-5
"""Stiffness over that at the start which counts as zero; what is left where a step changes to another path is more."""
_SAME = 1e-6
"""Distance of two poses, over the stage's size and in radians, that are the same."""
_FLAT, _SOON, _WELL = 0.01, 1.01, 1.25
"""Slope over the steepest so far below which a path bends off; times the factor there, how far it is followed at least and at most."""
_BESIDE = (1.0, 1.0 - 1e-8, 1.0 - 1e-7, 1.0 - 1e-6, 1.0 - 1e-5)
"""Shares of a step at which an equilibrium is looked for where it is singular."""
_NEXT = 1e-9
"""Of the last step: the last stable state before a critical one."""
_SEEN = 1e-6
"""Work of the load on the motion, over their sizes, below which it does none."""


class NothingGivesWayError(DesignError):
    """The stage bears as much of a load as was looked at."""


class Kind(Enum):
    """The type of a critical point: a `LIMIT` point, which the load cannot pass, or a `BIFURCATION` into another path."""

    LIMIT = "limit"
    BIFURCATION = "bifurcation"


@dataclass(frozen=True, eq=False)
class Critical:
    """The `factor` on a load at which the stage gives way, the `shape` (n, 6) of its `bodies` doing so, and of which `kind` it is.

    `link` names the flexure that gives way by itself, its ends at rest; else it is empty. `state` is the last stable one. `bend` is the
    factor at which the path has bent off before, an imperfect bifurcation; None where it has not.
    """

    factor: float
    bodies: tuple[str, ...]
    shape: Array
    kind: Kind
    link: str
    state: State
    bend: float | None = None


@dataclass(frozen=True, eq=False)
class Followed:
    """A path from its start: its last stable point, its first critical one, if there is one, the factors of its bend and of its end."""

    last: Point
    event: Point | None
    bend: float | None
    factor: float


def unstable_motions(state: State, *, locked: Sequence[str] | None = None) -> Array:
    """How many independent motions (...) lower the potential of each case: zero if it is stable. -1 where a case has no state.

    The negative eigenvalues of the stage's stiffness, and those of each flexure's own system beyond its six multipliers. Of what the state
    holds, the coordinates `locked` stay held (absent: all); the others are released under the force that held them.
    """
    whole = assemble(state.model, state.pose, state.loads, state.hold)
    count = count_descents(state.model, whole, kept_rows(state.model, state.held, state.held if locked is None else locked))
    return np.where(state.converged.ravel(), count, -1).reshape(state.shape)


@check_arguments
def critical(  # noqa: PLR0913 (what stays, one by one)
    model: Nonlinear,
    load: Mapping[str, float],
    *,
    rest: Mapping[str, float] | None = None,
    hold: Mapping[str, float] | None = None,
    locked: Sequence[str] | None = None,
    weight: float = 1.0,
    stated: float = 1.0,
    known: State | None = None,
    most: float = _MOST,
    tolerance: float = 1e-9,
) -> Critical:
    """The factor on `load` at which equilibrium stops being stable, all else (`rest`, weight, stated forces) staying as it is.

    Loads are named as in `equilibrium`; `weight` names the stage's own, which then counts as a load alone if `weight` is zero, and `stated
    forces` those of the description with its preloads, likewise. Coordinates in `hold` stay at their values; those that are not `locked`
    too (absent: all are) count as free under the force that holds them there.

    The path of equilibria is followed from no load, or from the whole load where the state under it is `known`, by arc length with steps
    that resolve its turning and the change of its lowest stiffness. The first limit point or bifurcation is where that stiffness is zero,
    to `tolerance`. Raises `DesignError` for a load that is zero and for a stage that is unstable where that begins,
    `NothingGivesWayError` where no stiffness vanishes up to `most` times the load, and `LowerBoundError` where the path is followed to
    less than that: to a strain of 5 %, or to where no further equilibrium is found.
    """
    if not any(load.values()):
        raise refuse("load", "the load whose critical factor is asked for is zero", "Name a force or moment and its size")
    require(Finding(name, "no value holds it", suggest_nearest(name, hold or {})) for name in locked or () if name not in (hold or {}))
    low = 0.0 if known is None else 1.0
    start = _at(model, load, low, rest=rest or {}, hold=hold or {}, shares=(weight, stated), start=known)
    course = course_of(start, load, low, _NEAR, locked=locked)
    begin = first_point(course, start.pose, low)
    if not bool(start.converged) or begin.motions:
        under = "with" if low else "without"
        raise refuse("stage", f"it is not stable, or has no equilibrium, {under} the load", "Look at its weight and its stated forces")
    followed = follow_to_event(course, begin, most, tolerance)
    if followed.event is None or followed.factor > most:
        what = f"nothing gives way up to {most:g} times the load"
        raise NothingGivesWayError([Finding("load", what, "Name a larger load, or another one")])
    return _critical(course, followed, start.held)


def _at(
    model: Nonlinear,
    load: Mapping[str, float],
    factor: float,
    *,
    rest: Mapping[str, float],
    hold: Mapping[str, float],
    shares: tuple[float, float],
    start: State | None,
) -> State:
    """The equilibrium under a factor on a load, all else staying."""
    scaled = {name: factor * value for name, value in load.items()}
    weight, stated = (share + scaled.pop(name, 0.0) for share, name in zip(shares, (WEIGHT, STATED), strict=True))
    together = {name: scaled.get(name, 0.0) + rest.get(name, 0.0) for name in {**rest, **scaled}}
    return equilibrium(model, together, hold=hold, weight=weight, stated=stated, start=start, effort=Effort(arcs=0))


def follow_to_event(
    course: Course, begin: Point, most: float, tolerance: float, *, length: float = _FIRST, bounded: bool = True
) -> Followed:
    """Follow a path to the first point where its stiffness vanishes, or to the factor `most`; its first step has a `length`.

    Raises `LowerBoundError` where the path is not followed so far: where no equilibrium is found, and if it is `bounded`, well beyond an
    imperfect bifurcation and at strains beyond the law.
    """
    last, bent = begin, None
    for _ in range(_JUMPS):
        for point in itertools.islice(march(course, last, length), _POINTS):
            length = 0.1 * float(np.linalg.norm(point.step))
            if point.motions:
                event = _zero(course, last, point, _stiffness, tolerance)
                if event is None or abs(event.stiffness) > _VANISHED:
                    break  # the step went over to another path
                if bounded:
                    _require_lawful(course, event, last, bent)
                before = step_along(course, last, (1.0 - _NEXT) * float(np.linalg.norm(event.step)))
                rest = event.stiffness * float(np.linalg.norm(event.step)) / (last.stiffness - event.stiffness)
                factor = event.factor + event.slope * rest
                return Followed(before if event.motions and before is not None else event, event, _bend(bent, event), factor)
            if bounded:
                _require_lawful(course, point, last, bent)
            if bent is None and _excess(point) < 0.0:
                bent = _zero(course, last, point, _excess, 1e-4) or point
            last = point
            ends = last.factor >= most
            if bounded and bent is not None and (last.factor > _WELL * bent.factor or (ends and _bend(bent, last) is not None)):
                raise _not_followed(last, "", bent)
            if ends:
                return Followed(last, None, _bend(bent, last), last.factor)
        else:
            break
    raise _not_followed(last, "no equilibrium is found next to the last one", bent)


def require_continuation(start: State, end: State) -> None:
    """Refuse a stable state that is not the continuation of another one as loads and held coordinates go from those to its own.

    Raises `DesignError` at the load of the first limit point or bifurcation on the way, where the path ends, and where it leads to another
    equilibrium. A state that is not stable, or whose path begins at one that is not, is let through.
    """
    if int(unstable_motions(end)):
        return
    advice = "Load it less, or ask flexstage buckle what gives way"
    try:
        followed = follow_between(start, end, 1e-6)
    except LowerBoundError as error:
        what = f"equilibrium was followed to {error.bound:.3g} of the way from the unloaded stage: a state beyond is not its continuation"
        raise refuse("stage", what, advice) from None
    if followed is None:
        return
    if followed.event is not None:
        what = f"at {followed.factor:.4g} of its loads it snaps or buckles: the equilibrium beyond is not the continuation of the unloaded"
        raise refuse("stage", what, advice)
    found = search(end.model, followed.last.found.pose, end.loads, end.hold, USUAL)
    if found.status[0] != Status.CONVERGED or _apart(end.model, found.pose, end.pose) > _SAME:
        raise refuse("stage", "the equilibrium found under its loads is not the continuation of the unloaded stage", advice)


def follow_between(start: State, end: State, tolerance: float) -> Followed | None:
    """Follow the path from a state to the loads and held coordinates of another one, its first critical point included.

    `None` where it begins at a state that is not stable, or where the loads move nothing. Raises `LowerBoundError` as `follow_to_event`.
    """
    gain = Loads(*(getattr(end.loads, name) - getattr(start.loads, name) for name in ("inputs", "gravity", "constant")))
    kept = kept_rows(start.model, start.held, start.held)
    course = Course(start.model, start.loads, start.hold, gain, end.hold.value - start.hold.value, _NEAR, kept)
    begin = first_point(course, start.pose, 0.0)
    if begin.motions or not np.isfinite(begin.slope):
        return None
    followed = follow_to_event(course, begin, 1.0, tolerance, length=1.0 / begin.slope, bounded=False)
    return followed if followed.factor <= 1.0 else replace(followed, event=None)


def _apart(model: Nonlinear, one: Pose, other: Pose) -> float:
    """How far bodies are from where another pose has them, over the stage's size and in radians."""
    moved = np.max(np.abs(one.position - other.position)) / model.size
    return float(max(moved, np.max(np.abs(one.turn - other.turn))))


def _stiffness(point: Point) -> float:
    return point.stiffness


def _excess(point: Point) -> float:
    """How far the slope is above that of a path that has bent off."""
    return point.slope / point.steepest - _FLAT


def _require_lawful(course: Course, point: Point, last: Point, bent: Point | None) -> None:
    """Refuse a point where a flexure is strained beyond any linear law."""

    def left(each: Point) -> float:
        return _STRAINED - float(np.max(strains(state_at(course, each, ())).largest, initial=0.0))

    if left(point) < 0.0:
        raise _not_followed(_zero(course, last, point, left, 1e-4) or last, f"a flexure is strained by {_STRAINED:.0%} there", bent)


def _not_followed(last: Point, why: str, bent: Point | None) -> LowerBoundError:
    """A path that ends without a critical point: stable up to its end, or to where it bends off."""
    bend = _bend(bent, last)
    bound = last.factor if bend is None else bend
    reason = why if bend is None else f"it bends off there, an imperfect bifurcation, and moves {1.0 / _FLAT:g} times as far per load"
    what = f"it is stable up to {bound:.6g} times the load, and not followed beyond: {reason}"
    return LowerBoundError([Finding("load", what, "Follow the load with fs.trace, or name another one")], bound)


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


def course_of(start: State, load: Mapping[str, float], factor: float, effort: Effort, *, locked: Sequence[str] | None = None) -> Course:
    """The course of a load that changes by a factor, from a state that has it so many times."""
    model = start.model
    rate = np.array([[load.get(channel.name, 0.0) for channel in model.inputs]])
    gain = Loads(rate, load.get(WEIGHT, 0.0) * model.gravity[None], load.get(STATED, 0.0) * np.ones(1))
    begun = Loads(*(getattr(start.loads, name) - factor * getattr(gain, name) for name in ("inputs", "gravity", "constant")))
    kept = kept_rows(model, start.held, start.held if locked is None else locked)
    return Course(model, begun, start.hold, gain, 0.0 * start.hold.value, effort, kept)


def state_at(course: Course, point: Point, held: tuple[str, ...]) -> State:
    """The state at a point of a course."""
    return state(course.model, *course.at(point.factor), point.found, ((), held))


def _critical(course: Course, followed: Followed, held: tuple[str, ...]) -> Critical:
    """The critical point where a stiffness vanishes: a limit point where the load works on the motion of that stiffness."""
    model, event = course.model, followed.event
    assert event is not None  # noqa: S101
    assert event.reference is not None  # noqa: S101
    scale = event.reference.scale
    value, motion = lowest_stiffness(model, event.system, course.kept, scale)
    own, link = weakest_flexure(model, event.system)
    inside = abs(own) < _VANISHED * event.reference.flexure
    force = load_rate(course, event.found.pose, event.factor, event.system)[: model.freedoms]
    work = abs(force @ motion) / (np.linalg.norm(force / scale) * np.linalg.norm(motion * scale))
    apart = inside and abs(value) > _VANISHED * event.reference.stage
    kind = Kind.LIMIT if work > _SEEN and not apart else Kind.BIFURCATION
    last = state_at(course, followed.last, held)
    return Critical(followed.factor, model.bodies, motion.reshape(-1, 6), kind, link if inside else "", last, followed.bend)
