"""Arithmetic expressions of numbers with units and of named numbers, with + - * / ( ), sqrt, sin, cos, tan only.

A unit belongs to the number before it. The unit extends to the last unit name: `10 um/V` is one number, `10 um/arm` is a quotient. Values
are floats, complex numbers or arrays with dimensions; the angle is a separate dimension.
"""

from __future__ import annotations

import functools
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

import numpy as np

from flexstage.base.finding import list_choices, suggest_nearest
from flexstage.base.number import freeze
from flexstage.base.units.dimension import Dimension, common_spelling, dimension_of
from flexstage.base.units.unit import ANGLE_POWERS, number_with_unit, quantity_of_dimension

FUNCTIONS: Mapping[str, Callable[[Any], Any]] = {"sqrt": np.sqrt, "sin": np.sin, "cos": np.cos, "tan": np.tan}
LONGEST = 300
DEEPEST = 20
_NUMBER = re.compile(r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?")
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_UNIT_NAME = re.compile(r"(?:g0|[A-Za-zµμ°%_]+)(?:\^-?[0-9](?:\.[0-9])?)?(?![\w^])")
_BETWEEN = re.compile(r"\s*[*/]?\s*")
_PLAIN = re.compile(r"[+-]?(?:\d+[\d.,]*|\.\d+)(?:[eE][+-]?\d+)?\s*(?:/?[^\W\d_%°(](?:[^+\-]|\^-)*|[%°(](?:[^+\-]|\^-)*|1\s*/.*)?")
_ZERO = Fraction(0)


class ExpressionError(ValueError):
    """Error in an expression, with a hint."""

    def __init__(self, what: str, advice: str) -> None:
        self.what, self.advice = what, advice
        super().__init__(f"{what}. {advice}.")


@dataclass(frozen=True, eq=False)
class Amount:
    """Value in coherent SI units, and its dimension."""

    value: Any
    dimension: Dimension

    def noun(self) -> str:
        """Return the kind of quantity in words, e.g. "a length", "a ratio" or "a quantity in m^2".

        >>> evaluate(parse_expression("2 mm * 3 mm"), {}).noun()
        'a quantity in m^2'
        """
        return quantity_of_dimension(self.dimension).noun


Scope = Mapping[str, Amount | None]
"""Amounts by name; `None` for a named number whose error is already reported."""


class UnknownAmountError(Exception):
    """Error for a named number without a known amount; its cause is already reported elsewhere."""


@dataclass(frozen=True, eq=False)
class Expression:
    """Parsed arithmetic expression: the `names` it uses, and a function `amount` that evaluates it for a scope.

    If `literal`, the expression is one number with its unit. `amount` raises `ExpressionError` for inconsistent dimensions, unknown names,
    and values out of range.
    """

    names: frozenset[str]
    amount: Callable[[Scope], Amount]
    literal: bool = False


def _named(name: str, scope: Scope) -> Amount:
    if name not in scope:
        raise ExpressionError(f'unknown number "{name}"', _name_advice(name, scope))
    result = scope[name]
    if result is None:
        raise UnknownAmountError(name)
    return result


def _literal(amount: Amount, unit: str, scope: Scope) -> Amount:
    """A number with its unit, unless a named number has the name of that unit and could be meant."""
    if (named := scope.get(unit)) is not None and named.dimension.powers == amount.dimension.powers:
        raise ExpressionError(f'"{unit}" is a unit and a named number of the same quantity', f"Rename the number, e.g. {unit}_1")
    return amount


def _negative(inner: Expression, scope: Scope) -> Amount:
    result = inner.amount(scope)
    return Amount(-result.value, result.dimension)


_VALUES: Mapping[str, Callable[[Any, Any], Any]] = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}


def _pair(sign: str, first: Expression, second: Expression, text: str, scope: Scope) -> Amount:
    left, right = first.amount(scope), second.amount(scope)
    if sign == "/" and np.any(np.equal(right.value, 0.0)):
        raise ExpressionError(f'"{text}" divides by 0', "Check the number that is 0")
    value = _VALUES[sign](left.value, right.value)
    if sign in "*/":
        return Amount(value, left.dimension.times(right.dimension, Fraction(1 if sign == "*" else -1)))
    if left.dimension.powers != right.dimension.powers:
        word = "adds" if sign == "+" else "subtracts"
        what = f'"{text}" {word} different quantities: {left.noun()} and {right.noun()}'
        raise ExpressionError(what, "Use the same unit for both")
    return Amount(value, left.dimension)


def _call(function: str, argument: Expression, text: str, scope: Scope) -> Amount:
    inner = argument.amount(scope)
    if function == "sqrt":
        if np.any(np.real(inner.value) < 0.0):
            raise ExpressionError(f'"{text}" is the square root of a negative number', "Check its sign")
        return Amount(freeze(np.sqrt(inner.value)), _ONE.times(inner.dimension, Fraction(1, 2)))
    if inner.dimension.powers != ANGLE_POWERS:
        what = f'"{text}" requires an angle (got {inner.noun()})'
        raise ExpressionError(what, "Write the angle with its unit, for example sin(30 deg)")
    return Amount(freeze(FUNCTIONS[function](inner.value)), _ONE)


_ONE = Dimension(Fraction(1))


@functools.lru_cache(maxsize=1024)
def parse_expression(text: str) -> Expression:
    """Parse an expression; raises `ExpressionError`.

    >>> sorted(parse_expression("2*arm + sqrt(half*arm) - 1 mm").names)
    ['arm', 'half']
    """
    if len(text) > LONGEST:
        raise ExpressionError(
            f"formula too long (got {len(text)} characters, expected at most {LONGEST})", "Name parts of the formula in [numbers]"
        )
    return _Parser(common_spelling(text)).whole()


def evaluate(expression: Expression, scope: Scope) -> Amount:
    """Evaluate an expression with the named amounts of `scope`; raises `ExpressionError`, also for a result that is not finite.

    >>> arm = Amount(0.026, dimension_of("m"))
    >>> round(evaluate(parse_expression("arm/2 + 1 mm"), {"arm": arm}).value, 12)
    0.014
    """
    with np.errstate(all="ignore"):
        result = expression.amount(scope)
    if not np.all(np.isfinite(result.value)):
        raise ExpressionError("its value is not finite", "Check the numbers in the formula")
    return result


def is_plain(text: str) -> bool:
    """Return whether a string has the form of one number with an optional unit; the unit need not be valid.

    >>> is_plain("25,4 mm"), is_plain("3 m^-2"), is_plain("2*arm"), is_plain("arm"), is_plain("1 mm + 2 mm")
    (True, True, False, False, False)
    """
    return _PLAIN.fullmatch(text.strip()) is not None


class _Parser:
    """Recursive-descent parser: sums of products of signed atoms."""

    def __init__(self, text: str) -> None:
        self.text, self.at, self.depth = text, 0, 0

    def whole(self) -> Expression:
        result = self.sum()
        if self.at < len(self.text):
            raise self.unexpected()
        return result

    def sum(self) -> Expression:
        return self.chain("+-", self.product)

    def product(self) -> Expression:
        return self.chain("*/", self.signed)

    def chain(self, signs: str, inner: Callable[[], Expression]) -> Expression:
        start = self.at
        left = inner()
        while sign := self.sign(signs):
            right = inner()
            left = Expression(left.names | right.names, partial(_pair, sign, left, right, self.text[start : self.at].strip()))
        return left

    def signed(self) -> Expression:
        if not self.sign("-"):
            return self.atom()
        inner = self.deeper(self.signed)
        return Expression(inner.names, partial(_negative, inner))

    def atom(self) -> Expression:
        start = self.at
        if number := self.match(_NUMBER):
            end = unit_end(self.text, self.at)
            unit, self.at = self.text[self.at : end].strip(), end
            return Expression(frozenset(), partial(_literal, _amount(number, unit), unit), literal=True)
        if self.sign("("):
            return self.inside()
        name = self.match(_NAME)
        if name is None:
            raise self.unexpected()
        if self.sign("("):
            if name not in FUNCTIONS:
                raise ExpressionError(f'unknown function "{name}"', f"Use {list_choices([*FUNCTIONS])}")
            inner = self.inside()
            return Expression(inner.names, partial(_call, name, inner, self.text[start : self.at].strip()))
        return Expression(frozenset([name]), partial(_named, name))

    def inside(self) -> Expression:
        result = self.deeper(self.sum)
        if not self.sign(")"):
            raise self.unexpected()
        return result

    def deeper(self, inner: Callable[[], Expression]) -> Expression:
        self.depth += 1
        if self.depth > DEEPEST:
            raise ExpressionError(f"nested deeper than {DEEPEST} levels", "Name parts of the formula in [numbers]")
        result = inner()
        self.depth -= 1
        return result

    def sign(self, signs: str) -> str:
        """Next sign, if it is one of these."""
        return self.match(re.compile(rf"[{re.escape(signs)}]")) or ""

    def match(self, pattern: re.Pattern[str]) -> str | None:
        """Next token after blanks, if it matches."""
        blank = len(self.text) - len(self.text[self.at :].lstrip())
        result = pattern.match(self.text, blank)
        if result is None:
            return None
        self.at = result.end()
        return result[0]

    def unexpected(self) -> ExpressionError:
        """Error of an unexpected token."""
        before, rest = self.text[: self.at].strip(), self.text[self.at :].strip()
        if not rest:
            return ExpressionError(f'"{self.text.strip()}" ends too early', "Complete the formula")
        name = _NAME.match(rest)
        after = f'after "{before}"' if before else "at its beginning"
        if name and before:
            advice = f"Multiply by a named number with *: {before[-20:]}*{name[0]}"
            return ExpressionError(f'"{name[0]}" {after} is not a unit, and an operator is missing', advice)
        if rest[0] == "^":
            return ExpressionError(f'found "^" {after}', "Powers are written as products, arm*arm, and roots as sqrt(arm)")
        if rest[0] == ",":
            return ExpressionError(f'found "," {after}', "Use a decimal point")
        return ExpressionError(f'found "{rest[0]}" {after}', "Use + - * / ( ), sqrt, sin, cos, tan, numbers with units, and names")


def unit_end(text: str, at: int) -> int:
    """Return the index in `text` after the unit that begins at index `at`; `at` if there is no unit.

    >>> unit_end("10 um/arm", 2), unit_end("10 um/V", 2)
    (5, 7)
    """
    start = re.compile(r"\s*(?:1\s*/|/)?\s*").match(text, at)
    end = _unit(text, start.end() if start else at)
    return at if end is None else end


def _unit(text: str, at: int) -> int | None:
    """End of a product or quotient of unit names; `None` if there is none."""
    end = _factor(text, at)
    while end is not None:
        between = _BETWEEN.match(text, end)
        further = _factor(text, between.end() if between else end)
        if further is None:
            return end
        end = further
    return None


def _factor(text: str, at: int) -> int | None:
    if text[at : at + 1] == "(":
        end = _unit(text, at + 1)
        closing = re.compile(r"\s*\)").match(text, end) if end is not None else None
        return closing.end() if closing else None
    name = _UNIT_NAME.match(text, at)
    return name.end() if name and is_unit(name[0]) and text[name.end() : name.end() + 1] != "(" else None


def is_unit(name: str) -> bool:
    """Return whether a name is a unit, with or without a power.

    >>> is_unit("mm"), is_unit("arm")
    (True, False)
    """
    try:
        dimension_of(name)
    except ValueError:
        return False
    return True


def _amount(number: str, unit: str) -> Amount:
    value, dimension = number_with_unit(number, unit)
    if not np.isfinite(value) or (value == 0.0 and Fraction(number) != _ZERO):
        raise ExpressionError(f'outside the range of double precision (got "{number} {unit}")', "Check the exponent and the unit")
    return Amount(value, dimension)


_POWER = re.compile(r"([A-Za-z]+)([2-9])")


def _name_advice(name: str, scope: Scope) -> str:
    if is_unit(name):
        return f"{name} is a unit: write 1 {name}"
    if name in FUNCTIONS:
        return f"{name} is a function: {name}(...)"
    if (power := _POWER.fullmatch(name)) is not None and is_unit(power[1]):
        return f"Powers of units have the sign ^: {power[1]}^{power[2]}"
    return suggest_nearest(name, scope) if scope else f'Define it: [numbers] {name} = "26 mm"'
