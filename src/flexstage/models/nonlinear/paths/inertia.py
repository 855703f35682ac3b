"""Inertia (number of negative eigenvalues) of the tangent stiffness, for the stage and for each flexure (docs/nonlinear.md, 22)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.models.nonlinear.elements.condense import system
from flexstage.models.nonlinear.elements.element import Tangent
from flexstage.models.nonlinear.graph import System
from flexstage.models.nonlinear.stage import Nonlinear
from flexstage.models.nonlinear.summed import nearest_descent, negative_pivots


def kept_rows(model: Nonlinear, held: Sequence[str], locked: Sequence[str]) -> list[int]:
    """Return the indices of the system's rows, without rows of fixed coordinates that are not locked."""
    first = model.freedoms + len(model.hinges.locked)
    return [*range(first), *(first + place for place, name in enumerate(held) if name in locked)]


def count_descents(model: Nonlinear, whole: System, kept: list[int]) -> Array:
    """Count the independent motions (b,) that decrease the potential energy.

    The count is the number of negative eigenvalues of the stiffnesses of stage and flexures, minus one per constraint and multiplier.
    """
    count = _descents(whole, kept, model.freedoms) - (len(kept) - model.freedoms)
    for bent in whole.bent:
        count = count + np.sum(_negative(indefinite(bent.tangent)) - 6, axis=0)
    return count


def lowest_stiffness(model: Nonlinear, whole: System, kept: list[int], scale: Array) -> tuple[float, Array]:
    """Compute the lowest eigenvalue of the scaled stiffness among admissible motions, and the motion (n,) of this eigenvalue.

    The rows and columns of the stiffness are divided by `scale` (n,).

    If there are no admissible motions, the function returns the eigenvalue 1 and a zero motion.
    """
    freedoms = model.freedoms
    if not isinstance(whole.matrix, np.ndarray):
        value, motion = nearest_descent(whole.matrix[0][kept][:, kept], scale)
        return value, motion / scale
    matrix = whole.matrix[0][np.ix_(kept, kept)]
    stiff = 0.5 * (matrix + matrix.T)[:freedoms, :freedoms] / scale / scale[:, None]
    free = scipy.linalg.null_space(matrix[freedoms:, :freedoms] / scale) if len(matrix) > freedoms else np.eye(freedoms)
    if not free.size:
        return 1.0, np.zeros(freedoms)
    values, vectors = np.linalg.eigh(free.T @ stiff @ free)
    return float(values[0]), free @ vectors[:, 0] / scale


def weakest_flexure(model: Nonlinear, whole: System) -> tuple[float, str]:
    """Compute the lowest eigenvalue of the scaled stiffnesses of single flexures with fixed ends, and the flexure's name.

    The eigenvalues of the six multipliers of each flexure are excluded. Without flexures, the result is 1.
    """
    weakest = [
        (float(least), name)
        for group, each in zip(model.flexures, whole.bent, strict=True)
        for name, least in zip(group.names, np.linalg.eigvalsh(_even(indefinite(each.tangent)[:, 0]))[:, 6], strict=True)
    ]
    return min(weakest, default=(1.0, ""))


def stiffness_scale(model: Nonlinear, whole: System) -> Array:
    """Compute the square roots (n,) of the stiffness diagonal. Motions scaled by them do not depend on the units of measurement."""
    diagonal = whole.matrix[0].diagonal()[: model.freedoms]
    size = np.tile([1.0 / model.size] * 3 + [1.0] * 3, len(model.bodies))
    typical = np.sqrt(np.max(diagonal / size**2, initial=0.0) or 1.0)
    return np.maximum(np.sqrt(np.maximum(diagonal, 0.0)), 1e-6 * typical * size)


def indefinite(tangent: Tangent) -> Array:
    """Build the symmetric form of a flexure's system of equations: the six rows for the motion of the end have reversed signs."""
    matrix = system(tangent)
    matrix[..., matrix.shape[-1] - 6 :, :] *= -1.0
    return 0.5 * (matrix + matrix.mT)


def _descents(whole: System, kept: list[int], freedoms: int) -> Array:
    """Negative eigenvalues (b,) of the kept rows and columns; of sparse matrices by their pivots."""
    if isinstance(whole.matrix, np.ndarray):
        return _negative(whole.matrix[:, kept][:, :, kept])
    known = [bool(np.isfinite(each.data).all()) for each in whole.matrix]
    return np.array([negative_pivots(each[kept][:, kept], freedoms) if good else 0 for each, good in zip(whole.matrix, known, strict=True)])


def _negative(matrix: Array) -> Array:
    """Number of negative eigenvalues of symmetric matrices (..., n, n)."""
    return np.sum(np.linalg.eigvalsh(_even(matrix)) < 0.0, axis=-1)


def _even(matrix: Array) -> Array:
    """Symmetric matrices (..., n, n) scaled by their largest row entries."""
    even = 0.5 * (matrix + matrix.mT)
    size = np.sqrt(np.maximum(np.max(np.abs(even), axis=-1), 1e-300))
    return np.nan_to_num(even / size[..., None] / size[..., None, :])
