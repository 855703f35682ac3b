"""The section of a report about warnings and default values."""

from __future__ import annotations

from flexstage.analysis.caveats import caveats
from flexstage.base.finding import Finding, combine_warnings
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.page import Section, section
from flexstage.show.tables.caveats import warning_table


def caveat_section(mechanism: Mechanism, more: tuple[Finding, ...] = ()) -> Section | None:
    """Make the section of warnings about the description and the result (`more`), and of default values; `None` if it is empty.

    >>> caveat_section(Mechanism("stage")) is None
    True
    """
    found = caveats(mechanism)
    warnings = combine_warnings((*found.warnings, *more))
    taken = "Default values"
    return section("Warnings" if warnings else taken, [warning_table(warnings), warning_table(found.defaults, taken)])
