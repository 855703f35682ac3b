"""Units of recorded channels: spellings of other programs, unusable units, and conversion of records to SI."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from flexstage.base.units import quantity as quantities
from flexstage.base.units.dimension import dimension_of
from flexstage.base.units.quantity import Quantity
from flexstage.experiment.records.record import Record, changed_samples

_ABSENT = {"none", "n/a", "-", "unknown", "unitless", "[]", "()"}
_SPELLINGS = (
    *("V volt volts", "N newton newtons", "um micron microns", "s sec secs second seconds", "Hz hertz", "m meters metres", "A amp amps"),
    *("g0 g gn gs", "deg degrees", "rad radians", "% percent", "Pa pascals"),
)
_WORDS = {word: symbols.split()[0] for symbols in _SPELLINGS for word in symbols.split()[1:]}
_WORD = re.compile(r"g0\b|[^\W\d_]+")
_POWER = re.compile(r"(?<=[^\W\d_])(?=[23](?!\d))")
_FURTHER = ("m/s", "rad/s", "rad/s^2", "A", "C", "W", "J", "N/s", "V/s")


def plain_unit(text: str) -> str:
    """Convert a unit to the spelling of flexstage: symbols for words, `m/s^2` for `m/s2`, no brackets, `g0` (standard gravity) for `g`.

    >>> [plain_unit(text) for text in ("Volts", "m/s2", "[um]", "NONE", "g", "g0", "m/sec^2")]
    ['V', 'm/s^2', 'um', '', 'g0', 'g0', 'm/s^2']
    """
    text = text.strip()
    if len(text) > 1 and text[0] + text[-1] in ("[]", "()") and not any(sign in text[1:-1] for sign in "[]()"):
        text = text[1:-1].strip()
    if text.lower() in _ABSENT:
        return ""
    spelt = _WORD.sub(lambda word: _WORDS.get(word[0] if len(word[0]) == 1 else word[0].lower(), word[0]), text)
    return _POWER.sub("^", spelt)


def unit_problem(unit: str) -> str | None:
    """Describe why a unit is unusable; None if it is usable.

    >>> unit_problem("um"), unit_problem(""), unit_problem("furlong")
    (None, 'no unit is specified', '"furlong" is not a known unit')
    """
    if not unit:
        return "no unit is specified"
    try:
        dimension_of(unit)
    except ValueError as error:
        return str(error)
    return None


def same_dimension(unit: str, other: str) -> bool:
    """Check whether two known units have the same dimension.

    >>> same_dimension("um", "m"), same_dimension("um", "V")
    (True, False)
    """
    return dimension_of(unit).powers == dimension_of(other).powers


def derivative_order(unit: str) -> int:
    """Return the order of the derivative of a motion with this unit: 1 for velocities, 2 for accelerations, 0 for other or unknown units.

    >>> derivative_order("mm/s"), derivative_order("deg/s^2"), derivative_order("N")
    (1, 2, 0)
    """
    if unit_problem(unit) is not None:
        return 0
    return next((order for order in (1, 2) for motion in ("m", "rad") if same_dimension(unit, f"{motion}/s^{order}")), 0)


def in_si(record: Record) -> Record:
    """Convert a record to SI; samples are scaled when they are read. Channels with a missing or unknown unit are unchanged.

    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> metres = in_si(in_memory([Channel("S1", "um"), Channel("u1")], 1.0, np.array([[2.0, 3.0]])))
    >>> [channel.unit for channel in metres.channels], metres.values.tolist()
    (['m', ''], [[2e-06, 3.0]])
    """
    both = [_si(channel.unit) for channel in record.channels]
    channels = tuple(replace(channel, unit=unit) for channel, (unit, _) in zip(record.channels, both, strict=True))
    factors = np.array([factor for _, factor in both])
    return replace(record, channels=channels, samples=changed_samples(record.samples, lambda block: block * factors))


def _si(unit: str) -> tuple[str, float]:
    """Coherent SI unit, and the factor to it."""
    if unit_problem(unit) is not None:
        return unit, 1.0
    known = [each.si for each in vars(quantities).values() if isinstance(each, Quantity) and each.si != "mixed"]
    found = next((each for each in (*known, *_FURTHER) if same_dimension(each, unit)), unit)
    factor = float(dimension_of(unit).size / dimension_of(found).size)
    return (unit, 1.0) if factor == 1.0 else (found, factor)
