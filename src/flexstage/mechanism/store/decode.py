"""From the tree of a design file to a description: every finding is collected before any is raised."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from flexstage.base.finding import DesignError, Finding, nearest, require
from flexstage.base.number import Table
from flexstage.base.quantity import RATIO
from flexstage.base.unit import parse
from flexstage.mechanism.checks import copy_findings
from flexstage.mechanism.checks.value import number_findings
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
    node_of,
    numbers,
)
from flexstage.mechanism.locate import locate
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.catalogue import Catalogue
from flexstage.spatial.frame import COMPONENTS

FORMAT = "flexstage 1"
_FILES = {FORMAT: "a design file"}
_Record = TypeVar("_Record")

MOST_FINDINGS = 100


class _Bad:
    """Marks a value that could not be read; a finding says why."""


class _EnoughError(Exception):
    """There are so many findings that reading on is of no use."""


_BAD = _Bad()


@dataclass
class Reader:
    """Reads nodes and gathers what it finds: findings, tags by address, and sources that catalogue entries bring along."""

    catalogue: Catalogue
    findings: list[Finding] = field(default_factory=list)
    tags: dict[str, str] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)

    def read(self, node: Node, raw: Any, where: str) -> Any:
        """The value that `raw` means as a `node`; `_BAD` after a finding."""
        try:
            return self._read(node, raw, where)
        except DesignError as error:
            return self.note(error.findings)

    def _read(self, node: Node, raw: Any, where: str) -> Any:
        if isinstance(node, NumberNode):
            return _number(node, raw, where)
        if isinstance(node, DirectionNode):
            return self._direction(raw, where)
        if isinstance(node, TextNode):
            return self._text(raw, where)
        if isinstance(node, WholeNode):
            return self._whole(raw, where)
        if isinstance(node, FlagNode):
            return raw if isinstance(raw, bool) else self.refuse(where, f"found {_kind(raw)}", "Write true or false, without quotes")
        if isinstance(node, ChoiceNode):
            return self._choice(node, raw, where)
        if isinstance(node, (VectorNode, ListNode, MatrixNode)):
            return self._row(node, raw, where)
        return self._table(node, raw, where)

    def refuse(self, where: str, what: str, advice: str) -> _Bad:
        """Note a finding."""
        return self.note([Finding(where, what, advice)])

    def note(self, findings: Iterable[Finding]) -> _Bad:
        """Note findings, up to a number that is of use to anybody."""
        self.findings += findings
        if len(self.findings) >= MOST_FINDINGS:
            raise _EnoughError
        return _BAD

    def _text(self, raw: Any, where: str) -> Any:
        return raw if isinstance(raw, str) else self.refuse(where, f"found {_kind(raw)} where a text is expected", "Write it in quotes")

    def _whole(self, raw: Any, where: str) -> Any:
        whole = isinstance(raw, int) and not isinstance(raw, bool) and abs(raw) < 2**63
        return raw if whole else self.refuse(where, f"found {_kind(raw)} where a whole number is expected", "Write it without quotes")

    def _choice(self, node: ChoiceNode, raw: Any, where: str) -> Any:
        choices = {str(choice.value): choice for choice in node.choices}
        if isinstance(raw, str) and raw in choices:
            return choices[raw]
        return self.refuse(where, f"found {_kind(raw)}", f"It is one of {', '.join(choices)}")

    def _direction(self, raw: Any, where: str) -> Any:
        advice = f"Write one of {', '.join(DIRECTIONS)}, or three numbers without units"
        if isinstance(raw, str):
            return DIRECTIONS.get(raw) or self.refuse(where, f'found "{_short(raw)}" where a direction is expected', advice)
        if not isinstance(raw, list) or len(raw) != 3 or not all(_is_number(item) for item in raw):
            return self.refuse(where, f"found {_kind(raw)} where a direction is expected", advice)
        return tuple(_float(item, where) for item in raw)

    def _row(self, node: VectorNode | ListNode | MatrixNode, raw: Any, where: str) -> Any:
        length = _length(node)
        if not isinstance(raw, list) or (length is not None and len(raw) != length):
            count = f"{length} values" if length is not None else "several values"
            return self.refuse(where, f"found {_kind(raw)} where {count} are expected", f"Write them in brackets: {_example(node)}")
        if isinstance(node, MatrixNode):
            return _all([self._matrix_row(row, item, where) for row, item in enumerate(raw)])
        if isinstance(node, VectorNode):
            return _all([self.read(item, part, f"{where}.{name}") for name, item, part in zip(COMPONENTS, node.items, raw, strict=False)])
        return _all([self.read(node.item, part, where) for part in raw])

    def _matrix_row(self, row: int, raw: Any, where: str) -> Any:
        here = f"{where}.{COMPONENTS[row]}"
        if not isinstance(raw, list) or len(raw) != 6:
            what = f"found {_kind(raw)} where a row of six entries is expected"
            return self.refuse(here, what, 'Write entries such as "2.91 um/N", or 0')
        return _all(
            [
                0.0 if _is_number(part) and part == 0 else self.read(entry(row, column), part, f"{here}.{COMPONENTS[column]}")
                for column, part in enumerate(raw)
            ]
        )

    def _table(self, node: Node, raw: Any, where: str) -> Any:
        if not isinstance(raw, dict):
            return self.refuse(where, f"found {_kind(raw)} where a table is expected", "Write a table: [name] or { key = value }")
        if isinstance(node, UnionNode):
            return self._union(node, raw, where)
        if isinstance(node, RecordNode):
            return self._record(node, raw, where)
        raw = self._untagged(raw, where)
        if isinstance(node, TableNode):
            items = {name: self.read(node.item, part, _join(where, name)) for name, part in raw.items()}
            return _BAD if _BAD in items.values() else Table(items)
        return Table(raw)

    def _untagged(self, raw: dict[str, Any], where: str) -> dict[str, Any]:
        """The table without its tags, which are noted by address."""
        tags = raw.get(TAGS, {})
        if not isinstance(tags, dict) or not all(isinstance(tag, str) for tag in tags.values()):
            self.refuse(_join(where, TAGS), "these are no tags", 'Write for example tags = { thickness = "stated paper 2.2" }')
        else:
            self.tags.update({_join(where, key): tag for key, tag in tags.items()})
        return {key: value for key, value in raw.items() if key != TAGS}

    def _union(self, node: UnionNode, raw: dict[str, Any], where: str) -> Any:
        options = dict(node.options)
        key = node.key or ""
        entry_of = self.catalogue.section(*(option.record for option in options.values()))
        name = raw.get(key, entry_of.kind if entry_of and LIKE in raw else None)
        if name is None:
            return self.refuse(where, f"it has no {key}", f"Write {key} = one of {', '.join(options)}")
        if not isinstance(name, str) or name not in options:
            return self.refuse(_join(where, key), f"found {_kind(name)}", nearest(_kind(name), options))
        return self._record(options[name], {item: value for item, value in raw.items() if item != key}, where)

    def _record(self, node: RecordNode, raw: dict[str, Any], where: str) -> Any:
        known_like = self._like_is_known(node, raw, where)
        raw = self._untagged(self._expanded(node, raw) if known_like else _without_like(raw), where)
        values: dict[str, Any] = {}
        used: set[str] = set()
        for name, slot in node.fields.items():
            key, inner = self._alternative(slot, raw, where)
            if key in raw:
                used.add(key)
                values[name] = self.read(inner, raw[key], _join(where, key))
            elif slot.required and not known_like:
                values[name] = _BAD
            elif slot.required:
                values[name] = self.refuse(where or "file", f"it has no {_wanted(slot)}", f"Write for example {_example_of(slot)}")
            else:
                values[name] = slot.default
        known = [key for slot in node.fields.values() for key in _keys(slot)]
        for key in [key for key in raw if key not in used]:
            self.refuse(_join(where, key), "this key is not known here", nearest(key, set(known) - used or known))
        return _BAD if _BAD in values.values() else node.record(**values)

    def _alternative(self, slot: Slot, raw: dict[str, Any], where: str) -> tuple[str, Node]:
        """The key under which a field stands, and its node: the name of an alternative where that replaces the field's own."""
        if not isinstance(slot.node, UnionNode) or slot.node.key is not None:
            return slot.key, slot.node
        present = [(name, option) for name, option in slot.node.options if name in raw]
        if len(present) > 1:
            names = " and ".join(name for name, _ in present)
            self.refuse(where, f"it has both {names}", "Leave one of them")
        return present[0] if present else (slot.key, slot.node)

    def _like_is_known(self, node: RecordNode, raw: dict[str, Any], where: str) -> bool:
        """Whether what `like` names is in the catalogue, if anything is; what an unknown entry would have brought is not missed besides."""
        section = self.catalogue.section(node.record)
        if section is None or LIKE not in raw:
            return True
        name = raw[LIKE]
        known = isinstance(name, str) and name in section.entries
        if not known:
            self.refuse(_join(where, LIKE), f"the catalogue has no {_kind(name)}", nearest(_kind(name), section.entries))
        return known

    def _expanded(self, node: RecordNode, raw: dict[str, Any]) -> dict[str, Any]:
        """The table with what its `like` brings along, overridden by what stands in it."""
        section = self.catalogue.section(node.record)
        if section is None or LIKE not in raw:
            return raw
        name = raw[LIKE]
        shipped = section.entries[name]
        tags = {key: tag for key, tag in shipped.get(TAGS, {}).items() if key not in raw}
        self.sources.update(self.catalogue.sources_of(tags.values()))
        own = raw.get(TAGS, {})
        merged = {"source": f"{name} of the catalogue"} | dict(shipped) | raw | {TAGS: tags | own if isinstance(own, dict) else own}
        return _without_like(merged)


def _without_like(raw: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in raw.items() if key != LIKE}


def mechanism_from(raw: dict[str, Any], catalogue: Catalogue) -> Mechanism:
    """Return the description that a file's tree means; raises `DesignError` with everything that is wrong with it.

    >>> from flexstage.mechanism.store.catalogue import shipped
    >>> mechanism_from({"format": "flexstage 1", "name": "empty"}, shipped()).name
    'empty'
    """
    reader = Reader(catalogue)
    mechanism: Any = None
    try:
        mechanism = _mechanism(reader, raw)
    except _EnoughError:
        reader.findings.append(Finding("file", f"there are {MOST_FINDINGS} findings or more", "Mend these first"))
    require(reader.findings)
    return mechanism


def record_from(record: type[_Record], raw: dict[str, Any], form: str) -> _Record:
    """Return the record that a tree means whose `format` is to be `form`; raises `DesignError` with everything that is wrong with it.

    Its fields are annotated as those of descriptions are.

    >>> from flexstage.parts.rod import Rod
    >>> record_from(Rod, {"format": "rod 1", "material": "steel", "length": "3 mm", "diameter": "1 mm"}, "rod 1").length
    0.003
    """
    reader = Reader(Catalogue((), {}))
    _check_format(reader, raw, form)
    value: Any = _BAD
    try:
        value = reader.read(node_of(record), {key: part for key, part in raw.items() if key != "format"}, "")
        for address, number, node in () if value is _BAD else numbers(node_of(record), value):
            reader.note(number_findings(address, number, node))
    except _EnoughError:
        reader.findings.append(Finding("file", f"there are {MOST_FINDINGS} findings or more", "Mend these first"))
    require(reader.findings)
    return value


def _check_format(reader: Reader, raw: dict[str, Any], form: str) -> None:
    found = raw.get("format")
    if found != form:
        what = f"found {_kind(found)}" if found is not None else "the file does not say its format"
        reader.refuse("format", what, f'The first line of {_FILES.get(form, "such a file")} is format = "{form}"')


def _mechanism(reader: Reader, raw: dict[str, Any]) -> Any:
    _check_format(reader, raw, FORMAT)
    body = {key: value for key, value in raw.items() if key not in ("format", "change")}
    mechanism = reader.read(node_of(Mechanism), body, "")
    if not isinstance(mechanism, Mechanism):
        return _BAD
    if faults := tuple(copy_findings(mechanism)):
        return reader.note(faults)
    changes = raw.get("change", {})
    values = _changes(reader, mechanism, changes) if isinstance(changes, dict) else reader.read(ChangesNode(), changes, "change")
    sources = reader.sources | dict(mechanism.sources)
    return replace(mechanism, changes=values, tags=Table(reader.tags), sources=Table(sources))


def _changes(reader: Reader, mechanism: Mechanism, raw: dict[str, Any]) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for address, value in raw.items():
        where = f'change."{_short(address)}"'
        if address == TAGS:
            reader.refuse(where, "this is no address", "Tags of changes stand in [tags], by address")
            continue
        try:
            values[address] = reader.read(locate(mechanism, address).node, value, where)
        except DesignError as error:
            reader.note(replace(finding, where=where) for finding in error.findings)
    return values


def _number(node: NumberNode, raw: Any, where: str) -> float:
    example = f'Write for example "{node.quantity.example}"'
    if isinstance(raw, str):
        return parse(raw, node.quantity, where=where)
    if not _is_number(raw):
        raise DesignError([Finding(where, f"found {_kind(raw)} where {node.quantity.noun} is expected", example)])
    if node.quantity is not RATIO:
        raise DesignError([Finding(where, f"found {_kind(raw)} without a unit", example)])
    return _float(raw, where)


def _float(raw: float, where: str) -> float:
    try:
        value = float(raw)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise DesignError([Finding(where, f"found {_kind(raw)}, which is not finite", "Give a finite number")])
    return value


def _is_number(raw: Any) -> bool:
    return isinstance(raw, (int, float)) and not isinstance(raw, bool)


def _all(items: list[Any]) -> Any:
    return _BAD if any(item is _BAD for item in items) else tuple(items)


def _join(where: str, name: str) -> str:
    return f"{where}.{name}" if where else name


def _short(raw: Any) -> str:
    text = str(raw)
    return text if len(text) <= 40 else f"{text[:40]}..."


def _kind(raw: Any) -> str:
    if isinstance(raw, bool):
        return str(raw).lower()
    if isinstance(raw, int) and raw.bit_length() > 128:
        return "a number of many digits"
    if isinstance(raw, dict):
        return "a table"
    if isinstance(raw, list):
        return f"{len(raw)} values in brackets"
    return f'"{_short(raw)}"' if isinstance(raw, str) else _short(raw)


def _length(node: VectorNode | ListNode | MatrixNode) -> int | None:
    if isinstance(node, VectorNode):
        return len(node.items)
    return 6 if isinstance(node, MatrixNode) else node.length


def _keys(slot: Slot) -> list[str]:
    if isinstance(slot.node, UnionNode) and slot.node.key is None:
        return [name for name, _ in slot.node.options]
    return [slot.key]


def _wanted(slot: Slot) -> str:
    return " or ".join(_keys(slot))


def _example_of(slot: Slot) -> str:
    return f"{_keys(slot)[0]} = {_example(slot.node)}"


def _example(node: Node) -> str:
    """A text as it may stand in a file."""
    if isinstance(node, NumberNode):
        return node.quantity.example if node.quantity is RATIO else f'"{node.quantity.example}"'
    if isinstance(node, (VectorNode, ListNode)):
        items = node.items if isinstance(node, VectorNode) else [node.item] * (node.length or 1)
        return f"[{', '.join(_example(item) for item in items)}]"
    if isinstance(node, ChoiceNode):
        return f'"{next(iter(node.choices)).value}"'
    if isinstance(node, UnionNode) and node.key:
        return f'{{ {node.key} = "{node.options[0][0]}", ... }}'
    fixed: dict[type, str] = {
        DirectionNode: '"x"',
        WholeNode: "1",
        FlagNode: "true",
        TextNode: '"a name"',
        MatrixNode: '[["2.91 um/N", 0, 0, 0, 0, 0], ...]',
    }
    return fixed.get(type(node), "{ ... }")
