"""Where the paper disagrees with itself or with this project: recorded, tested, never fitted (docs/disagreements.md)."""

from __future__ import annotations

import numpy as np
import pytest

import flexstage as fs
from flexstage.base.number import Array, Number
from flexstage.cases.double_triangle import SM_REF_B, double_triangle

ANGLES = np.deg2rad([0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0])
DISPLACEMENT = np.array([41.9, 44.0, 45.2, 45.5, 45.0, 43.9, 41.7])
STIFFNESS = np.array([2.39, 2.27, 2.21, 2.20, 2.22, 2.28, 2.40])
AXIAL, LATERAL, LOAD = 10.30, 0.0012, 100.0
DIRECTIONS = np.deg2rad([0.0, 120.0, -120.0])


def equivalent_stiffness(axial: Number, lateral: Number, angles: Array) -> Array:
    """In-plane stiffness tensor (2, 2) of units pushing at `angles` [rad], each with axial and lateral stiffness (Eq. 1 of Shin & Moon).

    For three units 120 degrees apart it is 1.5 (K_a + K_l) in every direction (Eq. 2).

    >>> third = 2 * np.pi / 3
    >>> equivalent_stiffness(10.30, 0.0012, np.array([0, third, -third])).diagonal().round(6).tolist()
    [15.4518, 15.4518]
    """
    along = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    across = np.stack([-np.sin(angles), np.cos(angles)], axis=-1)
    return axial * np.einsum("ki,kj->ij", along, along) + lateral * np.einsum("ki,kj->ij", across, across)


def test_equation_2_has_no_direction() -> None:
    tensor = equivalent_stiffness(AXIAL, LATERAL, DIRECTIONS)
    assert tensor[0, 0] == pytest.approx(15.452, abs=5e-4)
    np.testing.assert_allclose(tensor, 1.5 * (AXIAL + LATERAL) * np.eye(2), atol=1e-12 * 15.452)


def test_table_1_agrees_with_itself() -> None:
    np.testing.assert_allclose(LOAD / DISPLACEMENT, STIFFNESS, atol=0.006)


@pytest.mark.xfail(strict=True, reason="Eq. 2 (15.45 N/um) and Table 1 (2.20-2.40 N/um) differ by a factor of 6.4 to 7: recorded")
def test_table_1_agrees_with_equation_2() -> None:
    np.testing.assert_allclose(STIFFNESS, 1.5 * (AXIAL + LATERAL), rtol=0.1)


def test_the_factor_between_equation_2_and_table_1() -> None:
    ratio = 1.5 * (AXIAL + LATERAL) / STIFFNESS
    assert ratio.min() == pytest.approx(6.44, abs=0.01)
    assert ratio.max() == pytest.approx(7.02, abs=0.02)


def _fit() -> tuple[np.ndarray, float]:
    columns = np.stack([np.ones_like(ANGLES), np.cos(2 * ANGLES), np.sin(2 * ANGLES)], axis=1)
    found = np.linalg.lstsq(columns, DISPLACEMENT, rcond=None)[0]
    return found, float(np.sqrt(np.mean((columns @ found - DISPLACEMENT) ** 2)))


def test_table_1_fits_a_tensor_that_a_symmetric_stage_cannot_have() -> None:
    (mean, cosine, sine), rms = _fit()
    assert (mean, cosine, sine) == pytest.approx((41.89, 0.10, 3.74), abs=0.01)
    assert rms == pytest.approx(0.13, abs=0.005)
    assert 0.5 * np.rad2deg(np.arctan2(sine, cosine)) == pytest.approx(44.0, abs=0.5)
    assert mean + np.hypot(cosine, sine) == pytest.approx(45.6, abs=0.05)
    assert mean - np.hypot(cosine, sine) == pytest.approx(38.2, abs=0.1)


@pytest.mark.xfail(strict=True, reason="Table 1 fits principal axes near 44 degrees; three units 120 degrees apart have none: recorded")
def test_table_1_is_as_isotropic_as_the_stage() -> None:
    statics = fs.statics(fs.lumped(double_triangle(SM_REF_B)))
    spread = np.ptp(statics.free.along(ANGLES)) / statics.free.principal.mean()
    assert np.ptp(STIFFNESS) / STIFFNESS.mean() <= spread + 1e-3


def test_the_stage_has_no_direction() -> None:
    statics = fs.statics(fs.lumped(double_triangle(SM_REF_B)))
    for tensor in (statics.held, statics.free):
        assert np.ptp(tensor.along(np.linspace(0.0, np.pi, 37))) < 1e-9 * tensor.principal[0]


def test_a_ten_times_softer_stack_would_explain_the_level_of_table_1() -> None:
    """One hypothesis, circumstantial: 1.7 instead of 17 N/um gives 2.396 N/um; the direction stays unexplained."""
    neck = 2.0 / (1.0 / AXIAL - 1.0 / 17.0)
    soft = 1.0 / (1.0 / 1.7 + 2.0 / neck)
    assert soft == pytest.approx(1.5962, abs=2e-4)
    assert LOAD / (1.5 * (soft + LATERAL)) == pytest.approx(41.74, abs=0.05)


def test_equation_6_needs_no_theta_in_its_denominator() -> None:
    """Eq. 4 solved for theta: the denominator is K_theta2 + r_1^2 K_1 + r_2^2 K_3, a moment per radian; times theta it would not be."""
    pivot, drive, pole, short, long = 537.5, 31.0e6, 70.7e6, 0.026, 0.078
    stroke, height = 200e-6, 590e-6
    theta = (short * drive * stroke + long * pole * height) / (pivot + short**2 * drive + long**2 * pole)
    moment = pivot * theta - short * drive * (stroke - short * theta) + long * pole * (long * theta - height)
    assert moment == pytest.approx(0.0, abs=1e-9 * pivot)


def test_equation_29_is_a_frequency_response_not_a_transmissibility() -> None:
    """G_ij / G_ii with i the input is the H1 estimate of output over input; a transmissibility relates two outputs."""
    generator = np.random.default_rng(29)
    force = generator.standard_normal((400, 256))
    gains = np.exp(-1j * 0.3), 4.0
    spectrum = np.fft.rfft(force)
    outputs = [gain * spectrum for gain in gains]
    auto = np.mean(np.abs(spectrum) ** 2, axis=0)
    ratios = [np.mean(np.conj(spectrum) * output, axis=0) / auto for output in outputs]
    for ratio, gain in zip(ratios, gains, strict=True):
        np.testing.assert_allclose(ratio, gain, rtol=1e-12)
    assert not np.allclose(ratios[1], outputs[1][0] / outputs[0][0])
