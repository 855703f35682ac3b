"""The import contracts of pyproject.toml: they hold, they bite, and they name every reading there is."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.hygiene.source import ROOT, SRC, modules


def lint(root: Path) -> subprocess.CompletedProcess[str]:
    code = "import sys; from importlinter.cli import lint_imports_command; sys.exit(lint_imports_command())"
    command = [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(root / 'src')!r}); {code}", "--no-cache", "--no-logo"]
    return subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)


def contracts() -> list[dict[str, list[str]]]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]


def test_contracts_hold() -> None:
    done = lint(ROOT)
    assert done.returncode == 0, done.stdout + done.stderr


def planted(folder: Path, imports: dict[str, str]) -> Path:
    """A copy of the package in which each of the given files imports the module it should not."""
    shutil.copy(ROOT / "pyproject.toml", folder)
    shutil.copytree(SRC, folder / "src" / "flexstage", ignore=shutil.ignore_patterns("__pycache__"))
    for importer, imported in imports.items():
        for path in (importer, imported.removeprefix("flexstage.").replace(".", "/") + ".py"):
            target = folder / "src" / "flexstage" / path
            if not target.exists() and not target.with_suffix("").is_dir():
                target.write_text('"""Stands in for a module that is not there yet."""\n')
        path = folder / "src" / "flexstage" / importer
        path.write_text(f"{path.read_text()}\nimport {imported}\n")
    return folder


@pytest.mark.parametrize(
    ("importer", "imported"),
    [
        ("parts/material.py", "flexstage.mechanism.mechanism"),
        ("mechanism/mechanism.py", "flexstage.beams"),
        ("beams/__init__.py", "flexstage.mechanism.pattern"),
        ("readings/ideal.py", "flexstage.readings.lumped"),
        ("readings/lumped.py", "flexstage.readings.ideal"),
        ("readings/lumped.py", "flexstage.readings.mapped"),
        ("readings/mapped.py", "flexstage.readings.lumped"),
        ("readings/finite.py", "flexstage.readings.lumped"),
        ("readings/lumped.py", "flexstage.readings.solid.install"),
        ("readings/mapped.py", "flexstage.readings.solid.install"),
        ("readings/solid/install.py", "flexstage.readings.lumped"),
        ("readings/solid/install.py", "flexstage.readings.finite"),
        ("readings/solid/install.py", "flexstage.beams"),
        ("beams/leaf.py", "flexstage.readings.solid.install"),
        ("beams/leaf.py", "flexstage.readings.linear"),
        ("readings/measured/record.py", "flexstage.readings.ideal"),
        ("readings/linear/__init__.py", "flexstage.readings.lumped"),
        ("apps/cli/sweep.py", "flexstage.apps.cli.tolerance"),
        ("apps/cli/loop.py", "flexstage.apps.cli.commands"),
        ("present/command/answer.py", "flexstage.apps.cli.about"),
        ("present/command/progress.py", "flexstage.readings.solid.progress"),
    ],
)
def test_contracts_bite(tmp_path: Path, importer: str, imported: str) -> None:
    done = lint(planted(tmp_path, {importer: imported}))
    assert done.returncode == 1, done.stdout + done.stderr
    assert "BROKEN" in done.stdout


def test_contracts_bite_through_others(tmp_path: Path) -> None:
    chain = {"readings/solid/install.py": "flexstage.cases.stock", "cases/stock.py": "flexstage.beams.leaf"}
    done = lint(planted(tmp_path, chain))
    assert "nor beam theory the solid reading BROKEN" in done.stdout
    assert "Imports go down the floors only KEPT" in done.stdout


def test_every_reading_has_its_contract() -> None:
    here = {path.relative_to(SRC / "readings").parts[0].removesuffix(".py") for path in modules() if SRC / "readings" in path.parents}
    layers = next(each["layers"] for each in contracts() if each.get("containers") == ["flexstage.readings"])
    named = {name for layer in layers for name in layer.replace("|", " ").replace("(", " ").replace(")", " ").split()}
    assert here - {"__init__"} <= named
