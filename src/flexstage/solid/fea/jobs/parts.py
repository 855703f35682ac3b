"""The reduced components of a stage: each distinct one once, from the cache where it is there, else in a process of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from types import MappingProxyType
from typing import Any, TypeAlias

from flexstage.base.finding import Finding, refuse
from flexstage.base.number import Array
from flexstage.base.processes.progress import Progress
from flexstage.solid.fea.jobs.cache import Cache, find, keep, key_of
from flexstage.solid.fea.jobs.content import KEPT, content
from flexstage.solid.fea.jobs.install import require_installed
from flexstage.solid.fea.jobs.reducing import Reduce, StoredJob
from flexstage.solid.fea.jobs.remote import Limits, Pool, work_all
from flexstage.solid.fea.jobs.store import from_bytes, versions
from flexstage.solid.fea.meshing.fineness import Hold, Reduction
from flexstage.solid.fea.solver.component import Component, with_yielding_ends
from flexstage.solid.fea.solver.superelement import Superelement, hold_faces

Parts: TypeAlias = tuple[tuple[Component, Superelement], ...]
"""Components of a stage with their superelements; equal components share one."""

_NO_SPRINGS: Mapping[str, Array] = MappingProxyType({})


@dataclass(frozen=True)
class Ways:
    """How components are come by: the `cache` (`None`: none is used), who is told of the `progress`, and the `limits`.

    With a `pool` processes stay, and results at hand, for what is asked next.
    """

    cache: Cache | None = Cache()
    progress: Progress | None = None
    limits: Limits = Limits()
    pool: Pool | None = field(default=None, compare=False)


@dataclass(frozen=True, eq=False)
class ReducedParts:
    """Reduced components, and what is to be said about the cache: files damaged or of other versions, or that could not be kept."""

    parts: Parts
    notices: tuple[Finding, ...] = ()


def reduce_parts(
    parts: Sequence[Component],
    reduction: Reduction,
    ways: Ways = Ways(),
    springs: Mapping[str, Array] = _NO_SPRINGS,
) -> ReducedParts:
    """Reduce components; `springs` between the interfaces of some, by name.

    The solver is needed only for those that are not in the cache. Each is kept as soon as it is done: what is interrupted resumes. Raises
    `DesignError` with all that could not be reduced.

    >>> reduce_parts((), Reduction()).parts
    ()
    """
    jobs = reduce_jobs(parts, reduction, springs)
    elements, notices = obtain(jobs, ways)
    return ReducedParts(as_joined(parts, [(job.component, elements[job.key]) for job in jobs]), notices)


def reduce_jobs(parts: Sequence[Component], reduction: Reduction, springs: Mapping[str, Array] = _NO_SPRINGS) -> list[Reduce]:
    """A job a component: what is reduced yields at the ends of its links, so that a unit alone and in its stage are one job.

    >>> reduce_jobs((), Reduction())
    []
    """
    yields = reduction.hold is Hold.RIGID and not reduction.residual
    wholes = [with_yielding_ends(part) if yields and part.name not in springs else part for part in parts]
    jobs: list[Reduce] = []
    for part, whole in zip(parts, wholes, strict=True):
        own, joined = reduction.of(content(whole)), springs.get(part.name)
        jobs.append(Reduce(key_of(whole, own, joined), whole, own, joined))
    return jobs


@lru_cache(maxsize=KEPT)
def content_in_stage(part: Component) -> str:
    """The content of what is reduced for a component, the same for a unit alone and in its stage.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> content_in_stage(bar()) == content(with_yielding_ends(bar()))
    True
    """
    return content(with_yielding_ends(part))


def as_joined(parts: Sequence[Component], reduced: Sequence[tuple[Component, Superelement]]) -> Parts:
    """Components with the superelements of their `reduce_jobs`, faces that end on what is rigid held; equal ones share one.

    >>> as_joined((), ())
    ()
    """
    made: dict[tuple[int, tuple[bool, ...]], Superelement] = {}
    found: list[tuple[Component, Superelement]] = []
    for part, (whole, element) in zip(parts, reduced, strict=True):
        pairs = zip(part.interfaces, whole.interfaces, strict=True)
        held = tuple(not own.yields for own, other in pairs if other.yields)
        key = id(element), held
        made.setdefault(key, hold_faces(element, held))
        found.append((part, made[key]))
    return tuple(found)


def obtain(jobs: Sequence[StoredJob], ways: Ways) -> tuple[dict[str, Any], tuple[Finding, ...]]:
    """Results of jobs by key, from the cache, else computed, each once and kept as soon as it is done; what is to be said of the cache.

    >>> obtain((), Ways())
    ({}, ())
    """
    store = _Store(ways.cache, {} if ways.pool is None else ways.pool.results)
    first: dict[str, StoredJob] = {}
    for job in jobs:
        first.setdefault(job.key, job)
    missing = [job for job in first.values() if not store.holds(job)]
    if missing:
        require_installed()  # the processes load it
        missing.sort(key=lambda job: -job.seconds())  # the longest first: the others fill the time beside it
        work_all(missing, store.take, ways.limits, ways.progress, ways.pool)
    return {key: store.results[key] for key in first}, tuple(store.notices)


class _Store:
    """Results at hand, by key, on top of a cache."""

    def __init__(self, cache: Cache | None, results: dict[str, Any]) -> None:
        self.cache, self.results = cache, results
        self.notices: list[Finding] = []

    def holds(self, job: StoredJob) -> bool:
        """Whether a result is at hand, or in the cache; it is at hand then."""
        if job.key in self.results or self.cache is None:
            return job.key in self.results
        found = find(self.cache, job.key, job.name, job.stored)
        self.notices += found.notices
        if found.element is not None:
            self.results[job.key] = found.element
        return found.element is not None

    def take(self, job: StoredJob, data: bytes) -> None:
        """Take a result as a worker wrote it, and keep it."""
        result = from_bytes(data, job.key, versions(job.stored.method))
        if isinstance(result, str):
            advice = "See that the folder for temporary files (environment variable TMPDIR) keeps what is written to it, and run it again"
            raise refuse(job.name, f"what its process wrote cannot be used: {result}", advice)
        self.results[job.key] = result
        if self.cache is not None:
            self.notices += keep(self.cache, job.key, job.name, data, job.stored)
