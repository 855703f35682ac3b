"""Data not explained by the identified modes: excess of the residual by frequency, and a further mode that explains it."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.identification.likelihood import Band, Modal, explained_share, with_shapes

SURPRISING = 8.0
"""Smallest significant excess of the residual, in standard deviations."""
_TERMS = 2
_WIDTHS = 1.0


def excess(band: Band, modal: Modal) -> Array:
    """Compute the excess of the residual chi-squared in each cell (c,), in standard deviations.

    In every cell, responses linear in frequency are fitted to the residual. If the residual contains only noise, the explained power
    divided by the noise variance has a mean and a variance equal to the number of complex parameters.

    >>> from flexstage.experiment.example import one_mode_band
    >>> from flexstage.experiment.identification.likelihood import fit
    >>> band, start = one_mode_band()
    >>> bool(np.max(excess(band, fit(band, start).modal)) < SURPRISING < np.max(excess(band, start)))
    True
    """
    cells = band.cells
    found = np.zeros(len(cells.low))
    for chosen, inside in explained_share(band, modal):
        own, rest = _residual_sums(band, chosen, inside)
        solved = _solve(own, rest)
        power = np.real(np.einsum("cno,cno->oc", np.conj(rest), solved)) / band.variance[:, chosen]
        count = np.minimum(own.shape[1], cells.count[chosen]) * len(power)
        found[chosen] = (np.sum(power, axis=0) - count) / np.sqrt(count)
    return found


def suggest_mode(band: Band, modal: Modal, cell: int) -> Modal:
    """Add a mode to `modal` at the middle of cell number `cell`; its participation is the strongest in the cell's residual.

    >>> from flexstage.experiment.example import one_mode_band
    >>> band, start = one_mode_band()
    >>> len(suggest_mode(band, start, 0).poles)
    2
    """
    chosen, inside = next(each for each in explained_share(band, modal) if cell in each[0])
    own, rest = _residual_sums(band, chosen, inside)
    place = int(np.flatnonzero(chosen == cell)[0])
    columns = list(band.cells.columns[band.cells.block[cell]])
    local = _solve(own, rest)[place, : len(columns)] / np.sqrt(band.variance[:, cell])
    participation = np.zeros((len(modal.poles) + 1, band.cells.width), dtype=complex)
    participation[:-1] = modal.participation
    participation[-1, columns] = np.linalg.svd(local)[0][:, 0]
    middle = band.cells.middle[cell]
    widths = -np.real(modal.poles) / np.abs(modal.poles)
    width = float(np.median(widths)) * middle if len(widths) else band.cells.high[cell] - band.cells.low[cell]
    return with_shapes(band, np.append(modal.poles, -_WIDTHS * width + 1j * middle), participation)


def _residual_sums(band: Band, chosen: Array, inside: Array) -> tuple[Array, Array]:
    """Gram matrices (c, q, q) of the lowest two polynomials times the drive, and their products (c, q, p) with the residual."""
    cells = band.cells
    own, cross = cells.own[chosen], cells.cross[chosen]
    rest = cross - np.einsum("canbm,ocbm->cano", own, inside, optimize=True)
    size = _TERMS * own.shape[2]
    return own[:, :_TERMS, :, :_TERMS, :].reshape(len(own), size, size), rest[:, :_TERMS].reshape(len(own), size, -1)


def _solve(own: Array, rest: Array) -> Array:
    return np.linalg.pinv(own, rcond=1e-9, hermitian=True) @ rest
