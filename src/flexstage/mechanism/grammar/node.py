"""Grammar nodes of single values: number, vector, direction, matrix, string, choice.

Each node class has the operations `read` and `write` for files, `schema` for editors, and `members` and `numbers` for addresses and checks.
The operation `parse` reads the string of an assignment.
"""

from __future__ import annotations

import inspect
import itertools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any, ClassVar

import numpy as np

from flexstage.base.finding import DesignError, Finding, list_choices, refuse, require, suggest_nearest
from flexstage.base.units.expression import UnknownAmountError
from flexstage.base.units.quantity import (
    COMPLIANCE,
    COUPLING,
    COUPLING_STIFFNESS,
    DIRECTION,
    DIRECTIONS,
    RATIO,
    ROTATIONAL_COMPLIANCE,
    ROTATIONAL_STIFFNESS,
    STIFFNESS,
    Bound,
    Quantity,
)
from flexstage.base.units.unit import convert, example, missing_unit, parse, quantity_of_unit, show
from flexstage.mechanism.grammar.formulas import Numbers, formula_value, is_formula
from flexstage.spatial.frame import COMPONENTS

MOST_FINDINGS = 100
LARGEST = 1e40
"""Largest accepted number in SI; its reciprocal is the least nonzero number. Powers of larger numbers would exceed the range of floats."""

_NUMBER = r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?"
_WITH_UNIT = rf"^(?![0-9.eE+-]*$){_NUMBER}(\s*[A-Za-zµμ°%/(].*|\s+1/.*)$"
_UNIT = r"(\s*[A-Za-zµμ°%/(]|\s+1/)[A-Za-zµμ°%0-9^./() ]*"
_OPERAND = rf"(-|\(|(sqrt|sin|cos|tan)\s*\(|\s)*([A-Za-z]\w*|{_NUMBER.removeprefix('[+-]?')}({_UNIT})?)[)\s]*"
_FORMULA = rf"^(?![0-9.eE+-]*$){_OPERAND}([-+*/]{_OPERAND})*$"


class Bad:
    """Marker for a value that cannot be read and whose error is already reported."""


BAD = Bad()


class EnoughError(Exception):
    """Exception that stops reading after too many errors."""


@dataclass
class Reader:
    """Data collected while a file is read: errors, tags by address, and sources of catalogue entries.

    If `tagged`, tables may have tags; otherwise, `tags` is an ordinary name. `numbers` are the named numbers for formulas (None: formulas
    are not allowed). `formulas` contains the formulas that were read, by address. `bounds` contains the errors for numbers outside their
    bounds; they are reported when the description is checked.
    """

    tagged: bool = True
    findings: list[Finding] = field(default_factory=list)
    tags: dict[str, str] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)
    numbers: Numbers | None = None
    formulas: dict[str, str] = field(default_factory=dict)
    bounds: list[Finding] = field(default_factory=list)

    def read(self, node: Node, raw: Any, where: str) -> Any:
        """Return the value of `raw` as read by a `node`; `BAD` after an error."""
        try:
            return node.read(raw, where, self)
        except DesignError as error:
            return self.note(error.findings)

    def formula(self, text: str, quantity: Quantity, where: str) -> Any:
        """Store a formula and return its value; `BAD` if one of its named numbers could not be read."""
        scope = self.numbers.scope if self.numbers is not None else {}
        try:
            value = formula_value(text, quantity, scope, where)
        except UnknownAmountError:
            return BAD
        self.formulas[where] = text
        return value

    def refuse(self, where: str, what: str, advice: str) -> Bad:
        """Report an error."""
        return self.note([Finding(where, what, advice)])

    def note(self, findings: Iterable[Finding]) -> Bad:
        """Report errors; stop reading after a maximum number."""
        self.findings += findings
        if len(self.findings) >= MOST_FINDINGS:
            raise EnoughError
        return BAD


@dataclass
class Writer:
    """Data collected while a file is written: errors, and formulas by address. A value with a formula is written as the formula."""

    findings: list[Finding] = field(default_factory=list)
    formulas: Mapping[str, str] = field(default_factory=dict)

    def has_formula(self, where: str) -> bool:
        """Return whether a value or one of its members has a formula."""
        return any(key == where or key.startswith(f"{where}.") for key in self.formulas)

    def write(self, node: Node, value: Any, where: str) -> Any:
        """Return a value as a file contains it; `None` after an error."""
        try:
            return node.write(value, where, self)
        except DesignError as error:
            self.findings += error.findings
            return None


@dataclass
class Definitions:
    """Schemas of classes by name, for schema references. If `tagged`, tables may have tags; if `formulas`, numbers may be formulas."""

    tagged: bool = True
    formulas: bool = False
    known: dict[str, Any] = field(default_factory=dict)


class Node:
    """Kind of a value, with default operations for files, addresses and checks."""

    single: ClassVar[bool] = False
    """Whether a single string can specify the value, as in an assignment."""
    components: ClassVar[bool] = False
    """Whether the members have the names x, y, z, rx, ry, rz."""
    shown: ClassVar[str] = "{ ... }"

    @property
    def example(self) -> str:
        """Example as written in a file."""
        return self.shown

    @property
    def measures(self) -> Quantity | None:
        """Quantity of the number, or of each component; `None` for other kinds."""
        return None

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return the value that a file contains as `raw`; `BAD` after an error. May raise `DesignError`."""
        raise NotImplementedError

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Return a value as a file contains it; raises `DesignError` if files cannot contain it."""
        return value

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the JSON Schema of the value in a file."""
        raise NotImplementedError

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield name, node and value of each member."""
        return iter(())

    def child(self, value: Any, name: str) -> Node:
        """Return the node of the member with this name (see `path.member`); `value` selects an alternative."""
        raise KeyError(name)

    def key(self, value: Any, name: str) -> Any:
        """Return the key of a member in a file."""
        return COMPONENTS.index(name) if self.components else name

    def field_called(self, value: Any, key: str) -> str:
        """Return the field for a key of a file; the key may be the name of an alternative (`polar` for the field `pattern`)."""
        return key

    def parse(self, text: str, where: str) -> Any:
        """Return the value of an assignment's string (`1.4 mm`, `x`, `steel`); raises `DesignError` at `where`."""
        if not self.single:
            raise refuse(where, "it has several values", "Set one of them, e.g. its x")
        reader = Reader()
        value = reader.read(self, text, where)
        require(reader.findings)
        return value

    def numbers(self, value: Any, where: str = "") -> Iterator[tuple[str, Any, NumberNode]]:
        """Yield address, value and node of every number in a value; directions and absent values are omitted."""
        if value is not None:
            for name, inner, item in self.members(value):
                yield from inner.numbers(item, join(where, name))


@dataclass(frozen=True)
class NumberNode(Node):
    """Number of a quantity, within a bound. If `zero`, the value zero is written without a unit, e.g. in a matrix."""

    quantity: Quantity
    bound: Bound | None = None
    zero: bool = False
    single: ClassVar[bool] = True

    @property
    def measures(self) -> Quantity:
        """Quantity of the number."""
        return self.quantity

    @property
    def example(self) -> str:
        """Example as written in a file."""
        return self.quantity.example if self.quantity is RATIO else f'"{self.quantity.example}"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return the number in SI, or the value of a formula."""
        scope = {} if reader.numbers is None else reader.numbers.scope
        try:
            value = self.si(raw, where)
        except DesignError:
            if not isinstance(raw, str) or reader.numbers is None or not is_formula(raw, scope):
                raise
            value = reader.formula(raw, self.quantity, where)
        else:
            if isinstance(raw, str) and any(name in raw for name in scope):
                formula_value(raw, self.quantity, scope, where)  # raises if a named number is meant by the unit
        if value is not BAD:
            reader.bounds += number_findings(where, value, self)
        return value

    def si(self, raw: Any, where: str) -> float:
        """Return the number of a file value in SI; raises `DesignError` at `where` if it is invalid."""
        if is_bare(raw) and raw == 0:
            return float(raw)
        if isinstance(raw, str):
            return parse(raw, self.quantity, where=where)
        if not is_bare(raw):
            raise refuse(where, f"must be {self.quantity.noun} (got {kind(raw)})", f"Use e.g. {example(self.quantity)}")
        if self.quantity is not RATIO:
            raise missing_unit(raw, self.quantity, where=where)
        return _float(raw, where)

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Return the formula, or the shortest string that is read back to the same bits. A ratio without formula is a number."""
        require_single(value, where)
        if where in writer.formulas:
            return writer.formulas[where]
        if self.zero and str(value) == "0.0":
            return 0
        return value if self.quantity is RATIO else show(value, self.quantity)

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a JSON string with a unit, with an example."""
        said = f", {self.bound.text()}" if self.bound and self.bound.text() else ""
        text = {"type": "string", "pattern": _WITH_UNIT}
        description = {"description": f"{self.quantity.name}{said}", "examples": [self.quantity.example]}
        texts = [text, {"type": "string", "pattern": _FORMULA}] if definitions.formulas else [text]
        texts = [{"enum": [0, "0"]}, *texts]
        if self.quantity is not RATIO:
            return {"anyOf": texts} | description
        return {"anyOf": [{"type": "number", **_limits(self.bound)}, *texts]} | description | {"examples": [float(self.quantity.example)]}

    def numbers(self, value: Any, where: str = "") -> Iterator[tuple[str, Any, NumberNode]]:
        """Yield this number."""
        if value is not None:
            yield where, value, self


def first_failing(failing: Any, *values: Any) -> tuple[str, tuple[Any, ...]]:
    """Return the index of the first failing design of a batch (`" at index 3"`, empty for one design), and its values.

    >>> first_failing(np.array([False, True]), np.array([1.0, 2.0]), 3.0)
    (' at index 1', (2.0, 3.0))
    """
    shape = np.shape(failing)
    index = tuple(int(axis) for axis in np.argwhere(failing)[0]) if shape else ()
    picked = tuple(float(np.broadcast_to(np.real(value), shape)[index]) for value in values)
    return (f" at index {', '.join(map(str, index))}" if shape else ""), picked


def number_findings(where: str, value: Any, node: NumberNode) -> Iterator[Finding]:
    """Return errors of a number: an implausible size, or a value outside the bound of its node.

    >>> from flexstage.base.units.quantity import FREQUENCY, POSITIVE
    >>> print(*number_findings("rate", 0.0, NumberNode(FREQUENCY, POSITIVE)))
    rate: must be greater than 0 Hz (got 0 Hz). Use e.g. "4 kHz".
    >>> print(*number_findings("peak", 0.5, NumberNode(RATIO, Bound(1.0, open_low=True))))
    peak: must be greater than 1 (got 0.5). Use a number greater than 1.
    """
    hint, real = f"Use e.g. {example(node.quantity)}", np.real(value)
    size = np.abs(real)
    extreme = (size > LARGEST) | ((size < 1.0 / LARGEST) & (size > 0.0))
    if np.any(extreme):
        at, (result,) = first_failing(extreme, real)
        told = show(result, node.quantity, digits=6)
        yield Finding(f"{where}{at}", f"implausible size (got {told})", "Check the exponent and the unit")
        return
    bound = node.bound
    if bound is not None and np.any(outside := _outside(real, bound)):
        at, (result,) = first_failing(outside, real)
        fits = node.quantity is not RATIO or not _outside(parse(RATIO.example, RATIO), bound)
        limits = replace(bound, **{name: float(convert(getattr(bound, name), node.quantity)) for name in ("low", "high")})
        text = limits.text() if node.quantity.shown == "1" else f"{limits.text()} {node.quantity.shown}"
        advice = hint if fits else f"Use a number {text}"
        yield Finding(f"{where}{at}", f"must be {text} (got {show(result, node.quantity, digits=6)})", advice)


def _outside(real: Any, bound: Bound) -> Any:
    low = real <= bound.low if bound.open_low else real < bound.low
    high = real >= bound.high if bound.open_high else real > bound.high
    return low | high


@dataclass(frozen=True)
class NamedNode(Node):
    """Named number of any quantity; its unit determines the quantity."""

    single: ClassVar[bool] = True
    shown: ClassVar[str] = '"26 mm"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return the number with this name, which was read before all other values."""
        return reader.numbers.values.get(where.partition(".")[2], BAD) if reader.numbers is not None else BAD

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Return the formula, or the shortest string in the number's unit that is read back to the same bits."""
        return self.child(value, "value").write(value.value, where, writer)

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a number, a string with a unit, or a formula."""
        texts = [{"type": "string", "pattern": pattern} for pattern in (_WITH_UNIT, _FORMULA)]
        said = 'named number for formulas: "26 mm", a ratio, or a formula of other named numbers, "arm / 2"'
        return {"anyOf": [{"type": "number"}, *texts], "description": said}

    def child(self, value: Any, name: str) -> NumberNode:
        """Return the node of the number's value."""
        return NumberNode(quantity_of_unit(value.unit))

    def numbers(self, value: Any, where: str = "") -> Iterator[tuple[str, Any, NumberNode]]:
        """Yield the value of the number."""
        yield where, value.value, self.child(value, "value")


class RowNode(Node):
    """Row of values in square brackets."""

    length: int | None
    """Required number of values (None: any)."""

    def parts(self, row: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield address, node and value of each element of a row."""
        raise NotImplementedError

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return a tuple with the value of each element."""
        if not isinstance(raw, list) or self.length not in (None, len(raw)):
            count = "several values" if self.length is None else f"{self.length} values"
            return reader.refuse(where, f"must be {count} (got {kind(raw)})", f"Write them in brackets: {self.example}")
        return every([reader.read(node, part, join(where, name) if name else where) for name, node, part in self.parts(raw)])

    def write(self, value: Any, where: str, writer: Writer) -> list[Any]:
        """Return a list of the elements as a file contains them."""
        return [writer.write(node, part, join(where, name) if name else where) for name, node, part in self.parts(value)]

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the elements."""
        return self.parts(value)


@dataclass(frozen=True)
class VectorNode(RowNode):
    """Vector with the components x, y, z, ...; or the rows of a matrix."""

    items: tuple[Node, ...]
    components: ClassVar[bool] = True

    @property
    def measures(self) -> Quantity | None:
        """Quantity of the first component."""
        return self.items[0].measures

    @property
    def example(self) -> str:
        """Example as written in a file."""
        return f"[{', '.join(item.example for item in self.items)}]"

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a JSON array of strings."""
        return row_schema([item.schema(definitions) for item in self.items])

    @property
    def length(self) -> int:  # type: ignore[override]
        """Number of components."""
        return len(self.items)

    def parts(self, row: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the components."""
        return zip(COMPONENTS, self.items, row, strict=False)

    def child(self, value: Any, name: str) -> Node:
        """Return the node of a component."""
        return self.items[COMPONENTS.index(name)]


@dataclass(frozen=True)
class DirectionNode(VectorNode):
    """Direction: a vector with three components, of any length."""

    items: tuple[Node, ...] = (NumberNode(RATIO),) * 3
    single: ClassVar[bool] = True

    @property
    def example(self) -> str:
        """Example as written in a file: a direction by name."""
        return '"x"'

    @property
    def measures(self) -> Quantity:
        """Quantity of the components: a direction."""
        return DIRECTION

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return the direction specified by a name or by three numbers without units."""
        if isinstance(raw, str) and raw in DIRECTIONS:
            return DIRECTIONS[raw]
        if not isinstance(raw, list) or len(raw) != 3:
            advice = f"Write one of {', '.join(DIRECTIONS)}, or three numbers without units"
            return reader.refuse(where, f"must be a direction (got {kind(raw)})", advice)
        return super().read(raw, where, reader)

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Return the name of the direction, or its components."""
        name = next((name for name, direction in DIRECTIONS.items() if repr(direction) == repr(value)), None)
        return super().write(value, where, writer) if name is None or writer.has_formula(where) else name

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a name or three numbers."""
        return {"oneOf": [{"enum": list(DIRECTIONS)}, super().schema(definitions)]}

    def numbers(self, value: Any, where: str = "") -> Iterator[tuple[str, Any, NumberNode]]:
        """Yield nothing: the components of a direction do not vary individually."""
        return iter(())


def _rows(*quantities: Quantity) -> tuple[VectorNode, ...]:
    """Rows of a 6x6 of quantities: translational, coupling and rotational entries."""
    entries = [NumberNode(quantity, zero=True) for quantity in quantities]
    return tuple(VectorNode(tuple(entries[(row > 2) + (column > 2)] for column in range(6))) for row in range(6))


@dataclass(frozen=True)
class MatrixNode(VectorNode):
    """Symmetric 6x6 matrix of the quantity `name`. Files and overrides specify the whole matrix or single entries.

    >>> COMPLIANCES.child(None, "x").child(None, "rz").quantity.name, COMPLIANCES.child(None, "rx").child(None, "rx").quantity.name
    ('coupling compliance', 'rotational compliance')
    """

    name: str

    @property
    def measures(self) -> None:
        """There is no common quantity, because the entries have several quantities."""

    @property
    def example(self) -> str:
        """Example as written in a file."""
        return f"[{self.items[0].example}, ...]"

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a 6x6 matrix with six rows."""
        said = f"6x6 {self.name} about the centre, rows x, y, z, rx, ry, rz; zeros have no unit"
        return super().schema(definitions) | {"description": said}

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the entries on and above the diagonal."""
        for row, column in itertools.combinations_with_replacement(range(6), 2):
            name = COMPONENTS[column]
            yield f"{COMPONENTS[row]}.{name}", self.items[row].child(None, name), value[row][column]


COMPLIANCES = MatrixNode(_rows(COMPLIANCE, COUPLING, ROTATIONAL_COMPLIANCE), "compliance")
STIFFNESSES = MatrixNode(_rows(STIFFNESS, COUPLING_STIFFNESS, ROTATIONAL_STIFFNESS), "stiffness")


@dataclass(frozen=True)
class WholeNode(Node):
    """A whole number without unit, within a bound."""

    bound: Bound | None = None
    shown: ClassVar[str] = "1"

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return an integer of at most 64 bits."""
        if not isinstance(raw, int) or isinstance(raw, bool) or abs(raw) >= 2**63:
            return reader.refuse(where, f"must be a whole number (got {kind(raw)})", "Remove the quotes or the fraction")
        if self.bound is not None and not self.bound.low <= raw <= self.bound.high:
            return reader.refuse(where, f"must be {self.bound.whole()} (got {kind(raw)})", f"Use e.g. {self.bound.low:g}")
        return raw

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of an integer."""
        return {"type": "integer", **_limits(self.bound)}


@dataclass(frozen=True)
class FlagNode(Node):
    """Boolean: true or false."""

    shown: ClassVar[str] = "true"

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return true or false."""
        return raw if isinstance(raw, bool) else reader.refuse(where, f"must be a boolean (got {kind(raw)})", "Use true or false")

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a boolean."""
        return {"type": "boolean"}


@dataclass(frozen=True)
class TextNode(Node):
    """String: a name or a remark."""

    single: ClassVar[bool] = True
    shown: ClassVar[str] = '"a name"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return the string."""
        return raw if isinstance(raw, str) else reader.refuse(where, f"must be a string (got {kind(raw)})", "Put it in quotes")

    def write(self, value: Any, where: str, writer: Writer) -> str:
        """Return the string."""
        return whole_text(value, where)

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a string."""
        return {"type": "string"}


@dataclass(frozen=True)
class ChoiceNode(Node):
    """One of several words: a member of an enumeration."""

    choices: type[Enum]
    only: tuple[Enum, ...] = ()
    """Allowed members of the enumeration, if not all are allowed."""
    single: ClassVar[bool] = True

    @property
    def words(self) -> dict[str, Enum]:
        """Allowed members by their names in files."""
        return {str(choice.value): choice for choice in self.only or self.choices}

    @property
    def example(self) -> str:
        """Example as written in a file."""
        return f'"{next(iter(self.words))}"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return the member with this name."""
        if isinstance(raw, str) and raw in self.words:
            return self.words[raw]
        return reader.refuse(
            where,
            f"unknown value (got {kind(raw)})",
            suggest_nearest(kind(raw).strip('"'), self.words, otherwise=f"Use {list_choices(list(self.words))}"),
        )

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Return the name of the member."""
        return value.value

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of the allowed names."""
        return {"enum": list(self.words), "description": meaning(self.choices)}


@dataclass(frozen=True)
class AmountNode(Node):
    """String with a number and its unit, or a percentage; another field of the file determines the quantity."""

    shown: ClassVar[str] = '"1.4 mm"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return the string or the number unchanged."""
        if isinstance(raw, str) or is_bare(raw):
            return raw
        return reader.refuse(where, f"must be a number with its unit (got {kind(raw)})", f"Use e.g. {self.shown}")

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a string with a unit, or a number."""
        return {"anyOf": [{"type": "number"}, {"type": "string", "pattern": _WITH_UNIT}], "description": "number with unit, or in percent"}


@dataclass(frozen=True)
class TextsNode(Node):
    """One string, or a list of strings."""

    shown: ClassVar[str] = '["a name", "another"]'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return a tuple of the strings."""
        texts = [raw] if isinstance(raw, str) else raw
        if not isinstance(texts, list) or not texts:
            return reader.refuse(where, f"must be one or several strings (got {kind(raw)})", "Put each in quotes, several in brackets")
        return every([reader.read(TextNode(), text, where) for text in texts])

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a string, or of an array of strings."""
        return {"oneOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}]}


# --- common functions of nodes ---


def join(where: str, name: str) -> str:
    """Return the address of a member: the address `where`, a dot, and the name."""
    return f"{where}.{name}" if where else name


def kind(raw: Any) -> str:
    """Describe a file's value in a few words.

    >>> kind([1, 2]), kind({}), kind("steel")
    ('2 values in brackets', 'a table', '"steel"')
    """
    if isinstance(raw, bool):
        return str(raw).lower()
    if isinstance(raw, int) and raw.bit_length() > 128:
        return "a number of many digits"
    if isinstance(raw, dict):
        return "a table"
    if isinstance(raw, list):
        return f"{len(raw)} values in brackets"
    return f'"{short(raw)}"' if isinstance(raw, str) else short(raw)


def short(raw: Any) -> str:
    """Return a file's value as a string, truncated if it is long."""
    text = str(raw)
    return text if len(text) <= 40 else f"{text[:40]}..."


def every(items: list[Any]) -> Any:
    """Return the items; `BAD` if any item could not be read."""
    return BAD if any(item is BAD for item in items) else tuple(items)


def row_schema(items: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the schema of a list whose elements have the schemas `items`."""
    return {"type": "array", "prefixItems": items, "items": False, "minItems": len(items)}


def meaning(record: type) -> str:
    """Return the description of a class: its docstring on one line, without examples."""
    return " ".join((inspect.getdoc(record) or "").partition("\n\n>>>")[0].split())


def whole_text(value: str, where: str) -> str:
    """Return the string unchanged; raises `DesignError` at `where` if a file cannot contain it."""
    try:
        value.encode()
    except UnicodeEncodeError:
        raise refuse(where, "the string contains an incomplete character (a lone surrogate)", "Rewrite it") from None
    return value


def require_single(value: Any, where: str) -> None:
    """Raise `DesignError` at `where` for a number that a file cannot contain: an array or a complex number."""
    if not isinstance(value, (int, float)):
        raise refuse(where, "batches and complex numbers are not allowed in files", "Select one design before writing it")


def is_bare(raw: Any) -> bool:
    """Return whether a file's value is a number without unit."""
    return isinstance(raw, (int, float)) and not isinstance(raw, bool)


def _float(raw: float, where: str) -> float:
    try:
        value = float(raw)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise refuse(where, f"must be finite (got {kind(raw)})", "Use a finite number")
    return value


def _limits(bound: Bound | None) -> dict[str, float]:
    if bound is None:
        return {}
    low = {"exclusiveMinimum" if bound.open_low else "minimum": bound.low} if bound.low != float("-inf") else {}
    high = {"exclusiveMaximum" if bound.open_high else "maximum": bound.high} if bound.high != float("inf") else {}
    return low | high
