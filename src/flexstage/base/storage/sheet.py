"""Decomposition of results into labelled matrices and sheets, for CSV, pandas, xarray, MATLAB and notebooks.

Each sheet or matrix has the path of its data in the document (`docs/json.md`). Records in a sequence or mapping are the rows of one sheet.
Nested records are the rows of another sheet, which repeats the row names of the first sheet. An array with named entries has one row per
name; any other array has one row per entry.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, is_dataclass, replace
from enum import Enum
from itertools import product
from typing import Any, TypeAlias

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.record import Field, values_of

NUMBERS = (int, float, complex, np.number, np.bool_)
_MATRIX = {"rows", "columns", "unit", "values"}

Record: TypeAlias = Mapping[Field, Any]
_Row: TypeAlias = tuple[Any, ...]


class _Sort(Enum):
    """Kind of a value that does not fit a cell: a record, or names or numbers with values."""

    MATRIX, RECORD, CELL, NAMES, NUMBERS = range(5)


@dataclass(frozen=True)
class Sheet:
    """Table of values: `names` contains the columns of row names (none for a single row), `columns` a column of values for each field."""

    names: Mapping[str, tuple[Any, ...]]
    columns: Mapping[Field, tuple[Any, ...]]

    @property
    def heads(self) -> Mapping[str, tuple[Any, ...]]:
        """All columns by heading: row names, then fields. The heading of a field is its key in the document, with the SI unit."""
        fields = {each.key: values for each, values in self.columns.items()}
        return {f"{head}_name" if head in fields else head: values for head, values in self.names.items()} | fields


_Part: TypeAlias = tuple[str, Sheet | Matrix]


def parts(result: Any) -> Iterator[_Part]:
    """Yield (path, sheet or matrix) for each part of a result or a document.

    >>> from flexstage.base.labelled import Matrix
    >>> result = dict(parts({"gain": 2.0, "modes": [{"frequency_hz": 100.0}, {"frequency_hz": 200.0}]}))
    >>> result["modes"].heads
    {'mode': (1, 2), 'frequency_hz': (100.0, 200.0)}
    """
    taken = Counter[str]()
    for path, part in [("", result)] if isinstance(result, Matrix) else _parts("", {}, [_record(result)]):
        taken[path] += 1
        yield path if taken[path] == 1 else f"{path}.{taken[path]}", part


def rows_of(source: Any) -> Sheet:
    """Return a sheet with a row for each record in a mapping or sequence; for a single record, a row for each element of its arrays."""
    if isinstance(source, Mapping):
        return Sheet(owner_names(source), _columns([_record(each) for each in source.values()]))
    if isinstance(source, Sequence):
        return Sheet({}, _columns([_record(each) for each in source]))
    return next(_rows_along({}, [_record(source)]))[1]


def owner_names(source: Any) -> dict[str, tuple[Any, ...]]:
    """Return columns with the row names of a mapping, one column for each element of its keys; empty for any other value.

    >>> owner_names({("raster", "B1"): 0, ("raster", "B2"): 0})
    {'name': ('raster', 'raster'), 'name 2': ('B1', 'B2')}
    """
    keys = [key if isinstance(key, tuple) else (key,) for key in source] if isinstance(source, Mapping) else []
    return {f"name {place}" if place > 1 else "name": names for place, names in enumerate(zip(*keys, strict=True), 1)}


def _record(value: Any) -> Record:
    return values_of(value.to_json() if hasattr(value, "to_json") else value)[0]


def _columns(records: Sequence[Record]) -> dict[Field, tuple[Any, ...]]:
    columns = {field: tuple(each.get(field) for each in records) for field in dict.fromkeys(field for each in records for field in each)}
    return {part: own for field, values in columns.items() for part, own in _split_complex(field, values)}


def _split_complex(field: Field, values: tuple[Any, ...]) -> Iterator[tuple[Field, tuple[Any, ...]]]:
    """A column, or two for complex values: real and imaginary parts."""
    if any(isinstance(each, complex) for each in values):
        for part, of in (("real", np.real), ("imaginary", np.imag)):
            yield replace(field, name=f"{field.name}_{part}"), tuple(None if each is None else of(each) for each in values)
    else:
        yield field, values


def _parts(path: str, names: Mapping[str, tuple[Any, ...]], records: Sequence[Record]) -> Iterator[_Part]:
    columns = _columns(records)
    axes = {name for field in columns for name in field.axes}
    alone = {field: values for field, values in columns.items() if not field.axes and field.name not in axes}
    cells = {field: tuple(map(plain_cell, values)) for field, values in alone.items() if all(map(is_cell, values))}
    if any(value is not None for values in cells.values() for value in values):
        yield path, Sheet(names, cells)
    for name, sheet in _rows_along(names, records):
        yield _join_path(path, name), sheet
    for field, values in alone.items():
        if field not in cells:
            there = [(*(own[index] for own in names.values()), value) for index, value in enumerate(values) if value is not None]
            yield from _inner(_join_path(path, field.key), field, tuple(names), there)


def _join_path(path: str, key: str) -> str:
    return f"{path}.{key}" if path else key


def _inner(path: str, field: Field, heads: tuple[str, ...], rows: Sequence[_Row], *, entries: bool = False) -> Iterator[_Part]:
    """Parts of a field that does not fit a cell; a row is the names of its owner and its value.

    `entries`: values of a list or mapping, with mappings as records.
    """
    groups = dict[_Sort, list[_Row]]()
    for row in rows:
        groups.setdefault(_sort(row[-1], entry=entries), []).append(row)
    for sort, alike in groups.items():
        if sort is _Sort.MATRIX:
            yield from ((".".join([path, *map(str, names)]), matrix) for *names, value in alike if (matrix := _matrix(value)) is not None)
        elif sort in (_Sort.RECORD, _Sort.CELL):
            records = [_record(row[-1]) if sort is _Sort.RECORD else {field: row[-1]} for row in alike]
            yield from _parts(path, _name_rows(heads, alike), records)
        else:
            items = [(*names, name, item) for *names, value in alike for name, item in _items(value)]
            plural = not any(is_cell(row[-1]) for row in items)
            head = field.words.removesuffix("s") if plural else "name" if sort is _Sort.NAMES else "number"
            yield from _inner(path, field, (*heads, head if head not in heads else f"{head} {len(heads) + 1}"), items, entries=True)


def _sort(value: Any, *, entry: bool) -> _Sort:
    if _matrix(value) is not None:
        return _Sort.MATRIX
    if is_cell(value):
        return _Sort.CELL
    if not isinstance(value, Mapping):
        return _Sort.RECORD if _is_record(value) else _Sort.NUMBERS
    names = all(map(is_cell, value.values())) or all(map(_is_record, value.values()))
    return _Sort.NAMES if names and not entry else _Sort.RECORD


def _name_rows(heads: Iterable[str], rows: Sequence[tuple[Any, ...]]) -> dict[str, tuple[Any, ...]]:
    return {head: tuple(row[number] for row in rows) for number, head in enumerate(heads)}


def _rows_along(names: Mapping[str, tuple[Any, ...]], records: Sequence[Record]) -> Iterator[tuple[str, Sheet]]:
    """A sheet for arrays along equal axes, with a row for each combination of names."""
    for axes in dict.fromkeys(field.axes for record in records for field in record if field.axes):
        rows, results = list[tuple[Any, ...]](), list[Record]()
        heads = tuple(_head(records[0], name) for name in axes)
        for index, record in enumerate(records):
            ends = [next(value for field, value in record.items() if field.name == name) for name in axes]
            own = {field: value for field, value in record.items() if field.axes == axes and value is not None}
            for place in product(*(range(len(end)) for end in ends)) if own else ():
                rows.append((*(each[index] for each in names.values()), *(end[at] for end, at in zip(ends, place, strict=True))))
                results.append({field: _entry(value, place) for field, value in own.items()})
        if results:
            columns = _columns(results)
            named = columns if len(axes) > 1 else [field for field in records[0] if field.name in axes]
            yield "_".join(each.key for each in named), Sheet(_name_rows((*names, *heads), rows), columns)


def _head(record: Record, name: str) -> str:
    field = next(field for field in record if field.name == name)
    return field.key if field.unit != "1" else field.words.removesuffix("s")


def _entry(value: Any, place: tuple[int, ...]) -> Any:
    if isinstance(value, np.ndarray):
        return plain_cell(value[(..., *place)])
    for at in place:
        value = value[at]
    return plain_cell(value)


def _matrix(value: Any) -> Matrix | None:
    """Matrix of a value, or of its document form."""
    if isinstance(value, Mapping) and set(value) == _MATRIX:
        unit = value["unit"] if isinstance(value["unit"], str) else tuple(map(tuple, value["unit"]))
        return Matrix(np.array(value["values"], dtype=float), tuple(value["rows"]), tuple(value["columns"]), unit)
    return value if isinstance(value, Matrix) else None


def _is_record(value: Any) -> bool:
    return isinstance(value, Mapping) or is_dataclass(value) or hasattr(value, "to_json")


def _items(value: Any) -> Iterable[tuple[Any, Any]]:
    return value.items() if isinstance(value, Mapping) else enumerate(value, 1)


def is_cell(value: Any) -> bool:
    """Return whether a value fits in a table cell: None, a number, a word, or a few words.

    >>> is_cell(None), is_cell(np.array(1.0)), is_cell(("a", "b")), is_cell(np.ones(2)), is_cell({})
    (True, True, True, False, False)
    """
    if isinstance(value, (list, tuple)):
        return all(isinstance(each, (str, Enum)) for each in value)
    return value is None or isinstance(value, (*NUMBERS, str, Enum)) or (isinstance(value, np.ndarray) and value.ndim == 0)


def plain_cell(value: Any) -> Any:
    """Return a cell as plain Python numbers and strings.

    >>> plain_cell(np.float64(2.0)), plain_cell(("a", "b"))
    (2.0, 'a, b')
    """
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, (list, tuple)) and is_cell(value):
        return ", ".join(str(plain_cell(each)) for each in value)
    return value.item() if isinstance(value, np.generic) or (isinstance(value, np.ndarray) and value.ndim == 0) else value
