"""Architectures: design files with named numbers. A specification sets some numbers; the search varies the others within ranges."""

from __future__ import annotations

import functools
import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import resources
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from flexstage.base.finding import DesignError
from flexstage.base.lazy import LazyModule
from flexstage.base.number import Array
from flexstage.base.units.dimension import dimension_of
from flexstage.base.units.expression import Amount, evaluate, parse_expression
from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import quantity_of_dimension, show
from flexstage.mechanism.catalogue import shipped_catalogue
from flexstage.mechanism.store import loads
from flexstage.mechanism.store.decode import catalogue_of, mechanism_from
from flexstage.spatial.frame import COMPONENTS
from flexstage.studies.synthesis.specification import FREQUENCY_KEYS, Specification
from flexstage.studies.tolerances.reach import reach

if TYPE_CHECKING:
    import tomlkit
else:
    tomlkit = LazyModule("tomlkit")  # bounds need none of it

_LENGTH, _ANGLE = dimension_of("m"), dimension_of("rad")
_DIGITS = 7
_COPIES = 512
_FRONT = 5
_SPARE = 1e-4
"""A quarter of the range of a gauge for a motion that is not required [m, rad]."""
DESIGN = "stage.toml"
"""Name of the design file in studies of the search."""
_TURNS: Mapping[str, Array] = {
    "x": np.eye(3),
    "y": np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
    "z": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
}
"""Axes of an architecture's file as rows in the frame of the specification, by the motion that corresponds to the file's x."""


@dataclass(frozen=True)
class LeafRule:
    """Guided leaves whose end moves by the fraction `share` of the displacement; the formula `room` is the available length."""

    share: float
    room: str


@dataclass(frozen=True, kw_only=True)
class Architecture:
    """An architecture: its `name`, the sets of motions that it `serves`, and its actuators (see `architectures.toml`)."""

    name: str
    kind: str
    slot: str
    count: int
    serves: tuple[frozenset[str], ...] = ()
    turns: bool = False
    own: bool = False
    direct: bool = False
    struts: bool = False
    leaf: LeafRule | None = None
    set: Mapping[str, str] = field(default_factory=dict)
    ranges: Mapping[str, tuple[str, str, str]] = field(default_factory=dict)
    limits: Mapping[str, str] = field(default_factory=dict)
    """Smallest values of measures, as formulas."""
    drawing: str = ""
    """Text of the design file, if the folder of architectures does not contain this file."""

    def is_for(self, motions: frozenset[str]) -> bool:
        """Return whether the architecture has exactly these motions.

        >>> architectures()["guide"].is_for(frozenset({"z"})), architectures()["guide"].is_for(frozenset({"rz"}))
        (True, False)
        """
        return motions in self.serves or (self.turns and len(motions) == 1 and motions <= set("xyz"))

    @property
    def text(self) -> str:
        """Text of the design file."""
        return self.drawing or _file(f"{self.name}.toml")


def _file(name: str) -> str:
    return resources.files("flexstage.studies.synthesis").joinpath("architectures", name).read_text(encoding="utf-8")


@functools.cache
def architectures() -> dict[str, Architecture]:
    """Return the shipped architectures by name.

    >>> architectures()["hexapod"].count
    6
    """
    found = {}
    for name, table in tomllib.loads(_file("architectures.toml")).items():
        serves = tuple(frozenset(each) for each in table.pop("serves", ()))
        leaf = LeafRule(**table.pop("leaf")) if "leaf" in table else None
        found[name] = Architecture(name=name, serves=serves, leaf=leaf, **table)
    return found


@dataclass(frozen=True, eq=False)
class CatalogueActuator:
    """An actuator of the catalogue: the `name` of its entry, the `kind` of its section, and its `part`."""

    name: str
    kind: str
    part: Any

    @property
    def stroke(self) -> float:
        """Full stroke [m]; for a coil, its travel."""
        return float(self.part.travel or np.inf) if self.kind == "voice_coil" else float(self.part.stroke)

    @property
    def stiffness(self) -> float:
        """Stiffness along the stroke [N/m]; for an amplified actuator, u^T k u with 6x6 stiffness k and free deformation u per stroke."""
        if self.kind == "piezo":
            return float(self.part.stiffness)
        return float(self.part.free_deformation @ self.part.between @ self.part.free_deformation)

    @property
    def force(self) -> float:
        """Continuous force of a coil [N]."""
        part = self.part
        limits = (part.continuous_current or part.peak_current, part.heat_current)
        return float(part.force_constant * min(each or np.inf for each in limits))


def catalogue_actuators(spec: Specification, where: str = "spec") -> dict[str, list[CatalogueActuator]]:
    """Return the actuators of the catalogue that a specification allows, by kind, sorted by name.

    >>> from flexstage.studies.synthesis.specification import example
    >>> [each.name for each in catalogue_actuators(example())["piezo"]][:1]
    ['PSt 1000/10/150 VS18']
    """
    known = catalogue_of(spec.catalogue, where)
    kinds = {each.value for each in spec.actuators.kinds}
    found: dict[str, list[CatalogueActuator]] = {kind: [] for kind in sorted(kinds)}
    for section in known.sections:
        if section.key != "parts" or section.kind not in kinds:
            continue
        for name in sorted(section.entries):
            if spec.actuators.like is None or name in spec.actuators.like:
                found[str(section.kind)].append(
                    CatalogueActuator(name, str(section.kind), catalogue_entry(spec, "parts", name, kind=str(section.kind)))
                )
    return found


def catalogue_entry(spec: Specification, section: str, like: str, kind: str | None = None) -> Any:
    """Return an entry of the catalogue as a material or part of a stage."""
    tree = {"format": "flexstage 1", "name": "a", section: {"entry": {"like": like} if kind is None else {"like": like, "kind": kind}}}
    if spec.catalogue is not None:
        tree["catalogue"] = spec.catalogue
    return getattr(mechanism_from(tree), section)["entry"]


def turned_axes(architecture: Architecture, spec: Specification) -> Array:
    """Return the axes of the architecture's frame, as rows (3, 3) in the frame of the specification.

    >>> from flexstage.studies.synthesis.specification import example
    >>> turned_axes(architectures()["carriages"], example()).tolist() == np.eye(3).tolist()
    True
    """
    return _TURNS[next(iter(spec.displacements))] if architecture.turns else np.eye(3)


def scope(architecture: Architecture, spec: Specification, actuator: CatalogueActuator) -> dict[str, Amount]:
    """Return the numbers that formulas of an architecture may use, in the architecture's frame."""
    turn = np.abs(turned_axes(architecture, spec))
    box, size = turn @ np.array(spec.box.size), turn @ np.array(spec.payload.size or (0.02, 0.02, 0.01))
    found = {f"box_{axis}": box[index] for index, axis in enumerate("xyz")} | {
        f"payload_{axis}": size[index] for index, axis in enumerate("xyz")
    }
    found |= {"height": payload_height(spec), "thinnest": spec.make.thinnest, "opening": min(spec.box.opening or (0.03, 0.03))}
    found |= {
        "stroke": actuator.stroke,
        "length": getattr(actuator.part, "length", None) or 0.0,
        "diameter": getattr(actuator.part, "diameter", None) or 0.0,
    }
    amounts = {name: Amount(float(value), _LENGTH) for name, value in found.items()}
    amounts["plate_speed"] = Amount(_plate_speed(spec), dimension_of("m/s"))
    if (frequency := spec.least(FREQUENCY_KEYS[0])) is not None:
        amounts["frequency"] = Amount(frequency, dimension_of("1/s"))
    moved = spec.displacements
    named = {"x": next(iter(moved.values()))} if architecture.turns else moved
    return amounts | {axis: Amount(value, _ANGLE if axis.startswith("r") else _LENGTH) for axis, value in named.items()}


def _plate_speed(spec: Specification) -> float:
    """The factor sqrt(E / (12 rho (1 - nu^2))) of the bodies' material in the frequencies of plates [m/s]."""
    body = catalogue_entry(spec, "materials", spec.make.bodies)
    return float((body.young / (12.0 * body.density * (1.0 - body.poisson**2))) ** 0.5)


def payload_height(spec: Specification) -> float:
    """Return the height of the payload's centre above the platform [m]."""
    if spec.payload.height is not None:
        return spec.payload.height
    return 0.5 * spec.payload.size[2] if spec.payload.size else 0.0


@dataclass(frozen=True, eq=False)
class Variable:
    """A named number that the search varies between `low` and `high`, from the initial value `start` [SI]."""

    name: str
    quantity: Quantity
    low: float
    start: float
    high: float


def variables(architecture: Architecture, known: Mapping[str, Amount]) -> Iterator[Variable]:
    """Yield the numbers of an architecture that the search varies, with their ranges. Each initial value is limited to the range."""
    for name, formulas in architecture.ranges.items():
        low, start, high = (evaluate(parse_expression(text), known) for text in formulas)
        most = max(float(high.value), 1.05 * float(low.value))
        yield Variable(name, quantity_of_dimension(low.dimension), float(low.value), float(np.clip(start.value, low.value, most)), most)


def measure_key(architecture: Architecture, spec: Specification, key: str) -> str:
    """Return the measure of a design for a requirement of the specification, with its axis in the architecture's frame.

    >>> from flexstage.studies.synthesis.specification import example
    >>> measure_key(architectures()["carriages"], example(), "unwanted")
    'frequency.unwanted'
    """
    if key in FREQUENCY_KEYS:
        return "frequency.1" if key == FREQUENCY_KEYS[0] else "frequency.unwanted"
    kind, _, axis = key.rpartition(".")
    if not architecture.turns or axis not in COMPONENTS:
        return key
    turn = np.abs(turned_axes(architecture, spec))
    own = "xyz"[int(np.argmax(turn[:, "xyz".index(axis[-1])]))]
    return f"{kind}.{axis[:-1]}{own}"


def requirement_lines(architecture: Architecture, spec: Specification, known: Mapping[str, Amount]) -> dict[str, str]:
    """Return the requirements of a design of this architecture, by measure."""
    lines = {}
    for key, formula in architecture.limits.items():
        if "frequency" in formula and "frequency" not in known:
            continue
        found = evaluate(parse_expression(formula), known)
        lines[key] = f"at least {show(float(found.value), quantity_of_dimension(found.dimension), digits=_DIGITS)}"
    for axis, value in spec.displacements.items():
        quantity = quantity_of_dimension(_ANGLE, "urad") if axis.startswith("r") else quantity_of_dimension(_LENGTH, "um")
        lines[measure_key(architecture, spec, f"stroke.{axis}")] = f"at least {show(value, quantity, digits=_DIGITS)}"
    lines |= {measure_key(architecture, spec, key): text for key, text in spec.requirements.items()}
    lines.setdefault("safety", "at least 2")
    if architecture.kind == "voice_coil":  # at peak current it would be that of unused force
        lines["safety.at_strokes"] = lines.pop("safety")
    if spec.together and architecture.kind != "voice_coil":
        lines["corner"] = "at most 100 %"
    box = np.abs(turned_axes(architecture, spec)) @ np.array(spec.box.size)
    return lines | {f"envelope.{axis}": f"at most {_mm(value)}" for axis, value in zip("xyz", box, strict=True)}


def _mm(value: float) -> str:
    return show(float(value), quantity_of_dimension(_LENGTH, "mm"), digits=_DIGITS)


def draw(
    architecture: Architecture, spec: Specification, actuator: CatalogueActuator, replaced: Mapping[str, str | None] = MappingProxyType({})
) -> str:
    """Return the text of an architecture's design file for a specification, with the initial values of the search.

    `replaced` changes the limits of requirements, or removes requirements (`None`).
    """
    known = scope(architecture, spec, actuator)
    document = tomlkit.parse(architecture.text)
    tree: Any = document
    tree["name"] = f"{spec.name}: {architecture.name} with {actuator.name}"
    turn = turned_axes(architecture, spec)
    tree["envelope"] = [_mm(value) for value in np.abs(turn) @ np.array(spec.box.size)]
    tree["gravity"] = [f"{value:.7g} m/s^2" for value in turn @ np.array([0.0, 0.0, -9.80665])]
    if spec.box.opening is not None and not architecture.turns:
        tree["opening"] = {"size": [_mm(value) for value in spec.box.opening]}
    for name, like in (("flexure", spec.make.flexures), ("body", spec.make.bodies)):
        if name in tree["materials"]:
            tree["materials"][name] = _stated(spec, "materials", like)
    tree["parts"][architecture.slot] = {"kind": architecture.kind, **_stated(spec, architecture.kind, actuator.name)}
    _set_numbers(tree["numbers"], architecture, spec, known)
    _set_payload(tree, architecture, spec)
    _set_gauges(tree, architecture, spec)
    lines = {**requirement_lines(architecture, spec, known), **replaced}
    tree["requirements"] = {key: text for key, text in lines.items() if text is not None}
    return tomlkit.dumps(document)


def _set_gauges(tree: Any, architecture: Architecture, spec: Specification) -> None:
    """Add a gauge for each motion of the platform, at its reference; the sensors are assumed, since the specification names none."""
    motions = frozenset("x") if architecture.turns else frozenset(spec.displacements)
    axes = max((each for each in architecture.serves if motions <= each), key=len, default=motions)
    needed = {"x": next(iter(spec.displacements.values()))} if architecture.turns else spec.displacements
    gauges, sensors = tomlkit.table(), tomlkit.table()
    sensors.add(tomlkit.comment("assumed; replace them by your own"))
    for axis in sorted(axes, key=COMPONENTS.index):
        turns = axis.startswith("r")
        own = {"kind": "tilt", "resolution": "10 nrad"} if turns else {"kind": "encoder", "period": "4 um", "steps": 4096}
        span = quantity_of_dimension(_ANGLE, "mrad") if turns else quantity_of_dimension(_LENGTH, "mm")
        own["range"] = show(4.0 * needed.get(axis, _SPARE), span, digits=3)
        sensors[axis] = own
        pose = {"along": axis[-1], "up": "x"} if axis[-1] == "z" else {"along": axis[-1]}
        gauges[axis] = {"gauge": axis, "body": "platform", "pose": pose}
    tree["sensors"], tree["gauges"] = sensors, gauges


def _stated(spec: Specification, section: str, name: str) -> dict[str, Any]:
    """An entry of the catalogue in a design file: by name, or by its values where it is of the user's own."""
    found = [each for each in catalogue_of(spec.catalogue, "spec").sections if section in (each.name, each.kind) and name in each.entries]
    shipped = [each for each in shipped_catalogue().sections if section in (each.name, each.kind)]
    if not found or found[0].entries[name] == shipped[0].entries.get(name):
        return {"like": name}
    return {key: value for key, value in found[0].entries[name].items() if key != "tags"}


def _set_numbers(table: Any, architecture: Architecture, spec: Specification, known: Mapping[str, Amount]) -> None:
    """Set the numbers that a specification fixes, and the start values of the others; comments stay."""
    values = {name: evaluate(parse_expression(text), known) for name, text in architecture.set.items()}
    values |= {each.name: Amount(each.start, dimension_of(each.quantity.si)) for each in variables(architecture, known)}
    values |= {f"{architecture.slot}_{name}": known[name] for name in ("length", "diameter") if f"{architecture.slot}_{name}" in table}
    values |= {"payload_height": known["height"]} if "payload_height" in table else {}
    for name, amount in values.items():
        table[name] = show(float(amount.value), quantity_of_dimension(amount.dimension), digits=_DIGITS)
    table["payload_mass"] = f"{spec.payload.mass:.7g} kg"


def _set_payload(tree: Any, architecture: Architecture, spec: Specification) -> None:
    turn = turned_axes(architecture, spec)
    block = turn @ spec.inertia[3:, 3:] @ turn.T
    names = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
    inertia = {name: f"{block[at]:.7g} kg m^2" for name, at in names.items() if at[0] == at[1] or block[at] != 0.0}
    tree["payloads"]["load"]["inertia"] = inertia
    if architecture.turns:
        height = _mm(payload_height(spec))
        upright = abs(turn[0, 2]) > 0.5  # the motion is along z of the specification: the payload is on the face that moves
        tree["numbers"]["payload_at_x"] = f"length/2 + {height}" if upright else "0 mm"
        tree["numbers"]["payload_at_z"] = "0 mm" if upright else f"depth/2 + {height}"


def specified_goals(architecture: Architecture, spec: Specification) -> list[tuple[str, str]]:
    """Return the goals of a specification, each as a direction and a measure of a design of this architecture."""
    return [(each[0], measure_key(architecture, spec, each[1])) for each in (spec.goal, spec.second_goal) if each is not None]


def study_text(architecture: Architecture, spec: Specification, actuator: CatalogueActuator, goals: Sequence[tuple[str, str]]) -> str:
    """Return the study file of the search in an architecture: its variables, and one or two goals, each a direction and a measure."""
    lines = ['format = "flexstage study 1"', f"name = {json.dumps(spec.name)}", f'design = "{DESIGN}"', "", "[variables]"]
    for each in variables(architecture, scope(architecture, spec, actuator)):
        low, high = (show(value, each.quantity, digits=_DIGITS) for value in (each.low, each.high))
        step = "" if each.quantity.si == "rad" else f', step = "{_mm(spec.make.step)}"'
        even = "" if each.low <= 0.0 or each.quantity.si == "rad" else ", logarithmic = true"
        lines.append(f'{each.name} = {{ address = "numbers.{each.name}", from = "{low}", to = "{high}"{even}{step} }}')
    names = ("goal", "second")[: len(goals)]
    lines += ["", "[responses]", *(f'{name} = "{measure}"' for name, (_, measure) in zip(names, goals, strict=True)), "", "[optimise]"]
    lines += [f'{way} = "{name}"' for name, (way, _) in zip(names, goals, strict=True)]
    return "\n".join([*lines, f"pareto_points = {_FRONT}", f"starts = {spec.starts}", f"seed = {spec.seed}", ""])


def tolerance_text(architecture: Architecture, spec: Specification, actuator: CatalogueActuator, limits: Mapping[str, str]) -> str:
    """Return the tolerance study of a design: lengths, and the thickness of every hinge, are uniformly distributed within the tolerance.

    `limits` are requirements of the design. Requirements on named numbers are left out, because they are rules of the architecture.
    """
    spread = f'uniform = "{_mm(spec.make.tolerance)}"'
    lines = ['format = "flexstage study 1"', f"name = {json.dumps(spec.name)}", f'design = "{DESIGN}"', ""]
    lines += ["[tolerance]", "requirements = false", "crosstalk = false", f"copies = {_COPIES}", f"seed = {spec.seed}", "", "[limits]"]
    lines += [f"{json.dumps(key)} = {json.dumps(text)}" for key, text in limits.items() if not key.startswith("numbers.")]
    lines += ["", "[scatter]"]
    with suppress(DesignError):  # no hinges
        reach(loads(architecture.text, checked=False), "hinges.thickness")
        lines.append(f'hinges = {{ address = "hinges.thickness", {spread}, independent = true }}')
    lengths = [each.name for each in variables(architecture, scope(architecture, spec, actuator)) if each.quantity.si != "rad"]
    return "\n".join([*lines, *(f'{name} = {{ address = "numbers.{name}", {spread} }}' for name in lengths), ""])
