"""Margins from measured frequency responses, with uncertainty, compared with predictions of plant models."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Heading
from flexstage.base.units.quantity import ANGLE, FREQUENCY
from flexstage.control.controllers.pose_plant import pose_plant
from flexstage.control.plant_models.coordinates import Coordinates
from flexstage.control.plant_models.measured_plant import channel_places
from flexstage.control.plant_models.plants import Plant
from flexstage.control.robustness.response_margins import LoopLines, ResponseMargins
from flexstage.control.systems.closed import Loop, pose_controller
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.pipeline import Identification
from flexstage.experiment.records.record import Responses
from flexstage.experiment.spectral.local_responses import LocalResponses, local_responses

_DRAWS, _SEED = 100, 0
_ENDS = (0.025, 0.975)
_COHERENT = 0.5
_AROUND = 1.5
_LEAST_LINES = 16


@dataclass(frozen=True)
class Reading:
    """Measured margin: its `value`, and 95 % confidence limits `low` and `high` (None: unknown).

    `fitted` is the margin of the identified plant, and `predicted` is the margin of the stage's model. Both use the frequency lines of the
    measurement. NaN means that the margin has no limit.
    """

    value: Annotated[float, Heading("measured", digits=4)]
    low: Annotated[float | None, Heading("95 %, low", digits=4)]
    high: Annotated[float | None, Heading("95 %, high", digits=4)]
    fitted: Annotated[float, Heading("identified model", digits=4)]
    predicted: Annotated[float, Heading("design model", digits=4)]


@dataclass(frozen=True)
class ReadChannel:
    """Measured margins of one loop, with the other loops closed: upper gain factor, `phase` [rad], and first frequency of |S_ii| = 1."""

    channel: Annotated[str, INNER]
    gain_high: Reading
    phase: Annotated[Reading, ANGLE]
    rejection: Annotated[Reading, FREQUENCY]


@dataclass(frozen=True, eq=False)
class ReadLines:
    """Sensitivities |S_ii| (f, n) of n loops at f `frequencies` [Hz]: `measured`, with 95 % limits `low` and `high`, `fitted`, `predicted`.

    The `fitted` values belong to the identified plant, the `predicted` values belong to the stage's model. `low` and `high` are absent if
    the uncertainty of the test's responses is unknown.
    """

    frequencies: Array
    measured: Array
    low: Array | None
    high: Array | None
    fitted: Array
    predicted: Array


@dataclass(frozen=True, eq=False)
class MeasuredMargins(InNotebook):
    """Margins of a loop at the frequency lines of a test: peak of S, and margins by coordinate.

    The peak is the largest singular value of the sensitivity S, with rotations multiplied by the stage's length. `lines` is the number of
    frequency lines within `band` [Hz]. Between the lines, the response is unknown, and a narrow peak may be higher.
    """

    band: Annotated[tuple[float, float], FREQUENCY]
    lines: int
    peak: Reading
    peak_frequency: Annotated[float, FREQUENCY]
    channels: Annotated[tuple[ReadChannel, ...], INNER]
    sensitivities: Annotated[ReadLines, INNER]

    @property
    def loops(self) -> Annotated[Mapping[str, ReadChannel], VIEW]:
        """Margins by channel."""
        return {each.channel: each for each in self.channels}


def measured_margins(closed: Loop, seen: Identification, predicted: Plant) -> MeasuredMargins:
    """Compute the margins of a loop L = P(f) H_0(f) e^{-j w delay} K(e^{j w T}) from measured responses P of the plant.

    H_0 is the response of the hold, and K that of the controller; T is the sampling time, and w = 2 pi f. P is estimated from records with
    local polynomials (`local_responses`), or is the analyser's response. The errors of P are assumed to have a circular complex normal
    distribution. For an analyser's response, their variance is |P|^2 (1 - g^2)/(n g^2), with the coherence g^2 and n averages (Bendat &
    Piersol, Random Data, 4th ed., 2010, chapter 9). The formula assumes one driven input at a time. Confidence limits are quantiles of
    100 random draws; they are widened if the draws are biased. Aliasing of signals above half the sampling rate is neglected.

    Only frequency lines within the band of the identification and below half the sampling rate are used.
    """
    loop, found = closed.plant.coordinates, seen.found
    step = closed.step or 0.0
    known = _responses(seen)
    lines = known.frequencies
    inside = (lines >= found.band[0]) & (lines <= found.band[1]) & (lines < (0.5 / step if step else np.inf))
    lines = lines[inside]
    require(_few_lines(lines, found))
    rows, columns, outer, inner = channel_places(loop, found)
    chosen = np.ix_(np.flatnonzero(inside).tolist(), rows, columns)
    scale = outer[:, None] / inner
    response = known.values[chosen] * scale
    late = np.sinc(lines * step) * np.exp(-2j * np.pi * lines * (0.5 * step + predicted.hardware.delay))
    control = pose_controller(closed.controller, loop).sweep(lines, slice(len(loop.names)))
    whole = LoopLines(lines, loop.scale, control)
    values = whole.margins((loop.pose @ response) * late[:, None, None])
    sure = bool(np.all(np.isfinite(known.deviations)))
    drawn = _draws(whole, loop, response, known.deviations[chosen] * scale, late) if sure else None
    models = [whole.margins(pose_plant(plant).sweep(lines)) for plant in (closed.plant, predicted)]
    names = loop.names
    low, high = (None, None) if drawn is None else np.quantile([each.sizes for each in drawn], _ENDS, axis=0)

    def reading(of: Callable[[ResponseMargins], float]) -> Reading:
        low, high = (None, None) if drawn is None else _ends(of(values), np.array([of(each) for each in drawn]))
        return Reading(of(values), low, high, of(models[0]), of(models[1]))

    return MeasuredMargins(
        band=(float(lines[0]), float(lines[-1])),
        lines=len(lines),
        peak=reading(lambda each: each.peak),
        peak_frequency=values.peak_frequency,
        channels=tuple(
            ReadChannel(
                name,
                reading(lambda each, row=row: each.gains[row]),
                reading(lambda each, row=row: each.phases[row]),
                reading(lambda each, row=row: each.rejections[row]),
            )
            for row, name in enumerate(names)
        ),
        sensitivities=ReadLines(lines, values.sizes, low, high, models[0].sizes, models[1].sizes),
    )


def coherence_findings(seen: Identification, margins: MeasuredMargins) -> Iterator[Finding]:
    """Return a finding for each gauge with low coherence between 2/3 of the lowest and 3/2 of the highest crossover frequency."""
    if seen.multiple is None or seen.spectra is None:
        return
    ends = [each.rejection.fitted for each in margins.channels if np.isfinite(each.rejection.fitted)]
    if not ends:
        return
    low, high = min(ends) / _AROUND, max(ends) * _AROUND
    lines = seen.spectra.frequencies
    inside = (lines >= low) & (lines <= high)
    shares = np.median(seen.multiple[inside], axis=0) if np.any(inside) else np.zeros(len(seen.spectra.outputs))
    for channel, share in zip(seen.spectra.outputs, shares, strict=True):
        if share < _COHERENT:
            what = f"low coherence from {low:.3g} to {high:.3g} Hz, near the crossover (got {share:.0%}, expected at least {_COHERENT:.0%})"
            yield Finding(f"--record: {channel.name}", what, "Increase the drive in this band, record longer, or request another bandwidth")


def _ends(value: float, drawn: Array) -> tuple[float, float]:
    """Confidence limits: quantiles of the draws about their median, set about the value, and extended by the bias of the draws.

    The minimum of many noisy numbers is biased low. Quantiles mirrored at the value correct this (basic bootstrap, Davison & Hinkley,
    Bootstrap Methods and their Application, 1997, ch. 5).
    """
    low, middle, high = np.quantile(drawn, (_ENDS[0], 0.5, _ENDS[1]), method="nearest")
    if not np.all(np.isfinite([value, low, middle])):
        return float("nan"), float("nan")
    further = 2.0 * value - high if np.isfinite(high) else np.inf
    return float(min(value + low - middle, further)), float(max(value + high - middle, 2.0 * value - low))


def _responses(seen: Identification) -> LocalResponses:
    """Responses with standard deviations (f, p, m), in their units; NaN if unknown."""
    found, stored = seen.found, seen.found.responses
    if not isinstance(seen.test, Responses):
        return local_responses(seen.test, found)
    if stored.coherence is None or not stored.averages:
        return LocalResponses(stored.frequencies, stored.values, np.full(stored.values.shape, np.nan))
    share = np.clip(stored.coherence, 1e-6, 1.0)
    return LocalResponses(stored.frequencies, stored.values, np.abs(stored.values) * np.sqrt((1.0 - share) / (share * stored.averages)))


def _few_lines(lines: Array, found: Identified) -> Iterator[Finding]:
    if len(lines) < _LEAST_LINES:
        low, high = found.band
        what = f"too few frequency lines between {low:.4g} and {high:.4g} Hz (got {len(lines)}, expected at least {_LEAST_LINES})"
        yield Finding("--record", what, "Record longer, or drive with noise over the whole band")


def _draws(whole: LoopLines, loop: Coordinates, response: Array, spread: Array, late: Array) -> list[ResponseMargins]:
    random = np.random.default_rng(_SEED)
    found = []
    for _ in range(_DRAWS):
        noise = random.standard_normal((2, *response.shape)) * np.sqrt(0.5)
        moved = response + spread * (noise[0] + 1j * noise[1])
        found.append(whole.margins((loop.pose @ moved) * late[:, None, None]))
    return found
