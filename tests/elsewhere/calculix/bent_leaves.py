"""Leaves at large displacements as solids of CalculiX: decks of graded bricks, and what `ccx` printed for them.

Run as a module (`python -m tests.elsewhere.calculix.bent_leaves`, needs `ccx`) to make `stored/bent-leaves.csv` anew. Units: mm, N, rad.
A leaf lies along x, thin along y; its far end, or those of all leaves of a guide, is a rigid body that is loaded at its reference node.
Twenty-node bricks with reduced integration (C3D20R), denser towards ends and edges. A moment of ccx on the node of rotations does work
on the components of the rotation vector; it is not fixed in space.
"""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexstage.base.number import Array
from tests.elsewhere.calculix.deck import program

STORED = Path(__file__).with_name("stored") / "bent-leaves.csv"
COLUMNS = ("solid", "along", "across", "nodes")
COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")
_CORNERS = ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))
_SIDES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))


@dataclass(frozen=True)
class Solid:
    """Leaves of `length`, `thickness` and `width` at `places` along y, clamped at x = 0, their far ends rigid; `young` [MPa].

    `load` is the force [N] and moment [N mm] on the middle of the far ends; `half`: the half z > 0 alone, of what stays in its plane, where
    `load` is still that of the whole. Bricks `through` a leaf, and in `meshes` along
    and across it (across its half, half of these).
    """

    name: str
    length: float
    thickness: float
    width: float
    places: tuple[float, ...]
    young: float
    load: tuple[float, float, float, float, float, float]
    half: bool = False
    through: int = 1
    meshes: tuple[tuple[int, int], ...] = ((16, 6), (24, 8), (32, 10))


_UNIT = 210e3 * 50.0 * 5.0**3 / 12.0 / 250.0**2
"""E I / L^2 of the guide's leaves [N]."""
_NOISE = 1e-9
_FINE = ((24, 8), (36, 12), (48, 16))
_WEIGHT = 2.5 * 9.80665


def _guide(name: str, force: float) -> Solid:
    return Solid(name, 250.0, 5.0, 50.0, (-75.0, 75.0), 210e3, (0.0, force * _UNIT, 0.0, 0.0, 0.0, 0.0), half=True, through=2, meshes=_FINE)


SOLIDS = (
    _guide("guide 1", 1.0),
    _guide("guide 5", 5.0),
    _guide("guide 20", 20.0),
    Solid("upright", 60.0, 0.3, 20.0, (-50.0, 50.0), 200e3, (-_WEIGHT, 0.5, 0.0, 0.0, 0.0, 0.0), half=True, meshes=_FINE),
    Solid("twist", 80.0, 1.0, 30.0, (0.0,), 200e3, (0.0, 0.0, 0.0, 3000.0, 0.0, 0.0)),
    Solid("bend", 80.0, 1.0, 30.0, (0.0,), 200e3, (0.0, 0.0, 20.0, 0.0, 0.0, 3000.0)),
)


def graded(count: int) -> Array:
    """Places (count + 1,) from 0 to 1, twenty times as dense at both ends as if they were even."""
    even = np.linspace(0.0, 1.0, count + 1)
    return 0.05 * even + 0.95 * 0.5 * (1.0 - np.cos(np.pi * even))


@dataclass(frozen=True, eq=False)
class _Bricks:
    nodes: Array
    elements: Array
    grid: Array


def _bricks(along: Array, through: Array, across: Array) -> _Bricks:
    """Twenty-node bricks between planes: nodes (n, 3), elements (m, 20) by node, and places (n, 3) in the grid of half bricks."""
    lines = [np.interp(np.arange(2 * len(each) - 1) / 2.0, np.arange(len(each)), each) for each in (along, through, across)]
    grid = np.stack(np.meshgrid(*(np.arange(len(line)) for line in lines), indexing="ij"), -1).reshape(-1, 3)
    grid = grid[np.sum(grid % 2, axis=1) < 2]
    number = {tuple(place): index for index, place in enumerate(grid.tolist())}
    nodes = np.stack([lines[axis][grid[:, axis]] for axis in range(3)], -1)
    elements = []
    for start in 2 * np.stack(np.meshgrid(*(np.arange(len(each) - 1) for each in (along, through, across)), indexing="ij"), -1).reshape(
        -1, 3
    ):
        corners = start + np.array(_CORNERS)
        middles = [(corners[a] + corners[b]) // 2 for a, b in _SIDES]
        elements.append([number[tuple(place)] for place in [*corners.tolist(), *(middle.tolist() for middle in middles)]])
    return _Bricks(nodes, np.array(elements), grid)


def deck(solid: Solid, mesh: tuple[int, int]) -> str:
    """The input file of one static step at large displacements."""
    return "\n".join([*_lines(solid, mesh), ""])


def nodes(solid: Solid, mesh: tuple[int, int]) -> int:
    """How many nodes a mesh has."""
    return sum(line.count(",") == 3 for line in _nodes(solid, mesh)[0])


def _nodes(solid: Solid, mesh: tuple[int, int]) -> tuple[list[str], _Bricks]:
    along, across = mesh
    width = solid.width * (2.0 * graded(across) - 1.0) / 2.0
    if solid.half:
        width = width[across // 2 :]
    block = _bricks(solid.length * graded(along), solid.thickness * (np.linspace(0.0, 1.0, solid.through + 1) - 0.5), width)
    lines, count = ["*NODE, NSET=ALL"], len(block.nodes)
    for copy, place in enumerate(solid.places):
        lines += [f"{copy * count + index},{x:.12g},{y + place:.12g},{z:.12g}" for index, (x, y, z) in enumerate(block.nodes, start=1)]
    return lines, block


def _lines(solid: Solid, mesh: tuple[int, int]) -> Iterator[str]:
    lines, block = _nodes(solid, mesh)
    yield from lines
    count, copies = len(block.nodes), range(len(solid.places))
    reference = len(copies) * count + 1
    yield f"{reference},{solid.length:.12g},0,0\n{reference + 1},{solid.length:.12g},0,0"
    yield "*ELEMENT, TYPE=C3D20R, ELSET=LEAF"
    for copy in copies:
        for index, element in enumerate(block.elements, start=1):
            row = [copy * len(block.elements) + index, *(element + 1 + copy * count)]
            yield ",".join(map(str, row[:11])) + ",\n" + ",".join(map(str, row[11:]))
    yield f"*MATERIAL, NAME=STEEL\n*ELASTIC\n{solid.young:.12g},0.3\n*SOLID SECTION, ELSET=LEAF, MATERIAL=STEEL"
    far = block.grid[:, 0] == block.grid[:, 0].max()
    for name, chosen in (
        ("FOOT", block.grid[:, 0] == 0),
        ("HEAD", far),
        ("MIDDLE", (block.grid[:, 2] == 0) & (block.grid[:, 0] > 0) & ~far),
    ):
        yield f"*NSET, NSET={name}"
        yield from _rows(np.concatenate([np.flatnonzero(chosen) + 1 + copy * count for copy in copies]))
    yield f"*NSET, NSET=TOP\n{reference},{reference + 1}"
    yield f"*RIGID BODY, NSET=HEAD, REF NODE={reference}, ROT NODE={reference + 1}"
    yield "*BOUNDARY\nFOOT,1,3"
    if solid.half:
        yield f"MIDDLE,3,3\n{reference},3,3\n{reference + 1},1,2"
    yield "*STEP, NLGEOM, INC=1000\n*STATIC\n0.1,1.\n*CLOAD"
    share = 0.5 if solid.half else 1.0
    for axis, value in enumerate(solid.load):
        if value:
            yield f"{reference + axis // 3},{axis % 3 + 1},{share * value:.12g}"
    yield "*NODE PRINT, NSET=TOP, FREQUENCY=1000\nU\n*END STEP"


def _rows(numbers: Iterable[int]) -> Iterator[str]:
    values = list(numbers)
    for start in range(0, len(values), 8):
        yield ",".join(map(str, values[start : start + 8]))


def run(solid: Solid, mesh: tuple[int, int]) -> Array:
    """The displacement [mm] and rotation vector [rad] (6,) that ccx finds."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "job.inp").write_text(deck(solid, mesh))
        done = subprocess.run([str(program()), "-i", "job"], cwd=folder, capture_output=True, text=True, timeout=3000, check=False)
        printed = Path(folder, "job.dat").read_text()
        rows = [line.split()[1:] for line in printed.splitlines() if len(line.split()) == 4 and line.split()[0].isdigit()]
        if done.returncode or len(rows) < 2:
            raise RuntimeError(f"ccx ended with {done.returncode}: {done.stdout[-2000:]}")
        return np.array([float(word) for row in rows[-2:] for word in row])


def make(names: Iterable[str]) -> None:
    """Run the solids named, or all of them, on all meshes, and store what is found."""
    rows = {(row["solid"], row["along"], row["across"]): row for row in stored()}
    for solid in SOLIDS:
        for mesh in solid.meshes:
            if not names or solid.name in names:
                found = (f"{value if abs(value) > _NOISE else 0.0:.7g}" for value in run(solid, mesh))
                head = dict(zip(COLUMNS, map(str, (solid.name, *mesh, nodes(solid, mesh))), strict=False))
                rows[solid.name, *map(str, mesh)] = head | dict(zip(COMPONENTS, found, strict=True))
                _store(rows.values())


def stored() -> list[dict[str, str]]:
    """The rows of the stored table."""
    if not STORED.exists():
        return []
    with STORED.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _store(rows: Iterable[dict[str, str]]) -> None:
    with STORED.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, (*COLUMNS, *COMPONENTS), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    make(sys.argv[1:])
