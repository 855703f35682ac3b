"""Newton's method on all unknowns: bodies, flexure amplitudes and forces, reactions (docs/nonlinear.md, 21)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.models.nonlinear.compiled import iterate_compiled, kernel, tables
from flexstage.models.nonlinear.elements.fixed_coordinates import FixedCoordinates
from flexstage.models.nonlinear.graph import OtherTerms, System, advance, assemble, end_displacement, other_terms
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.state import Loads, Pose, SolverOptions, Status, put
from flexstage.models.nonlinear.walk import walk_tree

_CHUNK, _STREAM, _DESIGNS = 128, 2048, 32
"""Cases at once, to fit the processor cache; cases of a stage that is iterated in C only, where lanes refill; and designs."""


USUAL = SolverOptions()
RESULT_FIELDS = ("status", "iterations", "residual", "reached")
"""Names of the result fields that have one value per case."""
_GOES_ON = -1
_OF_DESIGNS = ("turn", "arm_first", "arm_second", "stiffness", "stroke", "thrust", "push", "strut", "bow")
"""Fields of links about centres that differ from design to design."""


@dataclass(frozen=True, eq=False)
class EquilibriumSolution:
    """Poses of b cases with `status`, number of `iterations`, last `residual` (see `lack`), and load fraction `reached`.

    A failed case has the pose at the load fraction `reached`, or its start pose if this fraction is zero.
    """

    pose: Pose
    status: Array
    iterations: Array
    residual: Array
    reached: Array

    def of(self, cases: Array) -> EquilibriumSolution:
        """Return the solution of some cases."""
        return EquilibriumSolution(self.pose.of(cases), *(getattr(self, name)[cases] for name in RESULT_FIELDS))


def equilibrate(model: Nonlinear, start: Pose, loads: Loads, hold: FixedCoordinates, options: SolverOptions = USUAL) -> EquilibriumSolution:
    """Compute the equilibrium of every case under its full load. If a case does not converge, its load is applied in steps."""
    cases = np.arange(len(loads.inputs))
    most = _STREAM if _all_compiled(model, hold) else _CHUNK
    chunks = [search(model, start.of(part), loads.of(part), hold.of(part), options) for part in _split(cases, most)]
    solution = join(chunks)
    return _by_steps(model, start, loads, hold, options=options, solution=solution)


def equilibrate_designs(tasks: Sequence[Task], options: SolverOptions = USUAL) -> list[EquilibriumSolution]:
    """Compute the equilibria of designs of the same structure, in groups of several designs."""
    several = min(_DESIGNS, max(1, _CHUNK // len(tasks[0].loads.inputs)))
    if several == 1:
        return [equilibrate(*_parts(each), options) for each in tasks]
    chunks = [tasks[first : first + several] for first in range(0, len(tasks), several)]
    solutions = [each for chunk in chunks for each in search_designs(chunk, options)]
    return [_by_steps(*_parts(task), options=options, solution=each) for task, each in zip(tasks, solutions, strict=True)]


def _split(cases: Array, most: int) -> list[Array]:
    return np.array_split(cases, max(1, -(-len(cases) // most)))


def _all_compiled(model: Nonlinear, hold: FixedCoordinates) -> bool:
    """Whether the kernel supports the whole stage: only flexures and constant-direction loads, no fixed coordinates."""
    others = model.hinges.names or model.elements or len(hold.body)
    return not others and kernel() is not None and tables(model) is not None


def join(parts: list[EquilibriumSolution]) -> EquilibriumSolution:
    """Join the results of several batches."""
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
    return EquilibriumSolution(pose, *(np.concatenate([getattr(part, name) for part in parts]) for name in RESULT_FIELDS))


def _by_steps(
    model: Nonlinear, start: Pose, loads: Loads, hold: FixedCoordinates, *, options: SolverOptions, solution: EquilibriumSolution
) -> EquilibriumSolution:
    """Load failed cases in steps: twice the step after success, half after failure."""
    failed = np.flatnonzero(solution.status != Status.CONVERGED)
    share, width, pose = np.zeros(len(failed)), np.full(len(failed), 0.5), start.of(failed)
    loads, hold = loads.of(failed), hold.of(failed)
    while (active := np.flatnonzero((share < 1.0) & (width >= 0.5**options.halvings))).size:
        aim = np.minimum(1.0, share[active] + width[active])
        target = replace(hold.of(active), value=aim[:, None] * hold.value[active])
        again = search(model, pose.of(active), loads.of(active).times(aim), target, options)
        good = again.status == Status.CONVERGED
        width[active] *= np.where(good, 2.0, 0.5)
        share[active[good]] = aim[good]
        pose = pose.put(active[good], again.pose.of(np.flatnonzero(good)))
        whole = np.flatnonzero(aim == 1.0)
        solution = merge(solution, failed[active[whole]], again.of(whole))
    reached = replace(solution, reached=put(solution.reached, failed, share))
    lost = reached.status[failed] != Status.CONVERGED
    return replace(reached, pose=reached.pose.put(failed[lost], pose.of(np.flatnonzero(lost))))


def merge(solution: EquilibriumSolution, cases: Array, other: EquilibriumSolution) -> EquilibriumSolution:
    """Return a result in which some cases are replaced by the cases of another result."""
    return EquilibriumSolution(
        solution.pose.put(cases, other.pose), *(put(getattr(solution, name), cases, getattr(other, name)) for name in RESULT_FIELDS)
    )


def search(model: Nonlinear, start: Pose, loads: Loads, hold: FixedCoordinates, options: SolverOptions) -> EquilibriumSolution:
    """Iterate all cases together until every case is finished; the iteration is in C if the kernel supports all flexures of the stage."""
    (solutions,) = search_designs((Task(model, start, loads, hold),), options)
    return solutions


@dataclass(frozen=True, eq=False)
class Task:
    """Cases of one design: start poses, loads, fixed coordinates."""

    model: Nonlinear
    start: Pose
    loads: Loads
    hold: FixedCoordinates

    def of(self, cases: Array, pose: Pose) -> Task:
        """Return the task for some cases, with start poses from `pose`, which contains the poses of all cases."""
        return Task(self.model, pose.of(cases), self.loads.of(cases), self.hold.of(cases))


@dataclass(frozen=True, eq=False)
class _Search:
    """State of an iteration, updated in place: results of every case (b,), and the active cases."""

    task: Task
    status: Array
    iterations: Array
    residual: Array

    @staticmethod
    def of(task: Task) -> _Search:
        count = len(task.loads.inputs)
        return _Search(task, np.full(count, _GOES_ON), np.zeros(count, dtype=int), np.full(count, np.inf))

    @property
    def active(self) -> Array:
        return np.flatnonzero(self.status == _GOES_ON)

    def take(self, cases: Array, step: _Step, options: SolverOptions) -> None:
        """Update the results of the cases of a step."""
        self.iterations[cases] += 1
        self.residual[cases] = step.gap
        lost = ~np.isfinite(step.size)
        done = (step.size < options.step) & (step.gap < options.gap)
        self.status[cases[done]], self.status[cases[lost]] = Status.CONVERGED, Status.SINGULAR

    def found(self, pose: Pose) -> EquilibriumSolution:
        status = np.where(self.status == _GOES_ON, Status.NOT_CONVERGED, self.status)
        return EquilibriumSolution(pose, status, self.iterations, self.residual, 1.0 * (status == Status.CONVERGED))


@dataclass(frozen=True, eq=False)
class _Step:
    """Pose after an iteration, `size` (b,) of its step, and `gap` (b,), the flexure residuals before it."""

    pose: Pose
    size: Array
    gap: Array


def search_designs(tasks: Sequence[Task], options: SolverOptions) -> list[EquilibriumSolution]:
    """Iterate the cases of several designs of equal structure. Elements other than flexures are evaluated for all designs together."""
    first = tasks[0]
    if _all_compiled(first.model, first.hold):
        return [_search_compiled(task, options) for task in tasks]
    compiled = kernel() is not None and tables(first.model) is not None
    searches, poses = [_Search.of(task) for task in tasks], [task.start for task in tasks]
    with np.errstate(all="ignore"):
        for _ in range(options.iterations):
            going = [place for place, each in enumerate(searches) if each.active.size]
            if not going:
                break
            cases = [searches[place].active for place in going]
            selected = [tasks[place].of(some, poses[place]) for place, some in zip(going, cases, strict=True)]
            steps = _iterate_compiled(selected, options) if compiled else [_Step(*iterate(*_parts(each), options)) for each in selected]
            for place, some, step in zip(going, cases, steps, strict=True):
                poses[place] = poses[place].put(some, step.pose)
                searches[place].take(some, step, options)
    return [each.found(pose) for each, pose in zip(searches, poses, strict=True)]


def _parts(task: Task) -> tuple[Nonlinear, Pose, Loads, FixedCoordinates]:
    return task.model, task.start, task.loads, task.hold


def _search_compiled(task: Task, options: SolverOptions) -> EquilibriumSolution:
    solutions = iterate_compiled(task.model, task.start, task.loads, options, None)
    return EquilibriumSolution(
        solutions.pose, solutions.status, solutions.count, solutions.lack, 1.0 * (solutions.status == Status.CONVERGED)
    )


def _iterate_compiled(tasks: list[Task], options: SolverOptions) -> list[_Step]:
    """Iterate as `iterate`, with flexures, loads and solution in C."""
    once = replace(options, iterations=1)
    results = [iterate_compiled(each.model, each.start, each.loads, once, terms) for each, terms in zip(tasks, _rests(tasks), strict=True)]
    return [_Step(each.pose, each.moved, each.lack) for each in results]


def _rests(tasks: list[Task]) -> list[OtherTerms | None]:
    """Terms of elements other than flexures, of all designs together; one by one with superelements."""
    if len(tasks) == 1 or tasks[0].model.elements:
        return [other_terms(*_parts(each)) for each in tasks]
    counts = [len(each.loads.inputs) for each in tasks]
    whole = other_terms(*_parts(_together(tasks, np.repeat(np.arange(len(tasks)), counts))))
    if whole is None:
        return [None] * len(tasks)
    ends = np.cumsum(counts)[:-1]
    parts = zip(np.split(whole.residual, ends), np.split(whole.stiffness, ends), strict=True)
    return [OtherTerms(residual, stiffness) for residual, stiffness in parts]


def _together(tasks: list[Task], design: Array) -> Task:
    """One task of all cases, with links about centres and points of fixed coordinates by the design (b,) of each case."""

    def all_cases(of: Callable[[Task], Array]) -> Array:
        return np.concatenate([of(each) for each in tasks])

    model, hold = tasks[0].model, tasks[0].hold
    tables = {name: np.stack([getattr(each.model.hinges, name) for each in tasks], axis=1)[:, design] for name in _OF_DESIGNS}
    places = {name: np.stack([getattr(each.hold, name) for each in tasks])[design] for name in ("arm", "origin")}
    pose = Pose(
        all_cases(lambda each: each.start.position),
        all_cases(lambda each: each.start.turn),
        (),
        (),
        all_cases(lambda each: each.start.held),
    )
    loads = Loads(*(all_cases(lambda each, name=name: getattr(each.loads, name)) for name in ("inputs", "gravity", "constant")))
    held = replace(hold, **places, value=all_cases(lambda each: each.hold.value))
    return Task(replace(model, hinges=replace(model.hinges, **tables)), pose, loads, held)


def iterate(model: Nonlinear, pose: Pose, loads: Loads, hold: FixedCoordinates, options: SolverOptions) -> tuple[Pose, Array, Array]:
    """Compute one step; returns the new pose, the size of the step (b,), and the largest residual before the step (b,)."""
    system = assemble(model, pose, loads, hold)
    step = system.solved(-system.residual)
    size = motion(model, step, model.size)
    many = not isinstance(system.matrix, np.ndarray)
    largest = end_displacement(model, system.bent, step) if many else motion(model, step, model.reach)
    share = np.minimum(1.0, options.limit / np.maximum(largest, options.limit))
    after, inside = advance(model, pose, system.bent, step, share)
    return walk_tree(model, after, loads) if many else after, np.maximum(size, inside), lack(model, system)


def motion(model: Nonlinear, step: Array, length: float) -> Array:
    """Return the largest motion (b,) in a step (b, n): translations divided by `length`, and rotations in radians."""
    moved = step[:, : model.freedoms].reshape(len(step), -1, 6)
    over = np.array([length] * 3 + [1.0] * 3)
    return np.max(np.abs(moved) / over, axis=(1, 2))


def lack(model: Nonlinear, system: System) -> Array:
    """Return the largest residual (b,): gaps at flexure ends, scaled residuals of amplitudes, and residuals of locked and fixed DOFs."""
    largest = [np.zeros(len(system.residual))]
    for group, bent in zip(model.flexures, system.bent, strict=True):
        stiff = np.max(np.linalg.diagonal(group.law.form), axis=-1)[:, None]
        largest += [np.max(np.abs(bent.gap), axis=(0, 2)), np.max(np.max(np.abs(bent.tangent.gradient), axis=-1) / stiff, axis=0)]
    held = system.residual[:, model.freedoms :]
    return np.max(np.stack([*largest, np.max(np.abs(held), axis=1, initial=0.0)]), axis=0)
