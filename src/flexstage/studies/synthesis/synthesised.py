"""Architectures for motions that no shipped architecture has: guides from a ground structure, written as design files."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

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
from flexstage.studies.synthesis.constraint_space import has_parallel_guide, pure_force_span, reciprocal_space, serial_guides, twists_of
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
from flexstage.studies.synthesis.specification import Specification

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
    "end": "neck + 2*neck_radius",
    "foot": "(stack_diameter + end + sqrt((stack_diameter - end)*(stack_diameter - end)))/2 + 1 mm",
    "cell": "(foot + seat + sqrt((foot - seat)*(foot - seat)))/2",
}
_BLOCK_NUMBERS = {
    "pitch_x": "cell + gap_x",
    "pitch_y": "cell + gap_y",
    "reach_x": "2*pitch_x + cell + 2 mm",
    "reach_y": "2*pitch_y + cell + 2 mm",
    "half_x": "(payload_length + reach_x + sqrt((payload_length - reach_x)*(payload_length - reach_x)))/4",
    "half_y": "(payload_width + reach_y + sqrt((payload_width - reach_y)*(payload_width - reach_y)))/4",
}
_HEADER = """# {title}: a block on wires and leaves, found by a search on a ground structure.
# Elements and actuators are in cells of a grid on its faces, with gaps between; leaves are as wide as their seat.
format = "flexstage 1"
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
back = { joins = ["ground", "base"], part = "neck", at = ["-10 mm - 3*neck_radius - stack_length", "0 mm", "0 mm"], along = "x" }
pzt = { joins = ["base", "tip"], part = "stack", at = ["-5 mm - 2*neck_radius - stack_length/2", "0 mm", "0 mm"], along = "x" }
front = { joins = ["tip", "platform"], part = "neck", at = ["-neck_radius", "0 mm", "0 mm"], along = "x" }

[placements]"""
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
    """Return the architectures with the motions of a specification. If no shipped one has them, returns those of a synthesised guide.

    Raises `DesignError` if there is none, with the reason if no parallel guide exists.

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
    if not served and not has_parallel_guide(twists_of(motions)):
        raise refuse("motion", *_no_guide(motions))
    if not served and spec.box.opening is not None:
        raise refuse("box.opening", f"the guide for the motions {_listed(motions)} has no opening", "Remove the opening")
    found = [each for each in served or synthesise(spec) if each.name in (names or (each.name,))]
    if not found:
        what = f"no architecture{' of these' if names else ' with these actuators'} has exactly the motions {_listed(motions)}"
        advice = 'Allow actuators of kind "piezo" or "voice_coil", or reduce make.thinnest'
        raise refuse("motion", what, "Use another --architecture" if names else advice)
    return found


def _no_guide(motions: frozenset[str]) -> tuple[str, str]:
    """The reason without a parallel guide, and guides in series."""
    span = pure_force_span(reciprocal_space(twists_of(motions)))
    free = (axis for axis, row in zip(COMPONENTS, span, strict=True) if axis not in motions and np.linalg.norm(row) < 0.5)
    what = (
        f"no architecture has exactly the motions {_listed(motions)}, and no parallel guide of wires and leaves has: "
        f"no pure force that does no work on these motions constrains {' or '.join(free)}"
    )
    return what, f"Combine guides in series, e.g. {' on '.join(_listed(each) for each in serial_guides(motions))}"


def _listed(motions: frozenset[str]) -> str:
    return ", ".join(sorted(motions, key=COMPONENTS.index))


def synthesise(spec: Specification) -> list[Architecture]:
    """Return architectures of a synthesised guide for the motions of a specification: one with stacks, one with coils."""
    known = catalogue_actuators(spec)
    found = (_drawn(spec, name, kind, known.get(kind, [])) for name, kind in SYNTHESISED.items())
    return [each for each in found if each is not None]


def _drawn(spec: Specification, name: str, kind: str, actuators: Sequence[CatalogueActuator]) -> Architecture | None:
    """The architecture with actuators of one kind, its places chosen for the shortest of them."""
    if not actuators:
        return None
    motions, first = frozenset(spec.displacements), min(actuators, key=_length)
    blank = Architecture(name=name, kind=kind, slot=_SLOTS[kind], count=len(motions), serves=(motions,), set=_SET)
    for rows, room in (((0,), spec.box.size), ((-1, 0, 1), spec.box.size), ((-1, 0, 1), (np.inf,) * 3)):
        block = nominal_block(spec, first, rows)
        guide = find_guide(block, motions, symmetries(spec), rows)
        if guide is None or (guide.ratio < _STIFF and np.all(np.isfinite(room))):
            continue
        strut = _length(first) + _STRUT_ENDS if kind == "piezo" else 0.0
        fits = 2.0 * block.half + strut <= room
        guide = with_actuators(guide, block, motions, [each for each in places(rows) if fits[each.face]])
        if guide.conditioning > _CONDITIONED:
            return _architecture(blank, guide, rows)
    return None


def _length(actuator: CatalogueActuator) -> float:
    return float(getattr(actuator.part, "length", None) or 0.0)


def nominal_block(spec: Specification, actuator: CatalogueActuator, rows: Sequence[int]) -> Block:
    """Return the block and the dimensions of candidates at the initial values of the search."""
    all_ranges = Architecture(name="", kind=actuator.kind, slot="", count=0, ranges=_RANGES)
    known = scope(all_ranges, spec, actuator)
    known |= {"stack_length": known["length"], "stack_diameter": known["diameter"]}
    known |= {each.name: Amount(each.start, known["length"].dimension) for each in variables(all_ranges, known)}
    for name, formula in {**_SET, **_formulas(actuator.kind, rows)}.items():
        known[name] = evaluate(parse_expression(formula), known)
    value = {name: float(amount.value) for name, amount in known.items()}
    half, pitch, length = (np.array([value.get(f"{kind}_{axis}", 0.0) for axis in "xyz"]) for kind in ("half", "pitch", "length"))
    material = catalogue_entry(spec, "materials", spec.make.flexures)
    return Block(half, pitch, length, value["leaf_thickness"], value["seat"], value["wire"], material)


def _formulas(kind: str, rows: Sequence[int]) -> dict[str, str]:
    """Numbers that follow from others. Cells of the grid hold any element or strut, with gaps between: nothing can clash."""
    tall = {"pitch_z": "cell + gap_z", "half_z": "pitch_z + (cell + skin)/2"} if len(rows) > 1 else {"half_z": "(cell + skin)/2"}
    return {**(_STACK_NUMBERS if kind == "piezo" else {"cell": "seat"}), **_BLOCK_NUMBERS, **tall}


def _architecture(blank: Architecture, guide: Guide, rows: Sequence[int]) -> Architecture:
    """The architecture with the text of its design file, and ranges and limits of the numbers that it uses."""
    parts = sorted({(_part(each), "xyz"[each.place.face]) for each in guide.elements})
    used = {"seat", "skin", "gap_x", "gap_y", *(f"length_{axis}" for _, axis in parts)}
    used |= {"leaf_thickness" if part == "leaf" else "wire" for part, _ in parts}
    used |= ({"gap_z"} if len(rows) > 1 else set[str]()) | ({"neck"} if blank.kind == "piezo" else set[str]())
    ranges = {name: each for name, each in _RANGES.items() if name in used}
    slender = {f"{part}_slenderness_{axis}": f"length_{axis}/{_THIN[part]}" for part, axis in parts}
    numbers = {**{name: "1 mm" if "thinnest" in _RANGES[name][0] else "10 mm" for name in ranges}, **dict.fromkeys(_SET, "30 mm")}
    numbers |= {**_formulas(blank.kind, rows), **slender}
    numbers |= {"stack_length": "36 mm", "stack_diameter": "6 mm"} if blank.kind == "piezo" else {}
    numbers |= {"payload_mass": "0.1 kg", "payload_height": "5 mm"}
    text = "\n".join(_lines(blank, guide, numbers, parts))
    return replace(blank, drawing=text, ranges=ranges, limits={f"numbers.{name}": "10" for name in slender})


def _lines(blank: Architecture, guide: Guide, numbers: Mapping[str, str], parts: Sequence[tuple[str, str]]) -> Iterator[str]:
    """Lines of the design file."""
    stacks = blank.kind == "piezo"
    yield _HEADER.format(title=blank.name, name=json.dumps(blank.name)) + ('steel = { like = "AISI 420 hardened" }\n' if stacks else "")
    yield from ("[numbers]", *(f'{name} = "{text}"' for name, text in numbers.items()), "", "[parts]")
    for part, axis in parts:
        yield f'{part}_{axis} = {{ kind = "{_KINDS[part]}", material = "flexure", length = "length_{axis}", {_SECTIONS[part]} }}'
    yield from (_STACK_PARTS if stacks else _COIL, _BODY)
    if stacks:
        yield _STRUT
        for number, place in enumerate(guide.actuators, 1):
            pose = f'at = {_point(place)}, along = "{_inward(place)}", up = "{"xz"[place.face < 2]}"'
            yield f'B{number} = {{ unit = "strut", pose = {{ {pose} }} }}'
    yield "\n[links]"
    for number, element in enumerate(guide.elements, 1):
        part, axis = _part(element), "xyz"[element.place.face]
        bends = "" if element.width < 0 else f', bends = "{"xyz"[element.width]}"'
        yield _link(f"{part}_{number}", f"{part}_{axis}", element.place, f"length_{axis}/2", bends)
    for number, place in enumerate(() if stacks else guide.actuators, 1):
        yield _link(f"motor_{number}", blank.slot, place)
    yield _PAYLOAD


def _part(element: Element) -> str:
    return "wire" if element.width < 0 else "leaf"


def _link(name: str, part: str, place: Place, outside: str = "", more: str = "") -> str:
    at = _point(place, outside)
    return f'{name} = {{ joins = ["ground", "platform"], part = "{part}", at = {at}, along = "{_inward(place)}"{more} }}'


def _inward(place: Place) -> str:
    return f"{'-' if place.side > 0 else ''}{'xyz'[place.face]}"


def _point(place: Place, outside: str = "") -> str:
    """The formulas of a point on a face, or outside of it."""
    texts = ["0 mm" if not each else f"{'-' if each < 0 else ''}pitch_{axis}" for each, axis in zip(place.grid, "xyz", strict=True)]
    sign = "-" if place.side < 0 else ""
    texts[place.face] = f"{sign}half_{'xyz'[place.face]}" + (f" {sign or '+'} {outside}" if outside else "")
    return json.dumps(texts)


def symmetries(spec: Specification) -> tuple[Array, ...]:
    """Return the symmetries of a specification: both mirrors of its box, and a quarter turn about z if x and y are equal.

    >>> from flexstage.studies.synthesis.specification import example
    >>> len(symmetries(example()))
    3
    """
    moved, sizes = spec.displacements, (spec.box.size, spec.payload.size or (0.0, 0.0, 0.0))
    equal = all(moved.get(one) == moved.get(other) for one, other in (("x", "y"), ("rx", "ry")))
    return (*MIRRORS, QUARTER_TURN) if equal and all(each[0] == each[1] for each in sizes) else MIRRORS
