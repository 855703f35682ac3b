"""Tables of single units and of what simpler theories omit."""

from __future__ import annotations

from collections.abc import Mapping

from flexstage.analysis.linear_statics.omitted import Omitted
from flexstage.analysis.linear_statics.units import UnitResult
from flexstage.base.labelled import NOISE
from flexstage.show.display import NO_VALUE, format_value, number, percent
from flexstage.show.scene.primitives import first_value
from flexstage.show.table import Cell, Column, Mark, Table, make_table


def unit_table(found: Mapping[str, UnitResult]) -> Table:
    """Every distinct unit alone: stiffness at its output, gain, loss.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.linear_statics.units import units
    >>> unit_table(units(double_triangle())).texts()[1][:2]
    ['horizontal', 'B1']
    """
    rows = [
        (
            Cell(name, Mark.STRONG),
            unit.copy,
            format_value(unit.axial, "N/m"),
            " to ".join(format_value(value, "N/m", 4) for value in unit.lateral),
            number(unit.ideal_gain),
            number(unit.gain),
            percent(unit.loss if abs(unit.loss) > NOISE else 0.0),
            NO_VALUE if unit.series is None else format_value(unit.series, "N/m"),
        )
        for name, unit in found.items()
    ]
    heads = ["unit", "copy", Column("axial stiffness"), Column("lateral stiffness"), Column("ideal gain"), Column("gain")]
    heads += [Column("loss"), Column("in strokes")]
    note = "Each unit alone, strokes held, output guided along its direction. In strokes: in actuator coordinates, as mapped reads it."
    return make_table("Units alone", heads, rows, notes=[note])


def lever_table(found: Mapping[str, UnitResult]) -> Table | None:
    """The springs and arms of lever units as in Eqs. 3-11 of Shin & Moon; `None` without lever units.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.linear_statics.units import units
    >>> lever_table(units(double_triangle())).texts()[1][:2]
    ['vertical', '30.996 N/um']
    """
    levers = {name: unit.lever for name, unit in found.items() if unit.lever is not None}
    rows = [
        (
            Cell(name, Mark.STRONG),
            format_value(first_value(lever.drive), "N/m"),
            format_value(first_value(lever.pivot), "N m/rad"),
            format_value(first_value(lever.pole), "N/m"),
            f"{number(1e3 * first_value(lever.short_arm))} / {number(1e3 * first_value(lever.long_arm))}",
            number(first_value(lever.gain)),
            format_value(first_value(lever.tip_compliance), "m/N", 4),
        )
        for name, lever in levers.items()
    ]
    heads = ["unit", Column("drive K1"), Column("pivot K_theta2"), Column("pole K3"), Column("arms r1 / r2", "mm")]
    heads += [Column("gain (Eq. 11)"), Column("tip compliance (Eq. 11)")]
    return make_table("Springs of the lever units", heads, rows) if rows else None


def omitted_table(found: Omitted, *, top: int = 12) -> Table:
    """What each freedom that a simpler theory leaves out costs; those of which rounding alone is seen stand together as one.

    >>> omitted_table(Omitted("platform.z", "B1", 2.0, 1.9, {"lever.rz": -0.1, "lever.x": 1e-15})).texts()[2:4]
    [['lever.rz', '-0.1', '-5.26 %'], ['further freedoms', '+0', '0 %']]
    """
    least = NOISE * abs(found.full)
    ranked = sorted(found.changes.items(), key=lambda item: -abs(round(item[1] / found.full, 9)))
    seen = [(name, change) for name, change in ranked[:top] if abs(change) >= least]
    rows: list[tuple[Cell | str, ...]] = [(Cell("simple theory", Mark.STRONG), number(found.simple), "")]
    rows += [(Cell(name), f"{change:+.4g}", percent(change / found.full, 3)) for name, change in seen]
    rest = sum(change for _, change in ranked[len(seen) :] if abs(change) >= least)
    rows += [(Cell("further freedoms"), f"{rest:+.4g}", percent(rest / found.full, 3))] if ranked[len(seen) :] else []
    rows += [(Cell("their interaction"), f"{found.interaction:+.4g}", percent(found.interaction / found.full, 3))]
    rows += [(Cell("full theory", Mark.STRONG), Cell(number(found.full), Mark.STRONG), "")]
    title = f"What the simple theory omits: {found.output} over {found.input}"
    return make_table(title, ["freedom given back", Column("value"), Column("of the full")], rows)
