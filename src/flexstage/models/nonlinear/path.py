"""Paths of equilibria: over a drive from end to end, or along a load past the points where it turns (docs/nonlinear.md, 26 and 27)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.models.nonlinear.condense import solve
from flexstage.models.nonlinear.critical import Kind, unstable_motions
from flexstage.models.nonlinear.equilibrium import State, equilibrium, state
from flexstage.models.nonlinear.graph import advance, assemble, exerted_by
from flexstage.models.nonlinear.hold import Hold
from flexstage.models.nonlinear.newton import USUAL, Found, join, lack, motion
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Effort, Loads, Pose, Status


@dataclass(frozen=True, eq=False)
class Event:
    """What happens between two points of a path: a `LIMIT`, where the load turns, or a `BIFURCATION`, where stability is lost or won."""

    kind: Kind
    before: int
    value: float


@dataclass(frozen=True, eq=False)
class Path:
    """Equilibria (k,) along `drive`: its `values` (k,) [m, rad, N, N m; or a factor on a load], the `state` of each.

    `motions` (k,) is how many ways each would leave its equilibrium (0: stable; -1: not found), what a held drive holds counted as held.
    `locked` coordinates stay where they are along it.
    """

    drive: str
    values: Array
    state: State
    motions: Array
    locked: tuple[str, ...] = ()

    @property
    def events(self) -> tuple[Event, ...]:
        """Limits and changes of stability, in order, each at the mean of the values beside it."""
        found = []
        for place in range(1, len(self.values)):
            middle = 0.5 * (self.values[place - 1] + self.values[place])
            if place > 1 and np.diff(self.values[place - 2 : place]) * np.diff(self.values[place - 1 : place + 1]) < 0.0:
                found.append(Event(Kind.LIMIT, place - 1, float(self.values[place - 1])))
            elif min(self.motions[place - 1 : place + 1]) >= 0 and self.motions[place - 1] != self.motions[place]:
                found.append(Event(Kind.BIFURCATION, place - 1, float(middle)))
        return tuple(found)


def path(
    model: Nonlinear,
    drive: str,
    values: Array,
    *,
    loads: Mapping[str, float] | None = None,
    hold: Mapping[str, float] | None = None,
    weight: float = 1.0,
    effort: Effort = USUAL,
) -> Path:
    """Equilibria as `drive` takes `values` (k,): a coordinate that is held (`platform.y`), or an actuator's stroke, force or a wrench.

    Coordinates in `hold` stay locked at their values. All values are tried at once from the drawn position; what fails starts again from
    its nearest neighbour that was found. Raises `DesignError` for a drive that the stage does not have.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> found = path(nonlinear(parallelogram()), "platform.x", np.linspace(-1e-4, 1e-4, 3), weight=0.0)
    >>> found.state.reactions[:, 0].round(0).tolist(), found.motions.tolist()
    ([-1939.0, 0.0, 1939.0], [0, 0, 0])
    """
    values, rest, locked = np.asarray(values, dtype=float), dict(loads or {}), dict(hold or {})
    known = {channel.name for channel in model.inputs}

    def at(some: Array, start: State | None) -> State:
        if drive in known:
            driven = {**rest, drive: some + rest.get(drive, 0.0)}
            return equilibrium(model, driven, hold=locked, weight=weight, start=start, effort=effort)
        return equilibrium(model, rest, hold={drive: some, **locked}, weight=weight, start=start, effort=effort)

    found = at(values, None)
    while 0 < (count := int(np.sum(found.converged))) < values.size:
        found = at(values, _neighbour(found))
        if int(np.sum(found.converged)) <= count:
            break
    return Path(drive, values, found, unstable_motions(found), tuple(locked))


def _neighbour(found: State) -> State:
    """The state with every case that failed begun from the nearest that did not."""
    places, good = np.arange(len(found.status)), np.flatnonzero(found.converged)
    nearest = good[np.argmin(np.abs(places[:, None] - good), axis=1)]
    chosen = np.where(found.converged, places, nearest)
    return replace(found, pose=found.pose.of(chosen))


def trace(
    model: Nonlinear,
    load: Mapping[str, float],
    *,
    step: float = 0.02,
    points: int = 60,
    rest: Mapping[str, float] | None = None,
    hold: Mapping[str, float] | None = None,
    weight: float = 1.0,
    effort: Effort = USUAL,
) -> Path:
    """Equilibria along the factor on `load`, by arc length: past limits, where the load turns and the stage goes on.

    `step` is the length of a step in the motion of the bodies, over the flexures' length and in radians; `points` how many steps at most.
    Coordinates in `hold` stay locked at their values. The path ends where no further equilibrium is found. After E. Riks (Int. J. Solids
    Structures 15, 1979), steps normal to the first of each.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> found = trace(nonlinear(parallelogram()), {"platform.fx": 100.0}, points=2, weight=0.0)
    >>> found.values.size, bool(found.state.converged.all())
    (3, True)
    """
    start = equilibrium(model, rest or {}, hold=hold, weight=weight)
    if not bool(start.converged):
        raise refuse("stage", "it has no equilibrium without the load", "Look at its weight and its stated forces")
    names = [channel.name for channel in model.inputs]
    unknown = [name for name in load if name not in names]
    if unknown or not any(load.values()):
        raise refuse(", ".join(unknown) or "load", "it is no load of this stage, or zero", "Name a force, moment or stroke and its size")
    rate = Loads(np.array([[load.get(name, 0.0) for name in names]]), np.zeros((1, 3)), np.zeros(1))
    tracing = _Tracing(model, start.loads, rate, start.hold, effort)
    found, factors, last = [Found(start.pose, np.array([Status.CONVERGED]), np.zeros(1, dtype=int), np.zeros(1), np.ones(1))], [0.0], None
    for _ in range(points):
        after = _step(tracing, found[-1].pose, factors[-1], last, step)
        if after is None:
            break
        found.append(after[0])
        factors.append(after[1])
        last = after[2]
    whole, count = join(found), len(factors)
    inputs = start.loads.inputs + np.array(factors)[:, None] * rate.inputs
    loads = Loads(inputs, np.repeat(start.loads.gravity, count, axis=0), np.repeat(start.loads.constant, count))
    held = replace(start.hold, value=np.repeat(start.hold.value, count, axis=0))
    states = state(model, loads, held, whole, ((count,), start.held))
    return Path("factor", np.array(factors), states, unstable_motions(states), start.held)


@dataclass(frozen=True, eq=False)
class _Tracing:
    model: Nonlinear
    rest: Loads
    rate: Loads
    hold: Hold
    effort: Effort

    def loads(self, factor: float) -> Loads:
        return Loads(self.rest.inputs + factor * self.rate.inputs, self.rest.gravity, self.rest.constant)


def _step(tracing: _Tracing, pose: Pose, factor: float, last: Array | None, length: float) -> tuple[Found, float, Array] | None:
    """The next point: its pose, factor and the step (n,) to it; `None` where none is found."""
    model, effort = tracing.model, tracing.effort
    scale = np.concatenate(
        [np.tile([1.0 / model.size] * 3 + [1.0] * 3, len(model.bodies)), np.zeros(len(model.hinges.locked) + len(tracing.hold.body))]
    )
    whole, sign = np.zeros(len(scale)), 1.0
    with np.errstate(all="ignore"):
        for iteration in range(effort.iterations):
            system = assemble(model, pose, tracing.loads(factor), tracing.hold)
            pushed = np.append(exerted_by(model, pose, tracing.rate)[0], np.zeros(len(tracing.hold.body)))
            right = np.stack([-system.residual[0], pushed], axis=-1)
            own, along = solve(system.stiffness, right[None])[0].T
            if iteration == 0:
                sign = 1.0 if last is None or (along * scale) @ (last * scale) >= 0.0 else -1.0
                change = sign * length / float(np.linalg.norm(along * scale))
            else:
                change = -float((whole * scale) @ (own * scale) / ((whole * scale) @ (along * scale)))
            moved = own + change * along
            size, gap = float(motion(model, moved[None], model.size)[0]), float(lack(model, system)[0])
            if not np.isfinite(size + gap) or size > 20.0 * length:
                return None
            pose, inside = advance(model, pose, system.bent, moved[None], np.ones(1))
            factor, whole, size = factor + change, whole + moved, max(size, float(inside[0]))
            if iteration and size < effort.step and gap < effort.gap and abs(change) <= 1e-9 * max(abs(factor), abs(factor - change)):
                return Found(pose, np.array([Status.CONVERGED]), np.array([iteration + 1]), np.array([gap]), np.ones(1)), factor, whole
    return None
