"""Modes from records, found without a hand: candidates by pLSCF, then maximum likelihood on the records' transforms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.readings.measured.adequacy import Reach, few_lines
from flexstage.readings.measured.bands import Extent, extents, sweeps
from flexstage.readings.measured.caution import warnings
from flexstage.readings.measured.cluster import Candidate, Stabilisation, alike, merged, stabilisation
from flexstage.readings.measured.confidence import Deviations, deviations, drive_strength, freedoms, significance
from flexstage.readings.measured.evidence import Evidence, chosen_segments, evidence, whole
from flexstage.readings.measured.identified import Identified
from flexstage.readings.measured.likelihood import Band, Fit, Modal, background, fit, noise, scatter, shaped, silence
from flexstage.readings.measured.lines import Cells, edges, gathered
from flexstage.readings.measured.lscf import lscf
from flexstage.readings.measured.record import Record, Responses
from flexstage.readings.measured.residues import modal_sum, remainder
from flexstage.readings.measured.spectra import Segments, Tell
from flexstage.readings.measured.unexplained import SURPRISING, excess, suggested

_ONCE_IN = 1e-9
_SURE, _EVIDENT = 1.0 / 3.0, 3.0
_LARGEST = 72
_LONGEST = 40
_ROUNDS = 2
_FEW = 5.0
_MOST_MODES = 24


@dataclass(frozen=True)
class Search:
    """What is searched for: modes with frequencies in `band` (Hz; absent: all the record can show), damped no more than `highest_damping`.

    `segments` are those of the spectra that candidates are taken from (absent: chosen by the record's length).
    """

    band: tuple[float, float] | None = None
    highest_damping: float = 0.1
    segments: Segments | None = None


@dataclass(frozen=True, eq=False)
class _Found:
    """The modes of one band, with deviations and significance, and the outputs' noise variance per line (p,)."""

    fit: Fit
    deviations: Deviations
    significance: Array
    noise: Array


def identify(what: Record | Responses | Sequence[Record], search: Search = Search(), tell: Tell | None = None) -> Identified:
    """Natural frequencies, damping, shapes and participations, with 95 % intervals, and whether they are there at all.

    `what` is a record, or several of the same stage (six with one actuator each are put together as one test), or responses of an analyser.
    Candidates are the stable poles of pLSCF on H1; each group of near ones is then fitted by maximum likelihood to the transform of the
    whole record, its transient included, so that there is neither window nor leakage: inputs are taken as exact, outputs' noise as of
    slowly varying density; intervals hold for noise correlated between outputs too (Pintelon & Schoukens 2012, ch. 9 and 10). A mode is
    kept if leaving it out costs more likelihood than noise would once in 1e9, thrice that where its damping is not known to a third.
    Linear, time-invariant stages. Raises `DesignError` for inputs that are not independent, no outputs, records that do not fit together or
    are too short.

    >>> from flexstage.readings.measured.example import one_mode_record
    >>> found = identify(one_mode_record())
    >>> found.frequencies.round(1).tolist(), found.damping.round(3).tolist()
    ([10.0], [0.02])
    """
    found = _identified(what, search, tell)
    if len(found.frequencies) or search.segments is not None or isinstance(what, Responses):
        return found
    # Resonances sharper than the segments resolve leave no stable pole, and a blow falls into the first of them alone: look once more.
    records = [what] if isinstance(what, Record) else list(what)
    longer = chosen_segments(records, _FEW) if len(found.inputs) > 1 else whole(records)
    again = _identified(what, replace(search, segments=longer), tell)
    return again if len(again.frequencies) else found


def _identified(what: Record | Responses | Sequence[Record], search: Search, tell: Tell | None) -> Identified:
    known = evidence(what, search.segments, tell)
    band = _band(known, search)
    diagrams, candidates, reach = _candidates(known, band, search)
    found = _fitted(known, candidates, band, search)
    return _result(known, band, diagrams, found, reach)


def _band(known: Evidence, search: Search) -> tuple[float, float]:
    low, high = known.band
    if search.band is None:
        return low, high
    asked = search.band
    if asked[0] < asked[1] and asked[0] < high and asked[1] > low:
        chosen = max(low, asked[0]), min(high, asked[1])
        lines = known.responses.frequencies
        require(few_lines(known, chosen, int(np.sum((lines >= chosen[0]) & (lines <= chosen[1])))))
        return chosen
    what = f"modes between {asked[0]:g} and {asked[1]:g} Hz are asked for; the data reach from {low:.4g} to {high:.4g} Hz"
    require([Finding(known.where, what, "Ask for a band within, or record faster or longer")])
    return low, high


def _candidates(
    known: Evidence, band: tuple[float, float], search: Search
) -> tuple[tuple[Stabilisation, ...], tuple[Candidate, ...], Reach]:
    """Candidates, and the band that was searched: where lines are few, no polynomial can be fitted to them."""
    low, high = 0.0, 0.0
    diagrams: list[Stabilisation] = []
    candidates: list[tuple[Candidate, ...]] = []
    inputs = known.responses.values.shape[2]
    for sweep in sweeps(*band):
        inside = (known.responses.frequencies >= sweep.low) & (known.responses.frequencies <= sweep.high)
        highest = min(_LONGEST, max(3, _LARGEST // inputs), int(np.sum(inside)) // (2 + 2 * inputs))
        if highest < 2:
            continue
        low, high = low or sweep.first, sweep.last
        lowest = max(1, highest // 4)
        orders = range(lowest, highest + 1, max(1, (highest - lowest) // 10))
        values, weights = known.responses.values[inside], known.weights[inside]
        diagram, found = stabilisation(lscf(known.responses.frequencies[inside], values, weights, orders), search.highest_damping)
        diagrams.append(diagram)
        candidates.append(tuple(each for each in found if sweep.first + each.pole.real <= each.pole.imag <= sweep.last - each.pole.real))
    return tuple(diagrams), merged(candidates), Reach(low, high, search.band)


def _fitted(known: Evidence, candidates: tuple[Candidate, ...], band: tuple[float, float], search: Search) -> list[_Found]:
    if not candidates:
        return []
    poles = np.array([candidate.pole for candidate in candidates])
    groups = extents(poles, *band, resolution=known.resolution)
    bounds = [edges(poles, group.low, group.high) for group in groups]
    every = gathered(known.lines(), bounds)
    return [
        found for group, cells in zip(groups, every, strict=True) if (found := _group(known, cells, candidates, group, search)) is not None
    ]


def _group(known: Evidence, cells: Cells, candidates: tuple[Candidate, ...], group: Extent, search: Search) -> _Found | None:
    """The modes of one group of candidates: fitted, freed of what is not significant, fitted anew with the noise that is left."""
    poles = np.array([candidate.pole for candidate in candidates])
    members = list(group.members)
    outside = np.concatenate([np.delete(poles, members), np.conj(poles)])
    shape = known.shape(cells)
    variance = known.variance(group.low, group.high)[:, None] * shape / np.median(shape, axis=1, keepdims=True)
    variance = np.maximum(variance, silence(cells, known.rounding))
    band = Band(cells, variance, background(cells, outside), known.smear, shape, known.rounding, len(known.input_scale))
    if np.sum(cells.count) < 2 * cells.own.shape[2] * band.background.shape[1]:
        return None
    participation = np.array([candidates[index].participation for index in members])
    found, strength = _pruned(band, fit(band, shaped(band, poles[members], participation)), group, search)
    for _ in range(_ROUNDS):
        band = replace(band, variance=noise(band, found.modal))
        found, strength = _pruned(band, fit(band, found.modal), group, search)
        band, found, strength = _extended(band, (found, strength), group, search)
    if not len(found.modal.poles):
        return None
    return _Found(
        found,
        deviations(found, known.inflation, scatter(band, found.modal)),
        strength / _limit(found.modal),
        np.mean(band.variance, axis=1),
    )


def _limit(modal: Modal) -> float:
    from scipy.stats import chi2

    return float(chi2.isf(_ONCE_IN, freedoms(modal)))


def _undriven(band: Band, modal: Modal) -> float:
    from scipy.stats import chi2

    return float(chi2.isf(_ONCE_IN, 2 * (modal.participation.shape[1] if band.inputs is None else band.inputs)))


def _pruned(band: Band, found: Fit, group: Extent, search: Search) -> tuple[Fit, Array]:
    """Leave out, one at a time and the least significant first, what is no mode; and the significance of the modes left."""
    while len(found.modal.poles):
        worst, strength = _worst(band, found, group, search)
        if worst is None:
            return found, strength
        found = fit(band, found.modal.without(worst))
    return found, np.zeros(0)


def _extended(band: Band, known: tuple[Fit, Array], group: Extent, search: Search) -> tuple[Band, Fit, Array]:
    """Add modes, one at a time, where the data hold more than those found explain, as long as that is significant."""
    found, strength = known
    while len(found.modal.poles) < _MOST_MODES:
        score = excess(band, found.modal)
        place = int(np.argmax(score))
        if score[place] < SURPRISING:
            break
        more, grown = _pruned(band, fit(band, suggested(band, found.modal, place)), group, search)
        if len(more.modal.poles) <= len(found.modal.poles) or more.cost > found.cost:
            break
        found, strength = more, grown
        band = replace(band, variance=noise(band, found.modal))
    return band, found, strength


def _worst(band: Band, found: Fit, group: Extent, search: Search) -> tuple[int | None, Array]:
    """The mode that is least one, if there is such, and how significant each is."""
    poles, limit = found.modal.poles, _limit(found.modal)
    ratio = -np.real(poles) / np.abs(poles)
    spread = deviations(found)
    outside = (ratio > search.highest_damping) | (np.imag(poles) < group.low) | (np.imag(poles) > group.high)
    if np.any(outside):
        return int(np.argmax(np.where(outside, spread.damping / ratio, -1.0))), np.zeros(len(poles))
    strength = np.where(_doubles(found.modal), 0.0, significance(band, found, limit))
    strength = np.minimum(strength, limit / _undriven(band, found.modal) * drive_strength(band, found))
    wanted = np.where(spread.damping > _SURE * ratio, _EVIDENT * limit, limit)
    least = int(np.argmin(strength / wanted))
    return (least if strength[least] < wanted[least] else None), strength


def _doubles(modal: Modal) -> Array:
    """Modes that repeat another one: same pole within a tenth of its half-width, same shape and participation; the weaker of both."""
    size = np.linalg.norm(modal.shapes, axis=0) * np.linalg.norm(modal.participation, axis=1)
    found = np.zeros(len(size), dtype=bool)
    for first in range(len(size)):
        for second in range(first):
            near = abs(modal.poles[first] - modal.poles[second]) < -0.1 * modal.poles[first].real
            same = alike(modal.shapes[:, first], modal.shapes[:, second]) > 0.98
            if near and same and alike(modal.participation[first], modal.participation[second]) > 0.98:
                found[first if size[first] < size[second] else second] = True
    return found


def _result(
    known: Evidence, band: tuple[float, float], diagrams: tuple[Stabilisation, ...], found: list[_Found], reach: Reach
) -> Identified:
    inputs, outputs = len(known.input_scale), len(known.output_scale)
    modal = _joined([part.fit.modal for part in found], inputs, outputs)
    spread = [np.concatenate([getattr(part.deviations, name) for part in found] or [np.zeros(0)]) for name in ("frequencies", "damping")]
    wide = np.concatenate([part.deviations.shapes for part in found] or [np.zeros((outputs, 0))], axis=1)
    strength = np.concatenate([part.significance for part in found] or [np.zeros(0)])
    order = np.argsort(np.abs(modal.poles))
    poles, (shapes, participation, wide) = modal.poles[order], _in_units(known, modal, wide, order)
    inside = (known.responses.frequencies >= band[0]) & (known.responses.frequencies <= band[1])
    lines = known.responses.frequencies[inside]
    rest = known.responses.values[inside] - modal_sum(lines, 2.0 * np.pi * poles, shapes, participation)
    close = _close(poles)
    return Identified(
        frequencies=np.abs(poles),
        damping=-np.real(poles) / np.abs(poles),
        shapes=shapes,
        participation=participation,
        frequency_deviations=spread[0][order],
        damping_deviations=spread[1][order],
        shape_deviations=wide,
        significance=strength[order],
        outputs=known.responses.outputs,
        inputs=known.responses.inputs,
        close=close,
        residuals=remainder(lines, rest, known.weights[inside]),
        responses=known.responses,
        stabilisation=diagrams,
        band=band,
        noise=np.median(known.density[inside], axis=0) * 2.0 / known.rate,
        warnings=warnings(known, poles, close, reach),
        provenance=f"identified from {known.where}: pLSCF, then maximum likelihood",
    )


def _joined(parts: list[Modal], inputs: int, outputs: int) -> Modal:
    return Modal(
        np.concatenate([part.poles for part in parts] or [np.zeros(0, dtype=complex)]),
        np.concatenate([part.participation[:, :inputs] for part in parts] or [np.zeros((0, inputs), dtype=complex)]),
        np.concatenate([part.shapes for part in parts] or [np.zeros((outputs, 0), dtype=complex)], axis=1),
    )


def _in_units(known: Evidence, modal: Modal, wide: Array, order: Array) -> tuple[Array, Array, Array]:
    """Shapes (largest component 1), participations in rad/s and units of the channels, deviations of the shapes."""
    shapes = modal.shapes * known.output_scale[:, None]
    if not shapes.shape[1]:
        return shapes, modal.participation / known.input_scale, wide
    scaled = np.argmax(np.abs(modal.shapes), axis=0)
    every = np.arange(shapes.shape[1])
    relative = shapes / shapes[scaled, every]
    wide = wide * (known.output_scale[:, None] / known.output_scale[scaled])
    largest = np.argmax(np.abs(relative), axis=0)
    turn = relative[largest, every]
    participation = 2.0 * np.pi * modal.participation / known.input_scale * (shapes[scaled, every] * turn)[:, None]
    return (relative / turn)[:, order], participation[order], (wide / np.abs(turn))[:, order]


def _close(poles: Array) -> tuple[tuple[int, ...], ...]:
    """Modes nearer to the next than the mean of their half-widths, in groups."""
    groups: list[list[int]] = []
    for index in range(len(poles)):
        before = groups[-1][-1] if groups else None
        if before is not None and abs(poles[index].imag - poles[before].imag) < -0.5 * (poles[index] + poles[before]).real:
            groups[-1].append(index)
        else:
            groups.append([index])
    return tuple(tuple(group) for group in groups if len(group) > 1)
