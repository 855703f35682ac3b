"""Test of excitation by recorded inputs: regression of a mode's motion on the inputs over frequency lines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.experiment.identification.confidence import SAME
from flexstage.experiment.identification.likelihood import Band, Modal, explained_share, resonances
from flexstage.experiment.spectral.lines import DEGREE, Lines

_WIDTHS = 4.0
_LINES = 3
_HALVINGS = 40


@dataclass(frozen=True, eq=False)
class Drive:
    """Excitation of the modes (k,) of a band by the recorded inputs.

    `chance` (k,) is the probability that a mode not excited by the inputs shows at least the observed correlation with the inputs.
    `elsewhere` (k,) is the fraction of the motion in the half-power band that the inputs do not explain.
    """

    chance: Array
    elsewhere: Array


def measure_drives(bands: Sequence[tuple[Band, Modal]], lines: Iterable[Lines]) -> list[Drive]:
    """Test whether the recorded inputs excite each mode, band by band.

    All other fitted components are subtracted from the outputs. The modal motion q is the mean of the remaining outputs, weighted with the
    shape and the inverse noise variance. At the frequency f, the modal force plus output noise is q (j f - p), where p is the pole in Hz.
    The modal force is regressed on inputs and transients. The regression uses the lines within four half-widths, but at least three lines
    for each regressor. If the inputs do not excite the mode, the explained fraction is F-distributed even with unrecorded forces or tones.
    A line is weighted with the inverse of its variance a + b |j f - p|^2. The variance a of the unrecorded force follows from the residual;
    b is the variance of q due to noise of the outputs. Near the pole, the variance is increased so that at least as many lines as
    regressors have similar weights. Transients count as inputs if the inputs explain at least nine tenths of their power, as for an impact
    at the start of a record.

    >>> from flexstage.experiment.example import one_mode_band, one_mode_record
    >>> from flexstage.experiment.identification.likelihood import fit
    >>> from flexstage.experiment.spectral.lines import record_lines
    >>> band, start = one_mode_band()
    >>> [found] = measure_drives([(band, fit(band, start).modal)], record_lines(one_mode_record(), (0,), 1))
    >>> bool(found.chance[0] < 1e-30), bool(found.elsewhere[0] < 0.01)
    (True, True)
    """
    kept = [_Local.of(band, modal) for band, modal in bands]
    for number, block in enumerate(lines):
        for local in kept:
            local.add(number, block)
    return [local.drive() for local in kept]


class _Near(NamedTuple):
    """Lines near a mode: their drive (n, m+b), the mode's motion (n,), and their complex distances (n,) from its pole in Hz."""

    drive: Array
    motion: Array
    away: Array


@dataclass(frozen=True, eq=False)
class _Local:
    """Band with its fit, and the lines near each of its modes."""

    band: Band
    modal: Modal
    fitted: list[tuple[Array, Array]]
    own: Array
    near: list[list[_Near]]

    @staticmethod
    def of(band: Band, modal: Modal) -> _Local:
        return _Local(band, modal, list(explained_share(band, modal)), resonances(band, modal.poles), [[] for _ in modal.poles])

    def add(self, block: int, lines: Lines) -> None:
        cells, (chosen, inside) = self.band.cells, self.fitted[block]
        least = _LINES * cells.width / len(cells.columns) / 2.0 * float(lines.frequencies[1] - lines.frequencies[0])
        for mode, pole in enumerate(self.modal.poles):
            reach = max(-_WIDTHS * pole.real, least)
            low, high = max(pole.imag - reach, np.min(cells.low)), min(pole.imag + reach, np.max(cells.high))
            start, stop = np.searchsorted(lines.frequencies, [low, high])
            frequencies, drive = lines.frequencies[start:stop], lines.drive[start:stop]
            place = np.searchsorted(cells.low[chosen], frequencies, side="right") - 1
            edges = cells.low[chosen][place], cells.high[chosen][place]
            powers = np.polynomial.legendre.legvander((2.0 * frequencies - edges[0] - edges[1]) / (edges[1] - edges[0]), DEGREE)
            rest = lines.outputs[start:stop] - np.einsum("olan,la,ln->lo", inside[:, place], powers, drive, optimize=True)
            weight = np.conj(self.modal.shapes[:, mode]) / self._noise(mode)
            own = np.sum(self.own[chosen][place, mode] * powers, axis=1) * (drive @ self.modal.participation[mode, list(lines.columns)])
            full = np.zeros((stop - start, cells.width), dtype=complex)
            full[:, list(lines.columns)] = drive
            self.near[mode].append(_Near(full, rest @ weight / (weight @ self.modal.shapes[:, mode]) + own, 1j * frequencies - pole))

    def _noise(self, mode: int) -> Array:
        cells = self.band.cells
        return self.band.variance[:, int(np.argmin(np.abs(cells.middle - self.modal.poles[mode].imag)))]

    def drive(self) -> Drive:
        inputs = self.band.cells.width if self.band.inputs is None else self.band.inputs
        return Drive(*np.array([self._tested(mode, inputs) for mode in range(len(self.near))]).reshape(-1, 2).T)

    def _tested(self, mode: int, inputs: int) -> tuple[float, float]:
        joined = _Near(*map(np.concatenate, zip(*self.near[mode], strict=True)))
        sensed = 1.0 / float(np.sum(np.abs(self.modal.shapes[:, mode]) ** 2 / self._noise(mode)))
        return _drive_chance(joined, inputs, sensed)


def _drive_chance(near: _Near, inputs: int, sensed: float) -> tuple[float, float]:
    """Tail probability of the F-test for complex numbers, with twice the degrees of freedom; and the unexplained share of motion."""
    values, force, distance = near.drive, near.motion * near.away, np.abs(near.away) ** 2
    count, total = values.shape
    if count <= total:
        return 1.0, 1.0
    least = sensed * float(np.sort(distance)[total])
    other = _other_variance(values, force, sensed * distance + least)
    weights = 1.0 / (other + sensed * distance + least)
    rest = _weighted_residual(values, force, weights)
    left = float(np.sum(np.abs(rest) ** 2))
    transients = values[:, inputs:]
    unlike, size = np.abs(_weighted_residual(values[:, :inputs], transients, weights)) ** 2, np.abs(transients) ** 2 * weights[:, None]
    free = transients if np.sum(unlike) > SAME * np.sum(size) else transients[:, :0]
    gained = float(np.sum(np.abs(_weighted_residual(free, force, weights)) ** 2)) - left
    more = total - free.shape[1]
    ratio = gained / more * (count - total) / max(left, 1e-300)
    return float(scipy.special.fdtrc(2 * more, 2 * (count - total), max(ratio, 0.0))), _unexplained_share(near, rest / np.sqrt(weights))


def _unexplained_share(near: _Near, rest: Array) -> float:
    """Share of the force residual in the motion, at its maximum."""
    count, total = near.drive.shape
    distance = np.abs(near.away) ** 2
    close = distance <= max(2.0 * float(np.min(np.real(near.away) ** 2)), float(np.sort(distance)[total]))
    left = np.sum(np.abs(rest[close]) ** 2 / distance[close]) * count / (count - total)
    return float(min(1.0, left / max(np.sum(np.abs(near.motion[close]) ** 2), 1e-300)))


def _other_variance(values: Array, force: Array, sensed: Array) -> float:
    """Smallest variance in addition to the `sensed` one for a consistent regression residual."""
    free = len(force) - values.shape[1]
    if np.sum(np.abs(_weighted_residual(values, force, 1.0 / sensed)) ** 2) <= free:
        return 0.0
    low, high = float(np.min(sensed)) * 1e-6, float(np.sum(np.abs(force) ** 2)) / free
    for _ in range(_HALVINGS):
        middle = np.sqrt(low * high)
        enough = np.sum(np.abs(_weighted_residual(values, force, 1.0 / (middle + sensed))) ** 2) <= free
        low, high = (low, middle) if enough else (middle, high)
    return high


def _weighted_residual(values: Array, force: Array, weights: Array) -> Array:
    """Regression residual times the roots of the weights."""
    root = np.sqrt(weights)
    rows, right = values * root[:, None], (force.T * root).T
    return right - rows @ np.linalg.lstsq(rows, right, rcond=1e-10)[0]
