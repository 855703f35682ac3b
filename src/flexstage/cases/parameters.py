"""Parameters of a case: the numbers and choices of its dataclass, by name, and a copy of it in which some are others.

A name is the way to a field, as addresses are: `long_arm`, `plate.side`, `neck.profile.length`; levels may be skipped where that is unique
(`neck.length`). What a field is, its quantity and its bound, the annotations of the dataclass say.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from flexstage.base.finding import DesignError, Finding, refuse, require, suggest_nearest
from flexstage.base.number import Array, freeze
from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import parse, show
from flexstage.mechanism.addresses.path import complete, replace_member
from flexstage.mechanism.checks.value import number_findings
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import ChoiceNode, NumberNode, WholeNode

Stated: TypeAlias = str | float | Array
"""A parameter as a user gives it: a text with its unit, or a number or an array of numbers in SI."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of a case: its full name, what it may be, and its `value` unless another is stated [SI]."""

    name: str
    node: NumberNode | WholeNode | ChoiceNode
    value: Any

    @property
    def quantity(self) -> Quantity | None:
        """The quantity of a number; `None` for a whole number and for a choice, which cannot vary."""
        return self.node.quantity if isinstance(self.node, NumberNode) else None

    @property
    def kind(self) -> str:
        """What it is, in words.

        >>> from flexstage.cases.tip_tilt import TipTilt
        >>> found = parameters(TipTilt())
        >>> found["holder"].kind, found["posts"].kind
        ('length', 'whole number')
        """
        if isinstance(self.node, ChoiceNode):
            return " or ".join(str(each.value) for each in self.node.choices)
        return "whole number" if isinstance(self.node, WholeNode) else self.node.quantity.name

    @property
    def text(self) -> str:
        """Its value as a person writes it."""
        if isinstance(self.node, NumberNode):
            return show(self.value, self.node.quantity, digits=12)
        return str(self.value.value if isinstance(self.node, ChoiceNode) else self.value)


def parameters(of: Any) -> dict[str, Parameter]:
    """The parameters in a case's dataclass by full name: its numbers, also those of its parts, its whole numbers and its choices.

    >>> from flexstage.cases.parallelogram import Parallelogram
    >>> [*parameters(Parallelogram())][-5:]
    ['size.x', 'size.y', 'size.z', 'spacing', 'push_offset']
    """
    found = {name: Parameter(name, node, value) for name, value, node in node_of(type(of)).numbers(of)}
    for name, slot in node_of(type(of)).fields.items():
        if isinstance(slot.node, (WholeNode, ChoiceNode)):
            found[name] = Parameter(name, slot.node, getattr(of, name))
    return found


def parameter(of: Any, name: str, where: str = "") -> Parameter:
    """The parameter of that name, levels skipped where that is unique. Raises `DesignError` at `where` with the nearest names.

    >>> from flexstage.cases.parallelogram import Parallelogram
    >>> parameter(Parallelogram(), "neck.radius").name
    'neck.profile.radius'
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

    >>> from flexstage.cases.parallelogram import Parallelogram
    >>> with_parameters(Parallelogram(), {"spacing": "52 mm", "neck.radius": 0.005}).spacing
    0.052
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
            wanted = _value(found, value, f"{where}.{name}")
            if isinstance(found.node, NumberNode):
                require(number_findings(f"{where}.{name}", wanted, found.node))
            result = replace_member(result, tuple(found.name.split(".")), wanted)
        except DesignError as error:
            findings += error.findings
    require(findings)
    return result


def _value(found: Parameter, stated: Any, where: str) -> Any:
    """What is stated of a parameter, as its field keeps it."""
    node = found.node
    if isinstance(node, ChoiceNode):
        for each in node.choices:
            if stated in (each, each.value):
                return each
        raise refuse(where, f'found "{stated}"', f"It is one of {', '.join(str(each.value) for each in node.choices)}")
    if isinstance(node, WholeNode):
        try:
            return int(stated) if isinstance(stated, str) else _whole(stated)
        except (TypeError, ValueError):
            raise refuse(where, f"found {stated!r}", "Give a whole number") from None
    if isinstance(stated, str):
        return parse(stated, node.quantity, where=where)
    value = freeze(stated)
    if isinstance(value, bool) or not isinstance(value, (int, float, complex, np.ndarray)):
        raise refuse(where, f"found {stated!r}", f'Give a number in SI, or a text such as "{node.quantity.example}"')
    return float(value) if isinstance(value, int) else value


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError
    return value
