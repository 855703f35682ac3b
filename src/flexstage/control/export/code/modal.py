"""Controller in modal form: decoupled blocks of one or two states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexstage.base.number import Array
from flexstage.control.systems.system import System

_WORST = 1e8


def modal_form(given: System) -> System:
    """Transform the states x of a system to z = V^-1 x, so that its matrix A has diagonal blocks of one and two states.

    The columns of V are the real mode vectors of A, of unit length.

    Returns the system unchanged if the condition number of V exceeds 1e8 (dependent modes).

    >>> from flexstage.control.example import integral_loop
    >>> closed = integral_loop().system
    >>> found = modal_form(closed)
    >>> both = [each.transfer(np.array([50.0])) for each in (found, closed)]
    >>> bool(np.count_nonzero(found.A) <= 2 * len(closed.A)), bool(np.allclose(*both))
    (True, True)
    """
    if not len(given.A):
        return given
    values, vectors = np.linalg.eig(given.A)
    basis = _real_basis(values, vectors)
    if np.linalg.cond(basis) > _WORST:
        return given
    back = np.linalg.inv(basis)
    return replace(given, A=_blocks(values), B=back @ given.B, C=given.C @ basis)


def _real_basis(values: Array, vectors: Array) -> Array:
    """Real parts, followed by imaginary parts for pairs; only the first of a pair is used."""
    columns: list[Array] = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value.imag == 0.0:
            columns.append(vector.real)
        elif value.imag > 0.0:
            columns += [np.sqrt(2.0) * vector.real, np.sqrt(2.0) * vector.imag]
    return np.stack(columns, axis=-1)


def _blocks(values: Array) -> Array:
    """Diagonal blocks of A in the real basis."""
    found, row = np.zeros((len(values), len(values))), 0
    for value in values:
        if value.imag == 0.0:
            found[row, row] = value.real
            row += 1
        elif value.imag > 0.0:
            found[row : row + 2, row : row + 2] = [[value.real, value.imag], [-value.imag, value.real]]
            row += 2
    return found
