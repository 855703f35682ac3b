"""From a description to the tree of a design file: plain tables, lists, texts and bare numbers, in the order of the fields."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from flexstage.base.digest import digest
from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.number import Vector
from flexstage.base.quantity import RATIO
from flexstage.base.unit import show
from flexstage.mechanism.checks.kind import kind_findings
from flexstage.mechanism.grammar import (
    DIRECTIONS,
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
    TableNode,
    UnionNode,
    VectorNode,
    entry,
    node_of,
)
from flexstage.mechanism.locate import locate
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.decode import FORMAT
from flexstage.spatial.frame import COMPONENTS

_ALWAYS = ("gravity",)
_LAST = ("change", "require", "sources", TAGS)


def tree_of(mechanism: Mechanism) -> dict[str, Any]:
    """Return the tree of a description's file; raises `DesignError` for what a file cannot hold (a batch, a complex number).

    Values equal to their defaults are left out, but for gravity.

    >>> tree_of(Mechanism("empty"))
    {'format': 'flexstage 1', 'name': 'empty', 'gravity': ['0 m/s^2', '0 m/s^2', '-9.80665 m/s^2']}
    """
    require(kind_findings(mechanism))
    findings: list[Finding] = []
    tree = {"format": FORMAT} | _collected(findings, node_of(Mechanism), mechanism, "")
    changes = {key: _collected(findings, _node_at(mechanism, key), value, f'change."{key}"') for key, value in mechanism.changes.items()}
    require(findings)
    tree |= {"change": changes} if changes else {}
    for address, tag in mechanism.tags.items():
        table, key = _home(tree, address)
        table.setdefault(TAGS, {})[key] = tag
    return {key: tree[key] for key in (*(key for key in tree if key not in _LAST), *(key for key in _LAST if key in tree))}


def plain(node: Node, value: Any, where: str) -> Any:
    """Return the form of a single value in a file; raises `DesignError` at `where` if it has none.

    >>> from flexstage.base.quantity import LENGTH
    >>> plain(NumberNode(LENGTH), 0.00154, "parts.neck.thickness")
    '1.54 mm'
    """
    findings: list[Finding] = []
    form = _collected(findings, node, value, where)
    require(findings)
    return form


def _node_at(mechanism: Mechanism, address: str) -> Node:
    return locate(mechanism, address).node


def _collected(findings: list[Finding], node: Node, value: Any, where: str) -> Any:
    """The form of a value in a file; findings are added for what has none."""
    try:
        if isinstance(node, (RecordNode, UnionNode, TableNode)):
            return _table(findings, node, value, where)
        return _plain(findings, node, value, where)
    except DesignError as error:
        findings += error.findings
        return None


def _plain(findings: list[Finding], node: Node, value: Any, where: str) -> Any:
    if isinstance(node, NumberNode):
        return _number(node, value, where)
    if isinstance(node, VectorNode):
        items = zip(COMPONENTS, node.items, value, strict=False)
        return [_collected(findings, item, part, f"{where}.{name}") for name, item, part in items]
    if isinstance(node, MatrixNode):
        return [[_entry(row, column, part, where) for column, part in enumerate(parts)] for row, parts in enumerate(value)]
    if isinstance(node, DirectionNode):
        return _direction(value, where)
    if isinstance(node, ListNode):
        return [_collected(findings, node.item, item, where) for item in value]
    if isinstance(node, FlagNode):
        return bool(value)
    return value.value if isinstance(node, ChoiceNode) else _text(value, where)


def _table(findings: list[Finding], node: RecordNode | UnionNode | TableNode, value: Any, where: str) -> dict[str, Any]:
    if isinstance(node, TableNode):
        if TAGS in value:
            raise refuse(f"{where}.{TAGS}", f'no entry may be named "{TAGS}"', "Rename it")
        return {_text(name, where): _collected(findings, node.item, item, f"{where}.{name}") for name, item in value.items()}
    if isinstance(node, UnionNode):
        name = node.name_of(value)
        inner = _table(findings, dict(node.options)[name], value, where)
        return {node.key: name} | inner if node.key else inner
    return dict(_fields(findings, node, value, where))


def _fields(findings: list[Finding], node: RecordNode, record: Any, where: str) -> Iterator[tuple[str, Any]]:
    for name, slot in node.fields.items():
        value = getattr(record, name)
        default = name not in _ALWAYS and not slot.required and digest(value) == digest(slot.default)
        if not default and name != TAGS and not isinstance(slot.node, ChangesNode):
            alternative = isinstance(slot.node, UnionNode) and slot.node.key is None
            key = slot.node.name_of(value) if isinstance(slot.node, UnionNode) and alternative else slot.key
            yield key, _collected(findings, slot.node, value, f"{where}.{name}" if where else name)


def _number(node: NumberNode, value: Any, where: str) -> Any:
    _single(value, where)
    return value if node.quantity is RATIO else show(value, node.quantity)


def _entry(row: int, column: int, value: Any, where: str) -> Any:
    """An entry of a compliance matrix: zero stands without unit."""
    _single(value, where)
    return 0 if value == 0.0 and str(value) == "0.0" else show(value, entry(row, column).quantity)


def _direction(value: Vector, where: str) -> Any:
    for item in value:
        _single(item, where)
    return next((name for name, direction in DIRECTIONS.items() if repr(direction) == repr(value)), list(value))


def _single(value: Any, where: str) -> None:
    if not isinstance(value, float):
        raise refuse(where, "it is a batch or complex, and a file holds one design", "Pick one design before writing it")
    if value - value != 0.0:
        raise refuse(where, f"found {value}, which is not finite", "Give a finite number")


def _text(value: str, where: str) -> str:
    try:
        value.encode()
    except UnicodeEncodeError:
        raise refuse(where, "the text holds half a character (a lone surrogate)", "Write it anew") from None
    return value


def _home(tree: dict[str, Any], address: str) -> tuple[dict[str, Any], str]:
    """The table that a tag stands in, and its key there: that of the named material, part, unit, ..., or the whole file."""
    steps = address.split(".")
    section = tree.get(steps[0]) if len(steps) > 2 else None
    table = section.get(steps[1]) if isinstance(section, dict) else None
    return (table, ".".join(steps[2:])) if isinstance(table, dict) else (tree, address)
