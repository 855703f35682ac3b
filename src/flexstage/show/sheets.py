"""Results for other programs, part by part: CSV, pandas, xarray. Full precision, SI units; parts are those of `base.sheet`."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from flexstage.base.arguments import check_arguments
from flexstage.base.labelled import Matrix
from flexstage.base.storage.sheet import Sheet, parts, plain_cell
from flexstage.show.table import first_design

_FORMULA = ("=", "+", "-", "@")


@check_arguments
def to_csv(result: Any) -> dict[str, str]:
    r"""Every part of a result as CSV (RFC 4180), by its path: names first, numbers as they are, SI units in the heads.

    Texts that a spreadsheet would run as formulas (`=`, `+`, `-`, `@` first) begin with an apostrophe.
    A number that is not known is an empty cell. Where the columns of a matrix have no unit in common, each row has its unit beside it;
    where rows have none either, each entry is a row.

    >>> to_csv({"gain": 2.0, "loss": {"B1": 0.1}})
    {'': 'gain\r\n2.0\r\n', 'loss': 'name,loss\r\nB1,0.1\r\n'}
    """
    return {path: _text(_matrix_lines(part) if isinstance(part, Matrix) else _lines(part.heads)) for path, part in parts(result)}


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


def _lines(heads: Mapping[str, tuple[Any, ...]]) -> Iterator[Sequence[Any]]:
    yield tuple(heads)
    yield from zip(*heads.values(), strict=True)


def _matrix_lines(matrix: Matrix) -> Iterator[Sequence[Any]]:
    columns, rows, cells = matrix.unit_places
    values = first_design(matrix.values, 2).tolist()
    if any(map(any, cells)):
        yield "row", "column", "unit", "value"
        for name, line, units in zip(matrix.rows, values, cells, strict=True):
            yield from ((name, *entry) for entry in zip(matrix.columns, units, line, strict=True))
        return
    heads = [name if unit in ("", "1") else f"{name} [{unit}]" for name, unit in zip(matrix.columns, columns, strict=True)]
    yield ["row", *(["unit"] if any(rows) else []), *heads]
    for name, unit, line in zip(matrix.rows, rows, values, strict=True):
        yield [name, *([unit] if any(rows) else []), *line]


@check_arguments
def to_pandas(result: Any) -> dict[str, Any]:
    """Every part of a result as a pandas frame, by its path; the names of rows are the index (extra `tables`).

    Units stand in the names of columns, and those of matrices in `attrs["unit"]`.
    """
    return {path: part.to_pandas() if isinstance(part, Matrix) else _frame(part) for path, part in parts(result)}


def _frame(sheet: Sheet) -> Any:
    import pandas

    frame = pandas.DataFrame(sheet.heads)
    return frame.set_index(list(sheet.heads)[: len(sheet.names)]) if sheet.names else frame


@check_arguments
def to_xarray(result: Any) -> dict[str, Any]:
    """Every part of a result as an xarray dataset, a matrix as an array, by its path; names of rows are dimensions (extra `tables`)."""
    return {path: part.to_xarray() if isinstance(part, Matrix) else _frame(part).to_xarray() for path, part in parts(result)}
