"""Labelled matrices: named rows and columns, entries with units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array

NOISE = 1e-9
NOISE_RULE = "0: rounding noise. The entry is below 1e-9 times the geometric mean of the largest entries in its row and column (SI units)."
"""Note for tables: the rule by which rounding noise is shown as 0."""


@dataclass(frozen=True, eq=False)
class Matrix(InNotebook):
    """Matrix (..., rows, columns) with names on both axes; `unit` is one string, or a string for every entry."""

    values: Array
    rows: tuple[str, ...]
    columns: tuple[str, ...]
    unit: str | tuple[tuple[str, ...], ...]

    def at(self, row: str, column: str) -> Any:
        """Return the entry of a row and a column name (an array over the batch axes).

        >>> import numpy as np
        >>> Matrix(np.array([[2.0]]), ("a",), ("b",), "m").at("a", "b").item()
        2.0
        """
        return self.values[..., self.rows.index(row), self.columns.index(column)]

    def part(self, rows: tuple[str, ...], columns: tuple[str, ...]) -> Matrix:
        """Return the sub-matrix of named rows and columns."""
        row_index = [self.rows.index(row) for row in rows]
        column_index = [self.columns.index(column) for column in columns]
        unit = self.unit
        if not isinstance(unit, str):
            unit = tuple(tuple(unit[row][column] for column in column_index) for row in row_index)
        return Matrix(self.values[..., row_index, :][..., column_index], rows, columns, unit)

    def to_json(self) -> dict[str, Any]:
        """Return the matrix as {rows, columns, unit, values}.

        >>> import numpy as np
        >>> Matrix(np.array([[2.0]]), ("a",), ("b",), "m").to_json()
        {'rows': ['a'], 'columns': ['b'], 'unit': 'm', 'values': [[2.0]]}
        """
        unit = self.unit if isinstance(self.unit, str) else [list(row) for row in self.unit]
        return {"rows": list(self.rows), "columns": list(self.columns), "unit": unit, "values": self.values.tolist()}

    def to_pandas(self) -> Any:
        """Return the matrix as a pandas DataFrame (one design)."""
        import pandas

        return pandas.DataFrame(self.values, index=list(self.rows), columns=list(self.columns))

    def to_xarray(self) -> Any:
        """Return the matrix as an xarray DataArray with dimensions `row` and `column` after its batch axes; `unit` is an attribute."""
        import xarray

        batch = tuple(f"batch {number + 1}" for number in range(self.values.ndim - 2))
        coords = {"row": list(self.rows), "column": list(self.columns)}
        return xarray.DataArray(self.values, dims=(*batch, "row", "column"), coords=coords, attrs={"unit": self.unit})

    def __str__(self) -> str:
        """Return a string with names, units and six digits; for a batch, for the first design.

        >>> import numpy as np
        >>> print(Matrix(np.array([[1.0, -0.025]]), ("B1",), ("x", "rx"), (("1", "m/rad"),)))
            x  rx [m/rad]
        B1  1      -0.025
        """
        first = quiet(self.values[(0,) * (self.values.ndim - 2)])
        columns, rows, cells = self.unit_places
        lines = [["", *(_with(name, unit) for name, unit in zip(self.columns, columns, strict=True))]]
        for name, unit, values, own in zip(self.rows, rows, first, cells, strict=True):
            texts = (_with(f"{value:.6g}", each, "{} {}") for value, each in zip(values + 0.0, own, strict=True))
            lines.append([_with(name, unit), *texts])
        widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
        return "\n".join("  ".join([line[0].ljust(widths[0]), *map(str.rjust, line[1:], widths[1:])]) for line in lines)

    @property
    def unit_places(self) -> tuple[list[str], list[str], list[list[str]]]:
        """Units for column heads, row heads and entries. A unit common to a whole column or row is only in the head."""
        columns, rows = [""] * len(self.columns), [""] * len(self.rows)
        cells = [columns] * len(rows)
        if isinstance(self.unit, str):
            columns = [self.unit] * len(columns)
        elif len(set(self.unit)) <= 1:
            columns = list(self.unit[0]) if self.unit else columns
        elif all(len(set(line)) == 1 for line in self.unit):
            rows = [line[0] for line in self.unit]
        else:
            cells = [list(line) for line in self.unit]
        return columns, rows, cells


def _with(text: str, unit: str, form: str = "{} [{}]") -> str:
    return text if unit in ("", "1") else form.format(text, unit)


def quiet(values: Array, against: Array | None = None) -> Array:
    """Return a copy of a matrix (rows, columns) with rounding noise set to 0 (`NOISE_RULE`).

    Entries are compared with the largest entries of their row and column in `against`, a matrix of equal shape (default: the matrix
    itself).

    >>> quiet(np.array([[1.0, 1e-15], [1e-15, 2.0]])).tolist()
    [[1.0, 0.0], [0.0, 2.0]]
    """
    if not np.size(values):
        return np.array(values)
    sizes = np.nan_to_num(np.abs(values if against is None else against), nan=0.0, posinf=0.0)
    scale = np.sqrt(sizes.max(axis=1, keepdims=True) * sizes.max(axis=0, keepdims=True))
    return np.where(np.abs(values) < NOISE * scale, 0.0, values)


def ratio_units(rows: tuple[str, ...], columns: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """Return units of a matrix that maps quantities in the columns' units to quantities in the rows' units.

    >>> ratio_units(("m",), ("m", "rad"))
    (('1', 'm/rad'),)
    """
    return tuple(tuple(_ratio(row, column) for column in columns) for row in rows)


def _ratio(row: str, column: str) -> str:
    if row == column:
        return "1"
    bottom = f"({column})" if " " in column or "/" in column else column
    return row if column == "1" else f"{row}/{bottom}"
