"""Tables of the workspace: reachable motion, use of actuators and gauges, forces, strength and clearance."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from flexstage.analysis.workspace.buckling import Buckling
from flexstage.analysis.workspace.strength import HingeStress
from flexstage.analysis.workspace.stroke import Utilisation
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.number import Number
from flexstage.parts.profile import single
from flexstage.show.display import format_value, number
from flexstage.show.table import Table, first_design, merge_rows, optional, result_table
from flexstage.spatial.frame import MOTION


def command_text(command: Mapping[str, Number]) -> str:
    """Format the ranges of commanded motions as text.

    >>> command_text({"x": 50e-6, "rz": 244e-6})
    'x +-50 um, rz +-244 urad'
    """
    return ", ".join(f"{name} +-{format_value(single(value), MOTION.unit(name))}" for name, value in command.items())


def stroke_tables(workspace: Workspace) -> Iterator[Table | None]:
    """Tabulate the platform's strokes along single coordinates, ideal and with corrected lost motion, and the required actuator strokes."""
    yield result_table(workspace.single_axis)
    yield result_table(workspace.corrected, title="Single-axis strokes with corrected lost motion")
    yield optional(corner_table, workspace.worst_case)


def corner_table(corner: Utilisation) -> Table | None:
    """Tabulate the actuator strokes if all motions are commanded at the same time.

    >>> import numpy as np
    >>> corner_table(Utilisation(("B1",), {"x": 5e-05}, np.array([5e-5]), np.array([7.5e-5]), "")).texts()[1]
    ['B1', '50', '75', '66.67 %']
    """
    scale = single(corner.scale)
    verdict = "within reach" if scale >= 1.0 - 1e-9 else "out of reach"
    return result_table(
        corner,
        notes=[f"All combinations of {command_text(corner.command)}: {verdict}; all ranges can be scaled by {number(scale, 4)}."],
    )


def gauge_tables(workspace: Workspace) -> Iterator[Table | None]:
    """Tabulate gauge readings at the worst combination of commands, their ratios to the gauges' ranges, and the pose resolution."""
    gauges = workspace.gauges
    yield None if gauges is None else result_table(gauges, notes=[f"Values at the worst combination of {command_text(gauges.command)}."])
    yield result_table(workspace.resolution)


def strength_tables(workspace: Workspace) -> Iterator[Table | None]:
    """Tabulate blocked forces of platform and stacks, stress, buckling loads, and loads of stacks."""
    yield result_table(workspace.platform_lines)
    yield result_table(workspace.stack_lines)
    yield weakest_first(workspace.stress)
    if workspace.buckling is not None:
        yield result_table(workspace.buckling.stage)
        yield weakest_first(workspace.buckling)
    yield from load_tables(workspace)


def weakest_first(found: HingeStress | Buckling | None) -> Table | None:
    """Tabulate stress or buckling loads: unknown safety factors first, then in ascending order. Rows with equal cells are merged."""
    table = result_table(found)
    if found is None or table is None:
        return None
    factors = first_design(found.safety if isinstance(found, HingeStress) else found.factor, 1)
    order = np.argsort(np.round(np.nan_to_num(factors, nan=-1.0, posinf=1e300), 6), kind="stable")
    return merge_rows(replace(table, rows=tuple(table.rows[place] for place in order)))


def load_tables(workspace: Workspace) -> Iterator[Table | None]:
    """Tabulate the axial forces of stacks under permanent load, and over all strokes."""
    if workspace.loads is not None:
        yield result_table(workspace.loads)
        yield result_table(workspace.loads.over(workspace.limits.from_zero))
