"""Tables of a force workspace: travel, its limits, and continuous current, voltage and heat."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.analysis.linear_statics.drive_force import DriveForce
from flexstage.analysis.workspace.force_workspace import ForceWorkspace
from flexstage.show.table import Table, column_table, make_table, merge_rows, result_table
from flexstage.show.tables.lost_motion import share_rows


def force_workspace_tables(found: ForceWorkspace) -> Iterator[Table | None]:
    """Tabulate the travel along each coordinate with its limits, and the continuous inputs of every coil at that travel."""
    yield result_table(found)
    if found.current.columns:
        yield column_table(
            "Coil inputs at the continuous travel", found.holding, head="along, coil", notes=["Inputs for permanent load are not included."]
        )


def drive_force_tables(found: DriveForce | None) -> Iterator[Table | None]:
    """Tabulate the drive force per displacement and its excess over that of the ideal guide, in total and by flexure; no table for `None`.

    >>> list(drive_force_tables(None))
    []
    """
    if found is None:
        return
    yield result_table(found)
    columns = {
        f"{name}{text}": dict(zip(matrix.rows, np.real(matrix.values[:, place]).tolist(), strict=True))
        for place, name in enumerate(found.shares.columns)
        for text, matrix in (("", found.shares), (", excess", found.excess))
    }
    notes = ["Contribution of each flexure to the drive force, and to the excess of this force over that of the ideal guide."]
    yield merge_rows(make_table("Drive force by flexure", ["part", *columns], share_rows(columns, "all"), notes=notes))
