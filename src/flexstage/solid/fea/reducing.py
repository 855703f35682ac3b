"""The job of reducing one component."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.cache import SUPERELEMENTS, Kind
from flexstage.solid.fea.component import Component
from flexstage.solid.fea.content import content
from flexstage.solid.fea.fineness import ATTEMPTS, WARPS, Fineness, Hold, Reduction
from flexstage.solid.fea.memory import Counts, mesh_seconds, needed, reduction_seconds, refusal
from flexstage.solid.fea.piece import Form, Piece, span, thinnest
from flexstage.solid.fea.store import to_bytes
from flexstage.solid.fea.worker import Call, Job

_PER_PIECE, _PER_FEWEST = 450.0, 12.0
"""Elements of usual meshes: so many a piece, and so many times the fewest."""
_TRIANGLE = 0.433
"""Area of an equilateral triangle of side one."""


def fewest_elements(component: Component, fineness: Fineness) -> float:
    """Elements a mesh has at least: one at every triangle of the surface, were it that of the pieces' necks and blocks alone.

    What asks for more memory than there is need not be meshed first.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.solid.fea.component import components
    >>> part = components(parallelogram())[-1]  # a stack, 5 mm thick and 40 mm long
    >>> round(fewest_elements(part, Fineness(neck=0.1)) / fewest_elements(part, Fineness(neck=1.0)))
    100
    """
    return sum(_surface(piece.form) / (_TRIANGLE * _size(piece, fineness) ** 2) for piece in component.pieces)


def _size(piece: Piece, fineness: Fineness) -> float:
    return (fineness.neck if piece.body is None else fineness.block) * thinnest(piece.form)


def _surface(form: Form) -> float:
    """Lateral surface [m^2], that of the square around the least dimension."""
    return 4.0 * thinnest(form) * max(span(form), thinnest(form))


@dataclass(frozen=True, eq=False)
class StoredJob(Job):
    """A job whose result is stored for `key`, in a file of a kind."""

    key: str

    stored: ClassVar[Kind]

    @property
    def mark(self) -> str:
        """Its key."""
        return self.key


@dataclass(frozen=True, eq=False)
class ComponentJob(StoredJob):
    """A component to mesh."""

    component: Component

    attempts = len(ATTEMPTS)
    stored = SUPERELEMENTS

    @property
    def name(self) -> str:
        """The component's name."""
        return self.component.name

    @property
    def kin(self) -> str:
        """Its content: at whatever order, its mesh is the same."""
        return content(self.component)

    def expected(self, fineness: Fineness) -> Counts:
        """What its mesh usually consists of."""
        return Counts.of(_PER_PIECE * len(self.component.pieces) + _PER_FEWEST * fewest_elements(self.component, fineness))


@dataclass(frozen=True, eq=False)
class Reduce(ComponentJob):
    """A component to reduce; `springs` (6 m, 6 m) between its interfaces, for modes of a whole stage in one piece."""

    reduction: Reduction
    springs: Array | None = None

    @property
    def columns(self) -> int:
        """Coordinates its superelement will have at most."""
        part = self.component
        stacks = sum(isinstance(piece.form, Piezo) for piece in part.pieces)
        warps = WARPS * sum(item.yields for item in part.interfaces)
        residual = 6 * len(part.interfaces) if self.reduction.residual else 0
        return (
            residual + 6 * (len(part.interfaces) + part.floats + len(part.bodies) + len(part.seats)) + warps + stacks + self.reduction.modes
        )

    @property
    def _is_plain(self) -> bool:
        """Whether faces alone hold it, plane or as they warp: then motions about a plane of symmetry are told apart by what moves them."""
        part = self.component
        return self.springs is None and self.reduction.hold is Hold.RIGID and not (part.floats or part.seats)

    @cached_property
    def _usual(self) -> Counts:
        return self.expected(self.reduction.fineness)

    def seconds(self, counts: Counts | None = None) -> float:
        """What the reduction usually takes [s]: every unknown is solved for and projected once a coordinate."""
        found = counts or self._usual
        return reduction_seconds(found, self.reduction.fineness.order, self.columns)

    def spared(self) -> float:
        """Its drawing and mesh [s]."""
        return mesh_seconds(self._usual)

    def needed(self, counts: Counts) -> float:
        """Memory of the reduction [bytes]."""
        return needed(counts, self.reduction.fineness.order, self.columns)

    def refusal(self, counts: Counts, limit: float) -> Finding | None:
        """Why it does not fit, with an order or a fineness that does."""
        return refusal(self.name, counts, self.reduction.fineness, self.columns, limit)

    def work(self, call: Call) -> bytes:
        """Ask for what the surface alone takes, or one side of it, draw, mesh, ask for the mesh, reduce; the superelement as stored."""
        from flexstage.solid.fea.cad import mirrors_of
        from flexstage.solid.fea.mesh import mesh_component
        from flexstage.solid.fea.reduce import reduce_mesh

        sides = mirrors_of(self.component).copies if self._is_plain else 1
        call.ask(Counts.of(fewest_elements(self.component, self.reduction.fineness) / sides, sides))
        mesh = mesh_component(self.component, self.reduction.fineness, call.report, call.attempt, by_symmetry=self._is_plain)
        size = mesh.mesh
        share = float(np.mean(mesh.finer))
        call.ask(Counts(size.nv, size.nedge, size.nface, size.ne, sides).enriched(share, self.reduction.fineness.order))
        element = reduce_mesh(self.component, mesh, self.reduction, self.springs, call.report)
        return to_bytes(element, self.key, call.made)
