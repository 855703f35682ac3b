"""Peaks that are not confirmed as modes: possible causes, and required data."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, ClassVar

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.base.record import VIEW, Heading, Layout
from flexstage.base.units.quantity import FREQUENCY
from flexstage.experiment.identification.evidence import Evidence, is_even
from flexstage.experiment.identification.group import RejectedResonance
from flexstage.experiment.identification.outputs.tones import Tone
from flexstage.experiment.records.record import Channel, Responses

_MAINS = (50.0, 60.0)
_HARMONICS = 12
_REACH = 12
_FREE = 2 * (_REACH - 1) - 4
_ONE_IN = 0.05
_NOTICED = 1e-3
_WIDTHS = 4.0
_PART, _LITTLE = 0.3, 0.03
_MOST = 20


class PeakCause(Enum):
    """Reason why a peak is not accepted as a mode."""

    TONE = "tone"
    """Sinusoid in the outputs but not in the inputs; it is removed."""
    UNDRIVEN = "not driven"
    """Resonance without excitation by the recorded inputs."""
    WEAK = "weak"
    """Resonance that noise could cause."""
    UNSURE = "unsure"
    """Resonance in a test without recorded inputs: its width is not significantly above zero, or differs between divisions into bands."""
    FREE = "free"
    """Free oscillation that decays too little: neither its damping nor its excitation by an input can be determined."""
    NARROW = "narrow"
    """Single prominent line: too few lines to distinguish a resonance from a tone."""


@dataclass(frozen=True)
class Peak:
    """Peak at `frequency` in Hz, with a half-power `width` in Hz; tones, free oscillations and single lines have no width.

    `outputs` names the outputs with the peak; `resolution` is the spacing of frequency lines in Hz. `chance` is the probability of such a
    peak without a mode. For a tone, it is the probability that noise looks like an equally pure sinusoid. For a weak or narrow peak, it is
    the probability that noise causes an equally strong peak. For an undriven peak, it is the probability that inputs explain as much motion
    by chance. For an accepted mode, the probability is at most 1e-9; under floor excitation, the width is also at least the line spacing.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Peaks not confirmed as modes",
        "frequency outputs width resolution chance reason",
        notes=(
            (
                "Probability of such a peak if there is no mode. Not driven: probability that inputs explain as much motion by chance. "
                "A mode requires a probability of at most 1e-9 and, under floor excitation, a width of at least the line spacing."
            ),
        ),
    )

    frequency: Annotated[float, FREQUENCY, Heading(digits=5)]
    doubt: PeakCause
    chance: Annotated[float, Heading("probability by chance", digits=2)]
    width: Annotated[float | None, FREQUENCY, Heading(digits=3, absent="below line spacing")]
    resolution: Annotated[float, FREQUENCY, Heading("line spacing", digits=3)]
    outputs: Annotated[tuple[str, ...], Heading("outputs")]

    @property
    def reason(self) -> Annotated[str, VIEW]:
        """Reason why the peak is not accepted as a mode, with advice.

        >>> Peak(120.0, PeakCause.NARROW, 1e-6, None, 0.3125, ("y",)).reason
        'a peak at a single line (spacing 0.3125 Hz): a narrower resonance or a tone (2 x 60 Hz: the mains?). Measure with finer lines.'
        """
        if self.doubt is PeakCause.TONE:
            return f"a tone absent from the inputs{_mains(self)}, or an oscillation without decay in the record. It is removed."
        if self.doubt is PeakCause.FREE:
            return "a free oscillation that decays too little in the record to determine its damping. Record longer."
        if self.doubt is PeakCause.UNDRIVEN:
            return "not driven by the recorded inputs, but by an unrecorded force or an unsteady tone. Record all excitation of the stage."
        if self.doubt is PeakCause.UNSURE:
            return "its damping is too uncertain: noise or a neighbouring mode could cause this peak. Record longer."
        if self.doubt is PeakCause.WEAK:
            return "noise could cause such a peak. Record longer, or increase the drive."
        lines = f"a peak at a single line (spacing {self.resolution:.4g} Hz)"
        return f"{lines}: a narrower resonance or a tone{_mains(self)}. Measure with finer lines."


def peaks(
    known: Evidence, lines: Array, rest: Array, poles: Array, *, refused: Sequence[RejectedResonance], lost: Sequence[RejectedResonance]
) -> tuple[Peak, ...]:
    """List all peaks that are not modes, by ascending frequency.

    `rest` (f, p, m) are the responses at `lines` (f,) in Hz, after subtraction of the modes with `poles` (k,) in Hz.

    The list contains removed tones, `refused` resonances (not excited by the inputs) and `lost` resonances (not significant). A lost
    resonance is listed only if noise alone would give an equally strong peak with a probability below 1/1000. For an analyser's responses,
    the list also contains prominent single lines.

    >>> from flexstage.experiment.identification.evidence import evidence
    >>> from flexstage.experiment.example import one_mode_record
    >>> known, nothing = evidence(one_mode_record(), None), np.zeros(0)
    >>> weak = RejectedResonance(-0.1 + 20.0j, np.ones(1), 1e-6)
    >>> [peak.doubt.value for peak in peaks(known, nothing, nothing, nothing, refused=(), lost=(weak, weak))]
    ['weak']
    """
    step = known.resolution
    free = [tone for tone in known.tones if not (tone.fades and _is_listed(complex(0.0, tone.frequency), poles, (), step))]
    found = tone_peaks(free, step, known.responses.outputs, known.output_scale)
    for doubt, group in ((PeakCause.UNDRIVEN, refused), (PeakCause.WEAK, sorted(lost, key=lambda each: each.chance))):
        for each in group:
            modes = () if doubt is PeakCause.UNDRIVEN else poles
            if (doubt is PeakCause.UNDRIVEN or each.chance < _NOTICED) and not _is_listed(each.pole, modes, found, step):
                size = np.abs(each.shape)
                seen = names_where(known.responses.outputs, size > _PART * np.max(size))
                found.append(Peak(abs(each.pole), doubt, each.chance, -2.0 * each.pole.real, step, seen))
    for peak in narrow_peaks(known.responses, lines, rest, poles) if known.stored else ():
        if not _is_listed(complex(0.0, peak.frequency), (), found, peak.resolution):
            found.append(peak)
    return tuple(sorted(found, key=lambda each: each.frequency))


def _is_listed(pole: complex, poles: Iterable[complex], found: Sequence[Peak], step: float) -> bool:
    """Whether it lies within four half-widths, or three lines, of a listed mode or peak."""
    reach = max(-_WIDTHS * pole.real, 3.0 * step)
    return any(abs(pole.imag - abs(each)) < max(reach, -_WIDTHS * each.real) for each in poles) or any(
        abs(pole.imag - each.frequency) < max(reach, 0.5 * _WIDTHS * (each.width or 0.0)) for each in found
    )


def tone_peaks(tones: Iterable[Tone], resolution: float, outputs: Sequence[Channel], size: Array) -> list[Peak]:
    """List the tones of records as peaks with their dominant outputs; close tones are merged. `size` (p,) is the rms of each output.

    >>> outputs = (Channel("S1"), Channel("S2"))
    >>> hums = [Tone(50.0 + 1e-4 * each, np.array([0.3, 1e-6]), 0, 1000, 1e-12) for each in range(2)]
    >>> [(peak.frequency, peak.outputs) for peak in tone_peaks(hums, 0.1, outputs, np.ones(2))]
    [(50.0, ('S1',))]
    """
    found: list[tuple[Tone, Array]] = []
    for tone in sorted(tones, key=lambda each: each.frequency):
        if found and tone.frequency - found[-1][0].frequency < resolution:
            found[-1] = found[-1][0], np.maximum(found[-1][1], np.abs(tone.amplitudes))
        else:
            found.append((tone, np.abs(tone.amplitudes)))
    return [
        Peak(
            tone.frequency,
            PeakCause.FREE if tone.fades else PeakCause.TONE,
            tone.chance,
            None,
            resolution,
            names_where(outputs, amplitude / size > _LITTLE * np.max(amplitude / size)),
        )
        for tone, amplitude in found
    ]


def narrow_peaks(responses: Responses, lines: Array, rest: Array, poles: Array) -> list[Peak]:
    """List prominent single lines of the residual responses `rest` (f, p, m) at `lines` (f,) in Hz; `poles` (k,) of the modes are in Hz.

    An F-test compares each line with a cubic through its neighbours, from the 2nd to the 12th on both sides. The false-alarm rate is one in
    twenty data sets. Lines within four half-widths or three lines of a mode belong to the mode and are omitted. Responses with unevenly
    spaced lines are not tested.

    >>> lines, noise = np.arange(100.0), np.random.default_rng(2).standard_normal((2, 100, 1, 1))
    >>> rest = noise[0] + 1j * noise[1] + 30.0 * (lines == 60.0)[:, None, None]
    >>> here = Responses(lines, (Channel("S1"),), (Channel("u"),), rest)
    >>> [(peak.frequency, peak.outputs) for peak in narrow_peaks(here, lines, rest, np.zeros(0))]
    [(60.0, ('S1',))]
    """
    step = float(responses.frequencies[1] - responses.frequencies[0])
    if len(lines) <= 2 * _REACH or not is_even(lines):
        return []
    ratio = _prominence(rest)
    chance = scipy.special.fdtrc(2, 2 * _FREE, ratio) * ratio.size
    near = np.any(np.abs(lines[:, None] - np.abs(poles)) < np.maximum(-_WIDTHS * np.real(poles), 3.0 * step), axis=1)
    least = np.where(near, 1.0, np.min(chance, axis=(1, 2)))
    found: list[Peak] = []
    for line in np.argsort(least):
        if least[line] > _ONE_IN or len(found) == _MOST:
            break
        if all(abs(lines[line] - other.frequency) > 1.5 * step for other in found):
            seen = names_where(responses.outputs, np.min(chance[line], axis=1) < _ONE_IN)
            found.append(Peak(float(lines[line]), PeakCause.NARROW, float(least[line]), None, step, seen))
    return found


def _prominence(rest: Array) -> Array:
    """Squared distance of every line (f, p, m) from the cubic through its neighbours, over its variance; zero at the ends."""
    offsets = np.r_[-_REACH:-1, 2 : _REACH + 1]
    powers = np.vander(offsets / _REACH, 4, increasing=True)
    basis, _ = np.linalg.qr(powers)
    at_nought = np.linalg.lstsq(powers, basis, rcond=None)[0][0]
    count = len(rest) - 2 * _REACH
    power, parts = np.zeros((count, *rest.shape[1:])), np.zeros((4, count, *rest.shape[1:]), dtype=complex)
    for place, offset in enumerate(offsets):
        shifted = rest[_REACH + offset : _REACH + offset + count]
        power += np.abs(shifted) ** 2
        parts += basis[place, :, None, None, None] * shifted
    left = np.maximum(power - np.sum(np.abs(parts) ** 2, axis=0), 1e-9 * power + 1e-300) / _FREE
    away = rest[_REACH:-_REACH] - np.tensordot(at_nought, parts, axes=1)
    found = np.zeros(rest.shape)
    found[_REACH:-_REACH] = np.abs(away) ** 2 / (1.0 + np.sum(at_nought**2)) / left
    return found


def names_where(outputs: Sequence[Channel], chosen: Array) -> tuple[str, ...]:
    """Return the names of the channels chosen by the booleans `chosen` (p,).

    >>> names_where((Channel("S1"), Channel("S2")), np.array([False, True]))
    ('S2',)
    """
    return tuple(channel.name for channel, each in zip(outputs, chosen, strict=True) if each)


def _mains(peak: Peak) -> str:
    """Whether the peak is at a multiple of the mains frequency, within half a line or a part in a thousand."""
    for mains in _MAINS:
        times = round(peak.frequency / mains)
        within = max(min(0.5 * peak.resolution, 1.0), 1e-3 * peak.frequency)
        if 1 <= times <= _HARMONICS and abs(peak.frequency - times * mains) <= within:
            return f" ({times} x {mains:g} Hz: the mains?)" if times > 1 else f" ({mains:g} Hz: the mains?)"
    return ""
