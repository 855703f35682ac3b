"""Calibrated parts of a stage, and the nominal stage with the drawn parts that they replace."""

from __future__ import annotations

from dataclasses import replace

from flexstage.base.finding import Finding, require
from flexstage.mechanism.assembly.expand import PlacedLink
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.compliance_matrix import ComplianceMatrix, Origin
from flexstage.parts.part import inner, material_of


def with_drawn_parts(mechanism: Mechanism) -> Mechanism:
    """Return the stage with the drawn parts instead of the compliance matrices that replace them.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> with_drawn_parts(double_triangle()) == double_triangle()
    True
    """
    stand_ins = {name: part.replaces for name, part in mechanism.parts.items() if isinstance(part, ComplianceMatrix) and part.replaces}
    require(
        Finding(f"parts.{name}.replaces", f'unknown part "{kept}"', "Restore the drawn part that this compliance matrix replaces")
        for name, kept in stand_ins.items()
        if kept not in mechanism.parts
    )
    if not stand_ins:
        return mechanism
    return replace(mechanism, parts={**mechanism.parts, **{name: mechanism.parts[kept] for name, kept in stand_ins.items()}})


def as_drawn(mechanism: Mechanism, link: PlacedLink) -> PlacedLink:
    """Return the link with the drawn part instead of the compliance matrix that replaces it.

    The link then has the length, expansion and damping of the drawn part.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> link = expand(double_triangle()).links["B1/front"]
    >>> as_drawn(double_triangle(), link) is link
    True
    """
    own = inner(link.part)
    kept = mechanism.parts.get(own.replaces) if isinstance(own, ComplianceMatrix) else None
    if kept is None:
        return link
    material = material_of(kept)
    return replace(link, part=kept, material=mechanism.materials[material] if material else None)


def calibrated_parts(mechanism: Mechanism) -> tuple[str, ...]:
    """Return the names of parts with a 6x6 compliance from FEA. A theory that uses these parts is not independent of FEA.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> calibrated_parts(double_triangle())
    ()
    """
    return tuple(name for name, part in mechanism.parts.items() if isinstance(part, ComplianceMatrix) and part.origin is Origin.FEA)
