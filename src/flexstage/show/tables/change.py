"""Tables of changes: what was set, and what it did."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum

from flexstage.analysis.assessment.difference import Change
from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.address import get, quantity_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.display import NO_VALUE, display_unit_of, number, percent
from flexstage.show.table import Cell, Column, Mark, Table, make_table

_SILENT = 1e-9


def change_table(changes: Iterable[Change]) -> Table:
    """Old, new and change of every figure; what stays within a billionth is faint.

    >>> change_table([Change("platform mode 1", "Hz", 100.0, 90.0)]).texts()[1]
    ['platform mode 1', '100', '90', '-10', '-10 %', 'Hz']
    """
    heads = ["figure", Column("old"), Column("new"), Column("change"), Column("relative"), "unit"]
    return make_table("What the change does", heads, [_row(change) for change in changes])


def set_table(before: Mechanism, after: Mechanism, addresses: Iterable[str]) -> Table:
    """What was set: every value before and after, in the unit a design file shows it in.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.addresses.address import assign
    >>> stage = double_triangle()
    >>> set_table(stage, assign(stage, "parts.neck.thickness=1.4mm"), ["parts.neck.thickness"]).texts()[1]
    ['parts.neck.thickness', '1.54 mm', '1.4 mm', '-0.14 mm', '-9.09 %']
    """
    heads = ["value", Column("old"), Column("new"), Column("change"), Column("relative")]
    return make_table("Values set", heads, [_set_row(before, after, address) for address in dict.fromkeys(addresses)])


def _set_row(before: Mechanism, after: Mechanism, address: str) -> tuple[Cell, ...]:
    old, new = get(before, address), get(after, address)
    if not isinstance(new, float) or not isinstance(old, float):
        return Cell(address, Mark.STRONG), Cell(_text(old)), Cell(_text(new)), Cell(""), Cell("")
    quantity = quantity_of(after, address)
    texts = [show(value, quantity, digits=6) for value in (old, new, new - old)]
    relative = percent(new / old - 1.0, 3) if old else NO_VALUE
    return Cell(address, Mark.STRONG), *(Cell(text) for text in (*texts, relative))


def _text(value: object) -> str:
    return NO_VALUE if value is None else str(value.value if isinstance(value, Enum) else value)


def _row(change: Change) -> tuple[Cell, ...]:
    known = [value for value in (change.old, change.new) if value is not None]
    form = display_unit_of(change.unit, max((abs(value) for value in known), default=0.0))
    still = change.relative is not None and abs(change.relative) < _SILENT
    mark = Mark.FAINT if still else Mark.PLAIN
    difference = None if change.old is None or change.new is None else change.new - change.old
    texts = [NO_VALUE if value is None else number(value * form.factor) for value in (change.old, change.new)]
    moved = NO_VALUE if difference is None else "0" if still else number(difference * form.factor, 4)
    relative = "0" if still else NO_VALUE if change.relative is None else percent(change.relative, 3)
    unit = "" if form.unit == "1" else form.unit
    return Cell(change.name, Mark.STRONG), *(Cell(text, mark) for text in (*texts, moved, relative)), Cell(unit, mark)
