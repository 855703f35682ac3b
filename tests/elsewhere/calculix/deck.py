"""A problem as an input file of CalculiX, the program run on it, and what it printed.

Units of the deck: mm, N, t, s (so stresses are MPa). A number takes 20 characters at most: ccx cuts off the rest, exponents too.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from flexstage.base.number import Array
from flexstage.solid.fea.geometry.piece import Medium
from flexstage.solid.fea.meshing.mesh import PieceMesh
from tests.elsewhere.calculix.grid import Grid, grid, spread
from tests.elsewhere.calculix.ours import MODES
from tests.elsewhere.calculix.problems import Problem, Solution

_ROW = 8
_MODES = re.compile(r"E I G E N V A L U E   O U T P U T(.*?)P A R T I C I P A T I O N", re.DOTALL)
_DISPLACEMENTS = "displacements (vx,vy,vz) for set LOADED"


def program() -> str | None:
    """Where CalculiX's solver is, if it is installed."""
    return shutil.which("ccx")


def run(folder: Path, name: str) -> str:
    """Run CalculiX on `name`.inp in a folder; what it printed to `name`.dat."""
    found = program()
    if found is None:
        raise FileNotFoundError("ccx is not on the PATH")
    done = subprocess.run([found, "-i", name], cwd=folder, capture_output=True, text=True, timeout=600, check=False)
    printed = (folder / f"{name}.dat").read_text() if (folder / f"{name}.dat").exists() else ""
    if done.returncode != 0 or not _MODES.search(printed):
        raise RuntimeError(f"ccx ended with {done.returncode}: {done.stdout[-2000:]}")
    return printed


def deck(problem: Problem, mesh: PieceMesh) -> str:
    """The input file: three unit forces spread evenly over the loaded face, one static step each, then the lowest frequencies."""
    cells = grid(mesh, (problem.held, problem.loaded))
    return "\n".join([*_model(cells, mesh.media, problem), *_steps(spread(cells, problem.loaded)), ""])


def printed_solution(problem: Problem, mesh: PieceMesh, printed: str) -> Solution:
    """What a .dat file says of a problem."""
    shares = spread(grid(mesh, (problem.loaded,)), problem.loaded)
    blocks = printed.split(_DISPLACEMENTS)[1:]
    motions = [_mean(block, shares) for block in blocks]
    return Solution(1e-3 * np.column_stack(motions), _frequencies(printed))


def _model(cells: Grid, media: tuple[Medium, ...], problem: Problem) -> Iterator[str]:
    yield "*NODE, NSET=ALL"
    for number, (x, y, z) in enumerate(cells.nodes, start=1):
        yield f"{number},{x:.13g},{y:.13g},{z:.13g}"
    for index, medium in enumerate(media):
        yield f"*ELEMENT, TYPE=C3D10, ELSET=MEDIUM{index}"
        for element in np.flatnonzero(cells.medium == index):
            yield ",".join(str(value) for value in (element + 1, *(cells.elements[element] + 1)))
        yield f"*MATERIAL, NAME=MEDIUM{index}"
        yield f"*ELASTIC\n{1e-6 * medium.young:.13g},{medium.poisson:.13g}"
        yield f"*DENSITY\n{1e-12 * medium.density:.13g}"
        yield f"*SOLID SECTION, ELSET=MEDIUM{index}, MATERIAL=MEDIUM{index}"
    for name, face in (("HELD", problem.held), ("LOADED", problem.loaded)):
        yield f"*NSET, NSET={name}"
        yield from _rows(np.unique(cells.faces[face]) + 1)
    yield "*BOUNDARY\nHELD,1,3"


def _rows(numbers: Array) -> Iterator[str]:
    for start in range(0, len(numbers), _ROW):
        yield ",".join(str(value) for value in numbers[start : start + _ROW])


def _steps(shares: dict[int, float]) -> Iterator[str]:
    for axis in (1, 2, 3):
        yield "*STEP\n*STATIC\n*CLOAD, OP=NEW"
        for node, share in shares.items():
            yield f"{node + 1},{axis},{share:.13g}"
        yield "*NODE PRINT, NSET=LOADED\nU\n*END STEP"
    yield f"*STEP\n*FREQUENCY\n{MODES}\n*CLOAD, OP=NEW\n*NODE PRINT, NSET=LOADED\n*END STEP"


def _mean(block: str, shares: dict[int, float]) -> Array:
    """Mean displacement (3,) of the loaded face [mm] from a printed table of nodes."""
    total, seen = np.zeros(3), 0
    for line in block.splitlines()[1:]:
        words = line.split()
        if len(words) == 4 and words[0].isdigit():
            total += shares[int(words[0]) - 1] * np.array([float(word) for word in words[1:]])
            seen += 1
        elif words:
            break
    if seen != len(shares):
        raise ValueError(f"{seen} of {len(shares)} nodes of the loaded face were printed")
    return total


def _frequencies(printed: str) -> Array:
    """The fourth column of the table of modes: number, eigenvalue, rad/s, Hz, imaginary part."""
    found = _MODES.search(printed)
    if found is None:
        raise ValueError("no table of modes was printed")
    rows = [line.split() for line in found.group(1).splitlines()]
    return np.array([float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()])
