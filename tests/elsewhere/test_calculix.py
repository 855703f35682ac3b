"""The solid model's elements against CalculiX, an independent finite-element code: the same meshes, the same order, solved there.

`ccx` runs where it is on the PATH ("run"); what it printed once is compared everywhere, on the meshes stored with it ("stored"). Elements
of order two are the same polynomials in both codes, so static answers agree to the seven digits that are printed, curved or not.
Frequencies differ by CalculiX's four-point mass: by 1e-4 at most here, and not at all when ours takes the same points.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

pytest.importorskip("ngsolve", reason="the solid model needs flexstage[solid]")

from flexstage.solid.fea.meshing.mesh import PieceMesh
from tests.elsewhere.calculix.deck import deck, printed_solution, program, run
from tests.elsewhere.calculix.ours import Law, solved
from tests.elsewhere.calculix.problems import GEOMETRIES, PROBLEMS, Geometry, Problem, Solution, mesh_of, read_mesh, shape
from tests.elsewhere.calculix.stored import mesh_file, output_file

PRINTED = 1e-6
AGREED = 1e-3
GEOMETRY = {geometry.name: geometry for geometry in GEOMETRIES}


@dataclass(frozen=True)
class Case:
    """A problem on a mesh, and what CalculiX prints for it by geometry."""

    name: str
    problem: Problem
    mesh: PieceMesh
    printed: Callable[[Geometry], str]

    def peer(self, geometry: Geometry) -> Solution:
        """CalculiX's solution; leaves the mesh shaped as asked."""
        shape(self.mesh, geometry)
        return printed_solution(self.problem, self.mesh, self.printed(geometry))


def _stored(name: str) -> Case:
    problem = PROBLEMS[name]()
    return Case(name, problem, read_mesh(mesh_file(name), problem), lambda geometry: output_file(name, geometry.name).read_text())


def _run(name: str, folder: Path) -> Case:
    problem = PROBLEMS[name]()
    mesh = mesh_of(problem)

    def printed(_: Geometry) -> str:
        (folder / "job.inp").write_text(deck(problem, mesh))
        return run(folder, "job")

    return Case(name, problem, mesh, printed)


@pytest.fixture(
    scope="module",
    params=[
        *(f"{name}-stored" for name in PROBLEMS),
        *(pytest.param(f"{name}-run", marks=() if name == "hinge" else pytest.mark.full) for name in PROBLEMS),
    ],
)
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Case:
    name, _, source = request.param.partition("-")
    if source == "stored":
        return _stored(name)
    if program() is None:
        pytest.skip("ccx (Debian calculix-ccx) is not on the PATH: only its stored output is compared")
    return _run(name, tmp_path_factory.mktemp("ccx"))


@pytest.mark.parametrize("geometry", GEOMETRY)
def test_agree_on_an_equal_mesh(case: Case, geometry: str) -> None:
    peer = case.peer(GEOMETRY[geometry])
    compliance, frequencies = solved(case.problem, case.mesh).difference(peer)
    assert compliance < PRINTED
    assert frequencies < AGREED
    assert solved(case.problem, case.mesh, Law(few_points=True)).difference(peer)[1] < PRINTED


def test_another_poisson_ratio_is_seen() -> None:
    """The comparison has teeth: 1 % on Poisson's ratio shows in compliance and frequencies."""
    case = _stored("hinge")
    peer = case.peer(GEOMETRY["curved"])
    steel = case.mesh.media[0]
    changed = replace(case.mesh, media=(replace(steel, poisson=1.01 * steel.poisson),))
    compliance, frequencies = solved(case.problem, changed, Law(few_points=True)).difference(peer)
    assert compliance > 100 * PRINTED
    assert frequencies > 100 * PRINTED
