"""Report of a loop: one self-contained HTML file."""

from __future__ import annotations

from dataclasses import replace

from flexstage.base.arguments import check_arguments
from flexstage.base.storage.digest import digest
from flexstage.base.version import __version__
from flexstage.control.show.figures.front import front_figure
from flexstage.control.show.playing import response_motions
from flexstage.control.show.sections import error_section, frequency_section, headline, loop_section, measured_section, time_section
from flexstage.control.show.tables import comparison_tables, kind_name
from flexstage.control.study.compare import Comparison
from flexstage.control.study.setup import LoopSetup
from flexstage.control.study.study import LoopStudy
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.page import Head, Headline, page, picture, section
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.stage import stage_section
from flexstage.show.viewer.data import stage_data
from flexstage.show.viewer.motions import Group


@check_arguments
def loop_report(found: LoopStudy) -> str:
    """Write a loop as an HTML page: stability, block diagram, margins, open loops, sensitivities, poles, steps, trajectories, noise."""
    mechanism = found.settled.mechanism
    origin = (
        ("physics", digest(mechanism, physics=True)[:16]),
        ("model", found.model_name),
        ("rate", f"{found.settled.rate:g} Hz"),
        ("flexstage", __version__),
    )
    data = stage_data(mechanism)
    data = replace(data, motions=(*response_motions(found, data), *data.motions))
    played = next((f"{each.group.value} {each.name}" for each in data.motions if each.group is Group.RESPONSE), "")
    sections = (
        stage_section(data, motion=played or None),
        loop_section(found),
        caveat_section(mechanism, found.warnings),
        frequency_section(found),
        measured_section(found),
        time_section(found),
        error_section(found),
    )
    head = Head(mechanism.name or "stage", f"Control loop, {found.settled.model_name.partition(',')[0]} model", origin, headline(found))
    return page(head, sections, {"stage": data})


def comparison_report(mechanism: Mechanism, asked: LoopSetup, found: Comparison) -> str:
    """Write a controller comparison as an HTML page: the best controller for each quantity, the Pareto front, and values by coordinate."""
    origin = (("physics", digest(mechanism, physics=True)[:16]), ("model", asked.model.value), ("flexstage", __version__))
    data = stage_data(mechanism)
    best = ", ".join(f"{aim} by {kind_name(name)}" for aim, name in found.wins.items())
    detuned = {kind_name(name): each.detuned for name, each in found.controllers.items()}
    lines = {name: each for name, each in detuned.items() if each is not None and len(each.gains)}
    caption = (
        "Each dot is a tuned controller; its line shows the same controller with lower gain, down to a tenth. Values are those of the "
        "worst coordinate in the linear loop. The noise is the geometric mean of all coordinates, with rotations multiplied by the "
        "stage's length. A filled dot is Pareto-optimal: no other controller is at least as good in all four quantities."
    )
    figure = front_figure(lines, [*map(kind_name, found.front)])
    drawn = picture(figure, "front", "Trade-off between controllers: rejection, noise, settling, delay margin", caption)
    compared, by_coordinate = comparison_tables(found)
    sections = (
        stage_section(data),
        section("Comparison of controllers", [compared, drawn if lines else None]),
        caveat_section(mechanism, found.warnings),
        section("Results by coordinate", [by_coordinate]),
    )
    head = Head(mechanism.name or "stage", f"Controllers, {asked.model.value} model", origin, Headline(f"Best: {best}."))
    return page(head, sections, {"stage": data})
