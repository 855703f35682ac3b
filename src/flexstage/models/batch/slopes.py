"""Derivatives of eigenvalues by the features: Phi^T (dK - lambda dM) Phi of each cluster, part by part and link by link.

K and M are sums over links and bodies, so their derivatives by a number are contracted with the modes where it stands, and no derivative
of a whole matrix is made: a part's law by the strains of its links, an arm or an axis by the forces on a link's ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.blocks import Scheme, carries, inertia_matrix, of_kind
from flexstage.models.batch.parameters.features import TURNS, Feature
from flexstage.models.batch.parameters.numbers import MIRROR, MIRROR_SIGN, Change
from flexstage.spatial.frame import cross_matrix


@dataclass(frozen=True, eq=False)
class Motion:
    """Modes as links and bodies see them.

    `twists` (b, links, 12, k) of both ends in the link's axes, `forces` on them less lambda times the momenta, `bodies` (b, bodies, 6, k)
    by number; `turns` (b, links, 3, 3) are the links' axes, `value` (b, k) is lambda, the mean of each cluster.
    """

    twists: Array
    forces: Array
    bodies: Array
    turns: Array
    value: Array


def motion(plan: Scheme, numbers: Array, shapes: Array, value: Array) -> Motion:
    """The modes `shapes` (b, bodies in the order of elimination, 6, k) as links see them.

    >>> from flexstage.models.batch.blocks import scheme
    >>> from flexstage.models.batch.parameters.features import Topology
    >>> plan = scheme(Topology(("platform",), ((0, -1, 0),), 1, locked=False))
    >>> numbers = np.zeros((plan.topology.count, 1))
    >>> numbers[:36, 0], numbers[180:189, 0] = 2.0 * np.eye(6).ravel(), np.eye(3).ravel()
    >>> motion(plan, numbers, np.eye(6)[None, None], np.zeros((1, 6))).forces[0, 0, 6:].diagonal().tolist()
    [2.0, 2.0, 2.0, 2.0, 2.0, 2.0]
    """
    links = plan.topology.links
    twists = np.zeros((len(shapes), len(links), 2, 6, shapes.shape[-1]))
    seen = carries(plan, numbers) @ shapes[:, [place for _, _, place in plan.ends]]
    twists[:, [link for link, _, _ in plan.ends], [side for _, side, _ in plan.ends]] = seen
    part = [link[0] for link in links]
    force = of_kind(plan, numbers, "stiffness")[:, part] @ (twists[:, :, 1] - twists[:, :, 0])
    both = twists.reshape(*twists.shape[:2], 12, -1)
    forces = np.concatenate([-force, force], axis=-2) - value[:, None, None, :] * (of_kind(plan, numbers, "mass")[:, part] @ both)
    bodies = shapes[:, [plan.position[body] for body in range(len(plan.topology.bodies))]]
    return Motion(both, forces, bodies, of_kind(plan, numbers, "turn"), value)


def slope(plan: Scheme, seen: Motion, change: Change, values: Array) -> Array:
    """Phi^T (dK - lambda dM) Phi (b, k, k) of a feature that changes by `values` (rows, b).

    >>> from flexstage.models.batch.blocks import scheme
    >>> from flexstage.models.batch.parameters.features import Topology
    >>> plan = scheme(Topology(("platform",), ((0, -1, 0),), 1, locked=False))
    >>> numbers = np.zeros((plan.topology.count, 1))
    >>> numbers[:36, 0], numbers[180:189, 0] = 2.0 * np.eye(6).ravel(), np.eye(3).ravel()
    >>> seen = motion(plan, numbers, np.eye(6)[None, None], np.zeros((1, 6)))
    >>> slope(plan, seen, Change(0, plan.topology.features[0], np.arange(0, 36, 7)), np.ones((6, 1)))[0].diagonal().tolist()
    [1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    """
    place, by = change.place, _whole(change, values)
    if place.kind in {"stiffness", "mass"}:
        links = [number for number, link in enumerate(plan.topology.links) if link[0] == place.owner]
        twists = seen.twists[:, links]
        if place.kind == "stiffness":
            strain = twists[:, :, 6:] - twists[:, :, :6]
            return np.sum(np.swapaxes(strain, -1, -2) @ (by[:, None] @ strain), axis=1)
        return -_weigh(seen, np.sum(np.swapaxes(twists, -1, -2) @ (by[:, None] @ twists), axis=1))
    if place.kind == "inertia":
        moved = seen.bodies[:, place.owner]
        return -_weigh(seen, np.swapaxes(moved, -1, -2) @ (inertia_matrix(by) @ moved))
    half = np.swapaxes(seen.forces[:, place.owner], -1, -2) @ _move(plan, seen, place, by)
    return half + np.swapaxes(half, -1, -2)


def _whole(change: Change, values: Array) -> Array:
    """The derivative (b, *shape) of a feature, of which only some rows are given."""
    result = np.zeros((values.shape[1], int(np.prod(change.place.shape))))
    result[:, change.rows] = values.T
    if change.mirrored:
        result[:, MIRROR[change.rows]] = MIRROR_SIGN[change.rows] * values.T
    result = result.reshape(-1, *change.place.shape)
    if change.place.symmetric:
        result += np.swapaxes(np.triu(result, 1), -1, -2)
    return result


def _weigh(seen: Motion, products: Array) -> Array:
    """Products of modes i and j times lambda, which is the same for both where it matters: within a cluster."""
    return seen.value[:, :, None] * products


def _move(plan: Scheme, seen: Motion, place: Feature, by: Array) -> Array:
    """Change (b, 12, k) of the twists of a link's end as its axes turn, or as its arm changes."""
    turn = seen.turns[:, place.owner]
    back = np.swapaxes(turn, -1, -2)
    result = np.zeros((*seen.twists.shape[:1], 12, seen.twists.shape[-1]))
    side = (*TURNS, "first", "second").index(place.kind) % 2
    moved, turned = slice(6 * side, 6 * side + 3), slice(6 * side + 3, 6 * side + 6)
    if place.kind in TURNS:
        for each in (moved, turned):
            result[:, each] = -back @ cross_matrix(by) @ turn @ seen.twists[:, place.owner, each]
    else:
        result[:, moved] = back @ (cross_matrix(by) @ seen.bodies[:, plan.topology.links[place.owner][1 + side], 3:])
    return result
