"""Force workspace of force-driven stages: travel along each axis, its limits, and the holding currents."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.workspace.stops import STOPS
from flexstage.analysis.workspace.strength import sized_links, stress_use
from flexstage.analysis.workspace.stroke import StrokeLimits, stroke_limits
from flexstage.analysis.workspace.wrench import dead_wrenches
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.notebook import Result
from flexstage.base.number import Array, Number, first_design, magnitude, stack
from flexstage.base.record import INNER, VIEW, Axes, Heading, Layout
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, expand
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.models.linear.channels import see
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import input_motion, part_deformation, static_gain
from flexstage.parts.actuator import ThrustActuator
from flexstage.parts.profile import single
from flexstage.parts.voice_coil import Coil
from flexstage.spatial.frame import COMPONENTS, FORCES, MOTION, Frame, twist_transform

_ROUNDING, _NONE = 1e-12, 1e-9
_STRESS_STEPS, _CHORD = 20, 1e-6
_YIELD = "yield stress"
_LIMIT = 'Add e.g. peak_current = "2 A" to the coil, or maximum = "20 N" to the force'


class ForceWorkspace(Result):
    """Force workspace: elastic travel of a point along single coordinates, in both directions.

    `per_motion` are the inputs (strokes in m, forces in N, currents in A) per motion of the `point` along each coordinate. If `alone` is
    true, the other ideal coordinates are zero; otherwise they are free. `bounds` (coordinates x causes) [m, rad] are the limits of the
    motion in continuous use, by cause (NaN if unspecified). `short` are the limits in short use, at the `duty` of a coil. `current`,
    `voltage`, `power` and `rise` (coordinates x coils) are the values for holding each coordinate at its continuous limit: i, R i, i^2 R,
    and i^2 R times the thermal resistance [K]. `unmoved` are ideal motions that no input drives.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Reach",
        "held held_briefly limited_by",
        head="along",
        notes=("Possible elastic motion in both directions. Continuous: without a time limit. Short use: with the duty cycle of a coil.",),
    )

    point: str
    coordinates: tuple[str, ...]
    alone: tuple[bool, ...]
    per_motion: Matrix
    bounds: Matrix
    short: Matrix
    current: Matrix
    voltage: Matrix
    power: Matrix
    rise: Matrix
    unmoved: tuple[str, ...]
    provenance: str

    @property
    def held(self) -> Annotated[Array, VIEW, MOTION, Axes("coordinates"), Heading("continuous, both ways")]:
        """Least continuous limit of every coordinate (..., f) [m, rad]; NaN if no limit is known."""
        return _least(self.bounds.values)

    @property
    def held_briefly(self) -> Annotated[Array, VIEW, MOTION, Axes("coordinates"), Heading("short use")]:
        """Least short-use limit of every coordinate (..., f) [m, rad]."""
        return _least(self.short.values)

    @property
    def limited_by(self) -> Annotated[tuple[str, ...], VIEW]:
        """Cause of the least limit of each coordinate, in the first design; empty if no limit is known."""
        first = np.nan_to_num(np.real(first_design(self.bounds.values, 2)), nan=np.inf)
        return tuple(self.bounds.columns[int(np.argmin(row))] if np.isfinite(np.min(row, initial=np.inf)) else "" for row in first)

    @property
    def holding(self) -> Annotated[Matrix, INNER]:
        """Current, voltage, power and temperature rise of each coil at the continuous limit of each coordinate (first design)."""
        needs = (self.current, self.voltage, self.power, self.rise)
        values = np.stack([np.real(first_design(need.values, 2)).ravel() for need in needs], axis=-1)
        rows = tuple(f"{name}, {coil}" for name in self.coordinates for coil in self.current.columns)
        return Matrix(values, rows, ("current", "R i", "heat", "temperature rise"), (("A", "V", "W", "K"),) * len(rows))

    @property
    def notes(self) -> Annotated[tuple[str, ...], INNER]:
        """Notes on motions that inputs do not drive independently, or not at all."""
        coupled = () if all(self.alone) else ("There are fewer inputs than ideal motions, so the other coordinates move freely.",)
        return (*coupled, *([f"No actuator moves {', '.join(self.unmoved)}."] if self.unmoved else []))


def _least(bounds: Array) -> Array:
    least = np.min(np.where(np.isnan(bounds), np.inf, bounds), axis=-1, initial=np.inf)
    return np.where(np.isinf(least), np.nan, least)


@check_arguments
def force_workspace(mechanism: Mechanism, kinematics: Kinematics, model: LinearModel, *, point: str = PLATFORM) -> ForceWorkspace:
    """Compute the force workspace of a stage with force actuators: the limits of the elastic motion along every ideal motion.

    The elastic model gives the matrix C = dx/du of the motions x and the inputs u (strokes, forces and currents). With as many inputs as
    motions, the inputs per motion are G = C^-1. With more inputs, G minimises the sum of u_i^2 / limit_i, where limit_i is the least limit
    of input u_i. The limits of a coil are its peak current, continuous current, temperature rise (heat i^2 R times thermal resistance),
    amplifier voltage R i, largest force and magnetic travel. Other limits are the actuator strokes, the stops (each stop by its nearer
    side), and yield in a hinge under the motion and the permanent load. The computation is linear.

    An input drives a coordinate if the resulting motion exceeds 1e-9 of the Cauchy-Schwarz bound (c E)^(1/2). Here c is the compliance of
    the coordinate, and E is twice the strain energy due to the input. Raises `DesignError` if the stage has no force actuator, no ideal
    motion, or no motion that an input drives.
    """
    if not kinematics.thrusts or not kinematics.mobility:
        raise refuse("force_workspace", "no force actuator moves the stage", "Use the workspace of its strokes")
    assembly = expand(mechanism)
    inputs, gain, names = model.actuators, *_moved(model, point, kinematics.coordinates)
    if not names:
        what = f"no actuator moves {point} along any ideal motion ({', '.join(kinematics.coordinates)})"
        raise refuse("force_workspace", what, "Check the directions and connections of the actuators")
    limits = {brief: _input_limits(mechanism, assembly, inputs, brief=brief) for brief in (False, True)}
    per_motion, alone = _inverse(gain, _sizes(limits[False]))
    per_motion = _without_rounding(per_motion)
    others = [
        *_travel(assembly, model, inputs, per_motion),
        *_stops(assembly, model, inputs, per_motion),
        *_stress(mechanism, assembly, model, inputs, per_motion),
    ]
    units = tuple(map(MOTION.unit, names))
    bounds = {brief: _bounds(names, [*_by_input(inputs, known, per_motion), *others], units) for brief, known in limits.items()}
    channels = tuple(channel.unit for channel in model.inputs if channel.name in inputs)
    return ForceWorkspace(
        point=point,
        coordinates=names,
        alone=alone,
        per_motion=Matrix(per_motion, inputs, names, ratio_units(channels, units)),
        bounds=bounds[False],
        short=bounds[True],
        **_needs(assembly, inputs, names, per_motion * _least(bounds[False].values)[..., None, :]),
        unmoved=tuple(name for name in kinematics.coordinates if name not in names),
        provenance=model.provenance,
    )


def _moved(model: LinearModel, point: str, coordinates: tuple[str, ...]) -> tuple[Array, tuple[str, ...]]:
    """Gain (..., f, n) of all inputs on the coordinates that they move in any design, rounding set to zero; and these coordinates."""
    outputs = tuple(f"{point}.{name}" for name in coordinates)
    wrenches = tuple(f"{point}.{FORCES[COMPONENTS.index(name)]}" for name in coordinates)
    gain = static_gain(model, outputs, model.actuators).values
    compliance = np.linalg.diagonal(static_gain(model, outputs, wrenches).values)
    strains = part_deformation(model, input_motion(model, model.input_index(model.actuators)))
    energy = sum(np.sum(strain * (model.stiffness[name].law @ strain), axis=-2) for name, strain in strains.items())
    most = np.sqrt(np.abs(np.real(compliance[..., :, None] * np.asarray(energy)[..., None, :])))
    moved = np.abs(np.real(gain)) > _NONE * most
    kept = np.flatnonzero(np.any(moved.reshape(-1, *moved.shape[-2:]), axis=(0, 2)))
    return np.where(moved, gain, gain - np.real(gain))[..., kept, :], tuple(coordinates[place] for place in kept)


_Causes = list[tuple[str, Array]]


def _input_limits(mechanism: Mechanism, assembly: Assembly, inputs: tuple[str, ...], *, brief: bool) -> list[list[tuple[str, Number]]]:
    """Symmetric limits of every input by name; strokes by their nearer end."""
    strokes = stroke_limits(mechanism)
    result: list[list[tuple[str, Number]]] = []
    for name in inputs:
        part = assembly.actuator(name)
        if isinstance(part, ThrustActuator):
            each = [(limit.name, limit.short if brief else limit.held) for limit in part.limits]
            result.append([(cause, value) for cause, value in each if value is not None])
        else:
            place = strokes.actuators.index(name)
            result.append([("stroke", np.minimum(-strokes.low[..., place], strokes.high[..., place]))])
    return result


def _sizes(limits: list[list[tuple[str, Number]]]) -> list[float]:
    """Square root of every input's least limit (first design; 1 if unknown): redundant inputs minimise sum u_i^2/limit_i.

    Two collinear inputs then reach their limits together.
    """
    return [min((single(value) for _, value in own), default=1.0) ** 0.5 for own in limits]


def _inverse(gain: Array, sizes: list[float]) -> tuple[Array, tuple[bool, ...]]:
    """Inputs (..., n, f) per motion, and whether each coordinate moves alone; else the others are free."""
    scaled = gain * np.asarray(sizes)
    count, first = gain.shape[-2], np.real(first_design(scaled, 2))
    weight = np.max(np.abs(first), axis=1, keepdims=True)
    if np.linalg.matrix_rank(first / np.where(weight > 0.0, weight, 1.0), tol=1e-6) == count:
        return np.asarray(sizes)[:, None] * _least_norm(scaled), (True,) * count
    columns = [_least_norm(scaled[..., row : row + 1, :])[..., 0] for row in range(count)]
    return np.asarray(sizes)[:, None] * np.stack(columns, axis=-1), (False,) * count


def _least_norm(gain: Array) -> Array:
    """G = C^T (C C^T)^-1, equal to C^-1 for a square C; NaN for designs in which no input moves a coordinate."""
    transposed = gain.mT
    square = gain if gain.shape[-1] == gain.shape[-2] else gain @ transposed
    lost = np.linalg.det(np.real(square))[..., None, None] == 0.0
    inverse = np.linalg.inv(np.where(lost, np.eye(square.shape[-1]), square))
    return np.where(lost, np.nan, inverse if square is gain else transposed @ inverse)


def _by_input(inputs: tuple[str, ...], limits: list[list[tuple[str, Number]]], per_motion: Array) -> Iterator[tuple[str, Array]]:
    for place, (name, own) in enumerate(zip(inputs, limits, strict=True)):
        for cause, value in own:
            yield f"{name} {cause}", _over(np.asarray(value)[..., None], per_motion[..., place, :])


def _over(limit: Array, slope: Array) -> Array:
    """Motion (..., f) at which a quantity of given slope reaches its limit; infinite at zero slope."""
    size = magnitude(_without_rounding(slope))
    known = np.real(size) > 0.0
    return np.where(known, limit / np.where(known, size, 1.0), np.inf)


def _without_rounding(slope: Array) -> Array:
    """Slopes per motion (..., f) with rounding (relative to other motions) set to zero; derivatives unchanged."""
    size = np.abs(np.real(slope))
    known = size > _ROUNDING * np.max(np.nan_to_num(size), axis=-1, keepdims=True)
    return np.where(known, slope, slope - np.real(slope))


def _travel(assembly: Assembly, model: LinearModel, inputs: tuple[str, ...], per_motion: Array) -> Iterable[tuple[str, Array]]:
    """Limit from half the magnetic travel of every coil."""
    columns = model.input_index(inputs)
    moved = input_motion(model, columns, per_motion)
    found: dict[str, Array] = {}
    for link, (name, _) in assembly.pushes.items():
        part = assembly.actuator(name)
        if isinstance(part, ThrustActuator) and part.travel is not None:
            imposed = model.imposed.get(link)
            opened = (model.stiffness[link].operator @ moved)[..., part.axis, :]
            opened = opened if imposed is None else opened - (imposed[..., columns] @ per_motion)[..., part.axis, :]
            most = _over(0.5 * np.asarray(part.travel)[..., None], opened)
            found[name] = np.minimum(found.get(name, np.inf), most)
    return ((f"{name} travel", most) for name, most in found.items())


def _stops(assembly: Assembly, model: LinearModel, inputs: tuple[str, ...], per_motion: Array) -> Iterator[tuple[str, Array]]:
    """Motion at which every stop closes, on the nearer side."""
    for name, stop in assembly.stops.items():
        twists = {
            body: static_gain(model, tuple(f"{body}.{component}" for component in COMPONENTS), inputs).values @ per_motion
            for body in {stop.sight.body, stop.sight.base} - {GROUND}
        }
        closing = see(stop.sight, partial(_twist, assembly, twists))[..., 0, :]
        yield f"{STOPS}/{name}", _over(np.minimum(-stop.low, stop.high)[..., None], closing)


def _twist(assembly: Assembly, twists: Mapping[str, Array], body: str, frame: Frame) -> Array:
    """Twist of a body at a frame, from twists (..., 6, f) at the bodies' reference points; zero for the ground."""
    still = np.zeros_like(next(iter(twists.values())))
    return still if body == GROUND else twist_transform(frame, assembly.bodies[body].reference) @ twists[body]


def _stress(
    mechanism: Mechanism, assembly: Assembly, model: LinearModel, inputs: tuple[str, ...], per_motion: Array
) -> Iterator[tuple[str, Array]]:
    """Motion at which a hinge yields, with permanent load."""
    sized = sized_links(assembly)
    if not sized:
        return
    names = tuple(f"{link}.{force}" for link in sized for force in FORCES)
    per = static_gain(model, names, inputs).values @ per_motion
    yield _YIELD, _yielding(sized, dead_wrenches(mechanism, model, names), np.moveaxis(per, -1, 0))


def _yielding(sized: Mapping[str, PlacedLink], dead: Array, per: Array) -> Array:
    """Least motions (..., f) in both directions at which the largest stress reaches yield, for wrenches (f, ..., w) per motion.

    The share of yield is a convex function of the motion: Newton's steps from above, with slopes of short chords. The motion is 0 if the
    permanent load alone reaches yield.
    """

    def use(wrenches: Array) -> Array:
        return stress_use(sized, wrenches.reshape(*wrenches.shape[:-1], len(sized), len(FORCES)))

    both = np.stack([per, -per])
    rest, begin = use(dead), use(both)
    motion = (1.0 + rest) / np.where(begin == 0.0, 1.0, begin)
    for _ in range(_STRESS_STEPS):
        used, more = (use(dead + share * motion[..., None] * both) for share in (1.0, 1.0 + _CHORD))
        motion = motion * (1.0 - _CHORD * (used - 1.0) / np.where(np.real(more) > np.real(used), more - used, np.inf))
    motion = np.where(np.real(rest) >= 1.0, 0.0, motion)
    least = np.minimum(*np.where(np.real(begin) > 0.0, motion, np.where(np.isnan(begin), np.nan, np.inf)))
    return np.moveaxis(least, 0, -1)


def _bounds(names: tuple[str, ...], causes: _Causes, units: tuple[str, ...]) -> Matrix:
    values = stack([value for _, value in causes]) if causes else np.zeros((len(names), 0))
    return Matrix(values, names, tuple(cause for cause, _ in causes), tuple((unit,) * len(causes) for unit in units))


def _needs(assembly: Assembly, inputs: tuple[str, ...], names: tuple[str, ...], held: Array) -> dict[str, Matrix]:
    """Current, voltage, power and temperature rise of every coil for inputs (..., n, f)."""
    coils = {name: part for name in inputs if isinstance(part := assembly.actuator(name), Coil)}
    current = magnitude(held[..., [inputs.index(name) for name in coils], :]).mT
    resistance, thermal = (
        stack([np.nan if value is None else value for value in (getattr(part, field) for part in coils.values())])[..., None, :]
        for field in ("resistance", "thermal_resistance")
    )
    power = resistance * current**2
    found = {"current": (current, "A"), "voltage": (resistance * current, "V"), "power": (power, "W"), "rise": (power * thermal, "K")}
    return {key: Matrix(values, names, tuple(coils), unit) for key, (values, unit) in found.items()}


def input_limits(mechanism: Mechanism, model: LinearModel) -> StrokeLimits:
    """Return the limits of every input: a stroke is measured from zero voltage; a force or current has its least limit in short use.

    An input is also limited so that, acting alone, it displaces its coil by at most half the magnetic travel. Raises `DesignError` for a
    force actuator without a limit.
    """
    assembly, inputs = expand(mechanism), model.actuators
    strokes = stroke_limits(mechanism).from_zero
    known = _input_limits(mechanism, assembly, inputs, brief=True)
    for name, bounds in _travel(assembly, model, inputs, np.eye(len(inputs))):
        owner = name.removesuffix(" travel")
        known[inputs.index(owner)].append((name, bounds[..., inputs.index(owner)]))
    require(Finding(name, "force limit missing", _LIMIT) for name, own in zip(inputs, known, strict=True) if not own)
    low, high = [], []
    for name, own in zip(inputs, known, strict=True):
        if name in strokes.actuators:
            place = strokes.actuators.index(name)
            low.append(strokes.low[..., place])
            high.append(strokes.high[..., place])
        else:
            most = np.min(np.stack(np.broadcast_arrays(*(np.asarray(value) for _, value in own))), axis=0)
            low.append(-most)
            high.append(most)
    return StrokeLimits(inputs, *(stack(list(each)) for each in (low, high)))


def bounds_along(found: ForceWorkspace, name: str) -> Array:
    """Return the limits (..., k) of the motion along one coordinate; an unspecified limit is infinite.

    Raises `DesignError` if no limit is specified.
    """
    if name not in found.coordinates:
        what = "no actuator drives this motion" if name in found.unmoved else "not an ideal motion of this stage"
        raise refuse(f"stroke.{name}", what, f"Use one of {', '.join(found.coordinates)}")
    place = found.coordinates.index(name)
    if np.any(np.isnan(found.held[..., place])):
        what = "the actuators of this motion have no specified limit"
        raise refuse(f"force_workspace.{name}", what, _LIMIT)
    values = found.bounds.values[..., place, :]
    return np.where(np.isnan(values), np.inf, values)
