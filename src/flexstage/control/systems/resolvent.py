"""Frequency responses at many points: one Schur form, then triangular solves for all points at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.control.systems.system import System

_CHUNK = 2_000_000
_FEW = 12
"""Points that are solved one by one: the rows of a triangle cost more than these, if each is a step of its own."""


@dataclass(frozen=True, eq=False)
class Resolvent:
    """A system in Schur form, A = Q T Q^H: H = C Q (lambda - T)^-1 Q^H B + D costs n^2 a point, whether or not A has all eigenvectors."""

    system: System
    triangle: Array
    entry: Array
    exit: Array

    def at(self, frequencies: Array) -> Array:
        """H, complex (f, p, m), at `frequencies` (f,) in Hz; infinite ones give D (continuous systems only)."""
        frequencies = np.asarray(frequencies, dtype=float)
        finite = np.where(np.isfinite(frequencies), frequencies, 0.0)
        turning = 2j * np.pi * finite
        points = turning if self.system.step is None else np.exp(turning * self.system.step)
        size = max(1, _CHUNK // max(1, self.entry.size))
        pieces = [self._at(points[start : start + size]) for start in range(0, len(points), size)]
        found = np.concatenate(pieces) if pieces else np.zeros((0, *self.system.D.shape), complex)
        return np.where(np.isfinite(frequencies)[:, None, None], found, self.system.D)

    def _at(self, points: Array) -> Array:
        if len(points) <= _FEW and len(self.triangle):
            return np.stack([self.exit @ self._solved(point) for point in points]) + self.system.D
        return self._at_many(points)

    def _solved(self, point: complex) -> Array:
        shifted = -self.triangle
        np.einsum("ii->i", shifted)[:] += point
        return scipy.linalg.blas.ztrsm(1.0, shifted, self.entry)

    def _at_many(self, points: Array) -> Array:
        """Back substitution, row by row, for all points."""
        size, width = self.entry.shape
        solved = np.zeros((size, len(points) * width), complex)
        shifted = points[:, None] - np.diag(self.triangle)
        for row in range(size - 1, -1, -1):
            above = self.triangle[row, row + 1 :] @ solved[row + 1 :]
            solved[row] = ((self.entry[row] + above.reshape(len(points), width)) / shifted[:, row, None]).ravel()
        found = (self.exit @ solved).reshape(len(self.exit), len(points), width)
        return np.moveaxis(found, 0, 1) + self.system.D


def resolvent(system: System) -> Resolvent:
    """Prepare a system for its response at many frequencies.

    >>> from flexstage.control.example import integral_loop
    >>> system, far = integral_loop().system, np.array([1.0, 30.0, 4000.0])
    >>> bool(np.allclose(resolvent(system).at(far), system.transfer(far)))
    True
    """
    if not np.any(np.tril(system.A, -1)):  # laws of one loop are triangles as they stand
        return Resolvent(system, system.A.astype(complex), system.B.astype(complex), system.C.astype(complex))
    balanced, (scale, _) = scipy.linalg.matrix_balance(system.A, permute=False, separate=True)
    found: Any = scipy.linalg.schur(balanced.astype(complex), output="complex")
    triangle, vectors = found
    return Resolvent(system, triangle, vectors.conj().T @ (system.B / scale[:, None]), (system.C * scale) @ vectors)
