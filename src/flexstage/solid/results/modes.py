"""Modes by finite elements for comparisons: computed on request, or else read from the cache if it contains all components of the stage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, refuse
from flexstage.mechanism.mechanism import Mechanism
from flexstage.solid.fea.jobs.cache import Cache, find
from flexstage.solid.fea.jobs.parts import Parts, as_joined, reduce_jobs
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.solver.component import components
from flexstage.solid.results.read import STANDARD_SOLIDS, Solids, coarsen, read_solid
from flexstage.solid.results.resolution import DEFAULT, HIGHEST, Resolution, converge, estimates, reduction_of_order
from flexstage.solid.results.stage import mode_figures


@check_arguments
def fea_modes(mechanism: Mechanism, asked: Resolution = DEFAULT, reduce: Solids = STANDARD_SOLIDS) -> FeaModes:
    """Compute the modes of a stage as a solid, to the accuracy required by `asked`. Raises the same `DesignError` as `read_solid`."""
    found = converge(lambda way: _modes(mechanism, way, reduce), _figures, asked)
    return _with_errors(found.result, found.errors)


def fea_modes_from_cache(mechanism: Mechanism, cache: Cache) -> FeaModes | None:
    """Return a stage's modes by FEA at the highest order with all components in the cache; `None` if no order has all components there.

    >>> from pathlib import Path
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> fea_modes_from_cache(parallelogram(), Cache(Path("/nowhere"))) is None
    True
    """
    for order in range(HIGHEST, 1, -1):
        found = _from_cache(mechanism, cache, reduction_of_order(order))
        if found is not None:
            before = _from_cache(mechanism, cache, coarsen(reduction_of_order(order)))
            return found if before is None else _with_errors(found, estimates(_figures(before), _figures(found), order))
    return None


def _from_cache(mechanism: Mechanism, cache: Cache, reduction: Reduction) -> FeaModes | None:
    """The modes, if all components are in the cache; `None` also for a stage that has no solid model."""

    def stored(shape: Mechanism, reduction: Reduction) -> Parts:
        own = components(shape)
        found = [(job.component, find(cache, job.key, job.name)) for job in reduce_jobs(own, reduction)]
        if not found or any(element is None for _, element in found):
            raise refuse(shape.name, "not all components are in the cache", "Compute them")
        return as_joined(own, found)

    try:
        return _modes(mechanism, reduction, stored)
    except DesignError:
        return None


def _modes(mechanism: Mechanism, reduction: Reduction, reduce: Solids) -> FeaModes:
    model = read_solid(mechanism, reduction, reduce).model
    return FeaModes(platform_modes(mechanism, model), model, reduction.fineness.order)


def _with_errors(found: FeaModes, errors: Mapping[str, float]) -> FeaModes:
    return replace(found, errors=tuple(errors.get(name) for name in _figures(found)))


def _figures(found: FeaModes) -> Mapping[str, float]:
    return mode_figures(found.modes)
