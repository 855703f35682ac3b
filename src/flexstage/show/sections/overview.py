"""First sections of a report: verdicts on the requirements, and a summary of the stage."""

from __future__ import annotations

from flexstage.analysis.assessment.difference import Comparison
from flexstage.analysis.complete import Analysis
from flexstage.show.page import Headline, Prose, Section, section
from flexstage.show.table import result_table
from flexstage.show.tables.change import set_table
from flexstage.show.tables.overview import stage_text, summary_tables
from flexstage.show.tables.requirements import is_met, verdict_table, verdict_text


def headline(analysis: Analysis) -> Headline:
    """Make the headline of a report: the number of requirements that are met, and the smallest margin.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> headline(analyse(double_triangle(), Model.IDEAL)).text
    'All 8 requirements are met; the smallest margin is 6.01 %, for frequency.platform.1.'
    """
    verdicts = analysis.verdicts
    if not verdicts:
        return Headline("The design has no requirements.")
    return Headline(verdict_text(verdicts), all(map(is_met, verdicts)))


def requirement_section(analysis: Analysis) -> Section | None:
    """Make the section of verdicts on requirements with values, failed requirements first; `None` without requirements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> requirement_section(analyse(double_triangle(), Model.IDEAL)).blocks[0].texts()[1][:5]
    ['stroke.x', '74.4 um', 'at least 50 um', '+48.8 %', 'met']
    """
    if not analysis.verdicts:
        return None
    note = "Verdicts always use the lumped model, even if this report is based on another model."
    return section("Requirements", [verdict_table(sorted(analysis.verdicts, key=is_met), explained=True), Prose(note)])


def change_section(analysis: Analysis, compared: Comparison | None) -> Section | None:
    """Make the section of changed values, with the key figures before and after; `None` without changes.

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
    """Make the section that summarises the stage in a few lines and tables, as on the terminal.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> summary_section(analyse(double_triangle(), Model.IDEAL)).blocks[0].text.partition(": ")[2]
    '6 DOFs (x, y, z, rx, ry, rz), 6 actuators, 6 gauges'
    """
    parts = (stage_text(analysis), *summary_tables(analysis, explained=True))
    return section("Summary", [Prose(each) if isinstance(each, str) else each for each in parts])
