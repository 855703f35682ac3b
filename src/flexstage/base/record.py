"""Records: results with annotated fields. One function (`walk`) reads the fields of a result for documents and tables.

The key of a field is its name; for a number, the SI unit is appended: `natural: Annotated[Array, FREQUENCY]` has the key `natural_hz`. For
an array, `Along` can refer to another field that names the entries of the last axis: `Annotated[Array, LENGTH, Along("actuators")]`. An
array with this annotation is written as one value per name. A property is included if its type is annotated with a quantity or `VIEW`.
Arrays without annotation, `INNER` fields and descriptions are omitted. Absent values are None; `reasons` gives the reason by field.
"""

from __future__ import annotations

import functools
import inspect
import types
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from enum import Enum
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from flexstage.base.finding import DesignError
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.base.storage.digest import Description
from flexstage.base.units.quantity import Quantity

_Kind = TypeVar("_Kind")


class Walked(Enum):
    """Annotation of a field: documents contain a `VIEW` field and omit an `INNER` field, whatever the type of the field."""

    VIEW = True
    INNER = False


VIEW, INNER = Walked.VIEW, Walked.INNER


@dataclass(frozen=True)
class Along:
    """Annotation of an array: `names` is the field of the result that contains a name for each entry of the array's last axis."""

    names: str


@dataclass(frozen=True, init=False)
class Axes:
    """Annotation of an array: `fields` are the result fields that label its last axes. Documents contain the array without labels."""

    fields: tuple[str, ...]

    def __init__(self, *fields: str) -> None:
        object.__setattr__(self, "fields", fields)


@dataclass(frozen=True)
class UnitOf:
    """Annotation of a mapping from names to numbers: `unit` returns the SI unit of a number from its name."""

    unit: Callable[[str], str]


@dataclass(frozen=True)
class UnitIn:
    """Annotation of numbers in tables: their SI units are in another `field` of the result."""

    field: str


@dataclass(frozen=True)
class Called:
    """Annotation with the `key` that replaces the field's name in documents."""

    key: str


class Mark(Enum):
    """Meaning of a cell, shown by colour, font weight or a sign."""

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
class Graded:
    """Grade of a number by its magnitude: `best` if it is at most `good`, a warning if at most `poor`, otherwise failed.

    If `good` exceeds `poor`, larger numbers are better, and `good` and `poor` are lower limits.
    """

    good: float
    poor: float = np.inf
    best: Mark = Mark.PASS

    def __call__(self, value: float) -> Mark:
        """Return the grade; an unknown number fails.

        >>> [Graded(0.02, 0.1)(value).value for value in (-0.01, 0.05, -0.2)]
        ['pass', 'warn', 'fail']
        >>> [Graded(0.9, 0.5)(value).value for value in (0.95, 0.6, 0.1)]
        ['pass', 'warn', 'fail']
        """
        good, poor = (value >= limit if self.good > self.poor else abs(value) <= limit for limit in (self.good, self.poor))
        return self.best if good else Mark.WARN if poor else Mark.FAIL


@dataclass(frozen=True)
class Heading:
    """Table format of a field, in addition to its name and quantity.

    `text` is the column heading (default: the name in words). `digits` is the number of significant digits (default: aligned decimals).
    `unit` is the display unit (default: the quantity's display unit); a ratio may be in `%`. If `varying` is true, each number is shown in
    a suitable unit. `infinite` and `absent` are the words for infinite and absent values. `mark` is a function that grades a value.
    """

    text: str = ""
    digits: int | None = None
    unit: str = ""
    varying: bool = False
    infinite: str = "inf"
    absent: str = ""
    mark: Callable[[Any], Mark] | None = None


@dataclass(frozen=True)
class Layout:
    """Table layout of a result class, in its attribute `TABLE`: title, fields in order, heading of the name column, notes.

    By default, all fields that fit in a cell are shown. A field may be a path (`requirement.key`); `INNER` fields may be shown too. Each
    column of a labelled matrix is a table column; fields without any value are omitted. Title and notes may contain attributes of the
    result, as `{self.point}`. For several results, the title uses the first result; if their notes differ, each note follows the name of
    its result. A property `notes` of the result adds notes on its values.
    """

    title: str
    fields: str = ""
    head: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Field:
    """Field of a result: name, type, annotations, and `meaning` (the first line of its docstring)."""

    name: str
    type: Any
    annotations: tuple[Any, ...]
    meaning: str = ""

    @property
    def key(self) -> str:
        """Key in documents: the name followed by the unit.

        >>> from flexstage.base.units.quantity import STIFFNESS
        >>> Field("axial", float, (STIFFNESS,)).key
        'axial_n_per_m'
        """
        called = self.annotation(Called)
        return key_with_unit(called.key if called else self.name, self.unit)

    @property
    def unit(self) -> str:
        """SI unit; `1` for a field without a quantity."""
        quantity = self.annotation(Quantity)
        return quantity.si if quantity else "1"

    @property
    def heading(self) -> Heading:
        """Table format of the field; the default heading is its name in words.

        >>> Field("blocking_force", float, (Heading(digits=4),)).heading
        Heading(text='blocking force', digits=4, unit='', varying=False, infinite='inf', absent='', mark=None)
        """
        own = self.annotation(Heading) or Heading()
        return replace(own, text=own.text or self.words)

    @property
    def words(self) -> str:
        """Name in words."""
        called = self.annotation(Called)
        return (called.key if called else self.name).replace("_", " ")

    @property
    def axes(self) -> tuple[str, ...]:
        """Names of the fields that label the last axes of the array."""
        axes = self.annotation(Axes)
        return axes.fields if axes else (self.along,) if self.along else ()

    def annotation(self, kind: type[_Kind]) -> _Kind | None:
        """Return the annotation of a kind, e.g. a quantity or a bound."""
        return next((each for each in self.annotations if isinstance(each, kind)), None)

    def of(self, record: Any) -> Any:
        """Return the value of this field in a result."""
        value = getattr(record, self.name)
        by_name = self.annotation(UnitOf)
        return (
            {key_with_unit(name, by_name.unit(name)): each for name, each in value.items()}
            if by_name is not None and isinstance(value, Mapping)
            else value
        )

    @property
    def along(self) -> str | None:
        """Name of the field that names the entries of the array's last axis; `None` if there is no such field."""
        along = self.annotation(Along)
        return along.names if along else None


def key_with_unit(name: str, unit: str) -> str:
    """Return the key of a document field: its name followed by its unit.

    >>> key_with_unit("gain", "m/V"), key_with_unit("gain", "1"), key_with_unit("mass_factor", "1/s")
    ('gain_m_per_v', 'gain', 'mass_factor_per_s')
    """
    if unit == "1":
        return name
    top, _, bottom = unit.replace(" ", "").replace("^", "").replace("(", "").replace(")", "").lower().partition("/")
    return "_".join([name, *([top] if top != "1" else []), *(["per", bottom] if bottom else [])])


@functools.cache
def result_fields(kind: type) -> Mapping[str, Field]:
    """Return all fields of a result class by name, then its properties, including those shown only in tables."""
    hints = get_type_hints(kind, include_extras=True)
    own = [(each.name, hints[each.name], "") for each in fields(kind)]
    return {name: Field(name, *_unwrap(hint), doc) for name, hint, doc in (*own, *_properties(kind))}


@functools.cache
def walked_fields(kind: type) -> tuple[Field, ...]:
    """Return the fields of a result class that documents contain: its dataclass fields, then its annotated properties."""
    own = {each.name for each in fields(kind)}
    result = {name: each for name, each in result_fields(kind).items() if name != "reasons"}
    return tuple(
        each
        for name, each in result.items()
        if (_is_walked(each.type, each.annotations) if name in own else each.annotations and INNER not in each.annotations)
    )


def field_of(kind: type, path: str) -> Field:
    """Return a field of a result class by its name, or by its path through nested results.

    By default, a nested field has the quantity and heading of the field that contains it.

    >>> field_of(Field, "heading.digits").heading.text
    'digits'
    """
    name, _, rest = path.partition(".")
    field = result_fields(kind)[name]
    if not rest:
        return field
    inner = field_of(next(part for part in (*get_args(field.type), field.type) if isinstance(part, type)), rest)
    heading = inner.annotation(Heading) or field.annotation(Heading) or Heading()
    annotations = (replace(heading, text=heading.text or inner.words), *inner.annotations, *field.annotations)
    return replace(inner, name=path, annotations=annotations)


def field_at(record: Any, path: str) -> tuple[Field, Any]:
    """Return a field of a result (see `field_of`) and its value; the value is None if any result on the path is absent.

    >>> field_at(Field("mass", float, ()), "heading.text")[1]
    'mass'
    """
    field = field_of(type(record), path)
    for name in path.split("."):
        record = None if record is None or name in getattr(record, "reasons", ()) else getattr(record, name)
    return field, record


def _unwrap(hint: Any) -> tuple[Any, tuple[Any, ...]]:
    """A type and its annotations."""
    return get_args(hint)[0] if get_origin(hint) is Annotated else hint, getattr(hint, "__metadata__", ())


def _is_walked(kind: Any, annotations: tuple[Any, ...]) -> bool:
    if any(not isinstance(each, (Axes, Heading)) for each in annotations):
        return INNER not in annotations
    return not any(part == Array or (isinstance(part, type) and issubclass(part, Description)) for part in _parts(kind))


def _parts(kind: Any) -> Iterator[Any]:
    """A type and its component types."""
    yield kind
    if kind != Array:
        for part in get_args(kind):
            yield from _parts(part)


def _properties(kind: type) -> Iterator[tuple[str, Any, str]]:
    for base in reversed(kind.__mro__):
        for name, each in vars(base).items():
            function = each.fget if isinstance(each, property) else each.func if isinstance(each, functools.cached_property) else None
            if function is not None and name != "reasons":
                yield name, get_type_hints(function, include_extras=True).get("return"), (inspect.getdoc(function) or "").split("\n")[0]


def walk(record: Any) -> dict[str, Any]:
    """Return the fields of a result as a mapping, with the `reasons` for absent values; nested results are not converted."""
    values, reasons = values_of(record)
    named, result = {each.along for each in values}, dict[str, Any]()
    for each, value in values.items():
        if each.along is None:
            result[each.key] = {name: {} for name in value or ()} if each.name in named else value
        elif value is not None:
            for under, item in zip(result[each.along].values(), by_name(value), strict=True):
                under[each.key] = item
    keys = {each.name: each.key for each in values}
    return result | ({"reasons": {keys.get(name, name): reason for name, reason in reasons.items()}} if reasons else {})


@dataclass(frozen=True)
class SideBySide:
    """Several results, or mappings of results, in one document."""

    results: tuple[Any, ...]


def values_of(record: Any) -> tuple[dict[Field, Any], dict[str, str]]:
    """Return the values of all document fields of a result, and the reasons for absent values by field name.

    For a mapping, each key except `reasons` becomes a field without annotations.
    """
    if isinstance(record, SideBySide):
        values, why = dict[Field, Any](), dict[str, str]()
        for each in record.results:
            own, absent = values_of(each)
            values, why = values | own, why | absent
        return values, why
    if isinstance(record, Mapping):
        return {Field(str(key), object, ()): value for key, value in record.items() if key != "reasons"}, dict(record.get("reasons") or {})
    reasons, result = dict(getattr(record, "reasons", {})), dict[Field, Any]()
    for each in walked_fields(type(record)):
        try:
            result[each] = None if each.name in reasons else each.of(record)
        except DesignError as error:
            result[each], reasons[each.name] = None, str(error)
    return result, reasons


def by_name(value: Any) -> Any:
    """Return the values of a field along its last axis, one item per name."""
    return np.moveaxis(value, -1, 0) if isinstance(value, np.ndarray) else value


def paths(kind: type, before: str = "") -> Iterator[tuple[str, str, str]]:
    """Yield (path, kind, explanation) of all document fields of a result class, including nested results."""
    kinds = walked_fields(kind)
    named = {each.along for each in kinds}
    for each in kinds:
        if each.name not in named:
            under = "" if each.along is None else f"{each.along}.<name>."
            yield from _field_paths(each, before + under + each.key)


def _field_paths(each: Field, path: str) -> Iterator[tuple[str, str, str]]:
    inner: Any = each.type
    form = ""
    if get_origin(inner) in (Union, types.UnionType):
        inner = next(part for part in get_args(inner) if part is not type(None))
    if get_origin(inner) is tuple and get_args(inner)[-1] is Ellipsis:
        inner, form = get_args(inner)[0], "[]" if each.along is None else ""
    elif get_origin(inner) is Mapping:
        inner, form = get_args(inner)[1], ".<name>"
    if is_dataclass(inner) and isinstance(inner, type) and not hasattr(inner, "to_json"):
        yield path + form, "", f"{each.meaning} {explanation(inner)}".strip()
        yield from paths(inner, f"{path}{form}.")
        return
    yield path + form, f"number, {each.unit}" if each.unit != "1" else _word(inner), each.meaning


def _word(kind: Any) -> str:
    words: dict[Any, str] = {Matrix: "matrix", str: "text", bool: "true or false", Array: "numbers"}
    words |= {int: "number", float: "number", complex: "[real, imaginary]"}
    if isinstance(kind, type) and issubclass(kind, Enum):
        return ", ".join(str(each.value) for each in kind)
    if get_origin(kind) is tuple:
        return "numbers" if {int, float} & {*get_args(kind)} else "texts"
    return words.get(kind, "")


def explanation(kind: type) -> str:
    """Return the docstring of a class as one line, without its example."""
    return " ".join((inspect.getdoc(kind) or "").partition(">>>")[0].split())
