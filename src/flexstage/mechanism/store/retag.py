"""Insertion of tags in a design file's text, with comments and order preserved."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from flexstage.base.finding import refuse
from flexstage.base.lazy import LazyModule
from flexstage.base.storage.digest import digest
from flexstage.mechanism.addresses.address import tag_of
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.grammar.formulas import NUMBERS
from flexstage.mechanism.grammar.grammar import TAGS
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.decode import read_design

if TYPE_CHECKING:
    import tomlkit
    import tomlkit.exceptions
    import tomlkit.items
else:
    tomlkit = LazyModule("tomlkit")  # not required for reading a file


def set_tags(text: str, tags: Mapping[str, str], *, where: str = "text") -> str:
    """Return a design file's text with `tags` by address, written in the tables of the values; tags of overrides are in `[tags]`.

    Raises `DesignError` if the layout of the file does not allow these tags.

    >>> text = 'format = "flexstage 1"' + chr(10) + 'name = "a"' + chr(10) + 'max_mode_frequency = "1 kHz"  # enough' + chr(10)
    >>> print(set_tags(text, {"max_mode_frequency": "derived test"}))
    format = "flexstage 1"
    name = "a"
    max_mode_frequency = "1 kHz"  # enough
    <BLANKLINE>
    [tags]
    max_mode_frequency = "derived test"
    <BLANKLINE>
    """
    mechanism = read_design(text, where)
    together = _with_tags(text, mechanism, tags, where, beside=True)
    return _one_by_one(text, mechanism, tags, where) if together is None else together


def _one_by_one(text: str, mechanism: Mechanism, tags: Mapping[str, str], where: str) -> str:
    """Each next to its value if the file's layout allows it, else in the table of all tags."""
    for address, tag in tags.items():
        ways = (_with_tags(text, mechanism, {address: tag}, where, beside=beside) for beside in (True, False))
        result = next((way for way in ways if way is not None), None)
        if result is None:
            raise refuse(address, "the file's table layout does not allow a tag at this address", "Rewrite the file with dump")
        text = result
    return text


def _with_tags(text: str, mechanism: Mechanism, tags: Mapping[str, str], where: str, *, beside: bool) -> str | None:
    """The text with these tags; `None` if other values change."""
    try:
        document = tomlkit.parse(text)
        for address, tag in tags.items():
            place = locate(mechanism, address)
            path = (NUMBERS, place.number) if place.number else place.path
            _put(document, path if beside and not place.owners else (), place.address, tag)
        result = tomlkit.dumps(document)
        now = read_design(result, where)
    except (tomlkit.exceptions.TOMLKitError, ValueError):  # a DesignError is a ValueError
        return None
    told = all(tag_of(now, address) == tag for address, tag in tags.items())
    alike = now.overrides == mechanism.overrides and digest(now, physics=True) == digest(mechanism, physics=True)
    return result if told and alike else None


def _put(document: Any, path: tuple[str, ...], address: str, tag: str) -> None:
    table, depth = document, 0
    while depth < len(path) - 1 and isinstance(table.get(path[depth]), Mapping):
        table, depth = table[path[depth]], depth + 1
    key = ".".join(path[depth:]) or address
    old = table.get(TAGS)
    if depth and (old is None or isinstance(old, tomlkit.items.InlineTable)):  # a new one: removals from the old one leave blanks
        table[TAGS] = tomlkit.inline_table()
        table[TAGS].update({**(old or {}), key: tag})
        return
    if old is None:
        table[TAGS] = tomlkit.table()
    table[TAGS][key] = tag
