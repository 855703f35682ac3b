"""The report of the solid model: one HTML file that stands alone."""

from __future__ import annotations

from collections.abc import Iterable

import flexstage
from flexstage.base.digest import digest
from flexstage.base.finding import Finding
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.page import Head, Section, page
from flexstage.show.sections.caveats import caveat_section


def solid_report(mechanism: Mechanism, sections: Iterable[Section | None], cautions: tuple[Finding, ...] = ()) -> str:
    """Sections of the solid model as a page of HTML, after cautions about the description and `cautions` about the result.

    Sections that are absent are left out.

    >>> solid_report(Mechanism("stage"), [None])[:15]
    '<!doctype html>'
    """
    origin = (
        ("model", "solid"),
        ("physics", digest(mechanism, physics=True)[:16]),
        ("document", digest(mechanism)[:16]),
        ("flexstage", flexstage.__version__),
    )
    head = Head(mechanism.name or "stage", "A flexure stage as solids", origin)
    return page(head, [each for each in (caveat_section(mechanism, cautions), *sections) if each is not None])
