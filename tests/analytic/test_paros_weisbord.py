"""Right-circular notches: Paros & Weisbord 1965, Wu & Zhou 2002, Schotborgh 2005, and plane finite elements (reference B1)."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.spatial.frame import transport
from tests.analytic import closed_forms
from tests.analytic.hinges import PERCENT_DIGIT, STEEL, UNIT, circular, diagonal, error

# t/R | C_rz: elements, error of Paros-Weisbord full, simplified, of Schotborgh | C_x: elements, error | C_y: elements, error
TABLE = (
    (0.05, 25629.0, -1.95, -1.33, -2.64, 13.042, -10.04, 448.34, -4.67),
    (0.10, 4588.15, -3.80, -2.56, -2.44, 8.8695, -13.00, 165.52, -7.18),
    (0.20, 829.427, -7.17, -4.72, -1.58, 5.8944, -16.21, 62.154, -9.40),
    (0.40, 151.707, -12.64, -7.91, 0.32, 3.7742, -19.11, 23.599, -9.02),
    (0.50, 87.921, -14.86, -9.04, 1.43, 3.2332, -19.81, 17.293, -7.78),
    (0.80, 27.761, -19.92, -11.04, 5.63, 2.2798, -20.59, 9.0043, -2.72),
)
RATIOS = np.geomspace(1e-3, 10.0, 41)
WORKED = (200e3, 10.0, 1.0, 5.0)


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"t/R={row[0]}")
def test_errors_against_finite_elements_are_those_of_the_table(row):
    """The quadrature shows the error of beam theory itself, column by column; Schotborgh's, printed to 0.01, is a stiffness."""
    ratio, rz, full, simplified, schotborgh, x, x_error, y, y_error = row
    size = (1.0, 1.0, ratio, 1.0)
    found = diagonal(circular(ratio), UNIT)
    assert error(found[5], rz) == pytest.approx(full, abs=PERCENT_DIGIT)
    assert error(found[0], x) == pytest.approx(x_error, abs=PERCENT_DIGIT)
    assert error(found[1], y) == pytest.approx(y_error, abs=PERCENT_DIGIT)
    assert error(closed_forms.paros_weisbord_rotation_simplified(*size), rz) == pytest.approx(simplified, abs=PERCENT_DIGIT)
    assert error(1.0 / closed_forms.schotborgh_rotation_stiffness(*size), rz) == pytest.approx(schotborgh, abs=PERCENT_DIGIT)


def test_quadrature_equals_the_closed_forms_from_thin_to_thick():
    """Over four decades of t/R at once; 2e-13 relative. The closed form of C_y loses digits of its own to cancellation."""
    found = diagonal(circular(RATIOS), UNIT)
    size = (1.0, 1.0, RATIOS, 1.0)
    shear = closed_forms.wu_zhou_shear(UNIT.shear, 1.0, RATIOS, 1.0)
    bending = closed_forms.wu_zhou_end_deflection(*size) - closed_forms.wu_zhou_rotation(*size)
    cancellation = 1e-15 * closed_forms.wu_zhou_end_deflection(*size) / (bending + shear)
    np.testing.assert_allclose(found[:, 0], closed_forms.wu_zhou_axial(*size), rtol=2e-13)
    assert np.all(np.abs(found[:, 1] / (bending + shear) - 1.0) < 2e-13 + 30.0 * cancellation)
    np.testing.assert_allclose(found[:, 2], closed_forms.deflection_across(*size) + shear, rtol=2e-13)
    np.testing.assert_allclose(found[:, 4], closed_forms.wu_zhou_rotation_across(*size), rtol=2e-13)
    np.testing.assert_allclose(found[:, 5], closed_forms.wu_zhou_rotation(*size), rtol=2e-13)
    np.testing.assert_allclose(found[:, 5], closed_forms.paros_weisbord_rotation(*size), rtol=2e-13)


def test_quadrature_at_the_thinnest_necks():
    """2e-12 at t/R = 1e-4, far below what can be made."""
    thin = diagonal(circular(1e-4), UNIT)
    assert thin[5] == pytest.approx(closed_forms.paros_weisbord_rotation(1.0, 1.0, 1e-4, 1.0), rel=2e-12)


def test_worked_example():
    """R = 5, t = 1, b = 10 mm, to the digits printed."""
    found = diagonal(circular(0.2, radius=5.0, width=10.0))
    assert found[5] == pytest.approx(1.539997e-5, rel=5e-7)
    assert found[0] == pytest.approx(2.46941e-6, rel=3e-6)
    assert found[1] == pytest.approx(2.81554e-5, rel=3e-6)
    assert found[4] == pytest.approx(2.96329e-7, rel=3e-6)
    assert found[2] == pytest.approx(8.97693e-6, rel=3e-6)


def test_worked_example_by_the_named_forms():
    assert closed_forms.paros_weisbord_rotation_simplified(*WORKED) == pytest.approx(1.580583e-5, rel=5e-7)
    stiffnesses = (
        1.0 / closed_forms.paros_weisbord_rotation(*WORKED),
        1.0 / closed_forms.paros_weisbord_rotation_simplified(*WORKED),
        closed_forms.schotborgh_rotation_stiffness(*WORKED),
    )
    assert [round(value) for value in stiffnesses] == [64935, 63268, 61251]
    bending = closed_forms.wu_zhou_end_deflection(*WORKED) - 25.0 * closed_forms.wu_zhou_rotation(*WORKED)
    assert bending == pytest.approx(2.04508e-5, rel=3e-6)
    assert closed_forms.wu_zhou_shear(200e3 / 2.6, *WORKED[1:]) == pytest.approx(7.70456e-6, rel=1e-6)


def test_simplified_forms_are_the_thin_limit():
    thin = (1.0, 1.0, 1e-6, 1.0)
    full = closed_forms.wu_zhou_rotation(*thin)
    assert closed_forms.paros_weisbord_rotation_simplified(*thin) == pytest.approx(full, rel=1e-5)
    assert closed_forms.paros_weisbord_axial_simplified(*thin) == pytest.approx(closed_forms.wu_zhou_axial(*thin), rel=1e-5)


def test_end_deflection_is_the_centre_compliance_transported():
    """B5: C about the end = X C X^T, with (y, rz) coupling R C_rz; the end's deflection is the closed form for the END."""
    hinge = circular(0.2, radius=5.0, width=10.0)
    carry = transport(np.array([5.0, 0.0, 0.0]))
    end = carry @ np.diag(diagonal(hinge)) @ carry.T
    bending = closed_forms.wu_zhou_end_deflection(*WORKED)
    assert end[1, 1] == pytest.approx(bending + closed_forms.wu_zhou_shear(STEEL.shear, *WORKED[1:]), rel=1e-12)
    assert error(end[1, 1], 4.4579e-4) == pytest.approx(-7.3, abs=0.1)  # elements; C_y and C_rz errors of the table, weighted
    assert end[1, 5] == pytest.approx(5.0 * end[5, 5], rel=1e-12)
    assert end[2, 4] == pytest.approx(-5.0 * end[4, 4], rel=1e-12)
