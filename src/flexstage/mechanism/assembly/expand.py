"""Expansion of a description into single bodies and links with frames in the stage's frame."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, TypeAlias, TypeVar, cast

import numpy as np

from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array, Number, Table, Vector, stack
from flexstage.base.session import SESSION
from flexstage.mechanism.addresses.path import complete, has_member, replace_member
from flexstage.mechanism.assembly.likeness import drawn_units, link_lineage
from flexstage.mechanism.assembly.misalignment import MISALIGNED, misalign
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Normal, Pattern, Polar, Pose, copy_names
from flexstage.mechanism.assembly.sight import (
    PlacedGauge,
    PlacedStop,
    gauge_findings,
    link_names,
    place_stop,
    place_sum,
    sight,
    sight_of_link,
)
from flexstage.mechanism.mechanism import (
    GROUND,
    NAMED,
    PLATFORM,
    GaugePlace,
    GaugeSum,
    Link,
    LinkProbe,
    Mechanism,
    Probe,
    Stop,
    Unit,
    every_link,
    posed,
)
from flexstage.mechanism.references import references
from flexstage.parts.actuator import Actuator, ThrustActuator
from flexstage.parts.body import Body, PlacedSolid, owner_of, pierce
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.compound import FIRST, SECOND, Composition, Compound
from flexstage.parts.mass import MassProperties, combine, drawn_solids, mass_properties, union_properties, within
from flexstage.parts.material import Material, Paired
from flexstage.parts.part import Part, Restricted, actuator_of, counter_of, inner, is_actuator, material_of, ports_of
from flexstage.parts.superelement import Superelement
from flexstage.spatial.frame import Frame, axes, identity, reflection, turn_z

_Copy: TypeAlias = tuple[str, str, Frame]
_Value = TypeVar("_Value")
_EXAMPLES = {"at": '["1.54 mm", "1.54 mm", "1.54 mm"]', "along": '"x"'}
NO_IMAGE = ("the mirror image of its part is unknown", "Draw the other side in a separate unit, or mirror a unit without this part")
"""Error and hint for a mirrored link whose part has no known mirror image."""


@dataclass(frozen=True, eq=False)
class PlacedBody:
    """Body of the expanded stage with its frame, reference point (..., 3) and mass properties, in the stage's frame.

    `drawn` contains the body and all bodies that name this body in `of`. `mass` is the total mass of `drawn`, computed with `materials`.
    """

    name: str
    body: Body
    frame: Frame
    drawn: tuple[_DrawnBody, ...]
    links: tuple[PlacedLink | PlacedSuperelement, ...]
    materials: Mapping[str, Material]

    @cached_property
    def mass(self) -> MassProperties | None:
        """Mass properties of the body together with bodies that belong to it (`of`); `None` without any mass."""
        return _mass(self.drawn, self.materials)

    @cached_property
    def reference(self) -> Array:
        """Reference point (..., 3): as specified, else the centre of mass, else the centroid of the body's joints."""
        if self.body.reference is not None:
            return self.frame.point(stack(self.body.reference))
        if self.mass is not None:
            return self.mass.centre
        joints = [place for link in self.links for place in link.joints(self.name)]
        return sum(joints, np.zeros(3)) / len(joints) if joints else self.frame.position

    @cached_property
    def solids(self) -> Mapping[str, PlacedSolid]:
        """Outlines of the body, and of bodies that belong to it, by address (`platform.plate`, `B1/pad.lug`)."""
        return _placed_solids(self.drawn)


@dataclass(frozen=True, eq=False)
class PlacedLink:
    """Link of the expanded stage: joined bodies by name, part with overrides, link frame in the stage's frame.

    `name` is the address of this instance (`B1/front`). `drawn` is the address of the link in the description (`horizontal/front`). For a
    member of a compound (`B1/pivot.left`), `of` is the compound's link (`B1/pivot`).
    """

    name: str
    drawn: str
    joins: tuple[str, str]
    link: Link
    part: Part
    material: Material | None
    frame: Frame
    of: PlacedLink | None = None

    @property
    def described(self) -> PlacedLink:
        """Link as in the description: the link itself; for a member of a compound, the compound's link."""
        return self.of or self

    def joints(self, body: str) -> tuple[Array, ...]:
        """Return the positions (..., 3) of joints with a body: the link's centre, or none if the link does not join the body."""
        return (self.frame.position,) if body in self.joins else ()


@dataclass(frozen=True, eq=False)
class PlacedPort:
    """Port of a superelement: its body, and its frame in the stage's frame."""

    body: str
    frame: Frame


@dataclass(frozen=True, eq=False)
class PlacedSuperelement:
    """Superelement of the expanded stage: its part, the part's frame in the stage's frame, and its ports in file order."""

    name: str
    drawn: str
    link: Link
    part: Superelement
    frame: Frame
    ports: Mapping[str, PlacedPort]

    @property
    def joins(self) -> tuple[str, ...]:
        """Names of the joined bodies, one per port."""
        return tuple(port.body for port in self.ports.values())

    def joints(self, body: str) -> tuple[Array, ...]:
        """Return the positions (..., 3) of the joints with a body: the ports at this body."""
        return tuple(port.frame.position for port in self.ports.values() if port.body == body)

    def welds(self) -> Iterator[PlacedLink]:
        """Yield joints from the body of the first port to the body of each other port, for the ideal model.

        A joint is rigid, except for degrees of freedom that a link with two ports specifies as free. A further port on the body of the
        first port gets no joint.
        """
        first, *others = self.ports
        free = self.link.free or ()
        for name in others:
            port = self.ports[name]
            frame = self.frame if free else port.frame
            if port.body != self.ports[first].body:
                joins = (self.ports[first].body, port.body)
                yield PlacedLink(f"{self.name}.{name}", self.drawn, joins, self.link, Joint(free), None, frame)


@dataclass(frozen=True, eq=False)
class Assembly:
    """Expanded stage: all moving bodies, links and gauges by name. `actuators` maps input names to link names.

    If a circuit connects several force actuators, `actuators` contains the first link of the circuit. `circuits` maps every actuator's link
    to its input and sign. `strokes` are the stroke actuators, `thrusts` the force actuators. Links of parts with ports are in
    `superelements` instead of `links`, because they join any number of bodies. `bodies` omits bodies that belong to another body (`of`),
    because their solids belong to that body. Solids of the ground are in `ground`.
    """

    bodies: Mapping[str, PlacedBody]
    links: Mapping[str, PlacedLink]
    gauges: Mapping[str, PlacedGauge]
    actuators: Mapping[str, str]
    points: Mapping[str, tuple[str, Array]]
    ground: Mapping[str, PlacedSolid]
    superelements: Mapping[str, PlacedSuperelement] = field(default_factory=lambda: Table({}))
    stops: Mapping[str, PlacedStop] = field(default_factory=lambda: Table({}))
    circuits: Mapping[str, tuple[str, float]] = field(default_factory=lambda: Table({}))

    @property
    def welded(self) -> Assembly:
        """The stage with rigid joints instead of superelements (see `PlacedSuperelement.welds`)."""
        welds = {weld.name: weld for item in self.superelements.values() for weld in item.welds()}
        return replace(self, links={**self.links, **welds}, superelements=Table({})) if self.superelements else self

    def actuator(self, name: str) -> Actuator:
        """Return the actuator of an input; for a circuit, the equivalent of its actuators in series."""
        part = actuator_of(self.links[self.actuators[name]].part)
        count = sum(owner == name for owner, _ in self.circuits.values())
        return part.in_series(count) if count > 1 and isinstance(part, ThrustActuator) else part

    @cached_property
    def strokes(self) -> Mapping[str, str]:
        """Link names of the stroke actuators, by input name."""
        return {name: link for name, link in self.actuators.items() if self.actuator(name).takes_stroke}

    @cached_property
    def thrusts(self) -> Mapping[str, str]:
        """Link names of the force actuators, by input name; for a circuit, the first link."""
        return {name: link for name, link in self.actuators.items() if not self.actuator(name).takes_stroke}

    @cached_property
    def pushes(self) -> Mapping[str, tuple[str, Array]]:
        """Input name, and wrench (..., 6) per unit of this input, by link of a force actuator; the polarity in a circuit sets the sign."""
        known = {link: each for link, each in self.circuits.items() if each[0] in self.thrusts}
        return {link: (name, sign * actuator_of(self.links[link].part).wrench) for link, (name, sign) in known.items()}


def copy_frames(pattern: Pattern, count: int) -> tuple[Frame, ...]:
    """Compute the frames of a pattern's instances in the stage's frame.

    >>> tangent = Polar(radius=0.1, first=0.0, facing=InstanceOrientation.TANGENT)
    >>> copy_frames(tangent, 1)[0].direction(np.array([1.0, 0, 0])).round(9).tolist()
    [0.0, 1.0, 0.0]
    >>> upright = Polar(radius=0.1, first=0.0, facing=InstanceOrientation.AXIS)
    >>> copy_frames(upright, 1)[0].rotation.T.tolist()  # x up, z inward, and y = z cross x
    [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    """
    if not isinstance(pattern, Polar):
        return (_reflect(Frame(axes(pattern.direction, _upright(pattern)), stack(pattern.origin)), pattern.mirror),) * count
    step = pattern.step if pattern.step is not None else 2.0 * np.pi / count
    return tuple(_reflect(_polar_frame(pattern, pattern.first + number * step), pattern.mirror) for number in range(count))


def patterned(entries: Mapping[str, Any]) -> Iterator[tuple[str, Any, Frame]]:
    """Yield name, entry and frame of every instance placed by patterns.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [name for name, _, _ in patterned(double_triangle().gauges)][:3]
    ['S1', 'S2', 'S3']
    """
    for key, item in entries.items():
        names = copy_names(key)
        for name, frame in zip(names, copy_frames(item.pattern, len(names)), strict=True):
            yield name, item, frame


def _upright(pose: Pose) -> Vector | None:
    """Direction of a pose's z axis; any if the default, z, is along x: the gauge is axisymmetric."""
    x, y, z = (np.max(np.abs(np.real(component))) for component in pose.direction)
    return None if pose.up == Pose().up and max(x, y) <= 1e-3 * z else pose.up


def _reflect(frame: Frame, mirror: Normal | None) -> Frame:
    """The frame, or its mirror image in the stage's plane with that normal."""
    return frame if mirror is None else frame.within(reflection("xyz".index(mirror.value)))


def _polar_frame(pattern: Polar, angle: Number) -> Frame:
    position = stack((pattern.radius * np.cos(angle), pattern.radius * np.sin(angle), pattern.height))
    if pattern.facing is InstanceOrientation.AXIS:
        upright = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
        return Frame(turn_z(angle + pattern.turn) @ upright, position)
    quarter = {InstanceOrientation.OUTWARD: 0.0, InstanceOrientation.TANGENT: 0.5 * np.pi, InstanceOrientation.INWARD: np.pi}[
        pattern.facing
    ]
    return Frame(turn_z(angle + quarter + pattern.turn), position)


def expand(mechanism: Mechanism) -> Assembly:
    """Expand a description into bodies and links: place units by pattern, apply overrides, transform frames to the stage's frame.

    The description must have passed its checks. A platform without a specified reference point has its centre of mass as reference point.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(expand(double_triangle()).links)
    27
    """
    assembly = lay_out(mechanism)
    for body in assembly.bodies.values():
        _ = [item.own for item in body.drawn], body.reference, body.mass  # refuses unknown masses
    return assembly


def lay_out(mechanism: Mechanism) -> Assembly:
    """Expand a description as `expand` does; mass properties are computed only on first use.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(lay_out(double_triangle()).bodies)
    19
    """
    return _assembly(IdentityKey(mechanism))


class IdentityKey:
    """Cache key that identifies a description by object identity: equal descriptions may have their tables in another order."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism

    def __hash__(self) -> int:
        return id(self.mechanism)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, IdentityKey) and self.mechanism is other.mechanism


@SESSION.keep(2)
def _assembly(key: IdentityKey) -> Assembly:
    """The assembly, cached by description."""
    mechanism = key.mechanism
    require([*place_findings(mechanism), *unknown_names(mechanism), *compound_findings(mechanism)])
    placed = tuple(copies(mechanism))
    described = tuple(_links(mechanism, placed))
    elements = {link.name: link for link in described if isinstance(link, PlacedSuperelement)}
    compositions = {id(link.part): link.part.composition for link in described if isinstance(link.part, Compound)}
    wholes = (whole for whole in described if isinstance(whole, PlacedLink))
    links = {link.name: link for whole in wholes for link in _members(mechanism, whole, compositions.get(id(whole.part)))}
    drawn = (*_bodies(mechanism, placed), *_inner_bodies(mechanism, described, compositions))
    joined = (*links.values(), *elements.values())
    lent = [item for item in drawn if item.body.of is not None]
    bodies = {
        item.name: PlacedBody(
            item.name,
            item.body,
            item.frame,
            (item, *(each for each in lent if each.body.of == item.name)),
            joined,
            mechanism.materials,
        )
        for item in drawn
        if item.body.of is None
    }
    gauges = {f"gauges.{name}": probe for name, probe in posed(mechanism.gauges).items()}
    require(_unknown_bodies(bodies, joined, gauges | {f"stops.{name}": stop for name, stop in mechanism.stops.items()}))
    resting = [item for item in lent if item.body.of == GROUND]
    _ = [item.own for item in resting]  # their mass is unused, but an unknown one is refused
    ground = _placed_solids(resting)
    circuits = _circuits(links, {copy for copy, _, _ in placed})
    drives: dict[str, str] = {}
    for link, (name, _) in circuits.items():
        drives.setdefault(name, link)
    return Assembly(
        bodies,
        links,
        _gauges(mechanism, links),
        drives,
        dict(_points(drawn)),
        ground,
        elements,
        {name: place_stop(stop, frame.right_handed) for name, stop, frame in patterned(mechanism.stops)},
        circuits,
    )


def place_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors for links without a position, or with two positions.

    >>> print(*place_findings(Mechanism("", links={"strut": Link(("ground", "platform"), "wire", end=(0.0, 0.0, 0.1))})))
    links.strut: from missing. Specify both from and to, or at and along.
    """
    for where, link in every_link(mechanism):
        ends, place = {"from": link.start, "to": link.end}, {"at": link.at, "along": link.along}
        stated = [name for name, value in {**place, **ends}.items() if value is not None]
        if {"from", "to"} & set(stated) and {"at", "along"} & set(stated):
            yield Finding(where, f"both {' and '.join(stated)} specified", "Specify either the ends (from, to) or the position (at, along)")
            continue
        wanted = place if link.start is None and link.end is None else ends
        for name in [name for name, value in wanted.items() if value is None]:
            advice = "Specify both from and to, or at and along" if wanted is ends else f"Use e.g. {name} = {_EXAMPLES[name]}"
            yield Finding(where, f"{name} missing", advice)


def unknown_names(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors for unknown parts, materials, units and sensors, and for wrong ports of links.

    >>> print(*unknown_names(Mechanism("", links={"strut": Link(("ground", "platform"), "wire")})))
    links.strut.part: unknown part "wire". None is defined.
    """
    parts = mechanism.parts
    yield from unknown_entries({section: getattr(mechanism, section) for section in NAMED})
    for where, link in every_link(mechanism):
        yield from _port_findings(where, link, parts) if link.part in parts else ()


def unknown_entries(sections: Mapping[str, Any]) -> Iterator[Finding]:
    """Yield errors for names of materials, parts, units and sensors that do not exist.

    `sections` are the sections of a description or of a file's tree.

    >>> print(*unknown_entries({"parts": {"leaf": {"material": "stel"}}, "materials": {"steel": {}}}))
    parts.leaf.material: unknown material "stel". Use steel.
    """
    for section in ("parts", "bodies", "links", "units", "placements", "gauges"):
        for where, home, name in references(sections.get(section, {}), section):
            known = sections.get(home, {})
            if name not in known:
                yield Finding(where, f'unknown {home.removesuffix("s")} "{name}"', suggest_nearest(name, known))


def _port_findings(where: str, link: Link, parts: Mapping[str, Part]) -> Iterator[Finding]:
    """Errors in the bodies of a link: one per port of its part, or two without ports."""
    ports, known = ports_of(parts[link.part]), isinstance(link.joins, Mapping)
    example = ", ".join(f'{name} = "{body}"' for name, body in zip(ports, itertools.cycle((GROUND, PLATFORM)), strict=False))
    if known and not ports:
        yield Finding(f"{where}.joins", f'part "{link.part}" has no ports', f'Use two bodies: joins = ["{GROUND}", "{PLATFORM}"]')
    elif ports and (not known or set(link.joins) != set(ports)):
        found = f"got {', '.join(link.joins)}" if known else "got no ports"
        yield Finding(
            f"{where}.joins", f'wrong ports ({found}, expected {", ".join(ports)} of part "{link.part}")', f"Use joins = {{ {example} }}"
        )
    if ports and isinstance(parts[link.part], Restricted):
        what = f'part "{link.part}" restricts a part with ports (six degrees of freedom per port)'
        yield Finding(f"{where}.part", what, "Use the part directly")
    if ports and link.free and len(ports) > 2:
        what = f'free requires two ports (part "{link.part}" has {len(ports)})'
        yield Finding(f"{where}.free", what, "Remove this key: the part is rigid in the ideal model")


def _unknown_bodies(
    bodies: Mapping[str, PlacedBody], links: Iterable[PlacedLink | PlacedSuperelement], looking: Mapping[str, Probe | Stop]
) -> Iterator[Finding]:
    known = dict.fromkeys((*bodies, GROUND))
    ends = [(f"{link.name}.joins", body) for link in links for body in link.joins]
    ends += [(where, body) for where, item in looking.items() for body in (item.body, item.base or GROUND)]
    yield from (Finding(where, f'unknown body "{body}"', suggest_nearest(body, known)) for where, body in ends if body not in known)


def copies(mechanism: Mechanism) -> Iterator[tuple[str, str, Frame]]:
    """Yield (instance name, unit name, frame) of every placed unit.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [name for name, _, _ in copies(double_triangle())]
    ['B1', 'B2', 'B3', 'B4', 'B5', 'B6']
    """
    for name, placement, frame in patterned(mechanism.placements):
        yield name, placement.unit, misalign(frame, mechanism.overrides, name)


def unit_of_copy(mechanism: Mechanism) -> dict[str, str]:
    """Return the name of the unit for every instance name.

    >>> unit_of_copy(Mechanism(""))
    {}
    """
    return {copy: placement.unit for key, placement in mechanism.placements.items() for copy in copy_names(key)}


def placed_bodies(mechanism: Mechanism) -> dict[str, Body]:
    """Return every body by the name used in links, gauges and loads: bodies of the stage, and `instance/body` of placed units.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> list(placed_bodies(double_triangle()))[:3]
    ['platform', 'B1/base', 'B1/tip']
    """
    drawn = drawn_units(mechanism)
    placed = [(copy, drawn[unit].bodies) for copy, unit in unit_of_copy(mechanism).items() if unit in drawn]
    return dict(mechanism.bodies) | {f"{copy}/{name}": body for copy, bodies in placed for name, body in bodies.items()}


def placed_links(mechanism: Mechanism) -> Iterator[tuple[str, Link, tuple[str, ...]]]:
    """Yield name, link, and bodies at its ends or ports, of every link of the stage and of placed units.

    A body with `of` is replaced by its owner.

    >>> strut = Link(("pad", "platform"), "wire", at=(0.0, 0.0, 0.0), along=(1.0, 0.0, 0.0))
    >>> [joins for _, _, joins in placed_links(Mechanism("", bodies={"pad": Body(of="ground")}, links={"strut": strut}))]
    [('ground', 'platform')]
    """
    bodies, units = placed_bodies(mechanism), drawn_units(mechanism)
    for name, link in mechanism.links.items():
        yield name, link, tuple(owner_of(bodies, body) for body in link.bodies)
    for copy, unit in unit_of_copy(mechanism).items():
        drawn = units.get(unit, Unit())
        for name, link in drawn.links.items():
            ends = (f"{copy}/{body}" if body in drawn.bodies else body for body in link.bodies)
            yield f"{copy}/{name}", link, tuple(owner_of(bodies, body) for body in ends)


@dataclass(frozen=True, eq=False)
class _DrawnBody:
    """Body drawn under the name `source`, in the frame of this instance; `aligned` is that frame without misalignment."""

    name: str
    body: Body
    materials: Mapping[str, Material]
    source: str
    frame: Frame
    aligned: Frame

    @property
    def own(self) -> MassProperties | None:
        """Mass properties in the drawing frame, shared by all instances; `None` without any."""
        return mass_properties(self.body, self.materials, self.source)

    def mass(self) -> MassProperties | None:
        """Mass properties in the stage's frame."""
        return None if self.own is None else within(self.own, self.frame)

    def solids(self) -> Iterator[tuple[str, PlacedSolid]]:
        """Outlines by address, in the stage's frame."""
        for name, solid in self.body.solids.items():
            frame = solid.frame.within(self.frame)
            yield f"{self.name}.{name}", PlacedSolid(solid.mirrored if frame.mirrored else solid, frame.right_handed)


def _placed_solids(drawn: Iterable[_DrawnBody]) -> dict[str, PlacedSolid]:
    """Outlines of a body, without holes."""
    return pierce(dict(solid for item in drawn for solid in item.solids()))


def _bodies(mechanism: Mechanism, placed: tuple[_Copy, ...]) -> Iterator[_DrawnBody]:
    materials, drawn = mechanism.materials, drawn_units(mechanism)
    for name, body in mechanism.bodies.items():
        yield _DrawnBody(name, body, materials, name, identity(), identity())
    meant = {copy: frame for copy, _, frame in copies(replace(mechanism, overrides=Table({})))} if mechanism.overrides else {}
    for copy, unit, frame in placed:
        for name, body in drawn[unit].bodies.items():
            yield _DrawnBody(f"{copy}/{name}", body, materials, f"{unit}/{name}", frame, meant.get(copy, frame))


def _points(drawn: tuple[_DrawnBody, ...]) -> Iterator[tuple[str, tuple[str, Array]]]:
    """Named points with their moving bodies, without those of the ground."""
    for item in drawn:
        owner = item.body.of or item.name
        for point, at in item.body.points.items():
            if owner != GROUND:
                yield point if item.name == PLATFORM else f"{item.name}.{point}", (owner, item.frame.point(stack(at)))


def _links(mechanism: Mechanism, placed: tuple[_Copy, ...]) -> Iterator[PlacedLink | PlacedSuperelement]:
    """Links in the stage's frame; `owners` are the addresses of overrides by rising precedence."""
    units = drawn_units(mechanism)
    frames = {id(link): _own_frame(link) for item in (mechanism, *units.values()) for link in item.links.values()}
    lineages = {(unit, own): link_lineage(mechanism, unit, own) for unit, item in units.items() for own in item.links}
    places = {f"{copy}/{own}": (unit, own, frame) for copy, unit, frame in placed for own in units[unit].links}
    for name, drawn, joins in placed_links(mechanism):
        owners, outer = (f"links.{name}",), identity()
        if name in places:
            unit, own, outer = places[name]
            owners = tuple(f"{owner}/{own}" for owner in lineages[unit, own])
        link, part = apply_overrides(mechanism, drawn, (*owners, name))
        frame = (frames.get(id(link)) or _own_frame(link)).within(outer)
        if ports_of(part):
            whole = cast("Superelement", inner(part))
            whole, frame = (whole.mirrored, frame.right_handed) if frame.mirrored else (whole, frame)
            yield PlacedSuperelement(name, owners[-1], link, whole, frame, _placed_ports(whole, frame, link.joins, joins))
        else:
            yield PlacedLink(name, owners[-1], (joins[0], joins[1]), link, part, _seen_from(mechanism, part, frame), frame)


def _own_frame(link: Link) -> Frame:
    """Frame of a link in the frame of its unit."""
    return Frame(axes(link.direction, link.bends), stack(link.centre))


def compound_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors for restricted compounds, and for links of compounds that specify degrees of freedom or two ends.

    >>> list(compound_findings(Mechanism("")))
    []
    """
    advice = "Draw the members as separate links, and specify free for these"
    compounds = {name for name, part in mechanism.parts.items() if isinstance(inner(part), Compound)}
    for name in sorted(compounds):
        if isinstance(mechanism.parts[name], Restricted):
            yield Finding(f"parts.{name}", "a compound part cannot be restricted", "Draw its members as separate links, and restrict these")
    for where, link in every_link(mechanism):
        if link.free is not None and link.part in compounds:
            yield Finding(f"{where}.free", f"part {link.part} is a compound: only its members have degrees of freedom", advice)
        if (link.start is not None or link.end is not None) and link.part in compounds:
            place = "Specify the origin (at) and the direction (along)"
            yield Finding(f"{where}.from", f"part {link.part} is a compound: only its members have two ends", place)


def _members(mechanism: Mechanism, whole: PlacedLink, composition: Composition | None) -> Iterator[PlacedLink]:
    """Expanded links of one in the description: its members, else itself."""
    if composition is None:
        yield _image(whole)
        return
    ends = {FIRST: whole.joins[0], SECOND: whole.joins[1]}
    for name, member in composition.members.items():
        first, second = (ends.get(body) or f"{whole.name}.{body}" for body in member.joins)
        frame = Frame(axes(member.along, member.bends), stack(member.at)).within(whole.frame)
        link = PlacedLink(
            f"{whole.name}.{name}",
            f"{whole.drawn}.{name}",
            (first, second),
            replace(whole.link, joins=(first, second)),
            member.part,
            _seen_from(mechanism, member.part, frame),
            frame,
            whole,
        )
        yield _image(link)


def _inner_bodies(
    mechanism: Mechanism, links: Iterable[PlacedLink | PlacedSuperelement], compositions: Mapping[int, Composition]
) -> Iterator[_DrawnBody]:
    """Bodies within compounds."""
    for whole in links:
        if (composition := compositions.get(id(whole.part))) is not None:
            for name, body in composition.bodies.items():
                own = f"{whole.name}.{name}"
                yield _DrawnBody(own, body, mechanism.materials, own, whole.frame, whole.frame)


def _seen_from(mechanism: Mechanism, part: Part, frame: Frame) -> Material | None:
    """Material of a part in the part's axes (crystals), or with that of its seat (contacts)."""
    name, counter = material_of(part), counter_of(part)
    if not name:
        return None
    own = mechanism.materials[name].oriented(frame.rotation)
    return Paired.of(own, mechanism.materials[counter]) if counter else own


def _placed_ports(part: Superelement, outer: Frame, names: Iterable[str], ends: Sequence[str]) -> dict[str, PlacedPort]:
    bodies = dict(zip(names, ends, strict=True))
    frames = {name: Frame(axes(port.along, port.up), stack(port.at)) for name, port in part.ports.items()}
    return {name: PlacedPort(bodies[name], frames[name].within(outer)) for name in part.order}


def _image(link: PlacedLink) -> PlacedLink:
    """The link in a right-handed frame, with the part's mirror image in a mirrored instance."""
    if not link.frame.mirrored:
        return link
    part = link.part.mirrored
    if part is None:
        raise refuse(link.name, *NO_IMAGE)
    return replace(link, part=part, frame=link.frame.right_handed)


def apply_overrides(mechanism: Mechanism, link: Link, owners: tuple[str, ...]) -> tuple[Link, Part]:
    """Apply the `overrides` of several addresses, `owners`, to a link and its part, in the order of `owners`.

    >>> from dataclasses import replace
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = replace(double_triangle(), overrides={"horizontal/front.thickness": 1.4e-3})
    >>> link = stage.units["horizontal"].links["front"]
    >>> apply_overrides(stage, link, ("horizontal/front", "B1/front"))[1].thickness
    0.0014
    """
    part = mechanism.parts[link.part]
    for owner in dict.fromkeys(owners):
        for address, value in mechanism.overrides.items():
            if not address.startswith(f"{owner}."):
                continue
            path = tuple(address[len(owner) + 1 :].split("."))
            if path[0] in MISALIGNED:  # of a gauge that has a link's name
                continue
            if has_member(link, path[0]):
                link = replace_member(link, complete(link, path), value)
            else:
                part = replace_member(part, complete(part, path), value)
    return link, part


def _mass(drawn: tuple[_DrawnBody, ...], materials: Mapping[str, Material]) -> MassProperties | None:
    """Mass of a body and of bodies lent to it; overlaps are determined without misalignment.

    A misalignment of a lug by a few micrometres changes no mass. A specified mass applies regardless of outlines.
    """
    weighed = [item for item in drawn if item.body.mass is None and item.body.solids]
    single = [item for item in drawn if item.body.mass is not None or len(weighed) == 1]
    masses = [mass for item in single if (mass := item.mass()) is not None]
    if len(weighed) > 1:
        actual, meant = (
            [solid for item in weighed for solid in drawn_solids(item.body, materials, item.name, frame(item))]
            for frame in (lambda item: item.frame, lambda item: item.aligned)
        )
        masses.append(union_properties(actual, meant))
    return combine(masses) if masses else None


def _circuits(links: Mapping[str, PlacedLink], copies: Collection[str]) -> dict[str, tuple[str, float]]:
    """Input and sign of every actuator: its circuit, else its unit's copy where that has one actuator only, else its link."""
    drives = [name for name, link in links.items() if is_actuator(link.part)]
    owners = [name.rpartition("/")[0] for name in drives]
    own = ((owner if owner in copies and owners.count(owner) == 1 else name) for owner, name in zip(owners, drives, strict=True))
    named = {name: links[name].link.circuit or usual for name, usual in zip(drives, own, strict=True)}
    return {name: (text.removeprefix("-"), -1.0 if text.startswith("-") else 1.0) for name, text in named.items()}


def _gauges(mechanism: Mechanism, links: Mapping[str, PlacedLink]) -> dict[str, PlacedGauge]:
    """Gauges in the description's order; sums of placed gauges."""
    require(gauge_findings(mechanism, links))
    single = {item.name: item for key, place in mechanism.gauges.items() for item in _single_gauges(mechanism, links, key, place)}
    formed = {name: place for name, place in mechanism.gauges.items() if isinstance(place, GaugeSum)}
    sums = {name: place_sum(name, place, mechanism.gauges, single) for name, place in formed.items()}
    return {name: sums[name] if name in sums else single[name] for key in mechanism.gauges for name in copy_names(key)}


def _single_gauges(mechanism: Mechanism, links: Mapping[str, PlacedLink], key: str, place: GaugePlace) -> Iterator[PlacedGauge]:
    if isinstance(place, Probe):
        gauge = mechanism.sensors[place.gauge]
        for name, _, frame in patterned({key: place}):
            yield PlacedGauge(name, gauge, (sight(place, gauge, misalign(frame, mechanism.overrides, name).right_handed),))
    elif isinstance(place, LinkProbe):
        gauge = mechanism.sensors[place.gauge]
        for name, link in zip(copy_names(key), (links[each] for each in link_names(place.link)), strict=True):
            yield PlacedGauge(name, gauge, (sight_of_link(*link.joins, link.frame, link.part, gauge),))


def by_part(links: Mapping[str, PlacedLink], function: Callable[[Part, Material | None], _Value]) -> dict[str, _Value]:
    """Compute a value for every link, once for each part and material.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> by_part(expand(parallelogram()).links, lambda part, _: part.kind)["left"]
    'leaf'
    """
    keys = {name: (id(link.part), id(link.material)) for name, link in links.items()}
    distinct = {keys[name]: link for name, link in links.items()}
    values = {key: function(link.part, link.material) for key, link in distinct.items()}
    return {name: values[key] for name, key in keys.items()}
