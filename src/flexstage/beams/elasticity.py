"""What three-dimensional elasticity finds beside beam theory, by laws fitted to finite elements: which error to expect of a hinge.

Every law is the compliance of beam theory changed by what it leaves out, term by term: what the blocks yield at the roots (over the root of
t/R), contraction that wide hinges and clamped ends prevent (by Poisson's ratio squared, over the width), shear that clamped ends change.
`python -m tools.validation.beam_errors` computes the hinges, fits the numbers and prints both.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.closed_forms import wu_zhou_rotation
from flexstage.beams.plate import moment_factor, shear_factor

AXES = ("x", "y", "z", "rx", "ry", "rz")
Numbers = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Slot:
    """A hinge by its numbers (...): thickness, width, half its length, the axes of its arcs, Poisson's ratio.

    `beam` (..., 6) is the diagonal of its compliance by beam theory times Young's modulus. Hinges without arcs have no use for their axes.
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
        """The root of t/R."""
        return np.sqrt(self.thickness / self.radius)

    @property
    def flatness(self) -> Array:
        """Height of the arc over its half length."""
        return self.across / self.along

    @property
    def height(self) -> Array:
        """Full height of the block."""
        return self.thickness + 2.0 * self.across

    @property
    def shear_share(self) -> Array:
        """What shear has of the compliance across, by beam theory."""
        return 2.4 * (1.0 + self.poisson) * self.beam[..., 0]

    def plane_strain(self, scale: float, power: float, size: Array) -> Array:
        """1 - nu^2 where the width prevents contraction over a `size`, 1 where it does not, and in between."""
        return 1.0 - self.poisson**2 / (1.0 + (scale * size / self.width) ** power)


Law = Callable[[Slot, Numbers], Array]
"""The compliance along or about an axis times Young's modulus, from the numbers fitted."""


def notch_x(slot: Slot, p: Numbers) -> Array:
    """Tension: what the roots yield, d(t/R) / (E b), and contraction prevented."""
    root, flat = slot.root, slot.flatness
    yielded = (p[0] + p[1] * root + p[2] * root**2) * flat ** p[5] + p[6] * (1.0 - flat)
    return slot.plane_strain(p[3], p[4], slot.half) * (slot.beam[..., 0] + yielded / slot.width)


def notch_y(slot: Slot, p: Numbers) -> Array:
    """Across: the roots, bending with contraction prevented, and the block that was taken off as a beam although it is a plate."""
    root, flat, height = slot.root, slot.flatness, slot.height
    circle = (p[0] + p[1] * root + p[2] * root**2 + p[3] * root**3) * flat ** p[9]
    yielded = circle + (flat - 1.0) * (p[10] + p[11] * root + p[12] * root**2)
    yielded = yielded * (1.0 + p[8] * (slot.poisson - 0.3)) / (root**2 * slot.width)
    block = 2.0 / slot.width * (12.0 / height**2 * (slot.half + 0.5 * height) ** 2 + 1.0)
    plate = slot.poisson**2 * p[6] / (1.0 + (p[7] * height / slot.width) ** 2)
    bent = slot.plane_strain(p[4], p[5], np.sqrt(slot.thickness * slot.radius)) * (slot.beam[..., 1] - slot.shear_share)
    return bent + slot.shear_share + yielded - plate * block


def notch_ry(slot: Slot, p: Numbers) -> Array:
    """Bending about the thickness: as tension; narrow hinges yield less at their roots."""
    root, flat = slot.root, slot.flatness
    yielded = (p[0] + p[1] * root + p[2] * root**2) * flat ** p[7] + p[8] * (1.0 - flat)
    share = 1.0 / (1.0 + p[5] * (slot.along / slot.width) ** p[6])
    return slot.plane_strain(p[3], p[4], slot.half) * (slot.beam[..., 4] + 12.0 / slot.width**3 * share * yielded)


def notch_rz(slot: Slot, p: Numbers) -> Array:
    """Bending: the roots turn, in proportion to t/R at first."""
    neck = np.sqrt(slot.thickness * slot.radius)
    return slot.plane_strain(p[2], p[3], neck) * (slot.beam[..., 5] + _root_rotation(slot, p) * slot.flatness ** p[4])


def fillet_y(slot: Slot, p: Numbers) -> Array:
    """Across a fillet: a plate where it is wide, and roots that turn at their arms."""
    bent = _plate_share(slot, shear_factor, p[3], p[4]) * (slot.beam[..., 1] - slot.shear_share)
    return bent + slot.shear_share * (1.0 + p[5] * slot.root) + _root_rotation(slot, p) * (slot.half - p[2] * slot.along) ** 2


def fillet_rz(slot: Slot, p: Numbers) -> Array:
    """Bending of a fillet: a plate where it is wide, and roots that turn."""
    return _plate_share(slot, moment_factor, p[2], p[3]) * (slot.beam[..., 5] + _root_rotation(slot, p))


def _root_rotation(slot: Slot, p: Numbers) -> Array:
    """What the roots turn: as those of the circular notch with the same throat."""
    circle = np.asarray(wu_zhou_rotation(1.0, slot.width, slot.thickness, slot.radius))
    return circle * (p[0] * slot.root**2 + p[1] * slot.root**3)


def bar_x(slot: Slot, p: Numbers) -> Array:
    """Tension between rigid faces, which hold the contraction across the width and the thickness."""
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
    """Across a bar that beam theory has without plate action."""
    return slot.beam[..., 1] * (_plate_share(slot, shear_factor, 1.0, p[0]) - slot.poisson**2 * p[1] * _proportions(slot)[1])


def bar_rz(slot: Slot, p: Numbers) -> Array:
    """Bending of a bar that beam theory has without plate action."""
    return slot.beam[..., 5] * _plate_share(slot, moment_factor, 1.0, p[0])


def _plate_share(slot: Slot, factor: Callable[[Number, Number], Number], scale: float, power: float) -> Array:
    """What a plate has of a beam's compliance, less where the width is no more than some thicknesses."""
    wide = scale * _proportions(slot)[0]
    stiffer = np.asarray(factor(1.0 / wide, slot.poisson))
    return 1.0 - (1.0 - 1.0 / stiffer) / (1.0 + power * slot.thickness / slot.width)


def leaf_y(slot: Slot, p: Numbers) -> Array:
    """Across a leaf, plate action counted."""
    return slot.beam[..., 1] * (1.0 - p[0] * slot.poisson**2 * _proportions(slot)[0])


def leaf_rx(slot: Slot, p: Numbers) -> Array:
    """Torsion of a leaf: bending of its strips, which the closed form has without restrained contraction."""
    wide, _ = _proportions(slot)
    return slot.beam[..., 3] / (1.0 + p[0] + (p[1] * wide + p[2] * wide**2) * slot.poisson**2)


def leaf_rz(slot: Slot, p: Numbers) -> Array:
    """Bending of a leaf, plate action counted."""
    return slot.beam[..., 5] * (1.0 - p[0] * slot.poisson**2 * _proportions(slot)[0])


def _proportions(slot: Slot) -> tuple[Array, Array]:
    """Width and thickness over the length."""
    return slot.width / (2.0 * slot.half), slot.thickness / (2.0 * slot.half)


def _saturate(share: Array) -> Array:
    """A share that grows evenly and ends at one."""
    return share / (1.0 + share**3) ** (1.0 / 3.0)


def toroidal(slot: Slot, p: Numbers, index: int) -> Array:
    """Compliance of a toroidal neck: larger by exp(t/R (p0 + p1 (t/R)^1/2 + p2 (nu - 0.3)))."""
    return slot.beam[..., index] * np.exp(slot.root**2 * (p[0] + p[1] * slot.root + p[2] * (slot.poisson - 0.3)))


def _toroid(index: int) -> Law:
    return lambda slot, p: toroidal(slot, p, index)


LAWS: Mapping[str, Mapping[str, tuple[Law, Numbers]]] = MappingProxyType(
    {
        "notch": {
            "x": (notch_x, (1.773, -1.989, 0.7267, 4.556, 1.593, 0.4082, -0.7166)),
            "y": (
                notch_y,
                (-0.09343, 7.87, -14.42, 7.346, 2.673, 1.996, 0.8526, 0.2926, -1.66, 0.3597, -1.009, 5.626, -3.534),
            ),
            "ry": (notch_ry, (3.368, -4.811, 2.259, 8.218, 2.439, 1.02, 0.4007, 0.5283, -0.9448)),
            "rz": (notch_rz, (0.495, -0.17, 2.214, 1.836, 0.1228)),
        },
        "fillet": {
            "x": (notch_x, (1.768, -1.966, 0.6864, 4.81, 1.809, 0.0, 0.0)),
            "y": (fillet_y, (0.6163, -0.2812, 0.7618, 2.263, 3.097, 0.01838)),
            "ry": (notch_ry, (2.789, -4.127, 1.959, 10.4, 1.258, 0.5138, 0.6834, 0.0, 0.0)),
            "rz": (fillet_rz, (0.4696, -0.147, 1.186, 1.354)),
        },
        "bar": {
            "x": (bar_x, (0.2893, 0.4173)),
            "y": (bar_y, (1.45, 0.6995)),
            "z": (bar_z, (0.4012, 1.327, 0.06473, 0.5844, -0.02202)),
            "ry": (bar_ry, (0.1282, 0.4259)),
            "rz": (bar_rz, (0.8406,)),
        },
        "leaf": {
            "x": (bar_x, (0.2893, 0.4173)),
            "y": (leaf_y, (0.04168,)),
            "z": (bar_z, (0.3799, 1.549, 0.1191, 0.2558, -0.01696)),
            "rx": (leaf_rx, (0.0009758, 0.3758, 0.005599)),
            "ry": (bar_ry, (0.1282, 0.4259)),
            "rz": (leaf_rz, (0.00952,)),
        },
        "toroid": {
            "x": (_toroid(0), (0.6975, -0.5301, -0.6062)),
            "y": (_toroid(1), (0.4627, -0.3716, -0.8128)),
            "z": (_toroid(2), (0.4627, -0.3716, -0.8128)),
            "rx": (_toroid(3), (0.1367, -0.007523, 0.004667)),
            "ry": (_toroid(4), (0.1706, 0.006852, -0.3264)),
            "rz": (_toroid(5), (0.1706, 0.006852, -0.3264)),
        },
    }
)
"""By family and axis, the law and its numbers."""
