"""What solids of a stage cost before they begin: their jobs that are not in the cache, in phases, with unknowns, seconds and memory."""

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
    """The jobs of a computation by phase, how many are done at once, how many are in the cache already; what may come on top.

    Without the jobs of `needed` (keys) nothing can be told.
    """

    phases: Mapping[str, tuple[StoredJob, ...]]
    lanes: int
    cached: int = 0
    further: str = ""
    needed: frozenset[str] = frozenset()

    @property
    def jobs(self) -> tuple[StoredJob, ...]:
        """All there are to do."""
        return tuple(chain.from_iterable(self.phases.values()))

    @property
    def seconds(self) -> float:
        """What they usually take in one queue [s]."""
        each = [job.seconds() for job in self.jobs]
        return max(sum(each) / self.lanes, max(each, default=0.0))

    def __str__(self) -> str:
        """The plan in a line or two: how many jobs, the unknowns and the memory of the largest, seconds.

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
    """What `verify` has to do in any case: hinges, the stage and its units alone at two orders.

    The accuracy of hinges is what is asked for, unless it is told. Outlines are checked against each other. Unknowns and seconds are those
    of usual meshes of such parts, right within a factor of two or three; time left is told by what the first jobs took. Raises
    `DesignError` where the stage cannot be read as a solid, or has no hinge.
    """
    shape, alone = with_drawn_parts(mechanism), units_alone(mechanism)
    check_together([shape, *alone], ways.cache, ways.pool)
    parts = [sound_components(shape, ways.cache)]
    try:
        parts += [sound_components(stage, ways.cache) for stage in alone]
    except DesignError:  # told when its turn comes
        alone = []
    require_hinges(distinct_hinges(shape))
    exact = accuracy_of(asked.accuracy, asked.order) if of_hinges is None else of_hinges
    lower, upper = first_reductions(asked)
    _, *rest = orders_of(asked)

    def jobs(stage: Mechanism, components: Sequence[Component]) -> list[Sequence[StoredJob]]:
        return [hinge_jobs(turned_forms(distinct_hinges(stage)), exact), reduce_jobs(components, lower), reduce_jobs(components, upper)]

    each = [jobs(stage, components) for stage, components in zip((shape, *alone), parts, strict=True)]
    names = "hinges", f"order {lower.fineness.order}", f"order {upper.fineness.order}"
    more = f" Order {rest[0]} follows where that is not exact enough." if rest else ""
    phases = {name: chain.from_iterable(same) for name, same in zip(names, zip(*each, strict=True), strict=True)}
    return _plan(phases, ways, more, frozenset(job.key for job in chain.from_iterable(each[0])))


def reduction_plan(stages: Sequence[Mechanism], asked: Resolution, ways: Ways, *, bare: bool = False) -> Plan:
    """What `solid` has to do in any case for stages as they are drawn: their components at two orders, `bare` of modes.

    Outlines are checked. Raises `DesignError` where a stage cannot be read as a solid.
    """
    check_together(stages, ways.cache, ways.pool)
    parts = [part for stage in stages for part in sound_components(stage, ways.cache)]
    reductions = [replace(way, modes=0) if bare else way for way in first_reductions(asked)]
    phases = {f"order {way.fineness.order}": reduce_jobs(parts, way) for way in reductions}
    return _plan(phases, ways, "", frozenset(job.key for jobs in phases.values() for job in jobs))


def _plan(phases: Mapping[str, Iterable[StoredJob]], ways: Ways, further: str, needed: frozenset[str]) -> Plan:
    """A plan of the jobs of phases by name, each of them once; refused where one that is needed is far beyond memory or time."""
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
    """Work what is planned in one queue: hinges, stage and units wait for nobody, and find it at hand in the pool of `ways`.

    Raises `DesignError` where what is needed in any case cannot be had; what only a unit alone lacks is told when its turn comes.
    """
    try:
        obtain(plan.jobs, ways)
    except DesignError:
        known = {} if ways.pool is None else ways.pool.results
        if any(job.key in plan.needed and job.key not in known for job in plan.jobs):
            raise


def units_alone(mechanism: Mechanism) -> list[Mechanism]:
    """Every distinct unit alone as it is drawn; none where strokes leave motions of the platform open, which is told when its turn comes.

    >>> units_alone(Mechanism("nothing"))
    []
    """
    try:
        return [with_drawn_parts(isolate(mechanism, copy)) for copy, _ in driven_units(mechanism).values()]
    except DesignError:
        return []
