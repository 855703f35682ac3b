"""Units at the border: text with units to SI numbers and back. Inside the package every number is SI.

Units are pint's, from a short list of definitions in which the angle is a dimension of its own, so that degrees are never taken for
ratios and rad/s never for Hz. All arithmetic is exact (fractions); a text is rounded once, to the float nearest to what it says, so that
"1.54 mm" is the float 0.00154.
"""

from __future__ import annotations

import functools
import importlib
import re
from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any, TypeAlias

import numpy as np

from flexstage.base import quantity as quantities
from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Number
from flexstage.base.quantity import RATIO, Quantity

_DEFINITIONS = """
nano- = 1e-9 = n-
micro- = 1e-6 = u- = µ- = μ-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
pico- = 1e-12 = p-
meter = [length] = m = metre
gram = [mass] = g
second = [time] = s
kelvin = [temperature] = K
radian = [angle] = rad
ampere = [current] = A
pi = 3.1415926535897932384626433832795028841971693993751
degree = pi / 180 * radian = deg = °
arcminute = degree / 60 = arcmin
arcsecond = degree / 3600 = arcsec
newton = kilogram * meter / second ** 2 = N
pascal = newton / meter ** 2 = Pa
joule = newton * meter = J
watt = joule / second = W
hertz = 1 / second = Hz
coulomb = ampere * second = C
volt = watt / ampere = V
farad = coulomb / volt = F
bar = 1e5 * pascal
minute = 60 * second = min
hour = 3600 * second = h
tonne = 1000 * kilogram = t
inch = 25.4 * millimeter = in
pound = 0.45359237 * kilogram = lb
pound_force = 4.4482216152605 * newton = lbf
psi = pound_force / inch ** 2
standard_gravity = 9.80665 * meter / second ** 2 = g0
percent = 0.01 = %
ppm = 1e-6
"""
_OFFSET_SCALE = re.compile(r"deg(?:ree)?_?[CF]|celsius|fahrenheit", re.IGNORECASE)
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?")
_SIGNS = re.compile(r"[A-Za-zµμ°%_0-9^*/(). \-]+")
_POWERS_AND_ONES = re.compile(r"(?<=[A-Za-z0%°])\^-?[0-9](?:\.[0-9])?(?![0-9.^])|(?<![A-Za-z0-9_.^-])1(?=\s*/)|\bg0\b")
_LONGEST = 60

_Scale: TypeAlias = tuple[Fraction, frozenset[tuple[str, Fraction]]]


def parse(text: str, quantity: Quantity, *, where: str = "value") -> float:
    """Return the SI value of a text with a unit.

    A ratio is a bare number or has "%". Raises `DesignError` at `where` for a missing or unknown unit, a wrong dimension (both are named),
    a temperature scale with an offset, or a number that is not finite.

    >>> from flexstage.base.quantity import ANGLE, LENGTH, STIFFNESS
    >>> parse("1.54 mm", LENGTH), parse("17 N/um", STIFFNESS), parse("5 %", RATIO)
    (0.00154, 17000000.0, 0.05)
    >>> parse("180deg", ANGLE)
    3.141592653589793
    """
    number, unit = _split(text, quantity, where)
    scale = _relative(unit, quantity, where, text)
    value = _rounded(Fraction(number) * scale, text, where)
    return -0.0 if value == 0.0 and number.startswith("-") else value


def show(value: Number, quantity: Quantity, unit: str | None = None, *, digits: int | None = None) -> str:
    """Return an SI value as text in `unit` (absent: the quantity's shown unit).

    Without `digits`: the shortest text that `parse` takes back to the same bits. An array shows its range and size.

    >>> from flexstage.base.quantity import LENGTH, STIFFNESS
    >>> show(0.00154, LENGTH), show(1.03e7, STIFFNESS, "N/mm"), show(2.0 / 3.0, LENGTH, digits=4)
    ('1.54 mm', '10300 N/mm', '666.7 mm')
    """
    if isinstance(value, np.ndarray):
        return _show_range(value, quantity, unit, digits)
    number = float(np.real(value))
    unit = unit or quantity.shown
    if not np.isfinite(number):
        return _with_unit(str(number), unit)
    scale = _relative(unit, quantity, "unit", unit)
    text = _shortest(number, scale) if digits is None else _decimal(Fraction(number) / scale, digits)
    return _with_unit(f"-{text}" if str(number) == "-0.0" else text, unit)


def convert(value: Number, quantity: Quantity, unit: str | None = None) -> Number:
    """Return an SI value (float or array) in `unit` (absent: the quantity's shown unit).

    >>> from flexstage.base.quantity import LENGTH
    >>> convert(0.002, LENGTH), convert(0.0254, LENGTH, "in")
    (2.0, 1.0)
    """
    unit = unit or quantity.shown
    scale = _relative(unit, quantity, "unit", unit)
    if scale.denominator == 1:
        return value / float(scale)
    return value * float(1 / scale)


def missing_unit(found: Any, quantity: Quantity, *, where: str) -> DesignError:
    """The error of a number that has no unit.

    >>> from flexstage.base.quantity import LENGTH
    >>> str(missing_unit(1.54, LENGTH, where="parts.neck.thickness"))
    'parts.neck.thickness: found 1.54 without a unit. Write for example "1.54 mm".'
    """
    shown = f'"{found}"' if isinstance(found, str) else f"{found}"
    return refuse(where, f"found {shown} without a unit", f'Write for example "{quantity.example}"')


def _split(text: str, quantity: Quantity, where: str) -> tuple[str, str]:
    text = text.strip()
    match = _NUMBER.match(text)
    if match is None or len(match[0]) > _LONGEST:
        raise _no_number(text, quantity, where)
    number, unit = match[0], text[match.end() :].strip()
    if re.match(r"(?!1\s*/)[\d.,eE]*\d", unit):
        raise _no_number(text, quantity, where)
    if not unit and quantity is not RATIO:
        raise missing_unit(text, quantity, where=where)
    return number, unit or "1"


def _no_number(text: str, quantity: Quantity, where: str) -> DesignError:
    shown = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."
    example = f'Write for example "{quantity.example}"'
    if re.match(r"[+-]?(nan|inf)", text, re.IGNORECASE):
        return refuse(where, f'found "{shown}", which is not finite', example)
    if re.match(r"[+-]?\d+,\d", text):
        return refuse(where, f'found "{shown}" with a comma', f"The decimal sign is a point. {example}")
    return refuse(where, f'found "{shown}" where a {quantity.name} is expected', example)


def _rounded(exact: Fraction, text: str, where: str) -> float:
    value = _nearest(exact)
    if not np.isfinite(value) or (value == 0.0 and exact != 0):
        raise refuse(where, f'found "{text}", which no double-precision number can hold', "Check the exponent and the unit")
    return value


def _nearest(exact: Fraction) -> float:
    try:
        return float(exact)
    except OverflowError:
        return float("inf")


def _relative(unit: str, quantity: Quantity, where: str, text: str) -> Fraction:
    """The unit's size in the quantity's SI unit, after checking its dimension."""
    example = f'Write for example "{quantity.example}"'
    if unit == quantity.si:
        return Fraction(1)
    try:
        size, dimension = _scale(unit)
    except ValueError as error:
        raise refuse(where, f'found "{text}": {error}', example) from None
    for form in (quantity.si, *quantity.also):
        base, expected = _scale(form)
        if dimension == expected:
            return size / base
    raise refuse(where, f'found "{text}", {_dimension_name(unit, dimension)}, where a {quantity.name} is expected', example)


def _dimension_name(unit: str, dimension: frozenset[tuple[str, Fraction]]) -> str:
    for known in vars(quantities).values():
        if isinstance(known, Quantity) and known.si != "mixed" and _scale(known.si)[1] == dimension:
            return f"{'an' if known.name[0] in 'aeiou' else 'a'} {known.name}"
    return f"a quantity in {unit}"


@functools.lru_cache(maxsize=512)
def _scale(unit: str) -> _Scale:
    """Size in kilogram-metre-second base units and dimension; raises `ValueError` with what is wrong with the unit."""
    plain = _plain(unit)
    if plain == "1":
        return Fraction(1), frozenset()
    if _OFFSET_SCALE.search(plain):
        raise ValueError("degC and degF have an offset; a difference of temperature is given in K")
    registry = _registry()
    try:
        parsed = registry.Unit(plain)
        size, _ = registry.get_root_units(parsed)
        dimension = frozenset((name, Fraction(power)) for name, power in parsed.dimensionality.items())
    except Exception as error:  # pint and the tokenizer under it raise many kinds; every one means the same to the user
        raise ValueError(_unit_problem(plain, error)) from None
    return Fraction(size), dimension


def _plain(unit: str) -> str:
    """The unit in the few signs that are allowed: names, products, quotients and small powers of names; no arithmetic reaches pint."""
    plain = unit[: _LONGEST + 1]
    for sign, meaning in (("**", "^"), ("·", " "), ("²", "^2"), ("³", "^3"), ("°C", "degC"), ("°F", "degF")):
        plain = plain.replace(sign, meaning)
    plain = f"1{plain}" if plain.startswith("/") else plain
    stray = re.search(r"[0-9^.\-]", _POWERS_AND_ONES.sub("", plain))
    if plain != "1" and (stray or len(plain) > _LONGEST or not _SIGNS.fullmatch(plain)):
        raise ValueError("the unit cannot be read")
    return plain


def _unit_problem(unit: str, error: Exception) -> str:
    names = getattr(error, "unit_names", None)
    name = names if isinstance(names, str) else (names[0] if names else unit)
    return f'"{name}" is not a known unit'


@functools.cache
def _registry() -> Any:
    pint = importlib.import_module("pint")  # 0.3 s, spent only where texts are read or written
    registry = pint.UnitRegistry(None, non_int_type=Fraction)
    registry.load_definitions(_DEFINITIONS.splitlines())
    return registry


def _show_range(value: Any, quantity: Quantity, unit: str | None, digits: int | None) -> str:
    if value.size == 0:
        return "no values"
    low, high = (show(float(bound), quantity, unit, digits=digits) for bound in (np.min(value.real), np.max(value.real)))
    return f"{low} to {high} ({value.size} values)"


def _with_unit(text: str, unit: str) -> str:
    return text if unit == "1" else f"{text} {unit}"


def _shortest(value: float, scale: Fraction) -> str:
    exact = Fraction(value) / scale
    for digits in range(1, 18):
        text = _decimal(exact, digits)
        if _nearest(Fraction(text) * scale) == value:
            return text
    return _decimal(exact, 18)


def _decimal(value: Fraction, digits: int) -> str:
    """The fraction rounded to `digits` significant digits: plain, or with an exponent that is a multiple of three."""
    with localcontext() as context:
        context.prec = digits
        rounded = (Decimal(value.numerator) / Decimal(value.denominator)).normalize()
        power = rounded.adjusted()
        if rounded == 0 or -5 < power < 7:
            return f"{rounded:f}"
        power = 3 * (power // 3)
        return f"{rounded.scaleb(-power):f}e{power}"
