"""Values are of the kind that their field asks for; files are so by their reading, descriptions written in Python may not be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from flexstage.base.finding import Finding
from flexstage.mechanism.grammar import (
    ChangesNode,
    ChoiceNode,
    DirectionNode,
    FlagNode,
    ListNode,
    MatrixNode,
    Node,
    NumberNode,
    RecordNode,
    TableNode,
    TextNode,
    UnionNode,
    VectorNode,
    node_of,
)
from flexstage.mechanism.mechanism import Mechanism


def kind_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Findings about values of another kind than their field's.

    >>> from flexstage.parts.rod import Rod
    >>> print(*kind_findings(Mechanism("", parts={"wire": Rod("steel", length=None, diameter=0.001)})))
    parts.wire.length: found None where a length is expected. Give a number or an array in SI units.
    """
    yield from _kinds(node_of(Mechanism), mechanism, "")


def _kinds(node: Node, value: Any, where: str) -> Iterator[Finding]:
    expected = wanted(node, value)
    if expected:
        what, advice = expected
        yield Finding(where, f"found {_short(value)} where {what} is expected", advice)
        return
    for name, inner, item, optional in _inner(node, value):
        if not (optional and item is None):
            yield from _kinds(inner, item, f"{where}.{name}" if where else name)


def wanted(node: Node, value: Any) -> tuple[str, str] | None:
    """What is expected instead of the value, and advice; `None` if the value is of the right kind (what it holds is not looked at).

    >>> wanted(TextNode(), 3.0)
    ('a text', 'Give a str')
    """
    if isinstance(node, NumberNode):
        return None if _is_number(value) else (node.quantity.noun, "Give a number or an array in SI units")
    if isinstance(node, (VectorNode, DirectionNode)):
        count = len(node.items) if isinstance(node, VectorNode) else 3
        fits = _is_row(value, count) and (isinstance(node, VectorNode) or all(_is_number(item) for item in value))
        return None if fits else (f"a row of {count} numbers", "Give a tuple of numbers or arrays in SI units")
    if isinstance(node, MatrixNode):
        fits = _is_row(value, 6) and all(_is_row(row, 6) and all(_is_number(item) for item in row) for row in value)
        return None if fits else ("a 6x6", "Give six rows of six numbers or arrays, as tuples")
    return _wanted_name(node, value)


def _wanted_name(node: Node, value: Any) -> tuple[str, str] | None:
    if isinstance(node, TextNode):
        return None if isinstance(value, str) else ("a text", "Give a str")
    if isinstance(node, FlagNode):
        return None if isinstance(value, bool) else ("true or false", "Give a bool")
    if isinstance(node, ChoiceNode):
        return None if isinstance(value, node.choices) else (f"a {node.choices.__name__}", f"Give a member of {node.choices.__name__}")
    if isinstance(node, ListNode):
        fits = _is_row(value, node.length) and all(wanted(node.item, item) is None for item in value)
        return None if fits else ("a row of values", "Give a tuple")
    if isinstance(node, (TableNode, ChangesNode)):
        fits = isinstance(value, Mapping) and all(isinstance(name, str) for name in value)
        return None if fits else ("a mapping by name", "Give a dict with names as keys")
    options = [option.record for _, option in node.options] if isinstance(node, UnionNode) else [_record(node)]
    names = " or ".join(option.__name__ for option in options)
    return None if type(value) in options else (names, f"Give a {names}")


def _record(node: Node) -> type:
    return node.record if isinstance(node, RecordNode) else object


def _inner(node: Node, value: Any) -> Iterator[tuple[str, Node, Any, bool]]:
    if isinstance(node, UnionNode):
        node = dict(node.options)[node.name_of(value)]
    if isinstance(node, RecordNode):
        for name, slot in node.fields.items():
            yield name, slot.node, getattr(value, name), slot.optional
    elif isinstance(node, TableNode):
        for name, item in value.items():
            yield name, node.item, item, False
    elif isinstance(node, VectorNode):
        for name, item_node, item in zip("xyz", node.items, value, strict=False):
            yield name, item_node, item, False


def _is_number(value: Any) -> bool:
    if isinstance(value, np.ndarray):
        return value.dtype.kind in "fc"
    return isinstance(value, (float, complex))


def _is_row(value: Any, count: int | None) -> bool:
    return isinstance(value, tuple) and (count is None or len(value) == count)


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."
