"""The text of a design file: tidy TOML, each table headed, short tables on one line, comments where they help."""

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
"""Sections whose entries have a heading each; entries of the others stand on one line where they fit."""

HEADINGS: Mapping[str, str] = {
    "numbers": "Numbers by name: formulas anywhere in this file may refer to them.",
    "materials": "Materials: Young's modulus, Poisson's ratio and density; like = \"...\" starts from the catalogue.",
    "parts": "Parts: one entry per distinct part; links refer to it by name.",
    "bodies": "Bodies of the stage. The ground is implied; the platform is the moving part.",
    "links": "Links of the stage itself: what they join, first to second, and where.",
    "units": "Units: drawn once in their own frame, x = push. A link joins two bodies; bends = axis of the compliant rotation.",
    "placements": "Copies of the units. first = position angle of the first copy; facing = where its push points.",
    "sensors": "Gauges of the catalogue or by their data.",
    "gauges": "Where the gauges read: x of each copy points from the gauge to its target.",
    "payloads": "Masses carried by bodies, in the stage's frame.",
    "forces": "Constant forces, in the stage's frame.",
    "stops": "Gaps at which strokes end: the body may move by gap along x of each copy against its base.",
    "paths": "Strokes at large displacements, from where the stage rests: what requirements over a stroke are judged along.",
    "temperatures": "Changes of temperature since the stage was made, by body; all: of what has none of its own.",
    "overrides": "Overrides: unit/link.field for all copies, copy/link.field for one.",
    "requirements": "Judged first in every report.",
    "sources": "Sources that tags name. A value without tag is assumed.",
}
"""Comments above the sections of a file that has none of its own."""


def text_of(tree: Mapping[str, Any], comments: Mapping[str, str]) -> str:
    """Return the TOML text of a file's tree, with comments by address; raises `DesignError` for a comment that has no place.

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
        raise refuse(f"comment on {next(iter(writer.comments))}", "the file has nothing under this address", "Address a table or a value")
    return "\n".join(lines).lstrip("\n") + "\n"


class _Writer:
    """Writes tables and uses up the comments."""

    def __init__(self, comments: Mapping[str, str]) -> None:
        self.comments = dict(comments)

    def comment(self, address: str) -> list[str]:
        """The lines of the comment on an address, if any."""
        text = self.comments.pop(address, None)
        return [f"# {_printable(line)}".rstrip() for line in text.splitlines()] if text else []

    def table(self, path: tuple[str, ...], table: Mapping[str, Any]) -> Iterator[str]:
        """The table's own lines, then its headed tables."""
        headed = _headed_entries(path, table)
        for key, value in table.items():
            if key not in headed:
                yield from self.comment(".".join((*path, key)))
                yield _line(key, value)
        for key, value in headed.items():
            yield from self.headed_table((*path, key), value)

    def headed_table(self, path: tuple[str, ...], table: Mapping[str, Any]) -> Iterator[str]:
        """A table with its heading; none where it only holds headed tables."""
        comment = self.comment(".".join(path))
        if comment:
            yield from ["", *comment]
        if len(_headed_entries(path, table)) < len(table) or not table:
            if not comment:
                yield ""
            yield f"[{'.'.join(_key(step) for step in path)}]"
        yield from self.table(path, table)


def _headed_entries(path: tuple[str, ...], table: Mapping[str, Any]) -> dict[str, Any]:
    """The entries with a heading of their own. Of a table of tables all have one or none: the order of copies and links stays."""
    headed = {key: value for key, value in table.items() if _is_headed((*path, key), value)}
    return dict(table) if headed and path and all(isinstance(value, dict) for value in table.values()) else headed


def _is_headed(path: tuple[str, ...], value: Any) -> bool:
    """Whether a table has a heading of its own: sections, entries of some, bodies and links of units, and what does not fit on a line."""
    if not isinstance(value, dict):
        return False
    if len(path) == 1:
        return path[0] in HEADINGS or path[0] == TAGS
    if path[0] in _HEADED and (len(path) == 2 or (path[0] == "units" and len(path) == 3)):
        return path[-1] != TAGS or len(path) == 2
    return len(_line(path[-1], value)) > _WIDTH or _is_long(value)


def _is_long(value: Any) -> bool:
    """Whether a table holds a matrix, which takes several lines."""
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
    """A TOML basic string: that of JSON, with delete escaped too."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _printable(text: str) -> str:
    return "".join(sign if sign.isprintable() else " " for sign in text)
