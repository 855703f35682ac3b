"""Cruciform torsion hinges: two crossed leaves in one piece, with a plus-shaped section across x."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.number import Array, Number, magnitude
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.parts.freedom import Freedom
from flexstage.parts.section import Section
from flexstage.parts.shape import Order, Shaped


@dataclass(frozen=True, eq=False)
class Cross(Section):
    """Plus-shaped section of two equal leaves of `thickness` t and width b (`height` = `width`), with sharp inner corners.

    >>> section = cross(1e-3, 10e-3)
    >>> [round(float(value), 4) for value in (section.area * 1e6, section.inertia_y * 1e12, section.torsion * 1e12, section.shear)]
    [19.0, 84.0833, 6.5819, 1.8693]
    """

    thickness: Number = 0.0

    @cached_property
    def area(self) -> Number:
        """Area t (2 b - t) [m^2]."""
        return self.thickness * (2.0 * self.width - self.thickness)

    @cached_property
    def inertia_y(self) -> Number:
        """Second moment of area about y: (t b^3 + (b - t) t^3) / 12 [m^4]."""
        cubes = self.thickness * self.width**3 + (self.width - self.thickness) * self.thickness**3
        return cubes / 12.0

    @cached_property
    def inertia_z(self) -> Number:
        """Second moment of area about z, equal to that about y [m^4]."""
        return self.inertia_y

    @cached_property
    def torsion(self) -> Number:
        """Saint-Venant's torsion constant t^4 (2 b / (3 t) - 0.08476 - 4.6 exp(-pi b / (2 t))) [m^4]; error <= 2e-4 for b >= 3 t.

        The first term is that of two strips, 2 b t^3 / 3. The others are corrections for the junction and the ends of the leaves, in the
        form of Trayer & March (NACA Report 334, 1930). The coefficients fit finite-element solutions of Prandtl's stress function
        (Timoshenko & Goodier, Theory of Elasticity, section 106).
        """
        slender = self.width / self.thickness
        return self.thickness**4 * (2.0 / 3.0 * slender - 0.08476 - 4.6 * np.exp(-0.5 * np.pi * slender))

    @cached_property
    def warping(self) -> Number:
        """C_w = b^3 t^3 / 72 [m^6]: leaves warp only across their thickness (Timoshenko & Gere, Theory of Elastic Stability, 5.3)."""
        return (self.width * self.thickness) ** 3 / 72.0

    @cached_property
    def sectorial(self) -> Number:
        """Sectorial coordinate b t / 4 [m^2], at the corners of the leaves' ends."""
        return 0.25 * self.width * self.thickness

    @property
    def thinnest(self) -> Number:
        """Thickness of the leaves [m]."""
        return self.thickness

    def outline(self, angles: Array) -> Array:  # noqa: ARG002
        """Return the twelve corners (12, 2) [m]."""
        far, near = 0.5 * self.first.width, 0.5 * self.first.thickness
        quarter = np.array([(near, -far), (near, -near), (far, -near)])
        turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
        return np.concatenate([quarter @ np.linalg.matrix_power(turn, count) for count in range(4)])

    def pieces(self, angles: Array) -> tuple[Array, ...]:
        """Return three convex polygons: the leaf along y, and both halves of the other leaf."""
        corners = self.outline(angles)
        return corners[[2, 3, 8, 9]], corners[[11, 0, 1, 10]], corners[[4, 5, 6, 7]]

    def torsional_stress(self, torque: Array, uniform: Array) -> Array:
        """Return Saint-Venant's shear stress on the leaves' faces plus the shear stress of leaf bending, without stress concentration."""
        strips = 4.5 * magnitude(1.0 - uniform) / (self.width * self.width * self.thickness)
        return torque * (magnitude(uniform) * self.thickness / self.torsion + strips)


def cross(thickness: Number, width: Number) -> Cross:
    """Return the plus-shaped section of leaves of `thickness` and `width`.

    The shear factor k follows from the energy of Jourawski's shear stress V Q(y) / (I b(y)): k = A / I^2 times the integral of Q^2 / b(y).
    V is the shear force, Q the first and I the second moment of area, and b(y) the width at y.
    """
    half, near = 0.5 * width, 0.5 * thickness
    plain = Cross(width, width, thickness=thickness)
    root, square, product = near / half, half * half - near * near, half * near
    leaf = near * half**5 * (8.0 / 15.0 - root + 2.0 / 3.0 * root**3 - 0.2 * root**5)
    middle = near**3 / half * (square * square + 4.0 / 3.0 * square * product + 8.0 / 15.0 * product * product)
    return Cross(width, width, plain.area / plain.inertia_y**2 * (leaf + middle), thickness)


@dataclass(frozen=True, eq=False)
class Cruciform(Shaped):
    """Cruciform torsion hinge of two equal crossed leaves: `length` is along x; one leaf has its `width` along y, the other along z.

    Ideal degree of freedom: rotation about x.
    """

    kind: ClassVar[str] = "cruciform"
    slender: ClassVar[bool] = True
    material: str
    length: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    width: Annotated[Number, LENGTH, POSITIVE]

    @property
    def intended(self) -> tuple[Freedom, ...]:
        """Ideal degree of freedom: rotation about x."""
        return (Freedom.RX,)

    @property
    def span(self) -> Number:
        """Length [m]."""
        return self.length

    @property
    def throat(self) -> Cross:
        """Cross-section, constant over the length."""
        return cross(self.thickness, self.width)

    @property
    def orders(self) -> Iterator[Order]:
        """Required: the leaves are thinner than wide."""
        yield Order("thickness", self.thickness, self.width, "the width", "Exchange both values")
