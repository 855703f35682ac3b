"""Stability: number of unstable motions at a state, and the critical load (docs/nonlinear.md, 22 to 24)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.models.nonlinear.elements.strain import law_reserve
from flexstage.models.nonlinear.equilibrium import LESS, State, equilibrium, failure_reason, require_equilibrium, state
from flexstage.models.nonlinear.graph import assemble
from flexstage.models.nonlinear.newton import Task
from flexstage.models.nonlinear.paths.arc import Point, ProportionalLoading, first_point, load_rate
from flexstage.models.nonlinear.paths.follow import NEAR, VANISHED, FollowedPath, continued, follow_to_event
from flexstage.models.nonlinear.paths.inertia import count_descents, kept_rows, lowest_stiffness, weakest_flexure
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import STATED, WEIGHT, Loads, SolverOptions, Status

_MOST = 1e12
"""Maximum factor."""
_SEEN = 1e-6
"""Relative work of the load on the motion below which it is zero."""
_EQUAL = 1e-3
"""Relative difference of shape components that is zero."""


class NoCriticalLoadError(DesignError):
    """Error: there is no critical load up to the maximum load factor."""


class Kind(Enum):
    """Type of a critical point: a `LIMIT` point (maximum of the load), or a `BIFURCATION` into another path."""

    LIMIT = "limit"
    BIFURCATION = "bifurcation"


@dataclass(frozen=True, eq=False)
class Critical:
    """Critical point: the `factor` on a load, the buckling mode `shape` (n, 6) of its `bodies`, and its `kind`.

    The sign of the shape is such that its largest component is positive (if several are equal, the first). The largest component is found
    with translations divided by the longest flexure length.

    `link` names a flexure that buckles between fixed ends; otherwise it is empty. `state` is the last stable state. `bend` is the factor of
    an earlier imperfect bifurcation, or `None`.
    """

    factor: float
    bodies: tuple[str, ...]
    shape: Array
    kind: Kind
    link: str
    state: State
    bend: float | None = None


def unstable_motions(state: State, *, locked: Sequence[str] | None = None) -> Array:
    """Return the number (...) of independent motions that decrease the potential energy of each case: 0 if stable, -1 without equilibrium.

    The result is the number of negative eigenvalues of the stage stiffness and of the flexures' stiffnesses with fixed ends (without
    multipliers).

    Fixed coordinates in `locked` remain fixed (default: all). Other fixed coordinates are released, and their reactions act as loads.
    """
    whole = assemble(state.model, state.pose, state.loads, state.hold)
    count = count_descents(state.model, whole, kept_rows(state.model, state.held, state.held if locked is None else locked))
    return np.where(state.converged.ravel(), count, -1).reshape(state.shape)


@check_arguments
def critical_load(  # noqa: PLR0913 (what stays, one by one)
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
    """Compute the critical load: the factor on `load` at which equilibrium becomes unstable, with all other loads constant.

    Constant loads are `rest`, weight and specified forces. Loads are named as in `equilibrium`. Coordinates in `hold` can also be part of
    `load`: their values then grow with the factor. The name `weight` in `load` stands for the weight of the stage; it requires the argument
    `weight` = 0. The name `stated forces` means the forces and preloads of the description; it requires `stated` = 0. Coordinates in
    `hold` that are not in `load` keep their values. For the evaluation of stability, the coordinates in `locked`
    (default: all coordinates in `hold`) stay fixed. The other coordinates in `hold` are released, and their reactions act as loads.

    The path starts without load. If the state `known` is specified, the path starts from this state, under the full load. Arc-length steps
    resolve the path's curvature and the change of the lowest stiffness. The result is the first limit point or bifurcation, where the
    lowest stiffness is zero (to a relative `tolerance` of the factor).

    The function raises:

    - a `DesignError` for a zero load, and for a stage that is unstable at the start;
    - a `NoCriticalLoadError` if the lowest stiffness does not reach zero up to `most` times the load;
    - a `LowerBoundError` if the path ends earlier, because the stiffness law of a part reaches its limit of validity (`strain.law_reserve`)
      or there is no further equilibrium.
    """
    if not any(load.values()):
        raise refuse("load", "the load is zero", "Specify a force or moment with its size")
    require(Finding(name, "not a fixed coordinate", suggest_nearest(name, hold or {})) for name in locked or () if name not in (hold or {}))
    low = 0.0 if known is None else 1.0
    start = _at(model, load, low, rest=rest or {}, hold=hold or {}, shares=(weight, stated), start=known)
    require_equilibrium(start)
    loading = proportional_loading(start, load, low, NEAR, locked=locked)
    begin = first_point(loading, start.pose, low)
    if begin.motions:
        under = "with" if low else "without"
        raise refuse("stage", f"the stage is not stable, or has no equilibrium, {under} the load", "Check weight and specified forces")
    followed = follow_to_event(loading, begin, most, tolerance, reserve=lambda point: law_reserve(state_at(loading, point, ())))
    if followed.event is None or followed.factor > most:
        what = f"no critical point up to {most:g} times the load"
        raise NoCriticalLoadError([Finding("load", what, "Use a larger load, or another load")])
    return _critical(loading, followed, start.held)


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
    """Equilibrium under a factor on a load, with all other loads constant."""
    held = {name: value + factor * load.get(name, 0.0) for name, value in hold.items()}
    scaled = {name: factor * value for name, value in load.items() if name not in hold}
    weight, stated = (share + scaled.pop(name, 0.0) for share, name in zip(shares, (WEIGHT, STATED), strict=True))
    together = {name: scaled.get(name, 0.0) + rest.get(name, 0.0) for name in {**rest, **scaled}}
    return equilibrium(model, together, hold=held, weight=weight, stated=stated, start=start)


def require_continuation(start: State, end: State) -> None:
    """Raise `DesignError` if a stable state `end` is not reached from `start` by proportional change of loads and fixed coordinates.

    Causes of the error are a limit point or a bifurcation on the path, an early end of the path, or a path that leads to another
    equilibrium. If `end` is unstable, or if its path starts unstable, there is no error.
    """
    one, other = (Task(each.model, each.pose, each.loads, each.hold) for each in (start, end))
    continuation = continued(one, other)
    if continuation.status[0] != Status.CONVERGED:
        raise refuse("stage", failure_reason(int(continuation.status[0]), float(continuation.reached[0])), LESS)
    if continuation.pose is not end.pose:
        raise refuse("stage", "the equilibrium under its loads is not on the path of equilibria from the unloaded stage", LESS)


def proportional_loading(
    start: State, load: Mapping[str, float], factor: float, options: SolverOptions, *, locked: Sequence[str] | None = None
) -> ProportionalLoading:
    """Build the loading in which `load` is proportional to a load factor; `factor` is the value of this load factor at the state."""
    model = start.model
    rate = np.array([[load.get(channel.name, 0.0) for channel in model.inputs]])
    gain = Loads(rate, load.get(WEIGHT, 0.0) * model.gravity[None], load.get(STATED, 0.0) * np.ones(1))
    moved = np.array([[load.get(name, 0.0) for name in start.held]])
    kept = kept_rows(model, start.held, start.held if locked is None else locked)
    return ProportionalLoading(
        model, start.loads.plus(gain, -factor), replace(start.hold, value=start.hold.value - factor * moved), gain, moved, options, kept
    )


def state_at(loading: ProportionalLoading, point: Point, held: tuple[str, ...]) -> State:
    """Build the state at a point of a load path."""
    return state(loading.model, *loading.at(point.factor), point.found, ((), held))


def _critical(loading: ProportionalLoading, followed: FollowedPath, held: tuple[str, ...]) -> Critical:
    """The critical point at a zero stiffness: a limit point if the load does work on its motion."""
    model, event = loading.model, followed.event
    assert event is not None  # noqa: S101
    assert event.reference is not None  # noqa: S101
    scale = event.reference.scale
    value, motion = lowest_stiffness(model, event.system, loading.kept, scale)
    own, link = weakest_flexure(model, event.system)
    inside = abs(own) < VANISHED * event.reference.flexure
    force = _force_rate(loading, event)
    work = abs(force @ motion) / (np.linalg.norm(force / scale) * np.linalg.norm(motion * scale))
    apart = inside and abs(value) > VANISHED * event.reference.stage
    kind = Kind.LIMIT if work > _SEEN and not apart else Kind.BIFURCATION
    sizes = loading.scale[: model.freedoms] * motion
    first = np.argmax(np.abs(sizes) > (1.0 - _EQUAL) * np.max(np.abs(sizes)))
    motion = np.copysign(1.0, sizes[first]) * motion
    last = state_at(loading, followed.last, held)
    return Critical(followed.factor, model.bodies, motion.reshape(-1, 6), kind, link if inside else "", last, followed.bend)


def _force_rate(loading: ProportionalLoading, event: Point) -> Array:
    """Derivative (n,) of body forces by the factor; prescribed coordinates that change with it move only their bodies."""
    count, matrix = loading.model.freedoms, event.system.matrix[0]
    rate = load_rate(loading, event.found.pose, event.factor, event.system)
    if not np.any(loading.moved):
        return rate[:count]
    held = matrix[count:, :count]
    moved = np.linalg.lstsq(held if isinstance(held, np.ndarray) else held.toarray(), rate[count:])[0]
    return rate[:count] - matrix[:count, :count] @ moved
