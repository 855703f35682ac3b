"""Elimination order of a graph of bodies, and what elimination fills in: found once for a topology."""

from __future__ import annotations

import itertools
from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True)
class Elimination:
    """Nodes in the order they are eliminated, the kept one last; all indices below are positions in that order.

    `edges` are the pairs (first, later) of the filled graph, by their first; `levels` are the ranges of positions that do not depend
    on one another: a level is done when those before it are.
    """

    order: tuple[int, ...]
    edges: tuple[tuple[int, int], ...]
    levels: tuple[tuple[int, int], ...]

    @cached_property
    def edge_ranges(self) -> tuple[tuple[int, int], ...]:
        """By level: where its edges begin and end."""
        firsts = [first for first, _ in self.edges]
        return tuple((bisect_left(firsts, start), bisect_left(firsts, stop)) for start, stop in self.levels)

    @cached_property
    def updates(self) -> tuple[tuple[tuple[int, int, int], ...], ...]:
        """By level: (edge, edge, target) of every product of two edges of one node; target -1 is the later node's own block."""
        place = {edge: number for number, edge in enumerate(self.edges)}
        result: list[tuple[tuple[int, int, int], ...]] = []
        for start, stop in self.levels:
            found: list[tuple[int, int, int]] = []
            for node in range(start, stop):
                own = [number for number, (first, _) in enumerate(self.edges) if first == node]
                for left, right in itertools.combinations_with_replacement(own, 2):
                    pair = (self.edges[left][1], self.edges[right][1])
                    found.append((left, right, -1 if left == right else place[pair]))
            result.append(tuple(found))
        return tuple(result)


def elimination(count: int, edges: Iterable[tuple[int, int]], keep: int) -> Elimination:
    """Eliminate `count` nodes by minimum fill (ties: fewest neighbours, then the lowest number), node `keep` last.

    >>> chain = elimination(4, [(0, 1), (1, 2), (2, 3)], keep=0)
    >>> chain.order, chain.edges
    ((3, 2, 1, 0), ((0, 1), (1, 2), (2, 3)))
    >>> elimination(4, [(0, 1), (1, 2), (2, 3), (3, 0)], keep=0).edges  # a ring: one edge more
    ((0, 1), (0, 3), (1, 2), (1, 3), (2, 3))
    """
    near: dict[int, set[int]] = {node: set() for node in range(count)}
    for first, second in edges:
        if first != second:
            near[first].add(second)
            near[second].add(first)
    later: dict[int, set[int]] = {}
    left = set(range(count)) - {keep}
    while left:
        node = min(left, key=lambda each: (_fill(near, each), len(near[each]), each))
        later[node] = near.pop(node)
        for one in later[node]:
            near[one] |= later[node]
            near[one] -= {one, node}
        left.remove(node)
    later[keep] = set()
    return _by_levels(later)


def _fill(near: dict[int, set[int]], node: int) -> int:
    return sum(1 for one, other in itertools.combinations(near[node], 2) if other not in near[one])


def _by_levels(later: dict[int, set[int]]) -> Elimination:
    """The order sorted by level: nodes of one level are independent, so that they can be eliminated together."""
    level = dict.fromkeys(later, 0)
    for node, bound in later.items():  # in the order of elimination
        for other in bound:
            level[other] = max(level[other], level[node] + 1)
    *rest, keep = later
    highest = max((level[node] for node in rest), default=-1)
    level[keep] = highest + 1
    order = (*sorted(rest, key=lambda node: level[node]), keep)
    place = {node: position for position, node in enumerate(order)}
    edges = sorted((place[node], place[other]) for node, bound in later.items() for other in bound)
    starts = [position for position, node in enumerate(order) if position == 0 or level[node] != level[order[position - 1]]]
    return Elimination(order, tuple(edges), tuple(itertools.pairwise([*starts, len(order)])))
