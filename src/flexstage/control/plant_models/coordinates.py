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
"""Frequency [Hz] by which accelerations of motions without stiffness are compared with displacements."""
_MISSING = 1e-9


@dataclass(frozen=True, eq=False)
class Coordinates:
    """The f coordinates a loop holds: a stage's ideal motions xi (x ... rz, or those of them it has).

    `pose` (f, g) gives xi from gauge readings, (R_s V)^+: R_s^-1 of Eq. 14 of Shin & Moon for six gauges, least squares for more. Sums of
    gauges are part of it: `gauges` are the single ones. `strokes` (n, f) gives strokes from xi, R_a of Eq. 13; `back` (f, n) is its
    (least-squares) inverse. Of force actuators `back` is the motion at rest per unit of input and `strokes` its pseudo-inverse, the least
    inputs [A, N] that hold xi. `units` are m or rad, `length` [m] makes rotations comparable with translations. `gauge_units` and
    `input_units` are those of readings and inputs (absent: m).
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
        """Factors (f,) that make all coordinates lengths: 1, and `length` for rotations."""
        return np.array([1.0 if unit == "m" else self.length for unit in self.units])

    @property
    def forced(self) -> bool:
        """Whether forces drive the stage."""
        return any(unit != "m" for unit in self.input_units)

    def motions(self, prefix: str = "") -> tuple[Channel, ...]:
        """Channels of the coordinates, named with a prefix.

        >>> from flexstage.cases.parallelogram import parallelogram
        >>> from flexstage.models.ideal import ideal
        >>> coordinates(ideal(parallelogram())).motions("error.")
        (Channel(name='error.x', unit='m'),)
        """
        return tuple(Channel(f"{prefix}{name}", unit) for name, unit in zip(self.names, self.units, strict=True))

    def readings(self, prefix: str = "") -> tuple[Channel, ...]:
        """A channel a gauge, its name behind a prefix, in its unit."""
        units = self.gauge_units or ("m",) * len(self.gauges)
        return tuple(Channel(f"{prefix}{name}", unit) for name, unit in zip(self.gauges, units, strict=True))

    def commands(self, prefix: str = "") -> tuple[Channel, ...]:
        """A channel an actuator, its name behind a prefix, in the unit of its input."""
        units = self.input_units or ("m",) * len(self.actuators)
        return tuple(Channel(f"{prefix}{name}", unit) for name, unit in zip(self.actuators, units, strict=True))

    def controller_inputs(self) -> tuple[Channel, ...]:
        """`error.<c>`, `pose.<c>` and `applied.<actuator>`."""
        return (*self.motions("error."), *self.motions("pose."), *self.commands("applied."))


def coordinates(kinematics: Kinematics, model: LinearModel | None = None) -> Coordinates:
    """The coordinates of a stage's loop (one design). Force actuators move as far as the elastic `model` gives way.

    Their inputs are (V^T W)^+ times the force that the pose takes at rest, so each loop's plant has a static gain of 1, as with strokes.
    Raises `DesignError` where the gauges do not tell the pose or the actuators cannot make it, with the directions that are missing, and
    for strokes and forces together.

    >>> from flexstage.cases.double_triangle import SM_REF_A, double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> found = coordinates(ideal(double_triangle(SM_REF_A)))
    >>> found.names, found.pose[2, 3:].round(6).tolist()
    (('x', 'y', 'z', 'rx', 'ry', 'rz'), [0.333333, 0.333333, 0.333333])
    """
    units = tuple(TWIST_UNITS[COMPONENTS.index(name)] for name in kinematics.coordinates)
    scale = np.array([1.0 if unit == "m" else kinematics.first_length for unit in units])
    require(_mixture(kinematics))
    drive = np.real(first_design(kinematics.actuation, 2))
    pushed = np.real(first_design(kinematics.thrust, 2)).T if kinematics.thrusts else drive
    told = _even(kinematics)[:, None] * np.real(first_design(kinematics.seen, 2)) / scale
    require(
        [
            *_missing("actuators", pushed / scale, kinematics, "make", "Add actuators, or lock the freedoms they cannot move"),
            *_missing("gauges", told, kinematics, "tell", "Add gauges, or turn them so that every motion changes a reading"),
        ]
    )
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
        pose=_pose(kinematics, told) / scale[:, None],
        strokes=drive,
        back=back,
        length=kinematics.first_length,
        input_units=kinematics.thrust_inputs,
    )


def _mixture(kinematics: Kinematics) -> list[Finding]:
    if not kinematics.actuators or not kinematics.thrusts:
        return []
    what = f"strokes ({', '.join(kinematics.actuators)}) and forces ({', '.join(kinematics.thrusts)}) drive the stage"
    return [Finding("loop", what, "Leave out one sort: how a loop shares its commands between the two is not known here")]


def _give(kinematics: Kinematics, model: LinearModel | None) -> Array:
    """Motion of the coordinates (f, n) per unit input at rest, by an elastic model; without stiffness the amplitude at `_REFERENCE`."""
    if model is None:
        raise refuse("loop", "forces move a stage as far as it gives way, and no elastic model is given", "Give its lumped model")
    twist = tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)
    if model.floating is None:
        gain = np.asarray(static_gain(model, twist, kinematics.thrusts).values)
    else:
        rows, force = model.output[model.output_index(twist)], model.input_matrix[:, model.input_index(kinematics.thrusts)]
        gain = rows @ (model.solve(force) + model.floating @ (model.floating.T @ force) / (2.0 * np.pi * _REFERENCE) ** 2)
    return np.real(first_design(kinematics.projection @ gain, 2))


def _even(kinematics: Kinematics) -> Array:
    """Factors (t,) that make readings comparable: 1, and the stage's length for rotations."""
    units = dict(zip(kinematics.gauges, kinematics.reading_units, strict=True))
    return np.array([1.0 if units[name] == "m" else kinematics.first_length for name in kinematics.telling])


def _pose(kinematics: Kinematics, told: Array) -> Array:
    """Coordinates (f, s), all lengths, from readings of single gauges; `told` are all comparable readings from coordinates."""
    pose = np.linalg.pinv(told) * _even(kinematics)
    return pose @ np.real(first_design(kinematics.selection, 2)) if kinematics.sums else pose


def _missing(kind: str, map_: Array, kinematics: Kinematics, verb: str, advice: str) -> list[Finding]:
    """Motions (columns, all lengths) that a map does not see, by the right null space."""
    count = len(kinematics.coordinates)
    if not count:
        return [Finding("loop", "the platform has no ideal motion to be controlled", "Free the freedoms that its links should have")]
    _, values, rows = np.linalg.svd(np.vstack([map_, np.zeros((count, count))]))
    lost = rows[values[:count] <= _MISSING * max(values[0], _MISSING)]
    if not len(lost):
        return []
    shown = "; ".join(_direction(row, kinematics) for row in lost)
    number = len(kinematics.thrusts or kinematics.actuators) if kind == "actuators" else len(kinematics.telling)
    what = f"{number} {kind} {verb} {count - len(lost)} of the platform's {count} ideal motions; missing: {shown}"
    return [Finding(kind, what, advice)]


def _direction(row: Array, kinematics: Kinematics) -> str:
    """A motion in words, its largest part made 1: rotations in rad per m where both occur."""
    size = np.array([1.0 if name[0] != "r" else 1.0 / kinematics.first_length for name in kinematics.coordinates])
    row = row * size
    largest = row[np.argmax(np.abs(row / size))]
    parts = [(value / largest, name) for value, name in zip(row, kinematics.coordinates, strict=True) if abs(value / largest) > 1e-6]
    return " ".join(f"{value:+.3g} {name}" if abs(value - 1.0) > 1e-9 else name for value, name in parts)
