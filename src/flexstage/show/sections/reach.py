"""Report sections on workspace, forces, strength and clearance."""

from __future__ import annotations

from flexstage.analysis.complete import Analysis
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.show.figures.export import to_svg
from flexstage.show.figures.workspace import workspace_figure
from flexstage.show.page import Block, Picture, Prose, Section, fold, section
from flexstage.show.table import result_table
from flexstage.show.tables.force_workspace import drive_force_tables, force_workspace_tables
from flexstage.show.tables.workspace import gauge_tables, load_tables, stroke_tables, weakest_first


def workspace_section(analysis: Analysis) -> Section | None:
    """Make the section on the workspace of platform, actuators and gauges, or on the force workspace; `None` without either workspace.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> workspace_section(analyse(double_triangle(), Model.IDEAL)).title
    'Workspace'
    """
    reach = analysis.workspace
    if reach is None:
        forced = analysis.force_workspace
        tables = [] if forced is None else [*force_workspace_tables(forced), *drive_force_tables(analysis.drive_force)]
        return section("Force workspace", tables)
    figure = workspace_figure(reach)
    caption = "Reachable poses, projected on pairs of coordinates."
    picture = None if figure is None else Picture(to_svg(figure, "reach", caption), caption)
    return section(
        "Workspace",
        [
            *stroke_tables(reach),
            picture,
            *gauge_tables(reach),
            fold("Extents, error of the linear map, voltages", *map(result_table, (reach.polytope, reach.map_error, reach.drive))),
        ],
    )


def strength_section(analysis: Analysis) -> Section | None:
    """Make the section on forces, stress, buckling, loads and clearance; `None` without results.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> strength_section(analyse(double_triangle(), Model.IDEAL)).title
    'Forces, strength and clearance'
    """
    reach = analysis.workspace
    if reach is not None:
        return section("Forces, strength and clearance", [weakest_first(analysis.stress), *_strength(reach)])
    buckled = [] if analysis.buckling is None else [result_table(analysis.buckling.stage), weakest_first(analysis.buckling)]
    return section("Strength", [weakest_first(analysis.stress), *buckled])


def _strength(reach: Workspace) -> list[Block | None]:
    stressed = reach.stress is not None and bool(reach.stress.links)
    text = "Stress, buckling and loads are the worst values at all corners of the strokes from zero voltage, under permanent load."
    return [
        Prose(text) if stressed else None,
        weakest_first(reach.stress),
        result_table(reach.platform_lines),
        *load_tables(reach),
        result_table(reach.clearance),
        fold(
            "Load lines of stacks and stage, buckling",
            result_table(reach.stack_lines),
            *([] if reach.buckling is None else [result_table(reach.buckling.stage), weakest_first(reach.buckling)]),
        ),
    ]
