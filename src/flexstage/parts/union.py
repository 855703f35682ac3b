"""Mass of the union of a body's outlines: common volumes count once.

The mass of the union follows from the intersections of the solids by inclusion and exclusion. Each solid is its outer form minus its hole.
An intersection can be computed for prisms along one common axis: blocks along any edge, extrusions along their height, cylinders along
their axis. An intersection can also be computed for balls that are within the section of a prism.

The section of an intersection is a polygon clipped by half-planes. The moments of the polygon are line integrals (Green's theorem): closed
formulas, valid for batches and complex steps. All other overlaps of solids raise an error.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, reduce
from itertools import combinations, product
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array, Number, stack
from flexstage.parts.body import Block, Cylinder, Extrusion, Imported, Solid, Sphere, within_polygon
from flexstage.parts.pieces import solid_pieces
from flexstage.spatial.convex import Boxes, Convex, separation, separations
from flexstage.spatial.frame import Frame

_FLUSH = 1e-9
"""Largest distance of coincident faces, relative to the size of the solids."""
_ROUNDING = 1e-14
"""Tolerance of points on a line relative to their size."""
_MOST = 2000
"""Largest number of outlines in an intersection."""
_AXES: dict[type[Solid], tuple[int, ...]] = {Block: (0, 1, 2), Cylinder: (0,), Extrusion: (2,)}
"""Prism axes of a solid."""
_SQUARE = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])


@dataclass(frozen=True, eq=False)
class Drawn:
    """Solid of a body: name, solid, density [kg/m^3], and frame in which it is drawn."""

    name: str
    solid: Solid
    density: Number
    frame: Frame

    @cached_property
    def placed(self) -> Frame:
        """Frame of the solid, relative to the outer frame of the drawing."""
        return self.solid.frame.within(self.frame)


@dataclass(frozen=True, eq=False)
class Moments:
    """Moments of a region: its volume (...) [m^3], first moment (..., 3) [m^4] and second moment (..., 3, 3) [m^5].

    The moments are the integrals of 1, r and r r^T over the volume, for the position r. For a plane region they are the area (...) [m^2],
    the first moment (..., 2) [m^3] and the second moment (..., 2, 2) [m^4].
    """

    volume: Array
    first: Array
    second: Array

    def __add__(self, other: Moments) -> Moments:
        return Moments(self.volume + other.volume, self.first + other.first, self.second + other.second)

    def times(self, weight: ArrayLike) -> Moments:
        """Return the moments multiplied by a factor."""
        weight = np.asarray(weight)
        return Moments(weight * self.volume, weight[..., None] * self.first, weight[..., None, None] * self.second)

    def shift(self, by: Array) -> Moments:
        """Return the moments of the region translated by a vector (..., 3) or (..., 2)."""
        cross = self.first[..., :, None] * by[..., None, :]
        moved = self.second + cross + cross.mT + self.volume[..., None, None] * by[..., :, None] * by[..., None, :]
        return Moments(self.volume, self.first + self.volume[..., None] * by, moved)

    def within(self, frame: Frame) -> Moments:
        """Return the moments in the parent frame of `frame`."""
        turn = frame.rotation
        second = turn @ self.second @ turn.mT
        return Moments(self.volume, (turn @ self.first[..., None])[..., 0], second).shift(frame.position)


@dataclass(frozen=True, eq=False)
class _Prism:
    """Prism along x of its frame, of half length `half`, over a polygon of `corners` (..., n, 2) or a circle; or a ball.

    `is_rectangle`: the polygon is convex.
    """

    sign: float
    frame: Frame
    half: Array
    corners: Array | None = None
    radius: Array | None = None
    is_rectangle: bool = False


def common_moments(solids: Sequence[Drawn]) -> Iterator[tuple[Number, Moments]]:
    """Yield densities and moments to add to the moments of a body's solids, so that common volumes count only once.

    A subtracted solid removes its intersection with other solids of the same material. The moments of the rest are those of the union of
    all these solids and the subtracted solid, minus those of the subtracted solid. Raises `DesignError` if a common volume cannot be
    computed: if materials differ, or if shapes are not prisms along one axis.

    >>> from flexstage.parts.body import Block
    >>> from flexstage.spatial.frame import identity
    >>> here, there = Block("steel", (2.0, 1.0, 1.0)), Block("steel", (1.0, 1.0, 1.0), at=(1.0, 0.0, 0.0))
    >>> [(_, result)] = common_moments([Drawn("a", here, 1.0, identity()), Drawn("b", there, 1.0, identity())])
    >>> float(result.volume)
    -0.5
    """
    seen = [drawn for drawn in solids if not isinstance(drawn.solid, Imported)]
    yield from _common(seen)
    for density, moments in _common([drawn for drawn in seen if drawn.solid.subtract]):
        yield density, moments.times(-1.0)


def _common(seen: Sequence[Drawn]) -> Iterator[tuple[Number, Moments]]:
    """Inclusion and exclusion: pairs count -1, triples +1, and so on."""
    scale = max((float(np.max(np.abs(each.placed.position)) + np.max(np.real(each.solid.sides))) for each in seen), default=0.0)
    tiny = _FLUSH * scale**3
    near = [(one, other) for one, other in _near(seen) if not _is_apart(seen[one], seen[other])]
    problems: list[Finding] = []
    groups: dict[tuple[int, ...], Moments] = {}
    for one, other in near:
        both = (seen[one], seen[other])
        result = _region(both)
        if result is None:
            problems += _refusals(both) if _meet(*both, scale) else ()
        elif np.any(np.real(both[0].density - np.asarray(both[1].density))):
            holes = [each for each in seen if each.solid.subtract and each.solid.material in {drawn.solid.material for drawn in both}]
            left = result.volume - sum(moments.volume for hole in holes if (moments := _region((*both, hole))) is not None)
            problems += _mixtures(*both, float(np.max(np.real(left)))) if np.any(np.real(left) > tiny) else ()
        elif np.any(there := np.abs(result.volume) > tiny):
            groups[one, other] = result.times(there)
    require(problems)
    pairs, told = set(groups), 0
    while groups:
        for group, result in groups.items():
            yield seen[group[0]].density, result.times((-1.0) ** (len(group) - 1))
        told += len(groups)
        if told > _MOST:
            names = ", ".join(seen[number].name for number in next(iter(groups)))
            advice = "Use fewer outlines, or specify the body's mass"
            require([Finding(names, "too many overlapping outlines for the mass of their union", advice)])
        wider = [
            (*group, more) for group in groups for more in range(group[-1] + 1, len(seen)) if {(each, more) for each in group} <= pairs
        ]
        groups = {}
        for group in wider:
            members = [seen[number] for number in group]
            result = _region(members)
            require(_refusals(members) if result is None else ())
            if result is not None and np.any(there := np.abs(result.volume) > tiny):
                groups[group] = result.times(there)


def _box(drawn: Drawn) -> tuple[tuple[Array, int], ...]:
    """Axes, centre and half sides of a solid's bounding box, each with its number of non-batch axes."""
    return (drawn.placed.rotation, 2), (drawn.placed.position, 1), (0.5 * drawn.solid.sides, 1)


def _shape(seen: Sequence[Drawn]) -> tuple[int, ...]:
    """Batch axes of positions and sizes of solids."""
    return np.broadcast_shapes(*(value.shape[: value.ndim - own] for each in seen for value, own in _box(each)))


def _spread(value: Array, own: int, shape: tuple[int, ...]) -> Array:
    """Real parts of a value in every design."""
    return np.broadcast_to(np.real(value), (*shape, *value.shape[value.ndim - own :]))


def _near(seen: Sequence[Drawn]) -> Iterator[tuple[int, int]]:
    """Pairs whose boxes overlap in a design."""
    shape = _shape(seen)
    boxes = [Boxes(*(_spread(value, own, shape).reshape(-1, *value.shape[-own:]) for value, own in _box(each))) for each in seen]
    flush = [_FLUSH * np.linalg.norm(box.halves, axis=-1) for box in boxes]
    reach = [np.einsum("kij,kj->ki", np.abs(box.turns), box.halves) for box in boxes]
    for one, other in combinations(range(len(seen)), 2):
        least = flush[one] + flush[other]
        close = np.all(np.abs(boxes[other].centres - boxes[one].centres) < reach[one] + reach[other] - least[..., None], axis=-1)
        if np.any(close) and np.any(separations(boxes[one], boxes[other]) < -least):
            yield one, other


def _is_apart(first: Drawn, second: Drawn) -> bool:
    """Whether one is a hole of another material."""
    return (first.solid.subtract or second.solid.subtract) and first.solid.material != second.solid.material


def _refusals(seen: Sequence[Drawn]) -> Iterator[Finding]:
    first, *others = seen
    names = " and ".join(other.name for other in others)
    what = f"unsupported overlap with {names}: only blocks, extrusions and cylinders along a common axis may overlap"
    yield Finding(first.name, what, "Trim one of these solids, draw one as a hole along the axis of the other, or specify the body's mass")


def _mixtures(first: Drawn, second: Drawn, volume: float) -> Iterator[Finding]:
    there = f"{second.name} of {second.solid.material} by {1e9 * volume:.4g} mm^3"
    what = f"ambiguous material: {first.solid.material} overlaps {there}"
    yield Finding(first.name, what, "Cut one solid (a block may have a hole, a cylinder a bore), or specify the body's mass")


def _region(group: Sequence[Drawn]) -> Moments | None:
    """Moments of the intersection of solids; `None` unless prisms along one axis, with balls within their sections."""
    for chosen in _alignments(group):
        parts = [_moments(prisms) for prisms in product(*chosen)]
        known = [each for each in parts if each is not None]
        if len(known) == len(parts):
            return reduce(Moments.__add__, known)
    return None


def _alignments(group: Sequence[Drawn]) -> Iterator[list[list[_Prism]]]:
    """Decomposition of each solid into prisms along every common prism axis."""
    first, *others = sorted(group, key=lambda each: isinstance(each.solid, Sphere))
    for axis in _AXES.get(type(first.solid), ()):
        way = first.placed.rotation[..., :, axis]
        results = [next((k for k in _AXES.get(type(each.solid), (0,)) if _is_along(each, k, way)), None) for each in others]
        if None not in results:
            yield [_prisms(first, axis), *(_prisms(each, k) for each, k in zip(others, results, strict=True) if k is not None)]


def _is_along(drawn: Drawn, axis: int, way: Array) -> bool:
    """Whether an axis of a solid is parallel to a direction, also under complex steps; always for a ball."""
    own = drawn.placed.rotation[..., :, axis]
    across, turning = np.cross(own, way), max(float(np.max(np.abs(np.imag(each)))) for each in (own, way))
    level = np.all(np.abs(np.real(across)) < _FLUSH) and np.all(np.abs(np.imag(across)) <= _FLUSH * turning)
    return isinstance(drawn.solid, Sphere) or bool(level)


def _prisms(drawn: Drawn, axis: int) -> list[_Prism]:
    """A solid as a sum of prisms along one of its axes: outer form minus hole."""
    solid, placed = drawn.solid, drawn.placed
    frame, half = Frame(np.roll(placed.rotation, -axis, axis=-1), placed.position), 0.5 * solid.sides
    if isinstance(solid, Sphere):
        return [_Prism(1.0, frame, half[..., 0])]
    if isinstance(solid, Extrusion):
        return [_Prism(1.0, frame, half[..., 2], solid.corners)]
    if isinstance(solid, Cylinder):
        bores = [] if solid.bore is None else [_Prism(-1.0, frame, half[..., 0], radius=np.asarray(0.5 * solid.bore))]
        return [_Prism(1.0, frame, half[..., 0], radius=half[..., 1]), *bores]
    hole = solid.hole if isinstance(solid, Block) else None
    sizes = [(1.0, half), *([] if hole is None else [(-1.0, 0.5 * stack((*hole, solid.sides[..., 2])))])]
    return [
        _Prism(sign, frame, size[..., axis], np.roll(size, -axis, axis=-1)[..., None, 1:] * _SQUARE, is_rectangle=True)
        for sign, size in sizes
    ]


def _moments(prisms: Sequence[_Prism]) -> Moments | None:
    """Moments of the intersection of prisms along one axis; `None` if a ball crosses the sides of one."""
    base = prisms[0].frame
    turn = base.rotation.mT
    at = [(turn @ (each.frame.position - base.position)[..., None])[..., 0] for each in prisms]
    long = [(each, place) for each, place in zip(prisms, at, strict=True) if each.corners is not None or each.radius is not None]
    low, high = -_least([each.half - place[..., 0] for each, place in long]), _least([place[..., 0] + each.half for each, place in long])
    polygons = [
        (
            _unstepped(place[..., None, 1:] + each.corners @ (turn @ each.frame.rotation)[..., 1:, 1:].mT),
            each.is_rectangle,
        )
        for each, place in long
        if each.corners is not None
    ]
    circles = [(_unstepped(place[..., 1:]), _unstepped(each.radius)) for each, place in long if each.radius is not None]
    if len(long) < len(prisms):
        result = _zone(prisms[-1].half, at[-1], (low, high), polygons, circles) if len(long) == len(prisms) - 1 else None
    else:
        result = _extruded(_section(polygons, circles), low, high)
    return None if result is None else result.within(base).times(float(np.prod([each.sign for each in prisms])))


def _unstepped(value: Array) -> Array:
    """A value as real numbers if without complex steps, for faster evaluation."""
    return value if np.any(np.imag(value)) else np.real(value)


def _least(values: Sequence[Array]) -> Array:
    """Value with the least real part."""
    return reduce(lambda one, other: np.where(np.real(other) < np.real(one), other, one), values)


def _extruded(section: Moments, low: Array, high: Array) -> Moments:
    """Moments of a section (y, z) extruded along x from `low` to `high`; zero if empty."""
    size = np.where(np.real(high - low) > 0.0, high - low, 0.0)
    shape = np.broadcast_shapes(section.volume.shape, size.shape)
    first = np.zeros((*shape, 3), dtype=np.result_type(section.volume, size))
    second = np.zeros((*shape, 3, 3), dtype=first.dtype)
    first[..., 1:] = section.first * size[..., None]
    second[..., 0, 0] = section.volume * size**3 / 12.0
    second[..., 1:, 1:] = section.second * size[..., None, None]
    middle = 0.5 * (low + high)[..., None] * np.array([1.0, 0.0, 0.0])
    return Moments(section.volume * size, first, second).shift(middle)


def polygon_moments(corners: Array, height: Array) -> Moments:
    """Compute the moments of a prism of this `height` by Green's theorem; its mid-plane is a counter-clockwise polygon (..., n, 2).

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> float(polygon_moments(square, np.asarray(2.0)).volume)
    2.0
    """
    result = _extruded(_along(corners, np.roll(corners, -1, axis=-2)), -0.5 * height, 0.5 * height)
    return result.within(Frame(np.roll(np.eye(3), -1, axis=0), np.zeros(3)))


# Sections

_Polygon = tuple[Array, bool]
_Circle = tuple[Array, Array]


def _section(polygons: Sequence[_Polygon], circles: Sequence[_Circle]) -> Moments:
    """Moments of the region within all polygons and circles.

    The first polygon is clipped by the sides of the others, which are split into signed triangles. The intersection with several circles is
    the sum over circles, each in the region of its largest power, |p - c|^2 - r^2.
    """
    if polygons:
        regions = [(_turn(polygons[0][0]), polygons[0][0])]
    else:
        regions = [(np.asarray(1.0), circles[0][0][..., None, :] + 2.0 * circles[0][1][..., None, None] * _SQUARE)]
    for corners, is_rectangle in polygons[1:]:
        pieces = [corners] if is_rectangle else [corners[..., [0, k, k + 1], :] for k in range(1, corners.shape[-2] - 1)]
        regions = [(weight * _turn(corners) * _turn(piece), _clip_by(region, piece)) for weight, region in regions for piece in pieces]
    results = [_in_circles(region, circles).times(weight) for weight, region in regions]
    return reduce(Moments.__add__, results)


def _turn(corners: Array) -> Array:
    """Orientation of a polygon: 1 counter-clockwise, -1 clockwise."""
    return np.where(np.sum(np.real(_cross(corners, np.roll(corners, -1, axis=-2))), axis=-1) < 0.0, -1.0, 1.0)


def _clip_by(region: Array, corners: Array) -> Array:
    """Region within a convex polygon."""
    run = np.roll(corners, -1, axis=-2) - corners
    outward = _turn(corners)[..., None, None] * np.stack([run[..., 1], -run[..., 0]], axis=-1)
    for number in range(corners.shape[-2]):
        normal = outward[..., number, :]
        region = _clip(region, normal, np.sum(normal * corners[..., number, :], axis=-1))
    return region


def _clip(points: Array, normal: Array, offset: Array, *, strict: bool = False) -> Array:
    """Closed path (..., n, 2) clipped to the half-plane normal . p <= offset; outside parts run along its edge with zero area.

    With a zero normal all points are inside or outside; with a zero offset too, outside if `strict`.
    """
    beyond = (points @ normal[..., None])[..., 0] - offset[..., None]
    square = np.sum(normal * normal, axis=-1)[..., None]
    is_line = np.real(square) > 0.0
    rounding = _ROUNDING * np.max(np.abs(np.real(points)), axis=(-2, -1))[..., None] * np.sqrt(np.abs(square))
    outside = (np.real(beyond) > rounding) | (~is_line & (np.real(beyond) == 0.0) & strict)
    shadow = points - (beyond / np.where(is_line, square, 1.0))[..., None] * normal[..., None, :]
    held = np.where(outside[..., None], np.where(is_line[..., None], shadow, points[..., :1, :]), points)
    ahead, following = np.roll(beyond, -1, axis=-1), np.roll(points, -1, axis=-2)
    crosses = outside != np.roll(outside, -1, axis=-1)
    share = np.where(crosses, beyond, 0.0) / np.where(crosses, beyond - ahead, 1.0)
    middle = np.where(crosses[..., None], points + share[..., None] * (following - points), held)
    path = np.stack([held, middle], axis=-2).reshape(*held.shape[:-2], -1, 2)
    moves = np.any(path != np.roll(path, 1, axis=-2), axis=(*range(path.ndim - 2), -1))
    return path[..., moves, :] if np.any(moves) else path[..., :1, :]


def _in_circles(region: Array, circles: Sequence[_Circle]) -> Moments:
    """Moments of the area enclosed by a path within circles."""
    if not circles:
        return _along(region, np.roll(region, -1, axis=-2))
    powers = [np.sum(centre * centre, axis=-1) - radius * radius for centre, radius in circles]
    parts = []
    for number, (centre, radius) in enumerate(circles):
        own = region
        for other, (middle, _) in enumerate(circles):
            if other != number:
                own = _clip(own, 2.0 * (centre - middle), powers[number] - powers[other], strict=other < number)
        parts.append(_in_circle(own - centre[..., None, :], radius[..., None]).shift(centre))
    return reduce(Moments.__add__, parts)


def _in_circle(path: Array, radius: Array) -> Moments:
    """Moments of the area enclosed by a path within a circle about the origin: triangles to inside sides, sectors to outside ones."""
    run = np.roll(path, -1, axis=-2) - path
    square, slope, power = (np.sum(one * other, axis=-1) for one, other in ((run, run), (path, run), (path, path)))
    under = slope * slope - square * (power - radius * radius)
    meets = (np.real(under) > 0.0) & (np.real(square) > 0.0)
    root, safe = np.sqrt(np.where(meets, under, 1.0)), np.where(meets, square, 1.0)
    ends = [np.where(meets, (side * root - slope) / safe, 0.0) for side in (-1.0, 1.0)]
    inner, outer = (path + np.where(np.real(end) < 0.0, 0.0, np.where(np.real(end) > 1.0, 1.0, end))[..., None] * run for end in ends)
    return _along(inner, outer) + _sectors(path, inner, radius) + _sectors(outer, path + run, radius)


def _along(start: Array, end: Array) -> Moments:
    """Moments of the triangles from the origin to sides (..., n, 2), signed by orientation."""
    cross = _cross(start, end)
    total = start + end
    second = sum((each.mT @ (cross[..., None] * each) for each in (start, end, total)), np.zeros((2, 2)))
    return Moments(0.5 * np.sum(cross, axis=-1), np.sum(cross[..., None] * total, axis=-2) / 6.0, second / 24.0)


def _sectors(start: Array, end: Array, radius: Array) -> Moments:
    """Moments of the sectors of a circle between directions (..., n, 2), signed by orientation."""
    (a, b), (c, d) = (np.moveaxis(each / _length(each)[..., None], -1, 0) for each in (start, end))
    angle = _angle(a * c + b * d, a * d - b * c)
    area, cubic, quartic = 0.5 * radius**2 * angle, radius**3 / 3.0, 0.125 * radius**4
    twist, lean = c * d - a * b, d * d - b * b
    first = np.stack([np.sum(cubic * (d - b), axis=-1), np.sum(cubic * (a - c), axis=-1)], axis=-1)
    xx, xy, yy = (np.sum(quartic * each, axis=-1) for each in (angle + twist, lean, angle - twist))
    return Moments(np.sum(area, axis=-1), first, np.stack([np.stack([xx, xy], axis=-1), np.stack([xy, yy], axis=-1)], axis=-2))


def _cross(one: Array, other: Array) -> Array:
    return one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0]


def _length(vectors: Array) -> Array:
    square = np.sum(vectors * vectors, axis=-1)
    return np.sqrt(np.where(np.real(square) > 0.0, square, 1.0))


def _angle(x: Array, y: Array) -> Array:
    """Angle of a direction, analytic in its components."""
    base = np.arctan2(np.real(y), np.real(x))
    return base + (y * np.cos(base) - x * np.sin(base)) / np.sqrt(np.where(np.real(x * x + y * y) > 0.0, x * x + y * y, 1.0))


# Balls


def _zone(radius: Array, at: Array, ends: tuple[Array, Array], polygons: Sequence[_Polygon], circles: Sequence[_Circle]) -> Moments | None:
    """Moments of a ball between two planes normal to x; `None` if outside any section."""
    centre = at[..., 1:]
    for corners, _ in polygons:
        shape = np.broadcast_shapes(centre.shape[:-1], radius.shape, corners.shape[:-2])
        point, reach, around = (_spread(each, own, shape) for each, own in ((centre, 1), (radius, 0), (corners, 2)))
        if not all(within_polygon(point[k][None], around[k], -float(reach[k]))[0] for k in np.ndindex(shape)):
            return None
    if any(np.any(np.linalg.norm(np.real(centre - middle), axis=-1) + np.real(radius) > np.real(size)) for middle, size in circles):
        return None
    square = radius * radius

    def upto(t: Array) -> tuple[Array, Array, Array, Array]:
        along = square * t**3 / 3.0 - t**5 / 5.0
        across = 0.25 * (square * square * t - 2.0 * square * t**3 / 3.0 + t**5 / 5.0)
        return square * t - t**3 / 3.0, 0.5 * square * t**2 - 0.25 * t**4, along, across

    low, high = (-_least([radius, -_least([radius, end - at[..., 0]])]) for end in ends)
    high = -_least([-high, -low])
    volume, first, along, across = (np.pi * (top - bottom) for top, bottom in zip(upto(high), upto(low), strict=True))
    second = np.stack([along, across, across], axis=-1)[..., None] * np.eye(3)
    return Moments(volume, first[..., None] * np.array([1.0, 0.0, 0.0]), second).shift(at)


def _meet(first: Drawn, second: Drawn, scale: float) -> bool:
    """Whether two solids overlap in a design, by their convex pieces."""
    shape = _shape((first, second))
    for design in np.ndindex(shape):
        pieces: list[list[Convex]] = []
        for each in (first, second):
            turn, at = (_spread(*part, shape)[design] for part in _box(each)[:2])
            pieces.append([piece.within(Frame(turn, at)) for piece in solid_pieces(_at(each.solid, shape, design))])
        if any(separation(*pair)[0] < -_FLUSH * scale for pair in product(*pieces)):
            return True
    return False


def _at(value: Any, shape: tuple[int, ...], design: tuple[int, ...]) -> Any:
    """A solid, or one of its values, in one design."""
    if isinstance(value, Solid):
        return replace(value, **{each.name: _at(getattr(value, each.name), shape, design) for each in fields(value)})  # type: ignore[type-var,arg-type]
    if isinstance(value, tuple):
        return tuple(_at(each, shape, design) for each in value)
    return float(np.broadcast_to(np.real(value), shape)[design]) if isinstance(value, (complex, np.ndarray)) else value
