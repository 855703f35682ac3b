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
        ("readings/solid.py", "flexstage.readings.lumped"),
        ("readings/solid.py", "flexstage.beams"),
        ("readings/measured.py", "flexstage.readings.ideal"),
        ("readings/linear/__init__.py", "flexstage.readings.lumped"),
    ],
)
def test_contracts_bite(tmp_path: Path, importer: str, imported: str) -> None:
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    shutil.copytree(SRC, tmp_path / "src" / "flexstage", ignore=shutil.ignore_patterns("__pycache__"))
    for path in (importer, imported.removeprefix("flexstage.").replace(".", "/") + ".py"):
        target = tmp_path / "src" / "flexstage" / path
        if not target.exists() and not target.with_suffix("").is_dir():
            target.write_text('"""Stands in for a module that is not there yet."""\n')
    path = tmp_path / "src" / "flexstage" / importer
    path.write_text(f"{path.read_text()}\nimport {imported}\n")
    done = lint(tmp_path)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "BROKEN" in done.stdout


def test_every_reading_has_its_contract() -> None:
    here = {path.relative_to(SRC / "readings").parts[0].removesuffix(".py") for path in modules() if SRC / "readings" in path.parents}
    layers = next(each["layers"] for each in contracts() if each.get("containers") == ["flexstage.readings"])
    named = {name for layer in layers for name in layer.replace("|", " ").replace("(", " ").replace(")", " ").split()}
    assert here - {"__init__"} <= named
