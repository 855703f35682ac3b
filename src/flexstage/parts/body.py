"""Rigid bodies: mass properties stated, or taken from solid outlines and their density."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, TypeAlias

from flexstage.base.digest import DOCUMENT_ONLY, Description
from flexstage.base.number import Number, Table, Vector, stack
from flexstage.base.quantity import DIRECTION, INERTIA, LENGTH, MASS, NOT_NEGATIVE, POSITIVE
from flexstage.spatial.frame import Frame, axes


@dataclass(frozen=True, eq=False)
class Block(Description):
    """A rectangular block centred at `at`, its x edge along the direction `along`, its z edge along `up` (perpendicular to `along`).

    Without directions its edges lie along the axes of the frame it stands in. `hole` is a centred rectangular through hole of sides (x, y)
    along the block's own z edge. Sizes in metres.
    """

    material: str
    size: tuple[Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE]]
    at: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    hole: tuple[Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE]] | None = None
    along: Annotated[Vector, DIRECTION] = (1.0, 0.0, 0.0)
    up: Annotated[Vector, DIRECTION] = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Cylinder(Description):
    """A round cylinder or tube centred at `at`, its axis along the direction `along`; `bore` is the diameter of a concentric hole."""

    material: str
    diameter: Annotated[Number, LENGTH, POSITIVE]
    length: Annotated[Number, LENGTH, POSITIVE]
    at: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    along: Annotated[Vector, DIRECTION] = (0.0, 0.0, 1.0)
    bore: Annotated[Number, LENGTH, POSITIVE] | None = None


@dataclass(frozen=True, eq=False)
class Inertia(Description):
    """Moments and products of inertia about the centre of mass, along the axes of the frame the body stands in [kg m^2].

    The products are the integrals of x y, x z, y z (the tensor's off-diagonal entries are their negatives).
    """

    xx: Annotated[Number, INERTIA, NOT_NEGATIVE]
    yy: Annotated[Number, INERTIA, NOT_NEGATIVE]
    zz: Annotated[Number, INERTIA, NOT_NEGATIVE]
    xy: Annotated[Number, INERTIA] = 0.0
    xz: Annotated[Number, INERTIA] = 0.0
    yz: Annotated[Number, INERTIA] = 0.0


@dataclass(frozen=True, eq=False)
class Imported(Description):
    """A solid drawn elsewhere: the STEP `file`, its origin at `at`, its x axis along `along`, its z axis along `up`.

    What models with rigid bodies need is stated, in the file's own axes: the sides (`size`) and the `middle` of the box around the solid,
    its `mass`, `centre` of mass and `inertia` about that. The solid model holds them to the file (0.1 %). `sha256`, the digest of the
    file's bytes, says which version of it is meant and stands for it in caches. `wall` is the thinnest wall, for the mesh (absent: the
    shortest side). A relative path is looked for from the design file.
    """

    material: str
    file: str = field(metadata=DOCUMENT_ONLY)
    sha256: str
    size: tuple[Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE]]
    mass: Annotated[Number, MASS, POSITIVE]
    centre: Annotated[Vector, LENGTH]
    inertia: Inertia
    middle: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    at: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    along: Annotated[Vector, DIRECTION] = (1.0, 0.0, 0.0)
    up: Annotated[Vector, DIRECTION] = (0.0, 0.0, 1.0)
    wall: Annotated[Number, LENGTH, POSITIVE] | None = None


Solid: TypeAlias = Block | Cylinder | Imported


def solid_frame(solid: Solid) -> Frame:
    """The frame of an outline in the one it is drawn in: origin at its centre, axes along a block's edges, x along a cylinder's axis.

    The centre of an imported solid is the middle of the box around it.

    >>> upright = Block("steel", size=(0.3, 0.2, 0.1), at=(0.0, 0.0, 1.0), along=(0.0, 0.0, 1.0), up=(1.0, 0.0, 0.0))
    >>> solid_frame(upright).rotation.T.tolist()  # x edge up, y edge = up x along, z edge along the body's x
    [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]
    """
    frame = Frame(axes(solid.along, None if isinstance(solid, Cylinder) else solid.up), stack(solid.at))
    return Frame(frame.rotation, frame.point(stack(solid.middle))) if isinstance(solid, Imported) else frame


@dataclass(frozen=True, eq=False)
class Body(Description):
    """A rigid body: `solids` (outlines with materials), or a stated `mass`, `centre` of mass and `inertia`; named `points`.

    Stated mass properties and solids exclude one another; a body with neither has no mass of its own. `point`: the stated mass is meant as
    a point, without inertia. `reference` is the point its twist is given at (absent: its centre of mass, or without mass the mean of its
    joints).

    `of` names another body of the stage, or the ground, that these solids belong to: a lug of the platform drawn once in a unit's frame and
    so placed with every copy. Such a body does not move by itself: its solids, mass and points are its owner's, and links that join it join
    the owner. It states no mass and no reference.
    """

    solids: Mapping[str, Solid] = field(default_factory=lambda: Table({}))
    mass: Annotated[Number, MASS, NOT_NEGATIVE] | None = None
    centre: Annotated[Vector, LENGTH] | None = None
    inertia: Inertia | None = None
    point: bool = field(default=False, metadata=DOCUMENT_ONLY)
    points: Mapping[str, Annotated[Vector, LENGTH]] = field(default_factory=lambda: Table({}))
    reference: Annotated[Vector, LENGTH] | None = None
    of: str | None = None


def owner_of(bodies: Mapping[str, Body], name: str) -> str:
    """The body that moves where the named one is joined: its owner where it is `of` another one, else itself.

    >>> owner_of({"pad": Body(of="platform")}, "pad"), owner_of({}, "ground")
    ('platform', 'ground')
    """
    body = bodies.get(name)
    return name if body is None or body.of is None else body.of


@dataclass(frozen=True, eq=False)
class Payload(Description):
    """A mass carried by a body: `mass`, its centre `at` (in the stage's frame) and its own `inertia` about that centre.

    `point`: it is meant as a point, without inertia of its own.
    """

    body: str
    mass: Annotated[Number, MASS, NOT_NEGATIVE]
    at: Annotated[Vector, LENGTH]
    inertia: Inertia | None = None
    point: bool = field(default=False, metadata=DOCUMENT_ONLY)
