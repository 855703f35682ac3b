"""Stability: how many ways a state would leave its equilibrium, and the load at which the first opens (docs/nonlinear.md, 22 to 24)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
import scipy

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.models.nonlinear.arc import Course, first_point, follow_to_turn
from flexstage.models.nonlinear.condense import system
from flexstage.models.nonlinear.element import Tangent
from flexstage.models.nonlinear.equilibrium import State, equilibrium
from flexstage.models.nonlinear.graph import System, assemble
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import STATED, WEIGHT, Effort, Loads
from flexstage.models.nonlinear.summed import nearest_descent, negative_pivots

_FIRST, _MOST, _GROWTH = 1e-3, 1e6, 2.0
_NEAR = Effort(halvings=0, iterations=12, arcs=0)
"""Each state starts from one beside it."""
_ROUGH = 1e-6
"""How far a count is bisected where no stiffness goes through zero."""
_SEEN = 1e-6
"""Work of the load on the motion, over their sizes, below which it does none."""


class NothingGivesWayError(DesignError):
    """The stage bears as much of a load as was looked at."""


class Kind(Enum):
    """What happens at a critical load: a `LIMIT` that it cannot pass, a `BIFURCATION` into another way of giving, or a sharp `BEND`.

    A stage whose symmetry is not quite right bends off beside a bifurcation, to one side, and may bear more load so.
    """

    LIMIT = "limit"
    BIFURCATION = "bifurcation"
    BEND = "bend"


@dataclass(frozen=True, eq=False)
class Critical:
    """The `factor` on a load at which the stage gives way, the `shape` (n, 6) of its `bodies` doing so, and of which `kind` it is.

    `link` names the flexure that gives way by itself, its ends at rest; else it is empty. `state` is the last stable one.
    """

    factor: float
    bodies: tuple[str, ...]
    shape: Array
    kind: Kind
    link: str
    state: State


def unstable_motions(state: State, *, locked: Sequence[str] | None = None) -> Array:
    """How many independent motions (...) lower the potential of each case: zero if it is stable. -1 where a case has no state.

    The negative eigenvalues of the stage's stiffness, and those of each flexure's own system beyond its six multipliers. Of what the state
    holds, the coordinates `locked` stay held (absent: all); the others are released under the force that held them.
    """
    whole = _system(state)
    kept = _kept(state, whole, state.held if locked is None else locked)
    count = _descents(whole, kept, state.model.freedoms) - (len(kept) - state.model.freedoms)
    for bent in whole.bent:
        count = count + np.sum(_negative(_indefinite(system(bent.tangent))) - 6, axis=0)
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

    The factor doubles from 0.001, or from 1 where the state under the whole load is `known`, each state from the one before; the change of
    `unstable_motions` is then found, to `tolerance`, as a zero of the stage's lowest stiffness, or bisected, to 1e-6 at best. Where
    steps of load find no state beside the last one the path is followed by arc length: it turns, a limit, or bends sharply. Raises
    `DesignError` for a load that is nothing and for a stage that is unstable where that begins, `NothingGivesWayError` where nothing gives
    way up to `most`.
    """
    if not any(load.values()):
        raise refuse("load", "the load whose critical factor is asked for is zero", "Name a force or moment and its size")
    held = dict(hold or {})
    require(Finding(name, "no value holds it", suggest_nearest(name, held)) for name in locked or () if name not in held)
    search = _Search(model, dict(load), dict(rest or {}), held, tuple(held if locked is None else locked), (weight, stated))
    low, high = (0.0, _FIRST) if known is None else (1.0, _GROWTH)
    last = search.at(low, known)
    if search.motions(last) != 0:
        under = "with" if low else "without"
        raise refuse("stage", f"it is not stable, or has no equilibrium, {under} the load", "Look at its weight and its stated forces")
    while low < most:
        high = min(high, most)
        found = search.at(high, last)
        if search.motions(found) != 0:
            return _close(search, low, high, last, tolerance)
        last, low, high = found, high, _GROWTH * high
    what = f"nothing gives way up to {most:g} times the load"
    raise NothingGivesWayError([Finding("load", what, "Name a larger load, or another one")])


@dataclass(frozen=True, eq=False)
class _Search:
    """A load to be scaled, and what stays: loads, coordinates, of which some are locked, and shares of weight and stated forces."""

    model: Nonlinear
    load: Mapping[str, float]
    rest: Mapping[str, float]
    hold: Mapping[str, float]
    locked: tuple[str, ...]
    shares: tuple[float, float]

    def at(self, factor: float, start: State | None) -> State:
        scaled = {name: factor * value for name, value in self.load.items()}
        weight, stated = (share + scaled.pop(name, 0.0) for share, name in zip(self.shares, (WEIGHT, STATED), strict=True))
        together = {name: scaled.get(name, 0.0) + self.rest.get(name, 0.0) for name in {**self.rest, **scaled}}
        return equilibrium(self.model, together, hold=self.hold, weight=weight, stated=stated, start=start, effort=_NEAR)

    def motions(self, state: State) -> int:
        return int(unstable_motions(state, locked=self.locked))


def _close(search: _Search, low: float, high: float, last: State, tolerance: float) -> Critical:
    """Bisect the count; once both sides are near, the stage's lowest stiffness is taken to zero instead."""
    close = 1e-2
    while high - low > max(_ROUGH, tolerance) * high:
        middle = 0.5 * (low + high)
        found = search.at(middle, last)
        if search.motions(found) == 0:
            last, low = found, middle
        elif not bool(found.converged) or high - low > close * high:
            high = middle
        else:
            sharp = _zero(search, low, middle, last, tolerance)
            if sharp is None:
                high, close = middle, 0.03 * close
            else:
                return _told(search, sharp, search.at(sharp, last), "")
    own, factor = _inside(last), 0.5 * (low + high)
    return _told(search, factor, last, own) if own else _where_lost(search, factor, last, low)


def _where_lost(search: _Search, factor: float, last: State, low: float) -> Critical:
    """A load beyond which steps find nothing near: its limit if the load turns there, else a bend of the path."""
    top, turns = follow_to_turn(course_of(last, search.load, low, _NEAR), first_point(last.pose, low))
    shape = top.step[: last.model.freedoms].reshape(-1, 6)
    return Critical(factor, last.model.bodies, shape, Kind.LIMIT if turns else Kind.BEND, "", last)


def course_of(start: State, load: Mapping[str, float], factor: float, effort: Effort) -> Course:
    """The course of a load that changes by a factor, from a state that has it so many times."""
    model = start.model
    rate = np.array([[load.get(channel.name, 0.0) for channel in model.inputs]])
    gain = Loads(rate, load.get(WEIGHT, 0.0) * model.gravity[None], load.get(STATED, 0.0) * np.ones(1))
    begun = Loads(*(getattr(start.loads, name) - factor * getattr(gain, name) for name in ("inputs", "gravity", "constant")))
    return Course(model, begun, start.hold, gain, 0.0 * start.hold.value, effort)


def _zero(search: _Search, low: float, high: float, start: State, tolerance: float) -> float | None:
    """Where the stage's lowest stiffness is zero; `None` where it is not what changes sign."""

    def lowest(factor: float) -> float:
        found = search.at(factor, start)
        return float(_lowest(found, search.locked)[0]) if bool(found.converged) else np.nan

    ends = [lowest(factor) for factor in (low, high)]
    if not np.all(np.isfinite(ends)) or ends[0] * ends[1] >= 0.0:
        return None
    try:
        return float(scipy.optimize.brentq(lowest, low, high, xtol=tolerance * high, rtol=1e-14))
    except ValueError:  # some state between them was not found
        return None


def _lowest(state: State, locked: Sequence[str]) -> tuple[float, Array]:
    """The lowest scaled stiffness among motions that keep what is `locked`, and its motion (n,)."""
    whole, freedoms = _system(state), state.model.freedoms
    kept, scale = _kept(state, whole, locked), _scale(state.model)
    if not isinstance(whole.matrix, np.ndarray):
        value, motion = nearest_descent(whole.matrix[0][kept][:, kept], scale)
        return value, motion / scale
    matrix = whole.stiffness[0][np.ix_(kept, kept)]
    stiff = 0.5 * (matrix + matrix.T)[:freedoms, :freedoms] / scale / scale[:, None]
    free = scipy.linalg.null_space(matrix[freedoms:, :freedoms] / scale) if len(matrix) > freedoms else np.eye(freedoms)
    values, vectors = np.linalg.eigh(free.T @ stiff @ free)
    return values[0], free @ vectors[:, 0] / scale


def _inside(state: State) -> str:
    """The flexure that gives way by itself, or none."""
    weakest = [
        (float(least), name)
        for group, each in zip(state.model.flexures, _system(state).bent, strict=True)
        for name, least in zip(group.names, _softest(each.tangent), strict=True)
    ]
    size, name = min(weakest, default=(1.0, ""))
    return name if size < 1e-7 else ""


def _softest(found: Tangent) -> Array:
    """How near the own system of each flexure (l,) is to being singular, in the first case."""
    return np.min(np.abs(np.linalg.eigvalsh(_indefinite(system(found))[:, 0])), axis=-1)


def _told(search: _Search, factor: float, state: State, own: str) -> Critical:
    model = search.model
    _, motion = _lowest(state, search.locked)
    gravity = search.load.get(WEIGHT, 0.0) * model.gravity[None]
    stated = search.load.get(STATED, 0.0) * np.ones_like(state.loads.constant)
    pushed = model.dead(replace(state.loads, inputs=_inputs(search), gravity=gravity, constant=stated))
    work = _work(model, state, pushed, motion)
    return Critical(factor, model.bodies, motion.reshape(-1, 6), Kind.LIMIT if work > _SEEN else Kind.BIFURCATION, own, state)


def _inputs(search: _Search) -> Array:
    names = [channel.name for channel in search.model.inputs]
    return np.array([[search.load.get(name, 0.0) for name in names]])


def _work(model: Nonlinear, state: State, dead: Array, motion: Array) -> float:
    """The load's work on a motion over both their sizes, lengths over the model's."""
    arms = (state.pose.turn[0, model.places.body] @ model.places.arm[..., None])[..., 0]
    force = np.zeros((len(model.bodies) + 1, 6))
    np.add.at(force, model.places.body, np.concatenate([dead[0, :, :3], dead[0, :, 3:] + np.cross(arms, dead[0, :, :3])], axis=-1))
    scale = _scale(model)
    scaled, moved = np.ravel(force[:-1]) / scale, motion * scale
    size = np.linalg.norm(scaled) * np.linalg.norm(moved)
    return float(abs(scaled @ moved) / size) if size > 0.0 else 0.0


def _scale(model: Nonlinear) -> Array:
    return np.tile([1.0 / model.size] * 3 + [1.0] * 3, len(model.bodies))


def _kept(state: State, whole: System, locked: Sequence[str]) -> list[int]:
    """The rows of the system without those that hold what is not `locked`."""
    first = whole.residual.shape[-1] - len(state.held)
    return [*range(first), *(first + place for place, name in enumerate(state.held) if name in locked)]


def _descents(whole: System, kept: list[int], freedoms: int) -> Array:
    """Negative eigenvalues (b,) of the rows and columns kept; of sparse matrices by their pivots."""
    if isinstance(whole.matrix, np.ndarray):
        return _negative(whole.matrix[:, kept][:, :, kept])
    known = [bool(np.isfinite(each.data).all()) for each in whole.matrix]
    return np.array([negative_pivots(each[kept][:, kept], freedoms) if good else 0 for each, good in zip(whole.matrix, known, strict=True)])


def _system(state: State) -> System:
    return assemble(state.model, state.pose, state.loads, state.hold)


def _indefinite(matrix: Array) -> Array:
    """The symmetric form of a flexure's system: the rows of its end with reversed signs."""
    size = matrix.shape[-1] - 6
    result = np.array(matrix)
    result[..., size:, :] *= -1.0
    return 0.5 * (result + np.swapaxes(result, -1, -2))


def _negative(matrix: Array) -> Array:
    """How many eigenvalues of symmetric matrices (..., n, n), scaled by their rows, are negative."""
    even = 0.5 * (matrix + np.swapaxes(matrix, -1, -2))
    size = np.sqrt(np.maximum(np.max(np.abs(even), axis=-1), 1e-300))
    return np.sum(np.linalg.eigvalsh(np.nan_to_num(even / size[..., None] / size[..., None, :])) < 0.0, axis=-1)
