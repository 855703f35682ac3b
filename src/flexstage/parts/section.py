"""Cross-sections of parts: outline, area, second moments, Saint-Venant torsion, warping, shear factors and largest stresses.

Axes of the link frame: x along the part, y along the section's height, z along its width. A section is symmetric about y and z.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from flexstage.base.number import Array, Number, magnitude, with_step
from flexstage.parts.profile import single

PARABOLIC = 6.0 / 5.0
"""Shear factor k = 6/5 of a rectangle, from the strain energy of parabolic shear stress (Castigliano), as in the notch formulas."""
ROUND = 10.0 / 9.0
"""Shear factor of a circle, from the strain energy of parabolic shear stress."""
_ODD = np.arange(1.0, 8.0, 2.0)
_ODD_FIFTH_POWERS = 1.00452376279513961613
"""Sum of 1/n^5 over odd n, (31/32) zeta(5)."""


@dataclass(frozen=True, eq=False)
class Section:
    """Cross-section: overall `height` along y and `width` along z [m], and the factor k (`shear`) of the shear flexibility k / (G A).

    Each form of section is a dataclass with its dimensions, which may be arrays and complex. A form implements `area`, `inertia_y`,
    `inertia_z`, `torsion` and `outline`, and may override other properties.
    """

    height: Number
    width: Number
    shear: Number = PARABOLIC
    is_axisymmetric: ClassVar[bool] = False
    """Whether the outline is a circle about x."""
    shear_peak: ClassVar[float] = 1.5
    """Ratio of the largest to the mean shear stress of a transverse force."""

    @cached_property
    def area(self) -> Number:
        """Area [m^2]."""
        raise NotImplementedError

    @cached_property
    def inertia_y(self) -> Number:
        """Second moment of area about y [m^4]."""
        raise NotImplementedError

    @cached_property
    def inertia_z(self) -> Number:
        """Second moment of area about z [m^4]."""
        raise NotImplementedError

    @cached_property
    def torsion(self) -> Number:
        """Saint-Venant's torsion constant J [m^4]."""
        raise NotImplementedError

    @cached_property
    def warping(self) -> Number | None:
        """Warping constant C_w [m^6]; `None` if warping is zero or neglected."""
        return None

    @cached_property
    def sectorial(self) -> Number:
        """Largest value of the warping function [m^2]; a bimoment B causes the stress B / C_w times this value."""
        return 0.25 * self.height * self.width

    @property
    def polar(self) -> Number:
        """Polar second moment I_y + I_z [m^4]."""
        return self.inertia_y + self.inertia_z

    @property
    def least_inertia(self) -> Number:
        """Least second moment of area [m^4]."""
        return np.minimum(self.inertia_y, self.inertia_z)

    @property
    def thinnest(self) -> Number:
        """Least thickness of its material [m]."""
        return np.minimum(self.height, self.width)

    def outline(self, angles: Array) -> Array:
        """Return the first design's corners (n, 2) [m], counter-clockwise; for a curved outline, its points at `angles` [rad] from y."""
        raise NotImplementedError

    def pieces(self, angles: Array) -> tuple[Array, ...]:
        """Return convex polygons (n, 2) [m] that form the outline; the number of polygons is the same in every design."""
        return (self.outline(angles),)

    def normal_stress(self, axial: Array, about_y: Array, about_z: Array) -> Array:
        """Return an upper bound of normal stress [Pa] for the `axial` stress [Pa] and the bending terms |M_y| / I_y, |M_z| / I_z [Pa/m]."""
        return axial + 0.5 * self.height * about_z + 0.5 * self.width * about_y

    def torsional_stress(self, torque: Array, uniform: Array) -> Array:
        """Return the largest shear stress [Pa] of a torque [N m]; Saint-Venant torsion carries its fraction `uniform`, warping the rest."""
        raise NotImplementedError

    def each(self, function: Callable[[Number], Any]) -> Self:
        """Return the section with a function applied to each of its fields."""
        return type(self)(**{item.name: function(getattr(self, item.name)) for item in fields(self)})

    @property
    def first(self) -> Self:
        """The section of the first design, with floats."""
        return self.each(single)


@dataclass(frozen=True, eq=False)
class Rectangle(Section):
    """Rectangular section: `height` t along y, `width` b along z.

    >>> section = Rectangle(0.001, 0.01)
    >>> round(section.area, 12), round(section.inertia_z * 12e12, 9)
    (1e-05, 10.0)
    """

    @cached_property
    def area(self) -> Number:
        """Height times width [m^2]."""
        return self.height * self.width

    @cached_property
    def inertia_y(self) -> Number:
        """Second moment of area A b^2 / 12 [m^4]."""
        return self.area * self.width * self.width / 12.0

    @cached_property
    def inertia_z(self) -> Number:
        """Second moment of area A t^2 / 12 [m^4]."""
        return self.area * self.height * self.height / 12.0

    @cached_property
    def torsion(self) -> Number:
        """Torsion constant [m^4], from `rectangle_torsion`."""
        return rectangle_torsion(self.height, self.width)

    @cached_property
    def warping(self) -> Number:
        """Warping constant b^3 t^3 / 144 [m^6] for the warping shape y z (see `beams.torsion`)."""
        return self.area * self.area * self.area / 144.0

    def outline(self, angles: Array) -> Array:  # noqa: ARG002
        """Return the four corners (4, 2) [m]."""
        section = self.first
        return 0.5 * np.array([section.height, section.width]) * [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]

    def torsional_stress(self, torque: Array, uniform: Array) -> Array:
        """Return the Saint-Venant shear stress in the middle of the longer sides plus the shear stress of strips in bending [Pa]."""
        short, long = np.minimum(self.height, self.width), np.maximum(self.height, self.width)
        ratio = 0.5 * np.pi * (long / short)[..., None] * _ODD
        crest = 1.0 - 8.0 / np.pi**2 * np.sum(2.0 * np.exp(-ratio) / (1.0 + np.exp(-2.0 * ratio)) / _ODD**2, axis=-1)
        strips = 9.0 * magnitude(1.0 - uniform) / (long * long * short)
        return torque * (magnitude(uniform) * crest * short / self.torsion + strips)


@dataclass(frozen=True, eq=False)
class Circle(Section):
    """Circular section; its height and its width are the diameter.

    >>> round(Circle(1.0, 1.0).shear, 6)
    1.111111
    """

    shear: Number = ROUND
    is_axisymmetric: ClassVar[bool] = True
    shear_peak: ClassVar[float] = 4.0 / 3.0

    @cached_property
    def area(self) -> Number:
        """Area pi d^2 / 4 [m^2]."""
        return 0.25 * np.pi * self.height * self.height

    @cached_property
    def inertia_y(self) -> Number:
        """Second moment of area A d^2 / 16 [m^4]."""
        return self.area * self.height * self.height / 16.0

    @cached_property
    def inertia_z(self) -> Number:
        """Second moment of area about z, equal to that about y [m^4]."""
        return self.inertia_y

    @cached_property
    def torsion(self) -> Number:
        """Torsion constant J: the polar second moment [m^4]."""
        return 2.0 * self.inertia_y

    def outline(self, angles: Array) -> Array:
        """Return the points (n, 2) [m] of the outline at `angles` [rad] from y."""
        return 0.5 * single(self.height) * np.column_stack([np.cos(angles), np.sin(angles)])

    def normal_stress(self, axial: Array, about_y: Array, about_z: Array) -> Array:
        """Return the axial stress plus the resultant bending stress of both axes [Pa]."""
        return axial + 0.5 * self.height * np.sqrt(about_y * about_y + about_z * about_z)

    def torsional_stress(self, torque: Array, uniform: Array) -> Array:  # noqa: ARG002  (it does not warp)
        """Return the shear stress at the surface: torque times radius divided by J [Pa]."""
        return torque * 0.5 * self.height / self.torsion


def circle(diameter: Number, shear: Number = ROUND) -> Circle:
    """Return the circle of `diameter` [m]; by default, `shear` follows from the energy of a parabolic shear stress.

    >>> section = circle(2.0, cowper_circle(0.3))
    >>> round(section.area / np.pi, 12), round(section.torsion / np.pi, 12)
    (1.0, 0.5)
    """
    return Circle(diameter, diameter, shear)


def rectangle_torsion(thickness: Number, width: Number) -> Array:
    """Compute the Saint-Venant torsion constant J [m^4] of a rectangle, exact to rounding error.

    J = a^3 c / 3 (1 - (192/pi^5) (a/c) sum over odd n of tanh(n pi c / (2 a)) / n^5), with the sides a <= c (Timoshenko & Goodier, Theory
    of Elasticity, section 109). The sum is (31/32) zeta(5) minus a series in exp(-n pi c / a). The remainder of this series after four
    terms is below 1e-17.

    >>> round(float(rectangle_torsion(1.0, 1.0)), 10), round(float(rectangle_torsion(100.0, 1.0)), 4)
    (0.140577015, 33.1233)
    """
    tall = np.real(width) < np.real(thickness)
    short, long = np.where(tall, width, thickness), np.where(tall, thickness, width)
    ratio = long / short
    decay = np.exp(-np.pi * np.real(ratio))
    square, series, slope = decay * decay, _ODD_FIFTH_POWERS, 0.0
    for odd in (1.0, 3.0, 5.0, 7.0):
        share = decay / (1.0 + decay)
        series = series - 2.0 / odd**5 * share
        slope = slope + 2.0 * np.pi / odd**4 * share / (1.0 + decay)
        decay = decay * square
    series = with_step(series, slope, ratio)
    return short**3 * (long - 192.0 / np.pi**5 * short * series) / 3.0


def cowper_rectangle(poisson: Number) -> Number:
    """Return the shear factor of a rectangle, (12 + 11 nu) / (10 (1 + nu)) (Cowper, Journal of Applied Mechanics 33, 1966; SPACAR Light).

    >>> round(cowper_rectangle(0.3), 6)
    1.176923
    """
    return (12.0 + 11.0 * poisson) / (10.0 * (1.0 + poisson))


def cowper_circle(poisson: Number) -> Number:
    """Return the shear factor of a circle, (7 + 6 nu) / (6 (1 + nu)) (Cowper, Journal of Applied Mechanics 33, 1966; SPACAR Light).

    >>> round(cowper_circle(0.3), 6)
    1.128205
    """
    return (7.0 + 6.0 * poisson) / (6.0 * (1.0 + poisson))
