"""Newton's method on everything at once: bodies, flexures' amplitudes and forces, reactions (docs/nonlinear.md, 21)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.models.nonlinear.compiled import iterate_compiled, kernel, tables
from flexstage.models.nonlinear.condense import solve
from flexstage.models.nonlinear.graph import System, advance, assemble, rest
from flexstage.models.nonlinear.hold import Hold
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Effort, Loads, Pose, Status, put

_CHUNK = 128
"""Cases at once: what they need stays in the processor's caches."""


USUAL = Effort()


@dataclass(frozen=True, eq=False)
class Found:
    """Poses of b cases, each with its status, its iterations and the last residual of its flexures."""

    pose: Pose
    status: Array
    iterations: Array
    residual: Array


def equilibrate(model: Nonlinear, start: Pose, loads: Loads, hold: Hold, effort: Effort = USUAL) -> Found:
    """The equilibrium of every case, the whole load at once; what fails so is loaded in halved steps, up to 64."""
    cases = np.arange(len(loads.inputs))
    chunks = [_search(model, start.of(part), loads.of(part), hold.of(part), effort) for part in _split(cases)]
    found = join(chunks)
    return _by_halves(model, start, loads, hold, (effort, found))


def _split(cases: Array) -> list[Array]:
    return np.array_split(cases, max(1, -(-len(cases) // _CHUNK)))


def join(parts: list[Found]) -> Found:
    """What was found in several batches as one."""
    if len(parts) == 1:
        return parts[0]
    poses = [part.pose for part in parts]
    strain, wrench = (
        tuple(np.concatenate(group, axis=1) for group in zip(*(getattr(pose, name) for pose in poses), strict=True))
        for name in ("strain", "wrench")
    )
    pose = Pose(
        np.concatenate([each.position for each in poses]),
        np.concatenate([each.turn for each in poses]),
        strain,
        wrench,
        np.concatenate([each.held for each in poses]),
    )
    status, iterations, residual = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("status", "iterations", "residual")
    )
    return Found(pose, status, iterations, residual)


def _by_halves(model: Nonlinear, start: Pose, loads: Loads, hold: Hold, tried: tuple[Effort, Found]) -> Found:
    effort, found = tried
    rest = Loads(np.zeros_like(loads.inputs), np.zeros_like(loads.gravity), np.zeros_like(loads.constant))
    for halving in range(1, effort.halvings + 1):
        failed = np.flatnonzero(found.status != Status.CONVERGED)
        if not failed.size:
            return found
        mine, all_of, held = start.of(failed), loads.of(failed), hold.of(failed)
        again = None
        for step in range(1, 2**halving + 1):
            share = step / 2**halving
            target = Hold(held.body, held.arm, held.component, held.origin, share * held.value)
            again = _search(model, mine, rest.of(failed).between(all_of, share), target, effort)
            mine = again.pose
        found = _merge(found, failed, again) if again is not None else found
    return found


def _merge(found: Found, cases: Array, other: Found) -> Found:
    status, iterations, residual = (put(getattr(found, name), cases, getattr(other, name)) for name in ("status", "iterations", "residual"))
    return Found(found.pose.put(cases, other.pose), status, iterations, residual)


def _search(model: Nonlinear, start: Pose, loads: Loads, hold: Hold, effort: Effort) -> Found:
    """Iterate all cases together; those that are done leave. In C where there is a kernel that knows all of the stage's flexures."""
    compiled = kernel() is not None and tables(model) is not None
    if compiled and not model.hinges.names and not len(hold.body):
        found = iterate_compiled(model, start, loads, effort, None)
        return Found(found.pose, found.status, found.count, found.lack)
    count = len(loads.inputs)
    status, iterations, residual = np.full(count, Status.NOT_CONVERGED), np.zeros(count, dtype=int), np.full(count, np.inf)
    pose, active = start, np.arange(count)
    with np.errstate(all="ignore"):
        for _ in range(effort.iterations):
            if not active.size:
                break
            here = pose.of(active)
            step = _iterate_compiled if compiled else iterate
            after, size, gap = step(model, here, loads.of(active), hold.of(active), effort)
            pose = pose.put(active, after)
            iterations[active] += 1
            residual[active] = gap
            lost = ~np.isfinite(size)
            done = (size < effort.step) & (gap < effort.gap)
            status[active[done]], status[active[lost]] = Status.CONVERGED, Status.SINGULAR
            active = active[~(done | lost)]
    return Found(pose, status, iterations, residual)


def _iterate_compiled(model: Nonlinear, pose: Pose, loads: Loads, hold: Hold, effort: Effort) -> tuple[Pose, Array, Array]:
    """As `iterate`, flexures, loads and the solution in C."""
    found = iterate_compiled(model, pose, loads, replace(effort, iterations=1), rest(model, pose, loads, hold))
    return found.pose, found.moved, found.lack


def iterate(model: Nonlinear, pose: Pose, loads: Loads, hold: Hold, effort: Effort) -> tuple[Pose, Array, Array]:
    """One step: the pose after it, the step's size (b,) and how large the flexures' residuals were before it (b,)."""
    system = assemble(model, pose, loads, hold)
    step = solve(system.stiffness, -system.residual[..., None])[..., 0]
    size = motion(model, step)
    share = np.minimum(1.0, effort.limit / np.maximum(size, effort.limit))
    after, inside = advance(model, pose, system.bent, step, share)
    return after, np.maximum(size, inside), lack(model, system)


def motion(model: Nonlinear, step: Array) -> Array:
    """The largest motion (b,) in a step (b, n): lengths over the flexures' length, radians."""
    moved = step[:, : model.freedoms].reshape(len(step), -1, 6)
    over = np.array([model.size] * 3 + [1.0] * 3)
    return np.max(np.abs(moved) / over, axis=(1, 2))


def lack(model: Nonlinear, system: System) -> Array:
    """The largest residual (b,) inside flexures: gaps, and forces on amplitudes over their stiffness; locked freedoms' too."""
    found = [np.zeros(len(system.residual))]
    for group, bent in zip(model.flexures, system.bent, strict=True):
        stiff = np.max(np.diagonal(group.law.form, axis1=-2, axis2=-1), axis=-1)[:, None]
        found += [np.max(np.abs(bent.gap), axis=(0, 2)), np.max(np.max(np.abs(bent.tangent.gradient), axis=-1) / stiff, axis=0)]
    held = system.residual[:, model.freedoms :]
    return np.max(np.stack([*found, np.max(np.abs(held), axis=1, initial=0.0)]), axis=0)
