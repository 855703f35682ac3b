"""Newton's method on everything at once: bodies, flexures' amplitudes and forces, reactions (docs/nonlinear.md, 21)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.models.nonlinear.compiled import iterate_compiled, kernel, tables
from flexstage.models.nonlinear.graph import System, advance, apart, assemble, rest
from flexstage.models.nonlinear.hold import Hold
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Effort, Loads, Pose, Status, put
from flexstage.models.nonlinear.walk import walked

_CHUNK, _STREAM = 128, 2048
"""Cases at once: what they need stays in the processor's caches; and of a stage whose iterations are all in C, where lanes refill."""


USUAL = Effort()
TOLD = ("status", "iterations", "residual", "reached")
"""What is told of every case."""


@dataclass(frozen=True, eq=False)
class Found:
    """Poses of b cases, each with its status, its iterations, the last residual of its flexures, and the share of its load `reached`.

    A case that failed has the pose of that share, if there is one above zero, or the one it began from.
    """

    pose: Pose
    status: Array
    iterations: Array
    residual: Array
    reached: Array

    def of(self, cases: Array) -> Found:
        """Some of the cases."""
        return Found(self.pose.of(cases), *(getattr(self, name)[cases] for name in TOLD))


def equilibrate(model: Nonlinear, start: Pose, loads: Loads, hold: Hold, effort: Effort = USUAL) -> Found:
    """The equilibrium of every case, the whole load at once; what fails so is loaded in steps."""
    cases = np.arange(len(loads.inputs))
    most = _STREAM if _all_compiled(model, hold) else _CHUNK
    chunks = [search(model, start.of(part), loads.of(part), hold.of(part), effort) for part in _split(cases, most)]
    found = join(chunks)
    return _by_steps(model, start, loads, hold, effort=effort, found=found)


def _split(cases: Array, most: int) -> list[Array]:
    return np.array_split(cases, max(1, -(-len(cases) // most)))


def _all_compiled(model: Nonlinear, hold: Hold) -> bool:
    """Whether the kernel knows all of the stage: flexures and dead loads, nothing else and nothing held."""
    others = model.hinges.names or model.elements or len(hold.body)
    return not others and kernel() is not None and tables(model) is not None


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
    return Found(pose, *(np.concatenate([getattr(part, name) for part in parts]) for name in TOLD))


def _by_steps(model: Nonlinear, start: Pose, loads: Loads, hold: Hold, *, effort: Effort, found: Found) -> Found:
    """What failed, loaded in steps: twice as long after each that is found, half as long after each that is not."""
    failed = np.flatnonzero(found.status != Status.CONVERGED)
    share, width, pose = np.zeros(len(failed)), np.full(len(failed), 0.5), start.of(failed)
    loads, hold = loads.of(failed), hold.of(failed)
    while (active := np.flatnonzero((share < 1.0) & (width >= 0.5**effort.halvings))).size:
        aim = np.minimum(1.0, share[active] + width[active])
        target = replace(hold.of(active), value=aim[:, None] * hold.value[active])
        again = search(model, pose.of(active), loads.of(active).times(aim), target, effort)
        good = again.status == Status.CONVERGED
        width[active] *= np.where(good, 2.0, 0.5)
        share[active[good]] = aim[good]
        pose = pose.put(active[good], again.pose.of(np.flatnonzero(good)))
        whole = np.flatnonzero(aim == 1.0)
        found = _merge(found, failed[active[whole]], again.of(whole))
    reached = replace(found, reached=put(found.reached, failed, share))
    lost = reached.status[failed] != Status.CONVERGED
    return replace(reached, pose=reached.pose.put(failed[lost], pose.of(np.flatnonzero(lost))))


def _merge(found: Found, cases: Array, other: Found) -> Found:
    return Found(found.pose.put(cases, other.pose), *(put(getattr(found, name), cases, getattr(other, name)) for name in TOLD))


def search(model: Nonlinear, start: Pose, loads: Loads, hold: Hold, effort: Effort) -> Found:
    """Iterate all cases together; those that are done leave. In C where there is a kernel that knows all of the stage's flexures."""
    compiled = kernel() is not None and tables(model) is not None
    if _all_compiled(model, hold):
        found = iterate_compiled(model, start, loads, effort, None)
        return Found(found.pose, found.status, found.count, found.lack, 1.0 * (found.status == Status.CONVERGED))
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
    return Found(pose, status, iterations, residual, 1.0 * (status == Status.CONVERGED))


def _iterate_compiled(model: Nonlinear, pose: Pose, loads: Loads, hold: Hold, effort: Effort) -> tuple[Pose, Array, Array]:
    """As `iterate`, flexures, loads and the solution in C."""
    found = iterate_compiled(model, pose, loads, replace(effort, iterations=1), rest(model, pose, loads, hold))
    return found.pose, found.moved, found.lack


def iterate(model: Nonlinear, pose: Pose, loads: Loads, hold: Hold, effort: Effort) -> tuple[Pose, Array, Array]:
    """One step: the pose after it, the step's size (b,) and how large the flexures' residuals were before it (b,)."""
    system = assemble(model, pose, loads, hold)
    step = system.solved(-system.residual)
    size = motion(model, step, model.size)
    many = not isinstance(system.matrix, np.ndarray)
    far = apart(model, system.bent, step) if many else motion(model, step, model.reach)
    share = np.minimum(1.0, effort.limit / np.maximum(far, effort.limit))
    after, inside = advance(model, pose, system.bent, step, share)
    return walked(model, after, loads) if many else after, np.maximum(size, inside), lack(model, system)


def motion(model: Nonlinear, step: Array, length: float) -> Array:
    """The largest motion (b,) in a step (b, n): translations over a length, radians."""
    moved = step[:, : model.freedoms].reshape(len(step), -1, 6)
    over = np.array([length] * 3 + [1.0] * 3)
    return np.max(np.abs(moved) / over, axis=(1, 2))


def lack(model: Nonlinear, system: System) -> Array:
    """The largest residual (b,) inside flexures: gaps, and forces on amplitudes over their stiffness; locked freedoms' too."""
    found = [np.zeros(len(system.residual))]
    for group, bent in zip(model.flexures, system.bent, strict=True):
        stiff = np.max(np.diagonal(group.law.form, axis1=-2, axis2=-1), axis=-1)[:, None]
        found += [np.max(np.abs(bent.gap), axis=(0, 2)), np.max(np.max(np.abs(bent.tangent.gradient), axis=-1) / stiff, axis=0)]
    held = system.residual[:, model.freedoms :]
    return np.max(np.stack([*found, np.max(np.abs(held), axis=1, initial=0.0)]), axis=0)
