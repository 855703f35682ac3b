"""Lines of a TOML text at which its values stand: for findings that say where."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from flexstage.base.finding import Finding

_HEAD = re.compile(r"\s*\[\[?(?P<name>[^\]]+)\]\]?\s*(#.*)?$")
_KEY = re.compile(r"\s*(?P<name>(?:[\w-]+|\"[^\"]*\"|'[^']*')(?:\s*\.\s*(?:[\w-]+|\"[^\"]*\"|'[^']*'))*)\s*=")
_STEP = re.compile(r"[\w-]+|\"[^\"]*\"|'[^']*'")


def with_lines(findings: Iterable[Finding], text: str, where: str) -> Iterator[Finding]:
    r"""The findings with the file `where` and the line in front of their addresses; of an inline table's entry the table's line.

    >>> found = with_lines([Finding("place.B1.unit", "it is lost", "Find it")], "[place]\nB1 = { unit = 1 }", "stage.toml")
    >>> print(next(found))
    stage.toml: line 2: place.B1.unit: it is lost. Find it.
    """
    lines = line_numbers(text)
    for finding in findings:
        line = line_of(finding.where, lines)
        yield replace(finding, where=f"{where}: {finding.where}" if line is None else f"{where}: line {line}: {finding.where}")


def line_numbers(text: str) -> Mapping[str, int]:
    r"""Line by address, of every table head and every key that starts a line; of tables in a row the first.

    >>> dict(line_numbers("rate = 1\n[floor]\nx.y = 2"))
    {'rate': 1, 'floor': 2, 'floor.x.y': 3}
    """
    found: dict[str, int] = {}
    table = ""
    for number, line in enumerate(text.splitlines(), start=1):
        if (head := _HEAD.match(line)) is not None:
            table = _address(head["name"])
            found.setdefault(table, number)
        elif (key := _KEY.match(line)) is not None:
            name = _address(key["name"])
            found.setdefault(f"{table}.{name}" if table else name, number)
    return found


def _address(name: str) -> str:
    return ".".join(step.strip("\"'") for step in _STEP.findall(name))


def line_of(address: str, lines: Mapping[str, int]) -> int | None:
    """The line of an address, or of the nearest table around it; `None` where the text has neither.

    >>> line_of("parts.neck.thickness", {"parts.neck": 3}), line_of("gravity", {})
    (3, None)
    """
    while address:
        if address in lines:
            return lines[address]
        address = address.rpartition(".")[0]
    return None
