"""What is told when the solver of the solid model is missing, of another version, or does not load."""

from __future__ import annotations

import tomllib
from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from flexstage.base.finding import DesignError
from flexstage.solid.fea.jobs import install
from flexstage.solid.fea.jobs.install import SOLVER_VERSION, require_solver, solver_findings
from flexstage.solid.fea.jobs.parts import Ways, reduce_parts
from flexstage.solid.fea.meshing.bar import bar
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from tests.hygiene.source import ROOT


def missing(name: str) -> str:
    raise PackageNotFoundError(name)


def unloadable(name: str) -> None:
    raise ImportError(f"libquadmath.so.0: cannot open shared object file ({name})")


def test_the_version_is_the_one_that_is_installed_with_flexstage() -> None:
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    assert any(need.startswith(f"ngsolve=={SOLVER_VERSION};") for need in extras["solid"])
    for name in ("runtime", "dev"):
        assert f"ngsolve=={SOLVER_VERSION} " in (ROOT / "requirements" / f"{name}.txt").read_text()


def test_missing_packages_are_all_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(install, "version", missing)
    with pytest.raises(DesignError, match=r"flexstage\[solid\]") as told:
        require_solver()
    assert [finding.where.split()[-1] for finding in told.value.findings] == ["ngsolve", "netgen-mesher"]


def test_another_version_is_named_with_the_wanted_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(install, "version", lambda _: "6.2.2405")
    assert {finding.what for finding in solver_findings()} == {f"is version 6.2.2405, not {SOLVER_VERSION}"}


def test_a_missing_library_leads_to_the_doctor(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(install, "import_module", unloadable)
    (finding,) = solver_findings()
    assert "libquadmath.so.0" in finding.what
    assert "flexstage doctor" in finding.advice


@pytest.mark.parametrize("error", ["ImportError", "OSError"])
def test_what_does_not_load_in_a_process_of_its_own_leads_to_the_doctor(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: str
) -> None:
    (tmp_path / "ngsolve.py").write_text(f"raise {error}('libquadmath.so.0: cannot open shared object file')")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(DesignError) as told:
        reduce_parts((bar(),), Reduction(Fineness(order=2)), Ways(cache=None))
    (finding,) = told.value.findings
    assert "libquadmath.so.0" in finding.what
    assert "flexstage doctor" in finding.advice
