"""Numbers and units for people: right factors, no silent alterations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.labelled import NOISE, quiet
from flexstage.base.units.quantity import Quantity
from flexstage.show.display import UNITS, align_numbers, display_unit_of, field_unit, format_value, ladder, number, to_typography

FINITE = st.floats(min_value=-1e12, max_value=1e12, allow_nan=False).filter(lambda value: value == 0.0 or abs(value) > 1e-12)


@pytest.mark.parametrize("si", [unit for unit in UNITS if unit != "%"])  # a ratio is shown in per cent where its result says so
def test_fields_are_shown_in_any_unit_and_display_units_have_their_size(si: str) -> None:
    for unit, factor in ladder(si).items():
        form = field_unit(Quantity("tried", si, unit, ""))
        assert form.unit == unit
        assert math.isclose(form.factor, factor, rel_tol=1e-12), unit


@pytest.mark.parametrize("si", UNITS)
def test_ladders_ascend(si: str) -> None:
    factors = list(ladder(si).values())
    assert factors == sorted(factors, reverse=True)


@given(FINITE, st.integers(3, 8))
def test_a_number_keeps_its_digits(value: float, digits: int) -> None:
    back = float(number(value, digits))
    assert math.isclose(back, value, rel_tol=0.51 * 10 ** (1 - digits)) or back == value == 0.0


@given(st.lists(FINITE, min_size=1, max_size=6))
def test_a_column_keeps_its_digits(values: list[float]) -> None:
    texts = align_numbers(values)
    largest = max(abs(value) for value in values)
    for text, value in zip(texts, values, strict=True):
        assert abs(float(text) - value) <= 0.51e-4 * max(abs(value), 0.1 * largest)


@given(st.floats(min_value=1e-9, max_value=1e9), st.sampled_from(sorted(UNITS)))
def test_a_value_is_shown_readably(value: float, si: str) -> None:
    text = format_value(value, si)
    figure = float(text.split()[0])
    form = display_unit_of(si, value)
    assert math.isclose(figure, value * form.factor, rel_tol=1e-4)
    smallest = next(iter(ladder(si).values()))
    if value * smallest >= 1.0:
        assert figure >= 0.1
    if len(ladder(si)) > 2 and value < 1e3:
        assert figure <= 1e9


def test_noise_is_shown_as_zero_and_data_stay() -> None:
    data = np.array([[1.0, 1e-14], [-3e-13, 1e-6]])
    before = data.copy()
    kept = quiet(data)
    assert np.array_equal(data, before)
    assert kept[0, 1] == 0.0
    assert kept[1, 0] == 0.0
    assert kept[0, 0] == 1.0
    assert kept[1, 1] == 1e-6


@given(st.floats(min_value=1e-3, max_value=1e3), st.floats(min_value=1e-3, max_value=1e3))
def test_what_is_not_noise_is_never_altered(first: float, second: float) -> None:
    data = np.diag([first, second]) + (100.0 * NOISE) * np.sqrt(first) * np.sqrt(second) * (1.0 - np.eye(2))
    assert np.array_equal(quiet(data), data)


def test_not_a_number_is_a_dash() -> None:
    assert number(float("nan")) == "-"
    assert np.isnan(quiet(np.array([[np.nan, 1.0]]))[0, 0])


def test_typesetting_leaves_names_alone() -> None:
    assert to_typography("units.horizontal um5 put-on B1-B3") == "units.horizontal um5 put-on B1-B3"
    assert to_typography("x +-50 um at -3e-5 urad/N") == "x ±50 µm at −3·10⁻⁵ µrad/N"
