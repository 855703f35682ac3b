"""Plans: those jobs of a study of solids that are known before the computation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain

from flexstage.analysis.linear_statics.units import driven_units
from flexstage.base.finding import DesignError
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.restrict import isolate
from flexstage.solid.fea.geometry.sound import check_together, sound_components
from flexstage.solid.fea.jobs.cache import Cache, holds
from flexstage.solid.fea.jobs.hinge_cache import hinge_jobs
from flexstage.solid.fea.jobs.parts import Ways, distinct, obtain, reduce_jobs
from flexstage.solid.fea.jobs.reducing import StoredJob
from flexstage.solid.fea.meshing.estimate import Accuracy
from flexstage.solid.fea.solver.component import Component
from flexstage.solid.results.hinges import accuracy_of, distinct_hinges, require_hinges, turned_forms
from flexstage.solid.results.resolution import Resolution, first_reductions


@dataclass(frozen=True)
class Plan:
    """Jobs that a computation needs in any case. If a job with a key in `needed` fails, the computation fails."""

    jobs: tuple[StoredJob, ...]
    needed: frozenset[str] = frozenset()

    def missing(self, cache: Cache | None) -> tuple[StoredJob, ...]:
        """Return the jobs without a stored result."""
        return tuple(job for job in self.jobs if cache is None or not holds(cache, job.key, job.stored))


def verification_plan(mechanism: Mechanism, asked: Resolution, ways: Ways, of_hinges: Accuracy | None = None) -> Plan:
    """Return the jobs that `verify` needs in any case: hinges, and components of the stage and its isolated units at two orders.

    `of_hinges` is the required accuracy of hinges; by default, it follows from `asked`. Outlines are checked. Raises `DesignError` if the
    stage cannot be modelled as a solid or has no hinge.
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

    def jobs(stage: Mechanism, components: Sequence[Component]) -> list[StoredJob]:
        reductions = (job for way in first_reductions(asked) for job in reduce_jobs(components, way))
        return [*hinge_jobs(turned_forms(distinct_hinges(stage)), exact), *reductions]

    each = [jobs(stage, components) for stage, components in zip((shape, *alone), parts, strict=True)]
    return Plan(distinct(chain.from_iterable(each)), frozenset(job.key for job in each[0]))


def reduction_plan(stages: Sequence[Mechanism], asked: Resolution, ways: Ways, *, bare: bool = False) -> Plan:
    """Return the jobs that `solid` needs for stages as drawn: reductions of all components at two orders, without modes if `bare`.

    Outlines are checked. Raises `DesignError` if a stage cannot be modelled as a solid.
    """
    check_together(stages, ways.cache, ways.pool)
    parts = [part for stage in stages for part in sound_components(stage, ways.cache)]
    reductions = [replace(way, modes=0) if bare else way for way in first_reductions(asked)]
    jobs = distinct(job for way in reductions for job in reduce_jobs(parts, way))
    return Plan(jobs, frozenset(job.key for job in jobs))


def work_ahead(plan: Plan, ways: Ways) -> None:
    """Run the planned jobs in one queue. The computations of hinges, stage and units then find their results in the pool of `ways`.

    Raises `DesignError` if a needed job fails. All other jobs are of isolated units; their failures are reported when the units are
    computed.
    """
    try:
        obtain(plan.jobs, ways)
    except DesignError:
        known = {} if ways.pool is None else ways.pool.results
        if any(job.key in plan.needed and job.key not in known for job in plan.jobs):
            raise


def units_alone(mechanism: Mechanism) -> list[Mechanism]:
    """Return every distinct isolated unit as drawn; return no unit if the strokes do not determine the motion (an error reported later).

    >>> units_alone(Mechanism("nothing"))
    []
    """
    try:
        return [with_drawn_parts(isolate(mechanism, copy)) for copy, _ in driven_units(mechanism).values()]
    except DesignError:
        return []
