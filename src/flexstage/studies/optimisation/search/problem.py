"""Problem of a search: objective and limits as normalised inequalities of measures, and their linearisation about a design."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.analysis.assessment.measures import Extreme
from flexstage.analysis.assessment.requirements import Sense
from flexstage.base.number import Array
from flexstage.studies.optimisation.values import NumberedFrequency, Point, Scalars

SPARE = 1e-8
"""Safety margin of a limit, relative to its scale: rounding errors then do not violate the limit."""


@dataclass(frozen=True)
class Side:
    """One-sided bound of the measure with number `index`. A design meets the bound if the constraint value c is 0 or less.

    For `at least`, c = (limit - value) / scale; for `at most`, c = (value - limit) / scale.
    """

    index: int
    sense: Sense
    limit: float
    scale: float

    def of(self, value: float) -> float:
        """Compute the constraint value c for a value of the measure.

        >>> Side(0, Sense.AT_LEAST, 100.0, 100.0).of(90.0)
        0.1
        """
        spare = (value - self.limit) / self.scale
        return -spare if self.sense is Sense.AT_LEAST else spare

    def at(self, point: Point) -> float:
        """Compute the constraint value c of a design."""
        return self.of(point.found[self.index].value)


@dataclass(frozen=True)
class Problem:
    """Minimise the largest constraint value c (see `Side`) of the sides in `objective`, with c <= 0 for all sides in `limits`."""

    objective: tuple[Side, ...]
    limits: tuple[Side, ...]

    def worth(self, point: Point) -> float:
        """Return the largest constraint value c of the objective's sides."""
        return max(side.at(point) for side in self.objective)

    def excess(self, point: Point) -> float:
        """Return the largest constraint value c of the limits. A positive value is a violation; without limits the value is 0."""
        return max((side.at(point) for side in self.limits), default=0.0)

    def violation(self, point: Point) -> float:
        """Return the largest violation, which is 0 for a feasible design."""
        return max(0.0, self.excess(point))


@dataclass(frozen=True, eq=False)
class Linear:
    """Linear model of a `Side`: for a change d of the n variables, the constraint value c is the largest eigenvalue of a matrix of k modes.

    This matrix is `constant` (k, k) plus the sum of d_p times the matrix p of `slope` (n, k, k) over all variables p. For m scalar values,
    the matrices are diagonal, and only their diagonals (m,) and (n, m) are stored.
    """

    constant: Array
    slope: Array

    @property
    def diagonal(self) -> bool:
        """Whether the side consists of scalars instead of matrices."""
        return self.constant.ndim == 1

    def project(self, vector: Array) -> tuple[float, Array]:
        """Return constant and gradient (n,) of v^T C v with a `vector` v and the model's matrix C. For a unit vector, v^T C v <= c."""
        return float(vector @ self.constant @ vector), np.einsum("i,pij,j->p", vector, self.slope, vector)

    def after(self, change: Array) -> tuple[Array, Array]:
        """Return eigenvalues, in ascending sequence, and eigenvectors of the matrix after a change (n,)."""
        return np.linalg.eigh(self.constant + np.tensordot(change, self.slope, axes=1))


def linear(side: Side, point: Point) -> Linear:
    """Linearise a side around a design.

    A lower bound of a minimum, or an upper bound of a maximum, applies to all pieces (values) of the measure. A lower bound of a maximum,
    or an upper bound of a minimum, applies only to the active piece. A lower bound of a frequency applies to all modes from the requested
    number upward, an upper bound to all modes up to this number.

    >>> at = Point(np.zeros(1), (Scalars(np.array([3.0, 2.0]), np.ones((2, 1)), Extreme.LEAST),))
    >>> linear(Side(0, Sense.AT_LEAST, 1.0, 1.0), at).constant.tolist()
    [-2.0, -1.0]
    """
    found, sign = point.found[side.index], -1.0 if side.sense is Sense.AT_LEAST else 1.0
    if isinstance(found, Scalars):
        values, gradient = _pieces(found, side.sense)
        return Linear(sign * (values - side.limit) / side.scale, sign * gradient.T / side.scale)
    chosen = members(side, found)
    constant = np.diag(found.spectrum.frequencies[chosen] - side.limit)
    return Linear(sign * constant / side.scale, sign * found.spectrum.slopes[:, chosen, chosen] / side.scale)


def second_order_correction(side: Side, point: Point, tried: Point) -> Linear:
    """Linearise a side around a design; the constant is corrected so that the model has the exact value at another design, `tried`.

    >>> first, second = (Point(np.array([x]), (Scalars(np.array([x * x]), np.array([[2.0 * x]]), Extreme.LEAST),)) for x in (1.0, 2.0))
    >>> second_order_correction(Side(0, Sense.AT_MOST, 0.0, 1.0), first, second).constant.tolist()  # 4 - 2 (2 - 1)
    [2.0]
    """
    here, there = linear(side, point), linear(side, tried)
    if here.constant.shape != there.constant.shape:
        return here
    turned = there.constant if here.diagonal else _change_basis(side, there.constant, tried, point)
    return Linear(turned - np.tensordot(tried.shares - point.shares, here.slope, axes=1), here.slope)


def members(side: Side, found: NumberedFrequency) -> slice:
    """Return the modes of the spectrum to which a side applies.

    >>> from flexstage.studies.optimisation.search.spectrum import Spectrum
    >>> one = NumberedFrequency(Spectrum(np.ones(3), np.zeros((0, 3, 3)), np.eye(3), np.eye(3)), 2)
    >>> members(Side(0, Sense.AT_LEAST, 1.0, 1.0), one), members(Side(0, Sense.AT_MOST, 1.0, 1.0), one)
    (slice(1, None, None), slice(0, 2, None))
    """
    return slice(found.count - 1, None) if side.sense is Sense.AT_LEAST else slice(0, found.count)


def _pieces(found: Scalars, sense: Sense) -> tuple[Array, Array]:
    if (found.extreme is Extreme.LEAST) == (sense is Sense.AT_LEAST) or len(found.values) == 1:
        return found.values, found.gradient
    own = int(np.argmin(found.values) if found.extreme is Extreme.LEAST else np.argmax(found.values))
    return found.values[own : own + 1], found.gradient[own : own + 1]


@dataclass(frozen=True, eq=False)
class Weights:
    """Multipliers of one side: one for each piece (m,), or a positive semidefinite matrix (k, k) for its modes."""

    values: Array

    @property
    def total(self) -> float:
        """Sum of the multipliers."""
        return float(np.trace(self.values) if self.values.ndim == 2 else np.sum(self.values))

    def gradient(self, at: Linear) -> Array:
        """Compute the contribution of the side to the gradient (n,) of the Lagrangian."""
        if self.values.ndim == 1:
            return at.slope @ self.values
        return np.einsum("pij,ij->p", at.slope, self.values)


def sides(problem: Problem) -> Iterator[Side]:
    """Iterate over all sides: first the sides of the objective, then the sides of the limits.

    >>> len(list(sides(Problem((Side(0, Sense.AT_MOST, 0.0, 1.0),), ()))))
    1
    """
    yield from problem.objective
    yield from problem.limits


def lagrangian(problem: Problem, point: Point, weights: tuple[Weights, ...], seen_from: Point | None = None) -> Array | None:
    """Compute the gradient (n,) of the Lagrangian at a design `point`.

    The multipliers `weights` were computed for the modes and pieces of the design `seen_from`, by default `point`. Returns `None` if the
    pieces of `point` and `seen_from` do not correspond.

    >>> at = Point(np.zeros(1), (Scalars(np.array([3.0]), np.array([[2.0]]), Extreme.LEAST),))
    >>> lagrangian(Problem((Side(0, Sense.AT_MOST, 0.0, 1.0),), ()), at, (Weights(np.ones(1)),)).tolist()
    [2.0]
    """
    total = np.zeros(len(point.shares))
    for side, weight in zip(sides(problem), weights, strict=True):
        at, own = linear(side, point), weight
        if own.values.shape[0] != at.constant.shape[0]:
            return None
        if seen_from is not None and not at.diagonal:
            own = Weights(_change_basis(side, own.values, seen_from, point))
        total = total + own.gradient(at)
    return total


def _change_basis(side: Side, values: Array, before: Point, now: Point) -> Array:
    """A matrix transformed from the modes of one design to those of another."""
    first, second = before.found[side.index], now.found[side.index]
    assert isinstance(first, NumberedFrequency)  # noqa: S101  a side with a matrix is of frequencies
    assert isinstance(second, NumberedFrequency)  # noqa: S101
    chosen = members(side, first)
    left, _, right = np.linalg.svd(first.spectrum.weighted[:, chosen].T @ second.spectrum.shapes[:, chosen])
    turn = left @ right
    return turn.T @ values @ turn
