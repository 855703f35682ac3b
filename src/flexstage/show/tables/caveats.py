"""Tables of caveats: warnings, and what was taken by default."""

from __future__ import annotations

from collections.abc import Sequence

from flexstage.base.finding import Finding
from flexstage.show.table import Cell, Mark, Table, make_table


def warning_table(found: Sequence[Finding]) -> Table | None:
    """What is doubtful, and what to do; `None` where nothing is.

    >>> warning_table([Finding("B4/pivot", "it is thin", "Thicken it")]).texts()
    [['where', 'what', 'what to do'], ['B4/pivot', 'it is thin', 'Thicken it']]
    """
    return _table("Warnings", "what to do", Mark.WARN, found)


def default_table(found: Sequence[Finding]) -> Table | None:
    """What the description leaves open, as it was taken; `None` where nothing is.

    >>> default_table([]) is None
    True
    """
    return _table("Taken by default", "how to state it", Mark.STRONG, found)


def _table(title: str, advice: str, mark: Mark, findings: Sequence[Finding]) -> Table | None:
    rows = [(Cell(each.where, mark), each.what, each.advice) for each in findings]
    return make_table(title, ["where", "what", advice], rows) if rows else None
