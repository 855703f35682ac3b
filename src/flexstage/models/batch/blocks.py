"""Stiffness and inertia as 6x6 blocks of bodies and of pairs of joined bodies, for many designs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.order import Elimination, elimination
from flexstage.models.batch.parameters.features import GROUNDED, Topology
from flexstage.spatial.frame import cross_matrix


@dataclass(frozen=True)
class Scheme:
    """Which body stands where in the order of elimination, and so which block a link adds to."""

    topology: Topology
    graph: Elimination

    @cached_property
    def position(self) -> Mapping[int, int]:
        """Position in the order by number of the body."""
        return {body: place for place, body in enumerate(self.graph.order)}

    @cached_property
    def ends(self) -> tuple[tuple[int, int, int], ...]:
        """(link, side, position) of every end on a body that moves."""
        found = enumerate(self.topology.links)
        return tuple(
            (number, side, self.position[body]) for number, link in found for side, body in enumerate(link[1:]) if body != GROUNDED
        )

    @cached_property
    def pairs(self) -> tuple[tuple[int, int, int], ...]:
        """(edge, end, end) of every link between two bodies that move, the end on the body eliminated first before the other."""
        places = {edge: number for number, edge in enumerate(self.graph.edges)}
        result: list[tuple[int, int, int]] = []
        for one in range(len(self.ends) - 1):
            if self.ends[one][0] == self.ends[one + 1][0]:
                first, later = sorted((one, one + 1), key=lambda end: self.ends[end][2])
                result.append((places[self.ends[first][2], self.ends[later][2]], first, later))
        return tuple(result)

    @cached_property
    def coordinates(self) -> Array:
        """Where the coordinates of the topology stand among those of the blocks."""
        return np.concatenate([6 * self.position[body] + np.arange(6) for body in range(len(self.topology.bodies))])


@dataclass(frozen=True, eq=False)
class Blocks:
    """One matrix of many designs: `own` (b, bodies, 6, 6) and `edges` (b, edges, 6, 6), the first body's rows and the later's columns."""

    own: Array
    edges: Array

    def take(self, designs: Array) -> Blocks:
        """Those of some designs."""
        return Blocks(self.own[designs], self.edges[designs])


def scheme(topology: Topology) -> Scheme:
    """The scheme of a topology: the platform is eliminated last.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> from flexstage.models.batch.parameters.features import topology
    >>> found = scheme(topology(expand(double_triangle())))
    >>> len(found.graph.edges), found.graph.levels  # legs from their feet to the platform
    (18, ((0, 6), (6, 12), (12, 15), (15, 18), (18, 19)))
    """
    joined = [(first, second) for _, first, second in topology.links if GROUNDED not in {first, second}]
    return Scheme(topology, elimination(len(topology.bodies), joined, keep=0))


def carries(plan: Scheme, numbers: Array) -> Array:
    """The 6x6 (b, ends, 6, 6) from the twist of a body at its reference to that of a link's end, at the link, in its axes.

    >>> from flexstage.models.batch.parameters.features import Topology
    >>> plan = scheme(Topology(("platform",), ((0, -1, 0),), 1, locked=False))
    >>> numbers = np.zeros((plan.topology.count, 1))
    >>> numbers[180:189, 0] = np.eye(3).ravel()
    >>> carries(plan, numbers)[0, 0].tolist() == np.eye(6).tolist()
    True
    """
    links = [link for link, _, _ in plan.ends]
    back = np.swapaxes(of_kind(plan, numbers, "turn")[:, links], -1, -2)
    arms = np.stack([of_kind(plan, numbers, kind) for kind in ("first", "second")], axis=2)
    lever = back @ cross_matrix(arms[:, links, [side for _, side, _ in plan.ends]])
    result = np.zeros((*lever.shape[:-2], 6, 6))
    result[..., :3, :3] = back
    result[..., 3:, 3:] = back
    result[..., :3, 3:] = lever
    return result


def blocks(plan: Scheme, numbers: Array) -> tuple[Blocks, Blocks]:
    """Stiffness and inertia (numbers (features, b)) as blocks in the order of elimination.

    >>> from flexstage.models.batch.parameters.features import Topology
    >>> plan = scheme(Topology(("platform",), ((0, -1, 0),), 1, locked=False))
    >>> numbers = np.zeros((plan.topology.count, 1))
    >>> numbers[:36, 0], numbers[180:189, 0] = 2.0 * np.eye(6).ravel(), np.eye(3).ravel()
    >>> blocks(plan, numbers)[0].own[0, 0].diagonal().tolist()
    [2.0, 2.0, 2.0, 2.0, 2.0, 2.0]
    """
    carry = carries(plan, numbers)
    part = np.array([plan.topology.links[link][0] for link, _, _ in plan.ends])
    side = np.array([each[1] for each in plan.ends])
    stiff = of_kind(plan, numbers, "stiffness")
    heavy = of_kind(plan, numbers, "mass").reshape(-1, plan.topology.parts, 2, 6, 2, 6).swapaxes(3, 4)
    back = np.swapaxes(carry, -1, -2)
    inertia = of_kind(plan, numbers, "inertia")[:, list(plan.graph.order)]
    own = (_sum(plan, back @ (stiff[:, part] @ carry)), inertia + _sum(plan, back @ (heavy[:, part, side, side] @ carry)))
    if not plan.pairs:
        return Blocks(own[0], np.zeros((len(inertia), 0, 6, 6))), Blocks(own[1], np.zeros((len(inertia), 0, 6, 6)))
    first, later = (np.array([pair[index] for pair in plan.pairs]) for index in (1, 2))
    between = heavy[:, part[first], side[first], side[later]]
    left, right = back[:, first], carry[:, later]
    edges = (_join(plan, -left @ (stiff[:, part[first]] @ right)), _join(plan, left @ (between @ right)))
    return Blocks(own[0], edges[0]), Blocks(own[1], edges[1])


def of_kind(plan: Scheme, numbers: Array, kind: str) -> Array:
    """Every feature of a kind (b, owners, *shape); inertias as 6x6 matrices.

    >>> from flexstage.models.batch.parameters.features import Topology
    >>> plan = scheme(Topology(("platform",), ((0, -1, 0),), 1, locked=False))
    >>> of_kind(plan, np.zeros((plan.topology.count, 5)), "mass").shape
    (5, 1, 12, 12)
    """
    members = [item for item in plan.topology.features if item.kind == kind]
    rows = numbers[members[0].start : members[-1].slots.stop]
    found = np.ascontiguousarray(rows.T).reshape(-1, len(members), *members[0].shape)
    return inertia_matrix(found) if kind == "inertia" else found


def inertia_matrix(numbers: Array) -> Array:
    """The 6x6 inertia (..., 6, 6) of a body for its twist at a point, of its numbers (..., 10): [m, -[s]x; [s]x, J].

    >>> inertia_matrix(np.array([2.0, 0.1, 0.2, 0.3, 3.0, 0.0, 4.0, 0.0, 0.0, 5.0]))[0].tolist()
    [2.0, 0.0, 0.0, -0.0, 0.3, -0.2]
    """
    result = np.zeros((*numbers.shape[:-1], 6, 6))
    moments = cross_matrix(numbers[..., 1:4])
    result[..., range(3), range(3)] = numbers[..., :1]
    result[..., 3:, :3], result[..., :3, 3:] = moments, -moments
    row, column = np.tril_indices(3)
    result[..., 3 + row, 3 + column] = result[..., 3 + column, 3 + row] = numbers[..., 4:]
    return result


def _sum(plan: Scheme, values: Array) -> Array:
    result = np.zeros((len(values), len(plan.graph.order), 6, 6))
    for number, (_, _, place) in enumerate(plan.ends):
        result[:, place] += values[:, number]
    return result


def _join(plan: Scheme, values: Array) -> Array:
    result = np.zeros((len(values), len(plan.graph.edges), 6, 6))
    for number, (edge, _, _) in enumerate(plan.pairs):
        result[:, edge] += values[:, number]
    return result


def dense(plan: Scheme, matrix: Blocks) -> Array:
    """The whole matrix (b, n, n) in the order of the topology's coordinates.

    >>> from flexstage.models.batch.parameters.features import Topology
    >>> plan = scheme(Topology(("platform",), ((0, -1, 0),), 1, locked=False))
    >>> dense(plan, Blocks(np.ones((1, 1, 6, 6)), np.zeros((1, 0, 6, 6)))).shape
    (1, 6, 6)
    """
    count = len(plan.graph.order)
    result = np.zeros((len(matrix.own), count, 6, count, 6))
    for place in range(count):
        result[:, place, :, place] = 0.5 * (matrix.own[:, place] + np.swapaxes(matrix.own[:, place], -1, -2))
    for number, (first, later) in enumerate(plan.graph.edges):
        result[:, first, :, later] = matrix.edges[:, number]
        result[:, later, :, first] = np.swapaxes(matrix.edges[:, number], -1, -2)
    whole = result.reshape(-1, 6 * count, 6 * count)
    return whole[:, plan.coordinates[:, None], plan.coordinates]
