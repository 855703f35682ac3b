"""Reduced components of a stage: each distinct component is read from the cache, or computed in a separate process if it is missing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import Any, TypeAlias, TypeVar

from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.processes.memory import available
from flexstage.base.processes.progress import Progress, Step, duration
from flexstage.base.session import SESSION
from flexstage.solid.fea.jobs.cache import Cache, Notice, find, folder_of, keep, key_of, warn
from flexstage.solid.fea.jobs.content import KEPT, content
from flexstage.solid.fea.jobs.install import require_installed
from flexstage.solid.fea.jobs.memory import ReductionWork
from flexstage.solid.fea.jobs.reducing import MeasureWork, Reduce, StoredJob
from flexstage.solid.fea.jobs.remote import Limits, Pool, work_all, workers
from flexstage.solid.fea.meshing.fineness import Fineness, Hold, Reduction, thin_findings
from flexstage.solid.fea.solver.casing import is_encased
from flexstage.solid.fea.solver.component import Component, with_yielding_ends
from flexstage.solid.fea.solver.superelement import Superelement, hold_faces

Parts: TypeAlias = tuple[tuple[Component, Superelement], ...]
"""Components of a stage with their superelements; equal components share one superelement."""

AnyStored = TypeVar("AnyStored", bound=StoredJob)


@dataclass(frozen=True)
class Ways:
    """Options of the jobs: the `cache` (`None`: no cache), the receivers of `progress` and of warnings (`notice`), and the `limits`.

    With a `pool`, later calls use the same processes and results. The function `note` receives lines of text: first the jobs and their CPU
    time, then every result. After an interruption, `note` receives the number of stored results.
    """

    cache: Cache | None = Cache()
    progress: Progress | None = None
    limits: Limits = Limits()
    pool: Pool | None = field(default=None, compare=False)
    notice: Notice = field(default=warn, compare=False)
    note: Callable[[str], None] = field(default=lambda _line: None, compare=False)


def reduce_parts(parts: Sequence[Component], reduction: Reduction, ways: Ways = Ways()) -> Parts:
    """Reduce components.

    Only components missing from the cache need the solver. Each superelement is stored immediately, so that an interrupted computation can
    resume. Raises a `DesignError` that lists all failures.

    >>> reduce_parts((), Reduction())
    ()
    """
    jobs = reduce_jobs(parts, reduction)
    elements = obtain(jobs, ways)
    return as_joined(parts, [(job.component, elements[job.key]) for job in jobs])


def reduce_jobs(parts: Sequence[Component], reduction: Reduction) -> list[Reduce]:
    """Make a job for each component. Ends of links may deform, so that an isolated unit and the unit in its stage have the same job.

    An encased stack has no fixed-interface modes: in these modes, the ceramic would bend without its casing, which is connected only to the
    end faces.

    >>> reduce_jobs((), Reduction())
    []
    """
    yields = reduction.hold is Hold.RIGID and not reduction.residual
    jobs: list[Reduce] = []
    for part in parts:
        whole = with_yielding_ends(part) if yields else part
        own = reduction.of(content(whole))
        own = replace(own, modes=0) if all(is_encased(piece.form) for piece in whole.pieces) else own
        jobs.append(Reduce(key_of(whole, own), whole, own))
    return jobs


@SESSION.keep(KEPT)
def content_in_stage(part: Component) -> str:
    """Return a digest of a component's content, which is the same for an isolated unit and for the unit in its stage.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> content_in_stage(bar()) == content(with_yielding_ends(bar()))
    True
    """
    return content(with_yielding_ends(part))


def as_joined(parts: Sequence[Component], reduced: Sequence[tuple[Component, Superelement]]) -> Parts:
    """Return components with their superelements, in which faces on rigid bodies stay plane. Equal components share a superelement.

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


def obtain(jobs: Sequence[StoredJob], ways: Ways) -> dict[str, Any]:
    """Return the results of jobs by key. Results that are not in the cache are computed once and stored immediately.

    First, the computing effort of missing results is estimated from their meshes and reported. Raises `DesignError` if a job fails or would
    exceed memory or time.

    >>> obtain((), Ways())
    {}
    """
    results: dict[str, Any] = {} if ways.pool is None else ways.pool.results
    todo = distinct(jobs)
    for job in todo:
        if job.key not in results and ways.cache is not None:
            found = find(ways.cache, job.key, job.name, job.stored, notice=ways.notice)
            results |= {} if found is None else {job.key: found}
    missing = [job for job in todo if job.key not in results]
    if missing:
        require_installed()  # the processes load it
        with nullcontext(ways.pool) if ways.pool is not None else Pool() as pool:
            _compute(missing, results, replace(ways, pool=pool), len(todo) - len(missing))
    return {job.key: results[job.key] for job in jobs}


def _compute(missing: Sequence[StoredJob], results: dict[str, Any], ways: Ways, cached: int) -> None:
    """Compute missing results, the longest first, for an even load of the cores; those of components without a mesh fail last."""
    measured, failures = _measure(missing, ways)
    measured.sort(key=lambda job: -job.seconds())
    ways.note(announce(measured, workers(ways.limits), cached))
    try:
        work_all(measured, partial(_take, results, ways), ways.limits, ways.progress, ways.pool)
    except DesignError as error:
        failures += error.findings
    except (KeyboardInterrupt, SystemExit):
        kept = sum(job.key in results for job in measured)
        where = "" if ways.cache is None else f" in {folder_of(ways.cache)}; the same command continues with the others"
        ways.note(f"Interrupted: {kept} of {len(measured)} results are kept{where}.")
        raise
    require(failures)


def _measure(jobs: Sequence[StoredJob], ways: Ways) -> tuple[list[StoredJob], tuple[Finding, ...]]:
    """The jobs, with the measured work of reductions, and failures: each component is meshed once.

    Those without a mesh are left out. Raises `DesignError` beyond memory or time, or if a part is too thin.
    """
    alike: dict[tuple[str, Fineness], list[Reduce]] = {}
    reductions = [job for job in jobs if isinstance(job, Reduce)]
    for job in reductions:
        alike.setdefault((job.kin, replace(job.reduction.fineness, order=1)), []).append(job)
    require(chain.from_iterable(thin_findings(same[0].component.pieces, same[0].reduction.fineness) for same in alike.values()))
    known: dict[str, ReductionWork] = {}

    def take(job: MeasureWork, found: tuple[ReductionWork, ...]) -> None:
        known.update({each.key: work for each, work in zip(job.reductions, found, strict=True)})

    def show(step: Step) -> None:
        if ways.progress is not None:
            ways.progress(Step(step.text, 0.0, None))

    failures: tuple[Finding, ...] = ()
    try:
        work_all([MeasureWork(tuple(each)) for each in alike.values()], take, ways.limits, show, ways.pool)
    except DesignError as error:
        failures = error.findings
    measured = [replace(job, measured=known[job.key]) for job in reductions if job.key in known]
    memory = available() if ways.limits.memory is None else ways.limits.memory
    require(each for job in measured for each in job.excess(memory, ways.limits.seconds))
    return [*(job for job in jobs if not isinstance(job, Reduce)), *measured], failures


def announce(jobs: Sequence[StoredJob], lanes: int, cached: int) -> str:
    """Describe the jobs in one line: their number, the largest number of unknowns, and the total CPU time.

    >>> announce((), lanes=2, cached=3)
    'to do: nothing, all 3 results are in the cache.'
    """
    if not jobs:
        return f"to do: nothing, all {cached} results are in the cache."
    work = ", ".join(f"{phase} ({number})" for phase, number in Counter(sorted(job.phase for job in jobs)).items())
    unknowns = max((job.measured.freedoms for job in jobs if isinstance(job, Reduce) and job.measured is not None), default=0)
    sizes = f"up to {unknowns:,} unknowns, " if unknowns else ""
    known = f" {cached} more results are in the cache." if cached else ""
    return f"to do: {work}; {sizes}{lanes} in parallel, about {duration(sum(job.seconds() for job in jobs))} of CPU time.{known}"


def distinct(jobs: Iterable[AnyStored]) -> tuple[AnyStored, ...]:
    """Return the first job of each key."""
    first: dict[str, AnyStored] = {}
    for job in jobs:
        first.setdefault(job.key, job)
    return tuple(first.values())


def _take(results: dict[str, Any], ways: Ways, job: StoredJob, found: Any) -> None:
    """Take a result of a worker, store it, and report it."""
    results[job.key] = found
    if ways.cache is not None:
        keep(ways.cache, job.key, job.name, found, job.stored, notice=ways.notice)
    ways.note(job.summary(found))
