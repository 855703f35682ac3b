"""Parameters of a case: the numbers and choices of its dataclass, by name, and a copy of it in which some are others.

A name is the way to a field, as addresses are: `long_arm`, `plate.side`, `neck.profile.length`; levels may be skipped where that is unique
(`neck.length`). What a field is, its quantity and its bound, the annotations of the dataclass say.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array, freeze
from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.path import complete, replace_member
from flexstage.mechanism.checks.value import number_findings
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import ChoiceNode, NumberNode

Stated: TypeAlias = str | float | Array
"""A parameter as a user gives it: a text with its unit, or a number or an array of numbers in SI."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a case: its full name, what it may be, and its `value` unless another is stated [SI]."""

    name: str
    node: NumberNode | ChoiceNode
    value: Any

    @property
    def quantity(self) -> Quantity | None:
        """The quantity of a number; `None` for a choice, which cannot vary."""
        return self.node.quantity if isinstance(self.node, NumberNode) else None

    @property
    def kind(self) -> str:
        """What it is, in words.

        >>> from flexstage.cases.double_triangle import SM_REF_B
        >>> found = parameters(SM_REF_B)
        >>> found["long_arm"].kind, found["bodies"].kind
        ('length', 'solid or massless')
        """
        if isinstance(self.node, ChoiceNode):
            return " or ".join(str(each.value) for each in self.node.choices)
        return self.node.quantity.name

    @property
    def text(self) -> str:
        """Its value as a person writes it."""
        return str(self.value.value) if isinstance(self.node, ChoiceNode) else show(self.value, self.node.quantity, digits=12)


def parameters(of: Any) -> dict[str, Parameter]:
    """The parameters in a case's dataclass by full name: its numbers, also those of its parts, and its choices.

    >>> from flexstage.cases.double_triangle import SM_REF_B
    >>> [*parameters(SM_REF_B)][-5:]
    ['plate.side', 'plate.thickness', 'plate.height', 'plate.corner', 'bodies']
    """
    found = {name: Parameter(name, node, value) for name, value, node in node_of(type(of)).numbers(of)}
    for name, slot in node_of(type(of)).fields.items():
        if isinstance(slot.node, ChoiceNode):
            found[name] = Parameter(name, slot.node, getattr(of, name))
    return found


def parameter(of: Any, name: str, where: str = "") -> Parameter:
    """The parameter of that name, levels skipped where that is unique. Raises `DesignError` at `where` with the nearest names.

    >>> from flexstage.cases.double_triangle import SM_REF_B
    >>> parameter(SM_REF_B, "pole_neck.radius").name
    'pole_neck.profile.radius'
    """
    known = parameters(of)
    try:
        full = ".".join(complete(of, tuple(name.split("."))))
    except (KeyError, ValueError):
        full = name
    if full not in known:
        inside = [each for each in known if each.startswith(f"{full}.")]
        if inside:
            raise refuse(where or name, f'"{name}" is no single parameter but holds several', f"Name one: {', '.join(inside)}")
        raise refuse(where or name, f'there is no parameter "{name}"', suggest_nearest(name, known))
    return known[full]


def with_parameters(of: Any, stated: Mapping[str, Stated], where: str = "parameters") -> Any:
    """A copy of a case's dataclass in which the parameters named are `stated`: texts with units, numbers or arrays in SI.

    Raises `DesignError` with all findings: unknown names, wrong units, values out of bounds.

    >>> from flexstage.cases.double_triangle import SM_REF_B
    >>> with_parameters(SM_REF_B, {"long_arm": "80 mm", "pole_neck.radius": 0.005}).long_arm
    0.08
    """
    findings: list[Finding] = []
    given: dict[str, str] = {}
    result = of
    for name, value in stated.items():
        try:
            found = parameter(of, name, f"{where}.{name}")
            if found.name in given:
                raise refuse(f"{where}.{name}", f'"{given[found.name]}" is the same parameter', "State it once")
            given[found.name] = name
            wanted = _value(found.node, value, f"{where}.{name}")
            if isinstance(found.node, NumberNode):
                require(number_findings(f"{where}.{name}", wanted, found.node))
            result = replace_member(result, tuple(found.name.split(".")), wanted)
        except DesignError as error:
            findings += error.findings
    require(findings)
    return result


def _value(node: NumberNode | ChoiceNode, stated: Any, where: str) -> Any:
    """What is stated of a parameter, as its field keeps it."""
    value = node.parse(stated, where) if isinstance(stated, str) else node.fit(freeze(stated), where)
    require(node.check(value, where))
    return value
