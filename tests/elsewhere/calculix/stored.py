"""CalculiX's output as stored beside this file, with the meshes it was made on; run as a module to make it anew (needs `ccx`).

For each problem `<name>.vol.gz` is the mesh with its drawing, `<name>-<geometry>.dat` what CalculiX printed for it.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from tests.elsewhere.calculix.deck import deck, run
from tests.elsewhere.calculix.problems import GEOMETRIES, PROBLEMS, mesh_of, shape

FOLDER = Path(__file__).with_name("stored")


def mesh_file(name: str) -> Path:
    """Where a problem's mesh is stored."""
    return FOLDER / f"{name}.vol.gz"


def output_file(name: str, geometry: str) -> Path:
    """Where what CalculiX printed is stored."""
    return FOLDER / f"{name}-{geometry}.dat"


def make() -> None:
    """Mesh every problem, run CalculiX and store both."""
    for name, build in PROBLEMS.items():
        problem = build()
        mesh = mesh_of(problem)
        mesh.mesh.ngmesh.Save(str(mesh_file(name)))
        for geometry in GEOMETRIES:
            shape(mesh, geometry)
            with tempfile.TemporaryDirectory() as folder:
                Path(folder, "job.inp").write_text(deck(problem, mesh))
                output_file(name, geometry.name).write_text(run(Path(folder), "job"))


if __name__ == "__main__":
    make()
