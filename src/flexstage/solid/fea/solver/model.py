"""Solid model: the same description as 3-D elastic bodies, by substructures."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding
from flexstage.base.processes.progress import Progress
from flexstage.base.storage.digest import digest
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.solid.fea.geometry.sound import sound_components
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.parts import Parts, Ways, reduce_parts
from flexstage.solid.fea.jobs.remote import Limits, Pool
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.solver.assemble import linear_model
from flexstage.solid.fea.solver.component import Component
from flexstage.solid.fea.solver.superelement import Superelement

_CACHE, _STANDARD = Cache(), Reduction()


@dataclass(frozen=True, eq=False)
class SolidModel:
    """A stage read as solids: its linear model, the components with the superelements it is made of, how they were reduced.

    `notices` say what is to be known about the cache; the result is complete all the same.
    """

    model: LinearModel
    parts: Parts
    reduction: Reduction
    notices: tuple[Finding, ...]

    @property
    def components(self) -> tuple[Component, ...]:
        """The components, copies included."""
        return tuple(component for component, _ in self.parts)

    @property
    def superelements(self) -> tuple[Superelement, ...]:
        """The superelement of each component; copies share one."""
        return tuple(element for _, element in self.parts)


@check_arguments
def model(
    mechanism: Mechanism,
    reduction: Reduction = _STANDARD,
    *,
    cache: Cache | None = _CACHE,
    progress: Progress | None = None,
    memory: float | None = None,
) -> LinearModel:
    """Read a stage as 3-D elastic solids: finite elements of each distinct component, reduced by Craig and Bampton's method and joined.

    Same names of inputs and outputs as `lumped`. Every component is drawn, meshed and reduced once, in a process of its own, and kept in
    the `cache` (`None`: neither looked up nor kept). `progress` is told what is done, the fraction and the seconds left; `memory` [bytes]
    bounds what is planned with (absent: what the machine has left). Raises `DesignError` for links without a shape, for gaps, overlaps and
    slivers of outlines, all by name before anything is meshed, for meshes that cannot be made, too little memory or time, and stages that
    move freely. What is to be said about the cache is warned.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> model(parallelogram(), memory=1e6, cache=None)
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: ...
    """
    solid = model_with_parts(mechanism, reduction, cache=cache, progress=progress, memory=memory)
    for notice in solid.notices:
        warnings.warn(str(notice), stacklevel=2)
    return solid.model


def model_with_parts(
    mechanism: Mechanism,
    reduction: Reduction = _STANDARD,
    *,
    cache: Cache | None = _CACHE,
    progress: Progress | None = None,
    memory: float | None = None,
) -> SolidModel:
    """Read a stage as `model` does, and return the reduced components as well: fields for pictures and stress, and notices.

    Calibrated hinges are read as the shapes they stand for.
    """
    shape = with_drawn_parts(mechanism)
    with Pool() as pool:
        reduced = reduce_parts(sound_components(shape, cache, pool=pool), reduction, Ways(cache, progress, Limits(memory=memory), pool))
    model = linear_model(shape, expand(shape), reduced.parts, f"solid model of {digest(shape, physics=True)[:16]}")
    return SolidModel(model, reduced.parts, reduction, reduced.notices)
