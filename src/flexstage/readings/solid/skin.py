"""Skins: displacement and stress of the basis motions at the surface, for pictures and for the highest stress."""

from __future__ import annotations

import ngsolve
import numpy as np

from flexstage.base.number import Array
from flexstage.readings.solid.draw import MILLIMETRES
from flexstage.readings.solid.field import Field, strain
from flexstage.readings.solid.superelement import Skin

_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))


def skin(space: Field, basis: Array) -> Skin:
    """The surface of a field's mesh with the basis motions (n, k) on it; stresses are means over the triangles around a vertex."""
    mesh = space.meshed.mesh
    corners = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.Elements(ngsolve.BND)])
    used, triangles = np.unique(corners, return_inverse=True)
    triangles = triangles.reshape(corners.shape)
    places = np.array([mesh.vertices[int(number)].point for number in used]) / MILLIMETRES
    points = mesh.MapToAllElements(ngsolve.IntegrationRule([(1, 0), (0, 1), (0, 0)], [0.0, 0.0, 0.0]), ngsolve.BND)
    function = ngsolve.GridFunction(space.space)
    tension = space.stress(MILLIMETRES * strain(function))
    wanted = ngsolve.BoundaryFromVolumeCF(ngsolve.CoefficientFunction(tuple(tension[i, j] for i, j in _PAIRS)))
    motion = np.empty((len(used), 3, basis.shape[1]), dtype=np.float32)
    stress = np.empty((len(used), 6, basis.shape[1]), dtype=np.float32)
    shares = np.bincount(triangles.ravel(), minlength=len(used))[:, None]
    for number in range(basis.shape[1]):
        function.vec.FV().NumPy()[:] = basis[:, number]
        motion[triangles.ravel(), :, number] = function(points)
        stress[..., number] = _summed(triangles, np.asarray(wanted(points)), len(used)) / shares
    return Skin(places, triangles, motion, stress, _owners(mesh, space.meshed.owner))


def _summed(triangles: Array, values: Array, count: int) -> Array:
    total = np.zeros((count, values.shape[1]))
    np.add.at(total, triangles.ravel(), values)
    return total


def _owners(mesh: ngsolve.Mesh, owner: Array) -> Array:
    """The piece of the element behind each triangle."""
    behind = [mesh[face.facets[0]].elements[0].nr for face in mesh.Elements(ngsolve.BND)]
    return owner[np.array(behind, dtype=int)]
