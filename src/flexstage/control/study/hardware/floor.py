"""Floor vibration spectra: generic criteria by name, and specified densities."""

from __future__ import annotations

from types import MappingProxyType

import numpy as np

from flexstage.analysis.dynamics.random_response import Rate, Spectrum
from flexstage.control.study.choices import Criterion
from flexstage.control.study.setup import Floor, VibrationSetup

_THIRD_OCTAVE = np.log(2.0) / 3.0
_VELOCITIES = MappingProxyType(
    dict(zip(Criterion, (800e-6, 400e-6, 200e-6, 100e-6, 50e-6, 25e-6, 12.5e-6, 6.25e-6, 3.12e-6, 1.56e-6, 0.78e-6), strict=True))
)
_FROM_ONE_HERTZ = (Criterion.VC_C, Criterion.VC_D, Criterion.VC_E, Criterion.VC_F, Criterion.VC_G)
_LOWEST, _CORNER, _HIGHEST = 4.0, 8.0, 80.0


def criterion_spectrum(criterion: Criterion) -> Spectrum:
    """Compute the spectrum of a floor that just meets a generic vibration criterion in every third-octave band.

    The criteria limit the rms velocity v in third-octave bands. The limit is constant from 8 to 80 Hz, and inversely proportional to the
    frequency (constant acceleration) from 4 to 8 Hz. For VC-C to VC-G the limit is constant from 1 to 80 Hz (Gordon 1999; Amick and others
    2005, Table 1). For constant v, a velocity with the power density v^2/(f ln(2)/3) at the frequency f has exactly the rms value v in each
    band. Outside these frequencies the criteria do not apply, and the spectrum is zero.

    >>> spectrum = criterion_spectrum(Criterion.VC_D)
    >>> band = np.geomspace(10.0 * 2.0 ** (-1.0 / 6.0), 10.0 * 2.0 ** (1.0 / 6.0), 2001)
    >>> velocity = spectrum.at(band) * (2.0 * np.pi * band) ** 2
    >>> round(1e6 * float(np.sqrt(np.trapezoid(velocity, band))), 4)
    6.25
    """
    velocity = _VELOCITIES[criterion]
    if criterion in _FROM_ONE_HERTZ:
        frequencies, velocities = np.array([1.0, _HIGHEST]), np.array([velocity, velocity])
    else:
        frequencies = np.array([_LOWEST, _CORNER, _HIGHEST])
        velocities = velocity * np.array([_CORNER / _LOWEST, 1.0, 1.0])
    return Spectrum(velocities**2 / (_THIRD_OCTAVE * frequencies), frequencies, Rate.VELOCITY)


def floor_spectra(floor: Floor) -> dict[str, Spectrum]:
    """Compute the spectra of a set-up's floor by plant input (`ground.x`, ...).

    >>> sorted(floor_spectra(Floor(z=VibrationSetup(criterion=Criterion.VC_C))))
    ['ground.z']
    """
    by_axis = {axis: getattr(floor, axis) for axis in ("x", "y", "z")}
    return {f"ground.{axis}": _spectrum(shaking) for axis, shaking in by_axis.items() if shaking is not None}


def _spectrum(shaking: VibrationSetup) -> Spectrum:
    if shaking.criterion is not None:
        return criterion_spectrum(shaking.criterion)
    kinds = ((Rate.ACCELERATION, shaking.acceleration), (Rate.VELOCITY, shaking.velocity), (Rate.VALUE, shaking.displacement))
    rate, table = next((rate, table) for rate, table in kinds if table)
    if not shaking.frequencies:
        return Spectrum(table[0] ** 2, rate=rate)
    return Spectrum(np.array(table) ** 2, np.array(shaking.frequencies), rate)
