"""The system of one flexure and its condensation: from amplitudes, end force and moment to the motion of its end (docs/nonlinear.md, 6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.flexure.law import FlexureLaw
from flexstage.models.nonlinear.elements.element import Tangent, field_system


@dataclass(frozen=True, eq=False)
class Answer:
    """What the unknowns (..., q + 6) of a flexure do: `still` while its end stays, and `moved` (..., q + 6, 6) per motion of its end.

    Of a flexure with weight three more columns: per change of the weight in its start frame.
    """

    still: Array
    moved: Array


def system(found: Tangent) -> Array:
    """The matrix (..., q + 6, q + 6) of amplitudes, end force and end moment; symmetric where H is."""
    size = found.hessian.shape[-1]
    result = np.zeros((*found.hessian.shape[:-2], size + 6, size + 6))
    result[..., :size, :size] = found.hessian
    rows = np.concatenate([found.reach, found.turning], axis=-2)
    result[..., :size, size:] = -np.swapaxes(rows, -1, -2)
    result[..., size:, :size] = rows
    result[..., size : size + 3, size : size + 3] = found.soft
    return result


def condense(found: Tangent, gap: Array) -> Answer:
    """Solve for the motions of the end and for the residual; `gap` (..., 6) is how far the end lies off its body. NaN where singular."""
    matrix = system(found)
    size = found.hessian.shape[-1]
    right = np.zeros((*matrix.shape[:-1], 7 if found.hung is None else 10))
    right[..., :size, 0], right[..., size:, 0] = -found.gradient, -gap
    right[..., size:, 1:7] = np.eye(6)
    if found.hung is not None and found.swayed is not None:
        right[..., :size, 7:] = np.swapaxes(found.hung, -1, -2)
        right[..., size : size + 3, 7:] = -found.swayed[..., 0, :, :]
    answer = solve(matrix, right)
    return Answer(answer[..., 0], answer[..., 1:])


def settle(law: FlexureLaw, strain: Array) -> Array:
    """Amplitudes (..., b, q) whose plate fields have the least energy at their curvatures, in which it is quadratic.

    Newton's method on fields and curvatures at once overshoots in thin leaves, where stretching goes with their squares' product.
    """
    count = law.modes.shape[-1]
    if strain.shape[-1] == count:
        return strain
    matrix, right = field_system(law, strain)
    return np.concatenate([strain[..., :count], solve(matrix, right[..., None])[..., 0]], axis=-1)


def solve(matrix: Array, right: Array) -> Array:
    """Solutions (..., n, m) of a batch of systems, NaN where one is singular or not finite."""
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
