"""Exact elimination of linear constraints by a pivoted partition of the coordinates.

For constraints A z = 0 of rank r, the independent coordinates z_i determine the r dependent coordinates z_d = -A_d^-1 A_i z_i.

Pivots are chosen by real parts, so that complex steps remain valid. `eliminate` chooses the pivots of all designs from the first design of
a batch; `eliminate_each` chooses them for each design.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Array, first_design

_RANK = 1e-9
_WEAKER = 1e-3
"""Permitted decrease of pivot independence from the first design to another one of a batch."""
_PREFERENCE = 1e-6
"""Symmetric stages have equal pivots: each column counts this much less than the previous one, so that rounding does not decide."""


@dataclass(frozen=True, eq=False)
class Elimination:
    """Solution of the constraints: z = `basis` z_i with the f independent coordinates z_i; `basis` (..., N, f).

    `independent` and `dependent` are indices of coordinates, `rows` are the constraints that determine the dependent coordinates.
    """

    basis: Array
    independent: tuple[int, ...]
    dependent: tuple[int, ...]
    rows: tuple[int, ...]

    @property
    def rank(self) -> int:
        """Number of independent constraints."""
        return len(self.dependent)


def eliminate(constraints: Array, scale: Array, keep: tuple[int, ...] = ()) -> Elimination:
    """Eliminate the constraints A z = 0, A (..., m, N).

    `scale` (N,) makes the coordinates comparable. Coordinates in `keep` remain independent if possible.

    Raises `DesignError` if the pivots of the first design are linearly dependent, or nearly dependent, in another design of the batch.

    >>> eliminate(np.array([[1.0, 2.0]]), np.ones(2), keep=(0,)).basis.ravel().tolist()
    [1.0, -0.5]
    """
    choice = _choice(np.real(first_design(constraints, 2)), scale, keep)
    _require_served(constraints, scale, choice)
    return _solved(constraints, choice)


def _require_served(constraints: Array, scale: Array, choice: _Choice) -> None:
    """Refuse designs in which the pivots of the first are nearly dependent, or leave constraints unsatisfied."""
    designs = np.real(constraints).reshape(math.prod(constraints.shape[:-2]), *constraints.shape[-2:])
    others = np.flatnonzero(np.any(designs != designs[0], axis=(1, 2)) & np.all(np.isfinite(designs), axis=(1, 2)))
    if not len(others):
        return
    dependent, rows = (list(each) for each in choice)
    scaled = _comparable(np.concatenate([designs[:1], designs[others]]), scale)
    least = np.min(np.linalg.svd(scaled[:, rows][..., dependent], compute_uv=False), axis=1, initial=1.0)
    _require_none(others[least[1:] < max(_RANK, _WEAKER * least[0])])
    missed = np.max(np.abs(scaled[1:] @ _solved(scaled[1:], choice).basis), axis=(1, 2), initial=0.0)
    _require_none(others[missed > _RANK])


def _require_none(others: Array) -> None:
    if len(others):
        raise unlike(int(others[0]), "differs from the first design in the dependence between locked degrees of freedom")


def unlike(number: int, what: str) -> DesignError:
    """Build the error for design `number` (from 0) of a batch; `what` is its structural difference from the first design."""
    return refuse("designs", f"design {number + 1} of the batch {what}", "Analyse the designs one by one")


def eliminate_each(constraints: Array, scale: Array, keep: tuple[int, ...] = ()) -> Elimination:
    """Eliminate like `eliminate`, but with separate pivots for each design of a batch. Results equal single-design results bit for bit.

    `scale` is (..., N). The designs may differ in the independent coordinates outside `keep`; the indices of the first design are returned.

    Raises `DesignError` if designs differ in the independent coordinates within `keep`, or in the number of independent coordinates.

    >>> rows = np.array([[[1.0, 2.0, 0.0]], [[1.0, 0.0, 2.0]]])
    >>> eliminate_each(rows, np.ones((2, 3)), keep=(0,)).basis[:, :, 0].tolist()
    [[1.0, -0.5, 0.0], [1.0, 0.0, -0.5]]
    """
    batch = np.broadcast_shapes(constraints.shape[:-2], scale.shape[:-1])
    count, size = math.prod(batch), constraints.shape[-2:]
    flat = np.broadcast_to(constraints, (*batch, *size)).reshape(count, *size)
    groups = _by_choice(np.real(flat), np.broadcast_to(scale, (*batch, size[1])).reshape(count, size[1]), keep)
    parts = [_solved(flat[designs], choice) for choice, designs in groups.items()]
    _require_alike(parts, list(groups.values()), keep)
    basis = np.empty((len(flat), *parts[0].basis.shape[1:]), dtype=flat.dtype)
    for part, designs in zip(parts, groups.values(), strict=True):
        basis[designs] = part.basis
    return replace(parts[0], basis=basis.reshape(*batch, *basis.shape[1:]))


_Choice = tuple[tuple[int, ...], tuple[int, ...]]


def _by_choice(designs: Array, scale: Array, keep: tuple[int, ...]) -> dict[_Choice, list[int]]:
    """Numbers of the designs (b, m, N) by common choice of pivots; complex steps of one design share its choice."""
    result: dict[_Choice, list[int]] = {}
    last: _Choice | None = None
    for number, (rows, sizes) in enumerate(zip(designs, scale, strict=True)):
        stays = last is not None and np.array_equal(rows, designs[number - 1]) and np.array_equal(sizes, scale[number - 1])
        last = last if stays and last is not None else _choice(rows, sizes, keep)
        result.setdefault(last, []).append(number)
    return result


def _require_alike(parts: Sequence[Elimination], designs: Sequence[list[int]], keep: tuple[int, ...]) -> None:
    """Refuse designs whose motions differ from the first design's."""
    mine = _freedom(parts[0], keep)
    for part, numbers in zip(parts[1:], designs[1:], strict=True):
        theirs = _freedom(part, keep)
        if theirs != mine:
            counts = [f"{len(kept)} of the platform and {others} others" for kept, others in (theirs, mine)]
            other = f"{counts[0]} instead of {counts[1]}" if counts[0] != counts[1] else f"also {counts[1]}, but in other coordinates"
            raise unlike(numbers[0], f"differs from the first design in its motions: {other}")


def _freedom(solution: Elimination, keep: tuple[int, ...]) -> tuple[tuple[int, ...], int]:
    kept = tuple(index for index in solution.independent if index in keep)
    return kept, len(solution.independent) - len(kept)


def _choice(rows: Array, scale: Array, keep: tuple[int, ...]) -> _Choice:
    """Dependent columns of one real design (m, N), and the rows that determine them."""
    first = _comparable(rows, scale)
    dependent = _pivot_columns(first, keep)
    return tuple(dependent), tuple(_pivots(first[:, dependent].T)[: len(dependent)])


def _comparable(rows: Array, scale: Array) -> Array:
    """Constraints (..., m, N) scaled to unit length over comparable coordinates; zero rows are unchanged."""
    scaled = rows * scale
    norms = np.linalg.norm(scaled, axis=-1, keepdims=True)
    return scaled / np.where(norms > 0.0, norms, 1.0)


def _solved(constraints: Array, choice: _Choice) -> Elimination:
    dependent, rows = (list(each) for each in choice)
    independent = _without(constraints.shape[-1], dependent)
    square = constraints[..., rows, :]
    solved = -np.linalg.solve(square[..., dependent], square[..., independent])
    basis = np.zeros((*constraints.shape[:-2], constraints.shape[-1], len(independent)), dtype=constraints.dtype)
    basis[..., dependent, :] = solved
    basis[..., independent, :] = np.eye(len(independent))
    return Elimination(basis, tuple(independent), *choice)


def imposed_motion(solution: Elimination, constraints: Array, imposed: Array) -> Array:
    """Compute z (..., N, m) with A z = `imposed` (rows, m) for constraints A; only dependent coordinates are nonzero.

    >>> rows = np.array([[1.0, 2.0]])
    >>> imposed_motion(eliminate(rows, np.ones(2), keep=(0,)), rows, np.array([[3.0]])).ravel().tolist()
    [0.0, 1.5]
    """
    square = constraints[..., solution.rows, :][..., solution.dependent]
    result = np.zeros((*constraints.shape[:-2], constraints.shape[-1], imposed.shape[-1]), dtype=constraints.dtype)
    target = np.broadcast_to(imposed[list(solution.rows)], (*square.shape[:-2], len(solution.rows), imposed.shape[-1]))
    result[..., solution.dependent, :] = np.linalg.solve(square, target)
    return result


def _pivot_columns(first: Array, keep: tuple[int, ...]) -> list[int]:
    """Dependent columns: as many as possible outside `keep`, the others inside."""
    outside = _without(first.shape[1], keep)
    if not first.size:
        return []
    orthogonal, triangle, order = scipy.linalg.qr(_preference(first[:, outside]), pivoting=True)
    rank = _rank(triangle)
    dependent = [outside[index] for index in order[:rank]]
    left = (orthogonal.T @ first[:, list(keep)])[rank:]
    if left.size:
        dependent += [keep[index] for index in _pivots(left)]
    return dependent


def _pivots(matrix: Array) -> list[int]:
    """Indices of a maximal set of independent columns, best conditioned first."""
    if not matrix.size:
        return []
    _, triangle, order = scipy.linalg.qr(_preference(matrix), pivoting=True)
    return [int(index) for index in order[: _rank(triangle)]]


def _preference(matrix: Array) -> Array:
    return matrix * (1.0 - _PREFERENCE * np.arange(matrix.shape[1]))


def _without(size: int, left_out: Sequence[int]) -> list[int]:
    unwanted = set(left_out)
    return [index for index in range(size) if index not in unwanted]


def _rank(triangle: Array) -> int:
    diagonal = np.abs(np.diag(triangle))
    return int(np.sum(diagonal > _RANK))


def echelon(basis: Array) -> Array:
    """Transform a basis to reduced echelon form: the pivot column of each row has 1 in this row and 0 in all other rows.

    >>> (echelon(np.array([[1.0, 1.0], [1.0, -1.0]])) + 0.0).tolist()
    [[1.0, 0.0], [0.0, 1.0]]
    """
    if not basis.size:
        return basis
    columns = sorted(_pivots(basis))
    return np.linalg.solve(basis[:, columns], basis)


def null_space(matrix: Array) -> Array:
    """Compute an orthonormal basis (columns) of the null space of one real matrix with comparable columns, by pivoted QR of its transpose.

    >>> np.abs(null_space(np.array([[1.0, 0.0]]))).round(12).ravel().tolist()
    [0.0, 1.0]
    """
    if not matrix.size:
        return np.eye(matrix.shape[1])
    orthogonal, triangle, _ = scipy.linalg.qr(_preference(matrix.T), pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    return orthogonal[:, int(np.sum(diagonal > _RANK * diagonal[0])) :]
