"""Plan of a virtual test with all defaults resolved: drive of each actuator, errors of each gauge, rate and band."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.analysis.complete import platform_modes
from flexstage.analysis.workspace.stroke import stacks, stroke_limits
from flexstage.base.number import Array, Number
from flexstage.experiment.virtual_rig.setup import RigSetup
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.linear.model import LinearModel
from flexstage.parts.actuator import ChargedActuator

_DEFAULT_SHARE = 0.01
_RATE_OVER_HIGHEST = 10.0
_BAND_SHARE = 0.4
TAPER = 0.25
"""Range of the density's decay to zero, relative to the upper end of the band."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Resolved set-up, by driven actuator (m,) and by single gauge (p,) with the `units` of its reading, SI.

    `rms` of the commanded free stroke, `low` and `high` end of the stroke. `bandwidths` of amplifiers (infinite: ideal), `lags` of gauges,
    `walks` their drift per minute. `volts` per metre of free stroke (NaN for a stack without voltage range). `highest` platform mode [Hz].
    """

    setup: RigSetup
    actuators: tuple[str, ...]
    gauges: tuple[str, ...]
    units: tuple[str, ...]
    rate: float
    band: tuple[float, float]
    corner: float
    highest: float
    rms: Array
    low: Array
    high: Array
    volts: Array
    capacitances: Array
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


def plan_test(mechanism: Mechanism, model: LinearModel, setup: RigSetup) -> Plan:
    """Resolve a checked set-up.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> stage = double_triangle()
    >>> plan = plan_test(stage, mapped(stage), RigSetup(seconds=1.0))
    >>> plan.rate, (1e6 * plan.rms).round(6).tolist(), (1e9 * plan.steps[:2]).round(6).tolist()
    (2048.0, [1.5, 1.5, 1.5, 2.0, 2.0, 2.0], [10.0, 10.0])
    """
    names = setup.drive.actuators if setup.drive.actuators is not None else drivable_actuators(mechanism, model)
    limits = stroke_limits(mechanism)
    places = [limits.actuators.index(name) for name in names]
    piezos = [stacks(mechanism)[name] for name in names]
    gauges = {name: placed.gauge for name, placed in expand(mechanism).gauges.items() if not placed.members}
    metres = np.array([gauge.quantity.si == "m" for gauge in gauges.values()])
    highest = platform_modes(mechanism, model).highest
    rate = setup.rate if setup.rate is not None else 2.0 ** np.ceil(np.log2(_RATE_OVER_HIGHEST * highest))
    volts = np.array([volts_per_metre(piezo) for piezo in piezos])
    capacitances = np.array([np.nan if piezo.capacitance is None else float(np.real(piezo.capacitance)) for piezo in piezos])
    return Plan(
        setup=setup,
        actuators=tuple(names),
        gauges=tuple(gauges),
        units=tuple(gauge.quantity.si for gauge in gauges.values()),
        rate=float(rate),
        band=setup.drive.band if setup.drive.band is not None else (0.0, _BAND_SHARE * float(rate)),
        corner=setup.filter.corner if setup.filter.corner is not None else _BAND_SHARE * float(rate),
        highest=highest,
        rms=_commanded_rms(setup, piezos, volts),
        low=np.real(limits.low[places]),
        high=np.real(limits.high[places]),
        volts=volts,
        capacitances=capacitances,
        bandwidths=setup.amplifier.cutoff(capacitances),
        densities=_asked(setup.sensing.density, metres, _stated([gauge.noise_density for gauge in gauges.values()], 0.0)),
        steps=_asked(setup.sensing.resolution, metres, _stated([gauge.resolution for gauge in gauges.values()], 0.0)),
        lags=_stated([gauge.bandwidth for gauge in gauges.values()], np.inf),
        walks=_asked(setup.sensing.drift, metres, np.zeros(len(gauges))),
        ranges=_stated([gauge.range for gauge in gauges.values()], np.inf),
    )


def drivable_actuators(mechanism: Mechanism, model: LinearModel) -> tuple[str, ...]:
    """Find the actuators that can be driven: piezo stacks with stroke inputs.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.lumped import lumped
    >>> drivable_actuators(parallelogram(), lumped(parallelogram()))
    ('B',)
    """
    known = stacks(mechanism)
    return tuple(name for name in model.strokes if name in known)


def volts_per_metre(piezo: ChargedActuator) -> float:
    """Compute the voltage per free stroke [V/m]: the voltage range over the full stroke; NaN without a range.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(volts_per_metre(stacks(double_triangle())["B4"]))
    5000000
    """
    if piezo.voltage_low is None or piezo.voltage_high is None:
        return float("nan")
    return float(np.real((piezo.voltage_high - piezo.voltage_low) / piezo.stroke))


def _commanded_rms(setup: RigSetup, piezos: list[ChargedActuator], volts: Array) -> Array:
    if setup.drive.stroke is not None:
        return np.full(len(piezos), setup.drive.stroke)
    if setup.drive.voltage is not None:
        return setup.drive.voltage / volts
    return np.array([_DEFAULT_SHARE * float(np.real(piezo.stroke)) for piezo in piezos])


def _stated(values: list[Number | None], otherwise: float) -> Array:
    return np.array([otherwise if value is None else float(np.real(value)) for value in values])


def _asked(value: float | None, metres: Array, stated: Array) -> Array:
    """Set-up values of displacement gauges; for others the design's."""
    return stated if value is None else np.where(metres, value, stated)
