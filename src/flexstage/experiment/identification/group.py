"""Modes of one group of candidates: joint fit, removal of insignificant modes, addition of further significant modes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.experiment.identification.bands import Extent
from flexstage.experiment.identification.cluster import Candidate, vector_assurance
from flexstage.experiment.identification.confidence import Deviations, deviations, drive_strength, freedoms, misfits, significance
from flexstage.experiment.identification.diagnosis.unexplained import SURPRISING, excess, suggest_mode
from flexstage.experiment.identification.evidence import Evidence
from flexstage.experiment.identification.jackknife import jackknife, sub_bands
from flexstage.experiment.identification.likelihood import Band, Fit, Modal, background, fit, noise, scatter, silence, with_shapes
from flexstage.experiment.spectral.lines import Cells

ONCE_IN = 1e-9
"""Probability of a false mode caused by noise."""
_SURE, _EVIDENT = 1.0 / 3.0, 3.0
_ROUNDS = 2
_NOTICED, _DOUBTED, _SLIGHT = 2.0, 1e-4, 1.1
_MOST_MODES = 24


@dataclass(frozen=True, eq=False)
class RejectedResonance:
    """Rejected resonance: its `pole` in Hz, its `shape` (p,), and the probability `chance` that noise causes a resonance this strong."""

    pole: complex
    shape: Array
    chance: float


@dataclass(frozen=True, eq=False)
class ModeSearch:
    """Search parameters: the band `group`, the maximum damping ratio, and the list `lost`, to which rejected resonances are added."""

    group: Extent
    highest_damping: float
    lost: list[RejectedResonance]


@dataclass(frozen=True, eq=False)
class BandModes:
    """Identified modes of the band of one `group`, with their standard deviations caused by noise, and their significance.

    `misfit` (k,) is the rms residual near each mode, divided by the rms noise (see `misfits`). `widening` (k,) is the inflation factor of
    the standard deviations; it follows from `misfit`.
    """

    group: Extent
    band: Band
    modal: Modal
    deviations: Deviations
    significance: Array
    misfit: Array
    widening: Array


def fit_group(known: Evidence, cells: Cells, candidates: tuple[Candidate, ...], hunt: ModeSearch) -> BandModes | None:
    """Fit the modes of one group of candidates, remove insignificant ones, and fit again with the noise variance found in the residual.

    `cells` belong to the group's band. Candidates outside the group represent the modes outside the band. Returns `None` if no mode is
    significant.

    >>> from flexstage.experiment.identification.evidence import evidence
    >>> from flexstage.experiment.example import POLE, one_mode_record
    >>> from flexstage.experiment.spectral.lines import edges, gather_cells
    >>> known, pole = evidence(one_mode_record(), None), 1.01 * POLE
    >>> [cells] = gather_cells(known.lines(), [edges(np.array([pole]), 6.0, 14.0)])
    >>> found = fit_group(known, cells, (Candidate(pole, np.ones(1), 3),), ModeSearch(Extent(6.0, 14.0, (0,)), 0.1, []))
    >>> None if found is None else abs(found.modal.poles).round(1).tolist()
    [10.0]
    """
    group, members = hunt.group, list(hunt.group.members)
    poles = np.array([candidate.pole for candidate in candidates])
    band = _band(known, cells, candidates, group)
    if np.sum(cells.count) < 2 * cells.own.shape[2] * band.background.shape[1]:
        return None
    participation = np.array([candidates[index].participation for index in members])
    found, strength = _prune(band, fit(band, with_shapes(band, poles[members], participation)), hunt)
    for _ in range(_ROUNDS):
        band = replace(band, variance=noise(band, found.modal))
        found, strength = _prune(band, fit(band, found.modal), hunt)
        band, found, strength = _extend(band, found, strength, hunt)
    if not len(found.modal.poles):
        return None
    beyond = misfits(band, found.modal)
    spread = deviations(found, known.inflation, scatter(band, found.modal))
    every = BandModes(
        group, band, found.modal, spread, strength / _limit(found.modal), beyond, np.maximum(beyond, _hidden_mode_factor(band, found))
    )
    return replace(every, widening=_widening(every, band, found.modal))


def _hidden_mode_factor(band: Band, found: Fit) -> Array:
    """Factor (k,) on deviations for a possible further mode of lower significance than required for identification.

    Such a mode has a false-alarm rate of 1/10,000 instead of 1e-9. If present, it shifts the modes next to it. The deviations are the root
    of the sum of squares of the shift and the deviations with it (as for model averaging, Burnham & Anderson 2002, ch. 4, with the larger
    model assumed correct).
    """
    modal, score = found.modal, excess(band, found.modal)
    place = int(np.argmax(score))
    if score[place] < _NOTICED:
        return np.ones(len(modal.poles))
    enough = found.cost - 0.5 * float(scipy.special.chdtri(freedoms(modal), _DOUBTED / len(score)))
    more = fit(band, suggest_mode(band, modal, place), enough)
    if more.cost > enough:
        return np.ones(len(modal.poles))
    same = [int(np.argmin(np.abs(more.modal.poles - pole))) for pole in modal.poles]
    moves = np.abs(more.modal.poles[same] - modal.poles)
    before, after = deviations(found).frequencies, deviations(more).frequencies[same]
    factors = np.sqrt(after**2 + moves**2) / np.maximum(before, 1e-300)
    return np.where(factors > _SLIGHT, factors, 1.0)


def widen_by_parts(known: Evidence, cells: Cells, candidates: tuple[Candidate, ...], found: BandModes) -> BandModes:
    """If the residual exceeds noise, increase the inflation factors so that they include differences of modes between parts of the record.

    `cells` belong to the same band, but are computed from transforms of the record's parts. A mode that depends on amplitude or time
    differs between parts.
    """
    modal = found.modal
    band = _band(known, cells, candidates, found.group)
    free = np.zeros((len(modal.poles), cells.width - found.band.cells.width), dtype=complex)
    start = Modal(modal.poles, np.concatenate([modal.participation, free], axis=1), modal.shapes)
    band = replace(band, variance=noise(band, start))
    return replace(found, widening=_widening(found, band, fit(band, start).modal))


def _band(known: Evidence, cells: Cells, candidates: tuple[Candidate, ...], group: Extent) -> Band:
    poles = np.array([candidate.pole for candidate in candidates])
    outside = np.concatenate([np.delete(poles, list(group.members)), np.conj(poles)])
    shape = known.shape(cells)
    variance = known.variance(group.low, group.high)[:, None] * shape / np.median(shape, axis=1, keepdims=True)
    variance = np.maximum(variance, silence(cells, known.rounding))
    return Band(cells, variance, background(cells, outside), known.smear, shape, known.rounding, len(known.input_scale))


def _widening(found: BandModes, band: Band, modal: Modal) -> Array:
    """Inflation factor (k,) on noise deviations, for modes with a residual above noise.

    The largest of the residual excess, the scatter between sub-bands, and the scatter between blocks: inputs, records, or parts of records.
    """
    factors = found.widening.copy()
    noise_alone = np.maximum(found.deviations.frequencies, 1e-300)
    for mode in np.flatnonzero(found.misfit > 1.0):
        divisions = [sub_bands(band, modal.poles[mode]), band.cells.block]
        scattered = [jackknife(band, modal, each)[mode] for each in divisions if np.max(each) > 0]
        factors[mode] = max([factors[mode], *(float(each / noise_alone[mode]) for each in scattered)])
    return factors


def _limit(modal: Modal) -> float:
    return float(scipy.special.chdtri(freedoms(modal), ONCE_IN))


def _prune(band: Band, found: Fit, hunt: ModeSearch) -> tuple[Fit, Array]:
    """Remove insignificant modes one at a time, least significant first; returns the significance of the others."""
    while len(found.modal.poles):
        worst, strength = _least_significant(band, found, hunt)
        if worst is None:
            return found, strength
        chance = float(scipy.special.chdtrc(freedoms(found.modal), strength[worst]))
        hunt.lost.append(RejectedResonance(complex(found.modal.poles[worst]), found.modal.shapes[:, worst], chance))
        found = fit(band, found.modal.without(worst))
    return found, np.zeros(0)


def _extend(band: Band, found: Fit, strength: Array, hunt: ModeSearch) -> tuple[Band, Fit, Array]:
    """Add modes one at a time while the unexplained data are significant."""
    while len(found.modal.poles) < _MOST_MODES:
        score = excess(band, found.modal)
        place = int(np.argmax(score))
        if score[place] < SURPRISING:
            break
        more, grown = _prune(band, fit(band, suggest_mode(band, found.modal, place)), hunt)
        if len(more.modal.poles) <= len(found.modal.poles) or more.cost > found.cost:
            break
        found, strength = more, grown
        band = replace(band, variance=noise(band, found.modal))
    return band, found, strength


def _least_significant(band: Band, found: Fit, hunt: ModeSearch) -> tuple[int | None, Array]:
    """Least significant mode, if rejected, and the significance of each."""
    poles, limit = found.modal.poles, _limit(found.modal)
    ratio = -np.real(poles) / np.abs(poles)
    spread = deviations(found)
    outside = (ratio > hunt.highest_damping) | (np.imag(poles) < hunt.group.low) | (np.imag(poles) > hunt.group.high)
    if np.any(outside):
        return int(np.argmax(np.where(outside, spread.damping / ratio, -1.0))), np.zeros(len(poles))
    strength = np.where(_find_doubles(found.modal), 0.0, significance(band, found, limit))
    strength = np.minimum(strength, limit * drive_strength(band, found, ONCE_IN))
    wanted = np.where(spread.damping > _SURE * ratio, _EVIDENT * limit, limit)
    least = int(np.argmin(strength / wanted))
    return (least if strength[least] < wanted[least] else None), strength


def _find_doubles(modal: Modal) -> Array:
    """Duplicates of other modes: same pole within a tenth of its half-width, same shape and participation; the weaker of both."""
    size = np.linalg.norm(modal.shapes, axis=0) * np.linalg.norm(modal.participation, axis=1)
    found = np.zeros(len(size), dtype=bool)
    for first in range(len(size)):
        for second in range(first):
            near = abs(modal.poles[first] - modal.poles[second]) < -0.1 * modal.poles[first].real
            same = vector_assurance(modal.shapes[:, first], modal.shapes[:, second]) > 0.98
            if near and same and vector_assurance(modal.participation[first], modal.participation[second]) > 0.98:
                found[first if size[first] < size[second] else second] = True
    return found
