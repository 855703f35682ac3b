"""Platform strokes from actuator strokes: single-axis and simultaneous."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number, first_design, magnitude, matvec, stack
from flexstage.base.record import VIEW, Along, Heading, Layout
from flexstage.base.session import SESSION
from flexstage.base.units.quantity import DISPLACEMENT, LENGTH, RATIO, SHARE, Bound
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.assembly.incidence import layout, twist_at
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.linear.kinematics import Kinematics
from flexstage.parts.actuator import ChargedActuator, StrokeActuator
from flexstage.spatial.frame import COMPONENTS, MOTION, Frame


@dataclass(frozen=True, eq=False)
class StrokeLimits:
    """Stroke limits `low` to `high` (..., n) [m] of each actuator, relative to its bias (or mid-range).

    `zero` (..., n) is the stroke at zero voltage, relative to the bias (default: equal to `low`).
    """

    actuators: tuple[str, ...]
    low: Annotated[Array, LENGTH, Along("actuators")]
    high: Annotated[Array, LENGTH, Along("actuators")]
    zero: Annotated[Array | None, LENGTH, Along("actuators")] = None

    @property
    def full(self) -> Array:
        """Full stroke (..., n) [m]: `high` minus `low`."""
        return self.high - self.low

    @cached_property
    def from_zero(self) -> StrokeLimits:
        """Stroke limits relative to zero voltage, for a stage assembled without voltage."""
        zero = self.low if self.zero is None else self.zero
        return StrokeLimits(self.actuators, self.low - zero, self.high - zero, np.zeros_like(self.low - zero))

    def swing(self, gains: Array) -> tuple[Array, Array]:
        """Return the least and largest values (..., r) of linear functions of the strokes with the `gains` (..., r, n)."""
        ends = [gains * each[..., None, :] for each in (self.low, self.high)]
        return np.sum(np.minimum(*ends), axis=-1), np.sum(np.maximum(*ends), axis=-1)

    @property
    def corners(self) -> Array:
        """All 2^n combinations of least and largest strokes (..., 2^n, n) [m]. Raises `DesignError` for more than 12 actuators."""
        count = len(self.actuators)
        if count > 12:
            raise refuse("stroke corners", f"{count} actuators have {2**count} corners, which are too many", "Use single strokes")
        high = (np.arange(2**count)[:, None] >> np.arange(count)) & 1 == 1
        return np.where(high, self.high[..., None, :], self.low[..., None, :])

    def points(self, depth: int) -> Array:
        """Return the corners (2^n, ..., n) with at least `depth` batch axes, so that they broadcast with a batch of designs."""
        return beside(np.moveaxis(self.corners, -2, 0), depth)


class SingleAxis(Result):
    """Strokes of the platform along one coordinate with the other coordinates at zero, from `low` to `high` (..., f) [m, rad].

    `limiting` names the actuator or stop (`stops/end`) that determines each symmetric stroke of the first design.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Single-axis strokes",
        "table limiting",
        notes=("Strokes along one coordinate, with the others at zero. Limited by: actuator or stop that limits the symmetric stroke.",),
    )

    coordinates: tuple[str, ...]
    low: Array
    high: Array
    limiting: Annotated[tuple[str, ...], Along("coordinates"), Heading("limited by")]
    at: str
    provenance: str

    @property
    def symmetric(self) -> Array:
        """Symmetric stroke (..., f): the lesser of -low and high."""
        return np.minimum(-self.low, self.high)

    @property
    def table(self) -> Annotated[Matrix, VIEW]:
        """Table of the coordinates (rows) with low, high, symmetric and full stroke."""
        values = np.stack([self.low, self.high, self.symmetric, self.high - self.low], axis=-1)
        units = tuple((MOTION.unit(name),) * 4 for name in self.coordinates)
        return Matrix(values, self.coordinates, ("low", "high", "symmetric", "full"), units)


class Utilisation(Result):
    """Actuator utilisation for a box of simultaneous displacements.

    `demand` (..., n) [m] is the largest absolute stroke over the corners of the box, `available` (..., n) [m] the symmetric stroke. The
    actuators include stops within reach (`stops/end`), with their gaps as strokes.
    """

    TABLE: ClassVar[Layout] = Layout("Simultaneous strokes", "demand available ratio")

    actuators: tuple[str, ...]
    command: Annotated[Mapping[str, Number], MOTION]
    demand: Annotated[Array, DISPLACEMENT, Along("actuators"), Heading("required")]
    available: Annotated[Array, DISPLACEMENT, Along("actuators")]
    provenance: str

    @property
    def ratio(self) -> Annotated[Array, SHARE, Bound(high=1.0), Along("actuators"), Heading("used")]:
        """Demand divided by available stroke (..., n); above 1, the corner of the box is out of reach."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.demand == 0.0, 0.0, self.demand / self.available)

    @property
    def reachable(self) -> Annotated[Array, VIEW]:
        """Whether every corner of the box can be reached (...), within a relative rounding error of 1e-9."""
        return np.max(self.ratio, axis=-1) <= 1.0 + 1e-9

    @property
    def scale(self) -> Annotated[Array, RATIO]:
        """Factor (...) by which the box can be scaled until the strokes are fully used."""
        return 1.0 / np.max(self.ratio, axis=-1)


def beside(points: Array, depth: int) -> Array:
    """Return points (k, ..., n) with at least `depth` axes between first and last axis, so that they broadcast with a batch of designs.

    >>> beside(np.zeros((64, 6)), 1).shape
    (64, 1, 6)
    """
    missing = max(0, depth - (points.ndim - 2))
    return np.expand_dims(points, tuple(range(1, 1 + missing)))


def stacks(mechanism: Mechanism) -> dict[str, ChargedActuator]:
    """Return the piezo actuators by input name, with overrides applied.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stacks(double_triangle())["B4"].length
    0.201
    """
    return {name: part for name, part in stroke_actuators(mechanism).items() if isinstance(part, ChargedActuator)}


def stroke_actuators(mechanism: Mechanism) -> dict[str, StrokeActuator]:
    """Return the stroke actuators by input name, with overrides applied.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> list(stroke_actuators(double_triangle()))
    ['B1', 'B2', 'B3', 'B4', 'B5', 'B6']
    """
    assembly = expand(mechanism)
    parts = {name: assembly.actuator(name) for name in assembly.strokes}
    return {name: part for name, part in parts.items() if isinstance(part, StrokeActuator)}


@SESSION.keep(2)
def stroke_limits(mechanism: Mechanism) -> StrokeLimits:
    """Return stroke limits relative to the bias voltage (default: mid-range).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> limits = stroke_limits(double_triangle())
    >>> (1e6 * limits.low).round(6).tolist(), (1e6 * limits.high).round(6).tolist()
    ([-75.0, -75.0, -75.0, -100.0, -100.0, -100.0], [75.0, 75.0, 75.0, 100.0, 100.0, 100.0])
    """
    parts = stroke_actuators(mechanism)
    low = stack([-part.stroke * part.below_rest for part in parts.values()])
    full = stack([part.stroke for part in parts.values()])
    below = stack([part.stroke * part.below_zero for part in parts.values()])
    return StrokeLimits(tuple(parts), *np.broadcast_arrays(low, low + full, low + below))


def mapping_at(mechanism: Mechanism, kinematics: Kinematics, point: str = PLATFORM, *, mapping: Matrix | None = None) -> Matrix:
    """Compute R_a for the motion of a named point: strokes per coordinate of the point, with its other coordinates fixed.

    `mapping` replaces R_a, e.g. by the correction gains of lost motion (strokes per platform coordinate).

    Translations of a rigid platform are equal at all points; rotations are about the named point. With fewer than six ideal motions, the
    coordinates of the point have the same names as those of the platform. Raises `DesignError` if the point cannot move along each
    coordinate independently.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> round(float(mapping_at(stage, ideal(stage)).at("B4", "rx")), 6)
    0.04
    """
    mapping = kinematics.mapping if mapping is None else mapping
    motion = point_motion(mechanism, kinematics, point)[..., [COMPONENTS.index(name) for name in mapping.columns], :]
    first = np.real(first_design(motion, 2))
    if np.linalg.cond(first) > 1e9:
        raise refuse(point, f"its motions along {', '.join(mapping.columns)} are not independent", "Choose another point")
    return Matrix(mapping.values @ np.linalg.inv(motion), mapping.rows, mapping.columns, mapping.unit)


def point_motion(mechanism: Mechanism, kinematics: Kinematics, point: str) -> Array:
    """Compute the twist (..., 6, f) of a point for unit ideal motions: a named point, or for `platform` its reference point.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> point_motion(stage, ideal(stage), "platform").tolist() == np.eye(6).tolist()
    True
    """
    assembly = expand(mechanism)
    if point == PLATFORM:
        return kinematics.motion
    if point not in assembly.points:
        raise refuse(point, "unknown point", suggest_nearest(point, (PLATFORM, *assembly.points)))
    body, position = assembly.points[point]
    return twist_at(assembly, layout(assembly), body, Frame(np.eye(3), position)) @ kinematics.bodies


def single_axis(mapping: Matrix, limits: StrokeLimits, *, at: str = PLATFORM, provenance: str = "") -> SingleAxis:
    """Compute the single-axis strokes x within the stroke limits low <= R_a x <= high, with the `mapping` R_a.

    `mapping` is `kinematics.mapping`, `mapping_at` of a point, or the correction gains of lost motion. Example of a single actuator:

    >>> lever = Matrix(np.array([[0.5]]), ("B1",), ("z",), "1")
    >>> stroke = single_axis(lever, StrokeLimits(("B1",), np.array([-1e-4]), np.array([1e-4])))
    >>> stroke.symmetric.tolist(), stroke.limiting
    ([0.0002], ('B1',))
    """
    gain = np.where(np.abs(mapping.values) > 1e-12 * np.max(np.abs(mapping.values), axis=-2, keepdims=True), mapping.values, np.nan)
    ends = np.stack([limits.low[..., :, None] / gain, limits.high[..., :, None] / gain])
    above = np.nan_to_num(np.max(ends, axis=0), nan=np.inf)
    below = np.nan_to_num(np.min(ends, axis=0), nan=-np.inf)
    first = first_design(np.minimum(above, -below), 2)
    limiting = tuple(mapping.rows[index] for index in np.argmin(np.round(first / np.min(first, axis=0), 9), axis=0))
    return SingleAxis(mapping.columns, np.max(below, axis=-2), np.min(above, axis=-2), limiting, at, provenance)


def utilisation(mapping: Matrix, limits: StrokeLimits, command: Mapping[str, Number], *, provenance: str = "") -> Utilisation:
    """Compute each actuator's demand, sum_j |R_ij| c_j, for the `mapping` R and a box of displacements (half widths c [m, rad]).

    >>> pair = Matrix(np.array([[1.0, 0.085]]), ("B1",), ("x", "rz"), "1")
    >>> used = utilisation(pair, StrokeLimits(("B1",), np.array([-75e-6]), np.array([75e-6])), {"x": 50e-6, "rz": 244e-6})
    >>> (1e6 * used.demand).round(2).tolist()
    [70.74]
    """
    require(
        Finding(
            f"command {name}", f"unknown coordinate (expected one of {', '.join(mapping.columns)})", suggest_nearest(name, mapping.columns)
        )
        for name in command
        if name not in mapping.columns
    )
    half = stack([command.get(name, 0.0) for name in mapping.columns])
    demand = matvec(magnitude(mapping.values), magnitude(half))
    available = np.minimum(0.0 - limits.low, limits.high)  # never -0
    return Utilisation(mapping.rows, dict(command), demand, available, provenance)
