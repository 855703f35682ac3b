"""Union: what outlines of one body have in common, so that it weighs once.

The union of solids follows by inclusion and exclusion from their intersections, each solid being its outer form less its hole. Exact are
boxes that are parallel to one another, prisms and cylinders along one axis, however they are turned about it, and balls that are cut by one
plane. What crosses otherwise is refused.

A common region of prisms has one section from end to end, bounded by lines and arcs. Which of them bound it is found in one design; the
moments are formulas, so that batches and complex steps pass through. Designs of a batch with other edges are computed for themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TypeAlias

import numpy as np
import scipy

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array, Number, first_design, stack
from flexstage.parts.body import Block, Cylinder, Extrusion, Imported, Solid, Sphere, triangles, within_polygon
from flexstage.spatial.convex import Boxes, polytope_corners, separations
from flexstage.spatial.frame import Frame, axes

_FLUSH = 1e-9
"""Faces nearer than this share of the solids' size coincide."""
_MOST = 2000
"""Common regions of more outlines than this are not weighed."""
_SIDES, _FACES = 64, 400
"""Plane faces that stand for a round one and for a ball where a volume is estimated."""
_LINE_NODES, _LINE_WEIGHTS = np.polynomial.legendre.leggauss(2)
_ARC_NODES, _ARC_WEIGHTS = np.polynomial.legendre.leggauss(24)
"""Exact to rounding for the polynomials of third moments along a line, and the trigonometric ones along an arc."""
_DEGREES: Array = 2.0 + np.sum(np.meshgrid(*3 * [[0.0, 1.0, 1.0]], indexing="ij"), axis=0)
"""By Green's theorem: what the integral of a product of three of (1, y, z) along the edge of a section is divided by."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """A solid of a body: its name, its density [kg/m^3], and the frame that it is drawn in."""

    name: str
    solid: Solid
    density: Number
    frame: Frame


@dataclass(frozen=True, eq=False)
class Moments:
    """Volume (...) [m^3], its first moment (..., 3) [m^4] and second moment (..., 3, 3), the integral of r r^T [m^5]."""

    volume: Array
    first: Array
    second: Array


@dataclass(frozen=True, eq=False)
class _Cell:
    """A convex region near a `point` (..., 3): all r with `normals` (..., k, 3) r <= `offsets` (..., k), within `rounds` and `balls`.

    Rounds are given by their axis and a point of it (..., 3) and their radius (...), balls by their centre and their radius.
    """

    point: Array
    normals: Array
    offsets: Array
    rounds: tuple[tuple[Array, Array, Array], ...] = ()
    balls: tuple[tuple[Array, Array], ...] = ()

    def common(self, other: _Cell) -> _Cell:
        """The region of both."""
        normals, offsets = (_joined(getattr(self, name), getattr(other, name), axis) for name, axis in (("normals", -2), ("offsets", -1)))
        return _Cell(self.point, normals, offsets, self.rounds + other.rounds, self.balls + other.balls)

    @property
    def numbers(self) -> list[tuple[Array, int]]:
        """All of it, each with the number of its own axes."""
        found = [(self.point, 1), (self.normals, 2), (self.offsets, 1)]
        return found + [(each, 1 if at < len(item) - 1 else 0) for item in (*self.rounds, *self.balls) for at, each in enumerate(item)]

    def take(self, shape: tuple[int, ...], designs: Array) -> _Cell:
        """The region in some designs of a batch of this shape, with one batch axis."""
        point, normals, offsets, *others = (_flat(each, axes, shape)[designs] for each, axes in self.numbers)
        count = 3 * len(self.rounds)
        rounds = tuple((others[at], others[at + 1], others[at + 2]) for at in range(0, count, 3))
        balls = tuple((others[at], others[at + 1]) for at in range(count, len(others), 2))
        return _Cell(point, normals, offsets, rounds, balls)


def _batch(numbers: Sequence[tuple[Array, int]]) -> tuple[int, ...]:
    """The batch axes of arrays, each with the number of its own axes."""
    return np.broadcast_shapes(*(each.shape[: each.ndim - axes] for each, axes in numbers))


def _flat(values: Array, axes: int, shape: tuple[int, ...]) -> Array:
    """The same with one batch axis."""
    own = values.shape[values.ndim - axes :]
    return np.broadcast_to(values, (*shape, *own)).reshape(int(np.prod(shape, dtype=int)), *own)


def _joined(one: Array, other: Array, axis: int) -> Array:
    """Two arrays one after the other along one of their own axes, their batch axes broadcast."""
    shape = np.broadcast_shapes(one.shape[:axis], other.shape[:axis])
    return np.concatenate([np.broadcast_to(each, (*shape, *each.shape[axis:])) for each in (one, other)], axis=axis)


_Signed: TypeAlias = tuple[Number, _Cell]
_Region: TypeAlias = tuple[Number, _Cell, Moments]
"""A convex region with its sign and its moments."""


class _InexactError(Exception):
    """A common region that is no prism, and its volume [m^3]."""

    def __init__(self, volume: float) -> None:
        super().__init__()
        self.volume = volume


def common_moments(solids: Sequence[Drawn]) -> Iterator[tuple[Number, Moments]]:
    """What solids of a body have in common and would weigh more than once: densities, and the moments to add (most are negative).

    Those that remove material (`subtract`) count with their material among the others, which gives what is there with their holes filled,
    and less what they have in common among themselves. Raises `DesignError` for each pair that overlaps where no closed form is known, or
    of two materials that are not removed there. Imported solids state their own mass.

    >>> from flexstage.spatial.frame import identity
    >>> places = {"a": (0.0, 0.0, 0.0), "b": (1.0, 1.0, 1.0)}
    >>> one, other = (Drawn(name, Block("steel", (2.0, 2.0, 2.0), at), 7800.0, identity()) for name, at in places.items())
    >>> [(float(density), float(found.volume)) for density, found in common_moments([one, other])]
    [(7800.0, -1.0)]
    """
    seen = [drawn for drawn in solids if not isinstance(drawn.solid, Imported)]
    yield from _common(seen)
    for density, moments in _common([drawn for drawn in seen if drawn.solid.subtract]):
        yield density, Moments(-moments.volume, -moments.first, -moments.second)


def _common(seen: Sequence[Drawn]) -> Iterator[tuple[Number, Moments]]:
    """The moments that make the union of solids, of every material by itself, of the sum of them."""
    near = _near(seen) if len(seen) > 1 else []
    if not near:
        return
    cells = {number: _cells(seen[number]) for pair in near for number in pair}
    scale = max(
        float(np.max(np.abs(first_design(np.real(drawn.frame.position), 1)) + np.max(first_design(np.real(drawn.solid.sides), 1))))
        for drawn in seen
    )
    problems: list[Finding] = []
    groups: list[tuple[tuple[int, ...], list[_Region]]] = []
    for one, two in near:
        first, second = seen[one], seen[two]
        if (first.solid.subtract or second.solid.subtract) and first.solid.material != second.solid.material:
            continue  # a hole takes away nothing of another material
        try:
            found = _product(*_beside(first, cells[one], second, cells[two]), scale)
        except _InexactError as crossing:
            problems.append(_crossing(seen, (one, two), crossing.volume))
            continue
        if found and np.any(np.real(np.asarray(first.density) - second.density)):
            materials = {first.solid.material, second.solid.material}
            holes = [at for at, each in enumerate(seen) if each.solid.subtract and each.solid.material in materials and at in cells]
            volume = _volume_of(found) - sum(_volume_of(_product([item[:2] for item in found], cells[at], scale)) for at in holes)
            problems += [_mixture(first, second, volume)] if volume > _FLUSH * scale**3 else []
        elif found:
            groups.append(((one, two), found))
    require(problems)
    yield from _alternating(seen, cells, groups, scale)


def _alternating(
    seen: Sequence[Drawn], cells: Mapping[int, list[_Signed]], groups: list[tuple[tuple[int, ...], list[_Region]]], scale: float
) -> Iterator[tuple[Number, Moments]]:
    """Inclusion and exclusion: pairs count -1, triples +1, and so on."""
    pairs, count = {group for group, _ in groups}, 0
    while groups:
        larger: list[tuple[tuple[int, ...], list[_Region]]] = []
        for group, found in groups:
            for sign, _, own in found:
                weight = np.asarray(sign * (-1.0) ** (len(group) - 1))
                moments = Moments(weight * own.volume, weight[..., None] * own.first, weight[..., None, None] * own.second)
                yield seen[group[0]].density, moments
            for other in range(group[-1] + 1, len(seen)):
                if all((member, other) in pairs for member in group):
                    try:
                        wider = _product([item[:2] for item in found], cells[other], scale)
                    except _InexactError as crossing:
                        require([_crossing(seen, (*group, other), crossing.volume)])
                        continue
                    larger += [((*group, other), wider)] if wider else []
            count += 1
        if count > _MOST:
            names = ", ".join(seen[number].name for number in groups[0][0])
            advice = "Draw the body of fewer outlines, or state its mass"
            require([Finding(names, "too many outlines overlap in one place to weigh their union", advice)])
        groups = larger


def _near(seen: Sequence[Drawn]) -> list[tuple[int, int]]:
    """Pairs whose boxes overlap in some design."""
    frames = [drawn.solid.frame.within(drawn.frame) for drawn in seen]
    boxes = [
        Boxes(np.real(frame.rotation), np.real(frame.position), 0.5 * np.real(drawn.solid.sides))
        for frame, drawn in zip(frames, seen, strict=True)
    ]
    reaches = [(np.abs(box.turns) @ box.halves[..., None])[..., 0] for box in boxes]
    return [
        (one, other)
        for one, other in combinations(range(len(seen)), 2)
        if _do_meet(boxes[one], boxes[other], reaches[one] + reaches[other])
    ]


def _do_meet(one: Boxes, other: Boxes, reach: Array) -> bool:
    """Whether two boxes overlap in some design; along the axes they `reach` (..., 3) so far together."""
    within = _FLUSH * np.linalg.norm(reach, axis=-1)
    if not np.any(np.all(reach - np.abs(one.centres - other.centres) > within[..., None], axis=-1)):
        return False
    shape = _batch([each for box in (one, other) for each in ((box.turns, 2), (box.centres, 1), (box.halves, 1))])
    first, second = (
        Boxes(
            box.turns[None] if box.turns.ndim == 2 else _flat(box.turns, 2, shape),
            _flat(box.centres, 1, shape),
            _flat(box.halves, 1, shape),
        )
        for box in (one, other)
    )
    return bool(np.any(separations(first, second).reshape(shape) < -within))


def _cells(drawn: Drawn) -> list[_Signed]:
    """A solid as a sum of convex regions: its outer form, less its hole."""
    solid, frame = drawn.solid, drawn.solid.frame.within(drawn.frame)
    if isinstance(solid, Cylinder):
        ends = _slab(frame, stack((solid.length,)))
        sizes = [(1.0, solid.diameter)] + ([] if solid.bore is None else [(-1.0, solid.bore)])
        return [
            (sign, _Cell(ends.point, ends.normals, ends.offsets, ((frame.rotation[..., :, 0], frame.position, np.asarray(0.5 * size)),)))
            for sign, size in sizes
        ]
    if isinstance(solid, Sphere):
        return [(1.0, _Cell(frame.position, np.zeros((0, 3)), np.zeros(0), balls=((frame.position, np.asarray(0.5 * solid.diameter)),)))]
    if isinstance(solid, Extrusion):
        corners = solid.corners
        trios = (corners[..., trio, :] for trio in triangles(first_design(np.real(corners), 2)))
        return [(sign, _wedge(frame, sign, trio, np.asarray(solid.height))) for trio in trios for sign in [_turn(trio)]]
    outer = _slab(frame, solid.sides)
    if not isinstance(solid, Block) or solid.hole is None:
        return [(1.0, outer)]
    return [(1.0, outer), (-1.0, _slab(frame, stack((*solid.hole, solid.size[2]))))]


def _slab(frame: Frame, size: Array) -> _Cell:
    """The region between pairs of planes across the first axes of a frame."""
    normals = np.swapaxes(frame.rotation, -1, -2)[..., : size.shape[-1], :]
    middle = np.sum(normals * frame.position[..., None, :], axis=-1)
    offsets = np.concatenate([middle + 0.5 * size, 0.5 * size - middle], axis=-1)
    return _Cell(frame.position, np.concatenate([normals, -normals], axis=-2), offsets)


def _turn(trio: Array) -> Number:
    """How triangles (..., 3, 2) count: those of the first design fill the outlines of all, some of which turn them round."""
    first, second = (np.real(trio[..., corner, :] - trio[..., 0, :]) for corner in (1, 2))
    backward = first[..., 0] * second[..., 1] < first[..., 1] * second[..., 0]
    return np.where(backward, -1.0, 1.0) if np.any(backward) else 1.0


def _wedge(frame: Frame, sign: Number, trio: Array, height: Array) -> _Cell:
    """The prism over a triangle (..., 3, 2) in x and y of a frame, half of its height on either side; `sign` as its corners turn."""
    run = np.roll(trio, -1, axis=-2) - trio
    outward = np.stack([run[..., 1], -run[..., 0]], axis=-1) / np.sqrt(np.sum(run * run, axis=-1, keepdims=True))
    outward = outward * np.asarray(sign)[..., None, None]
    turn = np.swapaxes(frame.rotation, -1, -2)
    normals = _joined(outward @ turn[..., :2, :], turn[..., [2, 2], :] * np.array([[1.0], [-1.0]]), -2)
    offsets = _joined(np.sum(outward * trio, axis=-1), np.broadcast_to(0.5 * height[..., None], (*height.shape, 2)), -1)
    return _Cell(frame.position, normals, offsets + np.sum(normals * frame.position[..., None, :], axis=-1))


def _beside(one: Drawn, cells: list[_Signed], two: Drawn, others: list[_Signed]) -> tuple[list[_Signed], list[_Signed]]:
    """The regions of two solids; a ball that keeps clear of the sides of an extrusion sees the planes of its height alone."""
    if isinstance(two.solid, Sphere):
        return _beside(two, others, one, cells)
    solid = two.solid
    if isinstance(one.solid, Sphere) and isinstance(solid, Extrusion):
        frame = solid.frame.within(two.frame)
        arm = one.solid.frame.within(one.frame).position - frame.position
        centre = (np.swapaxes(frame.rotation, -1, -2) @ arm[..., None])[..., :2, 0]
        if _is_clear(np.real(centre), np.real(one.solid.sides[..., 0]), np.real(solid.corners)):
            upright = Frame(frame.rotation[..., :, [2, 0, 1]], frame.position)
            return cells, [(1.0, _slab(upright, np.asarray(solid.height)[..., None]))]
    return cells, others


def _is_clear(centre: Array, diameter: Array, corners: Array) -> bool:
    """Whether circles lie within polygons in all designs."""
    shape = np.broadcast_shapes(centre.shape[:-1], diameter.shape, corners.shape[:-2])
    centre, corners = np.broadcast_to(centre, (*shape, 2)), np.broadcast_to(corners, (*shape, *corners.shape[-2:]))
    radius = 0.5 * np.broadcast_to(diameter, shape)
    return all(bool(within_polygon(centre[design][None], corners[design], -float(radius[design]))[0]) for design in np.ndindex(shape))


def polygon_moments(corners: Array, height: Array) -> Moments:
    """Moments of a prism over a polygon of corners (..., n, 2), counter-clockwise, half of its `height` on either side (Green's theorem).

    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> found = polygon_moments(square, np.asarray(3.0))
    >>> float(found.volume), found.first.tolist(), found.second.diagonal().tolist()
    (12.0, [12.0, 12.0, 0.0], [16.0, 16.0, 9.0])
    """
    ahead = np.roll(corners, -1, axis=-2)
    cross = corners[..., 0] * ahead[..., 1] - corners[..., 1] * ahead[..., 0]
    total = corners + ahead
    area = 0.5 * np.sum(cross, axis=-1)
    outer = [np.einsum("...nx,...ny,...n->...xy", each, each, cross) for each in (corners, ahead, total)]
    second = np.zeros((*np.broadcast_shapes(area.shape, height.shape), 3, 3), dtype=np.result_type(corners, height))
    second[..., :2, :2] = sum(outer) / 24.0 * height[..., None, None]
    second[..., 2, 2] = area * height**3 / 12.0
    first = np.zeros(second.shape[:-1], dtype=second.dtype)
    first[..., :2] = np.einsum("...nx,...n->...x", total, cross) / 6.0 * height[..., None]
    return Moments(np.asarray(area * height), first, second)


def _product(first: Sequence[_Signed], second: Sequence[_Signed], scale: float) -> list[_Region]:
    """The common regions of two sums, without those that are empty in every design."""
    found: list[_Region] = []
    for (sign, one), (other_sign, other) in ((a, b) for a in first for b in second):
        cell = one.common(other)
        moments = _moments(cell, scale)
        if np.any(np.real(moments.volume) > 0.0):
            found.append((sign * other_sign, cell, moments))
    total = sum((sign * np.real(moments.volume) for sign, _, moments in found), np.zeros(()))
    return found if np.any(np.abs(total) > (_FLUSH * scale) * scale**2) else []


def _volume_of(regions: Sequence[_Region]) -> float:
    return sum(float(np.max(sign * np.real(moments.volume))) for sign, _, moments in regions)


def _crossing(seen: Sequence[Drawn], numbers: tuple[int, ...], volume: float) -> Finding:
    first, *others = (seen[number] for number in numbers)
    names = " and ".join(other.name for other in others)
    what = f"it overlaps {names} by {1e9 * volume:.4g} mm^3, which would weigh twice: they are no prisms along one axis there"
    return Finding(
        first.name, what, "Trim one of them so that they only touch, let it remove material (subtract = true), or state the body's mass"
    )


def _mixture(first: Drawn, second: Drawn, volume: float) -> Finding:
    there = f"{second.name} of {second.solid.material} by {1e9 * volume:.4g} mm^3"
    what = f"it is of {first.solid.material} and overlaps {there}: which of them fills it is not known"
    return Finding(first.name, what, "Cut one of them (a block may have a hole, a cylinder a bore), or state the body's mass")


# Moments of regions


class _Alike:
    """The first design of a batch decides; `designs` (b,) are those that have decided as it has."""

    def __init__(self, count: int) -> None:
        self.designs = np.ones(count, dtype=bool)

    def as_first(self, decisions: Array) -> Array:
        """What the first design decides, of decisions (b, ...)."""
        same = decisions == decisions[0]
        self.designs &= same.reshape(len(same), -1).all(axis=1)
        return np.asarray(decisions[0])

    def require_empty(self, cell: _Cell, scale: float) -> None:
        """Raise `_InexactError` if the first design's region, of which no closed form is known, is not empty; it decides for itself."""
        self.designs[1:] = False
        if (volume := _volume(cell, scale)) > _FLUSH * scale**3:
            raise _InexactError(volume)


def _moments(cell: _Cell, scale: float) -> Moments:
    """Moments of a region, those designs together whose sections have the same edges."""
    shape = _batch(cell.numbers)
    total = np.zeros((int(np.prod(shape, dtype=int)), 4, 4), np.result_type(*(each for each, _ in cell.numbers)))
    pending = np.arange(len(total))
    while pending.size:
        own, alike = cell.take(shape, pending), _Alike(len(pending))
        with np.errstate(divide="ignore", invalid="ignore"):  # of designs that are not alike
            found = _cap(own, scale, alike) if cell.balls else _box(own, scale, alike) if _is_box(own) else _prism(own, scale, alike)
        if found is not None:
            total[pending[alike.designs]] = found[alike.designs]
        pending = pending[~alike.designs]
    total = total.reshape(*shape, 4, 4)
    return Moments(total[..., 0, 0], total[..., 0, 1:], total[..., 1:, 1:])


def _seen_from(point: Array, axes_: Array) -> Array:
    """The matrix (b, 4, 4) by which (1, r) follows from coordinates along `axes_` (b, 3, 3) from a point."""
    result = np.zeros((len(point), 4, 4), np.result_type(point, axes_))
    result[:, 0, 0], result[:, 1:, 0], result[:, 1:, 1:] = 1.0, point, axes_
    return result


def _cap(cell: _Cell, scale: float, alike: _Alike) -> Array | None:
    """Integrals (b, 4, 4) of (1, r) (1, r)^T over a ball, or what of it lies on one side of a plane; `None`: empty."""
    within = _FLUSH * scale
    point, radius = min(cell.balls, key=lambda item: float(np.real(item[1][0])))
    depths = cell.offsets - (cell.normals @ point[..., None])[..., 0]
    limits = [size - _lengths(np.real(other - point)) for other, size in cell.balls if size is not radius]
    limits += [size - _lengths(np.cross(np.real(other - point), np.real(axis))) for axis, other, size in cell.rounds]
    reach = np.real(np.concatenate([depths, *(each[:, None] for each in limits)], axis=1))
    if alike.as_first(np.min(reach, axis=1) <= within - np.real(radius)):
        return None
    cuts = np.flatnonzero(alike.as_first(reach < np.real(radius)[:, None] - within))
    if np.any(cuts >= depths.shape[1]) or np.any(np.abs(np.real(cell.normals[:1, cuts] - cell.normals[:1, cuts[:1]])) > _FLUSH):
        alike.require_empty(cell, scale)
        return None
    normal, depth = (cell.normals[:, cuts[0]], _least(depths[:, cuts])) if len(cuts) else (np.eye(1, 3).repeat(len(radius), 0), radius)
    square, own = radius * radius, np.zeros((len(radius), 4, 4), np.result_type(radius, depth))

    def upto(t: Array) -> tuple[Array, Array, Array, Array]:
        """Integrals of the round sections, and of their first and second moments, up to t."""
        along, across = square * t**3 / 3.0 - t**5 / 5.0, 0.25 * (square * square * t - 2.0 * square * t**3 / 3.0 + t**5 / 5.0)
        return square * t - t**3 / 3.0, 0.5 * square * t**2 - 0.25 * t**4, along, across

    own[:, 0, 0], own[:, 0, 1], own[:, 1, 1], own[:, 2, 2] = (np.pi * (b - a) for a, b in zip(upto(-radius), upto(depth), strict=True))
    own[:, 1, 0], own[:, 3, 3] = own[:, 0, 1], own[:, 2, 2]
    place = _seen_from(point, axes(normal))
    return place @ own @ np.swapaxes(place, -1, -2)


def _is_box(cell: _Cell) -> bool:
    """Whether a region is one between planes along three axes, none of which a complex step turns."""
    if cell.rounds or np.iscomplexobj(cell.normals):
        return False
    slopes = np.abs(cell.normals @ np.swapaxes(cell.normals, -1, -2))
    return bool(np.all((slopes < _FLUSH) | (slopes > 1.0 - 1e-15)))


def _box(cell: _Cell, scale: float, alike: _Alike) -> Array | None:
    """Integrals (b, 4, 4) of (1, r) (1, r)^T over what planes along three axes bound."""
    first = cell.normals[:, 0]
    other = cell.normals[:, int(np.argmin(np.abs(cell.normals[0] @ first[0])))]
    turn = np.stack([first, other, np.cross(first, other)], axis=-1)
    slopes = alike.as_first(np.round(cell.normals @ turn))
    offsets = cell.offsets - (cell.normals @ cell.point[..., None])[..., 0]
    high, low = (np.stack([sign * _least(offsets[:, slopes[:, axis] == sign]) for axis in range(3)], axis=-1) for sign in (1.0, -1.0))
    size, middle = high - low, 0.5 * (high + low)
    volume = np.where(np.all(np.real(size) > 2.0 * _FLUSH * scale, axis=-1), np.prod(size, axis=-1), 0.0)
    own = np.concatenate([np.ones((len(size), 1)), size * size / 12.0], axis=-1)
    place = _seen_from(cell.point + (turn @ middle[..., None])[..., 0], turn)
    return (place * (volume[:, None] * own)[:, None]) @ np.swapaxes(place, -1, -2)


def _prism(cell: _Cell, scale: float, alike: _Alike) -> Array | None:
    """Integrals (b, 4, 4) of (1, r) (1, r)^T over what planes and rounds along an axis bound, and planes across it; `None`: empty.

    Complex steps may tilt them: sides lean by a section at each of two stations, ends by what of the section lies beyond.
    """
    within = _FLUSH * scale
    normals, offsets = np.real(cell.normals), np.real(cell.offsets)
    opposite = np.sum((normals[:, :, None] + normals[:, None]) ** 2, axis=-1) < _FLUSH**2
    if alike.as_first((opposite & (offsets[:, :, None] + offsets[:, None] <= 2.0 * within)).any(axis=(1, 2))):
        return None
    rounds = [axis for axis, _, _ in cell.rounds]
    along = next((axis for axis in rounds or np.swapaxes(cell.normals, 0, 1) if _is_common(cell, np.real(axis[0]))), None)
    if along is None:
        alike.require_empty(cell, scale)
        return None
    turn = axes(along)
    slopes = cell.normals @ turn
    offsets = cell.offsets - (cell.normals @ cell.point[..., None])[..., 0]
    leans = [item[:, 1:] / item[:, :1] for item in ((axis[:, None] @ turn)[:, 0] for axis in rounds)]
    sideways = alike.as_first(np.abs(np.real(slopes[..., 0])) < 0.5)
    alike.as_first(np.minimum(*(_lengths(np.real(slopes[..., some])) for some in ([0], [1, 2]))) < _FLUSH)
    upward = alike.as_first(np.real(slopes[..., 0]) > 0.5)
    planes = np.concatenate([offsets[..., None], -slopes[..., 1:]], axis=-1) / slopes[..., :1]
    low, high = _farthest(planes[:, ~(sideways | upward)], -1.0), _farthest(planes[:, upward], 1.0)
    if alike.as_first(np.real(high[:, 0] - low[:, 0]) <= within):
        return None
    centres = [((point - cell.point)[:, None] @ turn)[:, 0] for _, point, _ in cell.rounds]

    def section(station: Array) -> Array | None:
        circles = [
            (centre[:, 1:] + (station - centre[:, 0])[:, None] * lean, radius)
            for centre, lean, (_, _, radius) in zip(centres, leans, cell.rounds, strict=True)
        ]
        lines = [(slopes[:, number, 1:], offsets[:, number] - station * slopes[:, number, 0]) for number in np.flatnonzero(sideways)]
        return _section(circles, lines, within, alike)

    half, middle = 0.5 * (high[:, 0] - low[:, 0]), 0.5 * (high[:, 0] + low[:, 0])
    stations = [middle + half * node for node in _LINE_NODES]
    first = section(stations[0])
    if first is None:
        return None
    is_leaning = any(map(np.any, (np.imag(slopes[:, sideways, 0]), *map(np.imag, leans))))
    second = section(stations[1]) if is_leaning else first
    slices = [
        (station, half[:, None, None] * each[:, 0]) for station, each in zip(stations, (first, second), strict=True) if each is not None
    ]
    for sign, end in ((1.0, high), (-1.0, low)):
        slices.append((end[:, 0], sign * np.einsum("bi,bijk->bjk", end[:, 1:], first[:, 1:])))
    place, total = _seen_from(cell.point, turn), np.zeros((), dtype=float)
    for station, each in slices:
        seen = place[:, :, [0, 2, 3]] + np.where([True, False, False], place[:, :, 1:2] * station[:, None, None], 0.0)
        total = total + seen @ each @ np.swapaxes(seen, -1, -2)
    return total


def _is_common(cell: _Cell, along: Array) -> bool:
    """Whether all faces of the first design run along an axis or lie across it."""
    normals = np.real(cell.normals[0])
    steep = normals @ along
    across = [np.cross(np.real(axis[0]), along) for axis, _, _ in cell.rounds]
    is_upright = (np.abs(steep) < _FLUSH) | (_lengths(normals - steep[:, None] * along) < _FLUSH)
    return bool(np.all(is_upright) and all(_lengths(each) < _FLUSH for each in across))


def _farthest(planes: Array, sign: float) -> Array:
    """Of planes x = p . (1, y, z) (b, n, 3) that of the least or, for a negative sign, the largest x."""
    return np.take_along_axis(planes, np.argmin(sign * np.real(planes[..., 0]), axis=1)[:, None, None], axis=1)[:, 0]


def _least(values: Array) -> Array:
    """Of values (b, n) that of the least real part."""
    return np.take_along_axis(values, np.argmin(np.real(values), axis=1)[:, None], axis=1)[:, 0]


def _lengths(vectors: Array) -> Array:
    return np.sqrt(np.sum(vectors * vectors, axis=-1))


def _dot(one: Array, other: Array) -> Array:
    return np.sum(one * other, axis=-1)


_Edge: TypeAlias = tuple[Array, Array]
"""A circle by its centre (b, 2) and radius (b,), or a line by its normal and offset."""


def _section(circles: Sequence[_Edge], lines: Sequence[_Edge], within: float, alike: _Alike) -> Array | None:
    """Integrals (b, 3, 3, 3) of products of three of (1, y, z) over the region within all circles and lines, by Green along its edge."""
    circles, lines = _distinct(circles, within, within, alike), _distinct(lines, _FLUSH, within, alike)
    sides = [side for number in range(len(lines)) for side in _along_line(number, circles, lines, alike)]
    sides += [side for number in range(len(circles)) for side in _along_circle(number, circles, lines, alike)]
    if not sides:
        return None
    total = np.zeros((), dtype=float)
    for places, turn in sides:
        ones = np.concatenate([np.ones((*places.shape[:2], 1)), places], axis=-1)
        total = total + np.swapaxes(ones, -1, -2) @ ((ones * turn[..., None])[..., :, None] * ones[..., None, :]).reshape(*turn.shape, 9)
    total = total.reshape(-1, 3, 3, 3) / _DEGREES
    return None if alike.as_first(np.real(total[:, 0, 0, 0]) <= within * within) else total


def _distinct(edges: Sequence[_Edge], near: float, within: float, alike: _Alike) -> list[_Edge]:
    """The circles (or lines) that differ from those before them in their centres (normals) by `near`, or in their radii (offsets)."""
    kept: list[_Edge] = []
    for vector, size in edges:
        apart = [np.abs(np.real(vector - other)).max(axis=-1) >= near for other, _ in kept]
        apart = [far | (np.abs(np.real(size - other)) >= within) for far, (_, other) in zip(apart, kept, strict=True)]
        if all(alike.as_first(each) for each in apart):
            kept.append((vector, size))
    return kept


def _along_line(number: int, circles: Sequence[_Edge], lines: Sequence[_Edge], alike: _Alike) -> Iterator[tuple[Array, Array]]:
    """Places along the part of a line that bounds the region, and p x dp there."""
    normal, offset = lines[number]
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=-1)
    lows, highs = [], []
    for centre, radius in circles:
        reach = radius**2 - (offset - _dot(normal, centre)) ** 2
        if alike.as_first(np.real(reach) <= 0.0):
            return
        half, middle = np.sqrt(reach), _dot(along, centre)
        lows.append(middle - half)
        highs.append(middle + half)
    for slope, limit in (*lines[:number], *lines[number + 1 :]):
        rate, left = _dot(slope, along), limit - offset * _dot(slope, normal)
        if alike.as_first(np.abs(np.real(rate)) < _FLUSH):
            if alike.as_first(np.real(left) < 0.0):
                return
        elif alike.as_first(np.real(rate) > 0.0):
            highs.append(left / rate)
        else:
            lows.append(left / rate)
    low, high = -_least(-np.stack(lows, axis=-1)), _least(np.stack(highs, axis=-1))
    if alike.as_first(np.real(high - low) <= 0.0):
        return
    half = 0.5 * (high - low)
    distance = 0.5 * (low + high)[:, None] + half[:, None] * _LINE_NODES
    yield offset[:, None, None] * normal[:, None] + distance[..., None] * along[:, None], (offset * half)[:, None] * _LINE_WEIGHTS


def _along_circle(number: int, circles: Sequence[_Edge], lines: Sequence[_Edge], alike: _Alike) -> Iterator[tuple[Array, Array]]:
    """Places along the arcs of a circle that bound the region, and p x dp there."""
    centre, radius = circles[number]
    limits = [(normal, (offset - _dot(normal, centre)) / radius) for normal, offset in lines]
    for middle, size in (*circles[:number], *circles[number + 1 :]):
        arm = centre - middle
        apart = np.sqrt(_dot(arm, arm))
        if alike.as_first(np.real(apart) < _FLUSH * np.real(radius)):
            limits.append((np.broadcast_to([1.0, 0.0], arm.shape), np.where(np.real(radius) <= np.real(size), 2.0, -2.0)))
        else:
            limits.append((arm / apart[:, None], (size**2 - apart**2 - radius**2) / (2.0 * radius * apart)))
    for low, high in _intervals(limits, alike):
        half = 0.5 * (high - low)
        angles = 0.5 * (low + high)[:, None] + half[:, None] * _ARC_NODES
        outward = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        turn = radius[:, None] ** 2 + radius[:, None] * (outward @ centre[..., None])[..., 0]
        yield centre[:, None] + radius[:, None, None] * outward, turn * half[:, None] * _ARC_WEIGHTS


def _intervals(limits: Sequence[tuple[Array, Array]], alike: _Alike) -> Iterator[tuple[Array, Array]]:
    """Intervals of the angle where e(angle) . direction <= limit holds for all limits."""
    cut = [(direction, limit) for direction, limit in limits if alike.as_first(np.real(limit) < 1.0)]
    if any(alike.as_first(np.real(limit) <= -1.0) for _, limit in cut):
        return
    if not cut:
        whole = np.full(len(alike.designs), np.pi)
        yield -whole, whole
        return
    middle, half = (np.stack(each, axis=-1) for each in zip(*((_angle(way), np.arccos(limit)) for way, limit in cut), strict=True))
    low = middle - half
    turns = 2.0 * np.pi * np.floor((np.real(low) + np.pi) / (2.0 * np.pi))
    order = np.argsort(np.real(low - turns), axis=1, kind="stable")
    low, high = (np.take_along_axis(ends, order, axis=1) for ends in (low - turns, middle + half - turns))
    reached = -_least(-np.concatenate([high[:, :1], high - 2.0 * np.pi], axis=1))  # the last may reach round to the first
    ahead = np.concatenate([low[:, 1:], low[:, :1] + 2.0 * np.pi], axis=1)
    for following, end in zip(ahead.T, np.roll(high, -1, axis=1).T, strict=True):
        if alike.as_first(np.real(following) > np.real(reached)):
            yield reached, following
        reached = np.where(np.real(end) > np.real(reached), end, reached)


def _angle(direction: Array) -> Array:
    """The angle of a direction, analytic in its components."""
    base = np.arctan2(np.real(direction[:, 1]), np.real(direction[:, 0]))
    turned = direction[:, 1] * np.cos(base) - direction[:, 0] * np.sin(base)
    return base + turned / np.sqrt(_dot(direction, direction))


def _volume(cell: _Cell, scale: float) -> float:
    """The volume of a region of the first design, plane faces for round ones [m^3]; 0 where it is empty."""
    normals, offsets, share = [np.real(cell.normals[0])], [np.real(cell.offsets[0])], np.cos(np.pi / _SIDES)
    angles = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    for axis, point, radius in cell.rounds:
        normals.append(np.column_stack([np.cos(angles), np.sin(angles)]) @ axes(np.real(axis[0])).T[1:])
        offsets.append(normals[-1] @ np.real(point[0]) + share * np.real(radius[0]))
    turns, heights = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(_FACES), 1.0 - (2.0 * np.arange(_FACES) + 1.0) / _FACES
    rims = np.sqrt(1.0 - heights**2)
    for centre, radius in cell.balls:
        normals.append(np.column_stack([rims * np.cos(turns), rims * np.sin(turns), heights]))
        offsets.append(normals[-1] @ np.real(centre[0]) + share * np.real(radius[0]))
    corners = polytope_corners(np.concatenate(normals), np.concatenate(offsets) - _FLUSH * scale)
    return float(scipy.spatial.ConvexHull(corners).volume) if len(corners) else 0.0
