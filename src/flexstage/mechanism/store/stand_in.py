"""Given parts that stand in for drawn ones in a design file's text: the drawn parts are kept under another name, comments stay."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from flexstage.base.finding import Finding, refuse, require
from flexstage.mechanism.checks import checked
from flexstage.mechanism.grammar import TAGS, child, node_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.catalogue import shipped
from flexstage.mechanism.store.decode import mechanism_from
from flexstage.mechanism.store.encode import plain
from flexstage.mechanism.store.file import parse_toml
from flexstage.parts.given import Given

KEPT = "-drawn"


def stood_in(text: str, parts: Mapping[str, Given], tag: str, *, where: str = "text") -> str:
    """The text of a design file with given parts, by name, in the places of drawn ones, which are kept as `<name>-drawn`.

    The new matrices carry `tag`. Raises `DesignError` where links depart from such a part, and where the file's layout does not allow it.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.store import dumps, loads
    >>> unit = tuple(tuple(1e-7 * (row == column) for column in range(6)) for row in range(6))
    >>> text = stood_in(dumps(parallelogram()), {"leaf": Given(unit, free=())}, "derived test")
    >>> loads(text).parts["leaf"].stands_for, "leaf-drawn" in loads(text).parts
    ('leaf-drawn', True)
    """
    before = mechanism_from(parse_toml(text, where), shipped())
    require(_clashes(before, parts))
    try:
        document = tomlkit.parse(text)
        for name, part in parts.items():
            _stand_in(document, name, replace(part, stands_for=name + KEPT), tag)
        after = tomlkit.dumps(document)
    except TOMLKitError as error:
        raise refuse(where, f"the file cannot be changed: {error}", "Write it anew with dump") from None
    found = checked(mechanism_from(parse_toml(after, where), shipped()))
    if any(found.parts.get(name) != replace(part, stands_for=name + KEPT) for name, part in parts.items()):
        raise refuse(where, "its tables are laid out so that parts cannot be exchanged", "Write it anew with dump")
    return after


def _clashes(mechanism: Mechanism, parts: Mapping[str, Given]) -> list[Finding]:
    found = [
        Finding(f"parts.{name}{KEPT}", "there is a part of this name", f"Rename it: the drawn {name} is to be kept under it")
        for name in parts
        if name + KEPT in mechanism.parts
    ]
    links = [(f"{unit}/{name}", link.part) for unit, drawn in mechanism.units.items() for name, link in drawn.links.items()]
    links += [(name, link.part) for name, link in mechanism.links.items()]
    touched = {address: part for address, part in links if part in parts}
    for key in mechanism.changes:
        ends = [address for address in touched if f"/{key}".partition(".")[0].endswith(f"/{address.rpartition('/')[2]}")]
        if ends:
            what = f"it departs from {touched[ends[0]]}, whose 6x6 is shared"
            found.append(Finding(f'change."{key}"', what, "Give that link a part of its own, or take the departure out"))
    return found


def _stand_in(document: Any, name: str, part: Given, tag: str) -> None:
    parts = document["parts"]
    drawn = parts[name]
    node: Any = child(child(node_of(Mechanism), Mechanism(""), "parts"), {name: part}, name)
    table = tomlkit.table()
    values = plain(node, part, f"parts.{name}")
    for key, value in values.items():
        table[key] = _lines(value) if key == "compliance" else value
    table[TAGS] = tomlkit.inline_table()
    table[TAGS].update({"compliance": tag})
    parts[name] = table
    parts[name + KEPT] = drawn
    _rename_tags(document, f"parts.{name}.", f"parts.{name}{KEPT}.")


def _lines(rows: Any) -> Any:
    """A matrix with a line for each row."""
    array = tomlkit.array()
    for row in rows:
        array.append(row)
    return array.multiline(multiline=True)


def _rename_tags(document: Any, old: str, new: str) -> None:
    """Tags at the top of the file that were the drawn part's."""
    tags = document.get(TAGS, {})
    for key in [key for key in tags if str(key).startswith(old)]:
        tags[new + str(key).removeprefix(old)] = tags[key]
        del tags[key]
