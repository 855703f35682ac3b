"""Controller in modal form: decoupled blocks of one or two states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

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
    columns, blocks = list[Array](), list[list[list[float]]]()
    values, vectors = np.linalg.eig(given.A)
    for value, vector in zip(values, vectors.T, strict=True):
        if value.imag == 0.0:
            columns.append(vector.real)
            blocks.append([[value.real]])
        elif value.imag > 0.0:  # only the first of a pair
            columns += [np.sqrt(2.0) * vector.real, np.sqrt(2.0) * vector.imag]
            blocks.append([[value.real, value.imag], [-value.imag, value.real]])
    basis = np.stack(columns, axis=-1)
    if np.linalg.cond(basis) > _WORST:
        return given
    return replace(given, A=scipy.linalg.block_diag(*blocks), B=np.linalg.inv(basis) @ given.B, C=given.C @ basis)
