"""Delay of the outputs, caused by a test's converters and filters, from the phase of the modal residues."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.identification.evidence import Evidence
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.records.record import Channel
from flexstage.experiment.records.unit import derivative_order
from flexstage.experiment.spectral.lines import Lines

_LEAST_REAL, _SURE = 0.9, 5.0
_UNSURE, _KNOWN = 0.01, 0.2
_CLEAR, _NOTICED = 6.0, 0.1
_ONE, _FEW, _ENOUGH = 0.45, 3.0, 3
_FINE = 40.0
_TURNED, _BESIDE = 0.05, 24.0


@dataclass(frozen=True)
class Delay:
    """Delay of the outputs: `value` [s] and its standard `deviation` [s]."""

    value: float
    deviation: float


def common_delay(found: Identified) -> Delay | None:
    """Estimate the common delay of all outputs, assuming proportional damping.

    In a proportionally damped stage, a mode with the pole p has the response H = R/(s - p) + ... with an imaginary residue R (real for a
    velocity; Heylen, Lammens & Sas, Modal Analysis Theory and Testing, 1997, A.1). A delay tau multiplies the residue by e^{-p tau}, so
    that the phase falls with frequency. Lags and filters count as delay if they have the same phase as a delay. Because the signs of
    residues are unknown, delays can be determined only up to 3 periods of the lowest mode; with fewer than three modes, only up to 0.45
    periods. Among equally good delays the shortest is returned. Returns `None` if no delay makes the residues imaginary, or if the delay is
    not significant.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> from flexstage.experiment.records.record import in_memory
    >>> made = one_mode_record()
    >>> late = in_memory(made.channels, made.rate, np.stack([made.values[2:, 0], made.values[:-2, 1]], axis=1))  # by 2 / 64 s
    >>> round(identify(late).delay, 3)
    0.031
    """
    return _fit_delay(found, None)


def late_channels(found: Identified) -> Iterator[str]:
    """Find single inputs or outputs whose delay differs from the delay of the others, and yield a warning for each.

    The delay of each channel is estimated from its residues in three modes or more. A channel is reported if its delay differs from the
    median delay by more than 6 standard deviations and by more than a tenth of the highest mode's period. Most channels must agree with
    this median. A channel with a phase shift of half a turn in all modes has a wrong sign, not a delay.
    """
    if len(_groups(found)) < _ENOUGH:
        return
    for axis, (kind, channels) in enumerate((("outputs", found.outputs), ("inputs", found.inputs))):
        if len(channels) < _ENOUGH:
            continue
        first = [_fit_delay(found, (axis, number), least=-np.inf) for number in range(len(channels))]
        known = [each.value for each in first if each is not None]
        if len(known) < len(channels):
            continue
        usual = float(np.median(known))
        own = [_fit_delay(found, (axis, number), usual, -np.inf) for number in range(len(channels))]
        apart = [(channel, each.value - usual, each.deviation) for channel, each in zip(channels, own, strict=True) if each is not None]
        turns = float(np.max(found.frequencies))
        late = [each for each in apart if abs(each[1]) > _CLEAR * each[2] and abs(each[1]) * turns > _NOTICED]
        if 2 * len(late) < len(channels):
            for channel, by, _ in late:
                word = "late" if by > 0.0 else "early"
                yield (
                    f"{channel.name} looks {word} by {1e3 * abs(by):.3g} ms relative to the other {kind}: after correction, the "
                    f"phases of its modal residues agree with those of the others."
                )


def _fit_delay(found: Identified, channel: tuple[int, int] | None, near: float = 0.0, least: float = _SURE) -> Delay | None:
    """Delay of the residues, of all or of one channel (axis and index); `None` if less than `least` deviations from zero.

    Among equally good delays, the one nearest to `near` [s]: signs are free, half turns are no evidence.
    """
    terms = [_residue(found, group, channel) for group in _groups(found)] if len(found.frequencies) else []
    if not terms:
        return None
    squares, poles, spreads = map(np.array, zip(*terms, strict=True))
    turning = np.abs(np.imag(poles))
    weights = 1.0 / (spreads**2 + _UNSURE**2)
    longest = (_FEW if np.sum(spreads < _KNOWN) >= _ENOUGH else _ONE) * 2.0 * np.pi / np.min(turning)
    step = 2.0 * np.pi / (_FINE * np.max(turning))
    count = int(np.ceil(longest / step))
    first = near - (0.0 if channel is None else longest)
    tried = first + step * np.arange(count if channel is None else 2 * count)

    def phases(delays: Array) -> Array:
        return -0.5 * np.angle(squares[:, None] * np.exp(2j * np.outer(turning, delays)))

    curvature = float(np.sum(weights * turning**2))
    for _ in range(3):
        tried = tried + (weights * turning) @ phases(tried) / curvature
    tried = tried[tried >= first - step]
    if not len(tried):
        return None
    misfit = weights @ phases(tried) ** 2
    scatter = max(1.0, float(np.min(misfit)) / max(1, len(terms) - 1))
    equal = tried[misfit <= np.min(misfit) + _CLEAR**2 * scatter]
    value = float(equal[np.argmin(np.abs(equal - near))])
    real = float(np.real(np.exp(2j * turning * value) @ (weights * squares)) / np.sum(weights))
    deviation = float(np.sqrt(scatter / curvature))
    return Delay(value, deviation) if real >= _LEAST_REAL and value > least * deviation else None


def bends_modes(found: Identified, seconds: float) -> bool:
    """Return whether a delay of `seconds` rotates the phase within a mode's band enough (0.05 rad) to impair the fit."""
    widths = found.frequencies * found.damping
    return bool(2.0 * np.pi * seconds * _BESIDE * float(np.max(widths)) > _TURNED)


def take_out_delay(known: Evidence, seconds: float) -> Evidence:
    """Return the evidence with the outputs advanced by a delay tau of `seconds`: multiplied by e^{j omega tau}, line by line."""

    def lines(number: int = 0, parts: int = 1) -> Iterable[Lines]:
        for each in known.lines(number, parts):
            yield replace(each, outputs=each.outputs * _turn(each.frequencies, seconds)[:, None])

    responses = known.responses
    earlier = responses.values * _turn(responses.frequencies, seconds)[:, None, None]
    return replace(known, responses=replace(responses, values=earlier), lines=lines)


def _turn(frequencies: Array, seconds: float) -> Array:
    return np.exp(2j * np.pi * frequencies * seconds)


def _groups(found: Identified) -> list[tuple[int, ...]]:
    """Indistinguishable close modes together, each other individually."""
    together = set(chain.from_iterable(found.close))
    return [*found.close, *((index,) for index in range(len(found.frequencies)) if index not in together)]


def _residue(found: Identified, group: tuple[int, ...], channel: tuple[int, int] | None) -> tuple[complex, complex, float]:
    """Mean square over mean power of a group's residues, or of one channel's (1 if all are imaginary), mean pole, spread of the phase.

    The phase of a channel with a small part in the mode is more uncertain.
    """
    chosen = list(group)
    pole = complex(np.mean(found.poles[chosen]))
    rates, driven = _rates(found.outputs, pole), _rates(found.inputs, pole)
    residues = (found.shapes[:, chosen] / rates[:, None]) @ (found.participation[chosen] * driven)
    size = np.max(np.abs(found.shapes[:, :, None] * found.participation), axis=1)
    scaled = residues / np.where(size > 0.0, size, 1.0)
    scaled = scaled if channel is None else np.take(scaled, [channel[1]], axis=channel[0])
    power = float(np.sum(np.abs(scaled) ** 2))
    square = complex(np.sum((scaled / 1j) ** 2)) / power if power else 0.0
    spread = float(np.min(found.frequency_deviations[chosen] / (found.damping[chosen] * found.frequencies[chosen])))
    part = 1.0 if channel is None else np.sqrt(power / scaled.size) + np.finfo(float).eps
    return square, pole, spread / part


def _rates(channels: tuple[Channel, ...], pole: complex) -> Array:
    """Velocities or accelerations of a free decay over its motions, up to a positive factor: (p/|p|)^n; 1 for others."""
    return np.array([(pole / abs(pole)) ** derivative_order(channel.unit) for channel in channels])
