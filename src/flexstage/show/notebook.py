"""Values in notebooks: a stage is shown as a picture, results and matrices as the tables of a report."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np
from rich.console import Console

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
    """Convert a stage to its picture, or a result to its tables, as HTML for notebooks.

    A result without tables of its own gets one table for each of its parts. A stage that cannot be drawn is replaced by its errors.

    >>> import flexstage as fs
    >>> stage = fs.case("parallelogram")
    >>> to_html(stage)[:13], to_html(fs.ideal(stage)).count("<table>")
    ('<svg viewBox=', 2)
    """
    if isinstance(value, Mechanism):
        return _picture(value)
    tables = _TABLES.get(type(value), result_tables)
    return "".join(render.to_html(table) for table in tables(value) if table is not None)


_LINES, _WIDTH, _NAMES = 25, 100, 8
"""Most lines of a printed value, their width, and most names in one of them."""


def to_text(value: Any) -> str:
    """Format the tables of a result or, without tables, a summary of its fields, in at most 25 lines of text.

    >>> import flexstage as fs
    >>> print(fs.ideal(fs.case("parallelogram")))  # doctest: +ELLIPSIS
    <BLANKLINE>
    Mobility...
    """
    tables = _TABLES.get(type(value))
    if tables is None:
        return _summary(value)
    console = Console(width=_WIDTH, no_color=True)
    with console.capture() as captured:
        for table in filter(None, tables(value)):
            console.print(*render.to_rich(table, _WIDTH), sep="\n")
    lines = [line.rstrip() for line in captured.get().splitlines()]
    return "\n".join(lines if len(lines) <= _LINES else [*lines[: _LINES - 1], f"... {len(lines) - _LINES + 1} further lines"])


def _summary(value: Any) -> str:
    """A dataclass: each field by its value, its shape, or its first names."""
    texts = {each.name: _short(getattr(value, each.name)) for each in fields(value)}
    shown = {name: text for name, text in texts.items() if text} if len(texts) >= _LINES else texts
    width = max(map(len, shown), default=0)
    lines = [type(value).__name__, *(f"  {name:{width}}  {text or 'none'}" for name, text in shown.items())]
    return "\n".join(lines[:_LINES])


def _short(value: Any) -> str:
    """A value in one line; empty for an empty collection."""
    if isinstance(value, np.ndarray) and value.ndim:
        return f"array {' x '.join(map(str, value.shape))}"
    if isinstance(value, float | np.number | np.ndarray):
        return f"{float(value):.6g}"
    if is_dataclass(value):
        return str(getattr(value, "name", "")) or type(value).__name__
    if isinstance(value, Collection) and not isinstance(value, str | Enum):
        names = [each if isinstance(each, str) else _short(each) for each in list(value)[:_NAMES]]
        value = f"{len(value)}: {', '.join(names)}{', ...' if len(value) > _NAMES else ''}" if value else ""
    return textwrap.shorten(str(value), _WIDTH, placeholder=" ...")


def _picture(mechanism: Mechanism) -> str:
    try:
        picture = stage_picture(still_data(mechanism))
    except DesignError as error:
        return "".join(str(render.templates().prose(Prose(str(finding)))) for finding in error.findings)
    return to_svg(picture, f"stage{digest(mechanism)[:12]}", f"{mechanism.name} seen obliquely from above")
