"""Lines at which findings point: of values, of what stands around them, of links by the name they have in the stage."""

import pytest

from flexstage.base.finding import DesignError, Finding
from flexstage.cases.double_triangle import double_triangle
from flexstage.mechanism.addresses.address import addresses
from flexstage.mechanism.store import dumps, loads
from flexstage.mechanism.store.lines import Spot, line_numbers, line_of, spot_of, with_lines

TEXT = dumps(double_triangle())
ROWS = TEXT.splitlines()
LINES = line_numbers(TEXT)


def test_every_number_of_a_stage_has_a_line_that_names_it():
    found = {address: line_of(address, LINES) for address in addresses(double_triangle())}
    assert all(found.values())
    named = [ROWS[line - 1] for address, line in found.items() if address.rpartition(".")[2] in ROWS[line - 1]]
    assert len(named) > len(found) / 3
    assert ROWS[found["parts.pole_neck.thickness"] - 1].startswith("thickness")


@pytest.mark.parametrize(
    ("address", "start"),
    [
        ("horizontal/front", "front = {"),
        ("vertical/pivot.thickness", "pivot = {"),
        ("B4/pivot", "pivot = {"),
        ('requirements."stroke.x"', '"stroke.x"'),
        ('tags."materials.steel.yield_stress"', "yield_stress"),
    ],
)
def test_objects_of_the_stage_are_found(address, start):
    assert ROWS[line_of(address, LINES) - 1].startswith(start) or start in "".join(ROWS[line_of(address, LINES) - 1 :][:2])


def test_what_a_text_does_not_name_has_no_line():
    assert line_of("nothing.here", LINES) is None
    assert str(next(with_lines([Finding("a", "b", "c")], TEXT, "s.toml"))) == "s.toml: a: b. c."


def test_a_finding_says_where_it_points():
    at = ROWS.index('name = "double triangle"') + 1
    with pytest.raises(DesignError) as caught:
        loads(TEXT.replace('name = "double triangle"', "name = 3"), where="s.toml")
    assert [spot_of(each, "s.toml") for each in caught.value.findings] == [Spot("name", at)]
    with pytest.raises(DesignError) as caught:
        loads("\n[parts \n", where="s.toml")
    assert spot_of(caught.value.findings[0], "s.toml") == Spot("", 2, 8)
    assert spot_of(Finding("lib.toml:3: parts.wire", "b", "c"), "s.toml") == Spot("lib.toml:3: parts.wire")
