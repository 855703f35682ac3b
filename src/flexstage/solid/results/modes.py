"""Modes by finite elements for comparisons: computed on request, or else read from the cache if it contains all components of the stage."""

from __future__ import annotations

from collections.abc import Mapping

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.dynamics.solid_modes import FeaModes
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError
from flexstage.base.storage.digest import digest
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.solid.fea.jobs.cache import Cache, find
from flexstage.solid.fea.jobs.parts import as_joined, reduce_jobs
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.solver.assemble import linear_model
from flexstage.solid.fea.solver.component import Component, components
from flexstage.solid.fea.solver.superelement import Superelement
from flexstage.solid.results.read import STANDARD_SOLIDS, Solids, coarsen, read_solid
from flexstage.solid.results.resolution import DEFAULT, HIGHEST, Resolution, converge, estimates, reduction_of_order


@check_arguments
def fea_modes(mechanism: Mechanism, asked: Resolution = DEFAULT, reduce: Solids = STANDARD_SOLIDS) -> FeaModes:
    """Compute the modes of a stage as a solid, to the accuracy required by `asked`. Raises the same `DesignError` as `read_solid`."""

    def work(way: Reduction) -> FeaModes:
        model = read_solid(mechanism, way, reduce).model
        return FeaModes(platform_modes(mechanism, model), model, way.fineness.order)

    found = converge(work, _figures, asked)
    errors = tuple(found.errors.get(name) for name in _figures(found.result))
    return FeaModes(found.result.modes, found.result.model, found.order, errors)


def fea_modes_from_cache(mechanism: Mechanism, cache: Cache) -> FeaModes | None:
    """Return a stage's modes by FEA at the highest order with all components in the cache; `None` if no order has all components there.

    >>> from pathlib import Path
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> fea_modes_from_cache(parallelogram(), Cache(Path("/nowhere"))) is None
    True
    """
    try:
        for order in range(HIGHEST, 1, -1):
            found = _from_cache(mechanism, cache, reduction_of_order(order))
            if found is not None:
                before = _from_cache(mechanism, cache, coarsen(reduction_of_order(order)))
                return found if before is None else FeaModes(found.modes, found.model, order, _errors(before, found))
    except DesignError:  # parts without a shape: the stage has no solid model
        return None
    return None


def _from_cache(mechanism: Mechanism, cache: Cache, reduction: Reduction) -> FeaModes | None:
    shape = with_drawn_parts(mechanism)
    wholes, own = list[tuple[Component, Superelement]](), components(shape)
    for job in reduce_jobs(own, reduction):
        element = find(cache, job.key, job.name)
        if element is None:
            return None
        wholes.append((job.component, element))
    parts = as_joined(own, wholes)
    order = reduction.fineness.order
    provenance = f"solid model of {digest(shape, physics=True)[:16]}, order {order}, {reduction.modes} modes per component"
    model = linear_model(shape, expand(shape), parts, provenance)
    return FeaModes(platform_modes(mechanism, model), model, order) if parts else None


def _figures(found: FeaModes) -> Mapping[str, float]:
    return {f"platform mode {number + 1}": float(value) for number, value in enumerate(found.modes.platform_frequencies)}


def _errors(before: FeaModes, after: FeaModes) -> tuple[float | None, ...]:
    found = estimates(_figures(before), _figures(after), after.order)
    return tuple(found.get(name) for name in _figures(after))
