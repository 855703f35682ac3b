"""Monolithic solve: the whole stage in one mesh, the check of the substructured one."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.base.processes.progress import Progress
from flexstage.base.storage.digest import digest
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.solid.fea.geometry.sound import sound_components
from flexstage.solid.fea.jobs.cache import Cache
from flexstage.solid.fea.jobs.parts import Ways, reduce_parts
from flexstage.solid.fea.jobs.remote import Limits, Pool
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.solver.assemble import linear_model
from flexstage.solid.fea.solver.casing import casing, end_face_twist
from flexstage.solid.fea.solver.component import Component, Cut

_CACHE, _STANDARD = Cache(), Reduction(modes=18)


def monolithic(
    mechanism: Mechanism,
    reduction: Reduction = _STANDARD,
    *,
    cache: Cache | None = _CACHE,
    progress: Progress | None = None,
    memory: float | None = None,
) -> LinearModel:
    """Read a stage as one elastic solid: no interface is held rigid but the end caps of stacks.

    The model is exact in statics under strokes and wrenches on the platform, and for its lowest `reduction.modes` modes, where all bodies
    are elastic and no payload is carried; it costs the time and memory of the whole mesh. Same names of inputs and outputs, same options
    and errors as `solid`.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> monolithic(parallelogram(), memory=1e6, cache=None)
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: ...
    """
    assembly = expand(mechanism)
    with Pool() as pool:
        parts = sound_components(mechanism, cache, Cut.NONE, pool)
        springs = {part.name: _springs(assembly, part) for part in parts}
        whole = reduce_parts(parts, reduction, Ways(cache, progress, Limits(memory=memory), pool), springs)
    return linear_model(mechanism, assembly, whole, f"monolithic solid model of {digest(mechanism, physics=True)[:16]}")


def _springs(assembly: Assembly, component: Component) -> Array:
    """Stiffness (6 m, 6 m) of the casings between a component's interfaces, in its axes."""
    total = np.zeros((6 * len(component.interfaces),) * 2)
    for piece in component.pieces:
        law = None if piece.body is not None else casing(assembly.links[piece.name])
        if law is not None:
            across = end_face_twist(component, assembly.links[piece.name])
            total += across.T @ law @ across
    return total
