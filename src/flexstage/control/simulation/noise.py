"""Noise series for a simulated loop: floor, gauges and amplifiers, from their spectra and a seed."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum

import numpy as np

from flexstage.analysis.dynamics.random_response import Spectrum
from flexstage.base.finding import refuse, require, unknown_names
from flexstage.base.number import Array
from flexstage.base.stream import generator
from flexstage.control.plant_models.electronics import Amplifier, Sensor
from flexstage.control.plant_models.plants import Plant
from flexstage.control.white_noise import gauge_noise


class Stream(IntEnum):
    """Random-number stream of each kind of noise source."""

    FLOOR = 16
    GAUGE = 17
    AMPLIFIER = 18


def noise_series(given: Plant, floor: Mapping[str, Spectrum], samples: int, seed: int = 0) -> dict[str, Array]:
    """Generate noise series (samples,) by name for `simulate`: ground motions `ground.<c>`, noise of gauges, noise of amplifiers.

    The series are independent and Gaussian. Each series depends only on its source and the seed. Ground motion is linear between samples
    (see `first_order_hold` for the error). Gauge noise is the noise after lag and filter, with exact aliasing (`gauge_noise`). Amplifier
    noise is white up to half the sampling rate. Rounding is not included: the simulation rounds. Raises `DesignError` for a continuous
    loop, and for unknown ground motions.

    >>> from flexstage.control.example import integral_loop
    >>> found = noise_series(integral_loop().plant, {"ground.x": Spectrum(1e-18)}, 1000, seed=3)
    >>> list(found), round(float(np.std(found["ground.x"])) * 1e9)  # 1 nm/Hz^(1/2) over 5 kHz: 71 nm
    (['ground.x', 'noise.S'], 70)
    """
    step = given.hardware.step
    if step is None:
        raise refuse("loop", "the loop is continuous, but noise series need samples", "Specify the sampling rate")
    inputs = given.system.input_names
    require(unknown_names(floor, [name for name in inputs if name.startswith("ground.")], "motion of the ground"))
    outside = {**floor, **{name: Spectrum(heard**2) for name, heard in given.heard.items()}}
    found = {name: series(spectrum, samples, step, (seed, Stream.FLOOR, inputs.index(name))) for name, spectrum in outside.items()}
    for number, name in enumerate(given.gauges):
        density = given.hardware.sensors.get(name, Sensor()).noise_density
        if density:
            frequencies = np.fft.rfftfreq(2 * samples, step)
            sampled = gauge_noise(given, name, density).sweep(frequencies)
            aliased = 2.0 * step * np.sum(np.abs(sampled) ** 2, axis=(1, 2))
            found[f"noise.{name}"] = shape(aliased, samples, step, (seed, Stream.GAUGE, number))
    for number, name in enumerate(given.actuators):
        density = given.hardware.amplifiers.get(name, Amplifier()).noise_density
        if density:
            found[f"noise.{name}"] = series(Spectrum(density**2), samples, step, (seed, Stream.AMPLIFIER, number))
    return found


def series(spectrum: Spectrum, samples: int, step: float, key: tuple[int, ...]) -> Array:
    """Generate a zero-mean Gaussian series (samples,) with a one-sided spectral density, sampled every `step` [s].

    Frequencies range from 1/(2 samples step) to half the sampling rate; the spectrum outside is omitted. `key` contains seed and stream.

    >>> one = series(Spectrum(2e-18), 100_000, 0.5e-3, (1,))
    >>> round(float(np.var(one)) / (2e-18 * 1000.0), 1)  # density times half the sampling rate
    1.0
    """
    frequencies = np.fft.rfftfreq(2 * samples, step)
    density = np.concatenate([[0.0], spectrum.at(frequencies[1:])])
    return shape(density, samples, step, key)


def shape(density: Array, samples: int, step: float, key: tuple[int, ...]) -> Array:
    """Generate Gaussian noise with a one-sided density (f,), given at the frequencies of a series of twice the length.

    A series with the density S and the step T has the transform X(f) = W(f) (S(f)/(2 T))^(1/2), where W is the transform of white noise of
    unit variance. The series is Gaussian and stationary, with the given density at its frequencies. Only half the series is returned, which
    removes the periodicity (Shinozuka and Deodatis, Applied Mechanics Reviews 44, 1991).

    >>> flat = shape(np.full(9, 2.0), 8, 1.0, (7,))  # density 2 T: unit variance, the unchanged white noise
    >>> bool(np.allclose(flat, generator(7).standard_normal(16)[:8]))
    True
    """
    length = 2 * samples
    white = generator(*key).standard_normal(length)
    return np.fft.irfft(np.fft.rfft(white) * np.sqrt(density / (2.0 * step)), length)[:samples]
