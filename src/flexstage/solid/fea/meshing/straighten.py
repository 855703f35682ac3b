"""Straightening: elements that would be inverted by curved sides get straight sides where straight sides are harmless.

A concave arc of radius R bulges into its elements by h^2 / (8 R), with element size h, and inverts flatter elements. The inverted elements
are few, all near the ends of arcs, where sections are thick. Smaller elements everywhere would need far more computing time than these
straight sides.
"""

from __future__ import annotations

import ngsolve
import numpy as np

from flexstage.base.number import Array

_FLAT = 0.05
"""Smallest permitted ratio of the lowest to the highest Jacobian determinant of an element."""
_ORDER = 4


def straighten(mesh: ngsolve.Mesh, kept: Array) -> str | None:
    """Give folded elements of a curved mesh straight sides. Return `None`, or the reason if straightening fails.

    Elements of `kept` (mask) keep their curved sides; if one of these elements is inverted, the reason contains the lowest Jacobian
    determinant. If an element was folded, the mesh is reset to order one, and a deformation of the mesh represents the remaining curvature.
    Call `UnsetDeformation` before you curve the mesh again.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> block = mesh_component(bar(), Fineness(order=2)).mesh  # has nothing curved
    >>> straighten(block, np.zeros(block.ne, dtype=bool)), block.deformation is None
    (None, True)
    """
    lowest, highest = jacobians(mesh)
    if np.any(lowest[kept] <= 0.0):
        return f"a curved face turns an element inside out, Jacobian {float(np.min(lowest[kept])):.3g}"
    folded = _folded_elements(lowest, highest) & ~kept
    if not np.any(folded):
        return None
    shape = _shape(mesh)
    mesh.Curve(1)
    mesh.SetDeformation(shape)
    while np.any(folded):  # ends: an element with straight sides only is valid
        _flatten(shape, folded)
        lowest, highest = jacobians(mesh)
        folded = _folded_elements(lowest, highest) & ~kept
        folded[folded] = [_is_curved(shape, number) for number in np.flatnonzero(folded).tolist()]
    worst = float(np.min(lowest))
    return None if worst > 0.0 else f"a straight element is inside out, Jacobian {worst:.3g}"


def jacobians(mesh: ngsolve.Mesh) -> tuple[Array, Array]:
    """Compute the lowest and the highest Jacobian determinants (n,) of n elements at the points of a quadrature rule of order four.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> lowest, highest = jacobians(mesh_component(bar(), Fineness(order=2)).mesh)  # six times the volumes: straight ones are even
    >>> round(float(sum(lowest)) / 6.0, 6), bool(np.allclose(lowest, highest))
    (10000.0, True)
    """
    points = mesh.MapToAllElements(ngsolve.IntegrationRule(ngsolve.TET, _ORDER), ngsolve.VOL)
    values = np.asarray(ngsolve.Det(ngsolve.specialcf.JacobianMatrix(3))(points)).reshape(mesh.ne, -1)
    return values.min(axis=1), values.max(axis=1)


def _folded_elements(lowest: Array, highest: Array) -> Array:
    return lowest < _FLAT * highest


def _shape(mesh: ngsolve.Mesh) -> ngsolve.GridFunction:
    """Difference between curved and straight mesh [mm]: the hierarchical coordinates of the position without those of vertices."""
    space = ngsolve.VectorH1(mesh, order=mesh.GetCurveOrder())
    shape = ngsolve.GridFunction(space)
    shape.Set(ngsolve.CoefficientFunction((ngsolve.x, ngsolve.y, ngsolve.z)))
    for component in shape.components:
        component.vec.FV().NumPy()[: mesh.nv] = 0.0
    return shape


def _flatten(shape: ngsolve.GridFunction, elements: Array) -> None:
    values = shape.vec.FV().NumPy()
    for number in np.flatnonzero(elements).tolist():
        values[_coordinates(shape, number)] = 0.0


def _is_curved(shape: ngsolve.GridFunction, number: int) -> bool:
    return bool(np.any(shape.vec.FV().NumPy()[_coordinates(shape, number)]))


def _coordinates(shape: ngsolve.GridFunction, number: int) -> list[int]:
    return [dof for dof in shape.space.GetDofNrs(ngsolve.ElementId(ngsolve.VOL, number)) if dof >= 0]
