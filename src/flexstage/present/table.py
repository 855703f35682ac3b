"""Tables: results laid out for people, independent of where they are shown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import TypeAlias

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.present.display import NO_VALUE, NOISE_RULE, Shown, aligned, number, preferred, quiet, shown


class Mark(Enum):
    """What a cell means besides its text; a renderer shows it by colour, weight or a sign."""

    PLAIN = "plain"
    STRONG = "strong"
    FAINT = "faint"
    PASS = "pass"
    FAIL = "fail"
    WARN = "warn"
    STATED = "stated"
    DERIVED = "derived"
    ASSUMED = "assumed"


@dataclass(frozen=True)
class Cell:
    """A table's cell: its text, its mark, and optionally the length of a bar behind it (a share between 0 and 1)."""

    text: str
    mark: Mark = Mark.PLAIN
    bar: float | None = None


@dataclass(frozen=True)
class Column:
    """A table's column: head and unit; `numeric` columns are set flush right."""

    head: str
    unit: str = ""
    numeric: bool = True


Content: TypeAlias = str | Cell


@dataclass(frozen=True)
class Table:
    """A table for people: title, columns, rows, notes under it and where its numbers come from."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()
    provenance: str = ""

    def texts(self) -> list[list[str]]:
        """Heads (with units) and cells as plain text, row by row."""
        heads = [f"{column.head} [{column.unit}]" if column.unit else column.head for column in self.columns]
        return [heads, *([cell.text for cell in row] for row in self.rows)]

    def _repr_html_(self) -> str:
        from flexstage.present.render import to_html

        return to_html(self)


def build(
    title: str,
    columns: Iterable[Column | str],
    rows: Iterable[Sequence[Content]],
    *,
    notes: Iterable[str] = (),
    provenance: str = "",
) -> Table:
    """A table from columns (a text alone is the head of a column of words) and rows of cells (a text alone is a plain cell).

    >>> build("Masses", ["body", Column("mass", "kg")], [("platform", "14")]).texts()
    [['body', 'mass [kg]'], ['platform', '14']]
    """
    heads = tuple(column if isinstance(column, Column) else Column(column, numeric=False) for column in columns)
    cells = tuple(tuple(cell if isinstance(cell, Cell) else Cell(cell) for cell in row) for row in rows)
    return Table(title, heads, cells, tuple(notes), provenance)


def figures(values: Iterable[float], form: Shown, digits: int = 5) -> list[Cell]:
    """A column of SI values in a display unit, decimals aligned; rounding noise against the column's largest value is shown as 0.

    >>> [cell.text for cell in figures([15e6, 1e-6], Shown("N/um", 1e-6))]
    ['15', '0']
    """
    items = np.array([float(value) for value in values])
    largest = np.max(np.abs(items[np.isfinite(items)]), initial=0.0)
    silent = np.isfinite(items) & (np.abs(items) < 1e-9 * largest)
    texts = aligned(np.where(silent, 0.0, items * form.factor), digits)
    return [Cell(text, _faint(text)) for text in texts]


def matrix_table(title: str, matrix: Matrix, *, corner: str = "", digits: int = 5, notes: Iterable[str] = ()) -> Table:
    """A labelled matrix (first design of a batch) in display units.

    Where the entries' units differ, one unit a column is used if that is possible, else each entry carries its own.

    >>> table = matrix_table("K", Matrix(np.array([[2e6]]), ("fx",), ("x",), "N/m"))
    >>> table.texts()
    [['', 'x [N/um]'], ['fx', '2']]
    """
    values = first_design(matrix.values, 2)
    kept = quiet(values)
    units = _entry_units(matrix)
    said = [NOISE_RULE] if np.any(kept != np.where(np.isnan(values), kept, values)) else []
    by_column = [{row[index] for row in units} for index in range(len(matrix.columns))]
    if all(len(column) == 1 for column in by_column):
        forms = [[_form(column.pop(), kept[:, index])] * len(units) for index, column in enumerate(by_column)]
        heads = [Column(name, _unit(forms[index][0])) for index, name in enumerate(matrix.columns)]
        cells = [[_entry(value * forms[index][0].factor, digits) for index, value in enumerate(row)] for row in kept]
    else:
        heads = [Column(name) for name in matrix.columns]
        cells = [
            [_with_unit(value, unit, digits) for value, unit in zip(row, line, strict=True)] for row, line in zip(kept, units, strict=True)
        ]
    rows = [[Cell(name, Mark.STRONG), *line] for name, line in zip(matrix.rows, cells, strict=True)]
    return build(title, [Column(corner, numeric=False), *heads], rows, notes=[*notes, *said, *batch_note(matrix.values, 2)])


def _entry_units(matrix: Matrix) -> tuple[tuple[str, ...], ...]:
    if isinstance(matrix.unit, str):
        return ((matrix.unit,) * len(matrix.columns),) * len(matrix.rows)
    return matrix.unit


def _form(unit: str, column: Array) -> Shown:
    return shown(unit, float(np.max(np.abs(column[np.isfinite(column)]), initial=0.0)))


def _unit(form: Shown) -> str:
    return "" if form.unit == "1" else form.unit


def _entry(value: float, digits: int) -> Cell:
    text = number(float(value), digits)
    return Cell(text, _faint(text))


def _with_unit(value: float, unit: str, digits: int) -> Cell:
    form = preferred(unit)
    text = number(float(value) * form.factor, digits)
    return Cell(text if text in ("0", NO_VALUE) or form.unit == "1" else f"{text} {form.unit}", _faint(text))


def _faint(text: str) -> Mark:
    return Mark.FAINT if text in ("0", NO_VALUE) else Mark.PLAIN


def first_design(values: Array, axes: int) -> Array:
    """The first design of a batch: the last `axes` axes of real values.

    >>> first_design(np.ones((4, 2, 2)), 2).shape
    (2, 2)
    """
    values = np.asarray(values)
    return np.real(values.reshape(-1, *values.shape[values.ndim - axes :])[0])


def batch_note(values: Array, axes: int) -> tuple[str, ...]:
    """What is said under a table of a batch's first design; nothing for a single one.

    >>> batch_note(np.ones((4, 2, 2)), 2)
    ('The first of 4 designs.',)
    """
    count = int(np.prod(values.shape[: values.ndim - axes]))
    return (f"The first of {count} designs.",) if values.ndim > axes else ()
