"""Line numbers of the values of a TOML text, for errors."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from flexstage.base.finding import Finding

_HEAD = re.compile(r"\s*\[\[?(?P<name>[^\]]+)\]\]?\s*(#.*)?$")
_KEY = re.compile(r"\s*(?P<name>(?:[\w-]+|\"[^\"]*\"|'[^']*')(?:\s*\.\s*(?:[\w-]+|\"[^\"]*\"|'[^']*'))*)\s*=")
_STEP = re.compile(r"[\w-]+|\"[^\"]*\"|'[^']*'")
_PLACE = re.compile(r"(?P<file>.*?):(?P<line>\d+)(?::(?P<column>\d+))?(?:: (?P<address>.*))?", re.DOTALL)
_OWNER = re.compile(r"(?P<owner>[^/.\s]+)/(?P<name>[^/.\s]+)(?:\.(?P<rest>.*))?")


def with_lines(findings: Iterable[Finding], text: str, where: str) -> Iterator[Finding]:
    r"""Yield the errors with the file `where` and the line in front of their addresses. A key of an inline table has the table's line.

    >>> result = with_lines([Finding("placements.B1.unit", "it is lost", "Find it")], "[placements]\nB1 = { unit = 1 }", "stage.toml")
    >>> print(next(result))
    stage.toml:2: placements.B1.unit: it is lost. Find it.
    """
    lines = line_numbers(text)
    for finding in findings:
        line = line_of(finding.where, lines)
        yield replace(finding, where=f"{where}: {finding.where}" if line is None else f"{where}:{line}: {finding.where}")


@dataclass(frozen=True)
class Spot:
    """Position of an error: its address, and the line and column in the file if known."""

    address: str
    line: int | None = None
    column: int | None = None


def spot_of(finding: Finding, where: str) -> Spot:
    """Return the position of an error in the file `where`. For an error in another file, the address includes that file's name.

    >>> spot_of(Finding("stage.toml:2: placements.B1.unit", "it is lost", "Find it"), "stage.toml")
    Spot(address='placements.B1.unit', line=2, column=None)
    """
    result = _PLACE.fullmatch(finding.where)
    if result is None or result["file"] != where:
        return Spot(finding.where.removeprefix(f"{where}: "))
    return Spot(result["address"] or "", int(result["line"]), None if result["column"] is None else int(result["column"]))


def line_of(address: str, lines: Mapping[str, int]) -> int | None:
    """Return the line of an address. Without a line, return the line of the nearest enclosing table or of its first key, or `None`.

    For a link of an instance, the line is that of the link in the unit.

    >>> line_of("B1/front.thickness", {"units": 1, "units.lever.links.front": 4, "placements.B1": 9}), line_of("gravity", {})
    (4, None)
    >>> line_of('tags."parts.leaf.width"', {"parts.leaf": 2, "parts.leaf.width": 3, "parts.leaf.tags.width": 5})
    5
    """
    around = (table for each in _ways(address.replace('"', ""), lines) for table in _tables(each) if table != "tags")
    return next((lines[table] for table in around if table in lines), None)


def _tables(address: str) -> Iterator[str]:
    """An address and its enclosing tables, innermost first."""
    while address:
        yield address
        address = address.rpartition(".")[0]


def _ways(address: str, lines: Mapping[str, int]) -> Iterator[str]:
    """An address, and for a link in a unit or an instance (`B4/pivot.at`) its possible addresses in the file, nearest first."""
    result = _OWNER.fullmatch(address)
    if result is None:
        yield from (each for each in lines if ".tags." in each and f"tags.{each.replace('.tags.', '.', 1)}" == address)
        yield from (address, address.removeprefix("tags."))
        yield from (f"{kind}.{address}" for kind in ("bodies", "links") if f"{kind}.{address.partition('.')[0]}" in lines)
        yield from (each for each in lines if each.startswith(f"{address}."))
        return
    owner, name, rest = result["owner"], result["name"], result["rest"]
    link = f".links.{name}"
    drawn = [each for each in lines if each.startswith("units.") and each.endswith(link)]
    unit = f"units.{owner}{link}" if f"units.{owner}{link}" in drawn else drawn[0] if len(drawn) == 1 else None
    yield from (each for each in (f"overrides.{address}", f"placements.{owner}") if each in lines and unit is None)
    yield from (f"{unit}.{rest}" if rest else unit,) if unit else (f"placements.{owner}",)


def line_numbers(text: str) -> Mapping[str, int]:
    r"""Return the line numbers of table headings, and of keys that begin a line, by address; for a repeated heading, the first line.

    >>> dict(line_numbers("rate = 1\n[floor]\nx.y = 2"))
    {'rate': 1, 'floor': 2, 'floor.x.y': 3}
    """
    result: dict[str, int] = {}
    table = ""
    for number, line in enumerate(text.splitlines(), start=1):
        if (head := _HEAD.match(line)) is not None:
            table = _address(head["name"])
            result.setdefault(table, number)
        elif (key := _KEY.match(line)) is not None:
            name = _address(key["name"])
            result.setdefault(f"{table}.{name}" if table else name, number)
    return result


def _address(name: str) -> str:
    return ".".join(step.strip("\"'") for step in _STEP.findall(name))
