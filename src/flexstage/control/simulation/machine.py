"""Numerical model of one sample of a sampled loop: plant, controller, amplifiers, gauges."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.analysis.workspace.drive import Drive
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require, suggest_nearest, unknown_names
from flexstage.base.number import Array
from flexstage.control.hysteresis.models.inverse import inverse_findings
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii
from flexstage.control.hysteresis.models.protocol import Hysteresis
from flexstage.control.plant_models.electronics import Amplifier, Sensor
from flexstage.control.plant_models.plants import Plant, zero_order_hold
from flexstage.control.systems.system import System, names_of, select
from flexstage.models.linear.model import Channel


@dataclass(frozen=True, eq=False)
class Amplifiers:
    """Amplifier model; each field has one number per actuator (m,).

    Strokes are free strokes relative to the bias. The command is rounded to the converter's `step` [m] (0: no rounding). The rounded
    command is limited to the range from `low` to `high` [m] and to the rate `slew` [m/s]. The voltage is `bias` + stroke / `gain` ([V],
    [m/V]; NaN for a stack without voltage data).
    """

    low: Array
    high: Array
    slew: Array
    step: Array
    gain: Array
    bias: Array


@dataclass(frozen=True, eq=False)
class Relief:
    """Reduction of the hysteretic stroke (the stroke minus the linear stroke at the same voltage) by charge drives.

    `residual_hysteresis` (m,) is the fraction of the hysteretic stroke that remains. `leak` (m,) is the fraction of the removed stroke that
    returns per sample by charge leakage: 1 - exp(-2 pi f T), with the drive's corner frequency f and the sampling period T.
    """

    residual_hysteresis: Array
    leak: Array


@dataclass(frozen=True, eq=False)
class Machine:
    """Sampled loop as computed by a simulation.

    A sample k begins with the readings y = C x + D w + noise of the `plant` (outputs `gap.<gauge>`), which are rounded to `resolution` (g,)
    [m] (0: no rounding). The gauge's last valid reading replaces a reading that is not finite or beyond `half_range` (g,) [m] (default:
    unlimited). The pose is the matrix `pose` (f, g) times y, and the error is reference minus pose. The `controller` computes
    `command.<actuator>` from any of the inputs `error.<c>`, `reference.<c>`, `pose.<c>` and `applied.<actuator>`. With `compensation`, its
    inverse computes the voltage from the command; otherwise the voltage is proportional to the command. The voltage is limited by
    `amplifiers`. With `hysteresis`, this model computes the free stroke from the voltage (reduced by `relief`); otherwise the free stroke
    is proportional to the voltage. Finally, the states of plant and controller are computed for sample k + 1. The input `applied` is the
    amplifier's output minus its input: zero except at a limit.

    `plant` is sampled. The plant's inputs named in `actuators` are strokes, all other inputs are disturbances. A stroke affects no reading
    in the same sample.
    """

    plant: System
    controller: System
    coordinates: tuple[Channel, ...]
    actuators: tuple[str, ...]
    gauges: tuple[str, ...]
    pose: Array
    amplifiers: Amplifiers
    resolution: Array
    hysteresis: Hysteresis | None = None
    compensation: PrandtlIshlinskii | None = None
    half_range: Array | None = None
    relief: Relief | None = None

    def __post_init__(self) -> None:
        require(_findings(self))

    @property
    def step(self) -> float:
        """Time between samples [s]."""
        return self.plant.step or np.nan

    @property
    def reach(self) -> Array:
        """Largest valid readings (g,) [m]: half the gauge's range plus half its resolution; without a range, the largest finite number."""
        ends = np.full(len(self.gauges), np.inf) if self.half_range is None else self.half_range
        return np.minimum(ends + 0.5 * self.resolution, np.finfo(float).max)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the loop's coordinates."""
        return names_of(self.coordinates)

    @property
    def disturbances(self) -> tuple[Channel, ...]:
        """Inputs of the plant except strokes."""
        return tuple(channel for channel in self.plant.inputs if channel.name not in self.actuators)

    @property
    def motions(self) -> tuple[Channel, ...]:
        """Outputs of the plant except readings."""
        return tuple(channel for channel in self.plant.outputs if channel.name not in self.readings)

    @property
    def readings(self) -> tuple[str, ...]:
        """Names of the plant's gauge outputs."""
        return tuple(f"gap.{name}" for name in self.gauges)

    def read(self, prefix: str = "") -> tuple[Channel, ...]:
        """Return one channel per gauge, with a name prefix, in the unit of its reading."""
        units = {channel.name: channel.unit for channel in self.plant.outputs}
        return tuple(Channel(f"{prefix}{name}", units[f"gap.{name}"]) for name in self.gauges)

    def strokes(self, prefix: str = "") -> tuple[Channel, ...]:
        """Return one channel per actuator, with a name prefix, in the unit of its input."""
        units = {channel.name: channel.unit for channel in self.plant.inputs}
        return tuple(Channel(f"{prefix}{name}", units[name]) for name in self.actuators)

    @property
    def commands(self) -> tuple[str, ...]:
        """Names of the controller's outputs."""
        return tuple(f"command.{name}" for name in self.actuators)


@check_arguments
def machine(
    given: Plant,
    controller: System,
    electric: Drive | None = None,
    *,
    hysteresis: Hysteresis | None = None,
    compensation: PrandtlIshlinskii | None = None,
    motions: tuple[str, ...] | None = None,
) -> Machine:
    """Assemble a plant with hardware and controller for simulation.

    `electric` maps strokes to volts; `hysteresis` and `compensation` require it. `motions` are the plant outputs to keep (default: all).
    Raises `DesignError` for a continuous loop, and in the same cases as `Machine`.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.run import simulate
    >>> example = integral_loop()
    >>> found = machine(example.plant, example.controller)
    >>> found.names, found.gauges, found.step
    (('x',), ('S',), 0.0001)
    """
    if given.hardware.step is None:
        raise refuse("loop", "the loop is continuous, but the simulation needs samples", "Specify the sampling rate")
    loop, nothing = given.coordinates, np.full(len(given.actuators), np.nan)
    power = [given.hardware.amplifiers.get(name, Amplifier()) for name in given.actuators]
    senses = [given.hardware.sensors.get(name, Sensor()) for name in given.gauges]
    plant = zero_order_hold(given)
    kept = plant if motions is None else select(plant, plant.input_names, (*loop.gaps, *motions))
    return Machine(
        plant=kept,
        controller=controller,
        coordinates=loop.motions(),
        actuators=given.actuators,
        gauges=given.gauges,
        pose=loop.pose,
        amplifiers=Amplifiers(
            *np.array([(each.low, each.high, each.slew, each.step) for each in power]).T,
            gain=nothing if electric is None else electric.gain,
            bias=nothing if electric is None else electric.bias,
        ),
        resolution=np.array([each.resolution for each in senses]),
        hysteresis=hysteresis,
        compensation=compensation,
        half_range=np.array([each.half_range for each in senses]),
        relief=None if hysteresis is None else _relief(power, given.hardware.step),
    )


def _relief(powers: Sequence[Amplifier], step: float) -> Relief | None:
    drives = [each.charge for each in powers]
    if all(each is None for each in drives):
        return None
    left = np.array([1.0 if each is None else each.residual_hysteresis for each in drives])
    corners = np.array([0.0 if each is None else each.corner for each in drives])
    return Relief(left, -np.expm1(-2.0 * np.pi * corners * step))


def _findings(given: Machine) -> Iterator[Finding]:
    plant, controller = given.plant, given.controller
    if plant.step is None or controller.step is None or abs(controller.step / plant.step - 1.0) > 1e-9:
        yield Finding(
            "loop",
            f"different sampling (got {plant.step} s for the plant, {controller.step} s for the controller)",
            "Use one sampling rate",
        )
    missing = [
        *_missing("plant", plant.input_names, given.actuators),
        *_missing("plant", plant.output_names, given.readings),
        *_missing("controller", controller.output_names, given.commands),
    ]
    yield from missing
    if not missing and np.any(select(plant, given.actuators, given.readings).D):  # otherwise an algebraic loop
        yield Finding(
            "plant", "the readings depend on the stroke of the same sample", "Add a delay to the loop, or a bandwidth to the gauges"
        )
    if np.any(controller.D[:, [name.startswith("applied.") for name in controller.input_names]]):
        yield Finding("controller", "the command depends on applied.<actuator> of the same sample", "Connect this input to states only")
    known = [f"{kind}.{name}" for kind in ("error", "reference", "pose") for name in given.names]
    known += [f"applied.{name}" for name in given.actuators]
    yield from unknown_names(controller.input_names, known, "input of a controller")
    yield from _electric(given)


def _missing(kind: str, known: tuple[str, ...], wanted: tuple[str, ...]) -> Iterator[Finding]:
    for name in wanted:
        if name not in known:
            yield Finding(f"{kind}: {name}", "unknown channel", suggest_nearest(name, known))


def _electric(given: Machine) -> Iterator[Finding]:
    models = {"hysteresis": given.hysteresis, "compensation": given.compensation}
    for name, model in models.items():
        if model is None:
            continue
        if model.axes != len(given.actuators):
            yield Finding(
                name,
                f"wrong number of axes (got {model.axes}, expected {len(given.actuators)}, the actuators)",
                "Use one axis per actuator",
            )
        for actuator, gain in zip(given.actuators, given.amplifiers.gain, strict=True):
            if np.isnan(gain):
                yield Finding(actuator, f"{name} needs the stack's voltage range, which is missing", 'Add for example voltage_low = "0 V"')
    if given.compensation is not None and given.relief is not None:
        yield Finding("compensation", "the inverse model is for voltage drive, but the stacks have charge drive", "Omit the compensation")
    if given.compensation is not None:
        yield from inverse_findings(given.compensation)
