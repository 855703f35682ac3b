"""What a verification costs before it begins: its jobs that are not in the cache, in phases, with unknowns, seconds and memory."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from flexstage.analysis.units import driven_units
from flexstage.base.finding import DesignError
from flexstage.base.memory import gigabytes
from flexstage.base.progress import duration, time_left
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.restrict import isolate
from flexstage.solid.fea.cache import HINGES, SUPERELEMENTS, Kind, holds
from flexstage.solid.fea.component import Component
from flexstage.solid.fea.hinge_cache import hinge_jobs
from flexstage.solid.fea.memory import freedoms
from flexstage.solid.fea.parts import Ways, reduce_jobs
from flexstage.solid.fea.reducing import Reduce, StoredJob
from flexstage.solid.fea.remote import workers
from flexstage.solid.fea.sound import sound_components
from flexstage.solid.hinges import accuracy_of, distinct_hinges, turned_forms
from flexstage.solid.resolution import Resolution, first_reductions, orders_of


@dataclass(frozen=True)
class Phase:
    """Jobs that are done side by side: seconds by key, the most unknowns of one of them and the memory [bytes] it needs (0: not known)."""

    name: str
    seconds: Mapping[str, float]
    freedoms: float = 0.0
    memory: float = 0.0


@dataclass(frozen=True)
class Plan:
    """The phases of a computation, how many jobs are done at once, how many are in the cache already; what may come on top."""

    phases: tuple[Phase, ...]
    lanes: int
    cached: int = 0
    further: str = ""

    @property
    def jobs(self) -> int:
        """How many there are to do."""
        return sum(len(phase.seconds) for phase in self.phases)

    @property
    def seconds(self) -> float:
        """What they usually take [s]."""
        return time_left([phase.seconds for phase in self.phases], {}, lanes=self.lanes)

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


def verification_plan(mechanism: Mechanism, asked: Resolution, ways: Ways) -> Plan:
    """What `verify` has to do: hinges, then the stage and its units alone, order by order.

    Outlines are checked against each other. Unknowns and seconds are those of usual meshes of such parts, right within a factor of two or
    three; time left is told by what the first jobs took. Raises `DesignError` where the stage cannot be read as a solid.
    """
    shape = with_drawn_parts(mechanism)
    parts = [sound_components(shape, ways.cache)]
    alone = _units_alone(mechanism, ways)
    stages, parts = [shape, *(stage for stage, _ in alone)], [*parts, *(components for _, components in alone)]
    hinges = [job for stage in stages for job in hinge_jobs(turned_forms(distinct_hinges(stage)), accuracy_of(asked.accuracy, asked.order))]
    _, *rest = orders_of(asked)
    taken: set[str] = set()
    phases = [
        _phase("hinges", hinges, HINGES, ways, taken),
        *(
            _phase(f"order {way.fineness.order}", reduce_jobs(components, way), SUPERELEMENTS, ways, taken)
            for components in parts
            for way in first_reductions(asked)
        ),
    ]
    missing = sum(len(phase.seconds) for phase in phases)
    more = f" Order {rest[0]} follows where that is not exact enough." if rest else ""
    return Plan(tuple(phases), workers(ways.limits), len(taken) - missing, more)


def _units_alone(mechanism: Mechanism, ways: Ways) -> list[tuple[Mechanism, Sequence[Component]]]:
    """Every distinct unit alone, and its components; none where one cannot be read as a solid, which is told when its turn comes."""
    try:
        stages = [with_drawn_parts(isolate(mechanism, copy)) for copy, _ in driven_units(mechanism).values()]
        return [(stage, sound_components(stage, ways.cache)) for stage in stages]
    except DesignError:
        return []


def _phase(name: str, jobs: Iterable[StoredJob], kind: Kind, ways: Ways, taken: set[str]) -> Phase:
    """The jobs of a phase that no earlier one does, without those in the cache."""
    todo: dict[str, StoredJob] = {}
    for job in jobs:
        if job.key not in taken and (ways.cache is None or not holds(ways.cache, job.key, kind)):
            todo[job.key] = job
        taken.add(job.key)
    reductions = [job for job in todo.values() if isinstance(job, Reduce)]
    sizes = [
        (job.needed(job.expected(way)), freedoms(job.expected(way), way.order)) for job in reductions for way in [job.reduction.fineness]
    ]
    memory, unknowns = max(sizes, default=(0.0, 0.0))
    return Phase(name, {key: job.seconds() for key, job in todo.items()}, unknowns, memory)
