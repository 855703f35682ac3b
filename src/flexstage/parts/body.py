"""Rigid bodies: mass properties stated, or taken from solid outlines and their density."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.number import Array, Number, Table, Vector, first_design, stack
from flexstage.base.storage.digest import DOCUMENT_ONLY, Description
from flexstage.base.units.quantity import DIRECTION, INERTIA, LENGTH, MASS, NOT_NEGATIVE, POSITIVE
from flexstage.parts.profile import single
from flexstage.parts.shape import Order
from flexstage.spatial.frame import Frame, axes


class Solid(Description):
    """An outline of a body, of one `material`. What stands in the frame of its centre asks it for its geometry there.

    A cylinder's axis is x there, a block's and an extrusion's height z.
    """

    material: str
    at: Vector
    subtract: bool = False

    @property
    def sides(self) -> Array:
        """Sides (..., 3) of the box around it, along its own axes [m]."""
        raise NotImplementedError

    @property
    def frame(self) -> Frame:
        """Its own frame in the one it is drawn in: origin at the centre of the box around it."""
        raise NotImplementedError

    @property
    def thinnest(self) -> Number:
        """Its smallest dimension [m]: it sets the mesh there."""
        return np.min(np.real(self.sides), axis=-1)

    @property
    def is_flat(self) -> bool:
        """Whether all of its faces are plane."""
        return True

    @property
    def orders(self) -> Iterator[Order]:
        """Which of its numbers must be below which others."""
        yield from ()

    @property
    def mirrored(self) -> Solid:
        """What a mirror across the y axis of its frame shows, in that frame: itself, where it is alike on both sides."""
        return self

    def contains(self, points: Array, slack: float) -> Array:
        """Which points (n, 3) of its own frame lie in it, or within `slack` [m] of it; of the first design."""
        half = 0.5 * first_design(np.real(self.sides), 1)
        return np.all(np.abs(points) <= half + slack, axis=1)


@dataclass(frozen=True, eq=False)
class Block(Solid):
    """A rectangular block centred at `at`, its x edge along the direction `along`, its z edge along `up` (perpendicular to `along`).

    Without directions its edges lie along the axes of the frame it stands in. `hole` is a centred rectangular through hole of sides (x, y)
    along the block's own z edge. Sizes in metres. `subtract`: it is a hole, see `Body`.
    """

    material: str
    size: tuple[Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE]]
    at: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    hole: tuple[Annotated[Number, LENGTH, POSITIVE], Annotated[Number, LENGTH, POSITIVE]] | None = None
    along: Annotated[Vector, DIRECTION] = (1.0, 0.0, 0.0)
    up: Annotated[Vector, DIRECTION] = (0.0, 0.0, 1.0)
    subtract: bool = False

    @property
    def sides(self) -> Array:
        """Its sizes."""
        return stack(self.size)

    @property
    def frame(self) -> Frame:
        """Axes along its edges.

        >>> upright = Block("steel", size=(0.3, 0.2, 0.1), at=(0.0, 0.0, 1.0), along=(0.0, 0.0, 1.0), up=(1.0, 0.0, 0.0))
        >>> upright.frame.rotation.T.tolist()  # x edge up, y edge = up x along, z edge along the body's x
        [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]
        """
        return Frame(axes(self.along, self.up), stack(self.at))

    @property
    def orders(self) -> Iterator[Order]:
        """Its hole is smaller than itself."""
        for name, hole, size in zip("xy", self.hole or (), self.size, strict=False):
            yield Order(f"hole.{name}", hole, size, "the size of the block", "Make the hole smaller")

    def contains(self, points: Array, slack: float) -> Array:
        """Which points lie in its walls."""
        within = super().contains(points, slack)
        if self.hole is not None:
            hole = 0.5 * first_design(np.real(stack(self.hole)), 1)
            within &= np.any(np.abs(points[:, :2]) >= hole - slack, axis=1)
        return within


@dataclass(frozen=True, eq=False)
class Cylinder(Solid):
    """A round cylinder or tube centred at `at`, its axis along the direction `along`; `bore` is the diameter of a concentric hole.

    `subtract`: it is a hole, see `Body`.
    """

    material: str
    diameter: Annotated[Number, LENGTH, POSITIVE]
    length: Annotated[Number, LENGTH, POSITIVE]
    at: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    along: Annotated[Vector, DIRECTION] = (0.0, 0.0, 1.0)
    bore: Annotated[Number, LENGTH, POSITIVE] | None = None
    subtract: bool = False

    @property
    def sides(self) -> Array:
        """Length, and twice the diameter."""
        return stack((self.length, self.diameter, self.diameter))

    @property
    def frame(self) -> Frame:
        """x along its axis."""
        return Frame(axes(self.along), stack(self.at))

    @property
    def thinnest(self) -> Number:
        """Its length, its diameter or its wall."""
        wall = self.diameter if self.bore is None else 0.5 * (self.diameter - self.bore)
        return np.minimum(np.real(wall), np.real(self.length))

    @property
    def is_flat(self) -> bool:
        """It is round."""
        return False

    @property
    def orders(self) -> Iterator[Order]:
        """Its bore is smaller than itself."""
        yield Order("bore", self.bore, self.diameter, "the diameter", "Make the bore smaller")

    def contains(self, points: Array, slack: float) -> Array:
        """Which points lie in its wall."""
        length, diameter, _ = first_design(np.real(self.sides), 1)
        radii = np.hypot(points[:, 1], points[:, 2])
        bore = 0.0 if self.bore is None else 0.5 * single(self.bore)
        return (np.abs(points[:, 0]) <= 0.5 * length + slack) & (radii <= 0.5 * diameter + slack) & (radii >= bore - slack)


@dataclass(frozen=True, eq=False)
class Extrusion(Solid):
    """A polygon drawn out over a `height`: its corners `outline` (x, y) in a plane through `at`, half of the height on either side of it.

    x of the outline runs along the direction `along`, the height along `up` (perpendicular to `along`). The corners go round the polygon
    either way, its sides do not cross. `subtract`: it is a hole, see `Body`.

    >>> corner = Extrusion("steel", outline=((0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 3.0), (0.0, 3.0)), height=1.0)
    >>> corner.sides.tolist(), corner.frame.position.tolist()
    ([2.0, 3.0, 1.0], [1.0, 1.5, 0.0])
    """

    TOLD_BY: ClassVar[tuple[str, str]] = ("shape", "extrusion")
    material: str
    outline: tuple[Annotated[tuple[Number, Number], LENGTH], ...]
    height: Annotated[Number, LENGTH, POSITIVE]
    at: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    along: Annotated[Vector, DIRECTION] = (1.0, 0.0, 0.0)
    up: Annotated[Vector, DIRECTION] = (0.0, 0.0, 1.0)
    subtract: bool = False

    @property
    def _drawn(self) -> Array:
        return np.moveaxis(np.stack(np.broadcast_arrays(*(stack(corner) for corner in self.outline))), 0, -2)

    @property
    def _ends(self) -> tuple[Array, Array]:
        """The least and the largest x and y (..., 2)."""
        drawn = self._drawn
        least, largest = (find(np.real(drawn), axis=-2, keepdims=True) for find in (np.argmin, np.argmax))
        return np.take_along_axis(drawn, least, axis=-2)[..., 0, :], np.take_along_axis(drawn, largest, axis=-2)[..., 0, :]

    @property
    def corners(self) -> Array:
        """Its corners (..., n, 2) from the centre of the box around it, counter-clockwise seen from above (in the first design) [m]."""
        least, largest = self._ends
        centred = self._drawn - 0.5 * (least + largest)[..., None, :]
        return centred if winding(first_design(np.real(centred), 2)) > 0.0 else centred[..., ::-1, :]

    @property
    def sides(self) -> Array:
        """The box around it."""
        least, largest = self._ends
        size = largest - least
        return stack((size[..., 0], size[..., 1], self.height))

    @property
    def frame(self) -> Frame:
        """Axes along those of its outline, z along its height."""
        least, largest = self._ends
        middle = 0.5 * (least + largest)
        own = Frame(axes(self.along, self.up), stack(self.at))
        return Frame(own.rotation, own.point(stack((middle[..., 0], middle[..., 1], 0.0))))

    @property
    def mirrored(self) -> Extrusion:
        """The outline with its y reversed."""
        return replace(self, outline=tuple((x, -y) for x, y in self.outline))

    @property
    def thinnest(self) -> Number:
        """Its height, or the least distance of a corner from a side that does not end there, in the first design."""
        corners = first_design(np.real(self.corners), 2)
        begin, run = corners, np.roll(corners, -1, axis=0) - corners
        share = np.clip(np.einsum("ijx,jx->ij", corners[:, None] - begin, run) / np.sum(run * run, axis=1), 0.0, 1.0)
        gaps = np.linalg.norm(corners[:, None] - begin - share[..., None] * run, axis=-1)
        count = len(corners)
        apart = (np.arange(count)[:, None] != np.arange(count)) & (np.arange(count)[:, None] != (np.arange(count) + 1) % count)
        return min(float(np.min(gaps[apart])), single(self.height))

    def contains(self, points: Array, slack: float) -> Array:
        """Which points lie in its outline, or near one of its sides, and within its height."""
        corners = first_design(np.real(self.corners), 2)
        level = np.abs(points[:, 2]) <= 0.5 * single(self.height) + slack
        return level & within_polygon(points[:, :2], corners, slack)


@dataclass(frozen=True, eq=False)
class Sphere(Solid):
    """A ball centred at `at`. `subtract`: it is a hollow, see `Body`."""

    TOLD_BY: ClassVar[tuple[str, str]] = ("shape", "sphere")
    material: str
    diameter: Annotated[Number, LENGTH, POSITIVE]
    at: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    subtract: bool = False

    @property
    def sides(self) -> Array:
        """Three times the diameter."""
        return stack((self.diameter, self.diameter, self.diameter))

    @property
    def frame(self) -> Frame:
        """The axes of the frame it is drawn in."""
        return Frame(np.eye(3), stack(self.at))

    @property
    def is_flat(self) -> bool:
        """It is round."""
        return False

    def contains(self, points: Array, slack: float) -> Array:
        """Which points lie no farther from its centre than its radius."""
        return np.linalg.norm(points, axis=1) <= 0.5 * single(self.diameter) + slack


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

    @property
    def mirrored(self) -> Inertia:
        """That of the image in the plane across y."""
        return replace(self, xy=-self.xy, yz=-self.yz)


def across(vector: Vector) -> Vector:
    """The image of a place or a direction in the plane across y.

    >>> across((1.0, 2.0, 3.0))
    (1.0, -2.0, 3.0)
    """
    return (vector[0], -vector[1], vector[2])


@dataclass(frozen=True, eq=False)
class Imported(Solid):
    """A solid drawn elsewhere: the STEP `file`, its origin at `at`, its x axis along `along`, its z axis along `up`.

    What models with rigid bodies need is stated, in the file's own axes: the sides (`size`) and the `middle` of the box around the solid,
    its `mass`, `centre` of mass and `inertia` about that. The solid model holds them to the file (0.1 %). `sha256`, the digest of the
    file's bytes, says which version of it is meant and stands for it in caches. `wall` is the thinnest wall, for the mesh (absent: the
    shortest side). A relative path is looked for from the design file. Of a file that holds several solids, `solid` names the one meant, by
    its name there or by its place among them: `#2`. `reflected`: it is the mirror image of the file's solid across its x-z plane, as are
    the middle, the centre and the inertia that are stated.
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
    solid: str | None = None
    reflected: bool = False

    @property
    def mirrored(self) -> Imported:
        """Its image in the plane across y."""
        middle, centre, inertia = across(self.middle), across(self.centre), self.inertia.mirrored
        return replace(self, middle=middle, centre=centre, inertia=inertia, reflected=not self.reflected)

    @property
    def sides(self) -> Array:
        """Those of the box around it."""
        return stack(self.size)

    @property
    def frame(self) -> Frame:
        """The file's axes, at the middle of the box around it."""
        frame = Frame(axes(self.along, self.up), stack(self.at))
        return Frame(frame.rotation, frame.point(stack(self.middle)))

    @property
    def thinnest(self) -> Number:
        """Its thinnest wall where that is stated."""
        return super().thinnest if self.wall is None else self.wall

    @property
    def orders(self) -> Iterator[Order]:
        """Its thinnest wall is not thicker than itself."""
        for side in self.size:
            yield Order("wall", self.wall, side, "the sides of the box around it", "Give the thinnest wall", strict=False)


@dataclass(frozen=True, eq=False)
class Pierced(Solid):
    """A `solid` with the `holes` that others of its body leave in it, these drawn in the frame of its centre."""

    solid: Solid
    holes: tuple[Solid, ...]

    @property
    def material(self) -> str:  # type: ignore[override]
        """That of the solid."""
        return self.solid.material

    @property
    def sides(self) -> Array:
        """Those of the solid."""
        return self.solid.sides

    @property
    def frame(self) -> Frame:
        """That of the solid."""
        return self.solid.frame

    @property
    def thinnest(self) -> Number:
        """The solid's, or the least size of a hole."""
        return min(single(self.solid.thinnest), *(single(hole.thinnest) for hole in self.holes))

    @property
    def is_flat(self) -> bool:
        """Whether all of its faces are plane."""
        return self.solid.is_flat and all(hole.is_flat for hole in self.holes)

    @property
    def drawn(self) -> Iterator[tuple[Solid, Frame]]:
        """The solid and its holes, with the frames that they are drawn in."""
        yield self.solid, Frame(np.eye(3), np.zeros(3))
        yield from ((hole, self.solid.frame) for hole in self.holes)

    def contains(self, points: Array, slack: float) -> Array:
        """Which points lie in the solid and in none of its holes."""
        inside = self.solid.contains(points, slack)
        return inside & ~np.any([_holds(hole, points, -slack) for hole in self.holes], axis=0)


def _holds(hole: Solid, points: Array, slack: float) -> Array:
    """Which points of the frame that a hole is drawn in lie in it."""
    place, turn = first_design(np.real(hole.frame.position), 1), first_design(np.real(hole.frame.rotation), 2)
    return hole.contains((points - place) @ turn, slack)


@dataclass(frozen=True, eq=False)
class PlacedSolid:
    """A solid and its own frame in the frame of the body, or of the stage, that it belongs to.

    The frame's origin is the solid's centre, its axes a block's edges (z along its hole), or x a cylinder's axis.
    """

    solid: Solid
    frame: Frame


def pierce(solids: Mapping[str, PlacedSolid]) -> dict[str, PlacedSolid]:
    """Solids of one body by name: those that remove material as holes in the others.

    >>> plate, bolt = Block("steel", (0.1, 0.1, 0.01)), Cylinder("steel", 0.005, 0.02, subtract=True)
    >>> placed = {"plate": PlacedSolid(plate, plate.frame), "bolt": PlacedSolid(bolt, bolt.frame)}
    >>> [type(each.solid).__name__ for each in pierce(placed).values()]
    ['Pierced']
    """
    holes = [item for item in solids.values() if item.solid.subtract]
    return {name: _pierced(item, holes) for name, item in solids.items() if not item.solid.subtract}


def _pierced(item: PlacedSolid, holes: list[PlacedSolid]) -> PlacedSolid:
    solid, frame = item.solid, item.frame
    own = [_seen_from(hole, frame) for hole in holes if hole.solid.material == solid.material and _meet(item, hole)]
    return PlacedSolid(Pierced(solid, tuple(own)), frame) if own and not isinstance(solid, Imported) else item


def _meet(one: PlacedSolid, other: PlacedSolid) -> bool:
    """Whether the balls around the boxes of two solids meet in a design."""
    apart = np.linalg.norm(np.real(one.frame.position - other.frame.position), axis=-1)
    reach = sum(0.5 * np.linalg.norm(np.real(each.solid.sides), axis=-1) for each in (one, other))
    return bool(np.any(apart < reach))


def _seen_from(placed: PlacedSolid, frame: Frame) -> Solid:
    """A hole drawn anew in another frame."""
    hole, place = placed.solid, placed.frame
    turn, own = np.swapaxes(frame.rotation, -1, -2), hole.frame
    moved = place.rotation @ np.swapaxes(own.rotation, -1, -2)
    origin = place.position + (moved @ (stack(hole.at) - own.position)[..., None])[..., 0]
    changes = {"at": (turn @ (origin - frame.position)[..., None])[..., 0]}
    for name in ("along", "up"):
        if hasattr(hole, name):
            changes[name] = (turn @ moved @ stack(getattr(hole, name))[..., None])[..., 0]
    return replace(hole, **{name: tuple(np.moveaxis(value, -1, 0)) for name, value in changes.items()})  # type: ignore[type-var]


def winding(corners: Array) -> float:
    """Twice the signed area of a polygon's corners (n, 2), positive where they go round counter-clockwise.

    >>> winding(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    1.0
    """
    ahead = np.roll(corners, -1, axis=0)
    return float(np.sum(corners[:, 0] * ahead[:, 1] - corners[:, 1] * ahead[:, 0]))


def triangles(corners: Array) -> list[tuple[int, int, int]]:
    """The corners of triangles that fill a simple polygon (n, 2), counter-clockwise: ears cut off one by one (Meisters 1975).

    >>> triangles(np.array([[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]]))
    [(0, 2, 3), (0, 1, 2)]
    """
    left, found = list(range(len(corners))), []
    while len(left) > 3:
        ears = [_ear(corners, left, place) for place in range(len(left))]
        place = int(np.argmax(ears))
        found.append((left[place - 1], left[place], left[(place + 1) % len(left)]))
        del left[place]
    return [(left[0], left[1], left[2]), *found]


def _ear(corners: Array, left: list[int], place: int) -> float:
    """How good an ear a corner of what is left is: the least sine of its triangle's angles; below 0: none."""
    trio = corners[[left[place - 1], left[place], left[(place + 1) % len(left)]]]
    runs = np.roll(trio, -1, axis=0) - trio
    lengths = np.linalg.norm(runs, axis=1)
    area = winding(trio)
    others = corners[[number for number in left if not np.any(np.all(corners[number] == trio, axis=1))]]
    sides = runs[:, None, 0] * (others[:, 1] - trio[:, None, 1]) - runs[:, None, 1] * (others[:, 0] - trio[:, None, 0])
    if area <= 0.0 or np.any(np.all(sides >= 0.0, axis=0)):
        return -1.0
    return float(np.min(area / (lengths * np.roll(lengths, 1))))


def within_polygon(points: Array, corners: Array, slack: float) -> Array:
    """Which points (n, 2) lie within a polygon of corners (k, 2), by the crossings of a ray, or within `slack` of one of its sides.

    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> within_polygon(np.array([[0.5, 0.5], [1.5, 0.5], [1.05, 0.5]]), square, 0.1).tolist()
    [True, False, True]
    """
    run = np.roll(corners, -1, axis=0) - corners
    arm = points[:, None] - corners
    above, ahead = arm[..., 1] >= 0.0, arm[..., 1] < run[:, 1]
    crosses = above == ahead
    left = run[:, 0] * arm[..., 1] - run[:, 1] * arm[..., 0]
    inside = np.sum(crosses & ((left > 0.0) == (run[:, 1] > 0.0)), axis=1) % 2 == 1
    share = np.clip(np.sum(arm * run, axis=-1) / np.sum(run * run, axis=-1), 0.0, 1.0)
    near = np.min(np.linalg.norm(arm - share[..., None] * run, axis=-1), axis=1) <= abs(slack)
    return inside | near if slack >= 0.0 else inside & ~near


SOLIDS: tuple[type[Solid], ...] = (Block, Cylinder, Extrusion, Sphere, Imported)
"""What a body may be drawn of."""


@dataclass(frozen=True, eq=False)
class Body(Description):
    """A rigid body: `solids` (outlines with materials), or a stated `mass`, `centre` of mass and `inertia`; named `points`.

    Solids that `subtract` are holes: they take away what lies in them of the body's other solids of their material.
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
