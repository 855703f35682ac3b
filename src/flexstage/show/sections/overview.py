"""The first page of a report: verdicts on the requirements, and the stage in a few numbers."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.analysis.assessment.difference import Comparison
from flexstage.analysis.complete import Analysis
from flexstage.parts.profile import single
from flexstage.show.display import format_value, number, percent
from flexstage.show.page import Fact, Facts, Headline, Prose, Section, section
from flexstage.show.table import first_design, result_table
from flexstage.show.tables.change import set_table
from flexstage.show.tables.overview import axis_table, count_text
from flexstage.show.tables.requirements import is_met, verdict_table, verdict_text

_SILENT = 1e-9


def headline(analysis: Analysis) -> Headline:
    """How many requirements are met, and the worst margin.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> headline(analyse(double_triangle(), Model.IDEAL)).text
    'All 8 requirements are met; the least margin is 6.01 %, for frequency.platform.1.'
    """
    verdicts = analysis.verdicts
    if not verdicts:
        return Headline("No requirements are stated.")
    return Headline(verdict_text(verdicts), all(map(is_met, verdicts)))


def requirement_section(analysis: Analysis) -> Section | None:
    """Verdicts with their values, those that fail before the others; `None` without requirements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> requirement_section(analyse(double_triangle(), Model.IDEAL)).blocks[0].texts()[1][:5]
    ['stroke.x', '74.4 um', 'at least 50 um', '+48.8 %', 'met']
    """
    if not analysis.verdicts:
        return None
    note = "Judged by the lumped model, whichever model the rest of this report uses."
    return section("Requirements", [verdict_table(sorted(analysis.verdicts, key=is_met), explained=True), Prose(note)])


def change_section(analysis: Analysis, compared: Comparison | None) -> Section | None:
    """The values that were set, and the key figures before and after; `None` where nothing was set.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> change_section(analyse(double_triangle(), Model.IDEAL), None) is None
    True
    """
    if compared is None:
        return None
    values = set_table(compared.stated, analysis.mechanism, compared.addresses)
    return section("Changes", [values, result_table(compared.figures)])


def summary_section(analysis: Analysis) -> Section | None:
    """The stage in a few numbers, and its platform axis by axis.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> [fact.name for fact in summary_section(analyse(double_triangle(), Model.IDEAL)).blocks[0].items]
    ['Freedoms', 'Stroke along x']
    """
    return section("Summary", [Facts(tuple(_facts(analysis))), axis_table(analysis)])


def _facts(analysis: Analysis) -> Iterator[Fact]:
    kinematics = analysis.kinematics
    driven = f"{count_text(len(kinematics.actuators), 'actuator')}, {count_text(len(kinematics.gauges), 'gauge')}"
    yield Fact("Freedoms", str(kinematics.mobility), driven)
    if analysis.modes is not None and analysis.modes.platform:
        index = analysis.modes.platform[0]
        frequency = float(first_design(analysis.modes.frequencies, 1)[index])
        yield Fact("First platform mode", format_value(frequency, "Hz", 4), analysis.modes.names[index])
    if analysis.statics is not None:
        most, least = (float(value) for value in first_design(analysis.statics.free.principal, 1))
        spread = "in every direction" if most - least < _SILENT * most else f"to {format_value(most, 'N/m', 4)}"
        yield Fact("Stiffness in the plane", format_value(least, "N/m", 4), spread)
    if analysis.lost_motion is not None:
        losses = np.diagonal(first_design(analysis.lost_motion.loss.values, 2))
        worst = int(np.argmax(np.round(np.abs(losses), 9)))
        yield Fact(
            "Lost motion", percent(_zero_if_noise(float(losses[worst])), 3), f"at worst, actuator {analysis.lost_motion.loss.rows[worst]}"
        )
    yield from _reach_facts(analysis)


def _zero_if_noise(share: float) -> float:
    return 0.0 if abs(share) < _SILENT else share


def _reach_facts(analysis: Analysis) -> Iterator[Fact]:
    if analysis.workspace is None:
        return
    strokes = analysis.workspace.corrected or analysis.workspace.single_axis
    if strokes.coordinates:
        name = strokes.coordinates[0]
        value = float(first_design(strokes.symmetric, 1)[0])
        yield Fact(f"Stroke along {name}", f"±{format_value(value, 'rad' if name.startswith('r') else 'm', 4)}", "one axis at a time")
    stress = analysis.workspace.stress
    if stress is not None and stress.links:
        least = single(stress.min_safety)
        yield Fact("Least safety factor", number(least, 3), f"against yield, in {stress.weakest}")
