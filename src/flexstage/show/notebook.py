"""Results in notebooks: `%load_ext flexstage.show.notebook` shows them as the tables of a report."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from flexstage.analysis.drift import Drift
from flexstage.analysis.error_budget import ErrorBudget
from flexstage.analysis.lost_motion import LostMotion
from flexstage.analysis.modes import Modes
from flexstage.analysis.statics import Statics
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.labelled import Matrix
from flexstage.models.linear.frequency import Response
from flexstage.models.linear.kinematics import Kinematics
from flexstage.show.render import to_html
from flexstage.show.table import Table, matrix_table
from flexstage.show.tables.errors import drift_table, error_budget_tables
from flexstage.show.tables.kinematics import mapping_table, mobility_table
from flexstage.show.tables.lost_motion import budget_table, loss_table
from flexstage.show.tables.modes import mode_table
from flexstage.show.tables.response import response_table
from flexstage.show.tables.statics import principal_table, stiffness_table
from flexstage.show.tables.workspace import stroke_table


def _kinematics(result: Kinematics) -> tuple[Table, ...]:
    return (mobility_table(result), *([mapping_table(result)] if result.actuated else []))


_TABLES: Mapping[type, Callable[[Any], tuple[Table, ...]]] = {
    Kinematics: _kinematics,
    Statics: lambda result: (stiffness_table(result), principal_table(result)),
    LostMotion: lambda result: (loss_table(result), budget_table(result)),
    Modes: lambda result: (mode_table(result),),
    Response: lambda result: (response_table(result),),
    Workspace: lambda result: (stroke_table(result),),
    Drift: lambda result: (drift_table(result),),
    ErrorBudget: error_budget_tables,
    Matrix: lambda result: (matrix_table("", result),),
}


def tables_of(result: Any) -> tuple[Table, ...]:
    """The tables that sum a result up; none for values of other types.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [table.title for table in tables_of(fs.ideal(double_triangle()))]
    ['Mobility', 'Actuator mapping R_a']
    """
    return _TABLES[type(result)](result) if type(result) in _TABLES else ()


def load_ipython_extension(ipython: Any) -> None:
    """Register the tables with a notebook's HTML formatter (called by `%load_ext`).

    >>> class Formatter(dict):
    ...     def for_type(self, kind, function):
    ...         self[kind.__name__] = function
    >>> class Shell:
    ...     class display_formatter:
    ...         formatters = {"text/html": Formatter()}
    >>> load_ipython_extension(Shell)
    >>> "Modes" in Shell.display_formatter.formatters["text/html"]
    True
    """
    formatter = ipython.display_formatter.formatters["text/html"]
    for kind in _TABLES:
        formatter.for_type(kind, _html)


def _html(result: Any) -> str:
    return "".join(to_html(table) for table in tables_of(result))
