"""The report of the solid model: one self-contained HTML file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from flexstage.base.finding import Finding
from flexstage.base.storage.digest import digest
from flexstage.base.version import __version__
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.page import Head, Headline, Section, page
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.stage import stage_section
from flexstage.show.viewer.data import stage_data
from flexstage.show.viewer.motions import Motion


def solid_report(
    mechanism: Mechanism,
    said: Headline,
    sections: Iterable[Section | None],
    warnings: tuple[Finding, ...] = (),
    more: tuple[Motion, ...] = (),
) -> str:
    """Return sections of the solid model as an HTML page: headline, stage, first section, warnings, other sections.

    `warnings` about the result precede the warnings about the description. Sections that are `None` are left out. `more` contains motions
    that the viewer shows in addition to the motions by theory.

    >>> solid_report(Mechanism("stage"), Headline(""), [None])[:15]
    '<!doctype html>'
    """
    origin = (
        ("model", "solid"),
        ("physics", digest(mechanism, physics=True)[:16]),
        ("document", digest(mechanism)[:16]),
        ("flexstage", __version__),
    )
    head = Head(mechanism.name or "stage", "A flexure stage as solids", origin, said)
    first, *rest = sections
    data = stage_data(mechanism)
    data = replace(data, motions=(*data.motions, *more))
    shown = (stage_section(data), first, caveat_section(mechanism, warnings), *rest)
    return page(head, shown, {"stage": data})
