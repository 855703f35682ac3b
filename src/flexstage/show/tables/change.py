"""Tables of changes: changed values, and their effects."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum

from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.address import get, quantity_of
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.display import NO_VALUE, percent
from flexstage.show.table import Cell, Column, Mark, Table, make_table


def set_table(before: Mechanism, after: Mechanism, addresses: Iterable[str]) -> Table:
    """Tabulate changed values, old and new, in display units.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.addresses.address import assign
    >>> stage = double_triangle()
    >>> set_table(stage, assign(stage, "parts.neck.thickness=1.4mm"), ["parts.neck.thickness"]).texts()[1]
    ['parts.neck.thickness', '1.54 mm', '1.4 mm', '-0.14 mm', '-9.09 %']
    """
    heads = ["value", Column("old"), Column("new"), Column("change"), Column("relative")]
    return make_table("Changed values", heads, [_set_row(before, after, address) for address in dict.fromkeys(addresses)])


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
