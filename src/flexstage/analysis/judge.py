"""The requirements of a design file judged: each value is worked out only if a line asks for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property

import numpy as np

from flexstage.analysis.deflection import deflection
from flexstage.analysis.drift import Drift, drift
from flexstage.analysis.lost_motion import LostMotion, lost_motion
from flexstage.analysis.modes import Modes, modes
from flexstage.analysis.requirements import Measure, Requirement, Sense, Subject, Verdict, direction_of, offered, requirements
from flexstage.analysis.stability import Stability, stability
from flexstage.analysis.standing import standing, under_load
from flexstage.analysis.statics import statics
from flexstage.analysis.workspace.blocking import platform_lines
from flexstage.analysis.workspace.buckling import buckling
from flexstage.analysis.workspace.gauging import gauge_swing, half_ranges, pose_resolution
from flexstage.analysis.workspace.load import load_share
from flexstage.analysis.workspace.map_error import linear_map_error
from flexstage.analysis.workspace.room import Room, bounds, room
from flexstage.analysis.workspace.small import small_motion
from flexstage.analysis.workspace.strength import HingeStress, hinge_stress
from flexstage.analysis.workspace.stroke import StrokeLimits, mapping_at, single_axis, stroke_limits, utilisation
from flexstage.base.finding import DesignError, refuse, require
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array, magnitude
from flexstage.beams.mass import mass
from flexstage.mechanism.expand import Assembly, expand
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.mechanism.outline import outlines
from flexstage.models.batch.choice import Choice, chosen
from flexstage.models.ideal import ideal
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.lumped import lumped
from flexstage.spatial.frame import COMPONENTS, transport


def judge(mechanism: Mechanism) -> tuple[Verdict, ...]:
    """Judge every `[require]` line of a description by the lumped model.

    What the stage cannot answer (a safety factor without yield stress) is a failed verdict with its reason. Raises `DesignError` for lines
    that cannot be read.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [bool(verdict.passed) for verdict in judge(double_triangle())]
    [True, True, True, True, True, True, True, True]
    """
    lines = requirements(mechanism)
    bench = Bench(mechanism, _box(lines))
    return tuple(_judged(bench, line) for line in lines)


def measured(mechanism: Mechanism, measures: tuple[Measure, ...]) -> tuple[Array | str, ...]:
    """Values (...) in SI of measures by the lumped model, for one design or a batch; where a stage has none, the reason in words.

    What asks for all required strokes at once (corner, gauge.range) takes those of the description's `[require]` lines.

    >>> from flexstage.analysis.requirements import measure
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> round(float(measured(stage, (measure(stage, "frequency.platform.1", "here"),))[0]), 1)
    106.0
    """
    bench = bench_of(mechanism)
    return tuple(measured_on(bench, each) for each in measures)


def bench_of(mechanism: Mechanism) -> Bench:
    """A bench for one design or a batch; the strokes that measures of all strokes at once take are those of the `[require]` lines.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> bench_of(double_triangle()).command["x"]
    5e-05
    """
    return Bench(mechanism, _box(requirements(mechanism)))


def _box(lines: tuple[Requirement, ...]) -> dict[str, float]:
    return {line.name: line.limit for line in lines if line.subject is Subject.STROKE}


def measured_on(bench: Bench, asked: Measure) -> Array | str:
    """The value (...) of one measure, or the reason in words.

    >>> from flexstage.analysis.requirements import measure
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> round(float(measured_on(bench_of(stage), measure(stage, "mass", "here"))), 2)
    14.0
    """
    try:
        return np.asarray(_MEASURES[asked.subject](bench, asked))
    except DesignError as error:
        return str(error)


def _judged(bench: Bench, line: Requirement) -> Verdict:
    value = measured_on(bench, line)
    if isinstance(value, str):
        return Verdict(line, None, value)
    drawn = Verdict(line, value)
    doubt = _loaded_doubt(bench, drawn) or _large_doubt(bench, drawn)
    return Verdict(line, None, doubt) if doubt else drawn


def _large_doubt(bench: Bench, drawn: Verdict) -> str:
    """Why a line about motion that linear models say is met is not known: what it asks for is no small motion; empty where it is."""
    line = drawn.requirement
    if drawn.value is None or np.ndim(drawn.value) or not drawn.passed:
        return ""
    if line.subject is Subject.STROKE and line.sense is Sense.AT_LEAST:
        asked: Mapping[str, float] = {line.name: line.limit}
    elif line.subject is Subject.CORNER:
        asked = bench.box()
    elif line.subject in _BY_STROKES and bench.kinematics.actuated:
        single = single_axis(bench.kinematics.mapping, bench.limits)
        asked = dict(zip(single.coordinates, (float(each) for each in single.symmetric), strict=True))
    else:
        return ""
    doubt = small_motion(bench.mechanism, bench.kinematics).doubt(asked)
    return f"withheld: {doubt}" if doubt else ""


def _loaded_doubt(bench: Bench, drawn: Verdict) -> str:
    """Why a line that the drawn stage meets may be missed by the loaded one: its weight softens it; empty where it is met either way."""
    line = drawn.requirement
    power = _SOFTENED.get(line.subject)
    if power is None or drawn.value is None or np.ndim(drawn.value) or not drawn.passed:
        return ""
    factor = float(np.real(bench.stability.dead))
    loaded = Verdict(line, drawn.value * (1.0 - 1.0 / factor) ** power)
    if loaded.passed:
        return ""
    return (
        f"withheld: it is {float(drawn.value):.4g} {line.quantity.si} as drawn, but weight softens the stage (load factor {factor:.3g}): "
        f"loaded it may be {float(np.asarray(loaded.value)):.4g} {line.quantity.si}"
    )


class Bench:
    """Models and results of one stage, each worked out when first asked for. `command`: the required strokes as a box."""

    def __init__(self, mechanism: Mechanism, command: Mapping[str, float]) -> None:
        self.mechanism = mechanism
        self.command = command
        self._corrections: dict[str, Matrix] = {}

    def correction(self, point: str) -> Matrix:
        """Strokes per motion of a point, lost motion made up by command."""
        if point not in self._corrections:
            self._corrections[point] = mapping_at(self.mechanism, self.kinematics, point, mapping=self.lost.correction)
        return self._corrections[point]

    @cached_property
    def assembly(self) -> Assembly:
        """The description expanded."""
        return expand(self.mechanism)

    @cached_property
    def kinematics(self) -> Kinematics:
        """The ideal model."""
        return ideal(self.mechanism)

    @cached_property
    def model(self) -> LinearModel:
        """The lumped model, of a stage that stands under its dead load."""
        return standing(self.mechanism)

    @cached_property
    def stability(self) -> Stability:
        """Load factors of the dead load."""
        return under_load(self.mechanism) or stability(self.mechanism, self.model)

    @cached_property
    def limits(self) -> StrokeLimits:
        """Strokes around the bias."""
        return stroke_limits(self.mechanism)

    @cached_property
    def lost(self) -> LostMotion:
        """Lost motion."""
        return lost_motion(self.kinematics, self.model)

    @cached_property
    def modes(self) -> Modes:
        """Modes, the platform's among them below the description's limit."""
        limit = self.mechanism.mode_limit
        return modes(self.model, limit=np.inf if limit is None else float(np.max(limit)))

    @cached_property
    def platform_frequencies(self) -> Array:
        """Frequencies of the platform's modes (..., k) [Hz], of a batch chosen design by design; NaN where one has fewer than others."""
        found = self.modes
        if found.frequencies.ndim == 1:
            return found.platform_frequencies
        flat = found.frequencies.reshape(-1, found.frequencies.shape[-1])
        mask = chosen((2.0 * np.pi * flat) ** 2, found.share.reshape(flat.shape), Choice(limit=found.limit)).mask
        ordered = np.sort(np.where(mask, flat, np.nan), axis=-1)[:, : int(np.max(np.sum(mask, axis=-1), initial=0))]
        return ordered.reshape(*found.frequencies.shape[:-1], -1)

    @cached_property
    def stress(self) -> HingeStress:
        """Stress of hinges over all strokes, relaxed without voltage."""
        return hinge_stress(self.mechanism, self.model, self.limits.from_zero)

    @cached_property
    def drift(self) -> Drift:
        """Motion by temperature."""
        return drift(self.mechanism, self.model)

    @cached_property
    def room(self) -> Room:
        """What the stage occupies."""
        return room(self.mechanism)

    @cached_property
    def size(self) -> Array:
        """Edges of the bounding box (..., 3) [m]."""
        low, high, _ = bounds(outlines(self.assembly))
        return high - low

    @cached_property
    def map_error(self) -> Array:
        """Largest errors of the linear map (..., 6)."""
        return linear_map_error(self.mechanism, self.kinematics, self.limits).worst

    def arm(self, point: str) -> Array:
        """From the platform's reference to a point of the platform; refused for points of other bodies."""
        if point == PLATFORM:
            return np.zeros(3)
        body, position = self.assembly.points[point]
        if body != PLATFORM:
            raise refuse(point, f"is a point of {body}", "Name a point of the platform")
        return position - self.assembly.bodies[PLATFORM].reference

    def box(self) -> Mapping[str, float]:
        """The box of all required strokes."""
        if not self.command:
            raise refuse(
                "require", "no stroke is required, so there is no corner to reach", 'Add for example "stroke.x" = "at least 50 um"'
            )
        return self.command


def _stroke(bench: Bench, line: Measure) -> Array:
    mapping = bench.correction(line.point)
    if line.name not in mapping.columns:
        raise refuse(f"stroke.{line.name}", "is no ideal motion of this stage", f"Its ideal motions are {', '.join(mapping.columns)}")
    return single_axis(mapping, bench.limits).symmetric[..., mapping.columns.index(line.name)]


def _corner(bench: Bench, _: Measure) -> Array:
    return np.max(utilisation(bench.lost.correction, bench.limits, bench.box()).ratio, axis=-1)


def _frequency(bench: Bench, line: Measure) -> Array:
    return _numbered(bench.modes.frequencies, line)


def _platform_frequency(bench: Bench, line: Measure) -> Array:
    return _numbered(bench.platform_frequencies, line)


def _numbered(frequencies: Array, line: Measure) -> Array:
    count = frequencies.shape[-1]
    if int(line.name) > count:
        raise refuse(f"require.{line.key}", f"there are {count} such modes", "Ask for a lower number")
    return frequencies[..., int(line.name) - 1]


def _safety(bench: Bench, _: Measure) -> Array:
    if bench.stress.unknown:
        links = ", ".join(bench.stress.unknown[:3])
        raise refuse(
            "safety", f"the material of {links} states no yield stress", 'Add for example yield_stress = "1360 MPa" to the material'
        )
    return bench.stress.least


def _buckling(bench: Bench, _: Measure) -> Array:
    return buckling(bench.mechanism, lumped(bench.mechanism), bench.limits.from_zero).least


def _stiffness(bench: Bench, line: Measure) -> Array:
    index = COMPONENTS.index(line.name)
    return 1.0 / _compliance(bench, line)[..., index, index]


def _directed_stiffness(bench: Bench, line: Measure) -> Array:
    along, start = direction_of(line.name, line.key), 3 * line.name.startswith("r")
    return 1.0 / (along @ _compliance(bench, line)[..., start : start + 3, start : start + 3] @ along)


def _least_stiffness(bench: Bench, line: Measure) -> Array:
    """Real directions, so that derivatives by complex step are those of a simple eigenvalue."""
    block = _compliance(bench, line)[..., :3, :3]
    worst = np.linalg.eigh(0.5 * np.real(block + np.swapaxes(block, -1, -2)))[1][..., :, -1]
    return 1.0 / np.einsum("...i,...ij,...j->...", worst, block, worst)


def _compliance(bench: Bench, line: Measure) -> Array:
    return statics(bench.model, load_point=line.point, read_point=line.point).compliance.values


def _deflection(bench: Bench, line: Measure) -> Array:
    causes = deflection(bench.mechanism, bench.model, point=line.point).by_cause
    return magnitude(np.sum(causes.values[..., causes.rows.index(f"{line.point}.{line.name}"), :], axis=-1))


def _total_mass(bench: Bench, _: Measure) -> Array:
    """Links by their integrals over the profile: a rigid motion along has the mass of both ends and what is between them."""
    bodies = [body.mass.mass for body in bench.assembly.bodies.values() if body.mass is not None]
    ends = [mass(link.part, link.material) for link in bench.assembly.links.values()]
    links = [each[..., 0, 0] + each[..., 0, 6] + each[..., 6, 0] + each[..., 6, 6] for each in ends]
    return sum([*bodies, *links], np.asarray(0.0))


def _force(bench: Bench, line: Measure) -> Array:
    lines = platform_lines(bench.kinematics.mapping, bench.model, bench.limits)
    if line.name not in lines.coordinates:
        raise refuse(f"force.{line.name}", "is no ideal motion of this stage", f"Its ideal motions are {', '.join(lines.coordinates)}")
    return lines.blocking[..., lines.coordinates.index(line.name)]


def _loss(bench: Bench, line: Measure) -> Array:
    own = magnitude(np.diagonal(bench.lost.loss.values, axis1=-2, axis2=-1))
    return own[..., bench.lost.loss.rows.index(line.name)] if line.name else np.max(own, axis=-1)


def _crosstalk(bench: Bench, _: Measure) -> Array:
    values = bench.lost.loss.values
    return np.max(magnitude(values * (1.0 - np.eye(values.shape[-1]))), axis=(-2, -1))


def _map_error(bench: Bench, line: Measure) -> Array:
    return bench.map_error[..., COMPONENTS.index(line.name)]


def _drift(bench: Bench, line: Measure) -> Array:
    return magnitude(bench.drift.motion.at(f"{line.point}.{line.name}", "uniform"))


def _mass(bench: Bench, _: Measure) -> Array:
    own = bench.assembly.bodies[PLATFORM].mass
    if own is None:
        raise refuse("platform", "has neither solids nor a stated mass", "Give it a solid of a material with a density, or its mass")
    return own.mass


def _size(bench: Bench, line: Measure) -> Array:
    return bench.size[..., COMPONENTS.index(line.name or "z")]


def _opening(bench: Bench, _: Measure) -> Array:
    if bench.mechanism.opening is None:
        raise refuse("opening", "the description has no clear opening", 'Add for example opening = { size = ["110 mm", "110 mm"] }')
    depths = [item.depth for item in bench.room.intrusions]
    return np.max(np.stack(np.broadcast_arrays(*depths)), axis=0) if depths else np.asarray(0.0)


def _resolution(bench: Bench, line: Measure) -> Array:
    seen = pose_resolution(bench.mechanism, bench.kinematics)
    inverse = transport(bench.arm(line.point)) @ seen.inverse.values
    return (magnitude(inverse) @ seen.gauge_steps[..., None])[..., COMPONENTS.index(line.name), 0]


def _gauge_range(bench: Bench, line: Measure) -> Array:
    ratio = gauge_swing(bench.kinematics, bench.box()) / half_ranges(bench.assembly)
    return ratio[..., bench.kinematics.gauges.index(line.name)] if line.name else np.max(ratio, axis=-1)


def _load(bench: Bench, line: Measure) -> Array:
    share = load_share(bench.mechanism, bench.model)
    limits = bench.limits.from_zero
    if line.name:
        return share.range(limits)[1][..., share.actuators.index(line.name)]
    use = share.use(limits)
    if np.any(np.isnan(use)) or np.any(np.isnan(share.maximum)):
        raise refuse("load", "not every stack states its maximum load", 'Add for example maximum_load = "5000 N" to the stack')
    if use.ndim == 1:
        require(each for each in share.pulled(limits) if "neither" in each.what)
    return np.max(use, axis=-1)


_SOFTENED = {
    Subject.FREQUENCY: 0.5,
    Subject.PLATFORM_FREQUENCY: 0.5,
    Subject.STIFFNESS: 1.0,
    Subject.DIRECTED_STIFFNESS: 1.0,
    Subject.LEAST_STIFFNESS: 1.0,
    Subject.DEFLECTION: -1.0,
}
"""With which power of 1 - 1/factor a measure changes where the load softens it most."""

_BY_STROKES = (Subject.SAFETY, Subject.BUCKLING, Subject.LOAD, Subject.OWN_LOAD)
"""Measures over all strokes."""

_MEASURES: Mapping[Subject, Callable[[Bench, Measure], Array]] = {
    Subject.STROKE: _stroke,
    Subject.CORNER: _corner,
    Subject.FREQUENCY: _frequency,
    Subject.PLATFORM_FREQUENCY: _platform_frequency,
    Subject.SAFETY: _safety,
    Subject.BUCKLING: _buckling,
    Subject.STIFFNESS: _stiffness,
    Subject.DIRECTED_STIFFNESS: _directed_stiffness,
    Subject.LEAST_STIFFNESS: _least_stiffness,
    Subject.DEFLECTION: _deflection,
    Subject.FORCE: _force,
    Subject.LOSS: _loss,
    Subject.OWN_LOSS: _loss,
    Subject.CROSSTALK: _crosstalk,
    Subject.MAP_ERROR: _map_error,
    Subject.DRIFT: _drift,
    Subject.MASS: _mass,
    Subject.TOTAL_MASS: _total_mass,
    Subject.SIZE: _size,
    Subject.HEIGHT: _size,
    Subject.OPENING: _opening,
    Subject.RESOLUTION: _resolution,
    Subject.GAUGE_RANGE: _gauge_range,
    Subject.OWN_GAUGE_RANGE: _gauge_range,
    Subject.LOAD: _load,
    Subject.OWN_LOAD: _load,
    Subject.OFFERED: lambda bench, asked: offered(asked.name).value(bench),
}
