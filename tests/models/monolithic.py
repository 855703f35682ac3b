"""Monolithic solve: the whole stage in one mesh, the check of the substructured one."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.base.storage.digest import digest
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.solid.fea.geometry.sound import sound_components
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.fea.meshing.mesh import mesh_component
from flexstage.solid.fea.solver.assemble import linear_model
from flexstage.solid.fea.solver.casing import casing, end_face_twist
from flexstage.solid.fea.solver.component import Component, Cut
from flexstage.solid.fea.solver.reduce import reduce_mesh

_STANDARD = Reduction(modes=18)


def monolithic(mechanism: Mechanism, reduction: Reduction = _STANDARD) -> LinearModel:
    """Read a stage as one elastic solid: no interface is held rigid but the end caps of stacks.

    The model is exact in statics under strokes and wrenches on the platform, and for its lowest `reduction.modes` modes, where all bodies
    are elastic and no payload is carried; it costs the time and memory of the whole mesh. Same names of inputs and outputs, same errors of
    outlines as `solid`.
    """
    assembly = expand(mechanism)
    parts = sound_components(mechanism, None, Cut.NONE)
    meshes = [(part, mesh_component(part, reduction.fineness)) for part in parts]
    whole = tuple((part, reduce_mesh(part, mesh, reduction, _springs(assembly, part))) for part, mesh in meshes)
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
