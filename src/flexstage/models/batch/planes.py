"""Legs that are symmetric about a plane, in axes of their own: there 6x6 blocks fall into two of 3x3, which have nothing in common.

A leg is what hangs together without the platform. Its plane is told once a family, by its nominal design; the kernel asks every design
whether what is symmetric there is so in it too, and designs in which it is not are solved in the stage's axes. What is not symmetric at
all (a pivot beside the plane) leaves blocks of 6x6 of its bodies, and of those that elimination couples with them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.blocks import Scheme, of_kind
from flexstage.models.batch.features import GROUNDED

SKEW = 1e-13
"""What counts as rounding: of axes, of arms over the longest of the stage, of products of inertia over what they are of."""

_ORDER = (0, 1, 5, 2, 3, 4)


@dataclass(frozen=True, eq=False)
class Planes:
    """Whose axes bodies have, and which blocks are two of 3x3.

    `plane` (bodies, 2) is by place the link and its axis that is normal to the plane, -1: the stage's axes; `normal` (links,) the axis of
    each link that is, -1 where it is not symmetric. `flat` (bodies, 2) and `thin` (edges, 2): own blocks and edges that are two of 3x3,
    and that elimination leaves so. `axes` (bodies, 3, 3) are those of the first design, `span` [m] the longest arm.
    """

    plane: Array
    normal: Array
    flat: Array
    thin: Array
    axes: Array
    span: float

    def inside(self, force: Array) -> Array:
        """Forces (bodies, 6, m) in the stage's axes as the kernel takes them: of legs with a plane x, y, rz, z, rx, ry in their own."""
        turned = (np.swapaxes(self.axes, -1, -2)[:, None] @ force.reshape(len(force), 2, 3, -1)).reshape(force.shape)
        return np.where((self.plane[:, 0] >= 0)[:, None, None], turned[:, _ORDER], force)


def no_planes(scheme: Scheme) -> Planes:
    """All bodies in the stage's axes.

    >>> from flexstage.models.batch.blocks import scheme
    >>> from flexstage.models.batch.features import Topology
    >>> no_planes(scheme(Topology(("platform",), ((0, -1, 0),), 1, locked=False))).normal.tolist()
    [-1]
    """
    bodies, links, edges = len(scheme.graph.order), len(scheme.topology.links), len(scheme.graph.edges)
    nothing = (np.zeros((bodies, 2), dtype=np.int64), np.zeros((edges, 2), dtype=np.int64), np.tile(np.eye(3), (bodies, 1, 1)))
    return Planes(np.full((bodies, 2), -1), np.full(links, -1), *nothing, 0.0)


def planes(scheme: Scheme, numbers: Array) -> Planes:
    """The planes about which legs are symmetric in all of these designs (features, b), but for what is symmetric in none.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.engine import plan
    >>> bool((plan(double_triangle(), ()).planes.normal >= 0).all())
    True
    """
    found = no_planes(scheme)
    arms = np.stack([of_kind(scheme, numbers, kind) for kind in ("first", "second")], axis=2)
    span = float(np.max(np.abs(arms)))
    for links, bodies in _legs(scheme):
        frames = [np.roll(of_kind(scheme, numbers, "turn")[:, links[0]], -1 - axis, axis=-1) for axis in range(3)]
        known = [_flatness(scheme, numbers, (links, bodies), frame, arms / span) for frame in frames]
        axis = int(np.argmax([np.sum(flat) for _, flat in known]))
        normal, flat = known[axis]
        if flat.any():
            places = [scheme.position[body] for body in bodies]
            found.plane[places], found.axes[places], found.flat[places] = (links[0], axis), frames[axis][0], flat[:, None]
            found.normal[list(links)] = normal
    return _eliminated(scheme, Planes(found.plane, found.normal, found.flat, found.thin, found.axes, span))


def _legs(scheme: Scheme) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """The links and the bodies of every leg."""
    inner = [set(link[1:]) - {GROUNDED, 0} for link in scheme.topology.links]
    group = list(range(len(scheme.topology.bodies)))
    for pair in filter(None, inner):
        seen = {group[body] for body in pair}
        group = [min(seen) if number in seen else number for number in group]
    for each in sorted(set(group) - {group[0]}):
        bodies = tuple(body for body, number in enumerate(group) if number == each)
        yield tuple(number for number, pair in enumerate(inner) if pair & set(bodies)), bodies


def _flatness(
    scheme: Scheme, numbers: Array, leg: tuple[tuple[int, ...], tuple[int, ...]], frame: Array, arms: Array
) -> tuple[Array, Array]:
    """The normal axis of each link of a leg (links, bodies) about the plane of a frame (b, 3, 3), and which bodies are symmetric."""
    links, bodies = leg
    normal = np.array([_normal(scheme, numbers, link, frame, arms[:, link]) for link in links])
    tilted = {body for link, axis in zip(links, normal, strict=True) if axis < 0 for body in scheme.topology.links[link][1:]}
    inertia = of_kind(scheme, numbers, "inertia")[:, list(bodies)].reshape(len(frame), -1, 2, 3, 2, 3)
    seen = np.einsum("bji,bnpjqk,bkl->bnpiql", frame, inertia, frame).reshape(len(frame), -1, 6, 6)
    own = np.diagonal(seen, axis1=-2, axis2=-1)
    flat = (seen**2 <= SKEW**2 * (own[..., :, None] * own[..., None, :]))[..., _crossing(6, 2)].all(axis=(0, 2))
    return normal, flat & ~np.isin(bodies, list(tilted))


def _normal(scheme: Scheme, numbers: Array, link: int, frame: Array, arms: Array) -> int:
    """The axis of a link along the third of a frame, about whose plane its law and its arms (b, 2, 3) are symmetric; -1: none is."""
    part, *ends = scheme.topology.links[link]
    normal = frame[:, None, :, 2]
    seen = np.abs(normal @ of_kind(scheme, numbers, "turn")[:, link])[:, 0]
    axis = int(np.argmax(seen[0]))
    laws = (of_kind(scheme, numbers, kind)[:, part] for kind in ("stiffness", "mass"))
    is_flat = (
        np.all(np.delete(seen, axis, axis=1) <= SKEW)
        and np.all(np.abs(np.sum(normal * arms, axis=-1))[:, [end not in {GROUNDED, 0} for end in ends]] <= SKEW)
        and not any(np.any(law[:, _crossing(law.shape[-1], axis)]) for law in laws)
    )
    return axis if is_flat else -1


def _crossing(size: int, axis: int) -> Array:
    """Which entries of a law are between what moves in the plane with this normal and what moves out of it."""
    row = np.arange(size)
    half = (row // 3 % 2 == 1) == (row % 3 == axis)
    return half[:, None] != half


def _eliminated(scheme: Scheme, found: Planes) -> Planes:
    """With the blocks that elimination leaves in two."""
    graph, place = scheme.graph, {**scheme.position, GROUNDED: -1}
    tilted = {
        frozenset((place[one], place[two])) for (_, one, two), axis in zip(scheme.topology.links, found.normal, strict=True) if axis < 0
    }
    for number, edge in enumerate(graph.edges):
        has_axes = edge[1] < len(graph.order) - 1 and found.plane[edge[0], 0] >= 0
        found.thin[number] = has_axes and frozenset(edge) not in tilted
    flat, thin = found.flat[:, 1], found.thin[:, 1]
    firsts = np.array([first for first, _ in graph.edges])
    for left, right, target in (update for level in graph.updates for update in level):
        thin[[left, right]] *= flat[firsts[left]]
        if target >= 0:
            thin[target] *= thin[left] * thin[right]
        else:
            flat[graph.edges[left][1]] *= thin[left]
    return found
