"""The scene of a stage: surfaces of its bodies, links, ground and gauges, and labels."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, first_design
from flexstage.mechanism.assembly.expand import Assembly, PlacedBody, PlacedLink, PlacedSuperelement, expand
from flexstage.mechanism.assembly.sight import Sight
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.parts.body import PlacedSolid
from flexstage.parts.part import is_actuator
from flexstage.show.scene.primitives import first_frame, part_length, part_section, part_skin, solid_skin
from flexstage.show.scene.skin import ROUND, DrawnSurface, Kind, circle, extrude, join, line, loft, rectangle
from flexstage.spatial.frame import Frame, axes

_MARKER = 0.02
_BAR = 0.009
_ARROW = 0.11
_GROUNDED = (GROUND, GROUND)


@dataclass(frozen=True)
class Label:
    """A name at a point of the stage [m], in the colour of its kind. The name moves with the mean motion of two `bodies`."""

    text: str
    point: tuple[float, float, float]
    kind: Kind
    bodies: tuple[str, str] = _GROUNDED


@dataclass(frozen=True, eq=False)
class DrawnPiece:
    """A surface in the stage's frame, its name (`B1/front`, `platform.plate`) and kind, and the two bodies with which it moves."""

    name: str
    kind: Kind
    bodies: tuple[str, str]
    skin: DrawnSurface


@dataclass(frozen=True, eq=False)
class Scene:
    """Pieces and labels in the stage's frame [m]; `size` is the diagonal of the bounding box.

    `references` contains, for each body, the point (3,) [m] at which the body's twist is given.
    """

    pieces: tuple[DrawnPiece, ...]
    labels: tuple[Label, ...]
    references: dict[str, Array]
    size: float


def scene(mechanism: Mechanism, *, steps: int = 1) -> Scene:
    """Build the scene of the first design of a description. Hinges are divided into `steps` along their length, to show bending.

    Bodies without outlines, and superelements, are drawn as bars between their joints or ports. If a joint is outside the outline of its
    body, a thin line connects the joint and the outline. The ground is drawn at each link that is fixed to it.

    >>> scene(Mechanism("", bodies={})).pieces
    ()
    """
    assembly = expand(mechanism)
    ends = {name: _ends(link) for name, link in assembly.links.items()}
    joints = _joints(assembly, ends)
    size = _span(np.array([point for points in joints.values() for point in points]).reshape(-1, 3))
    pieces = [piece for body in assembly.bodies.values() for piece in _body(body, joints.get(body.name, []), size)]
    pieces += _solids(assembly.ground, Kind.GROUND, GROUND)
    size = max(size, _span(np.concatenate([piece.skin.points for piece in pieces]))) if pieces else size
    parts = {
        id(link.part): part_skin(link.part, _MARKER * size, steps=1 if is_actuator(link.part) else steps)
        for link in assembly.links.values()
    }
    pieces += [piece for name, link in assembly.links.items() for piece in _link(link, parts[id(link.part)], ends[name], size)]
    pieces += [piece for element in assembly.superelements.values() for piece in _superelement(element, size)]
    pieces += [_gauge(name, sight, size) for name, sight in _sights(assembly)]
    references = {name: first_design(np.real(body.reference), 1) for name, body in assembly.bodies.items()}
    return Scene(tuple(pieces), tuple(_labels(assembly, size)), references, size)


def _span(points: Array) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0))) or 1.0 if len(points) else 1.0


_Ends = tuple[Array, Array]
"""End points of a link at its first and its second body, by the convention that x goes from the first to the second."""


def _ends(link: PlacedLink) -> _Ends:
    frame = first_frame(link.frame)
    half = 0.5 * part_length(link.part) * frame.rotation[:, 0]
    return frame.position - half, frame.position + half


def _joints(assembly: Assembly, ends: Mapping[str, _Ends]) -> dict[str, list[Array]]:
    joints: dict[str, list[Array]] = {}
    for name, link in assembly.links.items():
        for body, end in zip(link.joins, ends[name], strict=True):
            joints.setdefault(body, []).append(end)
    for element in assembly.superelements.values():
        for port in element.ports.values():
            joints.setdefault(port.body, []).append(first_frame(port.frame).position)
    return joints


def _body(body: PlacedBody, joints: list[Array], size: float) -> Iterator[DrawnPiece]:
    """A body's outlines, or bars between its joints, and lines from joints off the outlines to their nearest box point."""
    kind = Kind.PLATFORM if body.name == PLATFORM else Kind.BODY
    solids = _solids(body.solids, kind, body.name)
    yield from solids
    skins = [] if solids else _bars(joints, _BAR * size)
    if solids:
        points = np.concatenate([piece.skin.points for piece in solids])
        nearest = [np.clip(joint, points.min(axis=0), points.max(axis=0)) for joint in joints]
        skins = [line(np.stack(ends)) for ends in zip(joints, nearest, strict=True) if np.max(np.abs(ends[0] - ends[1])) > 0.01 * size]
    if skins:
        yield DrawnPiece(body.name, kind, (body.name, body.name), join(skins))


def _solids(solids: Mapping[str, PlacedSolid], kind: Kind, body: str) -> list[DrawnPiece]:
    return [
        DrawnPiece(name, kind, (body, body), solid_skin(placed.solid).placed(first_frame(placed.frame))) for name, placed in solids.items()
    ]


def _bars(joints: Sequence[Array], thickness: float) -> list[DrawnSurface]:
    """Bars between all pairs of up to four joints, else from their middle to each."""
    if len(joints) > 4:
        middle = np.mean(joints, axis=0)
        return _drawn_bars([(middle, joint) for joint in joints], thickness)
    return _drawn_bars(itertools.combinations(joints, 2), thickness)


def _drawn_bars(ends: Iterable[tuple[Array, Array]], thickness: float) -> list[DrawnSurface]:
    """Bars of a square section; none between equal points."""
    return [_bar(first, second, thickness) for first, second in ends if np.linalg.norm(second - first) >= 1e-9]


def _bar(first: Array, second: Array, thickness: float) -> DrawnSurface:
    reach = second - first
    rings = extrude(np.array([0.0, float(np.linalg.norm(reach))]), [rectangle(thickness, thickness)] * 2)
    return loft(rings).placed(Frame(axes(reach), first))


def _link(link: PlacedLink, skin: DrawnSurface, ends: _Ends, size: float) -> Iterator[DrawnPiece]:
    frame = first_frame(link.frame)
    yield DrawnPiece(link.name, Kind.DRIVE if is_actuator(link.part) else Kind.HINGE, link.joins, skin.placed(frame))
    if GROUND in link.joins:
        begins = link.joins[0] == GROUND
        foot = _foot(part_section(link.part), -1.0 if begins else 1.0, _MARKER * size)
        yield DrawnPiece(f"{link.name} foot", Kind.GROUND, _GROUNDED, foot.placed(Frame(frame.rotation, ends[0] if begins else ends[1])))


def _foot(section: tuple[float, float], outward: float, depth: float) -> DrawnSurface:
    """A block of ground behind the end of a link, outward along its x axis or against it, somewhat larger than the link's section."""
    stations = (0.0, depth) if outward > 0.0 else (-depth, 0.0)
    height, width = (max(1.15 * extent, 1.6 * depth) for extent in section)
    return loft(extrude(np.array(stations), [rectangle(height, width)] * 2))


def _superelement(element: PlacedSuperelement, size: float) -> Iterator[DrawnPiece]:
    """Bars between its ports: between all of up to four, else from the first to each; they bend with the bodies there."""
    ports = list(element.ports.values())
    pairs = itertools.combinations(ports, 2) if len(ports) <= 4 else ((ports[0], port) for port in ports[1:])
    for one, other in pairs:
        for bar in _drawn_bars([(first_frame(one.frame).position, first_frame(other.frame).position)], _MARKER * size):
            yield DrawnPiece(element.name, Kind.HINGE, (one.body, other.body), bar)


def _gauge(name: str, sight: Sight, size: float) -> DrawnPiece:
    """An arrow along the measuring direction, its tip at the measured point."""
    tip, head, shaft = 0.0, -0.35 * _ARROW * size, -_ARROW * size
    thick, thin, none = circle(0.022 * size, 10), circle(0.008 * size, 10), circle(1e-4 * size, 10)
    arrow = [
        loft(extrude(np.array(ends), rings), along=ROUND) for ends, rings in (((head, tip), [thick, none]), ((shaft, head), [thin] * 2))
    ]
    return DrawnPiece(name, Kind.GAUGE, (sight.base, sight.base), join(arrow).placed(first_frame(sight.frame)))


def _sights(assembly: Assembly) -> Iterator[tuple[str, Sight]]:
    """Measured points of single gauges by name; sums are replaced by their members."""
    yield from ((name, gauge.single) for name, gauge in assembly.gauges.items() if gauge.single is not None)


def _labels(assembly: Assembly, size: float) -> Iterator[Label]:
    for name, link in assembly.actuators.items():
        yield Label(name, _point(assembly.links[link].frame.position), Kind.DRIVE, assembly.links[link].joins)
    for name, sight in _sights(assembly):
        frame = first_frame(sight.frame)
        yield Label(name, _point(frame.position - _ARROW * size * frame.rotation[:, 0]), Kind.GAUGE, (sight.base, sight.base))


def _point(position: Array) -> tuple[float, float, float]:
    x, y, z = first_design(np.real(position), 1).tolist()
    return x, y, z
