"""The report of a loop: one HTML file that stands alone."""

from __future__ import annotations

from dataclasses import replace

import flexstage
from flexstage.base.digest import digest
from flexstage.control.playing import response_motions
from flexstage.control.sections import error_section, frequency_section, headline, loop_section, time_section
from flexstage.control.study.study import LoopStudy
from flexstage.show.page import Head, page
from flexstage.show.scene.stage import scene
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.stage import first_motion, stage_section
from flexstage.show.viewer.data import stage_data
from flexstage.show.viewer.motions import Group


def loop_report(found: LoopStudy) -> str:
    """A loop as a page of HTML: verdict, block diagram, margins, open loops, sensitivities, poles, steps, trajectories, noise."""
    mechanism = found.settled.mechanism
    origin = (
        ("physics", digest(mechanism, physics=True)[:16]),
        ("model", found.setup.model.value),
        ("rate", f"{found.settled.rate:g} Hz"),
        ("flexstage", flexstage.__version__),
    )
    data = stage_data(mechanism)
    data = replace(data, motions=(*response_motions(found, data), *data.motions))
    played = next((f"{each.group.value} {each.name}" for each in data.motions if each.group is Group.RESPONSE), "")
    sections = (
        stage_section(scene(mechanism), motion=played or first_motion(data)),
        loop_section(found),
        caveat_section(mechanism, found.cautions),
        frequency_section(found),
        time_section(found),
        error_section(found),
    )
    head = Head(mechanism.name or "stage", f"Control loop, {found.setup.model.value} model", origin, headline(found))
    return page(head, [each for each in sections if each is not None], {"stage": data})
