"""Contacts by Hertz and Mindlin: the stiffness of a ball in its seat about its preload.

After K. L. Johnson, Contact Mechanics (Cambridge, 1985), chapters 4 and 7.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array, stack
from flexstage.beams.law import PartLaw
from flexstage.parts.contact import Contact, Seat
from flexstage.parts.material import Material, Paired


@dataclass(frozen=True, eq=False)
class Hertz:
    """Each contact of a ball under its share of the preload: `force` [N], `spot` radius a [m], stiffness `normal` and `tangential` [N/m].

    `normals` (..., c, 3) of the c contacts point from the seat to the ball, `motion` (..., c, 3, 6) is what the ball moves there per
    twist of its centre.
    """

    force: Array
    spot: Array
    normal: Array
    tangential: Array
    normals: Array
    motion: Array

    @property
    def matrix(self) -> Array:
        """Stiffness (..., c, 3, 3) of each contact."""
        across = np.swapaxes(self.normals[..., None, :], -1, -2) @ self.normals[..., None, :]
        normal, tangential = (each[..., None, None, None] for each in (self.normal, self.tangential))
        return normal * across + tangential * (np.eye(3) - across)


def hertz(part: Contact, material: Material) -> Hertz:
    """The contacts of a ball of radius R; a flat bears the preload F, each wall of a groove F / (2 sin h), h its half angle.

    1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, a = (3 F R / (4 E*))^(1/3), k_n = 2 E* a = (6 E*^2 R F)^(1/3); tangential, where all of the
    spot sticks, k_t = 8 a G*, 1/G* = (2 - nu1)/G1 + (2 - nu2)/G2. Isotropic materials, smooth faces, a spot much smaller than the ball.
    Raises `DesignError` for a crystal, and where the seat's material is not given.
    """
    ball, counter = _both(part, material)
    normals = _normals(part)
    force = np.asarray(part.preload) / (1.0 if part.seat is Seat.FLAT else 2.0 * np.sin(np.asarray(part.half_angle)))
    modulus = 1.0 / sum((1.0 - each.contraction**2) / each.modulus for each in (ball, counter))
    shear = 1.0 / sum((2.0 - each.contraction) / each.shear for each in (ball, counter))
    spot = (0.75 * force * part.radius / modulus) ** (1.0 / 3.0)
    return Hertz(force, spot, 2.0 * modulus * spot, 8.0 * spot * shear, normals, _motion(normals, np.asarray(part.radius)))


def contact_stiffness(part: Contact, material: Material) -> Array:
    """Stiffness (..., 6, 6) about the ball's centre: the sum of its contacts, which pass forces and no moments.

    About the contact of a flat the ball rolls and spins freely; about its centre that shows as k_t R and k_t R^2.

    >>> steel = Material(young=210e9, poisson=0.3, density=7850.0)
    >>> ball = Contact("steel", "steel", radius=0.005, preload=10.0)
    >>> (contact_stiffness(ball, Paired.of(steel, steel)).diagonal()[:3] / 1e6).round(2).tolist()
    [15.87, 13.07, 13.07]
    """
    found = hertz(part, material)
    return np.sum(np.swapaxes(found.motion, -1, -2) @ found.matrix @ found.motion, axis=-3)


def _both(part: Contact, material: Material) -> tuple[Material, Material]:
    if not isinstance(material, Paired):
        what = f"its stiffness was asked for without the material of its seat, {part.counter}"
        raise refuse(f"contact of {part.material}", what, "Pass Paired.of(ball, seat)")
    for name, each in ((part.material, material), (part.counter, material.counter)):
        if each.is_cubic:
            what = f"{name} is a crystal, and contacts are known of isotropic materials alone"
            raise refuse(f"contact of {part.material} on {part.counter}", what, 'State its measured stiffness (kind = "spring")')
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


CONTACT = PartLaw(material_stiffness=contact_stiffness, mass=lambda _: np.zeros((12, 12)))
