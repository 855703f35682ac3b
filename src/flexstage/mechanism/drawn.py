"""Calibrated parts: which a stage has, and the stage as it was drawn."""

from __future__ import annotations

from dataclasses import replace

from flexstage.base.finding import Finding, require
from flexstage.mechanism.assembly.expand import PlacedLink
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.compliance_matrix import ComplianceMatrix, Origin
from flexstage.parts.part import Restricted, material_of


def with_drawn_parts(mechanism: Mechanism) -> Mechanism:
    """The stage with every compliance matrix that replaces a drawn part replaced by it.

    Raises `DesignError` where the part it stands for is not there.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> with_drawn_parts(double_triangle()) == double_triangle()
    True
    """
    stand_ins = {name: part.replaces for name, part in mechanism.parts.items() if isinstance(part, ComplianceMatrix) and part.replaces}
    require(
        Finding(f"parts.{name}.replaces", f'unknown part "{kept}"', "Keep the drawn part that was calibrated in the file")
        for name, kept in stand_ins.items()
        if kept not in mechanism.parts
    )
    if not stand_ins:
        return mechanism
    return replace(mechanism, parts={**mechanism.parts, **{name: mechanism.parts[kept] for name, kept in stand_ins.items()}})


def as_drawn(mechanism: Mechanism, link: PlacedLink) -> PlacedLink:
    """The link with the drawn part that its given one stands for, and that part's material: how long it is, how it grows and loses energy.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> link = expand(double_triangle()).links["B1/front"]
    >>> as_drawn(double_triangle(), link) is link
    True
    """
    inner = link.part.part if isinstance(link.part, Restricted) else link.part
    kept = mechanism.parts.get(inner.replaces) if isinstance(inner, ComplianceMatrix) else None
    if kept is None:
        return link
    material = material_of(kept)
    return replace(link, part=kept, material=mechanism.materials[material] if material else None)


def calibrated_parts(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of the parts whose 6x6 is of FEA origin: theory that uses them is not independent of FEA.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> calibrated_parts(double_triangle())
    ()
    """
    return tuple(name for name, part in mechanism.parts.items() if isinstance(part, ComplianceMatrix) and part.origin is Origin.FEA)
