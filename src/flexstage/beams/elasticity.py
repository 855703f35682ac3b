"""Deviation of beam theory from three-dimensional elasticity: the expected model error of a hinge, fitted to finite elements.

Each law is the compliance of beam theory plus the terms that beam theory neglects:

- compliance of the hinge's roots in the blocks (proportional to (t/R)^(1/2), with thickness t and throat radius R),
- contraction that wide hinges and clamped ends prevent (proportional to the square of Poisson's ratio),
- change of the shear deformation by clamped ends.

`python -m tools.validation.beam_errors` computes hinge compliances by finite elements, fits the coefficients and prints both.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.plate import moment_factor, shear_factor

Numbers = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class HingeDimensions:
    """Dimensions of a hinge (...): thickness, width, half length and arc semi-axes; and Poisson's ratio.

    `beam` (..., 6) is the diagonal of the hinge's compliance by beam theory, multiplied by Young's modulus. Hinges without arcs do not use
    the semi-axes.
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
        """Radius of curvature R at the throat."""
        return self.along**2 / self.across

    @property
    def root(self) -> Array:
        """Square root of t/R, the thickness divided by the radius of curvature at the throat."""
        return np.sqrt(self.thickness / self.radius)

    @property
    def flatness(self) -> Array:
        """Height of the arc divided by the half length."""
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
        """Compute the plane-strain factor: 1 - nu^2 if the width is far above `scale` times `size`, and 1 if it is far below this product.

        Here nu is Poisson's ratio, and `power` is the exponent of the transition from narrow to wide hinges.
        """
        return 1.0 - self.poisson**2 / (1.0 + (scale * size / self.width) ** power)


Law = Callable[[HingeDimensions, Numbers], Array]
"""Compliance along or about an axis times Young's modulus, as a function of dimensions and fitted coefficients."""


def notch_x(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the tensile compliance of a notch and the fitted compliance of its roots, both reduced by restrained contraction."""
    root, flat = hinge.root, hinge.flatness
    yielded = (p[0] + p[1] * root + p[2] * root**2) * flat ** p[5] + p[6] * (1.0 - flat)
    return hinge.plane_strain(p[3], p[4], hinge.half) * (hinge.beam[..., 0] + yielded / hinge.width)


def notch_y(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the transverse compliance of a notch: bending with restrained contraction, shear, and fitted compliance of the roots.

    Beam theory treats the block as a beam. A wide block deforms less, like a plate; the difference is subtracted.
    """
    root, flat = hinge.root, hinge.flatness
    circle = (p[0] + p[1] * root + p[2] * root**2 + p[3] * root**3) * flat ** p[9]
    yielded = circle + (flat - 1.0) * (p[10] + p[11] * root + p[12] * root**2)
    yielded = yielded * (1.0 + p[8] * (hinge.poisson - 0.3)) / (root**2 * hinge.width)
    bent = hinge.plane_strain(p[4], p[5], np.sqrt(hinge.thickness * hinge.radius)) * (hinge.beam[..., 1] - hinge.shear_share)
    return bent + hinge.shear_share + yielded - _block_as_plate(hinge, p[6], p[7])


def notch_ry(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the bending compliance of a notch about y, in the plane of its width, like `notch_x`; roots of narrow notches are stiffer."""
    root, flat = hinge.root, hinge.flatness
    yielded = (p[0] + p[1] * root + p[2] * root**2) * flat ** p[7] + p[8] * (1.0 - flat)
    share = 1.0 / (1.0 + p[5] * (hinge.along / hinge.width) ** p[6])
    return hinge.plane_strain(p[3], p[4], hinge.half) * (hinge.beam[..., 4] + 12.0 / hinge.width**3 * share * yielded)


def notch_rz(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the bending compliance of a notch, with a fitted root rotation, which rises with Poisson's ratio."""
    neck = np.sqrt(hinge.thickness * hinge.radius)
    turned = _root_rotation(hinge, p) * hinge.flatness ** p[4] * (1.0 + p[5] * (hinge.poisson - 0.3))
    return hinge.plane_strain(p[2], p[3], neck) * (hinge.beam[..., 5] + turned)


def fillet_y(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the transverse compliance of a fillet: bending (plate action if wide), shear, root rotation, block of `notch_y`."""
    bent = _plate_share(hinge, shear_factor, p[3], p[4]) * (hinge.beam[..., 1] - hinge.shear_share)
    turned = _root_rotation(hinge, p) * (hinge.half - p[2] * hinge.along) ** 2
    return bent + hinge.shear_share * (1.0 + p[5] * hinge.root) + turned - _block_as_plate(hinge, p[6], p[7])


def fillet_rz(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the bending compliance of a fillet, with plate action if it is wide, and with root rotation."""
    return _plate_share(hinge, moment_factor, p[2], p[3]) * (hinge.beam[..., 5] + _root_rotation(hinge, p))


def _block_as_plate(hinge: HingeDimensions, share: float, scale: float) -> Array:
    """Excess compliance of the block as a beam over the block as a plate, which is subtracted too much next to a hinge."""
    block = 2.0 / hinge.width * (12.0 / hinge.height**2 * (hinge.half + 0.5 * hinge.height) ** 2 + 1.0)
    return hinge.poisson**2 * share / (1.0 + (scale * hinge.height / hinge.width) ** 2) * block


def _root_rotation(hinge: HingeDimensions, p: Numbers) -> Array:
    """Root rotation, equal to that of the circular notch with the same throat."""
    circle = np.asarray(wu_zhou_rotation(1.0, hinge.width, hinge.thickness, hinge.radius))
    return circle * (p[0] * hinge.root**2 + p[1] * hinge.root**3)


def wu_zhou_rotation(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Compute the rotational compliance of a right-circular notch about z [rad/(N m)] (Wu & Zhou, Rev Sci Instrum 73, 2002).

    >>> float(f"{wu_zhou_rotation(200e3, 10.0, 1.0, 5.0):.7g}")
    1.539997e-05
    """
    s = radius / thickness
    q = np.sqrt(4.0 * s + 1.0)
    first = 2.0 * s**3 * (6.0 * s * s + 4.0 * s + 1.0) / ((2.0 * s + 1.0) * q**4)
    return 12.0 / (young * width * radius * radius) * (first + 12.0 * s**4 * (2.0 * s + 1.0) / q**5 * np.arctan(q))


def bar_x(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the tensile compliance of a bar between rigid faces, which restrain the contraction across width and thickness."""
    wide, thick = _proportions(hinge)
    return hinge.beam[..., 0] * (1.0 - hinge.poisson**2 * (_saturate(p[0] * wide) + _saturate(p[1] * thick)))


def bar_z(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the transverse compliance of a bar in the plane of its width, by bending and shear, between rigid faces."""
    wide, thick = _proportions(hinge)
    sheared = hinge.shear_share / hinge.beam[..., 2]
    restraint = hinge.poisson**2 * (p[0] * wide + p[1] * thick)
    return hinge.beam[..., 2] * (1.0 - (1.0 - sheared) * restraint - sheared * (p[2] * _saturate(p[3] * wide) + p[4] * hinge.poisson))


def bar_ry(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the bending compliance of a bar in the plane of its width, between rigid faces."""
    wide, thick = _proportions(hinge)
    return hinge.beam[..., 4] * (1.0 - hinge.poisson**2 * (p[0] * wide + p[1] * thick))


def bar_y(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the transverse compliance of a bar, including plate action, which beam theory neglects."""
    return hinge.beam[..., 1] * (_plate_share(hinge, shear_factor, 1.0, p[0]) - hinge.poisson**2 * p[1] * _proportions(hinge)[1])


def bar_rz(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the bending compliance of a bar, including plate action, which beam theory neglects."""
    return hinge.beam[..., 5] * _plate_share(hinge, moment_factor, 1.0, p[0])


def _plate_share(hinge: HingeDimensions, factor: Callable[[Number, Number], Number], scale: float, power: float) -> Array:
    """Compliance of a plate over that of a beam; the effect decreases if the width is only a few thicknesses."""
    wide = scale * _proportions(hinge)[0]
    stiffer = np.asarray(factor(1.0 / wide, hinge.poisson))
    return 1.0 - (1.0 - 1.0 / stiffer) / (1.0 + power * hinge.thickness / hinge.width)


def leaf_rx(hinge: HingeDimensions, p: Numbers) -> Array:
    """Compute the torsional compliance of a leaf; restrained contraction at its ends increases its stiffness, most of all if it is wide."""
    wide, _ = _proportions(hinge)
    restrained = hinge.poisson**2 / (1.0 - hinge.poisson**2)
    return hinge.beam[..., 3] / (1.0 + p[0] + restrained * _saturate(p[1] * wide + p[2] * wide**2))


def leaf_bending(hinge: HingeDimensions, p: Numbers, index: int) -> Array:
    """Compute the transverse or the bending compliance of a leaf, including plate action."""
    return hinge.beam[..., index] * (1.0 - p[0] * hinge.poisson**2 * _proportions(hinge)[0])


def _proportions(hinge: HingeDimensions) -> tuple[Array, Array]:
    """Width and thickness over the length."""
    return hinge.width / (2.0 * hinge.half), hinge.thickness / (2.0 * hinge.half)


def _saturate(share: Array) -> Array:
    """A fraction that grows linearly at first and saturates at one."""
    return share / (1.0 + share**3) ** (1.0 / 3.0)


def toroidal(hinge: HingeDimensions, p: Numbers, index: int) -> Array:
    """Compute the compliance of a toroidal neck: the compliance by beam theory, multiplied by a fitted factor.

    The factor is exp((t/R) (p0 + p1 (t/R)^(1/2) + p2 (nu - 0.3))), with thickness t, radius R, Poisson's ratio nu and coefficients `p`.
    """
    return hinge.beam[..., index] * np.exp(hinge.root**2 * (p[0] + p[1] * hinge.root + p[2] * (hinge.poisson - 0.3)))


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
            "y": (partial(leaf_bending, index=1), (0.02987,)),
            "z": (bar_z, (0.3725, 1.626, 0.1195, 0.2543, -0.01614)),
            "rx": (leaf_rx, (0.002352, 0.3073, 0.02046)),
            "ry": (bar_ry, (0.1274, 0.3336)),
            "rz": (partial(leaf_bending, index=5), (0.007913,)),
        },
        "toroid": {
            "x": (partial(toroidal, index=0), (0.6781, -0.489, -0.5586)),
            "y": (partial(toroidal, index=1), (0.4643, -0.3794, -0.8822)),
            "z": (partial(toroidal, index=2), (0.4643, -0.3794, -0.8822)),
            "rx": (partial(toroidal, index=3), (0.1361, -0.00781, -0.0001351)),
            "ry": (partial(toroidal, index=4), (0.1697, 0.00696, -0.3379)),
            "rz": (partial(toroidal, index=5), (0.1697, 0.00696, -0.3379)),
        },
    }
)
"""Fitted law and its coefficients by hinge family and axis."""
