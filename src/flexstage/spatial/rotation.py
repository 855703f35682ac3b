"""Finite rotations: rotation vectors and rotation matrices (exponential and logarithm of SO(3)).

A rotation vector points along the axis, its length is the angle [rad]. All arrays may carry leading batch axes and may be complex.
"""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.spatial.frame import cross_matrix

_SMALL = 1e-4


def exponential(vector: Array) -> Array:
    """Rotation matrix (..., 3, 3) of a rotation vector (..., 3) [rad]: Rodrigues, R = I + sin t/t [v]x + (1 - cos t)/t^2 [v]x^2.

    >>> exponential(np.array([0.0, 0.0, np.pi / 2])).round(12).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """
    square = np.sum(vector * vector, axis=-1)
    small = np.real(square) < _SMALL
    angle = np.sqrt(np.where(small, 1.0, square))
    first = np.where(small, 1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0)), np.sin(angle) / angle)
    half = np.sin(0.5 * angle) / angle
    second = np.where(small, 0.5 - square / 24.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)), 2.0 * half * half)
    cross = cross_matrix(vector)
    return np.eye(3) + first[..., None, None] * cross + second[..., None, None] * (cross @ cross)


def logarithm(rotation: Array) -> Array:
    """Rotation vector (..., 3) [rad] of a rotation matrix (..., 3, 3), for angles below pi (3.1 is safe).

    With s = sin t and c = cos t from the antisymmetric part and the trace, t = 2 atan(s / (1 + c)).

    >>> logarithm(exponential(np.array([0.1, -0.2, 0.3]))).round(12).tolist()
    [0.1, -0.2, 0.3]
    """
    skew = 0.5 * (rotation - np.swapaxes(rotation, -1, -2))
    axis = np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=-1)
    cosine = 0.5 * (np.trace(rotation, axis1=-2, axis2=-1) - 1.0)
    square = np.sum(axis * axis, axis=-1)
    small = (np.real(square) < _SMALL) & (np.real(cosine) > 0.0)
    sine = np.sqrt(np.where(np.real(square) < _SMALL**4, 1.0, square))
    series = 1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * (5.0 / 112.0 + square * 35.0 / 1152.0)))
    factor = np.where(small, series, 2.0 * np.arctan(sine / (1.0 + cosine)) / sine)
    return factor[..., None] * axis


def logarithm_rate(vector: Array) -> Array:
    """The matrix J (..., 3, 3) with log(exp(w) R) = v + J w for small w, where v = log R: the inverse of the left Jacobian of SO(3).

    J = I - [v]x / 2 + (1 - (t/2) cot(t/2)) / t^2 [v]x^2 (Chirikjian, Stochastic Models, Information Theory, and Lie Groups 2, 10.86).

    >>> logarithm_rate(np.zeros(3)).tolist() == np.eye(3).tolist()
    True
    """
    square = np.sum(vector * vector, axis=-1)
    small = np.real(square) < _SMALL
    angle = np.sqrt(np.where(small, 1.0, square))
    closed = (1.0 - 0.5 * angle / np.tan(0.5 * angle)) / (angle * angle)
    series = 1.0 / 12.0 + square / 720.0 * (1.0 + square / 42.0)
    cross = cross_matrix(vector)
    return np.eye(3) - 0.5 * cross + np.where(small, series, closed)[..., None, None] * (cross @ cross)
