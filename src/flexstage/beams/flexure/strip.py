"""Clamped strip: bending of a leaf across its width in two even shapes (Legendre polynomials P2 and P4), with Mindlin shear.

Across the width b the deflection is w(x, z) = W - theta z + a2 phi2 + a4 phi4, phi_j = (b^2 / 12) P_j(2 z / b). W is the deflection of the
centre line, theta the twist angle.

The shapes have zero mean and are therefore orthogonal to W''; phi2'' = 1. At clamped ends, the amplitudes and the section rotations psi of
each shape are constrained (docs/nonlinear.md, 10).
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, Number
from flexstage.beams.flexure.modes import FINE, across, clamped, gauss, polynomials

_DEGREES = (2, 4)
"""Degrees of the polynomials across the width of a bent leaf."""
_TERMS = 30
"""Polynomials per field along the strip."""
_CUT = 1e-14
"""Relative singular value below which a combination of fields is rounding."""
LOADS = (6, 4)
"""Numbers of line loads on a2 and on a4. The responses to these loads are the field modes of a leaf."""
STRETCH_TWO, STRETCH_FOUR = 1.0 / 720.0, 1.0 / 1296.0
"""Integrals of phi2^2 and of phi4^2 across the width b, divided by b^5."""


@dataclass(frozen=True, eq=False)
class Fields:
    """Modes of a leaf's plate fields a2 and a4, the amplitudes of two shapes across its width (docs/nonlinear.md, 11).

    Lengths are divided by the leaf's length L, energies by D b / L with the plate stiffness D and the width b. `form` (..., e, e) is the
    quadratic form of the energy of e modes. `values` (..., 2, e, n) are a2 and a4 at the n points of a rule. `coupling` (..., 2, e, n) are
    the integrals of a2 and a4 times the first n Legendre polynomials.
    """

    form: Array
    values: Array
    coupling: Array


def stiffness(width: Number, thickness: Number, poisson: Number) -> Array:
    """Build the quadratic energy form (120, 120) of a clamped strip of unit length (docs/nonlinear.md, 10).

    The form is for the fields a2, a4 (amplitudes) and psi2, psi4 (rotations). It is divided by the plate stiffness times the width.

    >>> form = stiffness(0.5, 0.005, 0.3)
    >>> form.shape, bool(np.allclose(form, form.T))
    ((120, 120), True)
    """
    width_wise = across(_DEGREES)
    square = width * width
    plain, sloped, curved, mixed = (
        square * square * width_wise.plain,
        square * width_wise.sloped,
        width_wise.curved,
        square * width_wise.mixed,
    )
    shear = 5.0 * (1.0 - poisson) / (thickness * thickness) * plain
    torsion = 0.5 * (1.0 - poisson) * sloped
    moved, turned, _ = clamped(_TERMS, 1)
    pairs = ((moved, moved), (turned, turned), (turned, moved))
    value, slope, slope_value = (one * gauss(FINE).weights @ other.T for one, other in pairs)
    amplitude = np.kron(curved, value) + np.kron(torsion + shear, slope)
    rotation = np.kron(plain, slope) + np.kron(torsion + shear, value)
    # 2 nu A02 psi' a + (torsion - shear) a' psi: rows a, columns psi
    both = np.kron(poisson * mixed.T, slope_value.T) + np.kron(torsion - shear, slope_value)
    return np.block([[amplitude, both], [both.T, rotation]])


@functools.lru_cache(maxsize=256)
def fields(width: float, thickness: Number, poisson: Number, size: int, loads: tuple[int, int] = LOADS) -> Fields:
    """Compute the modes of a leaf's fields: responses of the strip to line loads on a2 and a4 that vary as Legendre polynomials.

    `width` and `thickness` are fractions of the length. `size` is the number of points of the rule.

    The results are cached; their arrays cannot be modified.

    >>> fields(0.3, 0.003, 0.3, 10).values.shape
    (2, 10, 10)
    """
    form = stiffness(width, thickness, poisson)
    value, weights = clamped(_TERMS, 1)[0], gauss(FINE).weights
    moments = polynomials(size, gauss(FINE).points)
    load = value * weights @ moments.T
    right = np.zeros((4 * _TERMS, sum(loads)))
    right[:_TERMS, : loads[0]], right[_TERMS : 2 * _TERMS, loads[0] :] = load[:, : loads[0]], load[:, : loads[1]]
    answer = _solve(form, right)
    answer = answer / np.sqrt(np.sum(answer * (form @ answer), axis=0))
    amplitudes = np.stack([answer[:_TERMS].T, answer[_TERMS : 2 * _TERMS].T])
    along = amplitudes @ value
    coupling = along * weights @ moments.T
    projected = coupling * (2.0 * np.arange(size) + 1.0) @ polynomials(size, gauss(size).points)
    modes = Fields(answer.T @ form @ answer, projected, coupling)
    for each in (modes.form, modes.values, modes.coupling):
        each.flags.writeable = False
    return modes


def _solve(form: Array, right: Array) -> Array:
    """Solve symmetric and antisymmetric fields separately, as they are decoupled."""
    odd = np.arange(_TERMS) % 2
    turns = np.concatenate([odd, odd, 1 - odd, 1 - odd]) == 1  # rotations are antisymmetric where amplitudes are symmetric
    result = np.zeros_like(right)
    for part in (np.flatnonzero(turns), np.flatnonzero(~turns)):
        own = form[np.ix_(part, part)]
        root = np.sqrt(np.diag(own))
        result[part] = np.linalg.lstsq(own / root / root[:, None], right[part] / root[:, None], rcond=_CUT)[0] / root[:, None]
    return result
