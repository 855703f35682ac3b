"""Seeded records of known modes: white noise in, modal motion and white noise out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.experiment.records.record import Channel, InMemory, Record, Role


@dataclass(frozen=True)
class Truth:
    """Modes (k): frequencies in Hz, damping ratios, shapes (p, k) at the outputs, participations (k, m) of the inputs."""

    frequencies: np.ndarray
    damping: np.ndarray
    shapes: np.ndarray
    participation: np.ndarray

    @property
    def poles(self) -> np.ndarray:
        natural = 2 * np.pi * self.frequencies
        return natural * (-self.damping + 1j * np.sqrt(1 - self.damping**2))

    def response(self, frequencies: np.ndarray) -> np.ndarray:
        """H (f, p, m) = sum of phi L / (w_r^2 - w^2 + 2 j zeta_r w_r w)."""
        return np.einsum("pk,fk,km->fpm", self.shapes, self._receptances(frequencies), self.participation)

    def _receptances(self, frequencies: np.ndarray) -> np.ndarray:
        natural, omega = 2 * np.pi * self.frequencies, 2 * np.pi * np.asarray(frequencies)[:, None]
        return natural**2 / (natural**2 - omega**2 + 2j * self.damping * natural * omega)


WIDE = (118.0, 119.4, 166.0, 231.0, 233.5, 291.0)
NARROW = (118.0, 118.1, 166.0, 231.0, 231.15, 291.0)


def truth(frequencies: tuple[float, ...] = WIDE, seed: int = 1, outputs: int = 6, inputs: int = 6) -> Truth:
    """Modes at these frequencies with damping of 1-2 % and random, well separated shapes."""
    count = len(frequencies)
    random = np.random.default_rng(seed)
    shapes, _ = np.linalg.qr(random.standard_normal((outputs, outputs)))
    participation, _ = np.linalg.qr(random.standard_normal((inputs, inputs)))
    skew = 0.3 / np.sqrt(outputs)
    shapes = shapes[:, :count] + skew * random.standard_normal((outputs, min(count, outputs)))
    participation = participation[:count] + skew * random.standard_normal((min(count, inputs), inputs))
    return Truth(np.array(frequencies), np.linspace(0.01, 0.02, count)[random.permutation(count)], shapes, participation)


def record(
    known: Truth,
    seed: int,
    *,
    seconds: float = 120.0,
    rate: float = 2048.0,
    noise: float = 0.1,
    active: tuple[int, ...] | None = None,
    static: bool = False,
) -> Record:
    """A stretch of steady motion under band-limited white noise at the `active` inputs, cut from a longer one.

    `noise` is white, as a share of each output's rms. The transient of the cut is that of any real record.
    """
    random = np.random.default_rng(seed)
    size, spare = round(seconds * rate), 4096
    count = known.participation.shape[1]
    inputs = random.standard_normal((size + 2 * spare, count))
    if active is not None:
        inputs[:, [index for index in range(count) if index not in active]] = 0.0
    lines = np.fft.rfft(inputs, axis=0)
    lines[-1] = 0.0
    frequencies = np.fft.rfftfreq(len(inputs), 1 / rate)
    modal = known._receptances(frequencies) * (lines @ known.participation.T)
    outputs = np.fft.irfft(modal @ known.shapes.T, len(inputs), axis=0)[spare : spare + size]
    inputs = np.fft.irfft(lines, len(inputs), axis=0)[spare : spare + size]
    outputs = outputs + noise * np.std(outputs, axis=0) * random.standard_normal(outputs.shape)
    names = [Channel(f"u{index + 1}", "V", Role.INPUT) for index in range(count)]
    names += [Channel(f"y{index + 1}", "um", Role.OUTPUT) for index in range(outputs.shape[1])]
    return Record(tuple(names), rate, InMemory(np.hstack([inputs, outputs])), name=f"seed {seed}")


def binomial_limits(count: int, share: float = 0.683, once_in: float = 1e-3) -> tuple[float, float]:
    """How many of `count` intervals hold, at least and at most, but once in so many tries, where each does with probability `share`."""
    return float(scipy.stats.binom.ppf(0.5 * once_in, count, share)), float(scipy.stats.binom.ppf(1.0 - 0.5 * once_in, count, share))
