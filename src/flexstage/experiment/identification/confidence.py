"""Confidence of an estimate: standard deviations from Fisher information, and tests for the presence of a mode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.experiment.identification.likelihood import Band, Fit, Modal, fit, residual_power, scatter

NORMAL_95 = 1.959964
"""Half the width of a 95 % interval of the normal distribution, in standard deviations."""
_DOUBTFUL = 50.0
_LINES = 3
_NEAR, _NEAREST, _BY_CHANCE = (1.5, 4.0), 2.0, 1e-3
"""Neighbourhood of a mode: half-widths, minimum lines per parameter, and probability of a false alarm."""
SAME = 0.1
"""Relative power difference below which inputs count as equal to transients."""


@dataclass(frozen=True, eq=False)
class Deviations:
    """Standard deviations of modes: `frequencies` (k,) for frequencies in Hz, `damping` (k,) for damping ratios.

    `shapes` (p, k) applies to the real part and to the imaginary part of shapes with largest component 1.
    """

    frequencies: Array
    damping: Array
    shapes: Array

    def widen(self, factors: Array) -> Deviations:
        """Multiply all standard deviations of each mode by the mode's factor (k,).

        >>> Deviations(np.ones(1), np.ones(1), np.ones((2, 1))).widen(np.array([3.0])).shapes.tolist()
        [[3.0], [3.0]]
        """
        return Deviations(self.frequencies * factors, self.damping * factors, self.shapes * factors)


def misfits(band: Band, modal: Modal) -> Array:
    """Compute the rms residual of the fit near each mode (k,), divided by the rms noise of the band; 1 if the residual is not significant.

    If the residual contains only noise, its level equals the noise everywhere, after correction for the degrees of freedom that the mode
    uses. Outputs whose noise is coherent count as one output. A residual is significant if noise causes it with a probability below 1/1000:
    the mode is then nonlinear, not viscously damped, or not isolated. Two neighbourhoods of a mode are tested: frequencies within 1.5 and
    within 4 half-widths. If a mode varies during the test or its excitation was not recorded, the residual is largest within 1.5
    half-widths.

    >>> from flexstage.experiment.example import one_mode_band
    >>> from flexstage.experiment.identification.likelihood import fit, noise
    >>> from dataclasses import replace
    >>> band, start = one_mode_band()
    >>> found = fit(band, start).modal
    >>> misfits(replace(band, variance=noise(band, found)), found).tolist()
    [1.0]
    """
    cells = band.cells
    root = np.sqrt(band.variance)
    left = residual_power(band, modal) / (root[:, None] * root)
    taken = 1.0 + (1.0 + cells.width) / len(left)
    result = np.ones(len(modal.poles))
    for mode, pole in enumerate(modal.poles):
        away = np.abs(cells.middle - pole.imag)
        order = np.argsort(away)
        lines = np.cumsum(cells.count[order])
        share = np.abs(modal.shapes[:, mode]) ** 2 / np.mean(band.variance, axis=1)
        share = share / np.sum(share)
        for reach in _NEAR:
            wide = int(np.searchsorted(away[order], reach * -pole.real, side="right"))
            number = min(len(order), max(wide, 1 + int(np.searchsorted(lines, _NEAREST * taken))))
            free = max(lines[number - 1] - taken, 1.0)
            near = np.sum(left[:, :, order[:number]], axis=2)
            ratio = float(share @ np.real(np.diagonal(near))) / free
            freedom = free / float(share @ _shared_noise(near, lines[number - 1]) @ share)
            if ratio > float(scipy.special.gammainccinv(freedom, _BY_CHANCE / len(_NEAR))) / freedom:
                result[mode] = max(result[mode], np.sqrt(ratio))
    return result


def _shared_noise(power: Array, lines: float) -> Array:
    """Squared coherence (p, p) of the output residuals, corrected for the bias by the number of lines (Bendat & Piersol, ch. 9)."""
    size = np.sqrt(np.maximum(np.real(np.diagonal(power)), 1e-300))
    by_chance = 1.0 / max(lines, 2.0)
    found = (np.minimum(np.abs(power) / np.outer(size, size), 1.0) ** 2 - by_chance) / (1.0 - by_chance)
    return np.where(np.eye(len(power), dtype=bool), 1.0, np.maximum(found, 0.0))


def deviations(found: Fit, inflation: float = 1.0, scatter: Array | None = None) -> Deviations:
    """Compute standard deviations of a fit by the Cramer-Rao bound: the covariance is I^-1, the inverse of the Fisher information.

    `inflation` multiplies the variances. `scatter` is the covariance S of the gradient. If it is given, the covariance of the parameters is
    I^-1 S I^-1, which is also valid for noise correlated between outputs (White 1982).

    The residual is analytic in its complex parameters, so real and imaginary parts each have half of the covariance. The common scale
    factor of a shape and its participation is arbitrary; fixing the largest participation eliminates it.

    >>> from flexstage.experiment.example import one_mode_band
    >>> from flexstage.experiment.identification.likelihood import fit
    >>> spread = deviations(fit(*one_mode_band()))
    >>> bool(spread.frequencies[0] < 0.005), bool(spread.damping[0] < 0.0005)
    (True, True)
    """
    covariance = inflation * _covariance(found, scatter)
    modal = found.modal
    count, outputs = len(modal.poles), len(modal.shapes)
    size = np.abs(modal.poles)
    ratio = -np.real(modal.poles) / size
    variance = 0.5 * np.maximum(np.real(np.diagonal(covariance)[:count]), 0.0)
    first = count + count * modal.participation.shape[1]
    shapes = np.empty((outputs, count))
    for mode in range(count):
        places = first + np.arange(outputs) * count + mode
        shapes[:, mode] = _shape_deviation(modal.shapes[:, mode], covariance[np.ix_(places, places)])
    return Deviations(np.sqrt(variance), np.sqrt(variance * (1.0 - ratio**2)) / size, shapes)


def significance(band: Band, found: Fit, limit: float) -> Array:
    """Compute the test statistic (k,) for each mode. Without the mode, it is chi-squared distributed with `freedoms` degrees of freedom.

    The test statistic is Wald's, 2 phi^H C^-1 phi, for the mode's shape phi with covariance C. If Wald's statistic is below fifty times
    `limit`, the likelihood ratio replaces it (Wilks 1938): twice the decrease of the log-likelihood when the mode is removed and the others
    are fitted again. A factor of at most 1 corrects the ratio for noise correlated between outputs (White 1982).

    >>> from flexstage.experiment.example import one_mode_band
    >>> band, start = one_mode_band()
    >>> bool(significance(band, fit(band, start), 50.0)[0] > 1000.0)
    True
    """
    covariance = _covariance(found)
    modal = found.modal
    count, outputs = len(modal.poles), len(modal.shapes)
    first = count + count * modal.participation.shape[1]
    strength, correlated = np.empty(count), None
    for mode in range(count):
        places = first + np.arange(outputs) * count + mode
        strength[mode] = _wald(modal.shapes[:, mode], covariance[np.ix_(places, places)])
        if strength[mode] < _DOUBTFUL * limit:
            correlated = _covariance(found, scatter(band, modal)) if correlated is None else correlated
            share = _wald(modal.shapes[:, mode], correlated[np.ix_(places, places)]) / max(strength[mode], 1e-300)
            fall = fit(band, modal.without(mode), found.cost + _DOUBTFUL * limit).cost - found.cost
            strength[mode] = 2.0 * fall * min(1.0, share)
    return strength


def drive_strength(band: Band, found: Fit, once_in: float) -> Array:
    """Compute the test statistic (k,) of each mode's excitation, divided by the level that noise exceeds with probability `once_in`.

    The test statistic is Wald's for the mode's participation in the inputs. The largest component of the mode's shape and the
    participations of transients are fixed. Transients count as inputs if the inputs cannot be distinguished from them near the mode, as for
    an impact at the start of a record. Two modes that can replace each other both fail the test. Modes of measured frequency responses,
    which contain no transients, are not tested: the result is infinite.

    >>> from flexstage.experiment.example import one_mode_band
    >>> from flexstage.experiment.identification.likelihood import fit
    >>> band, start = one_mode_band()
    >>> bool(drive_strength(band, fit(band, start), 1e-9)[0] > 100.0)
    True
    """
    modal = found.modal
    count, total = modal.participation.shape
    inputs = total if band.inputs is None else band.inputs
    if inputs == band.cells.width:
        return np.full(count, np.inf)
    largest = count * (1 + total) + np.argmax(np.abs(modal.shapes), axis=0) * count + np.arange(count)
    strength = np.empty(count)
    driving = [total if _is_blow(band, pole, inputs) else inputs for pole in modal.poles]
    for mode in range(count):
        transients = (count + np.arange(count)[:, None] * total + np.arange(driving[mode], total)).ravel()
        covariance = _inverse(found.information, np.append(largest, transients))
        places = count + mode * total + np.arange(driving[mode])
        wald = _wald(modal.participation[mode, : driving[mode]], covariance[np.ix_(places, places)])
        strength[mode] = wald / float(scipy.special.chdtri(2 * driving[mode], once_in))
    return strength


def _is_blow(band: Band, pole: complex, inputs: int) -> bool:
    """Whether the inputs near a pole equal transients, to a tenth of their power."""
    cells = band.cells
    if inputs == cells.width:
        return False
    order = np.argsort(np.abs(cells.middle - pole.imag))
    near = order[: 1 + int(np.searchsorted(np.cumsum(cells.count[order]), _LINES * cells.width))]
    gram = np.zeros((cells.width, cells.width), dtype=complex)
    for cell in near:
        columns = list(cells.columns[cells.block[cell]])
        gram[np.ix_(columns, columns)] += cells.own[cell, 0, :, 0, :]
    mixed = gram[:inputs, inputs:]
    alike = np.conj(mixed.T) @ np.linalg.pinv(gram[:inputs, :inputs], rcond=1e-10, hermitian=True) @ mixed
    return bool(np.real(np.trace(alike)) > (1.0 - SAME) * np.real(np.trace(gram[inputs:, inputs:])))


def freedoms(modal: Modal) -> int:
    """Count the real parameters of one mode: pole, shape and participation, without their common scale factor.

    >>> freedoms(Modal(np.zeros(1), np.zeros((1, 6)), np.zeros((6, 1))))
    24
    """
    return 2 * (len(modal.shapes) + modal.participation.shape[1])


def _covariance(found: Fit, scatter: Array | None = None) -> Array:
    """Inverse of the information with each mode's largest participation fixed; its rows and columns are zero."""
    count, total = found.modal.participation.shape
    largest = np.argmax(np.abs(found.modal.participation), axis=1)
    return _inverse(found.information, count + np.arange(count) * total + largest, scatter)


def _wald(values: Array, covariance: Array) -> float:
    """Wald's statistic of values against zero; zero if one of them is undetermined."""
    variances = np.real(np.diagonal(covariance))
    if np.any(variances <= 0.0):
        return 0.0
    scale = np.sqrt(variances)
    inverse = np.linalg.pinv(covariance / np.outer(scale, scale), rcond=1e-10, hermitian=True)
    return float(2.0 * np.real(np.vdot(values / scale, inverse @ (values / scale))))


def _inverse(information: Array, held: Array, scatter: Array | None = None) -> Array:
    free = np.setdiff1d(np.arange(len(information)), held)
    inner = information[np.ix_(free, free)]
    scale = 1.0 / np.sqrt(np.maximum(np.real(np.diagonal(inner)), 1e-300))
    inverse = np.linalg.pinv(inner * np.outer(scale, scale), rcond=1e-13, hermitian=True) * np.outer(scale, scale)
    if scatter is not None:
        inverse = inverse @ scatter[np.ix_(free, free)] @ inverse
    covariance = np.zeros_like(information)
    covariance[np.ix_(free, free)] = inverse
    return covariance


def _shape_deviation(shape: Array, covariance: Array) -> Array:
    """Deviations of shape / (its largest component), to first order."""
    largest = int(np.argmax(np.abs(shape)))
    turn = np.eye(len(shape), dtype=complex) / shape[largest]
    turn[:, largest] -= shape / shape[largest] ** 2
    return np.sqrt(np.maximum(0.5 * np.real(np.diagonal(turn @ covariance @ np.conj(turn.T))), 0.0))
