"""Calibrated parts: which a stage has, and the stage as it was drawn."""

from __future__ import annotations

from dataclasses import replace

from flexstage.base.finding import Finding, require
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.given import Given, Origin


def drawn(mechanism: Mechanism) -> Mechanism:
    """The stage with every given part that stands for a drawn one replaced by it.

    Raises `DesignError` where the part it stands for is not there.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> drawn(double_triangle()) == double_triangle()
    True
    """
    stand_ins = {name: part.stands_for for name, part in mechanism.parts.items() if isinstance(part, Given) and part.stands_for}
    require(
        Finding(f"parts.{name}.stands_for", f'there is no part "{kept}"', "Keep the drawn part that was calibrated in the file")
        for name, kept in stand_ins.items()
        if kept not in mechanism.parts
    )
    if not stand_ins:
        return mechanism
    return replace(mechanism, parts={**mechanism.parts, **{name: mechanism.parts[kept] for name, kept in stand_ins.items()}})


def calibrated(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of the parts whose 6x6 is of FEA origin: theory that uses them is not independent of FEA.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> calibrated(double_triangle())
    ()
    """
    return tuple(name for name, part in mechanism.parts.items() if isinstance(part, Given) and part.origin is Origin.FEA)
