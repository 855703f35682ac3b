"""Formulas of a description, stored with the computed values.

Each formula is stored under the address of its number (`parts.leaf.length`, `numbers.half`). Values always equal their formulas. If a named
number changes, all dependent values are recomputed (`address.set_value`). If a computed value is set, its formula is removed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from graphlib import CycleError, TopologicalSorter
from typing import Any

from flexstage.base.finding import DesignError, Finding, refuse
from flexstage.base.number import Number
from flexstage.base.units.dimension import Dimension, dimension_of
from flexstage.base.units.expression import (
    FUNCTIONS,
    Amount,
    Expression,
    ExpressionError,
    Scope,
    UnknownAmountError,
    evaluate,
    is_plain,
    is_unit,
    parse_expression,
)
from flexstage.base.units.quantity import RATIO, Quantity
from flexstage.base.units.unit import parse, quantity_of_dimension, quantity_of_unit, split_unit
from flexstage.mechanism.mechanism import Mechanism, NamedNumber

NUMBERS = "numbers"
PREFIX = f"{NUMBERS}."
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,59}")
_WORD = re.compile(r"[A-Za-z_]\w*")
_SIGN = re.compile(r"[-+*/(]")
_NOT_FINITE = ("nan", "inf", "infinity")


def scope_of(mechanism: Mechanism) -> dict[str, Amount]:
    """Return the named numbers of a description as amounts, by name.

    >>> scope_of(Mechanism("", numbers={"arm": NamedNumber(0.026, "mm")}))["arm"].noun()
    'a length'
    """
    return {name: amount_of(number) for name, number in mechanism.numbers.items()}


def amount_of(number: NamedNumber) -> Amount:
    """Return the amount of a named number; raises `ValueError` for an unknown unit."""
    return Amount(number.value, Dimension(Fraction(1), dimension_of(number.unit).powers))


def formula_value(text: str, quantity: Quantity, scope: Scope, where: str) -> Number:
    """Evaluate a formula that must have a given quantity; returns the value in SI.

    Raises `DesignError` at `where`, or `UnknownAmountError` if the error of a named number is already reported.

    >>> from flexstage.base.units.quantity import LENGTH
    >>> formula_value("2 * 3 mm", LENGTH, {}, "parts.leaf.length")
    0.006
    """
    try:
        result = evaluate(parse_expression(text), scope)
    except ExpressionError as error:
        raise refuse(where, error.what, error.advice) from None
    if result.dimension.powers not in {dimension_of(form).powers for form in (quantity.si, *quantity.also)}:
        what = f'must be {quantity.noun} (got "{text}", {result.noun()})'
        raise refuse(where, what, "Check the units of its numbers")
    return result.value  # type: ignore[no-any-return]


def is_formula(text: str, scope: Scope) -> bool:
    """Return whether a string is a formula, not a plain number with a valid unit or another string.

    >>> is_formula("2 * 3 mm", {}), is_formula("3 furlong", {}), is_formula("steel", {}), is_formula("arm +", {})
    (True, False, False, True)
    """
    try:
        expression = parse_expression(text)
    except ExpressionError:
        names = set(_WORD.findall(text)) & set(scope)
        return bool(names or (not is_plain(text) and _SIGN.search(text.strip()[1:])))
    name = text.strip(" ()")
    if set(expression.names) == {name}:
        return bool(scope) and name.lower() not in _NOT_FINITE
    return not expression.literal


@dataclass(frozen=True, eq=False)
class Numbers:
    """Named numbers of a file: their `values` and `formulas`, the `scope` for evaluation of other formulas, and errors."""

    values: Mapping[str, NamedNumber]
    scope: Scope
    formulas: Mapping[str, str]
    findings: tuple[Finding, ...]


def read_numbers(table: Mapping[str, Any]) -> Numbers:
    """Read the named numbers of a file.

    >>> result = read_numbers({"half": "arm / 2", "arm": "26 mm"})
    >>> result.values["half"].value, result.formulas
    (0.013, {'numbers.half': 'arm / 2'})
    """
    findings = [finding for name in table for finding in spelling_findings(name)]
    values: dict[str, NamedNumber] = {}
    texts: dict[str, str] = {}
    for name, raw in table.items():
        try:
            number = _plain_number(raw, PREFIX + name)
        except DesignError as error:
            findings += error.findings
            continue
        if number is None:
            texts[name] = raw
        else:
            values[name] = number
    result, told = _evaluate(texts, values, table)
    findings += told
    return Numbers(
        {name: result[name] for name in table if name in result},
        _scope(table, result),
        {PREFIX + name: text for name, text in texts.items()},
        tuple(findings),
    )


def _plain_number(raw: Any, where: str) -> NamedNumber | None:
    """Number of a text without names or operators, or a bare number; `None` for a formula."""
    example = 'Use e.g. "26 mm", 0.3, or a formula such as "arm / 2"'
    if isinstance(raw, (int, float)) and not isinstance(raw, bool):
        return NamedNumber(parse(str(raw), RATIO, where=where), "1")
    if not isinstance(raw, str):
        raise refuse(where, "not a number", example)
    number, unit = split_unit(raw)
    try:
        quantity = quantity_of_unit(unit)
    except ValueError as error:
        if number and is_plain(raw) and not is_formula(raw, {}):
            raise refuse(where, f'found "{raw[:60]}": {error}', example) from None
        return None
    return NamedNumber(parse(raw, quantity, where=where), unit) if number else None


def _evaluate(
    texts: Mapping[str, str], values: Mapping[str, NamedNumber], table: Mapping[str, Any]
) -> tuple[dict[str, NamedNumber], list[Finding]]:
    """Named numbers including computed ones, in order of dependence, and their errors."""
    expressions: dict[str, Expression] = {}
    findings: list[Finding] = []
    for name, text in texts.items():
        try:
            expressions[name] = parse_expression(text)
        except ExpressionError as error:
            findings.append(Finding(PREFIX + name, error.what, error.advice))
    findings += cycle_findings(expressions)
    result = dict(values)
    for name in _order(expressions):
        try:
            amount = evaluate(expressions[name], _scope(table, result))
            result[name] = NamedNumber(amount.value, shown_unit(amount))
        except ExpressionError as error:
            findings.append(Finding(PREFIX + name, error.what, error.advice))
        except UnknownAmountError:
            continue  # the error of its operand is reported
    return result, findings


def shown_unit(amount: Amount) -> str:
    """Return the unit in which a computed named number is displayed; raises `ExpressionError` if no supported unit exists.

    >>> shown_unit(amount_of(NamedNumber(0.026, "um")))
    'mm'
    """
    unit = quantity_of_dimension(amount.dimension).shown
    if not is_unit(unit) and unit != "1":
        raise ExpressionError(f"the unit {unit} is not supported", "Use the root directly in the formula that requires it")
    return unit


def _order(expressions: Mapping[str, Expression]) -> list[str]:
    """Names in order of dependence, without circular ones and their dependents."""
    lost = {name for circle in cycles(expressions) for name in circle}
    names = {name: expression.names for name, expression in expressions.items() if name not in lost}
    return [name for name in TopologicalSorter(names).static_order() if name in names]


def _scope(table: Mapping[str, Any], result: Mapping[str, NamedNumber]) -> Scope:
    return {name: amount_of(result[name]) if name in result else None for name in table}


def dependents(mechanism: Mechanism, *names: str) -> tuple[str, ...]:
    """Return the addresses of all values that depend on any of these named numbers, in order of dependence.

    >>> formulas = {"numbers.half": "arm/2", "parts.leaf.length": "half", "parts.leaf.width": "1 mm * 2"}
    >>> dependents(Mechanism("", formulas=formulas), "arm")
    ('numbers.half', 'parts.leaf.length')
    """
    known = {address: parse_expression(text).names for address, text in mechanism.formulas.items()}
    inner = {address.removeprefix(PREFIX): used for address, used in known.items() if address.startswith(PREFIX)}
    moved = set(names)
    ordered: list[str] = []
    for number in TopologicalSorter(inner).static_order():
        if known.get(PREFIX + number, frozenset()) & moved:
            moved.add(number)
            ordered.append(PREFIX + number)
    return (*ordered, *(address for address, used in known.items() if used & moved and not address.startswith(PREFIX)))


def depth(mechanism: Mechanism, name: str) -> int:
    """Return the number of formulas in the longest chain that computes a named number.

    >>> depth(Mechanism("", formulas={"numbers.half": "arm/2", "numbers.quarter": "half/2"}), "quarter")
    2
    """
    text = mechanism.formulas.get(PREFIX + name)
    return 0 if text is None else 1 + max((depth(mechanism, each) for each in parse_expression(text).names), default=0)


def cycles(expressions: Mapping[str, Expression]) -> Iterator[tuple[str, ...]]:
    """Yield circular dependencies, each once, as the names from one name back to itself.

    >>> list(cycles({"a": parse_expression("2*b"), "b": parse_expression("a")}))
    [('a', 'b', 'a')]
    """
    left = {name: expression.names for name, expression in expressions.items()}
    while True:
        try:
            TopologicalSorter(left).prepare()
        except CycleError as error:
            result = tuple(reversed(error.args[1]))
            first = result.index(min(result))
            yield (*result[first:-1], *result[: first + 1]) if first else result
            left = {name: names for name, names in left.items() if name not in result}
        else:
            return


def cycle_findings(expressions: Mapping[str, Expression]) -> Iterator[Finding]:
    """Return errors for circular dependencies."""
    for circle in cycles(expressions):
        yield Finding(PREFIX + circle[0], f"circular formulas: {' -> '.join(circle)}", "Replace one of these formulas by a number")


def spelling_findings(name: str) -> Iterator[Finding]:
    """Yield errors in the name of a number: only letters, digits and _ are allowed, and function names are reserved.

    >>> print(*spelling_findings("sin"))
    numbers.sin: sin is reserved in formulas. Rename the number, e.g. sin_1.
    """
    if not _NAME.fullmatch(name):
        yield Finding(PREFIX + name[:60], "invalid name (expected a letter, then letters, digits and _)", "Rename the number")
    elif name in FUNCTIONS or name.lower() in _NOT_FINITE:
        yield Finding(PREFIX + name, f"{name} is reserved in formulas", f"Rename the number, e.g. {name}_1")


def unused_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors for named numbers that are not used in any formula or requirement.

    >>> print(*unused_findings(Mechanism("", numbers={"arm": NamedNumber(0.026, "mm")})))
    numbers.arm: no formula or requirement uses it. Use it in a formula, or remove it.
    """
    used = {name for text in mechanism.formulas.values() for name in parse_expression(text).names}
    used |= {key.removeprefix(PREFIX) for key in mechanism.requirements}
    for name in mechanism.numbers:
        if name not in used:
            yield Finding(PREFIX + name, "no formula or requirement uses it", "Use it in a formula, or remove it")
