"""Creep identification from the record of a voltage step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.base.units.quantity import LENGTH, TIME
from flexstage.control.hysteresis.creep import LogCreep

_STILL = 0.01
_PER_DECADE = 20
_FEWEST = 8
_SCATTER = 0.25


@dataclass(frozen=True)
class IdentifiedCreep:
    """Identified creep: the `law`, the `stroke` [m] at the reference time, and the fitted `span` of times [s] after the step.

    `rms` is the rms error within the span, divided by the stroke; every decade of time has equal weight.
    """

    law: LogCreep
    stroke: Annotated[float, LENGTH]
    span: Annotated[tuple[float, float], TIME]
    rms: float


def identify_creep(times: Array, volts: Array, strokes: Array, *, reference: float = 0.1) -> IdentifiedCreep:
    """Fit w(t) = w_0 (1 + gamma log10(t/t_0)) to the stroke w at the time t after a voltage step; t_0 is `reference` [s].

    `times` [s], `volts` [V] and `strokes` [m] are (k,); the stack is in equilibrium before the step. The least-squares fit uses means over
    equal intervals of log t, so that every decade has equal weight. Raises `DesignError` if the voltage is not a single step, if the record
    after t_0 is shorter than a decade, or if the stroke does not follow the logarithmic law.

    >>> times = np.arange(0.0, 100.0, 0.05)
    >>> after = np.maximum(times - 1.0, 0.01)
    >>> strokes = np.where(times < 1.0, 0.0, 1e-4 * LogCreep(0.02).at(after))
    >>> found = identify_creep(times, np.where(times < 1.0, 0.0, 500.0), strokes)
    >>> round(found.law.rate, 6), round(found.stroke * 1e6, 3)
    (0.02, 100.0)
    """
    times, volts, strokes = (np.asarray(each, dtype=float) for each in (times, volts, strokes))
    require(_step_findings(times, volts, strokes))
    first, last = _step(volts)
    after, risen = times[last:] - times[last], strokes[last:] - np.mean(strokes[: first + 1])
    if not reference > 0.0 or after[-1] < 10.0 * reference or np.sum(after >= reference) < _FEWEST:
        what = f"ends too soon after the step (got {after[-1]:g} s, {np.sum(after >= reference)} samples after {reference:g} s)"
        raise refuse("record", what, f"Record at least {10.0 * reference:g} s after the step, or use an earlier reference time")
    decades, means = _means(np.log10(np.maximum(after, 1e-300) / reference), risen)
    columns = np.column_stack([np.ones_like(decades), decades])
    stroke, slope = np.linalg.lstsq(columns, means, rcond=None)[0].tolist()
    rms = float(np.sqrt(np.mean((means - columns @ np.array([stroke, slope])) ** 2)))
    if stroke == 0.0 or not np.isfinite(slope / stroke):
        raise refuse("stroke", "no response to the step", "Check that voltage and stroke belong to the same stack")
    if rms > _SCATTER * abs(slope) * decades[-1] and rms > 1e-4 * abs(stroke):
        what = f"the rms deviation from the logarithmic law is {rms:.3g} m, for a creep of {slope * decades[-1]:.3g} m"
        raise refuse("stroke", what, "Record longer, or with less drift and noise")
    return IdentifiedCreep(LogCreep(slope / stroke, reference), stroke, (reference, float(after[-1])), rms / abs(stroke))


def _step(volts: Array) -> tuple[int, int]:
    """Last sample at the initial voltage, and the first sample of the constant final voltage."""
    least = _STILL * np.ptp(volts)
    first = int(np.argmax(np.abs(volts - volts[0]) > least)) - 1
    last = min(len(volts) - 1, len(volts) - int(np.argmax(np.abs(volts[::-1] - volts[-1]) > least)))
    return first, last


def _step_findings(times: Array, volts: Array, strokes: Array) -> Iterator[Finding]:
    if not (times.shape == volts.shape == strokes.shape and times.ndim == 1 and len(times) > _FEWEST):
        shapes = f"different lengths (got times {times.shape}, volts {volts.shape}, strokes {strokes.shape})"
        raise refuse("record", shapes, f"Use one time, voltage and stroke for every sample, and more than {_FEWEST} samples")
    if not np.all(np.isfinite([times, volts, strokes])):
        raise refuse("record", "a sample is not finite", "Truncate the record before this sample")
    if np.ptp(volts) == 0.0:
        raise refuse("volts", f"no voltage step (got {volts[0]:g} V throughout)", "Use a record of the stroke after a voltage step")
    places = _step(volts)
    first, last = (times[place] for place in places)
    if places[1] - places[0] > 1 and last - first > _STILL * (times[-1] - times[0]):
        what = f"the voltage step lasts from {first:g} s to {last:g} s, more than {_STILL:.0%} of the record"
        yield Finding("volts", what, "Record one quick step, and keep the voltage constant after it")
    if np.any(np.diff(times) <= 0.0):
        yield Finding("times", "times must ascend", "Use the times of the samples")


def _means(decades: Array, risen: Array) -> tuple[Array, Array]:
    """Means of decades and strokes in equal parts of the decades from the reference time."""
    used = decades >= 0.0
    place = np.floor(decades[used] * _PER_DECADE).astype(int)
    counts = np.bincount(place)
    there = counts > 0
    along, strokes = (np.bincount(place, values[used])[there] / counts[there] for values in (decades, risen))
    return along, strokes
