"""Jobs that mesh and reduce one component."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.processes.progress import duration
from flexstage.parts.piezo import Piezo
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.geometry.piece import Piece, span, thinnest
from flexstage.solid.fea.jobs.cache import SUPERELEMENTS, Kind
from flexstage.solid.fea.jobs.content import content
from flexstage.solid.fea.jobs.memory import Counts, ReductionWork, measure_pace, needed, refusal
from flexstage.solid.fea.jobs.worker import Call, Job
from flexstage.solid.fea.meshing.fineness import ATTEMPTS, WARPS, Fineness, Hold, Reduction, element_size, is_leaf, is_notch
from flexstage.solid.fea.solver.component import Component
from flexstage.solid.fea.solver.superelement import Superelement

if TYPE_CHECKING:  # loads the solver
    from flexstage.solid.fea.meshing.mesh import PieceMesh

_TRIANGLE = 0.433
"""Area of an equilateral triangle of side one."""


def fewest_elements(component: Component, fineness: Fineness) -> float:
    """Compute a lower bound of the number of elements: one element for each triangle on the lateral surface of necks and blocks.

    With this bound, meshes that exceed the available memory are refused before meshing.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.solid.fea.solver.component import components
    >>> part = components(parallelogram())[-1]  # a stack, 5 mm thick and 40 mm long
    >>> round(fewest_elements(part, Fineness(neck=0.1)) / fewest_elements(part, Fineness(neck=1.0)))
    100
    """
    return sum(_fewest_elements(piece, fineness) for piece in component.pieces)


def _fewest_elements(piece: Piece, fineness: Fineness) -> float:
    """Triangles of a leaf's middle plane, or of the lateral surface of a square section of the smallest dimension."""
    form = piece.form
    if isinstance(form, Shaped) and is_leaf(form):
        return span(form) * float(np.real(form.throat.width)) / (_TRIANGLE * element_size(piece, fineness) ** 2)
    size = fineness.neck if piece.body is None else fineness.block
    return 4.0 * max(span(form) / thinnest(form), 1.0) / (_TRIANGLE * size**2)


@dataclass(frozen=True, eq=False)
class StoredJob(Job):
    """Job with a result that is stored in the cache for `key`, in a file of the kind `stored`."""

    key: str

    stored: ClassVar[Kind]

    @property
    def phase(self) -> str:
        """Name of the group in which the job is announced."""
        return "hinges"

    def summary(self, _found: Any) -> str:
        """Describe the result in one line."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class ComponentJob(StoredJob):
    """Job that meshes a component."""

    component: Component

    attempts = len(ATTEMPTS)
    stored = SUPERELEMENTS

    @property
    def name(self) -> str:
        """The component's name."""
        return self.component.name

    @property
    def kin(self) -> str:
        """The digest of the component's content, because jobs of different orders use the same mesh."""
        return content(self.component)


@dataclass(frozen=True, eq=False)
class Reduce(ComponentJob):
    """Job that reduces a component."""

    reduction: Reduction
    measured: ReductionWork | None = None

    @property
    def phase(self) -> str:
        """Name of the group in which the job is announced; the name contains the element order."""
        return f"components at order {self.reduction.fineness.order}"

    @property
    def columns(self) -> int:
        """Upper bound of the number of coordinates of the component's superelement."""
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
        return self.reduction.hold is Hold.RIGID and not (part.floats or part.seats)

    def seconds(self) -> float:
        """Return the CPU time [s] of the reduction, estimated from the measured work if it is known, else the usual time of a small job."""
        return super().seconds() if self.measured is None else self.measured.seconds(self.columns)

    def summary(self, found: Superelement) -> str:
        """Describe the reduced component in one line."""
        return f"{self.name} at order {self.reduction.fineness.order}: {found.freedoms:,} unknowns"

    def needed(self, counts: Counts) -> float:
        """Return the memory that the reduction needs [bytes]."""
        return needed(counts, self.reduction.fineness.order, self.columns)

    def refusal(self, counts: Counts, limit: float) -> Finding | None:
        """Return an error if the job needs more memory than `limit`; it names an order or fineness that fits, and a thin leaf or notch."""
        found = refusal(self.name, counts, self.reduction.fineness, self.columns, limit)
        forms = ((piece.name, piece.form) for piece in self.component.pieces if is_leaf(piece.form) or is_notch(piece.form))
        wide = {name: form.throat for name, form in forms if isinstance(form, Shaped)}
        if found is None or not wide:
            return found
        sizes = {name: [1e3 * float(np.real(each)) for each in (throat.thinnest, throat.width)] for name, throat in wide.items()}
        name, (height, width) = min(sizes.items(), key=lambda each: each[1][0] / each[1][1])
        ratio = f"{name} is {height:.3g} mm thick and {width:.3g} mm wide, 1 to {width / height:.3g}"
        more = f"or make {name} thicker or narrower, or use theory: flexstage analyse"
        return Finding(found.where, f"{found.what}: {ratio}", f"{found.advice}, {more}")

    def excess(self, memory: float, seconds: float) -> Iterator[Finding]:
        """Return an error if the measured work of the reduction exceeds the limits of `memory` [bytes] or time in `seconds`."""
        found = self.measured and self.refusal(self.measured.counts, memory)
        if found:
            yield found
        elif self.seconds() > seconds:
            order = self.reduction.fineness.order
            what = f"its reduction at order {order} takes about {duration(self.seconds())} (at most {duration(seconds)} allowed)"
            yield Finding(self.name, what, "Use a lower order (--order 2)")

    @property
    def sides(self) -> int:
        """Number of mirror images of the mesh that form the whole."""
        from flexstage.solid.fea.geometry.cad import mirrors_of

        return mirrors_of(self.component).copies if self._is_plain else 1

    def mesh(self, call: Call) -> tuple[PieceMesh, Counts]:
        """Draw and mesh the component; returns the mesh and its counts."""
        from flexstage.solid.fea.meshing.mesh import mesh_component

        fineness = self.reduction.fineness
        found = mesh_component(self.component, fineness, call.report, call.attempt, by_symmetry=self._is_plain)
        size = found.mesh
        return found, Counts(size.nv, size.nedge, size.nface, size.ne, found.mirrors.copies).enriched(
            float(np.mean(found.finer)), fineness.order
        )

    def work(self, call: Call) -> Superelement:
        """Mesh and reduce the component, and return the superelement. Before meshing and before reduction, wait for free memory."""
        from flexstage.solid.fea.solver.reduce import reduce_mesh

        call.ask(Counts.of(fewest_elements(self.component, self.reduction.fineness) / self.sides, self.sides))
        mesh, counts = self.mesh(call)
        call.ask(counts)
        return reduce_mesh(self.component, mesh, self.reduction, report=call.report)


@dataclass(frozen=True, eq=False)
class MeasureWork(Job):
    """Job that meshes one component to estimate the work of its reductions in advance; the process keeps the mesh for the reductions."""

    reductions: tuple[Reduce, ...]

    attempts = Reduce.attempts

    @property
    def name(self) -> str:
        """The component's name."""
        return self.reductions[0].name

    @property
    def kin(self) -> str:
        """The digest of the component's content."""
        return self.reductions[0].kin

    def work(self, call: Call) -> tuple[ReductionWork, ...]:
        """Compute the effort of each reduction, from its mesh and the elimination order of its unknowns."""
        return tuple(_measure(each, call) for each in self.reductions)


def _measure(job: Reduce, call: Call) -> ReductionWork:
    from flexstage.solid.fea.solver.field import field

    mesh, counts = job.mesh(call)
    space = field(mesh, (), job.reduction.fineness.order)
    return ReductionWork(counts, space.size, counts.sides * space.fronts.operations, measure_pace())
