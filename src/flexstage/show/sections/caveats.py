"""The section of a report about caveats."""

from __future__ import annotations

from flexstage.analysis.cautions import caveats
from flexstage.base.finding import Finding
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.page import Section, section
from flexstage.show.tables.caveats import caution_table, default_table


def caveat_section(mechanism: Mechanism, more: tuple[Finding, ...] = ()) -> Section | None:
    """Cautions about the description and `more` about the result, and what was taken by default; `None` where there is neither.

    >>> caveat_section(Mechanism("stage")) is None
    True
    """
    found = caveats(mechanism)
    cautions = (*found.cautions, *more)
    return section("Cautions" if cautions else "Taken by default", [caution_table(cautions), default_table(found.defaults)])
