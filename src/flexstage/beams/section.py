"""Cross-sections: area, second moments, shear factors, Saint-Venant torsion and warping of rectangles and circles.

Axes of the link frame: x along the part, y across the thickness, z along the width.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Number
from flexstage.parts.shape import rectangle_torsion

PARABOLIC = 6.0 / 5.0
"""Shear factor of a rectangle from the energy of the parabolic shear stress (Castigliano); that of the notch formulas."""


@dataclass(frozen=True, eq=False)
class Section:
    """A cross-section: `thickness` along y, `width` along z, `area` [m^2], second moments about y and z, torsion constant J [m^4].

    `shear` is the factor k of the shear flexibility k / (G A). `warping` is the warping constant C_w [m^6], absent where plane sections
    stay plane in torsion (circles).
    """

    thickness: Number
    width: Number
    area: Number
    inertia_y: Number
    inertia_z: Number
    torsion: Number
    shear: Number
    warping: Number | None = None

    @property
    def is_round(self) -> bool:
        """Whether the section is a circle."""
        return self.warping is None

    @property
    def polar(self) -> Number:
        """Polar second moment I_y + I_z [m^4]."""
        return self.inertia_y + self.inertia_z


def rectangle(thickness: Number, width: Number, shear: Number = PARABOLIC) -> Section:
    """The rectangle `thickness` (y) x `width` (z), both in metres and of equal shape.

    The warping constant is that of the shape y z, C_w = b^3 t^3 / 144 (see `beams.torsion`).

    >>> section = rectangle(0.001, 0.01)
    >>> round(section.area, 12), round(section.inertia_z * 12e12, 9)
    (1e-05, 10.0)
    """
    area = thickness * width
    return Section(
        thickness=thickness,
        width=width,
        area=area,
        inertia_y=area * width * width / 12.0,
        inertia_z=area * thickness * thickness / 12.0,
        torsion=rectangle_torsion(thickness, width),
        shear=shear,
        warping=area * area * area / 144.0,
    )


def circle(diameter: Number, shear: Number) -> Section:
    """The circle of `diameter` [m].

    >>> section = circle(2.0, cowper_circle(0.3))
    >>> round(section.area / np.pi, 12), round(section.torsion / np.pi, 12)
    (1.0, 0.5)
    """
    area = 0.25 * np.pi * diameter * diameter
    inertia = area * diameter * diameter / 16.0
    return Section(thickness=diameter, width=diameter, area=area, inertia_y=inertia, inertia_z=inertia, torsion=2.0 * inertia, shear=shear)


def cowper_rectangle(poisson: Number) -> Number:
    """Shear factor of a rectangular prism, (12 + 11 nu) / (10 (1 + nu)) (Cowper, J. Appl. Mech. 33, 1966; as SPACAR Light).

    >>> round(cowper_rectangle(0.3), 6)
    1.176923
    """
    return (12.0 + 11.0 * poisson) / (10.0 * (1.0 + poisson))


def cowper_circle(poisson: Number) -> Number:
    """Shear factor of a circular prism, (7 + 6 nu) / (6 (1 + nu)) (Cowper, J. Appl. Mech. 33, 1966; as SPACAR Light).

    >>> round(cowper_circle(0.3), 6)
    1.128205
    """
    return (7.0 + 6.0 * poisson) / (6.0 * (1.0 + poisson))
