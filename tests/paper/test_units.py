"""Each unit alone: the numbers the paper gives for single units."""

from __future__ import annotations

import pytest

from flexstage.analysis.linear_statics.units import units
from flexstage.cases.double_triangle import SM_REF_A, SM_REF_B, double_triangle

BOTH = pytest.mark.parametrize("parameters", [SM_REF_A, SM_REF_B])


@BOTH
def test_horizontal_unit(parameters: str) -> None:
    unit = units(double_triangle(parameters))["horizontal"]
    assert unit.axial == pytest.approx(10.300e6, rel=5e-5)
    assert unit.lateral[1] == pytest.approx(0.00120e6, abs=5.0)
    assert unit.series == pytest.approx(unit.axial, rel=1e-12)
    assert unit.gain == pytest.approx(1.0, abs=1e-12)


@BOTH
def test_vertical_unit(parameters: str) -> None:
    unit = units(double_triangle(parameters))["vertical"]
    assert unit.ideal_gain == pytest.approx(3.0, rel=1e-12)
    assert unit.lever is not None
    assert unit.lever.gain == pytest.approx(3.0 * 0.975, abs=5e-4)
    assert unit.gain == pytest.approx(unit.ideal_gain * (1.0 - unit.loss), rel=1e-12)
    assert unit.axial == pytest.approx(1.0 / unit.load_compliance, rel=1e-9)


def test_a_softer_plane_of_the_rectangular_neck() -> None:
    """SM-REF-B's neck is thin vertically: 0.00056 N/um out of plane (reference value)."""
    unit = units(double_triangle(SM_REF_B))["horizontal"]
    assert unit.lateral[0] == pytest.approx(0.00056e6, abs=5.0)
