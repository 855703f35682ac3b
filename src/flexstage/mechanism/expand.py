"""Expansion of a description into single bodies and links with frames in the stage's frame."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from typing import TypeAlias

import numpy as np

from flexstage.base.number import Array, Number, stack
from flexstage.mechanism.mechanism import GROUND, Link, Mechanism, Probe
from flexstage.mechanism.path import complete, replaced
from flexstage.mechanism.pattern import Facing, Pattern, Polar
from flexstage.parts.body import Body
from flexstage.parts.gauge import Gauge, Positive
from flexstage.parts.mass import MassProperties, mass_properties
from flexstage.parts.material import Material
from flexstage.parts.part import Part, is_actuator, material_of
from flexstage.spatial.frame import Frame, axes, identity, turn_z

_Copy: TypeAlias = tuple[str, str, Frame]
_LINK_FIELDS = frozenset(field.name for field in fields(Link))


@dataclass(frozen=True, eq=False)
class PlacedBody:
    """A body of the expanded stage: its frame, its reference point (..., 3) and its own mass properties, in the stage's frame."""

    name: str
    body: Body
    frame: Frame
    reference: Array
    mass: MassProperties | None


@dataclass(frozen=True, eq=False)
class PlacedLink:
    """A link of the expanded stage: bodies joined by name, the part with its departures applied, the link frame in the stage's frame.

    `drawn` is its address in the description (`horizontal/front`), `name` that of this copy (`B1/front`).
    """

    name: str
    drawn: str
    joins: tuple[str, str]
    link: Link
    part: Part
    material: Material | None
    frame: Frame


@dataclass(frozen=True, eq=False)
class PlacedGauge:
    """A gauge of the expanded stage: measuring point and direction in the stage's frame, sign of its reading along that direction."""

    name: str
    gauge: Gauge
    body: str
    base: str
    frame: Frame
    sign: float


@dataclass(frozen=True, eq=False)
class Assembly:
    """The expanded stage: every body, link and gauge by name. `actuators` maps input names to link names."""

    bodies: Mapping[str, PlacedBody]
    links: Mapping[str, PlacedLink]
    gauges: Mapping[str, PlacedGauge]
    actuators: Mapping[str, str]
    points: Mapping[str, tuple[str, Array]]


def copy_names(key: str) -> tuple[str, ...]:
    """The copies that a placement key names.

    >>> copy_names("B1-B3"), copy_names("top")
    (('B1', 'B2', 'B3'), ('top',))
    """
    match = re.fullmatch(r"(.*?)(\d+)-(?:\1)?(\d+)", key)
    if match is None:
        return (key,)
    stem, first, last = match[1], int(match[2]), int(match[3])
    return tuple(f"{stem}{number}" for number in range(first, last + 1))


def copy_frames(pattern: Pattern, count: int) -> tuple[Frame, ...]:
    """The frames of a pattern's copies in the stage's frame.

    >>> tangent = Polar(radius=0.1, first=0.0, facing=Facing.TANGENT)
    >>> copy_frames(tangent, 1)[0].direction(np.array([1.0, 0, 0])).round(9).tolist()
    [0.0, 1.0, 0.0]
    >>> upright = Polar(radius=0.1, first=0.0, facing=Facing.AXIS)
    >>> copy_frames(upright, 1)[0].rotation.T.tolist()  # x up, z inward, and y = z cross x
    [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    """
    if not isinstance(pattern, Polar):
        return (Frame(axes(pattern.along, pattern.up), stack(pattern.at)),) * count
    step = pattern.step if pattern.step is not None else 2.0 * np.pi / count
    return tuple(_polar_frame(pattern, pattern.first + number * step) for number in range(count))


def _polar_frame(pattern: Polar, angle: Number) -> Frame:
    position = stack((pattern.radius * np.cos(angle), pattern.radius * np.sin(angle), pattern.height))
    if pattern.facing is Facing.AXIS:
        upright = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
        return Frame(turn_z(angle + pattern.turn) @ upright, position)
    quarter = {Facing.OUTWARD: 0.0, Facing.TANGENT: 0.5 * np.pi, Facing.INWARD: np.pi}[pattern.facing]
    return Frame(turn_z(angle + quarter + pattern.turn), position)


def expand(mechanism: Mechanism) -> Assembly:
    """Expand a description: units copied by pattern, departures applied, frames in the stage's frame.

    The description must have passed its checks. Without platform reference the platform's twist is given at its own centre of mass.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(expand(double_triangle()).links)
    27
    """
    placed = tuple(copies(mechanism))
    links = {link.name: link for link in _links(mechanism, placed)}
    bodies = {name: _placed_body(name, drawn, frame, links) for name, drawn, frame in _bodies(mechanism, placed)}
    points = {
        (point if name == "platform" else f"{name}.{point}"): (name, body.frame.point(stack(at)))
        for name, body in bodies.items()
        for point, at in body.body.points.items()
    }
    return Assembly(bodies, links, dict(_gauges(mechanism)), _actuators(links), points)


def copies(mechanism: Mechanism) -> Iterator[tuple[str, str, Frame]]:
    """Yield (copy name, unit name, frame) of every placed unit.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [name for name, _, _ in copies(double_triangle())]
    ['B1', 'B2', 'B3', 'B4', 'B5', 'B6']
    """
    for key, placement in mechanism.place.items():
        names = copy_names(key)
        frames = copy_frames(placement.pattern, len(names))
        for name, frame in zip(names, frames, strict=True):
            yield name, placement.unit, frame


@dataclass(frozen=True, eq=False)
class _DrawnBody:
    """A body with its own mass properties, both in the frame it is drawn in."""

    body: Body
    mass: MassProperties | None


@dataclass(frozen=True, eq=False)
class _DrawnLink:
    """A link with its own address and frame in the frame it is drawn in."""

    address: str
    link: Link
    frame: Frame


def _bodies(mechanism: Mechanism, placed: tuple[_Copy, ...]) -> Iterator[tuple[str, _DrawnBody, Frame]]:
    for name, drawn in _drawn_bodies(mechanism, mechanism.bodies).items():
        yield name, drawn, identity()
    units = {name: _drawn_bodies(mechanism, unit.bodies) for name, unit in mechanism.units.items()}
    for copy, unit, frame in placed:
        for name, drawn in units[unit].items():
            yield f"{copy}/{name}", drawn, frame


def _drawn_bodies(mechanism: Mechanism, bodies: Mapping[str, Body]) -> dict[str, _DrawnBody]:
    return {name: _DrawnBody(body, mass_properties(body, mechanism.materials)) for name, body in bodies.items()}


def _links(mechanism: Mechanism, placed: tuple[_Copy, ...]) -> Iterator[PlacedLink]:
    for name, drawn in _drawn_links("links.", mechanism.links).items():
        yield _placed_link(mechanism, drawn, identity(), (name, drawn.link.joins))
    units = {name: _drawn_links(f"{name}/", unit.links) for name, unit in mechanism.units.items()}
    for copy, unit, frame in placed:
        own = mechanism.units[unit].bodies
        for name, drawn in units[unit].items():
            first, second = (f"{copy}/{body}" if body in own else body for body in drawn.link.joins)
            yield _placed_link(mechanism, drawn, frame, (f"{copy}/{name}", (first, second)))


def _drawn_links(owner: str, links: Mapping[str, Link]) -> dict[str, _DrawnLink]:
    return {name: _DrawnLink(f"{owner}{name}", link, _link_frame(link)) for name, link in links.items()}


def _link_frame(link: Link) -> Frame:
    return Frame(axes(link.along, link.bends), stack(link.at))


def _placed_link(mechanism: Mechanism, drawn: _DrawnLink, outer: Frame, names: tuple[str, tuple[str, str]]) -> PlacedLink:
    name, joins = names
    link, part = departed(mechanism, drawn.link, (drawn.address, name))
    material = material_of(part)
    frame = drawn.frame if link is drawn.link else _link_frame(link)
    return PlacedLink(name, drawn.address, joins, link, part, mechanism.materials[material] if material else None, frame.within(outer))


def departed(mechanism: Mechanism, link: Link, owners: tuple[str, ...]) -> tuple[Link, Part]:
    """A link and its part with the mechanism's `changes` for the owners' addresses applied, in the owners' order.

    >>> from dataclasses import replace
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = replace(double_triangle(), changes={"horizontal/front.thickness": 1.4e-3})
    >>> link = stage.units["horizontal"].links["front"]
    >>> departed(stage, link, ("horizontal/front", "B1/front"))[1].thickness
    0.0014
    """
    part = mechanism.parts[link.part]
    for owner in dict.fromkeys(owners):
        for address, value in mechanism.changes.items():
            if not address.startswith(f"{owner}."):
                continue
            path = tuple(address[len(owner) + 1 :].split("."))
            if path[0] in _LINK_FIELDS:
                link = replaced(link, complete(link, path), value)
            else:
                part = replaced(part, complete(part, path), value)
    return link, part


def _placed_body(name: str, drawn: _DrawnBody, frame: Frame, links: Mapping[str, PlacedLink]) -> PlacedBody:
    body, own = drawn.body, drawn.mass
    mass = None if own is None else MassProperties(own.mass, frame.point(own.centre), _turned(frame, own.inertia))
    if body.reference is not None:
        reference = frame.point(stack(body.reference))
    elif mass is not None:
        reference = mass.centre
    else:
        joints = [link.frame.position for link in links.values() if name in link.joins]
        reference = sum(joints, np.zeros(3)) / len(joints) if joints else frame.position
    return PlacedBody(name, body, frame, reference, mass)


def _turned(frame: Frame, inertia: Array) -> Array:
    return frame.rotation @ inertia @ np.swapaxes(frame.rotation, -1, -2)


def _actuators(links: Mapping[str, PlacedLink]) -> dict[str, str]:
    """Name an input after its unit's copy where that copy has one actuator only, else after the link."""
    drives = [name for name, link in links.items() if is_actuator(link.part)]
    owners = [name.rpartition("/")[0] for name in drives]
    return {(owner if owner and owners.count(owner) == 1 else name): name for owner, name in zip(owners, drives, strict=True)}


def _gauges(mechanism: Mechanism) -> Iterator[tuple[str, PlacedGauge]]:
    for key, probe in mechanism.gauges.items():
        names = copy_names(key)
        frames = copy_frames(probe.pattern, len(names))
        for name, frame in zip(names, frames, strict=True):
            yield name, _placed_gauge(mechanism, probe, name, frame)


def _placed_gauge(mechanism: Mechanism, probe: Probe, name: str, frame: Frame) -> PlacedGauge:
    sign = 1.0 if probe.positive is Positive.OPENS else -1.0
    return PlacedGauge(name, mechanism.sensors[probe.gauge], probe.body, probe.base or GROUND, frame, sign)
