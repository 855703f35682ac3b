"""Clearance of a stage: check of its outlines against the clear aperture (a keep-out area in plan) and the envelope."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, first_design, stack
from flexstage.base.record import INNER, VIEW, Heading, Layout
from flexstage.base.session import SESSION
from flexstage.base.units.quantity import LENGTH
from flexstage.base.units.unit import show
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.geometry.outline import Outline, outlines
from flexstage.mechanism.mechanism import Mechanism

_TOUCHING = 1e-9
_AXES = ("x", "y", "z")
_BOTH_WAYS: Array = np.concatenate([np.eye(3), -np.eye(3)])


@dataclass(frozen=True, eq=False)
class Intrusion:
    """Outline inside the aperture, and the distance `depth` (...) [m] in plan by which it must move to leave the aperture."""

    name: str
    depth: Annotated[Array, LENGTH]


class Clearance(Result):
    """Clearance of the stage: its bounding box, envelope and clear aperture.

    `intrusions` are the outlines inside the clear aperture (empty without an aperture). `opening` (..., 2) [m] is the size of the aperture.
    `low` and `high` are corners (..., 3) [m] of the bounding box. `envelope` is the size (..., 3) [m] of the envelope, or `None`. `extreme`
    names the outermost outline at the low ends of x, y, z, then at the high ends (first design).
    """

    TABLE: ClassVar[Layout] = Layout("Clearance", "table reached_by", head="axis")

    intrusions: tuple[Intrusion, ...]
    low: Array
    high: Array
    envelope: Array | None
    extreme: tuple[str, ...]
    opening: Array | None = None

    @property
    def size(self) -> Annotated[Array, LENGTH]:
        """Edges of the bounding box (..., 3) [m]."""
        return self.high - self.low

    @property
    def table(self) -> Annotated[Matrix, VIEW, Heading(unit="mm")]:
        """Table of the axes (rows) with low, high, size, and envelope if specified."""
        columns = [self.low, self.high, self.size]
        names = ["low", "high", "size"]
        if self.envelope is not None:
            columns, names = [*columns, np.broadcast_to(self.envelope, self.low.shape)], [*names, "envelope"]
        return Matrix(np.stack(columns, axis=-1), _AXES, tuple(names), "m")

    @property
    def reached_by(self) -> Annotated[tuple[str, ...], INNER]:
        """Outermost outlines at both ends of each axis."""
        return tuple(f"{low}, {high}" for low, high in zip(self.extreme[:3], self.extreme[3:], strict=True))

    @property
    def notes(self) -> Annotated[tuple[str, ...], INNER]:
        """Notes on outlines inside the aperture and edges outside the envelope."""
        said = tuple(f"{each.where}: {each.what}." for each in self.findings)
        return said or (() if self.opening is None else ("Nothing enters the clear opening.",))

    @property
    def findings(self) -> Annotated[tuple[Finding, ...], VIEW]:
        """Errors for outlines inside the aperture and for edges outside the envelope."""
        return (*self._intrusion_findings(), *self._beyond())

    def _intrusion_findings(self) -> Iterator[Finding]:
        for item in self.intrusions:
            depth = show(float(np.max(item.depth)), LENGTH, digits=3)
            yield Finding(item.name, f"enters the clear opening by {depth}", "Move it outward, trim its outline or reduce the opening")

    def _beyond(self) -> Iterator[Finding]:
        for index, axis in enumerate(_AXES):
            size = float(np.max(self.size[..., index]))
            limit = np.inf if self.envelope is None else float(np.min(self.envelope[..., index]))
            if size > limit + _TOUCHING:
                shown = (show(size, LENGTH, digits=4), show(limit, LENGTH, digits=4))
                ends = " and ".join(dict.fromkeys((self.extreme[index], self.extreme[3 + index])))
                yield Finding(
                    f"envelope.{axis}",
                    f"the stage is larger than the envelope (got {shown[0]}, expected {shown[1]} or less)",
                    f"Check {ends}",
                )


@SESSION.keep(2)
def clearance(mechanism: Mechanism) -> Clearance:
    """Compare the bounding box with the envelope, and the outlines with the aperture (a rectangle about the z axis).

    The convex outlines are tested in plan by separating axes. The result is exact for boxes and round discs. The depth of a tilted cylinder
    may be overestimated. A body is outside the aperture if its through hole along z encloses the aperture. Parts without dimensions
    (compliance matrices, joints) are ignored.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> clearance(double_triangle()).size[2].round(6).item()
    0.112697
    """
    result = outlines(expand(mechanism))
    envelope = None if mechanism.envelope is None else stack(mechanism.envelope)
    opening = None if mechanism.opening is None else stack(mechanism.opening.size)
    low, high, extreme = bounds(result)
    return Clearance(
        intrusions=() if opening is None else tuple(_intrusions(result, opening)),
        low=low,
        high=high,
        envelope=envelope,
        extreme=extreme,
        opening=opening,
    )


def bounds(found: tuple[Outline, ...]) -> tuple[Array, Array, tuple[str, ...]]:
    """Return the low and high corners (..., 3) [m] of the bounding box, and the names of the outermost outlines.

    If there are no outlines, the corners are zero.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> low, high, _ = bounds(outlines(expand(double_triangle())))
    >>> (high - low).round(4).tolist()
    [0.3658, 0.3474, 0.1127]
    """
    if not found:
        return np.zeros(3), np.zeros(3), ()
    reached = [outline.reach(_BOTH_WAYS.reshape(6, *(1,) * len(outline.designs), 3)) for outline in found]
    high = [stack([each[axis] for each in reached]) for axis in range(3)]
    low = [stack([-each[3 + axis] for each in reached]) for axis in range(3)]
    ends = [np.argmin(first_design(values, 1)) for values in low] + [np.argmax(first_design(values, 1)) for values in high]
    least, most = stack([np.min(values, axis=-1) for values in low]), stack([np.max(values, axis=-1) for values in high])
    return least, most, tuple(found[int(index)].name for index in ends)


def _intrusions(result: tuple[Outline, ...], opening: Array) -> Iterator[Intrusion]:
    for outline in result:
        depth = np.where(_surrounds(outline, opening), -np.inf, _depth(outline, opening))
        if np.any(depth > _TOUCHING):
            yield Intrusion(outline.name, depth)


def _surrounds(outline: Outline, opening: Array) -> Array:
    """Whether the outline's upright through hole encloses the whole aperture."""
    turn = outline.frame.rotation
    corners = 0.5 * opening[..., None, :] * np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
    arms = corners - outline.frame.position[..., None, :2]
    if outline.hole is not None:
        inside = np.all(np.abs(arms @ turn[..., :2, :2]) <= 0.5 * outline.hole[..., None, :] + _TOUCHING, axis=(-2, -1))
        return inside & (np.abs(turn[..., 2, 2]) > 1.0 - _TOUCHING)
    if outline.bore is not None:
        inside = np.all(np.sum(arms * arms, axis=-1) <= (0.5 * outline.bore[..., None] + _TOUCHING) ** 2, axis=-1)
        return inside & (np.abs(turn[..., 2, 0]) > 1.0 - _TOUCHING)
    return np.zeros((), dtype=bool)


def _depth(outline: Outline, opening: Array) -> Array:
    """Least overlap in plan over candidate directions; negative or zero: apart."""
    directions = _directions(outline, opening)
    half = 0.5 * (opening[..., 0] * np.abs(directions[..., 0]) + opening[..., 1] * np.abs(directions[..., 1]))
    return np.min(outline.reach(directions) + half, axis=0)


def _directions(outline: Outline, opening: Array) -> Array:
    """Outward normals (n, ..., 3) of both shapes in plan, and directions from the aperture's corners to a round outline's centre."""
    normals = [np.array([1.0, 0.0]), np.array([0.0, 1.0])]
    edges = outline.frame.rotation[..., :2, :]
    normals += [np.stack([-edges[..., 1, index], edges[..., 0, index]], axis=-1) for index in range(3)]
    if outline.is_cylinder:
        corners = (np.array([sx, sy]) * 0.5 * opening for sx in (1.0, -1.0) for sy in (1.0, -1.0))
        normals += [outline.frame.position[..., :2] - corner for corner in corners]
    batch = np.broadcast_shapes(opening.shape[:-1], edges.shape[:-2], outline.frame.position.shape[:-1], outline.size.shape[:-1])
    normal = np.stack([np.broadcast_to(each, (*batch, 2)) for each in normals])
    if outline.is_cylinder:
        around = _AROUND.reshape(-1, *(1,) * len(batch), 2)
        normal = np.concatenate([normal, np.broadcast_to(around, (len(_AROUND), *batch, 2))])
    length = np.sqrt(np.sum(normal * normal, axis=-1, keepdims=True))
    unit = np.where(length > _TOUCHING, normal / np.where(length > _TOUCHING, length, 1.0), np.array([1.0, 0.0]))
    flat = np.concatenate([unit, np.zeros_like(unit[..., :1])], axis=-1)
    return np.concatenate([flat, -flat])


_AROUND: Array = np.stack([each(np.linspace(0.0, np.pi, 180, endpoint=False)) for each in (np.cos, np.sin)], axis=-1)
"""Directions in plan over half a turn."""
