"""Rounding of numbers for files."""

from __future__ import annotations

from flexstage.base.units.unit import parse, show
from flexstage.mechanism.addresses.address import set_value
from flexstage.mechanism.addresses.path import replace_member
from flexstage.mechanism.grammar.formulas import PREFIX
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.mechanism import Mechanism


def round_to_digits(mechanism: Mechanism, digits: int = 12) -> Mechanism:
    """Return the description with every number rounded to `digits` significant digits in its display unit; tags are kept.

    Thus, a new file contains no rounding errors of products, such as 1.5400000000000001 mm for 1.54 * mm.

    >>> from flexstage.parts.rod import Rod
    >>> round_to_digits(Mechanism("", parts={"wire": Rod("steel", 1.54 * 1e-3, 0.001)})).parts["wire"].length
    0.00154
    """
    result = mechanism
    for address, value, node in node_of(Mechanism).numbers(mechanism):
        if isinstance(value, float) and address not in mechanism.formulas:
            tidy = parse(show(value, node.quantity, digits=digits), node.quantity, where=address)
            if tidy != value:
                is_named = address.startswith(PREFIX)
                result = set_value(result, address, tidy) if is_named else replace_member(result, tuple(address.split(".")), tidy)
    return result
