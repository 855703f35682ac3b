"""Grids for other programs: the mesh of a component as quadratic tetrahedra, made in a separate process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexstage.base.number import Array
from flexstage.solid.fea.jobs.reducing import ComponentJob
from flexstage.solid.fea.jobs.worker import Call
from flexstage.solid.fea.meshing.fineness import Fineness

if TYPE_CHECKING:
    from flexstage.solid.fea.meshing.mesh import PieceMesh

_CORNERS = np.array([(0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)])
_ORDER = (1, 0, 2, 3)
"""Corners in the order of VTK, whose tetrahedra have the opposite orientation: their places, and their numbers here."""
_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
"""Edges in the order of VTK."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Quadratic tetrahedra: `points` (p, 3) [m], `cells` (c, 10) in VTK's sequence of nodes, and each cell's piece index `owner` (c,)."""

    points: Array
    cells: Array
    owner: Array


@dataclass(frozen=True, eq=False)
class Gridding(ComponentJob):
    """Job that meshes a component in a separate process and returns the mesh as a grid."""

    fineness: Fineness

    def work(self, call: Call) -> Grid:
        """Mesh the component and return the grid."""
        from flexstage.solid.fea.meshing.mesh import mesh_component

        return grid(mesh_component(self.component, self.fineness, call.report, call.attempt))


def grid(mesh: PieceMesh) -> Grid:
    """Convert a mesh to a grid of quadratic tetrahedra, with mid-edge points on the curved geometry.

    >>> import ngsolve
    >>> from netgen import occ
    >>> from flexstage.solid.fea.meshing.mesh import PieceMesh
    >>> cube = ngsolve.Mesh(occ.OCCGeometry(occ.Box((0, 0, 0), (1, 1, 1))).GenerateMesh(maxh=2.0))
    >>> drawn = grid(PieceMesh(cube, (), (), np.zeros(cube.ne, dtype=int), np.zeros(cube.ne, dtype=bool)))
    >>> drawn.cells.shape == (cube.ne, 10), float(drawn.points.max())
    (True, 0.001)
    """
    import ngsolve

    from flexstage.solid.fea.geometry.piece import MILLIMETRES

    elements = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.mesh.Elements(ngsolve.VOL)])[:, _ORDER]
    middles = np.array([0.5 * (_CORNERS[one] + _CORNERS[other]) for one, other in _EDGES])
    ends = np.sort(np.stack([elements[:, edge] for edge in _EDGES], axis=1), axis=2)
    _, first, number = np.unique(ends.reshape(-1, 2), axis=0, return_index=True, return_inverse=True)
    rule = ngsolve.IntegrationRule([tuple(point) for point in middles.tolist()], [0.0] * len(middles))
    place = ngsolve.CoefficientFunction((ngsolve.x, ngsolve.y, ngsolve.z))
    mapped = np.asarray(place(mesh.mesh.MapToAllElements(rule, ngsolve.VOL)))
    points = np.array([vertex.point for vertex in mesh.mesh.vertices])
    cells = np.hstack([elements, len(points) + number.reshape(-1, len(_EDGES))])
    return Grid(np.vstack([points, mapped[first]]) / MILLIMETRES, cells, np.asarray(mesh.owner))
