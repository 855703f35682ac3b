"""Modes of twist of a flat flexure whose ends cannot warp."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.flexure.modes import polynomials, slopes


@dataclass(frozen=True, eq=False)
class Modes:
    """Functions of s at places: `values` (..., k, p), and their `slopes` by s."""

    values: Array
    slopes: Array


def free_modes(count: int, places: Array) -> Modes:
    """Polynomials: twist, or bending, of a flexure without layers at its ends.

    >>> free_modes(1, np.array([0.0, 1.0])).values.tolist()
    [[1.0, 1.0]]
    """
    return Modes(polynomials(count, places), slopes(count, places))


def held_modes(count: int, places: Array, decay: Array) -> Modes:
    """Rates of twist (docs/nonlinear.md, 9), zero at ends that cannot warp: P_k - cosh(c u) / cosh(c), sinh for odd k; u = 2 s - 1.

    `decay` c (...) is half the length times sqrt(G J / (E C_w)). In exponentials that cannot overflow.

    >>> held_modes(2, np.array([0.0, 1.0]), np.array(500.0)).values.round(12).tolist()
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
