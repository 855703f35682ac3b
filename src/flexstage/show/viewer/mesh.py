"""The mesh of a stage: triangles and sharp edges. Each vertex belongs to a part, and has a position between its two bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexstage.base.number import Array
from flexstage.show.scene.skin import join
from flexstage.show.scene.stage import DrawnPiece
from flexstage.show.viewer.bend import COLUMNS, Bend


@dataclass(frozen=True, eq=False)
class Mesh:
    """Vertices, triangles and edges of a stage in its frame.

    `points` (v, 3) [m] are the positions of vertices. `part`, `carrier` and `station` (v,) are the indices of each vertex's part, carrier
    and row of `stations`. A carrier is a piece between two bodies: `bodies` (c, 2) are their numbers (0: ground), `ends` (c, 2, 3) [m] are
    the ends of the piece at these bodies. A rigid piece has the same body at both ends. The rows of `stations` (s, 5) are values of a
    `Bend`. `triangles` (t, 3) are counter-clockwise from outside; `edges` (e, 2) are sharp edges.
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
        """Point (v, 3) for each vertex: on the line between its carrier's ends, at the vertex's fraction of the length."""
        first, second = self.ends[self.carrier, 0], self.ends[self.carrier, 1]
        return first + self.stations[self.station, :1] * (second - first)

    @cached_property
    def _spans(self) -> tuple[Array, Array]:
        """Unit directions (v, 3) from the first ends of the vertices' carriers to the second ones, and their distances (v, 1)."""
        span = self.ends[self.carrier, 1] - self.ends[self.carrier, 0]
        length = np.sqrt(np.sum(span**2, axis=1, keepdims=True))
        return span / np.where(length > 0.0, length, 1.0), length

    def displacement(self, twists: Array) -> Array:
        """Compute the displacement (v, 3) of the vertices for small twists (b, 6) of the bodies at the origin.

        For a twist of translation t and rotation w, a point p of a body moves by t + w x p. A link moves with its first body, and bends
        (see `Bend`) due to the motion of the second body relative to the first. The viewer's shader computes the same displacement.
        """
        first, second = (twists[self.bodies[self.carrier, side]] for side in (0, 1))
        rigid = first[:, :3] + np.cross(first[:, 3:], self.points)
        end, (axis, length) = self.ends[self.carrier, 1], self._spans
        share, by_offset, by_turn, offset_slope, turn_slope = self.stations[self.station].T[..., None]
        turn = second[:, 3:] - first[:, 3:]
        offset = second[:, :3] - first[:, :3] + np.cross(turn, end)
        along, spin = (axis * np.sum(axis * each, axis=1, keepdims=True) for each in (offset, turn))
        lean = np.cross(turn, axis)
        line = along * share + (offset - along) * by_offset + lean * length * by_turn
        slope = (offset - along) / np.where(length > 0.0, length, 1.0) * offset_slope + lean * turn_slope
        return rigid + line + np.cross(np.cross(axis, slope) + spin * share, self.points - self.centres)


def mesh_of(
    pieces: Sequence[DrawnPiece], bodies: Mapping[str, int], parts: Mapping[str, int], bends: Mapping[str, Bend], straight: Bend
) -> Mesh:
    """Build the mesh of drawn pieces, with the numbers of bodies and parts by name.

    `bends` contains shape functions by name of the piece; all other pieces have the shape functions `straight`.

    >>> mesh_of((), {}, {}, {}, Bend(np.zeros(1), np.zeros((1, 5)))).points.shape
    (0, 3)
    """
    whole = join([replace(piece.skin, points=_single(piece.skin.points)) for piece in pieces])
    carriers, carrier = np.unique(np.array([_carrier(piece, bodies) for piece in pieces]).reshape(-1, 8), axis=0, return_inverse=True)
    rows = [_stations(piece, bends.get(piece.name, straight)) for piece in pieces]
    stations, station = np.unique(np.concatenate([np.zeros((0, COLUMNS)), *rows]), axis=0, return_inverse=True)
    own = np.repeat(np.arange(len(pieces)), [len(piece.skin.points) for piece in pieces])
    return Mesh(
        points=whole.points,
        part=np.array([parts[piece.name] for piece in pieces], dtype=int)[own],
        carrier=carrier.reshape(-1)[own],
        station=station.reshape(-1),
        bodies=carriers[:, :2].astype(int),
        ends=carriers[:, 2:].reshape(-1, 2, 3),
        stations=stations,
        triangles=whole.triangles,
        edges=whole.edges,
    )


def _single(values: Array) -> Array:
    """Values with the precision of a viewer."""
    return values.astype(np.float32).astype(float) + 0.0


def _carrier(piece: DrawnPiece, bodies: Mapping[str, int]) -> Array:
    """The bodies of a piece by number, and its ends (8,): the middles of its first and its last ring; zeros if rigid."""
    first, second = (bodies[name] for name in piece.bodies)
    share = piece.skin.share
    ends = np.zeros(6) if first == second else np.concatenate([_single(piece.skin.points[share == end]).mean(axis=0) for end in (0.0, 1.0)])
    return _single(np.array([first, second, *ends]))


def _stations(piece: DrawnPiece, bend: Bend) -> Array:
    """Rows (k, 5) of a piece's bend at its points; zeros if it is rigid."""
    first, second = piece.bodies
    return np.zeros((len(piece.skin.share), COLUMNS)) if first == second else _single(bend.at(piece.skin.share))
