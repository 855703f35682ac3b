"""Architectures for motions that no shipped architecture has: guides from a ground structure, written as design files."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.units.expression import Amount, evaluate, parse_expression
from flexstage.spatial.frame import COMPONENTS
from flexstage.studies.synthesis.architecture import (
    Architecture,
    CatalogueActuator,
    architectures,
    catalogue_actuators,
    catalogue_entry,
    scope,
    variables,
)
from flexstage.studies.synthesis.constraint_space import pure_force_span, reciprocal_space, serial_guides, twists_of
from flexstage.studies.synthesis.ground_structure import (
    MIRRORS,
    QUARTER_TURN,
    Block,
    Element,
    Guide,
    Place,
    find_guide,
    places,
    with_actuators,
)
from flexstage.studies.synthesis.specification import MotionTable, Specification

SYNTHESISED: Mapping[str, str] = {"synthesised-stacks": "piezo", "synthesised-coils": "voice_coil"}
"""Names of synthesised architectures, and the kinds of their actuators."""
_SLOTS: Mapping[str, str] = {"piezo": "stack", "voice_coil": "coil"}
_STIFF = 20.0
"""Ratio of stiffnesses from which one row of elements on each side of the block is sufficient."""
_CONDITIONED = 0.1
"""Smallest accepted singular value of the scaled map from actuators to motions."""
_SET = {"payload_length": "payload_x", "payload_width": "payload_y"}
_RANGES: Mapping[str, tuple[str, str, str]] = {
    "seat": ("4 mm", "10 mm", "20 mm"),
    "skin": ("2 mm", "4 mm", "20 mm"),
    "gap_x": ("1 mm", "4 mm", "box_x/6"),
    "gap_y": ("1 mm", "4 mm", "box_y/6"),
    "gap_z": ("1 mm", "2 mm", "box_z/6"),
    "length_x": ("6 mm", "20 mm", "box_x/3"),
    "length_y": ("6 mm", "20 mm", "box_y/3"),
    "length_z": ("6 mm", "15 mm", "box_z/2"),
    "leaf_thickness": ("thinnest", "1.5*thinnest", "2 mm"),
    "wire": ("thinnest", "2*thinnest", "3 mm"),
    "neck": ("0.8 mm", "1.5 mm", "5 mm"),
}
_STACK_NUMBERS = {
    "neck_radius": "2.2*neck",
    "strut": "10 mm + 4*neck_radius + stack_length",
    "end": "neck + 2*neck_radius",
    "foot": "(stack_diameter + end + sqrt((stack_diameter - end)*(stack_diameter - end)))/2 + 1 mm",
    "cell": "(foot + seat + sqrt((foot - seat)*(foot - seat)))/2",
}
_GRID_NUMBERS = {
    "pitch_x": "cell + gap_x",
    "pitch_y": "cell + gap_y",
    "reach_x": "2*pitch_x + cell + 2 mm",
    "reach_y": "2*pitch_y + cell + 2 mm",
}
_BLOCK_NUMBERS = {
    "half_x": "(payload_length + reach_x + sqrt((payload_length - reach_x)*(payload_length - reach_x)))/4",
    "half_y": "(payload_width + reach_y + sqrt((payload_width - reach_y)*(payload_width - reach_y)))/4",
}
_OWN = r"\b(skin|length_[xyz]|leaf_thickness|wire|half_[xyz]|payload_length|payload_width|(?:leaf|wire)_(?:slenderness_)?[xyz])\b"
"""Names of numbers and parts that are separate for each of several guides in series."""
_CLEARANCE = 2e-3
"""Gap below a block on a tray, in addition to its displacement [m]."""
_HEADER = """# {title}: a block on wires and leaves, found by a search on a ground structure.
# Elements and actuators are in cells of a grid on its faces, with gaps between; leaves are as wide as their seat.
{series}format = "flexstage 1"
name = {name}
damping = {{ law = "modal", ratio = 0.01 }}
envelope = ["200 mm", "200 mm", "100 mm"]
ground = "body"

[materials]
flexure = {{ like = "7075-T6" }}
body = {{ like = "7075-T6" }}
"""
_BODY = """
[bodies.platform]                       # its motions are those of its centre, the origin
reference = ["0 mm", "0 mm", "0 mm"]
solids.block = { shape = "block", material = "body", size = ["2*half_x", "2*half_y", "2*half_z"] }
"""
_STRUT = """
[units.strut.bodies.base.solids.plate]
shape = "cylinder"
material = "steel"
diameter = "foot"
length = "5 mm"
along = "x"
at = ["-7.5 mm - 2*neck_radius - stack_length", "0 mm", "0 mm"]

[units.strut.bodies.tip.solids.plate]
shape = "cylinder"
material = "steel"
diameter = "foot"
length = "5 mm"
along = "x"
at = ["-2.5 mm - 2*neck_radius", "0 mm", "0 mm"]

[units.strut.links]
pzt = { joins = ["base", "tip"], part = "stack", at = ["-5 mm - 2*neck_radius - stack_length/2", "0 mm", "0 mm"], along = "x" }
"""
_STRUT_NECKS = """back = {{ joins = ["{base}", "base"], part = "neck", at = ["neck_radius - strut", "0 mm", "0 mm"], along = "x" }}
front = {{ joins = ["tip", "{body}"], part = "neck", at = ["-neck_radius", "0 mm", "0 mm"], along = "x" }}"""
_PAYLOAD = """
[payloads.load]
body = "platform"
mass = "payload_mass"
at = ["0 mm", "0 mm", "half_z + payload_height"]
inertia = { xx = "1e-5 kg m^2", yy = "1e-5 kg m^2", zz = "1e-5 kg m^2" }

[requirements]
"frequency.1" = "at least 10 Hz"
"""
_THIN: Mapping[str, str] = {"leaf": "leaf_thickness", "wire": "wire"}
_KINDS: Mapping[str, str] = {"leaf": "leaf", "wire": "rod"}
_SECTIONS: Mapping[str, str] = {"leaf": 'thickness = "leaf_thickness", width = "seat"', "wire": 'diameter = "wire"'}
_STACK_PARTS = """neck = { kind = "neck", material = "steel", thickness = "neck", profile = { shape = "circular", radius = "neck_radius" } }
stack = { kind = "piezo", like = "PiezoDrive SA050536" }"""
_COIL = (
    'coil = { kind = "voice_coil", force_constant = "4 N/A", peak_current = "2 A", continuous_current = "0.5 A", resistance = "6 ohm", '
    'mass = "10 g", magnet_mass = "40 g", travel = "1 mm", thermal_resistance = "12 K/W", temperature_rise = "50 K" }'
)
_STRUT_ENDS = 0.03
"""Length of a strut in addition to its stack, estimated for the choice of faces [m]."""


def find_architectures(spec: Specification, names: tuple[str, ...] = ()) -> list[Architecture]:
    """Return the architectures with the motions of a specification. If no shipped architecture has them, synthesise a guide.

    Raises `DesignError` if no architecture is found, with the reason if no parallel guide exists.

    >>> from flexstage.studies.synthesis.specification import MotionTable, example
    >>> [each.name for each in find_architectures(example(), ("carriages", "tilt"))]
    ['carriages']
    >>> [each.name for each in find_architectures(replace(example(), motion=MotionTable(rx=1e-3)))]
    ['synthesised-stacks']
    """
    known, motions = architectures(), frozenset(spec.displacements)
    if unknown := [name for name in names if name not in known and name not in SYNTHESISED]:
        raise refuse("--architecture", f'unknown architecture "{unknown[0]}"', f"Use one of {', '.join((*known, *SYNTHESISED))}")
    served = [each for _, each in sorted(known.items()) if each.is_for(motions)]
    if not served and spec.box.opening is not None:
        raise refuse("box.opening", f"the guide for the motions {_listed(motions)} has no opening", "Remove the opening")
    found = [each for each in served or synthesise(spec) if each.name in (names or (each.name,))]
    if not found:
        what = f"no architecture{' of those specified' if names else ' with these actuators'} has exactly the motions {_listed(motions)}"
        advice = 'Allow actuators of kind "piezo" or "voice_coil", or reduce make.thinnest'
        raise refuse("motion", what, "Use another --architecture" if names else advice)
    return found


def _reason(motions: frozenset[str]) -> str:
    """Why no parallel guide has the motions."""
    span = pure_force_span(reciprocal_space(twists_of(motions)))
    free = (axis for axis, row in zip(COMPONENTS, span, strict=True) if axis not in motions and np.linalg.norm(row) < 0.5)
    return f"pure forces that leave the motions {_listed(motions)} free do not constrain {' or '.join(free)}"


def _listed(motions: frozenset[str]) -> str:
    return ", ".join(sorted(motions, key=COMPONENTS.index))


def synthesise(spec: Specification) -> list[Architecture]:
    """Return architectures of a synthesised guide for the motions of a specification: one with stacks, one with coils."""
    known = catalogue_actuators(spec)
    found = (_drawn(spec, name, kind, known.get(kind, [])) for name, kind in SYNTHESISED.items())
    return [each for each in found if each is not None]


@dataclass(frozen=True)
class Layer:
    """One of the guides in series, with its actuators: number 1 carries the platform, and number n carries the tray under guide n - 1."""

    number: int
    guide: Guide
    rows: Sequence[int]
    last: bool

    @property
    def body(self) -> str:
        """Name of the guided body."""
        return "platform" if self.number == 1 else f"tray_{self.number}"

    @property
    def base(self) -> str:
        """Name of the body on which the guide is mounted."""
        return "ground" if self.last else f"tray_{self.number + 1}"

    @property
    def strut(self) -> str:
        """Name of the unit of the guide's actuators."""
        return "strut" if self.number == 1 else f"strut_{self.number}"

    @property
    def elements(self) -> list[tuple[str, str]]:
        """Parts of the guide's elements, each with the axis along which the elements extend."""
        return sorted({(_part(each), "xyz"[each.place.face]) for each in self.guide.elements})

    def named(self, text: str) -> str:
        """Return a text in which the guide's number is appended to the names of the guide's own quantities and parts."""
        return text if self.number == 1 else re.sub(_OWN, rf"\1_{self.number}", text)

    def point(self, place: Place, outside: str = "") -> str:
        """Return the formulas of a point on a face of the block, or at a distance `outside` from the face."""
        texts = ["0 mm" if not each else f"{'-' if each < 0 else ''}pitch_{axis}" for each, axis in zip(place.grid, "xyz", strict=True)]
        sign = "-" if place.side < 0 else ""
        texts[place.face] = f"{sign}half_{'xyz'[place.face]}" + (f" {sign or '+'} {outside}" if outside else "")
        if self.number > 1:
            texts[2] = f"level_{self.number} {f'- {texts[2][1:]}' if texts[2][0] == '-' else f'+ {texts[2]}'}"
        return json.dumps(texts)

    def ends(self, *, stacks: bool) -> dict[Place, str]:
        """Return the places of elements and struts, with the distances of their ends from the block."""
        ends = {each.place: f"length_{'xyz'[each.place.face]}" for each in self.guide.elements}
        return ends | (dict.fromkeys(self.guide.actuators, "strut") if stacks else {})


def _drawn(spec: Specification, name: str, kind: str, actuators: Sequence[CatalogueActuator]) -> Architecture | None:
    """The architecture with actuators of one kind, its places chosen for the shortest of them."""
    if not actuators:
        return None
    motions, first = frozenset(spec.displacements), min(actuators, key=_length)
    for guides in serial_guides(motions):
        last = len(guides)
        if any(axis in each and across not in motions for each in guides[1:] for axis, across in (("rx", "y"), ("ry", "x"))):
            continue  # a tray is below the platform: it turns about another point
        found = [(number, _guide(spec, first, each, tray=number < last)) for number, each in enumerate(guides, 1)]
        layers = [Layer(number, *each, last=number == last) for number, each in found if each is not None]
        if len(layers) == last:
            own = last == len(motions) > 1
            blank = Architecture(name=name, kind=kind, slot=_SLOTS[kind], count=len(motions), serves=(motions,), set=_SET)
            return _architecture(replace(blank, own=own, direct=own and motions <= set("xyz")), layers, spec)
    return None


def _guide(
    spec: Specification, actuator: CatalogueActuator, motions: frozenset[str], *, tray: bool
) -> tuple[Guide, tuple[int, ...]] | None:
    """The guide for some motions, with actuators, and its rows; on a `tray`, no actuator is in line with an element below or above."""
    spec = replace(spec, motion=MotionTable(**{axis: value for axis, value in spec.displacements.items() if axis in motions}))
    for rows, room in (((0,), spec.box.size), ((-1, 0, 1), spec.box.size), ((-1, 0, 1), (np.inf,) * 3)):
        block = nominal_block(spec, actuator, rows)
        guide = find_guide(block, motions, symmetries(spec), rows)
        if guide is None or (guide.ratio < _STIFF and np.all(np.isfinite(room))):
            continue
        strut = _length(actuator) + _STRUT_ENDS if actuator.kind == "piezo" else 0.0
        fits, taken = 2.0 * block.half + strut <= room, {(each.place.face, *each.place.grid[:2]) for each in guide.elements if tray}
        guide = with_actuators(
            guide, block, motions, [each for each in places(rows) if fits[each.face] and (each.face, *each.grid[:2]) not in taken]
        )
        if guide.conditioning > _CONDITIONED:
            return guide, rows
    return None


def _length(actuator: CatalogueActuator) -> float:
    return float(getattr(actuator.part, "length", None) or 0.0)


def nominal_block(spec: Specification, actuator: CatalogueActuator, rows: Sequence[int]) -> Block:
    """Return the block and the dimensions of candidate elements at the initial values of the search."""
    all_ranges = Architecture(name="", kind=actuator.kind, slot="", count=0, ranges=_RANGES)
    known = scope(all_ranges, spec, actuator)
    known |= {"stack_length": known["length"], "stack_diameter": known["diameter"]}
    known |= {each.name: Amount(each.start, known["length"].dimension) for each in variables(all_ranges, known)}
    for name, formula in {**_SET, **_grid_numbers(actuator.kind, rows), **_block_numbers(rows)}.items():
        known[name] = evaluate(parse_expression(formula), known)
    value = {name: float(amount.value) for name, amount in known.items()}
    half, pitch, length = (np.array([value.get(f"{kind}_{axis}", 0.0) for axis in "xyz"]) for kind in ("half", "pitch", "length"))
    material = catalogue_entry(spec, "materials", spec.make.flexures)
    return Block(half, pitch, length, value["leaf_thickness"], value["seat"], value["wire"], material)


def _grid_numbers(kind: str, rows: Sequence[int]) -> dict[str, str]:
    """Numbers of the grid. Its cells hold any element or strut, with gaps between: nothing can clash."""
    tall = {"pitch_z": "cell + gap_z"} if len(rows) > 1 else {}
    return {**(_STACK_NUMBERS if kind == "piezo" else {"cell": "seat"}), **_GRID_NUMBERS, **tall}


def _block_numbers(rows: Sequence[int]) -> dict[str, str]:
    """Half sizes of a block."""
    return {**_BLOCK_NUMBERS, "half_z": f"{'pitch_z + ' if len(rows) > 1 else ''}(cell + skin)/2"}


def _architecture(blank: Architecture, layers: Sequence[Layer], spec: Specification) -> Architecture:
    """The architecture with the text of its design file, and ranges and limits of the numbers that it uses."""
    stacks, rows = blank.kind == "piezo", max((each.rows for each in layers), key=len)
    used = ["seat", "gap_x", "gap_y", *(["gap_z"] if len(rows) > 1 else []), *(["neck"] if stacks else [])]
    ranges, slender = {name: _RANGES[name] for name in used}, dict[str, str]()
    numbers = {"stack_length": "36 mm", "stack_diameter": "6 mm"} if stacks else {}
    numbers |= {"payload_mass": "0.1 kg", "payload_height": "5 mm", **dict.fromkeys(_SET, "30 mm")}
    formulas = _grid_numbers(blank.kind, rows)
    for layer in layers:
        parts = layer.elements
        names = {"skin", *(f"length_{axis}" for _, axis in parts), *(_THIN[part] for part, _ in parts)}
        ranges |= {layer.named(name): each for name, each in _RANGES.items() if name in names}
        above = layers[layer.number - 2] if layer.number > 1 else None
        formulas |= {} if above is None else _tray_numbers(above, layer, spec, stacks=stacks)
        formulas |= {layer.named(name): layer.named(text) for name, text in _block_numbers(layer.rows).items()}
        own = {f"{part}_slenderness_{axis}": f"length_{axis}/{_THIN[part]}" for part, axis in parts}
        slender |= {layer.named(name): layer.named(text) for name, text in own.items()}
    start = {name: "1 mm" if "thinnest" in each[0] else "10 mm" for name, each in ranges.items()}
    text = "\n".join(_lines(blank, layers, {**start, **numbers, **formulas, **slender}))
    return replace(blank, drawing=text, ranges=ranges, limits={f"numbers.{name}": "10" for name in slender})


def _largest(texts: Iterable[str], least: str) -> str:
    """The formula of the largest of several lengths."""
    first, *others = sorted(set(texts)) or [least]
    for each in others:
        first = f"({first} + {each} + sqrt(({first} - {each})*({first} - {each})))/2"
    return first


def _tray_numbers(above: Layer, layer: Layer, spec: Specification, *, stacks: bool) -> dict[str, str]:
    """Size of a tray that carries the ends of the guide above; its plate is the block of its own guide, at `level`."""
    ends, number = above.ends(stacks=stacks), above.number
    far = {axis: [text for place, text in ends.items() if place.face == index] for index, axis in enumerate("xyz")}
    travel = max((value for axis, value in spec.displacements.items() if axis in "xyz"), default=0.0)
    under, start = f"drop_{number}", f"level_{number} - " if number > 1 else "-"
    drop = _largest(far["z"], f"{1e3 * (_CLEARANCE + travel):.7g} mm") + (" + 1 mm" if len(set(far["z"])) > 1 else "")
    size = {axis: f"2*half_{axis}" + (f" + 2*({_largest(far[axis], '')} + cell)" if far[axis] else "") for axis in "xy"}
    return {
        under: above.named(drop),
        layer.named("payload_length"): above.named(size["x"]),
        layer.named("payload_width"): above.named(size["y"]),
        f"level_{layer.number}": f"{start}{above.named('half_z')} - {under} - {layer.named('half_z')}",
    }


def _posts(above: Layer, *, stacks: bool) -> Iterator[str]:
    """Solids of a tray that carry the ends of the guide above, from its plate up to each end."""
    ends, level = above.ends(stacks=stacks), f"level_{above.number} " if above.number > 1 else ""
    under, several = f"drop_{above.number}", len({text for place, text in ends.items() if place.face == 2}) > 1
    tops = dict[tuple[int, tuple[int, int], str], int]()
    for place, text in ends.items():
        key = (place.face, place.grid[:2], text)
        tops[key] = max(place.grid[2], tops.get(key, -1))
    for number, ((face, grid, text), row) in enumerate(sorted(tops.items()), 1):
        if face == 2 and not several:
            continue  # on the plate
        middle = ["0 mm" if not each else f"{'-' if each < 0 else ''}pitch_{axis}" for each, axis in zip(grid, "xy", strict=True)]
        height = f"{under} - {text}"
        if face < 2:
            sign = "-" if grid[face] < 0 else ""
            middle[face] = f"{sign}half_{'xy'[face]} {sign or '+'} {text} {sign or '+'} cell/2"
            height = f"half_z + {under} + cell/2" + {-1: " - pitch_z", 0: "", 1: " + pitch_z"}[row]
        at = [*middle, f"{level}- half_z - {under} + ({height})/2"]
        size = ["cell", "cell", height]
        yield above.named(f'post_{number} = {{ shape = "block", material = "body", size = {json.dumps(size)}, at = {json.dumps(at)} }}')


def _lines(blank: Architecture, layers: Sequence[Layer], numbers: Mapping[str, str]) -> Iterator[str]:
    """Lines of the design file."""
    stacks = blank.kind == "piezo"
    series = "" if layers[-1].number == 1 else f"# {len(layers)} guides in series: {_reason(blank.serves[0])}.\n"
    steel = 'steel = { like = "AISI 420 hardened" }\n' if stacks else ""
    yield _HEADER.format(title=blank.name, name=json.dumps(blank.name), series=series) + steel
    yield from ("[numbers]", *(f'{name} = "{text}"' for name, text in numbers.items()), "", "[parts]")
    for layer in layers:
        for part, axis in layer.elements:
            text = f'{part}_{axis} = {{ kind = "{_KINDS[part]}", material = "flexure", length = "length_{axis}", {_SECTIONS[part]} }}'
            yield layer.named(text)
    yield from (_STACK_PARTS if stacks else _COIL, _BODY)
    for above, layer in pairwise(layers):
        at, size = json.dumps(["0 mm", "0 mm", f"level_{layer.number}"]), layer.named('["2*half_x", "2*half_y", "2*half_z"]')
        yield f'[bodies.{layer.body}.solids]\nplate = {{ shape = "block", material = "body", size = {size}, at = {at} }}'
        yield from (*_posts(above, stacks=stacks), "")
    if stacks:
        yield from _struts(layers)
    yield "\n[links]"
    names = dict[str, int]()
    for layer in layers:
        joins = f'joins = ["{layer.base}", "{layer.body}"]'
        for element in layer.guide.elements:
            part, axis = _part(element), "xyz"[element.place.face]
            bends = "" if element.width < 0 else f', bends = "{"xyz"[element.width]}"'
            names[part] = names.get(part, 0) + 1
            at = f'part = "{part}_{axis}", at = {layer.point(element.place, f"length_{axis}/2")}'
            yield f'{part}_{names[part]} = {{ {joins}, {layer.named(at)}, along = "{_inward(element.place)}"{bends} }}'
        for place in () if stacks else layer.guide.actuators:
            names["motor"] = names.get("motor", 0) + 1
            at = f'part = "{blank.slot}", at = {layer.named(layer.point(place))}'
            yield f'motor_{names["motor"]} = {{ {joins}, {at}, along = "{_inward(place)}" }}'
    yield _PAYLOAD


def _struts(layers: Sequence[Layer]) -> Iterator[str]:
    """Units and placements of the stacks between necks."""
    yield _STRUT + _STRUT_NECKS.format(base=layers[0].base, body=layers[0].body)
    for layer in layers[1:]:
        necks = _STRUT_NECKS.format(base=layer.base, body=layer.body)
        yield f'\n[units.{layer.strut}]\nlike = "strut"\n\n[units.{layer.strut}.links]\n{necks}'
    yield "\n[placements]"
    placed = ((layer, place) for layer in layers for place in layer.guide.actuators)
    for number, (layer, place) in enumerate(placed, 1):
        pose = f'at = {layer.named(layer.point(place))}, along = "{_inward(place)}", up = "{"xz"[place.face < 2]}"'
        yield f'B{number} = {{ unit = "{layer.strut}", pose = {{ {pose} }} }}'


def _part(element: Element) -> str:
    return "wire" if element.width < 0 else "leaf"


def _inward(place: Place) -> str:
    return f"{'-' if place.side > 0 else ''}{'xyz'[place.face]}"


def symmetries(spec: Specification) -> tuple[Array, ...]:
    """Return the symmetries of a specification: both mirrors of its box, and a quarter turn about z if x and y are equal.

    >>> from flexstage.studies.synthesis.specification import example
    >>> len(symmetries(example()))
    3
    """
    moved, sizes = spec.displacements, (spec.box.size, spec.payload.size or (0.0, 0.0, 0.0))
    equal = all(moved.get(one) == moved.get(other) for one, other in (("x", "y"), ("rx", "ry")))
    return (*MIRRORS, QUARTER_TURN) if equal and all(each[0] == each[1] for each in sizes) else MIRRORS
