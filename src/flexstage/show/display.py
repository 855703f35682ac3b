"""Units and format of numbers in tables and reports. JSON documents keep SI units.

The preferred display unit is replaced only if the numbers would be unreadable (the largest number below 0.1, or 100 000 and more).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache

from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import convert

DIGITS = 5
NO_VALUE = "-"

_TOO_SMALL, _TOO_LARGE = 0.1, 1e5


@dataclass(frozen=True)
class DisplayUnit:
    """A display unit: its text and the factor from SI values to shown numbers."""

    unit: str
    factor: float

    @property
    def text(self) -> str:
        """The unit, or an empty string for pure numbers."""
        return "" if self.unit == "1" else self.unit

    def format(self, value: float, digits: int = DIGITS) -> str:
        """Format an SI value with this unit.

        >>> DisplayUnit("um", 1e6).format(2e-6)
        '2 um'
        """
        return f"{number(value * self.factor, digits)} {self.text}".rstrip()


# Display units of each SI unit, the preferred one first.
UNITS: dict[str, str] = {
    "m": "um, pm, nm, mm, m",
    "rad": "urad, nrad, mrad, rad",
    "N": "N, mN, kN, MN",
    "N m": "N m, mN m, kN m",
    "Pa": "MPa, kPa, GPa",
    "Hz": "Hz, kHz",
    "J": "mJ, uJ, J",
    "kg": "kg, g",
    "N/m": "N/um, N/m, N/mm, N/nm",
    "N/rad": "N/mrad, N/rad, N/urad",
    "N m/m": "N m/mm, N m/m, N m/um",
    "N m/rad": "N m/mrad, N m/rad, N m/urad",
    "m/N": "um/N, nm/N, mm/N",
    "rad/N": "urad/N, nrad/N, mrad/N",
    "m/(N m)": "um/(N m), nm/(N m), mm/(N m)",
    "rad/(N m)": "urad/(N m), nrad/(N m), mrad/(N m)",
    "m/rad": "mm/rad",
    "rad/m": "urad/um",
    "m/K": "nm/K, um/K, mm/K",
    "rad/K": "nrad/K, urad/K, mrad/K",
    "m/V": "um/V, nm/V, mm/V",
    "V/m": "V/um",
    "J/m^2": "uJ/um^2",
    "N/Hz^0.5": "N/Hz^0.5",
    "m/Hz^0.5": "nm/Hz^0.5",
    "rad/Hz^0.5": "nrad/Hz^0.5",
    "%": "%",
}
_FACTORS = {"%": 1e2, "g": 1e3}
_PREFIXES = {"p": 12, "n": 9, "u": 6, "m": 3, "": 0, "k": -3, "M": -6, "G": -9}


@lru_cache(maxsize=64)
def ladder(unit: str) -> dict[str, float]:
    """Return the display units of an SI unit with their factors, the smallest unit first.

    >>> ladder("Hz")
    {'Hz': 1.0, 'kHz': 0.001}
    """
    names = filter(None, UNITS.get(unit, "").split(", "))
    return dict(sorted(((name, _FACTORS.get(name) or _factor(name, unit)) for name in names), key=lambda each: -each[1]))


def _factor(name: str, unit: str) -> float:
    """Display units per SI unit, by the prefixes above and below the line."""
    (top, _, bottom), (whole, _, share) = name.partition("/"), unit.partition("/")
    below = _PREFIXES[bottom.removesuffix(share)] * (2 if share.endswith("^2") else 1)
    return 10.0 ** (_PREFIXES[top.removesuffix(whole)] - below)


def display_unit_of(unit: str, largest: float = 1.0, *shown: str) -> DisplayUnit:
    """Return the display unit of an SI unit for values up to `largest`: the first unit in `shown` that fits, otherwise a readable unit.

    >>> display_unit_of("N/m", 15e6).unit, display_unit_of("m", 5e-9).unit, display_unit_of("rad/m").unit
    ('N/um', 'nm', 'urad/um')
    """
    factors = ladder(unit)
    if not factors:
        return DisplayUnit(unit, 1.0)
    preferred = next(name for name in (*shown, UNITS[unit].partition(", ")[0]) if name in factors)
    if preferred in shown or largest == 0.0 or not math.isfinite(largest) or _TOO_SMALL <= largest * factors[preferred] < _TOO_LARGE:
        return DisplayUnit(preferred, factors[preferred])
    fitting = [name for name, factor in factors.items() if largest * factor >= 1.0]
    chosen = (fitting or list(factors)[:1])[-1]
    return DisplayUnit(chosen, factors[chosen])


def preferred_unit(unit: str) -> DisplayUnit:
    """Return the preferred display unit of an SI unit, independent of the values.

    >>> preferred_unit("m/N")
    DisplayUnit(unit='um/N', factor=1000000.0)
    """
    return display_unit_of(unit, 0.0)


@lru_cache(maxsize=256)
def field_unit(quantity: Quantity) -> DisplayUnit:
    """Return the display unit of a field of the description, by its quantity.

    >>> from flexstage.base.units.quantity import ANGLE, LENGTH
    >>> field_unit(LENGTH), round(field_unit(ANGLE).factor, 6)
    (DisplayUnit(unit='mm', factor=1000.0), 57.29578)
    """
    return DisplayUnit(quantity.shown, float(convert(1.0, quantity)))


def display_unit(quantity: Quantity | None, unit: str = "") -> DisplayUnit:
    """Return the display unit for results of a quantity: `unit`, if specified, else the preferred unit of the quantity.

    >>> from flexstage.base.units.quantity import PIEZO_GAIN
    >>> display_unit(PIEZO_GAIN, "um/V"), display_unit(None)
    (DisplayUnit(unit='um/V', factor=1000000.0), DisplayUnit(unit='', factor=1.0))
    """
    if quantity is None or quantity.shown == "1":
        return DisplayUnit(unit, 100.0 if unit == "%" else 1.0)
    return DisplayUnit(unit, ladder(quantity.si)[unit]) if unit else field_unit(quantity)


def number(value: float, digits: int = DIGITS) -> str:
    """Format a number to `digits` significant digits, without trailing zeros. Only magnitudes below 1e-4 or above 1e6 have an exponent.

    >>> number(15.4499), number(-0.0000123456), number(2e9), number(float("nan"))
    ('15.45', '-1.2346e-5', '2e9', '-')
    """
    if not math.isfinite(value):
        return NO_VALUE if math.isnan(value) else ("inf" if value > 0 else "-inf")
    if value == 0.0:
        return "0"
    text = f"{value:.{digits}g}"
    if "e" in text or not 1e-4 <= abs(value) < 1e6:
        mantissa, _, exponent = f"{value:.{digits - 1}e}".partition("e")
        mantissa = mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa
        return f"{mantissa}e{int(exponent)}" if not 1e-4 <= abs(value) < 1e6 else f"{value:.0f}"
    return text


def align_numbers(values: Iterable[float]) -> list[str]:
    """Format the numbers of a column with equal decimals: five significant digits for the largest number.

    One more decimal is used if the smallest number needs it. In a column that spans more than four decades, all numbers have the same
    number of significant digits instead.

    >>> align_numbers([110.9101, 1690.27]), align_numbers([0.0, 0.5]), align_numbers([1.0, 2.0])
    (['110.91', '1690.27'], ['0', '0.5'], ['1', '2'])
    """
    items = [float(value) for value in values]
    sizes = [abs(value) for value in items if math.isfinite(value) and value != 0.0]
    if not sizes or max(sizes) / min(sizes) > 1e4 or not 1e-4 <= max(sizes) < 1e6:
        return [number(value) for value in items]
    significant = DIGITS + (1 if max(sizes) / min(sizes) > 10.0 else 0)
    decimals = max(0, significant - 1 - math.floor(math.log10(max(sizes))))
    decimals = min(decimals, max(len(number(value, significant).partition(".")[2]) for value in items))
    return [f"{value:.{decimals}f}" if math.isfinite(value) and value != 0.0 else number(value) for value in items]


def percent(share: float, digits: int = 4) -> str:
    """Format a ratio in per cent.

    >>> percent(0.031251), percent(1.0)
    ('3.125 %', '100 %')
    """
    return f"{number(100.0 * share, digits)} %"


def format_value(value: float, unit: str, digits: int = DIGITS) -> str:
    """Format an SI value with its display unit.

    >>> format_value(15.45e6, "N/m"), format_value(2e-9, "m"), format_value(0.5, "1")
    ('15.45 N/um', '2 nm', '0.5')
    """
    return display_unit_of(unit, abs(value) if math.isfinite(value) else 0.0).format(value, digits)


_SUPERSCRIPT = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")


def _power(found: re.Match[str]) -> str:
    return f"{found[1]}·10{str(int(found[2])).translate(_SUPERSCRIPT)}"


_SETTING: tuple[tuple[re.Pattern[str], str | Callable[[re.Match[str]], str]], ...] = (
    (re.compile(r"\+-(?= ?\d)"), "±"),
    (re.compile(r"(?<![A-Za-z0-9])u(?=(?:m|rad|J|F|s|V)\b)"), "µ"),
    (re.compile(r"(?<![\w.])(\d+\.?\d*)e(-?\d+)\b"), _power),
    (re.compile(r"(\w+)\^0\.5\b"), r"√\1"),
    (re.compile(r"\^(-?\d+)"), lambda found: found[1].translate(_SUPERSCRIPT)),
    (re.compile(r"(?<![\w.)])-(?=\d|inf)"), "−"),
)
"""Typographic replacements, in this order."""


@lru_cache(maxsize=4096)
def to_typography(text: str) -> str:
    """Typeset units and numbers of a text: micro sign, true minus, powers; for HTML and figures.

    >>> [to_typography(text) for text in ("-1.2e-05 N/um", "J/m^2", "nm/Hz^0.5", "1 +- 5 um", "digest 9bc8e8")]
    ['−1.2·10⁻⁵ N/µm', 'J/m²', 'nm/√Hz', '1 ± 5 µm', 'digest 9bc8e8']
    """
    for pattern, set_ in _SETTING:
        text = pattern.sub(set_, text)
    return text
