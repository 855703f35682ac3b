"""Condensation of one flexure: from amplitudes, end force and end moment to the motion of its end (docs/nonlinear.md, 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.flexure.law import FlexureLaw
from flexstage.models.nonlinear.elements.element import Tangent, field_system


@dataclass(frozen=True, eq=False)
class FlexureResponse:
    """Response of a flexure's q + 6 unknowns: `still` (..., q + 6) with fixed end, and `moved` (..., q + 6, 6) per unit motion of the end.

    For a flexure with weight, `moved` has three more columns: the derivatives of the response with respect to the weight in the start
    frame.
    """

    still: Array
    moved: Array


def system(tangent: Tangent) -> Array:
    """Build the matrix (..., q + 6, q + 6) for the unknown amplitudes, end force and end moment."""
    size = tangent.hessian.shape[-1]
    result = np.zeros((*tangent.hessian.shape[:-2], size + 6, size + 6))
    result[..., :size, :size] = tangent.hessian
    rows = np.concatenate([tangent.reach, tangent.turning], axis=-2)
    result[..., :size, size:] = -rows.mT
    result[..., size:, :size] = rows
    result[..., size : size + 3, size : size + 3] = tangent.soft
    return result


def condense(tangent: Tangent, gap: Array) -> FlexureResponse:
    """Solve for the response to end motions and to the residual; NaN if singular.

    `gap` (..., 6) contains the gaps in translation and rotation between the end and the second body.
    """
    matrix = system(tangent)
    size = tangent.hessian.shape[-1]
    right = np.zeros((*matrix.shape[:-1], 7 if tangent.hung is None else 10))
    right[..., :size, 0], right[..., size:, 0] = -tangent.gradient, -gap
    right[..., size:, 1:7] = np.eye(6)
    if tangent.hung is not None and tangent.swayed is not None:
        right[..., :size, 7:] = tangent.hung.mT
        right[..., size : size + 3, 7:] = -tangent.swayed[..., 0, :, :]
    answer = solve(matrix, right)
    return FlexureResponse(answer[..., 0], answer[..., 1:])


def relax_fields(law: FlexureLaw, strain: Array) -> Array:
    """Replace the amplitudes (..., b, q) of plate fields by the amplitudes of least energy for the given curvatures.

    The strain energy is quadratic in the plate fields. A joint Newton iteration on fields and curvatures would overshoot in thin leaves,
    where stretching depends on the square of their product.
    """
    count = law.modes.shape[-1]
    if strain.shape[-1] == count:
        return strain
    matrix, right = field_system(law, strain)
    return np.concatenate([strain[..., :count], solve(matrix, right[..., None])[..., 0]], axis=-1)


def solve(matrix: Array, right: Array) -> Array:
    """Solve a batch of linear systems with right sides (..., n, m); NaN for singular or non-finite systems."""
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        flat, columns = matrix.reshape(-1, *matrix.shape[-2:]), right.reshape(-1, *right.shape[-2:])
        return np.stack([_solve_one(one, other) for one, other in zip(flat, columns, strict=True)]).reshape(right.shape)


def _solve_one(matrix: Array, right: Array) -> Array:
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return np.full_like(right, np.nan)
