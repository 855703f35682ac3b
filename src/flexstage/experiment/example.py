"""Example data for identification: a stage with one mode."""

from __future__ import annotations

import numpy as np

from flexstage.experiment.identification.likelihood import Band, Modal, background
from flexstage.experiment.records.record import Channel, Record, Role, in_memory
from flexstage.experiment.spectral.lines import edges, gather_cells, record_lines

POLE = 10.0 * (-0.02 + 1j * np.sqrt(1.0 - 0.02**2))
"""Pole of the example stage in Hz (rad/s over 2 pi): natural frequency 10 Hz, damping ratio 2 %."""

_NOISE = 0.05


def one_mode_record(*, seconds: float = 64.0) -> Record:
    """Generate a record of a white-noise input and the stage's motion with 5 % noise; every call returns the same samples.

    >>> one_mode_record().duration
    64.0
    """
    random = np.random.default_rng(0)
    size, rate = round(64.0 * seconds), 64.0
    drive = np.fft.rfft(random.standard_normal(size + 2048))
    lines = np.fft.rfftfreq(size + 2048, 1.0 / rate)
    natural = abs(POLE)
    moved = np.fft.irfft(drive * natural**2 / (natural**2 - lines**2 + 0.04j * natural * lines))[1024:-1024]
    values = np.stack([np.fft.irfft(drive)[1024:-1024], moved + _NOISE * np.std(moved) * random.standard_normal(size)], axis=1)
    return in_memory([Channel("u", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT)], rate, values)


def one_mode_band() -> tuple[Band, Modal]:
    """Return the band around the example's mode, and start values of a fit: a pole near `POLE`.

    >>> one_mode_band()[0].cells.width
    2
    """
    poles = np.array([1.01 * POLE])
    made = one_mode_record()
    cells = gather_cells(record_lines(made, (0,), 1), [edges(poles, 6.0, 14.0)])[0]
    variance = np.full((1, len(cells.low)), _NOISE**2 * float(np.var(made.values[:, 1])))
    start = Modal(poles, np.ones((1, 2), dtype=complex), np.full((1, 1), -5.0j))
    return Band(cells, variance, background(cells, np.conj(poles))), start
