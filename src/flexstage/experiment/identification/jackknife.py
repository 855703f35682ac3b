"""How far modes move as parts of the data are left out: deviations that hold where the model does not."""

from __future__ import annotations

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.likelihood import Band, Modal, shares

_SINGULAR = 1e-9
_OCTAVES = 6


def jackknife(band: Band, modal: Modal, groups: Array) -> Array:
    """Deviations (k,) of poles in Hz, of real and of imaginary part, from leaving out one group of cells after the other.

    sigma^2 = (G - 1)/G sum |d_g|^2 / 2, with d_g the pole's move without group g by a Newton step, -(I - I_g)^-1 s_g, where I_g and s_g
    are the group's share of information and gradient (Tukey 1958; CR3 of Bell & McCaffrey 2002). It asks only that groups err
    independently of one another: however what the fit leaves is correlated within a group, it counts once. Few groups say little about
    their scatter: sigma is multiplied by Student's t over the normal's 1.96, with 2 (sum |d|^2)^2 / sum |d|^4 degrees of freedom
    (Satterthwaite 1946), at most 2 (G - 1), so that 1.96 sigma is half of a 95 % interval. An error that moves the answers of all groups
    alike is not seen.

    `groups` (c,) are the numbers of each cell's group, from 0 on.

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
    """Groups (c,) of cells: those within a half-width of a pole, and on each side each octave of distance from there on.

    What a wrong model leaves near a resonance changes over its half-width, and further away over the distance.

    >>> from flexstage.experiment.example import POLE, one_mode_band
    >>> sub_bands(one_mode_band()[0], POLE).tolist()
    [7, 7, 5, 3, 1, 0, 0, 0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 9, 9]
    """
    away = (band.cells.middle - pole.imag) / -pole.real
    octave = np.clip(np.floor(np.log2(np.maximum(np.abs(away), 0.5))) + 1.0, 0.0, _OCTAVES)
    return np.unique(2.0 * octave - ((away < 0.0) & (octave > 0.0)), return_inverse=True)[1]
