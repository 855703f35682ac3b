"""Jackknife standard deviations of modes, from omission of parts of the data; they are valid even if the model is wrong."""

from __future__ import annotations

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.likelihood import Band, Modal, shares

_SINGULAR = 1e-9
_OCTAVES = 6


def jackknife(band: Band, modal: Modal, groups: Array) -> Array:
    """Compute standard deviations (k,) in Hz of real and imaginary parts of poles, by omitting one group of cells at a time.

    `groups` (c,) are the group numbers of the cells, from 0 to G - 1. Without group g, a pole changes by d_g. The variance sigma^2 is (1 -
    1/G)/2 times the sum of |d_g|^2 over the groups. The changes d_g are Newton steps -(I - I_g)^-1 s_g with the Fisher information I of all
    cells. I_g and s_g are the contributions of group g to the information and to the gradient of the log-likelihood (Tukey 1958; CR3 of
    Bell & McCaffrey 2002).

    Errors of different groups must be independent; errors within a group may be correlated. An error common to all groups is not detected.
    For few groups, sigma is multiplied by the 97.5 % quantile of Student's t divided by 1.96, so that 1.96 sigma is half of a 95 %
    interval. The degrees of freedom of t are 2 (sum |d_g|^2)^2 / sum |d_g|^4 (Satterthwaite 1946), at most 2 (G - 1).

    >>> from flexstage.experiment.identification.confidence import deviations
    >>> from flexstage.experiment.example import one_mode_band
    >>> from flexstage.experiment.identification.likelihood import fit
    >>> band, start = one_mode_band()
    >>> found = fit(band, start)
    >>> wide = jackknife(band, found.modal, sub_bands(band, found.modal.poles[0]))
    >>> bool(0.5 < wide[0] / deviations(found).frequencies[0] < 3.0)
    True
    """
    gradient, information = shares(band, modal, groups)
    count, total = modal.participation.shape
    held = count + np.arange(count) * total + np.argmax(np.abs(modal.participation), axis=1)
    free = np.setdiff1d(np.arange(gradient.shape[1]), held)
    inner = information[:, free[:, None], free]
    whole = np.sum(inner, axis=0)
    scale = 1.0 / np.sqrt(np.maximum(np.real(np.diagonal(whole)), 1e-300))
    rest = np.linalg.pinv((whole - inner) * np.outer(scale, scale), rcond=_SINGULAR, hermitian=True)
    moves = (rest @ (gradient[:, free] * scale)[:, :, None])[:, :count, 0] * scale[:count]
    power, size = np.abs(moves) ** 2, len(moves)
    freedom = np.sum(power, axis=0) ** 2 / np.maximum(np.sum(power**2, axis=0), 1e-300)
    quantile = -scipy.special.stdtrit(2.0 * np.clip(freedom, 1.0, max(size - 1.0, 1.0)), 0.025)
    return np.sqrt((size - 1.0) / size * np.sum(power, axis=0) / 2.0) * quantile / NORMAL_95


def sub_bands(band: Band, pole: complex) -> Array:
    """Divide the cells into groups (c,) by distance from a pole, for `jackknife`.

    One group is within a half-width of the pole. On each side, each further octave of distance from the pole is a group. Near the
    resonance, the residual of a wrong model changes within a half-width. Farther away, it changes within a frequency range as wide as the
    distance from the resonance.

    >>> from flexstage.experiment.example import POLE, one_mode_band
    >>> sub_bands(one_mode_band()[0], POLE).tolist()
    [7, 7, 5, 3, 1, 0, 0, 0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 9, 9]
    """
    away = (band.cells.middle - pole.imag) / -pole.real
    octave = np.clip(np.floor(np.log2(np.maximum(np.abs(away), 0.5))) + 1.0, 0.0, _OCTAVES)
    return np.unique(2.0 * octave - ((away < 0.0) & (octave > 0.0)), return_inverse=True)[1]
