"""VTU files: the meshes of all components of a stage as one unstructured grid of quadratic tetrahedra, in metres.

Cells carry numbers: of their piece, of the body or link it belongs to, of the material and of the component; the names behind the numbers
stand in a comment at the head of the file. Components do not share points where they meet: they are joined by coordinates, not by nodes.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path
from xml.sax.saxutils import escape

import meshio
import ngsolve
import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.mechanism import Mechanism
from flexstage.readings.solid.component import Component, components
from flexstage.readings.solid.content import content
from flexstage.readings.solid.draw import MILLIMETRES
from flexstage.readings.solid.fineness import Fineness
from flexstage.readings.solid.mesh import Meshed, meshed
from flexstage.readings.solid.stage_pieces import Stage, require_shapes, stage_pieces

_CORNERS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
_ORDER = (1, 0, 2, 3)
"""Corners in the order of VTK, whose tetrahedra turn the other way."""
_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
"""Edges in the order of VTK."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Quadratic tetrahedra: `points` (p, 3) [m], `cells` (c, 10), and the number of the piece (c,) they belong to."""

    points: Array
    cells: Array
    owner: Array


@dataclass(frozen=True, eq=False)
class StageMesh:
    """The grids of all components in the stage's frame, and the pieces' names by number."""

    stage: Stage
    components: tuple[Component, ...]
    grids: tuple[Grid, ...]
    pieces: tuple[str, ...]


def stage_mesh(mechanism: Mechanism, fineness: Fineness) -> StageMesh:
    """Mesh every distinct component once, and place it with every copy.

    Raises `DesignError` where the outlines do not form solids or cannot be meshed, and where nothing has a shape.

    >>> stage_mesh(Mechanism("nothing"), Fineness())
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: nothing: no body has outlines and no link a shape. ...
    """
    stage, parts = stage_pieces(mechanism), components(mechanism)
    require_shapes(mechanism, stage)
    numbers = {name: number for number, name in enumerate(stage.pieces)}
    own: dict[str, Grid] = {}
    grids: list[Grid] = []
    for part in parts:
        key = content(part)
        if key not in own:
            own[key] = grid(meshed(part, fineness))
        names = np.array([numbers[piece.name] for piece in part.pieces])
        grids.append(Grid(part.place.point(own[key].points), own[key].cells, names[own[key].owner]))
    return StageMesh(stage, parts, tuple(grids), tuple(stage.pieces))


def grid(mesh: Meshed) -> Grid:
    """A mesh's tetrahedra with the middles of their edges, which lie on the curved geometry.

    >>> from netgen import occ
    >>> cube = ngsolve.Mesh(occ.OCCGeometry(occ.Box((0, 0, 0), (1, 1, 1))).GenerateMesh(maxh=2.0))
    >>> drawn = grid(Meshed(cube, (), (), np.zeros(cube.ne, dtype=int)))
    >>> drawn.cells.shape == (cube.ne, 10), float(drawn.points.max())
    (True, 0.001)
    """
    elements = np.array([[vertex.nr for vertex in element.vertices] for element in mesh.mesh.Elements(ngsolve.VOL)])[:, _ORDER]
    corners = np.array(_CORNERS)[list(_ORDER)]
    middles = np.array([0.5 * (corners[one] + corners[other]) for one, other in _EDGES])
    ends = np.sort(np.stack([elements[:, edge] for edge in _EDGES], axis=1), axis=2)
    _, first, number = np.unique(ends.reshape(-1, 2), axis=0, return_index=True, return_inverse=True)
    rule = ngsolve.IntegrationRule([tuple(point) for point in middles.tolist()], [0.0] * len(middles))
    place = ngsolve.CoefficientFunction((ngsolve.x, ngsolve.y, ngsolve.z))
    mapped = np.asarray(place(mesh.mesh.MapToAllElements(rule, ngsolve.VOL)))
    points = np.array([vertex.point for vertex in mesh.mesh.vertices])
    cells = np.hstack([elements, len(points) + number.reshape(-1, len(_EDGES))])
    return Grid(np.vstack([points, mapped[first]]) / MILLIMETRES, cells, np.asarray(mesh.owner))


def vtu(mesh: StageMesh) -> bytes:
    """The file of a stage's mesh: cell data `piece`, `body`, `material`, `component` (numbers), `young` [Pa] and `density` [kg/m^3].

    >>> vtu.__name__  # meshing takes long
    'vtu'
    """
    pieces = [mesh.stage.pieces[name] for name in mesh.pieces]
    bodies = _numbered(piece.name if piece.body is None else piece.body for piece in pieces)
    materials = _numbered(mesh.stage.materials[name] for name in mesh.pieces)
    owner = np.concatenate([item.owner for item in mesh.grids])
    part = np.concatenate([np.full(len(item.owner), number) for number, item in enumerate(mesh.grids)])
    body = np.array([bodies[piece.name if piece.body is None else piece.body] for piece in pieces])
    material = np.array([materials[mesh.stage.materials[name]] for name in mesh.pieces])
    data = {
        "piece": owner,
        "body": body[owner],
        "material": material[owner],
        "component": part,
        "young": np.array([piece.medium.young for piece in pieces])[owner],
        "density": np.array([piece.medium.density for piece in pieces])[owner],
    }
    names = {"piece": mesh.pieces, "body": tuple(bodies), "material": tuple(materials)}
    return _commented(_written(mesh.grids, data), {**names, "component": tuple(each.name for each in mesh.components)})


def _numbered(names: Iterable[str]) -> dict[str, int]:
    return {name: number for number, name in enumerate(dict.fromkeys(names))}


def _written(grids: Sequence[Grid], data: Mapping[str, Array]) -> bytes:
    starts = [0, *accumulate(len(item.points) for item in grids)]
    cells = np.vstack([item.cells + start for item, start in zip(grids, starts, strict=False)])
    points = np.vstack([item.points for item in grids])
    mesh = meshio.Mesh(points, [("tetra10", cells)], cell_data={name: [values] for name, values in data.items()})
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "stage.vtu"
        mesh.write(path, file_format="vtu")
        return path.read_bytes()


def _commented(content: bytes, names: Mapping[str, Sequence[str]]) -> bytes:
    """The file with the names behind its numbers as a comment."""
    lines = ["lengths in metres; numbers of the cell data:"]
    lines += [f"{kind} {number}: {escape(name)}" for kind, members in names.items() for number, name in enumerate(members)]
    comment = "\n".join(lines).replace("--", "- -")
    head, start, rest = content.partition(b"<VTKFile")
    return head + f"<!--\n{comment}\n-->\n".encode() + start + rest
