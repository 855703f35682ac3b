"""Compliance of the stubs of a specimen: prismatic beams, subtracted from the specimen's compliance.

This module is independent of the beam theory of hinges (`flexstage.beams`), which is compared with the solid model: both use only the same
sections. The shear factor does not depend on Poisson's ratio. A shear factor that depends on Poisson's ratio (Cowper 1966) would change a
hinge's shear compliance by 1 %. The choice of the shear factor is part of the convention for stubs.
"""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.parts.profile import single
from flexstage.parts.section import Rectangle, Section
from flexstage.solid.fea.geometry.piece import Medium

_TERMS = 30
_POINTS = 40


def beam(section: Section, length: float, medium: Medium) -> Array:
    """Compute the compliance (6, 6) of a prismatic Timoshenko beam along x about its centre; one end stays plane, the other may warp.

    C = diag(L/(E A), L^3/(12 E I_z) + k L/(G A), L^3/(12 E I_y) + k L/(G A), C_rx, L/(E I_y), L/(E I_z)): about the centre, bending and
    shear are uncoupled; k is the shear factor. Torsion follows Vlasov's theory: C_rx = L/(G J) (1 - tanh(m)/m), m^2 = G J L^2/(E C_w), with
    the warping constant C_w. With Saint-Venant torsion, the stubs of a wide hinge would have more compliance than the whole specimen.

    >>> from flexstage.parts.section import circle
    >>> beam(circle(2.0), np.pi, Medium(1.0, 0.0, 1.0)).diagonal()[[0, 3, 4, 5]].round(9).tolist()
    [1.0, 4.0, 4.0, 4.0]
    """
    young, shear = medium.young, medium.shear
    sliding = section.shear * length / (shear * section.area)
    return np.diag(
        [
            length / (young * section.area),
            length**3 / (12.0 * young * section.inertia_z) + sliding,
            length**3 / (12.0 * young * section.inertia_y) + sliding,
            length / (shear * section.torsion) * _free_twist(section, length, medium),
            length / (young * section.inertia_y),
            length / (young * section.inertia_z),
        ]
    )


def _free_twist(section: Section, length: float, medium: Medium) -> float:
    """Twist with one end fixed plane over that of Saint-Venant."""
    warping = section.warping
    if warping is None:
        return 1.0
    if isinstance(section, Rectangle):  # the constant of its section is for thin ones
        warping = _warping(*sorted((single(section.height), single(section.width))))
    reach = single(np.sqrt(medium.shear * section.torsion / (medium.young * warping))) * length
    return 1.0 - float(np.tanh(reach)) / reach


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
