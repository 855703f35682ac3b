"""Automatic modal identification from records: candidates by pLSCF, then maximum likelihood on the records' transforms."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import refuse, require
from flexstage.base.number import Array
from flexstage.experiment.identification.bands import TOGETHER, extents, sweeps
from flexstage.experiment.identification.cluster import Candidate, Stabilisation, merge, stabilisation
from flexstage.experiment.identification.diagnosis.adequacy import Reach, few_lines
from flexstage.experiment.identification.diagnosis.data_warnings import data_warnings
from flexstage.experiment.identification.diagnosis.driven import Drive, measure_drives
from flexstage.experiment.identification.diagnosis.lateness import bends_modes, common_delay, late_channels, take_out_delay
from flexstage.experiment.identification.diagnosis.peaks import peaks
from flexstage.experiment.identification.evidence import Evidence, choose_segments, evidence, whole_segment
from flexstage.experiment.identification.excitation import Excitation
from flexstage.experiment.identification.group import ONCE_IN, BandModes, ModeSearch, RejectedResonance, fit_group, widen_by_parts
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.likelihood import Modal
from flexstage.experiment.identification.lscf import lscf
from flexstage.experiment.identification.residues import modal_sum, remainder
from flexstage.experiment.records.record import Record, Responses
from flexstage.experiment.spectral.cross_spectra import Segments, Spectra
from flexstage.experiment.spectral.lines import edges, gather_cells, in_band

_LARGEST = 72
_LONGEST = 40
_PASSES = 2
_FEW = 5.0
_UNRECORDED = 0.02
_LEAST_PARTS, _MOST_PARTS = 3, 8


@dataclass(frozen=True)
class Search(CheckedFields):
    """Search parameters: frequencies in `band` (Hz; default: the whole range of the record), damping ratios up to `highest_damping`.

    `segments` defines the segments of the spectra in which candidate modes are sought (default: chosen from the record's length).
    `excitation` is the type of excitation of the stage; if the excitation is not recorded, the function `identification` uses the outputs
    only.
    """

    band: tuple[float, float] | None = None
    highest_damping: float = 0.1
    segments: Segments | None = None
    excitation: Excitation = Excitation.RECORDED


@check_arguments
def identify(what: Record | Responses | Sequence[Record], search: Search = Search(), known: Sequence[Spectra] = ()) -> Identified:
    """Identify natural frequencies, damping, shapes and participations, with 95 % intervals and significance.

    `what` is a record, several records of one stage (for example six with one driven actuator each), or an analyser's responses. If `known`
    contains the spectra of all records, they are not computed again. Tones absent from the inputs are removed from the outputs.

    Candidates are the stable poles that the pLSCF method finds in the H1 estimate of the responses. Each group of close candidates is then
    fitted by maximum likelihood to the transform of the whole record. The fit includes the transient and needs no window, so that it has no
    leakage. Inputs are assumed to be exact. The noise density of outputs must vary slowly with frequency. Intervals are also valid for
    noise correlated between outputs (Pintelon & Schoukens 2012, ch. 9 and 10).

    The intervals of a mode are inflated if its residual is significant: noise alone would cause the residual near the mode with a
    probability below 1/1000. The inflation factor is proportional to the residual or to the scatter between independent parts of the data
    (`jackknife`), whichever is larger. Independent parts are sub-bands, inputs, records and time intervals.

    A mode must be significant: the probability that noise alone reaches the mode's chi-squared statistic is at most 1e-9. The required
    chi-squared is three times higher if the standard deviation of the damping exceeds a third of the damping. The recorded inputs must also
    excite the mode (F-test with a false-alarm rate of 1e-9). If the inputs leave more than 2 % of a mode's motion unexplained, an
    unrecorded force is assumed, and all modes are fitted together.

    >>> from flexstage.experiment.example import one_mode_record
    >>> found = identify(one_mode_record())
    >>> found.frequencies.round(1).tolist(), found.damping.round(3).tolist()
    ([10.0], [0.02])
    """
    seen = evidence(what, search.segments, known)
    found = _identify_once(seen, search)
    if len(found.frequencies) or search.segments is not None or isinstance(what, Responses):
        return _with_doubts(_without_delay(seen, search, found))
    # Resonances sharper than the segment resolution, and impacts, leave no stable pole: search again.
    records = [what] if isinstance(what, Record) else list(what)
    longer = choose_segments(records, _FEW) if len(found.inputs) > 1 else whole_segment(records)
    seen = evidence(what, longer)
    again = _identify_once(seen, replace(search, segments=longer))
    return _with_doubts(_without_delay(seen, search, again)) if len(again.frequencies) else found


def _with_doubts(found: Identified) -> Identified:
    """Result with a warning for every channel with more delay than the others."""
    late = tuple(late_channels(found))
    return replace(found, data_warnings=(*found.data_warnings, *late)) if late else found


def _without_delay(known: Evidence, search: Search, found: Identified) -> Identified:
    """Modes after correction of a significant common delay of all outputs."""
    total = 0.0
    for _ in range(_PASSES):
        later = common_delay(found)
        if later is None or not bends_modes(found, np.inf if total else later.value):
            return found
        total += later.value
        again = _identify_once(take_out_delay(known, total), search)
        if len(again.frequencies) < len(found.frequencies):
            return found
        found = replace(again, responses=known.responses, delay=total, delay_deviation=later.deviation)
    return found


def _identify_once(known: Evidence, search: Search) -> Identified:
    band = _band(known, search)
    diagrams, candidates, reach = _candidates(known, band, search)
    lost: list[RejectedResonance] = []
    fitted = _fit_groups(known, candidates, band, search.highest_damping, lost)
    drives = _measure_drives(known, fitted)
    if len(fitted) > 1 and any(np.any(each.elsewhere > _UNRECORDED) for each in drives):
        lost.clear()
        fitted = _fit_groups(known, candidates, band, search.highest_damping, lost, together=np.inf)
        drives = _measure_drives(known, fitted)
    found = _widen_doubted(known, candidates, fitted)
    return _result(known, found, drives, band=band, reach=reach, diagrams=diagrams, lost=lost)


def _band(known: Evidence, search: Search) -> tuple[float, float]:
    low, high = known.band
    if search.band is None:
        return low, high
    asked = search.band
    if asked[0] < asked[1] and asked[0] < high and asked[1] > low:
        chosen = max(low, asked[0]), min(high, asked[1])
        require(few_lines(known, chosen, int(np.sum(in_band(known.responses.frequencies, chosen)))))
        return chosen
    what = f"modes between {asked[0]:g} and {asked[1]:g} Hz are requested; the data reach from {low:.4g} to {high:.4g} Hz"
    raise refuse(known.where, what, "Request a band within this range, or record faster or longer")


def _candidates(
    known: Evidence, band: tuple[float, float], search: Search
) -> tuple[tuple[Stabilisation, ...], tuple[Candidate, ...], Reach]:
    """Candidates, and the searched band, which needs enough lines for a polynomial."""
    low, high = 0.0, 0.0
    diagrams: list[Stabilisation] = []
    candidates: list[tuple[Candidate, ...]] = []
    inputs = known.responses.values.shape[2]
    for sweep in sweeps(*band):
        inside = in_band(known.responses.frequencies, (sweep.low, sweep.high))
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
    return tuple(diagrams), merge(candidates), Reach(low, high, search.band)


def _fit_groups(
    known: Evidence,
    candidates: tuple[Candidate, ...],
    band: tuple[float, float],
    highest_damping: float,
    lost: list[RejectedResonance],
    *,
    together: float = TOGETHER,
) -> list[BandModes]:
    if not candidates:
        return []
    poles = np.array([candidate.pole for candidate in candidates])
    groups = extents(poles, *band, resolution=known.apart(np.imag(poles)), together=together)
    every = zip(groups, gather_cells(known.lines(), [edges(poles, group.low, group.high) for group in groups]), strict=True)
    found = [fit_group(known, cells, candidates, ModeSearch(group, highest_damping, lost)) for group, cells in every]
    return [each for each in found if each is not None]


def _widen_doubted(known: Evidence, candidates: tuple[Candidate, ...], fitted: list[BandModes]) -> list[BandModes]:
    """Bands with the scatter between parts of the record in the deviations of modes with a residual above noise."""
    found, every = list(fitted), [_parts(known, each) for each in fitted]
    poles = np.array([candidate.pole for candidate in candidates])
    for parts in sorted({*every} - {1}):
        chosen = [index for index, each in enumerate(every) if each == parts]
        bounds = [edges(poles, found[index].group.low, found[index].group.high) for index in chosen]
        for index, cells in zip(chosen, gather_cells(known.lines(1, parts), bounds), strict=True):
            found[index] = widen_by_parts(known, cells, candidates, found[index])
    return found


def _parts(known: Evidence, found: BandModes) -> int:
    """Number of parts of a record for a check of stationarity: up to eight, none shorter than their slowest decay to 1/e.

    Returns 1 without a residual above noise, for fewer than three parts, or for several records, which are parts.
    """
    doubted = -2.0 * np.pi * np.real(found.modal.poles)[found.misfit > 1.0]
    if known.stored or not len(doubted) or len(found.band.cells.columns) > 1:
        return 1
    parts = min(_MOST_PARTS, int(np.min(doubted) / known.resolution))
    return parts if parts >= _LEAST_PARTS else 1


def _measure_drives(known: Evidence, fitted: list[BandModes]) -> list[Drive]:
    """Test whether recorded inputs excite the modes, band by band. Responses have no information on other excitation."""
    if all(each.band.inputs == each.band.cells.width for each in fitted):
        return [Drive(*np.zeros((2, len(each.modal.poles)))) for each in fitted]
    return measure_drives([(each.band, each.modal) for each in fitted], known.lines(1))


def _result(
    known: Evidence,
    found: list[BandModes],
    drives: list[Drive],
    *,
    band: tuple[float, float],
    reach: Reach,
    diagrams: tuple[Stabilisation, ...],
    lost: list[RejectedResonance],
) -> Identified:
    """Modes excited by recorded inputs; other resonances stay in the fit, because they represent motion of other modes."""
    inputs, outputs = len(known.input_scale), len(known.output_scale)
    modal = Modal(
        _join(part.modal.poles for part in found),
        np.concatenate([np.zeros((0, inputs), dtype=complex), *(part.modal.participation[:, :inputs] for part in found)]),
        np.concatenate([np.zeros((outputs, 0), dtype=complex), *(part.modal.shapes for part in found)], axis=1),
    )
    widened = [part.deviations.widen(part.widening) for part in found]
    wide = np.concatenate([np.zeros((outputs, 0)), *(part.shapes for part in widened)], axis=1)
    widening, chance = _join(part.widening for part in found), _join(drive.chance for drive in drives)
    driven = np.flatnonzero(chance <= ONCE_IN)
    order = driven[np.argsort(np.abs(modal.poles[driven]))]
    refused = [
        RejectedResonance(complex(modal.poles[mode]), modal.shapes[:, mode], float(chance[mode]))
        for mode in np.flatnonzero(chance > ONCE_IN)
    ]
    poles, (shapes, participation, wide) = modal.poles[order], _restore_units(known, modal, wide, order)
    inside = in_band(known.responses.frequencies, band)
    lines = known.responses.frequencies[inside]
    rest = known.responses.values[inside] - modal_sum(lines, 2.0 * np.pi * poles, shapes, participation)
    close, elsewhere = close_groups(poles), _join(drive.elsewhere for drive in drives)[order]
    return Identified(
        frequencies=np.abs(poles),
        damping=-np.real(poles) / np.abs(poles),
        shapes=shapes,
        participation=participation,
        frequency_deviations=_join(part.frequencies for part in widened)[order],
        damping_deviations=_join(part.damping for part in widened)[order],
        shape_deviations=wide,
        widening=widening[order],
        significance=_join(part.significance for part in found)[order],
        outputs=known.responses.outputs,
        inputs=known.responses.inputs,
        close=close,
        residuals=remainder(lines, rest, known.weights[inside]),
        responses=known.responses,
        stabilisation=diagrams,
        band=band,
        noise=np.median(known.density[inside], axis=0) * 2.0 / known.rate,
        data_warnings=tuple(data_warnings(known, poles, close, elsewhere=elsewhere, widening=widening[order], reach=reach)),
        peaks=peaks(known, lines, rest, poles, refused=refused, lost=lost),
        provenance=f"identified from {known.where}: pLSCF, then maximum likelihood",
    )


def _join(parts: Iterable[Array]) -> Array:
    return np.concatenate([np.zeros(0), *parts])


def _restore_units(known: Evidence, modal: Modal, wide: Array, order: Array) -> tuple[Array, Array, Array]:
    """Convert shapes (largest component 1), participations in rad/s, units of the channels, and deviations of the shapes."""
    shapes = modal.shapes * known.output_scale[:, None]
    scaled = np.argmax(np.abs(modal.shapes), axis=0)
    every = np.arange(shapes.shape[1])
    relative = shapes / shapes[scaled, every]
    wide = wide * (known.output_scale[:, None] / known.output_scale[scaled])
    largest = np.argmax(np.abs(relative), axis=0)
    turn = relative[largest, every]
    participation = 2.0 * np.pi * modal.participation / known.input_scale * (shapes[scaled, every] * turn)[:, None]
    return (relative / turn)[:, order], participation[order], (wide / np.abs(turn))[:, order]


def close_groups(poles: Array) -> tuple[tuple[int, ...], ...]:
    """Group successive modes (`poles` (k,)) that are closer than the mean of their half-widths, and return the indices of each group."""
    apart = np.abs(np.diff(np.imag(poles))) >= -0.5 * np.real(poles[1:] + poles[:-1])
    return tuple(tuple(group.tolist()) for group in np.split(np.arange(len(poles)), 1 + np.flatnonzero(apart)) if len(group) > 1)
