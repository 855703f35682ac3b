"""Random descriptions grown from the grammar itself, so that no field is forgotten, and a small stage as text."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.base.number import Table
from flexstage.base.units.unit import quantity_of_unit, show
from flexstage.mechanism.addresses.address import addresses, quantity_of, set_text
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.grammar.formulas import spelling_findings
from flexstage.mechanism.grammar.grammar import RESERVED, ListNode, RecordNode, TableNode, UnionNode
from flexstage.mechanism.grammar.node import (
    ChoiceNode,
    DirectionNode,
    FlagNode,
    NamedNode,
    Node,
    NumberNode,
    TextNode,
    VectorNode,
    WholeNode,
)
from flexstage.mechanism.mechanism import GaugeSum, Link, Mechanism, NamedNumber, Placement, Unit

TEXT = """# A stage of one wire.
format = "flexstage 1"   # always
name = "wire"

[sources]
paper = "a paper"

[materials.steel]
like = "SUS420"          # from the catalogue

[parts.wire]
kind = "rod"
material = "steel"
length = "30 mm"         # as drawn
diameter = "1 mm"
tags = { length = "stated paper 2", diameter = "stated paper 3" }

[bodies.platform]
mass = "1 kg"

[units.leg.links]
front = { joins = ["ground", "platform"], part = "wire", at = ["1 mm", "0 mm", "0 mm"], along = "z" }  # upright

[placements]
L1-L3 = { unit = "leg", polar = { radius = "50 mm", first = "0 deg", facing = "tangent" } }
"""
"""A small stage as a person writes it; it passes the checks."""

FINITE = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False),
    st.floats(min_value=-10.0, max_value=10.0).map(lambda value: round(value, 4)),
    st.sampled_from([0.0, -0.0, 1e-3, 1.54e-3, 0.1, 200e9]),
)
NAMES = st.from_regex(r"[A-Za-z_äΔ][A-Za-z0-9_\-äΔ]{0,8}", fullmatch=True).filter(
    lambda name: name not in RESERVED and not re.search(r"\d-", name)
)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
NUMBER_NAMES = st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,8}", fullmatch=True).filter(lambda name: not [*spelling_findings(name)])
DIRECTIONS = st.one_of(st.sampled_from([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (-0.0, 0.0, 1.0)]), st.tuples(FINITE, FINITE, FINITE))


def values(node: Node) -> st.SearchStrategy[Any]:
    """Any value of a node."""
    if isinstance(node, (NumberNode, NamedNode)):
        return (
            FINITE
            if isinstance(node, NumberNode)
            else st.builds(NamedNumber, FINITE, st.sampled_from(["mm", "deg", "%", "1", "m^2", "N/um"]))
        )
    if isinstance(node, VectorNode):
        return st.tuples(*(values(item) for item in node.items))
    if isinstance(node, DirectionNode):
        return DIRECTIONS
    if isinstance(node, (TextNode, FlagNode, WholeNode)):
        return {TextNode: TEXTS, FlagNode: st.booleans(), WholeNode: st.integers(1, 20)}[type(node)]
    if isinstance(node, ChoiceNode):
        return st.sampled_from(list(node.choices))
    if isinstance(node, ListNode):
        length = {"min_size": node.length, "max_size": node.length} if node.length is not None else {"max_size": 3}
        return st.lists(values(node.item), **length).map(tuple)
    if isinstance(node, TableNode):
        names = NUMBER_NAMES if isinstance(node.item, NamedNode) else NAMES
        return st.dictionaries(names, values(node.item), max_size=2)
    if isinstance(node, UnionNode):
        return st.one_of(*(values(option) for _, option in node.options))
    return records(node) if isinstance(node, RecordNode) else st.just({})


def records(node: RecordNode) -> st.SearchStrategy[Any]:
    """Any value of a description class."""
    fields = {}
    for name, slot in node.fields.items():
        strategy = values(slot.node)
        strategy = st.one_of(st.none(), strategy) if slot.optional else strategy
        fields[name] = strategy if slot.required else st.one_of(st.just(slot.default), strategy)
    return st.builds(node.record, **fields)


@st.composite
def mechanisms(draw: st.DrawFn) -> Mechanism:
    """Any description whose addresses are sound; it need not make sense."""
    stage = draw(values(RecordNode(Mechanism)))
    gauges = {name: gauge for name, gauge in stage.gauges.items() if gauge != GaugeSum({})}  # a sum of nothing says nothing in a file
    stage = dataclasses.replace(
        stage, gauges=gauges, overrides={}, tags={}, placements={}, packages=()
    )  # a package that is named has to be installed
    if stage.parts:
        stage = _with_overrides(draw, stage)
    numbers = addresses(stage)
    for address in draw(st.lists(st.sampled_from(numbers), max_size=3, unique=True)) if numbers else []:
        stage = _with_formula(draw, stage, address)
    tagged = draw(st.lists(st.sampled_from(numbers), max_size=4, unique=True)) if numbers else []
    return dataclasses.replace(stage, tags={address: f"stated {draw(TEXTS)}" for address in tagged})


def _with_formula(draw: st.DrawFn, stage: Mechanism, address: str) -> Mechanism:
    """The stage with a formula at an address: of named numbers of that quantity if there are any; where that is no number, as it was."""
    quantity = quantity_of(stage, address)
    alike = [f"{name} + " for name, number in stage.numbers.items() if quantity_of_unit(number.unit).si == quantity.si]
    text = draw(st.sampled_from(["", *alike])) + f"2 * {show(draw(FINITE), quantity)}".replace("* -", "* -1 * ")
    try:
        return set_text(stage, address, text)
    except DesignError:
        return stage


def _with_overrides(draw: st.DrawFn, stage: Mechanism) -> Mechanism:
    part = draw(st.sampled_from(sorted(stage.parts)))
    link = draw(values(RecordNode(Link)))
    link = dataclasses.replace(link, part=part, at=link.at or (0.0, 0.0, 0.0))
    stage = dataclasses.replace(stage, units={"zz": Unit({}, {"link": link})}, placements=draw(_placements()))
    drawn = draw(st.lists(st.sampled_from(_overrides(stage)), max_size=3, unique=True))
    wanted = [key for key in drawn if not any(key.startswith(f"{other}.") for other in drawn)]  # `at` beside `at.x` is refused
    return dataclasses.replace(stage, overrides=Table({key: draw(values(locate(stage, key).node)) for key in wanted}))


def _placements() -> st.SearchStrategy[Any]:
    return values(RecordNode(Placement)).map(lambda placement: {"Z1-Z2": dataclasses.replace(placement, unit="zz")})


def _overrides(stage: Mechanism) -> list[str]:
    """Addresses of numbers that may depart: those of the link's part, and its place, in all copies or in the second."""
    link = stage.units["zz"].links["link"]
    inside = f"parts.{link.part}."
    own = [address.removeprefix(inside).removeprefix("part.") for address in addresses(stage) if address.startswith(inside)]
    return [f"{owner}/link.{path}" for owner in ("zz", "Z2") for path in ("at", "at.x", "along", *own)]
