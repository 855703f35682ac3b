"""Placement by pattern: around an axis, or a single pose."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from enum import Enum
from typing import Annotated, TypeAlias

from flexstage.base.number import Number, Vector
from flexstage.base.storage.digest import KEY, Description
from flexstage.base.units.quantity import ANGLE, DIRECTION, LENGTH, NOT_NEGATIVE

ORIGIN: Vector = (0.0, 0.0, 0.0)


def between(start: Vector, end: Vector) -> Vector:
    """Return the vector from one point to another.

    >>> between((1.0, 0.0, 0.0), (3.0, 1.0, 0.0))
    (2.0, 1.0, 0.0)
    """
    return (end[0] - start[0], end[1] - start[1], end[2] - start[2])


def middle(start: Vector, end: Vector) -> Vector:
    """Return the midpoint of two points.

    >>> middle((1.0, 0.0, 0.0), (3.0, 1.0, 0.0))
    (2.0, 0.5, 0.0)
    """
    return (0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1]), 0.5 * (start[2] + end[2]))


class InstanceOrientation(Enum):
    """Orientation of an instance's x axis: along the circle (counter-clockwise), outward, inward, or along the pattern's axis."""

    TANGENT = "tangent"
    OUTWARD = "outward"
    INWARD = "inward"
    AXIS = "axis"


class Normal(Enum):
    """Normal of a mirror plane through the stage's origin."""

    X = "x"
    Y = "y"
    Z = "z"


@dataclass(frozen=True, eq=False)
class Polar(Description):
    """Polar pattern: instances at equal steps on a circle around the stage's z axis.

    `first` is the *position angle* of the first instance, from x towards y. `facing` is the direction of each instance's x axis, which is
    then rotated by `turn` about z. Each instance's z axis is parallel to the stage's z axis. With `InstanceOrientation.AXIS`, x is instead
    parallel to the stage's z axis, and z points inward. `step` is the angle between instances (default: equal division of a full circle).
    If `mirror` is specified, all instances are mirrored at the plane through the stage's origin that has this normal.
    """

    radius: Annotated[Number, LENGTH, NOT_NEGATIVE]
    first: Annotated[Number, ANGLE]
    facing: InstanceOrientation
    height: Annotated[Number, LENGTH] = 0.0
    turn: Annotated[Number, ANGLE] = 0.0
    step: Annotated[Number, ANGLE] | None = None
    mirror: Normal | None = None


@dataclass(frozen=True, eq=False)
class Pose(Description):
    """Pose of a single instance: origin `at`, x axis `along`, z axis `up` (perpendicular to x, of any length).

    Instead of `at` and `along`, two points of the x axis can be specified: the origin `start`, and an `end` in the direction of x. If
    `mirror` is specified, the instance is mirrored at the plane through the stage's origin that has this normal.
    """

    at: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    along: Annotated[Vector, DIRECTION] = (1.0, 0.0, 0.0)
    up: Annotated[Vector, DIRECTION] = (0.0, 0.0, 1.0)
    mirror: Normal | None = None
    start: Annotated[Vector, LENGTH] | None = field(default=None, metadata={KEY: "from"})
    end: Annotated[Vector, LENGTH] | None = field(default=None, metadata={KEY: "to"})

    @property
    def origin(self) -> Vector:
        """Origin of the instance."""
        return self.at if self.start is None else self.start

    @property
    def direction(self) -> Vector:
        """Direction of the x axis."""
        return self.along if self.start is None or self.end is None else between(self.start, self.end)


RANGE = re.compile(r"(.*?)(\d+)-(?:\1)?(\d+)")
"""Placement key of several instances: stem, first number, last number."""
Pattern: TypeAlias = Polar | Pose


def copy_names(key: str) -> tuple[str, ...]:
    """Return the instances named by a placement key.

    >>> copy_names("B1-B3"), copy_names("top")
    (('B1', 'B2', 'B3'), ('top',))
    """
    match = RANGE.fullmatch(key)
    if match is None:
        return (key,)
    stem, first, last = match[1], int(match[2]), int(match[3])
    return tuple(f"{stem}{number}" for number in range(first, last + 1))
