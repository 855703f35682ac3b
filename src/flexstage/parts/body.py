"""Rigid bodies: mass properties as specified, or computed from solid outlines and densities."""

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
    """Solid component of a body, of one `material`. The geometry of a solid refers to a local frame at its centre.

    In the local frame, a cylinder's axis is x; the height of a block or an extrusion is along z.
    """

    material: str
    at: Vector
    subtract: bool = False

    @property
    def sides(self) -> Array:
        """Side lengths (..., 3) [m] of the bounding box along its axes."""
        raise NotImplementedError

    @property
    def frame(self) -> Frame:
        """Frame of the solid relative to the drawing frame, with its origin at the centre of the bounding box."""
        raise NotImplementedError

    @property
    def thinnest(self) -> Number:
        """Smallest dimension [m], for the mesh size."""
        return np.min(np.real(self.sides), axis=-1)

    @property
    def is_flat(self) -> bool:
        """Whether all faces are plane."""
        return True

    @property
    def orders(self) -> Iterator[Order]:
        """Required inequalities between the solid's numbers."""
        yield from ()

    @property
    def mirrored(self) -> Solid:
        """Mirror image in the x-z plane of the drawing frame; the solid itself if it is symmetric."""
        return self

    def contains(self, points: Array, slack: float) -> Array:
        """Return a mask of the points (n, 3), in the solid's frame, that are in the first design's solid or within `slack` [m] of it."""
        half = 0.5 * first_design(np.real(self.sides), 1)
        return np.all(np.abs(points) <= half + slack, axis=1)


@dataclass(frozen=True, eq=False)
class Block(Solid):
    """Rectangular block centred at `at`, x edge along `along`, z edge along `up` (perpendicular to `along`).

    By default, its edges are parallel to the axes of the drawing frame. `hole` gives the side lengths (x, y) [m] of a centred rectangular
    through hole along the block's z edge. If `subtract`, the block is a hole (see `Body`).
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
        """Side lengths (..., 3) [m]."""
        return stack(self.size)

    @property
    def frame(self) -> Frame:
        """Frame with axes along the edges of the block.

        >>> upright = Block("steel", size=(0.3, 0.2, 0.1), at=(0.0, 0.0, 1.0), along=(0.0, 0.0, 1.0), up=(1.0, 0.0, 0.0))
        >>> upright.frame.rotation.T.tolist()  # x edge up, y edge = up x along, z edge along the body's x
        [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]]
        """
        return Frame(axes(self.along, self.up), stack(self.at))

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the hole is smaller than the block."""
        for name, hole, size in zip("xy", self.hole or (), self.size, strict=False):
            yield Order(f"hole.{name}", hole, size, "the size of the block", "Make the hole smaller")

    def contains(self, points: Array, slack: float) -> Array:
        """Return a mask of the points in the block, outside its through hole."""
        within = super().contains(points, slack)
        if self.hole is not None:
            hole = 0.5 * first_design(np.real(stack(self.hole)), 1)
            within &= np.any(np.abs(points[:, :2]) >= hole - slack, axis=1)
        return within


@dataclass(frozen=True, eq=False)
class Cylinder(Solid):
    """Round cylinder or tube centred at `at`, axis along `along`; `bore` is the diameter of a concentric hole.

    If `subtract`, the cylinder is a hole (see `Body`).
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
        """Side lengths (..., 3) [m] of the bounding box: length, diameter, diameter."""
        return stack((self.length, self.diameter, self.diameter))

    @property
    def frame(self) -> Frame:
        """Frame with the x axis along the cylinder's axis."""
        return Frame(axes(self.along), stack(self.at))

    @property
    def thinnest(self) -> Number:
        """Smallest dimension [m]: the smaller of length and diameter, or of length and wall thickness for a tube."""
        wall = self.diameter if self.bore is None else 0.5 * (self.diameter - self.bore)
        return np.minimum(np.real(wall), np.real(self.length))

    @property
    def is_flat(self) -> bool:
        """False: its lateral surface is curved."""
        return False

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the bore is smaller than the diameter."""
        yield Order("bore", self.bore, self.diameter, "the diameter", "Make the bore smaller")

    def contains(self, points: Array, slack: float) -> Array:
        """Return a mask of the points in the cylinder or the wall of the tube."""
        length, diameter, _ = first_design(np.real(self.sides), 1)
        radii = np.hypot(points[:, 1], points[:, 2])
        bore = 0.0 if self.bore is None else 0.5 * single(self.bore)
        return (np.abs(points[:, 0]) <= 0.5 * length + slack) & (radii <= 0.5 * diameter + slack) & (radii >= bore - slack)


@dataclass(frozen=True, eq=False)
class Extrusion(Solid):
    """Polygon with the corners `outline` (x, y) in a plane through `at`, extruded by half of the `height` to each side of the plane.

    The x axis of the outline is along `along`, the height along `up` (perpendicular to `along`). The corners may be in clockwise or
    counter-clockwise order; the sides must not cross. If `subtract`, the extrusion is a hole (see `Body`).

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
        """Least and largest x and y (..., 2)."""
        drawn = self._drawn
        least, largest = (find(np.real(drawn), axis=-2, keepdims=True) for find in (np.argmin, np.argmax))
        return np.take_along_axis(drawn, least, axis=-2)[..., 0, :], np.take_along_axis(drawn, largest, axis=-2)[..., 0, :]

    @property
    def corners(self) -> Array:
        """Corners (..., n, 2) [m] relative to the centre of the bounding box, counter-clockwise as seen from +z (first design)."""
        least, largest = self._ends
        centred = self._drawn - 0.5 * (least + largest)[..., None, :]
        return centred if winding(first_design(np.real(centred), 2)) > 0.0 else centred[..., ::-1, :]

    @property
    def sides(self) -> Array:
        """Side lengths (..., 3) [m] of the bounding box."""
        least, largest = self._ends
        size = largest - least
        return stack((size[..., 0], size[..., 1], self.height))

    @property
    def frame(self) -> Frame:
        """Frame with the axes x and y of the outline, and z along the height."""
        least, largest = self._ends
        middle = 0.5 * (least + largest)
        own = Frame(axes(self.along, self.up), stack(self.at))
        return Frame(own.rotation, own.point(stack((middle[..., 0], middle[..., 1], 0.0))))

    @property
    def mirrored(self) -> Extrusion:
        """Extrusion of the outline with y reversed."""
        return replace(self, outline=tuple((x, -y) for x, y in self.outline))

    @property
    def thinnest(self) -> Number:
        """Smallest dimension [m] of the first design: the height, or the distance of a corner from a non-adjacent side."""
        corners = first_design(np.real(self.corners), 2)
        begin, run = corners, np.roll(corners, -1, axis=0) - corners
        share = np.clip(np.einsum("ijx,jx->ij", corners[:, None] - begin, run) / np.sum(run * run, axis=1), 0.0, 1.0)
        gaps = np.linalg.norm(corners[:, None] - begin - share[..., None] * run, axis=-1)
        count = len(corners)
        apart = (np.arange(count)[:, None] != np.arange(count)) & (np.arange(count)[:, None] != (np.arange(count) + 1) % count)
        return min(float(np.min(gaps[apart])), single(self.height))

    def contains(self, points: Array, slack: float) -> Array:
        """Return a mask of the points (n, 3) that are in the first design's extrusion or within `slack` [m] of it."""
        corners = first_design(np.real(self.corners), 2)
        level = np.abs(points[:, 2]) <= 0.5 * single(self.height) + slack
        return level & within_polygon(points[:, :2], corners, slack)


@dataclass(frozen=True, eq=False)
class Sphere(Solid):
    """Ball centred at `at`. If `subtract`, the ball is a cavity (see `Body`)."""

    TOLD_BY: ClassVar[tuple[str, str]] = ("shape", "sphere")
    material: str
    diameter: Annotated[Number, LENGTH, POSITIVE]
    at: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    subtract: bool = False

    @property
    def sides(self) -> Array:
        """Side lengths (..., 3) [m] of the bounding box: the diameter along all axes."""
        return stack((self.diameter, self.diameter, self.diameter))

    @property
    def frame(self) -> Frame:
        """Frame with the axes of the drawing frame."""
        return Frame(np.eye(3), stack(self.at))

    @property
    def is_flat(self) -> bool:
        """False, because a ball's surface is curved."""
        return False

    def contains(self, points: Array, slack: float) -> Array:
        """Return a mask of the points in the ball."""
        return np.linalg.norm(points, axis=1) <= 0.5 * single(self.diameter) + slack


@dataclass(frozen=True, eq=False)
class Inertia(Description):
    """Moments and products of inertia about the centre of mass, along the axes of the body's drawing frame [kg m^2].

    The products are the integrals of x y, x z, y z over the mass (the off-diagonal entries of the inertia tensor are the negatives of the
    products).
    """

    xx: Annotated[Number, INERTIA, NOT_NEGATIVE]
    yy: Annotated[Number, INERTIA, NOT_NEGATIVE]
    zz: Annotated[Number, INERTIA, NOT_NEGATIVE]
    xy: Annotated[Number, INERTIA] = 0.0
    xz: Annotated[Number, INERTIA] = 0.0
    yz: Annotated[Number, INERTIA] = 0.0

    @property
    def mirrored(self) -> Inertia:
        """Inertia of the mirror image in the x-z plane."""
        return replace(self, xy=-self.xy, yz=-self.yz)


def across(vector: Vector) -> Vector:
    """Return the mirror image of a point or a direction in the x-z plane.

    >>> across((1.0, 2.0, 3.0))
    (1.0, -2.0, 3.0)
    """
    return (vector[0], -vector[1], vector[2])


@dataclass(frozen=True, eq=False)
class Imported(Solid):
    """Solid imported from the STEP `file`, with its origin at `at`, x axis along `along`, z axis along `up`.

    Rigid-body models use specified values in the file's axes: `size` (sides) and `middle` of the bounding box, `mass`, `centre` of mass,
    and `inertia` about the centre of mass. The solid model compares these values with the file (tolerance 0.1 %). `sha256` is the digest of
    the file's bytes. The digest identifies the file's version, and caches use the digest instead of the file.

    `wall` is the thickness of the thinnest wall, for the mesh (default: the shortest side). A relative path is relative to the design file.
    If the file has several solids, `solid` selects one by name or number (`#2`). If `reflected`, the solid is the mirror image of the
    file's solid in the x-z plane of the file; `middle`, `centre` and `inertia` describe the mirror image.
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
        """Mirror image in the x-z plane."""
        middle, centre, inertia = across(self.middle), across(self.centre), self.inertia.mirrored
        return replace(self, middle=middle, centre=centre, inertia=inertia, reflected=not self.reflected)

    @property
    def sides(self) -> Array:
        """Side lengths (..., 3) [m] of the bounding box, as specified."""
        return stack(self.size)

    @property
    def frame(self) -> Frame:
        """Frame with the file's axes, at the centre of the bounding box."""
        frame = Frame(axes(self.along, self.up), stack(self.at))
        return Frame(frame.rotation, frame.point(stack(self.middle)))

    @property
    def thinnest(self) -> Number:
        """Thickness of the thinnest wall [m] as specified, else the shortest side."""
        return super().thinnest if self.wall is None else self.wall

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the wall is not thicker than the solid."""
        for side in self.size:
            yield Order("wall", self.wall, side, "the sides of its bounding box", "Use the thinnest wall", strict=False)


@dataclass(frozen=True, eq=False)
class SolidWithHoles(Solid):
    """Solid with `holes`, which are the subtracted solids of its body, drawn in the frame at the centre of this solid."""

    solid: Solid
    holes: tuple[Solid, ...]

    @property
    def material(self) -> str:  # type: ignore[override]
        """Material of the `solid`."""
        return self.solid.material

    @property
    def sides(self) -> Array:
        """Side lengths (..., 3) [m] of the `solid`."""
        return self.solid.sides

    @property
    def frame(self) -> Frame:
        """Frame of the `solid`."""
        return self.solid.frame

    @property
    def thinnest(self) -> Number:
        """Smallest dimension [m] of the solid and its holes."""
        return min(single(self.solid.thinnest), *(single(hole.thinnest) for hole in self.holes))

    @property
    def is_flat(self) -> bool:
        """Whether all faces are plane."""
        return self.solid.is_flat and all(hole.is_flat for hole in self.holes)

    @property
    def drawn(self) -> Iterator[tuple[Solid, Frame]]:
        """The solid and its holes, each one together with its drawing frame."""
        yield self.solid, Frame(np.eye(3), np.zeros(3))
        yield from ((hole, self.solid.frame) for hole in self.holes)

    def contains(self, points: Array, slack: float) -> Array:
        """Return a mask of the points in the solid, outside its holes."""
        inside = self.solid.contains(points, slack)
        return inside & ~np.any([_holds(hole, points, -slack) for hole in self.holes], axis=0)


def _holds(hole: Solid, points: Array, slack: float) -> Array:
    """Mask of points in a hole, in the hole's drawing frame."""
    place, turn = first_design(np.real(hole.frame.position), 1), first_design(np.real(hole.frame.rotation), 2)
    return hole.contains((points - place) @ turn, slack)


@dataclass(frozen=True, eq=False)
class PlacedSolid:
    """Solid with its frame relative to its body or the stage.

    The frame's origin is the solid's centre. For a block, the axes of the frame are along the edges, with z along the through hole. For a
    cylinder, x is along the cylinder's axis.
    """

    solid: Solid
    frame: Frame


def pierce(solids: Mapping[str, PlacedSolid]) -> dict[str, PlacedSolid]:
    """Return the solids of one body by name; each solid with `subtract` becomes a hole in the body's other solids of the same material.

    >>> plate, bolt = Block("steel", (0.1, 0.1, 0.01)), Cylinder("steel", 0.005, 0.02, subtract=True)
    >>> placed = {"plate": PlacedSolid(plate, plate.frame), "bolt": PlacedSolid(bolt, bolt.frame)}
    >>> [type(each.solid).__name__ for each in pierce(placed).values()]
    ['SolidWithHoles']
    """
    holes = [item for item in solids.values() if item.solid.subtract]
    return {name: _pierced(item, holes) for name, item in solids.items() if not item.solid.subtract}


def _pierced(item: PlacedSolid, holes: list[PlacedSolid]) -> PlacedSolid:
    solid, frame = item.solid, item.frame
    own = [_seen_from(hole, frame) for hole in holes if hole.solid.material == solid.material and _meet(item, hole)]
    return PlacedSolid(SolidWithHoles(solid, tuple(own)), frame) if own and not isinstance(solid, Imported) else item


def _meet(one: PlacedSolid, other: PlacedSolid) -> bool:
    """Whether the bounding spheres of two solids intersect in a design."""
    apart = np.linalg.norm(np.real(one.frame.position - other.frame.position), axis=-1)
    reach = sum(0.5 * np.linalg.norm(np.real(each.solid.sides), axis=-1) for each in (one, other))
    return bool(np.any(apart < reach))


def _seen_from(placed: PlacedSolid, frame: Frame) -> Solid:
    """A hole in another drawing frame."""
    hole, place = placed.solid, placed.frame
    turn, own = frame.rotation.mT, hole.frame
    moved = place.rotation @ own.rotation.mT
    origin = place.position + (moved @ (stack(hole.at) - own.position)[..., None])[..., 0]
    changes = {"at": (turn @ (origin - frame.position)[..., None])[..., 0]}
    for name in ("along", "up"):
        if hasattr(hole, name):
            changes[name] = (turn @ moved @ stack(getattr(hole, name))[..., None])[..., 0]
    return replace(hole, **{name: tuple(np.moveaxis(value, -1, 0)) for name, value in changes.items()})  # type: ignore[type-var]


def winding(corners: Array) -> float:
    """Return twice the signed area of a polygon's corners (n, 2), positive if counter-clockwise.

    >>> winding(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))
    1.0
    """
    ahead = np.roll(corners, -1, axis=0)
    return float(np.sum(corners[:, 0] * ahead[:, 1] - corners[:, 1] * ahead[:, 0]))


def triangles(corners: Array) -> list[tuple[int, int, int]]:
    """Triangulate a simple polygon with counter-clockwise corners (n, 2) by ear clipping (Meisters 1975).

    >>> triangles(np.array([[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]]))
    [(0, 2, 3), (0, 1, 2)]
    """
    left, result = list(range(len(corners))), []
    while len(left) > 3:
        ears = [_ear(corners, left, place) for place in range(len(left))]
        place = int(np.argmax(ears))
        result.append((left[place - 1], left[place], left[(place + 1) % len(left)]))
        del left[place]
    return [(left[0], left[1], left[2]), *result]


def _ear(corners: Array, left: list[int], place: int) -> float:
    """Quality of a corner of the remaining polygon as an ear: least sine of its triangle's angles; below 0: no ear."""
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
    """Return a mask of the points (n, 2) that are in the polygon with `corners` (k, 2) or within `slack` of its sides, by ray crossing.

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
"""Classes of the solids of a body, by shape."""


@dataclass(frozen=True, eq=False)
class Body(Description):
    """Rigid body with named `points`: either `solids` (outlines with materials), or a specified `mass`, `centre` of mass and `inertia`.

    Solids with `subtract` are holes: they remove their volume from the body's other solids of the same material. Specify either solids or
    mass properties; a body with neither is massless. If `point`, the specified mass is a point mass without inertia. `reference` is the
    reference point of the body's twist. The default reference point is the centre of mass; for a massless body, it is the mean position of
    the body's joints.

    `of` names another body of the stage, or the ground, that owns the solids of this body. Example: a lug that belongs to the platform is
    drawn in a unit, so that every instance of the unit adds one lug to the platform. A body with `of` does not move independently: its
    solids, mass, points and joints belong to the owner. A body with `of` has neither a specified mass nor a reference point.
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
    """Return the name of the moving body to which a named body belongs: the owner named in `of`, else the body itself.

    >>> owner_of({"pad": Body(of="platform")}, "pad"), owner_of({}, "ground")
    ('platform', 'ground')
    """
    body = bodies.get(name)
    return name if body is None or body.of is None else body.of


@dataclass(frozen=True, eq=False)
class Payload(Description):
    """Payload of a body: `mass`, its centre `at` (in the stage's frame) and its `inertia` about that centre.

    If `point`, the payload is a point mass without inertia.
    """

    body: str
    mass: Annotated[Number, MASS, NOT_NEGATIVE]
    at: Annotated[Vector, LENGTH]
    inertia: Inertia | None = None
    point: bool = field(default=False, metadata=DOCUMENT_ONLY)
