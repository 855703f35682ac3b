"""Frequency responses from modes: the modal sum, and residual terms of modes outside the band (least-squares frequency domain, LSFD)."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array


def modal_sum(frequencies: Array, poles: Array, shapes: Array, participation: Array) -> Array:
    """Compute the responses H (f, p, m) of modes at frequencies in Hz, with poles (k,) in rad/s.

    At the angular frequency w, H is the sum of two terms for each mode: shape (p, k) times participation (k, m) / (j w - pole), and the
    same term with conjugate shape, participation and pole (Heylen, Lammens & Sas, Modal Analysis Theory and Testing, 1997, A.1).

    >>> one = modal_sum(np.array([0.0]), np.array([-1.0 + 10j]), np.array([[1.0]]), np.array([[-0.5j]]))
    >>> round(one.item().real, 6)
    0.09901
    """
    omega = 2j * np.pi * np.asarray(frequencies)
    values = np.zeros((len(omega), len(shapes), participation.shape[1]), dtype=complex)
    for pole, shape, row in zip(poles, shapes.T, participation, strict=True):
        residue = np.outer(shape, row)
        values += residue / (omega - pole)[:, None, None] + np.conj(residue) / (omega - np.conj(pole))[:, None, None]
    return values


def remainder(frequencies: Array, rest: Array, weights: Array) -> Array:
    """Fit two residual terms (2, p, m) to responses (f, p, m): rest = lower / w^2 + upper, at the angular frequencies w.

    The shape of `weights` is (f, p); `frequencies` are above 0 [Hz]. The residual terms are the mass line of modes below the band and the
    stiffness line of modes above the band. Both residual terms are real, because these modes have little damping in the band.

    >>> lines = np.array([1.0, 2.0, 3.0])
    >>> remainder(lines, 5.0 + 1.0 / (2 * np.pi * lines[:, None, None]) ** 2, np.ones((3, 1))).round(9).ravel().tolist()
    [1.0, 5.0]
    """
    terms = _terms(frequencies)
    found = np.empty((2, *rest.shape[1:]))
    for output in range(rest.shape[1]):
        weight = weights[:, output, None]
        scale = np.linalg.norm(weight * terms, axis=0)
        solved = np.linalg.lstsq(weight * terms / scale, weight * np.real(rest[:, output]), rcond=None)[0]
        found[:, output] = solved / scale[:, None]
    return found


def remainder_sum(frequencies: Array, residuals: Array) -> Array:
    """Evaluate the response (f, p, m) of the lower and upper residual terms.

    >>> remainder_sum(np.array([1.0]), np.array([[[0.0]], [[5.0]]])).ravel().tolist()
    [5.0]
    """
    return np.tensordot(_terms(frequencies), residuals, axes=1)


def _terms(frequencies: Array) -> Array:
    omega = 2.0 * np.pi * np.maximum(np.asarray(frequencies, dtype=float), 1e-300)
    return np.stack([omega**-2.0, np.ones_like(omega)], axis=1)
