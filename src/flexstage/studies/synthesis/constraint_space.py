"""Existence of parallel guides: whether wires and leaves between platform and ground can permit exactly the required motions.

Theorem (Hopkins & Culpepper, Precision Engineering 34, 2010, 259-270; Blanding, Exact Constraint, 1999). An ideal wire transmits a pure
force along its line, and a leaf transmits pure forces in its plane. They permit a motion if their forces do no work on it: the wrenches
(f, m) are reciprocal to the twist (v, w), f.v + m.w = 0. A parallel guide permits exactly the motions T if its forces span the whole space
R of wrenches reciprocal to T. Hence such a guide exists if and only if the pure forces in R, with f.m = 0 and f != 0, span R. If they do, a
wire along each force of a basis is a guide; otherwise, every guide also permits another motion.

The pure forces in R are the zeros of the quadratic form f.m on R. The zeros of an indefinite form of rank 3 or more span R, even without
those with f = 0, because no open part of such a cone is in a linear subspace. An indefinite form of rank 2 is the product of two linear
forms: its zeros are two hyperplanes; a hyperplane without forces is left out. The zeros of a semidefinite form are its kernel.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from flexstage.base.number import Array
from flexstage.spatial.frame import COMPONENTS

_SMALL = 1e-9
"""Relative size of rounding errors of orthonormal bases."""


def reciprocal_space(vectors: Array) -> Array:
    """Return an orthonormal basis (6, 6 - n) of the wrenches that do no work on n independent twists (6, n).

    For n wrenches, the result is a basis of the twists on which they do no work.

    >>> reciprocal_space(np.eye(6)[:, :2]).shape
    (6, 4)
    """
    return _span(np.eye(6) - (basis := _span(vectors)) @ basis.T)


def pure_force_span(wrenches: Array) -> Array:
    """Return an orthonormal basis (6, k) of the span of all pure forces within the span of wrenches (6, n).

    A wrench with force f and moment m is a pure force if f.m = 0 and f != 0.

    >>> np.abs(pure_force_span(np.eye(6)[:, [0, 3]])).T.tolist()  # a force along x, and a couple about x: only the force
    [[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]]
    """
    basis = _span(wrenches)
    work = basis[:3].T @ basis[3:]
    values, vectors = np.linalg.eigh(work + work.T)
    up, down = values > _SMALL, values < -_SMALL
    if not (up.any() and down.any()):
        return _with_forces(basis @ vectors[:, ~(up | down)])
    if np.count_nonzero(up | down) > 2:
        return basis
    across, kernel = vectors[:, up | down] / np.sqrt(np.abs(values[up | down])), vectors[:, ~(up | down)]
    planes = (np.column_stack([kernel, across @ (1.0, sign)]) for sign in (1.0, -1.0))
    return _span(np.column_stack([_with_forces(basis @ each) for each in planes]))


def _span(vectors: Array) -> Array:
    """An orthonormal basis of the span of columns."""
    left, sizes, _ = np.linalg.svd(vectors, full_matrices=False)
    return left[:, sizes > _SMALL]


def _with_forces(wrenches: Array) -> Array:
    """The wrenches, if any of their span has a force: those with a force then span them all. Otherwise none."""
    return wrenches if np.any(np.abs(wrenches[:3]) > _SMALL) else wrenches[:, :0]


def twists_of(motions: frozenset[str]) -> Array:
    """Return the unit twists (6, n) of motions along and about the axes.

    >>> twists_of(frozenset({"rz", "x"})).T.tolist()
    [[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, 1.0]]
    """
    return np.eye(6)[:, [axis in motions for axis in COMPONENTS]]


def has_parallel_guide(twists: Array) -> bool:
    """Return whether a parallel guide of wires and leaves permits exactly the span of twists (6, n).

    >>> [has_parallel_guide(twists_of(frozenset(each.split()))) for each in ("x y rz", "x rx", "x y")]
    [True, True, False]
    """
    others = reciprocal_space(twists)
    return pure_force_span(others).shape == others.shape


def serial_guides(motions: frozenset[str]) -> list[tuple[frozenset[str], ...]]:
    """Return all ways to obtain the motions with the fewest parallel guides in series; ways with more motions in the first guide are first.

    >>> [[sorted(each) for each in way] for way in serial_guides(frozenset({"x", "y", "z", "rz"}))]
    [[['rz', 'x', 'y'], ['z']], [['z'], ['rz', 'x', 'y']]]
    """
    if has_parallel_guide(twists_of(motions)):
        return [(motions,)]
    axes = sorted(motions, key=COMPONENTS.index)
    firsts = (frozenset(each) for count in range(len(axes) - 1, 0, -1) for each in combinations(axes, count))
    ways = [(first, *rest) for first in firsts if has_parallel_guide(twists_of(first)) for rest in serial_guides(motions - first)]
    fewest = min(map(len, ways))
    return [way for way in ways if len(way) == fewest]
