"""The JSON Schema (2020-12) of the design file, for editors: keys, alternatives, units with examples, meanings."""

from __future__ import annotations

import inspect
from typing import Any

from flexstage.base.quantity import RATIO, Bound
from flexstage.mechanism.grammar import (
    DIRECTIONS,
    LIKE,
    TAGS,
    ChangesNode,
    ChoiceNode,
    DirectionNode,
    FlagNode,
    ListNode,
    MatrixNode,
    Node,
    NumberNode,
    RecordNode,
    Slot,
    TableNode,
    TextNode,
    UnionNode,
    VectorNode,
    WholeNode,
    entry,
)
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.catalogue import Catalogue, shipped
from flexstage.mechanism.store.decode import FORMAT

_NUMBER = r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{1,3})?"
_WITH_UNIT = rf"^(?![0-9.eE+-]*$){_NUMBER}(\s*[A-Za-zµμ°%/(].*|\s+1/.*)$"
_TAGS: dict[str, Any] = {
    "type": "object",
    "description": "Provenance by field: stated, derived or assumed, then a source and a place in it.",
    "additionalProperties": {"type": "string", "pattern": r"^(stated|derived|assumed)( |$)", "examples": ["stated paper 2.2"]},
}


def schema() -> dict[str, Any]:
    """Return the JSON Schema of a design file. Each class is a definition; quantities are texts whose unit the example shows.

    >>> schema()["properties"]["mode_limit"]["examples"]
    ['4 kHz']
    """
    return schema_of(Mechanism, FORMAT, "flexstage design")


def schema_of(record: type, form: str, title: str) -> dict[str, Any]:
    """Return the JSON Schema of a file that holds one record and says `format = form`.

    >>> from flexstage.parts.rod import Rod
    >>> schema_of(Rod, "rod 1", "rod")["properties"]["format"]
    {'const': 'rod 1'}
    """
    writer = _Writer(shipped())
    root = writer.record(RecordNode(record))
    properties = {"format": {"const": form}, **root.pop("properties")}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": title,
        **root,
        "required": ["format", *root["required"]],
        "properties": properties,
        "$defs": dict(sorted(writer.definitions.items())),
    }


class _Writer:
    """Writes nodes as schemas and gathers the definitions of classes."""

    def __init__(self, catalogue: Catalogue) -> None:
        self.catalogue = catalogue
        self.definitions: dict[str, Any] = {}

    def node(self, node: Node) -> dict[str, Any]:
        """The schema of a node; classes are referred to."""
        if isinstance(node, RecordNode):
            return self.reference(node)
        if isinstance(node, UnionNode):
            return {"oneOf": [self.reference(option, node.key, name) for name, option in node.options]}
        if isinstance(node, TableNode):
            return {"type": "object", "properties": {TAGS: _TAGS}, "additionalProperties": self.node(node.item)}
        if isinstance(node, ListNode):
            length = {} if node.length is None else {"minItems": node.length, "maxItems": node.length}
            return {"type": "array", "items": self.node(node.item), **length}
        return _leaf(node)

    def reference(self, node: RecordNode, key: str | None = None, name: str | None = None) -> dict[str, Any]:
        """A reference to the definition of a class, told apart by `key = name`."""
        title = node.record.__name__
        if title not in self.definitions:
            self.definitions[title] = {}
            self.definitions[title] = self.record(node, key, name)
        return {"$ref": f"#/$defs/{title}"}

    def record(self, node: RecordNode, key: str | None = None, name: str | None = None) -> dict[str, Any]:
        """The schema of a class."""
        properties: dict[str, Any] = {key: {"const": name}} if key else {}
        required = [key] if key else []
        wrapped: list[dict[str, Any]] = []
        for slot in node.fields.values():
            properties |= self.properties(slot)
            if isinstance(slot.node, UnionNode) and slot.node.key is None:
                wrapped += [{"required": [option]} for option, _ in slot.node.options]
            elif slot.required:
                required.append(slot.key)
        section = self.catalogue.section(node.record)
        demand: dict[str, Any] = {"required": required}
        if section is not None:
            properties |= {LIKE: {"enum": list(section.entries), "description": "the entry of the catalogue to start from"}}
            demand = {"anyOf": [{"required": required}, {"required": [LIKE]}]}
        demand |= {"oneOf": wrapped} if wrapped else {}
        shape = {"type": "object", "description": _meaning(node.record), "properties": properties | {TAGS: _TAGS}}
        return shape | demand | {"additionalProperties": False}

    def properties(self, slot: Slot) -> dict[str, Any]:
        """The schemas of a field by key: of each alternative where its name replaces the key."""
        if isinstance(slot.node, UnionNode) and slot.node.key is None:
            return {name: self.reference(option) for name, option in slot.node.options}
        return {slot.key: self.node(slot.node)}


def _leaf(node: Node) -> dict[str, Any]:
    if isinstance(node, NumberNode):
        return _number(node)
    if isinstance(node, VectorNode):
        return _row([_number(item) for item in node.items])
    if isinstance(node, DirectionNode):
        return {"oneOf": [{"enum": list(DIRECTIONS)}, _row([{"type": "number"}] * 3)]}
    if isinstance(node, MatrixNode):
        rows = [_row([{"oneOf": [{"const": 0}, _number(entry(row, column))]} for column in range(6)]) for row in range(6)]
        return _row(rows) | {"description": "6x6 compliance about the centre, rows x, y, z, rx, ry, rz; zero stands without unit"}
    if isinstance(node, ChoiceNode):
        return {"enum": [choice.value for choice in node.choices], "description": _meaning(node.choices)}
    if isinstance(node, ChangesNode):
        return {"type": "object", "description": "Departures by address: unit/link.field of all copies, copy/link.field of one."}
    if isinstance(node, FlagNode):
        return {"type": "boolean"}
    if isinstance(node, WholeNode):
        return {"type": "integer"}
    return {"type": "string"} if isinstance(node, TextNode) else {}


def _number(node: NumberNode) -> dict[str, Any]:
    said = f", {node.bound.text()}" if node.bound and node.bound.text() else ""
    text = {"type": "string", "pattern": _WITH_UNIT}
    told = {"description": f"{node.quantity.name}{said}", "examples": [node.quantity.example]}
    if node.quantity is not RATIO:
        return text | told
    return {"anyOf": [{"type": "number", **_limits(node.bound)}, text]} | told | {"examples": [float(node.quantity.example)]}


def _limits(bound: Bound | None) -> dict[str, float]:
    if bound is None:
        return {}
    low = {"exclusiveMinimum" if bound.open_low else "minimum": bound.low} if bound.low != float("-inf") else {}
    high = {"exclusiveMaximum" if bound.open_high else "maximum": bound.high} if bound.high != float("inf") else {}
    return low | high


def _row(items: list[dict[str, Any]]) -> dict[str, Any]:
    return {"type": "array", "prefixItems": items, "items": False, "minItems": len(items)}


def _meaning(record: type) -> str:
    """The description of a class for people: its docstring on one line, without examples."""
    text = (inspect.getdoc(record) or "").partition("\n\n>>>")[0]
    return " ".join(text.split())
