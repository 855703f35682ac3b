"""The stubs of a specimen by themselves: prismatic beams, taken off the specimen's compliance again.

Written apart from beam theory of hinges (`flexstage.beams`), which the solid model is compared with and never uses.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.solid.fea.piece import Medium

_TERMS = 30
_POINTS = 40


@dataclass(frozen=True)
class BeamSection:
    """A cross-section: area [m^2], second moments about y and z and torsion constant [m^4], warping constant [m^6], shear factor."""

    area: float
    about_y: float
    about_z: float
    torsion: float
    warping: float
    shear: float


def rectangle(height: float, width: float) -> BeamSection:
    """A rectangle, `height` along y and `width` along z [m].

    J = a^3 c/3 (1 - 192/pi^5 (a/c) sum_odd tanh(n pi c/2a)/n^5), a the shorter side (Saint-Venant); shear factor 5/6, Timoshenko's usual
    one (a factor that depends on Poisson's ratio, Cowper 1966, would move a hinge's shear compliance by 1 %: it is part of the convention).

    >>> section = rectangle(1.0, 1.0)
    >>> section.area, round(12 * section.about_z, 12), round(section.torsion, 4), round(section.shear, 4)
    (1.0, 1.0, 0.1406, 0.8333)
    """
    short, long = sorted((height, width))
    odd = np.arange(1, 2 * _TERMS, 2)
    series = np.sum(np.tanh(0.5 * odd * np.pi * long / short) / odd**5)
    torsion = float(short**3 * long / 3.0 * (1.0 - 192.0 / np.pi**5 * short / long * series))
    return BeamSection(height * width, height * width**3 / 12.0, width * height**3 / 12.0, torsion, _warping(short, long), 5.0 / 6.0)


def _warping(short: float, long: float) -> float:
    """Integral of the square of Saint-Venant's warping function of a rectangle, short^3 long^3 / 144 if it is thin."""
    points, weights = np.polynomial.legendre.leggauss(_POINTS)
    y, z = 0.5 * short * points[:, None, None], 0.5 * long * points[None, :, None]
    odd = np.arange(1, 2 * _TERMS, 2)
    rate, sign = odd * np.pi / short, (-1.0) ** ((odd - 1) // 2)
    near, far = np.exp(rate * (np.abs(z) - 0.5 * long)), np.exp(-rate * (np.abs(z) + 0.5 * long))
    wave = np.sign(z) * (near - far) / (1.0 + np.exp(-rate * long))  # sinh(rate z) / cosh(rate long / 2), without overflow
    series = np.sum(sign / odd**3 * wave * np.sin(rate * y), axis=-1)
    function = y[..., 0] * z[..., 0] - 8.0 * short**2 / np.pi**3 * series
    return float(weights @ function**2 @ weights * 0.25 * short * long)


def circle(diameter: float) -> BeamSection:
    """A full circle: J = 2 I; shear factor 9/10 (Timoshenko).

    >>> section = circle(2.0)
    >>> round(section.area, 4), round(section.torsion / section.about_y, 12), section.shear
    (3.1416, 2.0, 0.9)
    """
    second = np.pi * diameter**4 / 64.0
    return BeamSection(0.25 * np.pi * diameter**2, second, second, 2.0 * second, 0.0, 0.9)


def beam(section: BeamSection, length: float, medium: Medium) -> Array:
    """Compliance (6, 6) of a prismatic Timoshenko beam about its centre, axis along x, one end held plane and the other free to warp.

    C = diag(L/EA, L^3/12EI_z + L/kGA, L^3/12EI_y + L/kGA, C_rx, L/EI_y, L/EI_z): about the centre bending and shear do not couple. Torsion
    by Vlasov: C_rx = L/GJ (1 - tanh(m)/m), m^2 = G J L^2/(E C_w): Saint-Venant's alone would take more off a wide hinge than there is.

    >>> beam(BeamSection(1.0, 1.0, 2.0, 1.0, 0.0, 1.0), 1.0, Medium(1.0, 0.0, 1.0)).diagonal()[[0, 3, 4, 5]].tolist()
    [1.0, 2.0, 1.0, 0.5]
    """
    young, shear = medium.young, medium.shear
    sliding = length / (section.shear * shear * section.area)
    return np.diag(
        [
            length / (young * section.area),
            length**3 / (12.0 * young * section.about_z) + sliding,
            length**3 / (12.0 * young * section.about_y) + sliding,
            length / (shear * section.torsion) * _free_twist(section, length, medium),
            length / (young * section.about_y),
            length / (young * section.about_z),
        ]
    )


def _free_twist(section: BeamSection, length: float, medium: Medium) -> float:
    """Twist with one end held plane over that of Saint-Venant."""
    if section.warping == 0.0:
        return 1.0
    reach = float(np.sqrt(medium.shear * section.torsion / (medium.young * section.warping))) * length
    return 1.0 - float(np.tanh(reach)) / reach
