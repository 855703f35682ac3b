"""Graph of bodies and links of a stage, and the elimination order of its bodies: computed once for a family of designs."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.mass import law_and_mass
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink
from flexstage.mechanism.assembly.incidence import layout
from flexstage.mechanism.mechanism import GROUND

GROUNDED = -1
"""Body number of the ground."""

SHAPES: Mapping[str, tuple[int, ...]] = {
    "stiffness": (6, 6),
    "mass": (12, 12),
    "turn": (3, 3),
    "first": (3,),
    "second": (3,),
    "inertia": (10,),
}
"""Kinds of numbers of a design in the kernel input, with their shapes, in this order:

- stiffness and mass of each distinct part in its link frame;
- axes of each link in the stage frame, and arms from the link to the reference points of its two bodies;
- mass, moments of mass and moments of inertia (xx, yx, yy, zx, zy, zz) of each body about its reference point.
"""


@dataclass(frozen=True)
class Topology:
    """Connectivity of the stage: `links` are the numbers of (part, first body, second body); body 0 is the platform.

    `locked` is true if bodies do not have exactly six free coordinates: a DOF is locked or has no stiffness, or a part has internal
    coordinates.
    """

    bodies: tuple[str, ...]
    links: tuple[tuple[int, int, int], ...]
    parts: int
    locked: bool

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of arrays of each kind in `SHAPES`."""
        owners = (self.parts, self.parts, len(self.links), len(self.links), len(self.links), len(self.bodies))
        return dict(zip(SHAPES, owners, strict=True))

    @cached_property
    def starts(self) -> Mapping[str, int]:
        """First index of each kind of `SHAPES` in the array of all numbers."""
        sizes = [count * int(np.prod(SHAPES[kind])) for kind, count in self.counts.items()]
        return dict(zip(SHAPES, np.cumsum([0, *sizes[:-1]]).tolist(), strict=True))

    @property
    def mirror(self) -> Array:
        """Index of the transposed entry for each number of a symmetric matrix; all other numbers have their own index.

        >>> Topology(("platform",), ((0, -1, 0),), 1, locked=False).mirror[:7].tolist()
        [0, 6, 12, 18, 24, 30, 1]
        """
        indices = []
        for kind, count in self.counts.items():
            shape = (count, *SHAPES[kind])
            own = self.starts[kind] + np.arange(int(np.prod(shape))).reshape(shape)
            indices.append((np.swapaxes(own, 1, 2) if kind in {"stiffness", "mass"} else own).ravel())
        return np.concatenate(indices)


def distinct_links(assembly: Assembly) -> dict[tuple[int, int], PlacedLink]:
    """Return the first link with each distinct pair of part and material."""
    links: dict[tuple[int, int], PlacedLink] = {}
    for link in assembly.links.values():
        links.setdefault((id(link.part), id(link.material)), link)
    return links


def topology(assembly: Assembly) -> Topology:
    """Build the topology of an expanded stage. Links of equal part and material have the same part number.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> result = topology(expand(double_triangle()))
    >>> len(result.bodies), len(result.links), result.parts, result.locked
    (19, 27, 6, False)
    """
    bodies, parts = layout(assembly).bodies, distinct_links(assembly)
    numbers = {name: number for number, name in enumerate(bodies)} | {GROUND: GROUNDED}
    places = {key: number for number, key in enumerate(parts)}
    links = tuple(
        (places[id(link.part), id(link.material)], numbers[link.joins[0]], numbers[link.joins[1]]) for link in assembly.links.values()
    )
    laws = [law_and_mass(link.part, link.material)[0] for link in parts.values()]
    loose = any(bool(item.locked) or item.inner is not None or not np.all(np.any(np.real(item.stiffness) != 0.0, axis=-1)) for item in laws)
    return Topology(bodies, links, len(parts), loose or bool(assembly.superelements))


@dataclass(frozen=True)
class Elimination:
    """Elimination order of bodies, with the kept body last.

    `edges` are the pairs of connected bodies, including connections that the elimination adds: the body eliminated first, then the other.
    `edges` is sorted; its numbers are positions in the elimination order.
    """

    order: tuple[int, ...]
    edges: tuple[tuple[int, int], ...]

    @cached_property
    def updates(self) -> tuple[tuple[int, int, int], ...]:
        """Triples (edge, edge, target): two edges of an eliminated node, and the edge that their product changes (-1: diagonal block)."""
        place = {edge: number for number, edge in enumerate(self.edges)}
        triples: list[tuple[int, int, int]] = []
        for _, own in itertools.groupby(range(len(self.edges)), key=lambda number: self.edges[number][0]):
            for left, right in itertools.combinations_with_replacement(own, 2):
                triples.append((left, right, -1 if left == right else place[self.edges[left][1], self.edges[right][1]]))
        return tuple(triples)


def elimination(count: int, edges: Iterable[tuple[int, int]], keep: int) -> Elimination:
    """Eliminate `count` nodes in the order of minimum fill (ties: fewest neighbours, then lowest number), with node `keep` last.

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
    level = dict.fromkeys((*later, keep), 0)
    for node, bound in later.items():  # in elimination order
        for other in bound:
            level[other] = max(level[other], level[node] + 1)
    order = (*sorted(later, key=lambda node: level[node]), keep)
    place = {node: position for position, node in enumerate(order)}
    return Elimination(order, tuple(sorted((place[node], place[other]) for node, bound in later.items() for other in bound)))


def _fill(near: dict[int, set[int]], node: int) -> int:
    return sum(1 for one, other in itertools.combinations(near[node], 2) if other not in near[one])


def eliminate_bodies(topology: Topology) -> Elimination:
    """Compute the elimination order of the bodies of a topology, the platform last.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> len(eliminate_bodies(globals()["topology"](expand(double_triangle()))).edges)
    18
    """
    joined = [(first, second) for _, first, second in topology.links if GROUNDED not in {first, second}]
    return elimination(len(topology.bodies), joined, keep=0)
