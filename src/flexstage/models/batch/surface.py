"""Polynomial fit of the kernel input over specified ranges: fitted once, checked, then evaluated for any number of designs.

Terms are products of Chebyshev polynomials of the variables on which a number depends. The degree in each variable is determined from
function values along two lines through the ranges. Terms of high total degree are dropped if the error at the validation designs remains
small. The coefficients are fitted by least squares at random points. Numbers that are not smooth functions of the variables are not fitted,
for example if overlaps of outlines change over the ranges.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.family import INERTIA_ENTRIES, Family, numbers_of
from flexstage.models.batch.graph import SHAPES

TOLERANCE = 1e-10
"""Accepted error of a number, relative to its maximum value."""
_TAIL = 1e-12
_NODES = 17
_TERMS = 1500
_REACH = (1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 6.0)
_LINEAR = 0.2
"""Weight of a variable with a linear effect: such a variable (a modulus) multiplies all other terms."""
_TOGETHER = 256
"""Designs per evaluation, constant so that the result of one design does not depend on their number."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Fit of the numbers `rows` by Chebyshev polynomials of `variables` (d,): `degrees` (terms, d) and `coefficients` (terms, rows)."""

    variables: Array
    degrees: Array
    coefficients: Array
    rows: Array

    def basis(self, table: Array) -> Array:
        """Return the terms (terms, designs) of the fit: products of the polynomials in `table` (degree, P, designs)."""
        result = np.ones((len(self.degrees), table.shape[-1]))
        for place, variable in enumerate(self.variables):
            result *= table[self.degrees[:, place], variable]
        return result


@dataclass(frozen=True, eq=False)
class Surface:
    """Polynomial fit of the kernel input of a family for values from `low` to `high` (P,).

    `fixed` (numbers,) is the kernel input of the nominal design, used for numbers without a fit. `error` is the largest error at random
    designs, relative to the scale of each number. Numbers below the diagonals of symmetric matrices are not fitted; the surface returns
    their values in `fixed`.
    """

    low: Array
    high: Array
    fixed: Array
    pieces: tuple[Piece, ...]
    error: float

    def holds(self, values: Array) -> Array:
        """Return whether each design (b, P) is within the ranges."""
        return np.asarray(((values >= self.low) & (values <= self.high)).all(axis=1))

    def numbers(self, values: Array) -> Array:
        """Return the kernel input (numbers, b) of the designs `values` (b, P), as `numbers_of` does."""
        result = np.repeat(self.fixed[:, None], len(values), axis=1)
        middle, half = _ranges(self.low, self.high)
        highest = max((int(piece.degrees.max(initial=0)) for piece in self.pieces), default=0)
        for start in range(0, len(values), _TOGETHER):
            part = values[start : start + _TOGETHER]
            padded = np.concatenate([part, np.broadcast_to(middle, (_TOGETHER - len(part), len(middle)))])
            table = _chebyshev(((padded - middle) / half).T, highest)
            for piece in self.pieces:
                result[piece.rows, start : start + len(part)] = (piece.coefficients.T @ piece.basis(table))[:, : len(part)]
        return result


def _chebyshev(x: Array, highest: int) -> Array:
    """T_k(x) up to the highest degree, along a new first axis."""
    table = np.empty((max(highest, 1) + 1, *x.shape))
    table[0], table[1] = 1.0, x
    for degree in range(2, highest + 1):
        table[degree] = 2.0 * x * table[degree - 1] - table[degree - 2]
    return table


def surface(family: Family, low: Array, high: Array) -> Surface | None:
    """Fit the numbers of a family for values from `low` to `high` (P,); `None` if too many terms are needed.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.family import family
    >>> stage = family(double_triangle(), ("parts.neck.thickness", "materials.steel.young"))
    >>> result = surface(stage, 0.95 * stage.nominal, 1.05 * stage.nominal)
    >>> value, upper = np.array([[1.5e-3, 205e9]]), stage.topology.mirror >= np.arange(len(stage.topology.mirror))
    >>> bool(np.allclose(result.numbers(value)[upper], numbers_of(stage, value)[upper], rtol=1e-10, atol=1e-12))
    True
    """
    fixed = numbers_of(family, family.nominal[None])[:, 0]
    random = np.random.default_rng(0)
    inner, outer = np.cos(np.pi * random.random((3 * _TERMS, len(low)))), random.uniform(-1.0, 1.0, (200, len(low)))
    middle, half = _ranges(low, high)
    fitted, met = (numbers_of(family, middle + half * points) for points in (inner, outer))
    scale, mirror = _scale(family, fitted), family.topology.mirror
    degrees = _degrees(family, (middle, half), scale)
    degrees[:, mirror < np.arange(len(mirror))] = 0
    varies: Array = np.asarray(degrees.any(axis=0))
    still = ~varies & (mirror >= np.arange(len(mirror)))
    worst = float(np.max(np.abs(met - fixed[:, None])[still] / scale[still, None], initial=0.0))
    groups: dict[tuple[int, ...], list[int]] = {}
    for row in np.flatnonzero(varies):
        groups.setdefault(tuple(np.flatnonzero(degrees[:, row]).tolist()), []).append(int(row))
    pieces: list[Piece] = []
    for variables, rows in groups.items():
        highest = degrees[np.array(variables)][:, rows].max(axis=1)
        fit = _fit((np.array(variables), np.array(rows)), highest, (inner, fitted[rows], outer, met[rows]), scale[rows])
        if fit is None:
            return None
        pieces.append(fit[0])
        worst = max(worst, fit[1])
    return Surface(low, high, fixed, tuple(pieces), worst) if worst <= TOLERANCE else None


def _ranges(low: Array, high: Array) -> tuple[Array, Array]:
    """Midpoints and half widths of the ranges; a constant number gets a non-zero half width."""
    half = 0.5 * (high - low)
    return 0.5 * (low + high), np.where(half > 0.0, half, 1.0)


def _scale(family: Family, numbers: Array) -> Array:
    """Error scale of each number: the longest arm, one for axes, and the root of both diagonal entries in matrices."""
    largest, scales, start = np.max(np.abs(numbers), axis=1), [], 0
    begin, end = family.topology.starts["first"], family.topology.starts["inertia"]
    for kind, count in family.topology.counts.items():
        for _ in range(count):
            own = largest[start : start + int(np.prod(SHAPES[kind]))]
            start += len(own)
            if kind in {"first", "second"}:
                scales.append(np.full(3, float(np.max(largest[begin:end]))))
            elif kind == "turn":
                scales.append(np.ones(9))
            else:
                rows, columns = INERTIA_ENTRIES if kind == "inertia" else np.divmod(np.arange(len(own)), SHAPES[kind][0])
                square = dict(zip(zip(rows.tolist(), columns.tolist(), strict=True), own.tolist(), strict=True))
                root = np.sqrt(
                    [square[0, 0] if place < 3 and kind == "inertia" else square[place, place] for place in range(max(rows) + 1)]
                )
                scales.append(np.where(root[rows] * root[columns] > 0.0, root[rows] * root[columns], 1.0))
    return np.concatenate(scales)


def _degrees(family: Family, ranges: tuple[Array, Array], scale: Array) -> Array:
    """Degree (P, numbers) of each number along each variable: where its series reaches rounding, on two lines."""
    middle, half = ranges
    count = len(middle)
    nodes = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    base = np.stack([np.zeros(count), np.random.default_rng(1).uniform(-0.9, 0.9, count)])
    points = np.broadcast_to(base[:, None, None], (2, count, _NODES, count)).copy()
    points[:, np.arange(count), :, np.arange(count)] = nodes
    numbers = numbers_of(family, middle + half * points.reshape(-1, count)).reshape(-1, 2, count, _NODES)
    transform = np.cos(np.arange(_NODES)[:, None] * np.pi * (np.arange(_NODES) + 0.5) / _NODES) * 2.0 / _NODES
    above: Array = np.asarray((np.abs(numbers @ transform.T) > _TAIL * scale[:, None, None, None]).any(axis=1))
    above[..., 0] = True
    return (_NODES - 1 - np.argmax(above[..., ::-1], axis=-1)).T


def _fit(at: tuple[Array, Array], highest: Array, known: tuple[Array, Array, Array, Array], scale: Array) -> tuple[Piece, float] | None:
    """The fit of (variables, rows) with the fewest terms that meets the validation designs, and its error there."""
    variables, rows = at
    inner, fitted, outer, met = known
    for reach in _REACH:
        terms = np.array(list(_terms(highest.tolist(), reach)), dtype=int)
        if len(terms) > _TERMS:
            return None
        count = max(3 * len(terms), 100)
        table, test = (_chebyshev(points.T, int(highest.max())) for points in (inner[:count], outer))
        piece = Piece(variables, terms, np.zeros((len(terms), len(rows))), rows)
        coefficients = np.linalg.lstsq(piece.basis(table).T, (fitted[:, :count] / scale[:, None]).T, rcond=None)[0]
        keep = np.max(np.abs(coefficients), axis=1) > 1e-14
        piece = Piece(variables, terms[keep], coefficients[keep] * scale, rows)
        error = float(np.max(np.abs(piece.coefficients.T @ piece.basis(test) - met) / scale[:, None]))
        if error <= TOLERANCE:
            return piece, error
    return None


def _terms(highest: list[int], reach: float) -> Iterator[tuple[int, ...]]:
    """Degrees (d,) whose sum of degree over maximum degree is within the limit."""
    if not highest:
        yield ()
        return
    cost = _LINEAR if highest[-1] == 1 else 1.0 / highest[-1]
    for degree in range(highest[-1] + 1):
        if degree * cost <= reach + 1e-9:
            yield from ((*others, degree) for others in _terms(highest[:-1], reach - degree * cost))
