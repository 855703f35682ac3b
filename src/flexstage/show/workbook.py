"""Results as an Excel workbook (XLSX) in SI units: a sheet for each part (see `base.storage.sheet`), and a sheet for the source."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from itertools import chain, count
from typing import Any

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.storage.sheet import parts, plain_cell
from flexstage.base.text import printable
from flexstage.base.version import __version__
from flexstage.show.sheets import Grid, grid_of

PROVENANCE = "provenance"
_LONGEST_NAME = 31
_FORBIDDEN = re.compile(r"[\[\]:*?/\\]")
_MOST_ROWS, _MOST_COLUMNS, _LONGEST_TEXT = 1_048_576, 16_384, 32_767
_LARGEST = 9.99999999999999e307  # of a cell; the largest float rounded to 16 digits is infinite
_WIDEST = 40
_WRITTEN = datetime(1980, 1, 1)  # noqa: DTZ001 (a workbook's dates have no zone; equal results are equal files)


@check_arguments
def to_xlsx(result: Any, about: Mapping[str, Any] | None = None) -> bytes:
    """Convert a result to the bytes of an XLSX file, with a sheet for each part: column heads, SI units, then rows of numbers.

    Numbers have 16 digits. Unknown values are empty cells; infinity and numbers too large for a cell (1e308) are texts. The last sheet
    lists the source: the version of flexstage and the entries of `about`. Equal results give identical files. Raises `DesignError` for
    tables longer or wider than a sheet.

    >>> to_xlsx({"gain": 2.0, "loss": {"B1": 0.1}})[:2]
    b'PK'
    """
    import xlsxwriter

    content = io.BytesIO()
    grids = {path: grid_of(part) for path, part in parts(result)}
    names = sheet_names([*grids, PROVENANCE])
    with xlsxwriter.Workbook(content, {"in_memory": True, "nan_inf_to_errors": False}) as book:
        book.set_properties({"created": _WRITTEN, "comments": f"flexstage {__version__}"})
        head, unit = book.add_format({"bold": True, "bottom": 1}), book.add_format({"italic": True, "font_color": "#667382"})
        for name, grid in zip(names, (*grids.values(), _about(result, about or {})), strict=True):
            _write(book.add_worksheet(name), grid, head, unit)
    return content.getvalue()


def _write(sheet: Any, grid: Grid, head: Any, unit: Any) -> None:
    if len(grid.rows) + 2 > _MOST_ROWS or len(grid.heads) > _MOST_COLUMNS:
        size = f"{len(grid.rows)} rows and {len(grid.heads)} columns"
        raise refuse(sheet.name, f"too large for a worksheet (got {size})", "Write CSV files: --csv FOLDER")
    for row, line in enumerate((grid.heads, grid.units)):
        for column, text in enumerate(line):
            if text:
                sheet.write_string(row, column, _text(text), (head, unit)[row])
    for row, line in enumerate(grid.rows, start=2):
        for column, value in enumerate(line):
            _write_cell(sheet, row, column, plain_cell(value))
    for column, width in enumerate(_widths(grid)):
        sheet.set_column(column, column, width)
    sheet.freeze_panes(2, grid.named)


def _write_cell(sheet: Any, row: int, column: int, value: Any) -> None:
    """A cell: a number as a number, others as text; empty if unknown."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return
    if isinstance(value, bool):
        sheet.write_boolean(row, column, value)
    elif isinstance(value, (int, float)) and abs(value) <= _LARGEST:
        sheet.write_number(row, column, value + 0.0 if isinstance(value, float) else value)
    else:
        sheet.write_string(row, column, _text(str(value)))


def _text(text: str) -> str:
    text = printable(text, keep="\n\t")
    return text if len(text) <= _LONGEST_TEXT else f"{text[: _LONGEST_TEXT - 4]} ..."


def _widths(grid: Grid) -> Iterator[int]:
    """Widths of columns in characters, by their heads and first rows."""
    for column, texts in enumerate(zip(grid.heads, grid.units, strict=True)):
        cells = (str(row[column]) for row in grid.rows[:50])
        yield min(_WIDEST, 2 + max(len(text) for text in chain(texts, cells)))


def _about(result: Any, about: Mapping[str, Any]) -> Grid:
    own = getattr(result, PROVENANCE, None)
    entries = {
        "flexstage": __version__,
        "units": "SI units; they are below the heads or in the heads",
        **about,
        **({PROVENANCE: own} if own else {}),
    }
    rows = [(key, value) for key, value in entries.items() if not isinstance(value, (list, tuple))]
    rows += [(key, str(each)) for key, value in entries.items() if isinstance(value, (list, tuple)) for each in value]
    return Grid(("what", "value"), ("", ""), tuple(rows), 1)


def sheet_names(paths: Sequence[str]) -> list[str]:
    """Return valid names of Excel sheets, one for each path: 31 characters at most, without `[ ] : * ? /` and backslashes.

    Names are unique even if upper and lower case are not distinguished.

    >>> sheet_names(["", "modes", "Modes", "a/b", "statics.stiffness.by_direction.principal"])
    ['result', 'modes', 'Modes (2)', 'a_b', 'by_direction.principal']
    """
    taken = {"history"}
    found: list[str] = []
    for path in paths:
        plain = _FORBIDDEN.sub("_", printable(_last_parts(path))).strip("'") or "result"
        tries = chain((plain[-_LONGEST_NAME:],), (f"{plain[4 + len(str(number)) - _LONGEST_NAME :]} ({number})" for number in count(2)))
        name = next(each.strip("'") for each in tries if each.strip("'").lower() not in taken)
        taken.add(name.lower())
        found.append(name)
    return found


def _last_parts(path: str) -> str:
    """The end of a path that fits."""
    while len(path) > _LONGEST_NAME and "." in path:
        path = path.partition(".")[2]
    return path
