"""Grammar of descriptions: a tree of nodes for each class, built from the annotations of its fields.

The node of a value implements its behaviour for files, addresses and checks. This module has nodes for containers; `node` has nodes for
single values. A field is thus declared only once, in its class. This module also has the names of alternatives in a file (`kind =
"notch"`).
"""

from __future__ import annotations

import dataclasses
import functools
import types
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Any

from flexstage.base.finding import refuse
from flexstage.base.number import Table
from flexstage.base.register import Register
from flexstage.base.storage.digest import KEY, digest
from flexstage.base.units.quantity import COMPLIANCE_MATRIX, DIRECTION, STIFFNESS_MATRIX, Bound, Quantity
from flexstage.mechanism.assembly.pattern import Polar, Pose
from flexstage.mechanism.catalogue import shipped_catalogue
from flexstage.mechanism.grammar.node import (
    BAD,
    COMPLIANCES,
    STIFFNESSES,
    ChoiceNode,
    Definitions,
    DirectionNode,
    FlagNode,
    NamedNode,
    Node,
    NumberNode,
    Reader,
    RowNode,
    TextNode,
    VectorNode,
    WholeNode,
    Writer,
    join,
    kind,
    meaning,
    whole_text,
)
from flexstage.mechanism.grammar.trade import advise_key, advise_kind
from flexstage.mechanism.mechanism import (
    BESIDE,
    GaugeSum,
    Joins,
    LinkProbe,
    Mechanism,
    ModalDamping,
    NamedNumber,
    Probe,
    RayleighDamping,
    StructuralDamping,
)
from flexstage.parts import PARTS
from flexstage.parts.body import SOLIDS, Block, Cylinder, Imported, Solid
from flexstage.parts.profile import Circular, Elliptic, Filleted, Straight
from flexstage.parts.shape import Elastic

TAGS = "tags"
LIKE = "like"
RESERVED = (TAGS, LIKE)
"""Keys that any table of a file may have although they are not fields."""

BY_FIELD = ""
"""Marker for alternatives that are identified by a field in the table; the alternative has the name of this field."""

_ALTERNATIVES: dict[type, tuple[str | None, str]] = {
    Probe: (BY_FIELD, "body"),
    LinkProbe: (BY_FIELD, "link"),
    GaugeSum: (BY_FIELD, "sum"),
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
"""Name of a class attribute of alternatives: the discriminating key (or None) and the name of the alternative in a file."""

_ALWAYS = ("gravity",)
_TAGS_SCHEMA: dict[str, Any] = {
    "type": "object",
    "description": "Provenance of each field: stated, derived or assumed, then a source and the place in the source.",
    "additionalProperties": {"type": "string", "pattern": r"^(stated|derived|assumed)( |$)", "examples": ["stated paper 2.2"]},
}
_KIND = "kind"
_ELSEWHERE = "If another package provides this kind, install the package"


@dataclass(frozen=True)
class ListNode(RowNode):
    """List of strings, choices, numbers or tables, with a fixed `length` (None: any)."""

    item: Node
    length: int | None

    @property
    def example(self) -> str:
        """Example as written in a file."""
        return f"[{', '.join([self.item.example] * (self.length or 1))}]"

    def parts(self, row: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the items. A table has its number as address, counted from 1; other items have the address of the list."""
        numbered = isinstance(self.item, RecordNode | UnionNode)
        return ((str(number) if numbered else "", self.item, part) for number, part in enumerate(row, start=1))

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the items by number, counted from 1."""
        return ((str(number), self.item, item) for number, item in enumerate(value, start=1))

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a JSON array."""
        length = {} if self.length is None else {"minItems": self.length, "maxItems": self.length}
        return {"type": "array", "items": self.item.schema(definitions), **length}


@dataclass(frozen=True)
class NumbersNode(ListNode):
    """List of numbers or points of any length; the address of each item is its index from zero."""

    def parts(self, row: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the items by index."""
        return ((str(place), self.item, part) for place, part in enumerate(row))

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the items by index."""
        return self.parts(value)

    def child(self, value: Any, name: str) -> Node:
        """Return the node of an item."""
        return self.item

    def key(self, value: Any, name: str) -> int:
        """Return the index of an item."""
        return int(name)


@dataclass(frozen=True)
class TableNode(Node):
    """Table of values of one kind, by name."""

    item: Node

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return a table of the values that were read."""
        if not _is_table(raw, where, reader):
            return BAD
        items = {name: reader.read(self.item, part, join(where, name)) for name, part in _strip_tags(raw, where, reader).items()}
        return BAD if BAD in items.values() else Table(items)

    def write(self, value: Any, where: str, writer: Writer) -> dict[str, Any]:
        """Return a table for a file."""
        if TAGS in value:
            raise refuse(f"{where}.{TAGS}", f'"{TAGS}" is reserved', "Rename the entry")
        return {whole_text(name, where): writer.write(self.item, item, f"{where}.{name}") for name, item in value.items()}

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a JSON object with any keys."""
        return {"type": "object", "properties": _tags_of(definitions), "additionalProperties": self.item.schema(definitions)}

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the values by name."""
        return ((name, self.item, item) for name, item in value.items())

    def child(self, value: Any, name: str) -> Node:
        """Return the node of a value."""
        return self.item


@dataclass(frozen=True)
class OpenNode(Node):
    """Table whose values are read later, because their names determine their kinds. `said` is its description in a schema."""

    said: str

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return the table without reading its values."""
        return Table(raw) if _is_table(raw, where, reader) else BAD

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a JSON object with any values."""
        return {"type": "object", "description": self.said}


class JoinsNode(Node):
    """Bodies joined by a link: a list of two names, or a table of names by port."""

    shown = '["ground", "platform"]'

    def _node(self, value: Any) -> Node:
        return TableNode(TextNode()) if isinstance(value, Mapping) else ListNode(TextNode(), 2)

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return two names, or a table of names by port."""
        return self._node(raw).read(raw, where, reader)

    def write(self, value: Any, where: str, writer: Writer) -> Any:
        """Return a list or a table of names for a file."""
        return self._node(value).write(value, where, writer)

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return the schema of a JSON array of two items, or of an object."""
        by_port = {"type": "object", "additionalProperties": {"type": "string"}}
        return {"oneOf": [ListNode(TextNode(), 2).schema(definitions), by_port]}

    def child(self, value: Any, name: str) -> Node:
        """Return the node of a name."""
        return self._node(value).child(value, name)


OVERRIDES = OpenNode("Overrides by address: unit/link.field for all instances, instance/link.field for one instance.")


@dataclass(frozen=True)
class RecordNode(Node):
    """Object of one description class, with the nodes of its fields.

    >>> from flexstage.parts.rod import Rod
    >>> [address for address, _, _ in RecordNode(Rod).numbers(Rod("steel", length=0.03, diameter=0.001), "parts.wire")]
    ['parts.wire.length', 'parts.wire.diameter']
    """

    record: type

    @property
    def records(self) -> tuple[type, ...]:
        """Classes of possible values: only one class."""
        return (self.record,)

    @property
    def fields(self) -> Mapping[str, Slot]:
        """Fields by name."""
        return _slots(self.record)

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return an object built from the table's entries and the defaults."""
        if not _is_table(raw, where, reader):
            return BAD
        raw = _strip_tags(raw, where, reader)
        values: dict[str, Any] = {}
        used: set[str] = set()
        for name, slot in self.fields.items():
            key, inner = slot.alternative(raw, where, reader)
            if key in raw:
                used.add(key)
                values[name] = reader.read(inner, raw[key], join(where, key))
            elif slot.required:
                advice = f"Add e.g. {slot.keys[0]} = {slot.node.example}"
                values[name] = reader.refuse(where or "file", f"{' or '.join(slot.keys)} missing", advice)
            else:
                values[name] = slot.default
        known = [key for slot in self.fields.values() for key in slot.keys]
        for key in [key for key in raw if key not in used]:
            reader.refuse(join(where, key), "unknown key", advise_key(key, set(known) - used, known))
        return BAD if BAD in values.values() else self.record(**values)

    def write(self, value: Any, where: str, writer: Writer) -> dict[str, Any]:
        """Return a table of the fields that differ from their defaults or have a formula."""
        return dict(self._entries(value, where, writer))

    def _entries(self, record: Any, where: str, writer: Writer) -> Iterator[tuple[str, Any]]:
        for name, slot in self.fields.items():
            value = getattr(record, name)
            default = name not in _ALWAYS and not slot.required and digest(value) == digest(slot.default)
            stated = not default or writer.has_formula(join(where, name))
            if stated and name != TAGS and slot.node is not OVERRIDES:
                yield self.key(record, name), writer.write(slot.node, value, join(where, name))

    def schema(self, definitions: Definitions, key: str | None = None, name: str | None = None) -> dict[str, Any]:
        """Return a schema reference to the definition of the class, in which the property `key` must equal `name`."""
        title = self.record.__name__
        if title not in definitions.known:
            definitions.known[title] = {}
            definitions.known[title] = self.definition(definitions, key, name)
        return {"$ref": f"#/$defs/{title}"}

    def definition(self, definitions: Definitions, key: str | None = None, name: str | None = None) -> dict[str, Any]:
        """Return the full schema of the class, in which the property `key` must equal `name`."""
        properties: dict[str, Any] = {key: {"const": name}} if key else {}
        required = [key] if key else []
        wrapped: list[dict[str, Any]] = []
        for slot in self.fields.values():
            properties |= {key: node.schema(definitions) | _default(slot) for key, node in slot.alternatives}
            if slot.wrapped is not None:
                wrapped += [{"required": [option]} for option in slot.keys]
            elif slot.required:
                required.append(slot.key)
        section = shipped_catalogue().section(self.record)
        demand: dict[str, Any] = {"required": required}
        if section is not None:
            names = {"anyOf": [{"enum": list(section.entries)}, {"type": "string"}]}
            properties |= {LIKE: names | {"description": "catalogue entry that provides default values"}}
            demand = {"anyOf": [{"required": required}, {"required": [LIKE]}]}
        demand |= {"oneOf": wrapped} if wrapped else {}
        shape = {"type": "object", "description": meaning(self.record), "properties": properties | _tags_of(definitions)}
        return shape | demand | {"additionalProperties": False}

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the fields."""
        for name, slot in self.fields.items():
            yield name, slot.node, getattr(value, name)

    def child(self, value: Any, name: str) -> Node:
        """Return the node of a field."""
        return self.fields[name].node

    def key(self, value: Any, name: str) -> str:
        """Return the file key of a field, or the name of its alternative if files use this name as key (`polar`)."""
        slot = self.fields[name]
        return slot.key if slot.wrapped is None else slot.wrapped.name_of(getattr(value, name))

    def field_called(self, value: Any, key: str) -> str:
        """Return the field for a key of a file; the key may be the name of an alternative (`polar` for the field `pattern`)."""
        result = (name for name, slot in self.fields.items() if slot.wrapped is not None and self.key(value, name) == key)
        return next(result, key)


@dataclass(frozen=True)
class UnionNode(Node):
    """Object of one of several classes, identified by the value of the key `told_by`, or by the keys of the table if `told_by` is None."""

    told_by: str | None
    options: tuple[tuple[str, RecordNode], ...]
    usual: str | None = None
    """Name of the default alternative."""

    @property
    def records(self) -> tuple[type, ...]:
        """Classes of possible values: all alternatives."""
        return tuple(option.record for _, option in self.options)

    def name_of(self, value: Any) -> str:
        """Return the name of the alternative that a value belongs to."""
        return next(name for name, option in self.options if option.record is type(value))

    def option(self, value: Any) -> RecordNode:
        """Return the node of the alternative that a value belongs to."""
        return dict(self.options)[self.name_of(value)]

    @property
    def example(self) -> str:
        """Example as written in a file."""
        return f'{{ {self.told_by} = "{self.options[0][0]}", ... }}' if self.told_by else self.shown

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return an object of the alternative that the table names."""
        if not _is_table(raw, where, reader):
            return BAD
        options = dict(self.options)
        key = self.told_by or ""
        name = raw.get(key, self.usual)
        if name is None:
            return reader.refuse(where, f"{key} missing", f"Use {key} = one of {', '.join(options)}")
        if not isinstance(name, str) or name not in options:
            advice = advise_kind(kind(name), options)
            return reader.refuse(
                join(where, key), f"unknown {key} (got {kind(name)})", f"{advice}. {_ELSEWHERE}" if key == _KIND else advice
            )
        return options[name].read({item: value for item, value in raw.items() if item != key}, where, reader)

    def write(self, value: Any, where: str, writer: Writer) -> dict[str, Any]:
        """Return a table for a file, with the name of the alternative."""
        inner = self.option(value).write(value, where, writer)
        name = self.name_of(value)
        return {self.told_by: name} | inner if self.told_by and name != self.usual else inner

    def schema(self, definitions: Definitions) -> dict[str, Any]:
        """Return a schema that allows each alternative."""
        schemas = [option.schema(definitions, None if name == self.usual else self.told_by, name) for name, option in self.options]
        return {"oneOf": schemas} if len(schemas) > 1 else schemas[0]

    def members(self, value: Any) -> Iterator[tuple[str, Node, Any]]:
        """Yield the members of the value's alternative."""
        return self.option(value).members(value)

    def child(self, value: Any, name: str) -> Node:
        """Return the node of a member of the value's alternative."""
        return self.option(value).child(value, name)

    def key(self, value: Any, name: str) -> str:
        """Return the file key of a member of the value's alternative."""
        return self.option(value).key(value, name)

    def field_called(self, value: Any, key: str) -> str:
        """Return the field of the value's alternative for a key of a file."""
        return self.option(value).field_called(value, key)


@dataclass(frozen=True)
class FieldUnionNode(UnionNode):
    """Object of one of several classes, identified by a field in the table; if no field identifies a class, the first is used."""

    def read(self, raw: Any, where: str, reader: Reader) -> Any:
        """Return an object of the class whose field is in the table."""
        if not _is_table(raw, where, reader):
            return BAD
        return next((option for name, option in self.options if name in raw), self.options[0][1]).read(raw, where, reader)


@dataclass(frozen=True)
class Slot:
    """Field of a class: its file key, its node, whether it may be `None` (`optional`), and its default.

    `default` is `dataclasses.MISSING` for a field without a default; tables are empty by default.
    """

    key: str
    node: Node
    optional: bool
    default: Any

    @property
    def required(self) -> bool:
        """Whether the field is required."""
        return self.default is dataclasses.MISSING

    @property
    def wrapped(self) -> UnionNode | None:
        """Union of classes whose names replace the field's key in files (`polar`); `None` for a field with its own key."""
        return self.node if isinstance(self.node, UnionNode) and self.node.told_by is None else None

    @property
    def alternatives(self) -> tuple[tuple[str, Node], ...]:
        """Possible file keys of the field, each with its node."""
        return ((self.key, self.node),) if self.wrapped is None else self.wrapped.options

    @property
    def keys(self) -> list[str]:
        """All keys that the field can have in a file."""
        return [key for key, _ in self.alternatives]

    def alternative(self, raw: dict[str, Any], where: str, reader: Reader) -> tuple[str, Node]:
        """Return the key that a table uses for the field, and its node."""
        present = [(key, node) for key, node in self.alternatives if key in raw]
        if len(present) > 1:
            reader.refuse(where, f"both {' and '.join(key for key, _ in present)} specified", "Remove one of them")
        return present[0] if present else (self.key, self.node)


def _default(slot: Slot) -> dict[str, Any]:
    """The default of a field in a schema, if it is a single value."""
    single = isinstance(slot.default, str | int | float | Enum)
    return {"default": Writer().write(slot.node, slot.default, slot.key)} if single else {}


def _is_table(raw: Any, where: str, reader: Reader) -> bool:
    fits = isinstance(raw, dict)
    if not fits:
        reader.refuse(where, f"must be a table (got {kind(raw)})", "Write a table: [name] or { key = value }")
    return fits


def _strip_tags(raw: dict[str, Any], where: str, reader: Reader) -> dict[str, Any]:
    """The table without its tags, which are stored by address."""
    if not reader.tagged:
        return raw
    tags = raw.get(TAGS, {})
    wrong = [key for key, tag in tags.items() if not isinstance(tag, str)] if isinstance(tags, dict) else [""]
    if wrong:
        own = join(join(where, TAGS), wrong[0]) if wrong[0] else join(where, TAGS)
        reader.refuse(own, "a tag must be a string", 'Use e.g. tags = { thickness = "stated paper 2.2" }; quote keys that contain dots')
    else:
        reader.tags.update({join(where, key): tag for key, tag in tags.items()})
    return {key: value for key, value in raw.items() if key != TAGS}


def _tags_of(definitions: Definitions) -> dict[str, Any]:
    return {TAGS: _TAGS_SCHEMA} if definitions.tagged else {}


def node_of(record: type) -> RecordNode:
    """Return the node of a description class.

    >>> from flexstage.parts.rod import Rod
    >>> node_of(Rod).fields["length"].node.quantity.name
    'length'
    """
    return RecordNode(record)


@functools.cache
def _slots(record: type) -> Mapping[str, Slot]:
    hints = typing.get_type_hints(record, include_extras=True)
    return {
        field.name: _slot(record, field, hints[field.name])
        for field in dataclasses.fields(record)
        if not BESIDE.items() <= field.metadata.items()
    }


def _slot(record: type, field: dataclasses.Field[Any], hint: Any) -> Slot:
    inner, optional = _without_none(hint)
    key = field.metadata.get(KEY, field.name)
    node = OVERRIDES if (record, field.name) == (Mechanism, "overrides") else _node(inner)
    default = field.default if field.default_factory is dataclasses.MISSING else field.default_factory()
    if default is dataclasses.MISSING and isinstance(node, (TableNode, OpenNode)):
        default = Table({})
    if default is dataclasses.MISSING and optional:
        default = None
    return Slot(key, node, optional, default)


def _without_none(hint: Any) -> tuple[Any, bool]:
    options = typing.get_args(hint) if typing.get_origin(hint) in (types.UnionType, typing.Union) else ()
    rest = tuple(option for option in options if option is not type(None))
    return (hint, False) if rest == options else (typing.Union[rest], True)  # noqa: UP007  (a tuple of classes)


def _node(hint: Any) -> Node:
    origin = typing.get_origin(hint)
    if origin is Annotated:
        return _annotated_node(hint)
    if hint is NamedNumber:
        return NamedNode()
    if hint == Joins:
        return JoinsNode()
    if hint in (Elastic, Solid) or origin in (types.UnionType, typing.Union):
        several = {Elastic: PARTS.all.values(), Solid: SOLIDS}
        options = [each for option in typing.get_args(hint) or (hint,) for each in several.get(option, [option])]
        told = [_discriminator(option) for option in options]
        named = tuple((name, RecordNode(option)) for (_, name), option in zip(told, options, strict=True))
        return FieldUnionNode(None, named) if told[0][0] == BY_FIELD else UnionNode(told[0][0], named)
    if origin is tuple:
        return _tuple(typing.get_args(hint))
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return TableNode(_node(typing.get_args(hint)[1]))
    return _named_node(hint)


def _discriminator(option: type) -> tuple[str | None, str]:
    """Discriminating key of an alternative, and its name there; `kind` for parts."""
    told = _ALTERNATIVES.get(option) or getattr(option, TOLD_BY, None)
    return told or (_KIND, option.kind)  # type: ignore[attr-defined]


_PLAIN: Mapping[type, Node] = {bool: FlagNode(), str: TextNode(), int: WholeNode()}


def _named_node(hint: type) -> Node:
    if hint in _PLAIN:
        return _PLAIN[hint]
    return ChoiceNode(hint) if issubclass(hint, Enum) else RecordNode(hint)


def _annotated_node(hint: Any) -> Node:
    inner, *extras = typing.get_args(hint)

    def extra(kind: type) -> Any:
        return next((each for each in extras if isinstance(each, kind)), None)

    if node := extra(Node):
        return node
    if register := extra(Register):
        return UnionNode(_KIND, tuple((name, RecordNode(option)) for name, option in register.all.items()), next(iter(register.own)))
    if inner is int:
        return WholeNode(extras[0])
    quantity, bound = extra(Quantity), extra(Bound)
    if quantity is DIRECTION:
        return DirectionNode()
    if quantity in (COMPLIANCE_MATRIX, STIFFNESS_MATRIX):
        return COMPLIANCES if quantity is COMPLIANCE_MATRIX else STIFFNESSES
    if typing.get_origin(inner) is tuple:
        return VectorNode((NumberNode(quantity, bound),) * len(typing.get_args(inner)))
    return NumberNode(quantity, bound)


def _tuple(items: tuple[Any, ...]) -> VectorNode | ListNode:
    nodes = [_node(item) for item in items if item is not Ellipsis]
    numbers = tuple(node for node in nodes if isinstance(node, NumberNode))
    if Ellipsis in items and isinstance(nodes[0], NumberNode | VectorNode):
        return NumbersNode(nodes[0], None)
    if numbers:
        return VectorNode(numbers)
    return ListNode(nodes[0], None if Ellipsis in items else len(items))
