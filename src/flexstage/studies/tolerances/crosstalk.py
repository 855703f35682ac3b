"""Crosstalk of a stage with scatter that is commanded and measured with the mappings of the nominal stage."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np

from flexstage.analysis.assessment.measures import Measure, crosstalk
from flexstage.analysis.bench import StageResults
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.units.quantity import Quantity
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.static import static_gain
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS, transport

OPEN, HELD = "open", "held"
_TWIST = tuple(f"{PLATFORM}.{name}" for name in COMPONENTS)
_SINGULAR = 1e9


@dataclass(frozen=True, eq=False)
class Command:
    """Command of the nominal stage: the nominal matrices that a controller uses.

    `gains` (n, f) are the strokes per unit motion along each of the `coordinates` at `point`: the mapping R_a, corrected for lost motion.
    `strokes` (n,) are the full strokes of the stacks, which are proportional to voltage. `reference` (3,) is the position of `point`.
    `sensing` (6, g) is the mapping R_s^-1 from gauges to the pose at the point; it is absent if the gauges do not determine the pose.
    """

    point: str
    coordinates: tuple[str, ...]
    gains: Array
    strokes: Array
    reference: Array
    sensing: Array | None
    length: float


@dataclass(frozen=True)
class PoseMeasure(Measure):
    """Motion of the platform along or about one axis, per unit of a command along or about an axis."""


def command(bench: StageResults, point: str) -> Command:
    """Compute the nominal matrices for motions of a point of the platform.

    Raises `DesignError` if the strokes do not determine the platform's pose, or if the point is on another body.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.judge import bench_of
    >>> command(bench_of(double_triangle()), "platform").gains.shape
    (6, 6)
    """
    if point != PLATFORM and point not in bench.assembly.points:
        raise refuse("tolerance.point", f'unknown point "{point}"', suggest_nearest(point, (PLATFORM, *bench.assembly.points)))
    gains = bench.correction(point)
    reference = bench.assembly.bodies[PLATFORM].reference + bench.arm(point)
    return Command(
        point,
        gains.columns,
        np.asarray(gains.values),
        np.array([float(each) for each in _strokes(bench)]),
        np.asarray(reference),
        _sensing_inverse(bench, reference),
        bench.kinematics.first_length,
    )


def _sensing_inverse(bench: StageResults, reference: Array) -> Array | None:
    rows = _gauges(bench, reference, bench.kinematics.first_length)
    weights = np.array([1.0, 1.0, 1.0, *[bench.kinematics.first_length] * 3])
    scaled = rows / weights
    if len(rows) < len(COMPONENTS) or np.linalg.cond(scaled) > _SINGULAR:
        return None
    return np.linalg.pinv(scaled) / weights[:, None]


def _gauges(bench: StageResults, reference: Array, length: float) -> Array:
    """Readings per twist at the point (..., g, 6) of the gauges outside sums; rotations are scaled by a `length`."""
    kinematics, carry = bench.kinematics, transport(bench.assembly.bodies[PLATFORM].reference - reference)
    if not kinematics.sums and set(kinematics.reading_units) <= {"m"}:
        return kinematics.sensing @ carry
    rows = [kinematics.gauges.index(name) for name in kinematics.telling]
    even = np.array([1.0 if kinematics.reading_units[row] == "m" else length for row in rows])[:, None]
    return even * kinematics.sensing[..., rows, :] @ carry


def _strokes(bench: StageResults) -> list[Array]:
    parts = [bench.assembly.links[link].part for link in bench.assembly.actuators.values()]
    return [np.asarray(cast("Piezo", part.part if isinstance(part, Restricted) else part).stroke) for part in parts]


def pose_measures(asked: Command) -> Mapping[str, Measure]:
    """Return the measures that `poses` computes, by name: `open.x.rz` is the motion along x per command about z.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.analysis.assessment.judge import bench_of
    >>> list(pose_measures(command(bench_of(parallelogram()), "platform")))[:2]
    ['open.x.x', 'open.y.x']
    """
    pairs = [(OPEN, row, column) for row in COMPONENTS for column in asked.coordinates]
    if asked.sensing is not None:
        pairs += [(HELD, row, column) for row in COMPONENTS for column in COMPONENTS]
    return {
        f"{kind}.{row}.{column}": PoseMeasure(f"{kind}.{row}.{column}", crosstalk, f"{row}.{column}", _quantity(row, column), asked.point)
        for kind, row, column in pairs
    }


def _quantity(row: str, column: str) -> Quantity:
    units = tuple(TWIST_UNITS[COMPONENTS.index(name)] for name in (row, column))
    si = "1" if units[0] == units[1] else "/".join(units)
    return Quantity("pose per command", si, {"1": "1", "rad/m": "urad/um", "m/rad": "um/rad"}[si], "1")


def poses(bench: StageResults, asked: Command) -> tuple[Array, ...]:
    """Compute the motion per command (...) of a stage with scatter, or of a batch, in the sequence of `pose_measures`.

    In open loop (`open`), the stacks have the voltages of the nominal stage. The motion for a unit command e_j is x = X T (stroke / nominal
    stroke) C e_j. C are the nominal strokes per command, corrected for lost motion (`Command.gains`). The strokes in the ratio are full
    strokes. T are the motions per stroke of the elastic stage with scatter; X transfers the motion to the nominal point. In closed loop
    (`held`), a controller regulates the pose measured with the nominal R_s^-1. The true pose is x = (R_s^-1 R_s,real)^-1 e_j, where
    R_s,real are the readings per motion of the stage with scatter. For the nominal stage, x is e_j in both cases. In open loop, a stage
    with fewer than six motions has parasitic motions in addition.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.judge import bench_of
    >>> bench = bench_of(double_triangle())
    >>> np.allclose(np.reshape(poses(bench, command(bench, "platform"))[:36], (6, 6)), np.eye(6))
    True
    """
    real = bench.assembly.bodies[PLATFORM].reference
    gain = transport(asked.reference - real) @ static_gain(bench.model, _TWIST, bench.kinematics.actuators).values
    ratio = np.stack(np.broadcast_arrays(*_strokes(bench)), axis=-1) / asked.strokes
    moved = gain @ (ratio[..., None] * asked.gains)
    found = [moved[..., row, column] for row in range(len(COMPONENTS)) for column in range(len(asked.coordinates))]
    if asked.sensing is not None:
        held = np.linalg.inv(asked.sensing @ _gauges(bench, asked.reference, asked.length))
        found += [held[..., row, column] for row in range(len(COMPONENTS)) for column in range(len(COMPONENTS))]
    return tuple(found)
