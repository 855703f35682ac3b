"""Encoding of a description as the tree of a design file: tables, lists, strings and numbers, in the order of the fields."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flexstage.base.finding import require
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.checks.formula import formula_findings
from flexstage.mechanism.checks.kind import kind_findings
from flexstage.mechanism.grammar.grammar import TAGS, node_of
from flexstage.mechanism.grammar.node import Node, Writer
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.file import FORMAT

_FIRST = ("format", "name", "numbers")
_LAST = ("overrides", "requirements", "sources", TAGS)


def tree_of(mechanism: Mechanism) -> dict[str, Any]:
    """Encode a description as the tree of its file.

    Values equal to their defaults are omitted, except for gravity. A formula that does not match its value is also omitted. Raises
    `DesignError` for batches and complex numbers.

    >>> tree_of(Mechanism("empty"))
    {'format': 'flexstage 1', 'name': 'empty', 'gravity': ['0 m/s^2', '0 m/s^2', '-9.80665 m/s^2']}
    """
    require(kind_findings(mechanism))
    stale = {each.where for each in formula_findings(mechanism)}
    writer = Writer(formulas={address: text for address, text in mechanism.formulas.items() if address not in stale})
    tree = {"format": FORMAT} | writer.write(node_of(Mechanism), mechanism, "")
    places = {key: locate(mechanism, key) for key in mechanism.overrides}
    overrides = {key: writer.write(place.node, mechanism.overrides[key], place.address) for key, place in places.items()}
    require(writer.findings)
    tree |= {"overrides": overrides} if overrides else {}
    for address, tag in mechanism.tags.items():
        table, key = _home(tree, address)
        table.setdefault(TAGS, {})[key] = tag
    ordered = (*_FIRST, *(key for key in tree if key not in (*_FIRST, *_LAST)), *_LAST)
    return {key: tree[key] for key in ordered if key in tree}


def plain(node: Node, value: Any, where: str, formulas: Mapping[str, str] | None = None) -> Any:
    """Encode a single value for a file, or its formula if it has one; raises `DesignError` if a file cannot contain the value.

    >>> from flexstage.base.units.quantity import LENGTH
    >>> from flexstage.mechanism.grammar.node import NumberNode
    >>> plain(NumberNode(LENGTH), 0.00154, "parts.neck.thickness")
    '1.54 mm'
    """
    writer = Writer(formulas=formulas or {})
    form = writer.write(node, value, where)
    require(writer.findings)
    return form


def _home(tree: dict[str, Any], address: str) -> tuple[dict[str, Any], str]:
    """Table of a tag, and its key there: of the material, part, unit, ..., or of the whole file."""
    steps = address.split(".")
    section = tree.get(steps[0]) if len(steps) > 2 else None
    table = section.get(steps[1]) if isinstance(section, dict) else None
    return (table, ".".join(steps[2:])) if isinstance(table, dict) else (tree, address)
