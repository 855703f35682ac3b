"""Cost of solids of a stage before the computation: jobs missing from the cache, in phases, with unknowns, seconds and memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

from flexstage.analysis.linear_statics.units import driven_units
from flexstage.base.finding import DesignError, require
from flexstage.base.processes.memory import available, gigabytes
from flexstage.base.processes.progress import duration
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.restrict import isolate
from flexstage.solid.fea.geometry.sound import check_together, sound_components
from flexstage.solid.fea.jobs.cache import holds
from flexstage.solid.fea.jobs.hinge_cache import hinge_jobs
from flexstage.solid.fea.jobs.memory import freedoms
from flexstage.solid.fea.jobs.parts import Ways, distinct, obtain, reduce_jobs
from flexstage.solid.fea.jobs.reducing import Reduce, StoredJob
from flexstage.solid.fea.jobs.remote import workers
from flexstage.solid.fea.meshing.estimate import Accuracy
from flexstage.solid.fea.solver.component import Component
from flexstage.solid.results.hinges import accuracy_of, distinct_hinges, require_hinges, turned_forms
from flexstage.solid.results.resolution import Resolution, first_reductions, orders_of


@dataclass(frozen=True)
class Plan:
    """The jobs of a computation by phase, the number of simultaneous jobs and of cached ones; possible further jobs.

    Failed jobs of `needed` (keys) prevent any result.
    """

    phases: Mapping[str, tuple[StoredJob, ...]]
    lanes: int
    cached: int = 0
    further: str = ""
    needed: frozenset[str] = frozenset()

    @property
    def jobs(self) -> tuple[StoredJob, ...]:
        """All jobs."""
        return tuple(chain.from_iterable(self.phases.values()))

    @property
    def seconds(self) -> float:
        """Their usual duration in one queue [s]."""
        each = [job.seconds() for job in self.jobs]
        return max(sum(each) / self.lanes, max(each, default=0.0))

    def __str__(self) -> str:
        """The plan in one or two lines: number of jobs, unknowns and memory of the largest, seconds.

        >>> print(Plan({"hinges": ()}, lanes=2, cached=3))
        to do: nothing, all 3 parts are in the cache.
        """
        if not self.jobs:
            return f"to do: nothing, all {self.cached} parts are in the cache."
        work = ", ".join(f"{len(jobs)} {'' if name == 'hinges' else 'at '}{name}" for name, jobs in self.phases.items() if jobs)
        expected = [(job, job.expected(job.reduction.fineness)) for job in self.jobs if isinstance(job, Reduce)]
        memory, unknowns = max(
            ((job.needed(mesh), freedoms(mesh, job.reduction.fineness.order)) for job, mesh in expected), default=(0.0, 0.0)
        )
        sizes = f"up to {unknowns:,.0f} unknowns and {gigabytes(memory)} each, " if memory else ""
        known = f" {self.cached} are in the cache." if self.cached else ""
        return f"to do: {work} ({sizes}{self.lanes} at once); usually {duration(self.seconds)}.{known}{self.further}"


def verification_plan(mechanism: Mechanism, asked: Resolution, ways: Ways, of_hinges: Accuracy | None = None) -> Plan:
    """The minimum jobs of `verify`: hinges, the stage and its isolated units at two orders.

    The accuracy of hinges is by default the required one. Outlines are checked. Unknowns and seconds are those
    of usual meshes, within a factor of two or three; the remaining time is estimated from the first jobs. Raises
    `DesignError` if the stage cannot be read as a solid, or has no hinge.
    """
    shape, alone = with_drawn_parts(mechanism), units_alone(mechanism)
    check_together([shape, *alone], ways.cache, ways.pool)
    parts = [sound_components(shape, ways.cache)]
    try:
        parts += [sound_components(stage, ways.cache) for stage in alone]
    except DesignError:  # reported in its phase
        alone = []
    require_hinges(distinct_hinges(shape))
    exact = accuracy_of(asked.accuracy, asked.order) if of_hinges is None else of_hinges
    lower, upper = first_reductions(asked)
    _, *rest = orders_of(asked)

    def jobs(stage: Mechanism, components: Sequence[Component]) -> list[Sequence[StoredJob]]:
        return [hinge_jobs(turned_forms(distinct_hinges(stage)), exact), reduce_jobs(components, lower), reduce_jobs(components, upper)]

    each = [jobs(stage, components) for stage, components in zip((shape, *alone), parts, strict=True)]
    names = "hinges", f"order {lower.fineness.order}", f"order {upper.fineness.order}"
    more = f" Order {rest[0]} follows if the accuracy is insufficient." if rest else ""
    phases = {name: chain.from_iterable(same) for name, same in zip(names, zip(*each, strict=True), strict=True)}
    return _plan(phases, ways, more, frozenset(job.key for job in chain.from_iterable(each[0])))


def reduction_plan(stages: Sequence[Mechanism], asked: Resolution, ways: Ways, *, bare: bool = False) -> Plan:
    """The minimum jobs of `solid` for stages as drawn: their components at two orders, without modes if `bare`.

    Outlines are checked. Raises `DesignError` if a stage cannot be read as a solid.
    """
    check_together(stages, ways.cache, ways.pool)
    parts = [part for stage in stages for part in sound_components(stage, ways.cache)]
    reductions = [replace(way, modes=0) if bare else way for way in first_reductions(asked)]
    phases = {f"order {way.fineness.order}": reduce_jobs(parts, way) for way in reductions}
    return _plan(phases, ways, "", frozenset(job.key for jobs in phases.values() for job in jobs))


def _plan(phases: Mapping[str, Iterable[StoredJob]], ways: Ways, further: str, needed: frozenset[str]) -> Plan:
    """A plan of the distinct jobs of phases by name; refused if a needed one far exceeds memory or time."""
    whole = {name: distinct(jobs) for name, jobs in phases.items()}
    todo = {
        name: tuple(job for job in jobs if ways.cache is None or not holds(ways.cache, job.key, job.stored)) for name, jobs in whole.items()
    }
    plan = Plan(todo, workers(ways.limits), sum(map(len, whole.values())) - sum(map(len, todo.values())), further, needed)
    memory = available() if ways.limits.memory is None else ways.limits.memory
    reductions = (job for job in plan.jobs if job.key in needed and isinstance(job, Reduce))
    require(each for each in (job.foreseen_refusal(memory, ways.limits.seconds) for job in reductions) if each is not None)
    return plan


def work_ahead(plan: Plan, ways: Ways) -> None:
    """Run the planned jobs in one queue, so that hinges, stage and units find their results in the pool of `ways`.

    Raises `DesignError` for failures of needed jobs; those of a single isolated unit are reported in its phase.
    """
    try:
        obtain(plan.jobs, ways)
    except DesignError:
        known = {} if ways.pool is None else ways.pool.results
        if any(job.key in plan.needed and job.key not in known for job in plan.jobs):
            raise


def units_alone(mechanism: Mechanism) -> list[Mechanism]:
    """Every distinct isolated unit as drawn; none if the strokes do not determine the platform, which is reported in its phase.

    >>> units_alone(Mechanism("nothing"))
    []
    """
    try:
        return [with_drawn_parts(isolate(mechanism, copy)) for copy, _ in driven_units(mechanism).values()]
    except DesignError:
        return []
