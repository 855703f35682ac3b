"""What is solved in both codes: small components with one end held and the other loaded, on one mesh, curved or with straight sides."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import ngsolve
import numpy as np

from flexstage.base.number import Array
from flexstage.base.units.scale import GPa, mm
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.mechanism import Link, Mechanism
from flexstage.parts.body import Block, Body
from flexstage.parts.material import Material
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular
from flexstage.solid.fea.meshing.fineness import Fineness
from flexstage.solid.fea.meshing.mesh import PieceMesh, mesh_component
from flexstage.solid.fea.meshing.straighten import straighten
from flexstage.solid.fea.solver.component import Component, components
from tests.stock import SLIM_STACK

STEEL = Material(young=196 * GPa, poisson=0.27, density=7800.0, source="made up")
ALUMINIUM = Material(young=71.7 * GPa, poisson=0.33, density=2810.0, source="made up")
"""Stated here, and not those of the shipped cases: what is stored was computed with these."""
NOTCH = Notch("steel", 1 * mm, 8 * mm, Circular(4 * mm))


@dataclass(frozen=True)
class Geometry:
    """How the elements' sides follow the drawing: polynomials of this order."""

    name: str
    order: int


STRAIGHT = Geometry("straight", 1)
CURVED = Geometry("curved", 2)
GEOMETRIES = (STRAIGHT, CURVED)


@dataclass(frozen=True)
class Problem:
    """A component `held` on one of its faces and loaded on another."""

    component: Component
    held: str
    loaded: str


@dataclass(frozen=True)
class Solution:
    """Mean displacement of the loaded face per force spread evenly over it (3, 3) [m/N], and the lowest frequencies (k,) [Hz]."""

    compliance: Array
    frequencies: Array

    def difference(self, other: Solution) -> tuple[float, float]:
        """Largest differences: of compliances, as shares of the geometric mean of the two directions' own, and of frequencies."""
        scale = np.sqrt(np.diag(other.compliance))
        compliance = (self.compliance - other.compliance) / scale / scale[:, None]
        return float(np.max(np.abs(compliance))), float(np.max(np.abs(self.frequencies / other.frequencies - 1.0)))


def hinge() -> Problem:
    """A cantilever: a circular notch, held at one end, with a block on the other that is loaded over a disc on its far side."""
    notch_end, block_end = 4 * mm, 12 * mm
    stack_at = block_end + 0.5 * float(SLIM_STACK.length)
    links = {
        "notch": Link(("ground", "platform"), "notch", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0)),
        "stack": Link(("platform", "ground"), "stack", (stack_at, 0.0, 0.0), (1.0, 0.0, 0.0)),
    }
    block = Block("steel", (block_end - notch_end, 10 * mm, 8 * mm), at=(0.5 * (notch_end + block_end), 0.0, 0.0))
    stage = Mechanism("hinge", {"steel": STEEL}, {"notch": NOTCH, "stack": SLIM_STACK}, {"platform": Body({"block": block})}, links)
    return Problem(_named(stage, "platform"), "notch:ground", "stack:platform")


def pair() -> Problem:
    """An aluminium block between a notch of steel and one of its own that bends about another axis."""
    links = {
        "first": Link(("ground", "block"), "notch", (-9 * mm, 0.0, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0)),
        "second": Link(("block", "platform"), "own", (9 * mm, 1 * mm, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 1.0, 0.0)),
    }
    block = Body({"block": Block("aluminium", (10 * mm, 12 * mm, 10 * mm))})
    bodies = {"block": block, "platform": Body(mass=1.0)}
    parts = {"notch": replace(NOTCH, width=9 * mm), "own": replace(NOTCH, width=9 * mm, material="aluminium")}
    stage = Mechanism("pair", {"steel": STEEL, "aluminium": ALUMINIUM}, parts, bodies, links)
    return Problem(_named(stage, "block"), "first:ground", "second:platform")


def head() -> Problem:
    """The shipped parallelogram's strut head: a disc with a round neck, held at the platform, loaded where the stack stands."""
    stage = replace(parallelogram(), materials={"steel": STEEL, "aluminium": ALUMINIUM})
    return Problem(_named(stage, "B/tip"), "B/front:platform", "B/pzt:B/tip")


PROBLEMS: Mapping[str, Callable[[], Problem]] = {"hinge": hinge, "pair": pair, "head": head}
FINENESS = Fineness(neck=2.0, block=1.5, order=2)


def mesh_of(problem: Problem, fineness: Fineness = FINENESS) -> PieceMesh:
    """A problem's mesh, before `shape`; all elements are of one order, as CalculiX's are."""
    mesh = mesh_component(problem.component, fineness)
    return replace(mesh, finer=np.zeros_like(mesh.finer))


def shape(mesh: PieceMesh, geometry: Geometry) -> None:
    """Let a mesh follow its drawing as asked, but for elements that this would fold."""
    mesh.mesh.UnsetDeformation()
    mesh.mesh.Curve(geometry.order)
    found = straighten(mesh.mesh, np.zeros(mesh.mesh.ne, dtype=bool))
    if found is not None:
        raise ValueError(found)


def read_mesh(path: Path, problem: Problem) -> PieceMesh:
    """A problem's mesh, before `shape`, from a file that holds its drawing too; which piece owns an element is left out."""
    media = tuple(dict.fromkeys(piece.medium for piece in problem.component.pieces))
    mesh = ngsolve.Mesh(str(path))
    return PieceMesh(mesh, media, (problem.held, problem.loaded), np.zeros(mesh.ne, dtype=int), np.zeros(mesh.ne, dtype=bool))


def _named(stage: Mechanism, name: str) -> Component:
    return next(part for part in components(stage) if part.name == name)
