"""Changing a design file's text: the value changes, its stale tag goes, everything else stays; files are written whole or not at all."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.cases.registry import CASES
from flexstage.mechanism.addresses.address import addresses, assign, get, set_value, tag_of
from flexstage.mechanism.store import dumps, loads, patch, round_to_digits, write
from tests.conftest import examples
from tests.roundtrip.designs import TEXT


@pytest.mark.parametrize(
    ("address", "value", "old", "new"),
    [
        ("wire.length", "32 mm", 'length = "30 mm"         # as drawn', 'length = "32 mm"         # as drawn'),
        ("wire.length", 0.032, 'length = "30 mm"         # as drawn', 'length = "32 mm"         # as drawn'),
        ("leg/front.at.x", "2 mm", 'at = ["1 mm",', 'at = ["2 mm",'),
        ("leg/front.along", "x", 'along = "z"', 'along = "x"'),
        ("leg/front.along.x", 0.5, 'along = "z"', "along = [0.5, 0.0, 1.0]"),
        ("L1-L3.radius", "60 mm", 'radius = "50 mm"', 'radius = "60 mm"'),
        ("wire.material", "steel2", 'material = "steel"', 'material = "steel2"'),
    ],
)
def test_one_place_changes(address: str, value: Any, old: str, new: str) -> None:
    changed = patch(TEXT, {address: value})
    stale = 'length = "stated paper 2", '
    assert changed.replace(" ", "") == TEXT.replace(old, new).replace(stale if "length" in address else "", "").replace(" ", "")


def test_what_the_catalogue_gave_is_overridden_in_its_table() -> None:
    changed = patch(TEXT, {"steel.young": "210 GPa"})
    assert 'like = "SUS420"          # from the catalogue\nyoung = "210 GPa"' in changed
    read = loads(changed)
    assert (read.materials["steel"].young, tag_of(read, "steel.young")) == (210e9, "assumed")


def test_overrides_are_listed_under_overrides() -> None:
    once = patch(TEXT, {"L2/front.diameter": "1.1 mm"})
    assert once.startswith(TEXT.rstrip())
    assert '[overrides]\n"L2/front.diameter" = "1.1 mm"' in once
    twice = patch(once, {"L2/front.diameter": "1.2 mm", "leg/front.length": "31 mm"})
    assert dict(loads(twice).overrides) == {"L2/front.diameter": 1.2e-3, "leg/front.length": 0.031}


def test_absent_values_are_added() -> None:
    changed = patch(TEXT, {"max_mode_frequency": "2 kHz", "gravity.z": "0 m/s^2", "placements.L1-L3.height": "5 mm"})
    read = loads(changed)
    assert (read.max_mode_frequency, read.gravity[2], get(read, "L1-L3.height")) == (2000.0, 0.0, 0.005)


@pytest.mark.parametrize("name", ["double-triangle", "bridge"])
@examples(6)
@given(data=st.data())
def test_any_number_of_a_case_can_be_patched(name: str, data: st.DataObject) -> None:
    stage = round_to_digits(CASES[name].build())
    address = data.draw(st.sampled_from(addresses(stage)))
    value = data.draw(st.floats(min_value=1e-6, max_value=10.0))
    assert loads(patch(dumps(stage), {address: value}), checked=False) == set_value(stage, address, value)


@pytest.mark.parametrize("values", [{"wire.lenght": "1 mm"}, {"wire.length": "1 kg"}, {"wire.length": "1"}, {"leg/front.at": "1 mm"}])
def test_a_wrong_change_changes_nothing(values: dict[str, str]) -> None:
    with pytest.raises(DesignError):
        patch(TEXT, values)


def test_writing_replaces_the_whole_file_and_keeps_its_permissions(tmp_path: Path) -> None:
    target = tmp_path / "stage.toml"
    target.write_text("old " * 1000)
    target.chmod(0o640)
    assert write(target, "new") == target
    assert target.read_text() == "new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert [path.name for path in tmp_path.iterdir()] == ["stage.toml"]


def test_writing_through_a_link_keeps_the_link(tmp_path: Path) -> None:
    (tmp_path / "real.toml").write_text("old")
    (tmp_path / "link.toml").symlink_to(tmp_path / "real.toml")
    write(tmp_path / "link.toml", "new")
    assert (tmp_path / "real.toml").read_text() == "new"
    assert (tmp_path / "link.toml").is_symlink()


def test_a_failure_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "stage.toml"
    target.write_text("old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(DesignError, match="No space left"):
        write(target, "new")
    assert target.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["stage.toml"]


@pytest.mark.parametrize("path", ["missing/stage.toml", ".", "file/stage.toml", "nul\0.toml", "x" * 300])
def test_unwritable_paths_are_told(tmp_path: Path, path: str) -> None:
    (tmp_path / "file").write_text("a file")
    with pytest.raises(DesignError) as caught:
        write(f"{tmp_path}/{path}", "new")
    assert str(caught.value).startswith(f"{tmp_path}/{path}: ")
    assert sorted(item.name for item in tmp_path.iterdir()) == ["file"]


def test_a_device_is_never_replaced(tmp_path: Path) -> None:
    fifo = tmp_path / "pipe"
    os.mkfifo(fifo)
    with pytest.raises(DesignError, match="not a regular file"):
        write(fifo, "new")
    assert stat.S_ISFIFO(fifo.stat().st_mode)


def test_a_protected_file_is_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    target = tmp_path / "stage.toml"
    target.write_text("old")
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(DesignError, match="write-protected"):
        write(target, "new")
    assert target.read_text() == "old"


NUMBERS = TEXT.replace('length = "30 mm"         # as drawn', 'length = "2*arm"         # as drawn').replace(
    "[materials.steel]", '[numbers]\narm = "15 mm"   # measured\ntags = { arm = "stated paper 2" }\n\n[materials.steel]'
)


def test_a_named_number_changes_in_its_place_and_formulas_stay() -> None:
    """The tags of the number and of what depends on it are taken out: what was stated of them is not true any more."""
    found = patch(NUMBERS, {"numbers.arm": 0.02})
    wanted = NUMBERS.replace('"15 mm"', '"20 mm"').replace('tags = { arm = "stated paper 2" }\n', "")
    assert found.split() == wanted.replace('length = "stated paper 2", ', "").split()
    assert loads(found).parts["wire"].length == 0.04


def test_a_formula_is_replaced_by_a_number_or_by_another() -> None:
    assert 'length = "31 mm"  ' in patch(NUMBERS, {"wire.length": "31 mm"})
    found = patch(
        NUMBERS, {"wire.length": "3*arm", "wire.diameter": "arm/15", "leg/front.at.x": "arm - 1 mm", "L2/front.diameter": "arm/16"}
    )
    stage = loads(found)
    assert (stage.parts["wire"].length, stage.units["leg"].links["front"].at[0]) == (3 * 0.015, 0.015 - 0.001)
    assert '["arm - 1 mm", "0 mm", "0 mm"]' in found
    assert '"L2/front.diameter" = "arm/16"' in found
    assert loads(dumps(stage)) == stage


@pytest.mark.parametrize(
    ("assignment", "address", "value"),
    [
        ("numbers.arm=+10%", "wire.length", 0.03 * 1.1),
        ("arm = 20 mm", "wire.length", 0.04),
        ("wire.diameter=-5 %", "wire.diameter", 0.00095),
        ("wire.length=+10%", "wire.length", 0.033),
        ("steel.poisson=+10%", "steel.poisson", 0.33),
        ("steel.poisson=10%", "steel.poisson", 0.1),  # without a sign it is the value
    ],
)
def test_assignments_in_percent(assignment: str, address: str, value: float) -> None:
    assert get(assign(loads(NUMBERS), assignment), address) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    ("assignment", "words"),
    [
        ("leg/front.at.y=+10%", "leg/front.at.y: the value is 0, and a percentage does not change it. Use a value with its unit"),
        ("numbers.arm=3 N", "a force"),
        ("max_mode_frequency=-5%", "max_mode_frequency: not specified, so a percentage has no reference value. Use a value with its unit"),
    ],
)
def test_assignments_that_are_refused(assignment: str, words: str) -> None:
    with pytest.raises(DesignError, match=words):
        assign(loads(NUMBERS), assignment)
