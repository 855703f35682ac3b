"""Plan of a virtual test with all defaults resolved: drive of each actuator, errors of each gauge, rate and band."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.workspace.stroke import StrokeLimits, stacks, stroke_limits
from flexstage.base.number import Array, Number
from flexstage.experiment.virtual_rig.inputs import OWN_QUANTITIES, InputQuantity
from flexstage.experiment.virtual_rig.setup import RigSetup
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.parts.actuator import Actuator, ChargedActuator, ThrustActuator

_DEFAULT_SHARE = 0.01
_RATE_OVER_HIGHEST = 10.0
_BAND_SHARE = 0.4
TAPER = 0.25
"""Width of the range above the band in which the density decays to zero, relative to the upper end of the band."""


@dataclass(frozen=True, eq=False)
class DrivenInput:
    """Input of a driven actuator: free stroke [m] of a stack, current [A] or force [N] of a force actuator.

    `own` is the quantity of the input. `low` and `high` limit peaks, `sustained` limits the rms (infinite: no limit). `full` is the full
    stroke or the sustained limit (NaN: unknown); the default drive is a fraction of `full`. `factors` convert the input to other
    quantities. `capacitance` [F] is known for stacks only. `lag` [Hz] is the corner frequency of the coil (infinite: none).
    """

    own: InputQuantity
    low: float
    high: float
    full: float
    factors: Mapping[InputQuantity, float]
    sustained: float = np.inf
    capacitance: float = np.nan
    lag: float = np.inf

    def factor(self, quantity: InputQuantity | None) -> float:
        """Return the factor from the input to another `quantity`, in SI; 1 for the input's own quantity, NaN if unknown."""
        return 1.0 if quantity is None or quantity is self.own else self.factors.get(quantity, np.nan)


@dataclass(frozen=True, eq=False)
class Plan:
    """Set-up of a virtual test with all defaults resolved, in SI, for each driven actuator (m,) and each gauge (p,).

    `units` (p,) are the units of gauge readings. `rms` (m,) are rms values of the commanded `inputs`. `bandwidths` (m,) are the bandwidths
    of amplifiers and coils [Hz] (infinite: ideal). `lags` (p,) are the corner frequencies of the gauges [Hz]. `walks` (p,) are the standard
    deviations of the gauges' drifts after one minute. `highest` is the frequency of the highest platform mode [Hz].
    """

    setup: RigSetup
    actuators: tuple[str, ...]
    gauges: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    band: tuple[float, float]
    corner: float
    highest: float
    inputs: tuple[DrivenInput, ...]
    rms: Array
    bandwidths: Array
    densities: Array
    steps: Array
    lags: Array
    walks: Array
    ranges: Array

    @property
    def length(self) -> int:
        """Number of samples of each channel."""
        return round(self.setup.seconds * self.rate)

    @property
    def recorded(self) -> tuple[InputQuantity, ...]:
        """Recorded quantity of each input."""
        return tuple(self.setup.input_quantity or each.own for each in self.inputs)


def plan_test(mechanism: Mechanism, model: LinearModel, setup: RigSetup) -> Plan:
    """Resolve the defaults of a checked set-up.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> stage = double_triangle()
    >>> plan = plan_test(stage, mapped(stage), RigSetup(seconds=1.0))
    >>> plan.rate, (1e6 * plan.rms).round(6).tolist(), (1e9 * plan.steps[:2]).round(6).tolist()
    (2048.0, [1.5, 1.5, 1.5, 2.0, 2.0, 2.0], [10.0, 10.0])
    """
    names = setup.drive.actuators or drivable_actuators(mechanism, model)
    inputs = driven_inputs(mechanism, names)
    placed = {name: each.gauge for name, each in expand(mechanism).gauges.items() if not each.members}
    gauges = tuple(placed.values())
    units = tuple(gauge.quantity.si for gauge in gauges)
    metres = np.array([unit == "m" for unit in units])
    highest = platform_modes(mechanism, model).highest
    rate = float(setup.rate or 2.0 ** np.ceil(np.log2(_RATE_OVER_HIGHEST * highest)))
    cutoffs = setup.amplifier.cutoff(np.array([each.capacitance for each in inputs]))
    return Plan(
        setup=setup,
        actuators=tuple(names),
        gauges=tuple(placed),
        units=units,
        rate=rate,
        band=setup.drive.band or (0.0, _BAND_SHARE * rate),
        corner=setup.filter.corner or _BAND_SHARE * rate,
        highest=highest,
        inputs=inputs,
        rms=np.array([_commanded_rms(setup, each) for each in inputs]),
        bandwidths=np.minimum(cutoffs, [each.lag for each in inputs]),
        densities=_asked(setup.sensing.density, metres, _stated([gauge.noise_density for gauge in gauges], 0.0)),
        steps=_asked(setup.sensing.resolution, metres, _stated([gauge.resolution for gauge in gauges], 0.0)),
        lags=_stated([gauge.bandwidth for gauge in gauges], np.inf),
        walks=_asked(setup.sensing.drift, metres, np.zeros(len(gauges))),
        ranges=_stated([gauge.range for gauge in gauges], np.inf),
    )


def drivable_actuators(mechanism: Mechanism, model: LinearModel) -> tuple[str, ...]:
    """Find the actuators that can be driven: inputs of the model that are piezo stacks or force actuators.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> drivable_actuators(parallelogram(), lumped(parallelogram()))
    ('B',)
    """
    known = (*stacks(mechanism), *expand(mechanism).thrusts)
    return tuple(name for name in model.actuators if name in known)


def driven_inputs(mechanism: Mechanism, names: tuple[str, ...]) -> tuple[DrivenInput, ...]:
    """Describe the inputs of the named piezo stacks and force actuators.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> (found,) = driven_inputs(double_triangle(), ("B4",))
    >>> round(found.high * 1e6), round(found.factor(InputQuantity.VOLTAGE))
    (100, 5000000)
    """
    limits, assembly = stroke_limits(mechanism), expand(mechanism)
    return tuple(_driven_input(assembly.actuator(name), limits, name) for name in names)


def input_factor(mechanism: Mechanism, name: str, quantity: InputQuantity) -> float:
    """Return the factor from an actuator's input to a `quantity`, in SI; NaN if unknown.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(input_factor(double_triangle(), "B4", InputQuantity.VOLTAGE))
    5000000
    """
    known = name in (*stacks(mechanism), *expand(mechanism).thrusts)
    if not known:
        return 1.0 if quantity is InputQuantity.STROKE else float("nan")
    return driven_inputs(mechanism, (name,))[0].factor(quantity)


def _driven_input(part: Actuator, limits: StrokeLimits, name: str) -> DrivenInput:
    if isinstance(part, ChargedActuator):
        low, high = (_real(each[limits.actuators.index(name)]) for each in (limits.low, limits.high))
        volts = {InputQuantity.VOLTAGE: volts_per_metre(part)}
        return DrivenInput(InputQuantity.STROKE, low, high, _real(part.stroke), volts, capacitance=_real(part.capacitance))
    assert isinstance(part, ThrustActuator)  # noqa: S101  `drivable_actuators` has no other
    known = list(part.limits)
    high = min((_real(each.short, np.inf) for each in known if each.clips), default=np.inf)
    held = min((_real(each.held, np.inf) for each in known), default=np.inf)
    return DrivenInput(
        own=OWN_QUANTITIES[part.input.si],
        low=-high,
        high=high,
        full=held if np.isfinite(held) else np.nan,
        factors={InputQuantity.TORQUE if part.axis else InputQuantity.FORCE: _real(part.thrust)},
        sustained=held,
        lag=_real(part.cutoff, np.inf),
    )


def volts_per_metre(piezo: ChargedActuator) -> float:
    """Compute the voltage per free stroke [V/m]: the voltage range divided by the full stroke; NaN if the range is unknown.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(volts_per_metre(stacks(double_triangle())["B4"]))
    5000000
    """
    if piezo.voltage_low is None or piezo.voltage_high is None:
        return float("nan")
    return _real((piezo.voltage_high - piezo.voltage_low) / piezo.stroke)


def _commanded_rms(setup: RigSetup, driven: DrivenInput) -> float:
    for quantity, value in setup.drive.amounts.items():
        return value / abs(driven.factor(quantity))
    return _DEFAULT_SHARE * driven.full


def _stated(values: list[Number | None], otherwise: float) -> Array:
    return np.array([_real(value, otherwise) for value in values])


def _real(value: Number | None, otherwise: float = np.nan) -> float:
    return otherwise if value is None else float(np.real(value))


def _asked(value: float | None, metres: Array, stated: Array) -> Array:
    """Set-up values of displacement gauges; for others the design's."""
    return stated if value is None else np.where(metres, value, stated)
