"""Twist modes of a flat flexure with restrained warping, and the curvature of its section across the width."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.flexure.modes import FINE, across, clamped, gauss, polynomials, slopes

_DEGREES = (3, 5, 7)
"""Degrees of the polynomials across the width of a twisted leaf."""
_TERMS = 26
"""Polynomials per field along the leaf."""
_PARTS = tuple(np.flatnonzero(np.arange(_TERMS * len(_DEGREES)) % 2 == half) for half in (0, 1))
"""Indices of the symmetric and the antisymmetric polynomials, which are decoupled."""
_CUT = 1e-14


@dataclass(frozen=True, eq=False)
class Modes:
    """k functions of the position s from 0 to 1, at p points: `values` (..., k, p), and `slopes`, the derivatives with respect to s."""

    values: Array
    slopes: Array


def restrained_twist_modes(count: int, places: Array, decay: Array) -> Modes:
    """Compute the shapes of the twist rate under restrained warping (docs/nonlinear.md, 9).

    The shapes are P_k - cosh(c u) / cosh(c) for even k, and P_k - sinh(c u) / sinh(c) for odd k. P_k are the Legendre polynomials of u,
    where u = 2 s - 1 and s is the position from 0 to 1.

    `decay` c (...) is half the length times sqrt(G J / (E C_w)), with the torsional rigidity G J and the warping rigidity E C_w. The
    computation does not overflow for large c.

    >>> restrained_twist_modes(2, np.array([0.0, 1.0]), np.array(500.0)).values.round(12).tolist()
    [[0.0, 0.0], [0.0, 0.0]]
    """
    plain, rates = polynomials(count, places), slopes(count, places)
    c, u = np.asarray(decay)[..., None], 2.0 * places - 1.0
    near, far, whole = np.exp(-c * (1.0 - u)), np.exp(-c * (1.0 + u)), np.exp(-2.0 * c)
    even, odd = (near + far) / (1.0 + whole), (near - far) / (1.0 - whole)
    slope = 2.0 * c * (near - far) / (1.0 + whole), 2.0 * c * (near + far) / (1.0 - whole)
    layer = np.stack([(even, odd)[k % 2] for k in range(count)], axis=-2)
    layer_slope = np.stack([slope[k % 2] for k in range(count)], axis=-2)
    return Modes(plain - layer, rates - layer_slope)


def orthonormal(modes: Modes, weights: Array) -> Modes:
    """Orthonormalise functions, given at p points, with respect to the integral with the `weights` (p,) of these points.

    In short wide leaves, the functions of `restrained_twist_modes` are nearly linearly dependent, which would amplify rounding errors.

    >>> rule = gauss(20)
    >>> result = orthonormal(restrained_twist_modes(3, rule.points, np.array(0.1)), rule.weights)
    >>> bool(np.allclose(result.values * rule.weights @ result.values.T, np.eye(3)))
    True
    """
    root = np.linalg.qr((modes.values * np.sqrt(weights)).T)[1]
    root = (root * np.sign(np.diag(root))[:, None]).T
    return Modes(np.linalg.solve(root, modes.values), np.linalg.solve(root, modes.slopes))


def curling_energy(width: Number, poisson: Number, twist: Modes) -> Array:
    """Compute the quadratic form (..., k, k) by which bending of the section reduces the energy of k twist modes.

    The form is divided by D b / L, with the plate stiffness D, the width b and the length L. `width` is a fraction of the length; `twist`
    has the twist modes at the `FINE` points. The twist k_x causes the curvatures w_xx = - k_x' z and w_xz = - k_x. In addition, the plate
    bends in the shapes a_j phi_j with j = 3, 5, 7; a_j and a_j' are zero at the clamps. The fields a_j minimise the energy for a given
    twist (docs/nonlinear.md, 9).
    """
    width_wise, weights = across(_DEGREES), gauss(FINE).weights
    value, slope, curve = clamped(_TERMS, 2)
    pairs = ((width_wise.curved, value), (width_wise.sloped, slope), (width_wise.plain, curve))
    plain, sloped, curved = (np.kron(one, each * weights @ each.T) for one, each in pairs)
    mixed = np.kron(width_wise.mixed, curve * weights @ value.T)
    square, shear = width * width, 2.0 * (1.0 - poisson)
    form = plain + square * (shear * sloped + poisson * (mixed + mixed.T)) + square * square * curved
    load = poisson * np.kron(width_wise.curling[:, None], value * weights @ twist.slopes.T)
    load = width * (load + shear * np.kron(width_wise.turning[:, None], slope * weights @ twist.values.T))
    root = np.sqrt(np.diag(form))
    form, load = form / root / root[:, None], load / root[:, None]
    halves = [load[part].T @ np.linalg.lstsq(form[np.ix_(part, part)], load[part], rcond=_CUT)[0] for part in _PARTS]
    return halves[0] + halves[1]
