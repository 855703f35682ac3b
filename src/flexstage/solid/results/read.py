"""Solid model of a stage from its reduced components, which are computed, or read from a cache, with progress reports."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

from flexstage.base.arguments import check_arguments
from flexstage.base.processes.progress import Progress
from flexstage.base.storage.digest import digest
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.solid.fea.geometry.sound import sound_components
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.parts import Parts, Ways, content_in_stage, reduce_parts
from flexstage.solid.fea.jobs.remote import Limits, Pool
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.solver.assemble import Placed, linear_model, place_parts

Solids: TypeAlias = Callable[[Mechanism, Reduction], Parts]
"""Function that reduces the components of a stage."""

STANDARD_WAYS = Ways()


@dataclass(frozen=True, eq=False)
class SolidRead:
    """Solid model of a stage: its linear model, and the placed components with operators from the model's coordinates to their own."""

    mechanism: Mechanism
    model: LinearModel
    placed: tuple[Placed, ...]

    @property
    def elements(self) -> int:
        """Number of finite elements of all distinct components."""
        return sum(item.element.elements for item in self._distinct)

    @property
    def freedoms(self) -> int:
        """Number of unknowns of all distinct components before reduction."""
        return sum(item.element.freedoms for item in self._distinct)

    @property
    def sizes(self) -> dict[str, int]:
        """Number of unknowns of every distinct component, with the same keys as in `Reduction.raised`."""
        return {content_in_stage(item.component): item.element.freedoms for item in self._distinct}

    @property
    def _distinct(self) -> list[Placed]:
        return list({id(item.element.skin): item for item in self.placed}.values())


def solids(ways: Ways = STANDARD_WAYS) -> Solids:
    """Return a function that checks outlines and reduces components; `ways` specifies cache, progress and processes.

    >>> solids()(Mechanism("nothing"), Reduction())
    ()
    """
    return lambda mechanism, reduction: reduce_parts(sound_components(mechanism, ways.cache, pool=ways.pool), reduction, ways)


def remember(reduce: Solids) -> Solids:
    """Return a function that stores the results of `reduce`. If components are `raised`, it combines stored results of two orders.

    >>> remember(solids())(Mechanism("nothing"), Reduction())
    ()
    """
    known: dict[tuple[str, Reduction], Parts] = {}

    def again(mechanism: Mechanism, reduction: Reduction) -> Parts:
        name, plain = digest(mechanism), replace(reduction, raised=frozenset())
        if (name, reduction) in known:
            return known[name, reduction]
        higher = replace(plain, fineness=replace(plain.fineness, order=plain.fineness.order + 1))
        if reduction.raised and (name, plain) in known and (name, higher) in known:
            pairs = zip(known[name, plain], known[name, higher], strict=True)
            return tuple(more if content_in_stage(less[0]) in reduction.raised else less for less, more in pairs)
        known[name, reduction] = reduce(mechanism, reduction)
        return known[name, reduction]

    return again


STANDARD_SOLIDS = solids()
"""Function that reduces components, with the user's cache."""

STANDARD_REDUCTION, _CACHE = Reduction(), Cache()


@check_arguments
def model(
    mechanism: Mechanism,
    reduction: Reduction = STANDARD_REDUCTION,
    *,
    cache: Cache | None = _CACHE,
    progress: Progress | None = None,
    memory: float | None = None,
) -> LinearModel:
    """Model a stage as 3-D elastic solids: each distinct component by finite elements, reduced by the Craig-Bampton method, then joined.

    Inputs and outputs have the same names as in `lumped`. Every distinct component is meshed and reduced once, in a separate process, and
    stored in the `cache` (`None`: no cache). `progress` receives the step, the completed fraction and the remaining seconds. `memory`
    [bytes] limits the planned memory (default: the free memory of the machine).

    Before meshing, raises `DesignError` for links with neither a shape nor a specified stiffness, and for gaps, overlaps and slivers of
    outlines. Failed meshes, insufficient memory or time, and stages with rigid-body motions are also errors. Problems of the cache cause
    warnings.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> model(parallelogram(), memory=1e6, cache=None)
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: ...
    """
    with Pool() as pool:
        return read_solid(mechanism, reduction, solids(Ways(cache, progress, Limits(memory=memory), pool))).model


def read_solid(mechanism: Mechanism, reduction: Reduction, reduce: Solids) -> SolidRead:
    """Model a stage as solids. For a calibrated hinge, its drawn shape is used instead of its compliance matrix.

    `reduce` is the function that reduces the components. Raises `DesignError` for links without a shape or a specified stiffness, for gaps,
    overlaps and slivers of outlines, and if the stage has a rigid-body motion.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.restrict import restrict
    >>> from flexstage.parts.freedom import Freedom
    >>> read_solid(restrict(parallelogram(), {'leaf': ((Freedom.X,), ())}), Reduction(), solids())
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: left: some of its DOFs are locked or freed by a restriction. ...
    """
    shape = with_drawn_parts(mechanism)
    assembly = expand(shape)
    parts = reduce(shape, reduction)
    order = reduction.fineness.order
    orders = f"{order} and {order + 1}" if reduction.raised else f"{order}"
    bare = f", 0 in components of order {order + 1}" if reduction.raised and reduction.static else ""
    provenance = f"solid model of {digest(shape, physics=True)[:16]}, order {orders}, {reduction.modes} modes per component{bare}"
    return SolidRead(shape, linear_model(shape, assembly, parts, provenance), place_parts(assembly, parts))


def coarsen(reduction: Reduction) -> Reduction:
    """Return the coarser resolution for the error estimate: the same mesh, with elements one order lower.

    >>> coarsen(Reduction()).fineness.order
    2
    """
    return replace(reduction, fineness=replace(reduction.fineness, order=reduction.fineness.order - 1))
