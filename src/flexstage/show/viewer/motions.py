"""Motions of a stage: its modes, strokes of actuators, ideal motions of its platform, deflections under permanent load, drift."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np

from flexstage.analysis.dynamics.modes import Modes
from flexstage.analysis.linear_statics.drift import FIELDS, drift
from flexstage.analysis.workspace.load import dead_loads
from flexstage.analysis.workspace.strength import sized_links, stress_shares
from flexstage.analysis.workspace.stroke import stroke_limits
from flexstage.base.number import Array, first_design
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import displacement, input_motion, part_deformation
from flexstage.show.display import format_value, number, to_typography
from flexstage.spatial.frame import COMPONENTS, FORCES

PLATFORM_MODE = "a mode of the platform"
"""First words of the remark on a platform mode."""
_UNIT_STROKES = {"m": 1e-6, "N": 1.0, "A": 1.0}
_UNIT_MOTION = 1e-6
_WARMER = ("1 K warmer", "1 K/m along x", "1 K/m along y", "1 K/m along z")


class Group(Enum):
    """Kind of a motion."""

    MODE = "mode"
    STROKE = "stroke"
    AXIS = "axis"
    DEFLECTION = "deflection"
    DRIFT = "drift"
    RESPONSE = "response"
    PATH = "path"
    STATE = "state"


@dataclass(frozen=True, eq=False)
class Curve:
    """A quantity at every point of a path: its `values` (p,) in its display `unit`, NaN if unknown."""

    name: str
    unit: str
    values: Array

    @property
    def span(self) -> str:
        """Text with the first value, the last value and the unit."""
        first, last = (to_typography(number(float(value), 4)) for value in (self.values[0], self.values[-1]))
        return f"{first} … {last} {self.unit}".strip()


@dataclass(frozen=True, eq=False)
class Response:
    """Small motion of a stage over time, as the sum of `weights` times `basis`.

    `basis` (n, b, 6) are the twists of all bodies at the stage's origin, for a unit of each of n coordinates. `weights` (f, n) are the
    coordinates at f equally spaced times. `curves` are quantities over time; the first is the time.
    """

    basis: Array
    weights: Array
    curves: tuple[Curve, ...]


@dataclass(frozen=True, eq=False)
class PathMotion:
    """Large displacements through the points of a path, or a small motion about one displaced state.

    `poses` (f, rows, 6) are displacements and rotation vectors of the ground, the bodies' reference points, and the nodes along bending
    pieces. `frames` (f,) are the numbers of the points of the path that have these poses. `shape` (rows, 6) is a small motion about the
    displaced state (None for large displacements). `curves` are quantities along the path; the first is the quantity that is varied. For
    every point, `beyond` contains the numbers of parts that exceed a limit, and `said` describes the exceeded limits.
    """

    frames: Array
    poses: Array
    shape: Array | None
    curves: tuple[Curve, ...]
    beyond: tuple[tuple[int, ...], ...]
    said: tuple[str, ...]

    @property
    def reach(self) -> float:
        """Largest displacement [m] of a body's reference point or of a node."""
        moved = self.poses if self.shape is None else self.shape
        return float(np.sqrt(np.max(np.sum(moved[..., :3] ** 2, axis=-1), initial=0.0)))


@dataclass(frozen=True, eq=False)
class Motion:
    """A motion of all bodies: `twists` (b, 6) at the stage's origin, the ground first.

    `name` is unique in its group; `remark` contains further information; modes have a `frequency` [Hz]. `energy` contains the strain-energy
    fractions of links and other elastic parts by name, `None` if unknown. `stress` contains the stress utilisation of links by name;
    `stressed` describes the state of this utilisation, such as the full stroke. The amplitudes of all motions except modes are physical. A
    motion with large displacements, along a path or about a displaced state, has a `course` instead of twists. Motions over time have a
    `response`; their twists belong to the time of the largest displacement.
    """

    group: Group
    name: str
    label: str
    twists: Array
    remark: str = ""
    frequency: float | None = None
    energy: Mapping[str, float] | None = None
    stress: Mapping[str, float] | None = None
    stressed: str = ""
    course: PathMotion | None = None
    response: Response | None = None


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Bodies of a stage by name, without the ground, with the reference points (3,) [m] of their twists in models."""

    references: Mapping[str, Array]

    def at_origin(self, twists: Mapping[str, Array]) -> Array:
        """Convert twists at reference points to twists (b + 1, 6) at the stage's origin: ground first, zeros for bodies without a twist."""
        own = [np.real(twists[name]) if name in twists else np.zeros(6) for name in self.references]
        rows = np.array([np.zeros(6), *own])
        rows[1:, :3] += np.cross(self._points, rows[1:, 3:])
        return rows

    @cached_property
    def _points(self) -> Array:
        return np.array(list(self.references.values())).reshape(-1, 3)


def body_twists(
    model: LinearModel, kinematics: Kinematics | None, shape: Array, bodies: Sequence[str], inputs: Array | None = None
) -> dict[str, Array]:
    """Compute the twists (6,) of bodies for a shape (n,) of the model's coordinates, and for `inputs` (m,) if specified.

    For a batch, the twists of the first design are computed. If the model contains only the platform, the other bodies move by the ideal
    kinematics.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> twists = body_twists(fs.mapped(stage), fs.ideal(stage), np.eye(6)[2], ("platform", "B4/pole"))
    >>> twists["platform"].round(9).tolist(), float(twists["B4/pole"][2].round(9))
    ([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], 1.0)
    """
    known = {channel.name: index for index, channel in enumerate(model.outputs)}
    outputs = first_design(model.output, 2) @ shape
    outputs = outputs if inputs is None else outputs + first_design(model.feedthrough, 2) @ inputs
    result: dict[str, Array] = {}
    for body in bodies:
        names = [f"{body}.{component}" for component in COMPONENTS]
        if all(name in known for name in names):
            result[body] = outputs[[known[name] for name in names]]
        elif kinematics is not None and names[0] in kinematics.body_coordinates and len(shape) == kinematics.mobility:
            rows = [kinematics.body_coordinates.index(name) for name in names]
            result[body] = first_design(kinematics.bodies, 2)[rows] @ shape
    return result


def mode_motions(
    model: LinearModel, kinematics: Kinematics | None, found: Modes, bones: Skeleton, count: int, *, about: str = ""
) -> Iterator[Motion]:
    """Yield the `count` lowest modes and all higher platform modes as mass-normalised motions. `about` is appended to all remarks."""
    frequencies, shapes = first_design(found.frequencies, 1), first_design(found.shapes, 2)
    last = max((*found.platform, -1)) + 1
    for index in range(min(len(found.names), max(count, last))):
        if index >= count and index not in found.platform:
            continue
        twists = body_twists(model, kinematics, shapes[:, index], tuple(bones.references))
        frequency = float(frequencies[index])
        label = f"{index + 1}  {number(frequency)} Hz  {found.names[index]}"
        remark = (PLATFORM_MODE if index in found.platform else "a mode of other bodies") + about
        energy = _energy(model, shapes[:, index])
        yield Motion(Group.MODE, str(index + 1), to_typography(label), bones.at_origin(twists), remark, frequency, energy)


def strain_shares(model: LinearModel, shapes: Array, inputs: Array | None = None) -> dict[str, Array]:
    """Return the fraction (k,) of the strain energy in every link and other elastic part, for k shapes (n, k) and inputs (m, k).

    The fractions are zero for a shape without strain energy. For a batch, the fractions belong to the first design.
    """
    deformed = {name: first_design(each, 2) for name, each in part_deformation(model, shapes, inputs).items()}
    parts = {name: np.einsum("ik,ij,jk->k", each, first_design(model.stiffness[name].law, 2), each) for name, each in deformed.items()}
    total = sum(parts.values(), np.zeros(shapes.shape[1]))
    return {name: each / np.where(total > 0.0, total, np.inf) for name, each in parts.items()}


def _energy(model: LinearModel, motion: Array, inputs: Array | None = None) -> dict[str, float] | None:
    """Strain-energy fractions of a shape (n,); `None` without energy."""
    found = {
        name: float(each[0]) for name, each in strain_shares(model, motion[:, None], None if inputs is None else inputs[:, None]).items()
    }
    return found if any(found.values()) else None


class Bearing:
    """Calculator of the stress utilisation of links from their sections, their stress limits, and their forces in a model."""

    def __init__(self, mechanism: Mechanism, model: LinearModel) -> None:
        known = {channel.name for channel in model.outputs}
        self._links = {name: link for name, link in sized_links(expand(mechanism)).items() if f"{name}.{FORCES[0]}" in known}
        self._limits = stroke_limits(mechanism) if model.strokes else None
        self._model = model

    def at(self, shapes: Array, inputs: Array | None = None) -> list[dict[str, float] | None]:
        """Compute the utilisation of each link for k shapes (n, k) of the model's coordinates and inputs (m, k); `None` if unknown."""
        if not self._links or not shapes.shape[1]:
            return [None] * shapes.shape[1]
        rows = self._model.output_index(tuple(f"{link}.{force}" for link in self._links for force in FORCES))
        wrenches = first_design(self._model.output, 2)[rows] @ shapes
        wrenches = wrenches if inputs is None else wrenches + first_design(self._model.feedthrough, 2)[rows] @ inputs
        each = wrenches.T.reshape(wrenches.shape[1], -1, 6)
        batch = self._model.designs
        shares = np.stack([first_design(stress_shares(self._links, own), 1) for own in each]) if batch else stress_shares(self._links, each)
        return [dict(zip(self._links, each, strict=True)) for each in shares.tolist()]

    def most(self, actuator: str) -> float | None:
        """Return the lower or upper stroke limit [m] of an actuator, whichever has the larger magnitude; `None` if unknown."""
        if self._limits is None or actuator not in self._limits.actuators:
            return None
        place = self._limits.actuators.index(actuator)
        return max((float(np.ravel(np.real(side))[place]) for side in (self._limits.high, self._limits.low)), key=abs)


def stroke_motions(mechanism: Mechanism, model: LinearModel, kinematics: Kinematics | None, bones: Skeleton) -> Iterator[Motion]:
    """Yield motions for a unit input of each actuator (1 um, 1 N or 1 A), with zero input of all other actuators.

    The stress is computed at the larger of the actuator's two stroke limits, which are measured from its bias or mid-range.
    """
    names, bearing = model.actuators, Bearing(mechanism, model)
    columns = model.input_index(names)
    moved = first_design(input_motion(model, columns), 2)
    units = [model.inputs[column].unit for column in columns]
    amounts = np.array([_UNIT_STROKES.get(unit, 1.0) for unit in units])
    driven = np.zeros((len(model.inputs), len(names)))
    driven[columns, np.arange(len(names))] = amounts
    shapes, ends = amounts * moved, [bearing.most(name) for name in names]
    times = np.array([0.0 if end is None else end for end in ends]) / amounts
    stresses = bearing.at(times * shapes, times * driven)
    for place, (name, unit, amount, most, stress) in enumerate(zip(names, units, amounts.tolist(), ends, stresses, strict=True)):
        inputs, shape = driven[:, place], shapes[:, place]
        twists = bones.at_origin(body_twists(model, kinematics, shape, tuple(bones.references), inputs))
        text = to_typography(format_value(amount, unit))
        stressed = "" if most is None else to_typography(f"at {format_value(most, unit)} of {name} alone")
        energy, known = _energy(model, shape, inputs), None if most is None else stress
        yield Motion(Group.STROKE, name, f"{name}  {text}", twists, "", None, energy, known, stressed)


def axis_motions(kinematics: Kinematics, bones: Skeleton) -> Iterator[Motion]:
    """Yield ideal motions of the platform by 1 um or 1 urad along each of its coordinates, and the strokes that they require."""
    bodies, strokes = first_design(kinematics.bodies, 2), first_design(kinematics.actuation, 2)
    rows = {name: place for place, name in enumerate(kinematics.body_coordinates)}
    for place, coordinate in enumerate(kinematics.coordinates):
        unit = "rad" if coordinate.startswith("r") else "m"
        known = [name for name in bones.references if f"{name}.x" in rows]
        twists = {name: _UNIT_MOTION * bodies[[rows[f"{name}.{each}"] for each in COMPONENTS], place] for name in known}
        taken = [
            f"{name} {format_value(_UNIT_MOTION * float(stroke), 'm')}"
            for name, stroke in zip(kinematics.actuators, strokes[:, place], strict=True)
            if abs(stroke) > 1e-9
        ]
        text = f"{coordinate}  {format_value(_UNIT_MOTION, unit)}"
        remark = f"strokes: {', '.join(taken)}" if taken else ""
        yield Motion(Group.AXIS, coordinate, to_typography(text), bones.at_origin(twists), to_typography(remark))


def deflections(mechanism: Mechanism, model: LinearModel, kinematics: Kinematics | None, bones: Skeleton) -> Iterator[Motion]:
    """Yield static deflections under own weight, payloads and specified forces, with fixed actuators.

    Loads without effect are left out. Raises `DesignError` if a part has no support against a load.
    """
    bearing = Bearing(mechanism, model)
    for name, load in dead_loads(mechanism, model).items():
        shape = first_design(displacement(model, load[..., None]), 2)[:, 0]
        if np.any(shape):
            twists = bones.at_origin(body_twists(model, kinematics, shape, tuple(bones.references)))
            energy, (stress,) = _energy(model, shape), bearing.at(shape[:, None])
            yield Motion(Group.DEFLECTION, name, name, twists, "actuators fixed", None, energy, stress, f"under {name} alone")


def drift_motions(mechanism: Mechanism, model: LinearModel, bones: Skeleton) -> Iterator[Motion]:
    """Yield thermal motions of the bodies for a temperature rise of 1 K, and for 1 K/m along each axis, with fixed actuators.

    The thermal expansion of the bodies is not drawn. Raises `DesignError` for unknown expansion coefficients.
    """
    found = drift(mechanism, model)
    for place, (name, label) in enumerate(zip(FIELDS, _WARMER, strict=True)):
        twists = bones.at_origin({body: first_design(each, 2)[:, place] for body, each in found.bodies.items()})
        if np.any(twists):
            yield Motion(Group.DRIFT, name, label, twists, f"actuators fixed, ground of {found.taken[GROUND]}")
