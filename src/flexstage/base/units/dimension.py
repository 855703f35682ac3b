"""Size and dimension of a unit's text.

Names and prefixes are pint's, from a short list of definitions; the angle is a dimension of its own. A unit is a product or quotient of
names with small powers, read from left to right: `N m/rad`, `nm/Hz^0.5`, `um/m/K`, `1/K`, `m/(N m)`. Sizes are exact fractions.
"""

from __future__ import annotations

import functools
import importlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

_PI = Fraction("3.1415926535897932384626433832795028841971693993751")
_DEFINITIONS = """
pico- = 1e-12 = p-
nano- = 1e-9 = n-
micro- = 1e-6 = u- = µ- = μ-
milli- = 1e-3 = m-
centi- = 1e-2 = c-
kilo- = 1e3 = k-
mega- = 1e6 = M-
giga- = 1e9 = G-
mebi- = 1048576 = Mi-
gibi- = 1073741824 = Gi-
meter = [length] = m = metre
gram = [mass] = g
second = [time] = s
kelvin = [temperature] = K
radian = [angle] = rad
byte = [memory] = B
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
henry = volt * second / ampere = H
tesla = volt * second / meter ** 2 = T
ohm = volt / ampere
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
_PREFIXES = {"p": "1e-12", "n": "1e-9", "u": "1e-6", "µ": "1e-6", "m": "1e-3", "c": "1e-2", "k": "1e3", "M": "1e6", "G": "1e9"}
_BASES = {"m": "length", "g": "mass", "s": "time", "K": "temperature", "rad": "angle", "B": "memory", "A": "current"}
_DERIVED = {
    "N": "kg m/s^2",
    "Pa": "N/m^2",
    "J": "N m",
    "W": "J/s",
    "Hz": "1/s",
    "C": "A s",
    "V": "W/A",
    "F": "C/V",
    "H": "V s/A",
    "T": "V s/m^2",
}
"""Names that almost every text has, said once more: for them pint, which takes longer to import than numpy, is not asked."""
_OFFSET_SCALE = re.compile(r"deg(?:ree)?_?[CF]|celsius|fahrenheit", re.IGNORECASE)
_SPELLINGS = (("**", "^"), ("·", " "), ("²", "^2"), ("³", "^3"), ("°C", "degC"), ("°F", "degF"))
_TOKEN = re.compile(r"\s*(?:(?P<name>g0|[A-Za-zµμ°%_]+)(?:\^(?P<power>-?[0-9](?:\.[0-9])?))?|(?P<sign>[*/()1]))\s*")
_LONGEST = 60


@dataclass(frozen=True)
class Dimension:
    """A unit's size in kilogram, metre, second, ... and the powers of its base dimensions, sorted by name."""

    size: Fraction
    powers: tuple[tuple[str, Fraction], ...] = ()

    def times(self, other: Dimension, power: Fraction) -> Dimension:
        """The product with a power of another unit.

        >>> Dimension(Fraction(2)).times(Dimension(Fraction(4)), Fraction(-1)).size
        Fraction(1, 2)
        """
        powers = dict(self.powers)
        for name, exponent in other.powers:
            powers[name] = powers.get(name, Fraction(0)) + exponent * power
        return Dimension(self.size * Fraction(other.size**power), tuple(sorted((name, value) for name, value in powers.items() if value)))


@functools.lru_cache(maxsize=512)
def dimension_of(unit: str) -> Dimension:
    """Return the size and dimension of a unit; raises `ValueError` with what is wrong with it.

    >>> dimension_of("N m").powers == dimension_of("J").powers, dimension_of("N/um").size / dimension_of("N/m").size
    (True, Fraction(1000000, 1))
    """
    stack: list[tuple[Dimension, Fraction]] = []
    product, power, complete = _ONE, Fraction(1), False
    for token in _tokens(unit):
        sign = token["sign"]
        if sign in ("*", "/") and complete:
            power, complete = Fraction(-1 if sign == "/" else 1), False
        elif sign == "(":
            stack.append((product, power))
            product, power, complete = _ONE, Fraction(1), False
        elif sign in ("*", "/") or (sign == ")" and not (stack and complete)):
            raise ValueError("the unit cannot be read")
        elif sign == ")":
            outer, outer_power = stack.pop()
            product, power = outer.times(product, outer_power), Fraction(1)
        else:
            factor = _ONE if sign else _dimension_of_unit(token["name"])
            product, power, complete = product.times(factor, power * Fraction(token["power"] or 1)), Fraction(1), True
    if stack or not complete:
        raise ValueError("the unit cannot be read")
    return product


_ONE = Dimension(Fraction(1))


def common_spelling(text: str) -> str:
    """The text with other signs of products, powers and degrees in their common form.

    >>> common_spelling("kg·m²")
    'kg m^2'
    """
    for spelling, meaning in _SPELLINGS:
        text = text.replace(spelling, meaning)
    return text


def _tokens(unit: str) -> Iterator[re.Match[str]]:
    plain = common_spelling(unit[: _LONGEST + 1])
    plain = f"1{plain}" if plain.startswith("/") else plain
    if _OFFSET_SCALE.search(plain):
        raise ValueError("degC and degF have an offset; a difference of temperature is given in K")
    position = 0
    while position < len(plain):
        match = _TOKEN.match(plain, position)
        if match is None or len(plain) > _LONGEST:
            raise ValueError("the unit cannot be read")
        yield match
        position = match.end()


def _dimension_of_unit(name: str) -> Dimension:
    return common_dimension(name) or _dimension_by_pint(name)


@functools.cache
def common_dimension(name: str) -> Dimension | None:
    """The dimension of a symbol of SI with or without a prefix, of a degree and of a per cent; absent for all other names.

    >>> common_dimension("um").size, common_dimension("lbf")
    (Fraction(1, 1000000), None)
    """
    if name in _BASES:
        return Dimension(Fraction(1), ((f"[{_BASES[name]}]", Fraction(1)),))
    if name in _DERIVED:
        return dimension_of(_DERIVED[name])
    if name == "deg":
        return Dimension(_PI / 180, (("[angle]", Fraction(1)),))
    if name == "%":
        return Dimension(Fraction(1, 100))
    own = common_dimension(name[1:]) if name[:1] in _PREFIXES and name[1:] in {*_BASES, *_DERIVED} else None
    return None if own is None else Dimension(Fraction(_PREFIXES[name[:1]]) * own.size, own.powers)


def _dimension_by_pint(name: str) -> Dimension:
    registry = _registry()
    try:
        unit = registry.Unit(name)
    except (AttributeError, ValueError):  # pint's errors of unknown names
        raise ValueError(f'"{name}" is not a known unit') from None
    size, _ = registry.get_root_units(unit)
    return Dimension(Fraction(size), tuple(sorted((base, Fraction(power)) for base, power in unit.dimensionality.items())))


@functools.cache
def _registry() -> Any:
    pint = importlib.import_module("pint")  # 0.3 s, spent only where texts are read or written
    registry = pint.UnitRegistry(None, non_int_type=Fraction)
    registry.load_definitions(_DEFINITIONS.splitlines())
    return registry
