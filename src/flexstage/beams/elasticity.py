"""Deviation of beam theory from three-dimensional elasticity: the expected model error of a hinge, fitted to finite elements.

Each law is the compliance of beam theory plus the neglected terms:

- root compliance of the blocks (proportional to the root of t/R),
- contraction that wide hinges and clamped ends prevent (Poisson's ratio squared, over the width),
- shear that clamped ends change.

`python -m tools.validation.beam_errors` computes the hinges, fits the coefficients and prints both.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.plate import moment_factor, shear_factor

AXES = ("x", "y", "z", "rx", "ry", "rz")
Numbers = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Slot:
    """Dimensions of a hinge (...): thickness, width, half length, axes of its arcs, Poisson's ratio.

    `beam` (..., 6) is the diagonal of its compliance by beam theory times Young's modulus. Hinges without arcs do not use the arc axes.
    """

    thickness: Array
    width: Array
    half: Array
    along: Array
    across: Array
    poisson: Array
    beam: Array

    @property
    def radius(self) -> Array:
        """Radius of curvature at the throat."""
        return self.along**2 / self.across

    @property
    def root(self) -> Array:
        """Square root of t/R."""
        return np.sqrt(self.thickness / self.radius)

    @property
    def flatness(self) -> Array:
        """Height of the arc over the half length."""
        return self.across / self.along

    @property
    def height(self) -> Array:
        """Full height of the block."""
        return self.thickness + 2.0 * self.across

    @property
    def shear_share(self) -> Array:
        """Fraction of the transverse compliance that is due to shear, by beam theory."""
        return 2.4 * (1.0 + self.poisson) * self.beam[..., 0]

    def plane_strain(self, scale: float, power: float, size: Array) -> Array:
        """Plane-strain factor: 1 - nu^2 where the width prevents contraction over a `size`, 1 where it does not, smooth in between."""
        return 1.0 - self.poisson**2 / (1.0 + (scale * size / self.width) ** power)


Law = Callable[[Slot, Numbers], Array]
"""Compliance along or about an axis times Young's modulus, as a function of the fitted coefficients."""


def notch_x(slot: Slot, p: Numbers) -> Array:
    """Tension: the root compliance d(t/R) / (E b), and prevented contraction."""
    root, flat = slot.root, slot.flatness
    yielded = (p[0] + p[1] * root + p[2] * root**2) * flat ** p[5] + p[6] * (1.0 - flat)
    return slot.plane_strain(p[3], p[4], slot.half) * (slot.beam[..., 0] + yielded / slot.width)


def notch_y(slot: Slot, p: Numbers) -> Array:
    """Transverse: the roots, bending with prevented contraction, and the block, subtracted as a beam although it is a plate."""
    root, flat = slot.root, slot.flatness
    circle = (p[0] + p[1] * root + p[2] * root**2 + p[3] * root**3) * flat ** p[9]
    yielded = circle + (flat - 1.0) * (p[10] + p[11] * root + p[12] * root**2)
    yielded = yielded * (1.0 + p[8] * (slot.poisson - 0.3)) / (root**2 * slot.width)
    bent = slot.plane_strain(p[4], p[5], np.sqrt(slot.thickness * slot.radius)) * (slot.beam[..., 1] - slot.shear_share)
    return bent + slot.shear_share + yielded - _block_as_plate(slot, p[6], p[7])


def notch_ry(slot: Slot, p: Numbers) -> Array:
    """Bending about the thickness, as for tension; the roots of narrow hinges are stiffer."""
    root, flat = slot.root, slot.flatness
    yielded = (p[0] + p[1] * root + p[2] * root**2) * flat ** p[7] + p[8] * (1.0 - flat)
    share = 1.0 / (1.0 + p[5] * (slot.along / slot.width) ** p[6])
    return slot.plane_strain(p[3], p[4], slot.half) * (slot.beam[..., 4] + 12.0 / slot.width**3 * share * yielded)


def notch_rz(slot: Slot, p: Numbers) -> Array:
    """Bending: the root rotation, proportional to t/R for small t/R, and larger for a larger Poisson's ratio."""
    neck = np.sqrt(slot.thickness * slot.radius)
    turned = _root_rotation(slot, p) * slot.flatness ** p[4] * (1.0 + p[5] * (slot.poisson - 0.3))
    return slot.plane_strain(p[2], p[3], neck) * (slot.beam[..., 5] + turned)


def fillet_y(slot: Slot, p: Numbers) -> Array:
    """Transverse compliance of a fillet: plate action if wide, root rotation at its arms, and the block as for a notch."""
    bent = _plate_share(slot, shear_factor, p[3], p[4]) * (slot.beam[..., 1] - slot.shear_share)
    turned = _root_rotation(slot, p) * (slot.half - p[2] * slot.along) ** 2
    return bent + slot.shear_share * (1.0 + p[5] * slot.root) + turned - _block_as_plate(slot, p[6], p[7])


def fillet_rz(slot: Slot, p: Numbers) -> Array:
    """Bending of a fillet: plate action if wide, and root rotation."""
    return _plate_share(slot, moment_factor, p[2], p[3]) * (slot.beam[..., 5] + _root_rotation(slot, p))


def _block_as_plate(slot: Slot, share: float, scale: float) -> Array:
    """Excess compliance of the block as a beam over the block as a plate, which is subtracted too much next to a hinge."""
    block = 2.0 / slot.width * (12.0 / slot.height**2 * (slot.half + 0.5 * slot.height) ** 2 + 1.0)
    return slot.poisson**2 * share / (1.0 + (scale * slot.height / slot.width) ** 2) * block


def _root_rotation(slot: Slot, p: Numbers) -> Array:
    """Root rotation, equal to that of the circular notch with the same throat."""
    circle = np.asarray(wu_zhou_rotation(1.0, slot.width, slot.thickness, slot.radius))
    return circle * (p[0] * slot.root**2 + p[1] * slot.root**3)


def wu_zhou_rotation(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Compute the rotational compliance of a right-circular notch about z [rad/(N m)] (Wu & Zhou, Rev. Sci. Instrum. 73, 2002), s = R/t.

    >>> float(f"{wu_zhou_rotation(200e3, 10.0, 1.0, 5.0):.7g}")
    1.539997e-05
    """
    s = radius / thickness
    q = np.sqrt(4.0 * s + 1.0)
    first = 2.0 * s**3 * (6.0 * s * s + 4.0 * s + 1.0) / ((2.0 * s + 1.0) * q**4)
    return 12.0 / (young * width * radius * radius) * (first + 12.0 * s**4 * (2.0 * s + 1.0) / q**5 * np.arctan(q))


def bar_x(slot: Slot, p: Numbers) -> Array:
    """Tension between rigid faces, which restrain the contraction across the width and the thickness."""
    wide, thick = _proportions(slot)
    return slot.beam[..., 0] * (1.0 - slot.poisson**2 * (_saturate(p[0] * wide) + _saturate(p[1] * thick)))


def bar_z(slot: Slot, p: Numbers) -> Array:
    """Bending and shear in the plane of the width between rigid faces."""
    wide, thick = _proportions(slot)
    sheared = slot.shear_share / slot.beam[..., 2]
    held = slot.poisson**2 * (p[0] * wide + p[1] * thick)
    return slot.beam[..., 2] * (1.0 - (1.0 - sheared) * held - sheared * (p[2] * _saturate(p[3] * wide) + p[4] * slot.poisson))


def bar_ry(slot: Slot, p: Numbers) -> Array:
    """Bending in the plane of the width between rigid faces."""
    wide, thick = _proportions(slot)
    return slot.beam[..., 4] * (1.0 - slot.poisson**2 * (p[0] * wide + p[1] * thick))


def bar_y(slot: Slot, p: Numbers) -> Array:
    """Transverse compliance of a bar for which beam theory has no plate action."""
    return slot.beam[..., 1] * (_plate_share(slot, shear_factor, 1.0, p[0]) - slot.poisson**2 * p[1] * _proportions(slot)[1])


def bar_rz(slot: Slot, p: Numbers) -> Array:
    """Bending of a bar for which beam theory has no plate action."""
    return slot.beam[..., 5] * _plate_share(slot, moment_factor, 1.0, p[0])


def _plate_share(slot: Slot, factor: Callable[[Number, Number], Number], scale: float, power: float) -> Array:
    """Compliance of a plate over that of a beam; the effect decreases if the width is only a few thicknesses."""
    wide = scale * _proportions(slot)[0]
    stiffer = np.asarray(factor(1.0 / wide, slot.poisson))
    return 1.0 - (1.0 - 1.0 / stiffer) / (1.0 + power * slot.thickness / slot.width)


def leaf_y(slot: Slot, p: Numbers) -> Array:
    """Transverse compliance of a leaf, including plate action."""
    return slot.beam[..., 1] * (1.0 - p[0] * slot.poisson**2 * _proportions(slot)[0])


def leaf_rx(slot: Slot, p: Numbers) -> Array:
    """Torsion of a leaf: its strips bend with contraction restrained at the ends, from 1 to 1 / (1 - nu^2) stiffer with the width."""
    wide, _ = _proportions(slot)
    restrained = slot.poisson**2 / (1.0 - slot.poisson**2)
    return slot.beam[..., 3] / (1.0 + p[0] + restrained * _saturate(p[1] * wide + p[2] * wide**2))


def leaf_rz(slot: Slot, p: Numbers) -> Array:
    """Bending of a leaf, including plate action."""
    return slot.beam[..., 5] * (1.0 - p[0] * slot.poisson**2 * _proportions(slot)[0])


def _proportions(slot: Slot) -> tuple[Array, Array]:
    """Width and thickness over the length."""
    return slot.width / (2.0 * slot.half), slot.thickness / (2.0 * slot.half)


def _saturate(share: Array) -> Array:
    """A fraction that grows linearly at first and saturates at one."""
    return share / (1.0 + share**3) ** (1.0 / 3.0)


def toroidal(slot: Slot, p: Numbers, index: int) -> Array:
    """Compute the factor of a toroidal neck: larger compliance by exp(t/R (p0 + p1 (t/R)^1/2 + p2 (nu - 0.3)))."""
    return slot.beam[..., index] * np.exp(slot.root**2 * (p[0] + p[1] * slot.root + p[2] * (slot.poisson - 0.3)))


def _toroid(index: int) -> Law:
    return lambda slot, p: toroidal(slot, p, index)


LAWS: Mapping[str, Mapping[str, tuple[Law, Numbers]]] = MappingProxyType(
    {
        "notch": {
            "x": (notch_x, (1.782, -1.978, 0.6968, 4.973, 1.451, 0.284, -0.9158)),
            "y": (
                notch_y,
                (-0.002242, 7.069, -12.22, 5.682, 2.637, 1.991, 0.8432, 0.2712, -1.354, 0.4728, -0.3565, 1.522, 1.093),
            ),
            "ry": (notch_ry, (3.991, -5.824, 2.808, 6.154, 1.716, 1.258, 0.4207, 0.4407, -1.364)),
            "rz": (notch_rz, (0.5245, -0.1993, 2.063, 1.91, 0.156, 0.5961)),
        },
        "fillet": {
            "x": (notch_x, (1.744, -1.831, 0.5654, 5.108, 1.515, 0.0, 0.0)),
            "y": (fillet_y, (0.5519, -0.2514, 0.7889, 1.473, 3.434, 0.2933, 1.824, 0.6665)),
            "ry": (notch_ry, (2.858, -3.706, 1.473, 9.252, 1.261, 0.705, 0.5851, 0.0, 0.0)),
            "rz": (fillet_rz, (0.4315, -0.1017, 1.284, 1.757)),
        },
        "bar": {
            "x": (bar_x, (0.2989, 0.3964)),
            "y": (bar_y, (1.307, 0.6191)),
            "z": (bar_z, (0.4575, 1.116, 1.026, 0.03113, 0.03765)),
            "ry": (bar_ry, (0.1316, 0.4046)),
            "rz": (bar_rz, (0.8715,)),
        },
        "leaf": {
            "x": (bar_x, (0.2819, 0.4815)),
            "y": (leaf_y, (0.02987,)),
            "z": (bar_z, (0.3725, 1.626, 0.1195, 0.2543, -0.01614)),
            "rx": (leaf_rx, (0.002352, 0.3073, 0.02046)),
            "ry": (bar_ry, (0.1274, 0.3336)),
            "rz": (leaf_rz, (0.007913,)),
        },
        "toroid": {
            "x": (_toroid(0), (0.6781, -0.489, -0.5586)),
            "y": (_toroid(1), (0.4643, -0.3794, -0.8822)),
            "z": (_toroid(2), (0.4643, -0.3794, -0.8822)),
            "rx": (_toroid(3), (0.1361, -0.00781, -0.0001351)),
            "ry": (_toroid(4), (0.1697, 0.00696, -0.3379)),
            "rz": (_toroid(5), (0.1697, 0.00696, -0.3379)),
        },
    }
)
"""Fitted law and coefficients by family and axis."""
