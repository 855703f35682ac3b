"""Modes of stages without recorded inputs: under continuous floor excitation, or in free decay after an impact or a release."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.experiment.identification.cluster import vector_assurance
from flexstage.experiment.identification.diagnosis.peaks import Peak, PeakCause, names_where, tone_peaks
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.identification.identify import Search, close_groups, identify
from flexstage.experiment.identification.outputs.subspace import BLOCKS, AmbientMode, band_covariances, searched_from, shaken_modes
from flexstage.experiment.identification.outputs.tones import remove_tones
from flexstage.experiment.records.record import Channel, Record, Responses, Role, names_of
from flexstage.experiment.spectral.lines import in_band

_EVIDENT, _WEAK = 6.1, 4.0
"""Standard deviations by which a mode's width must differ from zero: noise reaches the first once in 1e9."""
_HIGHEST, _LOWEST = 0.42, 6.0
_FEWEST = 400
_SAME, _LOCATED = 0.95, 0.1
_UNSCALED = (
    "no input was recorded: participations, masses and mass-normalised shapes are unknown. Shapes have a largest component of 1; "
    "scaling them requires a record with a known force or stroke."
)


def identify_floor(records: Sequence[Record], search: Search) -> Identified:
    """Identify the modes of a stage under floor excitation from outputs only, band by band (see `shaken_modes`), with 95 % intervals.

    The density of the exciting forces must be smooth within each band (frequency ratio 1.4). Repeated modes require excitation in as many
    independent directions as there are modes at the same frequency. The frequency range is divided into bands in two ways, shifted by half
    a band. A mode is reported if its half-power width is at least 6.1 standard deviations above zero in one division (probability 1e-9 for
    noise). The other division must show the same pole, which is not the case for the tail of a mode in another band. Steady tones are
    removed first. A resonance narrower than the line spacing of a block cannot be distinguished from a tone. Participations are unknown:
    the result has no inputs. Raises `DesignError` for several records, and for a record that is too short.
    """
    _refuse_floor(records)
    record, tones = remove_tones(records[0].select(names_of(records[0].outputs)))
    resolution = BLOCKS / record.duration
    lowest, highest = search.band or (0.0, np.inf)
    low, high, where = max(_LOWEST * resolution, lowest), min(_HIGHEST * record.rate, highest), record.where
    if low >= high:
        what = f"modes up to {high:.4g} Hz are requested, but the record shows only modes above {low:.4g} Hz"
        raise refuse(where, what, "Request another band, or record longer")
    began, low = low, searched_from(low, high, outputs=len(record.outputs), resolution=resolution)
    if low == np.inf:
        what = f"bands between {began:.4g} and {high:.4g} Hz have too few lines: a block lasts only a fortieth of {record.duration:.4g} s"
        raise refuse(where, what, "Record longer (modes in floor noise need minutes), or request a wider band")
    divisions, density = band_covariances(record, low, high)
    every = [[shaken_modes(band, search.highest_damping) for band in bands] for bands in divisions]
    poles = [[mode for _, found in division for mode in found] for division in every]
    modes, others = (
        [
            mode
            for mode in _without_doubles(found)
            if low <= abs(mode.pole) <= high and -mode.pole.real <= search.highest_damping * abs(mode.pole)
        ]
        for found in poles
    )
    narrow = [mode for mode in modes if -2.0 * mode.pole.real < resolution and mode.deviation < _LOCATED * resolution]
    wide, also = ([mode for mode in each if -2.0 * mode.pole.real >= resolution] for each in (modes, others))
    first = [mode for mode in wide if _certainty(mode) >= _EVIDENT and _is_among(mode, poles[1])]
    second = [mode for mode in also if _certainty(mode) >= _EVIDENT and _is_among(mode, poles[0]) and not _is_among(mode, first)]
    unsure = [mode for mode in wide if _certainty(mode) >= _WEAK and mode not in first and not _is_among(mode, second)]
    certain = sorted([*first, *second], key=lambda each: abs(each.pole))
    found = _result(record, certain, density, (low, high))
    size = np.sqrt(found.noise * (high - low))
    peaks = [
        *tone_peaks(tones, 1.0 / record.duration, record.outputs, np.where(size > 0.0, size, 1.0)),
        *(_peak(mode, PeakCause.NARROW, record.outputs, resolution) for mode in narrow),
        *(_peak(mode, PeakCause.UNSURE, record.outputs, resolution) for mode in unsure),
    ]
    return replace(found, stabilisation=tuple(each for each, _ in every[0]), peaks=tuple(sorted(peaks, key=lambda each: each.frequency)))


def _without_doubles(modes: Iterable[AmbientMode]) -> list[AmbientMode]:
    """Modes by ascending frequency; of duplicates, from two bands or one, the more certain."""
    kept: list[AmbientMode] = []
    for mode in sorted(modes, key=_certainty, reverse=True):
        if not any(_is_double(mode, other) for other in kept):
            kept.append(mode)
    return sorted(kept, key=lambda each: abs(each.pole))


def _is_among(mode: AmbientMode, others: Iterable[AmbientMode]) -> bool:
    """Whether the pole differs from one of the others by less than four standard deviations in width and in frequency."""
    return any(
        abs(mode.pole.real - other.pole.real) < _WEAK * np.hypot(mode.width_deviation, other.width_deviation)
        and abs(mode.pole.imag - other.pole.imag) < _WEAK * np.hypot(mode.deviation, other.deviation)
        for other in others
    )


def _is_double(first: AmbientMode, second: AmbientMode) -> bool:
    near = abs(first.pole - second.pole) < max(-first.pole.real, -second.pole.real)
    return near and vector_assurance(first.shape, second.shape) > _SAME


def identify_decay(records: Sequence[Record], search: Search) -> Identified:
    """Identify modes of free decays from outputs only: the transform of a decay is a frequency response with the stage's poles.

    A decay is a sum over modes, y(n) = sum phi a e^{p n T}, with the shapes phi, amplitudes a and poles p, and the time step T. Its
    transform over N samples is sum phi a (1 - e^{p N T})/(1 - e^{(p - jw)T}) at the angular frequency w. Each decay is therefore treated
    like an input, and its amplitudes a like participations. A decay starts at the largest outputs, relative to their root mean squares; all
    decays are cut to the length of the shortest. Each record is one decay; it shows only one combination of repeated modes.
    """
    starts = [_largest(record) for record in records]
    size = min(record.length - start for record, start in zip(records, starts, strict=True))
    first = records[0]
    where = first.where
    parts = [record.select(names_of(first.outputs)).values[start : start + size] for record, start in zip(records, starts, strict=True)]
    lines = np.fft.rfftfreq(size, 1.0 / first.rate)
    values = np.stack([np.fft.rfft(part - np.mean(part[-max(1, size // 10) :], axis=0), axis=0) for part in parts], axis=2) / first.rate
    inside = lines <= _HIGHEST * first.rate
    decays = tuple(Channel(f"decay {number + 1}", "s^-1", Role.INPUT) for number in range(len(records)))
    found = identify(Responses(lines[inside], first.outputs, decays, values[inside], source=where), search)
    began = ", ".join(f"{start / record.rate + record.start:.5g} s" for record, start in zip(records, starts, strict=True))
    said = f"each free decay starts where outputs are largest: at {began}."
    return replace(
        found,
        data_warnings=(_UNSCALED, said, *found.data_warnings),
        provenance=f"identified from free decays in {where}: pLSCF, then maximum likelihood",
    )


def _refuse_floor(records: Sequence[Record]) -> None:
    """Raise `DesignError` for several records, and for a record that is too short."""
    if len(records) > 1:
        what = f"wrong number of records (got {len(records)}, expected 1)"
        raise refuse("--excitation floor", what, "Use one record: the directions of the floor motion differ between records")
    if records[0].length < BLOCKS * _FEWEST:
        what = f"too short (got {records[0].length} samples, expected {BLOCKS} blocks of {_FEWEST})"
        raise refuse(records[0].where, what, "Record longer: modes in floor noise need minutes")


def _largest(record: Record) -> int:
    values = record.select(names_of(record.outputs)).values
    values = values - np.mean(values[-max(1, len(values) // 10) :], axis=0)
    size = np.sqrt(np.mean(values**2, axis=0))
    return int(np.argmax(np.sum((values / np.where(size > 0.0, size, 1.0)) ** 2, axis=1)))


def _certainty(mode: AmbientMode) -> float:
    return -mode.pole.real / max(mode.width_deviation, 1e-300)


def _result(record: Record, modes: Sequence[AmbientMode], density: Responses, band: tuple[float, float]) -> Identified:
    outputs = record.outputs
    poles = np.array([mode.pole for mode in modes], dtype=complex)
    sizes = np.abs(poles)
    shapes = np.array([mode.shape for mode in modes], dtype=complex).reshape(-1, len(outputs)).T
    return Identified(
        frequencies=sizes,
        damping=-np.real(poles) / sizes,
        shapes=shapes,
        participation=np.zeros((len(modes), 0), dtype=complex),
        frequency_deviations=np.array([mode.deviation for mode in modes]),
        damping_deviations=np.array([mode.width_deviation for mode in modes]) / sizes,
        shape_deviations=np.array([mode.shape_deviation for mode in modes]).reshape(-1, len(outputs)).T,
        widening=np.ones(len(modes)),
        significance=np.array([(_certainty(mode) / _EVIDENT) ** 2 for mode in modes]),
        outputs=outputs,
        inputs=(),
        close=close_groups(poles),
        residuals=np.zeros((2, len(outputs), 0)),
        responses=density,
        stabilisation=(),
        band=band,
        noise=np.median(np.abs(density.values[in_band(density.frequencies, band), :, 0]) ** 2, axis=0),
        data_warnings=(_UNSCALED, *([] if modes else ["no mode exceeds the noise of floor and gauges: record longer, or excite more."])),
        provenance=f"identified from outputs alone, in {record.where}: covariance-driven stochastic subspace",
    )


def _peak(mode: AmbientMode, doubt: PeakCause, outputs: Sequence[Channel], resolution: float) -> Peak:
    named = names_where(outputs, np.abs(mode.shape) > 0.5)
    is_in_one_division = doubt is PeakCause.UNSURE and _certainty(mode) >= _EVIDENT
    chance = 1.0 if is_in_one_division else float(scipy.special.erfc(_certainty(mode) / np.sqrt(2.0)))
    return Peak(abs(mode.pole), doubt, chance, None if doubt is PeakCause.NARROW else -2.0 * mode.pole.real, resolution, named)
