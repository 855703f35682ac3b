"""Union: what outlines of one body have in common, so that it weighs once.

The union of solids follows by inclusion and exclusion from their intersections, each solid being its outer form less its hole. Those
of blocks, however they are turned, are polytopes; with cylinders they are prisms where all axes are parallel to faces that cross them.
Which corners a polytope has is told from one design; their places are formulas, so that batches pass through. Designs of a batch that have
other corners are told for themselves. Derivatives by complex step are integrals over the surface (`parts.surface`): the region of the real
parts is worked out once, however many numbers are stepped after one another.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache, reduce
from itertools import combinations
from typing import Any, TypeAlias

import numpy as np
import scipy

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array, Number, stack
from flexstage.base.storage.digest import Description, digest
from flexstage.parts.body import Block, Cylinder, Extrusion, Imported, Solid, Sphere, triangles, within_polygon
from flexstage.parts.surface import PLANE, ROUND, Face, Hull, Path, Prism, Surface, gains, hull_planes
from flexstage.spatial.convex import Boxes, separations
from flexstage.spatial.frame import Frame, axes

_FLUSH = 1e-9
"""Faces nearer than this share of the solids' size coincide."""
_MOST = 2000
"""Common regions of more outlines than this are not weighed."""


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
class _Round:
    """All within `radius` of the line through `point` along `axis`."""

    axis: Array
    point: Array
    radius: Array


@dataclass(frozen=True, eq=False)
class _Ball:
    """All within `radius` of `point`."""

    point: Array
    radius: Array


@dataclass(frozen=True, eq=False)
class _Cell:
    """A convex region: all r with `normals` (..., k, 3) r <= `offsets` (..., k), within all `rounds` and `balls`."""

    normals: Array
    offsets: Array
    rounds: tuple[_Round, ...] = ()
    balls: tuple[_Ball, ...] = ()
    made: tuple[tuple[int, int], ...] = ()
    """Of which solids it is the common region, each by its number and that of its cell."""

    def common(self, other: _Cell) -> _Cell:
        """The region of both."""
        return _Cell(
            _joined((self.normals, other.normals), 2),
            _joined((self.offsets, other.offsets), 1),
            self.rounds + other.rounds,
            self.balls + other.balls,
            self.made + other.made,
        )


def _joined(arrays: Sequence[Array], axes: int) -> Array:
    """Arrays one after the other along the first of their own axes, their batch axes broadcast."""
    shape = np.broadcast_shapes(*(each.shape[:-axes] for each in arrays))
    return np.concatenate([np.broadcast_to(each, (*shape, *each.shape[-axes:])) for each in arrays], axis=-axes)


_SYMMETRIC: Array = np.array([[4, 7, 8], [7, 5, 9], [8, 9, 6]])
"""Where second moments stand among 1, x, y, z, xx, yy, zz, xy, xz, yz."""


@dataclass(frozen=True, eq=False)
class _Region:
    """A convex region with its sign, its moments, and its surfaces as far as they are known."""

    sign: Number
    cell: _Cell
    moments: Moments
    surfaces: tuple[Surface, ...] = ()

    @cached_property
    def gains(self) -> Mapping[Face, Array]:
        """What its moments are to the motion of its faces."""
        return self._gains(turning=True)

    @cached_property
    def parallel_gains(self) -> Mapping[Face, Array]:
        """What they are to planes that stay parallel."""
        return self._gains(turning=False)

    def _gains(self, *, turning: bool) -> Mapping[Face, Array]:
        flat = _flat_cell(self.cell, self.moments.volume.shape)
        return gains(self.surfaces, [(item.axis, item.point) for item in flat.rounds], self.moments.volume.size, turning=turning)

    def moved(self, cell: _Cell) -> Moments:
        """Its moments with the derivatives by complex step that a cell of the same real numbers has."""
        shape = self.moments.volume.shape
        numbers = [cell.normals, cell.offsets, *(each for item in cell.rounds for each in (item.axis, item.point, item.radius))]
        if not any(map(np.iscomplexobj, numbers)):
            return self.moments
        flat, turns = _flat_cell(cell, shape), bool(np.any(np.imag(cell.normals)))
        total = np.zeros((self.moments.volume.size, 10))
        for (kind, number), gain in (self.gains if turns else self.parallel_gains).items():
            if kind == PLANE:
                turning = [np.broadcast_to(np.imag(flat.normals[:, number]), (len(total), 3))] if turns else []
                rates = [np.imag(flat.offsets[:, number, None]), *turning]
            else:
                item = flat.rounds[number]
                rates = [np.imag(item.radius)[:, None], np.imag(item.point), np.imag(item.axis)]
            rate = np.concatenate(rates, axis=1)
            if not np.any(rate):
                continue
            total += (gain @ rate[..., None])[..., 0] if rate.shape[1] > 1 else gain[..., 0] * rate
        second = total[:, _SYMMETRIC].reshape(*shape, 3, 3)
        own = self.moments
        first = total[:, 1:4].reshape(*shape, 3)
        return Moments(own.volume + 1j * total[:, 0].reshape(shape), own.first + 1j * first, own.second + 1j * second)


_Group: TypeAlias = tuple[tuple[int, ...], list[_Region]]
"""Solids, and the regions that they have in common."""


class _InexactError(Exception):
    """A common region whose volume is known by numbers only [m^3]."""

    def __init__(self, volume: float) -> None:
        super().__init__()
        self.volume = volume


def common_moments(solids: Sequence[Drawn]) -> Iterator[tuple[Number, Moments]]:
    """What solids of a body have in common and would weigh more than once: densities, and the moments to add (most are negative).

    Solids that remove weigh nothing themselves: what they have in common with others of their material is taken away, P less H being the
    union of both less H. Raises `DesignError` where the common volume cannot be weighed: of several materials, or of forms that cross with
    round faces.

    >>> from flexstage.parts.body import Block
    >>> from flexstage.spatial.frame import identity
    >>> here, there = Block("steel", (2.0, 1.0, 1.0)), Block("steel", (1.0, 1.0, 1.0), at=(1.0, 0.0, 0.0))
    >>> [(_, found)] = common_moments([Drawn("a", here, 1.0, identity()), Drawn("b", there, 1.0, identity())])
    >>> float(found.volume)
    -0.5
    """
    seen = [drawn for drawn in solids if not isinstance(drawn.solid, Imported)]
    yield from _common(seen)
    for density, moments in _common([drawn for drawn in seen if drawn.solid.subtract]):
        yield density, Moments(-moments.volume, -moments.first, -moments.second)


def _common(seen: Sequence[Drawn]) -> Iterator[tuple[Number, Moments]]:
    """The moments that make the union of solids, of every material by itself, of the sum of them."""
    if len(seen) < 2:
        return
    if any(isinstance(drawn.solid, Sphere) for drawn in seen):
        yield from ((seen[number].density, _weighed(weight, region.moments)) for number, weight, region in _regions(seen))
        return
    stepped = {number for number, drawn in enumerate(seen) if _is_stepped(drawn)}
    cells: dict[int, list[tuple[Number, _Cell]]] = {}
    for number, weight, region in _known(_Key(tuple(_real(drawn) for drawn in seen))):
        moments, members = region.moments, region.cell.made
        if any(member in stepped for member, _ in members):
            cells |= {member: _cells(seen[member]) for member, _ in members if member not in cells}
            moments = region.moved(reduce(_Cell.common, (cells[member][place][1] for member, place in members)))
        yield seen[number].density, _weighed(weight, moments)


def _weighed(weight: Number, moments: Moments) -> Moments:
    weight = np.asarray(weight)
    return Moments(weight * moments.volume, weight[..., None] * moments.first, weight[..., None, None] * moments.second)


@dataclass(frozen=True, eq=False)
class _Key:
    """Solids of real numbers, compared by content."""

    seen: tuple[Drawn, ...]

    @cached_property
    def content(self) -> str:
        """Everything that counts."""
        return digest([(each.name, each.solid, each.density, each.frame.rotation, each.frame.position) for each in self.seen])

    def __hash__(self) -> int:
        return hash(self.content)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and self.content == other.content


_Weighed: TypeAlias = tuple[int, Number, _Region]
"""A region that would weigh more than once: a solid whose density it has, and how often it is to be added."""


@lru_cache(maxsize=16)
def _known(key: _Key) -> tuple[_Weighed, ...]:
    """The regions of some bodies, kept while numbers are stepped one after the other: their real parts stay."""
    return tuple(_regions(key.seen))


def _is_stepped(drawn: Drawn) -> bool:
    """Whether a number that places a face is stepped."""
    return _real_part(drawn.solid) is not drawn.solid or any(map(np.iscomplexobj, (drawn.frame.rotation, drawn.frame.position)))


def _real(drawn: Drawn) -> Drawn:
    return Drawn(drawn.name, _real_part(drawn.solid), _real_part(drawn.density), _real_frame(drawn.frame))


def _real_frame(frame: Frame) -> Frame:
    return replace(frame, rotation=np.real(frame.rotation), position=np.real(frame.position))


def _real_part(value: Any) -> Any:
    """A number or a description, its numbers without their steps."""
    if isinstance(value, (complex, np.ndarray)):
        return np.real(value) if np.iscomplexobj(value) else value
    if isinstance(value, tuple):
        real = tuple(map(_real_part, value))
        return value if all(one is other for one, other in zip(real, value, strict=True)) else real
    if isinstance(value, Description):
        own = {field.name: getattr(value, field.name) for field in fields(value)}  # type: ignore[arg-type]
        changed = {name: real for name, item in own.items() if (real := _real_part(item)) is not item}
        return replace(value, **changed) if changed else value  # type: ignore[type-var]
    return value


def _regions(seen: Sequence[Drawn]) -> Iterator[_Weighed]:
    near = _near(seen) if len(seen) > 1 else {}
    if not near:
        return
    cells = {number: _numbered(number, _cells(seen[number])) for pair in near for number in pair}
    scale = max(float(np.max(np.abs(_first(drawn.frame.position, 1)) + np.max(_first(drawn.solid.sides, 1)))) for drawn in seen)
    problems: list[Finding] = []
    groups: list[_Group] = []
    for pair, where in near.items():
        if _is_apart(seen[pair[0]], seen[pair[1]]):
            continue
        try:
            found = _product(*_beside(seen, cells, *pair), where, scale)
        except _InexactError as crossing:
            problems += _refusals(seen, pair, crossing.volume)
            continue
        if found and _differ(seen[pair[0]], seen[pair[1]]):
            volume = _volume_of(found) - sum(
                _volume_of(rest) for rest in _removed([seen[number] for number in pair], seen, cells, found, scale)
            )
            problems += _mixtures(seen[pair[0]], seen[pair[1]], volume) if volume > _FLUSH * scale**3 else ()
        elif found:
            groups.append((pair, found))
    require(problems)
    yield from _alternating(seen, cells, groups, scale)


def _numbered(number: int, cells: list[tuple[Number, _Cell]]) -> list[tuple[Number, _Cell]]:
    return [(sign, replace(cell, made=((number, place),))) for place, (sign, cell) in enumerate(cells)]


def _beside(
    seen: Sequence[Drawn], cells: Mapping[int, list[tuple[Number, _Cell]]], one: int, two: int
) -> tuple[list[tuple[Number, _Cell]], list[tuple[Number, _Cell]]]:
    """The regions of two solids; a ball that keeps clear of the sides of an extrusion sees the planes of its height alone."""
    for ball, other in ((one, two), (two, one)):
        solid = seen[other].solid
        if isinstance(seen[ball].solid, Sphere) and isinstance(solid, Extrusion):
            frame = solid.frame.within(seen[other].frame)
            arm = seen[ball].solid.frame.within(seen[ball].frame).position - frame.position
            if _is_clear(
                (np.swapaxes(frame.rotation, -1, -2) @ arm[..., None])[..., :2, 0],
                np.asarray(seen[ball].solid.sides[..., 0]),
                solid.corners,
            ):
                upright = Frame(frame.rotation[..., :, [2, 0, 1]], frame.position)
                return cells[ball], [(1.0, _box(upright, np.asarray(solid.height)[..., None]))]
    return cells[one], cells[two]


def _is_clear(centre: Array, diameter: Array, corners: Array) -> bool:
    """Whether circles lie within polygons in all designs."""
    shape = np.broadcast_shapes(centre.shape[:-1], diameter.shape, corners.shape[:-2])
    centre, corners = np.broadcast_to(np.real(centre), (*shape, 2)), np.broadcast_to(np.real(corners), (*shape, *corners.shape[-2:]))
    radius = 0.5 * np.broadcast_to(np.real(diameter), shape)
    return all(bool(within_polygon(centre[design][None], corners[design], -float(radius[design]))[0]) for design in np.ndindex(shape))


def _alternating(
    seen: Sequence[Drawn], cells: Mapping[int, list[tuple[Number, _Cell]]], groups: list[_Group], scale: float
) -> Iterator[_Weighed]:
    """Inclusion and exclusion: pairs count -1, triples +1, and so on."""
    pairs = {group for group, _ in groups}
    told = 0
    while groups:
        larger: list[_Group] = []
        for group, found in groups:
            for region in found:
                yield group[0], region.sign * (-1.0) ** (len(group) - 1), region
            for other in range(group[-1] + 1, len(seen)):
                if all((member, other) in pairs for member in group):
                    where = np.any(np.stack(np.broadcast_arrays(*(region.moments.volume != 0.0 for region in found))), axis=0)
                    try:
                        wider = _product([(region.sign, region.cell) for region in found], cells[other], where, scale)
                    except _InexactError as crossing:
                        require(_refusals(seen, (*group, other), crossing.volume))
                        continue
                    larger += [((*group, other), wider)] if wider else []
            told += 1
        if told > _MOST:
            names = ", ".join(seen[number].name for number in groups[0][0])
            advice = "Draw the body of fewer outlines, or state its mass"
            require([Finding(names, "too many outlines overlap in one place to weigh their union", advice)])
        groups = larger


def _near(seen: Sequence[Drawn]) -> dict[tuple[int, int], Array]:
    """Pairs whose boxes overlap, and in which designs of a batch."""
    frames = [drawn.solid.frame.within(drawn.frame) for drawn in seen]
    boxes = [
        Boxes(np.real(frame.rotation), np.real(frame.position), 0.5 * np.real(drawn.solid.sides))
        for frame, drawn in zip(frames, seen, strict=True)
    ]
    reach = [np.sqrt(np.sum(box.halves * box.halves, axis=-1)) for box in boxes]
    middle = np.array([_first(box.centres, 1) for box in boxes]).reshape(-1, 3)
    loose = np.array([_spread(box.centres) + float(np.max(far)) for box, far in zip(boxes, reach, strict=True)])
    apart = middle[:, None] - middle
    close = np.einsum("ijk,ijk->ij", apart, apart) < (loose[:, None] + loose) ** 2
    first, second = np.nonzero(np.triu(close, k=1))
    pairs = list(zip(first.tolist(), second.tolist(), strict=True))
    if all(box.turns.ndim == 2 and box.centres.ndim == box.halves.ndim == 1 for box in boxes):
        drawn = Boxes(*(np.array([getattr(box, name) for box in boxes]) for name in ("turns", "centres", "halves")))
        gaps = separations(drawn.pick(first), drawn.pick(second))
    else:
        sides = [(np.abs(box.turns) @ box.halves[..., None])[..., 0] for box in boxes]
        pairs = [
            (one, other)
            for one, other in pairs
            if np.any(np.all(np.abs(boxes[one].centres - boxes[other].centres) < sides[one] + sides[other], axis=-1))
        ]
        gaps = [_gaps(boxes[one], boxes[other]) for one, other in pairs]
    meet = ((pair, gap < -_FLUSH * (reach[pair[0]] + reach[pair[1]])) for pair, gap in zip(pairs, gaps, strict=True))
    return {pair: np.asarray(where) for pair, where in meet if np.any(where)}


def _gaps(first: Boxes, second: Boxes) -> Array:
    """How far two boxes are apart at least, in each design."""
    both = (first, second)
    shape = np.broadcast_shapes(*(each.shape[:-1] for box in both for each in (box.turns[..., 0], box.centres, box.halves)))
    return separations(_flat(first, shape), _flat(second, shape)).reshape(shape)


def _flat(box: Boxes, shape: tuple[int, ...]) -> Boxes:
    """A box with one batch axis; turns that are those of every design stand once."""
    return Boxes(
        box.turns[None] if box.turns.ndim == 2 else np.broadcast_to(box.turns, (*shape, 3, 3)).reshape(-1, 3, 3),
        np.broadcast_to(box.centres, (*shape, 3)).reshape(-1, 3),
        np.broadcast_to(box.halves, (*shape, 3)).reshape(-1, 3),
    )


def _spread(centres: Array) -> float:
    """How far the centres of a batch lie from the first of them at most [m]."""
    return 0.0 if centres.ndim == 1 else float(np.max(np.linalg.norm(centres - _first(centres, 1), axis=-1)))


def _cells(drawn: Drawn) -> list[tuple[Number, _Cell]]:
    """A solid as a sum of convex regions: its outer form, less its hole."""
    solid, frame = drawn.solid, drawn.solid.frame.within(drawn.frame)
    if isinstance(solid, Cylinder):
        caps = _box(frame, stack((solid.length,)))
        axis = frame.rotation[..., :, 0]
        outer = replace(caps, rounds=(_Round(axis, frame.position, np.asarray(0.5 * solid.diameter)),))
        if solid.bore is None:
            return [(1.0, outer)]
        return [(1.0, outer), (-1.0, replace(caps, rounds=(_Round(axis, frame.position, np.asarray(0.5 * solid.bore)),)))]
    if isinstance(solid, Sphere):
        return [(1.0, _Cell(np.zeros((0, 3)), np.zeros(0), balls=(_Ball(frame.position, np.asarray(0.5 * solid.diameter)),)))]
    if isinstance(solid, Extrusion):
        corners = solid.corners
        trios = (corners[..., trio, :] for trio in triangles(_first(corners, 2)))
        return [(sign, _wedge(frame, sign, trio, np.asarray(solid.height))) for trio in trios for sign in [_turn(trio)]]
    outer = _box(frame, solid.sides)
    if not isinstance(solid, Block) or solid.hole is None:
        return [(1.0, outer)]
    return [(1.0, outer), (-1.0, _box(frame, stack((*solid.hole, solid.size[2]))))]


def _box(frame: Frame, size: Array) -> _Cell:
    """The region between pairs of planes across the first axes of a frame."""
    count = size.shape[-1]
    normals = np.swapaxes(frame.rotation, -1, -2)[..., :count, :]
    middle = np.sum(normals * frame.position[..., None, :], axis=-1)
    offsets = np.concatenate([middle + 0.5 * size, 0.5 * size - middle], axis=-1)
    return _Cell(np.concatenate([normals, -normals], axis=-2), offsets)


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
    sides = outward @ turn[..., :2, :]
    caps = turn[..., [2, 2], :] * np.array([[1.0], [-1.0]])
    normals = _joined((sides, caps), 2)
    offsets = _joined((np.sum(outward * trio, axis=-1), np.broadcast_to(0.5 * height[..., None], (*height.shape, 2))), 1)
    return _Cell(normals, offsets + np.sum(normals * frame.position[..., None, :], axis=-1))


def polygon_moments(corners: Array, height: Array) -> Moments:
    """Moments of a prism over a polygon of corners (..., n, 2), counter-clockwise, half of its `height` on either side (Green's theorem).

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> float(polygon_moments(square, np.asarray(2.0)).volume)
    2.0
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


def _product(first: Sequence[tuple[Number, _Cell]], second: Sequence[tuple[Number, _Cell]], where: Array, scale: float) -> list[_Region]:
    """The common regions of two sums in the designs `where` they may meet, without those that are empty in every design."""
    found: list[_Region] = []
    for (sign, one), (other_sign, other) in ((a, b) for a in first for b in second):
        cell = one.common(other)
        moments, surfaces = _moments(cell, where, scale)
        if np.any(np.real(moments.volume) > 0.0):
            found.append(_Region(sign * other_sign, cell, moments, surfaces))
    total = sum((region.sign * np.real(region.moments.volume) for region in found), np.zeros(()))
    return found if np.any(np.abs(total) > (_FLUSH * scale) * scale**2) else []


def _volume_of(regions: Sequence[_Region]) -> float:
    return sum(float(np.max(region.sign * np.real(region.moments.volume))) for region in regions)


def _removed(
    both: Sequence[Drawn], seen: Sequence[Drawn], cells: Mapping[int, list[tuple[Number, _Cell]]], found: Sequence[_Region], scale: float
) -> Iterator[list[_Region]]:
    """What holes in one of two solids take away of the regions that `both` have in common."""
    materials = {drawn.solid.material for drawn in both}
    for number, drawn in enumerate(seen):
        if drawn.solid.subtract and drawn.solid.material in materials and number in cells:
            yield _product([(region.sign, region.cell) for region in found], cells[number], np.ones((), dtype=bool), scale)


def _is_apart(first: Drawn, second: Drawn) -> bool:
    """Whether one is a hole, which takes away nothing of another material."""
    return (first.solid.subtract or second.solid.subtract) and first.solid.material != second.solid.material


def _differ(first: Drawn, second: Drawn) -> bool:
    return bool(np.any(np.real(np.asarray(first.density) - second.density)))


def _refusals(seen: Sequence[Drawn], numbers: tuple[int, ...], volume: float) -> Iterator[Finding]:
    first, *others = (seen[number] for number in numbers)
    names = " and ".join(other.name for other in others)
    what = f"it overlaps {names} by {_volume(volume)}, which would weigh twice: a round face crosses another face there"
    yield Finding(first.name, what, "Cut one of them so that they only touch, draw one within the other, or state the body's mass")


def _mixtures(first: Drawn, second: Drawn, volume: float) -> Iterator[Finding]:
    there = f"{second.name} of {second.solid.material} by {_volume(volume)}"
    what = f"it is of {first.solid.material} and overlaps {there}: which of them fills it is not known"
    yield Finding(first.name, what, "Cut one of them (a block may have a hole, a cylinder a bore), or state the body's mass")


def _volume(cubic_metres: float) -> str:
    return f"{1e9 * cubic_metres:.4g} mm^3"


# Moments of regions


def _moments(cell: _Cell, where: Array, scale: float) -> tuple[Moments, tuple[Surface, ...]]:
    """Moments and surfaces of a region in the designs `where`, nothing in the others; those together whose corners and edges are alike."""
    numbers = [each for item in cell.rounds for each in (item.axis, item.point)] + [item.point for item in cell.balls]
    radii = [item.radius for item in (*cell.rounds, *cell.balls)]
    shape = np.broadcast_shapes(
        where.shape, cell.offsets.shape[:-1], *(each.shape[:-1] for each in numbers), *(each.shape for each in radii)
    )
    kind = np.result_type(cell.normals, cell.offsets, *numbers, *radii)
    count = int(np.prod(shape, dtype=int))
    flat = _flat_cell(cell, shape)
    volume, first, second = np.zeros(count, kind), np.zeros((count, 3), kind), np.zeros((count, 3, 3), kind)
    surfaces: list[Surface] = []
    pending = np.flatnonzero(np.broadcast_to(where, shape))
    if not (cell.balls or cell.rounds):
        some = _pick(flat, pending)
        pending = pending[~_is_flat(np.real(some.normals), np.real(some.offsets), 2.0 * _FLUSH * scale)]
    while pending.size:
        if cell.balls:
            done, values = pending[:1], _ball_moments(_pick(flat, pending[0]), scale)
        else:
            alike, values, surface = (_round_moments if cell.rounds else _polytopes)(_pick(flat, pending), scale)
            done = pending[alike]
            surfaces += [] if surface is None else [replace(surface, designs=done)]
        volume[done], first[done], second[done] = values
        pending = np.setdiff1d(pending, done, assume_unique=True)
    return Moments(volume.reshape(shape), first.reshape((*shape, 3)), second.reshape((*shape, 3, 3))), tuple(surfaces)


def _flat_cell(cell: _Cell, shape: tuple[int, ...]) -> _Cell:
    """A region with one batch axis; normals that are those of every design stand once."""

    def flat(values: Array, axes: int) -> Array:
        own = values.shape[values.ndim - axes :]
        return np.broadcast_to(values, (*shape, *own)).reshape(int(np.prod(shape, dtype=int)), *own)

    rounds = tuple(_Round(flat(item.axis, 1), flat(item.point, 1), flat(item.radius, 0)) for item in cell.rounds)
    balls = tuple(_Ball(flat(item.point, 1), flat(item.radius, 0)) for item in cell.balls)
    normals = flat(cell.normals, 2) if cell.normals.ndim > 2 or cell.rounds or cell.balls else cell.normals[None]
    return _Cell(normals, flat(cell.offsets, 1), rounds, balls)


def _pick(cell: _Cell, designs: Array) -> _Cell:
    """One design, or some, of a region with one batch axis."""
    rounds = tuple(_Round(item.axis[designs], item.point[designs], item.radius[designs]) for item in cell.rounds)
    balls = tuple(_Ball(item.point[designs], item.radius[designs]) for item in cell.balls)
    normals = cell.normals if len(cell.normals) < len(cell.offsets) else cell.normals[designs]
    return _Cell(normals, cell.offsets[designs], rounds, balls)


class _Alike:
    """The first design of a batch decides; `designs` (b,) are those that have decided as it has."""

    def __init__(self, count: int) -> None:
        self.designs = np.ones(count, dtype=bool)

    def as_first(self, decisions: Array) -> Array:
        """What the first design decides, of decisions (b, ...)."""
        same = decisions == decisions[0]
        self.designs &= same.reshape(len(same), -1).all(axis=1)
        return np.asarray(decisions[0])


_Values = tuple[Array, Array, Array]


def _is_flat(normals: Array, offsets: Array, within: float) -> Array:
    """Which polytopes of a batch have two opposite faces (n and -n) that are not apart."""
    opposite = np.sum((normals[:, :, None] + normals[:, None]) ** 2, axis=-1) < _FLUSH**2
    return np.asarray((opposite & (offsets[:, :, None] + offsets[:, None] <= within)).any(axis=(1, 2)))


def _polytopes(cell: _Cell, scale: float) -> tuple[Array, _Values, Surface | None]:
    """Moments and surface of those polytopes of a batch that have the corners of the first one; which they are."""
    normals, offsets, within = cell.normals, cell.offsets, _FLUSH * scale
    planes = _distinct(np.real(normals[0]), np.real(offsets[0]), within)
    corners = _corners(np.real(normals[0]), np.real(offsets[0]), planes, within)
    empty = (np.array([0]), (np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3, 3))), None)
    if len(corners) < 4:
        done = _empty_alike(np.real(normals), np.real(offsets) / scale)
        return done, (np.zeros(len(done)), np.zeros((len(done), 3)), np.zeros((len(done), 3, 3))), None
    places = _crossings(normals[:, corners], offsets[:, corners])
    beyond = np.real(places) @ np.swapaxes(np.real(normals), -1, -2) - np.real(offsets)[:, None]
    alike = np.flatnonzero(np.all(beyond <= 2.0 * within, axis=(1, 2)))
    try:
        hull = scipy.spatial.ConvexHull(np.real(places[0]) / scale)
    except scipy.spatial.QhullError:
        return empty
    if hull.volume < _FLUSH:
        flat = float(np.min(np.ptp(np.real(places[0]) @ np.real(normals[0, planes]).T, axis=0)))
        if flat <= 2.0 * within:
            return empty
    middle = np.mean(places[alike], axis=1, keepdims=True)
    outward = _outward(hull)
    owners = np.array(planes)[hull_planes(hull, np.real(normals[0, planes]), np.real(offsets[0, planes]), scale)]
    return alike, _fan((places[alike] - middle)[:, outward], middle[:, 0]), Hull(alike, places[alike], outward, owners)


def _empty_alike(normals: Array, offsets: Array) -> Array:
    """Which polytopes of a batch are empty by the same planes as the first, which is one of them.

    Farkas' lemma: there is no r with N r <= b where weights w >= 0 have N^T w = 0 and b . w < 0.
    """
    normals, wanted = np.broadcast_to(normals, (*offsets.shape, 3)), np.array([0.0, 0.0, 0.0, -1.0])
    planes = np.concatenate([normals, offsets[..., None]], axis=-1)
    used = np.swapaxes(planes[:, scipy.optimize.nnls(planes[0].T, wanted)[0] > 0.0], -1, -2)
    weights = np.linalg.pinv(used) @ wanted
    miss = _lengths((used @ weights[..., None])[..., 0] - wanted)
    alike: Array = np.asarray((weights >= 0.0).all(axis=1) & (miss < _FLUSH))
    alike[0] = True
    return np.flatnonzero(alike)


def _outward(hull: scipy.spatial.ConvexHull) -> Array:
    """The triangles of a hull (n, 3), counter-clockwise seen from outside."""
    corners = hull.points[hull.simplices]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.sum(normal * hull.equations[:, :3], axis=1) < 0.0
    return np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)


def _crossings(normals: Array, offsets: Array) -> Array:
    """Where three planes each (..., 3, 3) meet (..., 3), by Cramer's rule."""
    across = np.stack([_cross(normals[..., one, :], normals[..., other, :]) for one, other in ((1, 2), (2, 0), (0, 1))], axis=-2)
    return np.sum(across * offsets[..., None], axis=-2) / _dot(normals[..., 0, :], across[..., 0, :])[..., None]


def _cross(one: Array, other: Array) -> Array:
    return one[..., [1, 2, 0]] * other[..., [2, 0, 1]] - one[..., [2, 0, 1]] * other[..., [1, 2, 0]]


def _fan(arms: Array, middle: Array) -> _Values:
    """Moments of polytopes as tetrahedra from their middles (b, 3) to their triangles (b, n, 3, 3)."""
    sixfold = _dot(arms[..., 0, :], _cross(arms[..., 1, :], arms[..., 2, :]))[..., None]
    total = np.sum(arms, axis=2)
    ends = np.concatenate([arms, total[:, :, None]], axis=2)
    heavy = sixfold[..., None] * ends
    second = np.swapaxes(ends.reshape(len(ends), -1, 3), -1, -2) @ heavy.reshape(len(ends), -1, 3) / 120.0
    return _shift((np.sum(sixfold, axis=(1, 2)) / 6.0, np.sum(heavy[:, :, 3], axis=1) / 24.0, second), middle)


def _shift(values: _Values, by: Array) -> _Values:
    volume, first, second = values
    cross = first[..., :, None] * by[..., None, :]
    moved = second + cross + np.swapaxes(cross, -1, -2) + volume[..., None, None] * by[..., :, None] * by[..., None, :]
    return volume, first + volume[..., None] * by, moved


def _distinct(normals: Array, offsets: Array, within: float) -> list[int]:
    """Planes that do not coincide with one before them."""
    kept: list[int] = []
    for number in range(len(offsets)):
        same = (
            np.all(np.abs(normals[kept] - normals[number]) < _FLUSH, axis=1) & (np.abs(offsets[kept] - offsets[number]) < within)
            if kept
            else np.zeros(0, dtype=bool)
        )
        if not np.any(same):
            kept.append(number)
    return kept


def _corners(normals: Array, offsets: Array, planes: Sequence[int], within: float) -> Array:
    """The planes (v, 3) that meet in each corner of a polytope, each corner once."""
    triples = np.array(list(combinations(planes, 3)))
    size = np.abs(np.linalg.det(normals[triples]))
    triples = triples[np.argsort(-np.round(size, 6), kind="stable")]
    triples = triples[np.abs(np.linalg.det(normals[triples])) > 1e-6]
    if not len(triples):
        return triples
    places = np.linalg.solve(normals[triples], offsets[triples][..., None])[..., 0]
    inside = np.all(places @ normals.T <= offsets + within, axis=1)
    kept: list[int] = []
    for number in np.flatnonzero(inside):
        if not kept or np.min(np.linalg.norm(places[kept] - places[number], axis=1)) > 4.0 * within:
            kept.append(int(number))
    return triples[kept]


def _round_moments(cell: _Cell, scale: float) -> tuple[Array, _Values, Surface | None]:
    """Moments and surface of those regions of a batch that have the edges of the first one; which they are.

    Regions with round faces: prisms along the rounds' common axis, or nothing.
    """
    within = _FLUSH * scale
    alike = _Alike(len(cell.offsets))
    with np.errstate(divide="ignore", invalid="ignore"):  # of designs that are not alike
        try:
            found = _prism(cell, within, alike)
        except _InexactError:
            volume = _by_numbers(_pick(cell, np.array(0)), scale)
            if volume > _FLUSH * scale**3:
                raise _InexactError(volume) from None
            return np.array([0]), (np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3, 3))), None
        done = np.flatnonzero(alike.designs)
        if found is None:
            return done, (np.zeros(len(done)), np.zeros((len(done), 3)), np.zeros((len(done), 3, 3))), None
        surface, (area, first, second) = found
        frame, (low, high) = surface.frame, surface.ends
        size, middle = high - low, 0.5 * (low + high)
        moments = np.zeros((len(size), 3, 3), dtype=np.result_type(area, size, frame.rotation))
        moments[:, 0, 0] = area * size**3 / 12.0
        moments[:, 1:, 1:] = second * size[:, None, None]
        flat = np.concatenate([np.zeros((len(size), 1)), first * size[:, None]], axis=1)
        turn = frame.rotation
        own = (area * size, (turn @ flat[..., None])[..., 0], turn @ moments @ np.swapaxes(turn, -1, -2))
        volume, first, second = _shift(own, frame.position + middle[:, None] * turn[..., 0])
    return done, (volume[done], first[done], second[done]), surface.take(done)


def _ball_moments(cell: _Cell, scale: float) -> _Values:
    """Moments of a region with balls, of one design: a ball, its cap, or nothing; what is cut otherwise is told by its volume."""
    nothing = np.zeros(()), np.zeros(3), np.zeros((3, 3))
    within = _FLUSH * scale
    ball, *others = sorted(cell.balls, key=lambda item: float(np.real(item.radius)))
    least = float(np.real(ball.radius))
    depths = cell.offsets - cell.normals @ ball.point
    beside = [(float(np.real(other.radius)), _length(other.point - ball.point)) for other in others]
    beside += [(float(np.real(item.radius)), _length(np.cross(item.point - ball.point, item.axis))) for item in cell.rounds]
    if np.any(np.real(depths) <= within - least) or any(gap >= radius + least - within for radius, gap in beside):
        return nothing
    planes = _distinct(np.real(cell.normals), np.real(depths), within)
    cuts = [number for number in planes if np.real(depths[number]) < least - within]
    if len(cuts) > 1 or any(gap + least > radius + within for radius, gap in beside):
        volume = _by_numbers(cell, scale)
        if volume <= _FLUSH * scale**3:
            return nothing
        raise _InexactError(volume)
    normal, depth = (cell.normals[cuts[0]], depths[cuts[0]]) if cuts else (np.array([1.0, 0.0, 0.0]), ball.radius)
    return _shift(_cap(normal, ball.radius, depth), ball.point)


def _length(vector: Array) -> float:
    return float(np.linalg.norm(np.real(vector)))


def _cap(normal: Array, radius: Array, depth: Array) -> _Values:
    """Moments of what of a ball about the origin lies at t = normal . r <= depth: integrals of its round sections over t."""
    square = radius * radius

    def upto(t: Array) -> tuple[Array, Array, Array, Array]:
        along = square * t**3 / 3.0 - t**5 / 5.0
        across = 0.25 * (square * square * t - 2.0 * square * t**3 / 3.0 + t**5 / 5.0)
        return square * t - t**3 / 3.0, 0.5 * square * t**2 - 0.25 * t**4, along, across

    volume, first, along, across = (np.pi * (high - low) for high, low in zip(upto(depth), upto(-radius), strict=True))
    line = normal[:, None] * normal
    return np.asarray(volume), first * normal, along * line + across * (np.eye(3) - line)


def _prism(cell: _Cell, within: float, alike: _Alike) -> tuple[Prism, _Values] | None:
    """Regions as prisms (x along the axis), and the moments of their sections; `None`: empty.

    Raises `_InexactError` where rounds are not parallel, or a plane cuts them aslant.
    """
    axis, radius = cell.rounds[0].axis, np.real(cell.rounds[0].radius)
    if any(alike.as_first(_lengths(np.cross(np.real(axis), np.real(other.axis))) > _FLUSH) for other in cell.rounds[1:]):
        raise _InexactError(0.0)
    frame = Frame(axes(axis), cell.rounds[0].point)
    slopes = cell.normals @ frame.rotation
    offsets = cell.offsets - (cell.normals @ frame.position[..., None])[..., 0]
    steep = np.real(slopes[..., 0])
    square = alike.as_first(np.hypot(np.real(slopes[..., 1]), np.real(slopes[..., 2])) < _FLUSH)
    sideways = alike.as_first(np.abs(steep) < _FLUSH)
    upward = alike.as_first(square & (steep > 0.0))
    cuts = offsets / np.where(square, slopes[..., 0], 1.0)
    downward = square & ~upward
    high, low = _least(cuts[:, upward]), -_least(-cuts[:, downward])
    if alike.as_first(np.real(high - low) <= within):
        return None
    circles = [(((item.point - frame.position)[:, None, :] @ frame.rotation[..., 1:])[:, 0], item.radius) for item in cell.rounds]
    sides = np.flatnonzero(sideways)
    lines = [(slopes[:, number, 1:], offsets[:, number]) for number in sides]
    for number in np.flatnonzero(~square & ~sideways):
        slope, offset = np.real(slopes[:, number]), np.real(offsets[:, number])
        across = radius * np.hypot(slope[:, 1], slope[:, 2])
        ends = slope[:, 0] * np.real(low), slope[:, 0] * np.real(high)
        if alike.as_first(np.minimum(*ends) - across >= offset - within):
            return None
        if alike.as_first(np.maximum(*ends) + across > offset + within):
            raise _InexactError(0.0)
    section = _section(circles, lines, within, alike)
    if section is None:
        return None
    paths = tuple(replace(path, face=(PLANE, int(sides[path.face[1]]))) if path.face[0] == PLANE else path for path in section[0])
    caps = tuple(
        np.flatnonzero(which)[np.argmin(side, axis=1)]
        for which, side in ((downward, -np.real(cuts[:, downward])), (upward, np.real(cuts[:, upward])))
    )
    return Prism(np.arange(len(low)), frame, (low, high), (caps[0], caps[1]), paths, section[1]), section[1]


def _least(values: Array) -> Array:
    """Of values (b, n) that of the least real part."""
    return np.take_along_axis(values, np.argmin(np.real(values), axis=1)[:, None], axis=1)[:, 0]


def _lengths(vectors: Array) -> Array:
    return np.sqrt(np.sum(vectors * vectors, axis=-1))


def _dot(one: Array, other: Array) -> Array:
    return np.sum(one * other, axis=-1)


_Circle: TypeAlias = tuple[Array, Array]
_Line: TypeAlias = tuple[Array, Array]
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(24)
"""Exact to rounding for the trigonometric and other polynomials of second moments along an arc or a side."""
_ROUND_NODES, _ROUND_WEIGHTS = np.arange(-7.0, 8.0, 2.0) / 8.0, np.full(8, 0.25)
"""Along a whole circle, exact for trigonometric polynomials below the eighth degree."""


def _section(circles: Sequence[_Circle], lines: Sequence[_Line], within: float, alike: _Alike) -> tuple[tuple[Path, ...], _Values] | None:
    """Rims and moments of the regions within all circles (centre, radius) and lines (normal, offset): by Green, along each."""
    own_circles, own_lines = _distinct_edges(circles, within, within, alike), _distinct_edges(lines, _FLUSH, within, alike)
    circles, lines = [circles[number] for number in own_circles], [lines[number] for number in own_lines]
    sides = [
        *(((PLANE, own), _along_line(number, circles, lines, alike)) for number, own in enumerate(own_lines)),
        *(((ROUND, own), piece) for number, own in enumerate(own_circles) for piece in _along_circle(number, circles, lines, alike)),
    ]
    paths = tuple(Path(face, *side) for face, side in sides if side is not None)
    if not paths:
        return None
    area = sum((0.5 * np.sum(path.turn, axis=-1) for path in paths), np.zeros(()))
    if alike.as_first(np.real(area) <= within * within):
        return None
    first = sum((np.sum(path.places * path.turn[..., None], axis=-2) / 3.0 for path in paths), np.zeros(2))
    second = sum((np.einsum("bnx,bny,bn->bxy", path.places, path.places, path.turn) / 4.0 for path in paths), np.zeros((2, 2)))
    return paths, (np.asarray(area), first, second)


def _distinct_edges(edges: Sequence[tuple[Array, Array]], near: float, within: float, alike: _Alike) -> list[int]:
    """The circles (or lines) that differ from those before them in their centres (normals) by `near`, or in their radii (offsets)."""
    kept: list[int] = []
    for number, (vector, size) in enumerate(edges):
        same = [
            alike.as_first(
                (np.abs(np.real(vector - edges[other][0])).max(axis=-1) < near) & (np.abs(np.real(size - edges[other][1])) < within)
            )
            for other in kept
        ]
        kept += [] if any(same) else [number]
    return kept


def _along_line(number: int, circles: Sequence[_Circle], lines: Sequence[_Line], alike: _Alike) -> tuple[Array, Array, Array] | None:
    """Places along the part of a line that bounds the region, p x dp and the lengths there."""
    normal, offset = lines[number]
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=-1)
    lows, highs = [], []
    for centre, radius in circles:
        reach = radius**2 - (offset - _dot(normal, centre)) ** 2
        if alike.as_first(np.real(reach) <= 0.0):
            return None
        half, middle = np.sqrt(reach), _dot(along, centre)
        lows.append(middle - half)
        highs.append(middle + half)
    for other, (slope, limit) in enumerate(lines):
        if other == number:
            continue
        rate, left = _dot(slope, along), limit - offset * _dot(slope, normal)
        if alike.as_first(np.abs(np.real(rate)) < _FLUSH):
            if alike.as_first(np.real(left) < 0.0):
                return None
        elif alike.as_first(np.real(rate) > 0.0):
            highs.append(left / rate)
        else:
            lows.append(left / rate)
    low, high = -_least(-np.stack(lows, axis=-1)), _least(np.stack(highs, axis=-1))
    if alike.as_first(np.real(high - low) <= 0.0):
        return None
    half = 0.5 * (high - low)
    places = offset[:, None, None] * normal[:, None] + (0.5 * (low + high)[:, None] + half[:, None] * _NODES)[..., None] * along[:, None]
    return places, (offset * half)[:, None] * _WEIGHTS, half[:, None] * _WEIGHTS


def _along_circle(number: int, circles: Sequence[_Circle], lines: Sequence[_Line], alike: _Alike) -> Iterator[tuple[Array, Array, Array]]:
    """Places along the arcs of a circle that bound the region, p x dp and the lengths there."""
    centre, radius = circles[number]
    limits = [(normal, (offset - _dot(normal, centre)) / radius) for normal, offset in lines]
    for other, (middle, size) in enumerate(circles):
        if other == number:
            continue
        arm = centre - middle
        apart = np.sqrt(_dot(arm, arm))
        if alike.as_first(np.real(apart) < _FLUSH * np.real(radius)):
            limits.append((np.broadcast_to([1.0, 0.0], arm.shape), np.where(np.real(radius) <= np.real(size), 2.0, -2.0)))
        else:
            limits.append((arm / apart[:, None], (size**2 - apart**2 - radius**2) / (2.0 * radius * apart)))
    for low, high in _intervals(limits, alike):
        half = 0.5 * (high - low)
        nodes, weights = (_ROUND_NODES, _ROUND_WEIGHTS) if np.all(half == np.pi) else (_NODES, _WEIGHTS)
        angles = 0.5 * (low + high)[:, None] + half[:, None] * nodes
        outward = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
        turn = radius[:, None] ** 2 + radius[:, None] * (outward @ centre[..., None])[..., 0]
        places = centre[:, None] + radius[:, None, None] * outward
        yield places, turn * half[:, None] * weights, (radius * half)[:, None] * weights


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


_SIDES, _FACES = 64, 400


def _by_numbers(cell: _Cell, scale: float) -> float:
    """The volume of a region with round faces, as prisms of as much section [m^3]; 0 where prisms within do not meet."""
    inner = _halves(cell, float(np.cos(np.pi / _SIDES)))
    wanted = np.column_stack([inner[:, :3], np.ones(len(inner))])
    ball = scipy.optimize.linprog([0.0, 0.0, 0.0, -1.0], A_ub=wanted, b_ub=-inner[:, 3], bounds=(None, None))
    if ball.x is None or ball.x[3] <= _FLUSH * scale:
        return 0.0
    alike = _halves(cell, float(np.sqrt(np.pi / (_SIDES * np.tan(np.pi / _SIDES)))))
    return float(scipy.spatial.ConvexHull(scipy.spatial.HalfspaceIntersection(alike, ball.x[:3]).intersections).volume)


def _halves(cell: _Cell, share: float) -> Array:
    """A region as half-spaces (k, 4), the sides of its rounds and balls at a share of their radius."""
    planes = [np.column_stack([np.real(cell.normals), -np.real(cell.offsets)])]
    angles = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    for item in cell.rounds:
        normals = np.column_stack([np.cos(angles), np.sin(angles)]) @ np.linalg.svd(np.real(item.axis)[None])[2][1:]
        offsets = normals @ np.real(item.point) + share * float(np.real(item.radius))
        planes.append(np.column_stack([normals, -offsets]))
    turns, heights = np.pi * (1.0 + np.sqrt(5.0)) * np.arange(_FACES), 1.0 - (2.0 * np.arange(_FACES) + 1.0) / _FACES
    rims = np.sqrt(1.0 - heights**2)
    for ball in cell.balls:
        normals = np.column_stack([rims * np.cos(turns), rims * np.sin(turns), heights])
        planes.append(np.column_stack([normals, -(normals @ np.real(ball.point) + share * float(np.real(ball.radius)))]))
    return np.concatenate(planes)


def _first(values: Array, axes: int) -> Array:
    return np.real(values[(0,) * (np.ndim(values) - axes)])
