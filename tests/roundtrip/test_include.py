"""Files that a design includes: their entries are the design's, changes of them stand in the design, and mistakes name the file."""

from __future__ import annotations

from pathlib import Path

import pytest

from flexstage.base.finding import DesignError
from flexstage.mechanism.addresses.address import assign, tag_of
from flexstage.mechanism.store import dump, load, loads, patch
from flexstage.mechanism.store.retag import set_tags

STOCK = """format = "flexstage 1"
name = "our stock"

[numbers]
wire_size = "1 mm"

[materials.steel]
like = "SUS420"

[parts.wire]
kind = "rod"
material = "steel"
length = "30*wire_size"
diameter = "wire_size"
tags = { length = "stated drawing 3" }

[sources]
drawing = "sheet 3"
"""
STAGE = """format = "flexstage 1"
name = "post"
include = ["lib/stock.toml"]   # ours

[bodies.platform]
mass = "1 kg"

[links]
post = { joins = ["ground", "platform"], part = "wire", at = ["wire_size", "0 mm", "0 mm"], along = "z" }
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A stage and the stock that it includes."""
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "stock.toml").write_text(STOCK)
    (tmp_path / "stage.toml").write_text(STAGE)
    return tmp_path


def told(folder: Path) -> str:
    """What is said about the stage."""
    with pytest.raises(DesignError) as caught:
        load(folder / "stage.toml")
    return str(caught.value)


def test_included_entries_are_the_designs_own(folder: Path) -> None:
    """As if all stood in one file; what is written holds all, and needs no other file."""
    stage = load(folder / "stage.toml")
    whole = loads(STAGE.replace('include = ["lib/stock.toml"]   # ours\n', "") + STOCK.partition('"our stock"')[2])
    assert stage == whole
    assert stage.links["post"].at[0] == 0.001
    assert load(dump(stage, folder / "elsewhere.toml")) == stage
    assert "include" not in (folder / "elsewhere.toml").read_text()
    assert assign(stage, "numbers.wire_size=2 mm").parts["wire"].length == 0.06


def test_values_of_included_entries_are_changed_in_the_design(folder: Path) -> None:
    """The stock stays as it is; numbers move what depends on them, and a changed value has no tag of the stock's."""
    path = folder / "stage.toml"
    changed = patch(STAGE, {"numbers.wire_size": "1.2 mm", "wire.diameter": 0.0011}, where=str(path))
    assert '"numbers.wire_size" = "1.2 mm"' in changed
    assert '"parts.wire.diameter" = "1.1 mm"' in changed
    path.write_text(set_tags(changed, {"wire.diameter": "derived test"}, where=str(path)))
    stage = load(path)
    assert (stage.parts["wire"].length, stage.parts["wire"].diameter) == (30 * 0.0012, 0.0011)
    assert (tag_of(stage, "wire.length"), tag_of(stage, "wire.diameter")) == ("assumed", "derived test")
    assert not stage.overrides
    assert load(dump(stage, folder / "elsewhere.toml")) == stage


def test_a_library_may_include_another(folder: Path) -> None:
    material = '[materials.steel]\nlike = "SUS420"\n'
    (folder / "steel.toml").write_text(f'format = "flexstage 1"\n{material}')
    (folder / "lib" / "stock.toml").write_text(STOCK.replace(material, "").replace("\n\n", '\ninclude = ["../steel.toml"]\n\n', 1))
    assert load(folder / "stage.toml").materials["steel"].young > 0.0


@pytest.mark.parametrize(
    ("stock", "stage", "words"),
    [
        (STOCK, STAGE.replace("lib/", "lib2/"), ["include", "lib2/stock.toml", "file not found"]),
        (STOCK, STAGE.replace("lib/stock", "stage"), ["include", "stage.toml would include itself"]),
        (STOCK, STAGE.replace('["lib/stock.toml"]', "3"), ["include", "a list of files"]),
        (
            STOCK,
            STAGE + '[parts.wire]\nkind = "rod"\n',
            ["include", "parts.wire is both in lib/stock.toml and in this file", "[overrides]"],
        ),
        (STOCK.replace("flexstage 1", "flexstage study 1"), STAGE, ["lib/stock.toml:1: format", "flexstage study 1"]),
        (
            STOCK.replace('"our stock"', '"our stock"\ninclude = ["../stage.toml"]'),
            STAGE,
            ["circular reference"],
        ),
        (STOCK + '[bodies.platform]\nmass = "2 kg"\n', STAGE, ["lib/stock.toml:", "bodies", "not allowed"]),
        (STOCK.replace('"30*wire_size"', '"30 N"'), STAGE, ["lib/stock.toml:13: parts.wire.length", "a force"]),
        (STOCK.replace('"1 mm"', '"1 ell"'), STAGE, ["lib/stock.toml:5: numbers.wire_size", "ell"]),
        (STOCK.replace("name =", "name = ="), STAGE, ["lib/stock.toml:2:", "not TOML"]),
        (STOCK, STAGE + '[overrides]\n"parts.wire.length" = "3 N"\n', ['overrides."parts.wire.length"', "a force"]),
        (STOCK, STAGE + '[overrides]\n"parts.wire.lenght" = "3 mm"\n', ['overrides."parts.wire.lenght"', "length"]),
    ],
)
def test_mistakes_name_the_file(folder: Path, stock: str, stage: str, words: list[str]) -> None:
    (folder / "lib" / "stock.toml").write_text(stock)
    (folder / "stage.toml").write_text(stage)
    text = told(folder)
    assert any(all(word in line for word in words) for line in text.splitlines()), text


def test_a_large_file_is_not_included(folder: Path) -> None:
    (folder / "lib" / "stock.toml").write_text("#" * 6_000_000)
    assert "file too large" in told(folder)
