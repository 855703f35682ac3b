"""Results do not depend on the units of measurement: a stage in other units has the same results in those units."""

from __future__ import annotations

import typing
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array, Table
from flexstage.base.units.dimension import dimension_of
from flexstage.base.units.quantity import Quantity
from flexstage.cases.registry import CASES
from flexstage.mechanism.addresses.address import addresses, get, quantity_of, set_value
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.models.nonlinear.equilibrium import State
from tests.conftest import FULL

UNITS = {"[length]": 1.6, "[mass]": 0.7, "[time]": 1.25, "[current]": 1.1, "[angle]": 1.0, "[temperature]": 1.0}
"""How many of the new units one of SI is. Temperatures stay in kelvin: the error budget is that of 1 K by default."""
SI = dict.fromkeys(UNITS, 1.0)
VARIANTS = ("double-triangle-a", "double-triangle-refitted", "xy-stage-floating", "tip-tilt-four")

OTHERS = (Mechanism, LinearModel, State)
"""What is no result."""


def size(unit: str, units: dict[str, float]) -> float:
    """How many of the new units a unit of SI is."""
    return float(np.prod([units[name] ** float(power) for name, power in dimension_of(unit).powers], initial=1.0))


def in_other_units(stage: Mechanism, units: dict[str, float]) -> Mechanism:
    """The stage, each of its numbers in the new units."""
    result = replace(stage, formulas=Table({}), requirements=Table({}), paths=Table({}), tags=Table({}), numbers=Table({}))
    for address in addresses(result):
        value, factor = get(result, address), size(quantity_of(result, address).si, units)
        if value is not None and factor != 1.0:
            result = set_value(result, address, value * factor)
    factor = size("m/s^2", units)
    return replace(result, gravity=tuple(factor * part for part in stage.gravity))


def numbers(result: Any, where: str = "", quantity: Quantity | None = None) -> Iterator[tuple[str, Array, Array | str]]:
    """All numbers of a result with their units, by their place."""
    if isinstance(result, Matrix):
        yield where, result.values, result.unit if isinstance(result.unit, str) else np.array(result.unit).reshape(result.values.shape[-2:])
    elif is_dataclass(result):
        yield from () if isinstance(result, OTHERS) else fields_of(result, where)
    elif isinstance(result, (dict, Table, tuple)):
        items = enumerate(result) if isinstance(result, tuple) else result.items()
        for name, value in items:
            yield from numbers(value, f"{where}[{name}]", quantity)
    elif isinstance(result, (float, np.ndarray)) and quantity is not None:
        yield where, np.asarray(result), quantity.si


def fields_of(result: Any, where: str) -> Iterator[tuple[str, Array, Array | str]]:
    """The numbers of a result's fields, in the unit of their annotation, or of a field beside them that states it."""
    hints = typing.get_type_hints(type(result), include_extras=True)
    for each in fields(result):
        marks, value = getattr(hints[each.name], "__metadata__", ()), getattr(result, each.name)
        unit = getattr(result, f"{each.name}_unit", None)
        if isinstance(unit, str):
            yield f"{where}.{each.name}", np.asarray(value), unit
        else:
            yield from numbers(value, f"{where}.{each.name}", next((mark for mark in marks if isinstance(mark, Quantity)), None))


def require_same(one: Any, other: Any, units: dict[str, float]) -> int:
    """Compare the numbers of two results, of which the second is in the new units, each array by its largest one; how many there are."""
    found, expected = {name: values for name, values, _ in numbers(other)}, list(numbers(one))
    assert list(found) == [name for name, _, _ in expected]
    for name, values, unit in expected:
        factor = size(unit, units) if isinstance(unit, str) else np.vectorize(lambda each: size(each, units), otypes=[float])(unit)
        scaled, others = np.asarray(values * factor), found[name]
        assert scaled.shape == others.shape, name
        np.testing.assert_array_equal(np.isfinite(scaled), np.isfinite(others), err_msg=name)
        known = np.isfinite(scaled)
        largest = np.max(np.abs(scaled[known]), initial=0.0)
        assert np.all(np.abs(scaled[known] - others[known]) <= 1e-6 * largest + ROUNDING), (name, scaled, others)
    return len(expected)


ROUNDING = 1e-12
"""Numbers in SI that are rounding in every result: lengths, angles and what is small beside them."""


@pytest.mark.parametrize("name", [name for name in CASES if FULL or name not in VARIANTS])
def test_an_analysis_is_the_same_in_other_units(name: str) -> None:
    stage = fs.case(name)
    one, other = (fs.analyse(in_other_units(stage, units)) for units in (SI, UNITS))
    assert require_same(one, other, UNITS) > 20


@pytest.mark.parametrize("name", ["double-triangle", "z-stage", "bridge"])
def test_drift_is_the_same_in_other_units_of_temperature(name: str) -> None:
    units = {**UNITS, "[temperature]": 1.2}
    stages = [in_other_units(fs.case(name), each) for each in (SI, units)]
    one, other = (fs.drift(stage, fs.lumped(stage)) for stage in stages)
    assert require_same(one, other, units) > 2


def hanging() -> Mechanism:
    """A platform on a wire, pulled by a spring with a length, beside a magnet."""
    parts = {
        "wire": fs.Rod("steel", length=0.04, diameter=0.5e-3),
        "coil": fs.Spring(stiffness=500.0, length=0.06, preload=5.0),
        "magnet": fs.Spring(diagonal=(-10.0, -10.0, 20.0, 0.0, 0.0, 0.0), mass=0.02, length=0.01),
    }
    at = {"wire": (0.0, 0.0, 0.02), "coil": (0.01, 0.0, -0.01), "magnet": (0.0, 0.02, 0.0)}
    links = {name: fs.Link(("ground", "platform"), name, place, (0.0, 0.0, -1.0), bends=(1.0, 0.0, 0.0)) for name, place in at.items()}
    body = fs.Body(mass=0.4, centre=(0.002, 0.0, -0.01), inertia=fs.Inertia(1e-4, 2e-4, 2e-4), reference=(0.0, 0.0, 0.0))
    steel = fs.Material(young=200e9, poisson=0.3, density=7800.0, yield_stress=1.5e9, loss_factor=0.002)
    return Mechanism("hanging", {"steel": steel}, parts, {"platform": body}, links, damping=fs.ModalDamping(0.01))


def test_a_loaded_stage_is_the_same_in_other_units() -> None:
    """Weight and the force in a spring change its frequencies by more than 1 %; so at large displacements."""
    one, other = (in_other_units(hanging(), units) for units in (SI, UNITS))
    before, after = fs.analyse(one), fs.analyse(other)
    assert before.loaded is not None
    assert abs(before.loaded.change) > 0.01
    assert require_same(before, after, UNITS) > 10
    here, there = (fs.operating_point(stage, {"platform.x": 1e-3 * metre}) for stage, metre in ((one, 1.0), (other, UNITS["[length]"])))
    assert require_same(here, there, UNITS) > 2
    require_same(fs.modes(here.linear), fs.modes(there.linear), UNITS)
