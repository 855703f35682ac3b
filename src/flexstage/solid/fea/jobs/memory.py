"""Memory and CPU time of a reduction, estimated from the mesh before assembly; the memory is compared with the machine's free memory.

Degrees of freedom and matrix entries are counted exactly from the mesh. The size of the matrix factor is empirical: 20 to 70 bytes for each
matrix entry were measured on hinges, levers, plates and stacks with 2,000 to 440,000 degrees of freedom at orders two to four.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.processes.memory import gigabytes
from flexstage.solid.fea.meshing.fineness import Fineness

_PROCESS = 180e6
_PER_ELEMENT = 3500.0
_MATRICES = 24.0
"""Bytes for each matrix entry of stiffness and inertia: 8 bytes of value and 4 bytes of index for each of the two matrices."""
_FACTOR, _FACTOR_FREEDOMS, _FACTOR_GROWTH = 50.0, 4e5, 1.0 / 6.0
"""Bytes of the matrix factor for each matrix entry; above this number of DOFs, the bytes grow with this power of the DOFs."""
_COPIES = 4.0
"""Simultaneous copies of the basis."""
_LANCZOS = 40
_PER_OPERATION, _PER_FREEDOM, _PER_PROJECTED, _PER_ASSEMBLED, _PER_JOB = 1.5e-10, 2.6e-5, 2.6e-7, 3.4e-5, 0.1
"""Seconds an operation of the factor, an unknown, an unknown and coordinate, an element of the whole, and a job, at the usual pace. Fitted
to 98 reductions of orders one to three, of 300 to 160,000 unknowns; above half a second the largest deviation is a factor of 1.7."""
_REFERENCE, _REFERENCE_SIZE, _REPEATED = 0.035, 800, 3
"""CPU time [s] of a factorisation of this size, and the number of tries: the least disturbed one counts."""
_COARSER, _COARSEST = 1.25, 12.0


@dataclass(frozen=True)
class Counts:
    """Numbers of vertices, edges, faces and elements of a tetrahedral mesh; `sides` mirror images of the mesh form the whole component."""

    vertices: float
    edges: float
    faces: float
    elements: float
    sides: int = 1

    @staticmethod
    def of(elements: float, sides: int = 1) -> Counts:
        """Estimate the counts of a mesh with this number of elements.

        >>> Counts.of(1000.0)
        Counts(vertices=300.0, edges=1500.0, faces=2200.0, elements=1000.0, sides=1)
        """
        return Counts(0.3 * elements, 1.5 * elements, 2.2 * elements, elements, sides)

    def coarser(self, factor: float) -> Counts:
        """Estimate the counts for elements larger by a `factor`: counts of graded meshes decrease with the factor's square, not its cube.

        >>> Counts(8.0, 8.0, 8.0, 8.0).coarser(2.0).elements
        2.0
        """
        return self._times(1.0 / factor**2)

    def enriched(self, share: float, order: int) -> Counts:
        """Scale the counts so that `freedoms` at `order` gives the DOFs of a mesh with a fraction `share` of elements of one order more.

        >>> Counts(4, 6, 4, 1).enriched(1.0, 1).vertices  # ten nodes instead of four
        10.0
        """
        return self._times(1.0 + share * (freedoms(self, order + 1) / freedoms(self, order) - 1.0))

    def _times(self, factor: float) -> Counts:
        return Counts(self.vertices * factor, self.edges * factor, self.faces * factor, self.elements * factor, self.sides)


def freedoms(counts: Counts, order: int) -> float:
    """Count the displacement DOFs at order p: 3 (n_v + (p-1) n_e + (p-1)(p-2)/2 n_f + (p-1)(p-2)(p-3)/6 n_t).

    n_v, n_e, n_f and n_t are the numbers of vertices, edges, faces and tetrahedra.

    >>> freedoms(Counts(4, 6, 4, 1), order=2)  # one tetrahedron: ten nodes
    30.0
    """
    p = order
    inner = (p - 1) * (p - 2) / 2.0, (p - 1) * (p - 2) * (p - 3) / 6.0
    return 3.0 * (counts.vertices + (p - 1) * counts.edges + inner[0] * counts.faces + inner[1] * counts.elements)


def entries(counts: Counts, order: int) -> float:
    """Count the entries of the stiffness matrix: nine entries for every pair of basis functions with a common element.

    >>> entries(Counts(4, 6, 4, 1), order=2)  # one tetrahedron: full
    900.0
    """
    p = order
    edge = (p + 1) ** 2 - 2
    face = ((p + 1) * (p + 2) // 2) ** 2 - 3 * edge - 3
    inside = ((p + 1) * (p + 2) * (p + 3) // 6) ** 2 - 4 * face - 6 * edge - 4
    return 9.0 * (counts.vertices + edge * counts.edges + face * counts.faces + inside * counts.elements)


def needed(counts: Counts, order: int, columns: int) -> float:
    """Estimate the peak memory [bytes] of a reduction to `columns` coordinates: process, mesh, matrices, their factors, and basis.

    For a symmetric component, only one side is solved, with one matrix factor for each kind of motion; the number of kinds is the number of
    mirror images. At orders two to four with modes, the error of the estimate is between -15 and +40 %. Without modes, only one matrix
    factor exists at a time, and the estimate is up to 70 % too high.

    >>> round(needed(Counts(1416, 7258, 10580, 4737), order=3, columns=24) / 1e6)  # a lever's foot: 967 MB measured
    1030
    """
    size, full = freedoms(counts, order), entries(counts, order)
    growth = max(1.0, size / _FACTOR_FREEDOMS) ** _FACTOR_GROWTH
    vectors = 8.0 * size * (_COPIES * columns + _LANCZOS)
    return _PROCESS + _PER_ELEMENT * counts.elements + full * (_MATRICES + counts.sides * _FACTOR * growth) + vectors


@dataclass(frozen=True)
class ReductionWork:
    """Computing effort of a reduction: mesh counts, numbers of unknowns and of factorisation operations, and the machine's pace.

    `pace` is the time of a small factorisation, divided by its usual time.
    """

    counts: Counts
    freedoms: float
    operations: float
    pace: float = 1.0

    def seconds(self, columns: int) -> float:
        """Estimate the CPU time [s] of factorisation, solution and projection for a number of coordinates.

        >>> round(ReductionWork(Counts.of(5000.0), 126_711, 3.1e10).seconds(90))
        11
        """
        assembled = _PER_ASSEMBLED * self.counts.elements * self.counts.sides + _PER_JOB
        solved = self.freedoms * (_PER_FREEDOM + _PER_PROJECTED * columns)
        return self.pace * (_PER_OPERATION * self.operations + solved + assembled)


def measure_pace() -> float:
    """Measure the pace of this machine: shortest CPU time of several small dense factorisations, divided by the usual time.

    >>> measure_pace() > 0.0
    True
    """
    wide = np.ones((_REFERENCE_SIZE, 2 * _REFERENCE_SIZE))
    times = []
    for _ in range(_REPEATED):
        begun = time.process_time()
        np.linalg.cholesky(wide @ wide.T + _REFERENCE_SIZE * np.eye(_REFERENCE_SIZE))
        times.append(time.process_time() - begun)
    return min(times) / _REFERENCE


def refusal(where: str, counts: Counts, fineness: Fineness, columns: int, limit: float) -> Finding | None:
    """Return an error for a component that needs more than `limit` bytes, else `None`; the error names an order or a fineness that fits.

    >>> found = refusal("lever", Counts(1416, 7258, 10580, 4737), Fineness(), 24, 0.5e9)
    >>> found.what
    'its reduction at order 3 needs about 1.03 GB (79,536 degrees of freedom), and 0.5 GB are available'
    >>> found.advice
    'Use order 2, about 0.363 GB, or larger elements, Fineness(neck=2.9, block=2.9, order=3), about 0.403 GB'
    >>> refusal("half a lever", Counts(1416, 7258, 10580, 4737, sides=2), Fineness(), 24, 0.5e9).what
    'its reduction at order 3 needs about 1.53 GB (79,536 degrees of freedom of one side), and 0.5 GB are available'
    """
    required = needed(counts, fineness.order, columns)
    if required <= limit:
        return None
    what = f"its reduction at order {fineness.order} needs about {gigabytes(required)}"
    size = f"{freedoms(counts, fineness.order):,.0f} degrees of freedom{' of one side' if counts.sides > 1 else ''}"
    what += f" ({size}), and {gigabytes(limit)} are available"
    smaller = [*_lower_order(counts, fineness, columns, limit), *_larger_elements(counts, fineness, columns, limit)]
    remedy = f"Use {', or '.join(smaller)}" if smaller else "Free memory, or compute its parts separately"
    return Finding(where, what, remedy)


def _lower_order(counts: Counts, fineness: Fineness, columns: int, limit: float) -> Iterator[str]:
    for order in range(fineness.order - 1, 1, -1):
        required = needed(counts, order, columns)
        if required <= limit:
            yield f"order {order}, about {gigabytes(required)}"
            return


def _larger_elements(counts: Counts, fineness: Fineness, columns: int, limit: float) -> Iterator[str]:
    factor = _COARSER
    while factor <= _COARSEST:
        required = needed(counts.coarser(factor), fineness.order, columns)
        if required <= limit:
            found = replace(fineness, neck=round(fineness.neck * factor, 1), block=round(fineness.block * factor, 1))
            yield f"larger elements, Fineness(neck={found.neck:g}, block={found.block:g}, order={found.order}), about {gigabytes(required)}"
            return
        factor *= _COARSER
