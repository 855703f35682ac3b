"""Skins: displacement and stress of the basis motions at the surface, for pictures and for the highest stress."""

from __future__ import annotations

from typing import Any

import ngsolve
import numpy as np

from flexstage.base.number import Array
from flexstage.solid.fea.field import Field, strain
from flexstage.solid.fea.piece import MILLIMETRES
from flexstage.solid.fea.superelement import Skin

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))

_WITHIN = [(2 / 3, 1 / 6), (1 / 6, 2 / 3), (1 / 6, 1 / 6)]
"""Points within a triangle, in the order of its corners."""
_CONTINUED = 2.0 * np.eye(3) - np.full((3, 3), 1.0 / 3.0)
"""Values at the corners of what is linear, from those at the points within: 5/3 of the own less 1/3 of the others."""
_LEAST_WEIGHT = 1e-12


def skin(space: Field, basis: Array) -> Skin:
    """The surface of a field's mesh with the basis motions (n, k) on it.

    Stresses are taken within each triangle and continued to its corners; at a vertex they are means over its triangles, weighted by the
    Jacobian: where an element is nearly folded, strains have no meaning.

    >>> from flexstage.solid.fea.bar import bar
    >>> from flexstage.solid.fea.field import field
    >>> from flexstage.solid.fea.fineness import Fineness
    >>> from flexstage.solid.fea.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> skin(space, np.zeros((space.size, 1))).motion.max().item()
    0.0
    """
    mesh = space.meshed.mesh
    corners = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.Elements(ngsolve.BND)])
    used, triangles = np.unique(corners, return_inverse=True)
    triangles = triangles.reshape(corners.shape)
    places = np.array([mesh.vertices[int(number)].point for number in used]) / MILLIMETRES
    points = mesh.MapToAllElements(ngsolve.IntegrationRule([(1, 0), (0, 1), (0, 0)], [0.0, 0.0, 0.0]), ngsolve.BND)
    within = mesh.MapToAllElements(ngsolve.IntegrationRule(_WITHIN, [0.0, 0.0, 0.0]), ngsolve.BND)
    function = ngsolve.GridFunction(space.space)
    tension = space.stress(MILLIMETRES * strain(function))
    wanted = ngsolve.BoundaryFromVolumeCF(ngsolve.CoefficientFunction(tuple(tension[i, j] for i, j in _PAIRS)))
    motion = np.empty((len(used), 3, basis.shape[1]), dtype=np.float32)
    stress = np.empty((len(used), 6, basis.shape[1]), dtype=np.float32)
    weights = _weights(within)
    shares = _sum_by_vertex(triangles, weights, len(used))
    for number in range(basis.shape[1]):
        function.vec.FV().NumPy()[:] = basis[:, number]
        motion[triangles.ravel(), :, number] = function(points)
        found = np.einsum("ab,tbc->tac", _CONTINUED, np.asarray(wanted(within)).reshape(-1, 3, 6)).reshape(-1, 6)
        stress[..., number] = _sum_by_vertex(triangles, weights * found, len(used)) / shares
    return Skin(places, triangles, motion, stress, surface_owners(mesh, space.meshed.owner))


def _weights(points: Any) -> Array:
    """Jacobian of the element behind each triangle (3 t, 1) at points within it, never quite zero."""
    values = np.asarray(ngsolve.BoundaryFromVolumeCF(ngsolve.Det(ngsolve.specialcf.JacobianMatrix(3)))(points)).reshape(-1, 1)
    return np.maximum(values, _LEAST_WEIGHT * float(np.max(values)))


def _sum_by_vertex(triangles: Array, values: Array, count: int) -> Array:
    total = np.zeros((count, values.shape[1]))
    np.add.at(total, triangles.ravel(), values)
    return total


def surface_owners(mesh: ngsolve.Mesh, owner: Array) -> Array:
    """The piece of the element behind each triangle."""
    behind = [mesh[face.facets[0]].elements[0].nr for face in mesh.Elements(ngsolve.BND)]
    return owner[np.array(behind, dtype=int)]
