"""Size and dimension of units.

Unit names and prefixes are defined in two tables. The angle is a separate dimension. A unit is a product or quotient of names with small
powers, read from left to right: `N m/rad`, `nm/Hz^0.5`, `um/m/K`, `1/K`, `m/(N m)`. Sizes are exact fractions.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

_DEFINITIONS = """
meter metre m = [length]
gram g = [mass]
second s = [time]
kelvin K = [temperature]
radian rad = [angle]
byte B = [memory]
ampere A = [current]
pi = 3.1415926535897932384626433832795028841971693993751
degree deg ° = 3.1415926535897932384626433832795028841971693993751/180 rad
arcminute arcmin = 1/60 deg
arcsecond arcsec = 1/3600 deg
newton N = 1 kg m/s^2
pascal Pa = 1 N/m^2
joule J = 1 N m
watt W = 1 J/s
hertz Hz = 1 1/s
coulomb C = 1 A s
volt V = 1 W/A
farad F = 1 C/V
henry H = 1 V s/A
tesla T = 1 V s/m^2
ohm = 1 V/A
bar = 1e5 Pa
minute min = 60 s
hour h = 3600 s
tonne t = 1000 kg
inch in = 25.4 mm
pound lb = 0.45359237 kg
pound_force lbf = 4.4482216152605 N
psi = 1 lbf/in^2
standard_gravity g0 = 9.80665 m/s^2
percent % = 0.01
ppm = 1e-6
"""
_PREFIXES = """
pico p = 1e-12
nano n = 1e-9
micro u µ μ = 1e-6
milli m = 1e-3
centi c = 1e-2
kilo k = 1e3
mega M = 1e6
giga G = 1e9
mebi Mi = 1048576
gibi Gi = 1073741824
"""
_OFFSET_SCALE = re.compile(r"deg(?:ree)?_?[CF]|celsius|fahrenheit", re.IGNORECASE)
_SPELLINGS = (("**", "^"), ("·", " "), ("²", "^2"), ("³", "^3"), ("°C", "degC"), ("°F", "degF"))
_TOKEN = re.compile(r"\s*(?:(?P<name>g0|[A-Za-zµμ°%_]+)(?:\^(?P<power>-?[0-9](?:\.[0-9])?))?|(?P<sign>[*/()1]))\s*")
_LONGEST = 60


@dataclass(frozen=True)
class Dimension:
    """Size of a unit in coherent SI units, and the powers of its base dimensions, sorted by name."""

    size: Fraction
    powers: tuple[tuple[str, Fraction], ...] = ()

    def times(self, other: Dimension, power: Fraction) -> Dimension:
        """Return the product of this unit and a `power` of another unit.

        >>> Dimension(Fraction(2)).times(Dimension(Fraction(4)), Fraction(-1)).size
        Fraction(1, 2)
        """
        powers = dict(self.powers)
        for name, exponent in other.powers:
            powers[name] = powers.get(name, Fraction(0)) + exponent * power
        return Dimension(self.size * Fraction(other.size**power), tuple(sorted((name, value) for name, value in powers.items() if value)))


@functools.lru_cache(maxsize=512)
def dimension_of(unit: str) -> Dimension:
    """Return the size and dimension of a unit; raises `ValueError` with a message for an invalid unit.

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
            factor = _ONE if sign else _dimension_of_name(token["name"])
            product, power, complete = product.times(factor, power * Fraction(token["power"] or 1)), Fraction(1), True
    if stack or not complete:
        raise ValueError("the unit cannot be read")
    return product


_ONE = Dimension(Fraction(1))


def common_spelling(text: str) -> str:
    """Return the text with standard signs for products, powers and degrees.

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


def _definitions(text: str) -> dict[str, str]:
    lines = (line.partition(" = ") for line in text.split("\n") if line)
    return {name: meaning for names, _, meaning in lines for name in names.split()}


_SINGULAR, _FACTORS = _definitions(_DEFINITIONS), _definitions(_PREFIXES)
_UNITS = _SINGULAR | {f"{name}s": meaning for name, meaning in _SINGULAR.items() if len(name) > 2 and name.islower()}


@functools.cache
def _dimension_of_name(name: str) -> Dimension:
    """Dimension of a name with an optional prefix."""
    meaning = _UNITS.get(name, "")
    if meaning.startswith("["):
        return Dimension(Fraction(1), ((meaning, Fraction(1)),))
    if meaning:
        number, _, unit = meaning.partition(" ")
        above, _, below = number.partition("/")
        return Dimension(Fraction(above) / Fraction(below or 1)).times(dimension_of(unit or "1"), Fraction(1))
    for prefix, factor in _FACTORS.items():
        unit = name.removeprefix(prefix)
        if unit != name and unit[:1].isalpha() and unit in _UNITS:
            return Dimension(Fraction(factor)).times(_dimension_of_name(unit), Fraction(1))
    raise ValueError(f'"{name}" is not a known unit')
