"""Report sections on thermal drift and the error budget."""

from __future__ import annotations

from flexstage.analysis.complete import Analysis
from flexstage.show.figures.budget import error_figure
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Picture, Prose, Section, fold, section
from flexstage.show.tables.errors import drift_table, error_budget_tables, gauge_drift_table


def drift_section(analysis: Analysis) -> Section | None:
    """Make the section on thermal drift, the motion per kelvin; `None` without results.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> drift_section(analyse(double_triangle(), Model.IDEAL)) is None
    True
    """
    drift = analysis.drift
    if drift is None:
        return None
    text = (
        "All bodies and parts expand freely; the elasticity of the links determines the resulting motion. The motion is listed per kelvin "
        "of uniform temperature change, and per temperature gradient of 1 K/m."
    )
    gauges = gauge_drift_table(drift)
    return section("Thermal drift", [Prose(text), drift_table(drift), fold("Gauge readings", gauges)])


def error_section(analysis: Analysis) -> Section | None:
    """Make the section on the error budget, with every source of pose error for each axis; `None` without results.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> error_section(analyse(double_triangle(), Model.IDEAL)) is None
    True
    """
    budget = analysis.error_budget
    if budget is None:
        return None
    picture = Picture(
        to_svg(error_figure(budget), "errors", "Error budget by axis and source"),
        "Sum of the largest errors of all sources"
        + ("." if budget.forced else ", both with commands by the ideal mapping and with commands that correct lost motion."),
    )
    return section("Error budget", [picture, *error_budget_tables(budget)])
