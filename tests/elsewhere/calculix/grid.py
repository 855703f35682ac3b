"""A mesh of ours as ten-node tetrahedra of CalculiX (C3D10): nodes at vertices and at the middles of our curved edges.

Edges 1-2, 2-3, 3-1, 1-4, 2-4, 3-4 carry the nodes 5 to 10, and the fourth corner lies on the side the first three turn about by the right
hand; gmsh exchanges the last two nodes, NGSolve (whose elements have no nodes) knows edges by their vertices only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import ngsolve
import numpy as np

from flexstage.base.number import Array
from flexstage.solid.fea.meshing.mesh import PieceMesh

EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
SIDES = ((0, 1), (1, 2), (2, 0))
_CORNERS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
"""Of NGSolve's reference tetrahedron, in the order of an element's vertices; its triangle's are (1, 0), (0, 1), (0, 0)."""


@dataclass(frozen=True)
class Grid:
    """Nodes (n, 3) [mm], elements (m, 10) by node, and the medium (m,) of each; six-node triangles (k, 6) of named faces."""

    nodes: Array
    elements: Array
    medium: Array
    faces: Mapping[str, Array]


def grid(mesh: PieceMesh, faces: tuple[str, ...]) -> Grid:
    """Elements of order two on our mesh; its `Curve` must have been of order one or two."""
    ours = mesh.mesh
    vertices = np.array([vertex.point for vertex in ours.vertices])
    corners = np.array([[vertex.nr for vertex in element.vertices] for element in ours.Elements(ngsolve.VOL)])
    middles = _mapped(ours, [0.5 * (_CORNERS[a] + _CORNERS[b]) for a, b in EDGES], len(corners))
    number: dict[tuple[int, int], int] = {}
    places: list[Array] = []
    for element, points in zip(corners, middles, strict=True):
        for (a, b), point in zip(EDGES, points, strict=True):
            key = _edge(element[a], element[b])
            if key not in number:
                number[key] = len(vertices) + len(places)
                places.append(point)
    turned = np.array([_right_handed(element, vertices) for element in corners])
    elements = np.array([[*element, *(number[_edge(element[a], element[b])] for a, b in EDGES)] for element in turned])
    names = {f"medium {index}": index for index in range(len(mesh.media))}
    medium = np.array([names[element.mat] for element in ours.Elements(ngsolve.VOL)])
    return Grid(np.vstack([vertices, *places]), elements, medium, {face: _triangles(ours, face, number) for face in faces})


def spread(mesh: Grid, face: str) -> dict[int, float]:
    """Nodal shares of a unit force spread evenly over a face: int N dA / A."""
    total: dict[int, float] = {}
    for triangle in mesh.faces[face]:
        for node, share in zip(triangle, _shares(mesh.nodes[triangle]), strict=True):
            total[int(node)] = total.get(int(node), 0.0) + float(share)
    area = sum(total.values())
    return {node: share / area for node, share in total.items()}


def _mapped(mesh: ngsolve.Mesh, points: list[Array], elements: int) -> Array:
    """Where reference points of each element lie (m, points, 3)."""
    rule = ngsolve.IntegrationRule([tuple(point) for point in points], [0.0] * len(points))
    places = mesh.MapToAllElements({ngsolve.TET: rule}, ngsolve.VOL)
    position = ngsolve.CoefficientFunction((ngsolve.x, ngsolve.y, ngsolve.z))
    return np.asarray(position(places)).reshape(elements, len(points), 3)


def _edge(a: int, b: int) -> tuple[int, int]:
    return (int(min(a, b)), int(max(a, b)))


def _right_handed(element: Array, vertices: Array) -> Array:
    origin, *others = vertices[element]
    if np.linalg.det(np.array(others) - origin) > 0.0:
        return element
    return element[[1, 0, 2, 3]]


def _triangles(mesh: ngsolve.Mesh, face: str, number: Mapping[tuple[int, int], int]) -> Array:
    corners = [[vertex.nr for vertex in element.vertices] for element in mesh.Elements(ngsolve.BND) if element.mat == face]
    return np.array([[*triangle, *(number[_edge(triangle[a], triangle[b])] for a, b in SIDES)] for triangle in corners])


def _shares(nodes: Array) -> Array:
    """int N dA (6,) of one six-node triangle in a plane, by a rule of degree five."""
    total = np.zeros(6)
    for first, second, weight in _radon():
        values, slopes = _shapes(first, second)
        normal = np.cross(*(slopes @ nodes))
        total += weight * float(np.linalg.norm(normal)) * values
    return total


def _radon() -> list[tuple[float, float, float]]:
    """Seven points and weights on the unit triangle (J. Radon 1948): exact to degree five."""
    root = float(np.sqrt(15.0))
    near, far = (6.0 - root) / 21.0, (6.0 + root) / 21.0
    light, heavy = (155.0 - root) / 2400.0, (155.0 + root) / 2400.0
    rule = [(1.0 / 3.0, 1.0 / 3.0, 9.0 / 80.0)]
    for at, weight in ((near, light), (far, heavy)):
        rule += [(at, at, weight), (1.0 - 2.0 * at, at, weight), (at, 1.0 - 2.0 * at, weight)]
    return rule


def _shapes(a: float, b: float) -> tuple[Array, Array]:
    """Quadratic shape functions (6,) of corners (c = 1 - a - b first) and middles, and their slopes (2, 6) along a and b."""
    c = 1.0 - a - b
    values = [c * (2 * c - 1), a * (2 * a - 1), b * (2 * b - 1), 4 * c * a, 4 * a * b, 4 * b * c]
    along_a = [1 - 4 * c, 4 * a - 1, 0.0, 4 * (c - a), 4 * b, -4 * b]
    along_b = [1 - 4 * c, 0.0, 4 * b - 1, -4 * a, 4 * a, 4 * (c - b)]
    return np.array(values), np.array([along_a, along_b])
