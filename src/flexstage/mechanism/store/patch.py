"""Changes of single values in a design file's text, with comments and order preserved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.lazy import LazyModule
from flexstage.mechanism.addresses.address import get, set_text, set_value
from flexstage.mechanism.addresses.locate import Place, canonical, locate
from flexstage.mechanism.addresses.path import member, with_mirror
from flexstage.mechanism.assembly.mount import STAGES
from flexstage.mechanism.grammar.grammar import TAGS, node_of
from flexstage.mechanism.grammar.node import Node
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.decode import mechanism_from, read_design
from flexstage.mechanism.store.encode import plain
from flexstage.mechanism.store.file import parse_toml
from flexstage.mechanism.store.include import INCLUDE, SECTIONS

if TYPE_CHECKING:
    import tomlkit
    import tomlkit.exceptions
else:
    tomlkit = LazyModule("tomlkit")  # not required for reading a file


def patch(text: str, values: Mapping[str, Any], *, where: str = "text") -> str:
    """Return a design file's text with new values by address: strings with units, or SI numbers.

    Comments are preserved. Tags of the old values are removed, because they do not apply to the new values.

    >>> text = 'format = "flexstage 1"' + chr(10) + 'name = "a"  # a stage' + chr(10) + 'max_mode_frequency = "1 kHz"  # enough'
    >>> print(patch(text, {"max_mode_frequency": "800 Hz"}))
    format = "flexstage 1"
    name = "a"  # a stage
    max_mode_frequency = "800 Hz"  # enough
    """
    tree = parse_toml(text, where)
    mechanism = mechanism_from(tree, where)
    require(finding for address in values for finding in _elsewhere(locate(mechanism, address), tree))
    steps: list[_Step] = []
    for address, value in values.items():
        change = set_text if isinstance(value, str) else set_value
        steps.append((mechanism, change(mechanism, address, value), address))
        mechanism = steps[-1][1]
    try:
        return _write(text, [steps], mechanism, where)
    except DesignError:  # some layouts allow only one change at a time
        return _write(text, [[step] for step in steps], mechanism, where)


def _elsewhere(place: Place, tree: dict[str, Any]) -> Iterator[Finding]:
    """Errors for values of a mounted stage; only overrides of them are allowed here."""
    name = place.path[1].partition("/")[0] if len(place.path) > 1 and not place.owners and "/" in place.path[1] else ""
    if name in tree.get(STAGES, {}):
        what = "it is in the file of a mounted stage"
        yield Finding(place.address, what, f"Change it in {tree[STAGES][name]['file']}, or use an override of one link")


_Step = tuple[Mechanism, Mechanism, str]
"""Description before and after a change, and its address."""


def _write(text: str, portions: list[list[_Step]], target: Mechanism, where: str) -> str:
    """The text after all changes, read again after each portion."""
    for steps in portions:
        text = _patch_steps(text, steps)
    if read_design(text, where) != target:
        raise refuse(where, "its table layout does not allow changes of single values", "Rewrite the file with dump")
    return text


def _patch_steps(text: str, steps: list[_Step]) -> str:
    document = tomlkit.parse(text)
    for mechanism, changed, address in steps:
        try:
            _untag(document, mechanism, changed)
            _set(document, mechanism, changed, address)
        except tomlkit.exceptions.TOMLKitError as error:
            raise refuse(address, f"the file cannot be changed at this address: {error}", "Rewrite the file with dump") from None
    return tomlkit.dumps(document)


def _set(document: Any, mechanism: Mechanism, changed: Mechanism, address: str) -> None:
    place = locate(mechanism, address)
    if place.owners:
        _set_overrides(document, mechanism, changed)
        return
    if _is_included(document, place):
        table = document.setdefault("overrides", tomlkit.table())
        table[place.address] = plain(place.node, get(changed, address), place.address, changed.formulas)
        return
    for path in with_mirror(place.path):
        _set_at(document, changed, path)


def _is_included(document: Any, place: Place) -> bool:
    """Whether a value is in an included file: this file changes it in `overrides`."""
    path = place.path
    return INCLUDE in document and len(path) > 1 and path[0] in SECTIONS and path[1] not in document.get(path[0], {})


def _set_overrides(document: Any, mechanism: Mechanism, changed: Mechanism) -> None:
    if "overrides" not in document:
        document["overrides"] = {}
    table = document["overrides"]
    for key in mechanism.overrides.keys() - changed.overrides.keys():
        del table[key]
    for key, value in changed.overrides.items():
        if key not in mechanism.overrides or mechanism.overrides[key] is not value:
            place = locate(changed, key)
            table[key] = plain(place.node, value, place.address, changed.formulas)


def _set_at(document: Any, changed: Mechanism, path: tuple[str, ...]) -> None:
    """Write the changed value at a path, or its nearest container in the file."""
    table: Any = document
    node: Node = node_of(Mechanism)
    value: Any = changed
    for number, name in enumerate(path):
        key = node.key(value, name)
        node, value = node.child(value, name), member(value, name)
        last = number == len(path) - 1
        if last or not (isinstance(key, int) or key in table) or isinstance(table[key], str):
            table[key] = plain(node, value, ".".join(path[: number + 1]), changed.formulas)
            return
        table = table[key]


def _untag(document: Any, mechanism: Mechanism, changed: Mechanism) -> None:
    lost = {canonical(mechanism, key) for key in mechanism.tags.keys() - changed.tags.keys()}
    for table, prefix in list(_tagged_tables(document, "")):
        for key in [key for key in table[TAGS] if canonical(mechanism, prefix + key) in lost]:
            del table[TAGS][key]
        if not table[TAGS]:
            del table[TAGS]


def _tagged_tables(table: Any, prefix: str) -> Iterator[tuple[Any, str]]:
    """Tables with tags, with the prefix of their addresses."""
    if TAGS in table:
        yield table, prefix
    for key, value in table.items():
        if isinstance(value, Mapping) and key != TAGS:
            yield from _tagged_tables(value, f"{prefix}{key}.")
