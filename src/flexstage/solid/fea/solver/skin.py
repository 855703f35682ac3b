"""Skins: displacement and stress of the basis motions at the surface, for pictures and for the highest stress."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import ngsolve
import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.solid.fea.geometry.mirror import MIRRORS
from flexstage.solid.fea.geometry.piece import MILLIMETRES
from flexstage.solid.fea.solver.field import Columns, Field, hooke
from flexstage.solid.fea.solver.superelement import Skin

_VOIGT = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
_FROM_VOIGT = [0, 1, 2, 5, 3, 4]
"""Order of stresses xx, yy, zz, xy, yz, zx, as positions in the order of a medium's law."""
_AT_ONCE = 32
"""Number of motions that are computed at once."""

_WITHIN = [(2 / 3, 1 / 6), (1 / 6, 2 / 3), (1 / 6, 1 / 6)]
"""Points within a triangle, in the order of the triangle's corners."""
_CONTINUED = 2.0 * np.eye(3) - np.full((3, 3), 1.0 / 3.0)
"""Linear extrapolation from the points within to the corners: 5/3 of the nearest point's value minus 1/3 of the other values."""
_LEAST_WEIGHT = 1e-12
_NEAR = 1e-9
"""Tolerance for points in a plane, divided by the drawing's size."""


def skin(space: Field, motions: Columns) -> Skin:
    """Build the surface of a field's mesh, with displacement and stress in `motions`. If the mesh has mirrors, return the whole surface.

    Stresses are evaluated within each triangle and extrapolated to its corners. The stress at a vertex is the mean over its triangles,
    weighted by the Jacobian, because strains of a nearly folded element are meaningless.

    >>> from flexstage.solid.fea.meshing.bar import bar
    >>> from flexstage.solid.fea.solver.field import field
    >>> from flexstage.solid.fea.meshing.fineness import Fineness
    >>> from flexstage.solid.fea.meshing.mesh import mesh_component
    >>> space = field(mesh_component(bar(), Fineness(order=2)), ["foot"], 2)
    >>> skin(space, Columns.of(np.zeros((space.size, 1)))).motion.max().item()
    0.0
    """
    mesh, basis = space.meshed.mesh, motions.values
    elements = list(mesh.Elements(ngsolve.BND))
    outside = np.array([element.mat not in MIRRORS.values() for element in elements])
    corners = np.array([[vertex.nr for vertex in element.vertices] for element in elements])[outside]
    used, triangles = np.unique(corners, return_inverse=True)
    triangles = triangles.reshape(corners.shape)
    places = np.array([mesh.vertices[int(number)].point for number in used]) / MILLIMETRES
    behind = np.array([mesh[element.faces[0]].elements[0].nr for element in elements], dtype=int)[outside]
    within = mesh.MapToAllElements(ngsolve.IntegrationRule(_WITHIN, [0.0, 0.0, 0.0]), ngsolve.BND)
    within = within.reshape(len(elements), -1)[outside].ravel()
    gradient = _gradient(space, corners, behind, within)
    laws = np.array([hooke(medium) for medium in space.meshed.media])[_media(space)[behind]]
    weights = _weights(within)
    average = _mean_by_vertex(triangles, weights[:, 0])
    columns, points = basis.shape[1], 3 * len(behind)
    motion = basis.reshape(3, -1, columns)[:, used].transpose(1, 0, 2).astype(np.float32)  # each vertex has its own function
    stress = np.empty((len(used), 6, columns), dtype=np.float32)
    for first in range(0, columns, _AT_ONCE):
        part = basis[:, first : first + _AT_ONCE]
        moved = part.reshape(3, -1, part.shape[1]).transpose(1, 0, 2).reshape(-1, 3 * part.shape[1])
        slopes = (gradient @ moved).reshape(points, 3, 3, -1)  # by point, derivative, component, column
        strains = np.stack([slopes[:, i, j] if i == j else slopes[:, i, j] + slopes[:, j, i] for i, j in _VOIGT], axis=1)
        found = np.einsum("tij,tpjc->tpic", laws, strains.reshape(len(behind), 3, 6, -1))
        ends = np.einsum("ab,tbic->taic", _CONTINUED, found)[:, :, _FROM_VOIGT]
        stress[..., first : first + _AT_ONCE] = (average @ ends.reshape(points, -1)).reshape(len(used), 6, -1)
    found, meshed = Skin(places, triangles, motion, stress, space.meshed.owner[behind]), space.meshed
    for axis in meshed.mirrors.axes:
        found = _with_image(found, axis, meshed.mirrors.is_odd(motions.kinds, axis))
    return replace(found, owner=np.concatenate([owner[behind] for owner in (meshed.owner, *meshed.images)]))


def _with_image(side: Skin, axis: int, odd: Array) -> Skin:
    """A surface and its mirror image across an axis, with the sign of `odd` (k,) motions changed."""
    signs, turn = np.where(np.arange(3) == axis, -1.0, 1.0), np.where(odd, -1.0, 1.0)
    apart = np.abs(side.vertices[:, axis]) > _NEAR * np.max(np.abs(side.vertices))
    images = np.where(apart, len(apart) + np.cumsum(apart) - 1, np.arange(len(apart)))
    motion = (side.motion * (signs[:, None] * turn)).astype(np.float32)
    stress = (side.stress * (np.array([signs[i] * signs[j] for i, j in _VOIGT])[_FROM_VOIGT, None] * turn)).astype(np.float32)
    mean = np.where(apart[:, None, None], side.stress, 0.5 * (side.stress + stress))
    return Skin(
        np.vstack([side.vertices, (side.vertices * signs)[apart]]),
        np.vstack([side.triangles, images[side.triangles][:, ::-1]]),
        np.concatenate([side.motion, motion[apart]]),
        np.concatenate([mean, stress[apart]]),
        np.tile(side.owner, 2),
    )


def _gradient(space: Field, corners: Array, behind: Array, points: Any) -> Any:
    """Operator of the derivatives along x, y and z [1/m] at points within each triangle, of the scalar functions of the elements behind."""
    scalar, mesh = space.space.components[0], space.meshed.mesh
    turned = ngsolve.BoundaryFromVolumeCF(ngsolve.specialcf.JacobianMatrix(3))(points)
    inverse = MILLIMETRES * np.linalg.inv(np.asarray(turned).reshape(len(behind), 3, 3, 3))
    weights = np.array([(a, b, 1.0 - a - b) for a, b in _WITHIN])
    values, columns = list[Array](), list[Array]()
    for triangle, number in enumerate(behind.tolist()):
        element = ngsolve.ElementId(ngsolve.VOL, number)
        members = [vertex.nr for vertex in mesh[element].vertices]
        share, function = np.zeros((3, 4)), scalar.GetFE(element)
        share[:, [members.index(corner) for corner in corners[triangle]]] = weights
        shapes = np.stack([np.array(function.CalcDShape(*point[:3]).NumPy()) for point in share])
        values.append((shapes @ inverse[triangle]).transpose(0, 2, 1).ravel())  # by point, derivative, function
        columns.append(np.tile(scalar.GetDofNrs(element), 9))
    starts = np.concatenate([[0], np.cumsum(np.repeat([len(each) // 9 for each in values], 9))])
    return scipy.sparse.csr_array((np.concatenate(values), np.concatenate(columns), starts), shape=(len(starts) - 1, scalar.ndof))


def _media(space: Field) -> Array:
    """The medium (index) of each element."""
    return np.array([int(element.mat.rpartition(" ")[2]) for element in space.meshed.mesh.Elements(ngsolve.VOL)])


def _weights(points: Any) -> Array:
    """Jacobian of the element behind each triangle (3 t, 1) at points within it, with a positive minimum."""
    values = np.asarray(ngsolve.BoundaryFromVolumeCF(ngsolve.Det(ngsolve.specialcf.JacobianMatrix(3)))(points)).reshape(-1, 1)
    return np.maximum(values, _LEAST_WEIGHT * float(np.max(values)))


def _mean_by_vertex(triangles: Array, weights: Array) -> Any:
    """Operator of weighted means at vertices of values at the corners of all triangles."""
    count = int(triangles.max()) + 1
    shares = weights / np.bincount(triangles.ravel(), weights, count)[triangles.ravel()]
    return scipy.sparse.csr_array((shares, (triangles.ravel(), np.arange(len(shares)))), shape=(count, len(shares)))


def surface_owners(mesh: ngsolve.Mesh, owner: Array) -> Array:
    """Return the piece of the element behind each triangle."""
    behind = [mesh[face.faces[0]].elements[0].nr for face in mesh.Elements(ngsolve.BND)]
    return owner[np.array(behind, dtype=int)]
