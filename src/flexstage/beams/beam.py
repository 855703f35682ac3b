"""Straight Timoshenko beam: flexibility and inertia per length, and their integrals along the axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.quadrature import Stations
from flexstage.beams.torsion import Twisting, constrained_twist, free_twist
from flexstage.parts.material import Material
from flexstage.parts.section import Section


@dataclass(frozen=True, eq=False)
class Beam:
    """Beam symmetric about its centre: `flexibility` and `inertia` per length at each station (..., m, 6), for (x, y, z, rx, ry, rz).

    The flexibilities are 1/(E A) for x, k/(G A) for y and for z (shear factor k), the twist rate per torque for rx, 1/(E I_y) for ry and
    1/(E I_z) for rz. The inertias are rho A for x, y and z, and rho I_p, rho I_y, rho I_z for the rotations, with the density rho.
    """

    points: Stations
    section: Section
    flexibility: Array
    inertia: Array
    twisting: Twisting

    def diagonal(self) -> Array:
        """Compute the diagonal (..., 6) of the compliance about the centre.

        C_x, C_rx, C_ry and C_rz are the integrals of the flexibilities f; C_y is the integral of f_y + x^2 f_rz, and C_z the integral of
        f_z + x^2 f_ry.
        """
        weight = 2.0 * self.points.rule.weights * self.points.rate
        plain = (weight[..., None, :] @ self.flexibility)[..., 0, :]
        bent = ((weight * self.points.position**2)[..., None, :] @ self.flexibility[..., 4:])[..., 0, :]
        arm = np.zeros_like(plain)
        arm[..., 1], arm[..., 2] = bent[..., 1], bent[..., 0]
        return plain + arm


def beam(points: Stations, section: Section, material: Material) -> Beam:
    """Build the beam of a section given at stations; warping is restrained at both ends.

    >>> from flexstage.beams.quadrature import stations
    >>> from flexstage.parts.section import Rectangle
    >>> from flexstage.parts.profile import Straight
    >>> steel = Material(young=200e9, poisson=0.25, density=7750.0)
    >>> bar = beam(stations(Straight(0.1), 0.01), Rectangle(np.full(25, 0.01), np.full(25, 0.01)), steel)
    >>> round(float(bar.diagonal()[0] * 200e9 * 1e-4), 12)
    0.1
    """
    young, shear = _column(material.modulus), _column(material.shear)
    across = shear_across(material)
    even = shear if across is None else 2.0 / (1.0 / shear + 1.0 / across)
    twisting = free_twist(section, even) if section.warping is None else constrained_twist(section, points, young, shear)
    return Beam(
        points, section, flexibility(section, young, shear, twisting, across), inertia(section, _column(material.density)), twisting
    )


def shear_across(material: Material) -> Array | None:
    """Return the shear modulus in the x-y plane (..., 1) [Pa] if it differs from that in the x-z plane (cubic crystal); else `None`."""
    return None if material.shear_across is None else _column(material.shear_across)


def flexibility(section: Section, young: Array, shear: Array, twisting: Twisting, across: Array | None = None) -> Array:
    """Compute the flexibility per length (..., m, 6) of a section; moduli `young` and `shear` [Pa] of shape (..., 1).

    `across` is the shear modulus for shear along y, if it differs from `shear`.

    >>> from flexstage.parts.section import circle
    >>> section = circle(np.ones(1), 1.0)
    >>> flexibility(section, np.ones(1), np.ones(1), free_twist(section, np.ones(1))).round(4).tolist()
    [[1.2732, 1.2732, 1.2732, 10.1859, 20.3718, 20.3718]]
    """
    lateral = section.shear / (shear * section.area)
    stretched = 1.0 / (young * section.area)
    sideways = lateral if across is None else lateral * (shear / across)
    return _rows(stretched, sideways, lateral, twisting.rate, 1.0 / (young * section.inertia_y), 1.0 / (young * section.inertia_z))


def inertia(section: Section, density: Array) -> Array:
    """Compute the inertia per length (..., m, 6) of a section, including rotary inertia; `density` has the shape (..., 1).

    >>> from flexstage.parts.section import Rectangle
    >>> inertia(Rectangle(np.ones(1), np.ones(1)), np.array([12.0])).tolist()
    [[12.0, 12.0, 12.0, 2.0, 1.0, 1.0]]
    """
    along = density * section.area
    return _rows(along, along, along, density * section.polar, density * section.inertia_y, density * section.inertia_z)


def _rows(*rows: Array) -> Array:
    """Stack rows (..., m) to a contiguous array (..., m, n)."""
    return np.moveaxis(np.stack(np.broadcast_arrays(*rows)), 0, -1)


def _column(number: Number) -> Array:
    return np.asarray(number)[..., None]
