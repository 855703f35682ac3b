"""Table of DOFs omitted by simpler theories."""

from __future__ import annotations

from flexstage.analysis.linear_statics.omitted import Omitted
from flexstage.base.labelled import NOISE
from flexstage.show.display import number, percent
from flexstage.show.table import Column, Table, text_table

_LISTED = 12


def omitted_table(found: Omitted) -> Table | None:
    """Tabulate how each DOF that a simpler theory omits changes a gain: the 12 largest changes individually, the others in one row.

    >>> omitted_table(Omitted("platform.z", "B1", 2.0, 1.9, {"lever.rz": -0.1, "lever.x": 1e-15})).texts()[2:4]
    [['lever.rz', '-0.1', '-5.26 %'], ['further DOFs', '+0', '0 %']]
    """
    least = NOISE * abs(found.full)
    ranked = sorted(found.changes.items(), key=lambda item: -abs(round(item[1] / found.full, 9)))
    kept = {name: change for name, change in ranked[:_LISTED] if abs(change) >= least}
    rest = [change for name, change in ranked if name not in kept]
    further = {"further DOFs": sum(change for change in rest if abs(change) >= least)} if rest else {}
    changes = {**kept, **further, "interaction": found.interaction}
    rows = {
        "simple theory": (number(found.simple), ""),
        **{name: (f"{change:+.4g}", percent(change / found.full, 3)) for name, change in changes.items()},
        "full theory": (number(found.full), ""),
    }
    title = f"DOFs that the simple theory omits, and their effect on {found.output} / {found.input}"
    return text_table(title, ["added DOF", Column("value"), Column("relative to full theory")], rows)
