"""Two-axis toroidal necks: Smith's closed form and axisymmetric finite elements (reference B4)."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.parts.neck import Neck
from flexstage.parts.profile import Circular, Straight
from tests.analytic import closed_forms
from tests.analytic.hinges import PERCENT_DIGIT, UNIT, diagonal, error

# t/R | C_rz: elements, error of beam theory, of Smith | C_x: elements, error of beam theory
TABLE = (
    (0.05, 718836.0, -0.83, -0.46, 180.926, -2.84),
    (0.10, 63852.8, -1.70, -0.95, 64.424, -5.09),
    (0.20, 5699.49, -3.42, -1.92, 22.939, -8.58),
    (0.50, 237.09, -8.29, -4.56, 5.7499, -14.76),
)


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"t/R={row[0]}")
def test_errors_against_finite_elements_are_those_of_the_table(row):
    ratio, rz, rz_error, smith, x, x_error = row
    found = diagonal(Neck("m", thickness=ratio, profile=Circular(1.0)), UNIT)
    assert error(found[5], rz) == pytest.approx(rz_error, abs=PERCENT_DIGIT)
    assert error(found[0], x) == pytest.approx(x_error, abs=PERCENT_DIGIT)
    assert error(1.0 / closed_forms.smith_toroid_rotation_stiffness(1.0, ratio, 1.0), rz) == pytest.approx(smith, abs=PERCENT_DIGIT)


def test_worked_example():
    """R = 5, t = 1 mm, to the digits printed."""
    found = diagonal(Neck("m", thickness=1.0, profile=Circular(5.0)))
    expected = (2.09716e-5, 2.59576e-4, 2.59576e-4, 2.86239e-4, 2.20183e-4, 2.20183e-4)
    np.testing.assert_allclose(found, expected, rtol=3e-6)


def test_smith_is_the_thin_limit():
    thin = diagonal(Neck("m", thickness=1e-5, profile=Circular(1.0)), UNIT)
    assert thin[5] * closed_forms.smith_toroid_rotation_stiffness(1.0, 1e-5, 1.0) == pytest.approx(1.0, rel=4e-3)


def test_round_neck_is_the_same_about_every_axis_across():
    found = diagonal(Neck("m", thickness=0.3, profile=Circular(1.0)), UNIT)
    assert found[1] == found[2]
    assert found[4] == found[5]


def test_neck_of_the_shipped_stage():
    """SM-REF-B's straight rectangular neck: 52.268 N/um (reference A6)."""
    found = diagonal(Neck("m", thickness=1.54, width=2.246, profile=Straight(13.235)))
    assert 1e-3 / found[0] == pytest.approx(52.268, abs=5e-4)
