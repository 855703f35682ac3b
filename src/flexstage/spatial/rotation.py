"""Finite rotations: rotation vectors and rotation matrices (exponential and logarithm of SO(3)).

A rotation vector points along the axis; its length is the angle [rad]. All arrays may have leading batch axes and may be complex.
"""

from __future__ import annotations

import math

import numpy as np

from flexstage.base.number import Array
from flexstage.spatial.frame import cross_matrix

_SMALL = 1e-4


def exponential(vector: Array) -> Array:
    """Compute the rotation matrix (..., 3, 3) of a rotation vector (..., 3) [rad] (Rodrigues' formula).

    R = I + (sin t / t) [v]x + ((1 - cos t) / t^2) [v]x^2, with the angle t = |v| and the cross-product matrix [v]x.

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
    """Compute the rotation vector (..., 3) [rad] of a rotation matrix (..., 3, 3), for angles below pi (accurate up to 3.1).

    >>> logarithm(exponential(np.array([0.1, -0.2, 0.3]))).round(12).tolist()
    [0.1, -0.2, 0.3]
    """
    skew = 0.5 * (rotation - rotation.mT)
    axis = np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=-1)
    cosine = 0.5 * (np.trace(rotation, axis1=-2, axis2=-1) - 1.0)
    square = np.sum(axis * axis, axis=-1)
    small = (np.real(square) < _SMALL) & (np.real(cosine) > 0.0)
    sine = np.sqrt(np.where(np.real(square) < _SMALL**4, 1.0, square))
    series = 1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * (5.0 / 112.0 + square * 35.0 / 1152.0)))
    factor = np.where(small, series, 2.0 * np.arctan(sine / (1.0 + cosine)) / sine)
    return factor[..., None] * axis


def rotation_vector(rotation: Array) -> Array:
    """Compute the rotation vector (3,) [rad] of one real rotation matrix (3, 3), for every angle up to pi.

    The rotation is first converted to a unit quaternion, largest component first (Shepperd, J. Guid. Control 1, 223, 1978). The result is
    exact even at the angle pi, where `logarithm` is singular.

    >>> (rotation_vector(np.diag([-1.0, 1.0, -1.0])) / np.pi).tolist()
    [0.0, 1.0, 0.0]
    """
    skew = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    trace = rotation[0, 0] + rotation[1, 1] + rotation[2, 2]
    largest = int(np.argmax([*np.diag(rotation), trace]))
    if largest == 3:
        axis, scalar = skew, 1.0 + trace
    else:
        axis, scalar = rotation[largest] + rotation[:, largest], skew[largest]
        axis[largest] = 1.0 - trace + 2.0 * rotation[largest, largest]
    a, b, c, d = (float(value) for value in (*axis, scalar))
    length = math.copysign(math.sqrt(a * a + b * b + c * c + d * d), d)
    a, b, c, d = a / length, b / length, c / length, d / length
    sine = math.sqrt(a * a + b * b + c * c)
    angle = 2.0 * math.atan2(sine, d)
    scale = angle / math.sin(0.5 * angle) if angle > 0.0 else 2.0
    return scale * np.array([a, b, c])


def logarithm_rate(vector: Array) -> Array:
    """Compute the inverse left Jacobian J (..., 3, 3) of SO(3): log(exp(w) R) = v + J w for small w, where v = log R.

    J = I - [v]x / 2 + ((1 - (t/2) cot(t/2)) / t^2) [v]x^2, with the angle t = |v| and the cross-product matrix [v]x (Chirikjian, Stochastic
    Models, Information Theory, and Lie Groups 2, 10.86).

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


def exponential_rate(vector: Array) -> Array:
    """Compute the left Jacobian T (..., 3, 3) of SO(3): exp(v + d) = exp(T d) exp(v) for small d; the inverse of `logarithm_rate`.

    T = I + ((1 - cos t) / t^2) [v]x + ((t - sin t) / t^3) [v]x^2, with the angle t = |v| and the cross-product matrix [v]x (Chirikjian 2,
    10.86).

    >>> exponential_rate(np.zeros(3)).tolist() == np.eye(3).tolist()
    True
    """
    square = np.sum(vector * vector, axis=-1)
    small = np.real(square) < _SMALL
    angle = np.sqrt(np.where(small, 1.0, square))
    half = np.sin(0.5 * angle) / angle
    first = np.where(small, 0.5 - square / 24.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)), 2.0 * half * half)
    series = 1.0 / 6.0 - square / 120.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))
    second = np.where(small, series, (1.0 - np.sin(angle) / angle) / (angle * angle))
    cross = cross_matrix(vector)
    return np.eye(3) + first[..., None, None] * cross + second[..., None, None] * (cross @ cross)


GAUSS_THREE: Array = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)])
"""Gauss points of a `magnus` step, as fractions of the step."""


def magnus(step: Array, first: Array, middle: Array, last: Array) -> Array:
    """Compute the rotation vector W (..., 3) [rad] of one integration step of R' = R [k]x: R becomes R exp(W).

    `step` (...) is the step length. The rotation rate k (..., 3) is given at the three Gauss points `first`, `middle`, `last`. The method
    is of order 6 (Blanes, Casas, Oteo and Ros, Physics Reports 470, 2009, 5.2; that paper treats Y' = A Y, for which the signs of all
    brackets are opposite).

    >>> magnus(np.array(2.0), *np.tile([0.1, 0.0, 0.3], (3, 1))).round(12).tolist()
    [0.2, 0.0, 0.6]
    """
    step = step[..., None]
    one = step * middle
    two = np.sqrt(15.0) / 3.0 * step * (last - first)
    three = 10.0 / 3.0 * step * (last - 2.0 * middle + first)
    bracket = cross(two, one)
    inner = two - cross(2.0 * three + bracket, one) / 60.0
    return one + three / 12.0 + cross(inner, bracket - 20.0 * one - three) / 240.0


def cross(one: Array, other: Array) -> Array:
    """Compute the cross product of vectors (..., 3), faster than numpy's.

    >>> cross(np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])).tolist()
    [0.0, 0.0, 1.0]
    """
    a, b, c = one[..., 0], one[..., 1], one[..., 2]
    d, e, f = other[..., 0], other[..., 1], other[..., 2]
    return np.stack(np.broadcast_arrays(b * f - c * e, c * d - a * f, a * e - b * d), axis=-1)
