"""Legs that are symmetric about a plane, in axes of their own: there 6x6 blocks fall into two of 3x3, which have nothing in common.

A leg is what hangs together without the platform. It is a tree where every body has one that is eliminated later; its plane is told
once a family, by its nominal design, and which legs are equal by a design beside it too. The kernel asks every design whether what is
symmetric or equal there is so in it too; designs in which it is not are solved in the stage's axes, as are legs that are not symmetric.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.blocks import Scheme, of_kind
from flexstage.models.batch.parameters.features import GROUNDED

SKEW = 1e-13
"""What counts as rounding: of axes, of arms over the longest of the stage, of products of inertia over what they are of."""

_ORDER = (0, 1, 5, 2, 3, 4)


@dataclass(frozen=True, eq=False)
class Planes:
    """Whose axes bodies have, and which legs are equal.

    A leg with axes of its own has a gate and, with all that are equal to it, a port, which stands for the platform.

    `gate` (gates, 6) is the port, the link whose axes are the leg's and which of them is normal to the plane, a link to the platform and
    its side, and which of the equal legs it is. `through` and `model` (bodies by place, then links) are the gate of each, -1: the stage's
    axes, and the one of an equal leg whose matrices serve for it, or itself. `normal` (links,) is the axis of each that is normal to its
    leg's plane, -1: none. `copies` and `row` (bodies and ports): how many are equal, and where the first component stands in vectors.
    `nth` (bodies and ports, 2): how many come just before it, and which of those it is. `axes` (bodies, 3, 3) are those of the first
    design, `span` [m] the longest arm.
    """

    gate: Array
    through: Array
    model: Array
    normal: Array
    copies: Array
    row: Array
    nth: Array
    axes: Array
    span: float

    @property
    def members(self) -> tuple[Array, Array]:
        """Where the bodies of each port's tree that stand for themselves begin among them all, and these."""
        bodies = np.flatnonzero((self.through[: len(self.axes)] >= 0) & (self.model[: len(self.axes)] == np.arange(len(self.axes))))
        ports = self.gate[self.through[bodies], 0]
        order = np.argsort(ports, kind="stable")
        return np.searchsorted(ports[order], np.arange(len(self.copies) - len(self.axes) + 1)), bodies[order]

    def later(self, scheme: Scheme) -> Array:
        """The later body of every edge, or the port that stands for the platform."""
        bodies = len(scheme.graph.order)
        pairs = [(last, int(self.through[first])) for first, last in scheme.graph.edges]
        return np.array([bodies + self.gate[gate, 0] if last == bodies - 1 and gate >= 0 else last for last, gate in pairs], dtype=np.int64)

    def inside(self, force: Array) -> Array:
        """Forces (bodies, 6, m) in the stage's axes as the kernel takes them, (6 bodies, m): x, y, rz, z, rx, ry in a leg's own."""
        turning, places = self._turning
        result = np.empty((places.size, force.shape[-1]))
        result[places] = turning @ force
        return result

    @cached_property
    def _turning(self) -> tuple[Array, Array]:
        """From the stage's axes to those of each body (bodies, 6, 6), and where its components stand in vectors (bodies, 6)."""
        bodies = len(self.axes)
        turned = np.zeros((bodies, 6, 6))
        turned[:, :3, :3] = turned[:, 3:, 3:] = np.swapaxes(self.axes, -1, -2)
        own = np.where((self.through[:bodies] >= 0)[:, None, None], turned[:, _ORDER], np.eye(6))
        return own, self.row[:bodies, None] + np.arange(6) * self.copies[:bodies, None]


def no_planes(scheme: Scheme) -> Planes:
    """All bodies in the stage's axes.

    >>> from flexstage.models.batch.blocks import scheme
    >>> from flexstage.models.batch.parameters.features import Topology
    >>> no_planes(scheme(Topology(("platform",), ((0, -1, 0),), 1, locked=False))).normal.tolist()
    [-1]
    """
    bodies, links = len(scheme.graph.order), len(scheme.topology.links)
    through, model = np.full(bodies + links, -1), np.concatenate([np.arange(bodies), np.arange(links)])
    alone = (np.ones(bodies, dtype=np.int64), 6 * np.arange(bodies), np.zeros((bodies, 2), dtype=np.int64))
    return Planes(np.zeros((0, 6), dtype=np.int64), through, model, np.full(links, -1), *alone, np.tile(np.eye(3), (bodies, 1, 1)), 0.0)


@dataclass(frozen=True, eq=False)
class Leg:
    """The links and bodies of a leg with a plane, whose normal is an `axis` of its first link and `normal` (links,) of each."""

    links: tuple[int, ...]
    bodies: tuple[int, ...]
    axis: int
    normal: Array

    def frame(self, scheme: Scheme, numbers: Array) -> Array:
        """Its axes (b, 3, 3) in designs (features, b), the normal last."""
        return np.roll(of_kind(scheme, numbers, "turn")[:, self.links[0]], -1 - self.axis, axis=-1)


def planes(scheme: Scheme, numbers: Array, near: Array | None = None) -> Planes:
    """The planes about which legs are symmetric in all of these designs (features, b).

    Legs that are equal in them and in others `near` them have one port; none are where there are no others.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.engine import plan
    >>> found = plan(double_triangle(), ("B2/front.thickness",)).planes
    >>> bool((found.normal >= 0).all()), found.copies.tolist()[-4:]  # the platform; two legs that are equal, the one that is not, three
    (True, [1, 2, 1, 3])
    """
    span, found, bodies = _span(scheme, numbers), no_planes(scheme), len(scheme.graph.order)
    legs = list(_with_planes(scheme, numbers, span))
    groups = [[leg] for leg in legs] if near is None else _equal(scheme, np.concatenate([numbers, near], axis=1), legs, span)
    copies, gates = np.ones(bodies + len(groups), dtype=np.int64), []
    for port, group in enumerate(groups):
        for copy, leg in enumerate(group):
            own, first = ([scheme.position[body] for body in each.bodies] for each in (leg, group[0]))
            members = [*own, *(bodies + link for link in leg.links)]
            found.through[members], found.model[members] = len(gates), [*first, *group[0].links]
            copies[own], found.normal[list(leg.links)], found.axes[own] = len(group), leg.normal, leg.frame(scheme, numbers)[0]
            gates.append((port, leg.links[0], leg.axis, *_way_out(scheme, leg), copy))
        copies[bodies + port] = len(group)
    tables = (np.array(gates, dtype=np.int64).reshape(-1, 6), found.through, found.model, found.normal, copies)
    result = Planes(*tables, _rows(found, copies, gates), np.zeros((len(copies), 2), dtype=np.int64), found.axes, span)
    for (first, _), later in zip(scheme.graph.edges, result.later(scheme), strict=True):
        if result.model[first] == first:
            result.nth[first, 1] = result.nth[later, 0]
            result.nth[later, 0] += 1
    return result


def _span(scheme: Scheme, numbers: Array) -> float:
    """The longest arm; 1 where all links are at the points of their bodies."""
    return float(max(np.max(np.abs(of_kind(scheme, numbers, kind))) for kind in ("first", "second"))) or 1.0


def _way_out(scheme: Scheme, leg: Leg) -> tuple[int, int]:
    """A link from a leg to the platform and its side."""
    return next((link, side) for link in leg.links for side in (0, 1) if scheme.topology.links[link][1 + side] == 0)


def _rows(found: Planes, copies: Array, gates: list[tuple[int, ...]]) -> Array:
    """Where bodies begin in vectors, and behind them ports: those that are equal stand side by side."""
    bodies = len(found.axes)
    row, start = np.zeros(len(copies), dtype=np.int64), 0
    for place in range(len(copies)):
        if place >= bodies or found.model[place] == place:
            row[place], start = start, start + 6 * int(copies[place])
    for place in range(bodies):
        if found.model[place] != place:
            row[place] = row[found.model[place]] + gates[found.through[place]][-1]
    return row


def _equal(scheme: Scheme, numbers: Array, legs: list[Leg], span: float) -> list[list[Leg]]:
    """Legs by those that are equal in all of these designs."""
    groups: list[list[Leg]] = []
    for leg in legs:
        alike = [group for group in groups if _alike(scheme, numbers, group[0], leg, span=span)]
        if alike:
            alike[0].append(leg)
        else:
            groups.append([leg])
    return groups


def _alike(scheme: Scheme, numbers: Array, one: Leg, other: Leg, *, span: float) -> bool:
    """Whether two legs have the same parts in the same places of their own axes, up to rounding."""
    if _form(scheme, one) != _form(scheme, other):
        return False
    (turns, arms, inertia), others = (_own(scheme, numbers, leg) for leg in (one, other))
    own = np.diagonal(inertia, axis1=-2, axis2=-1)
    return bool(
        np.all(np.abs(turns - others[0]) <= SKEW)
        and np.all(np.abs(arms - others[1]) <= SKEW * span)
        and np.all((inertia - others[2]) ** 2 <= SKEW**2 * (own[..., :, None] * own[..., None, :]))
    )


def _form(scheme: Scheme, leg: Leg) -> tuple[object, ...]:
    """Which parts join which bodies of a leg, by their number in it, and how they lie to its plane."""
    number = {GROUNDED: -1, 0: -2} | {body: place for place, body in enumerate(leg.bodies)}
    links = [(part, number[one], number[two]) for part, one, two in (scheme.topology.links[link] for link in leg.links)]
    return (leg.axis, *links, *leg.normal.tolist())


def _own(scheme: Scheme, numbers: Array, leg: Leg) -> tuple[Array, Array, Array]:
    """Axes and arms of the links of a leg (b, links, ...) and inertias of its bodies (b, bodies, 6, 6) in its axes."""
    links, frame = list(leg.links), leg.frame(scheme, numbers)
    turns = np.einsum("bji,bnjk->bnik", frame, of_kind(scheme, numbers, "turn")[:, links])
    arms = np.stack([of_kind(scheme, numbers, kind)[:, links] for kind in ("first", "second")], axis=2) @ frame[:, None]
    out = np.array([[end == 0 for end in scheme.topology.links[link][1:]] for link in links])
    link, side = _way_out(scheme, leg)
    arms -= np.where(out[..., None], arms[:, links.index(link), side, None, None], 0.0)  # to its port
    return turns, arms, _turned(scheme, numbers, leg.bodies, frame)


def _with_planes(scheme: Scheme, numbers: Array, span: float) -> Iterator[Leg]:
    """The legs that are trees and symmetric about a plane."""
    arms = np.stack([of_kind(scheme, numbers, kind) for kind in ("first", "second")], axis=2) / span
    firsts = [first for first, _ in scheme.graph.edges]
    for links, bodies in _legs(scheme):
        if any(firsts.count(scheme.position[body]) != 1 for body in bodies):
            continue
        for axis in range(3):
            frame = np.roll(of_kind(scheme, numbers, "turn")[:, links[0]], -1 - axis, axis=-1)
            normal = np.array([_normal(scheme, numbers, link, frame, arms[:, link]) for link in links])
            if (normal >= 0).all() and _is_flat(scheme, numbers, bodies, frame):
                yield Leg(links, bodies, axis, normal)
                break


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


def _is_flat(scheme: Scheme, numbers: Array, bodies: tuple[int, ...], frame: Array) -> bool:
    """Whether the inertias of bodies are symmetric about the plane of a frame (b, 3, 3)."""
    seen = _turned(scheme, numbers, bodies, frame)
    own = np.diagonal(seen, axis1=-2, axis2=-1)
    return bool(np.all((seen**2 <= SKEW**2 * (own[..., :, None] * own[..., None, :]))[..., _crossing(6, 2)]))


def _turned(scheme: Scheme, numbers: Array, bodies: tuple[int, ...], frame: Array) -> Array:
    """Inertias of bodies (b, bodies, 6, 6) in a frame."""
    inertia = of_kind(scheme, numbers, "inertia")[:, list(bodies)].reshape(len(frame), -1, 2, 3, 2, 3)
    return np.einsum("bji,bnpjqk,bkl->bnpiql", frame, inertia, frame).reshape(len(frame), -1, 6, 6)


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
