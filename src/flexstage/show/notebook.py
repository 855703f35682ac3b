"""Values in notebooks: a stage as its picture, results and matrices as the tables of a report."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from flexstage.analysis.assessment.error_budget import ErrorBudget
from flexstage.analysis.assessment.sensitivities import Sensitivities
from flexstage.analysis.dynamics.modes import Modes
from flexstage.analysis.dynamics.random_response import RandomResponse
from flexstage.analysis.linear_statics.drift import Drift
from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.analysis.linear_statics.statics import Statics
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.finding import DesignError
from flexstage.base.storage.digest import digest
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.frequency import Response
from flexstage.models.linear.kinematics import Kinematics
from flexstage.show import render
from flexstage.show.figures.export import to_svg
from flexstage.show.page import Prose
from flexstage.show.scene.pictures import stage_picture
from flexstage.show.table import Table, result_tables
from flexstage.show.tables.errors import drift_table, error_budget_tables
from flexstage.show.tables.kinematics import mapping_table, mobility_table
from flexstage.show.tables.lost_motion import budget_table, loss_table
from flexstage.show.tables.modes import mode_table
from flexstage.show.tables.random_response import random_table
from flexstage.show.tables.response import response_table
from flexstage.show.tables.sensitivities import frequency_sensitivity_table, loss_sensitivity_table
from flexstage.show.tables.statics import principal_table, stiffness_table
from flexstage.show.tables.workspace import stroke_tables
from flexstage.show.viewer.data import still_data

_TABLES: Mapping[type, Callable[[Any], Iterable[Table | None]]] = {
    Table: lambda table: (table,),
    Kinematics: lambda result: (mobility_table(result), mapping_table(result) if result.actuated else None),
    Statics: lambda result: (stiffness_table(result), principal_table(result)),
    LostMotion: lambda result: (loss_table(result), budget_table(result)),
    Modes: lambda result: (mode_table(result),),
    Response: lambda result: (response_table(result),),
    RandomResponse: lambda result: (random_table(result),),
    Workspace: stroke_tables,
    Drift: lambda result: (drift_table(result),),
    ErrorBudget: error_budget_tables,
    Sensitivities: lambda result: (frequency_sensitivity_table(result), loss_sensitivity_table(result)),
}


def to_html(value: Any) -> str:
    """A stage's picture, or the tables that summarise a result: its own tables, else one for each part.

    A stage that cannot be drawn is replaced by its errors.

    >>> import flexstage as fs
    >>> stage = fs.case("parallelogram")
    >>> to_html(stage)[:13], to_html(fs.ideal(stage)).count("<table>")
    ('<svg viewBox=', 2)
    """
    if isinstance(value, Mechanism):
        return _picture(value)
    tables = _TABLES.get(type(value), result_tables)
    return "".join(render.to_html(table) for table in tables(value) if table is not None)


def _picture(mechanism: Mechanism) -> str:
    try:
        picture = stage_picture(still_data(mechanism))
    except DesignError as error:
        return "".join(str(render.templates().prose(Prose(str(finding)))) for finding in error.findings)
    return to_svg(picture, f"stage{digest(mechanism)[:12]}", f"{mechanism.name} from above its corner")
