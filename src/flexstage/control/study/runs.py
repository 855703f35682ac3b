"""Simulations of a loop along all trajectories of its set-up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar

import numpy as np
import scipy

from flexstage.analysis.workspace.drive import Drive, drive
from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.analysis.workspace.stroke import stacks as piezo_stacks
from flexstage.base.finding import Finding, require
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.number import Array, Table
from flexstage.base.record import INNER, VIEW, Heading, Layout, Mark, UnitIn
from flexstage.base.units.quantity import DISPLACEMENT, POWER, SHORT_TIME, SPEED, TEMPERATURE
from flexstage.control.learning.learn import LearningResult
from flexstage.control.learning.repeat import RepetitiveResult
from flexstage.control.plant_models.creep_plant import add_creep
from flexstage.control.plant_models.plants import ADDED
from flexstage.control.simulation.machine import Machine, machine
from flexstage.control.simulation.result import Excursion, Simulated, StepFigures, other_motions, step_figures, tracking
from flexstage.control.simulation.run import simulate
from flexstage.control.study.choices import Compensation
from flexstage.control.study.control import Control
from flexstage.control.study.course import NamedTrajectory, course_findings, course_warnings, courses, sampled_course
from flexstage.control.study.disturbed import DisturbedLoop, rest_time
from flexstage.control.study.follow import follow
from flexstage.control.study.resolve import ResolvedSetup
from flexstage.control.study.stacks import Stacks
from flexstage.control.systems.closed import Loop
from flexstage.mechanism.assembly.expand import expand
from flexstage.parts.actuator import ThrustActuator

_BAND = 0.02
_STILL, _FEWEST, _MOST = 5.0, 5_000, 50_000
_REPEATED = 6
_ROUNDING = 1e-16


def _settled(time: float) -> Mark:
    return Mark.PLAIN if np.isfinite(time) else Mark.FAIL


@dataclass(frozen=True, eq=False)
class StepAnswer:
    """Response of one coordinate to a step of `size` [`unit`], with its `settling` time [s] (infinite: not settled).

    `overshoot` is a fraction of the step. `residual` [`unit`] is the true error at the end. `others` are the largest motions along all
    other platform axes. `largest` (f,) [m, rad] are the largest true errors of all coordinates.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Steps",
        "size settling overshoot residual cross_axis_error",
        head="step",
        notes=(
            (
                "After the settling time, the true error stays within 2 % of the step. The cross-axis error is the largest translation "
                "and rotation along all other axes of the platform, at any time."
            ),
        ),
    )

    size: Annotated[float, UnitIn("unit"), Heading(digits=4)]
    unit: str
    settling: Annotated[float, SHORT_TIME, Heading("settling time (2 %)", digits=4, infinite="not settled", mark=_settled)]
    overshoot: Annotated[float, Heading(digits=3, unit="%")]
    residual: Annotated[float, UnitIn("unit"), Heading("residual error", digits=3)]
    others: Mapping[str, Excursion]
    largest: Annotated[Array, VIEW]

    @property
    def cross_axis_error(self) -> Annotated[tuple[str, ...], INNER, Heading("cross-axis error")]:
        """Largest translation and largest rotation along other axes. Values below 0.1 fm or frad are rounding errors and are omitted."""
        largest = {
            each.unit: max((other.largest, name) for name, other in self.others.items() if other.unit == each.unit)
            for each in self.others.values()
        }
        return tuple(f"{1e9 * value:.3g} n{unit} {name}" for unit, (value, name) in largest.items() if value > _ROUNDING)


@dataclass(frozen=True)
class CoilHeat:
    """Thermal load of a force actuator in a repeated trajectory: its rms input `rms`, and its limit `held` for continuous input.

    Both have the unit `unit`. `power` [W] is the dissipated power, `warming` [K] the steady temperature rise; both are absent without data.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Heat of force actuators",
        "rms held power warming",
        head="trajectory, actuator",
        notes=("Each trajectory is repeated indefinitely, with the simulated rest at its end. Cooling by the motion is neglected.",),
    )

    rms: Annotated[float, UnitIn("unit"), Heading("rms input", digits=3)]
    unit: str
    held: Annotated[float | None, UnitIn("unit"), Heading("continuous limit", digits=3)]
    power: Annotated[float | None, POWER, Heading("heat", digits=3)]
    warming: Annotated[float | None, TEMPERATURE, Heading("temperature rise", digits=3)]


@dataclass(frozen=True)
class LegUse:
    """Amplifier load [m]: the largest stroke `added` by force feedback, and the `largest` total stroke (controller plus force feedback).

    `fastest` [m/s] is the largest rate of the total stroke between samples. `reach` [m] is the amplifier's stroke limit in the direction of
    the largest stroke, `slew` [m/s] its rate limit (infinite: no limit).
    """

    TABLE: ClassVar[Layout] = Layout(
        "Force feedback and amplifiers",
        "added stroke_share speed_share is_held",
        head="trajectory, actuator",
        notes=(
            (
                "Total stroke and speed (controller plus force feedback), relative to the amplifier's limits, which the simulation does "
                "not apply."
            ),
        ),
    )

    added: Annotated[float, DISPLACEMENT, Heading("largest added stroke", digits=3, varying=True)]
    largest: Annotated[float, DISPLACEMENT]
    reach: Annotated[float, DISPLACEMENT]
    fastest: Annotated[float, SPEED]
    slew: Annotated[float, SPEED]

    @property
    def is_held(self) -> Annotated[bool, VIEW, Heading("within limits", mark={True: Mark.PASS, False: Mark.FAIL}.__getitem__)]:
        """Whether stroke and speed are within the amplifier's limits."""
        return self.largest <= self.reach and self.fastest <= self.slew

    @property
    def stroke_share(self) -> Annotated[float, INNER, Heading("stroke / limit", digits=3, unit="%")]:
        """Largest total stroke, divided by the amplifier's limit."""
        return self.largest / self.reach

    @property
    def speed_share(self) -> Annotated[float | None, INNER, Heading("speed / limit", digits=3, unit="%")]:
        """Largest rate of the total stroke, divided by the amplifier's limit; absent without a limit."""
        return None if np.isinf(self.slew) else self.fastest / self.slew


@dataclass(frozen=True, eq=False)
class Run:
    """Simulated trajectory: the `figures` of a step, and the rms and peak `tracking` errors, true and as measured by the gauges.

    `learned` and `repeated` are results of iterative learning and repetitive control, if specified. `heat` is the thermal load of force
    actuators by name, `legs` the amplifier load with force feedback. `commanded` (n, f) is the commanded path if it differs from the
    trajectory; it contains samples of rest before and after the trajectory.
    """

    course: NamedTrajectory
    simulated: Simulated
    figures: Annotated[StepFigures | None, INNER]
    tracking: Matrix
    warnings: Annotated[tuple[Finding, ...], INNER] = ()
    learned: LearningResult | None = None
    repeated: RepetitiveResult | None = None
    heat: Mapping[str, CoilHeat] = field(default_factory=lambda: Table({}))
    legs: Mapping[str, LegUse] = field(default_factory=lambda: Table({}))
    commanded: Annotated[Array | None, INNER] = None

    @property
    def seconds(self) -> Annotated[float, VIEW]:
        """Simulated duration [s]."""
        times = self.simulated.times
        return float(times[-1] + (times[1] - times[0]))

    @property
    def step(self) -> Annotated[StepAnswer | None, VIEW]:
        """Step response; null for other trajectories."""
        if self.figures is None:
            return None
        seen, index = self.simulated, self.index
        channel = seen.coordinates[index]
        return StepAnswer(
            size=float(seen.reference[-1, index]),
            unit=channel.unit,
            settling=float(self.figures.settling[index]),
            overshoot=float(self.figures.overshoot[index]),
            residual=float(self.figures.residual[index]),
            others=other_motions(seen, channel.name),
            largest=np.max(np.abs(seen.true_error), axis=0),
        )

    @property
    def index(self) -> int:
        """Index of the first moved coordinate."""
        return [channel.name for channel in self.simulated.coordinates].index(self.course.moved[0])


def runs(given: ResolvedSetup, control: Control, closed: Loop, stacks: Stacks | None = None) -> tuple[Run, ...]:
    """Simulate all trajectories of a set-up.

    Steps are simulated without noise, other trajectories with noise. Gauge resolution and amplifier limits apply. The stacks have the
    hysteresis of `stacks`, compensated by the inverse model if specified. A loop is simulated until it has settled (see `rest_time`), or
    for the set-up's duration. Strokes that compensate for loads reduce the available range. Raises `DesignError` for unknown coordinates,
    and for trajectories beyond the strokes.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.control.systems.closed import loop
    >>> from flexstage.control.study.control import make_controller
    >>> from flexstage.control.study.resolve import resolve
    >>> from flexstage.control.study.setup import ControllerSetup, LoopSetup
    >>> given = resolve(parallelogram(), LoopSetup(controller=ControllerSetup(integral=300.0)))
    >>> control = make_controller(given, given.plant.coordinates.strokes)
    >>> found = runs(given, control, loop(given.plant, control.system))
    >>> found[0].course.name, bool(found[0].figures.settling[0] < 0.03)
    ('x', True)
    """
    loop = given.plant.coordinates
    asked = courses(given.setup.trajectory, loop)
    rest = rest_time(closed, ringing=Compensation.REFERENCE in given.setup.compensate)
    sampled = []
    for each in asked:
        still = rest if each.is_step else min(rest, 0.2 * each.duration)
        sampled.append(sampled_course(each, loop, given.step, given.setup.seconds or each.duration + still))
    units = tuple(each.unit for each in loop.commands())
    gains = Matrix(control.gains, loop.actuators, loop.names, ratio_units(units, loop.units))
    computed = driven_machine(given, control, stacks)
    powers = computed.amplifiers
    limits = StrokeLimits(loop.actuators, powers.low, powers.high)
    require(
        finding
        for course, (times, poses) in zip(asked, sampled, strict=True)
        for finding in course_findings(course, poses, times, gains, limits)
    )
    slew, noisy, found = powers.slew, DisturbedLoop(given, computed, rest), []
    for course, (times, poses) in zip(asked, sampled, strict=True):
        warnings = tuple(course_warnings(course, poses, times, gains, slew, units=units))
        taught = {}
        if given.setup.follow is not None:
            simulated, taught = follow(given.setup.follow, closed, poses, course, noisy=noisy)
        else:
            simulated = simulate(computed, poses) if course.is_step else noisy.simulate(poses)
        figures = step_figures(simulated, _BAND) if course.is_step else None
        warnings += tuple(_range_warnings(course, simulated, computed))
        found.append(Run(course, simulated, figures, tracking(simulated), warnings, **taught))
    return tuple(_with_legs(_with_heat(given, run), computed) for run in found)


def _with_heat(given: ResolvedSetup, run: Run) -> Run:
    """Run with the load of its force actuators; a warning above their continuous limit."""
    assembly, heat, warnings = expand(given.mechanism), {}, []
    for number, channel in enumerate(given.plant.coordinates.commands()):
        if channel.name not in assembly.thrusts or not isinstance(part := assembly.actuator(channel.name), ThrustActuator):
            continue
        rms = float(np.sqrt(np.mean(run.simulated.given[:, number] ** 2)))
        ends = [float(each.held) for each in part.limits if each.held is not None]
        losses = (None if each is None else float(each) for each in (part.loss(rms), part.warming(rms)))
        heat[channel.name] = CoilHeat(rms, channel.unit, min(ends, default=None), *losses)
        if ends and rms > min(ends):
            most = f"{min(ends):.3g} {channel.unit} or less"
            what = f"the rms input of {channel.name} is too large (got {rms:.3g} {channel.unit}, expected {most})"
            warnings.append(Finding(f"trajectory {run.course.name}", what, "Pause between trajectories, or reduce the amplitude"))
    return replace(run, heat=Table(heat), warnings=(*run.warnings, *warnings)) if heat else run


def _with_legs(run: Run, computed: Machine) -> Run:
    """Run with the amplifier load of inner loops; a warning beyond the limits, which the simulation does not apply."""
    seen, powers = run.simulated, computed.amplifiers
    channels = [channel.name for channel in seen.channels]
    used, warnings = {}, []
    for number, name in enumerate(seen.actuators):
        if f"{ADDED}.{name}" not in channels:
            continue
        added = seen.motions[:, channels.index(f"{ADDED}.{name}")]
        both = seen.given[:, number] + added
        high, low = max(powers.high[number], _ROUNDING), min(powers.low[number], -_ROUNDING)
        place = int(np.argmax(np.maximum(both / high, both / low)))
        reach = abs(float(high if both[place] > 0.0 else low))
        fastest = float(np.max(np.abs(np.diff(both)), initial=0.0)) / computed.step
        used[name] = LegUse(float(np.max(np.abs(added))), abs(float(both[place])), reach, fastest, float(powers.slew[number]))
        if not used[name].is_held:
            what = f"with force feedback, {name} needs {1e6 * used[name].largest:.4g} um (limit {1e6 * reach:.4g} um)"
            rates = f"and {1e3 * fastest:.4g} mm/s (limit {1e3 * used[name].slew:.4g} mm/s), but the simulation does not apply these limits"
            warnings.append(Finding(f"trajectory {run.course.name}", f"{what} {rates}", "Reduce the amplitude, the speed or the damping"))
    return replace(run, legs=Table(used), warnings=(*run.warnings, *warnings)) if used else run


def driven_machine(given: ResolvedSetup, control: Control, stacks: Stacks | None = None) -> Machine:
    """Build the simulation model of a loop: hardware with limits and quantisation, and hysteretic `stacks`, with creep if specified.

    The amplifiers' bias includes the strokes of load feedforward; limits are relative to this bias.
    """
    if stacks is None:
        found = machine(given.plant, control.system, _electric(given))
    else:
        inverted = stacks.model if Compensation.HYSTERESIS in given.setup.compensate else None
        plant = given.plant if stacks.creep is None else add_creep(given.plant, stacks.creep)
        found = machine(plant, control.system, stacks.electric, hysteresis=stacks.plant, compensation=inverted)
    powers, taken = found.amplifiers, given.carried
    shifted = replace(powers, low=powers.low - taken, high=powers.high - taken, bias=powers.bias + taken / powers.gain)
    return replace(found, amplifiers=shifted)


def _electric(given: ResolvedSetup) -> Drive | None:
    """Voltages of the stacks, if all have data."""
    piezos = dict(piezo_stacks(given.mechanism))
    stated = all(each.voltage_low is not None and each.voltage_high is not None for each in piezos.values())
    return drive(given.mechanism) if stated and piezos and tuple(piezos) == given.plant.actuators else None


def simulate_rest(given: ResolvedSetup, control: Control, closed: Loop) -> Simulated | None:
    """Simulate the steady state of the loop in regulation, with all noise; `None` if rounding is the only noise."""
    hardware = given.plant.hardware
    noisy = given.floor or any(each.noise_density for each in (*hardware.sensors.values(), *hardware.amplifiers.values()))
    if not noisy:
        return None
    noisy, count = _resting_loop(given, control, closed)
    return noisy.simulate(np.zeros((count, len(given.plant.coordinates.names))))


def _resting_loop(given: ResolvedSetup, control: Control, closed: Loop) -> tuple[DisturbedLoop, int]:
    """Loop with its noise, and the samples of a regulation simulation."""
    rest = rest_time(closed)
    return DisturbedLoop(given, driven_machine(given, control), rest), int(np.clip((_STILL * rest) / given.step, _FEWEST, _MOST))


@dataclass(frozen=True, eq=False)
class RestRms:
    """Rms (f,) of the true motion of each of f coordinates in regulation, from independent simulations.

    `low` and `high` (f,) are the 95 % confidence limits, from the scatter of `count` simulations that last `seconds` each.
    """

    rms: Array
    low: Array
    high: Array
    count: int
    seconds: float


def rest_rms(given: ResolvedSetup, control: Control, closed: Loop) -> RestRms:
    """Compute the rms in regulation from several simulations with independent random numbers, for rounding that is not white noise.

    Each simulation regulates at a different pose within the gauges' resolution steps. The motion is small if a reading is in the middle of
    a resolution step; near an edge it is larger, because the reading alternates between two values.
    """
    (noisy, whole), to_pose, squares = _resting_loop(given, control, closed), given.plant.coordinates.pose, list[Array]()
    count = whole // 3
    for number in range(_REPEATED):
        within = (
            np.random.default_rng([given.setup.seed + number, _REPEATED]).uniform(-0.5, 0.5, to_pose.shape[1]) * noisy.machine.resolution
        )
        held = to_pose @ within
        found = noisy.simulate(np.tile(held, (count, 1)), number, held)
        squares.append(np.mean(found.true_error**2, axis=0))
    mean = np.mean(squares, axis=0)
    reach = scipy.special.stdtrit(_REPEATED - 1, 0.975) * np.std(squares, axis=0, ddof=1) / np.sqrt(_REPEATED)
    low, high = np.sqrt(np.maximum(mean - reach, 0.0)), np.sqrt(mean + reach)
    return RestRms(np.sqrt(mean), low, high, _REPEATED, count * given.step)


def _range_warnings(course: NamedTrajectory, found: Simulated, computed: Machine) -> Iterator[Finding]:
    """Warnings for gauges beyond their range."""
    for read, share, reach in zip(computed.read(), found.out_of_range, computed.reach, strict=True):
        if share > 0.0:
            what = f"{read.name} exceeds its range of +-{1e6 * reach:.4g} u{read.unit} in {100.0 * share:.3g} % of the samples"
            advice = "Reduce the amplitude, or use a gauge with a larger range: out of range, the loop uses the last valid reading"
            yield Finding(f"trajectory {course.name}", what, advice)
