"""Simulation result, and its figures of merit: settling, overshoot, tracking error."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, Along, Heading, Layout
from flexstage.control.simulation.machine import Machine
from flexstage.control.systems.system import names_of
from flexstage.models.linear.model import Channel
from flexstage.spatial.frame import COMPONENTS


@dataclass(frozen=True, eq=False)
class Simulated(InNotebook):
    """Simulated loop: every series has one row for each sample at `times` (n,) [s].

    `reference`, `pose` (estimated) and `error` (n, f) [m, rad] have a column for each of `coordinates`. The true `motions` (n, p) have
    a column for each of `channels`. Four series (n, m) [m] contain strokes, with a column for each of `actuators`. Strokes are relative to
    the bias (with load feedforward: relative to the bias plus the feedforward strokes). `command` is the controller's output, `asked` the
    amplifier input (after inverse model and converter), `given` the amplifier output (after limits), and `stroke` the stroke at the stage.
    `volts` (n, m) are NaN for a stack without voltage data. `readings` (n, g) have a column for each of `gauges`, in its unit. `saturated`
    (m,) is the fraction of samples at a range limit, `slewing` (m,) the fraction at a speed limit only. `out_of_range` (g,) is the fraction
    of samples with a reading out of range or lost; the last valid reading then replaces it.
    """

    TABLE: ClassVar[Layout] = Layout("Limits of the actuators", "saturated slewing", head="trajectory, actuator")

    times: Array
    coordinates: Annotated[tuple[Channel, ...], INNER]
    actuators: tuple[str, ...]
    gauges: tuple[str, ...]
    channels: Annotated[tuple[Channel, ...], INNER]
    reference: Array
    pose: Array
    error: Array
    motions: Array
    command: Array
    asked: Array
    given: Array
    stroke: Array
    volts: Array
    readings: Array
    saturated: Annotated[Array, Along("actuators"), Heading("time at range limit", digits=3, unit="%")]
    slewing: Annotated[Array, Along("actuators"), Heading("time at speed limit", digits=3, unit="%")]
    out_of_range: Annotated[Array, Along("gauges"), Heading("time out of range", digits=3, unit="%")]

    def motion(self, name: str) -> Array:
        """Return the true motion (n,) of the channel `name` (`platform.x`) [m, rad]; raises `DesignError` if it was not recorded."""
        known = names_of(self.channels)
        if name not in known:
            raise refuse(name, "not recorded in the simulation", f"{suggest_nearest(name, known)}; add this channel to the motions")
        return self.motions[:, known.index(name)]

    @property
    def true_error(self) -> Array:
        """Reference minus true platform pose (n, f) [m, rad], including the loop's response to gauge noise.

        The pose is relative to the moving ground, as the gauges measure it, if the motions `relative.<c>` were recorded.
        """
        known = names_of(self.channels)
        names = [f"relative.{channel.name}" for channel in self.coordinates]
        kept = [name if name in known else f"platform.{name.partition('.')[2]}" for name in names]
        return self.reference - np.stack([self.motion(name) for name in kept], axis=-1)


@dataclass(frozen=True)
class Excursion:
    """Largest motion along an axis [`unit`]."""

    largest: float
    unit: str


def other_motions(found: Simulated, moved: str) -> dict[str, Excursion]:
    """Compute the largest deviation along every axis except `moved`: from its reference, or from zero for axes without control.

    These deviations are the cross-axis error. The result includes all recorded platform axes, translations and rotations.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> from flexstage.control.simulation.run import simulate
    >>> example = integral_loop(gain=300.0)
    >>> list(other_motions(simulate(machine(example.plant, example.controller), np.full((10, 1), 1e-6)), "x"))
    ['y', 'z', 'rx', 'ry', 'rz']
    """
    known = {channel.name: channel.unit for channel in found.channels}
    largest = np.max(np.abs(found.true_error), axis=0).tolist()
    pairs = zip(found.coordinates, largest, strict=True)
    result = {channel.name: Excursion(value, channel.unit) for channel, value in pairs if channel.name != moved}
    for name in COMPONENTS:
        kept = next((each for each in (f"relative.{name}", f"platform.{name}") if each in known), None)
        if kept is not None and name != moved and name not in result:
            result[name] = Excursion(float(np.max(np.abs(found.motion(kept)))), known[kept])
    return result


@dataclass(frozen=True, eq=False)
class Series:
    """Series computed by a loop, with a row per sample; the fields have the same meaning as in `Simulated`."""

    reference: Array
    pose: Array
    motions: Array
    command: Array
    asked: Array
    given: Array
    stroke: Array
    readings: Array


def simulation_result(given: Machine, found: Series) -> Simulated:
    """Build the result from the computed series.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> example = integral_loop()
    >>> nothing = np.zeros((2, 1))
    >>> known = machine(example.plant, example.controller, motions=("platform.x",))
    >>> simulation_result(known, Series(*(nothing,) * 8)).times.tolist()
    [0.0, 0.0001]
    """
    amplifiers = given.amplifiers
    limited = found.given != found.asked
    at_end = limited & ((found.given == amplifiers.low) | (found.given == amplifiers.high))
    return Simulated(
        times=given.step * np.arange(len(found.reference)),
        coordinates=given.coordinates,
        actuators=given.actuators,
        gauges=given.gauges,
        channels=given.motions,
        **vars(found),
        error=found.reference - found.pose,
        volts=amplifiers.bias + found.given / amplifiers.gain,
        saturated=np.mean(at_end, axis=0),
        slewing=np.mean(limited & ~at_end, axis=0),
        out_of_range=np.mean(~(np.abs(found.readings) <= given.reach), axis=0),
    )


@check_arguments
def tracking(found: Simulated) -> Matrix:
    """Compute rms and peak tracking errors by coordinate: those measured by the loop, and those of the true platform pose.

    The rms values are computed from all samples. A rest at the end of the trajectory therefore lowers the rms values.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> from flexstage.control.simulation.run import simulate
    >>> example = integral_loop(gain=300.0)
    >>> still = tracking(simulate(machine(example.plant, example.controller), np.zeros((10, 1))))
    >>> still.columns, still.values.tolist()
    (('rms', 'peak', 'true rms', 'true peak'), [[0.0, 0.0, 0.0, 0.0]])
    """
    errors = (found.error, found.true_error)
    columns = [each for error in errors for each in (np.sqrt(np.mean(error**2, axis=0)), np.max(np.abs(error), axis=0))]
    units = tuple((channel.unit,) * 4 for channel in found.coordinates)
    return Matrix(np.stack(columns, axis=-1), names_of(found.coordinates), ("rms", "peak", "true rms", "true peak"), units)


@dataclass(frozen=True, eq=False)
class StepFigures:
    """Step response results by coordinate (f,): `settling` time [s] until the true error stays within `band` [m, rad].

    The settling time is infinite if the error does not settle. `overshoot` is the largest motion beyond the step, `undershoot` the largest
    motion opposite to the step. Both are fractions of the step (NaN for coordinates without a step). `residual` [m, rad] is the true error
    at the end of the simulation.
    """

    coordinates: tuple[Channel, ...]
    band: Array
    settling: Array
    overshoot: Array
    undershoot: Array
    residual: Array


@check_arguments
def step_figures(found: Simulated, share: float = 0.02, *, start: float = 0.0) -> StepFigures:
    """Compute settling time and overshoot of a simulated step at `start` [s].

    The settling band of a coordinate is its step times `share`. For a coordinate without a step, the band is the largest step in the same
    unit times `share`. All values are computed from the error of the true platform pose.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> from flexstage.control.simulation.run import simulate
    >>> example = integral_loop(gain=100.0)
    >>> found = step_figures(simulate(machine(example.plant, example.controller), np.full((2000, 1), 1e-6)), 0.02)
    >>> round(float(found.settling[0]), 3), bool(found.overshoot[0] < 1e-3)  # ln(50) / (100/s), an integrator's exponential
    (0.039, True)
    """
    step = found.reference[-1]
    units = np.array([channel.unit for channel in found.coordinates])
    largest = np.array([np.max(np.abs(step[units == unit])) for unit in units])
    band = share * np.where(step != 0.0, np.abs(step), largest)
    error = found.true_error
    outside = np.abs(error) > band
    last = len(error) - np.argmax(outside[::-1], axis=0)
    times = np.append(found.times, np.inf)[np.where(np.any(outside, axis=0), last, 0)]
    beyond = (found.reference - error) / np.where(step != 0.0, step, np.nan) - 1.0
    moved = found.times >= start
    return StepFigures(
        coordinates=found.coordinates,
        band=band,
        settling=np.maximum(times - start, 0.0),
        overshoot=np.maximum(np.max(beyond[moved], axis=0), 0.0),
        undershoot=np.maximum(np.max(-1.0 - beyond[moved], axis=0), 0.0),
        residual=error[-1],
    )
