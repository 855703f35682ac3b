"""Parameters of a case (the named numbers without formulas in its file), and the stage with changed parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array, Number
from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import quantity_of_unit, show
from flexstage.mechanism.addresses.address import set_value
from flexstage.mechanism.grammar.formulas import PREFIX
from flexstage.mechanism.grammar.node import NumberNode, number_findings
from flexstage.mechanism.mechanism import Mechanism

Stated: TypeAlias = str | float | Array
"""Parameter value of a user: a string with its unit, or a number or an array of numbers in SI."""


@dataclass(frozen=True)
class Parameter:
    """Parameter of a case: name, quantity, and default `value` [SI]."""

    name: str
    quantity: Quantity
    value: Number

    @property
    def text(self) -> str:
        """Value of the parameter as in a design file."""
        return show(self.value, self.quantity, digits=12)


def parameters(stage: Mechanism) -> dict[str, Parameter]:
    """Return the parameters of a case by name.

    >>> from flexstage.cases.registry import case
    >>> [*parameters(case("double-triangle"))][-3:]
    ['plate_thickness', 'plate_height', 'plate_corner']
    """
    own = {name: number for name, number in stage.numbers.items() if PREFIX + name not in stage.formulas}
    return {name: Parameter(name, quantity_of_unit(number.unit), number.value) for name, number in own.items()}


def parameter(stage: Mechanism, name: str, where: str = "") -> Parameter:
    """Return the parameter with this name. Raises `DesignError` with the address `where` and the nearest names.

    >>> from flexstage.cases.registry import case
    >>> parameter(case("double-triangle"), "long_arm").text
    '78 mm'
    """
    known = parameters(stage)
    if name not in known:
        raise refuse(where or name, f'unknown parameter "{name}"', suggest_nearest(name, known))
    return known[name]


def with_parameters(stage: Mechanism, stated: Mapping[str, Stated]) -> Mechanism:
    """Return the case with the parameter values `stated`: strings with units, or numbers or arrays in SI. Formulas are re-evaluated.

    Raises `DesignError` with all errors: unknown names, wrong units, values out of bounds.

    >>> from flexstage.cases.registry import case
    >>> with_parameters(case("double-triangle"), {"long_arm": "80 mm"}).units["vertical"].links["front"].at[0]
    0.08
    """
    findings: list[Finding] = []
    for name, value in stated.items():
        here = f"parameters.{name}"
        try:
            node = NumberNode(parameter(stage, name, here).quantity)
            stage = set_value(stage, PREFIX + name, node.parse(value, here) if isinstance(value, str) else value)
            require(number_findings(here, stage.numbers[name].value, node))
        except DesignError as error:
            findings += error.findings
    require(findings)
    return stage
