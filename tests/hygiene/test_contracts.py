"""The import contracts of pyproject.toml: they hold, they bite, and they name every model there is."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

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


def planted(folder: Path, imports: list[tuple[str, str]]) -> Path:
    """A copy of the package in which each of the given files imports the module it should not."""
    shutil.copy(ROOT / "pyproject.toml", folder)
    shutil.copytree(SRC, folder / "src" / "flexstage", ignore=shutil.ignore_patterns("__pycache__"))
    for importer, imported in imports:
        for path in (importer, imported.removeprefix("flexstage.").replace(".", "/") + ".py"):
            target = folder / "src" / "flexstage" / path
            if not target.exists() and not target.with_suffix("").is_dir():
                target.write_text('"""Stands in for a module that is not there yet."""\n')
        path = folder / "src" / "flexstage" / importer
        path.write_text(f"{path.read_text()}\nimport {imported}\n")
    return folder


FORBIDDEN = [
    ("parts/material.py", "flexstage.mechanism.mechanism"),
    ("mechanism/mechanism.py", "flexstage.beams"),
    ("beams/__init__.py", "flexstage.mechanism.assembly.pattern"),
    ("beams/leaf.py", "flexstage.solid.fea.jobs.install"),
    ("beams/leaf.py", "flexstage.models.linear"),
    ("models/ideal.py", "flexstage.models.lumped"),
    ("models/lumped.py", "flexstage.models.ideal"),
    ("models/lumped.py", "flexstage.models.mapped"),
    ("models/mapped.py", "flexstage.models.lumped"),
    ("models/finite.py", "flexstage.models.lumped"),
    ("models/lumped.py", "flexstage.solid.fea.jobs.install"),
    ("models/flexible_bodies.py", "flexstage.models.lumped"),
    ("models/flexible_bodies.py", "flexstage.solid.fea.jobs.install"),
    ("solid/fea/jobs/install.py", "flexstage.models.flexible_bodies"),
    ("models/mapped.py", "flexstage.solid.fea.jobs.install"),
    ("models/linear/__init__.py", "flexstage.models.lumped"),
    ("analysis/linear_statics/statics.py", "flexstage.show.table"),
    ("show/table.py", "flexstage.solid.results.verification"),
    ("solid/fea/jobs/install.py", "flexstage.models.lumped"),
    ("solid/fea/jobs/install.py", "flexstage.models.finite"),
    ("solid/fea/jobs/install.py", "flexstage.beams"),
    ("solid/results/verification.py", "flexstage.experiment.comparison"),
    ("experiment/records/record.py", "flexstage.models.ideal"),
    ("experiment/identification/lscf.py", "flexstage.models.lumped"),
    ("experiment/comparison.py", "flexstage.solid.results.modes"),
    ("experiment/comparison.py", "flexstage.control.plant_models.plants"),
    ("control/plant_models/plants.py", "flexstage.solid.fea.jobs.install"),
    ("control/plant_models/plants.py", "flexstage.experiment.comparison"),
    ("studies/sweeps/execution/run.py", "flexstage.solid.fea.jobs.install"),
    ("studies/sweeps/execution/run.py", "flexstage.control.plant_models.plants"),
    ("apps/commands/analyse.py", "flexstage.apps.commands.describe"),
    ("apps/commands/analyse.py", "flexstage.apps.cli.commands"),
    ("studies/commands/sweep.py", "flexstage.studies.commands.tolerance"),
    ("studies/sweeps/execution/run.py", "flexstage.studies.commands.sweep"),
    ("control/commands/loop.py", "flexstage.apps.cli.commands"),
    ("experiment/commands/compare.py", "flexstage.solid.commands.modes"),
    ("show/command/answer.py", "flexstage.apps.commands.about"),
    ("show/command/progress.py", "flexstage.solid.results.modes"),
]


def test_contracts_bite(tmp_path: Path) -> None:
    """Every import planted is told with its line, all of them in one run."""
    done = lint(planted(tmp_path, FORBIDDEN))
    told = " ".join(done.stdout.split())
    assert done.returncode == 1, done.stdout + done.stderr
    for importer, imported in FORBIDDEN:
        module = "flexstage." + importer.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        assert re.search(rf"{re.escape(module)} -> {re.escape(imported)} \(l", told), f"{module} may import {imported}\n{done.stdout}"


def test_contracts_bite_through_others(tmp_path: Path) -> None:
    chain = [("solid/fea/jobs/install.py", "flexstage.cases.case"), ("cases/case.py", "flexstage.beams.leaf")]
    done = lint(planted(tmp_path, chain))
    assert "Finite elements reach neither beam theory nor its models BROKEN" in done.stdout
    assert "Imports go down the floors only KEPT" in done.stdout


def test_every_model_has_its_contract() -> None:
    here = {path.relative_to(SRC / "models").parts[0].removesuffix(".py") for path in modules() if SRC / "models" in path.parents}
    layers = next(each["layers"] for each in contracts() if each.get("containers") == ["flexstage.models"])
    named = {name for layer in layers for name in layer.replace("|", " ").replace("(", " ").replace(")", " ").split()}
    assert here - {"__init__"} <= named
