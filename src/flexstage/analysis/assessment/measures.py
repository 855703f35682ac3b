"""Measures: scalar results of a stage for requirements, sweeps, optimisation and tolerances. One function computes each measure."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial, wraps
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from flexstage.analysis.bench import KEPT, StageResults
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.workspace.blocking import platform_lines
from flexstage.analysis.workspace.force_workspace import bounds_along
from flexstage.analysis.workspace.gauging import gauge_swing, half_ranges, pose_resolution
from flexstage.analysis.workspace.stops import with_stops
from flexstage.analysis.workspace.strength import HingeStress
from flexstage.analysis.workspace.stroke import utilisation
from flexstage.base.finding import LowerBoundError, refuse, require
from flexstage.base.lazy import LazyModule
from flexstage.base.number import Array, magnitude, stack
from flexstage.base.register import Register
from flexstage.base.units.quantity import (
    ANGLE,
    CURRENT,
    DISPLACEMENT,
    FORCE,
    FREQUENCY,
    LENGTH,
    MASS,
    MOMENT,
    POWER,
    PRESSURE,
    RATIO,
    STIFFNESS,
    TEMPERATURE,
    VOLTAGE,
    Quantity,
)
from flexstage.beams.mass import mass as link_mass
from flexstage.mechanism.design import designs, step_size
from flexstage.mechanism.geometry.contact import least_gap
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.models.linear.static import input_motion
from flexstage.parts.condensation import condense
from flexstage.parts.voice_coil import Coil
from flexstage.spatial.frame import COMPONENTS, transport

if TYPE_CHECKING:
    from flexstage.analysis.loaded import load_cases as cases
    from flexstage.models.nonlinear import state
    from flexstage.models.nonlinear.paths import critical_load
else:
    cases = LazyModule("flexstage.analysis.loaded.load_cases")
    critical_load = LazyModule("flexstage.models.nonlinear.paths.critical_load")
    state = LazyModule("flexstage.models.nonlinear.state")

ROTATION = Quantity("rotation", ANGLE.si, "urad", "244 urad")
TWISTING = Quantity("rotational stiffness", "N m/rad", "N m/rad", "8e4 N m/rad")
DRIFT = Quantity("drift", "m/K", "nm/K", "5 nm/K")
TILT_DRIFT = Quantity("rotational drift", "rad/K", "nrad/K", "50 nrad/K")
FINE = Quantity("displacement", DISPLACEMENT.si, "nm", "10 nm")
FINE_ROTATION = Quantity("rotation", ANGLE.si, "nrad", "50 nrad")


class Extreme(Enum):
    """Whether a measure is the least or the largest of its pieces."""

    LEAST = "least"
    LARGEST = "largest"

    def of(self, values: Array) -> Array:
        """Return the value (...) of a measure from its pieces (..., m)."""
        return np.min(values, axis=-1) if self is Extreme.LEAST else np.max(values, axis=-1)


@dataclass(frozen=True, eq=False)
class MeasureKind:
    """Kind of measure: the `form` of its key, its `quantity`, and the function `work` that computes its SI value.

    The first sentence of the docstring of `work` defines the measure.

    - `about`: the quantity of the measure about an axis; `quantity` is then the quantity along an axis.
    - `pointed`: the measure may be computed at a specified point.
    - `extreme`: `work` returns m pieces (..., m), one for every actuator, hinge or stack; the least or largest piece is the measure, and an
      optimiser uses all pieces.
    - `softening`: an exponent; at worst, a permanent load with the critical load factor n multiplies the measure by (1 - 1/n)^softening.
    - `over_strokes`: the measure is the worst value over the full range of strokes.
    - `load_dependent`: the measure depends on lost motion, drift or deflection, which the permanent load changes.
    - `analytic`: complex-step differentiation is valid.
    - `along`: the measure is evaluated along a path of the design, or at a point of the path.
    """

    form: str
    quantity: Quantity
    work: Callable[[StageResults, Measure], Array]
    about: Quantity | None = None
    pointed: bool = False
    extreme: Extreme | None = None
    softening: float = 0.0
    over_strokes: bool = False
    load_dependent: bool = False
    analytic: bool = True
    along: bool = False

    @property
    def meaning(self) -> str:
        """Short definition."""
        first = (inspect.getdoc(self.work) or "").partition(".\n")[0].rstrip(".")
        return first[:1].lower() + first[1:]

    def pieces(self, bench: StageResults, asked: Measure) -> Array:
        """Pieces (..., m) of the measure; a measure without `extreme` has one piece."""
        found = np.asarray(self.work(bench, asked))
        return found[..., None] if self.extreme is None else found

    def value(self, bench: StageResults, asked: Measure) -> Array:
        """Value (...) of the measure. Raises `DesignError` if the measure has no value for the stage."""
        found = np.asarray(self.work(bench, asked))
        return found if self.extreme is None else self.extreme.of(found)

    def __reduce__(self) -> tuple[Callable[[str], MeasureKind], tuple[str]]:
        return measure_kind, (self.form,)


@dataclass(frozen=True)
class Measure:
    """Measure of a stage: its `key`, its `kind`, the `name` of an axis, actuator, gauge, path or number, and a `point`.

    If `place` is specified, a measure along a path is evaluated where the driven coordinate has this value. Otherwise, the measure is the
    worst value along the path. `path` names the path of a measure that is evaluated `over` a path.
    """

    key: str
    kind: MeasureKind
    name: str
    quantity: Quantity
    point: str = PLATFORM
    place: float | None = None
    path: str = ""


@partial(MeasureKind, "stroke.<axis>", DISPLACEMENT, about=ROTATION, pointed=True, extreme=Extreme.LEAST, load_dependent=True)
def stroke(bench: StageResults, asked: Measure) -> Array:
    """Symmetric stroke along one axis, with lost motion corrected.

    Every actuator and stop limits the stroke in both directions; in force-driven stages, the continuous force limits the stroke.
    """
    if bench.forced:
        return bounds_along(bench.force_workspace(asked.point), asked.name)
    mapping, limits = bench.stopped(asked.point)
    if asked.name not in mapping.columns:
        raise refuse(f"stroke.{asked.name}", "not an ideal motion of this stage", f"Use one of {', '.join(mapping.columns)}")
    gain = mapping.values[..., mapping.columns.index(asked.name)]
    able = np.abs(gain) > 1e-12 * np.max(np.abs(mapping.values), axis=(-2, -1), keepdims=False)[..., None]
    safe = np.where(able, gain, 1.0)
    ends = limits.low / safe, limits.high / safe
    both = np.concatenate(np.broadcast_arrays(-np.minimum(*ends), np.maximum(*ends)), axis=-1)
    return np.where(np.concatenate([able, able], axis=-1), both, np.inf)


@partial(MeasureKind, "corner", RATIO, extreme=Extreme.LARGEST, load_dependent=True)
def corner(bench: StageResults, _: Measure) -> Array:
    """Largest ratio of the motion of an actuator or at a stop to the limit of this motion, with all required strokes at once."""
    return utilisation(*with_stops(bench.mechanism, bench.kinematics, bench.lost.correction, bench.limits), bench.box()).ratio


@partial(MeasureKind, "frequency.<n>", FREQUENCY, softening=0.5)
def frequency(bench: StageResults, asked: Measure) -> Array:
    """N-th natural frequency of the stage."""
    return _nth(bench.modes.frequencies, asked)


@partial(MeasureKind, "frequency.platform.<n>", FREQUENCY, softening=0.5)
def platform_frequency(bench: StageResults, asked: Measure) -> Array:
    """N-th natural frequency of the platform."""
    return _nth(bench.modes.platform_frequencies, asked)


def _nth(frequencies: Array, asked: Measure) -> Array:
    count = frequencies.shape[-1]
    if int(asked.name) > count:
        raise refuse(f"requirements.{asked.key}", f"mode number too high (expected {count} or less)", "Use a lower number")
    return frequencies[..., int(asked.name) - 1]


@partial(MeasureKind, "safety", RATIO, extreme=Extreme.LEAST, over_strokes=True)
def safety(bench: StageResults, _: Measure) -> Array:
    """Stress limit divided by peak stress in the worst hinge, for the worst strokes (from zero voltage) and forces within their limits."""
    return _known_safety(bench.stress)


@partial(MeasureKind, "safety.at_strokes", RATIO, extreme=Extreme.LEAST)
def safety_at_strokes(bench: StageResults, _: Measure) -> Array:
    """Stress limit divided by peak stress in the worst hinge, for the worst combination of required strokes."""
    return _known_safety(bench.stress_at_strokes)


def _known_safety(found: HingeStress) -> Array:
    if found.unknown:
        links = ", ".join(found.unknown[:3])
        raise refuse("safety", f"the material of {links} has no stress limit", 'Add e.g. yield_stress = "1360 MPa" to the material')
    return found.safety


@partial(MeasureKind, "buckling", RATIO, over_strokes=True)
def buckling(bench: StageResults, _: Measure) -> Array:
    """Linearised load factor of the whole stage under permanent load and the worst strokes."""
    return bench.buckling.min_factor


@partial(MeasureKind, "stiffness.<axis>", STIFFNESS, about=TWISTING, pointed=True, softening=1.0)
def stiffness(bench: StageResults, asked: Measure) -> Array:
    """Stiffness of the platform along one axis, with the other axes free."""
    index = COMPONENTS.index(asked.name)
    return 1.0 / _compliance(bench, asked)[..., index, index]


@partial(MeasureKind, "stiffness.<direction>", STIFFNESS, about=TWISTING, pointed=True, softening=1.0)
def directed_stiffness(bench: StageResults, asked: Measure) -> Array:
    """Stiffness of the platform along a direction (about the direction if its name starts with r), with all other motions free."""
    along, start = direction_of(asked.name, asked.key), 3 * asked.name.startswith("r")
    return 1.0 / (along @ _compliance(bench, asked)[..., start : start + 3, start : start + 3] @ along)


def direction_of(name: str, where: str = "direction") -> Array:
    """Read the unit vector (3,) of a direction such as `(1,1,0)`, with `r` before it for a rotation. Errors name the location `where`.

    >>> direction_of("r(0,3,4)").tolist()
    [0.0, 0.6, 0.8]
    """
    try:
        vector = np.array([float(each) for each in name.removeprefix("r").removeprefix("(").removesuffix(")").split(",")])
    except ValueError:
        vector = np.zeros(0)
    if vector.shape != (3,) or not np.all(np.isfinite(vector)) or not np.any(vector) or not name.endswith(")"):
        raise refuse(where, f'invalid direction (got "{name}")', "Use three numbers, not all 0, without spaces, e.g. (1,1,0)")
    return vector / np.linalg.norm(vector)


@partial(MeasureKind, "stiffness.least", STIFFNESS, pointed=True, softening=1.0)
def least_stiffness(bench: StageResults, asked: Measure) -> Array:
    """Least stiffness of the platform over all directions of force.

    The direction is real, so that complex-step derivatives of a simple eigenvalue are exact.
    """
    block = _compliance(bench, asked)[..., :3, :3]
    worst = np.linalg.eigh(0.5 * np.real(block + block.mT))[1][..., :, -1]
    return 1.0 / np.einsum("...i,...ij,...j->...", worst, block, worst)


def _compliance(bench: StageResults, asked: Measure) -> Array:
    return statics(bench.model, load_point=asked.point, read_point=asked.point).compliance.values


@partial(MeasureKind, "deflection.<axis>", DISPLACEMENT, about=ROTATION, pointed=True, softening=-1.0, load_dependent=True)
def deflection(bench: StageResults, asked: Measure) -> Array:
    """Motion under gravity and specified forces, with strokes fixed."""
    causes = bench.deflection(asked.point).by_cause
    return magnitude(np.sum(causes.values[..., causes.rows.index(f"{asked.point}.{asked.name}"), :], axis=-1))


@partial(MeasureKind, "force.<axis>", FORCE, about=MOMENT)
def force(bench: StageResults, asked: Measure) -> Array:
    """Blocked force of the platform along one axis.

    For force-driven stages, the blocked force is the continuous stroke times the stiffness.
    """
    if bench.forced:
        bounds = np.min(bounds_along(bench.force_workspace(PLATFORM), asked.name), axis=-1)
        return bounds * stiffness.work(bench, asked)
    lines = platform_lines(bench.kinematics.mapping, bench.model, bench.limits)
    if asked.name not in lines.coordinates:
        raise refuse(f"force.{asked.name}", "not an ideal motion of this stage", f"Use one of {', '.join(lines.coordinates)}")
    return lines.blocking[..., lines.coordinates.index(asked.name)]


@partial(MeasureKind, "current.<axis>", CURRENT, extreme=Extreme.LARGEST)
def current(bench: StageResults, asked: Measure) -> Array:
    """Largest coil current for holding the required stroke along one axis."""
    return _held(bench, asked)[0]


@partial(MeasureKind, "voltage.<axis>", VOLTAGE, extreme=Extreme.LARGEST)
def voltage(bench: StageResults, asked: Measure) -> Array:
    """Largest static coil voltage, R i, for holding the required stroke along one axis."""
    currents, coils = _held(bench, asked)
    return currents * _stated(coils, "resistance")


@partial(MeasureKind, "thrust.<axis>", FORCE, extreme=Extreme.LARGEST)
def thrust(bench: StageResults, asked: Measure) -> Array:
    """Largest coil force for holding the required stroke along one axis."""
    currents, coils = _held(bench, asked)
    return currents * _stated(coils, "force_constant")


@partial(MeasureKind, "power.<axis>", POWER)
def power(bench: StageResults, asked: Measure) -> Array:
    """Heat of all coils, i^2 R, for holding the required stroke along one axis."""
    currents, coils = _held(bench, asked)
    return np.sum(currents**2 * _stated(coils, "resistance"), axis=-1)


@partial(MeasureKind, "heating.<axis>", TEMPERATURE, extreme=Extreme.LARGEST)
def heating(bench: StageResults, asked: Measure) -> Array:
    """Largest temperature rise of a coil for holding the required stroke along one axis continuously."""
    currents, coils = _held(bench, asked)
    return currents**2 * _stated(coils, "resistance") * _stated(coils, "thermal_resistance")


def _held(bench: StageResults, asked: Measure) -> tuple[Array, dict[str, Coil]]:
    """Currents (..., c) of all coils that hold the required stroke along an axis, and the coils."""
    found = bench.force_workspace(PLATFORM)
    coils = {name: part for name in bench.assembly.thrusts if isinstance(part := bench.assembly.actuator(name), Coil)}
    if not coils or asked.name not in found.coordinates:
        raise refuse(asked.key, "no coil moves the stage along this axis", f"Use one of {', '.join(found.coordinates)}")
    if asked.name not in bench.command:
        advice = f'Add e.g. "stroke.{asked.name}" = "at least 50 um"'
        raise refuse(asked.key, "required stroke along this axis missing", advice)
    rows = [found.per_motion.rows.index(name) for name in coils]
    return magnitude(found.per_motion.values[..., rows, found.coordinates.index(asked.name)] * bench.command[asked.name]), coils


def _stated(coils: dict[str, Coil], field: str) -> Array:
    """A number (..., c) of every coil; refuses missing ones."""
    values = {name: getattr(coil, field) for name, coil in coils.items()}
    missing = [name for name, value in values.items() if value is None]
    if missing:
        raise refuse(missing[0], f"{field.replace('_', ' ')} missing", f"Add {field} to its part")
    return stack(list(values.values()))


@partial(MeasureKind, "loss", RATIO, extreme=Extreme.LARGEST, load_dependent=True)
def loss(bench: StageResults, _: Measure) -> Array:
    """Largest relative lost motion of an actuator."""
    return magnitude(np.diagonal(bench.lost.loss.values, axis1=-2, axis2=-1))


@partial(MeasureKind, "loss.<actuator>", RATIO, load_dependent=True)
def own_loss(bench: StageResults, asked: Measure) -> Array:
    """Relative lost motion of the actuator."""
    return loss.pieces(bench, asked)[..., bench.lost.loss.rows.index(asked.name)]


@partial(MeasureKind, "crosstalk", RATIO, extreme=Extreme.LARGEST, load_dependent=True)
def crosstalk(bench: StageResults, _: Measure) -> Array:
    """Largest ratio of an actuator's apparent stroke to the stroke of the other actuator that causes it."""
    values = bench.lost.loss.values
    others = values[..., ~np.eye(values.shape[-1], dtype=bool)]
    return magnitude(others) if others.size else np.zeros((*values.shape[:-2], 1))


@partial(MeasureKind, "map_error.<axis>", FINE, about=FINE_ROTATION, analytic=False)
def map_error(bench: StageResults, asked: Measure) -> Array:
    """Largest error of the linear map over the workspace."""
    return bench.map_error[..., COMPONENTS.index(asked.name)]


@partial(MeasureKind, "drift.<axis>", DRIFT, about=TILT_DRIFT, pointed=True, load_dependent=True)
def drift(bench: StageResults, asked: Measure) -> Array:
    """Motion per kelvin of uniform temperature change, with strokes fixed; the ground expands too."""
    return magnitude(bench.drift.motion.at(f"{asked.point}.{asked.name}", "uniform"))


@partial(MeasureKind, "mass", MASS)
def mass(bench: StageResults, _: Measure) -> Array:
    """Mass of the platform without payload."""
    own = bench.assembly.bodies[PLATFORM].mass
    if own is None:
        raise refuse(
            "platform",
            "the platform has neither solids nor a specified mass",
            "Specify the mass, or add a solid of a material with a density",
        )
    return np.asarray(own.mass)


@partial(MeasureKind, "mass.total", MASS)
def total_mass(bench: StageResults, _: Measure) -> Array:
    """Mass of all bodies, links and stacks without payload.

    Masses of links are integrals over their profiles, including end masses.
    """
    bodies = [body.mass.mass for body in bench.assembly.bodies.values() if body.mass is not None]
    ends = [link_mass(link.part, link.material) for link in bench.assembly.links.values()]
    links = [each[..., 0, 0] + each[..., 0, 6] + each[..., 6, 0] + each[..., 6, 6] for each in ends]
    elements = [np.asarray(condense(item.part).mass) for item in bench.assembly.superelements.values()]
    return sum([*bodies, *links, *elements], np.asarray(0.0))


@partial(MeasureKind, "envelope.<dimension>", LENGTH)
def size(bench: StageResults, asked: Measure) -> Array:
    """Length of the bounding box along one axis."""
    return bench.size[..., COMPONENTS.index(asked.name)]


@partial(MeasureKind, "height", LENGTH)
def height(bench: StageResults, _: Measure) -> Array:
    """Height of the bounding box, along z."""
    return bench.size[..., 2]


@partial(MeasureKind, "opening", LENGTH, analytic=False)
def opening(bench: StageResults, _: Measure) -> Array:
    """Largest intrusion into the clear aperture."""
    if bench.mechanism.opening is None:
        raise refuse("opening", "clear aperture missing", 'Add e.g. opening = { size = ["110 mm", "110 mm"] }')
    depths = [item.depth for item in bench.clearance.intrusions]
    return np.max(np.stack(np.broadcast_arrays(*depths)), axis=0) if depths else np.asarray(0.0)


@partial(MeasureKind, "resolution.<axis>", FINE, about=FINE_ROTATION, pointed=True)
def resolution(bench: StageResults, asked: Measure) -> Array:
    """Pose error due to one resolution step of every gauge, with the worst signs."""
    seen = pose_resolution(bench.mechanism, bench.kinematics)
    inverse = transport(bench.arm(asked.point)) @ seen.inverse.values
    return (magnitude(inverse) @ seen.gauge_steps[..., None])[..., COMPONENTS.index(asked.name), 0]


@partial(MeasureKind, "gauge.range", RATIO, extreme=Extreme.LARGEST)
def gauge_range(bench: StageResults, _: Measure) -> Array:
    """Largest ratio of a gauge's reading to half the gauge's range, with all required strokes at once."""
    return gauge_swing(bench.kinematics, bench.box()) / half_ranges(bench.assembly)


@partial(MeasureKind, "gauge.range.<gauge>", RATIO)
def own_gauge_range(bench: StageResults, asked: Measure) -> Array:
    """Ratio of the gauge's reading to half the gauge's range, with all required strokes at once."""
    return gauge_range.pieces(bench, asked)[..., bench.kinematics.gauges.index(asked.name)]


@partial(MeasureKind, "load", RATIO, extreme=Extreme.LARGEST, over_strokes=True)
def load(bench: StageResults, _: Measure) -> Array:
    """Largest ratio of a stack's load to its limit, in compression or tension, at the worst corner of the stroke range."""
    share, limits = bench.load_share, bench.limits.from_zero
    use = share.use(limits)
    if np.any(np.isnan(use)) or np.any(np.isnan(share.maximum)):
        raise refuse("load", "maximum load of a stack missing", 'Add e.g. maximum_load = "5000 N" to the stack')
    if use.ndim == 1:
        require(each for each in share.tension_findings(limits) if "neither" in each.what)
    return use


@partial(MeasureKind, "load.<actuator>", FORCE, over_strokes=True)
def own_load(bench: StageResults, asked: Measure) -> Array:
    """Largest compression of the stack at the worst corner of the stroke range, including permanent load."""
    share = bench.load_share
    return share.range(bench.limits.from_zero)[1][..., share.actuators.index(asked.name)]


Work = Callable[[StageResults, Measure], float]


def _each_design(
    work: Work, together: Callable[[Sequence[StageResults], Measure], None] | None = None
) -> Callable[[StageResults, Measure], Array]:
    """Evaluate batches and complex numbers design by design; derivatives by central differences along the imaginary parts.

    `together` prepares the benches of many designs in one run.
    """

    @wraps(work)
    def works(bench: StageResults, asked: Measure) -> Array:
        stage = bench.mechanism
        count, step = designs(stage), step_size(stage)
        if count is None and not step:
            return np.asarray(work(bench, asked))
        found: list[complex] = []
        shares = _shares(step)
        several = KEPT // len(shares)
        for first in range(0, count or 1, several):
            places = range(first, min(first + several, count or 1))
            benches = [[bench.one(place, share) for share in shares] for place in places]
            if together is not None:
                together([each for group in benches for each in group], asked)
            found += [_value_and_slope([value_or_bound(work, each, asked) for each in group], step) for group in benches]
        return np.array(found)

    return works


def value_or_bound(work: Callable[[StageResults, Measure], Any], bench: StageResults, asked: Measure) -> Any:
    """Return the value of a measure, or its lower bound if only this bound is known."""
    try:
        return work(bench, asked)
    except LowerBoundError as error:
        return np.asarray(error.bound)


def _shares(step: float) -> tuple[float, ...]:
    """Shares of the imaginary parts added to a design."""
    return (0.0, step, -step) if step else (0.0,)


def _value_and_slope(values: list[float], step: float) -> complex:
    return values[0] if len(values) == 1 else values[0] + 1j * (values[1] - values[2]) / (2.0 * step)


def _go_along(benches: Sequence[StageResults], asked: Measure) -> None:
    StageResults.all_along(benches, asked.name, asked.place)


def _column(bench: StageResults, asked: Measure, name: str) -> Array:
    """A column of a stroke, at the requested place or complete. Refuses missing equilibria."""
    found = bench.along(asked.name, asked.place)
    if name not in found.columns:
        raise refuse(asked.key, f"{found.drive} is not a coordinate, and so has no holding force", "Drive a coordinate, e.g. platform.y")
    values = found.column(name)
    if np.any(np.isnan(values)):
        where = found.column(found.drive)[np.isnan(values)][0]
        raise refuse(asked.key, f"no stable equilibrium at {found.drive} = {where:.4g}", _LESS)
    return values


_LESS = "Reduce the stroke, or run flexstage buckle to find the buckling mode"


def _worst_along(name: str, column: str, quantity: Quantity, meaning: str, about: Quantity | None = None) -> MeasureKind:
    """Worst value of a stroke column along a path or at one point: least stiffness and frequency, else largest value."""
    worst: Callable[[Array], Any] = np.min if name in _LEAST else _largest

    @partial(_each_design, together=_go_along)
    def work(bench: StageResults, asked: Measure) -> float:
        return float(worst(_column(bench, asked, column)))

    work.__doc__ = meaning
    return MeasureKind(f"<path>.{name}", quantity, work, about=about, along=True)


def _largest(values: Array) -> Any:
    return np.max(np.abs(values))


_LEAST = {"stiffness", "frequency"}
_MOVED = "Largest motion of the platform along one axis on a path, relative to the static equilibrium."
_FORCED = "Largest holding force of the drive of a path, at large displacements."
path_force = _worst_along("force", "force", FORCE, _FORCED, MOMENT)
_STIFF = "Least stiffness along the drive of a path, at large displacements."
path_stiffness = _worst_along("stiffness", "stiffness", STIFFNESS, _STIFF, TWISTING)
path_stress = _worst_along("stress", "stress", PRESSURE, "Largest stress of a flexure over a path, at large displacements.")
path_strain = _worst_along("strain", "strain", RATIO, "Largest strain of a flexure over a path, at large displacements.")
path_frequency = _worst_along(
    "frequency", "f1", FREQUENCY, "Lowest natural frequency along a path, with the drive coordinate free under its holding force."
)


@partial(MeasureKind, "buckling.factor", RATIO)
@_each_design
def buckling_factor(bench: StageResults, _: Measure) -> float:
    """Critical load factor of weight and payloads, at large displacements."""
    return _least_factor(bench, [cases.LoadCase(state.WEIGHT, cases.REST, {state.WEIGHT: 1.0})])


@partial(MeasureKind, "<path>.buckling", RATIO, along=True)
@_each_design
def path_buckling(bench: StageResults, asked: Measure) -> float:
    """Least critical load factor of weight and other loads at the ends of a path, at large displacements."""
    places = None if asked.place is None else {"there": asked.place}
    return _least_factor(bench, cases.path_cases(bench.mechanism, asked.name, places))


def _least_factor(bench: StageResults, load_cases: Iterable[cases.LoadCase]) -> float:
    """Least factor of load cases, infinite without buckling. Raises `LowerBoundError` if the least is a lower bound."""
    least, bounded = np.inf, None
    for case in load_cases:
        try:
            factor, error = cases.case_critical(bench.nonlinear, case, tolerance=1e-9).factor, None  # for differentiation
        except critical_load.NoCriticalLoadError:
            continue
        except LowerBoundError as found:
            factor, error = found.bound, found
        if factor < least:
            least, bounded = factor, error
    if bounded is not None:
        raise bounded
    return float(least)


@partial(MeasureKind, "frequency.unwanted", FREQUENCY, softening=0.5)
def unwanted_frequency(bench: StageResults, asked: Measure) -> Array:
    """Lowest natural frequency with the required motions of the platform fixed.

    N spans the null space of the n constraint rows of these motions. With the stiffness K and the mass M of the free stage, the constrained
    stage has the matrices N^T K N and N^T M N. By the interlacing of eigenvalues, this frequency is at most the frequency of mode n + 1 of
    the free stage. The Rayleigh quotient of the real mode shape gives exact complex-step derivatives.
    """
    axes = [axis for axis, value in bench.command.items() if value]
    if not axes:
        raise refuse(asked.key, "no stroke is required, so there is no motion to fix", 'Add e.g. "stroke.x" = "at least 50 um"')
    model = bench.model
    rows = np.real(model.output[..., model.output_index(tuple(f"{PLATFORM}.{axis}" for axis in axes)), :])
    free = scipy.linalg.null_space(rows.reshape(-1, *rows.shape[-2:])[0])
    stiffness, mass = (free.T @ each @ free for each in (model.stiffness_matrix, model.inertia_matrix))
    try:  # of 1 / omega^2, so that coordinates without mass are no obstacle
        inverse = np.linalg.inv(np.linalg.cholesky(np.real(stiffness)))
    except np.linalg.LinAlgError:
        raise refuse(asked.key, "with the required motions fixed, the stage has a motion without stiffness", "Add links") from None
    lowest = np.linalg.eigh(inverse @ np.real(mass) @ inverse.mT)[1][..., :, -1]
    mode = np.einsum("...ji,...j->...i", inverse, lowest)
    square = np.einsum("...i,...ij,...j->...", mode, stiffness, mode) / np.einsum("...i,...ij,...j->...", mode, mass, mode)
    return np.sqrt(square) / (2.0 * np.pi)


@partial(MeasureKind, "clearance", LENGTH, analytic=False)
@_each_design
def clearance(bench: StageResults, asked: Measure) -> float:
    """Smallest gap between outlines that no joint connects, at rest and at the corners of the required strokes; negative for an overlap.

    The linear model gives the motion at the corners (at the ends of single strokes, if more than three are required). Bodies are rigid; a
    link moves by the mean of the motions of the two bodies that it joins. If the stage has no required strokes or no actuators, the measure
    is the gap at rest.
    """
    found = [least_gap(bench.mechanism, each) for each in ({}, *_corner_twists(bench))]
    known = [each.distance for each in found if each is not None]
    if not known:
        raise refuse(asked.key, "no two outlines could touch", "Add solids to the bodies")
    return min(known)


def _corner_twists(bench: StageResults) -> Iterator[dict[str, Array]]:
    """Twists (6,) of all bodies at the corners of the required strokes."""
    if not bench.command or not bench.kinematics.actuated:
        return
    mapping, (axes, corners) = bench.per_motion, bench.corners()
    inputs = np.real(mapping.values[:, [mapping.columns.index(axis) for axis in axes]]) @ corners.T
    model = bench.model
    motion = input_motion(model, model.input_index(mapping.rows), inputs)
    rows = {body: model.output_index(tuple(f"{body}.{axis}" for axis in COMPONENTS)) for body in bench.assembly.bodies}
    for place in range(len(corners)):
        yield {body: np.real(model.seen(own, motion[..., [place]]))[:, 0] for body, own in rows.items()}


@partial(MeasureKind, "numbers.<number>", RATIO)
def named_number(bench: StageResults, asked: Measure) -> Array:
    """Value of a named number of the design file."""
    return np.asarray(bench.mechanism.numbers[asked.name].value)


def over(kind: MeasureKind) -> MeasureKind:
    """Extend a measure of linear models (a frequency, a stiffness) to its worst value along a path. Other measures are refused.

    >>> over(frequency).form
    'frequency.<n> over <path>'
    """
    if kind.softening <= 0.0:
        raise refuse(kind.form, "not defined over a path", "Use a frequency or a stiffness over a path")

    @_each_design
    def least(bench: StageResults, asked: Measure) -> float:
        along = bench.over(asked.path)
        if kind.quantity is FREQUENCY:
            _require_frequencies(along.modes.frequencies[..., 0], asked.path)
        return float(np.min(kind.value(along, asked)))

    least.__doc__ = (inspect.getdoc(kind.work) or "").partition(".\n")[0].rstrip(".") + ", the least over a path."
    return replace(kind, form=f"{kind.form}{_OVER}", work=least, softening=0.0, extreme=None)


def _require_frequencies(lowest: Array, path: str) -> None:
    loose = int(np.sum(np.isnan(lowest)))
    if loose:
        what = f"the free stage is unstable at {loose} of {lowest.size} points, and so has no frequencies"
        raise refuse(
            f"paths.{path}", what, f"Run flexstage stroke --path {path} to find the points; reduce loads, or fix the unstable coordinate"
        )


_OVER = " over <path>"
_PATH_MOTIONS = tuple(
    _worst_along(f"motion.{axis}", f"{PLATFORM}.{axis}", ROTATION if axis.startswith("r") else DISPLACEMENT, _MOVED) for axis in COMPONENTS
)
MEASURES: Register[MeasureKind] = Register(
    "flexstage.measures", {each.form: each for each in (*globals().values(), *_PATH_MOTIONS) if isinstance(each, MeasureKind)}
)
"""Measures by the form of their keys, in the sequence above. `[requirements]` lines and studies use these keys."""


def measure_kind(form: str) -> MeasureKind:
    """Return the kind of measure whose keys have the given form. Raises `DesignError` if no installed package provides this kind.

    >>> measure_kind("mass").meaning
    'mass of the platform without payload'
    """
    found = MEASURES.get(form.removesuffix(_OVER))
    if found is not None and form.endswith(_OVER):
        return over(found)
    if found is None:
        raise refuse(form, "no installed package provides this measure", "Install the package that provides the measure")
    return found
