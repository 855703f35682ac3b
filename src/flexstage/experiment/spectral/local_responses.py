"""Frequency responses without leakage, with uncertainty: local polynomials on the lines of whole records."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.identification.diagnosis.peaks import PeakCause
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.outputs.tones import remove_tones
from flexstage.experiment.records.record import Record, names_of
from flexstage.experiment.spectral.lines import Lines, auto_powers, block_count, record_lines

_DEGREE, _OVER = 2, 2
"""Degree of the polynomials, and minimum number of lines per coefficient."""
_SHARE, _WIDEST, _STEP = 0.35, 8.0, 0.25
"""Half window relative to the distance to the nearest pole, and to the minimum; window spacing relative to half a window."""
_TOGETHER = 20_000
_DRIVEN = 1e-4
"""Minimum power of every input, relative to its median."""


@dataclass(frozen=True, eq=False)
class LocalResponses:
    """Responses (f, p, m) of outputs to inputs at `frequencies` (f,) [Hz], in the channels' units, with rms values of their errors."""

    frequencies: Array
    values: Array
    deviations: Array


def local_responses(records: Sequence[Record], found: Identified) -> LocalResponses:
    """Estimate the stage's frequency responses from records by the local polynomial method, without leakage and with little smearing.

    At the frequency lines of a whole block, the outputs are Y(f) = H(f) U(f) + T(f) + V(f), with responses H, inputs U, transient T and
    noise V. In a window of lines, H and T are modelled as polynomials of second degree (Pintelon & Schoukens, System Identification, 2nd
    ed., 2012, chapter 7). A window has at least twice as many lines as coefficients. The half-width of a window is about a third of the
    distance to the nearest pole of `found`, but at most eight times the minimum half-width. Blocks with a large residual have a small
    weight. Frequency lines at which an input has less than 1e-4 of the input's median power are omitted. As in `identify`, tones are
    removed from the records first. For m inputs, the minimum window has 3 (m + 1) lines to each side. A mode that is narrower than this
    window is smeared; the smearing counts as noise.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> made = one_mode_record()
    >>> seen = local_responses([made], identify(made))
    >>> round(float(seen.frequencies[np.argmax(abs(seen.values[:, 0, 0]))]), 1)
    10.0
    """
    hums = any(peak.doubt is PeakCause.TONE for peak in found.peaks)
    names = names_of((*found.inputs, *found.outputs))
    chosen = [record.select([each.name for each in record.channels if each.name in names]) for record in records]
    least = max(_least_reach(record) * block_count(record) / record.duration for record in chosen)
    centres, halves = _windows(found.poles / (2.0 * np.pi), found.band, least)
    values = np.zeros((len(centres), len(found.outputs), len(found.inputs)), dtype=complex)
    weights = np.zeros(values.shape)
    for record in chosen:
        columns = [names.index(each.name) for each in record.inputs]
        for lines in record_lines(remove_tones(record)[0] if hums else record, tuple(range(len(columns))), len(columns)):
            for part, response, spread in _block_responses(lines, centres, halves):
                place = np.ix_(part.tolist(), range(len(found.outputs)), columns)
                weight = 1.0 / np.maximum(spread, 1e-150) ** 2
                values[place] += response * weight
                weights[place] += weight
    driven = np.all(weights > 0.0, axis=(1, 2))
    return LocalResponses(centres[driven], values[driven] / weights[driven], 1.0 / np.sqrt(weights[driven]))


def _least_reach(record: Record) -> float:
    """Half of the minimum window, in lines."""
    return 0.5 * _OVER * (_DEGREE + 1) * (len(record.inputs) + 1)


def _windows(poles: Array, band: tuple[float, float], least: float) -> tuple[Array, Array]:
    """Centres and half widths [Hz] of the windows, the minimum times powers of two.

    >>> [each.tolist() for each in _windows(np.array([-1.0 + 20.0j]), (0.0, 10.0), 1.0)]
    [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0], [1.0, 2.0, 2.0, 4.0, 4.0, 4.0, 2.0, 2.0, 1.0]]
    """
    centre, found = band[0] + least, list[tuple[float, float]]()
    while centre + least <= band[1]:
        away = float(np.min(np.abs(1j * centre - poles), initial=np.inf))
        room = min(_SHARE * away, centre - band[0], band[1] - centre, _WIDEST * least)
        half = least * 2.0 ** np.floor(np.log2(max(1.0, room / least)))
        found.append((centre, half))
        centre += max(least, _STEP * half)
    centres, halves = np.array(found).reshape(-1, 2).T
    return centres, halves


def _block_responses(lines: Lines, centres: Array, halves: Array) -> Iterator[tuple[Array, Array, Array]]:
    """Window indices, with their responses (w, p, m) and deviations, infinite for an inactive input."""
    inputs = lines.drive.shape[1] - 1
    usual = np.median(np.abs(lines.drive[:, :inputs]) ** 2, axis=0)
    for half in np.unique(halves):
        number = int(2.0 * half / lines.frequencies[1])
        every = np.flatnonzero(halves == half)
        for part in np.array_split(every, max(1, len(every) * number // _TOGETHER)):
            first = np.searchsorted(lines.frequencies, centres[part] - half)
            places = np.minimum(first, len(lines.frequencies) - number)[:, None] + np.arange(number)
            away = (lines.frequencies[places] - centres[part, None]) / half
            response, spread = _polynomial_fit(away, lines.drive[places], lines.outputs[places])
            power = np.mean(np.abs(lines.drive[places, :inputs]) ** 2, axis=1)
            silent = np.any(power < _DRIVEN * usual, axis=1)
            yield part, response, np.where(silent[:, None, None], np.inf, spread)


def _polynomial_fit(away: Array, drive: Array, outputs: Array) -> tuple[Array, Array]:
    """Responses (w, p, m) at zero and their deviations: polynomials in `away` (w, l) times the drive (w, l, m+1) with its transient."""
    inputs, number = drive.shape[2] - 1, away.shape[1]
    sizes = np.maximum(np.linalg.norm(drive, axis=1), 1e-300)
    powers = away[:, :, None] ** np.arange(_DEGREE + 1)
    rows = (powers[:, :, :, None] * (drive / sizes[:, None])[:, :, None, :]).reshape(len(away), number, -1)
    turned = np.conj(np.swapaxes(rows, 1, 2))
    inverse = np.linalg.pinv(turned @ rows, rcond=1e-12, hermitian=True)
    fitted = inverse @ (turned @ outputs)
    noise = np.sum(np.abs(outputs - rows @ fitted) ** 2, axis=1) / (number - rows.shape[2])
    own = auto_powers(inverse)[:, :inputs]  # the coefficients of degree zero come first
    scale = sizes[:, None, :inputs]
    return np.swapaxes(fitted[:, :inputs], 1, 2) / scale, np.sqrt(noise[:, :, None] * own[:, None, :]) / scale
