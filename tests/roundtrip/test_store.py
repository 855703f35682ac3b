"""The design file: load(dump(m)) == m bit for bit and in the same order, short texts, catalogue, provenance, comments."""

from __future__ import annotations

import dataclasses
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from flexstage.base.finding import DesignError
from flexstage.cases.double_triangle import double_triangle
from flexstage.cases.registry import CASES
from flexstage.mechanism.addresses.address import assign, get, provenance, set_text, tag_of
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.checks import check
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import dump, dumps, load, loads, round_to_digits, shipped_catalogue
from flexstage.parts.rod import Rod
from tests.conftest import examples
from tests.roundtrip.designs import mechanisms

START = 'format = "flexstage 1"\nname = "a"\n'


def order(value: Any) -> Any:
    """The names in a description in their order, all the way down; tags and formulas may stand anywhere."""
    if isinstance(value, Mapping):
        return [(name, order(item)) for name, item in value.items()]
    if dataclasses.is_dataclass(value):
        return [
            (field.name, order(getattr(value, field.name))) for field in dataclasses.fields(value) if field.name not in ("tags", "formulas")
        ]
    return [order(item) for item in value] if isinstance(value, tuple) else None


@examples(8)
@given(mechanisms())
def test_any_description_survives_its_file(mechanism: Mechanism) -> None:
    read = loads(dumps(mechanism), checked=False)
    assert read == mechanism
    assert order(read) == order(mechanism)


@pytest.mark.parametrize("name", CASES)
def test_shipped_cases_survive_their_files_and_pass_the_checks(name: str, tmp_path: Path) -> None:
    mechanism = CASES[name].build()
    read = load(dump(mechanism, tmp_path / "stage.toml"))
    assert read == mechanism
    assert check(read) == ()
    assert list(expand(read).links) == list(expand(mechanism).links)
    assert list(expand(read).actuators) == list(expand(mechanism).actuators)


def test_a_formula_under_overrides_is_not_the_units() -> None:
    """The unit's own place stays; what the formula is worked out of moves the override."""
    text = dumps(double_triangle())
    text = text.replace("\n[materials", '\n[numbers]\narm = "10 mm"\n\n[materials', 1)
    text += '\n[overrides]\n"horizontal/front.at.x" = "2 * arm"\n'
    stage = loads(text)
    assert dict(stage.formulas) == {"horizontal/front.at.x": "2 * arm"}
    assert loads(dumps(stage)) == stage
    moved = set_text(stage, "numbers.arm", "20 mm")
    assert get(moved, "B1/front.at.x") == 0.04
    assert moved.units == stage.units


def test_overrides_that_are_no_table_are_told() -> None:
    with pytest.raises(DesignError, match=r"overrides: must be a table \(got 5\)"):
        loads(f"{START}overrides = 5\n")


@pytest.mark.parametrize("name", CASES)
def test_a_tidied_case_is_the_same_stage_in_short_texts(name: str) -> None:
    mechanism = CASES[name].build()
    tidy = round_to_digits(mechanism)
    assert round_to_digits(tidy) == tidy
    assert loads(dumps(tidy)) == tidy
    assert dict(provenance(tidy)) == dict(provenance(mechanism))
    digits = [len([sign for sign in text.lstrip("0.") if sign.isdigit()]) for text in dumps(tidy).split('"') if text[:1].isdigit()]
    assert max(digits) <= 14


def test_texts_are_the_shortest_in_the_shown_unit() -> None:
    text = dumps(Mechanism("a", parts={"wire": Rod("steel", length=0.03, diameter=0.1 + 0.2)}))
    assert 'length = "30 mm"' in text
    assert 'diameter = "300.00000000000004 mm"' in text


@pytest.mark.parametrize("value", [np.array([1.0, 2.0]), 1.0 + 1e-20j])
def test_what_a_file_cannot_hold_is_refused_by_name(value: Any, tmp_path: Path) -> None:
    mechanism = Mechanism("a", parts={"wire": Rod("steel", length=value, diameter=0.001)})
    with pytest.raises(DesignError, match=r"parts\.wire\.length: "):
        dump(mechanism, tmp_path / "stage.toml")
    assert list(tmp_path.iterdir()) == []


def test_comments_stand_above_what_they_are_about() -> None:
    wire = Rod("steel", length=0.03, diameter=0.001)
    text = dumps(Mechanism("a", parts={"wire": wire}), {"": "A wire.", "parts.wire": "Drawn.", "parts.wire.length": "Free."})
    assert text.startswith("# A wire.\nformat")
    assert "# Drawn.\n[parts.wire]" in text
    assert '# Free.\nlength = "30 mm"' in text


def test_a_comment_on_nothing_is_refused() -> None:
    with pytest.raises(DesignError, match=r"parts\.wire"):
        dumps(Mechanism("a"), {"parts.wire": "Drawn."})


def test_comments_cannot_break_the_file() -> None:
    assert loads(dumps(Mechanism("a"), {"": "one\ntwo\x00\x7f\u2028three"}), checked=False) == Mechanism("a")


def test_directions_by_name_or_by_components() -> None:
    text = START + '[links]\na = { joins = ["ground", "b"], part = "p", at = ["0 m", "0 m", "0 m"], along = "-y", bends = [1, 0, 0.5] }\n'
    link = loads(text, checked=False).links["a"]
    assert (link.along, link.bends) == ((0.0, -1.0, 0.0), (1.0, 0.0, 0.5))


def test_a_compliance_has_units_by_block_and_bare_zeros() -> None:
    rows = [["0"] * 6 for _ in range(6)]
    for index, unit in enumerate(("um/N", "um/N", "um/N", "urad/(N m)", "urad/(N m)", "urad/(N m)")):
        rows[index][index] = f'"2.5 {unit}"'
    rows[1][5], rows[5][1] = '"1e-7 m/(N m)"', '"0.1 urad/N"'
    matrix = ",\n".join(f"[{', '.join(row)}]" for row in rows)
    part = loads(START + f'[parts.p]\nkind = "compliance_matrix"\nfree = ["rz"]\ncompliance = [\n{matrix}\n]\n', checked=False).parts["p"]
    assert part.compliance[0][0] == part.compliance[3][3] == 2.5e-6
    assert part.compliance[1][5] == part.compliance[5][1] == 1e-7


def test_the_catalogue_is_overridden_by_what_follows_and_brings_its_tags_and_sources() -> None:
    text = START + '[materials.steel]\nlike = "SUS420"\nyoung = "210 GPa"\ndensity = "7.8 g/cm^3"\ntags = { density = "derived scale" }\n'
    read = loads(text, checked=False)
    assert read.materials["steel"].young == 210e9
    assert read.materials["steel"].yield_stress == 1360e6
    assert tag_of(read, "steel.young") == "assumed"
    assert tag_of(read, "steel.yield_stress") == "stated shin-moon 2.1"
    assert tag_of(read, "steel.density") == "derived scale"
    assert "shin-moon" in read.sources
    assert loads(dumps(read), checked=False) == read


def test_every_entry_of_the_catalogue_can_be_read_and_is_tagged_throughout() -> None:
    sections = shipped_catalogue().sections
    lines = [f'[{each.key}.{each.name}{number}]\nlike = "{name}"' for each in sections for number, name in enumerate(each.entries)]
    read = loads(START + "\n".join(lines), checked=False)
    assert [str(finding) for finding in check(read) if "platform" not in finding.what] == []
    for section in shipped_catalogue().sections:
        for name, item in section.entries.items():
            assert set(item["tags"]) == set(item) - {"tags", "source"}, name
            assert {tag.split()[1] for tag in item["tags"].values() if tag != "assumed"} <= set(shipped_catalogue().sources), name


def test_tags_stand_in_any_table() -> None:
    text = START + (
        'tags = { max_mode_frequency = "stated paper 1" }\nmax_mode_frequency = "1 kHz"\n'
        '[sources]\npaper = "a paper"\n'
        '[parts.wire]\nkind = "rod"\nmaterial = "steel"\nlength = "3 mm"\ndiameter = "1 mm"\ntags = { length = "stated paper 2" }\n'
        '[units.leg.links.front]\njoins = ["ground", "platform"]\npart = "wire"\nat = ["0 m", "0 m", "0 m"]\nalong = "x"\n'
        'tags = { "at.x" = "derived paper" }\n'
        '[placements.L]\nunit = "leg"\n'
        'polar = { radius = "1 mm", first = "0 deg", facing = "axis", tags = { radius = "stated paper 3" } }\n'
    )
    read = loads(text, checked=False)
    told = [tag_of(read, address) for address in ("max_mode_frequency", "wire.length", "leg/front.at.x", "leg/front.at.y", "L.radius")]
    assert told == ["stated paper 1", "stated paper 2", "derived paper", "assumed", "stated paper 3"]
    assert loads(dumps(read), checked=False) == read


def test_changes_are_read_as_what_they_address() -> None:
    stage = CASES["double-triangle"].build()
    changed = assign(assign(stage, "B2/front.thickness=1.55 mm"), "horizontal/front.along=-x")
    text = dumps(changed)
    assert tomllib.loads(text)["overrides"] == {"B2/front.thickness": "1.55 mm"}
    assert loads(text) == changed


def test_a_ratio_may_be_a_percentage() -> None:
    read = loads(START + 'damping = { law = "modal", ratio = "1 %" }\n', checked=False)
    assert read.damping is not None
    assert read == loads(START + 'damping = { law = "modal", ratio = 0.01 }\n', checked=False)
