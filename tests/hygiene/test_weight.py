"""The weight of the source: code tokens by package stay below ceilings that only fall."""

from __future__ import annotations

import pytest

from tests.hygiene.source import expect_none
from tools.weight import weigh, weights

CEILINGS = {
    "base": 28_800,
    "spatial": 3_900,
    "parts": 37_400,
    "beams": 25_300,
    "mechanism": 55_200,
    "cases": 1_200,
    "models": 96_200,
    "analysis": 69_700,
    "show": 62_600,
    "solid": 71_700,
    "experiment": 96_400,
    "control": 148_800,
    "studies": 69_600,
    "apps": 37_000,
    ".": 400,
    "all": 803_500,
}
"""Code tokens of each package, to the next hundred. A change may lower a ceiling; raising one needs a decision record."""


SLACK = 1_000
"""Tokens by which a ceiling may exceed the weight, so that what a change saves stays saved."""


def test_weights_stay_below_ceilings_that_follow_them() -> None:
    found = {name: row["tokens"] for name, row in weights().items()}
    heavy = (name for name, tokens in found.items() if tokens > CEILINGS.get(name, 0))
    advice = "remove code; to raise a ceiling, write a decision record that says what was tried instead"
    expect_none((f"{name}: {found[name]:,} code tokens, ceiling {CEILINGS.get(name, 0):,}" for name in heavy), advice)
    light = ((name, -(-found.get(name, 0) // 100) * 100) for name, ceiling in CEILINGS.items() if found.get(name, 0) < ceiling - SLACK)
    expect_none((f'"{name}": {tokens:_},' for name, tokens in light), "lower these ceilings: the packages have become lighter")


@pytest.mark.parametrize(
    ("text", "weight"),
    [
        ('"""A module."""\nimport math\n\nhalf = 0.5 * math.pi  # a comment\n', (7, 1)),
        ("def f(x):\n    '''One\n    two.'''\n    return x if x >= 1e-3 else -x\n", (15, 2)),
        ('a = f"{b}" "c"; d **= 0x1F\n"not a docstring" + a\n', (11, 0)),
        ("from a import (\n    b,\n    c,\n)\n@b\nclass C: ...\n", (6, 0)),
    ],
)
def test_tokens_leave_out_docstrings_comments_and_imports(text, weight) -> None:
    assert weigh(text) == weight
