"""The report of a complete analysis: one self-contained HTML file, identical for identical input."""

from __future__ import annotations

from dataclasses import replace

from flexstage.analysis.assessment.difference import Comparison
from flexstage.analysis.complete import Analysis
from flexstage.base.arguments import check_arguments
from flexstage.base.storage.digest import digest
from flexstage.base.version import __version__
from flexstage.show.page import Head, page
from flexstage.show.sections.accuracy import drift_section, error_section
from flexstage.show.sections.caveats import caveat_section
from flexstage.show.sections.dynamics import mode_section, response_section
from flexstage.show.sections.mechanics import kinematics_section, lost_motion_section, stiffness_section
from flexstage.show.sections.overview import change_section, headline, requirement_section, summary_section
from flexstage.show.sections.reach import strength_section, workspace_section
from flexstage.show.sections.sources import description_section, limit_section, reference_section
from flexstage.show.sections.stage import drawing_section, stage_section
from flexstage.show.viewer.data import StageData, stage_data
from flexstage.show.viewer.motions import Group


@check_arguments
def report(analysis: Analysis, compared: Comparison | None = None) -> str:
    """Write the analysis of a stage as a self-contained HTML page without a date, which begins with the verdict and the stage.

    With `compared`, a section after the requirements lists the changed values and their effects, in columns old, new and change. Results
    that are not available for the model or the stage are left out; the section "Limits" contains the reasons. For a batch, the first design
    is shown.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> report(analyse(double_triangle(), Model.IDEAL))[:15]
    '<!doctype html>'
    """
    mechanism = analysis.mechanism
    data = _turning(analysis)
    sections = (
        stage_section(data),
        requirement_section(analysis),
        caveat_section(mechanism, () if analysis.ends is None else analysis.ends.warnings),
        change_section(analysis, compared),
        summary_section(analysis),
        drawing_section(mechanism, data),
        kinematics_section(analysis),
        stiffness_section(analysis),
        lost_motion_section(analysis),
        mode_section(analysis, data),
        response_section(analysis),
        workspace_section(analysis),
        strength_section(analysis),
        drift_section(analysis),
        error_section(analysis),
        description_section(mechanism),
        limit_section(analysis),
        reference_section(analysis),
    )
    return page(_head(analysis), sections, {"stage": data})


def _turning(analysis: Analysis) -> StageData:
    """The stage for its viewer, with the motions of its model: for the ideal one only those of the platform."""
    weighed = analysis.under_load if analysis.under_load is not analysis.linear else None
    data = stage_data(analysis.mechanism, model=analysis.linear, weighed=weighed, kinematics=analysis.kinematics, found=analysis.modes)
    return data if analysis.linear is not None else replace(data, motions=tuple(each for each in data.motions if each.group is Group.AXIS))


def _head(analysis: Analysis) -> Head:
    origin = (
        ("model", analysis.model.value),
        ("physics", digest(analysis.mechanism, physics=True)[:16]),
        ("document", digest(analysis.mechanism)[:16]),
        ("flexstage", __version__),
    )
    kind = f"Analysis of a flexure stage, {analysis.model.value} model"
    return Head(analysis.mechanism.name or "stage", kind, origin, headline(analysis))
