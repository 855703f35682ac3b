"""Blockage: the locked DOFs that prevent a stroke, and the DOFs to free.

A stroke is blocked if there are forces in locked DOFs that are in equilibrium on all bodies and do work only on the stroke. Usually several
sets of such forces exist. The set with the least sum of magnitudes (a linear programme) has few forces; their links are the result.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.number import Array

_HELD = 1e-7
"""Forces below this are zero, and a column is a combination of rows if its remainder is below this."""
_RANK = 1e-9


@dataclass(frozen=True)
class Blockage:
    """Cause of an immobile stroke: the locked DOFs that work against it, sorted by decreasing force, and the DOFs to free.

    `against` and `free` contain the names of DOFs (`link.freedom`). If `together` is false, it is sufficient to free any one DOF of `free`;
    otherwise, all must be freed.

    At the `ends` (ground or platform), a hinge is missing: the actuator is joined directly to these bodies, and its own locked DOFs prevent
    its stroke.
    """

    against: tuple[str, ...]
    free: tuple[str, ...]
    together: bool = False
    ends: tuple[str, ...] = ()


def blockage(constraints: Array, stroke: int, names: Sequence[str], intended: frozenset[str]) -> Blockage:
    """Find the locked DOFs that block a stroke: the column `stroke` of the scaled `constraints` (m, N), whose rows have `names`.

    The first six columns belong to the platform. With the returned DOFs free, the stroke moves the platform. If possible, DOFs in
    `intended` (ideal DOFs of parts) are returned.

    >>> rows = np.zeros((3, 7))
    >>> rows[0, [0, 6]], rows[1, 0], rows[2, 1] = (1.0, -1.0), 1.0, 1.0
    >>> blockage(rows, 6, ("stack.x", "leaf.x", "leaf.y"), frozenset())
    Blockage(against=('leaf.x',), free=('leaf.x',), together=False, ends=())
    """
    against = _against(constraints, stroke)
    alone = _decisive(constraints, stroke) & ~_decisive(_at_platform(constraints), stroke)[: len(constraints)]
    single = [row for row in against if alone[row]]
    if single:
        meant = [row for row in single if names[row] in intended]
        return Blockage(_unique_names(against, names), _unique_names(meant or single, names))
    left, freed, fixed = list(range(len(names))), [], []
    while against and not _moves(constraints[left], stroke):
        rows = [left[row] for row in against]
        fixed += rows
        freed.append(next((row for row in rows if names[row] in intended), rows[0]))
        left.remove(freed[-1])
        against = _against(constraints[left], stroke)
    return Blockage(_unique_names(fixed, names), _unique_names(freed, names), together=True)


def _against(constraints: Array, stroke: int) -> list[int]:
    """Rows whose forces work against the stroke, largest first; rows that drive the platform are excluded."""
    forces = np.round(np.abs(_forces(constraints, stroke)), 9)
    rows = [row for row in np.argsort(-forces, kind="stable").tolist() if forces[row] > _HELD and constraints[row, stroke] == 0.0]
    driving = _decisive(_at_platform(constraints), stroke)
    return [row for row in rows if not driving[row]] or rows


def _decisive(constraints: Array, stroke: int) -> Array:
    """Rows (m,) that each prevent the stroke: every force state against it contains them, and no self-stress does."""
    forces, stresses = _states(constraints, stroke)
    return (np.abs(forces) > _HELD) & (np.linalg.norm(stresses, axis=1) < _HELD)


def _states(constraints: Array, stroke: int) -> tuple[Array, Array]:
    """Forces (m,) with C^T f = e by least squares, and a basis (m, k) of the self-stresses, C^T f = 0."""
    left, values, right = np.linalg.svd(constraints, full_matrices=True)
    rank = int(np.sum(values > _RANK * values[0]))
    return left[:, :rank] @ (right[:rank, stroke] / values[:rank]), left[:, rank:]


def _unique_names(rows: Sequence[int], names: Sequence[str]) -> tuple[str, ...]:
    """Unique names of rows: instances of a link share one."""
    return tuple(dict.fromkeys(names[row] for row in rows))


def _forces(constraints: Array, stroke: int) -> Array:
    """Forces (m,) of least total magnitude with C^T f = e, the stroke's unit vector."""
    count, size = constraints.shape
    unit = (np.arange(size) == stroke).astype(float)
    solved = scipy.optimize.linprog(np.ones(2 * count), A_eq=np.hstack([constraints.T, -constraints.T]), b_eq=unit, method="highs")
    if solved.x is None:  # least squares if rounding makes the programme infeasible
        return np.asarray(np.linalg.lstsq(constraints.T, unit, rcond=_HELD)[0])
    return np.asarray(solved.x[:count] - solved.x[count:])


def _moves(constraints: Array, stroke: int) -> bool:
    """Whether the stroke can move and moves the platform: with the platform fixed, it cannot."""
    return not _is_held(constraints, stroke) and _is_held(_at_platform(constraints), stroke)


def _at_platform(constraints: Array) -> Array:
    """The constraints with the platform fixed."""
    return np.concatenate([constraints, np.eye(6, constraints.shape[1])])


def _is_held(constraints: Array, stroke: int) -> bool:
    unit = (np.arange(constraints.shape[1]) == stroke).astype(float)
    return bool(np.linalg.norm(constraints.T @ _states(constraints, stroke)[0] - unit) < _HELD)
