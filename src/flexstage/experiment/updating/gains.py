"""Static gains of a test: frequency responses below the modes, extrapolated to zero frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.units.dimension import dimension_of
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.records.record import Channel, names_of
from flexstage.experiment.records.unit import same_dimension, unit_problem
from flexstage.experiment.virtual_rig.inputs import RECORDED_UNITS, InputQuantity
from flexstage.experiment.virtual_rig.plan import drivable_actuators, input_factor
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel

_SHARE = 0.35
"""Upper limit of the lines used, relative to the lowest mode."""
_SKIPPED = 2
"""Lines omitted next to zero, with drift and offset by the window."""
_FEWEST = 8
_UNITS = "Use a unit of stroke, voltage, current or force for an input, a unit of length or angle for a gauge; or compare without gains"
_NEIGHBOURS = 1.94
"""Lines per independent one: Hann's neighbours share (2/3)^2 and (1/6)^2 of their variance on either side."""


@dataclass(frozen=True, eq=False)
class Gains:
    """Static gains (p, m) of p outputs per unit of m inputs (free stroke, current or force), and their standard deviations due to noise.

    `units` (p, m) are the SI units of the gains.
    """

    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    values: Array
    deviations: Array
    units: tuple[tuple[str, ...], ...]

    @property
    def scale(self) -> Array:
        """Largest absolute gain (m,) of each actuator."""
        return np.max(np.abs(self.values), axis=0)

    def errors(self, share: float) -> Array:
        """Compute the standard deviations (p, m) due to two independent errors: noise, and a `share` of each actuator's largest gain."""
        return np.hypot(self.deviations, share * self.scale)


def measured_gains(mechanism: Mechanism, model: LinearModel, experiment: Identified, outputs: tuple[str, ...]) -> Gains:
    """Estimate the gains from recorded inputs (actuators of the stage) to the outputs named `outputs`.

    Let x = f/f_1 be the frequency relative to the lowest mode. The function a + (b x^2 + c x^4)/(1 - x^2) is fitted by least squares to the
    real part of the responses (estimator H1) up to x = 0.35. The constant a is the gain; b and c are the other two coefficients. The fitted
    function represents the lowest mode, at f_1, exactly. Even powers approximate higher modes, lags and the amplifier's bandwidth. An input
    in volts is converted to free stroke with the stroke and voltage range of its stack. Raises `DesignError` if no input is an actuator, if
    a unit cannot be converted to the model's unit, or if there are too few spectral lines below the modes.
    """
    known = drivable_actuators(mechanism, model)
    inputs = tuple(channel.name for channel in experiment.inputs if channel.name in known)
    require(
        Finding(channel.name, "no input of the record has the name of an actuator", suggest_nearest(channel.name, known))
        for channel in experiment.inputs
        if not inputs
    )
    channels = {channel.name: channel for channel in (*experiment.inputs, *experiment.outputs)}
    si = {channel.name: channel.unit for channel in (*model.outputs, *model.inputs)}
    sizes = {name: si_size(mechanism, channels[name], si[name]) for name in (*inputs, *outputs)}
    require(
        Finding(name, f'its unit "{channels[name].unit}" does not fit a gauge or an actuator', _UNITS)
        for name, size in sizes.items()
        if not np.isfinite(size)
    )
    rows = [names_of(experiment.responses.outputs).index(name) for name in outputs]
    columns = [names_of(experiment.responses.inputs).index(name) for name in inputs]
    lines, values = _low_lines(experiment)
    fitted, deviations = _extrapolate_to_zero(lines, np.real(values[:, rows][:, :, columns]))
    scale = np.array([sizes[name] for name in outputs])[:, None] / np.array([sizes[name] for name in inputs])
    units = tuple(tuple(f"{si[row]}/{si[column]}" for column in inputs) for row in outputs)
    return Gains(outputs, inputs, fitted * scale, deviations * scale, units)


def _low_lines(experiment: Identified) -> tuple[Array, Array]:
    """Lines below the modes relative to the lowest mode, and the responses there."""
    frequencies, lowest = experiment.responses.frequencies, float(experiment.frequencies[0])
    step = float(frequencies[1] - frequencies[0])
    chosen = (frequencies > (_SKIPPED + 0.5) * step) & (frequencies <= _SHARE * lowest)
    count = int(np.sum(chosen))
    if count < _FEWEST:
        what = f"too few lines below {_SHARE * lowest:.3g} Hz, {_SHARE:g} times the lowest mode (got {count}, expected {_FEWEST} for gains)"
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


def is_voltage(unit: str) -> bool:
    """Check whether a unit is a voltage.

    >>> is_voltage("um"), is_voltage("mV"), is_voltage("")
    (False, True, False)
    """
    return unit_problem(unit) is None and same_dimension(unit, "V")


def si_size(mechanism: Mechanism, channel: Channel, reading: str = "m") -> float:
    """Return the factor from a channel's unit to the SI unit of its actuator's input or of its gauge (`reading`); NaN for other units."""
    if unit_problem(channel.unit) is not None:
        return float("nan")
    unit = dimension_of(channel.unit)
    if channel.name not in expand(mechanism).actuators:
        return float(unit.size) if same_dimension(channel.unit, reading) else float("nan")
    quantity = next((key for key, name in RECORDED_UNITS.items() if same_dimension(name, channel.unit)), None)
    if quantity is None:
        return float("nan")
    size = unit.size / dimension_of("m" if quantity is InputQuantity.STROKE else RECORDED_UNITS[quantity]).size
    return float(size) / input_factor(mechanism, channel.name, quantity)
