"""The specification of a stage: motions, payload, box and requirements, read from a file."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from flexstage.analysis.assessment.requirements import measure, requirement
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array
from flexstage.base.units.quantity import DISPLACEMENT, FREQUENCY, LENGTH, MASS, NOT_NEGATIVE, POSITIVE, RATIO, ROTATION, Bound, Quantity
from flexstage.base.units.unit import parse, show
from flexstage.mechanism.grammar.node import TextsNode
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.mechanism.store.decode import catalogue_of, dotted, record_from
from flexstage.mechanism.store.file import parse_toml, read_text
from flexstage.mechanism.store.lines import with_lines
from flexstage.mechanism.store.schema import schema_of
from flexstage.parts.body import Body, Inertia
from flexstage.spatial.frame import COMPONENTS

FORMAT = "flexstage specification 1"
FREQUENCY_KEYS = ("frequency", "unwanted")
"""Requirements that only specifications have: the first natural frequency, and the first frequency of a motion that is not required."""

EXAMPLE = """\
format = "flexstage specification 1"
name = "scanner"
motion = { x = "50 um", y = "50 um" }
payload = { mass = "30 g", size = ["30 mm", "30 mm", "5 mm"] }
box = { size = ["260 mm", "260 mm", "40 mm"] }
actuators = { kinds = ["piezo"] }
requirements.frequency = "at least 500 Hz"
"""
"""The specification of an XY scanner."""
_Texts = Annotated[tuple[str, ...], TextsNode()]
_Length = Annotated[float, LENGTH, POSITIVE]
_Box = tuple[_Length, _Length, _Length]
_STARTS = Bound(low=1.0)


class ActuatorKind(Enum):
    """Kinds of actuators, with the names of the parts in a design file."""

    PIEZO = "piezo"
    AMPLIFIED = "amplified"
    VOICE_COIL = "voice_coil"


@dataclass(frozen=True)
class MotionTable:
    """Required displacement of the payload along each axis, in both directions. An axis without a displacement must be stiff."""

    x: Annotated[float, DISPLACEMENT, POSITIVE] | None = None
    y: Annotated[float, DISPLACEMENT, POSITIVE] | None = None
    z: Annotated[float, DISPLACEMENT, POSITIVE] | None = None
    rx: Annotated[float, ROTATION, POSITIVE] | None = None
    ry: Annotated[float, ROTATION, POSITIVE] | None = None
    rz: Annotated[float, ROTATION, POSITIVE] | None = None


@dataclass(frozen=True)
class PayloadTable:
    """The payload: its mass, its `size` as a uniform block or its `inertia` about the centre of mass, and its `height` above the platform.

    The default height is half the height of the block.
    """

    mass: Annotated[float, MASS, POSITIVE]
    size: _Box | None = None
    inertia: Inertia | None = None
    height: Annotated[float, LENGTH, NOT_NEGATIVE] | None = None


@dataclass(frozen=True)
class BoxTable:
    """The largest size of the stage, and its clear opening along z."""

    size: _Box
    opening: tuple[_Length, _Length] | None = None


@dataclass(frozen=True)
class MakeTable:
    """Materials of flexures and of bodies, by their catalogue names; smallest flexure thickness, step and tolerance (+-) of dimensions."""

    flexures: str = "7075-T6"
    bodies: str = "7075-T6"
    thinnest: _Length = 0.3e-3
    step: _Length = 10e-6
    tolerance: _Length = 10e-6


@dataclass(frozen=True)
class ActuatorTable:
    """The kinds of actuators to choose from. `like` restricts the choice to named entries of the catalogue."""

    kinds: tuple[ActuatorKind, ...] = tuple(ActuatorKind)
    like: _Texts | None = None


@dataclass(frozen=True)
class GoalTable:
    """The requirement to `maximise` or `minimise`, by its key. By default, the first required frequency is maximised.

    If both keys are used, `maximise` is the goal, and the Pareto front of both goals is also computed.
    """

    maximise: str | None = None
    minimise: str | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Specification:
    """The specification of a stage, in the frame of its box (z is up).

    `requirements` may contain `frequency` (first natural frequency), `unwanted` (first frequency of a motion that is not required), and any
    measure of a design file's requirements. By default, `safety` must be at least 2.

    If `together` is true, all displacements must be reached at once, in all combinations; otherwise, each displacement must be reached
    alone. `starts` and `seed` apply to the search of each pair.
    """

    name: str
    motion: MotionTable
    payload: PayloadTable
    box: BoxTable
    requirements: Mapping[str, str] = field(default_factory=dict)
    make: MakeTable = MakeTable()
    actuators: ActuatorTable = ActuatorTable()
    goals: GoalTable = GoalTable()
    together: bool = False
    catalogue: str | None = None
    starts: Annotated[int, _STARTS] = 2
    seed: Annotated[int, NOT_NEGATIVE] = 0

    @property
    def displacements(self) -> dict[str, float]:
        """The required displacements [m, rad] by axis."""
        found = {each.name: getattr(self.motion, each.name) for each in fields(self.motion)}
        return {axis: value for axis, value in found.items() if value is not None}

    @property
    def inertia(self) -> Array:
        """The payload's 6x6 inertia about its centre of mass [kg, kg m^2]."""
        block = np.zeros((3, 3))
        if self.payload.inertia is not None:
            each = self.payload.inertia
            block = np.array([[each.xx, each.xy, each.xz], [each.xy, each.yy, each.yz], [each.xz, each.yz, each.zz]], dtype=float)
        elif self.payload.size is not None:
            squares = np.square(self.payload.size)
            block = self.payload.mass / 12.0 * np.diag(np.sum(squares) - squares)
        found = np.zeros((6, 6))
        found[:3, :3], found[3:, 3:] = self.payload.mass * np.eye(3), block
        return found

    @property
    def masses(self) -> dict[str, float]:
        """Smallest effective mass or moment of inertia of the payload along each required motion, whatever other motions occur with it.

        For a rotation, it is 1 / (J^-1)_ii with the inertia J about the centre of mass, because (w_i)^2 <= (J^-1)_ii w^T J w for any
        angular velocity w.
        """
        least = dict.fromkeys("xyz", self.payload.mass)
        if any(axis not in least for axis in self.displacements):
            least |= zip(COMPONENTS[3:], 1.0 / np.linalg.inv(self.inertia[3:, 3:]).diagonal().copy(), strict=True)
        return {axis: float(least[axis]) for axis in self.displacements}

    def least(self, key: str, quantity: Quantity = FREQUENCY) -> float | None:
        """Return the required smallest value [SI] of a key, or `None` if it is not required."""
        text = self.requirements.get(key)
        if text is None:
            return None
        if not text.startswith("at least "):
            raise refuse(f"requirements.{key}", f'must begin with "at least" (got "{text}")', f'Use e.g. "at least {quantity.example}"')
        return parse(text.removeprefix("at least "), quantity, where=f"requirements.{key}")

    @property
    def goal(self) -> tuple[str, str]:
        """The direction (maximise, minimise) and the key of the goal."""
        if self.goals.minimise is not None and self.goals.maximise is None:
            return "minimise", self.goals.minimise
        default = next((key for key in FREQUENCY_KEYS if key in self.requirements), FREQUENCY_KEYS[0])
        return "maximise", self.goals.maximise or default

    @property
    def second_goal(self) -> tuple[str, str] | None:
        """The direction and the key of the second goal, if there are two."""
        both = self.goals.maximise is not None and self.goals.minimise is not None
        return ("minimise", str(self.goals.minimise)) if both else None


@check_arguments
def load_specification(path: str | os.PathLike[str]) -> Specification:
    """Read a specification file. Raises `DesignError` with all errors of the file.

    >>> load_specification("nowhere/spec.toml")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere/spec.toml: file not found. Check the path.
    """
    return loads_specification(read_text(path), where=os.fspath(path))


def loads_specification(text: str, *, where: str = "text") -> Specification:
    """Read a specification from its text. Paths of catalogues are relative to the folder of `where`.

    >>> found = loads_specification(EXAMPLE)
    >>> found.displacements, found.least("frequency"), found.goal
    ({'x': 5e-05, 'y': 5e-05}, 500.0, ('maximise', 'frequency'))
    """
    raw = parse_toml(text, where)
    try:
        if isinstance(raw.get("requirements"), dict):
            raw["requirements"] = dotted("requirements", raw["requirements"])
        found = _record(raw)
        if found.catalogue is not None:
            found = replace(found, catalogue=str((Path(where).parent / found.catalogue).resolve()))
        require([*_findings(found), *actuator_findings(found, where)])
    except DesignError as error:
        raise DesignError(with_lines(error.findings, text, where)) from None
    return found


def _record(raw: dict[str, Any]) -> Specification:
    """The specification of a file; of one that cannot be read, errors of its requirements too."""
    try:
        return record_from(Specification, raw, FORMAT, tagged=False)
    except DesignError as error:
        given = raw.get("requirements")
        texts = {key: text for key, text in given.items() if isinstance(text, str)} if isinstance(given, dict) else {}
        raise DesignError([*error.findings, *_requirement_findings(replace(example(), requirements=texts))]) from None


def example() -> Specification:
    """Return the specification of an XY scanner.

    >>> example().displacements
    {'x': 5e-05, 'y': 5e-05}
    """
    return loads_specification(EXAMPLE)


def specification_schema() -> dict[str, Any]:
    """Return the JSON Schema of a specification file.

    >>> specification_schema()["properties"]["format"]
    {'const': 'flexstage specification 1'}
    """
    return schema_of(Specification, FORMAT, "flexstage specification", tagged=False)


def _findings(spec: Specification) -> Iterator[Finding]:
    """Contradictions within a specification."""
    if not spec.displacements:
        yield Finding("motion", "required displacement missing", 'Use e.g. motion = { x = "50 um" }')
    if not any(key in FREQUENCY_KEYS or key.startswith("stiffness") for key in spec.requirements):
        yield Finding("requirements", "required frequency or stiffness missing", 'Use e.g. frequency = "at least 100 Hz"')
    yield from _requirement_findings(spec)
    yield from _size_findings(spec)
    if any(axis.startswith("r") for axis in spec.displacements) and np.linalg.eigvalsh(spec.inertia)[0] <= 0.0:
        what = "a rotation is required, but the payload has no moment of inertia about an axis"
        yield Finding("payload", what, 'Use e.g. size = ["30 mm", "30 mm", "5 mm"]')


def _requirement_findings(spec: Specification) -> Iterator[Finding]:
    """Requirements that are no measure of every stage, or no limit of it."""
    frame = Mechanism(spec.name, bodies={PLATFORM: Body()})
    for key, text in spec.requirements.items():
        where = f"requirements.{key}"
        try:
            if key in (*FREQUENCY_KEYS, "safety"):
                spec.least(key, RATIO if key == "safety" else FREQUENCY)
            elif key.startswith("stroke."):
                yield Finding(where, "strokes belong in the section motion", f'Use e.g. motion.{key.removeprefix("stroke.")} = "50 um"')
            else:
                requirement(frame, key, text, where)
        except DesignError as error:
            yield from error.findings
    for way, goal in (("maximise", spec.goals.maximise), ("minimise", spec.goals.minimise)):
        if goal is not None and goal not in FREQUENCY_KEYS:
            try:
                measure(frame, goal, f"goals.{way}")
            except DesignError as error:
                yield from error.findings


def _size_findings(spec: Specification) -> Iterator[Finding]:
    """Sizes and displacements that do not fit into the box."""
    for axis, size, payload in zip("xyz", spec.box.size, spec.payload.size or (0.0,) * 3, strict=True):
        if payload > size:
            what = f"the payload is wider than the box along {axis} (got {_mm(payload)}, expected at most {_mm(size)})"
            yield Finding("payload.size", what, "Enlarge the box")
        if (spec.displacements.get(axis) or 0.0) > 0.5 * size:
            what = f"the displacement exceeds the box (got {_mm(spec.displacements[axis])}, expected at most {_mm(0.5 * size)})"
            yield Finding(f"motion.{axis}", what, "Enlarge the box")


def _mm(value: float) -> str:
    return show(value, LENGTH, digits=4)


def actuator_findings(spec: Specification, where: str) -> Iterator[Finding]:
    """Yield a finding for each actuator missing in the catalogue; the catalogue's path is relative to the folder of `where`."""
    names = [name for section in catalogue_of(spec.catalogue, where).sections if section.key == "parts" for name in section.entries]
    for name in spec.actuators.like or ():
        if name not in names:
            yield Finding("actuators.like", f'unknown actuator "{name}"', suggest_nearest(name, names))
