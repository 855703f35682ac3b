"""Mass, centre of mass and inertia of rigid bodies, from outlines and density, or as specified."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.number import Array, Number, stack
from flexstage.base.session import SESSION
from flexstage.parts.body import Block, Body, Cylinder, Extrusion, Imported, Inertia, Solid, SolidWithHoles, Sphere
from flexstage.parts.material import Material
from flexstage.parts.union import Drawn, Moments, common_moments, polygon_moments
from flexstage.spatial.frame import Frame, identity


@dataclass(frozen=True, eq=False)
class MassProperties:
    """Mass [kg], centre of mass (..., 3) [m] and inertia tensor about it (..., 3, 3) [kg m^2], in the body's drawing frame."""

    mass: Array
    centre: Array
    inertia: Array


def mass_properties(body: Body, materials: Mapping[str, Material], name: str = "") -> MassProperties | None:
    """Compute mass properties of a body; `None` if the body has neither a specified mass nor solids.

    >>> block = Block("steel", size=(0.1, 0.1, 0.01))
    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> round(float(mass_properties(Body(solids={"plate": block}), {"steel": steel}).mass), 9)
    0.775
    """
    if body.mass is not None:
        centre = stack(body.centre or (0.0, 0.0, 0.0))
        inertia = tensor(body.inertia) if body.inertia is not None else np.zeros((3, 3))
        return MassProperties(np.asarray(body.mass), centre, inertia)
    if not body.solids:
        return None
    return _drawn_mass(body, tuple((key, materials[key]) for key in dict.fromkeys(each.material for each in body.solids.values())), name)


@SESSION.keep(32)
def _drawn_mass(body: Body, materials: tuple[tuple[str, Material], ...], name: str) -> MassProperties:
    """Mass of solids, cached: descriptions with different links share bodies."""
    return union_properties(drawn_solids(body, dict(materials), name, identity()))


def drawn_solids(body: Body, materials: Mapping[str, Material], name: str, frame: Frame) -> list[Drawn]:
    """Return the solids of a body, each with its address and density, drawn in a `frame`.

    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> drawn_solids(Body(solids={"plate": Block("steel", size=(0.1, 0.1, 0.01))}), {"steel": steel}, "platform", identity())[0].name
    'platform.plate'
    """
    prefix = f"{name}." if name else ""
    return [Drawn(f"{prefix}{key}", solid, materials[solid.material].density, frame) for key, solid in body.solids.items()]


def union_properties(solids: Sequence[Drawn], meant: Sequence[Drawn] | None = None) -> MassProperties:
    """Compute mass properties of the union of solids, in the frame in which the solids are drawn.

    If `meant` contains the solids at their nominal positions, the common volumes of the solids are computed at these positions.

    >>> half = Block("steel", size=(1.0, 1.0, 1.0))
    >>> float(union_properties([Drawn("a", half, 2.0, identity()), Drawn("b", half, 2.0, identity())]).mass)
    2.0
    """
    own = [within(solid_properties(each.solid, each.density), each.frame) for each in solids if not each.solid.subtract]
    return combine([*own, *(of_moments(density, moments) for density, moments in common_moments(meant or solids))])


def of_moments(density: Number, moments: Moments) -> MassProperties:
    """Compute mass properties of a region of uniform density rho [kg/m^3] from its moments.

    The inertia tensor about the centre is J = rho (tr(S) I - S), with the second moments S of the volume about its centre and the unit
    matrix I.

    >>> of_moments(3.0, Moments(np.array(2.0), np.zeros(3), np.eye(3))).inertia.diagonal().tolist()
    [6.0, 6.0, 6.0]
    """
    safe = np.where(np.real(moments.volume) == 0.0, 1.0, moments.volume)
    centre = moments.first / safe[..., None]
    central = moments.second - _outer(moments.first, centre)
    weight = np.asarray(density)
    return MassProperties(weight * moments.volume, centre, weight[..., None, None] * _about(central))


def combine(items: list[MassProperties]) -> MassProperties:
    """Combine mass properties of rigidly connected bodies.

    >>> point = MassProperties(np.array(1.0), np.array([1.0, 0, 0]), np.zeros((3, 3)))
    >>> other = MassProperties(np.array(1.0), np.array([-1.0, 0, 0]), np.zeros((3, 3)))
    >>> combine([point, other]).inertia.diagonal().tolist()
    [0.0, 2.0, 2.0]
    """
    if len(items) == 1:
        return items[0]
    mass = sum((item.mass for item in items), np.asarray(0.0))
    moment = sum((item.mass[..., None] * item.centre for item in items), np.zeros(3))
    safe = np.where(np.real(mass) > 0.0, mass, 1.0)
    centre = moment / safe[..., None]
    middle = np.real(centre)  # inertia is least about the centre: no first-order change by a complex step
    arms = [item.centre - middle for item in items]
    own = sum((item.inertia for item in items), np.zeros((3, 3)))
    spread = sum((_outer(item.mass[..., None] * arm, arm) for item, arm in zip(items, arms, strict=True)), np.zeros((3, 3)))
    return MassProperties(mass, centre, own + _about(spread))


def _outer(one: Array, other: Array) -> Array:
    return one[..., :, None] * other[..., None, :]


def _about(second: Array) -> Array:
    """Inertia of a second moment (..., 3, 3): tr S I - S."""
    result, (xx, yy, zz) = -second, np.moveaxis(np.diagonal(second, axis1=-2, axis2=-1), -1, 0)
    result[..., range(3), range(3)] = np.stack([yy + zz, xx + zz, xx + yy], axis=-1)
    return result


def tensor(inertia: Inertia) -> Array:
    """Return the 3x3 inertia tensor from the moments and products of inertia.

    >>> tensor(Inertia(xx=1.0, yy=2.0, zz=3.0, xy=0.5)).tolist()
    [[1.0, -0.5, -0.0], [-0.5, 2.0, -0.0], [-0.0, -0.0, 3.0]]
    """
    xy, xz, yz = -inertia.xy, -inertia.xz, -inertia.yz
    return stack(((inertia.xx, xy, xz), (xy, inertia.yy, yz), (xz, yz, inertia.zz)))


def solid_properties(solid: Solid, density: Number) -> MassProperties:
    """Compute mass properties of one solid of uniform `density` [kg/m^3]. For an imported solid, the specified properties are used.

    >>> float(solid_properties(Cylinder("steel", diameter=2.0, length=1.0), 1.0).mass.round(12))
    3.14159265359
    """
    if isinstance(solid, SolidWithHoles):
        return union_properties([Drawn("", each, density, frame) for each, frame in solid.drawn])
    if isinstance(solid, Imported):
        own = MassProperties(np.asarray(solid.mass), stack(solid.centre) - stack(solid.middle), tensor(solid.inertia))
    elif isinstance(solid, Extrusion):
        own = of_moments(density, polygon_moments(solid.corners, np.asarray(solid.height)))
    else:
        mass, diagonal = _DIAGONALS[type(solid)](solid, density)
        own = MassProperties(mass, np.zeros(3), diagonal[..., None] * np.eye(3))
    return within(own, solid.frame)


def within(properties: MassProperties, frame: Frame) -> MassProperties:
    """Transform mass properties to the parent frame of `frame`, whose rotation R changes the inertia tensor J to R J R^T.

    >>> point = MassProperties(np.array(1.0), np.array([1.0, 0.0, 0.0]), np.diag([0.0, 1.0, 2.0]))
    >>> quarter = Frame(np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3))
    >>> turned = within(point, quarter)
    >>> turned.centre.tolist(), turned.inertia.diagonal().tolist()
    ([0.0, 1.0, 0.0], [1.0, 0.0, 2.0])
    """
    if np.array_equal(frame.rotation, np.eye(3)):
        return MassProperties(properties.mass, frame.position + properties.centre, properties.inertia)
    inertia = frame.rotation @ properties.inertia @ frame.rotation.mT
    return MassProperties(properties.mass, frame.point(properties.centre), inertia)


def _block(solid: Block, density: Number) -> tuple[Array, Array]:
    """Mass and principal moments along the edges of a block."""
    length, width, height = solid.size
    mass, diagonal = _cuboid(density, length, width, height)
    if solid.hole is not None:
        hole_mass, hole_diagonal = _cuboid(density, solid.hole[0], solid.hole[1], height)
        mass, diagonal = mass - hole_mass, diagonal - hole_diagonal
    return mass, diagonal


def _cuboid(density: Number, length: Number, width: Number, height: Number) -> tuple[Array, Array]:
    mass = np.asarray(density * length * width * height)
    squares = (width**2 + height**2, length**2 + height**2, length**2 + width**2)
    return mass, mass[..., None] / 12.0 * stack(squares)


def _cylinder(solid: Cylinder, density: Number) -> tuple[Array, Array]:
    """Mass and principal moments, the axis first."""
    mass, along, across = _round(density, solid.diameter, solid.length)
    if solid.bore is not None:
        less, less_along, less_across = _round(density, solid.bore, solid.length)
        mass, along, across = mass - less, along - less_along, across - less_across
    return np.asarray(mass), stack((along, across, across))


def _sphere(solid: Sphere, density: Number) -> tuple[Array, Array]:
    mass = np.asarray(density * np.pi / 6.0 * solid.diameter**3)
    moment = mass * solid.diameter**2 / 10.0
    return mass, stack((moment, moment, moment))


_DIAGONALS: Mapping[type[Solid], Callable[[Any, Number], tuple[Array, Array]]] = {Block: _block, Cylinder: _cylinder, Sphere: _sphere}


def _round(density: Number, diameter: Number, length: Number) -> tuple[Number, Number, Number]:
    mass = density * np.pi / 4.0 * diameter**2 * length
    return mass, mass * diameter**2 / 8.0, mass * (diameter**2 / 16.0 + length**2 / 12.0)
