"""Direct solution of finite-element equations by fronts: nested dissection of the elements, and a dense Cholesky factor at each cut.

High-order elements result in large dense fronts; hinges between blocks result in small cuts. LAPACK therefore does nearly all of the work,
also for many right-hand sides at once. The method is that of Duff and Reid (ACM Trans. Math. Softw. 9, 302, 1983), and the elimination
order is that of George (SIAM J. Numer. Anal. 10, 345, 1973). A node has three degrees of freedom: the three components of one scalar basis
function.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
import scipy

from flexstage.base.number import Array

_dtrsm, _dsyrk, _dpotrf = scipy.linalg.blas.dtrsm, scipy.linalg.blas.dsyrk, scipy.linalg.lapack.dpotrf

_AT_HAND = 8
"""Meshes with cached cuts for the next order."""
_LEAF = 12
"""Number of elements without further cuts."""
_LEAST, _UNEVEN = 0.2, 0.5
"""Smallest share of the elements on either side of a cut; weight of unequal halves in faces."""
_COLUMNS = 256
"""Columns of a trace added at once if its nodes are scattered: the number of runs exceeds this share of the nodes."""
SCATTERED = 0.12
_EDGES = np.eye(3)
_ACROSS = np.array([turn for turn in np.ndindex(3, 3, 3) if turn > (1, 1, 1)]) - 1.0
"""Directions of trial cuts: the edges of a cube, and the edges and diagonals."""
_SMALL = 40
"""Number of elements below which only edges are tried."""


@dataclass(frozen=True, eq=False)
class Grid:
    """Input of `dissect`: numbers of the `faces` (n, 4) and centres `places` (n, 3) of n elements, and all m pairs of node and element.

    `count` is the number of nodes.
    """

    faces: Array
    places: Array
    nodes: Array
    elements: Array
    count: int


@dataclass(frozen=True, eq=False)
class _Place:
    """Positions of `nodes`: `runs` of consecutive ones by their ends in the list, and the first of each run."""

    nodes: Array
    runs: list[tuple[int, int, int]]

    @staticmethod
    def of(nodes: Array) -> _Place:
        """Nodes in rising order."""
        bounds = [0, *(np.flatnonzero(nodes[1:] - nodes[:-1] != 1) + 1).tolist(), len(nodes)] if len(nodes) else []
        return _Place(nodes, [(first, last, int(nodes[first])) for first, last in pairwise(bounds)])


@dataclass(frozen=True, eq=False)
class _Front:
    """Nodes `first` to `last` in the elimination order are eliminated here and leave a trace (Schur complement) on those `beyond`.

    Its `children` are eliminated before; of the nodes of their traces, those `near` are eliminated here, those `far` later: by position.
    """

    first: int
    last: int
    beyond: Array
    children: tuple[int, ...]
    near: tuple[_Place, ...]
    far: tuple[_Place, ...]


@dataclass(frozen=True, eq=False)
class _Factor:
    """Lower factor L of the eliminated nodes, and their coupling to those beyond times L^-T."""

    own: Array
    below: Array


@dataclass(frozen=True, eq=False)
class Fronts:
    """The elimination order: the free nodes in the sequence of elimination, and the fronts, in which children precede their parent."""

    nodes: Array
    fronts: tuple[_Front, ...]

    @property
    def size(self) -> int:
        """Number of entries of the matrix factor."""
        return sum(9 * (front.last - front.first) * (front.last - front.first + len(front.beyond)) for front in self.fronts)

    @property
    def operations(self) -> float:
        """Number of operations: the sum of n^3 / 3 + n^2 m + n m^2 over all fronts, with n eliminated DOFs coupled to m other DOFs."""
        pairs = ((3.0 * (front.last - front.first), 3.0 * len(front.beyond)) for front in self.fronts)
        return sum(own * (own * own / 3.0 + own * beyond + beyond * beyond) for own, beyond in pairs)


def dissect(grid: Grid, free: Array) -> Fronts:
    """Compute the elimination order of free nodes (mask) by nested dissection: elements are cut in two repeatedly, through few faces."""
    leaves, spans = _cuts(grid.faces.tobytes(), grid.places.tobytes())
    leaf = np.repeat(np.arange(len(leaves)), [len(each) for each in leaves])[np.argsort(np.concatenate(leaves))]
    owner, low = _owners(grid, leaf, spans)
    order = np.full(grid.count, len(spans), dtype=np.int64)
    order[free] = owner[free]
    nodes = np.lexsort((low, order))[: int(free.sum())]
    rank = np.full(grid.count, -1, dtype=np.int64)
    rank[nodes] = np.arange(len(nodes))
    bounds = np.searchsorted(order[nodes], np.arange(len(spans) + 1))
    leaf_of = leaf[grid.elements]
    by_leaf = np.argsort(leaf_of, kind="stable")
    touched, ends = grid.nodes[by_leaf], np.searchsorted(leaf_of[by_leaf], np.arange(len(leaves) + 1))
    fronts: list[_Front] = []
    for number, (start, stop, left, right) in enumerate(spans):
        first, last = int(bounds[number]), int(bounds[number + 1])
        inner = () if left < 0 else (left, right)
        met = [fronts[half].beyond for half in inner] or [rank[touched[ends[start] : ends[stop]]]]
        beyond = np.unique(np.concatenate(met))
        fronts.append(_front(first, last, beyond[beyond >= last], {child: fronts[child].beyond for child in inner}))
    return Fronts(nodes, tuple(fronts))


def _front(first: int, last: int, beyond: Array, met: dict[int, Array]) -> _Front:
    """A front, with the nodes of the traces of its children."""
    near = tuple(_Place.of(nodes[nodes < last] - first) for nodes in met.values())
    far = tuple(_Place.of(np.searchsorted(beyond, nodes[nodes >= last])) for nodes in met.values())
    return _Front(first, last, beyond, tuple(met), near, far)


_Span = tuple[int, int, int, int]


@lru_cache(maxsize=_AT_HAND)
def _cuts(faces: bytes, places: bytes) -> tuple[tuple[Array, ...], tuple[_Span, ...]]:
    """Leaves and spans of elements with these faces and positions: equal at every order of a mesh."""
    leaves: list[Array] = []
    spans: list[_Span] = []
    own = np.frombuffer(faces, dtype=np.int64).reshape(-1, 4)
    _cut(own, np.frombuffer(places).reshape(-1, 3), np.arange(len(own)), leaves, spans)
    return tuple(leaves), tuple(spans)


def _cut(faces: Array, places: Array, elements: Array, leaves: list[Array], spans: list[_Span]) -> int:
    """Cut elements; a span is the first leaf, the one after the last, and the numbers of both halves. Returns the number of its span."""
    if len(elements) <= _LEAF:
        leaves.append(elements)
        spans.append((len(leaves) - 1, len(leaves), -1, -1))
        return len(spans) - 1
    first = len(leaves)
    one, other = _halves(faces[elements], places[elements])
    left = _cut(faces, places, elements[one], leaves, spans)
    right = _cut(faces, places, elements[other], leaves, spans)
    spans.append((first, len(leaves), left, right))
    return len(spans) - 1


def _halves(faces: Array, places: Array) -> tuple[Array, Array]:
    """The elements on both sides of the best trial cut."""
    count = len(faces)
    sizes = np.arange(max(1, int(_LEAST * count)), count - max(1, int(_LEAST * count)) + 1)
    _, local = np.unique(faces, return_inverse=True)
    local = local.reshape(count, -1)
    place = np.repeat(np.arange(count), local.shape[1])
    last = np.zeros(int(local.max()) + 1, dtype=np.int64)
    first = np.zeros_like(last)
    least, found = np.inf, (place, place)
    for direction in _EDGES if count < _SMALL else _ACROSS:
        order = np.argsort(places @ direction, kind="stable")
        met = local[order].ravel()
        last[met], first[met[::-1]] = place, place[::-1]
        across = np.cumsum(np.bincount(first + 1, minlength=count + 2) - np.bincount(last + 1, minlength=count + 2))
        cost = across[sizes] * (1.0 + _UNEVEN * np.abs(2.0 * sizes / count - 1.0))
        best = int(np.argmin(cost))
        if cost[best] < least:
            least, found = cost[best], (order[: sizes[best]], order[sizes[best] :])
    return found


def _owners(grid: Grid, leaf: Array, spans: tuple[_Span, ...]) -> tuple[Array, Array]:
    """The span of each node's elimination, the smallest that contains all its elements, and the first of their leaves, from `leaf`.

    Nodes of one cut are in the order of these leaves, so that nodes shared with a smaller half are consecutive.
    """
    low, high = np.full(grid.count, len(spans), dtype=np.int64), np.full(grid.count, -1, dtype=np.int64)
    np.minimum.at(low, grid.nodes, leaf[grid.elements])
    np.maximum.at(high, grid.nodes, leaf[grid.elements])
    left, right = (np.array([span[k] for span in spans]) for k in (2, 3))
    middle = np.array([spans[span[2]][1] if span[2] >= 0 else -1 for span in spans])
    owner = np.full(grid.count, len(spans) - 1, dtype=np.int64)
    while True:
        inner = left[owner] >= 0
        down, up = inner & (high < middle[owner]), inner & (low >= middle[owner])
        if not (down.any() or up.any()):
            return owner, low
        owner = np.where(down, left[owner], np.where(up, right[owner], owner))


@dataclass(frozen=True, eq=False)
class Factorised:
    """A matrix factorised front by front; `order` contains the m free nodes, and `held` (m, 3) marks the fixed DOFs of these nodes."""

    order: Fronts
    held: Array
    factors: tuple[_Factor, ...]

    def solve(self, forces: Array) -> Array:
        """Compute displacements (n, k) from forces (n, k), zero at fixed degrees of freedom."""
        nodes, (size, columns) = self.order.nodes, forces.shape
        work = np.empty((len(nodes), 3, columns))  # by node, with its three components
        for axis, along in enumerate(forces.reshape(3, -1, columns)):
            work[:, axis] = along[nodes]
        work[self.held] = 0.0
        pairs = [pair for pair in zip(self.order.fronts, self.factors, strict=True) if pair[0].last > pair[0].first]
        for front, factor in pairs:
            own = _dtrsm(1.0, factor.own, work[front.first : front.last].reshape(-1, columns), lower=1)
            work[front.first : front.last] = own.reshape(-1, 3, columns)
            work[front.beyond] -= (factor.below @ own).reshape(-1, 3, columns)
        for front, factor in reversed(pairs):
            own = work[front.first : front.last].reshape(-1, columns) - factor.below.T @ work[front.beyond].reshape(-1, columns)
            work[front.first : front.last] = _dtrsm(1.0, factor.own, own, lower=1, trans_a=1).reshape(-1, 3, columns)
        result = np.zeros((3, size // 3, columns))
        result[:, nodes] = work.transpose(1, 0, 2)
        return result.reshape(size, columns)


def factorise_fronts(order: Fronts, matrices: Sequence[Any], held: Array) -> Iterator[Factorised]:
    """Factorise the sum of `matrices`, which is positive definite on the free nodes, once for each set of `held` (fixed) DOFs.

    Matrices are `scipy.sparse.csr_array` with both triangles. The DOFs of all nodes along x come first, then those along y, then along z.
    For each pair of coupled nodes, all nine entries are stored. Each row of `held` (k, n) is the mask of one set of fixed DOFs, which are
    decoupled from all other DOFs. All sets share the factor of a front if no DOF of the front or its descendants is held. The sets are
    factorised one after another, when they are needed; only results in use need additional memory. Raises `numpy.linalg.LinAlgError` if a
    front is not positive definite.
    """
    by_node = held.reshape(len(held), 3, -1)[:, :, order.nodes].transpose(0, 2, 1)
    parts, met = [_Entries.of(order, matrix) for matrix in matrices], np.any(by_node, axis=(0, 2))
    apart: list[bool] = []
    for front in order.fronts:
        inner = any(apart[child] for child in front.children)
        apart.append(bool(inner or met[front.first : front.last].any() or met[front.beyond].any()))
    traces: dict[int, Array] = {}
    alike = _eliminate_fronts(order, parts, np.flatnonzero(np.logical_not(apart)), np.zeros_like(by_node[0]), traces)
    for kind, own in enumerate(by_node):
        left = traces if kind == len(by_node) - 1 else dict(traces)
        yield Factorised(order, own, _in_order(alike | _eliminate_fronts(order, parts, np.flatnonzero(apart), own, left)))


def _in_order(factors: dict[int, _Factor]) -> tuple[_Factor, ...]:
    return tuple(factors[number] for number in range(len(factors)))


def _eliminate_fronts(order: Fronts, parts: list[_Entries], numbers: Array, held: Array, traces: dict[int, Array]) -> dict[int, _Factor]:
    """Factors of some fronts, children before their parents: takes earlier `traces`, and adds those for later fronts."""
    local, factors = np.empty(len(order.nodes), dtype=np.int64), {}
    for number in numbers.tolist():
        front = order.fronts[number]
        nodes = np.concatenate([np.arange(front.first, front.last), front.beyond])
        local[nodes] = np.arange(len(nodes))
        own, beyond = 3 * (front.last - front.first), 3 * len(front.beyond)
        panel = _Panel.of(np.zeros(own * (own + beyond)), own, beyond)
        for entries in parts:
            entries.add(panel, front, local)
        panel.uncouple(np.flatnonzero(held[nodes]))
        trace = _gather(panel, front, [traces.pop(child) for child in front.children])
        factors[number], traces[number] = _eliminate(panel, trace)
    return factors


def _gather(panel: _Panel, front: _Front, before: list[Array]) -> Array:
    """Add the traces of the children to a front's own columns, and to the nodes beyond: a new trace."""
    trace = np.zeros((len(panel.below), len(panel.below)), order="F")
    for left, near, far in zip(before, front.near, front.far, strict=True):
        cut = 3 * len(near.nodes)
        _add_trace(panel.own, left[:cut, :cut], near, near)
        _add_trace(panel.below, left[cut:, :cut], far, near)
        _add_trace(trace, left[cut:, cut:], far, far)
    return trace


@dataclass(frozen=True, eq=False)
class _Panel:
    """Columns of a front's own nodes: rows of their `own` (lower triangle), and those `below`, consecutively."""

    own: Array
    below: Array
    entries: Array

    @staticmethod
    def of(entries: Array, own: int, beyond: int) -> _Panel:
        """Make a panel with these columns and the rows below."""
        square = own * own
        return _Panel(entries[:square].reshape(own, own, order="F"), entries[square:].reshape(beyond, own, order="F"), entries)

    def uncouple(self, held: Array) -> None:
        """Keep only the diagonal of some rows and of the same own columns."""
        own = held[held < len(self.own)]
        diagonal = self.own[own, own]
        self.own[own], self.own[:, own], self.below[:, own] = 0.0, 0.0, 0.0
        self.own[own, own] = diagonal
        self.below[held[len(own) :] - len(self.own)] = 0.0


def _add_trace(law: Array, trace: Array, rows: _Place, columns: _Place) -> None:
    """Add a part of a trace to rows and columns of nodes; if both are equal, the lower triangle."""
    triangle = rows is columns
    if len(rows.runs) > SCATTERED * len(rows.nodes):
        at, across = ((3 * place.nodes[:, None] + np.arange(3)).ravel() for place in (rows, columns))
        for start in range(0, len(across), _COLUMNS):
            some, low = slice(start, start + _COLUMNS), start if triangle else 0
            law.T[across[some, None], at[low:]] += trace.T[some, low:]
        return
    for number, (first, last, place) in enumerate(columns.runs):
        for low, high, there in rows.runs[number:] if triangle else rows.runs:
            law[3 * there : 3 * (there + high - low), 3 * place : 3 * (place + last - first)] += trace[
                3 * low : 3 * high, 3 * first : 3 * last
            ]


def _eliminate(panel: _Panel, trace: Array) -> tuple[_Factor, Array]:
    """The factor of a front's own columns, its `panel`, and the trace on the nodes beyond, updated."""
    if not len(panel.own):
        return _Factor(panel.own, panel.below), trace
    factor, fault = _dpotrf(panel.own, lower=1, overwrite_a=1, clean=0)
    if fault:
        raise np.linalg.LinAlgError("a front is not positive definite")
    if not len(trace):
        return _Factor(factor, panel.below), trace
    below = _dtrsm(1.0, factor, panel.below, side=1, lower=1, trans_a=1, overwrite_b=1)
    return _Factor(factor, below), _dsyrk(-1.0, below, beta=1.0, c=trace, lower=1, overwrite_c=1)


@dataclass(frozen=True, eq=False)
class _Entries:
    """Entries of a matrix by nodes; `rank` belongs to elimination, -1 for fixed nodes."""

    matrix: Any
    nodes: Array
    rank: Array

    @staticmethod
    def of(order: Fronts, matrix: Any) -> _Entries:
        """The entries, prepared for an order."""
        rank = np.full((matrix.shape[0]) // 3, -1, dtype=np.int64)
        rank[order.nodes] = np.arange(len(order.nodes))
        return _Entries(matrix, order.nodes, rank)

    def add(self, panel: _Panel, front: _Front, local: Array) -> None:
        """Add the entries of a front's own nodes, with those eliminated later, to its lower triangle."""
        own, starts = self.nodes[front.first : front.last], self.matrix.indptr
        degree = (starts[own + 1] - starts[own]) // 3
        if not degree.any():
            return
        column = np.repeat(own, degree)
        place = np.arange(len(column)) - np.repeat(np.cumsum(degree) - degree, degree)
        row = self.matrix.indices[starts[column] + place]
        later = self.rank[row] >= self.rank[column]
        row, column, place, degree = row[later], column[later], place[later], np.repeat(degree, degree)[later]
        here, there = (3 * local[self.rank[each]] for each in (row, column))
        size, within = len(panel.own), here < len(panel.own)
        height = np.where(within, size, len(panel.below))  # of the part a row is in
        first = np.where(within, here, size * size + here - size) + there * height
        for b in range(3):
            start = starts[b * len(self.rank) + column] + place
            for a in range(3):
                panel.entries[first + a + b * height] += self.matrix.data[start + a * degree]
