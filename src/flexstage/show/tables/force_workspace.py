"""Tables of what forces reach: how far, what limits it, and what holding it there takes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexstage.analysis.workspace.force_workspace import ForceWorkspace
from flexstage.base.number import first_design
from flexstage.show.display import NO_VALUE, display_unit_of, number
from flexstage.show.table import Cell, Column, Mark, Table, make_table
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS


def force_workspace_tables(found: ForceWorkspace) -> Iterator[Table]:
    """The motion along each coordinate with what limits it; what it takes of every coil."""
    yield reach_table(found)
    if found.current.columns:
        yield need_table(found)


def reach_table(found: ForceWorkspace) -> Table:
    """How far single coordinates go either way, held for ever and in short use, and what ends it."""
    rows: list[tuple[Cell | str, ...]] = []
    both = (first_design(found.held, 1), first_design(found.held_briefly, 1))
    for place, name in enumerate(found.coordinates):
        unit = TWIST_UNITS[COMPONENTS.index(name)]
        form = display_unit_of(unit, float(np.nan_to_num(np.real(both[0][place]))))
        texts = [NO_VALUE if np.isnan(each[place]) else number(form.factor * float(np.real(each[place]))) for each in both]
        rows.append((Cell(name, Mark.STRONG), form.unit, *texts, found.limited_by[place] or "no limit stated"))
    notes = ["Elastic motion, either way. Held: for ever; short use: for a coil's share of time, `duty`."]
    if not all(found.alone):
        notes.append("There are fewer inputs than ideal motions: the other coordinates give way.")
    if found.unmoved:
        notes.append(f"No actuator moves {', '.join(found.unmoved)}.")
    heads = ["along", "unit", Column("held, both ways"), Column("short use"), "limited by"]
    return make_table("Reach", heads, rows, notes=notes, provenance=found.provenance)


def need_table(found: ForceWorkspace) -> Table:
    """Current, volts, heat and warming of every coil that holds the platform at its reach."""
    rows: list[tuple[Cell | str, ...]] = []
    needs = (found.current, found.voltage, found.power, found.rise)
    for place, name in enumerate(found.coordinates):
        for column, coil in enumerate(found.current.columns):
            values = (float(np.real(first_design(need.values, 2)[place, column])) for need in needs)
            rows.append((Cell(name, Mark.STRONG), coil, *(NO_VALUE if np.isnan(value) else number(value, 4) for value in values)))
    heads = ["along", "coil", Column("current", "A"), Column("R i", "V"), Column("heat", "W"), Column("warms by", "K")]
    return make_table("What holding it takes", heads, rows, notes=["At the reach held for ever, dead load not counted."])
