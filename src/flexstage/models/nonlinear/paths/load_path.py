"""Load paths: equilibria at given values of a drive, or by arc-length continuation past limit points (docs/nonlinear.md, 26 and 27)."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import scipy

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.models.nonlinear.equilibrium import State, equilibria, equilibrium, require_equilibrium, state
from flexstage.models.nonlinear.newton import USUAL, Task, join
from flexstage.models.nonlinear.paths.arc import Point, ProportionalLoading, continue_path, critical_point, first_point
from flexstage.models.nonlinear.paths.critical_load import Critical, Kind, critical_load, proportional_loading, unstable_motions
from flexstage.models.nonlinear.paths.follow import continued
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Loads, SolverOptions, Status
from flexstage.spatial.frame import COMPONENTS


@dataclass(frozen=True, eq=False)
class Event:
    """Event between two points of a path: a `LIMIT` point of the load, or a `BIFURCATION`, where stability changes."""

    kind: Kind
    before: int
    value: float


@dataclass(frozen=True, eq=False)
class LoadPath:
    """Load path of k equilibria along `drive`: its `values` (k,) [m, rad, N, N m, or a load factor] and a `state` for each value.

    `motions` (k,) is the number of unstable motions while the drive coordinate is fixed (0: stable; -1: no equilibrium). The coordinates
    `locked` are fixed along the path.

    `turns` (k - 1,) are the extreme loads between adjacent points (NaN: the load is monotonic there). `turns` is `None` if the caller
    specified the values.
    """

    drive: str
    values: Array
    state: State
    motions: Array
    locked: tuple[str, ...] = ()
    turns: Array | None = None

    @property
    def events(self) -> tuple[Event, ...]:
        """Limit points and bifurcations, in order. The value of a bifurcation is the mean of the two adjacent drive values."""
        return tuple(itertools.chain.from_iterable(map(self._between, range(len(self.values) - 1))))

    def _between(self, place: int) -> Iterator[Event]:
        """Event between a point and the next: one motion changes at a limit point, more at a bifurcation."""
        top, motions = np.nan if self.turns is None else float(self.turns[place]), self.motions[place : place + 2]
        changes = 0 if min(motions) < 0 else abs(int(motions[1] - motions[0]))
        if np.isfinite(top):
            yield Event(Kind.LIMIT, place, top)
        if changes > np.isfinite(top):
            yield Event(Kind.BIFURCATION, place, float(np.mean(self.values[place : place + 2])))


@check_arguments
def load_path(
    model: Nonlinear,
    drive: str,
    values: Array,
    *,
    loads: Mapping[str, float] | None = None,
    hold: Mapping[str, float] | None = None,
    weight: float = 1.0,
    options: SolverOptions = USUAL,
) -> LoadPath:
    """Compute the load path for given `values` (k,) of a drive.

    The `drive` is a fixed coordinate (`platform.y`), an actuator's stroke or force, or a wrench component.

    Coordinates in `hold` are fixed at their values. The iteration at every value starts at the nominal position. If this iteration does not
    converge, it is repeated from the state of the nearest converged value.

    All stable states of the result are on one continuous path along the drive. At values that this path does not reach, stable states are
    replaced by NaN. Raises `DesignError` for an unknown drive.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> result = load_path(nonlinear(parallelogram()), "platform.x", np.linspace(-1e-4, 1e-4, 3), weight=0.0)
    >>> result.state.reactions[:, 0].round(0).tolist(), result.motions.tolist()
    ([-1939.0, 0.0, 1939.0], [0, 0, 0])
    """
    values = np.asarray(values, dtype=float)
    unloaded = equilibrium(model, loads, hold=hold, weight=weight)
    states = equilibria_along(model, drive, values, loads=loads, hold=hold, weight=weight, options=options)
    begin, start = begin_along(unloaded, drive, loads or {}, hold or {}, weight)
    states = continue_along(begin, states, values - start)
    return LoadPath(drive, values, states, unstable_motions(states), tuple(hold or {}))


def begin_along(unloaded: State, drive: str, loads: Mapping[str, float], hold: Mapping[str, float], weight: float) -> tuple[State, float]:
    """Compute the equilibrium at the start of a path along a drive, with the drive coordinate fixed, and the drive's value at the start."""
    driven = drive in {channel.name for channel in unloaded.model.inputs}
    if not bool(unloaded.converged):
        return unloaded, 0.0
    owner, _, component = drive.rpartition(".")
    start = 0.0 if driven else float(unloaded.twist(owner)[COMPONENTS.index(component)])
    held = {**({} if driven else {drive: start}), **hold}
    return equilibrium(unloaded.model, loads, hold=held, weight=weight, start=unloaded), start


def continue_along(begin: State, states: State, away: Array) -> State:
    """Return the states (k,) along a drive, such that all stable states are on one continuous path from `begin`.

    At values that this path does not reach, stable states are replaced by NaN.

    `away` (k,) are the distances of the drive from its start.
    """
    if not bool(begin.converged):
        return replace(states, status=np.where(states.converged, begin.status, states.status), reached=0.0 * states.reached)
    pose, status, reached = states.pose, np.array(states.status), np.array(states.reached)
    stable = unstable_motions(states) == 0
    last = dict.fromkeys((False, True), (Task(begin.model, begin.pose, begin.loads, begin.hold), 0.0))
    for case in np.argsort(np.abs(away)):
        if not stable[case]:
            continue
        one, distance, side = np.array([case]), float(away[case]), bool(away[case] > 0.0)
        before, covered = last[side]
        end = Task(states.model, pose.of(one), states.loads.of(one), states.hold.of(one))
        after = continued(before, end)
        status[case], pose = after.status[0], pose.put(one, after.pose)
        if status[case] == Status.CONVERGED:
            last[side] = (replace(end, start=after.pose), distance)
        else:
            reached[case] = (covered + float(after.reached[0]) * (distance - covered)) / distance
    return replace(states, pose=pose, status=status, reached=reached)


def equilibria_along(
    model: Nonlinear,
    drive: str,
    values: Array,
    *,
    loads: Mapping[str, float] | None = None,
    hold: Mapping[str, float] | None = None,
    weight: float = 1.0,
    options: SolverOptions = USUAL,
) -> State:
    """Compute the states (k,) of a load path like `load_path`, but without stability and events, and without a check of continuity.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> equilibria_along(nonlinear(parallelogram()), "platform.x", np.array([0.0, 1e-4]), weight=0.0).reactions[:, 0].round(0).tolist()
    [0.0, 1939.0]
    """
    values, others, locked, options = np.asarray(values, dtype=float), dict(loads or {}), dict(hold or {}), replace(options, arcs=0)
    known = {channel.name for channel in model.inputs}

    def at(some: Array, start: State | None) -> State:
        if drive in known:
            driven = {**others, drive: some + others.get(drive, 0.0)}
            return equilibrium(model, driven, hold=locked, weight=weight, start=start, options=options)
        return equilibrium(model, others, hold={drive: some, **locked}, weight=weight, start=start, options=options)

    states = at(values, None)
    while 0 < (count := int(np.sum(states.converged))) < values.size:
        states = at(values, _neighbour(states))
        if int(np.sum(states.converged)) <= count:
            break
    return states


def equilibria_of_designs(
    models: Sequence[Nonlinear],
    drive: str,
    values: Sequence[Array],
    *,
    loads: Mapping[str, float],
    hold: Sequence[Mapping[str, float]],
    weight: float = 1.0,
) -> list[State]:
    """Compute the states of `equilibria_along` for several designs of the same structure.

    `values` has an array (k,) and `hold` a mapping for each design.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> (result,) = equilibria_of_designs([nonlinear(parallelogram())], "platform.x", [np.array([1e-4])], loads={}, hold=[{}], weight=0.0)
    >>> result.reactions[:, 0].round(0).tolist()
    [1939.0]
    """
    alone = [
        partial(equilibria_along, model, drive, some, loads=loads, hold=locked, weight=weight)
        for model, some, locked in zip(models, values, hold, strict=True)
    ]
    if drive in {channel.name for channel in models[0].inputs}:
        return [each() for each in alone]
    held = [{drive: some, **locked} for some, locked in zip(values, hold, strict=True)]
    states = equilibria(models, loads, hold=held, weight=weight, options=replace(USUAL, arcs=0))
    return [one if one.converged.all() else again() for one, again in zip(states, alone, strict=True)]


def _neighbour(states: State) -> State:
    """Restart every failed case from the nearest converged one."""
    places, good = np.arange(len(states.status)), np.flatnonzero(states.converged)
    nearest = good[np.argmin(np.abs(places[:, None] - good), axis=1)]
    chosen = np.where(states.converged, places, nearest)
    return replace(states, pose=states.pose.of(chosen))


@check_arguments
def continuation(
    model: Nonlinear,
    load: Mapping[str, float],
    *,
    step: float = 0.02,
    points: int = 60,
    rest: Mapping[str, float] | None = None,
    hold: Mapping[str, float] | None = None,
    weight: float = 1.0,
    options: SolverOptions = USUAL,
) -> LoadPath:
    """Compute equilibria under `load` times a varying factor by arc-length continuation, past limit points.

    `step` is the maximum norm of the body motion between two points (translations divided by the longest flexure length, rotations in
    radians); steps are shorter on a curved path. The path has the length `points` times `step`, and ends earlier if there is no further
    equilibrium. Coordinates in `hold` are fixed at their values.

    The method is by Riks (Int J Solids Structures 15, 1979), with corrections normal to the first step.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> result = continuation(nonlinear(parallelogram()), {"platform.fx": 100.0}, points=2, weight=0.0)
    >>> result.values.size, bool(result.state.converged.all())
    (3, True)
    """
    start = equilibrium(model, rest or {}, hold=hold, weight=weight)
    require_equilibrium(start)
    names = [channel.name for channel in model.inputs]
    unknown = [name for name in load if name not in names]
    if unknown or not any(load.values()):
        raise refuse(", ".join(unknown) or "load", "unknown load, or load of zero", "Specify a force, moment or stroke with its size")
    loading = proportional_loading(start, load, 0.0, options)
    begin = first_point(loading, start.pose, 0.0)
    return _along(loading, [begin, *continue_path(loading, begin, step, points)], start.held)


@check_arguments
def post_buckling_path(
    model: Nonlinear,
    load: Mapping[str, float],
    *,
    side: float = 1.0,
    step: float = 0.02,
    points: int = 60,
    rest: Mapping[str, float] | None = None,
    weight: float = 1.0,
    options: SolverOptions = USUAL,
) -> LoadPath:
    """Compute the post-buckling path: equilibria on the branch that begins at the first bifurcation under `load` times a varying factor.

    The first state is the last stable state before the bifurcation. From the first to the second state, the stage moves in the direction of
    the buckling mode `Critical.shape`; with `side` -1, in the opposite direction. `step` and `points` have the same meaning as in
    `continuation`.

    Raises the errors of `critical_load`. Raises `DesignError` for a limit point (use `continuation`), for a flexure that buckles between
    fixed ends, and if there is no equilibrium on the branch.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> result = post_buckling_path(nonlinear(parallelogram()), {"platform.fx": -1e3}, points=2, weight=0.0)
    >>> result.values.round(3).tolist()
    [11.063, 11.065, 11.069]
    """
    critical = critical_load(model, load, rest=rest, weight=weight)
    if critical.kind is Kind.LIMIT:
        raise refuse(
            "load", f"limit point without a branch at {critical.factor:.6g} times the load", "Follow the load with fs.continuation"
        )
    return beyond(critical, load, side=side, step=step, points=points, options=options)


def beyond(
    critical: Critical,
    load: Mapping[str, float],
    *,
    side: float = 1.0,
    step: float = 0.02,
    points: int = 60,
    options: SolverOptions = USUAL,
) -> LoadPath:
    """Compute equilibria beyond a critical point, at varying load factors: on the branch of a bifurcation, or past a limit point or bend.

    `critical` is the result of `critical_load` for the load. `side`, `step` and `points` have the same meaning as in `post_buckling_path`.
    Past a limit point or a bend, the path has only one side.

    Raises `DesignError` for a side that does not exist, for a flexure that buckles between fixed ends, and if there is no equilibrium.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> load = {"platform.fx": -1e3}
    >>> given = critical_load(nonlinear(parallelogram()), load, weight=0.0)
    >>> beyond(given, load, side=-1.0, points=2).values.round(3).tolist()
    [11.063, 11.065, 11.069]
    """
    start, what = critical.state, f"at {critical.factor:.6g} times the load"
    if critical.kind is not Kind.BIFURCATION and side < 0.0:
        raise refuse("side", f"{what} the path continues to one side only ({critical.kind.value} point)", "Use the other side")
    if critical.link and critical.kind is Kind.BIFURCATION:
        raise refuse(
            critical.link, f"{what} the flexure buckles between fixed ends", "Model the flexure as two parts with a light body between them"
        )
    loading, into = proportional_loading(start, load, critical.factor, options), None
    if critical.kind is Kind.BIFURCATION:
        others = np.zeros(len(loading.scale) - start.model.freedoms)
        into = np.concatenate([np.sign(side) * np.ravel(critical.shape), others])
    begin = critical_point(loading, start.pose, critical.factor, into)
    path = [begin, *continue_path(loading, begin, step, points)]
    if len(path) == 1:
        raise refuse("load", f"no equilibrium beyond the critical point {what}", "Use a smaller step")
    return _along(loading, path, start.held)


def _along(loading: ProportionalLoading, path: list[Point], held: tuple[str, ...]) -> LoadPath:
    factors, count = np.array([each.factor for each in path]), len(path)
    loads, hold = loading.at(0.0)
    inputs, gravity = (getattr(loads, name) + factors[:, None] * getattr(loading.gain, name) for name in ("inputs", "gravity"))
    along = Loads(inputs, gravity, loads.constant + factors * loading.gain.constant)
    whole = join([each.found for each in path])
    states = state(loading.model, along, replace(hold, value=np.repeat(hold.value, count, axis=0)), whole, ((count,), held))
    motions = np.array([each.motions for each in path])
    return LoadPath("factor", factors, states, motions, held, np.array([_turn(*pair) for pair in itertools.pairwise(path)]))


def _turn(one: Point, other: Point) -> float:
    """The extreme factor between two points, of the cubic with their values and slopes; NaN if monotonic."""
    if one.slope * other.slope >= 0.0:
        return np.nan
    cubic = scipy.interpolate.CubicHermiteSpline([0.0, np.linalg.norm(other.step)], [one.factor, other.factor], [one.slope, other.slope])
    return float(cubic(cubic.derivative().roots(extrapolate=False)[0]))
