"""Gauges (displacement sensors): readings over a box of displacements, largest mounting radius, and pose resolution."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, ClassVar

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number, magnitude, matvec, stack
from flexstage.base.record import INNER, VIEW, Along, Heading, Layout
from flexstage.base.units.quantity import SHARE, Bound
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.assembly.sight import Sight
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.models.linear.kinematics import Kinematics
from flexstage.spatial.frame import COMPONENTS, MOTION, TWIST_UNITS

_ANGLES = 720
_LEVEL = 1e-9
"""Ratio of reading per metre of radius to reading on the axis, below which a gauge counts as independent of its radius."""


class GaugeRange(Result):
    """Gauge readings (..., g) at the worst corner of a box of displacements, and half ranges (gauges start at mid-range).

    `swing` is the largest reading and `limit` half the range, in the gauge's unit, which `units` contains (m or rad). `radius` [m] is each
    gauge's distance from the platform's axis. `largest_here` [m] is the largest radius at the gauge's own angle for which the reading is
    within the range; `largest_anywhere` [m] is the largest such radius at any angle. An infinite radius means that the gauge is within its
    range everywhere. NaN means that the gauge exceeds its range even on the axis, or that it is not between platform and ground.
    """

    TABLE: ClassVar[Layout] = Layout("Gauge ranges", "table used")

    gauges: tuple[str, ...]
    command: Annotated[Mapping[str, Number], MOTION]
    swing: Annotated[Array, Heading("largest reading")]
    limit: Annotated[Array, Heading("half range")]
    radius: Annotated[Array, Heading(unit="mm")]
    largest_here: Annotated[Array, Heading("largest radius, same angle", unit="mm", digits=4, infinite="any")]
    largest_anywhere: Annotated[Array, Heading("largest radius, any angle", unit="mm", digits=4, infinite="any")]
    provenance: str
    units: Annotated[tuple[str, ...], INNER] = ()

    @property
    def used(self) -> Annotated[Array, INNER, SHARE, Bound(high=1.0), Along("gauges")]:
        """Largest reading relative to half the range (..., g)."""
        return self.swing / self.limit

    @property
    def fits(self) -> Annotated[Array, Along("gauges")]:
        """Whether the largest reading is within each gauge's range (..., g)."""
        return self.swing <= self.limit * (1.0 + 1e-12)

    @property
    def table(self) -> Annotated[Matrix, VIEW]:
        """Table of the gauges (rows)."""
        columns = ("swing", "limit", "radius", "largest_here", "largest_anywhere")
        values = np.stack([getattr(self, name) for name in columns], axis=-1)
        units = tuple((unit, unit, "m", "m", "m") for unit in self.units or ("m",) * len(self.gauges))
        return Matrix(values, self.gauges, columns, units)


class PoseResolution(Result):
    """Pose resolution: platform motion (..., 6) [m, rad] for one resolution step of every gauge.

    The matrix S = V (R_s V)^+ maps gauge readings to platform motion: V contains the ideal motions, R_s the readings per platform motion.
    Each column of S is for a single gauge, also for a gauge in a sum. `gauge_steps` and `gauge_noise` (..., g) [m, rad] are the gauges'
    resolution r and noise. `worst` is the motion if the reading errors of all gauges equal one step and have the worst signs, sum |S_ij|
    r_j. `rms` is the motion if the gauges have independent errors of one step, (sum S_ij^2 r_j^2)^(1/2). `noise` is the rms motion due to
    the specified noise densities over the gauges' bandwidths (NaN if unspecified).
    """

    TABLE: ClassVar[Layout] = Layout(
        "Pose resolution of the gauges",
        "table",
        notes=(
            "Errors if every reading is wrong by one step, with the worst signs, and rms with independent signs. Rms error due to noise.",
        ),
    )

    inverse: Matrix
    gauge_steps: Array
    gauge_noise: Array
    worst: Array
    rms: Array
    noise: Array
    provenance: str

    @property
    def table(self) -> Annotated[Matrix, VIEW]:
        """Table of the six components of the platform's motion (rows)."""
        units = tuple((unit,) * 3 for unit in TWIST_UNITS)
        return Matrix(np.stack([self.worst, self.rms, self.noise], axis=-1), COMPONENTS, ("worst", "rms", "noise"), units)


def gauge_inverse(kinematics: Kinematics) -> Matrix:
    """Compute S (..., 6, g), the platform motion per reading: R_s^-1 for six gauges, else the least-squares inverse on the ideal motions.

    If there are sums of gauges, the rows of R_s are the sums and the gauges outside sums; the columns of S are the single gauges. Raises
    `DesignError` if the gauges do not determine every ideal motion.

    >>> from flexstage.cases.double_triangle import SM_REF_A, double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> gauge_inverse(ideal(double_triangle(SM_REF_A))).values[2, 3:].round(6).tolist()
    [0.333333, 0.333333, 0.333333]
    """
    seen, reading = kinematics.seen, dict(zip(kinematics.gauges, kinematics.reading_units, strict=True))
    turns = [name.startswith("r") for name in kinematics.coordinates]
    scale = np.where(turns, 1.0 / np.asarray(kinematics.length)[..., None], 1.0)
    even = _even(kinematics, reading)
    scaled = even * seen * scale[..., None, :]
    rank = int(np.min(np.linalg.matrix_rank(np.real(scaled), tol=1e-9))) if scaled.size else 0
    if rank < kinematics.mobility:
        raise refuse(
            "gauges",
            f"{len(kinematics.telling)} gauges determine only {rank} of the platform's {kinematics.mobility} ideal motions",
            "Add gauges, or turn them so that every motion changes a reading",
        )
    values = kinematics.motion @ (scale[..., None] * _pseudo_inverse(scaled) * even[..., None, :, 0])
    single = kinematics.single_gauges
    values = values @ kinematics.selection if kinematics.sums else values
    return Matrix(values, COMPONENTS, single, tuple(tuple(f"{unit}/{reading[name]}" for name in single) for unit in TWIST_UNITS))


def _even(kinematics: Kinematics, units: Mapping[str, str]) -> Array:
    """Scale factors (..., t, 1) of readings: 1, and the stage's length for rotations."""
    lengths = [units[name] == "m" for name in kinematics.telling]
    return np.where(lengths, 1.0, np.asarray(kinematics.length)[..., None])[..., None]


def _pseudo_inverse(matrix: Array) -> Array:
    """A^+ of full column rank, valid for complex-step derivatives: dA^+ = A^+ A^+^T dA^T (I - A A^+) - A^+ dA A^+."""
    real = np.real(matrix)
    back = np.linalg.pinv(real)
    if not np.iscomplexobj(matrix):
        return back
    step = np.imag(matrix)
    beside = np.eye(real.shape[-2]) - real @ back
    change = back @ back.mT @ step.mT @ beside - back @ step @ back
    return back + 1j * change


def pose_resolution(mechanism: Mechanism, kinematics: Kinematics) -> PoseResolution:
    """Compute the pose resolution from the gauges' resolution and noise.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> (1e9 * pose_resolution(stage, ideal(stage)).worst[2]).round(6).item()
    10.0
    """
    inverse = gauge_inverse(kinematics)
    placed = expand(mechanism).gauges
    gauges = [placed[name].gauge for name in inverse.columns]
    steps = stack([gauge.resolution for gauge in gauges])
    noises = stack(
        [
            np.nan if gauge.noise_density is None or gauge.bandwidth is None else gauge.noise_density * gauge.bandwidth**0.5
            for gauge in gauges
        ]
    )
    squares = inverse.values**2
    return PoseResolution(
        inverse=inverse,
        gauge_steps=steps,
        gauge_noise=noises,
        worst=matvec(magnitude(inverse.values), steps),
        rms=np.sqrt(matvec(squares, steps**2)),
        noise=np.sqrt(matvec(squares, noises**2)),
        provenance=kinematics.provenance,
    )


def gauge_range(mechanism: Mechanism, kinematics: Kinematics, command: Mapping[str, Number]) -> GaugeRange:
    """Compute the largest gauge readings at the corners of a box of displacements (half widths by coordinate [m, rad]), and half ranges.

    The platform's axis is the line along z through its reference point. `largest_here` and `largest_anywhere` are NaN for gauges that are
    not between platform and ground.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> held = gauge_range(stage, ideal(stage), {"z": 150e-6, "rx": 733e-6, "ry": 733e-6})
    >>> (1e3 * held.largest_anywhere[3:]).round(2).tolist()
    [96.47, 96.47, 96.47]
    """
    half = _half(kinematics, command)
    swing = gauge_swing(kinematics, command)
    assembly = expand(mechanism)
    limit = half_ranges(assembly)
    box = kinematics.motion * half[..., None, :]
    places = [_places(assembly, name, box, limit[..., number]) for number, name in enumerate(assembly.gauges)]
    columns = [stack(list(values)) for values in zip(*places, strict=True)]
    radius, here, anywhere = columns or [np.zeros(0)] * 3
    return GaugeRange(
        gauges=kinematics.gauges,
        command=dict(command),
        swing=swing,
        limit=np.broadcast_to(limit, swing.shape),
        radius=np.broadcast_to(radius, swing.shape),
        largest_here=np.broadcast_to(here, swing.shape),
        largest_anywhere=np.broadcast_to(anywhere, swing.shape),
        provenance=kinematics.provenance,
        units=kinematics.reading_units,
    )


def gauge_swing(kinematics: Kinematics, command: Mapping[str, Number]) -> Array:
    """Compute the largest reading (..., g) [m, rad] over the corners of a box of displacements (half widths).

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> (1e6 * gauge_swing(ideal(double_triangle()), {"z": 150e-6})).round(1).tolist()
    [0.0, 0.0, 0.0, 150.0, 150.0, 150.0]
    """
    return matvec(magnitude(kinematics.sensing @ kinematics.motion), _half(kinematics, command))


def half_ranges(assembly: Assembly) -> Array:
    """Return half of each gauge's range (..., g) [m, rad].

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> half_ranges(expand(double_triangle()))[:2].tolist()
    [0.00025, 0.00025]
    """
    return stack([0.5 * placed.gauge.range for placed in assembly.gauges.values()])


def _half(kinematics: Kinematics, command: Mapping[str, Number]) -> Array:
    names = kinematics.coordinates
    for name in command:
        if name not in names:
            raise refuse(f"command {name}", "not an ideal motion of the stage", f"Use {', '.join(names)}")
    return magnitude(stack([command.get(name, 0.0) for name in names]))


def _places(assembly: Assembly, name: str, box: Array, limit: Array) -> tuple[Array, Array, Array]:
    """Radius of a gauge, and the largest radius at its angle and at any angle."""
    placed = assembly.gauges[name].single
    if placed is None:
        unknown = np.full(box.shape[:-2], np.nan)
        return unknown, unknown, unknown
    arm = 0.5 * (placed.frame.position + placed.foot.position) - assembly.bodies[PLATFORM].reference
    radius = np.sqrt(arm[..., 0] ** 2 + arm[..., 1] ** 2)
    if {placed.body, placed.base} != {PLATFORM, GROUND}:
        return radius, np.full_like(radius, np.nan), np.full_like(radius, np.nan)
    outward = np.where(radius[..., None] > 0.0, arm[..., :2] / np.where(radius > 0.0, radius, 1.0)[..., None], np.array([1.0, 0.0]))
    angles = np.linspace(0.0, 2.0 * np.pi, _ANGLES, endpoint=False)
    largest = _largest_radius(box, limit, angles, direction=_row(placed), outward=outward, height=arm[..., 2])
    return radius, largest[..., 0], np.min(largest, axis=-1)


def _largest_radius(box: Array, limit: Array, angles: Array, *, direction: Array, outward: Array, height: Array) -> Array:
    """Largest radius (..., angles) with a reading sum_j |A_j + r B_j| within the limit, for a gauge rotated about the axis.

    At the first angle it reads the translation or rotation along its `direction` (..., 6) at `height`, in the direction `outward` from the
    axis. Convex and piecewise linear in r: Newton's steps from above end in at most one step per piece.
    """
    turned, about = (_around(part, angles) for part in (direction[..., :3], direction[..., 3:]))
    out = _around(np.concatenate([outward, np.zeros_like(outward[..., :1])], axis=-1), angles)
    up = np.asarray(height)[..., None, None] * np.array([0.0, 0.0, 1.0])
    fixed = np.concatenate(np.broadcast_arrays(turned, np.cross(up, turned) + about), axis=-1) @ box
    growing = np.concatenate(np.broadcast_arrays(np.zeros_like(turned), np.cross(out, turned)), axis=-1) @ box
    start, slope = np.sum(np.abs(fixed), axis=-1), np.sum(np.abs(growing), axis=-1)
    bound = np.asarray(limit)[..., None] * (1.0 + 1e-12)
    grows = slope > _LEVEL * start
    radius = np.where(grows, (bound + start) / np.where(grows, slope, 1.0), 0.0)
    for _ in range(box.shape[-1] + 2):
        swing = fixed + radius[..., None] * growing
        steep = np.sum(np.sign(swing) * growing, axis=-1)
        excess = np.sum(np.abs(swing), axis=-1) - bound
        steps = grows & (excess > 0.0) & (steep > 0.0)
        radius = np.where(steps, radius - excess / np.where(steps, steep, 1.0), radius)
    return np.where(start > bound, np.nan, np.where(grows, radius, np.inf))


def _row(sight: Sight) -> Array:
    """Direction (..., 6) of the measured translation or rotation, in the stage's axes."""
    axis = sight.frame.rotation[..., :, sight.component % 3]
    parts = (axis, np.zeros_like(axis))
    return np.concatenate(parts if sight.component < 3 else parts[::-1], axis=-1)


def _around(vector: Array, angles: Array) -> Array:
    """A vector (..., 3) rotated about z by each angle, (..., angles, 3)."""
    x, y, z = (vector[..., None, index] for index in range(3))
    cosine, sine = np.cos(angles), np.sin(angles)
    return stack([x * cosine - y * sine, x * sine + y * cosine, z])
