"""Contact checks: links touch their bodies, outlines of one body are connected, other outlines have clearance, gauges face their targets.

The checks use the outlines of the description, without CAD, for the first design of a batch. Round faces are approximated within `SAGITTA`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from types import MappingProxyType

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, first_design
from flexstage.base.session import SESSION
from flexstage.base.units.quantity import LENGTH
from flexstage.base.units.unit import show
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.drawn import with_drawn_parts
from flexstage.mechanism.geometry.near import near_pairs
from flexstage.mechanism.geometry.outline import Outline, outlines
from flexstage.mechanism.geometry.pieces import SAGITTA, Form, form_of, is_flat, pieces
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.parts.body import Imported, PlacedSolid, Solid, SolidWithHoles, within_polygon
from flexstage.parts.section import Section
from flexstage.parts.shape import Shaped
from flexstage.spatial.convex import Convex, distance, polytope_corners, separation
from flexstage.spatial.frame import Frame
from flexstage.spatial.rotation import exponential

TOUCHING = 1e-6
"""Distance below which faces touch [m]."""
_SHARE = 1e-3
"""Largest share of an end face outside its body."""
_BRACKET = 0.05
"""Largest distance of a gauge's target on an undrawn bracket, relative to its body's longest side."""
_REACHES = (1e-3, 1e-2, 1e-1, 1.0)
"""Distances [m] up to which the smallest gap is searched."""
_ENOUGH = 300
"""Number of pairs of pieces examined for the deepest overlap."""
_ANGLES = np.linspace(0.0, 2.0 * np.pi, 128, endpoint=False)
"""Angles of the corners of the polygon of a round end face."""
_MARGIN = (5e-5, 0.05)
"""Length [m], or share of the half length, near its end faces where a link may touch its bodies."""


@dataclass(frozen=True, eq=False)
class _Thing:
    """A body's solid or a link's part in the stage; `bodies` are its own, or joined."""

    name: str
    form: Form
    frame: Frame
    bodies: tuple[str, ...]
    is_link: bool
    outline: Outline

    @cached_property
    def pieces(self) -> tuple[Convex, ...]:
        return tuple(piece.within(self.frame) for piece in pieces(self.form))

    @cached_property
    def holes(self) -> tuple[PlacedSolid, ...]:
        """Holes of the body in this solid."""
        own = self.form.holes if isinstance(self.form, SolidWithHoles) else ()
        return tuple(PlacedSolid(hole, _first(hole.frame).within(self.frame)) for hole in own)

    def trim(self, margin: float) -> tuple[Convex, ...]:
        return tuple(piece.within(self.frame) for piece in pieces(self.form, margin))

    @property
    def half(self) -> float:
        """Half the length of a link."""
        return 0.5 * float(np.ravel(np.real(self.outline.size[..., 0]))[0])

    @property
    def end(self) -> Section:
        """Section at both ends of a link."""
        assert isinstance(self.form, Shaped)  # noqa: S101  only links are asked
        return self.form.end

    def on_end(self, side: float, points: Array) -> Array:
        """Points (n, 3) in the stage of points (n, 2) of an end face."""
        return self.frame.point(np.column_stack([np.full(len(points), side * self.half), points]))

    @cached_property
    def face(self) -> tuple[Array, Array]:
        """Points (n, 2) on a link's end face, with their shares of the area; rim points first."""
        end, result = self.end, []
        for piece in end.pieces(_ANGLES):
            low, high = piece.min(axis=0), piece.max(axis=0)
            points, weights = _face(*(0.5 * (high - low)).tolist(), is_round=end.is_axisymmetric)
            points = points + 0.5 * (low + high)
            inside = within_polygon(points, piece, 0.0)
            result.append((points[inside], weights[inside] * np.prod(high - low)))
        points, weights = (np.concatenate(each) for each in zip(*result, strict=True))
        return points, weights / np.sum(weights)

    @property
    def slack(self) -> float:
        """Largest distance of its pieces inside the form [m]."""
        return 0.0 if is_flat(self.form) else SAGITTA


@SESSION.keep(4)
def contact_findings(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Return errors of the outlines of a stage.

    Errors are link ends that miss the faces of their bodies, disconnected bodies, overlaps, and gauges that miss their targets. A stage
    without outlines has no outline errors. Imported shapes are listed as unchecked.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> contact_findings(parallelogram())
    ()
    """
    shown = with_drawn_parts(mechanism)
    assembly = expand(shown)
    things = _things(assembly)
    solids = _by_body(things.values())
    findings = [
        *_joint_findings(assembly, things, solids),
        *_body_findings(solids),
        *_clash_findings(things),
        *_gauge_findings(assembly, solids),
    ]
    return (*_alike(findings, assembly), *_unseen(things.values()))


@dataclass(frozen=True)
class Gap:
    """Two unconnected outlines and their distance [m]; negative for an overlap."""

    first: str
    second: str
    distance: float


def gaps(mechanism: Mechanism, within: float, moved: Mapping[str, Array] = MappingProxyType({})) -> tuple[Gap, ...]:
    """Return overlaps, and gaps of at most `within` [m], between unconnected outlines, for the first design of a batch.

    Two outlines form a pair if they belong to different bodies, to two links, or to a link and a body that the link does not join. Links
    that join the same body form no pair if this body has no outline. Round faces are approximated with an error of at most `SAGITTA`.
    Imported shapes are omitted.

    `moved` displaces bodies by twists (6,) [m, rad]: the translation and the rotation vector at the body's reference point. A link moves
    rigidly, by the mean of the twists of the bodies that it joins.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> gaps(parallelogram(), 1e-4)
    ()
    """
    pairs = _unconnected(mechanism, within, moved)
    found = (Gap(first.name, second.name, _apart(first, second, within)) for first, second in pairs)
    return tuple(each for each in found if each.distance <= within)


def least_gap(mechanism: Mechanism, moved: Mapping[str, Array] = MappingProxyType({})) -> Gap | None:
    """Return the smallest gap between unconnected outlines (see `gaps`); `None` if no pair is within a metre.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> least_gap(parallelogram()).distance > 1e-4
    True
    """
    for within in _REACHES:
        least: Gap | None = None
        for first, second in _unconnected(mechanism, within, moved):
            most = within if least is None else least.distance
            apart = _apart(first, second, most)
            least = Gap(first.name, second.name, apart) if apart < most else least
        if least is not None:
            return least
    return None


def _unconnected(mechanism: Mechanism, within: float, moved: Mapping[str, Array]) -> Iterator[tuple[_Thing, _Thing]]:
    """Pairs of unconnected outlines whose boxes are within a distance."""
    assembly = expand(with_drawn_parts(mechanism))
    things = {name: _displaced(thing, moved, assembly) if moved else thing for name, thing in _things(assembly).items()}
    yield from ((first, second) for first, second, meets in _strangers(things.values(), within) if not meets)


def _strangers(things: Iterable[_Thing], within: float) -> Iterator[tuple[_Thing, _Thing, bool]]:
    """Pairs of outlines of different bodies near one another, and whether they are links that may meet in a body without outlines."""
    seen = [thing for thing in things if not isinstance(thing.form, Imported)]
    drawn_bodies = {thing.bodies[0] for thing in seen if not thing.is_link}
    for one, other in near_pairs([thing.outline for thing in seen], within):
        first, second = seen[one], seen[other]
        common = {*first.bodies} & {*second.bodies}
        if not common or (first.is_link and second.is_link):
            yield first, second, bool(common - drawn_bodies)


def _apart(first: _Thing, second: _Thing, most: float) -> float:
    """Distance of two outlines [m], negative for an overlap; infinite if it is above `most`."""
    apart = _gap(first, second, most)
    deep = _overlap(first.pieces, second.pieces, [*first.holes, *second.holes])[0] if apart <= TOUCHING else 0.0
    return -deep if deep > TOUCHING else apart


def _displaced(thing: _Thing, moved: Mapping[str, Array], assembly: Assembly) -> _Thing:
    """The outline displaced by the mean of its bodies' twists at its centre; the ground does not move."""
    shift, turn = np.zeros(3), np.zeros(3)
    for body in thing.bodies:
        if body in moved:
            arm = thing.frame.position - first_design(np.real(assembly.bodies[body].reference), 1)
            shift += (moved[body][:3] + exponential(moved[body][3:]) @ arm - arm) / len(thing.bodies)
            turn += moved[body][3:] / len(thing.bodies)
    frame = Frame(exponential(turn) @ thing.frame.rotation, thing.frame.position + shift)
    return replace(thing, frame=frame, outline=replace(thing.outline, frame=frame))


def _things(assembly: Assembly) -> dict[str, _Thing]:
    result = {outline.name: outline for outline in outlines(assembly)}
    owned = [(body.name, body.solids) for body in assembly.bodies.values()] + [(GROUND, assembly.ground)]
    things: dict[str, _Thing] = {}
    for body, solids in owned:
        for name, placed in solids.items():
            things[name] = _Thing(name, placed.solid, _first(placed.frame), (body,), is_link=False, outline=result[name])
    for name, link in assembly.links.items():
        form = form_of(link.part)
        if form is not None:
            things[name] = _Thing(name, form, _first(link.frame), link.joins, is_link=True, outline=result[name])
    return things


def _first(frame: Frame) -> Frame:
    return Frame(first_design(np.real(frame.rotation), 2), first_design(np.real(frame.position), 1))


def _by_body(things: Iterable[_Thing]) -> dict[str, list[_Thing]]:
    bodies: dict[str, list[_Thing]] = {}
    for thing in things:
        if not thing.is_link:
            bodies.setdefault(thing.bodies[0], []).append(thing)
    return bodies


def _unseen(things: Iterable[_Thing]) -> Iterator[Finding]:
    names = [thing.name for thing in things if isinstance(thing.form, Imported)]
    if names:
        what = "contact and clearance of imported shapes not checked"
        yield Finding(", ".join(names), what, "Run `flexstage cad` to check them")


def _alike(findings: Sequence[Finding], assembly: Assembly) -> Iterator[Finding]:
    """Errors shared by instances of a unit, reported once."""
    copies = {name.partition("/")[0] for name in (*assembly.links, *assembly.bodies, *assembly.ground) if "/" in name}
    groups: dict[tuple[str, ...], list[Finding]] = {}
    for finding in findings:
        words = (finding.where, finding.what.partition(" around (")[0], finding.advice)
        mentioned = {copy for copy in copies if any(f"{copy}/" in word for word in words)}
        key = tuple(word.replace(f"{copy}/", "/") for word in words for copy in mentioned) if len(mentioned) == 1 else words
        groups.setdefault(key, []).append(finding)
    for first, *others in groups.values():
        names = dict.fromkeys(_other_name(first, other) for other in others)
        alike = f" (same for {', '.join(names)})" if others else ""
        yield Finding(first.where, f"{first.what}{alike}", first.advice)


def _other_name(first: Finding, other: Finding) -> str:
    """Difference of an error from the first similar one: its address, or the word that differs."""
    if first.where != other.where:
        return other.where
    return next(there.rstrip(",:") for here, there in zip(first.what.split(), other.what.split(), strict=False) if here != there)


# Joints


@dataclass(frozen=True, eq=False)
class _Meeting:
    """An end face against the outlines of a body: share of the face in contact, depth of penetration [m]."""

    share: float
    depth: float

    @property
    def sound(self) -> bool:
        return self.share >= 1.0 - _SHARE and self.depth == 0.0


def _joint_findings(assembly: Assembly, things: Mapping[str, _Thing], solids: Mapping[str, list[_Thing]]) -> Iterator[Finding]:
    for name, link in assembly.links.items():
        if name in things:
            ends = [(side, body, _obstacles(things[name], body, solids)) for side, body in zip((-1.0, 1.0), link.joins, strict=True)]
            yield from _link_findings(things[name], [end for end in ends if end[2]])


def _obstacles(link: _Thing, body: str, solids: Mapping[str, list[_Thing]]) -> list[_Thing]:
    """Outlines of a body that a link may touch; of the ground, those drawn with the link; none if one is imported."""
    own = [each for each in solids.get(body, []) if body != GROUND or _group(each.name) == _group(link.name)]
    return [] if any(isinstance(each.form, Imported) for each in own) else own


def _group(name: str) -> str:
    return name.rpartition("/")[0]


def _link_findings(link: _Thing, ends: Sequence[tuple[float, str, list[_Thing]]]) -> Iterator[Finding]:
    meetings = [_meeting(link, side, met) for side, _, met in ends]
    if not all(meeting.sound for meeting in meetings) and all(_meeting(link, -side, met).sound for side, _, met in ends):
        first, second = link.bodies
        what = f"it is drawn from {second} to {first}, but joins {first} to {second}"
        yield Finding(link.name, what, "Reverse `along`, or exchange the two bodies")
        return
    for (side, body, met), meeting in zip(ends, meetings, strict=True):
        yield from _end_findings(link, side, body, met, meeting)


def _meeting(link: _Thing, side: float, met: Sequence[_Thing]) -> _Meeting:
    """Contact of the end face on both sides, at points over its area."""
    points, weights = link.face
    axis = side * link.frame.rotation[:, 0]
    face = link.on_end(side, points)
    beyond, before = (np.any([_inside(each, face + step * axis) for each in met], axis=0) for step in (2.0 * TOUCHING, -2.0 * TOUCHING))
    depth = 0.0
    if float(weights @ before) > _SHARE:
        depth = _depth(met, face[before], -axis, 2.0 * link.half)
    return _Meeting(float(weights @ beyond), depth)


def _face(y: float, z: float, *, is_round: bool) -> tuple[Array, Array]:
    """Points on a rectangle or circle by its half sides, with shares of the area."""
    if is_round:
        radii = np.array([0.9995, 0.9, 0.7, 0.5, 0.3, 0.1])
        shares = np.array([0.0, 0.36, 0.28, 0.2, 0.12, 0.04])
        angles = 2.0 * np.pi * (np.arange(16) + 0.5) / 16
        points = np.array([(y * r * np.cos(a), y * r * np.sin(a)) for r, a in product(radii, angles)])
        return points, _widen(np.repeat(shares / 16.0, 16))
    stations = np.array([-0.9995, 0.9995, *(np.arange(10) - 4.5) / 5.0])
    shares = np.array([0.0, 0.0, *[0.1] * 10])
    points = np.array([(y * u, z * v) for u, v in product(stations, stations)])
    return points, _widen(np.array([a * b for a, b in product(shares, shares)]))


def _widen(weights: Array) -> Array:
    """Weights with rim points slightly above the tolerated share."""
    rim = weights == 0.0
    return np.where(rim, 1.5 * _SHARE, weights * (1.0 - 1.5 * _SHARE * np.count_nonzero(rim)))


def _inside(thing: _Thing, points: Array, slack: float = TOUCHING) -> Array:
    """Mask of points (n, 3) in a solid or the box of a link, or within `slack` [m] of it."""
    own = (points - thing.frame.position) @ thing.frame.rotation
    if isinstance(thing.form, Solid):
        return thing.form.contains(own, slack)
    return np.all(np.abs(own) <= 0.5 * first_design(np.real(thing.outline.size), 1) + slack, axis=1)


def _depth(met: Sequence[_Thing], face: Array, inward: Array, most: float) -> float:
    """Distance [m] along the link from points of an end face to the outside of all outlines, by bisection."""
    steps = np.linspace(0.0, most, 33)
    deep = [step for step in steps if any(np.any(_inside(each, face + step * inward, 0.0)) for each in met)]
    low = max(deep, default=0.0)
    high = min(most, low + steps[1])
    while high - low > 0.1 * TOUCHING:
        middle = 0.5 * (low + high)
        meets = any(np.any(_inside(each, face + middle * inward, 0.0)) for each in met)
        low, high = (middle, high) if meets else (low, middle)
    return low


def _end_findings(link: _Thing, side: float, body: str, met: Sequence[_Thing], meeting: _Meeting) -> Iterator[Finding]:
    if meeting.share == 0.0 and meeting.depth == 0.0:
        corners = link.on_end(side, link.end.outline(_ANGLES))
        gap = min(distance(corners, piece.points) for each in met for piece in each.pieces)
        if gap > TOUCHING:
            advice = f"Move or lengthen the link or the outline by {_text(gap)}"
            yield Finding(link.name, f"gap of {_text(gap)} between its end and {body}", advice)
            return
    if meeting.depth > 0.0:
        deep = _text(meeting.depth)
        advice = f"Trim the outline of {body} by {deep}, or move it: end faces must touch without overlap"
        yield Finding(link.name, f"it penetrates {body} by {deep}", advice)
    elif meeting.share < 1.0 - _SHARE:
        what = f"only about {100.0 * meeting.share:.2g} % of its end face lies on {body}"
        yield Finding(link.name, what, f"Widen or move the outline of {body}: it must support the whole end face")
    if meeting.sound:
        yield from _side_findings(link, body, met)


def _side_findings(link: _Thing, body: str, met: Sequence[_Thing]) -> Iterator[Finding]:
    margin = min(_MARGIN[0], _MARGIN[1] * link.half)
    size = first_design(np.real(link.outline.size), 1) - np.array([2.0 * margin, 0.0, 0.0])
    short = replace(link.outline, size=size)
    near = [met[other - 1] for one, other in near_pairs([short, *(each.outline for each in met)], 0.0) if one == 0]
    deep = max((_overlap(link.trim(margin), each.pieces, each.holes)[0] for each in near), default=0.0)
    if deep > TOUCHING:
        what = f"it penetrates {body} by {_text(deep)} outside its end face"
        yield Finding(link.name, what, f"Trim the outline of {body} near the link")


# Bodies


def _body_findings(solids: Mapping[str, list[_Thing]]) -> Iterator[Finding]:
    for body, things in solids.items():
        seen = [thing for thing in things if not isinstance(thing.form, Imported)]
        if body != GROUND and len(seen) == len(things) > 1:
            yield from _apart_findings(body, seen)


def _apart_findings(body: str, things: Sequence[_Thing]) -> Iterator[Finding]:
    groups = [{number} for number in range(len(things))]
    for one, other in near_pairs([thing.outline for thing in things], TOUCHING):
        here, there = (next(group for group in groups if number in group) for number in (one, other))
        if here is not there and _is_joined(things[one], things[other]):
            groups = [group for group in groups if group not in (here, there)] + [here | there]
    groups.sort(key=lambda group: (-len(group), min(group)))
    for group in groups[1:]:
        rest = [number for number in range(len(things)) if number not in group]
        gap, nearest = min((_gap(things[i], things[j]), j) for i in group for j in rest)
        names = ", ".join(things[number].name for number in sorted(group))
        if gap > TOUCHING:
            what = f"{names} is {_text(gap)} away from {things[nearest].name}: the body is disconnected"
            yield Finding(body, what, "Connect the outlines of one body over a face")
        else:
            what = f"{names} touches {things[nearest].name} only along an edge or at a point"
            yield Finding(body, what, "Connect them over a face, or let them overlap")


def _is_joined(first: _Thing, second: _Thing) -> bool:
    """Whether two solids overlap, or touch over a face: along an edge two directions separate them."""
    slack = TOUCHING + first.slack + second.slack
    for one, other in product(first.pieces, second.pieces):
        gap, _, next_gap = separation(one, other)
        if gap < -slack or (gap <= slack and next_gap < -slack):
            return True
    return False


def _gap(first: _Thing, second: _Thing, most: float = np.inf) -> float:
    """Least distance of two outlines [m], of their pieces from the nearest boxes on; infinite if it is above `most`."""
    (low, high), (lows, highs) = (np.array([piece.box for piece in each.pieces]).swapaxes(0, 1) for each in (first, second))
    apart = np.linalg.norm(np.maximum(0.0, np.maximum(lows - high[:, None], low[:, None] - highs)), axis=-1)
    least, found = most, np.inf
    for place in np.argsort(apart, axis=None):
        one, other = np.unravel_index(place, apart.shape)
        if apart[one, other] > least:
            break
        found = min(found, distance(first.pieces[one].points, second.pieces[other].points))
        least = min(least, found)
    return found


# Clashes


def _clash_findings(things: Mapping[str, _Thing]) -> Iterator[Finding]:
    for first, second, meets in _strangers(things.values(), TOUCHING):
        deep, around = _overlap(first.pieces, second.pieces, [*first.holes, *second.holes])
        if deep > TOUCHING:
            place = ", ".join(f"{round(1e3 * float(value), 2) + 0.0:g}" for value in around)
            yield Finding(first.name, f"it overlaps {second.name} by {_text(deep)} around ({place}) mm", _advice(first, second))
        elif deep >= -TOUCHING and not meets:
            yield Finding(first.name, f"it touches {second.name} without a joint", _advice(first, second))


def _overlap(first: Sequence[Convex], second: Sequence[Convex], holes: Sequence[PlacedSolid] = ()) -> tuple[float, Array]:
    """Depth of overlap of two sets of pieces [m] (negative: least distance), and its centre.

    A common volume within one of the `holes` is not an overlap.
    """
    deepest, around = -np.inf, np.zeros(3)
    for count, (one, other) in enumerate(_close(first, second)):
        if count > _ENOUGH and deepest > TOUCHING:
            break
        gap, _, _ = separation(one, other)
        if -gap > deepest and not (holes and -gap > -TOUCHING and _is_hollow(one, other, holes)):
            low, high = np.maximum(one.box[0], other.box[0]), np.minimum(one.box[1], other.box[1])
            deepest, around = -gap, 0.5 * (low + high)
    return deepest, around


def _is_hollow(one: Convex, other: Convex, holes: Sequence[PlacedSolid]) -> bool:
    """Whether the common volume of two pieces, enlarged by twice the contact tolerance, is within a hole."""
    sides, offsets = [], []
    for piece in (one, other):
        for normals in (piece.normals, -piece.normals):
            sides.append(normals)
            offsets.append(np.max(piece.points @ normals.T, axis=0) + 2.0 * TOUCHING)
    corners = polytope_corners(np.concatenate(sides), np.concatenate(offsets))
    inside = (hole.solid.contains((corners - hole.frame.position) @ hole.frame.rotation, SAGITTA) for hole in holes)
    return len(corners) > 0 and any(map(np.all, inside))


def _close(first: Sequence[Convex], second: Sequence[Convex]) -> Iterator[tuple[Convex, Convex]]:
    """Pairs of pieces whose boxes along the axes meet."""
    lows, highs = (np.array([piece.box[end] for piece in second]) for end in (0, 1))
    for piece in first:
        low, high = piece.box
        near = np.all((low <= highs + TOUCHING) & (high >= lows - TOUCHING), axis=1)
        yield from ((piece, other) for other, is_near in zip(second, near, strict=True) if is_near)


def _advice(first: _Thing, second: _Thing) -> str:
    if not first.is_link and not second.is_link and GROUND in {*first.bodies, *second.bodies}:
        return "Trim one of the two outlines"
    return "Trim or move one of the two outlines without moving the axis of a link"


# Gauges


def _gauge_findings(assembly: Assembly, solids: Mapping[str, list[_Thing]]) -> Iterator[Finding]:
    for name, gauge in assembly.gauges.items():
        seen = gauge.single
        things = solids.get(seen.body, []) if seen is not None and gauge.gauge.gap else []
        if seen is None or not things or any(isinstance(thing.form, Imported) for thing in things):
            continue
        frame = _first(seen.frame)
        points = np.concatenate([piece.points for thing in things for piece in thing.pieces])
        side = float(np.max(np.ptp(points, axis=0)))
        if any(_is_within(_BRACKET * side, frame.position, piece) for thing in things for piece in thing.pieces):
            continue
        beside = min(distance(frame.position[None], piece.points) for thing in things for piece in thing.pieces)
        if beside > _BRACKET * side:
            axis = frame.position + (beside + 2.0 * side) * np.outer([-1.0, 1.0], frame.rotation[:, 0])
            yield _off_target(name, seen.body, beside, min(distance(axis, piece.points) for thing in things for piece in thing.pieces))


def _is_within(reach: float, point: Array, piece: Convex) -> bool:
    """Fast test: whether the nearest face of a piece contains the foot of the perpendicular within a distance."""
    across, heights = piece.points @ piece.normals.T, piece.normals @ point
    low, high = across.min(axis=0), across.max(axis=0)
    beyond = heights - np.clip(heights, low, high)
    face = int(np.argmax(np.abs(beyond)))
    foot = piece.normals @ (point - beyond[face] * piece.normals[face])
    return bool(abs(beyond[face]) <= reach and np.all((foot >= low - TOUCHING) & (foot <= high + TOUCHING)))


def _off_target(name: str, body: str, beside: float, miss: float) -> Finding:
    passes = f"and its axis misses the outline by {_text(miss)}" if miss > TOUCHING else "along its axis"
    what = f"its measuring point is {_text(beside)} away from the outline of {body}, {passes}"
    return Finding(name, what, f"Move the gauge, add its target to the solids of {body}, or change its body")


def _text(length: float) -> str:
    return show(length, LENGTH, digits=3)
