"""Results as CSV, pandas or xarray, in full precision and SI units. `base.storage.sheet` defines the parts of a result."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from flexstage.base.arguments import check_arguments
from flexstage.base.labelled import Matrix
from flexstage.base.storage.sheet import Sheet, parts, plain_cell
from flexstage.show.table import first_design

_FORMULA = ("=", "+", "-", "@")


@check_arguments
def to_csv(result: Any) -> dict[str, str]:
    r"""Return the parts of a result as CSV texts (RFC 4180). The keys are the paths of the parts in the JSON document.

    The first columns contain the names of the rows; column heads contain SI units. Numbers are not rounded; an unknown number is an empty
    cell. Texts that a spreadsheet would execute as formulas (they start with `=`, `+`, `-` or `@`) begin with an apostrophe. If only the
    entries in each row of a matrix have a common unit, a column `unit` contains the units of the rows. If neither the columns nor the rows
    have common units, each entry of the matrix becomes a row with its unit.

    >>> to_csv({"gain": 2.0, "loss": {"B1": 0.1}})
    {'': 'gain\r\n2.0\r\n', 'loss': 'name,loss\r\nB1,0.1\r\n'}
    """
    return {path: _text(_lines(part)) for path, part in parts(result)}


def _lines(part: Sheet | Matrix) -> Iterator[Sequence[Any]]:
    grid = grid_of(part)
    units = grid.units if isinstance(part, Matrix) else ("",) * len(grid.heads)  # heads of sheets are keys that end in units
    yield [f"{head} [{unit}]" if unit else head for head, unit in zip(grid.heads, units, strict=True)]
    yield from grid.rows


@dataclass(frozen=True)
class Grid:
    """A part of a result as a spreadsheet: column heads, SI units, and rows. The first `named` cells of a row are names."""

    heads: tuple[str, ...]
    units: tuple[str, ...]
    rows: tuple[Sequence[Any], ...]
    named: int


def grid_of(part: Sheet | Matrix) -> Grid:
    """Convert a part of a result to a grid.

    If every column of a matrix has one unit, the grid's `units` are these units; if every row has one unit, a column of units is added.
    Otherwise, each entry becomes a row with its unit.

    >>> import numpy as np
    >>> grid_of(Matrix(np.array([[2.0, 3.0]]), ("x",), ("a", "b"), (("m", "N"),)))
    Grid(heads=('row', 'a', 'b'), units=('', 'm', 'N'), rows=(['x', 2.0, 3.0],), named=1)
    """
    if isinstance(part, Sheet):
        units = ("" if field.unit == "1" else field.unit for field in part.columns)
        named = len(part.names)
        return Grid(tuple(part.heads), (*("",) * named, *units), tuple(zip(*part.heads.values(), strict=True)), named)
    columns, rows, cells = part.unit_places
    values = first_design(part.values, 2).tolist()
    if any(map(any, cells)):
        lines = zip(part.rows, values, cells, strict=True)
        entries = [(name, *entry) for name, line, own in lines for entry in zip(part.columns, own, line, strict=True)]
        return Grid(("row", "column", "unit", "value"), ("",) * 4, tuple(entries), 2)
    beside = any(rows)
    lines = ([name, *([unit] if beside else []), *line] for name, unit, line in zip(part.rows, rows, values, strict=True))
    names = ("row", "unit")[: 1 + beside]
    return Grid(
        (*names, *part.columns), (*("",) * len(names), *("" if unit == "1" else unit for unit in columns)), tuple(lines), len(names)
    )


def _text(lines: Iterable[Sequence[Any]]) -> str:
    found = io.StringIO(newline="")
    csv.writer(found).writerows([_cell(each) for each in line] for line in lines)
    return found.getvalue()


def _cell(value: Any) -> Any:
    value = plain_cell(value)
    if isinstance(value, float):
        return "" if math.isnan(value) else value + 0.0  # no -0.0
    if isinstance(value, str) and value.lstrip().startswith(_FORMULA):
        return f"'{value}"
    return str(value).lower() if isinstance(value, bool) else value


@check_arguments
def to_pandas(result: Any) -> dict[str, Any]:
    """Return the parts of a result as pandas data frames. The keys are the paths of the parts in the JSON document.

    Row names are the index. Column names contain the units; the data frame of a matrix has no units. Needs the extra `tables`.
    """
    return {path: part.to_pandas() if isinstance(part, Matrix) else _frame(part) for path, part in parts(result)}


def _frame(sheet: Sheet) -> Any:
    import pandas

    frame = pandas.DataFrame(sheet.heads)
    return frame.set_index(list(sheet.heads)[: len(sheet.names)]) if sheet.names else frame


@check_arguments
def to_xarray(result: Any) -> dict[str, Any]:
    """Return the parts of a result as xarray objects. The keys are the paths of the parts in the JSON document.

    A matrix becomes a data array; any other part becomes a dataset. The names of the rows are the coordinates of a dimension. Needs the
    extra `tables`.
    """
    return {path: part.to_xarray() if isinstance(part, Matrix) else _frame(part).to_xarray() for path, part in parts(result)}
