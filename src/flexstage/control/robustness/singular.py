"""Structured singular value of a matrix for one complex factor per channel: upper and lower bounds."""

from __future__ import annotations

import numpy as np
import scipy

from flexstage.base.number import Array

_POWERS = (4.0, 32.0, 256.0, 2048.0)


def balance(matrices: Array) -> Array:
    """Balance each matrix (f, n, n) by diagonal scaling e^{d_i} M_ij e^{-d_j}. Returns the logarithms d (f, n).

    By Osborne's rule, the off-diagonal norms of each row and the column with the same index become equal. The result is a start value for
    `upper_bound`, and often good enough.

    >>> balance(np.array([[[0.0, 100.0], [1.0, 0.0]]])).round(6).tolist()
    [[-1.151293, 1.151293]]
    """
    size = np.abs(matrices) ** 2
    count = matrices.shape[-1]
    logs = np.zeros(matrices.shape[:-1])
    for _ in range(12):
        for index in range(count):
            scaled = size * np.exp(2.0 * (logs[:, :, None] - logs[:, None, :]))
            row = np.sum(scaled[:, index, :], axis=-1) - scaled[:, index, index]
            column = np.sum(scaled[:, :, index], axis=-1) - scaled[:, index, index]
            usable = (row > 0.0) & (column > 0.0)
            logs[:, index] += np.where(usable, 0.25 * np.log(np.where(usable, column, 1.0) / np.where(usable, row, 1.0)), 0.0)
    return logs - np.mean(logs, axis=-1, keepdims=True)


def scaled(matrices: Array, logs: Array) -> Array:
    """Scale matrices (..., n, n) to e^{d_i} M_ij e^{-d_j} for the logarithms d (..., n)."""
    return matrices * np.exp(logs[..., :, None] - logs[..., None, :])


def scaled_size(matrix: Array, logs: Array) -> float:
    """Compute the largest singular value of e^{d_i} M_ij e^{-d_j} for the logarithms d.

    >>> scaled_size(np.array([[0.0, 4.0], [1.0, 0.0]]), np.array([-0.5, 0.5]) * np.log(2.0))
    2.0
    """
    return float(np.linalg.svd(scaled(matrix, logs), compute_uv=False)[0])


def upper_bound(matrix: Array, start: Array) -> tuple[float, Array]:
    """Minimise the largest singular value of e^{d_i} M_ij e^{-d_j} over d.

    Any d gives an upper bound of the structured singular value mu. The logarithm of the largest singular value is convex in d. At the
    minimum, several singular values sigma_k may coincide. Therefore the smooth norms (sum over k of sigma_k^(2p))^(1/(2p)) are minimised
    instead, with increasing p. The derivative of the logarithm of a norm with respect to d_i is the sum over k of w_k (|u_ik|^2 -
    |v_ik|^2). Here u_k and v_k are the left and right singular vectors of the scaled matrix; the weights w_k are proportional to
    sigma_k^(2p).

    >>> round(upper_bound(np.array([[0.0, 100.0], [1.0, 0.0]]), np.zeros(2))[0], 6)  # mu is the geometric mean of the two
    10.0
    """
    best, logs = scaled_size(matrix, start), start
    for power in _POWERS:
        found = scipy.optimize.minimize(_smooth, logs, args=(matrix, power), jac=True, method="BFGS", options={"gtol": 1e-9})
        size = scaled_size(matrix, found.x)
        if size < best:
            best, logs = size, found.x
    return best, logs - np.mean(logs)


def _smooth(logs: Array, matrix: Array, power: float) -> tuple[float, Array]:
    left, sizes, right = np.linalg.svd(scaled(matrix, logs))
    relative = np.maximum(sizes / max(sizes[0], 1e-300), 1e-300) ** (2.0 * power)
    weights = relative / np.sum(relative)
    value = np.log(max(sizes[0], 1e-300)) + 0.5 * np.log(np.sum(relative)) / power
    return float(value), (np.abs(left) ** 2 - np.abs(right.T) ** 2) @ weights


def lower_bound(matrix: Array) -> float:
    """Maximise the spectral radius of e^{j theta_i} M_ij over theta.

    Any theta gives a lower bound of the structured singular value mu. The BFGS method with several start values uses the derivatives d
    log|lambda| / d theta_i = -Im(conj(y_i) x_i / (y^H x)), where lambda is the eigenvalue of largest magnitude, x its right and y its left
    eigenvector.

    >>> round(lower_bound(np.array([[1.0, 2.0], [2.0, -1.0]])), 6), round(5.0**0.5, 6)  # equal to the largest singular value
    (2.236068, 2.236068)
    """
    left, _, right = np.linalg.svd(matrix)
    starts = [np.zeros(len(matrix)), *(-np.angle(left[:, index]) - np.angle(right[index]) for index in range(min(2, len(matrix))))]
    results = [
        scipy.optimize.minimize(_radius, start, args=(matrix,), jac=True, method="BFGS", options={"gtol": 1e-10}) for start in starts
    ]
    return float(np.exp(-min(result.fun for result in results)))


def _radius(phases: Array, matrix: Array) -> tuple[float, Array]:
    """-log of the spectral radius, and its gradient."""
    values, vectors = np.linalg.eig(np.exp(1j * phases)[:, None] * matrix)
    place = int(np.argmax(np.abs(values)))
    rows = np.linalg.pinv(vectors)
    return -float(np.log(max(abs(values[place]), 1e-300))), np.imag(rows[place] * vectors[:, place])
