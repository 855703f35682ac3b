"""The mesh of a stage: triangles and sharp edges whose vertices know their part and how far they lie between its two bodies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.mechanism import GROUND
from flexstage.show.scene.facet import SHARP, Facet, Kind, Paint, cross
from flexstage.show.viewer.bend import COLUMNS, Bend


@dataclass(frozen=True, eq=False)
class Mesh:
    """Vertices, triangles and edges of a stage in its frame.

    A vertex has a place in `points` (v, 3) [m], a `part` (v,), a `carrier` (v,) and a `station` (v,). A carrier is a piece between two
    bodies: `bodies` (c, 2) by number, 0 the ground; `ends` (c, 2, 3) [m], where it meets them; of what is rigid both bodies are one. A
    station is a row of `stations` (s, 5): see `Bend`. `triangles` (t, 3) are counter-clockwise from outside, `edges` (e, 2) sharp.
    """

    points: Array
    part: Array
    carrier: Array
    station: Array
    bodies: Array
    ends: Array
    stations: Array
    triangles: Array
    edges: Array

    @cached_property
    def centres(self) -> Array:
        """Points (v, 3) on the lines between the ends of carriers, at the vertices' shares."""
        first, second = self.ends[self.carrier, 0], self.ends[self.carrier, 1]
        return first + self.stations[self.station, :1] * (second - first)

    @cached_property
    def _spans(self) -> tuple[Array, Array]:
        """Unit directions (v, 3) from the first ends of the vertices' carriers to the second ones, and their distances (v, 1)."""
        span = self.ends[self.carrier, 1] - self.ends[self.carrier, 0]
        length = np.sqrt(np.sum(span**2, axis=1, keepdims=True))
        return span / np.where(length > 0.0, length, 1.0), length

    def displacement(self, twists: Array) -> Array:
        """Displacement (v, 3) of the vertices by the bodies' twists at the origin (b, 6), small rotations.

        Of a body every point p moves by t + w x p. A link moves with its first body and, on top of that, as a beam of its bend does whose
        second end follows the second body. The viewer's shader does the same.
        """
        first, second = (twists[self.bodies[self.carrier, side]] for side in (0, 1))
        rigid = first[:, :3] + cross(first[:, 3:], self.points)
        end, (axis, length) = self.ends[self.carrier, 1], self._spans
        share, by_offset, by_turn, offset_slope, turn_slope = self.stations[self.station].T[..., None]
        turn = second[:, 3:] - first[:, 3:]
        offset = second[:, :3] - first[:, :3] + cross(turn, end)
        along, spin = (axis * np.sum(axis * each, axis=1, keepdims=True) for each in (offset, turn))
        lean = cross(turn, axis)
        line = along * share + (offset - along) * by_offset + lean * length * by_turn
        slope = (offset - along) / np.where(length > 0.0, length, 1.0) * offset_slope + lean * turn_slope
        return rigid + line + cross(cross(axis, slope) + spin * share, self.points - self.centres)


@dataclass(frozen=True, eq=False)
class _Corners:
    """Corners of all facets one after the other: their `points` (k, 3), their `share` (k,) and which of the `paints` each has (k,)."""

    paints: Sequence[Paint]
    paint: Array
    points: Array
    share: Array


def mesh_of(facets: Sequence[Facet], bodies: Sequence[str], parts: Sequence[str], bends: Mapping[str, Bend], straight: Bend) -> Mesh:
    """The mesh of facets; numbers of bodies and parts are their places in the sequences, `bends` those of parts that are not `straight`.

    >>> mesh_of((), (), (), {}, Bend(np.zeros(1), np.zeros((1, 5)))).points.shape
    (0, 3)
    """
    counts = np.array([len(facet.points) for facet in facets], dtype=int)
    starts = np.concatenate([[0], np.cumsum(counts)])[:-1].astype(int)
    corners = _corners(facets, counts)
    carriers, carrier = _distinct(_carriers(corners, bodies))
    rigid = (carriers[:, 0] == carriers[:, 1])[carrier]
    stations, station = _distinct(_stations(corners, rigid, bends, straight))
    numbers = {name: number for number, name in enumerate(parts)}
    part = np.array([numbers[paint.thing] for paint in corners.paints], dtype=int)
    rows, vertex = _distinct(np.column_stack([np.column_stack([part, carrier])[corners.paint], station, corners.points]))
    return Mesh(
        points=rows[:, 3:],
        part=rows[:, 0].astype(int),
        carrier=rows[:, 1].astype(int),
        station=rows[:, 2].astype(int),
        bodies=carriers[:, :2].astype(int),
        ends=carriers[:, 2:].reshape(-1, 2, 3),
        stations=stations,
        triangles=vertex[_triangles(starts, counts)].reshape(-1, 3),
        edges=_edges(facets, starts, vertex),
    )


def _corners(facets: Sequence[Facet], counts: Array) -> _Corners:
    """The corners of facets, as exact as a viewer gets them."""
    paints = list({id(facet.paint): facet.paint for facet in facets}.values())
    numbers = {id(paint): number for number, paint in enumerate(paints)}
    paint = np.repeat(np.array([numbers[id(facet.paint)] for facet in facets], dtype=int), counts)
    points = np.concatenate([np.zeros((0, 3)), *(facet.points for facet in facets)]).astype(np.float32).astype(float) + 0.0
    return _Corners(paints, paint, points, np.concatenate([np.zeros(0), *(facet.share for facet in facets)]))


def _distinct(rows: Array) -> tuple[Array, Array]:
    """The different rows (n, k) in ascending order, and where each one went."""
    order = np.lexsort(rows.T[::-1])
    ascending = rows[order]
    first = np.concatenate([np.ones(min(len(rows), 1), dtype=bool), np.any(ascending[1:] != ascending[:-1], axis=1)])
    places = np.zeros(len(rows), dtype=int)
    places[order] = np.cumsum(first) - 1
    return ascending[first], places


def _carriers(corners: _Corners, bodies: Sequence[str]) -> Array:
    """The bodies of each paint by number, and where it meets them (n, 8): the middles of its first and its last ring; zeros if rigid."""
    numbers = {name: number for number, name in enumerate(bodies)}
    rows = np.zeros((len(corners.paints), 8))
    for side, value in enumerate((0.0, 1.0)):
        there = corners.share == value
        total = np.zeros((len(rows), 3))
        np.add.at(total, corners.paint[there], corners.points[there])
        rows[:, side] = [numbers[paint.carriers[side]] for paint in corners.paints]
        rows[:, 2 + 3 * side : 5 + 3 * side] = total / np.maximum(np.bincount(corners.paint[there], minlength=len(rows)), 1)[:, None]
    rows[rows[:, 0] == rows[:, 1], 2:] = 0.0
    return rows.astype(np.float32).astype(float)


def _stations(corners: _Corners, rigid: Array, bends: Mapping[str, Bend], straight: Bend) -> Array:
    """Rows (k, 5) of the corners' bends at their shares; zeros where their paint is rigid."""
    kinds = [bends.get(paint.name, straight) for paint in corners.paints]
    own = np.array([0 if still else id(kind) for kind, still in zip(kinds, rigid, strict=True)], dtype=int)[corners.paint]
    rows = np.zeros((len(corners.share), COLUMNS))
    for kind in {id(kind): kind for kind in kinds}.values():
        rows[own == id(kind)] = kind.at(corners.share[own == id(kind)])
    return rows.astype(np.float32).astype(float)


def _triangles(starts: Array, counts: Array) -> Array:
    """Fans of all polygons: places of their corners, three a triangle."""
    fans = np.maximum(counts - 2, 0)
    facet = np.repeat(np.arange(len(counts)), fans)
    corner = np.arange(len(facet)) - np.repeat(np.cumsum(fans) - fans, fans)
    return (starts[facet][:, None] + np.column_stack([np.zeros_like(corner), corner + 1, corner + 2])).ravel()


def _edges(facets: Sequence[Facet], starts: Array, vertex: Array) -> Array:
    """Pairs (e, 2) of vertices with a sharp edge between them, each once."""
    pairs = [
        (start + place, start + (place + 1) % len(facet.points))
        for facet, start in zip(facets, starts, strict=True)
        for place, edge in enumerate(facet.edges)
        if edge is SHARP
    ]
    ends = np.sort(vertex[np.array(pairs, dtype=int).reshape(-1, 2)], axis=1)
    return _distinct(ends[ends[:, 0] != ends[:, 1]])[0]


def body_names(names: Iterable[str]) -> tuple[str, ...]:
    """The ground, which is number 0, and the bodies in their order.

    >>> body_names(["platform"])
    ('ground', 'platform')
    """
    return (GROUND, *names)


def thing_kinds(facets: Iterable[Facet]) -> dict[str, tuple[Kind, tuple[str, str]]]:
    """What is shown, by name in the order of the facets: of which kind, carried by which bodies.

    >>> thing_kinds([])
    {}
    """
    found: dict[str, tuple[Kind, tuple[str, str]]] = {}
    for facet in facets:
        found.setdefault(facet.paint.thing, (facet.paint.kind, facet.paint.carriers))
    return found
