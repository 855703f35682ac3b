"""Static gains of a test: frequency responses below the modes, extrapolated to zero frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.analysis.workspace.stroke import stacks
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.units.dimension import dimension_of
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.records.record import Channel
from flexstage.experiment.records.unit import unit_problem
from flexstage.experiment.virtual_rig.plan import drivable_actuators, volts_per_metre
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel

_SHARE = 0.35
"""Upper limit of the lines used, relative to the lowest mode."""
_SKIPPED = 2
"""Lines omitted next to zero, with drift and offset by the window."""
_FEWEST = 8
_NEIGHBOURS = 1.94
"""Lines per independent one: Hann's neighbours share (2/3)^2 and (1/6)^2 of their variance on either side."""
_LENGTH, _VOLTAGE = dimension_of("m"), dimension_of("V")


@dataclass(frozen=True, eq=False)
class Gains:
    """Static gains (p, m) in m per m of free stroke, and their standard deviations by noise."""

    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    values: Array
    deviations: Array

    @property
    def scale(self) -> Array:
        """Largest gain (m,) of each actuator."""
        return np.max(np.abs(self.values), axis=0)

    def errors(self, share: float) -> Array:
        """Standard deviations (p, m) of noise and of a `share` of each actuator's largest gain."""
        return np.hypot(self.deviations, share * self.scale)


def measured_gains(mechanism: Mechanism, model: LinearModel, experiment: Identified, outputs: tuple[str, ...]) -> Gains:
    """Estimate the gains of the named outputs to the record's inputs that are strokes of the stage.

    The real part of H1 up to x = f/f_1 = 0.35 is fitted by a + (b x^2 + c x^4)/(1 - x^2), least squares: the lowest mode exactly, higher
    ones, lags and an amplifier's bandwidth by even powers; a is the gain. A drive in volts is converted by its stack's stroke and voltage
    range. Raises `DesignError` without a stroke input, for units not convertible to metres, or for too few lines below the modes.
    """
    strokes = drivable_actuators(mechanism, model)
    inputs = tuple(channel.name for channel in experiment.inputs if channel.name in strokes)
    require(
        Finding(channel.name, "no input of the record has the name of an actuator", suggest_nearest(channel.name, strokes))
        for channel in experiment.inputs
        if not inputs
    )
    known = {channel.name: channel for channel in (*experiment.inputs, *experiment.outputs)}
    require(_unit_findings(mechanism, [known[name] for name in (*inputs, *outputs)]))
    rows = [[each.name for each in experiment.responses.outputs].index(name) for name in outputs]
    columns = [[each.name for each in experiment.responses.inputs].index(name) for name in inputs]
    lines, values = _low_lines(experiment)
    fitted, deviations = _extrapolate_to_zero(lines, np.real(values[:, rows][:, :, columns]))
    top = np.array([metres(mechanism, known[name]) for name in outputs])[:, None]
    scale = top / np.array([metres(mechanism, known[name]) for name in inputs])
    return Gains(outputs, inputs, fitted * scale, deviations * scale)


def _low_lines(experiment: Identified) -> tuple[Array, Array]:
    """Lines below the modes relative to the lowest mode, and the responses there."""
    frequencies, lowest = experiment.responses.frequencies, float(experiment.frequencies[0])
    step = float(frequencies[1] - frequencies[0])
    chosen = (frequencies > (_SKIPPED + 0.5) * step) & (frequencies <= _SHARE * lowest)
    count = int(np.sum(chosen))
    if count < _FEWEST:
        what = f"{count} lines are below {_SHARE * lowest:.3g} Hz ({_SHARE:g} of the lowest mode), {_FEWEST} are needed for static gains"
        raise refuse(experiment.responses.source or "record", what, "Record longer, from lower frequencies, or compare without gains")
    return frequencies[chosen] / lowest, experiment.responses.values[chosen]


def _extrapolate_to_zero(lines: Array, values: Array) -> tuple[Array, Array]:
    """Extrapolated values (p, m) at zero frequency of values (f, p, m), and their standard deviations."""
    rise = 1.0 - lines**2
    powers = np.stack([np.ones_like(lines), lines**2 / rise, lines**4 / rise], axis=1)
    flat = values.reshape(len(lines), -1)
    found, *_ = np.linalg.lstsq(powers, flat, rcond=None)
    spread = np.sum((flat - powers @ found) ** 2, axis=0) / (len(lines) - powers.shape[1])
    share = np.linalg.inv(powers.T @ powers)[0, 0] * _NEIGHBOURS
    return found[0].reshape(values.shape[1:]), np.sqrt(spread * share).reshape(values.shape[1:])


def _unit_findings(mechanism: Mechanism, channels: list[Channel]) -> list[Finding]:
    advice = "Specify the channel's unit as a length or, for a drive, in volts, or compare without gains"
    return [
        Finding(channel.name, f'its unit "{channel.unit}" leads to no stroke or gap in metres', advice)
        for channel in channels
        if not np.isfinite(metres(mechanism, channel))
    ]


def is_length(unit: str) -> bool:
    """Check whether a unit is a length.

    >>> is_length("um"), is_length("mV"), is_length("")
    (True, False, False)
    """
    return unit_problem(unit) is None and dimension_of(unit).powers == _LENGTH.powers


def metres(mechanism: Mechanism, channel: Channel) -> float:
    """Return the metres per unit of a channel; NaN for other units."""
    if unit_problem(channel.unit) is not None:
        return float("nan")
    unit = dimension_of(channel.unit)
    if unit.powers == _LENGTH.powers:
        return float(unit.size / _LENGTH.size)
    known = stacks(mechanism)
    if unit.powers == _VOLTAGE.powers and channel.name in known:
        return float(unit.size / _VOLTAGE.size) / volts_per_metre(known[channel.name])
    return float("nan")
