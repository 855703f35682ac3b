"""Equilibria along a load by arc length: past limits, and on from a point with a motion into another branch (docs/nonlinear.md, 27)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.models.nonlinear.graph import System, advance, assemble, exerted_by
from flexstage.models.nonlinear.hold import Hold
from flexstage.models.nonlinear.newton import TOLD, Found, lack, motion, search
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Effort, Loads, Pose, Status, put
from flexstage.spatial.rotation import logarithm

_PROBE = 1e-3
"""Change of the factor by which its effect is told where more than inputs changes: along flexures weight is not linear in it."""
_STRIDE, _LEAST = 0.1, 1e-3
"""Of the motion so far: the length of a step towards a whole load, and the least, quarter by quarter, that is tried."""
_BEYOND, _TRIES = 1.01, 60
"""Times the factor where it may have turned: passed that, it has not. And steps that are tried till then."""
_FAR = 20.0
"""Times the length of a step that a correction may have."""


@dataclass(frozen=True, eq=False)
class Course:
    """Loads and held coordinates of one case that change with a factor: those at zero, and what they gain per unit of the factor.

    `effort` tells when each equilibrium on it is found.
    """

    model: Nonlinear
    loads: Loads
    hold: Hold
    gain: Loads
    moved: Array
    effort: Effort

    def at(self, factor: float) -> tuple[Loads, Hold]:
        """Loads and held coordinates at a factor."""
        loads = Loads(*(getattr(self.loads, name) + factor * getattr(self.gain, name) for name in ("inputs", "gravity", "constant")))
        return loads, replace(self.hold, value=self.hold.value + factor * self.moved)

    @property
    def plain(self) -> bool:
        """Whether inputs alone change, in which residuals are linear."""
        return not (np.any(self.gain.gravity) or np.any(self.gain.constant) or np.any(self.moved))

    @property
    def scale(self) -> Array:
        """What makes motions of bodies (n,) comparable, reactions left out."""
        model = self.model
        others = np.zeros(len(model.hinges.locked) + len(self.hold.body))
        return np.concatenate([np.tile([1.0 / model.size] * 3 + [1.0] * 3, len(model.bodies)), others])


@dataclass(frozen=True, eq=False)
class Point:
    """An equilibrium on a course: its `found` pose, `factor`, and the `step` (n,) that led to it."""

    found: Found
    factor: float
    step: Array


def follow_course(course: Course, begin: Point, length: float, points: int, *, into: Array | None = None) -> Iterator[Point]:
    """Up to `points` equilibria beyond `begin`, `length` apart in the motion of bodies, over the stage's size and in radians.

    The first goes where the factor grows, or along the motion `into` (n,). Steps are shorter where a path bends so sharply that none is
    found. Ends where none is found at a thousandth of the length.
    """
    last, width, found = begin, length, 0
    while found < points and width >= _LEAST * length:
        after = _next(course, last, width, None if found else into)
        if after is None:
            width *= 0.25
        else:
            last, width, found = after, min(2.0 * width, length), found + 1
            yield last


def follow_to_turn(course: Course, begin: Point) -> tuple[Point, bool]:
    """The point beyond `begin` from which the factor falls, with the step after it; or, and false, one well beyond, or the last."""
    last, length = begin, _LEAST * begin.factor * float(np.linalg.norm(_rate(course, begin)))
    for _ in range(_TRIES):
        after = _next(course, last, length, None)
        if after is None:
            length *= 0.25
        elif after.factor < last.factor:
            return replace(last, step=after.step), True
        elif after.factor > _BEYOND * begin.factor:
            return after, False
        else:
            last, length = after, 2.0 * length
    return last, False


def _rate(course: Course, point: Point) -> Array:
    """How bodies move (n,) by the factor at a point, lengths over the model's."""
    system = assemble(course.model, point.found.pose, *course.at(point.factor))
    return course.scale * _directions(course, point.found.pose, point.factor, system)[1]


def _next(course: Course, last: Point, length: float, into: Array | None) -> Point | None:
    """After E. Riks (Int. J. Solids Structures 15, 1979): corrections are normal to the step so far."""
    pose, factor, whole = last.found.pose, last.factor, np.zeros(len(course.scale))
    effort, scale = course.effort, course.scale
    with np.errstate(all="ignore"):
        for iteration in range(effort.iterations):
            system = assemble(course.model, pose, *course.at(factor))
            if into is not None and iteration == 0:
                change, step = 0.0, into * (length / np.linalg.norm(into * scale))
            else:
                own, along = _directions(course, pose, factor, system)
                change = _change(scale * whole, scale * own, scale * along, scale * last.step, length)
                step = own + change * along
            size = float(motion(course.model, step[None], course.model.size)[0])
            if not np.isfinite(size + change) or size > _FAR * length:
                return None
            pose, inside = advance(course.model, pose, system.bent, step[None], np.ones(1))
            factor, whole, size = factor + change, whole + step, max(size, float(inside[0]))
            if iteration and size < effort.step and abs(change) <= effort.step * max(abs(factor), abs(factor - change)):
                gap = float(lack(course.model, system)[0])
                if gap < effort.gap:
                    return Point(_one(pose, iteration + 1, gap), factor, whole)
    return None


def _directions(course: Course, pose: Pose, factor: float, system: System) -> tuple[Array, Array]:
    """The step (n,) to equilibrium at this factor, and how that changes with the factor."""
    if course.plain:
        pushed = np.append(exerted_by(course.model, pose, course.gain)[0], np.zeros(len(course.hold.body)))
    else:
        pushed = (system.residual[0] - assemble(course.model, pose, *course.at(factor + _PROBE)).residual[0]) / _PROBE
    return _solved(system, -system.residual[0]), _solved(system, pushed)


def _solved(system: System, right: Array) -> Array:
    return system.solved(right[None])[0]


def _change(whole: Array, own: Array, along: Array, before: Array, length: float) -> float:
    """How far the factor goes, by scaled steps: the length at first, on as before; then so that the step stays normal to the whole."""
    if np.any(whole):
        return -float(whole @ own / (whole @ along))
    sign = 1.0 if along @ before >= 0.0 else -1.0
    return sign * length / float(np.linalg.norm(along))


def _one(pose: Pose, iterations: int, gap: float) -> Found:
    return Found(pose, np.array([Status.CONVERGED]), np.array([iterations]), np.array([gap]), np.ones(1))


def first_point(pose: Pose, factor: float) -> Point:
    """A known equilibrium of one case to begin from."""
    return Point(_one(pose, 0, 0.0), factor, np.zeros(6 * (pose.position.shape[1] - 1) + pose.held.shape[1]))


def rescue(model: Nonlinear, loads: Loads, hold: Hold, found: Found, effort: Effort) -> Found:
    """What was found, with those cases that were found in part followed by arc length to their whole load, or to where it turns."""
    partly = np.flatnonzero((found.status != Status.CONVERGED) & (found.reached > 0.0))
    for case in partly if effort.arcs else ():
        one = np.array([case])
        after = _rescued(model, loads.of(one), hold.of(one), found.of(one), effort)
        told = (put(getattr(found, name), one, getattr(after, name)) for name in TOLD)
        found = Found(found.pose.put(one, after.pose), *told)
    return found


def _rescued(model: Nonlinear, loads: Loads, hold: Hold, found: Found, effort: Effort) -> Found:
    """One case: its load is followed from the share that was reached."""
    course = Course(model, loads.times(np.zeros(1)), replace(hold, value=0.0 * hold.value), loads, hold.value, effort)
    last = first_point(found.pose, float(found.reached[0]))
    stride = _STRIDE
    for _ in range(effort.arcs):
        after = _next(course, last, stride * _moved(course, last.found.pose), None)
        if after is None:
            stride *= 0.25
            if stride < _LEAST:
                break
        elif after.factor >= 1.0:
            whole = search(model, after.found.pose, loads, hold, effort)
            return whole if whole.status[0] == Status.CONVERGED else found
        elif after.factor < last.factor and not effort.past:
            break
        else:
            last, stride = after, _STRIDE * (2.5 if effort.past else 1.0)
            found = replace(found, pose=after.found.pose, reached=np.maximum(found.reached, after.factor))
    return found


def _moved(course: Course, pose: Pose) -> float:
    """How far bodies are from where they are drawn, over the stage's size and in radians."""
    model = course.model
    apart = (pose.position[0, :-1] - model.reference[:-1]) / model.size
    return float(np.linalg.norm(np.concatenate([apart, logarithm(pose.turn[0, :-1])]))) or 1.0
