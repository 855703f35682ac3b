"""Laws of expressions: what random trees give is what Python's floats give, their slope is that of numpy, and dimensions add up."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from flexstage.analysis.assessment.sensitivities import sensitivities
from flexstage.base.finding import DesignError
from flexstage.base.units.dimension import dimension_of
from flexstage.base.units.expression import Amount, ExpressionError, evaluate, parse_expression
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.registry import case
from flexstage.mechanism.addresses.address import get, set_text, set_value
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import Mechanism, NamedNumber
from flexstage.models.linear.eigen import eigen
from flexstage.models.lumped import lumped
from tests.conftest import examples

VALUES = {"arm": 0.026, "half": 0.0125, "share": 0.3}


@dataclass(frozen=True)
class Tree:
    """An expression as flexstage reads it and as Python does, and the power of the length that it is."""

    text: str
    python: str
    power: int


LEAVES = [Tree("arm", "arm", 1), Tree("half", "half", 1), Tree("share", "share", 0), Tree("2", "2.0", 0), Tree("1.5 mm", "0.0015", 1)]


def pair(left: Tree, right: Tree, sign: str) -> Tree:
    """Two trees with a sign between, or with a product where a sum makes no sense."""
    if left.power != right.power and sign in "+-":
        sign = "*"
    power = left.power + {"*": 1, "/": -1}.get(sign, 0) * right.power
    return Tree(f"({left.text}) {sign} ({right.text})", f"({left.python}) {sign} ({right.python})", power)


def call(function: str, inner: Tree) -> Tree:
    """The root of a tree's square, or a function of so many radians as a ratio is."""
    if function == "sqrt":
        return Tree(f"sqrt(({inner.text})*({inner.text}))", f"sqrt(({inner.python})*({inner.python}))", inner.power)
    return inner if inner.power else Tree(f"{function}(1 rad*({inner.text}))", f"{function}(1.0*({inner.python}))", 0)


TREES = st.recursive(
    st.sampled_from(LEAVES),
    lambda inner: st.one_of(
        st.builds(pair, inner, inner, st.sampled_from("+-*/")),
        st.builds(call, st.sampled_from(["sqrt", "sin", "cos", "tan"]), inner),
        inner.map(lambda tree: Tree(f"-({tree.text})", f"-({tree.python})", tree.power)),
    ),
    max_leaves=8,
)


def scope(values: dict[str, Any]) -> dict[str, Amount]:
    """The named numbers of the trees."""
    return {name: Amount(value, dimension_of("1" if name == "share" else "m")) for name, value in values.items()}


def amount(text: str, values: dict[str, Any]) -> Amount:
    """What an expression gives; of what divides by nothing, is too long or no number, nothing is asked."""
    try:
        return evaluate(parse_expression(text), scope(values))
    except ExpressionError as error:
        assume(not any(word in error.what for word in ("divides by 0", "must be finite", "characters", "nests")))
        raise


@examples(67)
@given(TREES)
def test_values_are_those_of_floats_and_slopes_those_of_numpy(tree: Tree) -> None:
    found = amount(tree.text, VALUES)
    functions = {name: getattr(np, name) for name in ("sqrt", "sin", "cos", "tan")}
    with np.errstate(all="ignore"):
        wanted = eval(tree.python, functions | VALUES)  # noqa: S307 (the test's own text, the oracle)
        stepped = eval(tree.python, functions | VALUES | {"arm": complex(0.026, 1e-22)})  # noqa: S307
    assert found.value == wanted
    assert dict(found.dimension.powers).get("[length]", 0) == tree.power
    slope = np.imag(amount(tree.text, VALUES | {"arm": complex(0.026, 1e-22)}).value) / 1e-22
    assert np.isclose(slope, np.imag(stepped) / 1e-22, rtol=1e-12, atol=0.0, equal_nan=True)


@examples(20)
@given(TREES)
def test_a_batch_gives_what_its_designs_give(tree: Tree) -> None:
    arms = np.array([0.02, 0.026, 0.031])
    together = amount(tree.text, VALUES | {"arm": arms}).value
    single = [amount(tree.text, VALUES | {"arm": float(arm)}).value for arm in arms]
    assert np.allclose(together, single, rtol=1e-13, atol=0.0)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2*arm + 1 mm", 0.053),
        ("10 um/V", 1e-5),
        ("10 um/arm", 1e-5 / 0.026),
        ("10 um/(2*arm)", 1e-5 / 0.052),
        ("1 mm/2", 0.0005),
        ("1/2*arm", 0.013),
        ("2 - 3 - 4", -5.0),
        ("8/4/2", 1.0),
        ("-2*-3", 6.0),
        ("10 % * arm", 0.0026),
        ("4590 urad/(N m) * 2", 0.00918),
        ("3 mm²", 3e-6),
        ("sin(30 deg)", math.sin(math.pi / 6)),
        ("sqrt(4 mm^2)", 0.002),
    ],
)
def test_units_belong_to_the_number_before_them(text: str, value: float) -> None:
    assert amount(text, VALUES).value == pytest.approx(value, rel=1e-15)


def stage() -> Mechanism:
    """Two leaves whose length, thickness and place come from two numbers."""
    found = replace(parallelogram(), numbers={"arm": NamedNumber(0.026, "mm"), "share": NamedNumber(0.02, "1")})
    for address, text in {
        "parts.leaf.length": "arm*1.2",
        "parts.leaf.thickness": "sqrt(arm*arm*share*share)",
        "parts.leaf.width": "arm*cos(40 deg)",
    }.items():
        found = set_text(found, address, text)
    assert not check(found)
    return found


def test_the_sensitivity_to_a_number_is_the_sum_over_what_depends_on_it() -> None:
    """The chain rule, by the slopes of the formulas; and the eigenvalue's own difference quotient beside it."""
    found = stage()
    fields = tuple(address for address in found.formulas)
    slopes = sensitivities(found, ("numbers.arm", *fields), modes=3)
    stepped = set_value(found, "numbers.arm", complex(0.026, 1e-22))
    weights = np.array([np.imag(get(stepped, address)) / 1e-22 for address in fields])
    assert np.allclose(slopes.frequency[0], weights @ slopes.frequency[1:], rtol=1e-9)
    above, below = (eigen(lumped(set_value(found, "numbers.arm", 0.026 + step))).values[:3] ** 0.5 / (2 * np.pi) for step in (1e-7, -1e-7))
    assert np.allclose(slopes.frequency[0], (above - below) / 2e-7, rtol=1e-5)


def test_numbers_and_what_hides_them_are_not_stepped_together() -> None:
    """All at once give what each gives by itself: writing a number overwrites what is worked out of it."""
    found = set_text(stage(), "numbers.share", "arm/(1.3 m)")
    names = ("numbers.share", "parts.leaf.length", "numbers.arm", "parts.leaf.thickness")
    together = sensitivities(found, names, modes=2).frequency
    for row, name in zip(together, names, strict=True):
        assert np.allclose(row, sensitivities(found, (name,), modes=2).frequency[0], rtol=1e-9)


def test_a_value_that_is_set_loses_its_formula_and_no_other_does() -> None:
    found = set_value(stage(), "leaf.length", 0.03)
    assert "parts.leaf.length" not in found.formulas
    assert "parts.leaf.width" in found.formulas
    moved = set_value(found, "numbers.arm", 0.03)
    assert get(moved, "leaf.length") == 0.03
    assert get(moved, "leaf.width") == pytest.approx(0.03 * math.cos(math.radians(40.0)), rel=1e-15)


def test_a_batch_of_a_number_is_one_description() -> None:
    arms = np.array([0.024, 0.026])
    both = eigen(lumped(set_value(stage(), "numbers.arm", arms))).values
    for position, arm in enumerate(arms):
        one = eigen(lumped(set_value(stage(), "numbers.arm", float(arm)))).values
        assert np.allclose(both[position], one, rtol=1e-10)


def test_formulas_and_values_that_differ_are_told() -> None:
    found = stage()
    parts = dict(found.parts) | {"leaf": replace(found.parts["leaf"], length=0.05)}
    (told,) = check(replace(found, parts=parts))
    assert str(told).startswith('parts.leaf.length: wrong value (got 0.05, expected 0.0312 in SI from its formula "arm*1.2")')


def test_a_number_is_not_worked_out_of_itself() -> None:
    found = set_text(stage(), "numbers.share", "arm/(1.3 m)")
    with pytest.raises(DesignError, match="and therefore on arm"):
        set_text(found, "numbers.arm", "share*1 m")


@pytest.mark.parametrize(
    "address", ["numbers.share", "numbers.arm", "damping.ratio", "materials.steel.poisson", "materials.steel.young", "parts.neck.thickness"]
)
@pytest.mark.parametrize(("text", "factor"), [("+10%", 1.1), ("-2.5 %", 0.975), ("+ 10 %", None), ("+0 %", 1.0)])
def test_a_signed_percentage_is_a_change_of_every_number(address: str, text: str, factor: float | None) -> None:
    """Ratios are numbers like others: only a percentage without a sign is the value of one."""
    before = replace(case("double-triangle"), numbers={"share": NamedNumber(0.3, "1"), "arm": NamedNumber(0.026, "mm")})
    if factor is None:
        with pytest.raises(DesignError):
            set_text(before, address, text)
    else:
        assert get(set_text(before, address, text), address) == pytest.approx(factor * get(before, address), rel=1e-12)
    if address in ("damping.ratio", "numbers.share"):
        assert get(set_text(before, address, "10 %"), address) == pytest.approx(0.1, rel=1e-12)
