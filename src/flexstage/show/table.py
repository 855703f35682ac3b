"""Tables: results laid out for people, independent of where they are shown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np

from flexstage.base.labelled import NOISE, NOISE_RULE, Matrix, quiet, ratio_units
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import Field, Mark, by_name, field_of, values_of
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
    preferred_unit,
)


@dataclass(frozen=True)
class Cell:
    """A table's cell: its text, its mark, and optionally the length of a bar behind it (a share between 0 and 1)."""

    text: str
    mark: Mark = Mark.PLAIN
    bar: float | None = None

    @property
    def length(self) -> float:
        """The bar's share, not beyond the cell."""
        return min(max(self.bar or 0.0, 0.0), 1.0)


@dataclass(frozen=True)
class Column:
    """A table's column: head and unit; `numeric` columns are set flush right."""

    head: str
    unit: str = ""
    numeric: bool = True


_MANY = 60
PAGE_ROWS = 300
"""Rows of a table that a page shows: the freedoms of a thousand bodies were a megabyte that nobody reads."""

Content: TypeAlias = str | Cell


@dataclass(frozen=True)
class Table(InNotebook):
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


def make_table(
    title: str,
    columns: Iterable[Column | str],
    rows: Iterable[Sequence[Content]],
    *,
    notes: Iterable[str] = (),
    provenance: str = "",
) -> Table:
    """A table from columns (a text alone is the head of a column of words) and rows of cells (a text alone is a plain cell).

    >>> make_table("Masses", ["body", Column("mass", "kg")], [("platform", "14")]).texts()
    [['body', 'mass [kg]'], ['platform', '14']]
    """
    heads = tuple(column if isinstance(column, Column) else Column(column, numeric=False) for column in columns)
    cells = tuple(tuple(cell if isinstance(cell, Cell) else Cell(cell) for cell in row) for row in rows)
    return Table(title, heads, cells, tuple(notes), provenance)


def number_cells(values: Iterable[float], form: DisplayUnit, digits: int | None = None) -> list[Cell]:
    """A column of SI values in a display unit, decimals aligned, or each to as many significant `digits`.

    Rounding noise against the column's largest value is shown as 0.

    >>> [cell.text for cell in number_cells([15e6, 1e-6], DisplayUnit("N/um", 1e-6))]
    ['15', '0']
    """
    items = form.factor * _zero_noise(np.array([float(value) for value in values]))
    texts = align_numbers(items) if digits is None else [number(float(each), digits) for each in items]
    return [Cell(text, _mark_of(text)) for text in texts]


def row_table(title: str, source: Any, *fields: str, head: str = "", notes: Iterable[str] = (), provenance: str = "") -> Table:
    """One row a record, or a name, and a column a field, headed by its name in words with its quantity's unit, or as its `Heading` says.

    `source` is a mapping or sequence of records of one kind, or a record. Arrays `Along` names are a row a name. `fields` are those shown,
    in that order (absent: all that a cell can hold); `head` stands over the names, `path, axis` over two. What lies outside of a field's
    `Bound` is marked.

    >>> from flexstage.analysis.workspace.drive import Drive
    >>> one = np.ones(1)
    >>> row_table("Drive", Drive(("B1",), 1.5e-7 * one, 0.0 * one, 1e3 * one, 500.0 * one, 4e-7 * one), "gain", "low", "high").texts()
    [['actuator', 'gain [um/V]', 'low [V]', 'high [V]'], ['B1', '0.15', '0', '1000']]
    """
    if not fields:
        sheet = rows_of(source)
        shown = {each: values for each, values in sheet.columns.items() if all(map(is_cell, values))}
        return sheet_table(title, Sheet(_headed(sheet.names, head), shown), notes=notes, provenance=provenance)
    records = tuple(source.values()) if isinstance(source, Mapping) else source if isinstance(source, Sequence) else (source,)
    found = [field_of(type(records[0]), name) for name in fields]
    columns = {each: tuple(_value_of(record, each) for record in records) for each in found}
    names, along = owner_names(source), next((each.along for each in found if each.along), None)
    if along:
        ends = [tuple(getattr(each, along)) for each in records]
        counts = [len(each) for each in ends]
        names = {name: _repeated(values, counts) for name, values in names.items()}
        names[field_of(type(records[0]), along).words.removesuffix("s")] = tuple(chain.from_iterable(ends))
        columns = {each: (_joined if each.along else _repeated)(values, counts) for each, values in columns.items()}
    known = {each: values for each, values in columns.items() if each.heading.absent or any(value is not None for value in values)}
    return sheet_table(title, Sheet(_headed(names, head), known), notes=notes, provenance=provenance)


def _headed(names: Mapping[str, tuple[Any, ...]], head: str) -> dict[str, tuple[Any, ...]]:
    """Names under the heads stated, one each, else under their own."""
    return dict(zip(head.split(", ") if head else names, names.values(), strict=True))


def _repeated(values: Iterable[Any], counts: Iterable[int]) -> tuple[Any, ...]:
    return tuple(value for value, count in zip(values, counts, strict=True) for _ in range(count))


def _joined(arrays: Iterable[Any], counts: Iterable[int]) -> tuple[Any, ...]:
    """Arrays one after the other, of what is absent so many entries."""
    return tuple(chain.from_iterable((None,) * count if array is None else array for array, count in zip(arrays, counts, strict=True)))


def _value_of(record: Any, field: Field) -> Any:
    """The value of a record, or of a record within it, an array by name; a number whose unit is in a field beside it as text."""
    *owners, name = field.name.split(".")
    for each in owners:
        record = getattr(record, each, None)
    value = None if name in getattr(record, "reasons", ()) else getattr(record, name, None)
    value, heading = by_name(value) if field.along else value, field.heading
    if value is None or not heading.unit_field:
        return value
    units = getattr(record, heading.unit_field)
    pairs = zip(value, units, strict=True) if field.along else [(value, units)]
    texts = [None if np.isnan(each) else format_value(each, unit, heading.digits or DIGITS) for each, unit in pairs]
    return texts if field.along else texts[0]


def sheet_table(title: str, sheet: Sheet, *, notes: Iterable[str] = (), provenance: str = "") -> Table:
    """Rows and columns of a result, names first, else the first field for them."""
    names = [(Column(head, numeric=False), [Cell(str(each), Mark.STRONG) for each in values]) for head, values in sheet.names.items()]
    columns = [*names, *(field_column(*each) for each in sheet.columns.items())]
    if columns and not names:
        columns[0] = columns[0][0], [replace(cell, mark=Mark.STRONG) if cell.mark is Mark.PLAIN else cell for cell in columns[0][1]]
    return make_table(
        title, [column for column, _ in columns], zip(*(cells for _, cells in columns), strict=True), notes=notes, provenance=provenance
    )


def array_table(
    title: str, record: Any, *fields: str, names: Mapping[str, Iterable[Any]] = MappingProxyType({}), notes: Iterable[str] = ()
) -> Table:
    """Arrays of a record as columns, an entry a row; `names` of the rows by their head."""
    columns = {field_of(type(record), name): tuple(getattr(record, name)) for name in fields}
    return sheet_table(title, Sheet({head: tuple(each) for head, each in names.items()}, columns), notes=notes)


def record_table(title: str, record: Any, *fields: str, notes: Iterable[str] = (), provenance: str = "") -> Table:
    """A record as rows of name, value and unit; `fields` as for `row_table`."""
    if fields:
        columns = {field: (_value_of(record, field),) for field in (field_of(type(record), name) for name in fields)}
    else:
        columns = {each: (value,) for each, value in values_of(record)[0].items() if not each.axes and is_cell(value)}
    return _vertical_table(title, Sheet({}, columns), notes, provenance)


def result_table(source: Any, *, notes: Iterable[str] = (), provenance: str = "") -> Table | None:
    """The table of a result, or of results in a sequence or by name, as `TABLE` of its class says; `None` where there is none.

    >>> from flexstage.analysis.workspace.drive import Drive
    >>> one = np.ones(1)
    >>> result_table(Drive(("B1",), 1.5e-7 * one, 0.0 * one, 1e3 * one, 500.0 * one, 4e-7 * one)).title
    'Drive'
    """
    several = source.values() if isinstance(source, Mapping) else source if isinstance(source, Sequence) else (source,)
    one = next(iter(several), None)
    if one is None:
        return None
    layout, fields, title = one.TABLE, one.TABLE.fields.split(), one.TABLE.title.format(self=one)
    told = [*chain.from_iterable(_told(text, source, one) for text in layout.notes), *(getattr(one, "notes", ()) if one is source else ())]
    provenance = provenance or getattr(one, "provenance", "")
    if one is source and not any(field.axes for field in values_of(one)[0]):
        return record_table(title, one, *fields, notes=[*told, *notes], provenance=provenance)
    return row_table(title, source, *fields, head=layout.head, notes=[*told, *notes], provenance=provenance)


def _told(text: str, source: Any, one: Any) -> list[str]:
    """A note of a result, or of results by name, of each where they differ."""
    notes = {name: text.format(self=each) for name, each in (source if isinstance(source, Mapping) else {"": one}).items()}
    alike = dict.fromkeys(notes.values())
    return list(alike) if len(alike) == 1 else [f"{name}: {note}" for name, note in notes.items()]


def _vertical_table(title: str, sheet: Sheet, notes: Iterable[str] = (), provenance: str = "") -> Table:
    """A single row of a sheet, set upright."""
    columns = [(each.heading.text, *field_column(each, values)) for each, values in sheet.columns.items()]
    rows = [(Cell(name, Mark.STRONG), cells[0], column.unit) for name, column, cells in columns]
    return make_table(title, ["", Column("value"), "unit"], rows, notes=notes, provenance=provenance)


def result_tables(result: Any) -> Iterator[Table]:
    """A table for every part of a result, headed by its path in the document; of many rows the first ones.

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
    """A table without the rows beyond so many, which a note counts.

    >>> first_rows(make_table("", ["body"], [("b1",), ("b2",), ("b3",)]), 1).notes
    ('2 further rows.',)
    """
    rest = len(table.rows) - most
    return table if rest <= 0 else replace(table, rows=table.rows[:most], notes=(*table.notes, further(rest)))


def further(rest: int) -> str:
    """How many rows are not shown, in words.

    >>> further(12)
    '12 further rows.'
    """
    return f"{rest} further rows."


def field_column(field: Field, values: Sequence[Any]) -> tuple[Column, list[Cell]]:
    """The column of a field and its cells, for tables that stand beside others' columns.

    >>> from flexstage.base.units.quantity import SHARE, STIFFNESS
    >>> from flexstage.base.record import Heading
    >>> field_column(Field("loss", float, (SHARE,)), [0.03, 1e-17])[1]
    [Cell(text='3 %', mark=<Mark.PLAIN: 'plain'>, bar=0.03), Cell(text='0 %', mark=<Mark.PLAIN: 'plain'>, bar=0.0)]
    >>> [cell.text for cell in field_column(Field("axial", float, (STIFFNESS, Heading(varying=True))), [15e6, 2e3])[1]]
    ['15 N/um', '2 N/mm']
    >>> [cell.text for cell in field_column(Field("after", float, ()), [2.1e11, 1.6e-3])[1]]
    ['2.1e11', '0.0016']
    """
    column, cells = _plain_column(field, values)
    heading = field.heading
    missing = Cell(heading.absent, Mark.WARN) if heading.absent else Cell(NO_VALUE, Mark.FAINT)
    mark = heading.mark
    graded = [cell if mark is None or value is None else replace(cell, mark=mark(value)) for cell, value in zip(cells, values, strict=True)]
    return column, [missing if value is None else cell for cell, value in zip(graded, values, strict=True)]


def interval_text(low: float, high: float) -> str:
    """An interval, its ends to two significant digits of its width.

    >>> interval_text(118.0101, 118.0145), interval_text(1.0, float("inf"))
    ('118.0101 to 118.0145', '-')
    """
    width = high - low
    if not np.isfinite(width):
        return NO_VALUE
    decimals = int(np.clip(1 - np.floor(np.log10(width)), 0, 6)) if width > 0.0 else 4
    return f"{low:.{decimals}f} to {high:.{decimals}f}"


def _plain_column(field: Field, values: Sequence[Any]) -> tuple[Column, list[Cell]]:
    """The column of a field and its cells, not graded."""
    heading, form = field.heading, display_unit(field.annotation(Quantity), field.heading.unit)
    if field.type == tuple[float, float] and all(each is None or isinstance(each, tuple) for each in values):
        ends = [NO_VALUE if each is None else interval_text(*(form.factor * end for end in each)) for each in values]
        return Column(heading.text, form.unit), [Cell(text) for text in ends]
    if not all(isinstance(each, (*NUMBERS, np.ndarray)) and not isinstance(each, bool) for each in values if each is not None):
        return Column(heading.text, numeric=bool(heading.unit_field)), [Cell(_cell_text(each)) for each in values]
    numbers = np.array([np.nan if each is None else float(first_design(each, 0)) for each in values])
    if heading.varying:
        cells = [Cell(format_value(each, field.unit, heading.digits or DIGITS)) for each in _zero_noise(numbers).tolist()]
    elif form.unit == "%":
        shares = _zero_noise(numbers, 1.0).tolist()
        cells = [Cell(percent(each, heading.digits or 4), bar=each if field.annotation(Quantity) == SHARE else None) for each in shares]
    elif field.annotation(Quantity) is None:  # numbers of who knows what beside one another: none is noise against the others
        cells = [Cell(text, _mark_of(text)) for text in (number(each, heading.digits or DIGITS) for each in numbers.tolist())]
    else:
        cells = number_cells(numbers, form, heading.digits)
    cells = [Cell(NO_VALUE, Mark.FAINT) if np.isnan(each) else cell for cell, each in zip(cells, numbers, strict=True)]
    bound = field.annotation(Bound) or Bound()
    outside = [each > bound.high + NOISE * abs(bound.high) or each < bound.low - NOISE * abs(bound.low) for each in numbers]
    cells = [replace(cell, mark=Mark.FAIL) if out else cell for cell, out in zip(cells, outside, strict=True)]
    cells = [replace(cell, text=heading.infinite) if np.isposinf(each) else cell for cell, each in zip(cells, numbers, strict=True)]
    return Column(heading.text, "" if heading.varying or form.unit == "%" else form.unit), cells


def _cell_text(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return ", ".join(map(_cell_text, value)) or NO_VALUE
    return NO_VALUE if value is None else str(plain_cell(value))


def _zero_noise(values: Array, least: float = 0.0) -> Array:
    """A column of values in which rounding noise against its largest, or `least` where that is more, is 0."""
    largest = np.max(np.abs(values[np.isfinite(values)]), initial=least)
    return np.where(np.isfinite(values) & (np.abs(values) < NOISE * largest), 0.0, values)


def matrix_table(title: str, matrix: Matrix, *, against: Matrix | None = None, fine: bool = True, notes: Iterable[str] = ()) -> Table:
    """A labelled matrix (first design of a batch) in display units.

    Rows and columns carry units and an entry is in row unit per column unit; where the entries' units are no such ratios, each entry
    carries its own. `against` sets the scale of rounding noise; `fine`: angles in urad, else in mrad (lever arms come out in mm).

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
        return _entries_with_units(title, matrix, kept, (*notes, *said))
    rows, columns = (tuple(_form(unit, fine=fine) for unit in units) for units in ends)
    heads = [Column(name, _unit(form)) for name, form in zip(short_names(matrix.columns), columns, strict=True)]
    lines = [
        [_row_head(name, form), *(_entry(value * form.factor / column.factor) for value, column in zip(line, columns, strict=True))]
        for name, form, line in zip(short_names(matrix.rows), rows, kept, strict=True)
    ]
    ratio = ["Entries: row unit per column unit."] if all(any(_unit(form) for form in forms) for forms in (rows, columns)) else []
    return make_table(title, [Column("", numeric=False), *heads], lines, notes=[*notes, *ratio, *said])


def unit_row_table(title: str, matrix: Matrix, *, heads: tuple[str, ...] = (), first: str = "along", notes: tuple[str, ...] = ()) -> Table:
    """A matrix whose entries share a unit along each row: the unit stands in a column of its own; noise against the largest of it is 0.

    >>> unit_row_table("a", Matrix(np.array([[2e-6]]), ("x",), ("low",), (("m",),))).texts()
    [['along', 'unit', 'low'], ['x', 'um', '2']]
    """
    rows: list[tuple[Content, ...]] = []
    values, units = first_design(matrix.values, 2), _entry_units(matrix)
    for name, line, unit in zip(matrix.rows, values, units, strict=True):
        alike = np.concatenate([other for other, its in zip(values, units, strict=True) if its[0] == unit[0]])
        largest = float(np.max(np.abs(alike[np.isfinite(alike)]), initial=0.0))
        form = display_unit_of(unit[0], largest)
        rows.append((Cell(name, Mark.STRONG), _unit(form), *number_cells(_zero_noise(line, largest), form)))
    return make_table(title, [first, "unit", *(Column(head) for head in heads or matrix.columns)], rows, notes=notes)


def short_names(names: tuple[str, ...]) -> tuple[str, ...]:
    """Names without the owner that all of them have in common.

    >>> short_names(("platform.x", "platform.y")), short_names(("platform.x", "chuck.x")), short_names(("B1", "B2"))
    (('x', 'y'), ('platform.x', 'chuck.x'), ('B1', 'B2'))
    """
    owners = {name.rpartition(".")[0] for name in names}
    return tuple(name.rpartition(".")[2] for name in names) if len(owners) == 1 else names


def _row_head(name: str, form: DisplayUnit) -> Cell:
    unit = _unit(form)
    return Cell(f"{name} [{unit}]" if unit else name, Mark.STRONG)


def _entries_with_units(title: str, matrix: Matrix, kept: Array, notes: tuple[str, ...]) -> Table:
    units = _entry_units(matrix)
    lines = [
        [Cell(name, Mark.STRONG), *(_with_unit(value, unit) for value, unit in zip(row, line, strict=True))]
        for name, row, line in zip(matrix.rows, kept, units, strict=True)
    ]
    return make_table(title, [Column("", numeric=False), *(Column(name) for name in matrix.columns)], lines, notes=notes)


_ENDS = ("m", "rad", "N", "N m", "K", "K/m", "V", "1")


def _ends(matrix: Matrix) -> tuple[tuple[str, ...], tuple[str, ...]] | None:
    """Units of rows and columns of which every entry's unit is the ratio; `None` if there are none."""
    units = _entry_units(matrix)
    if isinstance(matrix.unit, str):
        return None if matrix.unit != "1" else (("1",) * len(matrix.rows), ("1",) * len(matrix.columns))
    for start in _ENDS:
        columns = _drop_unknown(_denominator(start, unit) for unit in units[0])
        rows = _drop_unknown(_numerator(line[0], columns[0]) for line in units) if columns else ()
        if (len(rows), len(columns)) == (len(matrix.rows), len(matrix.columns)) and ratio_units(rows, columns) == units:
            return rows, columns
    return None


def _denominator(top: str, unit: str) -> str | None:
    return next((bottom for bottom in _ENDS if ratio_units((top,), (bottom,))[0][0] == unit), None)


def _numerator(unit: str, bottom: str) -> str | None:
    return next((top for top in _ENDS if ratio_units((top,), (bottom,))[0][0] == unit), None)


def _drop_unknown(units: Iterable[str | None]) -> tuple[str, ...]:
    return tuple(unit for unit in units if unit is not None)


def _entry_units(matrix: Matrix) -> tuple[tuple[str, ...], ...]:
    if isinstance(matrix.unit, str):
        return ((matrix.unit,) * len(matrix.columns),) * len(matrix.rows)
    return matrix.unit


def _form(unit: str, *, fine: bool) -> DisplayUnit:
    return DisplayUnit("mrad", 1e3) if unit == "rad" and not fine else preferred_unit(unit)


def _unit(form: DisplayUnit) -> str:
    return "" if form.unit == "1" else form.unit


def _entry(value: float) -> Cell:
    text = number(float(value))
    return Cell(text, _mark_of(text))


def _with_unit(value: float, unit: str) -> Cell:
    text = format_value(float(value), unit)
    bare = text.split()[0]
    return Cell(bare if bare in ("0", NO_VALUE) else text, _mark_of(bare))


def _mark_of(text: str) -> Mark:
    return Mark.FAINT if text in ("0", NO_VALUE) else Mark.PLAIN


def first_design(values: Array, axes: int) -> Array:
    """The first design of a batch: the last `axes` axes of real values.

    >>> first_design(np.ones((4, 2, 2)), 2).shape
    (2, 2)
    """
    values = np.asarray(values)
    return np.real(values[(0,) * (values.ndim - axes)])


def batch_note(values: Array, axes: int) -> tuple[str, ...]:
    """What is said under a table of a batch's first design; nothing for a single one.

    >>> batch_note(np.ones((4, 2, 2)), 2)
    ('The first of 4 designs.',)
    """
    count = int(np.prod(values.shape[: values.ndim - axes]))
    return (f"The first of {count} designs.",) if values.ndim > axes else ()
