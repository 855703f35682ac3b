"""Coordinates of a loop: pose from gauge readings, and strokes from a commanded pose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array, first_design
from flexstage.base.record import INNER
from flexstage.base.units.quantity import LENGTH
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import Channel, LinearModel
from flexstage.models.linear.static import static_gain
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

_REFERENCE = 1.0
"""Frequency [Hz] that converts accelerations to displacements for motions without stiffness."""
_MISSING = 1e-9


@dataclass(frozen=True, eq=False)
class Coordinates:
    """The f coordinates of a loop: ideal motions xi of a stage (x ... rz, or a subset).

    `pose` (f, g) maps gauge readings to xi: it is the pseudo-inverse (R_s V)^+. V maps xi to platform motions, and R_s maps platform
    motions to readings. For six coordinates and six gauges, `pose` is R_s^-1 (equation 14 of Shin & Moon); for more gauges, it is a
    least-squares solution. `gauges` are the single gauges; sums of gauges are included in `pose`. `strokes` (n, f) maps xi to strokes: R_a
    (equation 13 of Shin & Moon). `back` (f, n) is the inverse or the pseudo-inverse of `strokes`. For force actuators, `back` is the static
    motion per unit input; its pseudo-inverse `strokes` gives the inputs [A, N] of minimum norm. `units` are m or rad; `length` [m] makes
    rotations comparable with translations. `gauge_units` and `input_units` are units of readings and inputs (default: m).
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    actuators: tuple[str, ...]
    gauges: tuple[str, ...]
    pose: Array
    strokes: Array
    back: Array
    length: Annotated[float, LENGTH]
    gauge_units: Annotated[tuple[str, ...], INNER] = ()
    input_units: Annotated[tuple[str, ...], INNER] = ()

    @property
    def scale(self) -> Array:
        """Factors (f,) that convert all coordinates to lengths: 1, and `length` for rotations."""
        return np.array([1.0 if unit == "m" else self.length for unit in self.units])

    @property
    def gaps(self) -> tuple[str, ...]:
        """Names of the plant's outputs for the gauges."""
        return tuple(f"gap.{name}" for name in self.gauges)

    @property
    def forced(self) -> bool:
        """Whether forces drive the stage."""
        return any(unit != "m" for unit in self.input_units)

    def motions(self, prefix: str = "") -> tuple[Channel, ...]:
        """Return one channel per coordinate, with a name prefix.

        >>> from flexstage.cases.parallelogram import parallelogram
        >>> from flexstage.models.ideal import ideal
        >>> coordinates(ideal(parallelogram())).motions("error.")
        (Channel(name='error.x', unit='m'),)
        """
        return _channels(prefix, self.names, self.units)

    def readings(self, prefix: str = "") -> tuple[Channel, ...]:
        """Return one channel per gauge, with a name prefix, in its unit."""
        return _channels(prefix, self.gauges, self.gauge_units)

    def commands(self, prefix: str = "") -> tuple[Channel, ...]:
        """Return one channel per actuator, with a name prefix, in the unit of its input."""
        return _channels(prefix, self.actuators, self.input_units)

    def controller_inputs(self) -> tuple[Channel, ...]:
        """Return the channels `error.<c>`, `pose.<c>` and `applied.<actuator>`."""
        return (*self.motions("error."), *self.motions("pose."), *self.commands("applied."))


def _channels(prefix: str, names: tuple[str, ...], units: tuple[str, ...]) -> tuple[Channel, ...]:
    """Channels with a name prefix; the default unit is m."""
    return tuple(Channel(f"{prefix}{name}", unit) for name, unit in zip(names, units or ("m",) * len(names), strict=True))


def coordinates(kinematics: Kinematics, model: LinearModel | None = None) -> Coordinates:
    """Compute the coordinates of the loop of a single stage. For force actuators, the elastic `model` provides the static motion.

    The inputs of force actuators follow from the pseudo-inverse of the static motion per unit input. Each loop's plant then has a static
    gain of 1, as for a stroke-driven stage. Raises `DesignError`, with the missing directions, if the gauges cannot observe the pose or the
    actuators cannot produce it. Stages that combine stroke and force actuators are also refused.

    >>> from flexstage.cases.double_triangle import SM_REF_A, double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> found = coordinates(ideal(double_triangle(SM_REF_A)))
    >>> found.names, found.pose[2, 3:].round(6).tolist()
    (('x', 'y', 'z', 'rx', 'ry', 'rz'), [0.333333, 0.333333, 0.333333])
    """
    units = tuple(TWIST_UNITS[COMPONENTS.index(name)] for name in kinematics.coordinates)
    scale = np.array([1.0 if unit == "m" else kinematics.first_length for unit in units])
    if kinematics.actuators and kinematics.thrusts:
        what = f"both strokes ({', '.join(kinematics.actuators)}) and forces ({', '.join(kinematics.thrusts)}) drive the stage"
        raise refuse("loop", what, "Use only strokes or only forces: allocation of commands between both is not supported")
    drive = np.real(first_design(kinematics.actuation, 2))
    pushed = np.real(first_design(kinematics.thrust, 2)).T if kinematics.thrusts else drive
    told = _even(kinematics)[:, None] * np.real(first_design(kinematics.seen, 2)) / scale
    require(
        [
            *_missing("actuators", pushed / scale, kinematics, "produce", "Add actuators, or lock degrees of freedom without an actuator"),
            *_missing("gauges", told, kinematics, "measure", "Add gauges, or rotate them so that every motion changes a reading"),
        ]
    )
    pose = np.linalg.pinv(told) * _even(kinematics)  # from all readings, in lengths
    if kinematics.sums:
        pose = pose @ np.real(first_design(kinematics.selection, 2))
    back = np.linalg.pinv(drive / scale) / scale[:, None]
    if kinematics.thrusts:
        back = _give(kinematics, model)
        drive = np.linalg.pinv(scale[:, None] * back) * scale
    return Coordinates(
        names=kinematics.coordinates,
        units=units,
        actuators=kinematics.thrusts or kinematics.actuators,
        gauges=kinematics.single_gauges,
        gauge_units=tuple(kinematics.reading_units[kinematics.gauges.index(name)] for name in kinematics.single_gauges),
        pose=pose / scale[:, None],
        strokes=drive,
        back=back,
        length=kinematics.first_length,
        input_units=kinematics.thrust_inputs,
    )


def _give(kinematics: Kinematics, model: LinearModel | None) -> Array:
    """Static motion of the coordinates (f, n) per unit input, by an elastic model; without stiffness the amplitude at `_REFERENCE`."""
    if model is None:
        raise refuse("loop", "force actuators need an elastic model for the stage's static motion", "Use the lumped model")
    twist = tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)
    if model.floating is None:
        gain = static_gain(model, twist, kinematics.thrusts).values
    else:
        rows, force = model.output[model.output_index(twist)], model.input_matrix[:, model.input_index(kinematics.thrusts)]
        gain = rows @ (model.solve(force) + model.floating @ (model.floating.T @ force) / (2.0 * np.pi * _REFERENCE) ** 2)
    return np.real(first_design(kinematics.projection @ gain, 2))


def _even(kinematics: Kinematics) -> Array:
    """Factors (t,) that make readings comparable: 1, and the stage's length for rotations."""
    units = dict(zip(kinematics.gauges, kinematics.reading_units, strict=True))
    return np.array([1.0 if units[name] == "m" else kinematics.first_length for name in kinematics.telling])


def _missing(kind: str, map_: Array, kinematics: Kinematics, verb: str, advice: str) -> list[Finding]:
    """Unobservable motions of a map (columns, all lengths), by the right null space."""
    count = len(kinematics.coordinates)
    if not count:
        return [Finding("loop", "the platform has no ideal motion to control", "Release degrees of freedom of the links")]
    _, values, rows = np.linalg.svd(np.vstack([map_, np.zeros((count, count))]))
    lost = rows[values[:count] <= _MISSING * max(values[0], _MISSING)]
    if not len(lost):
        return []
    shown = "; ".join(_direction(row, kinematics) for row in lost)
    number = len(kinematics.thrusts or kinematics.actuators) if kind == "actuators" else len(kinematics.telling)
    what = f"{number} {kind} {verb} {count - len(lost)} of the platform's {count} ideal motions; missing: {shown}"
    return [Finding(kind, what, advice)]


def _direction(row: Array, kinematics: Kinematics) -> str:
    """Format a motion with its largest component 1: rotations in rad per m if both occur."""
    size = np.array([1.0 if name[0] != "r" else 1.0 / kinematics.first_length for name in kinematics.coordinates])
    row = row * size
    largest = row[np.argmax(np.abs(row / size))]
    parts = [(value / largest, name) for value, name in zip(row, kinematics.coordinates, strict=True) if abs(value / largest) > 1e-6]
    return " ".join(f"{value:+.3g} {name}" if abs(value - 1.0) > 1e-9 else name for value, name in parts)
