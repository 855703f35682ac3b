"""The recipes of docs/contributing.md, performed in a copy of the project: contracts and style always, types and features in full."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from textwrap import indent

import pytest

from flexstage.cases.registry import case
from flexstage.mechanism.store import dumps
from tests.apps.test_outside_package import LOOP, ROUGH, flexstage
from tests.hygiene.source import ROOT, SRC
from tests.hygiene.test_contracts import lint
from tests.outside_package.stage import SMALL, design

PACKAGE = ROOT / "tests" / "outside_package" / "tapered_leaf"
FILES = {
    "parts/taper": "part",
    "beams/taper": "law",
    "solid/fea/taper": "solid",
    "parts/blade_pair": "pair",
    "parts/interferometer": "gauge",
    "experiment/formats/log": "log",
    "control/controllers/integrators": "controller",
    "control/study/switching": "amplifier",
}
"""New modules of which the page shows a part, and those of the package from outside that are the same."""

FENCED = re.compile(r"`(src/flexstage/[\w/]+\.py)`|^( *)```diff\n(.*?)^ *```$", re.MULTILINE | re.DOTALL)


def edits() -> Iterator[tuple[str, str]]:
    """The file of each diff of the page, the last that is named before it, and its lines."""
    path = ""
    for found in FENCED.finditer((ROOT / "docs" / "contributing.md").read_text(encoding="utf-8")):
        path = found[1] or path
        if found[3]:
            yield path, re.sub(f"^{found[2]}", "", found[3], flags=re.MULTILINE)


def perform(folder: Path) -> Path:
    """Take a copy of the package through all recipes."""
    shutil.copy(ROOT / "pyproject.toml", folder)
    shutil.copytree(SRC, folder / "src" / "flexstage", ignore=shutil.ignore_patterns("__pycache__"))
    for path, diff in edits():
        hunks = [sides(hunk) for hunk in diff.split("@@\n")]
        if (folder / path).exists():
            change(folder / path, hunks)
        else:
            (folder / path).write_text(whole(path.removeprefix("src/flexstage/").removesuffix(".py"), hunks))
    ruff(folder, "check", "--select", "I001", "--fix")
    return folder


def sides(hunk: str) -> tuple[str, str]:
    """The lines that a hunk finds, and those that it leaves."""
    lines = [(line[:1], line[1:] + "\n") for line in hunk.splitlines()]
    return tuple("".join(text for sign, text in lines if sign != gone) for gone in "+-")


def change(path: Path, hunks: list[tuple[str, str]]) -> None:
    """Put each hunk in the one place where its lines are; lines that follow none are imports."""
    text = path.read_text(encoding="utf-8")
    for before, after in hunks:
        place = before or re.search(r"^from .*\n", text.replace("from __future__", "from-future__"), re.MULTILINE)[0]
        assert before == "" or text.count(before) == 1, f"{path.name} has {text.count(before)} times\n{before}"
        text = text.replace(place, after if before else after + place, 1)
    path.write_text(text, encoding="utf-8")


def whole(module: str, hunks: list[tuple[str, str]]) -> str:
    """A new module: as the page shows it, or that of the package from outside of which the page shows some lines."""
    ((_, shown),) = hunks
    if module not in FILES:
        return shown
    text = (PACKAGE / f"{FILES[module]}.py").read_text(encoding="utf-8")
    lines = iter(text.splitlines())
    assert all(line in lines for line in shown.splitlines()), f"{FILES[module]}.py has not, in this order,\n{indent(shown, '    ')}"
    for inside, outside in FILES.items():
        text = text.replace(f"tapered_leaf.{outside} ", f"flexstage.{inside.replace('/', '.')} ")
    return text


def ruff(folder: Path, *words: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "ruff", *words, "--no-cache", "."], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def copy(tmp_path_factory) -> Path:
    return perform(tmp_path_factory.mktemp("copy"))


def test_recipes_keep_the_import_contracts(copy) -> None:
    done = lint(copy)
    assert done.returncode == 0, done.stdout + done.stderr


def test_every_module_that_a_recipe_shows_in_part_is_whole_elsewhere() -> None:
    shown = {path.removeprefix("src/flexstage/").removesuffix(".py") for path, _ in edits() if not (ROOT / path).exists()}
    assert shown == {*FILES, "apps/commands/sag"}


def test_recipes_keep_style(copy) -> None:
    ruff(copy, "check")
    ruff(copy, "format", "--check")


@pytest.mark.full
def test_recipes_keep_types(copy) -> None:
    shutil.copytree(ROOT / "typings", copy / "typings")
    (copy / ".venv").symlink_to(ROOT / ".venv")
    done = subprocess.run([sys.executable, "-m", "basedpyright"], cwd=copy, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout


@pytest.fixture
def work(tmp_path) -> Path:
    """Designs with the new kinds; they come from no package."""
    (tmp_path / "s.toml").write_text(re.sub(r"^packages = .*\n", "", design(), flags=re.MULTILINE))
    (tmp_path / "small.toml").write_text(SMALL)
    (tmp_path / "plain.toml").write_text(dumps(case("parallelogram")))
    pair = SMALL.replace('kind = "taper"', 'kind = "blade_pair"\ndistance = "50 mm"').replace('end_thickness = "3 mm"\n', "")
    link = 'pair = { joins = ["ground", "platform"], part = "leaf", at = ["0 mm", "27.5 mm", "0 mm"], along = "-y", bends = "z" }\n'
    (tmp_path / "pair.toml").write_text(pair[: pair.index("left = ")] + link)
    (tmp_path / "loop.toml").write_text(LOOP)
    (tmp_path / "a.log").write_text("LOG 100\nu1 S1\nV um\n1 2\n3 4\n")
    return tmp_path


FEATURES = {
    "hinge": ("check small.toml", "schema", f"verify small.toml {ROUGH}", f"calibrate small.toml -o calibrated.toml {ROUGH}"),
    "compound": ("check pair.toml", "modes pair.toml"),
    "gauge and measure": ("check s.toml", "analyse s.toml --report s.html --json s.json"),
    "command": ("sag plain.toml --json sag.json", "sag --help"),
    "controller and amplifier": ("loop plain.toml --setup loop.toml --json loop.json",),
}


@pytest.mark.full
@pytest.mark.parametrize("feature", FEATURES)
def test_recipes_give_the_feature(copy, work, feature) -> None:
    told = flexstage(work, *FEATURES[feature], path=copy / "src")
    if feature == "hinge":
        assert '"const": "taper"' in told
    elif feature == "compound":
        assert "2 x leaf" in told
    elif feature == "gauge and measure":
        assert "sag" in (work / "s.json").read_text()
    elif feature == "command":
        assert "Deflection of the platform under its loads." in told
        assert json.loads((work / "sag.json").read_text())["kind"] == "sag"
    else:
        assert "integrators in platform coordinates" in told


@pytest.mark.full
def test_the_recipe_of_a_record_format_reads_it(copy, work) -> None:
    ask = "import sys; from flexstage.experiment import read_record; print(read_record('a.log').values.tolist())"
    code = f"import sys; sys.path.insert(0, {str(copy / 'src')!r}); {ask}"
    done = subprocess.run([sys.executable, "-c", code], cwd=work, capture_output=True, text=True, check=True)
    assert done.stdout == "[[1.0, 2.0], [3.0, 4.0]]\n"
