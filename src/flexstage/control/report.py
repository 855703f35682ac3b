"""The report of a loop: one HTML file that stands alone."""

from __future__ import annotations

import flexstage
from flexstage.base.digest import digest
from flexstage.control.sections import error_section, frequency_section, loop_section, time_section
from flexstage.control.study.study import LoopStudy
from flexstage.show.page import Head, page
from flexstage.show.sections.caveats import caveat_section


def loop_report(found: LoopStudy) -> str:
    """A loop as a page of HTML: block diagram, margins, open loops, sensitivities, poles, steps, trajectories, noise."""
    mechanism = found.settled.mechanism
    origin = (
        ("physics", digest(mechanism, physics=True)[:16]),
        ("model", found.setup.model.value),
        ("rate", f"{found.settled.rate:g} Hz"),
        ("flexstage", flexstage.__version__),
    )
    sections = (
        caveat_section(mechanism, found.cautions),
        loop_section(found),
        frequency_section(found),
        time_section(found),
        error_section(found),
    )
    return page(Head(mechanism.name or "stage", "Control loop", origin), [each for each in sections if each is not None])
