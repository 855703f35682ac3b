"""Validity of beam theory for a part, and for every part of a stage."""

from __future__ import annotations

from collections.abc import Mapping
from typing import overload

from flexstage.base.arguments import check_arguments
from flexstage.base.number import Table
from flexstage.beams import validity as beams
from flexstage.beams.validity import Validity
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.material import Material
from flexstage.parts.part import Part, material_of


@overload
def validity(part: Part, where: str = "part", material: Material | None = None) -> Validity: ...
@overload
def validity(part: Mechanism, where: str = "part", material: Material | None = None) -> Mapping[str, Validity]: ...


@check_arguments
def validity(part: Part | Mechanism, where: str = "part", material: Material | None = None) -> Validity | Mapping[str, Validity]:
    """Assess the range of validity and expected error of beam theory, for a part or all parts of a stage.

    If `part` is a single part, the result is its validity (see `beams.validity`). Messages then use the name `where` for the part, and
    Poisson's ratio is that of `material` (default: 0.3). If `part` is a stage, the result contains the validity of each part under the
    address `parts.NAME`. If a link overrides numbers of its part, the result contains the overridden part under the name of the link.
    Messages then use these names, and a specified `material` replaces the material of every part.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> result = validity(parallelogram())
    >>> list(result), round(float(result["parts.leaf"].errors["x"]), 3)
    (['parts.leaf', 'parts.neck', 'parts.stack'], 0.034)
    """
    if not isinstance(part, Mechanism):
        return beams.validity(part, where, material)
    used = dict[str, Part]()
    for link in expand(part).links.values():
        departs = link.described.part != part.parts[link.link.part]
        used.setdefault(link.name if departs else f"parts.{link.link.part}", link.part)
    return Table({name: beams.validity(each, name, material or part.materials.get(material_of(each) or "")) for name, each in used.items()})
