"""Text of a design file: TOML with a heading per table, short tables on one line, and comments."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from flexstage.base.finding import refuse
from flexstage.mechanism.grammar.grammar import TAGS

_WIDTH = 140
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_HEADED = ("materials", "parts", "bodies", "units", "sensors")
"""Sections with a heading for each entry; entries of other sections are on one line if they fit."""

HEADINGS: Mapping[str, str] = {
    "numbers": "Named numbers for formulas in this file.",
    "materials": "Materials: Young's modulus, Poisson's ratio and density; like = \"...\" uses a catalogue entry.",
    "parts": "Parts: one entry per distinct part; links refer to parts by name.",
    "bodies": "Bodies of the stage. The ground exists implicitly; the stage positions the platform.",
    "links": "Links of the stage: joined bodies (first, second) and position.",
    "units": "Subassemblies in local frames, x = output direction. A link joins two bodies; bends = axis of compliant rotation.",
    "placements": "Instances of the units. first = position angle of the first instance; facing = its output direction.",
    "sensors": "Gauges (displacement sensors) from the catalogue, or with their data.",
    "gauges": "Positions of the gauges: x of each instance points from the gauge to its target.",
    "payloads": "Masses carried by bodies; their centres (at) are in the stage's coordinates.",
    "forces": "Constant forces; points (at) and components are in the stage's coordinates.",
    "stops": "Stops: each lets its body move by `gap` along x of the instance, relative to the base.",
    "paths": "Load paths for requirements at large displacements, from the static equilibrium.",
    "temperatures": "Temperature changes since manufacture, by body; `all` is for all other bodies.",
    "overrides": "Overrides: unit/link.field for all instances, instance/link.field for one instance.",
    "requirements": "Requirements: evaluated first in every report.",
    "sources": "Sources of tags. A value without a tag is assumed.",
}
"""Default comments above the sections of a file."""


def text_of(tree: Mapping[str, Any], comments: Mapping[str, str]) -> str:
    """Return the TOML text of a file's tree, with comments by address; raises `DesignError` for a comment of an unknown address.

    >>> print(text_of({"name": "a", "placements": {"B1": {"unit": "u"}}}, {"placements": "copies"}), end="")
    name = "a"
    <BLANKLINE>
    # copies
    [placements]
    B1 = { unit = "u" }
    """
    writer = _Writer({**{key: text for key, text in HEADINGS.items() if key in tree}, **comments})
    lines = [*writer.comment(""), *writer.table((), tree)]
    if writer.comments:
        raise refuse(f"comment on {next(iter(writer.comments))}", "unknown address in the file", "Use the address of a table or a value")
    return "\n".join(lines).lstrip("\n") + "\n"


class _Writer:
    """Writer of tables and their comments."""

    def __init__(self, comments: Mapping[str, str]) -> None:
        self.comments = dict(comments)

    def comment(self, address: str) -> list[str]:
        """Comment lines of an address, if any."""
        text = self.comments.pop(address, None)
        return [f"# {_printable(line)}".rstrip() for line in text.splitlines()] if text else []

    def table(self, path: tuple[str, ...], table: Mapping[str, Any]) -> Iterator[str]:
        """Lines of a table, then its headed tables."""
        headed = _headed_entries(path, table)
        for key, value in table.items():
            if key not in headed:
                yield from self.comment(".".join((*path, key)))
                yield _line(key, value)
        for key, value in headed.items():
            yield from self.headed_table((*path, key), value)

    def headed_table(self, path: tuple[str, ...], table: Mapping[str, Any]) -> Iterator[str]:
        """A table with its heading, unless it has only headed tables."""
        comment = self.comment(".".join(path))
        if comment:
            yield from ["", *comment]
        if len(_headed_entries(path, table)) < len(table) or not table:
            if not comment:
                yield ""
            yield f"[{'.'.join(_key(step) for step in path)}]"
        yield from self.table(path, table)


def _headed_entries(path: tuple[str, ...], table: Mapping[str, Any]) -> dict[str, Any]:
    """Entries with a heading. In a table of tables all have one or none, to preserve the order of instances and links."""
    headed = {key: value for key, value in table.items() if _is_headed((*path, key), value)}
    return dict(table) if headed and path and all(isinstance(value, dict) for value in table.values()) else headed


def _is_headed(path: tuple[str, ...], value: Any) -> bool:
    """Whether a table has a heading: sections, entries of some, bodies and links of units, and tables too long for one line."""
    if not isinstance(value, dict):
        return False
    if len(path) == 1:
        return path[0] in HEADINGS or path[0] == TAGS
    if path[0] in _HEADED and (len(path) == 2 or (path[0] == "units" and len(path) == 3)):
        return path[-1] != TAGS or len(path) == 2
    return len(_line(path[-1], value)) > _WIDTH or _is_long(value)


def _is_long(value: Any) -> bool:
    """Whether a table has a matrix, which requires several lines."""
    return any(_is_matrix(item) or (isinstance(item, dict) and _is_long(item)) for item in value.values())


def _is_matrix(value: Any) -> bool:
    return isinstance(value, list) and any(isinstance(item, list) for item in value)


def _line(key: str, value: Any) -> str:
    if _is_matrix(value):
        return "\n".join([f"{_key(key)} = [", *(f"    {_value(row)}," for row in value), "]"])
    return f"{_key(key)} = {_value(value)}"


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _quote(key)


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(key)} = {_value(item)}' for key, item in value.items())} }}" if value else "{}"
    if isinstance(value, list):
        return f"[{', '.join(_value(item) for item in value)}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return _quote(value) if isinstance(value, str) else repr(value)


def _quote(text: str) -> str:
    """A TOML basic string: a JSON string with an escaped delete character."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _printable(text: str) -> str:
    return "".join(sign if sign.isprintable() else " " for sign in text)
