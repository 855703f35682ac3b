"""The grammar of descriptions: what each class holds, read from its annotations.

One tree of nodes per class; the file (reading, writing, schema), the addresses and the checks of numbers all walk it, so that a field is
written once, in its class. Names that tell alternatives apart in a file (`kind = "notch"`) stand here too.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import types
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Any, TypeAlias

from flexstage.base.number import Table
from flexstage.base.quantity import (
    COMPLIANCE,
    COMPLIANCE_MATRIX,
    COUPLING,
    DIRECTION,
    RATIO,
    ROTATIONAL_COMPLIANCE,
    Bound,
    Quantity,
)
from flexstage.mechanism.mechanism import Mechanism, ModalDamping, RayleighDamping, StructuralDamping
from flexstage.mechanism.pattern import Polar, Pose
from flexstage.parts.body import Block, Cylinder, Imported
from flexstage.parts.given import Given, Joint
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular, Elliptic, Filleted, Straight
from flexstage.parts.rod import Rod
from flexstage.spatial.frame import COMPONENTS

TAGS = "tags"
LIKE = "like"
RESERVED = (TAGS, LIKE)
"""Keys that may stand in any table of a file and are no field."""

DIRECTIONS: Mapping[str, tuple[float, float, float]] = {
    "x": (1.0, 0.0, 0.0),
    "-x": (-1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-z": (0.0, 0.0, -1.0),
}
"""Directions that have a name in a file."""

_ALTERNATIVES: dict[type, tuple[str | None, str]] = {
    Notch: ("kind", "notch"),
    Neck: ("kind", "neck"),
    Leaf: ("kind", "leaf"),
    Rod: ("kind", "rod"),
    Given: ("kind", "given"),
    Joint: ("kind", "joint"),
    Piezo: ("kind", "piezo"),
    Restricted: ("kind", "restricted"),
    Circular: ("shape", "circular"),
    Elliptic: ("shape", "elliptic"),
    Filleted: ("shape", "filleted"),
    Straight: ("shape", "straight"),
    Block: ("shape", "block"),
    Cylinder: ("shape", "cylinder"),
    Imported: ("shape", "step"),
    ModalDamping: ("law", "modal"),
    StructuralDamping: ("law", "structural"),
    RayleighDamping: ("law", "rayleigh"),
    Polar: (None, "polar"),
    Pose: (None, "pose"),
}
TOLD_BY = "TOLD_BY"
"""Class attribute of alternatives that do not stand above: the key that tells them apart, or None, and their name in a file."""

_FILE_KEYS = {(Mechanism, "changes"): "change", (Mechanism, "requirements"): "require"}


@dataclass(frozen=True)
class NumberNode:
    """A number of a quantity, within a bound."""

    quantity: Quantity
    bound: Bound | None = None


@dataclass(frozen=True)
class VectorNode:
    """Numbers by component: x, y, z."""

    items: tuple[NumberNode, ...]


@dataclass(frozen=True)
class DirectionNode:
    """Three components of a direction, of any length."""


@dataclass(frozen=True)
class MatrixNode:
    """A 6x6 compliance."""


@dataclass(frozen=True)
class RowNode:
    """A row of a 6x6 compliance."""

    row: int


@dataclass(frozen=True)
class WholeNode:
    """A whole number without unit."""


@dataclass(frozen=True)
class FlagNode:
    """Whether something is so: true or false."""


@dataclass(frozen=True)
class TextNode:
    """A text: a name or a remark."""


@dataclass(frozen=True)
class ChoiceNode:
    """One of the values of an enumeration."""

    choices: type[Enum]


@dataclass(frozen=True)
class ListNode:
    """Texts, choices, numbers or tables in a row, `length` of them (None: any number)."""

    item: Node
    length: int | None


@dataclass(frozen=True)
class TableNode:
    """Values by name."""

    item: Node


@dataclass(frozen=True)
class ChangesNode:
    """Departures by address; the address decides what the value is."""


@dataclass(frozen=True)
class RecordNode:
    """A description class with its fields."""

    record: type

    @property
    def fields(self) -> Mapping[str, Slot]:
        """The fields by name."""
        return _slots(self.record)


@dataclass(frozen=True)
class UnionNode:
    """One of several classes: told apart by the value of `key`, or, without key, by which name stands in the table."""

    key: str | None
    options: tuple[tuple[str, RecordNode], ...]

    def name_of(self, value: Any) -> str:
        """The name of a value's alternative."""
        return next(name for name, option in self.options if option.record is type(value))


Node: TypeAlias = (
    NumberNode
    | VectorNode
    | DirectionNode
    | MatrixNode
    | RowNode
    | WholeNode
    | FlagNode
    | TextNode
    | ChoiceNode
    | ListNode
    | TableNode
    | ChangesNode
    | RecordNode
    | UnionNode
)


@dataclass(frozen=True)
class Slot:
    """A field: its key in a file, what it holds, whether it may be `None`, and its default (`dataclasses.MISSING`: none; tables: empty)."""

    key: str
    node: Node
    optional: bool
    default: Any

    @property
    def required(self) -> bool:
        """Whether it must be given."""
        return self.default is dataclasses.MISSING


def node_of(record: type) -> RecordNode:
    """The node of a description class.

    >>> from flexstage.parts.rod import Rod
    >>> node_of(Rod).fields["length"].node.quantity.name
    'length'
    """
    return RecordNode(record)


@functools.cache
def _slots(record: type) -> Mapping[str, Slot]:
    hints = typing.get_type_hints(record, include_extras=True)
    return {field.name: _slot(record, field, hints[field.name]) for field in dataclasses.fields(record)}


def _slot(record: type, field: dataclasses.Field[Any], hint: Any) -> Slot:
    inner, optional = _without_none(hint)
    key = _FILE_KEYS.get((record, field.name), field.name)
    node = ChangesNode() if (record, field.name) == (Mechanism, "changes") else _node(inner)
    default = field.default if field.default_factory is dataclasses.MISSING else field.default_factory()
    if default is dataclasses.MISSING and isinstance(node, TableNode):
        default = Table({})
    return Slot(key, node, optional, default)


def _without_none(hint: Any) -> tuple[Any, bool]:
    if typing.get_origin(hint) not in (types.UnionType, typing.Union):
        return hint, False
    rest = [item for item in typing.get_args(hint) if item is not type(None)]
    if len(rest) == len(typing.get_args(hint)):
        return hint, False
    return functools.reduce(lambda left, right: left | right, rest), True


def _node(hint: Any) -> Node:
    origin = typing.get_origin(hint)
    if origin is Annotated:
        return _annotated(hint)
    if origin in (types.UnionType, typing.Union):
        options = typing.get_args(hint)
        told = [_ALTERNATIVES.get(option) or getattr(option, TOLD_BY) for option in options]
        return UnionNode(told[0][0], tuple((name, RecordNode(option)) for (_, name), option in zip(told, options, strict=True)))
    if origin is tuple:
        return _tuple(typing.get_args(hint))
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return TableNode(_node(typing.get_args(hint)[1]))
    return _named(hint)


def _named(hint: type) -> TextNode | WholeNode | FlagNode | ChoiceNode | RecordNode:
    if hint is bool:
        return FlagNode()
    if hint in (str, int):
        return TextNode() if hint is str else WholeNode()
    return ChoiceNode(hint) if issubclass(hint, Enum) else RecordNode(hint)


def _annotated(hint: Any) -> Node:
    inner, *extras = typing.get_args(hint)
    quantity = next(extra for extra in extras if isinstance(extra, Quantity))
    bound = next((extra for extra in extras if isinstance(extra, Bound)), None)
    if quantity is DIRECTION:
        return DirectionNode()
    if quantity is COMPLIANCE_MATRIX:
        return MatrixNode()
    if typing.get_origin(inner) is tuple:
        return VectorNode((NumberNode(quantity, bound),) * len(typing.get_args(inner)))
    return NumberNode(quantity, bound)


def _tuple(items: tuple[Any, ...]) -> VectorNode | ListNode:
    nodes = [_node(item) for item in items if item is not Ellipsis]
    numbers = tuple(node for node in nodes if isinstance(node, NumberNode))
    if numbers:
        return ListNode(numbers[0], None) if Ellipsis in items else VectorNode(numbers)
    return ListNode(_named(items[0]), None if Ellipsis in items else len(items))


def entry(row: int, column: int) -> NumberNode:
    """The quantity of an entry of a 6x6 compliance.

    >>> entry(0, 5).quantity.name, entry(3, 3).quantity.name
    ('coupling compliance', 'rotational compliance')
    """
    rotations = (row > 2) + (column > 2)
    return NumberNode((COMPLIANCE, COUPLING, ROTATIONAL_COMPLIANCE)[rotations])


def child(node: Node, value: Any, name: str) -> Node:
    """The node of the member of that name of a value (see `path.member`); `value` decides between alternatives.

    >>> from flexstage.parts.profile import Circular
    >>> child(UnionNode("shape", (("circular", RecordNode(Circular)),)), Circular(0.001), "radius").quantity.name
    'length'
    """
    if isinstance(node, UnionNode):
        node = dict(node.options)[node.name_of(value)]
    if isinstance(node, RecordNode):
        return node.fields[name].node
    if isinstance(node, TableNode):
        return node.item
    if isinstance(node, VectorNode):
        return node.items[COMPONENTS.index(name)]
    if isinstance(node, DirectionNode):
        return NumberNode(RATIO)
    if isinstance(node, MatrixNode):
        return RowNode(COMPONENTS.index(name))
    if isinstance(node, RowNode):
        return entry(node.row, COMPONENTS.index(name))
    raise KeyError(name)


def numbers(node: Node, value: Any, where: str = "") -> Iterator[tuple[str, Any, NumberNode]]:
    """Yield the address, value and node of every number of a description; directions, absent values and changes are left out.

    >>> from flexstage.parts.rod import Rod
    >>> [address for address, _, _ in numbers(node_of(Rod), Rod("steel", length=0.03, diameter=0.001), "parts.wire")]
    ['parts.wire.length', 'parts.wire.diameter']
    """
    if value is None:
        return
    if isinstance(node, NumberNode):
        yield where, value, node
    for name, inner, item in _members(node, value):
        yield from numbers(inner, item, f"{where}.{name}" if where else name)


def _members(node: Node, value: Any) -> Iterator[tuple[str, Node, Any]]:
    if isinstance(node, UnionNode):
        node = dict(node.options)[node.name_of(value)]
    if isinstance(node, RecordNode):
        yield from ((name, slot.node, getattr(value, name)) for name, slot in node.fields.items())
    elif isinstance(node, TableNode):
        yield from ((name, node.item, item) for name, item in value.items())
    elif isinstance(node, VectorNode):
        yield from zip(COMPONENTS, node.items, value, strict=False)
    elif isinstance(node, ListNode):
        yield from ((str(number), node.item, item) for number, item in enumerate(value, start=1))
    elif isinstance(node, MatrixNode):
        for row, column in itertools.combinations_with_replacement(range(6), 2):
            yield f"{COMPONENTS[row]}.{COMPONENTS[column]}", entry(row, column), value[row][column]
