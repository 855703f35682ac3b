"""The scene of a stage: facets of its bodies, links, grounds and gauges, and the names to write beside them."""

from __future__ import annotations

import itertools
import pickle
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import Assembly, PlacedBody, PlacedLink, PlacedSuperelement, expand
from flexstage.mechanism.assembly.sight import Sight
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.parts.body import PlacedSolid
from flexstage.parts.part import Part, is_actuator
from flexstage.show.scene.facet import SHARP, Facet, Kind, Paint, circle, cross, extrude, line, loft, rectangle
from flexstage.show.scene.inner import outer
from flexstage.show.scene.order import Partition, partition
from flexstage.show.scene.primitives import part_facets, part_length, part_section, solid_facets
from flexstage.spatial.frame import Frame, axes

_MARKER = 0.02
_BAR = 0.009
_ARROW = 0.11
ORDERED = 5000


@dataclass(frozen=True)
class Label:
    """A name at a point of the stage, shown in the colour of its kind; it moves with the mean of two `bodies`."""

    text: str
    point: tuple[float, float, float]
    kind: Kind
    bodies: tuple[str, str] = (GROUND, GROUND)


@dataclass(frozen=True, eq=False)
class Scene:
    """Facets and labels in the stage's frame [m]; `size` is the diagonal of the box around everything.

    `references` are the bodies' reference points (3,), about which their twists turn them.
    """

    facets: tuple[Facet, ...]
    labels: tuple[Label, ...]
    references: dict[str, Array]
    size: float

    @property
    def is_large(self) -> bool:
        """Whether its facets are too many to be ordered one by one: pictures show the outline of each solid."""
        return len(self.facets) > ORDERED

    @cached_property
    def order(self) -> Partition | None:
        """The facets in depth order, worked out when it is asked for: pictures need it, and it takes most of their time."""
        return partition(self.facets, self.size)


def scene(mechanism: Mechanism, *, steps: int = 1) -> Scene:
    """The scene of the first design of a description; hinges are divided into `steps` along their length, so that they can be bent.

    Bodies without outlines are bars between their joints; where a joint lies off its body's outline a thin line joins them. Ground is shown
    at each link that is fixed to it. Superelements are bars between their ports.

    >>> scene(Mechanism("", bodies={})).facets
    ()
    """
    assembly = expand(mechanism)
    ends = _ends(assembly)
    joints = _joints(assembly, ends)
    size = _span(np.array([point for points in joints.values() for point in points]).reshape(-1, 3))
    facets = [facet for body in assembly.bodies.values() for facet in _body(body, joints.get(body.name, []), size)]
    facets += _solids(assembly.ground, Paint(Kind.GROUND, (GROUND, GROUND)))
    size = max(size, _span(np.concatenate([facet.points for facet in facets])) if facets else size)
    facets += [facet for name, link in assembly.links.items() for facet in _link(link, *ends[name], size, steps)]
    facets += [facet for element in assembly.superelements.values() for facet in _superelement(element, size)]
    facets += [facet for name, sight in _sights(assembly) for facet in _gauge(name, sight, size)]
    references = {name: _first(body.reference) for name, body in assembly.bodies.items()}
    return Scene(tuple(facets), tuple(_labels(assembly, size)), references, size)


def displace(facets: Sequence[Facet], still: Scene, twists: Mapping[str, Array], factor: float) -> list[Facet]:
    """Facets with every body of the scene moved by `factor` times its twist (6,) at its reference point; others stand still.

    Links bend from the motion of the one body to that of the other.

    >>> displace([], scene(Mechanism("")), {}, 1.0)
    []
    """
    if not facets:
        return []
    points, change = _displacement(facets, still, twists, factor)
    ends = np.cumsum([len(facet.points) for facet in facets])[:-1]
    pieces = np.split(points + change, ends)
    return [Facet(piece, facet.edges, facet.paint, facet.share, facet.whole) for facet, piece in zip(facets, pieces, strict=True)]


def _displacement(facets: Sequence[Facet], still: Scene, twists: Mapping[str, Array], factor: float) -> tuple[Array, Array]:
    """All points of the facets (p, 3) and their displacements: each between the motions of the two bodies that carry it."""
    known = {name: number for number, name in enumerate(twists)}
    motion = np.array([*(np.real(twist) for twist in twists.values()), np.zeros(6)])
    centres = np.array([*(still.references[name] for name in twists), np.zeros(3)])
    points = np.concatenate([facet.points for facet in facets])
    share = np.concatenate([facet.share for facet in facets])[:, None]
    counts = [len(facet.points) for facet in facets]
    moves: list[Array] = []
    for side in (0, 1):
        rows = np.repeat([known.get(facet.paint.carriers[side], len(known)) for facet in facets], counts)
        moves.append(motion[rows, :3] + cross(motion[rows, 3:], points - centres[rows]))
    return points, factor * ((1.0 - share) * moves[0] + share * moves[1])


def largest_motion(still: Scene, twists: Mapping[str, Array]) -> float:
    """Largest displacement [m] of any point of the scene under the bodies' twists.

    >>> largest_motion(scene(Mechanism("")), {})
    0.0
    """
    if not still.facets:
        return 0.0
    _, change = _displacement(still.facets, still, twists, 1.0)
    return float(np.sqrt(np.sum(change**2, axis=1).max()))


def _first(values: Array) -> Array:
    values = np.asarray(values)
    return np.real(values.reshape(-1, values.shape[-1])[0])


def _frame(frame: Frame) -> Frame:
    """The frame of the first design."""
    rotation = np.real(frame.rotation.reshape(-1, 3, 3)[0])
    return Frame(rotation, _first(frame.position))


def _span(points: Array) -> float:
    if len(points) == 0:
        return 1.0
    extent = points.max(axis=0) - points.min(axis=0)
    return float(np.sqrt(extent @ extent)) or 1.0


_Ends = Mapping[str, tuple[Array, Array]]
"""Where each link meets its first and its second body, by the link's name."""


def _joints(assembly: Assembly, ends: _Ends) -> dict[str, list[Array]]:
    joints: dict[str, list[Array]] = {}
    for name, link in assembly.links.items():
        for body, end in zip(link.joins, ends[name], strict=True):
            joints.setdefault(body, []).append(end)
    for element in assembly.superelements.values():
        for port in element.ports.values():
            joints.setdefault(port.body, []).append(_first(port.frame.position))
    return joints


def _ends(assembly: Assembly) -> _Ends:
    """The ends of all links, by the convention that x goes from the first body to the second."""
    return {name: _link_ends(link) for name, link in assembly.links.items()}


def _link_ends(link: PlacedLink) -> tuple[Array, Array]:
    """Where a link meets its first body and its second."""
    frame = _frame(link.frame)
    half = 0.5 * part_length(link.part) * frame.rotation[:, 0]
    return frame.position - half, frame.position + half


def _body(body: PlacedBody, joints: list[Array], size: float) -> tuple[Facet, ...]:
    """The facets of a body; one that stands in the next design as in the last is not built anew."""
    return _built(pickle.dumps((body.name, dict(body.solids), joints, size)))


@lru_cache(maxsize=256)
def _built(drawn: bytes) -> tuple[Facet, ...]:
    """The facets of a body by its name, its outlines, its joints and the stage's size."""
    return tuple(_facets(*pickle.loads(drawn)))  # noqa: S301 (written one line above)


def _facets(name: str, solids: Mapping[str, PlacedSolid], joints: list[Array], size: float) -> list[Facet]:
    paint = Paint(Kind.PLATFORM if name == PLATFORM else Kind.BODY, (name, name), name)
    if not solids:
        return _bars(joints, paint, _BAR * size)
    facets = _solids(solids, paint)
    if paint.kind is Kind.PLATFORM:  # it is seen through
        facets = outer(facets)
    points = np.concatenate([facet.points for facet in facets])
    return facets + list(_legs(points, joints, paint, size))


def _solids(solids: Mapping[str, PlacedSolid], paint: Paint) -> list[Facet]:
    named = [(placed, _frame(placed.frame), replace(paint, name=name)) for name, placed in solids.items()]
    return [_place(facet, frame) for placed, frame, own in named for facet in solid_facets(placed.solid, own)]


def _place(facet: Facet, frame: Frame) -> Facet:
    turned = tuple(edge if edge is None or edge is SHARP else frame.rotation @ edge for edge in facet.edges)
    return Facet(facet.points @ frame.rotation.T + frame.position, turned, facet.paint, facet.share, facet.whole)


def _bars(joints: list[Array], paint: Paint, thickness: float) -> list[Facet]:
    """Bars between all pairs of up to four joints, else from their middle to each."""
    if len(joints) > 4:
        middle = np.mean(joints, axis=0)
        pairs = [(middle, joint) for joint in joints]
    else:
        pairs = [(joints[first], joints[second]) for first in range(len(joints)) for second in range(first)]
    return [facet for first, second in pairs for facet in _bar(first, second, paint, thickness)]


def _bar(first: Array, second: Array, paint: Paint, thickness: float) -> list[Facet]:
    reach = second - first
    distance = float(np.sqrt(reach @ reach))
    if distance < 1e-9:
        return []
    rings = extrude(np.array([0.0, distance]), [rectangle(thickness, thickness)] * 2)
    return [_place(facet, Frame(axes(reach), first)) for facet in loft(rings, paint)]


def _legs(points: Array, joints: list[Array], paint: Paint, size: float) -> Iterator[Facet]:
    """Lines from joints that lie off the outline to its nearest box point."""
    low, high = points.min(axis=0), points.max(axis=0)
    for joint in joints:
        nearest = np.clip(joint, low, high)
        if np.max(np.abs(joint - nearest)) > 0.01 * size:
            yield line(np.stack([joint, nearest]), paint)


def _link(link: PlacedLink, first: Array, second: Array, size: float, steps: int) -> list[Facet]:
    frame = _frame(link.frame)
    kind, fineness = (Kind.DRIVE, 1) if is_actuator(link.part) else (Kind.HINGE, steps)
    paint = Paint(kind, link.joins, link.name)
    facets = _place_all(_drawn_part(link.part, _MARKER * size, fineness), frame, paint)
    if GROUND in link.joins:
        begins = link.joins[0] == GROUND
        facets += _foot(link, first if begins else second, -1.0 if begins else 1.0, _MARKER * size)
    return facets


@lru_cache(maxsize=64)
def _drawn_part(part: Part, marker: float, steps: int) -> tuple[tuple[Facet, ...], Array, Array]:
    """Facets of a part in its own frame, and all their points and edges (n, 3) that are no sharp ones: links share parts."""
    facets = tuple(part_facets(part, Paint(Kind.HINGE, (GROUND, GROUND), ""), marker, steps=steps))
    edges = [edge for facet in facets for edge in facet.edges if edge is not None and edge is not SHARP]
    return facets, np.concatenate([facet.points for facet in facets]), np.array(edges).reshape(-1, 3)


def _place_all(drawn: tuple[tuple[Facet, ...], Array, Array], frame: Frame, paint: Paint) -> list[Facet]:
    """The facets of a part where a link stands, in its paint."""
    facets, points, edges = drawn
    points, turned = points @ frame.rotation.T + frame.position, iter(edges @ frame.rotation.T)
    placed: list[Facet] = []
    start = 0
    for facet in facets:
        stop = start + len(facet.points)
        own = tuple(edge if edge is None or edge is SHARP else next(turned) for edge in facet.edges)
        placed.append(Facet(points[start:stop], own, paint, facet.share, facet.whole))
        start = stop
    return placed


def _superelement(element: PlacedSuperelement, size: float) -> list[Facet]:
    """Bars between its ports: between all of up to four, else from the first to each; they bend with the bodies there."""
    ports = list(element.ports.values())
    pairs = itertools.combinations(ports, 2) if len(ports) <= 4 else ((ports[0], port) for port in ports[1:])
    ends = [(_first(one.frame.position), _first(other.frame.position), (one.body, other.body)) for one, other in pairs]
    return [
        facet for first, second, bodies in ends for facet in _bar(first, second, Paint(Kind.HINGE, bodies, element.name), _MARKER * size)
    ]


def _foot(link: PlacedLink, end: Array, outward: float, depth: float) -> list[Facet]:
    """A block of ground behind the end of a link, outward along its x axis or against it, somewhat larger than the link's section."""
    frame = _frame(link.frame)
    stations = (0.0, depth) if outward > 0.0 else (-depth, 0.0)
    height, width = (max(1.15 * extent, 1.6 * depth) for extent in part_section(link.part))
    rings = extrude(np.array(stations), [rectangle(height, width)] * 2)
    return [_place(facet, Frame(frame.rotation, end)) for facet in loft(rings, Paint(Kind.GROUND, (GROUND, GROUND), f"{link.name} foot"))]


def _gauge(name: str, sight: Sight, size: float) -> list[Facet]:
    """An arrow along the measuring direction, its tip at the measured point."""
    tip, head, shaft = 0.0, -0.35 * _ARROW * size, -_ARROW * size
    thick, thin, none = circle(0.022 * size, 10), circle(0.008 * size, 10), circle(1e-4 * size, 10)
    paint = Paint(Kind.GAUGE, (sight.base, sight.base), name)
    facets = loft(extrude(np.array([head, tip]), [thick, none]), paint, round_section=True)
    facets += loft(extrude(np.array([shaft, head]), [thin, thin]), replace(paint, name=f"{name} shaft", what=name), round_section=True)
    return [_place(facet, _frame(sight.frame)) for facet in facets]


def _sights(assembly: Assembly) -> Iterator[tuple[str, Sight]]:
    """What single gauges look at, by name; sums are their members."""
    yield from ((name, gauge.single) for name, gauge in assembly.gauges.items() if gauge.single is not None)


def _labels(assembly: Assembly, size: float) -> Iterator[Label]:
    for name, link in assembly.actuators.items():
        yield Label(name, _point(assembly.links[link].frame.position), Kind.DRIVE, assembly.links[link].joins)
    for name, sight in _sights(assembly):
        frame = _frame(sight.frame)
        yield Label(name, _point(frame.position - _ARROW * size * frame.rotation[:, 0]), Kind.GAUGE, (sight.base, sight.base))


def _point(position: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in _first(position))
    return x, y, z
