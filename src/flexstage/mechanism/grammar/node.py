"""Nodes of the grammar that hold one value: a number, a vector, a direction, a matrix, a text, a choice.

What can be done with a kind of node stands in its class: `read` what a file has, `write` it, its `schema`, `check` the kind of a value,
walk its `members`, `parse` the text of an assignment.
"""

from __future__ import annotations

import inspect
import itertools
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, ClassVar

from flexstage.base.finding import DesignError, Finding, refuse, require
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
from flexstage.base.units.unit import parse, quantity_of_unit, show
from flexstage.mechanism.grammar.formulas import Numbers, formula_value, is_formula
from flexstage.spatial.frame import COMPONENTS

MOST_FINDINGS = 100

_NUMBER = r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?"
_WITH_UNIT = rf"^(?![0-9.eE+-]*$){_NUMBER}(\s*[A-Za-zµμ°%/(].*|\s+1/.*)$"
_UNIT = r"(\s*[A-Za-zµμ°%/(]|\s+1/)[A-Za-zµμ°%0-9^./() ]*"
_OPERAND = rf"(-|\(|(sqrt|sin|cos|tan)\s*\(|\s)*([A-Za-z]\w*|{_NUMBER.removeprefix('[+-]?')}({_UNIT})?)[)\s]*"
_FORMULA = rf"^(?![0-9.eE+-]*$){_OPERAND}([-+*/]{_OPERAND})*$"


class Bad:
    """Marks a value that could not be read; a finding says why."""


BAD = Bad()


class EnoughError(Exception):
    """There are so many findings that reading on is of no use."""


@dataclass
class Reader:
    """Gathers what reading finds: findings, tags by address, and sources that catalogue entries bring along.

    `tagged`: tables may have tags; otherwise that is a name as any other. `numbers` are those that formulas may refer to, `formulas` those
    that were found, by address; without `numbers` there are none.
    """

    tagged: bool = True
    findings: list[Finding] = field(default_factory=list)
    tags: dict[str, str] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)
    numbers: Numbers | None = None
    formulas: dict[str, str] = field(default_factory=dict)

    def read(self, node: Node, raw: Any, where: str) -> Any:
        """The value that `raw` means as a `node`; `BAD` after a finding."""
        try:
            return node.read(raw, where, self)
        except DesignError as error:
            return self.note(error.findings)

    def formula(self, text: str, quantity: Quantity, where: str) -> Any:
        """The value of a formula, which is noted; `BAD` where a number it refers to could not be read."""
        scope = self.numbers.scope if self.numbers is not None else {}
        try:
            value = formula_value(text, quantity, scope, where)
        except UnknownAmountError:
            return BAD
        self.formulas[where] = text
        return value

    def refuse(self, where: str, what: str, advice: str) -> Bad:
        """Note a finding."""
        return self.note([Finding(where, what, advice)])

    def note(self, findings: Iterable[Finding]) -> Bad:
        """Note findings, up to a number that is of use to anybody."""
        self.findings += findings
        if len(self.findings) >= MOST_FINDINGS:
            raise EnoughError
        return BAD


@dataclass
class Writer:
    """Gathers what writing finds. What has a formula, by address, is written as that."""

    findings: list[Finding] = field(default_factory=list)
    formulas: Mapping[str, str] = field(default_factory=dict)

    def has_formula(self, where: str) -> bool:
        """Whether a value, or anything it holds, has one."""
        return any(key == where or key.startswith(f"{where}.") for key in self.formulas)

    def write(self, node: Node, value: Any, where: str) -> Any:
        """The form of a value in a file; `None` after a finding."""
        try:
            return node.write(value, where, self)
        except DesignError as error:
            self.findings += error.findings
            return None


@dataclass
class Definitions:
    """The schemas of classes by name, which others refer to, and the catalogue that `like` may name entries of.

    `tagged`: tables may have tags. `formulas`: numbers may be formulas.
    """

    tagged: bool = True
    formulas: bool = False
    known: dict[str, Any] = field(default_factory=dict)


class Node:
    """A kind of value. What a kind does not say of itself is said here."""

    single: ClassVar[bool] = False
    """Whether one text means it, as an assignment needs it."""
    components: ClassVar[bool] = False
    """Whether its members are told apart as x, y, z, rx, ry, rz."""
    shown: ClassVar[str] = "{ ... }"

    @property
    def example(self) -> str:
        """A text as it may stand in a file."""
        return self.shown

    @property
    def measures(self) -> Quantity | None:
        """What its number, or each of its components, is a number of."""
        return None

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """The value that `raw` means; `BAD` after a finding. May raise `DesignError`."""
        raise NotImplementedError

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """The form of a value in a file; raises `DesignError` for what has none."""
        raise NotImplementedError

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """The JSON Schema of what may stand in a file."""
        raise NotImplementedError

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Name, node and value of what a value holds."""
        return iter(())

    def child(self, value: Any, name: str) -> Node:
        """The node of the member of that name (see `path.member`); `value` decides between alternatives."""
        raise KeyError(name)

    def key(self, value: Any, name: str) -> Any:
        """What a member is called in a file."""
        return COMPONENTS.index(name) if self.components else name

    def field_called(self, value: Any, key: str) -> str:
        """The field that a file calls so by what it holds (`polar` for `pattern`); otherwise the key itself."""
        return key

    def parse(self, text: str, where: str) -> Any:
        """The value that the text of an assignment means (`1.4 mm`, `x`, `steel`); raises `DesignError` at `where`."""
        if not self.single:
            raise refuse(where, "it has several values", "Set one of them, for example its x")
        reader = Reader()
        value = reader.read(self, text, where)
        require(reader.findings)
        return value

    def numbers(self, value: Any, where: str = "") -> Iterator[tuple[str, Any, NumberNode]]:
        """Address, value and node of every number of a value; directions, absent values and changes are left out."""
        if value is not None:
            for name, inner, item in self.members(value):
                yield from inner.numbers(item, join(where, name))


@dataclass(frozen=True)
class NumberNode(Node):
    """A number of a quantity, within a bound. `zero`: zero is written without a unit, as in a matrix."""

    quantity: Quantity
    bound: Bound | None = None
    zero: bool = False
    single: ClassVar[bool] = True

    @property
    def measures(self) -> Quantity:
        """Its quantity."""
        return self.quantity

    @property
    def example(self) -> str:
        """A text as it may stand in a file."""
        return self.quantity.example if self.quantity is RATIO else f'"{self.quantity.example}"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """The number in SI, or what a formula gives."""
        scope = {} if reader.numbers is None else reader.numbers.scope
        try:
            value = self.si(raw, where)
        except DesignError:
            if not isinstance(raw, str) or reader.numbers is None or not is_formula(raw, scope):
                raise
            return reader.formula(raw, self.quantity, where)
        if isinstance(raw, str) and any(name in raw for name in scope):
            formula_value(raw, self.quantity, scope, where)  # raises if a named number is meant by the unit
        return value

    def si(self, raw: Any, where: str) -> float:
        """The number in SI of what a file has; raises `DesignError` at `where` if that is none."""
        if is_bare(raw) and raw == 0:
            return float(raw)
        example = f'Write for example "{self.quantity.example}"'
        if isinstance(raw, str):
            return parse(raw, self.quantity, where=where)
        if not is_bare(raw):
            raise refuse(where, f"found {kind(raw)} where {self.quantity.noun} is expected", example)
        if self.quantity is not RATIO:
            raise refuse(where, f"found {kind(raw)} without a unit", example)
        return _float(raw, where)

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Its formula, or the shortest text that is read back to the same bits; a ratio as it is."""
        require_single(value, where)
        if where in writer.formulas:
            return writer.formulas[where]
        if self.zero and str(value) == "0.0":
            return 0
        return value if self.quantity is RATIO else show(value, self.quantity)

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """A text whose unit the example shows."""
        said = f", {self.bound.text()}" if self.bound and self.bound.text() else ""
        text = {"type": "string", "pattern": _WITH_UNIT}
        told = {"description": f"{self.quantity.name}{said}", "examples": [self.quantity.example]}
        texts = [text, {"type": "string", "pattern": _FORMULA}] if definitions.formulas else [text]
        texts = [{"enum": [0, "0"]}, *texts]
        if self.quantity is not RATIO:
            return {"anyOf": texts} | told
        return {"anyOf": [{"type": "number", **_limits(self.bound)}, *texts]} | told | {"examples": [float(self.quantity.example)]}

    def numbers(self, value: Any, where: str = "") -> Iterator[tuple[str, Any, NumberNode]]:
        """The number itself."""
        if value is not None:
            yield where, value, self


@dataclass(frozen=True)
class NamedNode(Node):
    """A named number of any quantity, which its unit says."""

    single: ClassVar[bool] = True
    shown: ClassVar[str] = '"26 mm"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """The number of that name, which was read before all else."""
        return reader.numbers.values.get(where.partition(".")[2], BAD) if reader.numbers is not None else BAD

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Its formula, or the shortest text in its unit that is read back to the same bits."""
        return self.child(value, "value").write(value.value, where, writer)

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """A number, a text with a unit, or a formula."""
        texts = [{"type": "string", "pattern": pattern} for pattern in (_WITH_UNIT, _FORMULA)]
        said = 'a number that formulas refer to by name: "26 mm", a ratio, or a formula of others, "arm / 2"'
        return {"anyOf": [{"type": "number"}, *texts], "description": said}

    def child(self, value: Any, name: str) -> NumberNode:
        """Its value."""
        return NumberNode(quantity_of_unit(value.unit))

    def numbers(self, value: Any, where: str = "") -> Iterator[tuple[str, Any, NumberNode]]:
        """Its value."""
        yield where, value.value, self.child(value, "value")


class RowNode(Node):
    """Several values in brackets."""

    @property
    def size(self) -> int | None:
        """How many there are; absent: any number."""
        return None

    def parts(self, row: Any) -> Iterator[tuple[str, Node, Any]]:
        """Where each value of a row is, from where the row is, its node and itself."""
        raise NotImplementedError

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """One value for each."""
        if not is_row(self, raw, self.size, where, reader):
            return BAD
        return every([reader.read(node, part, join(where, name) if name else where) for name, node, part in self.parts(raw)])

    def write(self, value: Any, where: str, writer: Writer) -> list[Any]:
        """One form for each."""
        return [writer.write(node, part, join(where, name) if name else where) for name, node, part in self.parts(value)]

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """What it holds."""
        return self.parts(value)


@dataclass(frozen=True)
class VectorNode(RowNode):
    """Numbers by component: x, y, z; or the rows of a matrix."""

    items: tuple[Node, ...]
    components: ClassVar[bool] = True

    @property
    def measures(self) -> Quantity | None:
        """The quantity of its first component."""
        return self.items[0].measures

    @property
    def example(self) -> str:
        """A text as it may stand in a file."""
        return f"[{', '.join(item.example for item in self.items)}]"

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """As many texts."""
        return row_schema([item.schema(definitions) for item in self.items])

    @property
    def size(self) -> int:
        """As many as components."""
        return len(self.items)

    def parts(self, row: Any) -> Iterator[tuple[str, Node, Any]]:
        """Its components."""
        return zip(COMPONENTS, self.items, row, strict=False)

    def child(self, value: Any, name: str) -> Node:
        """A component."""
        return self.items[COMPONENTS.index(name)]


@dataclass(frozen=True)
class DirectionNode(VectorNode):
    """Three components of a direction, of any length."""

    items: tuple[Node, ...] = (NumberNode(RATIO),) * 3
    single: ClassVar[bool] = True

    @property
    def example(self) -> str:
        """A direction by name."""
        return '"x"'

    @property
    def measures(self) -> Quantity:
        """A direction."""
        return DIRECTION

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """A direction by name, or three numbers without units."""
        if isinstance(raw, str) and raw in DIRECTIONS:
            return DIRECTIONS[raw]
        if not isinstance(raw, list) or len(raw) != 3:
            advice = f"Write one of {', '.join(DIRECTIONS)}, or three numbers without units"
            return reader.refuse(where, f"found {kind(raw)} where a direction is expected", advice)
        return super().read(raw, where, reader)

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Its name, or its components."""
        name = next((name for name, direction in DIRECTIONS.items() if repr(direction) == repr(value)), None)
        return super().write(value, where, writer) if name is None or writer.has_formula(where) else name

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """A name or three numbers."""
        return {"oneOf": [{"enum": list(DIRECTIONS)}, super().schema(definitions)]}

    def numbers(self, value: Any, where: str = "") -> Iterator[tuple[str, Any, NumberNode]]:
        """None: no component varies by itself."""
        return iter(())


def _rows(*quantities: Quantity) -> tuple[VectorNode, ...]:
    """The rows of a 6x6 of quantities: of entries between translations, of mixed ones, between rotations."""
    entries = [NumberNode(quantity, zero=True) for quantity in quantities]
    return tuple(VectorNode(tuple(entries[(row > 2) + (column > 2)] for column in range(6))) for row in range(6))


@dataclass(frozen=True)
class MatrixNode(VectorNode):
    """A symmetric 6x6, of what is called `name`; files and overrides state the whole matrix or single entries.

    >>> COMPLIANCES.child(None, "x").child(None, "rz").quantity.name, COMPLIANCES.child(None, "rx").child(None, "rx").quantity.name
    ('coupling compliance', 'rotational compliance')
    """

    name: str

    @property
    def measures(self) -> None:
        """Its entries are of several quantities."""

    @property
    def example(self) -> str:
        """A text as it may stand in a file."""
        return f"[{self.items[0].example}, ...]"

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Six rows."""
        said = f"6x6 {self.name} about the centre, rows x, y, z, rx, ry, rz; zero stands without unit"
        return super().schema(definitions) | {"description": said}

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Its entries on the diagonal and above."""
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
        """A whole number of 64 bits."""
        if not isinstance(raw, int) or isinstance(raw, bool) or abs(raw) >= 2**63:
            return reader.refuse(where, f"found {kind(raw)} where a whole number is expected", "Write it without quotes")
        if self.bound is not None and not self.bound.low <= raw <= self.bound.high:
            return reader.refuse(where, f"found {kind(raw)}", f"Give a whole number of {self.bound.whole()}")
        return raw

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """The number."""
        return value

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """An integer."""
        return {"type": "integer", **_limits(self.bound)}


@dataclass(frozen=True)
class FlagNode(Node):
    """Whether something is so: true or false."""

    shown: ClassVar[str] = "true"

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """True or false."""
        return raw if isinstance(raw, bool) else reader.refuse(where, f"found {kind(raw)}", "Write true or false, without quotes")

    def write(self, value: Any, where: str, writer: Writer) -> bool:
        """True or false."""
        return bool(value)

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """A boolean."""
        return {"type": "boolean"}


@dataclass(frozen=True)
class TextNode(Node):
    """A text: a name or a remark."""

    single: ClassVar[bool] = True
    shown: ClassVar[str] = '"a name"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """The text."""
        return raw if isinstance(raw, str) else reader.refuse(where, f"found {kind(raw)} where a text is expected", "Write it in quotes")

    def write(self, value: Any, where: str, writer: Writer) -> str:
        """The text."""
        return whole_text(value, where)

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """A string."""
        return {"type": "string"}


@dataclass(frozen=True)
class ChoiceNode(Node):
    """One of the values of an enumeration."""

    choices: type[Enum]
    only: tuple[Enum, ...] = ()
    """Those that may stand here, if not all."""
    single: ClassVar[bool] = True

    @property
    def words(self) -> dict[str, Enum]:
        """The choices by what a file calls them."""
        return {str(choice.value): choice for choice in self.only or self.choices}

    @property
    def example(self) -> str:
        """A text as it may stand in a file."""
        return f'"{next(iter(self.words))}"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """The choice of that name."""
        if isinstance(raw, str) and raw in self.words:
            return self.words[raw]
        return reader.refuse(where, f"found {kind(raw)}", f"It is one of {', '.join(self.words)}")

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Its name."""
        return value.value

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """One of the names."""
        return {"enum": list(self.words), "description": meaning(self.choices)}


@dataclass(frozen=True)
class AmountNode(Node):
    """A number with its unit, or in percent; of which quantity, something else in the file decides, and who reads that reads the number."""

    shown: ClassVar[str] = '"1.4 mm"'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """The text or the number as it stands."""
        if isinstance(raw, str) or is_bare(raw):
            return raw
        return reader.refuse(where, f"found {kind(raw)} where a number with its unit is expected", f"Write for example {self.shown}")

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """A text with a unit, or a number."""
        return {"anyOf": [{"type": "number"}, {"type": "string", "pattern": _WITH_UNIT}], "description": "with its unit, or in percent"}


@dataclass(frozen=True)
class TextsNode(Node):
    """A text, or several of them in a list."""

    shown: ClassVar[str] = '["a name", "another"]'

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """The texts as a tuple."""
        texts = [raw] if isinstance(raw, str) else raw
        if not isinstance(texts, list) or not texts:
            return reader.refuse(
                where, f"found {kind(raw)} where a text is expected, or several", "Write it in quotes, several in brackets"
            )
        return every([reader.read(TextNode(), text, where) for text in texts])

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """A string or an array of them."""
        return {"oneOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}, "minItems": 1}]}


# --- what kinds of nodes have in common ---


def join(where: str, name: str) -> str:
    """The address of a member."""
    return f"{where}.{name}" if where else name


def kind(raw: Any) -> str:
    """A file's value in a few words.

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
    """A file's value, its beginning alone where it is long."""
    text = str(raw)
    return text if len(text) <= 40 else f"{text[:40]}..."


def every(items: list[Any]) -> Any:
    """The items, if none of them is bad."""
    return BAD if any(item is BAD for item in items) else tuple(items)


def is_row(node: Node, raw: Any, length: int | None, where: str, reader: Reader) -> bool:
    """Whether a file's value is a list of that length (None: any); a finding if not."""
    fits = isinstance(raw, list) and (length is None or len(raw) == length)
    if not fits:
        count = f"{length} values" if length is not None else "several values"
        reader.refuse(where, f"found {kind(raw)} where {count} are expected", f"Write them in brackets: {node.example}")
    return fits


def row_schema(items: list[dict[str, Any]]) -> dict[str, Any]:
    """The schema of a list of exactly these."""
    return {"type": "array", "prefixItems": items, "items": False, "minItems": len(items)}


def meaning(record: type) -> str:
    """The description of a class for people: its docstring on one line, without examples."""
    return " ".join((inspect.getdoc(record) or "").partition("\n\n>>>")[0].split())


def whole_text(value: str, where: str) -> str:
    """A text that a file can hold."""
    try:
        value.encode()
    except UnicodeEncodeError:
        raise refuse(where, "the text holds half a character (a lone surrogate)", "Write it anew") from None
    return value


def require_single(value: Any, where: str) -> None:
    """Raise `DesignError` for a number that a file cannot hold."""
    if not isinstance(value, (int, float)):
        raise refuse(where, "it is a batch or complex, and a file holds one design", "Pick one design before writing it")


def is_bare(raw: Any) -> bool:
    """Whether a file's value is a number without unit."""
    return isinstance(raw, (int, float)) and not isinstance(raw, bool)


def _float(raw: float, where: str) -> float:
    try:
        value = float(raw)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise refuse(where, f"found {kind(raw)}, which is not finite", "Give a finite number")
    return value


def _limits(bound: Bound | None) -> dict[str, float]:
    if bound is None:
        return {}
    low = {"exclusiveMinimum" if bound.open_low else "minimum": bound.low} if bound.low != float("-inf") else {}
    high = {"exclusiveMaximum" if bound.open_high else "maximum": bound.high} if bound.high != float("inf") else {}
    return low | high
