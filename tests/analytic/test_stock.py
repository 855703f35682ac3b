"""The stacks of the shipped stage agree with the shipped catalogue."""

from __future__ import annotations

from dataclasses import asdict

import pytest

from flexstage.cases.double_triangle import double_triangle
from flexstage.mechanism.store import loads

# The stacks of the case are as long as its unit needs, and their casings are computed from that length.
OWN = {"length", "mass", "bending_rigidity", "source"}


def catalogued(section: str, like: str) -> dict[str, object]:
    """An entry of the catalogue, by way of a file that names it; fields it does not state are left out."""
    platform = '[bodies.platform]\nmass = "1 kg"'
    stage = loads(f'format = "flexstage 1"\nname = "one"\n[{section}.one]\nlike = "{like}"\n{platform}\n', checked=False)
    return {name: value for name, value in asdict(getattr(stage, section)["one"]).items() if value is not None}


@pytest.mark.parametrize(("part", "like"), [("stack_horizontal", "PSt 1000/10/150 VS18"), ("stack_vertical", "PSt 1000/16/200 VS25")])
def test_stacks_of_the_paper(part: str, like: str) -> None:
    found, expected = asdict(double_triangle().parts[part]), catalogued("parts", like)
    assert {name: found[name] for name in expected if name not in OWN} == pytest.approx({k: v for k, v in expected.items() if k not in OWN})
    assert found["bending_rigidity"] == pytest.approx(expected["bending_rigidity"], rel=1e-3)
