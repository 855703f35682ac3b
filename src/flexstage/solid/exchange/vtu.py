"""VTU files: the meshes of all components of a stage as one unstructured grid of quadratic tetrahedra, in metres.

Each cell has the numbers of its piece, of its body or link, of its material and of its component. A comment at the start of the file lists
the name that belongs to each number. Components do not share points at their interfaces: the model joins them by coordinates, not by nodes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from xml.sax.saxutils import escape

import meshio
import numpy as np

from flexstage.base.number import Array
from flexstage.base.processes.progress import Progress
from flexstage.base.storage.store import temporary_folder
from flexstage.base.text import printable
from flexstage.mechanism.mechanism import Mechanism
from flexstage.solid.exchange.grid import Grid, Gridding
from flexstage.solid.fea.geometry.stage_pieces import Stage, require_shapes, stage_pieces
from flexstage.solid.fea.jobs.content import content
from flexstage.solid.fea.jobs.install import require_solver
from flexstage.solid.fea.jobs.parts import distinct
from flexstage.solid.fea.jobs.remote import Limits, work_all
from flexstage.solid.fea.meshing.fineness import Fineness
from flexstage.solid.fea.solver.component import Component, components


@dataclass(frozen=True, eq=False)
class StageMesh:
    """Mesh of a stage: grids of all components in the stage's frame, and the names of the pieces by number."""

    stage: Stage
    components: tuple[Component, ...]
    grids: tuple[Grid, ...]
    pieces: tuple[str, ...]


def stage_mesh(mechanism: Mechanism, fineness: Fineness, progress: Progress | None = None) -> StageMesh:
    """Mesh every distinct component once, in a separate process, and place the mesh at every instance of the component.

    Raises `DesignError` if the outlines do not form solids or cannot be meshed, and for a stage without any shape.

    >>> stage_mesh(Mechanism("nothing"), Fineness())
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: nothing: no body has outlines, and no link has a shape. ...
    """
    stage, parts = stage_pieces(mechanism), components(mechanism)
    require_shapes(mechanism, stage)
    require_solver()
    jobs = [Gridding(content(part), part, fineness) for part in parts]
    own: dict[str, Grid] = {}
    work_all(distinct(jobs), lambda job, found: own.update({job.key: found}), Limits(), progress)
    names, grids = list(stage.pieces), list[Grid]()
    for part, job in zip(parts, jobs, strict=True):
        grid, numbers = own[job.key], np.array([names.index(piece.name) for piece in part.pieces])
        grids.append(Grid(part.place.point(grid.points), grid.cells, numbers[grid.owner]))
    return StageMesh(stage, parts, tuple(grids), tuple(names))


def vtu(mesh: StageMesh) -> bytes:
    """Return the content of the VTU file of a stage's mesh.

    Cell data are the numbers `piece`, `body`, `material` and `component`, and `young` [Pa] and `density` [kg/m^3].
    """
    pieces = [mesh.stage.pieces[name] for name in mesh.pieces]
    bodies, body = _numbered([piece.owner for piece in pieces])
    materials, material = _numbered([mesh.stage.materials[name] for name in mesh.pieces])
    owner = np.concatenate([item.owner for item in mesh.grids])
    data = {
        "piece": owner,
        "body": body[owner],
        "material": material[owner],
        "component": np.repeat(np.arange(len(mesh.grids)), [len(item.owner) for item in mesh.grids]),
        "young": np.array([piece.medium.young for piece in pieces])[owner],
        "density": np.array([piece.medium.density for piece in pieces])[owner],
    }
    names = {"piece": mesh.pieces, "body": bodies, "material": materials, "component": [each.name for each in mesh.components]}
    return _comment(_write_xml(mesh.grids, data), names)


def _numbered(names: Sequence[str]) -> tuple[list[str], Array]:
    """The distinct names, and the number of each name."""
    distinct = list(dict.fromkeys(names))
    return distinct, np.array([distinct.index(name) for name in names])


def _write_xml(grids: Sequence[Grid], data: Mapping[str, Array]) -> bytes:
    starts = [0, *accumulate(len(item.points) for item in grids)]
    cells = np.vstack([item.cells + start for item, start in zip(grids, starts, strict=False)])
    points = np.vstack([item.points for item in grids])
    mesh = meshio.Mesh(points, [("tetra10", cells)], cell_data={name: [values] for name, values in data.items()})
    with temporary_folder() as folder:
        path = folder / "stage.vtu"
        mesh.write(path, file_format="vtu")
        return path.read_bytes()


def _comment(content: bytes, names: Mapping[str, Sequence[str]]) -> bytes:
    """The file with a comment that lists the names of its numbers."""
    lines = ["lengths in metres; names of the numbers in the cell data:"]
    lines += [f"{kind} {number}: {escape(printable(name))}" for kind, members in names.items() for number, name in enumerate(members)]
    comment = "\n".join(lines).replace("--", "- -")
    head, start, rest = content.partition(b"<VTKFile")
    return head + f"<!--\n{comment}\n-->\n".encode() + start + rest
