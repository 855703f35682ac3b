"""STEP files: a stage as one assembly of named solids, with materials, densities and colours (ISO 10303-21, AP214; lengths in mm).

The CAD kernel writes every solid separately. This module combines the solids as parts of one assembly; the name of each part is its
address in the design.
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
from flexstage.solid.fea.geometry.draw import unite
from flexstage.solid.fea.geometry.piece import Piece
from flexstage.solid.fea.geometry.stage_pieces import Stage, require_shapes, stage_pieces

_ENTITY = re.compile(r"#(\d+)\s*=\s*(.*?);[ \t]*\r?\n", re.DOTALL)
_REFERENCE = re.compile(r"#(\d+)")

_HEADING = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('stage as drawn by flexstage, mm'),'2;1');
FILE_NAME({name},'',(''),(''),'flexstage','flexstage','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
"""
_ASSEMBLY = """#1=APPLICATION_CONTEXT('core data for automotive mechanical design processes');
#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);
#3=PRODUCT_CONTEXT('',#1,'mechanical');
#4=PRODUCT({name},{name},'',(#3));
#5=PRODUCT_RELATED_PRODUCT_CATEGORY('assembly',$,(#4));
#6=PRODUCT_DEFINITION_FORMATION('','',#4);
#7=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#8=PRODUCT_DEFINITION('design','',#6,#7);
#9=SHAPE_REPRESENTATION('',({places}),#16);
#10=PRODUCT_DEFINITION_SHAPE('','',#8);
#11=SHAPE_DEFINITION_REPRESENTATION(#10,#9);
#12=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#13=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#14=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#15=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#12,'distance_accuracy_value','confusion accuracy');
#16=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#15))GLOBAL_UNIT_ASSIGNED_CONTEXT((#12,#13,#14))\
REPRESENTATION_CONTEXT('','3D'));
#17=CARTESIAN_POINT('',(0.,0.,0.));
#18=DIRECTION('',(0.,0.,1.));
#19=DIRECTION('',(1.,0.,0.));
#20=AXIS2_PLACEMENT_3D('',#17,#18,#19);
"""
"""The assembly and the context of its shapes, with placeholders for the parts."""
_USE = """#1=NEXT_ASSEMBLY_USAGE_OCCURRENCE('{count}',{name},'',{root},{definition},$);
#2=CARTESIAN_POINT('',(0.,0.,0.));
#3=DIRECTION('',(0.,0.,1.));
#4=DIRECTION('',(1.,0.,0.));
#5=AXIS2_PLACEMENT_3D('',#2,#3,#4);
#6=ITEM_DEFINED_TRANSFORMATION('','',{origin},#5);
#7=(REPRESENTATION_RELATIONSHIP('','',{shape},{whole})REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#6)SHAPE_REPRESENTATION_RELATIONSHIP());
#8=PRODUCT_DEFINITION_SHAPE('Placement','Placement of an item',#1);
#9=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#7,#8);
#10=DESCRIPTIVE_REPRESENTATION_ITEM({material},'');
#11=PROPERTY_DEFINITION('material property','material name',{definition});
#12=REPRESENTATION('material name',(#10),{context});
#13=PROPERTY_DEFINITION_REPRESENTATION(#11,#12);
#14=(MASS_UNIT()NAMED_UNIT(*)SI_UNIT(.KILO.,.GRAM.));
#15=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));
#16=DERIVED_UNIT_ELEMENT(#14,1.);
#17=DERIVED_UNIT_ELEMENT(#15,-3.);
#18=DERIVED_UNIT((#16,#17));
#19=MEASURE_REPRESENTATION_ITEM('density measure',POSITIVE_RATIO_MEASURE({density:.10E}),#18);
#20=PROPERTY_DEFINITION('material property','density',{definition});
#21=REPRESENTATION('density',(#19),{context});
#22=PROPERTY_DEFINITION_REPRESENTATION(#20,#21);
"""
"""A part in the assembly, with name and density of its material as CAD systems exchange them."""
_ROOT, _WHOLE, _CONTEXT, _ORIGIN = "#8", "#9", "#16", "#20"
"""Definition, shape, context and axes of the assembly."""
_PLACE = 5
"""The axes of a part in the assembly."""


@dataclass(frozen=True, eq=False)
class Part:
    """A solid of the STEP file, in mm; `name` is the address of a link (`B1/front`) or body, with the material if the body has several."""

    name: str
    shape: occ.TopoDS_Shape
    material: str
    density: float


def stage_parts(stage: Stage) -> tuple[Part, ...]:
    """Return the solids of a stage: one for each link, one for each material of each body, and one for each outline of the ground.

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
        Part(owner if owners.count(owner) == 1 else f"{owner}/{material}", unite(pieces), material, pieces[0].medium.density)
        for (owner, material), pieces in groups.items()
    )


def step(mechanism: Mechanism) -> bytes:
    """Return the content of the STEP file of a stage in its undeformed configuration.

    Raises `DesignError` with the names of links without a shape or a specified stiffness, and for a stage without any shape.

    >>> step(Mechanism("nothing"))
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: nothing: no body has outlines, and no link has a shape. ...
    """
    stage = stage_pieces(mechanism)
    require_shapes(mechanism, stage)
    return step_text(mechanism.name or "stage", stage_parts(stage)).encode("ascii")


def step_text(name: str, parts: Sequence[Part]) -> str:
    """Return the content of a STEP file: one product for each part, all placed in an assembly of this name.

    >>> step_text("nothing", ()).splitlines()[0]
    'ISO-10303-21;'
    """
    colours = palette(part.material for part in parts)
    used, places, entities = 20, [_ORIGIN], list[str]()
    with temporary_folder() as folder:
        for part in parts:
            own = _write_entities(part, colours[part.material], folder / "part.step")
            offset, used = used + 1, used + 1 + max(own)
            entities += (_name_entity(entity, part.name) for entity in _renumbered(own, offset))
            entities += _use(part, len(places), own, offset, used)
            places.append(f"#{used + _PLACE}")
            used += _USE.count("\n")
    return "".join(
        [
            _HEADING.format(name=quote(name)),
            _ASSEMBLY.format(name=quote(name), places=",".join(places)),
            *(f"{entity};\n" for entity in entities),
            "ENDSEC;\nEND-ISO-10303-21;\n",
        ]
    )


def _use(part: Part, count: int, own: Mapping[int, str], offset: int, used: int) -> Iterator[str]:
    """The entities that place a part in the assembly."""
    values = {"root": _ROOT, "whole": _WHOLE, "context": _CONTEXT, "origin": _ORIGIN, "count": count, "density": part.density}
    values |= {"name": quote(part.name), "material": quote(part.material), "definition": f"#{offset + _only(own, 'PRODUCT_DEFINITION(')}"}
    shape = _REFERENCE.findall(own[_only(own, "SHAPE_DEFINITION_REPRESENTATION(")])[1]
    for entity in _renumbered({int(number): text for number, text in _ENTITY.findall(_USE)}, used):
        yield entity.format(shape=f"#{offset + int(shape)}", **values)


def _renumbered(entities: Mapping[int, str], offset: int) -> Iterator[str]:
    """Entities renumbered by an offset."""
    for number, entity in entities.items():
        yield _REFERENCE.sub(lambda match: f"#{int(match[1]) + offset}", f"#{number}={entity}")


def quote(text: str) -> str:
    r"""Quote a string for a STEP file: quotes are doubled, non-ASCII characters are written as hexadecimal codes.

    >>> print(quote("d'Arc"), quote("Träger"))
    'd''Arc' 'Tr\X2\00E4\X0\ger'
    """
    return f"'{''.join(_letter(letter) for letter in printable(text))}'"


def _letter(letter: str) -> str:
    if " " <= letter <= "~":
        return letter * 2 if letter in "'\\" else letter
    code = ord(letter)
    return f"\\X4\\{code:08X}\\X0\\" if code > 0xFFFF else f"\\X2\\{code:04X}\\X0\\"


def _write_entities(part: Part, colour: Colour, path: Path) -> dict[int, str]:
    """The entities that the CAD kernel writes for one solid."""
    solids = list(part.shape.solids)
    for solid in solids:
        solid.col = colour
    shape = solids[0] if len(solids) == 1 else occ.Compound(solids)
    shape.WriteStep(str(path))
    data = path.read_text(encoding="ascii", errors="replace").partition("DATA;")[2].rpartition("ENDSEC;")[0]
    return {int(number): entity for number, entity in _ENTITY.findall(data + "\n")}


def _name_entity(entity: str, name: str) -> str:
    """Give products and solids the part's name; the kernel's writer does not support all letters."""
    kind, last = entity.partition("(")[0], entity[entity.rfind(",") :]
    if kind.endswith("=PRODUCT"):
        return f"{kind}({quote(name)},{quote(name)},''{last}"
    return f"{kind}({quote(name)}{last}" if kind.endswith("=MANIFOLD_SOLID_BREP") else entity


def _only(entities: Mapping[int, str], start: str) -> int:
    (number,) = (number for number, entity in entities.items() if entity.startswith(start))
    return number
