"""Direct solution of finite elements, by fronts: nested dissection of the elements, dense Cholesky factors of what each cut separates.

Elements of high order make large dense fronts, and hinges between blocks short cuts: there LAPACK does nearly all of the work, for many
right-hand sides at once too. The method is Duff and Reid's (ACM Trans. Math. Softw. 9, 302, 1983), the order George's (SIAM J.
Numer. Anal. 10, 345, 1973). A node is what has three degrees of freedom: the three components of one scalar basis function.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import get_blas_funcs, get_lapack_funcs

from flexstage.base.number import Array

_DOUBLE = np.zeros((1, 1))
_dtrsm, _dsyrk = get_blas_funcs(("trsm", "syrk"), (_DOUBLE,))
(_dpotrf,) = get_lapack_funcs(("potrf",), (_DOUBLE,))

_LEAF = 16
"""Elements that are not cut further."""
_LEAST, _UNEVEN = 0.2, 0.5
"""Least share of the elements on either side of a cut; how many faces more one is worth that leaves halves equal."""
_COLUMNS = 256
"""Columns of a trace that are added at once where its nodes lie scattered: more runs of them than this share of their number."""
_SCATTERED = 0.12
_ACROSS = np.array([turn for turn in np.ndindex(3, 3, 3) if turn > (1, 1, 1)]) - 1.0
"""What cuts are tried across: the edges and diagonals of a cube."""


@dataclass(frozen=True, eq=False)
class Grid:
    """What is cut: `faces` (n, 4) of elements, their `places` (n, 3), and the node and the element (m,) of all that belong to each other.

    `count` nodes in all.
    """

    faces: Array
    places: Array
    nodes: Array
    elements: Array
    count: int


@dataclass(frozen=True, eq=False)
class Matrix:
    """A symmetric matrix, both triangles, by rows: `starts`, `columns` and `values` as in a CSR matrix.

    Degrees of freedom are in the order of components: those of all nodes along x, then along y, then along z; every pair of nodes that has
    an entry has all nine.
    """

    starts: Array
    columns: Array
    values: Array


@dataclass(frozen=True, eq=False)
class _Front:
    """Nodes `first` to `last` in the order of elimination go at this cut and leave a trace on those `beyond`; its children went before."""

    first: int
    last: int
    beyond: Array
    children: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class _Factor:
    """Lower factor L of the nodes eliminated, and L^-1 times what couples them to those beyond."""

    own: Array
    across: Array


@dataclass(frozen=True, eq=False)
class Fronts:
    """The order of elimination: nodes by rank, and the fronts, children before their parent."""

    nodes: Array
    fronts: tuple[_Front, ...]

    @property
    def size(self) -> int:
        """Entries of the factor."""
        return sum(9 * (front.last - front.first) * (front.last - front.first + len(front.beyond)) for front in self.fronts)


def dissect(grid: Grid, free: Array) -> Fronts:
    """The order in which free nodes (mask) are eliminated: elements are cut in two where few faces lie on the cut, again and again."""
    leaves: list[Array] = []
    spans: list[tuple[int, int, int, int]] = []
    _cut(grid, np.arange(len(grid.faces)), leaves, spans)
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
        fronts.append(_Front(first, last, beyond[beyond >= last], inner))
    return Fronts(nodes, tuple(fronts))


def _cut(grid: Grid, elements: Array, leaves: list[Array], spans: list[tuple[int, int, int, int]]) -> int:
    """Cut elements; a span is the first leaf, the one after the last, and the numbers of both halves. The number of the own span."""
    if len(elements) <= _LEAF:
        leaves.append(elements)
        spans.append((len(leaves) - 1, len(leaves), -1, -1))
        return len(spans) - 1
    first = len(leaves)
    one, other = _halves(grid, elements)
    left = _cut(grid, one, leaves, spans)
    right = _cut(grid, other, leaves, spans)
    spans.append((first, len(leaves), left, right))
    return len(spans) - 1


def _halves(grid: Grid, elements: Array) -> tuple[Array, Array]:
    """Elements on both sides of the best of the cuts that are tried."""
    count = len(elements)
    sizes = np.arange(max(1, int(_LEAST * count)), count - max(1, int(_LEAST * count)) + 1)
    _, local = np.unique(grid.faces[elements], return_inverse=True)
    local = local.reshape(count, -1)
    place = np.repeat(np.arange(count), local.shape[1])
    last = np.zeros(int(local.max()) + 1, dtype=np.int64)
    first = np.zeros_like(last)
    least, found = np.inf, (elements, elements)
    for direction in _ACROSS:
        order = np.argsort(grid.places[elements] @ direction, kind="stable")
        met = local[order].ravel()
        last[met], first[met[::-1]] = place, place[::-1]
        across = np.cumsum(np.bincount(first + 1, minlength=count + 2) - np.bincount(last + 1, minlength=count + 2))
        cost = across[sizes] * (1.0 + _UNEVEN * np.abs(2.0 * sizes / count - 1.0))
        best = int(np.argmin(cost))
        if cost[best] < least:
            least, found = cost[best], (elements[order[: sizes[best]]], elements[order[sizes[best] :]])
    return found


def _owners(grid: Grid, leaf: Array, spans: list[tuple[int, int, int, int]]) -> tuple[Array, Array]:
    """The span each node is eliminated at, the least that holds all its elements, and the first of their leaves, which `leaf` tells.

    Nodes of one cut stand in the order of these leaves: those that a half of the half meets too lie together.
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
    """A matrix factorised front by front; `order` tells what is held."""

    order: Fronts
    factors: tuple[_Factor, ...]

    def solve(self, forces: Array) -> Array:
        """Displacements (n, k) that forces (n, k) make, zero where held."""
        nodes, (size, columns) = self.order.nodes, forces.shape
        work = forces.reshape(3, -1, columns)[:, nodes].transpose(1, 0, 2).copy()  # by node, its three components side by side
        pairs = [pair for pair in zip(self.order.fronts, self.factors, strict=True) if pair[0].last > pair[0].first]
        for front, factor in pairs:
            own = _dtrsm(1.0, factor.own, work[front.first : front.last].reshape(-1, columns), lower=1)
            work[front.first : front.last] = own.reshape(-1, 3, columns)
            work[front.beyond] -= (factor.across.T @ own).reshape(-1, 3, columns)
        for front, factor in reversed(pairs):
            own = work[front.first : front.last].reshape(-1, columns) - factor.across @ work[front.beyond].reshape(-1, columns)
            work[front.first : front.last] = _dtrsm(1.0, factor.own, own, lower=1, trans_a=1).reshape(-1, 3, columns)
        result = np.zeros((3, size // 3, columns))
        result[:, nodes] = work.transpose(1, 0, 2)
        return result.reshape(size, columns)


def factorise_fronts(order: Fronts, matrix: Matrix, held: Array) -> tuple[Factorised, ...]:
    """Factorise a matrix that is positive definite on the free nodes, for each of some sets of degrees of freedom that are `held`.

    Those of a set (masks (k, n)) are coupled to no other. A front that meets none of any set, nor do those before it, is the same for all.
    Raises `numpy.linalg.LinAlgError` where a front is not positive definite.
    """
    by_node = held.reshape(len(held), 3, -1)[:, :, order.nodes].transpose(0, 2, 1)
    entries, local = _Entries.of(order, matrix), np.empty(len(order.nodes), dtype=np.int64)
    traces: dict[int, list[Array]] = {}
    factors: list[list[_Factor]] = []
    for number, front in enumerate(order.fronts):
        nodes = np.concatenate([np.arange(front.first, front.last), front.beyond])
        local[nodes] = np.arange(len(nodes))
        panel = np.zeros((3 * len(nodes), 3 * (front.last - front.first)), order="F")
        entries.add(panel, front, local)
        below = [(local[order.fronts[child].beyond], traces.pop(child)) for child in front.children]
        alike = not by_node[:, nodes].any() and all(len(left) == 1 for _, left in below)
        factors.append([])
        traces[number] = []
        for kind in range(1 if alike else len(held)):
            law = panel if alike else panel.copy(order="F")
            _uncouple(law, np.flatnonzero(by_node[kind, nodes]))
            factor, trace = _eliminate(law, _gather(law, [(met, left[kind % len(left)]) for met, left in below]))
            factors[-1].append(factor)
            traces[number].append(trace)
    return tuple(Factorised(order, tuple(own[kind % len(own)] for own in factors)) for kind in range(len(held)))


def _gather(panel: Array, below: list[tuple[Array, Array]]) -> Array:
    """Add the traces of the fronts before, on the nodes that they met, to a front's own columns, and to what is beyond: a new trace."""
    own, size = panel.shape[1] // 3, len(panel) // 3
    trace = np.zeros((3 * (size - own), 3 * (size - own)), order="F")
    for met, left in below:
        cut = int(np.searchsorted(met, own))
        _add_trace(panel, met, left[:, : 3 * cut], met[:cut])
        _add_trace(trace, met[cut:] - own, left[3 * cut :, 3 * cut :], met[cut:] - own)
    return trace


def _uncouple(panel: Array, held: Array) -> None:
    """Leave of some rows of a front, and of the same of its own columns, the diagonal alone."""
    own = held[held < panel.shape[1]]
    diagonal = panel[own, own]
    panel[held], panel[:, own] = 0.0, 0.0
    panel[own, own] = diagonal


def _add_trace(law: Array, rows: Array, trace: Array, columns: Array) -> None:
    """Add what counts of a trace, the lower triangle of it, to nodes `rows` and the first of them, `columns`, of a part of a front."""
    runs = _runs(rows, len(columns))
    if len(runs) > _SCATTERED * len(rows):
        at = (3 * rows[:, None] + np.arange(3)).ravel()
        for start in range(0, 3 * len(columns), _COLUMNS):
            some = slice(start, min(start + _COLUMNS, 3 * len(columns)))
            law.T[at[some, None], at[start:]] += trace.T[some, start:]
        return
    for number, (first, last, place) in enumerate(runs):
        if first >= len(columns):
            return
        for low, high, there in runs[number:]:
            law[3 * there : 3 * (there + high - low), 3 * place : 3 * (place + last - first)] += trace[
                3 * low : 3 * high, 3 * first : 3 * last
            ]


def _runs(nodes: Array, cut: int) -> list[tuple[int, int, int]]:
    """Stretches of consecutive nodes, ended at a `cut` too: from where to where in the list, and the first node."""
    ends = np.flatnonzero(np.diff(nodes) != 1) + 1
    bounds = sorted({0, cut, *ends.tolist(), len(nodes)})
    return [(first, last, int(nodes[first])) for first, last in pairwise(bounds)]


def _eliminate(panel: Array, trace: Array) -> tuple[_Factor, Array]:
    """The factor of a front's own columns, its `panel`, and the trace left on the nodes beyond, whose front is added to."""
    own = panel.shape[1]
    factor, fault = _dpotrf(np.asfortranarray(panel[:own]), lower=1, overwrite_a=1) if own else (np.zeros((0, 0)), 0)
    if fault:
        raise np.linalg.LinAlgError("a front is not positive definite")
    if not own or not len(trace):
        return _Factor(factor, np.zeros((own, len(trace)))), trace
    across = _dtrsm(1.0, factor, np.asfortranarray(panel[own:].T), lower=1, overwrite_b=1)
    return _Factor(factor, across), _dsyrk(-1.0, across, beta=1.0, c=trace, trans=1, lower=1, overwrite_c=1)


@dataclass(frozen=True, eq=False)
class _Entries:
    """Entries of a matrix by nodes; `rank` is that of elimination, -1 of nodes that are held."""

    matrix: Matrix
    nodes: Array
    rank: Array

    @staticmethod
    def of(order: Fronts, matrix: Matrix) -> _Entries:
        """The entries, to be taken in an order."""
        rank = np.full((len(matrix.starts) - 1) // 3, -1, dtype=np.int64)
        rank[order.nodes] = np.arange(len(order.nodes))
        return _Entries(matrix, order.nodes, rank)

    def add(self, law: Array, front: _Front, local: Array) -> None:
        """Put the entries of a front's own nodes, with those eliminated later, into its lower triangle."""
        own, starts = self.nodes[front.first : front.last], self.matrix.starts
        degree = (starts[own + 1] - starts[own]) // 3
        column = np.repeat(own, degree)
        place = np.arange(len(column)) - np.repeat(np.cumsum(degree) - degree, degree)
        row = self.matrix.columns[starts[column] + place]
        later = self.rank[row] >= self.rank[column]
        row, column, place, degree = row[later], column[later], place[later], np.repeat(degree, degree)[later]
        here, there = (3 * local[self.rank[each]] for each in (row, column))
        for b in range(3):
            start = starts[b * len(self.rank) + column] + place
            for a in range(3):
                law[here + a, there + b] = self.matrix.values[start + a * degree]
