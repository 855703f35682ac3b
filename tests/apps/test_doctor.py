"""The doctor: every kind of damage gives its row with the command that mends it, and nothing it meets makes it stumble."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement

import flexstage
from flexstage.apps import doctor
from flexstage.apps.doctor import Row, Verdict, examine, examine_folder, examine_package
from flexstage.control.export.compiler import find_compiler
from tests.conftest import FULL


def distribution(folder: Path, code: str = "value = 1\n") -> None:
    """A package `sample` as pip would leave it in `folder`."""
    (folder / "sample.py").write_text(code)
    information = folder / "sample-1.0.dist-info"
    information.mkdir()
    (information / "METADATA").write_text("Metadata-Version: 2.1\nName: sample\nVersion: 1.0\n")


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder on the path of this process and of those it starts."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder))
    return folder


def examined(text: str) -> Row:
    row = examine_package(Requirement(text))
    assert row is not None
    return row


PASSED = Row("self-test", "equal", "equal", Verdict.GOOD)


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> tuple[Row, ...]:
    """This environment, examined once: packages are imported in processes of their own, all of them in the full tests."""
    imported = doctor._import_error
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(doctor, "_import_error", lambda module: imported(module) if FULL or module in {"numpy", "ngsolve"} else "")
        return examine(tmp_path_factory.mktemp("results"), lambda: PASSED)


def test_this_environment_is_sound(rows: tuple[Row, ...]) -> None:
    assert [row for row in rows if row.verdict is Verdict.BAD] == []
    assert {"numpy", "typer", "ngsolve", "pandas"} < {row.what for row in rows}


def test_versions_are_those_of_the_metadata(rows: tuple[Row, ...]) -> None:
    found = {row.what: row for row in rows}
    assert found["Python"].wanted == ">=3.11"
    assert found["flexstage"].found == flexstage.__version__


def test_missing_package() -> None:
    row = examined("no-such-package>=1.0")
    assert (row.found, row.verdict, row.remedy) == ("missing", Verdict.BAD, "pip install 'no-such-package>=1.0'")


def test_missing_extra_is_only_noted() -> None:
    row = examined("no-such-package>=1.0; extra == 'tables'")
    assert (row.verdict, row.remedy) == (Verdict.NOTE, "pip install 'flexstage[tables]'")


def test_what_other_extras_and_interpreters_need_has_no_row() -> None:
    for marker in ("extra == 'docs'", "python_version < '3.0'"):
        assert examine_package(Requirement(f"no-such-package; {marker}")) is None


def test_whole_package(site: Path) -> None:
    distribution(site)
    assert examined("sample>=1.0") == Row("sample", "1.0", ">=1.0", Verdict.GOOD)


def test_version_out_of_range(site: Path) -> None:
    distribution(site)
    row = examined("sample>=2.0")
    assert (row.found, row.wanted, row.verdict) == ("1.0", ">=2.0", Verdict.BAD)
    assert row.remedy == "pip install --force-reinstall 'sample>=2.0'"


@pytest.mark.parametrize(
    ("code", "said"),
    [("raise ImportError('no libquadmath')\n", "ImportError: no libquadmath"), ("import os; os.abort()\n", "ended by signal 6")],
)
def test_package_that_does_not_import(site: Path, code: str, said: str) -> None:
    distribution(site, code)
    row = examined("sample>=1.0")
    assert row.verdict is Verdict.BAD
    assert said in row.found


def test_unwritable_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "file"
    file.touch()
    row = examine_folder("current folder", file)
    assert row.verdict is Verdict.BAD
    assert str(file) in row.found
    assert row.remedy
    monkeypatch.setenv("MPLCONFIGDIR", str(file))
    assert doctor._figure_cache().verdict is Verdict.NOTE  # figures are drawn all the same


def test_self_test_has_its_row(rows: tuple[Row, ...]) -> None:
    assert rows[-1] == PASSED


def test_failing_self_test_is_a_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_examine_installed", tuple)

    def broken() -> Row:
        raise ZeroDivisionError("no stiffness")

    row = examine(tmp_path, broken)[-1]
    assert (row.verdict, row.found) == (Verdict.BAD, "ZeroDivisionError: no stiffness")


def test_bare_interpreter_gives_a_row(tmp_path: Path) -> None:
    # Without site-packages there is no packaging.
    source = Path(flexstage.__file__).parents[1]
    code = f"import sys; sys.path.insert(0, {str(source)!r}); from flexstage.apps.doctor import *; print(*examine(Path('.')), sep='\\n')"
    done = subprocess.run([sys.executable, "-I", "-S", "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert "pip install packaging" in done.stdout


def test_kernels_that_do_not_load_are_a_note(monkeypatch: pytest.MonkeyPatch) -> None:
    (row,) = doctor.native_code()
    assert row.verdict is doctor.Verdict.GOOD or not find_compiler()
    monkeypatch.setenv("FLEXSTAGE_KERNEL", "off")
    (row,) = doctor.native_code()
    assert (row.verdict, row.found) == (doctor.Verdict.NOTE, "off (FLEXSTAGE_KERNEL)")
    monkeypatch.setenv("FLEXSTAGE_KERNEL", "wide")
    (row,) = doctor.native_code()
    assert row.verdict is doctor.Verdict.NOTE
    assert "unsupported value (got wide" in row.found
