"""Features as polynomials of the numbers that vary, over stated ranges: fitted once, checked, then evaluated for any number of designs.

A feature (the law of a part, the arm of a link) depends on a few of the numbers that vary, and smoothly; over the ranges of a study its
Chebyshev series ends at rounding after a few terms. Fitted by least squares at points drawn by the series' own weight, as many terms as it
takes to meet other designs within `TOLERANCE`; where that takes too many, there is no surface and designs are described one by one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexstage.base.number import Array
from flexstage.models.batch.blocks import inertia_matrix
from flexstage.models.batch.parameters.features import INERTIA_ENTRIES, TURNS, Rows, spin
from flexstage.models.batch.parameters.numbers import Change, Family, Slopes, numbers_of, starts

TOLERANCE = 1e-10
"""Largest error of a number of a feature over the largest value it takes."""

_TAIL = 1e-12
_NODES = 17
_TERMS = 1500
_REACH = (1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 6.0)
_LINEAR = 0.2
"""What a number costs that a feature is linear in: a modulus multiplies all other terms, and is worth it."""

_TOGETHER = 256
"""Designs evaluated at once, always as many: so that no bit of one depends on how many there are."""


Places = dict[tuple[int, int], tuple[Array, Array]]
"""By piece and variable: rows of a result, and which of the piece's rows they are."""


@dataclass(frozen=True, eq=False)
class Piece:
    """Numbers (`rows` of all) of the same `variables` (d,): Chebyshev `degrees` (terms, d) and `coefficients` (terms, rows)."""

    variables: Array
    degrees: Array
    coefficients: Array
    rows: Array


@dataclass(frozen=True, eq=False)
class Surface:
    """Every number of the features of a family, for values from `low` to `high` (P,); `fixed` (features,) are those that do not vary.

    The family's derivatives are about the stage's axes: polynomials of features do not tell how bodies turn.
    """

    family: Family
    low: Array
    high: Array
    fixed: Array
    pieces: tuple[Piece, ...]
    error: float

    def holds(self, values: Array) -> Array:
        """Which designs (b, P) lie within the ranges."""
        return np.asarray(((values >= self.low) & (values <= self.high)).all(axis=1))

    def numbers(self, values: Array) -> Rows:
        """The features' numbers (features, b), as `numbers_of` gives them."""
        result = Rows(len(self.fixed), len(values))
        result[:] = self.fixed[:, None]
        for start, table, _ in self._tables(values):
            stop = min(start + _TOGETHER, len(values))
            for piece in self.pieces:
                found = (piece.coefficients.T @ _basis(piece, table))[:, : stop - start]
                result[piece.rows, start:stop] = found
        result[self._mirror_places[0]] = result[self._mirror_places[1]]
        return result

    def slopes(self, values: Array) -> Slopes:
        """Their derivatives, as `slopes_of` gives them."""
        changes = self.family.changes
        result, turned = Rows(sum(len(change.rows) for change in changes), len(values)), Rows(9 * len(self._turns), len(values))
        result.held[:], turned.held[:] = 0.0, 0.0
        for start, table, steep in self._tables(values):
            stop = min(start + _TOGETHER, len(values))
            for number, piece in enumerate(self.pieces):
                for place, variable in enumerate(piece.variables):
                    basis = _basis(piece, table, (place, steep))
                    for rows, places in ((result, self._places), (turned, self._turned_places)):
                        to, of = places[number, int(variable)]
                        rows[to, start:stop] = (piece.coefficients[:, of].T @ basis)[:, : stop - start]
        if self._turns:
            self._add_turns(result, turned, self.numbers(values))
        return Slopes(changes, result, np.zeros(len(values), dtype=bool))

    def _add_turns(self, result: Rows, turned: Rows, numbers: Rows) -> None:
        """Write how links' axes turn, of the derivatives of their nine numbers each."""
        for place, (start, change, axes) in enumerate(self._turns):
            rates, own = (rows.T.reshape(-1, 3, 3) for rows in (turned[9 * place : 9 * place + 9], numbers[axes]))
            result[start : start + len(change.rows)] = spin(rates, own).T[change.rows]

    @cached_property
    def _turns(self) -> list[tuple[int, Change, slice]]:
        """Changes of links' axes as bodies see them, with the rows they begin at and where the axes' numbers stand."""
        axes = {place.owner: place.slots for place in self.family.topology.features if place.kind == "turn"}
        return [(start, change, axes[change.place.owner]) for start, change in starts(self.family.changes) if change.place.kind in TURNS]

    def _tables(self, values: Array) -> Iterator[tuple[int, Array, Array]]:
        """Chebyshev polynomials (degree, P, designs) and their derivatives by the values, portion by portion."""
        middle, half = _ranges(self.low, self.high)
        highest = max((int(piece.degrees.max(initial=0)) for piece in self.pieces), default=0)
        for start in range(0, len(values), _TOGETHER):
            part = values[start : start + _TOGETHER]
            part = np.concatenate([part, np.broadcast_to(middle, (_TOGETHER - len(part), len(middle)))])
            table, steep = _chebyshev(((part - middle) / half).T, max(highest, 1))
            yield start, table, steep / half[:, None]

    @cached_property
    def _mirror_places(self) -> tuple[Array, Array]:
        """Lower halves of symmetric features, and where their upper halves stand."""
        mirror = self.family.topology.mirror
        known = np.concatenate([piece.rows for piece in self.pieces]) if self.pieces else np.zeros(0, dtype=int)
        upper = known[mirror[known] > known]
        return mirror[upper], upper

    @cached_property
    def _places(self) -> Places:
        """By piece and variable: rows of all changes, and which of the piece's rows they are."""
        plain = [(start, change) for start, change in starts(self.family.changes) if change.place.kind not in TURNS]
        return self._found((start, change.variable, change.place.start + change.rows) for start, change in plain)

    @cached_property
    def _turned_places(self) -> Places:
        """The same of axes: nine numbers for each of the changes of how they turn."""
        return self._found(
            (9 * place, change.variable, np.arange(axes.start, axes.stop)) for place, (_, change, axes) in enumerate(self._turns)
        )

    def _found(self, wanted: Iterable[tuple[int, int, Array]]) -> Places:
        """Where numbers stand among the pieces, of (row to begin at, variable, numbers)."""
        where = {int(row): (number, at) for number, piece in enumerate(self.pieces) for at, row in enumerate(piece.rows)}
        found: dict[tuple[int, int], list[tuple[int, int]]] = {
            (number, int(variable)): [] for number, piece in enumerate(self.pieces) for variable in piece.variables
        }
        for start, variable, rows in wanted:
            for offset, row in enumerate(rows):
                number, at = where.get(int(row), (-1, -1))
                if (number, variable) in found:
                    found[number, variable].append((start + offset, at))
        return {
            key: (np.array([one for one, _ in pairs], dtype=int), np.array([at for _, at in pairs], dtype=int))
            for key, pairs in found.items()
        }


def _chebyshev(x: Array, highest: int) -> tuple[Array, Array]:
    """T_k(x) and T_k'(x) up to the highest degree, along a new first axis."""
    table, steep = np.empty((highest + 1, *x.shape)), np.empty((highest + 1, *x.shape))
    table[0], table[1], steep[0], steep[1] = 1.0, x, 0.0, 1.0
    for degree in range(2, highest + 1):
        table[degree] = 2.0 * x * table[degree - 1] - table[degree - 2]
        steep[degree] = 2.0 * table[degree - 1] + 2.0 * x * steep[degree - 1] - steep[degree - 2]
    return table, steep


def _basis(piece: Piece, table: Array, steep: tuple[int, Array] | None = None) -> Array:
    """Products (terms, designs) of the piece's polynomials; one of them by its derivative if given (place, table)."""
    result = np.ones((len(piece.degrees), table.shape[-1]))
    for place, variable in enumerate(piece.variables):
        taken = table if steep is None or place != steep[0] else steep[1]
        result *= taken[piece.degrees[:, place], variable]
    return result


def surface(family: Family, low: Array, high: Array) -> Surface | None:
    """Fit the features of a family for values from `low` to `high` (P,); `None` where too many terms would be needed.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.batch.parameters.numbers import family, slopes_of
    >>> stage = family(double_triangle(), ("parts.neck.thickness", "materials.steel.young"))
    >>> found = surface(stage, 0.95 * stage.nominal, 1.05 * stage.nominal)
    >>> value = np.array([[1.5e-3, 205e9]])
    >>> bool(np.allclose(found.numbers(value), numbers_of(stage, value), rtol=1e-10, atol=1e-12))
    True
    >>> bool(np.allclose(found.slopes(value).values, slopes_of(stage, value).values, rtol=1e-7, atol=1e-12))
    True
    """
    family = replace(family, standpoint=replace(family.standpoint, turning=False))
    fixed = numbers_of(family, family.nominal[None])[:, 0]
    random = np.random.default_rng(0)
    inner, outer = np.cos(np.pi * random.random((3 * _TERMS, len(low)))), random.uniform(-1.0, 1.0, (200, len(low)))
    middle, half = _ranges(low, high)
    fitted, met = (numbers_of(family, middle + half * points) for points in (inner, outer))
    scale = _scale(family, fitted)
    degrees = _degrees(family, (middle, half), scale)
    lower = family.topology.mirror < np.arange(family.topology.count)
    degrees[:, lower] = 0
    varies: Array = np.asarray(degrees.any(axis=0))
    still = ~varies
    still[lower] = False
    groups: dict[tuple[int, ...], list[int]] = {}
    for row in np.flatnonzero(varies):
        groups.setdefault(tuple(np.flatnonzero(degrees[:, row]).tolist()), []).append(int(row))
    pieces: list[Piece] = []
    worst = float(np.max(np.abs(met - fixed[:, None])[still] / scale[still, None], initial=0.0))
    for variables, rows in groups.items():
        at = (np.array(variables), np.array(rows))
        highest = degrees[at[0]][:, rows].max(axis=1)
        found = _fit(at, highest, (inner, fitted[at[1]], outer, met[at[1]]), scale[at[1]])
        if found is None:
            return None
        pieces.append(found[0])
        worst = max(worst, found[1])
    return Surface(family, low, high, fixed, tuple(pieces), worst) if worst <= TOLERANCE else None


def _ranges(low: Array, high: Array) -> tuple[Array, Array]:
    """Middles and halves of the ranges; a number that does not vary has a half that is not zero all the same."""
    half = 0.5 * (high - low)
    return 0.5 * (low + high), np.where(half > 0.0, half, 1.0)


def _scale(family: Family, numbers: Array) -> Array:
    """What the error of each number is compared with: the longest arm, one for axes, and the root of both diagonal entries in matrices."""
    result = np.ones(len(numbers))
    largest = np.max(np.abs(numbers), axis=1)
    places = family.topology.features
    longest = max(float(np.max(largest[place.slots])) for place in places if place.kind in {"first", "second"})
    for place in places:
        if place.kind in {"first", "second"}:
            result[place.slots] = longest
        elif place.kind != "turn":
            own = largest[place.slots]
            root = np.sqrt(np.diag(inertia_matrix(own) if place.kind == "inertia" else own.reshape(place.shape)))
            both = root[:, None] * root
            both = both[INERTIA_ENTRIES] if place.kind == "inertia" else both.ravel()
            result[place.slots] = np.where(both > 0.0, both, 1.0)
    return result


def _degrees(family: Family, ranges: tuple[Array, Array], scale: Array) -> Array:
    """Degree (P, features) that each number needs along each variable: where its series is at rounding, on two lines."""
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
    """The piece of (variables, rows) with the fewest terms that meets the other designs, and its error there."""
    variables, rows = at
    inner, fitted, outer, met = known
    for reach in _REACH:
        terms = _terms(highest, reach)
        if terms is None:
            return None
        count = max(3 * len(terms), 100)
        table, test = (_chebyshev(points.T, max(int(highest.max()), 1))[0] for points in (inner[:count], outer))
        piece = Piece(variables, terms, np.zeros((len(terms), len(rows))), rows)
        coefficients = np.linalg.lstsq(_basis(piece, table).T, (fitted[:, :count] / scale[:, None]).T, rcond=None)[0]
        keep = np.max(np.abs(coefficients), axis=1) > 1e-14
        piece = Piece(variables, terms[keep], coefficients[keep] * scale, rows)
        error = float(np.max(np.abs(piece.coefficients.T @ _basis(piece, test) - met) / scale[:, None]))
        if error <= TOLERANCE:
            return piece, error
    return None


def _terms(highest: Array, reach: float) -> Array | None:
    """Degrees (terms, d) with the sum of degree over highest within the reach; `None` if they are too many."""
    found: list[tuple[tuple[int, ...], float]] = [((), 0.0)]
    for top in highest:
        steps = [(degree, degree * (_LINEAR if top == 1 else 1.0 / top)) for degree in range(int(top) + 1)]
        found = [((*done, degree), used + cost) for done, used in found for degree, cost in steps if used + cost <= reach + 1e-9]
        if len(found) > _TERMS:
            return None
    return np.array([degrees for degrees, _ in found], dtype=int)
