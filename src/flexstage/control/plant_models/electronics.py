"""Hardware of a loop: sampling clock, amplifiers with converters and stacks, gauges with filters."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, TypeVar

import numpy as np

from flexstage.analysis.workspace.stroke import stacks, stroke_limits
from flexstage.base.arguments import UNLIMITED, CheckedFields, check_arguments
from flexstage.base.finding import Finding, require, unknown_names
from flexstage.base.number import Table
from flexstage.base.record import INNER, VIEW
from flexstage.base.units.quantity import CURRENT, FREQUENCY, TIME, Bound
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts import amplifier
from flexstage.parts.actuator import ChargedActuator, ThrustActuator
from flexstage.parts.gauge import Instrument


@dataclass(frozen=True)
class ChargeHold(CheckedFields):
    """Charge drive of a stack with electromechanical `coupling` k: far above a corner frequency, it imposes charge instead of voltage.

    The corner frequency is `corner` [Hz], or 1/(2 pi R C) with the resistance R = `leakage` [ohm] parallel to the stack's capacitance C.
    `residual_hysteresis` is the fraction of hysteresis and creep that remains at constant charge.
    """

    coupling: float
    residual_hysteresis: float
    corner: float | None = None
    leakage: float | None = None


@dataclass(frozen=True)
class AmplifierSettings(amplifier.Amplifier):
    """Amplifier data that the design file does not contain; absent values impose no limit.

    `slew` [V/s] is the maximum voltage rate. `noise_density` [V/Hz^(1/2)] is the one-sided density of white noise at the input of the
    amplifier's lag. `bits` is the resolution of the converter before the amplifier. An amplifier of voice coils controls the current:
    `bandwidth`, `current` and `bits` apply, and its noise is `current_noise` [A/Hz^(1/2)]. An amplifier with `charge` controls the charge
    of its stack. Its commands, range, slew, noise and steps are in volts: each charge is given as the voltage that it causes at an unloaded
    stack.
    """

    slew: float | None = None
    noise_density: float | None = None
    bits: Annotated[int, Bound(low=1.0, high=64.0)] | None = None
    current_noise: float | None = None
    charge: ChargeHold | None = None


@dataclass(frozen=True)
class GaugeSettings(CheckedFields):
    """Gauge data that replace or extend the data in the design file.

    The design's value replaces an absent value. If the design has no value either, the gauge is ideal in this respect. `bandwidth` [Hz] is
    the corner of the first-order lag. `noise_density` [m/Hz^(1/2), rad/Hz^(1/2)] is the one-sided density of white noise at the input of
    the lag. `resolution` [m, rad] is the step of the reading. `filter_order` and `filter_corner` [Hz] belong to a Butterworth filter before
    the sampler (order 0: no filter).
    """

    bandwidth: Annotated[float, UNLIMITED] | None = None
    noise_density: float | None = None
    resolution: float | None = None
    filter_order: int = 0
    filter_corner: float | None = None


@dataclass(frozen=True)
class ChargeDrive:
    """Charge drive of a stack, effective above the frequency `corner` [Hz].

    `coupling` is the stack's coupling factor k. `residual_hysteresis` is the fraction of the hysteresis that remains.
    """

    coupling: float
    corner: Annotated[float, FREQUENCY]
    residual_hysteresis: float

    @property
    def stiffening(self) -> Annotated[float, VIEW]:
        """Axial stiffness at constant charge, divided by that at constant voltage: 1/(1 - k^2) with the coupling k.

        A stack with open electrodes has constant charge (Preumont, Vibration Control of Active Structures, 2018, chapter 4).

        >>> round(ChargeDrive(0.6, 0.1, 0.2).stiffening, 12)
        1.5625
        """
        return 1.0 / (1.0 - self.coupling**2)


@dataclass(frozen=True)
class Amplifier:
    """Amplifier, converter and stack of one actuator. All values refer to the free stroke [m], or to the input [A, N] of a force actuator.

    `low` to `high` [m] is the stroke range, measured from the bias. `slew` [m/s] is the maximum rate: the lesser of current x gain /
    capacitance and voltage rate x gain, where gain is the free stroke per volt. `bandwidth` [Hz] is the corner of the lag after the hold.
    `noise_density` [m/Hz^(1/2)] is the noise of the free stroke before the lag (None: not specified). `step` [m] is the converter's
    resolution (0: no rounding). Infinite values impose no limit. `charge` is the charge drive, if any.
    """

    low: float = -np.inf
    high: float = np.inf
    slew: float = np.inf
    bandwidth: float = np.inf
    noise_density: float | None = None
    step: float = 0.0
    charge: ChargeDrive | None = None


@dataclass(frozen=True)
class Sensor:
    """One gauge between stage and computer.

    `bandwidth` [Hz] is the corner of the lag (infinite: no lag). `filter_order` and `filter_corner` [Hz] describe the Butterworth filter
    after the lag. `noise_density` [m/Hz^(1/2), rad/Hz^(1/2)] is one-sided and white before lag and filter (None: not specified).
    `resolution` [m, rad] is the step of the reading (0: no rounding). `half_range` [m, rad] is half the measuring range.
    """

    bandwidth: float = np.inf
    noise_density: float | None = None
    resolution: float = 0.0
    filter_order: int = 0
    filter_corner: float = np.inf
    half_range: float = np.inf


@dataclass(frozen=True, eq=False)
class Hardware:
    """Sampling chain between controller and stage, in both directions.

    `rate` [Hz] is the sampling rate (None: a continuous loop, for analysis only). `delay` [s] is the time from a sample to the resulting
    output, not necessarily whole samples. `amplifiers` and `sensors` map names of actuators and gauges to their data; omitted ones are
    ideal. Raises `DesignError` for invalid numbers.

    >>> Hardware(rate=10e3).step
    0.0001
    """

    rate: Annotated[float | None, FREQUENCY] = None
    delay: Annotated[float, TIME] = 0.0
    amplifiers: Annotated[Mapping[str, Amplifier], INNER] = field(default_factory=lambda: Table({}))
    sensors: Annotated[Mapping[str, Sensor], INNER] = field(default_factory=lambda: Table({}))

    def __post_init__(self) -> None:
        require(_findings(self))

    @property
    def step(self) -> float | None:
        """Time between samples [s]; None for a continuous loop."""
        return None if self.rate is None else 1.0 / self.rate


@check_arguments
def sampling_chain(
    mechanism: Mechanism,
    *,
    rate: float | None = None,
    delay: float = 0.0,
    amplifiers: AmplifierSettings | Mapping[str, AmplifierSettings] | None = None,
    gauges: GaugeSettings | Mapping[str, GaugeSettings] | None = None,
) -> Hardware:
    """Describe the sampling chain of a stage from the data of its stacks and gauges, and from settings of amplifiers and gauges.

    `amplifiers` contains common settings of all amplifiers, or settings by name of the actuator. `gauges` contains common settings of all
    gauges, or settings by name of the gauge. Raises `DesignError` for unknown names, and for settings without the required stack data: the
    capacitance for `resistance`, `current` and `leakage`, or the voltage range for `current`, `slew` and `noise_density`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> given = sampling_chain(double_triangle(), rate=10e3, delay=50e-6, amplifiers=AmplifierSettings(resistance=100.0, bits=16))
    >>> round(given.amplifiers["B1"].bandwidth), round(given.amplifiers["B1"].step * 1e9, 3)  # 1/(2 pi 100 ohm 0.4 uF), 150 um/2^16
    (3979, 2.289)
    """
    assembly = expand(mechanism)
    piezos, placed = stacks(mechanism), {name: item for name, item in assembly.gauges.items() if not item.members}
    thrusts = {name: part for name in assembly.thrusts if isinstance(part := assembly.actuator(name), ThrustActuator)}
    powers = _by_name(amplifiers, (*piezos, *thrusts), AmplifierSettings(), "actuator")
    limits = stroke_limits(mechanism)
    require(
        Finding(name, f"{key} must be positive (got {value:g})", f"Use a positive number, or omit {key}")
        for name, setting in powers.items()
        for key in ("bandwidth", "resistance", "current", "slew")
        if (value := getattr(setting, key)) is not None and not value > 0.0
    )
    require(finding for name in piezos for finding in _amplifier_findings(name, powers[name], piezos[name]))
    require(finding for name in thrusts for finding in _thrust_findings(name, powers[name], thrusts[name]))
    senses = _by_name(gauges, tuple(placed), GaugeSettings(), "gauge")
    return Hardware(
        rate,
        delay,
        Table(
            {
                name: _amplifier(powers[name], piezo, float(low), float(high))
                for (name, piezo), low, high in zip(piezos.items(), limits.low, limits.high, strict=True)
            }
            | {name: _thrust_amplifier(powers[name], part) for name, part in thrusts.items()}
        ),
        Table({name: _sensor(senses[name], item.gauge) for name, item in placed.items()}),
    )


_Setting = TypeVar("_Setting", AmplifierSettings, GaugeSettings)


def _by_name(given: _Setting | Mapping[str, _Setting] | None, names: tuple[str, ...], none: _Setting, kind: str) -> dict[str, _Setting]:
    if not isinstance(given, Mapping):
        return dict.fromkeys(names, none if given is None else given)
    require(unknown_names(given, names, kind))
    return {name: given.get(name, none) for name in names}


def _amplifier(setting: AmplifierSettings, piezo: ChargedActuator, low: float, high: float) -> Amplifier:
    gain = _gain(piezo)
    capacitance = np.nan if piezo.capacitance is None else float(piezo.capacitance)
    return Amplifier(
        low=low,
        high=high,
        slew=_slew(setting, gain, capacitance),
        bandwidth=float(setting.cutoff(np.array(capacitance))),
        noise_density=None if setting.noise_density is None else setting.noise_density * gain,
        step=0.0 if setting.bits is None else (high - low) / 2**setting.bits,
        charge=setting.charge and _charge_drive(setting.charge, capacitance),
    )


def _charge_drive(held: ChargeHold, capacitance: float) -> ChargeDrive:
    corner = held.corner if held.leakage is None else 0.5 / (np.pi * held.leakage * capacitance)
    return ChargeDrive(held.coupling, float(corner or 0.0), held.residual_hysteresis)


def _thrust_amplifier(setting: AmplifierSettings, part: ThrustActuator) -> Amplifier:
    """Amplifier of a force actuator, in its input [A, N], limited to the peak input."""
    high = _largest_input(setting, part)
    return Amplifier(
        low=-high,
        high=high,
        slew=_first_stated(part.slew(high) if np.isfinite(high) else None, np.inf),
        bandwidth=min(_first_stated(setting.bandwidth, np.inf), _first_stated(part.cutoff, np.inf)),
        noise_density=setting.current_noise,
        step=0.0 if setting.bits is None else 2.0 * high / 2**setting.bits,
    )


def _largest_input(setting: AmplifierSettings, part: ThrustActuator) -> float:
    ends = [limit.short for limit in part.limits if limit.clips and limit.short is not None]
    return min((float(end) for end in (*ends, setting.current) if end is not None), default=np.inf)


def _thrust_findings(name: str, setting: AmplifierSettings, part: ThrustActuator) -> Iterator[Finding]:
    if setting.charge is not None:
        yield Finding(name, "a charge drive needs a stack, but this amplifier drives a force actuator", 'Omit the key "kind"')
    for key in ("resistance", "slew", "noise_density"):
        if getattr(setting, key) is not None:
            what = f"{key} applies to amplifiers of stacks, but this amplifier drives a force actuator"
            advice = "Use bandwidth, current, current_noise and bits; the slew rate follows from the coil's voltage and inductance"
            yield Finding(name, what, advice)
    for key in ("current", "current_noise"):
        if getattr(setting, key) is not None and part.input is not CURRENT:
            yield Finding(
                name, f"{key} does not apply if the input is {part.input.noun}", f"Omit {key}, or describe the actuator as a voice coil"
            )
    if setting.bits is not None and np.isinf(_largest_input(setting, part)):
        yield Finding(
            name, "a resolution in bits requires a limited input range", 'Add for example peak_current = "5 A" to the actuator\'s part'
        )


def _slew(setting: AmplifierSettings, gain: float, capacitance: float) -> float:
    """Maximum rate of free stroke [m/s]: by the current into the stack's capacitance, and by the amplifier's slew."""
    by_current = np.inf if setting.current is None else setting.current * gain / capacitance
    return min(by_current, np.inf if setting.slew is None else setting.slew * gain)


def _gain(piezo: ChargedActuator) -> float:
    """Free stroke per volt [m/V]; NaN without a range."""
    if piezo.voltage_low is None or piezo.voltage_high is None:
        return np.nan
    return float(piezo.stroke / (piezo.voltage_high - piezo.voltage_low))


def _sensor(setting: GaugeSettings, gauge: Instrument) -> Sensor:
    return Sensor(
        bandwidth=_first_stated(setting.bandwidth, gauge.bandwidth, np.inf),
        noise_density=_first_stated(setting.noise_density, gauge.noise_density),
        resolution=_first_stated(setting.resolution, gauge.resolution, 0.0),
        filter_order=setting.filter_order,
        filter_corner=_first_stated(setting.filter_corner, np.inf),
        half_range=0.5 * float(gauge.range),
    )


def _first_stated(*values: Any) -> Any:
    """First specified value, as a float; None without one."""
    return next((float(value) for value in values if value is not None), None)


def _amplifier_findings(name: str, setting: AmplifierSettings, piezo: ChargedActuator) -> Iterator[Finding]:
    if setting.resistance is not None and setting.bandwidth is not None:
        what = f"both bandwidth ({setting.bandwidth:g} Hz) and resistance ({setting.resistance:g} ohm) are specified"
        yield Finding(name, what, "Specify only the key with the lower corner frequency")
    stated = {"resistance": setting.resistance, "current": setting.current, "leakage": setting.charge and setting.charge.leakage}
    for key, value in stated.items():
        if value is not None and piezo.capacitance is None:
            yield Finding(name, f"{key} needs the stack's capacitance, which is missing", 'Add for example capacitance = "0.5 uF"')
    if setting.current_noise is not None:
        yield Finding(name, "current_noise applies only to amplifiers of voice coils", "Specify the noise of a stack's amplifier in volts")
    for key in ("current", "slew", "noise_density"):
        if getattr(setting, key) is not None and np.isnan(_gain(piezo)):
            what = f"{key} needs the stack's voltage range, which is missing"
            yield Finding(name, what, 'Add for example voltage_low = "0 V" and voltage_high = "1000 V"')


def _findings(given: Hardware) -> Iterable[Finding]:
    if given.rate is not None and not 0.0 < given.rate < np.inf:
        yield Finding("rate", f"must be positive (got {given.rate:g} Hz)", "Use a positive number, or omit the rate for a continuous loop")
    if not 0.0 <= given.delay < np.inf:
        yield Finding("delay", f"must be 0 or more (got {given.delay:g} s)", "Use a time of 0 or more")
    if given.rate is None and given.delay:
        yield Finding("delay", f"{given.delay:g} s in a continuous loop, which has no samples", "Specify a rate, or omit the delay")
    for kind in (given.amplifiers, given.sensors):
        for name, item in kind.items():
            yield from _item_findings(name, item, given.rate)


def _item_findings(name: str, item: Amplifier | Sensor, rate: float | None) -> Iterable[Finding]:
    if not item.bandwidth > 0.0:
        yield Finding(name, f"bandwidth must be positive (got {item.bandwidth:g} Hz)", "Correct the bandwidth, or omit the key")
    if item.noise_density is not None and not 0.0 <= item.noise_density < np.inf:
        yield Finding(name, f"noise density must be 0 or more (got {item.noise_density:g})", "Correct the noise density")
    if isinstance(item, Amplifier):
        if not item.low < item.high:
            yield Finding(name, f"not a stroke range (got {item.low:g} m to {item.high:g} m)", "Use a lower limit below the upper limit")
        return
    if not 0.0 <= item.resolution < np.inf:
        yield Finding(name, f"resolution must be 0 or more (got {item.resolution:g})", "Use 0 for no rounding")
    if not 0 <= item.filter_order <= 12:
        yield Finding(name, f"filter order out of range (got {item.filter_order}, expected 0 to 12)", "Use 0 for no filter")
    if item.filter_order and not 0.0 < item.filter_corner < np.inf:
        what = f"the filter of order {item.filter_order} has no corner"
        yield Finding(name, what, "Specify filter_corner, below half the sampling rate" if rate else "Specify filter_corner")
