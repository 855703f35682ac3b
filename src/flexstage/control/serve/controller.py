"""Controller of a stage's running loop, without a protocol: targets, velocities, wave generators, recorder."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.base.finding import DesignError
from flexstage.base.number import Array
from flexstage.control.robustness.stability import require_stable
from flexstage.control.serve.errors import Code, CommandError
from flexstage.control.serve.recorder import POSITION, TABLES, Recorder
from flexstage.control.simulation.noise import noise_series
from flexstage.control.simulation.running import RunningLoop
from flexstage.control.study.choices import Compensation
from flexstage.control.study.disturbed import rest_time
from flexstage.control.study.resolve import resolve
from flexstage.control.study.rest import rest_errors
from flexstage.control.study.retained import control_and_modes
from flexstage.control.study.runs import driven_machine
from flexstage.control.study.setup import LoopSetup
from flexstage.control.study.stacks import stacks_of
from flexstage.control.study.study import pose_gains
from flexstage.control.systems.closed import loop
from flexstage.mechanism.mechanism import Mechanism

_MICRO = 1e6
_NOISE = 65_536
_CROSSING = 10.0
"""Travel ranges per second of an axis at its initial velocity."""
_TOLERANCE, _WINDOW = 1e-4, 0.01
"""On-target tolerance: fraction of the travel, at least two steps of the gauges; and its time window [s]."""
_LARGEST = 1e300
_UNLIMITED = 1e-3
"""Travel [m, rad] of an axis whose actuators have no limit."""


@dataclass
class Generator:
    """Wave generator: number of its wave `table` (0: none), `cycles` (0: endless), samples per point `rate`, and `offset` [um, urad].

    `at` is the next sample of the wave (None: the generator is stopped). If `is_straight`, values are interpolated between points.
    """

    table: int = 0
    cycles: int = 0
    rate: int = 1
    is_straight: bool = False
    offset: float = 0.0
    at: int | None = None


class StageController:
    """Simulated closed-loop stage, in micrometres and microradians; `advance` continues the simulation.

    Raises `DesignError` in the same cases as `resolve` and `control_and_modes`, and for an unstable loop.
    """

    def __init__(self, mechanism: Mechanism, setup: LoopSetup | None = None) -> None:
        given = resolve(mechanism, setup or LoopSetup())
        lost = None if given.kinematics.thrusts else lost_motion(given.kinematics, given.model)
        gains = pose_gains(given, lost)
        if lost is not None and Compensation.LOAD in given.setup.compensate:
            given = replace(given, carried=rest_errors(given, lost).load_strokes)
        given, control, _ = control_and_modes(given, gains)
        closed = loop(given.plant, control.system)
        require_stable(closed, "simulation")
        stacks = None if given.setup.hysteresis is None else stacks_of(mechanism, given.setup.hysteresis)
        self.name = mechanism.name or "stage"
        self.running = RunningLoop(driven_machine(given, control, stacks), noise_series(given.plant, given.floor, _NOISE, given.setup.seed))
        machine = self.running.machine
        self.axes = tuple(name.replace(".", "_")[:16] for name in machine.names)
        self.units = tuple("um" if each.unit == "m" else "urad" for each in machine.coordinates)
        self.step = machine.step
        ends, reach = machine.amplifiers, np.where(machine.reach < _LARGEST, machine.reach, np.inf)
        self._gains = np.vstack([gains, np.linalg.pinv(machine.pose)])
        self._ends = np.concatenate([ends.low, -reach]), np.concatenate([ends.high, reach])
        self.low, self.high = _travel(self._gains, *self._ends)
        self.tolerance = np.maximum(_TOLERANCE * (self.high - self.low), 2.0 * _MICRO * np.abs(machine.pose) @ machine.resolution)
        count = len(self.axes)
        self.velocity = _CROSSING * (self.high - self.low)
        self.is_ramped = np.ones(count, dtype=bool)
        self.held = np.zeros(count, dtype=bool)
        self.target, self._wanted, self.position = (np.zeros(count) for _ in range(3))
        self.tables: dict[int, Array] = {}
        self.generators = [Generator() for _ in range(count)]
        self.recorder = Recorder([table % count for table in range(TABLES)], [POSITION if table < count else 0 for table in range(TABLES)])
        self._off_target = np.zeros(count, dtype=int)
        self.volts = np.zeros(len(machine.actuators))
        self.readings = np.zeros(len(machine.gauges))
        self.is_lost = False
        """Whether the simulation has diverged since the last query."""
        self.advance(int(rest_time(closed) / self.step))

    @property
    def seconds(self) -> float:
        """Simulated time [s]."""
        return self.running.count * self.step

    @property
    def moving(self) -> Array:
        """Whether the commanded motion of each axis (f,) is still in progress."""
        return np.array([each.at is not None for each in self.generators]) | (self.held & (self._wanted != self.target))

    @property
    def on_target(self) -> Array:
        """Whether each axis (f,) has been within `tolerance` of its target for a hundredth of a second."""
        return self.held & ~self.moving & (self._off_target * self.step >= _WINDOW)

    # --- commands ---

    def hold(self, axis: int, *, on: bool) -> None:
        """Switch the servo of an axis on or off; switching on sets the target to the present position."""
        if on and not self.held[axis]:
            self.target[axis] = self._wanted[axis] = self.position[axis]
        if not on:
            self.generators[axis].at = None
        self.held[axis] = on

    def move(self, targets: dict[int, float]) -> None:
        """Move axes to `targets` [um, urad]. If one target is refused, no axis moves."""
        if any(self.generators[axis].at is not None for axis in targets):
            raise CommandError(Code.WAVE_GENERATOR_ACTIVE)
        if not all(self.held[axis] for axis in targets):
            raise CommandError(Code.SERVO_OFF)
        self.target = self._reachable(targets)

    def jump(self, axis: int, way: float) -> None:
        """Step one axis by `way` [um, urad] at once, regardless of its velocity setting, and start the recorder."""
        self.move({axis: self.target[axis] + way})
        self._wanted[axis] = self.target[axis]
        self.recorder.start()

    def stop(self) -> None:
        """Stop all axes and wave generators, at the present commanded positions."""
        for each in self.generators:
            each.at = None
        self.target = self._wanted.copy()

    def generate(self, axis: int) -> None:
        """Start the wave generator of an axis."""
        one = self.generators[axis]
        if one.table not in self.tables:
            raise CommandError(Code.NO_WAVE_SELECTED)
        if not self.held[axis]:
            raise CommandError(Code.SERVO_OFF)
        for end in (np.min(self.tables[one.table]), np.max(self.tables[one.table])):
            self._reachable({axis: end + one.offset})
        one.at = 0

    def _reachable(self, targets: dict[int, float]) -> Array:
        """Pose with new targets of some axes; refuses a pose beyond the range of one axis, the strokes together, or a gauge."""
        wanted = self.target.copy()
        for axis, value in targets.items():
            wanted[axis] = value
        low, high = self._ends
        needed = self._gains @ (wanted / _MICRO)
        slack = 1e-9 * (self.high - self.low)
        bounds = ((wanted, self.low - slack, self.high + slack), (needed, low - 1e-9 * np.abs(low), high + 1e-9 * np.abs(high)))
        if any(np.any((values < least) | (values > most)) for values, least, most in bounds):
            raise CommandError(Code.POSITION_OUT_OF_LIMITS)
        return wanted

    # --- time ---

    def advance(self, count: int) -> None:
        """Simulate `count` samples. If the simulation diverges, the loop is reset and all servos are switched off."""
        if count < 1:
            return
        wanted = np.stack([self._course(axis, count) for axis in range(len(self.axes))], axis=-1)
        try:
            found = self.running.advance(wanted / _MICRO, self.held)
        except DesignError:
            self.is_lost = True
            for axis in range(len(self.axes)):
                self.hold(axis, on=False)
            for each in (self.target, self._wanted, self.position):
                each[:] = 0.0
            return
        poses, amplifiers = found.pose * _MICRO, self.running.machine.amplifiers
        self.position, self.readings = poses[-1], found.readings[-1]
        self._wanted = np.where(self.held, wanted[-1], self.position)
        self.target = np.where(self.held, self.target, self.position)
        off = np.abs(poses - self.target) > self.tolerance
        since = np.argmax(off[::-1], axis=0)
        self._off_target = np.where(np.any(off, axis=0), since, self._off_target + count)
        volts = amplifiers.bias + found.given / amplifiers.gain
        self.volts = volts[-1]
        self.recorder.take(found, _MICRO, volts)

    def _course(self, axis: int, count: int) -> Array:
        """Commanded trajectory of an axis [um, urad] for the next samples."""
        one = self.generators[axis]
        if one.at is not None:
            return self._wave(axis, one, one.at, count)
        way = self.target[axis] - self._wanted[axis]
        if way == 0.0 or not self.is_ramped[axis]:
            return np.full(count, self.target[axis])
        gone = self.velocity[axis] * self.step * np.arange(1, count + 1)
        return np.where(gone < abs(way), self._wanted[axis] + np.sign(way) * gone, self.target[axis])

    def _wave(self, axis: int, one: Generator, start: int, count: int) -> Array:
        points = self.tables[one.table]
        length = len(points) * one.rate
        at = start + np.arange(count)
        if one.cycles:
            at = np.minimum(at, one.cycles * length - 1)
        place, between = np.divmod(at % length, one.rate)
        found = points[place]
        if one.is_straight:
            found = found + (points[(place + 1) % len(points)] - found) * between / one.rate
        one.at = None if one.cycles and start + count >= one.cycles * length else start + count
        course = found + one.offset
        self.target[axis] = course[-1]
        return course

    @property
    def has_volts(self) -> bool:
        """Whether all stacks have voltage data."""
        return bool(np.all(np.isfinite(self.running.machine.amplifiers.gain)))


def _travel(gains: Array, low: Array, high: Array) -> tuple[Array, Array]:
    """Ends (f,) [um, urad] of each axis alone, by the strokes or inputs and the readings (n,) that it requires."""
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = low[:, None] / gains, high[:, None] / gains
    used = np.abs(gains) > 1e-12 * np.max(np.abs(gains), axis=0)
    upper = np.min(np.where(used, np.maximum(one, other), np.inf), axis=0)
    lower = np.max(np.where(used, np.minimum(one, other), -np.inf), axis=0)
    return (np.where(np.isfinite(lower), lower, -_UNLIMITED) * _MICRO, np.where(np.isfinite(upper), upper, _UNLIMITED) * _MICRO)
