"""Tables of warnings and defaults."""

from __future__ import annotations

from collections.abc import Sequence

from flexstage.base.finding import Finding
from flexstage.show.table import Table, row_table


def warning_table(found: Sequence[Finding], title: str = "Warnings") -> Table | None:
    """Tabulate warnings, or default values, each with its location and advice; `None` if there are none.

    >>> warning_table([Finding("B4/pivot", "it is thin", "Thicken it")]).texts()
    [['where', 'what', 'advice'], ['B4/pivot', 'it is thin', 'Thicken it']]
    """
    return row_table(title, found, "where", "what", "advice") if found else None
