"""Which tables a command shows, in which order."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexstage.analysis.deflection import Deflection
    from flexstage.analysis.drift import Drift
    from flexstage.analysis.lost_motion import LostMotion
    from flexstage.analysis.statics import Statics
    from flexstage.present.table import Table
    from flexstage.readings.linear.kinematics import Kinematics
    from flexstage.studies.complete import Analysis
    from flexstage.studies.workspace import Workspace


def mapping_tables(kinematics: Kinematics) -> Iterator[Table | None]:
    """Tables of `mapping`."""
    from flexstage.present.tables import kinematics as tables

    yield tables.mobility_table(kinematics)
    if kinematics.actuated:
        yield tables.mapping_table(kinematics)
    yield tables.gauge_table(kinematics) if kinematics.gauges else None
    yield tables.motion_table(kinematics)
    yield tables.freedom_table(kinematics)
    yield tables.idle_table(kinematics)
    yield tables.redundant_table(kinematics)


def stiffness_tables(statics: Statics, deflection: Deflection | None) -> Iterator[Table | None]:
    """Tables of `stiffness`."""
    from flexstage.present.tables import statics as tables
    from flexstage.present.tables.deflection import deflection_table

    yield tables.stiffness_table(statics)
    yield tables.compliance_table(statics)
    yield tables.principal_table(statics)
    yield tables.direction_table(statics)
    yield tables.centre_table(statics)
    yield None if deflection is None else deflection_table(deflection)


def lost_motion_tables(lost: LostMotion) -> Iterator[Table | None]:
    """Tables of `lost-motion`."""
    from flexstage.present.tables import lost_motion as tables

    yield tables.loss_table(lost)
    yield tables.budget_table(lost)
    yield tables.gain_table(lost)
    yield tables.crosstalk_table(lost)
    yield tables.parasitic_table(lost)
    yield tables.correction_table(lost)
    yield tables.energy_table(lost)


def workspace_tables(workspace: Workspace) -> Iterator[Table | None]:
    """Tables of `workspace`, those of motion first, then those of strength."""
    from flexstage.present.tables import workspace as tables

    yield tables.stroke_table(workspace)
    yield None if workspace.corner is None else tables.corner_table(workspace.corner)
    yield None if workspace.polytope is None else tables.extent_table(workspace.polytope)
    yield None if workspace.map_error is None else tables.map_error_table(workspace.map_error)
    yield None if workspace.drive is None else tables.drive_table(workspace.drive)
    yield None if workspace.gauges is None else tables.gauge_range_table(workspace.gauges)
    yield None if workspace.resolution is None else tables.resolution_table(workspace.resolution)
    yield None if workspace.room is None else tables.room_table(workspace.room)
    yield from _strength_tables(workspace)


def _strength_tables(workspace: Workspace) -> Iterator[Table | None]:
    from flexstage.present.tables import strength as tables

    yield None if workspace.platform_lines is None else tables.platform_line_table(workspace.platform_lines)
    yield None if workspace.stack_lines is None else tables.stack_line_table(workspace.stack_lines)
    yield None if workspace.stress is None else tables.stress_table(workspace.stress)
    yield None if workspace.buckling is None else tables.buckling_table(workspace.buckling)
    yield None if workspace.loads is None else tables.load_table(workspace.loads, workspace.limits.from_zero)


def drift_tables(drift: Drift) -> Iterator[Table | None]:
    """Tables of `drift`."""
    from flexstage.present.tables import errors as tables

    yield tables.drift_table(drift)
    yield tables.gauge_drift_table(drift)


def analysis_tables(analysis: Analysis) -> Iterator[Table | None]:
    """Tables of `analyse`: what decides first, one or two an analysis; the commands of one analysis show more."""
    from flexstage.present.tables import errors, kinematics, lost_motion, statics, strength, workspace
    from flexstage.present.tables.modes import mode_table
    from flexstage.present.tables.units import omitted_table, unit_table

    found = analysis.kinematics
    yield kinematics.mobility_table(found)
    yield kinematics.mapping_table(found) if found.actuated else None
    yield kinematics.gauge_table(found) if found.gauges else None
    if analysis.statics is not None:
        yield statics.stiffness_table(analysis.statics)
        yield statics.principal_table(analysis.statics)
    yield unit_table(analysis.units) if analysis.units else None
    if analysis.lost_motion is not None:
        yield lost_motion.loss_table(analysis.lost_motion)
        yield lost_motion.budget_table(analysis.lost_motion)
    for unit in (analysis.units or {}).values():
        yield None if unit.omitted is None else omitted_table(unit.omitted)
    yield None if analysis.modes is None else mode_table(analysis.modes)
    if analysis.workspace is not None:
        yield workspace.stroke_table(analysis.workspace)
        yield from _strength_tables(analysis.workspace)
    elif analysis.buckling is not None:
        yield strength.buckling_table(analysis.buckling)
    yield None if analysis.drift is None else errors.drift_table(analysis.drift)
    if analysis.error_budget is not None:
        yield from errors.error_budget_tables(analysis.error_budget)
