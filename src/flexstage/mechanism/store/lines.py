"""Lines of a TOML text at which its values stand: for findings that say where."""

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
    r"""The findings with the file `where` and the line in front of their addresses; of an inline table's entry the table's line.

    >>> found = with_lines([Finding("placements.B1.unit", "it is lost", "Find it")], "[placements]\nB1 = { unit = 1 }", "stage.toml")
    >>> print(next(found))
    stage.toml:2: placements.B1.unit: it is lost. Find it.
    """
    lines = line_numbers(text)
    for finding in findings:
        line = line_of(finding.where, lines)
        yield replace(finding, where=f"{where}: {finding.where}" if line is None else f"{where}:{line}: {finding.where}")


@dataclass(frozen=True)
class Spot:
    """Where a finding points: the address alone, and the line and column of the file if it says them."""

    address: str
    line: int | None = None
    column: int | None = None


def spot_of(finding: Finding, where: str) -> Spot:
    """Where in the file `where` a finding points; the whole of its own words where that is another file.

    >>> spot_of(Finding("stage.toml:2: placements.B1.unit", "it is lost", "Find it"), "stage.toml")
    Spot(address='placements.B1.unit', line=2, column=None)
    """
    found = _PLACE.fullmatch(finding.where)
    if found is None or found["file"] != where:
        return Spot(finding.where.removeprefix(f"{where}: "))
    return Spot(found["address"] or "", int(found["line"]), None if found["column"] is None else int(found["column"]))


def line_of(address: str, lines: Mapping[str, int]) -> int | None:
    """The line of an address, of the nearest table around it, or of the first key in it; of a link the line that draws it (`None`: none).

    >>> line_of("B1/front.thickness", {"units": 1, "units.lever.links.front": 4, "placements.B1": 9}), line_of("gravity", {})
    (4, None)
    """
    around = (table for each in _ways(address.replace('"', ""), lines) for table in _tables(each) if table != "tags")
    return next((lines[table] for table in around if table in lines), None)


def _tables(address: str) -> Iterator[str]:
    """An address and the tables around it, from the inside out."""
    while address:
        yield address
        address = address.rpartition(".")[0]


def _ways(address: str, lines: Mapping[str, int]) -> Iterator[str]:
    """An address, and for that of a link in a unit or a copy (`B4/pivot.at`) what it may be in the file, the nearest first."""
    found = _OWNER.fullmatch(address)
    if found is None:
        yield from (address, address.removeprefix("tags."))
        yield from (f"{kind}.{address}" for kind in ("bodies", "links") if f"{kind}.{address.partition('.')[0]}" in lines)
        yield from (each for each in lines if each.startswith(f"{address}."))
        return
    owner, name, rest = found["owner"], found["name"], found["rest"]
    link = f".links.{name}"
    drawn = [each for each in lines if each.startswith("units.") and each.endswith(link)]
    unit = f"units.{owner}{link}" if f"units.{owner}{link}" in drawn else drawn[0] if len(drawn) == 1 else None
    yield from (each for each in (f"overrides.{address}", f"placements.{owner}") if each in lines and unit is None)
    yield from (f"{unit}.{rest}" if rest else unit,) if unit else (f"placements.{owner}",)


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
