"""Units at the border: what is written is read back bit for bit, and what does not fit is refused by name."""

from __future__ import annotations

import math
import struct

import numpy as np
import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.base.units import dimension, quantity
from flexstage.base.units.quantity import (
    ANGLE,
    COUPLING,
    EXPANSION,
    FREQUENCY,
    INERTIA,
    LENGTH,
    NOISE_DENSITY,
    RATIO,
    STIFFNESS,
    TEMPERATURE,
    Quantity,
)
from flexstage.base.units.unit import convert, parse, show

MEASURABLE = [
    value for value in vars(quantity).values() if isinstance(value, Quantity) and value is not quantity.DIRECTION and value.si != "mixed"
]


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(MEASURABLE))
def test_shown_values_parse_to_the_same_bits(value: float, kind: Quantity) -> None:
    assert struct.pack("<d", parse(show(value, kind), kind)) == struct.pack("<d", value)


@pytest.mark.parametrize("kind", MEASURABLE, ids=lambda kind: kind.name)
def test_every_example_is_the_shortest_text_of_its_value_or_another_unit(kind: Quantity) -> None:
    assert parse(show(parse(kind.example, kind), kind), kind) == parse(kind.example, kind)


@pytest.mark.parametrize(
    ("text", "kind", "expected"),
    [
        ("1.54 mm", LENGTH, 1.54e-3),
        ("1.54mm", LENGTH, 1.54e-3),
        ("3 µm", LENGTH, 3e-6),
        ("1 in", LENGTH, 0.0254),
        ("17 N/um", STIFFNESS, 17e6),
        ("0.05 nm/Hz^0.5", NOISE_DENSITY, 0.05e-9),
        ("0.13 kg m^2", INERTIA, 0.13),
        ("1300 kg cm²", INERTIA, 0.13),
        ("10.3e-6 1/K", EXPANSION, 10.3e-6),
        ("10.3 um/m/K", EXPANSION, 10.3e-6),
        ("4 urad/N", COUPLING, 4e-6),
        ("4 um/(N m)", COUPLING, 4e-6),
        ("90 deg", ANGLE, math.pi / 2),
        ("60 arcsec", ANGLE, math.pi / 10800),
        ("0.3", RATIO, 0.3),
        ("5 %", RATIO, 0.05),
    ],
)
def test_reads(text: str, kind: Quantity, expected: float) -> None:
    assert parse(text, kind) == expected


@pytest.mark.parametrize(
    ("text", "kind", "words"),
    [
        ("1.54", LENGTH, ['unit missing (got "1.54")', '"2 mm"']),
        ("5 kg", LENGTH, ["a mass", "a length"]),
        ("30", ANGLE, ["unit missing", "30 deg"]),
        ("0.3 mm", RATIO, ["a length", "a ratio"]),
        ("0.3 rad", RATIO, ["an angle", "a ratio"]),
        ("100 rad/s", FREQUENCY, ["rad/s", "a frequency"]),
        ("20 degC", TEMPERATURE, ["offset", "K"]),
        ("1e-5 1/degC", EXPANSION, ["offset", "K"]),
        ("nan mm", LENGTH, ["must be finite"]),
        ("-inf mm", LENGTH, ["must be finite"]),
        ("1e400 mm", LENGTH, ["double precision"]),
        ("1e-400 mm", LENGTH, ["double precision"]),
        ("1e999999999999 mm", LENGTH, ["must be a length"]),
        ("1,54 mm", LENGTH, ["comma", "point"]),
        ("1.54 mmm", LENGTH, ['"mmm" is not a known unit']),
        ("1 m^9^9^9^9", LENGTH, ["cannot be read"]),
        ("1 (m^9)^9", LENGTH, ["cannot be read"]),
        ("1 1e9 m", LENGTH, ["must be a length"]),
        ("1 " + "m" * 1000, LENGTH, ["cannot be read"]),
        ("", LENGTH, ["must be a length"]),
    ],
)
def test_refuses(text: str, kind: Quantity, words: list[str]) -> None:
    with pytest.raises(DesignError) as caught:
        parse(text, kind, where="parts.neck.thickness")
    message = str(caught.value)
    assert message.startswith("parts.neck.thickness: ")
    assert [word for word in words if word not in message] == []


@given(st.text(max_size=40), st.sampled_from(MEASURABLE))
def test_any_text_is_a_number_or_a_design_error(text: str, kind: Quantity) -> None:
    for candidate in (text, f"1 {text}", f"1.5 m{text}"):
        try:
            assert math.isfinite(parse(candidate, kind))
        except DesignError:
            continue


def test_arrays_convert_and_show_their_range() -> None:
    values = np.array([1e-3, 2e-3, 1.5e-3])
    np.testing.assert_array_equal(convert(values, LENGTH), values * 1000.0)
    assert show(values, LENGTH) == "1 mm to 2 mm (3 values)"


SYMBOLS = ("m", "g", "s", "K", "rad", "B", "A", "N", "Pa", "J", "W", "Hz", "C", "V", "F", "H", "T", "bar", "ohm")
OTHERS = (
    "t",
    "deg",
    "arcmin",
    "arcsec",
    "min",
    "h",
    "lb",
    "lbf",
    "psi",
    "g0",
    "in",
    "millimeter",
    "micrometres",
    "inch",
    "kilonewton",
    "MiB",
)


def test_units_are_those_of_pint() -> None:
    """An independent table of units, in which angles have no dimension."""
    registry = pint.UnitRegistry()
    for name in (*(prefix + symbol for prefix in ("", *"pnumckMG") for symbol in SYMBOLS), *OTHERS):
        ours, theirs = dimension.dimension_of(name), registry.Unit(name)
        powers = {base: float(power) for base, power in ours.powers if base not in ("[angle]", "[memory]")}
        known = {base: float(power) for base, power in theirs.dimensionality.items()}
        assert powers == known, name
        root = (1.0 * theirs).to_root_units().magnitude
        assert float(ours.size) == pytest.approx(root if "B" not in name else root / 8.0, rel=1e-14), name


@pytest.mark.parametrize("name", ["mm_", "cd", "mmm", "Ns", "Pas", "kk", "meterss", "m%"])
def test_names_that_are_no_units_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match="is not a known unit"):
        dimension.dimension_of(name)
