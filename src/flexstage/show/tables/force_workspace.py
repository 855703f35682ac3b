"""Tables of a force workspace: travel, its limits, and continuous current, voltage and heat."""

from __future__ import annotations

from collections.abc import Iterator

from flexstage.analysis.workspace.force_workspace import ForceWorkspace
from flexstage.show.table import Table, column_table, result_table


def force_workspace_tables(found: ForceWorkspace) -> Iterator[Table | None]:
    """The travel along each coordinate with its limits; the continuous inputs of every coil there."""
    yield result_table(found)
    if found.current.columns:
        yield column_table(
            "Holding the reach", found.holding, head="along, coil", notes=["At the travel held without time limit, dead load not counted."]
        )
