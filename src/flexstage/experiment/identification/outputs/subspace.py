"""Output-only modes by covariance-driven stochastic subspace identification, band by band, with standard deviations from blocks."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.experiment.identification.bands import Sweep
from flexstage.experiment.identification.cluster import Candidate, Stabilisation, stabilisation
from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.lscf import Poles
from flexstage.experiment.progress import report
from flexstage.experiment.records.record import Channel, Record, Responses, Role, names_of

BLOCKS = 40
"""Number of blocks of a record; intervals follow from the scatter between blocks."""
_DIVISIONS = (0.0, 0.5)
"""Shifts of two divisions into bands, in bands: a mode must be found in both."""
_TAPER, _SKIPPED = 0.15, 2
_ROWS, _LONGEST, _LARGEST, _SIZE = 8, 48, 240, 36
_FADED = 0.08
_HIGHEST = 18
_RATIO, _MARGIN = 1.4, 0.4
_SURE = 6.0
_BY_CHANCE, _WORSE = 2.0, 3.0
_SINGULAR = 1e-8


@dataclass(frozen=True, eq=False)
class AmbientMode:
    """Mode of a stage under floor excitation: `pole` in Hz (rad/s divided by 2 pi), and `shape` (p,) with largest component 1.

    Standard deviations are `width_deviation` for the pole's real part, `deviation` for its imaginary part, and `shape_deviation` (p,) for
    the shape.
    """

    pole: complex
    shape: Array
    width_deviation: float
    deviation: float
    shape_deviation: Array


@dataclass(frozen=True, eq=False)
class Band:
    """Covariances (b, lags, p, p) of the outputs in a frequency band, for b blocks, at lags that are multiples of `step` [s].

    Frequencies are shifted down by `low` [Hz]. `sweep` contains the limits of the band, and the narrower limits within which poles are
    kept. Outputs are multiplied by `scale` (p,).
    """

    covariances: Array
    step: float
    low: float
    sweep: Sweep
    scale: Array


def band_covariances(record: Record, low: float, high: float) -> tuple[list[list[Band]], Responses]:
    """Compute the outputs' covariances in bands from `low` to `high` [Hz], for two divisions into bands, and their densities [unit/Hz^0.5].

    Each block is Fourier transformed. The lines of a band are multiplied for each pair of outputs, and tapered at the ends of the band. The
    inverse transform of these products is the band's covariance R(l) = E[y(n + l) y(n)^H] of the outputs y. This procedure is equivalent to
    mixing and decimation. R is divided by 1 - l/N, the fraction of the block's N samples available at lag l. Outputs are divided by their
    root mean squares. The density of the floor motion need only be smooth within each band.
    """
    chosen = record.select(names_of(record.outputs))
    size = record.length // BLOCKS
    divisions = [_divide(low, high, shift) for shift in _DIVISIONS]
    every = [sweep for division in divisions for sweep in division]
    resolution, count = record.rate / size, len(chosen.channels)
    places = [_lines(sweep, resolution, size // 2 + 1) for sweep in every]
    lags = 2 * _rows(count, 1e-9) + _SKIPPED + 1
    parts: list[list[Array]] = [[] for _ in every]
    power = np.zeros((size // 2 + 1, count))
    for number in range(BLOCKS):
        values = chosen.samples.read(number * size, (number + 1) * size)
        lines = np.fft.rfft(values - np.mean(values, axis=0), axis=0) / np.sqrt(size)
        power += np.abs(lines) ** 2 * (2.0 / record.rate / BLOCKS)
        for part, (first, last) in zip(parts, places, strict=True):
            part.append(_covariances(lines[first:last], lags))
        report((number + 1) / BLOCKS)
    bands = []
    for sweep, (first, last), part in zip(every, places, parts, strict=True):
        covariances = np.array(part)
        scale = 1.0 / np.sqrt(np.maximum(np.real(np.diagonal(np.mean(covariances[:, 0], axis=0))), 1e-300))
        step = size / record.rate / _folded(last - first)
        bands.append(Band(covariances * scale[:, None] * scale, step, first * record.rate / size, sweep, scale))
    lines = np.fft.rfftfreq(size, 1.0 / record.rate)
    density, count = np.sqrt(power[1:, :, None]) + 0j, len(divisions[0])
    return [bands[:count], bands[count:]], Responses(lines[1:], record.outputs, (Channel("density", "Hz^0.5", Role.INPUT),), density)


def searched_from(low: float, high: float, *, outputs: int, resolution: float) -> float:
    """Compute the lowest frequency [Hz] between `low` and `high` that can be searched; infinite if no band has enough lines.

    Covariances of a band with N lines repeat after N lags. A band must therefore have twice as many lines as the smallest Hankel matrix has
    lags. `resolution` [Hz] is the line spacing of a block.

    >>> round(searched_from(0.1, 100.0, outputs=6, resolution=0.02), 1), searched_from(50.0, 50.1, outputs=6, resolution=1.0)
    (1.4, inf)
    """
    needed = 2 * (2 * _rows(outputs, np.inf) + _SKIPPED)
    wide = [[each.first for each in _divide(low, high, shift) if each.high - each.low >= needed * resolution] for shift in _DIVISIONS]
    return max(min(each, default=np.inf) for each in wide)


def _divide(low: float, high: float, shift: float) -> list[Sweep]:
    """Bands between (shifted) powers of 1.4 Hz, whatever range is searched, extended by two fifths of their width on both sides."""
    first, last = (np.log(each) / np.log(_RATIO) - shift for each in (low, high))
    limits = _RATIO ** (shift + np.arange(np.floor(first), np.ceil(last) + 1.0))
    return [
        Sweep(a - _MARGIN * (b - a), b + _MARGIN * (b - a), max(float(a), low), min(float(b), high))
        for a, b in itertools.pairwise(limits)
        if b > low and a < high
    ]


def _rows(outputs: int, damping: float) -> int:
    """Number of block rows: enough for a mode to decay to about a half, and for the number of poles tried."""
    return int(np.clip(np.ceil(_FADED / damping), max(_ROWS, _SIZE // outputs), max(_SIZE // outputs, min(_LONGEST, _LARGEST // outputs))))


def _lines(sweep: Sweep, resolution: float, count: int) -> tuple[int, int]:
    """First and last line of a band, shifted down if it would exceed the last line."""
    first, last = int(sweep.low / resolution), int(np.ceil(sweep.high / resolution))
    return max(1, first - max(0, last - count)), min(count, last)


def _covariances(inside: Array, lags: int) -> Array:
    """Covariances of a band by lag, with tapered and folded ends: white noise stays white, with zero covariance at nonzero lags."""
    count, step = len(inside), _folded(len(inside))
    taper = np.minimum(np.minimum(np.arange(count) + 0.5, count - 0.5 - np.arange(count)) / (count - step), 1.0)
    power = inside[:, :, None] * np.conj(inside[:, None, :]) * (np.sin(0.5 * np.pi * taper) ** 2)[:, None, None]
    power[: count - step] += power[step:]
    found = np.fft.ifft(power[:step], axis=0)[:lags]
    return found / (1.0 - np.arange(len(found)) / step)[:, None, None]


def _folded(count: int) -> int:
    """Number of a band's lines after tapering."""
    return count - int(_TAPER * count)


def hankel(covariances: Array, rows: int, first: int) -> Array:
    """Assemble the block Hankel matrix (rows p, rows p) from the covariances (lags, p, p) of p outputs, beginning with lag `first`.

    >>> hankel(np.arange(4.0)[:, None, None], 2, 1).tolist()
    [[1.0, 2.0], [2.0, 3.0]]
    """
    outputs = covariances.shape[1]
    places = first + np.arange(rows)[:, None] + np.arange(rows)
    return covariances[places].transpose(0, 2, 1, 3).reshape(rows * outputs, rows * outputs)


def _roots(covariances: Array, rows: int) -> tuple[Array, Array]:
    """Matrix W and its inverse, W T W = 1 for the block Toeplitz matrix T (rows p, rows p) of covariances R(i - j)."""
    outputs = covariances.shape[1]
    both = np.concatenate([np.conj(covariances[rows - 1 : 0 : -1]).swapaxes(1, 2), covariances[:rows]])
    places = rows - 1 + np.arange(rows)[:, None] - np.arange(rows)
    values, vectors = np.linalg.eigh(both[places].transpose(0, 2, 1, 3).reshape(rows * outputs, rows * outputs))
    sizes = np.sqrt(np.maximum(values, _SINGULAR * values[-1]))
    turned = np.conj(vectors.T)
    return (vectors / sizes) @ turned, (vectors * sizes) @ turned


def shaken_modes(band: Band, highest_damping: float) -> tuple[Stabilisation, list[AmbientMode]]:
    """Identify the modes of a band by stochastic subspace identification, with the stabilisation diagram.

    The Hankel matrix H of covariances is factored as H = O Z for increasing orders. O is the observability matrix. The poles follow from
    the state matrix A: O A equals O shifted by one lag. H is weighted with the inverse matrix roots W and V of the future and past
    covariances. The singular values of W H V are canonical correlations: weakly and strongly excited modes have equal weight (Van Overschee
    & De Moor, Subspace Identification for Linear Systems, 1996, ch. 3; Peeters & De Roeck, MSSP 13 (1999) 855).

    The equations are projected onto the signal subspace of the whole record, spanned by the first singular vectors U and R of W H V. A then
    has the eigenvalues of (U^H W H V R)^-1 U^H W H' V R, where H' is H shifted by one lag. Standard deviations follow from first-order
    effects of the covariances of independent blocks on this projection (Doehler & Mevel, MSSP 38 (2013) 346). Modes outside the band bias
    low orders, and spurious poles bias high orders: the order is therefore selected for each mode (`_select_order`).
    """
    outputs = band.covariances.shape[2]
    least = _rows(outputs, np.inf)
    diagram, found = _with_rows(band, least, highest_damping)
    sure = [-mode.pole.real / abs(mode.pole) for mode in found if -mode.pole.real > _SURE * mode.width_deviation]
    most = (band.covariances.shape[1] - _SKIPPED) // 2
    longer = min(most, _rows(outputs, min(sure, default=np.inf)))
    return _with_rows(band, longer, highest_damping) if longer > 1.5 * least else (diagram, found)


def _with_rows(band: Band, rows: int, highest_damping: float) -> tuple[Stabilisation, list[AmbientMode]]:
    mean = np.mean(band.covariances, axis=0)
    (weight, inverse), (before, _) = _roots(mean, rows), _roots(np.conj(mean.swapaxes(1, 2)), rows)
    left, values, right = np.linalg.svd(weight @ hankel(mean, rows, _SKIPPED) @ before)
    highest = min(len(values) // 2, _HIGHEST)
    found = inverse @ left[:, :highest] * np.sqrt(values[:highest])
    poles = tuple(_poles(band, found[:, :order], order, mean.shape[1]) for order in range(2, highest + 1))
    diagram, candidates = stabilisation(poles, highest_damping)
    inside = [each for each in candidates if band.sweep.first + each.pole.real <= each.pole.imag <= band.sweep.last - each.pole.real]
    if not inside:
        return diagram, []
    return diagram, _perturbed(band, weight @ left[:, :highest], before @ np.conj(right[:highest].T), inside)


def _poles(band: Band, observability: Array, order: int, outputs: int) -> Poles:
    state = np.linalg.lstsq(observability[:-outputs], observability[outputs:], rcond=None)[0]
    turns, vectors = np.linalg.eig(state)
    values = _continuous(band, turns)
    shapes = (observability[:outputs] @ vectors).T
    kept = np.flatnonzero(np.real(values) < 0.0)
    kept = kept[np.argsort(np.imag(values)[kept])]
    return Poles(order, values[kept], shapes[kept] / np.linalg.norm(shapes[kept], axis=1, keepdims=True))


def _continuous(band: Band, turns: Array) -> Array:
    """Poles in rad/s from eigenvalues per lag, with the frequency shift of the band undone."""
    values = np.log(turns) / band.step
    return np.real(values) + 1j * (np.mod(np.imag(values), 2.0 * np.pi / band.step) + 2.0 * np.pi * band.low)


@dataclass(frozen=True, eq=False)
class _Estimate:
    """Mode at one order: `pole` in Hz, `shape` (p,) of any scale, and their changes by the blocks' covariances, (b,) and (b, p)."""

    pole: complex
    shape: Array
    pole_changes: Array
    shape_changes: Array

    def poles(self) -> tuple[Array, Array]:
        """Real and imaginary part of the pole (2,), and their changes (b, 2)."""
        return np.array([self.pole.real, self.pole.imag]), np.stack([np.real(self.pole_changes), np.imag(self.pole_changes)], axis=1)

    def shapes(self, largest: int) -> tuple[Array, Array]:
        """Real and imaginary parts (2 p,) of the shape over one of its components, and their changes (b, 2 p)."""
        shape = self.shape / self.shape[largest]
        changes = (self.shape_changes - self.shape_changes[:, largest, None] * shape) / self.shape[largest]
        return np.concatenate([np.real(shape), np.imag(shape)]), np.concatenate([np.real(changes), np.imag(changes)], axis=1)


def _perturbed(band: Band, left: Array, right: Array, candidates: Sequence[Candidate]) -> list[AmbientMode]:
    """Candidates as modes, each at its order of lowest error."""
    rows = len(left) // band.covariances.shape[2]
    blocks = [(hankel(each, rows, _SKIPPED) @ right, hankel(each, rows, _SKIPPED + 1) @ right) for each in band.covariances]
    orders = [
        _of_order(band, left[:, :order], [(a[:, :order], b[:, :order]) for a, b in blocks], candidates)
        for order in range(1, left.shape[1] + 1)
    ]
    tracks = [[found[number] for found in orders if number in found] for number in range(len(candidates))]
    return [_select_order(track) for track in tracks if track]


def _of_order(band: Band, left: Array, blocks: Sequence[tuple[Array, Array]], candidates: Sequence[Candidate]) -> dict[int, _Estimate]:
    """Candidates, by index, that are poles of the equations projected onto `left`, perturbed by each of the blocks."""
    outputs = band.covariances.shape[2]
    own, shifted = (np.mean([each[index] for each in blocks], axis=0) for index in range(2))
    inner = np.conj(left.T) @ own
    turns, vectors = np.linalg.eig(np.linalg.solve(inner, np.conj(left.T) @ shifted))
    rest = np.linalg.solve(inner @ vectors, np.conj(left.T))
    poles = _continuous(band, turns) / (2.0 * np.pi)
    shapes = own[:outputs] @ vectors / band.scale[:, None]
    found: dict[int, _Estimate] = {}
    for number, place in _matches(poles, candidates).items():
        moved = np.array([rest @ ((each[1] - turns[place] * each[0]) @ vectors[:, place]) for each in blocks])
        apart = turns[place] - turns
        turned = np.where(np.arange(len(turns)) == place, 0.0, moved / np.where(apart == 0.0, np.inf, apart))
        change = np.array([each[0][:outputs] @ vectors[:, place] for each in blocks]) / band.scale - shapes[:, place] + turned @ shapes.T
        step = moved[:, place] / turns[place] / (2.0 * np.pi * band.step)
        found[number] = _Estimate(complex(poles[place]), shapes[:, place], step, change)
    return found


def _select_order(track: Sequence[_Estimate]) -> AmbientMode:
    """Mode at the order, ascending, of lowest variance plus squared bias, with the bias from higher orders."""
    poles = [each.poles() for each in track]
    chosen = int(np.argmin([np.sum(_risk(index, poles)[0]) for index in range(len(poles))]))
    width, deviation = np.sqrt(np.sum(_risk(chosen, poles), axis=0))
    best = track[chosen]
    largest = int(np.argmax(np.abs(best.shape)))
    parts = np.sum(_risk(chosen, [each.shapes(largest) for each in track]), axis=0).reshape(2, -1)
    return AmbientMode(best.pole, best.shape / best.shape[largest], float(width), float(deviation), np.sqrt(np.mean(parts, axis=0)))


def _risk(index: int, track: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """Risk of values (q,) at one order: variance, squared bias from higher orders, and the square of an undetected bias.

    For values v_i and block changes of all orders, the largest |v_i - v_j|^2 - (2 sigma_ij)^2 of orders j above i is the squared bias
    (Goldenshluger & Lepski, Ann. Statist. 39 (2011) 1608), with sigma_ij the deviation of the difference. A smaller difference may be
    chance or bias: it counts as uniformly distributed, averaged over orders with at most three times the uncertainty.
    """
    value, changes = track[index]
    own = _deviation(changes)
    beyond, within = np.zeros(len(value)), list[Array]([np.zeros((2, len(value)))])
    for other, other_changes in track[index + 1 :]:
        apart, chance = (other - value) ** 2, (_BY_CHANCE * _deviation(other_changes - changes)) ** 2
        beyond = np.maximum(beyond, apart - chance)
        is_sure = _deviation(other_changes) < _WORSE * own
        within.append(np.stack([np.where(is_sure, np.minimum(apart, chance), 0.0), np.where(is_sure, 1.0, 0.0)]))
    hidden, count = np.sum(within, axis=0)
    return own**2 + beyond, hidden / np.maximum(count, 1.0) / 3.0


def _matches(poles: Array, candidates: Sequence[Candidate]) -> dict[int, int]:
    """Pole of each candidate, by index: the nearest unassigned one within two half-widths."""
    found: dict[int, int] = {}
    for number, candidate in enumerate(candidates):
        away = np.abs(poles - candidate.pole)
        away[list(found.values())] = np.inf
        if np.min(away) < -2.0 * candidate.pole.real:
            found[number] = int(np.argmin(away))
    return found


def _deviation(changes: Array) -> Array:
    """Standard deviation of the mean of independent blocks' changes (b, ...).

    Times Student's t over the normal's 1.96, so that 1.96 deviations are half a 95 % interval.
    """
    blocks = len(changes)
    spread = np.sqrt(np.sum((changes - np.mean(changes, axis=0)) ** 2, axis=0) / (blocks * (blocks - 1.0)))
    return spread * float(-scipy.special.stdtrit(blocks - 1.0, 0.025)) / NORMAL_95
