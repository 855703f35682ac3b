"""Union: what outlines of one body have in common, so that it weighs once.

The union of solids follows by inclusion and exclusion from their intersections, each solid being its outer form less its hole. Those
of blocks, however they are turned, are polytopes; with a cylinder they are exact where it lies within the other's sides, or is cut square.
Which corners a polytope has is told from the real parts of one design; their places are formulas, so that derivatives by complex step and
batches pass through. Designs of a batch that have other corners are told for themselves.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TypeAlias

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array, Number, stack
from flexstage.parts.body import Cylinder, Imported, Solid, solid_frame
from flexstage.spatial.convex import separations
from flexstage.spatial.frame import Frame

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
class _Cell:
    """A convex region: all r with `normals` (..., k, 3) r <= `offsets` (..., k), within all `rounds`."""

    normals: Array
    offsets: Array
    rounds: tuple[_Round, ...] = ()

    def common(self, other: _Cell) -> _Cell:
        """The region of both."""
        shape = np.broadcast_shapes(self.offsets.shape[:-1], other.offsets.shape[:-1])
        normals = [np.broadcast_to(cell.normals, (*shape, *cell.normals.shape[-2:])) for cell in (self, other)]
        offsets = [np.broadcast_to(cell.offsets, (*shape, cell.offsets.shape[-1])) for cell in (self, other)]
        return _Cell(np.concatenate(normals, axis=-2), np.concatenate(offsets, axis=-1), self.rounds + other.rounds)


_Sum: TypeAlias = list[tuple[float, _Cell]]
"""Convex regions with their signs."""
_Group: TypeAlias = tuple[tuple[int, ...], _Sum]
"""Solids, and the regions that they have in common."""


class _InexactError(Exception):
    """A common region whose volume is known by numbers only [m^3]."""

    def __init__(self, volume: float) -> None:
        super().__init__()
        self.volume = volume


def common_moments(solids: Sequence[Drawn]) -> Iterator[tuple[Number, Moments]]:
    """What solids of a body have in common and would weigh more than once: densities, and the moments to add (most are negative).

    Raises `DesignError` where the common volume cannot be weighed: of several materials, or of forms that cross with round faces.

    >>> from flexstage.spatial.frame import identity
    >>> here, there = Block("steel", (2.0, 1.0, 1.0)), Block("steel", (1.0, 1.0, 1.0), at=(1.0, 0.0, 0.0))
    >>> [(_, found)] = common_moments([Drawn("a", here, 1.0, identity()), Drawn("b", there, 1.0, identity())])
    >>> float(found.volume)
    -0.5
    """
    seen = [drawn for drawn in solids if not isinstance(drawn.solid, Imported)]
    near = _near(seen)
    if not near:
        return
    cells = {number: _cells(seen[number]) for pair in near for number in pair}
    scale = max(float(np.max(np.abs(_first(drawn.frame.position, 1)) + np.max(_first(_size(drawn.solid), 1)))) for drawn in seen)
    problems: list[Finding] = []
    groups: list[_Group] = []
    for pair in near:
        try:
            found = _product(cells[pair[0]], cells[pair[1]], scale)
        except _InexactError as crossing:
            problems += _refused(seen, pair, crossing.volume)
            continue
        if found and _differ(seen, pair):
            problems += _mixed(seen, pair, sum(sign * float(_first(_moments(cell, scale).volume, 0)) for sign, cell in found))
        elif found:
            groups.append((pair, found))
    require(problems)
    yield from _alternating(seen, cells, groups, scale)


def _alternating(
    seen: Sequence[Drawn],
    cells: Mapping[int, _Sum],
    groups: list[_Group],
    scale: float,
) -> Iterator[tuple[Number, Moments]]:
    """Inclusion and exclusion: pairs count -1, triples +1, and so on."""
    pairs = {group for group, _ in groups}
    told = 0
    while groups:
        larger: list[_Group] = []
        for group, found in groups:
            for sign, cell in found:
                moments = _moments(cell, scale)
                weight = sign * (-1.0) ** (len(group) - 1)
                yield seen[group[0]].density, Moments(weight * moments.volume, weight * moments.first, weight * moments.second)
            for other in range(group[-1] + 1, len(seen)):
                if all((member, other) in pairs for member in group):
                    try:
                        wider = _product(found, cells[other], scale)
                    except _InexactError as crossing:
                        require(_refused(seen, (*group, other), crossing.volume))
                        continue
                    larger += [((*group, other), wider)] if wider else []
            told += 1
        if told > _MOST:
            names = ", ".join(seen[number].name for number in groups[0][0])
            advice = "Draw the body of fewer outlines, or state its mass"
            require([Finding(names, "too many outlines overlap in one place to weigh their union", advice)])
        groups = larger


def _near(seen: Sequence[Drawn]) -> list[tuple[int, int]]:
    """Pairs whose boxes overlap, in any design of a batch."""
    if len(seen) < 2:
        return []
    frames = [solid_frame(drawn.solid).within(drawn.frame) for drawn in seen]
    turns, centres, halves = (
        [frame.rotation for frame in frames], [frame.position for frame in frames], [0.5 * _size(drawn.solid) for drawn in seen],
    )  # fmt: skip
    shape = np.broadcast_shapes(*(each.shape[:-2] for each in turns), *(each.shape[:-1] for each in (*centres, *halves)))
    turns, centres, halves = (
        np.stack([np.broadcast_to(np.real(each), (*shape, *each.shape[each.ndim - depth :])).reshape(-1, *[3] * depth) for each in items])
        for items, depth in ((turns, 2), (centres, 1), (halves, 1))
    )
    first, second = np.triu_indices(len(seen), k=1)
    reach = np.linalg.norm(halves, axis=-1)
    close = np.linalg.norm(centres[first] - centres[second], axis=-1) < reach[first] + reach[second]
    pairs = [(int(one), int(other)) for one, other in zip(first[close.any(axis=1)], second[close.any(axis=1)], strict=True)]
    return [
        (one, other)
        for one, other in pairs
        if np.any(
            separations((turns[one], centres[one], halves[one]), (turns[other], centres[other], halves[other]))
            < -_FLUSH * (reach[one] + reach[other])
        )
    ]


def _size(solid: Solid) -> Array:
    return stack((solid.length, solid.diameter, solid.diameter)) if isinstance(solid, Cylinder) else stack(solid.size)


def _cells(drawn: Drawn) -> _Sum:
    """A solid as a sum of convex regions: its outer form, less its hole."""
    solid, frame = drawn.solid, solid_frame(drawn.solid).within(drawn.frame)
    if isinstance(solid, Cylinder):
        caps = _box(frame, stack((solid.length,)))
        axis = frame.rotation[..., :, 0]
        outer = replace(caps, rounds=(_Round(axis, frame.position, np.asarray(0.5 * solid.diameter)),))
        if solid.bore is None:
            return [(1.0, outer)]
        return [(1.0, outer), (-1.0, replace(caps, rounds=(_Round(axis, frame.position, np.asarray(0.5 * solid.bore)),)))]
    outer = _box(frame, stack(solid.size))
    if isinstance(solid, Imported) or solid.hole is None:
        return [(1.0, outer)]
    return [(1.0, outer), (-1.0, _box(frame, stack((*solid.hole, solid.size[2]))))]


def _box(frame: Frame, size: Array) -> _Cell:
    """The region between pairs of planes across the first axes of a frame."""
    count = size.shape[-1]
    normals = np.swapaxes(frame.rotation, -1, -2)[..., :count, :]
    middle = np.sum(normals * frame.position[..., None, :], axis=-1)
    offsets = np.concatenate([middle + 0.5 * size, 0.5 * size - middle], axis=-1)
    return _Cell(np.concatenate([normals, -normals], axis=-2), offsets)


def _product(first: _Sum, second: _Sum, scale: float) -> _Sum:
    """The common regions of two sums, without those that are empty in every design."""
    found: _Sum = []
    for (sign, one), (other_sign, other) in ((a, b) for a in first for b in second):
        cell = one.common(other)
        if np.any(np.real(_moments(cell, scale).volume) > 0.0):
            found.append((sign * other_sign, cell))
    total = sum((sign * np.real(_moments(cell, scale).volume) for sign, cell in found), np.zeros(()))
    return found if np.any(np.abs(total) > (_FLUSH * scale) * scale**2) else []


def _differ(seen: Sequence[Drawn], pair: tuple[int, int]) -> bool:
    return bool(np.any(np.real(np.asarray(seen[pair[0]].density) - seen[pair[1]].density)))


def _refused(seen: Sequence[Drawn], numbers: tuple[int, ...], volume: float) -> Iterator[Finding]:
    first, *others = (seen[number] for number in numbers)
    names = " and ".join(other.name for other in others)
    what = f"it overlaps {names} by {_volume(volume)}, which would weigh twice: a round face crosses another face there"
    yield Finding(first.name, what, "Cut one of them so that they only touch, draw one within the other, or state the body's mass")


def _mixed(seen: Sequence[Drawn], pair: tuple[int, int], volume: float) -> Iterator[Finding]:
    first, second = (seen[number] for number in pair)
    there = f"{second.name} of {second.solid.material} by {_volume(volume)}"
    what = f"it is of {first.solid.material} and overlaps {there}: which of them fills it is not known"
    yield Finding(first.name, what, "Cut one of them (a block may have a hole, a cylinder a bore), or state the body's mass")


def _volume(cubic_metres: float) -> str:
    return f"{1e9 * cubic_metres:.4g} mm^3"


# Moments of regions


def _moments(cell: _Cell, scale: float) -> Moments:
    """Moments of a region, design by design where its corners differ."""
    rounds = cell.rounds
    arrays = [cell.offsets[..., 0], *(each for item in rounds for each in (item.axis[..., 0], item.point[..., 0], item.radius))]
    shape = np.broadcast_shapes(*(each.shape for each in arrays))
    kind = np.result_type(cell.normals, cell.offsets, *(each for item in rounds for each in (item.axis, item.point, item.radius)))
    count = int(np.prod(shape, dtype=int))
    normals = np.broadcast_to(cell.normals, (*shape, *cell.normals.shape[-2:])).reshape(count, -1, 3)
    offsets = np.broadcast_to(cell.offsets, (*shape, cell.offsets.shape[-1])).reshape(count, -1)
    flat = [
        _Round(
            np.broadcast_to(item.axis, (*shape, 3)).reshape(count, 3),
            np.broadcast_to(item.point, (*shape, 3)).reshape(count, 3),
            np.broadcast_to(item.radius, shape).reshape(count),
        )
        for item in rounds
    ]
    volume, first, second = np.zeros(count, kind), np.zeros((count, 3), kind), np.zeros((count, 3, 3), kind)
    pending = np.arange(count)
    while pending.size:
        number = pending[0]
        if flat:
            mine = [_Round(item.axis[number], item.point[number], item.radius[number]) for item in flat]
            done, values = pending[:1], _round_moments(_Cell(normals[number], offsets[number], tuple(mine)), scale)
        else:
            done, values = _polytopes(normals[pending], offsets[pending], scale)
            done = pending[done]
        volume[done], first[done], second[done] = values
        pending = np.setdiff1d(pending, done, assume_unique=True)
    return Moments(volume.reshape(shape), first.reshape((*shape, 3)), second.reshape((*shape, 3, 3)))


_Values = tuple[Array, Array, Array]


def _polytopes(normals: Array, offsets: Array, scale: float) -> tuple[Array, _Values]:
    """Moments of those polytopes of a batch that have the corners of the first one; which they are."""
    within = _FLUSH * scale
    planes = _distinct(np.real(normals[0]), np.real(offsets[0]), within)
    corners = _corners(np.real(normals[0]), np.real(offsets[0]), planes, within)
    empty = (np.array([0]), (np.zeros(1), np.zeros((1, 3)), np.zeros((1, 3, 3))))
    if len(corners) < 4:
        return empty
    places = np.linalg.solve(normals[:, corners], offsets[:, corners][..., None])[..., 0]
    beyond = np.einsum("bkx,bvx->bvk", np.real(normals), np.real(places)) - np.real(offsets)[:, None]
    alike = np.flatnonzero(np.all(beyond <= 2.0 * within, axis=(1, 2)))
    try:
        hull = ConvexHull(np.real(places[0]) / scale)
    except QhullError:
        return empty
    if hull.volume < _FLUSH:
        flat = float(np.min(np.ptp(np.real(places[0]) @ np.real(normals[0, planes]).T, axis=0)))
        if flat <= 2.0 * within:
            return empty
    middle = np.mean(places[alike], axis=1, keepdims=True)
    arms = (places[alike] - middle)[:, _outward(hull)]
    return alike, _fan(arms, middle[:, 0])


def _outward(hull: ConvexHull) -> Array:
    """The triangles of a hull (n, 3), counter-clockwise seen from outside."""
    corners = hull.points[hull.simplices]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.sum(normal * hull.equations[:, :3], axis=1) < 0.0
    return np.where(inward[:, None], hull.simplices[:, ::-1], hull.simplices)


def _fan(arms: Array, middle: Array) -> _Values:
    """Moments of polytopes as tetrahedra from their middles (b, 3) to their triangles (b, n, 3, 3)."""
    sixfold = np.linalg.det(arms)
    total = np.sum(arms, axis=2)
    volume = np.sum(sixfold, axis=1) / 6.0
    first = np.einsum("bn,bnx->bx", sixfold, total) / 24.0
    second = (np.einsum("bn,bnvx,bnvy->bxy", sixfold, arms, arms) + np.einsum("bn,bnx,bny->bxy", sixfold, total, total)) / 120.0
    return _shifted((volume, first, second), middle)


def _shifted(values: _Values, by: Array) -> _Values:
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


def _round_moments(cell: _Cell, scale: float) -> _Values:
    """Moments of a region with round faces, of one design: a cylinder cut square, or nothing."""
    empty = (np.zeros(()), np.zeros(3), np.zeros((3, 3)))
    within = _FLUSH * scale
    try:
        kept = _narrowest(cell.rounds, within)
        if kept is None:
            return empty
        ends = _ends(cell, kept, within)
    except _InexactError:
        volume = _by_numbers(cell, scale)
        if volume <= _FLUSH * scale**3:
            return empty
        raise _InexactError(volume) from None
    if ends is None:
        return empty
    low, high = ends
    size, radius = high - low, kept.radius
    volume = np.pi * radius**2 * size
    along = kept.axis[:, None] * kept.axis[None, :]
    second = volume * (size**2 / 12.0 * along + radius**2 / 4.0 * (np.eye(3) - along))
    return _shifted((np.asarray(volume), np.zeros(3), second), kept.point + 0.5 * (low + high) * kept.axis)


def _narrowest(rounds: Sequence[_Round], within: float) -> _Round | None:
    """The round that lies within all others; `None` where two do not meet."""
    kept = rounds[0]
    for other in rounds[1:]:
        if np.linalg.norm(np.cross(np.real(kept.axis), np.real(other.axis))) > _FLUSH:
            raise _InexactError(0.0)
        arm = np.real(other.point - kept.point)
        apart = float(np.linalg.norm(arm - (arm @ np.real(kept.axis)) * np.real(kept.axis)))
        here, there = float(np.real(kept.radius)), float(np.real(other.radius))
        if apart >= here + there - within:
            return None
        if apart + min(here, there) > max(here, there) + within:
            raise _InexactError(0.0)
        kept = kept if here <= there else other
    return kept


def _ends(cell: _Cell, kept: _Round, within: float) -> tuple[Array, Array] | None:
    """Where square planes cut a cylinder, measured along its axis; `None` where nothing is left. Other planes must pass it by."""
    slopes = cell.normals @ kept.axis
    offsets = cell.offsets - cell.normals @ kept.point
    real = np.real(slopes)
    square = np.sqrt(np.maximum(0.0, 1.0 - real**2)) < _FLUSH
    cuts = offsets / np.where(square, slopes, 1.0)
    above, below = np.flatnonzero(square & (real > 0.0)), np.flatnonzero(square & (real < 0.0))
    high = cuts[above[np.argmin(np.real(cuts[above]))]]
    low = cuts[below[np.argmax(np.real(cuts[below]))]]
    if np.real(high - low) <= within:
        return None
    for slope, offset in zip(real[~square], np.real(offsets[~square]), strict=True):
        sideways = float(np.real(kept.radius)) * np.sqrt(max(0.0, 1.0 - slope**2))
        reach = (slope * float(np.real(low)), slope * float(np.real(high)))
        if min(reach) - sideways >= offset - within:
            return None
        if max(reach) + sideways > offset + within:
            raise _InexactError(0.0)
    return low, high


_SIDES = 64


def _by_numbers(cell: _Cell, scale: float) -> float:
    """The volume of a region with round faces, as prisms of as much section [m^3]; 0 where prisms within do not meet."""
    inner = _halves(cell, float(np.cos(np.pi / _SIDES)))
    wanted = np.column_stack([inner[:, :3], np.ones(len(inner))])
    ball = linprog([0.0, 0.0, 0.0, -1.0], A_ub=wanted, b_ub=-inner[:, 3], bounds=(None, None))
    if ball.x is None or ball.x[3] <= _FLUSH * scale:
        return 0.0
    alike = _halves(cell, float(np.sqrt(np.pi / (_SIDES * np.tan(np.pi / _SIDES)))))
    return float(ConvexHull(HalfspaceIntersection(alike, ball.x[:3]).intersections).volume)


def _halves(cell: _Cell, share: float) -> Array:
    """A region as half-spaces (k, 4), its rounds as prisms whose sides lie at a share of their radius."""
    planes = [np.column_stack([np.real(cell.normals), -np.real(cell.offsets)])]
    angles = 2.0 * np.pi * np.arange(_SIDES) / _SIDES
    for item in cell.rounds:
        normals = np.column_stack([np.cos(angles), np.sin(angles)]) @ np.linalg.svd(np.real(item.axis)[None])[2][1:]
        offsets = normals @ np.real(item.point) + share * float(np.real(item.radius))
        planes.append(np.column_stack([normals, -offsets]))
    return np.concatenate(planes)


def _first(values: Array, axes: int) -> Array:
    return np.real(values[(0,) * (np.ndim(values) - axes)])
