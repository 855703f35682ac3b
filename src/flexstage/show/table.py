"""Tables of results for readers, independent of the output format."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from types import MappingProxyType
from typing import Any, TypeAlias, TypeVar

import numpy as np

from flexstage.base.labelled import NOISE, NOISE_RULE, Matrix, quiet, ratio_units
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import Field, Heading, Mark, UnitIn, UnitOf, by_name, field_at, field_of, result_fields, values_of
from flexstage.base.storage.sheet import NUMBERS, Sheet, is_cell, owner_names, parts, plain_cell, rows_of
from flexstage.base.units.quantity import SHARE, Bound, Quantity
from flexstage.show.display import (
    DIGITS,
    NO_VALUE,
    DisplayUnit,
    align_numbers,
    display_unit,
    display_unit_of,
    format_value,
    number,
    percent,
)


@dataclass(frozen=True)
class Cell:
    """A cell of a table: its text, its mark, and optionally the length of a bar behind the text (0 to 1)."""

    text: str
    mark: Mark = Mark.PLAIN
    bar: float | None = None

    @property
    def length(self) -> float:
        """Length of the bar as a fraction of the cell's width, at most 1."""
        return min(max(self.bar or 0.0, 0.0), 1.0)


@dataclass(frozen=True)
class Column:
    """A column of a table: its head and unit. `numeric` columns are aligned right."""

    head: str
    unit: str = ""
    numeric: bool = True

    @property
    def text(self) -> str:
        """The head and, in brackets, the unit."""
        return f"{self.head} [{self.unit}]" if self.unit else self.head


_Found = TypeVar("_Found")
_Made = TypeVar("_Made")
_MANY = 60
_PLAIN = Heading()
_NO_FIELDS: Mapping[str, Field] = {}
PAGE_ROWS = 300
"""Largest number of rows of a table in an HTML page: all DOFs of a thousand bodies would need a megabyte."""

Content: TypeAlias = str | Cell


_ColumnCells: TypeAlias = tuple[Column, list[Cell]]


@dataclass(frozen=True)
class Table(InNotebook):
    """A table for readers: title, columns, rows, notes below the table, and the source of its numbers."""

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()
    provenance: str = ""

    def texts(self) -> list[list[str]]:
        """Return heads (with units) and cells as plain text, row by row."""
        return [[column.text for column in self.columns], *([cell.text for cell in row] for row in self.rows)]


def make_table(
    title: str,
    columns: Iterable[Column | str],
    rows: Iterable[Sequence[Content]],
    *,
    notes: Iterable[str] = (),
    provenance: str = "",
) -> Table:
    """Make a table from columns and rows of cells. A string is the head of a text column, or the text of a plain cell.

    >>> make_table("Masses", ["body", Column("mass", "kg")], [("platform", "14")]).texts()
    [['body', 'mass [kg]'], ['platform', '14']]
    """
    heads = tuple(column if isinstance(column, Column) else Column(column, numeric=False) for column in columns)
    cells = tuple(tuple(cell if isinstance(cell, Cell) else Cell(cell) for cell in row) for row in rows)
    return Table(title, heads, cells, tuple(notes), provenance)


def text_table(
    title: str,
    heads: Sequence[Column | str],
    rows: Mapping[str, str | Sequence[str]],
    *,
    notes: Iterable[str] = (),
    provenance: str = "",
) -> Table | None:
    """Make a table of names, each with one or several texts. Returns `None` if there are no rows.

    >>> text_table("Sources", ["", "source"], {"steel": "data sheet"}).texts()
    [['', 'source'], ['steel', 'data sheet']]
    """
    cells = [(Cell(name, Mark.STRONG), *([texts] if isinstance(texts, str) else texts)) for name, texts in rows.items()]
    return make_table(title, heads, cells, notes=notes, provenance=provenance) if rows else None


def _cell(text: str) -> Cell:
    return Cell(text, Mark.FAINT if text in ("0", NO_VALUE) else Mark.PLAIN)


def number_cells(values: Iterable[float], form: DisplayUnit, digits: int | None = None) -> list[Cell]:
    """Format a column of SI values in a display unit, with aligned decimals. With `digits`, each number has that many significant digits.

    Values that are rounding noise, relative to the largest value of the column, are shown as 0.

    >>> [cell.text for cell in number_cells([15e6, 1e-6], DisplayUnit("N/um", 1e-6))]
    ['15', '0']
    """
    items = form.factor * _zero_noise(np.array([float(value) for value in values]))
    return list(map(_cell, align_numbers(items) if digits is None else [number(float(each), digits) for each in items]))


def row_table(
    title: str,
    source: Any,
    *fields: str,
    head: str = "",
    notes: Iterable[str] = (),
    provenance: str = "",
) -> Table:
    """Make a table with one row for each record or name, and one column for each field.

    `source` is a single record, or a mapping or sequence of records of one class. A record that contains a labelled matrix, or arrays
    marked with `Along`, has one row for each name along their first axis. `fields` are the shown fields in sequence; by default, all fields
    whose values fit into cells. The head of a column is the field's `Heading`, or otherwise the field's name and unit. `head` is the head
    of the column of names; for two columns of names, it contains both heads separated by a comma, for example `path, axis`. Values outside
    a field's `Bound` are marked.

    >>> from flexstage.analysis.workspace.drive import Drive
    >>> one = np.ones(1)
    >>> row_table("Drive", Drive(("B1",), 1.5e-7 * one, 0.0 * one, 1e3 * one, 500.0 * one, 4e-7 * one), "gain", "low", "high").texts()
    [['actuator', 'gain [um/V]', 'low [V]', 'high [V]'], ['B1', '0.15', '0', '1000']]
    """
    if not fields:
        sheet = rows_of(source)
        told = {each: values for each, values in sheet.columns.items() if all(map(is_cell, values))}
        return sheet_table(title, Sheet(_headed(sheet.names, head), told), notes, provenance)
    records = tuple(source.values()) if isinstance(source, Mapping) else source if isinstance(source, Sequence) else (source,)
    ends = [_row_names(each, fields) for each in records]
    counts = [len(names) for _, names in ends]
    along = list(chain.from_iterable(names for _, names in ends))
    names = {name: _spread(values, counts) for name, values in owner_names(source).items()} | ({ends[0][0]: along} if ends[0][0] else {})
    columns = [_name_column(*each) for each in _headed(names, head).items()]
    columns += [each for path in fields for each in _columns_at(records, path, counts, along)]
    table = _columns_table(title, columns, notes, provenance)
    return replace(table, rows=tuple((replace(first, mark=Mark.STRONG), *others) for first, *others in table.rows))


def _headed(names: Mapping[str, Iterable[Any]], head: str) -> dict[str, tuple[Any, ...]]:
    """Names under the specified heads, one each, else under their own."""
    return dict(zip(head.split(", ") if head else names, map(tuple, names.values()), strict=True))


def _row_names(record: Any, paths: Iterable[str]) -> tuple[str, Sequence[Any]]:
    """The kind of the rows of a record, and the name of each; a single row without a name if no field has names."""
    found = [field_at(record, path) for path in paths]
    matrix = next((value for _, value in found if isinstance(value, Matrix)), None)
    if matrix is not None:
        return "along", matrix.rows
    axis = next((field.axes[0] for field, _ in found if field.axes), None)
    return (field_of(type(record), axis).words.removesuffix("s"), getattr(record, axis)) if axis else ("", ("",))


def _spread(values: Iterable[Any], counts: Iterable[int], *, along: bool = False) -> list[Any]:
    """A value for each row: the entries of a record along names, or its single value, repeated."""
    pairs = zip(values, counts, strict=True)
    return [each for value, count in pairs for each in (by_name(value) if along and value is not None else (value,) * count)]


def _values_at(records: Iterable[Any], path: str, counts: Iterable[int]) -> list[Any]:
    """The value of a field in each row."""
    found = [field_at(each, path) for each in records]
    return _spread((value for _, value in found), counts, along=bool(found[0][0].axes))


def _columns_at(records: Sequence[Any], path: str, counts: Sequence[int], names: Sequence[str]) -> Iterator[_ColumnCells]:
    """The columns of a field: those of a matrix, one for other values, none without a value or text in any row."""
    field, value = field_at(records[0], path)
    if isinstance(value, Matrix):
        yield from matrix_columns(value, result_fields(type(records[0])), field.annotation(Heading) or _PLAIN)
        return
    values, beside, of_name = _values_at(records, path, counts), field.annotation(UnitIn), field.annotation(UnitOf)
    if beside:
        units = _spread((getattr(each, beside.field) for each in records), counts, along=bool(field.axes))
    else:
        units = [of_name.unit(name) for name in names] if of_name else []
    if field.heading.absent or any(each is not None for each in values):
        yield field_column(field, values, units)


def merge_rows(table: Table) -> Table:
    """Merge rows that differ only in the name into one row with all names. For links of instances, the names in the unit must be equal.

    >>> merge_rows(make_table("", ["link", "free"], [("B1/tip", "rz"), ("B1/foot", "rz"), ("B2/tip", "rz")])).texts()[1:]
    [['tip (B1, B2)', 'rz'], ['B1/foot', 'rz']]
    """
    groups: dict[tuple[str, ...], list[tuple[Cell, ...]]] = {}
    for row in table.rows:
        copy, _, own = row[0].text.rpartition("/")
        groups.setdefault((copy and own, *(each.text for each in row[1:])), []).append(row)
    rows = tuple((replace(rows[0][0], text=_join_names([row[0].text for row in rows])), *rows[0][1:]) for rows in groups.values())
    return replace(table, rows=rows)


def _join_names(names: Sequence[str]) -> str:
    copies, _, owns = zip(*(name.rpartition("/") for name in names), strict=True)
    return f"{owns[0]} ({', '.join(copies)})" if len(names) > 1 and all(copies) else ", ".join(names)


def sheet_table(title: str, sheet: Sheet, notes: Iterable[str] = (), provenance: str = "") -> Table:
    """Make a table of the rows and columns of a sheet; the first columns are names."""
    names = [_name_column(*each) for each in sheet.names.items()]
    return _columns_table(title, [*names, *(field_column(*each) for each in sheet.columns.items())], notes, provenance)


def column_table(title: str, matrix: Matrix, *, head: str = "", unit: str = "", notes: Iterable[str] = (), provenance: str = "") -> Table:
    """Make a table of a labelled matrix whose columns are quantities (see `matrix_columns`).

    `head` is the head of the column of row names; `unit` replaces the preferred display unit.

    >>> column_table("a", Matrix(np.array([[2e-6, 3.0]]), ("x",), ("low", "share"), (("m", "1"),)), head="along").texts()
    [['along', 'low [um]', 'share'], ['x', '2', '3']]
    """
    columns = [_name_column(head, matrix.rows), *matrix_columns(matrix, heading=Heading(unit=unit))]
    return _columns_table(title, columns, notes, provenance)


def _name_column(head: str, names: Iterable[Any]) -> _ColumnCells:
    return Column(head, numeric=False), [Cell(str(each), Mark.STRONG) for each in names]


def _columns_table(title: str, columns: Sequence[_ColumnCells], notes: Iterable[str], provenance: str = "") -> Table:
    rows = zip(*(cells for _, cells in columns), strict=True)
    return make_table(title, [column for column, _ in columns], rows, notes=notes, provenance=provenance)


def array_table(
    title: str, record: Any, *fields: str, names: Mapping[str, Iterable[Any]] = MappingProxyType({}), notes: Iterable[str] = ()
) -> Table:
    """Make a table with arrays of a record as columns. `names` maps the head of each column of row names to the names."""
    columns = (field_column(field, list(values)) for field, values in (field_at(record, name) for name in fields))
    return _columns_table(title, [*(_name_column(*each) for each in names.items()), *columns], notes)


def record_table(title: str, record: Any, *fields: str, notes: Iterable[str] = (), provenance: str = "") -> Table:
    """Make a table of a record, with a row of name, value and unit for each field. For `fields`, see `row_table`."""
    told = values_of(record)[0].items()
    chosen = [field_at(record, path) for path in fields] or [each for each in told if not each[0].axes and is_cell(each[1])]
    return _vertical_table(title, Sheet({}, {each: (value,) for each, value in chosen}), notes, provenance)


def result_table(source: Any, fields: str = "", *, title: str = "", notes: Iterable[str] = (), provenance: str = "") -> Table | None:
    """Make the table of a result, or of a sequence or mapping of results, with the layout `TABLE` of their class.

    `fields` and `title` replace the fields and title of `TABLE`. Returns `None` if there are no rows.

    >>> from flexstage.analysis.workspace.drive import Drive
    >>> one = np.ones(1)
    >>> result_table(Drive(("B1",), 1.5e-7 * one, 0.0 * one, 1e3 * one, 500.0 * one, 4e-7 * one)).title
    'Drive'
    """
    several = source.values() if isinstance(source, Mapping) else source if isinstance(source, Sequence) else (source,)
    one = next(iter(several), None)
    if one is None:
        return None
    layout, paths, title = one.TABLE, (fields or one.TABLE.fields).split(), (title or one.TABLE.title).format(self=one)
    said = [
        *chain.from_iterable(_note_texts(text, source, one) for text in layout.notes),
        *(getattr(one, "notes", ()) if one is source else ()),
        *notes,
    ]
    provenance = provenance or getattr(one, "provenance", "")
    known = [field_at(one, path) for path in paths] or values_of(one)[0].items()
    if one is source and not any(field.axes or isinstance(value, Matrix) for field, value in known):
        return record_table(title, one, *paths, notes=said, provenance=provenance)
    table = row_table(title, source, *paths, head=layout.head, notes=said, provenance=provenance)
    return table if table.rows else None


def _note_texts(text: str, source: Any, one: Any) -> list[str]:
    """A note of a result, or of results by name, one for each if they differ."""
    notes = {name: text.format(self=each) for name, each in (source if isinstance(source, Mapping) else {"": one}).items()}
    alike = list(dict.fromkeys(notes.values()))
    return alike if len(alike) == 1 else [f"{name}: {note}" for name, note in notes.items()]


def _vertical_table(title: str, sheet: Sheet, notes: Iterable[str] = (), provenance: str = "") -> Table:
    """A single row of a sheet as a vertical table."""
    columns = [(each.heading.text, *field_column(each, values)) for each, values in sheet.columns.items()]
    rows = [(Cell(name, Mark.STRONG), cells[0], column.unit) for name, column, cells in columns]
    return make_table(title, ["", Column("value"), "unit"], rows, notes=notes, provenance=provenance)


def optional(make: Callable[[_Found], _Made], found: _Found | None) -> _Made | None:
    """Make something of a result, such as its table; `None` for a result that is absent.

    >>> optional(further, None) is None
    True
    """
    return None if found is None else make(found)


def result_tables(result: Any) -> Iterator[Table]:
    """Make a table for every part of a result, with the part's path in the document as title. Only the first rows of long tables are shown.

    >>> [table.title for table in result_tables({"gain": 2.0, "loss": {"B1": 0.1, "B2": 0.2}})]
    ['', 'loss']
    """
    for path, part in parts(result):
        title = path.replace(".", ", ").replace("_", " ")
        if isinstance(part, Matrix):
            yield matrix_table(title, part)
        elif part.names:
            yield first_rows(sheet_table(title, part), _MANY)
        else:
            yield _vertical_table(title, part)


def first_rows(table: Table, most: int) -> Table:
    """Limit a table to its first `most` rows. A note contains the number of further rows.

    >>> first_rows(make_table("", ["body"], [("b1",), ("b2",), ("b3",)]), 1).notes
    ('2 further rows.',)
    """
    rest = len(table.rows) - most
    return table if rest <= 0 else replace(table, rows=table.rows[:most], notes=(*table.notes, further(rest)))


def further(rest: int) -> str:
    """Make the sentence with the number of rows that are not shown.

    >>> further(12)
    '12 further rows.'
    """
    return f"{rest} further rows."


def field_column(field: Field, values: Sequence[Any], units: Sequence[str] = ()) -> _ColumnCells:
    """Make the column of a field and its cells, for tables that also have other columns. `units` are the SI units of the values.

    >>> from flexstage.base.units.quantity import SHARE, STIFFNESS
    >>> from flexstage.base.record import Heading
    >>> field_column(Field("loss", float, (SHARE,)), [0.03, 1e-17])[1]
    [Cell(text='3 %', mark=<Mark.PLAIN: 'plain'>, bar=0.03), Cell(text='0 %', mark=<Mark.PLAIN: 'plain'>, bar=0.0)]
    >>> [cell.text for cell in field_column(Field("axial", float, (STIFFNESS, Heading(varying=True))), [15e6, 2e3])[1]]
    ['15 N/um', '2 N/mm']
    >>> [cell.text for cell in field_column(Field("after", float, ()), [2.1e11, 1.6e-3])[1]]
    ['2.1e11', '0.0016']
    """
    column, cells = _plain_column(field, values, units)
    heading = field.heading
    missing = Cell(heading.absent, Mark.WARN) if heading.absent else Cell(NO_VALUE, Mark.FAINT)
    cells = [missing if value is None else cell for cell, value in zip(cells, values, strict=True)]
    mark = heading.mark
    if mark is not None:
        cells = [cell if value is None else replace(cell, mark=mark(value)) for cell, value in zip(cells, values, strict=True)]
    return column, cells


def _plain_column(field: Field, values: Sequence[Any], units: Sequence[str]) -> _ColumnCells:
    """The column of a field and its cells, without bars."""
    heading, quantity = field.heading, field.annotation(Quantity)
    form = display_unit(quantity, heading.unit)
    if field.type == tuple[float, float] and not any(isinstance(each, NUMBERS) for each in values):
        ends = [NO_VALUE if each is None else interval_text(*(form.factor * end for end in each)) for each in values]
        return Column(heading.text, form.unit), [Cell(text) for text in ends]
    if not all(isinstance(each, (*NUMBERS, np.ndarray)) and not isinstance(each, bool) for each in values if each is not None):
        return Column(heading.text, numeric=False), [Cell(_cell_text(each)) for each in values]
    numbers = np.array([np.nan if each is None else float(first_design(each, 0)) for each in values])
    units = units or ([field.unit] * len(numbers) if heading.varying else ())
    varying = heading.varying or len(set(units)) > 1
    largest = float(np.max(np.abs(numbers[np.isfinite(numbers)]), initial=0.0))
    form = display_unit_of(units[0], largest, heading.unit) if units else form
    if varying:
        cells = _cells_with_units(numbers, units, heading.digits)
    elif form.unit == "%":
        shares = _zero_noise(numbers, 1.0).tolist()
        cells = [Cell(percent(each, heading.digits or 4), bar=each if quantity == SHARE else None) for each in shares]
    elif quantity is None and not units:  # numbers of unknown units: noise cannot be identified
        cells = [_cell(number(each, heading.digits or DIGITS)) for each in numbers.tolist()]
    else:
        cells = number_cells(numbers, form, heading.digits)
    cells = [Cell(NO_VALUE, Mark.FAINT) if np.isnan(each) else cell for cell, each in zip(cells, numbers, strict=True)]
    bound = field.annotation(Bound) or Bound()
    outside = [each > bound.high + NOISE * abs(bound.high) or each < bound.low - NOISE * abs(bound.low) for each in numbers]
    cells = [replace(cell, mark=Mark.FAIL) if out else cell for cell, out in zip(cells, outside, strict=True)]
    cells = [replace(cell, text=heading.infinite) if np.isposinf(each) else cell for cell, each in zip(cells, numbers, strict=True)]
    return Column(heading.text, "" if varying or form.unit == "%" else form.text), cells


def interval_text(low: float, high: float) -> str:
    """Format an interval. Both ends are rounded to the second significant digit of the interval's width.

    >>> interval_text(118.0101, 118.0145), interval_text(1.0, float("inf"))
    ('118.0101 to 118.0145', '-')
    """
    width = high - low
    if not np.isfinite(width):
        return NO_VALUE
    decimals = int(np.clip(1 - np.floor(np.log10(width)), 0, 6)) if width > 0.0 else 4
    return f"{low:.{decimals}f} to {high:.{decimals}f}"


def matrix_columns(matrix: Matrix, fields: Mapping[str, Field] = _NO_FIELDS, heading: Heading = _PLAIN) -> Iterator[_ColumnCells]:
    """Make the columns of a labelled matrix (first design of a batch).

    Numbers of a column with a common SI unit have a common display unit; otherwise each number has its own display unit. A column with the
    name of one of `fields` gets the heading and bound of that field; other columns get `heading`.

    >>> [cells[0].text for _, cells in matrix_columns(Matrix(np.array([[2e-6], [1e-3]]), ("x", "rx"), ("low",), (("m",), ("rad",))))]
    ['2 um']
    """
    entries = list(zip(*_entry_units(matrix), strict=True)) or [()] * len(matrix.columns)
    for name, values, units in zip(matrix.columns, first_design(matrix.values, 2).T, entries, strict=True):
        own = fields.get(name)
        yield field_column(own if own and own.annotation(Heading) else Field(name, float, (heading,)), list(values), units)


def _cells_with_units(values: Array, units: Sequence[str], digits: int | None = None) -> list[Cell]:
    """Values each with its best display unit; rounding noise against the largest of the same unit is 0."""
    owns = np.array(units)
    kept = [_zero_noise(np.where(owns == unit, values, 0.0))[place] for place, unit in enumerate(units)]
    return [_with_unit(float(value), unit, digits or DIGITS) for value, unit in zip(kept, units, strict=True)]


def _cell_text(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return ", ".join(map(_cell_text, value)) or NO_VALUE
    return NO_VALUE if value is None else str(plain_cell(value))


def _zero_noise(values: Array, least: float = 0.0) -> Array:
    """Replace rounding noise against the column's largest value, or `least` if that is larger, by 0."""
    largest = np.max(np.abs(values[np.isfinite(values)]), initial=least)
    return np.where(np.isfinite(values) & (np.abs(values) < NOISE * largest), 0.0, values)


def matrix_table(
    title: str,
    matrix: Matrix,
    *,
    against: Matrix | None = None,
    units: tuple[str, ...] = (),
    notes: Iterable[str] = (),
    provenance: str = "",
) -> Table:
    """Make a table of a labelled matrix (first design of a batch) in display units.

    Rows and columns have units, and the unit of an entry is row unit per column unit. If the units of the entries are not ratios of row and
    column units, each entry shows its unit. Rounding noise is shown as 0; a further matrix `against` may define the noise level. `units`
    replace the preferred display units; for example, with mrad, displacements per rotation are in um/mrad.

    >>> table = matrix_table("K", Matrix(np.array([[2e6]]), ("fx",), ("x",), (("N/m",),)))
    >>> table.texts()
    [['', 'x [um]'], ['fx [N]', '2']]
    """
    values = first_design(matrix.values, 2)
    kept = quiet(values, None if against is None else first_design(against.values, 2))
    said = [NOISE_RULE] if np.any((kept == 0.0) & (values != 0.0)) else []
    said += batch_note(matrix.values, 2)
    ends = _ends(matrix)
    if ends is None:
        return column_table(title, replace(matrix, values=kept), notes=[*notes, *said], provenance=provenance)
    rows, columns = (tuple(display_unit_of(unit, 0.0, *units) for unit in own) for own in ends)
    heads = [Column(name, form.text) for name, form in zip(short_names(matrix.columns), columns, strict=True)]
    scales = np.array([column.factor for column in columns])
    lines = [
        [Cell(Column(name, form.text).text, Mark.STRONG), *(_cell(number(each)) for each in (line * form.factor / scales).tolist())]
        for name, form, line in zip(short_names(matrix.rows), rows, kept, strict=True)
    ]
    ratio = ["Entries: row unit per column unit."] if all(any(form.text for form in forms) for forms in (rows, columns)) else []
    return make_table(title, [Column("", numeric=False), *heads], lines, notes=[*notes, *ratio, *said], provenance=provenance)


def short_names(names: tuple[str, ...]) -> tuple[str, ...]:
    """Remove the owner (the part before the dot) from names if all names have the same owner.

    >>> short_names(("platform.x", "platform.y")), short_names(("platform.x", "chuck.x")), short_names(("B1", "B2"))
    (('x', 'y'), ('platform.x', 'chuck.x'), ('B1', 'B2'))
    """
    owners = {name.rpartition(".")[0] for name in names}
    return tuple(name.rpartition(".")[2] for name in names) if len(owners) == 1 else names


_ENDS = ("m", "rad", "N", "N m", "K", "K/m", "V", "1")


def _ends(matrix: Matrix) -> tuple[tuple[str, ...], tuple[str, ...]] | None:
    """Units of rows and columns whose ratios are the units of all entries; `None` if none exist."""
    units = _entry_units(matrix)
    if isinstance(matrix.unit, str):
        return None if matrix.unit != "1" else (("1",) * len(matrix.rows), ("1",) * len(matrix.columns))
    for start in _ENDS:
        below = dict(zip(*ratio_units((start,), _ENDS), _ENDS, strict=True))
        columns = tuple(below.get(unit, "") for unit in units[0])
        above = {column[0]: top for top, column in zip(_ENDS, ratio_units(_ENDS, columns[:1]), strict=True) if column}
        rows = tuple(above.get(line[0], "") for line in units if line)
        if ratio_units(rows, columns) == units:
            return rows, columns
    return None


def _entry_units(matrix: Matrix) -> tuple[tuple[str, ...], ...]:
    if isinstance(matrix.unit, str):
        return ((matrix.unit,) * len(matrix.columns),) * len(matrix.rows)
    return matrix.unit


def _with_unit(value: float, unit: str, digits: int) -> Cell:
    text = format_value(value, unit, digits)
    bare = _cell(text.split()[0])
    return bare if bare.mark is Mark.FAINT else Cell(text)


def first_design(values: Array, axes: int) -> Array:
    """Return the real values of the first design of a batch. The last `axes` axes of the array belong to a design, the others to the batch.

    >>> first_design(np.ones((4, 2, 2)), 2).shape
    (2, 2)
    """
    values = np.asarray(values)
    return np.real(values[(0,) * (values.ndim - axes)])


def batch_note(values: Array, axes: int) -> tuple[str, ...]:
    """Return the note for a table that shows only the first design of a batch. A single design has no note.

    >>> batch_note(np.ones((4, 2, 2)), 2)
    ('The first of 4 designs.',)
    """
    count = int(np.prod(values.shape[: values.ndim - axes]))
    return (f"The first of {count} designs.",) if values.ndim > axes else ()
