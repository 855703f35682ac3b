"""Checks of named numbers and formulas: spelling, units, circular references, and values equal to their formulas."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from flexstage.base.finding import DesignError, Finding
from flexstage.base.units.expression import Expression, ExpressionError, parse_expression
from flexstage.base.units.unit import quantity_of_unit
from flexstage.mechanism.addresses.address import quantity_at, value_at
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.grammar.formulas import PREFIX, amount_of, cycle_findings, formula_value, scope_of, shown_unit, spelling_findings
from flexstage.mechanism.mechanism import Mechanism, NamedNumber

_ALIKE = 1e-9


def formula_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors of named numbers and formulas in a description written in Python. For design files, the file reader makes these checks.

    >>> print(*formula_findings(Mechanism("", numbers={"arm": NamedNumber(0.026, "ells")})))
    numbers.arm: "ells" is not a known unit. Use a unit, e.g. mm, or 1 for a ratio.
    """
    for name, number in mechanism.numbers.items():
        yield from spelling_findings(name)
        yield from _unit_findings(name, number)
    expressions: dict[str, Expression] = {}
    for address, text in mechanism.formulas.items():
        try:
            expressions[address] = parse_expression(text)
        except ExpressionError as error:
            yield Finding(address, error.what, error.advice)
    circles = tuple(cycle_findings({key.removeprefix(PREFIX): each for key, each in expressions.items() if key.startswith(PREFIX)}))
    yield from circles
    if circles or any(tuple(_unit_findings(*item)) for item in mechanism.numbers.items()):
        return
    scope = scope_of(mechanism)
    for address in expressions:
        try:
            place = locate(mechanism, address)
            target = formula_value(mechanism.formulas[address], quantity_at(place, address), scope, address)
            result = value_at(mechanism, place)
        except DesignError as error:
            yield from error.findings
            continue
        number = mechanism.numbers.get(address.removeprefix(PREFIX)) if address.startswith(PREFIX) else None
        if number is not None and number.unit != (unit := shown_unit(amount_of(number))):
            yield Finding(address, f"wrong unit (got {number.unit}, expected {unit} from its formula)", f"Use {unit}")
        if result is None or not np.allclose(result, target, rtol=_ALIKE, atol=0.0):
            what = f'wrong value (got {_si(result)}, expected {_si(target)} in SI from its formula "{mechanism.formulas[address]}")'
            yield Finding(address, what, "Use the value of the formula, or remove the formula")


def _si(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else "other values"


def _unit_findings(name: str, number: NamedNumber) -> Iterator[Finding]:
    try:
        quantity_of_unit(number.unit)
    except ValueError as error:
        yield Finding(PREFIX + name, str(error), "Use a unit, e.g. mm, or 1 for a ratio")
