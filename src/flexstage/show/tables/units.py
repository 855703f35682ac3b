"""Tables of isolated units and of DOFs omitted by simpler theories."""

from __future__ import annotations

from collections.abc import Mapping

from flexstage.analysis.linear_statics.omitted import Omitted
from flexstage.analysis.linear_statics.units import UnitResult
from flexstage.base.labelled import NOISE
from flexstage.show.display import number, percent
from flexstage.show.table import Column, Table, result_table, text_table


def lever_table(found: Mapping[str, UnitResult]) -> Table | None:
    """Tabulate the spring constants and arms of lever units, as in equations 3-11 of Shin & Moon; `None` without lever units.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.linear_statics.units import units
    >>> lever_table(units(double_triangle())).texts()[1][:2]
    ['vertical', '30.996']
    """
    return result_table({name: unit.lever for name, unit in found.items() if unit.lever is not None})


def omitted_table(found: Omitted, *, top: int = 12) -> Table | None:
    """Tabulate how each DOF that a simpler theory omits changes a gain: the `top` largest changes individually, the others in one row.

    >>> omitted_table(Omitted("platform.z", "B1", 2.0, 1.9, {"lever.rz": -0.1, "lever.x": 1e-15})).texts()[2:4]
    [['lever.rz', '-0.1', '-5.26 %'], ['further DOFs', '+0', '0 %']]
    """
    least = NOISE * abs(found.full)
    ranked = sorted(found.changes.items(), key=lambda item: -abs(round(item[1] / found.full, 9)))
    kept = {name: change for name, change in ranked[:top] if abs(change) >= least}
    rest = [change for name, change in ranked if name not in kept]
    further = {"further DOFs": sum(change for change in rest if abs(change) >= least)} if rest else {}
    changes = {**kept, **further, "interaction": found.interaction}
    rows = {name: (f"{change:+.4g}", percent(change / found.full, 3)) for name, change in changes.items()}
    title = f"DOFs that the simple theory omits, and their effect on {found.output} / {found.input}"
    ends = {name: (number(value), "") for name, value in (("simple theory", found.simple), ("full theory", found.full))}
    rows = {"simple theory": ends["simple theory"], **rows, "full theory": ends["full theory"]}
    return text_table(title, ["added DOF", Column("value"), Column("relative to full theory")], rows)
