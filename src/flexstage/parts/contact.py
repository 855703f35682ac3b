"""Contacts: a preloaded ball in its seat, with linearised stiffness by Hertz and Mindlin.

Reference: K. L. Johnson, Contact Mechanics (Cambridge, 1985), chapters 4 and 7.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import Finding, refuse
from flexstage.base.number import Array, Number, stack
from flexstage.base.units.quantity import ANGLE, FORCE, LENGTH, POSITIVE, RATIO, Bound
from flexstage.parts.freedom import Freedom, others
from flexstage.parts.material import Material, Paired
from flexstage.parts.shape import Elastic
from flexstage.parts.stated import Stated

_HALF_ANGLE = Bound(0.0, 0.5 * np.pi, open_low=True, open_high=True)


class Seat(Enum):
    """Seat of a ball: a `FLAT`, or both walls of a V `GROOVE`."""

    FLAT = "flat"
    GROOVE = "groove"


@dataclass(frozen=True, eq=False)
class Contact(Elastic):
    """Ball of a `radius` pressed on its `seat`. The seat is a flat face normal to x, or a V groove along z with x as bisector.

    The first body has the seat, the second body the ball. The link's origin is the ball's centre; x points out of the seat. `material` is
    the ball's material, `counter` the seat's. `preload` is the initial compression force along x. A preload is required: a contact without
    preload has no stiffness. `half_angle` is the angle between a wall of the groove and x. `friction` is the friction coefficient for the
    slip check. The contact is massless: the mass of the ball belongs to its body.

    Ideal degrees of freedom without friction: translation along y and z on a flat seat, along z in a groove, and all three rotations.
    """

    kind: ClassVar[str] = "contact"
    material: str
    counter: str
    radius: Annotated[Number, LENGTH, POSITIVE]
    seat: Seat = Seat.FLAT
    half_angle: Annotated[Number, ANGLE, _HALF_ANGLE] | None = None
    preload: Annotated[Number, FORCE, POSITIVE] | None = None
    friction: Annotated[Number, RATIO, POSITIVE] | None = None

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degrees of freedom, without friction."""
        return others((Freedom.X,) if self.seat is Seat.FLAT else (Freedom.X, Freedom.Y))

    @property
    def is_axisymmetric(self) -> bool:
        """True for a flat seat."""
        return self.seat is Seat.FLAT

    @property
    def mirrored(self) -> Contact:
        """The contact itself, by symmetry."""
        return self

    def stated(self, material: Material | None) -> Stated | None:
        """Return the stiffness linearised about the preload, for the materials of ball and seat; the mass is zero."""
        return None if material is None else Stated(contact_stiffness(self, material), np.zeros((12, 12)))

    @property
    def push(self) -> Number | None:
        """Preload [N] with which the seat pushes the ball away."""
        return self.preload

    @property
    def faults(self) -> Iterator[Finding]:
        """Errors: no preload, or a groove angle inconsistent with the seat."""
        if self.preload is None:
            what = "preload missing: a contact without preload has no stiffness"
            yield Finding("preload", what, 'Specify the compression force along x: preload = "10 N"')
        if self.seat is Seat.GROOVE and self.half_angle is None:
            yield Finding("half_angle", "half angle of the groove missing", 'Specify the angle between a wall and x: half_angle = "45 deg"')
        if self.seat is Seat.FLAT and self.half_angle is not None:
            yield Finding("half_angle", "only a groove has a half angle (got a flat seat)", 'Remove half_angle, or use seat = "groove"')


@dataclass(frozen=True, eq=False)
class Hertz:
    """Hertzian contacts of a preloaded ball, each with `force` [N], contact radius `spot` [m], `normal` and `tangential` stiffness [N/m].

    `normals` (..., c, 3) of the c contacts point from the seat to the ball. `motion` (..., c, 3, 6) maps the twist of the ball's centre to
    the displacement at each contact.
    """

    force: Array
    spot: Array
    normal: Array
    tangential: Array
    normals: Array
    motion: Array

    @property
    def matrix(self) -> Array:
        """Stiffness matrix (..., c, 3, 3) of each contact."""
        across = self.normals[..., None, :].mT @ self.normals[..., None, :]
        normal, tangential = (each[..., None, None, None] for each in (self.normal, self.tangential))
        return normal * across + tangential * (np.eye(3) - across)


def hertz(part: Contact, material: Material) -> Hertz:
    """Compute the Hertzian contacts of a ball. A flat carries the preload F; each wall of a groove with half angle h carries F / (2 sin h).

    A ball of radius R and a seat with Young's moduli E1, E2, shear moduli G1, G2 and Poisson's ratios nu1, nu2 have the contact moduli E*
    and G*, with 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 and 1/G* = (2 - nu1)/G1 + (2 - nu2)/G2. For the force P of one contact, the contact
    radius is a = (3 P R / (4 E*))^(1/3), the normal stiffness is 2 E* a = (6 E*^2 R P)^(1/3), and the tangential stiffness without slip is
    8 a G*.

    Assumptions: isotropic materials, smooth faces, contact radius much smaller than the ball. Raises `DesignError` for a crystal, or if the
    seat's material is missing.
    """
    ball, counter = _both(part, material)
    normals = _normals(part)
    force = np.asarray(part.preload) / (1.0 if part.seat is Seat.FLAT else 2.0 * np.sin(np.asarray(part.half_angle)))
    modulus = 1.0 / sum((1.0 - each.contraction**2) / each.modulus for each in (ball, counter))
    shear = 1.0 / sum((2.0 - each.contraction) / each.shear for each in (ball, counter))
    spot = (0.75 * force * part.radius / modulus) ** (1.0 / 3.0)
    return Hertz(force, spot, 2.0 * modulus * spot, 8.0 * spot * shear, normals, _motion(normals, np.asarray(part.radius)))


def contact_stiffness(part: Contact, material: Material) -> Array:
    """Compute the stiffness (..., 6, 6) about the ball's centre: the sum over all contacts, without contact moments.

    On a flat, rolling and spinning about the contact point are free. The tangential stiffness multiplied by the radius couples rotation
    with translation of the ball's centre. The tangential stiffness multiplied by the square of the radius resists rotation.

    >>> steel = Material(young=210e9, poisson=0.3, density=7850.0)
    >>> ball = Contact("steel", "steel", radius=0.005, preload=10.0)
    >>> (contact_stiffness(ball, Paired.of(steel, steel)).diagonal()[:3] / 1e6).round(2).tolist()
    [15.87, 13.07, 13.07]
    """
    result = hertz(part, material)
    return np.sum(result.motion.mT @ result.matrix @ result.motion, axis=-3)


def _both(part: Contact, material: Material) -> tuple[Material, Material]:
    if not isinstance(material, Paired):
        what = f"material of its seat missing ({part.counter})"
        raise refuse(f"contact of {part.material}", what, "Pass Paired.of(ball, seat)")
    for name, each in ((part.material, material), (part.counter, material.counter)):
        if each.is_cubic:
            what = f"contacts require isotropic materials ({name} is a crystal)"
            raise refuse(f"contact of {part.material} on {part.counter}", what, 'Use the measured stiffness (kind = "spring")')
    return material, material.counter


def _normals(part: Contact) -> Array:
    if part.seat is Seat.FLAT:
        return np.array([[1.0, 0.0, 0.0]])
    angle = np.asarray(part.half_angle)
    along, across, none = np.sin(angle), np.cos(angle), np.zeros_like(angle)
    return np.stack([stack((along, across, none)), stack((along, -across, none))], axis=-2)


def _motion(normals: Array, radius: Array) -> Array:
    """u + theta x (-R n) = u + R n x theta."""
    x, y, z = np.moveaxis(normals, -1, 0)
    none = np.zeros_like(x)
    cross = np.stack([stack((none, -z, y)), stack((z, none, -x)), stack((-y, x, none))], axis=-2)
    turned = radius[..., None, None, None] * cross
    return np.concatenate([np.broadcast_to(np.eye(3), turned.shape), turned], axis=-1)
