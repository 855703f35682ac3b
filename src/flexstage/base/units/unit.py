"""Conversion of strings with units to SI numbers and back. Inside the package every number is SI.

The angle is a separate dimension: degrees are distinct from ratios, and rad/s is distinct from Hz. All arithmetic is exact (fractions). The
value of a string is rounded only once, to the nearest float: "1.54 mm" is the float 0.00154.
"""

from __future__ import annotations

import functools
import re
from dataclasses import replace
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any

import numpy as np

from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Number
from flexstage.base.units import quantity as quantities
from flexstage.base.units.dimension import Dimension, dimension_of
from flexstage.base.units.quantity import RATIO, Quantity

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?")
_LONGEST = 60


def parse(text: str, quantity: Quantity, *, where: str = "value") -> float:
    """Parse a string with a unit and return its SI value.

    A ratio is a number without a unit, or with "%". Zero needs no unit. Raises `DesignError` at `where` for a missing or unknown unit, a
    wrong dimension, a temperature scale with an offset, or a number that is not finite.

    >>> from flexstage.base.units.quantity import ANGLE, LENGTH, STIFFNESS
    >>> parse("1.54 mm", LENGTH), parse("17 N/um", STIFFNESS), parse("5 %", RATIO)
    (0.00154, 17000000.0, 0.05)
    >>> parse("180deg", ANGLE)
    3.141592653589793
    """
    number, unit = _split(text, quantity, where)
    scale = _unit_scale(unit, quantity, where, text)
    value = _round(Fraction(number) * scale, text, where)
    return -0.0 if value == 0.0 and number.startswith("-") else value


def show(value: Number, quantity: Quantity, unit: str | None = None, *, digits: int | None = None) -> str:
    """Return an SI value as a string in `unit` (default: the quantity's display unit).

    If `digits` is not specified, the result is the shortest string that `parse` converts back to the same bits. For an array, the string
    contains the range and size.

    >>> from flexstage.base.units.quantity import LENGTH, STIFFNESS
    >>> show(0.00154, LENGTH), show(1.03e7, STIFFNESS, "N/mm"), show(2.0 / 3.0, LENGTH, digits=4)
    ('1.54 mm', '10300 N/mm', '666.7 mm')
    """
    if isinstance(value, np.ndarray):
        return _show_range(value, quantity, unit, digits)
    number = float(np.real(value))
    unit = unit or quantity.shown
    if not np.isfinite(number):
        return _with_unit(str(number), unit)
    scale = _unit_scale(unit, quantity, "unit", unit)
    text = _shortest_text(number, scale) if digits is None else _decimal(Fraction(number) / scale, digits)
    return _with_unit(f"-{text}" if str(number) == "-0.0" else text, unit)


def convert(value: Number, quantity: Quantity) -> Number:
    """Return an SI value (float or array) in the quantity's display unit.

    >>> from flexstage.base.units.quantity import LENGTH
    >>> convert(0.002, LENGTH)
    2.0
    """
    scale = _unit_scale(quantity.shown, quantity, "unit", quantity.shown)
    if scale.denominator == 1:
        return value / float(scale)
    return value * float(1 / scale)


def missing_unit(found: Any, quantity: Quantity, *, where: str) -> DesignError:
    """Return the error for a number `found` without a unit, at `where`.

    >>> from flexstage.base.units.quantity import LENGTH
    >>> str(missing_unit(1.54, LENGTH, where="parts.neck.thickness"))
    'parts.neck.thickness: unit missing (got 1.54). Use a length, e.g. "2 mm".'
    """
    shown = f'"{found}"' if isinstance(found, str) else f"{found}"
    return refuse(where, f"unit missing (got {shown})", f"Use {quantity.noun}, e.g. {example(quantity)}")


def number_with_unit(number: str, unit: str) -> tuple[float, Dimension]:
    """Convert the strings of a number and its unit to a value in coherent SI units and a dimension. A number without a unit is a ratio.

    >>> number_with_unit("26", "mm")[0], number_with_unit("5", "%")[0], number_with_unit("3", "kN")[0]
    (0.026, 0.05, 3000.0)
    """
    dimension = dimension_of(unit or "1")
    return _to_float(Fraction(number) * dimension.size / _coherent_size(dimension)), Dimension(Fraction(1), dimension.powers)


def split_unit(text: str) -> tuple[str, str]:
    """Split a string into its leading number (empty if there is none) and its unit (`1` if there is none).

    >>> split_unit("26 mm"), split_unit("0.3"), split_unit("arm / 2")
    (('26', 'mm'), ('0.3', '1'), ('', 'arm / 2'))
    """
    match = _NUMBER.match(text.strip())
    number = match[0] if match else ""
    return number, text.strip()[len(number) :].strip() or "1"


@functools.lru_cache(maxsize=512)
def quantity_of_dimension(dimension: Dimension, unit: str = "") -> Quantity:
    """Return the first known quantity of a dimension, displayed in `unit`; for an unknown dimension, a quantity named by its SI unit.

    >>> quantity_of_dimension(dimension_of("mm"), "mm").noun, quantity_of_dimension(dimension_of("mm^3")).si
    ('a length', 'm^3')
    """
    powers = dimension.powers
    known = (each for each in vars(quantities).values() if isinstance(each, Quantity) and each.si != "mixed")
    result = next((each for each in known if dimension_of(each.si).powers == powers), None)
    si = _si_text(powers)
    result = result or Quantity(f"quantity in {si}", si, si, f"1 {si}")
    return result if unit in ("", result.shown) else replace(result, shown=unit, example=f"1 {unit}")


def quantity_of_unit(unit: str) -> Quantity:
    """Return the quantity of a unit, with this unit as its display unit; raises `ValueError` for an unknown unit.

    >>> quantity_of_unit("mm").noun, quantity_of_unit("mm").shown
    ('a length', 'mm')
    """
    return quantity_of_dimension(dimension_of(unit), unit)


_SI_NAMES = {"length": "m", "mass": "kg", "time": "s", "temperature": "K", "angle": "rad", "memory": "B", "current": "A"}
ANGLE_POWERS = (("[angle]", Fraction(1)),)


def _si_text(powers: tuple[tuple[str, Fraction], ...]) -> str:
    def factor(name: str, power: Fraction) -> str:
        return _SI_NAMES[name.strip("[]")] + ("" if power == 1 else f"^{float(power):g}")

    above = " ".join(factor(name, power) for name, power in powers if power > 0)
    below = "".join(f"/{factor(name, -power)}" for name, power in powers if power < 0)
    return (above or "1") + below


def _coherent_size(dimension: Dimension) -> Fraction:
    """Size of the coherent SI unit of a dimension: a kilogram is 1000 of the base unit gram."""
    return Fraction(1000 ** dict(dimension.powers).get("[mass]", Fraction(0)))


def _split(text: str, quantity: Quantity, where: str) -> tuple[str, str]:
    text = text.strip()
    match = _NUMBER.match(text)
    if match is None or len(match[0]) > _LONGEST:
        raise _no_number(text, quantity, where)
    number, unit = match[0], text[match.end() :].strip()
    if re.match(r"(?!1\s*/)[\d.,eE]*\d", unit):
        raise _no_number(text, quantity, where)
    if not unit and quantity is not RATIO and Fraction(number) == 0:
        return number, quantity.si if quantity.si != "mixed" else "1"
    if not unit and quantity is not RATIO:
        raise missing_unit(text, quantity, where=where)
    return number, unit or "1"


def _no_number(text: str, quantity: Quantity, where: str) -> DesignError:
    shown = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
    if re.match(r"[+-]?(nan|inf)", text, re.IGNORECASE):
        return refuse(where, f'must be finite (got "{shown}")', f"Use e.g. {example(quantity)}")
    if re.match(r"[+-]?\d+,\d+(?![\d.,])", text):
        return refuse(where, f'decimal comma (got "{shown}")', f'Use a decimal point: "{shown.replace(",", ".")}"')
    return refuse(where, f'must be {quantity.noun} (got "{shown}")', f"Use e.g. {example(quantity)}")


def example(quantity: Quantity) -> str:
    """Return an example of input for a quantity. The example of a ratio has no quotes.

    >>> example(RATIO)
    '0.3'
    """
    return quantity.example if quantity is RATIO else f'"{quantity.example}"'


def _round(exact: Fraction, text: str, where: str) -> float:
    value = _to_float(exact)
    if not np.isfinite(value) or (value == 0.0 and exact != 0):
        raise refuse(where, f'outside the range of double precision (got "{text}")', "Check the exponent and the unit")
    return value


def _to_float(exact: Fraction) -> float:
    try:
        return float(exact)
    except OverflowError:
        return float("inf")


def _unit_scale(unit: str, quantity: Quantity, where: str, text: str) -> Fraction:
    """The unit's size in the quantity's SI unit, after checking its dimension."""
    hint = f"Use e.g. {example(quantity)}"
    if unit == quantity.si:
        return Fraction(1)
    try:
        dimension = dimension_of(unit)
    except ValueError as error:
        raise refuse(where, f'{error} (got "{text}", expected {quantity.noun})', hint) from None
    for form in (quantity.si, *quantity.also):
        expected = dimension_of(form)
        if dimension.powers == expected.powers:
            return dimension.size / expected.size
    raise refuse(where, f'must be {quantity.noun} (got "{text}", {_dimension_name(unit, dimension)})', hint)


def _dimension_name(unit: str, dimension: Dimension) -> str:
    known = quantity_of_dimension(dimension)
    return f"a quantity in {unit}" if known.name.startswith("quantity in ") else known.noun


def _show_range(value: Any, quantity: Quantity, unit: str | None, digits: int | None) -> str:
    if value.size == 0:
        return "no values"
    low, high = (show(float(bound), quantity, unit, digits=digits) for bound in (np.min(value.real), np.max(value.real)))
    return f"{low} to {high} ({value.size} values)"


def _with_unit(text: str, unit: str) -> str:
    return text if unit == "1" else f"{text} {unit}"


def _shortest_text(value: float, scale: Fraction) -> str:
    exact = Fraction(value) / scale
    for digits in range(1, 18):
        text = _decimal(exact, digits)
        if _to_float(Fraction(text) * scale) == value:
            return text
    return _decimal(exact, 18)


def _decimal(value: Fraction, digits: int) -> str:
    """Fraction rounded to `digits` significant digits: plain, or with an exponent that is a multiple of three."""
    with localcontext() as context:
        context.prec = digits
        rounded = (Decimal(value.numerator) / Decimal(value.denominator)).normalize()
        power = rounded.adjusted()
        if rounded == 0 or -5 < power < 7:
            return f"{rounded:f}"
        power = 3 * (power // 3)
        return f"{rounded.scaleb(-power):f}e{power}"
