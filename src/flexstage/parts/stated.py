"""Specified matrices of parts without a shape, and checks of 6x6 matrices: symmetry, axisymmetry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array, Number, first_design
from flexstage.parts.freedom import Freedom
from flexstage.spatial.frame import mirror

_SLACK = 1e-9
_QUARTER: Array = np.kron(np.eye(2), np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]))


@dataclass(frozen=True, eq=False)
class Stated:
    """Specified matrices of a part without a shape, in SI units, about the part's centre and in its frame.

    `stiffness` (..., 6, 6) and the optional viscous `damping` (..., 6, 6) are for motion of the second end relative to the first. The rows
    and columns of `mass` (..., 12, 12) belong to the twists of both ends.
    """

    stiffness: Array
    mass: Array
    damping: Array | None = None


def point_masses(first: Number, second: Number) -> Array:
    """Return the mass matrix (..., 12, 12) of point masses [kg] at a part's centre, one on each of its two bodies, without rotary inertia.

    >>> point_masses(1.0, 2.0).diagonal().tolist()
    [1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 0.0, 0.0, 0.0]
    """
    along = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    ends = np.broadcast_arrays(*(np.asarray(mass)[..., None] * along for mass in (first, second)))
    return np.concatenate(ends, axis=-1)[..., None] * np.eye(12)


def halves(inertia: Array) -> Array:
    """Distribute the mass matrix (..., 6, 6) of a rigid solid equally to both ends; return the mass matrix (..., 12, 12) of the ends.

    >>> halves(4.0 * np.eye(6)).diagonal()[5:7].tolist()
    [2.0, 2.0]
    """
    none = np.zeros_like(inertia)
    return 0.5 * np.concatenate([np.concatenate([inertia, none], axis=-1), np.concatenate([none, inertia], axis=-1)], axis=-2)


def line_mass(mass: Number, length: Number) -> Array:
    """Compute the consistent mass matrix (..., 12, 12) of a uniform line with its ends at +-L/2 from the centre; L is the length.

    The velocity is interpolated linearly between the ends: a line of mass m therefore has m/3 at each end and a coupling of m/6. A spring
    fixed at one end thus adds a third of its mass to its other end.

    >>> line_mass(6.0, 0.0)[0, [0, 6]].tolist()
    [2.0, 1.0]
    """
    half = 0.5 * np.asarray(length)
    first, second = _end(-half), _end(half)
    ends = np.concatenate([first, np.zeros_like(first)], axis=-1), np.concatenate([np.zeros_like(second), second], axis=-1)
    own, mixed = (one.mT @ other for one, other in ((ends[0], ends[0]), (ends[0], ends[1])))
    other = ends[1].mT @ ends[1]
    return np.asarray(mass)[..., None, None] * ((own + other) / 3.0 + (mixed + mixed.mT) / 6.0)


def _end(arm: Array) -> Array:
    """Displacement (..., 3, 6) at x = `arm` (...) per twist at the centre."""
    across = np.zeros((3, 6))
    across[1, 5], across[2, 4] = 1.0, -1.0
    return np.eye(3, 6) + arm[..., None, None] * across


def is_even(freedoms: tuple[Freedom, ...]) -> bool:
    """Return whether each degree of freedom along or about y has its counterpart along or about z.

    >>> is_even((Freedom.RZ,)), is_even((Freedom.RY, Freedom.RZ))
    (False, True)
    """
    pairs = ((Freedom.Y, Freedom.Z), (Freedom.RY, Freedom.RZ))
    return all((one in freedoms) == (other in freedoms) for one, other in pairs)


def turns_into_itself(matrix: Array) -> bool:
    """Return whether a 6x6 matrix (..., 6, 6) is invariant under a quarter turn about x.

    >>> turns_into_itself(np.eye(6)), turns_into_itself(np.diag([1.0, 2.0, 3.0, 1.0, 1.0, 1.0]))
    (True, False)
    """
    return bool(np.allclose(_QUARTER @ matrix @ _QUARTER.T, matrix, rtol=1e-9, atol=0.0))


def mirror_rows(rows: tuple[tuple[Number, ...], ...]) -> tuple[tuple[Number, ...], ...]:
    """Return the mirror image of a 6x6 matrix in the x-z plane: entries that couple y, rx or rz with x, z or ry change sign.

    >>> mirror_rows(tuple(map(tuple, np.ones((6, 6)).tolist())))[0]
    (1.0, -1.0, 1.0, -1.0, 1.0, -1.0)
    """
    signs = [float(sign) for sign in np.diag(mirror(1))]
    return tuple(tuple(one * other * entry for other, entry in zip(signs, row, strict=True)) for one, row in zip(signs, rows, strict=True))


def symmetry_findings(where: str, matrix: Array) -> Iterator[Finding]:
    """Return an error if a 6x6 matrix (..., 6, 6) is not symmetric; the message contains entries of the first design.

    >>> [each.what for each in symmetry_findings("parts.a.matrix", np.eye(6) + np.eye(6, k=1))]
    ['not symmetric: 1 and 0 SI']
    """
    real = np.real(matrix)
    mirrored = real.mT
    size = np.max(np.abs(real), axis=-1)
    scale = np.sqrt(size[..., :, None] * size[..., None, :])
    unequal = np.abs(real - mirrored) > _SLACK * scale
    if np.any(unequal):
        flat = [each.reshape(-1, 6, 6) for each in (unequal, real, mirrored)]
        at = tuple(np.argwhere(flat[0])[0])
        what = f"not symmetric: {flat[1][at]:.6g} and {flat[2][at]:.6g} SI"
        yield Finding(f"{where} at index {at[1]}, {at[2]}", what, "Use equal entries on both sides of the diagonal")


def definite_findings(where: str, matrix: Array) -> Iterator[Finding]:
    """Return an error if a 6x6 matrix is not symmetric, or not positive definite.

    >>> [each.what[:28] for each in definite_findings("matrix", np.diag([1.0, 1.0, 1.0, 1.0, 1.0, -1.0]))]
    ['not positive definite: the l']
    """
    unequal = tuple(symmetry_findings(where, matrix))
    yield from unequal
    scale = np.sqrt(np.abs(np.einsum("...ii->...i", np.real(matrix))))
    safe = np.where(scale > 0.0, scale, 1.0)
    lowest = np.min(np.linalg.eigvalsh(np.real(matrix) / safe[..., :, None] / safe[..., None, :]))
    if not unequal and lowest <= 0.0:
        what = f"not positive definite: the lowest eigenvalue of its scaled form is {lowest:.3g}"
        yield Finding(where, what, "Check signs and units of its entries; use a restricted part (not a zero) to lock a motion")


def negative_part(matrix: Array, lengths: Array) -> Array:
    """Return the negative part of a stiffness (..., 6, 6) as a positive semidefinite matrix (6, 6), for the first design.

    Rows and columns are divided by `lengths` (6,) before negative eigenvalues are separated, and multiplied by `lengths` afterwards.

    >>> negative_part(np.diag([-2.0, 1.0, 0.0, 0.0, 0.0, 0.0]), np.ones(6)).diagonal()[:2].tolist()
    [2.0, 0.0]
    """
    values, vectors = np.linalg.eigh(np.real(first_design(matrix, 2)) / lengths[:, None] / lengths)
    depth = np.where(values < -_SLACK * np.max(np.abs(values), initial=0.0), -values, 0.0)
    return (vectors * depth) @ vectors.T * lengths[:, None] * lengths
