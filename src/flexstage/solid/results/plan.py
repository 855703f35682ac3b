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
class Phase:
    """Jobs of one sort: seconds by key, the most unknowns of one of them and the memory [bytes] it needs (0: not known); the jobs."""

    name: str
    seconds: Mapping[str, float]
    freedoms: float = 0.0
    memory: float = 0.0
    todo: tuple[StoredJob, ...] = ()


@dataclass(frozen=True)
class Plan:
    """The phases of a computation, how many jobs are done at once, how many are in the cache already; what may come on top.

    Without the jobs of `needed` (keys) nothing can be told.
    """

    phases: tuple[Phase, ...]
    lanes: int
    cached: int = 0
    further: str = ""
    needed: frozenset[str] = frozenset()

    @property
    def jobs(self) -> int:
        """How many there are to do."""
        return sum(len(phase.seconds) for phase in self.phases)

    @property
    def seconds(self) -> float:
        """What they usually take in one queue [s]."""
        each = [seconds for phase in self.phases for seconds in phase.seconds.values()]
        return max(sum(each) / self.lanes, max(each, default=0.0))

    def __str__(self) -> str:
        """The plan in a line or two.

        >>> print(Plan((Phase("hinges", {"a": 15.0, "b": 15.0}), Phase("order 3", {"c": 90.0}, 60e3, 9e8)), lanes=2, cached=3))
        to do: 2 hinges, 1 at order 3 (up to 60,000 unknowns and 0.9 GB each, 2 at once); usually 2 minutes. 3 are in the cache.
        """
        if not self.jobs:
            return f"to do: nothing, all {self.cached} parts are in the cache."
        names = dict.fromkeys(phase.name for phase in self.phases if phase.seconds)
        counts = {name: sum(len(phase.seconds) for phase in self.phases if phase.name == name) for name in names}
        work = ", ".join(f"{count} {'' if name == 'hinges' else 'at '}{name}" for name, count in counts.items())
        largest = max(self.phases, key=lambda phase: phase.memory)
        sizes = f"up to {largest.freedoms:,.0f} unknowns and {gigabytes(largest.memory)} each, " if largest.memory else ""
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
    todo = tuple(_phase(name, jobs, ways) for name, jobs in whole.items())
    known = sum(map(len, whole.values())) - sum(len(phase.todo) for phase in todo)
    memory = available() if ways.limits.memory is None else ways.limits.memory
    reductions = (job for phase in todo for job in phase.todo if job.key in needed and isinstance(job, Reduce))
    require(each for each in (job.foreseen_refusal(memory, ways.limits.seconds) for job in reductions) if each is not None)
    return Plan(todo, workers(ways.limits), known, further, needed)


def work_ahead(plan: Plan, ways: Ways) -> None:
    """Work what is planned in one queue: hinges, stage and units wait for nobody, and find it at hand in the pool of `ways`.

    Raises `DesignError` where what is needed in any case cannot be had; what only a unit alone lacks is told when its turn comes.
    """
    todo = [job for phase in plan.phases for job in phase.todo]
    try:
        obtain(todo, ways)
    except DesignError:
        known = {} if ways.pool is None else ways.pool.results
        if any(job.key in plan.needed and job.key not in known for job in todo):
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


def _phase(name: str, jobs: Iterable[StoredJob], ways: Ways) -> Phase:
    """Those of the jobs that are not in the cache."""
    todo = tuple(job for job in jobs if ways.cache is None or not holds(ways.cache, job.key, job.stored))
    reductions = [job for job in todo if isinstance(job, Reduce)]
    sizes = [
        (job.needed(job.expected(way)), freedoms(job.expected(way), way.order)) for job in reductions for way in [job.reduction.fineness]
    ]
    memory, unknowns = max(sizes, default=(0.0, 0.0))
    return Phase(name, {job.key: job.seconds() for job in todo}, unknowns, memory, todo)
