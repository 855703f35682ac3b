"""Numbers as a person would write them."""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce

from flexstage.base.units.unit import parse, quantity_of_unit, show
from flexstage.mechanism.addresses.address import set_value
from flexstage.mechanism.addresses.path import replace_member
from flexstage.mechanism.grammar.formulas import NUMBERS
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.mechanism import Mechanism


def round_to_digits(mechanism: Mechanism, digits: int = 12) -> Mechanism:
    """Return the description with every number rounded to significant digits of its shown unit; tags stay.

    Products of parameters carry rounding errors (1.54 * mm is 1.5400000000000001 mm) that a starting file should not show.

    >>> from flexstage.parts.rod import Rod
    >>> round_to_digits(Mechanism("", parts={"wire": Rod("steel", 1.54 * 1e-3, 0.001)})).parts["wire"].length
    0.00154
    """
    result = reduce(_round_number(digits), mechanism.numbers, mechanism)
    for address, value, node in node_of(Mechanism).numbers(mechanism):
        if isinstance(value, float) and not address.startswith(NUMBERS) and address not in mechanism.formulas:
            tidy = parse(show(value, node.quantity, digits=digits), node.quantity, where=address)
            result = result if tidy == value else replace_member(result, tuple(address.split(".")), tidy)
    return result


def _round_number(digits: int) -> Callable[[Mechanism, str], Mechanism]:
    """Rounds a named number that is no formula, and works out anew what depends on it."""

    def round_number(mechanism: Mechanism, name: str) -> Mechanism:
        address, number = f"{NUMBERS}.{name}", mechanism.numbers[name]
        if address in mechanism.formulas or not isinstance(number.value, float):
            return mechanism
        quantity = quantity_of_unit(number.unit)
        tidy = parse(show(number.value, quantity, digits=digits), quantity, where=address)
        return mechanism if tidy == number.value else set_value(mechanism, address, tidy)

    return round_number
