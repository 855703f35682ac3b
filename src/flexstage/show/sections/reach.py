"""Workspace, forces, strength and clearance."""

from __future__ import annotations

from flexstage.analysis.complete import Analysis
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.show.figures.export import to_svg
from flexstage.show.figures.workspace import workspace_figure
from flexstage.show.page import Block, Folded, Picture, Prose, Section, fold, section
from flexstage.show.table import result_table
from flexstage.show.tables.force_workspace import force_workspace_tables
from flexstage.show.tables.strength import buckling_table, load_table, platform_line_table, stress_table
from flexstage.show.tables.workspace import (
    clearance_table,
    corner_table,
    extent_table,
    gauge_range_table,
    map_error_table,
    resolution_table,
    stroke_table,
)


def workspace_section(analysis: Analysis) -> Section | None:
    """What the platform reaches and what that asks of actuators and gauges; `None` where strokes do not determine the platform.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> workspace_section(analyse(double_triangle(), Model.IDEAL)).title
    'Workspace'
    """
    reach = analysis.workspace
    if reach is None:
        return (
            None if analysis.force_workspace is None else section("Force workspace", list(force_workspace_tables(analysis.force_workspace)))
        )
    figure = workspace_figure(reach)
    caption = "Reachable poses, projected on pairs of coordinates."
    picture = None if figure is None else Picture(to_svg(figure, "reach", caption), caption)
    return section(
        "Workspace",
        [
            stroke_table(reach),
            picture,
            None if reach.worst_case is None else corner_table(reach.worst_case),
            None if reach.gauges is None else gauge_range_table(reach.gauges),
            None if reach.resolution is None else resolution_table(reach.resolution),
            fold(
                "Extents, error of the linear map, volts",
                None if reach.polytope is None else extent_table(reach.polytope),
                None if reach.map_error is None else map_error_table(reach.map_error),
                result_table(reach.drive),
            ),
        ],
    )


def strength_section(analysis: Analysis) -> Section | None:
    """Forces, stress, buckling, loads and clearance; `None` where none is known.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> strength_section(analyse(double_triangle(), Model.IDEAL)).title
    'Forces, strength and clearance'
    """
    reach = analysis.workspace
    if reach is not None:
        return section("Forces, strength and clearance", _strength(reach))
    return None if analysis.buckling is None else section("Buckling", [buckling_table(analysis.buckling)])


def _strength(reach: Workspace) -> list[Block | None]:
    stressed = reach.stress is not None and bool(reach.stress.links)
    text = "Stress, buckling and loads count from the stage relaxed without voltage, over all corners of the strokes, dead load included."
    return [
        Prose(text) if stressed else None,
        stress_table(reach.stress) if stressed and reach.stress is not None else None,
        None if reach.platform_lines is None else platform_line_table(reach.platform_lines),
        None if reach.loads is None else load_table(reach.loads, reach.limits.from_zero),
        None if reach.clearance is None else clearance_table(reach.clearance),
        _more(reach),
    ]


def _more(reach: Workspace) -> Folded | None:
    return fold(
        "Stacks against the stage, buckling",
        result_table(reach.stack_lines),
        None if reach.buckling is None or not reach.buckling.links else buckling_table(reach.buckling),
    )
