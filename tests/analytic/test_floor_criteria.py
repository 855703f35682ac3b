"""Generic vibration criteria: the spectra have the stated rms velocity in every third-octave band, and nothing outside them."""

from __future__ import annotations

import numpy as np
import pytest

from flexstage.control.study.choices import Criterion
from flexstage.control.study.hardware.floor import criterion_spectrum, floor_spectra
from flexstage.control.study.setup import Floor, VibrationSetup

TABLE = {  # Amick et al. 2005, Table 1: um/s
    "ISO workshop": 800.0,
    "ISO office": 400.0,
    "ISO residential day": 200.0,
    "ISO operating theatre": 100.0,
    "VC-A": 50.0,
    "VC-B": 25.0,
    "VC-C": 12.5,
    "VC-D": 6.25,
    "VC-E": 3.12,
    "VC-F": 1.56,
    "VC-G": 0.78,
}


def band_rms(criterion: Criterion, centre: float, power: int) -> float:
    """Rms of the velocity (power 1) or acceleration (2) in the third-octave band around `centre`."""
    lines = np.geomspace(centre * 2.0 ** (-1 / 6), centre * 2.0 ** (1 / 6), 4001)
    density = criterion_spectrum(criterion).at(lines) * (2.0 * np.pi * lines) ** (2 * power)
    return float(np.sqrt(np.trapezoid(density, lines)))


@pytest.mark.parametrize("name", list(TABLE))
@pytest.mark.parametrize("centre", [10.0, 16.0, 31.5, 63.0])
def test_bands_have_the_stated_velocity(name: str, centre: float) -> None:
    assert band_rms(Criterion(name), centre, 1) == pytest.approx(TABLE[name] * 1e-6, rel=1e-6)


def test_below_eight_hertz_the_first_two_keep_their_acceleration() -> None:
    for name, micro_g in (("VC-A", 260.0), ("VC-B", 130.0)):
        assert band_rms(Criterion(name), 5.0, 2) == pytest.approx(micro_g * 9.81e-6, rel=0.02)


def test_the_finer_ones_begin_at_one_hertz() -> None:
    for name in ("VC-C", "VC-D", "VC-E", "VC-F", "VC-G"):
        assert band_rms(Criterion(name), 1.25, 1) == pytest.approx(TABLE[name] * 1e-6, rel=1e-6)
    outside = np.array([0.5, 90.0])
    assert not np.any(criterion_spectrum(Criterion.VC_C).at(outside))
    assert not np.any(criterion_spectrum(Criterion.VC_A).at(np.array([3.0, 90.0])))


def test_stated_densities_are_taken_as_they_are() -> None:
    found = floor_spectra(
        Floor(x=VibrationSetup(displacement=(2e-9,)), y=VibrationSetup(acceleration=(1e-6, 1e-7), frequencies=(1.0, 10.0)))
    )
    assert sorted(found) == ["ground.x", "ground.y"]
    np.testing.assert_allclose(found["ground.x"].at(np.array([3.0])), 4e-18)
    np.testing.assert_allclose(found["ground.y"].at(np.array([10.0 - 1e-9])), 1e-14 / (20.0 * np.pi) ** 4, rtol=1e-6)
