"""Block elimination K = L D L^T on the graph of bodies, for many designs, and products and solutions with it.

Blocks are 6x6; bodies of one level of the elimination are done together. D is inverted block by block, which a positive definite matrix
allows in any order; for K - sigma M, indefinite, pivots are taken one freedom at a time, and their signs count the eigenvalues below
sigma (Sylvester's law of inertia).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.blocks import Blocks
from flexstage.models.batch.order import Elimination


@dataclass(frozen=True, eq=False)
class Factor:
    """D^-1 as `inverse` (b, bodies, 6, 6), the edges of L^T as `edges` (b, edges, 6, 6), `pivots` (b, n) of D, freedom by freedom."""

    inverse: Array
    edges: Array
    pivots: Array

    def take(self, designs: Array) -> Factor:
        """Those of some designs."""
        return Factor(self.inverse[designs], self.edges[designs], self.pivots[designs])


def factor(graph: Elimination, matrix: Blocks) -> Factor:
    """Eliminate body by body; pivots that are zero give infinities, and nothing is raised.

    >>> from flexstage.models.batch.order import elimination
    >>> one = factor(elimination(1, [], keep=0), Blocks(4.0 * np.eye(6)[None, None], np.zeros((1, 0, 6, 6))))
    >>> one.inverse[0, 0, 0, 0].tolist(), one.pivots[0, 0].tolist()
    (0.25, 4.0)
    """
    own, edges = matrix.own.copy(), matrix.edges.copy()
    inverse, pivots = np.empty_like(own), np.empty(own.shape[:-1])
    firsts = np.array([first for first, _ in graph.edges], dtype=int)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for (start, stop), (low, high), updates in zip(graph.levels, graph.edge_ranges, graph.updates, strict=True):
            inverse[:, start:stop], pivots[:, start:stop] = _invert(own[:, start:stop])
            if not updates:
                continue
            plain = edges[:, low:high].copy()
            edges[:, low:high] = inverse[:, firsts[low:high]] @ plain
            left, right = (np.array([update[index] for update in updates]) for index in (0, 1))
            change = np.swapaxes(plain[:, left - low], -1, -2) @ edges[:, right]
            for number, (_, edge, target) in enumerate(updates):
                if target < 0:
                    own[:, graph.edges[edge][1]] -= change[:, number]
                else:
                    edges[:, target] -= change[:, number]
    return Factor(inverse, edges, pivots.reshape(len(own), -1))


def _invert(matrix: Array) -> tuple[Array, Array]:
    """Inverse of symmetric 6x6 matrices by elimination without exchange (Gauss-Jordan), and the pivots."""
    work = np.ascontiguousarray(np.moveaxis(matrix, (-2, -1), (0, 1)))
    pivots = np.empty(work.shape[1:])
    for step in range(6):
        pivots[step] = work[step, step]
        inverse = 1.0 / work[step, step]
        column = work[:, step].copy()
        row = work[step] * inverse
        work -= column[:, None] * row
        work[step], work[:, step] = row, -column * inverse
        work[step, step] = inverse
    return np.moveaxis(work, (0, 1), (-2, -1)), np.moveaxis(pivots, 0, -1)


def solve(graph: Elimination, parts: Factor, right: Array) -> Array:
    """K^-1 right, for right (b, bodies, 6, m).

    >>> from flexstage.models.batch.order import elimination
    >>> graph = elimination(1, [], keep=0)
    >>> solve(graph, factor(graph, Blocks(4.0 * np.eye(6)[None, None], np.zeros((1, 0, 6, 6)))), np.ones((1, 1, 6, 1)))[0, 0, 0].tolist()
    [0.25]
    """
    work = right.copy()
    firsts = [first for first, _ in graph.edges]
    transposed = np.swapaxes(parts.edges, -1, -2)
    for low, high in graph.edge_ranges[:-1]:
        change = transposed[:, low:high] @ work[:, _run(firsts[low:high])]
        for number in range(low, high):
            work[:, graph.edges[number][1]] -= change[:, number - low]
    work = parts.inverse @ work
    for low, high in reversed(graph.edge_ranges[:-1]):
        change = parts.edges[:, low:high] @ work[:, _run([later for _, later in graph.edges[low:high]])]
        first = _run(firsts[low:high])
        if isinstance(first, slice):
            work[:, first] -= change
        else:
            for number in range(low, high):
                work[:, firsts[number]] -= change[:, number - low]
    return work


def product(graph: Elimination, matrix: Blocks, right: Array) -> Array:
    """The matrix times right (b, bodies, 6, m).

    >>> from flexstage.models.batch.order import elimination
    >>> matrix = Blocks(4.0 * np.eye(6)[None, None], np.zeros((1, 0, 6, 6)))
    >>> product(elimination(1, [], keep=0), matrix, np.ones((1, 1, 6, 1)))[0, 0, 0].tolist()
    [4.0]
    """
    result = matrix.own @ right
    if not graph.edges:
        return result
    first, later = (_run([edge[index] for edge in graph.edges]) for index in (0, 1))
    change = matrix.edges @ right[:, later]
    if isinstance(first, slice):
        result[:, first] += change
    else:
        for number, (one, _) in enumerate(graph.edges):
            result[:, one] += change[:, number]
    np.matmul(np.swapaxes(matrix.edges, -1, -2), right[:, first], out=change)
    for number, (_, other) in enumerate(graph.edges):
        result[:, other] += change[:, number]
    return result


def _run(places: list[int]) -> slice | list[int]:
    """The same places as a slice where they follow one another: a view, and each of them once."""
    return slice(places[0], places[-1] + 1) if places == list(range(places[0], places[0] + len(places))) else places
