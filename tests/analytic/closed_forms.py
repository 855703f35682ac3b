"""Closed forms of the literature for notch hinges, which the quadrature of `flexstage.beams` is compared with.

Names as in `flexstage.parts`: `thickness` t, `width` b, `radius` R; s = R/t. Compliances are about the hinge centre unless said. All are
plane-stress beam theory between the arc ends, in SI or any coherent units: against elasticity they err as `beams.validity` says.
"""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Number
from flexstage.beams.elasticity import wu_zhou_rotation
from flexstage.parts.section import PARABOLIC


def paros_weisbord_rotation(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Rotational compliance of a right-circular notch about z [rad/(N m)] (Paros & Weisbord, Machine Design 37, 1965, full form).

    With beta = t/2R, g = 1 + beta, k = 2 beta + beta^2: 3/(2 E b R^2 k) (1/g + (3 + k)/(g k) + 6 g k^-3/2 atan sqrt((2 + beta)/beta)).

    >>> float(f"{paros_weisbord_rotation(200e3, 10.0, 1.0, 5.0):.7g}")  # reference B1, N and mm
    1.539997e-05
    """
    beta = thickness / (2.0 * radius)
    g, k = 1.0 + beta, beta * (2.0 + beta)
    angle = np.arctan(np.sqrt((2.0 + beta) / beta))
    return 1.5 / (young * width * radius * radius * k) * (1.0 / g + (3.0 + k) / (g * k) + 6.0 * g * angle / k**1.5)


def paros_weisbord_rotation_simplified(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """The same for thin necks, 9 pi R^1/2 / (2 E b t^5/2) (Paros & Weisbord 1965, simplified form).

    >>> float(f"{paros_weisbord_rotation_simplified(200e3, 10.0, 1.0, 5.0):.6g}")  # reference B1
    1.58058e-05
    """
    return 4.5 * np.pi * np.sqrt(radius) / (young * width * thickness * thickness * np.sqrt(thickness))


def paros_weisbord_axial_simplified(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Axial compliance for thin necks, (pi sqrt(R/t) - 2.57) / (E b) [m/N] (Paros & Weisbord 1965, simplified form).

    >>> round(float(paros_weisbord_axial_simplified(1.0, 1.0, 0.01, 1.0)), 3)
    28.846
    """
    return (np.pi * np.sqrt(radius / thickness) - 2.57) / (young * width)


def wu_zhou_axial(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Axial compliance I_0 / (E b) [m/N], I_0 = 2 (2s + 1) atan(q) / q - pi/2, q = sqrt(4s + 1) (Wu & Zhou 2002).

    >>> float(f"{wu_zhou_axial(200e3, 10.0, 1.0, 5.0):.6g}")  # reference B1
    2.46941e-06
    """
    return _length_over_thickness(radius / thickness) / (young * width)


def wu_zhou_shear(shear: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Shear compliance, alike along y and z, 1.2 I_0 / (G b) [m/N] (Wu & Zhou 2002); `shear` is the modulus G.

    >>> float(f"{wu_zhou_shear(200e3 / 2.6, 10.0, 1.0, 5.0):.6g}")  # reference B1
    7.70456e-06
    """
    return PARABOLIC * _length_over_thickness(radius / thickness) / (shear * width)


def wu_zhou_rotation_across(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Rotational compliance about y, 12 I_0 / (E b^3) [rad/(N m)] (Wu & Zhou 2002).

    >>> float(f"{wu_zhou_rotation_across(200e3, 10.0, 1.0, 5.0):.6g}")  # reference B1
    2.96329e-07
    """
    return 12.0 * _length_over_thickness(radius / thickness) / (young * width**3)


def wu_zhou_end_deflection(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Deflection along y of the arc's END (x = R) by a force there, bending only [m/N] (Wu & Zhou 2002).

    The value about the centre is this less R^2 times the rotational compliance; shear adds `wu_zhou_shear`.

    >>> end = wu_zhou_end_deflection(200e3, 10.0, 1.0, 5.0)
    >>> float(f"{end - 25.0 * wu_zhou_rotation(200e3, 10.0, 1.0, 5.0):.6g}")  # reference B1
    2.04508e-05
    """
    s = radius / thickness
    q, turn = _root_and_angle(s)
    first = s * (24.0 * s**4 + 24.0 * s**3 + 22.0 * s * s + 8.0 * s + 1.0) / (2.0 * (2.0 * s + 1.0) * q**4)
    second = (2.0 * s + 1.0) * (24.0 * s**4 + 8.0 * s**3 - 14.0 * s * s - 8.0 * s - 1.0) / (2.0 * q**5) * turn
    return 12.0 / (young * width) * (first + second + 0.125 * np.pi)


def deflection_across(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Out-of-plane deflection along z about the centre by bending, 12 R^2 J / (E b^3) [m/N], of a right-circular notch.

    With a = t/R + 2: J = (a/2)(a pi/4 + 1 - sqrt(a^2 - 4) atan sqrt((a + 2)/(a - 2))) - pi/4; shear adds `wu_zhou_shear`.

    >>> shear = wu_zhou_shear(200e3 / 2.6, 10.0, 1.0, 5.0)
    >>> float(f"{deflection_across(200e3, 10.0, 1.0, 5.0) + shear:.6g}")  # reference B1
    8.97693e-06
    """
    a = thickness / radius + 2.0
    turn = np.sqrt(a * a - 4.0) * np.arctan(np.sqrt((a + 2.0) / (a - 2.0)))
    second_moment = 0.5 * a * (0.25 * np.pi * a + 1.0 - turn) - 0.25 * np.pi
    return 12.0 * radius * radius * second_moment / (young * width**3)


def schotborgh_rotation_stiffness(young: Number, width: Number, thickness: Number, radius: Number) -> Number:
    """Rotational stiffness about z fitted to finite elements [N m/rad] (Schotborgh et al., Precision Engineering 29, 2005).

    K = (E b t^2 / 12) (-0.0089 + 1.3556 sqrt(t/2R) - 0.5227 t/2R), for 0.05 < t/2R < 0.65.

    >>> round(schotborgh_rotation_stiffness(200e3, 10.0, 1.0, 5.0))  # reference B1, N mm/rad
    61251
    """
    ratio = thickness / (2.0 * radius)
    return young * width * thickness * thickness / 12.0 * (-0.0089 + 1.3556 * np.sqrt(ratio) - 0.5227 * ratio)


def smith_toroid_rotation_stiffness(young: Number, thickness: Number, radius: Number) -> Number:
    """Rotational stiffness of a toroidal neck of throat diameter t, E t^7/2 / (20 R^1/2) [N m/rad] (Smith, Flexures, 2000).

    >>> round(float(smith_toroid_rotation_stiffness(200e3, 1.0, 5.0)), 1)  # reference B4, N mm/rad
    4472.1
    """
    return young * thickness**3 * np.sqrt(thickness / radius) / 20.0


def lobontiu_filleted_rotation(young: Number, width: Number, thickness: Number, length: Number, fillet: Number) -> Number:
    """Rotational compliance about z of a corner-filleted hinge [rad/(N m)]: straight middle and a circular notch split in two.

    12 (l - 2r) / (E b t^3) + the circular notch of radius r (after Lobontiu, Compliant Mechanisms, 2003).

    >>> float(f"{lobontiu_filleted_rotation(200e3, 10.0, 0.5, 10.0, 1.0):.4g}")  # reference B2: 4.279925e-4 less 1.53 %
    0.0004214
    """
    straight = 12.0 * (length - 2.0 * fillet) / (young * width * thickness**3)
    return straight + wu_zhou_rotation(young, width, thickness, fillet)


def lobontiu_filleted_axial(young: Number, width: Number, thickness: Number, length: Number, fillet: Number) -> Number:
    """Axial compliance of a corner-filleted hinge [m/N], composed in the same way.

    >>> float(f"{lobontiu_filleted_axial(200e3, 10.0, 0.5, 10.0, 1.0):.4g}")  # reference B2: 9.652974e-6 less 3.69 %
    9.296e-06
    """
    return (length - 2.0 * fillet) / (young * width * thickness) + wu_zhou_axial(young, width, thickness, fillet)


def lobontiu_parabolic_rotation(young: Number, width: Number, thickness: Number, along: Number, across: Number) -> Number:
    """Rotational compliance about z of a parabolic hinge [rad/(N m)], thickness t + 2 c (x/a)^2, |x| <= a.

    With k = 2c/t: 24 a / (E b t^3) (1/(4 (1 + k)^2) + 3/(8 (1 + k)) + 3 atan(k^1/2) / (8 k^1/2)), the integral of Lobontiu et al.
    (Precision Engineering 26, 2002).
    """
    k = 2.0 * across / thickness
    share = 0.25 / (1.0 + k) ** 2 + 0.375 / (1.0 + k) + 0.375 * np.arctan(np.sqrt(k)) / np.sqrt(k)
    return 24.0 * along / (young * width * thickness**3) * share


def lobontiu_parabolic_axial(young: Number, width: Number, thickness: Number, along: Number, across: Number) -> Number:
    """Axial compliance of a parabolic hinge [m/N]: 2 a / (E b (2 c t)^1/2) atan((2c/t)^1/2)."""
    return 2.0 * along / (young * width * np.sqrt(2.0 * across * thickness)) * np.arctan(np.sqrt(2.0 * across / thickness))


def lobontiu_hyperbolic_rotation(young: Number, width: Number, thickness: Number, along: Number, across: Number) -> Number:
    """Rotational compliance about z of a hyperbolic hinge, 24 a / (E b t^2 (t + 2c)) [rad/(N m)].

    Its thickness is (t^2 + 4 c (c + t) (x/a)^2)^1/2: both cuts are branches of one hyperbola (Lobontiu et al. 2002).
    """
    return 24.0 * along / (young * width * thickness * thickness * (thickness + 2.0 * across))


def lobontiu_hyperbolic_axial(young: Number, width: Number, thickness: Number, along: Number, across: Number) -> Number:
    """Axial compliance of the same hinge [m/N]: 2 a / (E b t k) asinh k, k = 2 (c (c + t))^1/2 / t."""
    k = 2.0 * np.sqrt(across * (across + thickness)) / thickness
    return 2.0 * along / (young * width * thickness * k) * np.arcsinh(k)


def _root_and_angle(s: Number) -> tuple[Number, Number]:
    root = np.sqrt(4.0 * s + 1.0)
    return root, np.arctan(root)


def _length_over_thickness(s: Number) -> Number:
    root, angle = _root_and_angle(s)
    return 2.0 * (2.0 * s + 1.0) * angle / root - 0.5 * np.pi
