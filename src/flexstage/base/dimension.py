"""Size and dimension of a unit's text.

The angle is a dimension of its own. A unit is a product or quotient of names with small powers, read from left to right: `N m/rad`,
`nm/Hz^0.5`, `um/m/K`, `1/K`, `m/(N m)`. Sizes are exact fractions.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

_UNITS = """
meter metre m = 1 [length]
gram g = 1 [mass]
second s = 1 [time]
kelvin K = 1 [temperature]
radian rad = 1 [angle]
byte B = 1 [memory]
ampere A = 1 [current]
dimensionless = 1 1
pi = 3.1415926535897932384626433832795028841971693993751 1
degree deg ° = 1/180 pi rad
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
percent % = 0.01 1
ppm = 1e-6 1
"""
"""Names of each unit, its size in other units, and those."""
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
    found, power, complete = _ONE, Fraction(1), False
    for token in _tokens(unit):
        sign = token["sign"]
        if sign in ("*", "/") and complete:
            power, complete = Fraction(-1 if sign == "/" else 1), False
        elif sign == "(":
            stack.append((found, power))
            found, power, complete = _ONE, Fraction(1), False
        elif sign in ("*", "/") or (sign == ")" and not (stack and complete)):
            raise ValueError("the unit cannot be read")
        elif sign == ")":
            outer, outer_power = stack.pop()
            found, power = outer.times(found, outer_power), Fraction(1)
        else:
            factor = _ONE if sign else _named(token["name"])
            found, power, complete = found.times(factor, power * Fraction(token["power"] or 1)), Fraction(1), True
    if stack or not complete:
        raise ValueError("the unit cannot be read")
    return found


_ONE = Dimension(Fraction(1))


def _tokens(unit: str) -> Iterator[re.Match[str]]:
    plain = unit[: _LONGEST + 1]
    for spelling, meaning in _SPELLINGS:
        plain = plain.replace(spelling, meaning)
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


@functools.cache
def _named(name: str) -> Dimension:
    """The unit of a name as it stands or in the plural, with a prefix or without."""
    for plural, (prefix, factor) in product(("", "s"), _prefixes().items()):
        stem = name.removesuffix(plural).removeprefix(prefix)
        meaning = _units().get(stem)
        if meaning is None or prefix + stem + plural != name or (plural and len(stem) == 1):  # a symbol has no plural: "kgs"
            continue
        size, _, unit = meaning.partition(" ")
        known = Dimension(Fraction(1), ((unit, Fraction(1)),)) if unit.startswith("[") else dimension_of(unit)
        return Dimension(factor * Fraction(size) * known.size, known.powers)
    raise ValueError(f'"{name}" is not a known unit')


@functools.cache
def _units() -> dict[str, str]:
    return dict(_rows(_UNITS))


@functools.cache
def _prefixes() -> dict[str, Fraction]:
    return {"": Fraction(1)} | {name: Fraction(size) for name, size in _rows(_PREFIXES)}


def _rows(table: str) -> Iterator[tuple[str, str]]:
    for line in table.strip().splitlines():
        names, _, meaning = line.partition(" = ")
        yield from ((name, meaning) for name in names.split())
