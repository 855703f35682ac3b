"""The job of reducing one component."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array
from flexstage.base.processes.progress import duration
from flexstage.parts.piezo import Piezo
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.geometry.piece import Form, Piece, span, thinnest
from flexstage.solid.fea.jobs.cache import SUPERELEMENTS, Kind
from flexstage.solid.fea.jobs.content import content
from flexstage.solid.fea.jobs.memory import Counts, needed, reduction_seconds, refusal
from flexstage.solid.fea.jobs.worker import Call, Job
from flexstage.solid.fea.meshing.fineness import ATTEMPTS, NOTCH_MIDDLE, NOTCH_REACH, WARPS, Fineness, Hold, Reduction
from flexstage.solid.fea.solver.component import Component
from flexstage.solid.fea.solver.superelement import Superelement

_PER_PIECE, _PER_FEWEST = 450.0, 12.0
"""Elements of usual meshes: a number for each piece, and a multiple of the smallest possible number."""
_LEAF, _NOTCH, _LEAST_THIN = 3.0, 5.5, 0.6
"""Elements over each triangle of the middle plane of a leaf and of the fine part of a notch, as counted; their smallest share."""
_SURELY = 0.85
"""Smallest observed share of the usual elements in meshes of leaves and notches."""
_TRIANGLE = 0.433
"""Area of an equilateral triangle of side one."""


def fewest_elements(component: Component, fineness: Fineness) -> float:
    """Lower bound of a mesh's elements: one for each triangle of the lateral surface of the pieces' necks and blocks.

    Meshes beyond the available memory are refused before meshing.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.solid.fea.solver.component import components
    >>> part = components(parallelogram())[-1]  # a stack, 5 mm thick and 40 mm long
    >>> round(fewest_elements(part, Fineness(neck=0.1)) / fewest_elements(part, Fineness(neck=1.0)))
    100
    """
    return sum(max(_narrow_elements(piece, fineness), _LEAST_THIN * _thin_elements(piece.form, fineness)) for piece in component.pieces)


def _narrow_elements(piece: Piece, fineness: Fineness) -> float:
    """Elements of a piece with all widths equal to its smallest dimension: one for each triangle of the lateral surface."""
    return _surface(piece.form) / (_TRIANGLE * _size(piece, fineness) ** 2)


def _thin_elements(form: Form, fineness: Fineness) -> float:
    """Elements of usual meshes in thin wide forms: a layer of prisms in a leaf, several about the middle plane of a notch."""
    if not isinstance(form, Shaped) or form.is_axisymmetric:
        return 0.0
    size, width = fineness.neck * thinnest(form), float(np.real(form.throat.area)) / thinnest(form)
    if form.slender:
        return _LEAF * span(form) * width / (_TRIANGLE * size**2)
    if not form.has_arc:
        return 0.0
    along = 2.0 * NOTCH_REACH * np.sqrt(0.5 * span(form) * thinnest(form))
    return _NOTCH * along * width / (_TRIANGLE * (NOTCH_MIDDLE * size) ** 2)


def _size(piece: Piece, fineness: Fineness) -> float:
    return (fineness.neck if piece.body is None else fineness.block) * thinnest(piece.form)


def _surface(form: Form) -> float:
    """Lateral surface [m^2] for a square section of the smallest dimension."""
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
        """Its content: the mesh is the same at all orders."""
        return content(self.component)

    def expected(self, fineness: Fineness) -> Counts:
        """Usual counts of its mesh, with elements of one order more in its notches."""
        forms = [piece.form for piece in self.component.pieces]
        thin = [_thin_elements(form, fineness) for form in forms]
        narrow = (_PER_FEWEST * _narrow_elements(piece, fineness) for piece in self.component.pieces)
        total = _PER_PIECE * len(thin) + sum(map(max, narrow, thin))
        finer = sum(number for number, form in zip(thin, forms, strict=True) if number and isinstance(form, Shaped) and form.has_arc)
        return Counts.of(total).enriched(finer / total, fineness.order)


@dataclass(frozen=True, eq=False)
class Reduce(ComponentJob):
    """A component to reduce; `springs` (6 m, 6 m) between its interfaces, for modes of a whole stage in one piece."""

    reduction: Reduction
    springs: Array | None = None

    @property
    def columns(self) -> int:
        """Upper bound of its superelement's coordinates."""
        part = self.component
        stacks = sum(isinstance(piece.form, Piezo) for piece in part.pieces)
        warps = WARPS * sum(item.yields for item in part.interfaces)
        residual = 6 * len(part.interfaces) if self.reduction.residual else 0
        return (
            residual + 6 * (len(part.interfaces) + part.floats + len(part.bodies) + len(part.seats)) + warps + stacks + self.reduction.modes
        )

    @property
    def _is_plain(self) -> bool:
        """Whether only faces carry it, plane or warping: then the kinds of motions about a symmetry plane follow from the moved faces."""
        part = self.component
        return self.springs is None and self.reduction.hold is Hold.RIGID and not (part.floats or part.seats)

    @cached_property
    def _usual(self) -> Counts:
        return self.expected(self.reduction.fineness)

    def seconds(self, counts: Counts | None = None) -> float:
        """Usual duration of the reduction [s]: every unknown is solved for and projected for each coordinate."""
        found = counts or self._usual
        return reduction_seconds(found, self.reduction.fineness.order, self.columns)

    def needed(self, counts: Counts) -> float:
        """Memory of the reduction [bytes]."""
        return needed(counts, self.reduction.fineness.order, self.columns)

    def refusal(self, counts: Counts, limit: float) -> Finding | None:
        """Reason why it does not fit, with an order or a fineness that does."""
        return refusal(self.name, counts, self.reduction.fineness, self.columns, limit)

    def foreseen_refusal(self, memory: float, seconds: float) -> Finding | None:
        """Reason why its usual mesh exceeds a memory [bytes] or a time by a large margin; the reason names the thinnest wide piece."""
        scaled = self._usual.coarser(_SURELY**-0.5)
        found = self.refusal(scaled, memory)
        if found is None and self.seconds(scaled) > seconds:
            what = f"its reduction at order {self.reduction.fineness.order} takes about {duration(self.seconds(scaled))}"
            found = Finding(self.name, f"{what}, {duration(seconds)} are allowed", "Use a lower order (--order 2)")
        thin = max(self.component.pieces, key=lambda piece: _thin_elements(piece.form, self.reduction.fineness))
        if found is None or not isinstance(thin.form, Shaped):
            return found
        width, height = (1e3 * float(np.real(each)) for each in (thin.form.throat.width, thin.form.throat.thinnest))
        ratio = f"{thin.name} is {height:.3g} mm thick and {width:.3g} mm wide, 1 to {width / height:.3g}"
        more = "or make that part thicker or narrower, or use theory: flexstage analyse"
        return Finding(found.where, f"{found.what}: {ratio}", f"{found.advice}, {more}")

    def work(self, call: Call) -> Superelement:
        """Request the memory of the surface, draw, mesh, request the memory of the mesh, and reduce; returns the stored superelement."""
        from flexstage.solid.fea.geometry.cad import mirrors_of
        from flexstage.solid.fea.meshing.mesh import mesh_component
        from flexstage.solid.fea.solver.reduce import reduce_mesh

        sides = mirrors_of(self.component).copies if self._is_plain else 1
        call.ask(Counts.of(fewest_elements(self.component, self.reduction.fineness) / sides, sides))
        mesh = mesh_component(self.component, self.reduction.fineness, call.report, call.attempt, by_symmetry=self._is_plain)
        size = mesh.mesh
        share = float(np.mean(mesh.finer))
        call.ask(Counts(size.nv, size.nedge, size.nface, size.ne, sides).enriched(share, self.reduction.fineness.order))
        return reduce_mesh(self.component, mesh, self.reduction, self.springs, call.report)
