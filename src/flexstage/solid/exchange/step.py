"""STEP files: a stage as one assembly of named solids, with materials, densities and colours (ISO 10303-21, AP214; lengths in mm).

The CAD kernel writes every solid by itself; here they become parts of one assembly, each a product with its address as name.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from netgen import occ

from flexstage.base.storage.store import temporary_folder
from flexstage.base.text import printable
from flexstage.mechanism.mechanism import Mechanism
from flexstage.solid.exchange.paint import Colour, palette
from flexstage.solid.fea.geometry.draw import draw_form, move_solid
from flexstage.solid.fea.geometry.piece import Piece
from flexstage.solid.fea.geometry.stage_pieces import Stage, require_shapes, stage_pieces

_ENTITY = re.compile(r"#(\d+)\s*=\s*(.*?);[ \t]*\r?\n", re.DOTALL)
_REFERENCE = re.compile(r"#(\d+)")


@dataclass(frozen=True, eq=False)
class Part:
    """A solid of the file [mm]: `name` is its address (`B1/front`, a body's name; `platform/steel` where a body has several materials)."""

    name: str
    shape: occ.TopoDS_Shape
    material: str
    density: float


def stage_parts(stage: Stage) -> tuple[Part, ...]:
    """The solids of a stage: one a link, one a body (and a material), the ground's outlines each by itself.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> [part.name for part in stage_parts(stage_pieces(parallelogram()))]
    ['platform', 'B/base', 'B/tip', 'left', 'right', 'B/back', 'B/pzt', 'B/front']
    """
    groups: dict[tuple[str, str], list[Piece]] = {}
    for piece in stage.pieces.values():
        owner = piece.name if piece.body is None or piece.name in stage.assembly.ground else piece.body
        groups.setdefault((owner, stage.materials[piece.name]), []).append(piece)
    owners = [owner for owner, _ in groups]
    return tuple(
        Part(owner if owners.count(owner) == 1 else f"{owner}/{material}", _fuse(pieces), material, pieces[0].medium.density)
        for (owner, material), pieces in groups.items()
    )


def step(mechanism: Mechanism) -> bytes:
    """The STEP file of a stage as it is described.

    Raises `DesignError` naming every link that has no shape, and where nothing at all has one.

    >>> step(Mechanism("nothing"))
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: nothing: no body has outlines and no link a shape. ...
    """
    stage = stage_pieces(mechanism)
    require_shapes(mechanism, stage)
    return step_text(mechanism.name or "stage", stage_parts(stage)).encode("ascii")


def _fuse(pieces: Sequence[Piece]) -> occ.TopoDS_Shape:
    shapes = [move_solid(draw_form(piece.form), piece.frame) for piece in pieces]
    return shapes[0] if len(shapes) == 1 else occ.Fuse(shapes)


def step_text(name: str, parts: Sequence[Part]) -> str:
    """Parts as the text of a STEP file: one product each, all placed in an assembly of the given name.

    >>> step_text("nothing", ()).splitlines()[0]
    'ISO-10303-21;'
    """
    colours = palette(part.material for part in parts)
    lines = _Lines()
    root = _root(lines, name)
    with temporary_folder() as folder:
        for part in parts:
            _append(lines, root, part, _write_entities(part, colours[part.material], folder / "part.step"))
    placed = ",".join(f"#{number}" for number in root.axes)
    lines.put(f"SHAPE_REPRESENTATION('',({placed}),#{root.context})", root.shape)
    heading = (
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('stage as drawn by flexstage, mm'),'2;1');\n"
        f"FILE_NAME({quote(name)},'',(''),(''),'flexstage','flexstage','');\n"
        "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
    )
    return heading + lines.text() + "ENDSEC;\nEND-ISO-10303-21;\n"


def quote(text: str) -> str:
    r"""A string of a STEP file: quotes doubled, other than ASCII by code.

    >>> print(quote("d'Arc"), quote("Träger"))
    'd''Arc' 'Tr\X2\00E4\X0\ger'
    """
    return f"'{''.join(_letter(letter) for letter in printable(text))}'"


def _letter(letter: str) -> str:
    if " " <= letter <= "~":
        return letter * 2 if letter in "'\\" else letter
    code = ord(letter)
    return f"\\X4\\{code:08X}\\X0\\" if code > 0xFFFF else f"\\X2\\{code:04X}\\X0\\"


class _Lines:
    """Entities of the file, numbered as they come."""

    def __init__(self) -> None:
        self._entities: dict[int, str] = {}
        self._next = 1

    def reserve(self, count: int = 1) -> int:
        first = self._next
        self._next += count
        return first

    def put(self, entity: str, number: int | None = None) -> int:
        number = self.reserve() if number is None else number
        self._entities[number] = entity
        return number

    def text(self) -> str:
        return "".join(f"#{number}={entity};\n" for number, entity in sorted(self._entities.items()))


@dataclass(frozen=True)
class _Root:
    """Numbers of the assembly's entities; `axes` are the places of its parts."""

    definition: int
    shape: int
    context: int
    axes: list[int]


def _root(lines: _Lines, name: str) -> _Root:
    application = lines.put("APPLICATION_CONTEXT('core data for automotive mechanical design processes')")
    lines.put(f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})")
    mechanical = lines.put(f"PRODUCT_CONTEXT('',#{application},'mechanical')")
    product = lines.put(f"PRODUCT({quote(name)},{quote(name)},'',(#{mechanical}))")
    lines.put(f"PRODUCT_RELATED_PRODUCT_CATEGORY('assembly',$,(#{product}))")
    formation = lines.put(f"PRODUCT_DEFINITION_FORMATION('','',#{product})")
    design = lines.put(f"PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')")
    definition = lines.put(f"PRODUCT_DEFINITION('design','',#{formation},#{design})")
    shape = lines.reserve()
    whole = lines.put(f"PRODUCT_DEFINITION_SHAPE('','',#{definition})")
    lines.put(f"SHAPE_DEFINITION_REPRESENTATION(#{whole},#{shape})")
    return _Root(definition, shape, _context(lines), [_axes(lines)])


def _context(lines: _Lines) -> int:
    length = lines.put("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
    angle = lines.put("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
    solid = lines.put("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
    accuracy = lines.put(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#{length},'distance_accuracy_value','confusion accuracy')")
    return lines.put(
        f"(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{accuracy}))"
        f"GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))REPRESENTATION_CONTEXT('','3D'))"
    )


def _axes(lines: _Lines) -> int:
    origin = lines.put("CARTESIAN_POINT('',(0.,0.,0.))")
    up, along = lines.put("DIRECTION('',(0.,0.,1.))"), lines.put("DIRECTION('',(1.,0.,0.))")
    return lines.put(f"AXIS2_PLACEMENT_3D('',#{origin},#{up},#{along})")


def _write_entities(part: Part, colour: Colour, path: Path) -> dict[int, str]:
    """The entities that the CAD kernel writes for one solid."""
    solids = list(part.shape.solids)
    for solid in solids:
        solid.col = colour
    shape = solids[0] if len(solids) == 1 else occ.Compound(solids)
    shape.WriteStep(str(path))
    data = path.read_text(encoding="ascii", errors="replace").partition("DATA;")[2].rpartition("ENDSEC;")[0]
    return {int(number): entity for number, entity in _ENTITY.findall(data + "\n")}


def _append(lines: _Lines, root: _Root, part: Part, entities: Mapping[int, str]) -> None:
    """Take a solid's entities over, renumbered and renamed, and place it in the assembly."""
    offset = lines.reserve(max(entities) + 1)
    for number, entity in entities.items():
        lines.put(_name_entity(_REFERENCE.sub(lambda match: f"#{int(match[1]) + offset}", entity), part.name), number + offset)
    definition = offset + _only(entities, "PRODUCT_DEFINITION(")
    shape = offset + _representation(entities)
    use = lines.put(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{len(root.axes)}',{quote(part.name)},'',#{root.definition},#{definition},$)")
    place, origin = _axes(lines), root.axes[0]
    root.axes.append(place)
    turn = lines.put(f"ITEM_DEFINED_TRANSFORMATION('','',#{origin},#{place})")
    relation = lines.put(
        f"(REPRESENTATION_RELATIONSHIP('','',#{shape},#{root.shape})"
        f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{turn})SHAPE_REPRESENTATION_RELATIONSHIP())"
    )
    used = lines.put(f"PRODUCT_DEFINITION_SHAPE('Placement','Placement of an item',#{use})")
    lines.put(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{used})")
    _append_material(lines, part, definition, root.context)


def _name_entity(entity: str, name: str) -> str:
    """Products and solids bear the part's name; written here, for the kernel's writer knows only some letters."""
    if entity.startswith("PRODUCT("):
        context = entity[entity.rindex(",") :]
        return f"PRODUCT({quote(name)},{quote(name)},''{context}"
    if entity.startswith("MANIFOLD_SOLID_BREP("):
        return f"MANIFOLD_SOLID_BREP({quote(name)}{entity[entity.rindex(',') :]}"
    return entity


def _only(entities: Mapping[int, str], start: str) -> int:
    (number,) = (number for number, entity in entities.items() if entity.startswith(start))
    return number


def _representation(entities: Mapping[int, str]) -> int:
    """The shape representation that the product's definition points to."""
    return int(_REFERENCE.findall(entities[_only(entities, "SHAPE_DEFINITION_REPRESENTATION(")])[1])


def _append_material(lines: _Lines, part: Part, definition: int, context: int) -> None:
    """Name and density of the material, as CAD systems exchange them."""
    for name, item in _material_items(lines, part):
        property_ = lines.put(f"PROPERTY_DEFINITION('material property','{name}',#{definition})")
        value = lines.put(f"REPRESENTATION('{name}',(#{item}),#{context})")
        lines.put(f"PROPERTY_DEFINITION_REPRESENTATION(#{property_},#{value})")


def _material_items(lines: _Lines, part: Part) -> Iterator[tuple[str, int]]:
    yield "material name", lines.put(f"DESCRIPTIVE_REPRESENTATION_ITEM({quote(part.material)},'')")
    mass = lines.put("(MASS_UNIT()NAMED_UNIT(*)SI_UNIT(.KILO.,.GRAM.))")
    length = lines.put("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.))")
    elements = (lines.put(f"DERIVED_UNIT_ELEMENT(#{mass},1.)"), lines.put(f"DERIVED_UNIT_ELEMENT(#{length},-3.)"))
    unit = lines.put(f"DERIVED_UNIT((#{elements[0]},#{elements[1]}))")
    value = f"POSITIVE_RATIO_MEASURE({part.density:.10E})"
    yield "density", lines.put(f"MEASURE_REPRESENTATION_ITEM('density measure',{value},#{unit})")
