"""The doctor: every kind of damage gives its row, cures work on what can be cured, and nothing it meets makes it stumble."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import flexstage
from flexstage.apps import cure, doctor
from flexstage.apps.cure import MakeFolder, Reinstall
from flexstage.apps.doctor import Row, Verdict, examine, examine_package, mend, writable
from flexstage.apps.installed import packages
from flexstage.apps.pins import Need, needs, needs_of, parsed_pins, pins
from flexstage.base.native import compiler


def distribution(folder: Path, code: str = "value = 1\n", version: str = "1.0") -> Path:
    """A package `sample` as pip would leave it in `folder`; returns its module."""
    module = folder / "sample.py"
    module.write_text(code)
    information = folder / f"sample-{version}.dist-info"
    information.mkdir()
    (information / "METADATA").write_text(f"Metadata-Version: 2.1\nName: sample\nVersion: {version}\n")
    (information / "RECORD").write_text(
        f"sample.py,,{len(code)}\nsample-{version}.dist-info/METADATA,,\nsample-{version}.dist-info/RECORD,,\n"
    )
    return module


def wheel(folder: Path) -> str:
    """A wheel of `sample` in `folder`; returns its pin."""
    path = folder / "sample-1.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("sample.py", "value = 1\n")
        archive.writestr("sample-1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: sample\nVersion: 1.0\n")
        archive.writestr("sample-1.0.dist-info/WHEEL", "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        archive.writestr("sample-1.0.dist-info/RECORD", "sample.py,,\nsample-1.0.dist-info/METADATA,,\nsample-1.0.dist-info/WHEEL,,\n")
    return f"sample==1.0 \\\n    --hash=sha256:{hashlib.sha256(path.read_bytes()).hexdigest()}"


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder on the path of this process and of those it starts."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setenv("PYTHONPATH", str(folder))
    return folder


PASSED = Row("self-test", "equal", "equal", Verdict.GOOD)


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> tuple[Row, ...]:
    """This environment, examined once: every package is imported in a process of its own."""
    return examine(tmp_path_factory.mktemp("results"), lambda: PASSED)


def test_this_environment_is_sound(rows: tuple[Row, ...]) -> None:
    assert [row for row in rows if row.verdict is Verdict.BAD and row.what != "cache of figures"] == []
    assert {need.name for need in needs()} < {row.what for row in rows}


def test_versions_are_those_of_the_metadata(rows: tuple[Row, ...]) -> None:
    found = {row.what: row for row in rows}
    assert found["Python"].wanted == ">=3.11"
    assert found["flexstage"].found == flexstage.__version__


def test_missing_package() -> None:
    row = examine_package(Need("no-such-package", ">=1.0", ""))
    assert (row.found, row.verdict, row.cure) == ("missing", Verdict.BAD, Reinstall("no-such-package", ">=1.0"))
    assert "pip install" in row.remedy


def test_missing_extra_is_only_noted() -> None:
    row = examine_package(Need("no-such-package", ">=1.0", "tables"))
    assert row.verdict is Verdict.NOTE
    assert "flexstage[tables]" in row.remedy
    assert mend([row]) == ()


def test_what_an_extra_left_out_needs_in_turn_is_not_missed(site: Path) -> None:
    # Neither is installed: the extra's package is noted, and what that would need is nobody's need.
    distribution(site)
    assert list(needs_of([Need("no-such-package", "", "solid"), Need("sample", "", "")])) == []


def test_what_an_installed_package_needs_in_turn_is_found(site: Path) -> None:
    distribution(site)
    with (site / "sample-1.0.dist-info" / "METADATA").open("a") as metadata:
        metadata.write("Requires-Dist: no-such-package>=2\nRequires-Dist: another; extra == 'more'\n")
    assert list(needs_of([Need("sample", "", "")])) == [Need("no-such-package", ">=2", "")]


def test_whole_package(site: Path) -> None:
    distribution(site)
    assert examine_package(Need("sample", ">=1.0", "")) == Row("sample", "1.0", ">=1.0", Verdict.GOOD)


def test_version_out_of_range(site: Path) -> None:
    distribution(site)
    row = examine_package(Need("sample", ">=2.0", ""))
    assert (row.found, row.wanted, row.verdict, row.cure) == ("1.0", ">=2.0", Verdict.BAD, Reinstall("sample", ">=2.0"))


@pytest.mark.parametrize("content", [None, "", "value = 1000\n"])
def test_lost_and_changed_files(site: Path, content: str | None) -> None:
    module = distribution(site)
    module.unlink()
    if content is not None:
        module.write_text(content)
    assert packages([site])["sample"].lost == 1
    row = examine_package(Need("sample", ">=1.0", ""))
    assert (row.found, row.verdict) == ("1.0, 1 files lost", Verdict.BAD)


def test_package_without_record(site: Path) -> None:
    distribution(site)
    (site / "sample-1.0.dist-info" / "RECORD").unlink()
    assert packages([site])["sample"].lost == 1


def test_half_removed_package(site: Path) -> None:
    (site / "sample-1.0.dist-info").mkdir()
    assert packages([site]) == {}
    assert examine_package(Need("sample", ">=1.0", "")).found == "missing"


@pytest.mark.parametrize(
    ("code", "said"),
    [("raise ImportError('no libquadmath')\n", "ImportError: no libquadmath"), ("import os; os.abort()\n", "ended by signal 6")],
)
def test_package_that_does_not_import(site: Path, code: str, said: str) -> None:
    distribution(site, code)
    row = examine_package(Need("sample", ">=1.0", ""))
    assert row.verdict is Verdict.BAD
    assert said in row.found


def test_unwritable_folder(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.touch()
    row = writable("current folder", file)
    assert row.verdict is Verdict.BAD
    assert str(file) in row.found
    assert row.remedy


def test_cache_folder_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLCONFIGDIR", str(tmp_path / "new" / "cache"))
    broken = doctor._cache()
    assert broken.verdict is Verdict.BAD
    (outcome,) = mend([broken])
    assert outcome.worked
    assert doctor._cache().verdict is Verdict.GOOD


def test_cache_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    outcome = cure.carry_out(MakeFolder(tmp_path / "file" / "cache"))
    assert not outcome.worked
    assert outcome.said


def test_pinned_package_is_installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pin = wheel(tmp_path)
    monkeypatch.setattr(cure, "pins", lambda: {"sample": pin})
    for name, value in {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(tmp_path), "PIP_TARGET": str(tmp_path / "site")}.items():
        monkeypatch.setenv(name, value)
    assert cure.carry_out(Reinstall("sample", ">=1.0")).said == ""
    assert packages([tmp_path / "site"])["sample"].lost == 0


def test_package_with_another_hash_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    wheel(tmp_path)
    monkeypatch.setattr(cure, "pins", lambda: {"sample": f"sample==1.0 --hash=sha256:{'0' * 64}"})
    for name, value in {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(tmp_path), "PIP_TARGET": str(tmp_path / "site")}.items():
        monkeypatch.setenv(name, value)
    outcome = cure.carry_out(Reinstall("sample", ">=1.0"))
    assert not outcome.worked
    assert "HASHES" in outcome.said
    assert not (tmp_path / "site").exists()


def test_every_need_is_pinned_within_its_range() -> None:
    listed = pins()
    for need in needs("solid", "tables"):
        version = listed[need.name].split("==")[1].split()[0]
        assert need.admits(version), need


def test_pins_of_other_interpreters_are_left_out() -> None:
    text = "a==1 ; python_version < '3.0' \\\n    --hash=sha256:00\na==2 ; python_version >= '3.0' \\\n    --hash=sha256:11\n# end\n"
    assert parsed_pins(text) == {"a": "a==2 ; python_version >= '3.0' \\\n    --hash=sha256:11"}


def test_self_test_has_its_row(rows: tuple[Row, ...]) -> None:
    assert rows[-1] == PASSED


def test_failing_self_test_is_a_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_packages", tuple)

    def broken() -> Row:
        raise ZeroDivisionError("no stiffness")

    row = examine(tmp_path, broken)[-1]
    assert (row.verdict, row.found) == (Verdict.BAD, "ZeroDivisionError: no stiffness")


def test_bare_interpreter_gives_a_row(tmp_path: Path) -> None:
    # Without site-packages there is neither packaging nor pip.
    source = Path(flexstage.__file__).parents[1]
    code = f"import sys; sys.path.insert(0, {str(source)!r}); from flexstage.apps.doctor import *; print(*examine(Path('.')), sep='\\n')"
    done = subprocess.run([sys.executable, "-I", "-S", "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert "ensurepip" in done.stdout


@pytest.mark.skipif(not hasattr(os, "geteuid"), reason="files have no owners here")
def test_the_folder_of_compiled_code_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FLEXSTAGE_CACHE", str(tmp_path / "cache"))
    if compiler() is None:
        pytest.skip("no compiler of C")
    (row,) = doctor.native_code()
    assert (row.verdict, row.found) == (doctor.Verdict.GOOD, f"kept in {tmp_path / 'cache' / 'native'}")
    (tmp_path / "cache").chmod(0o777)
    (row,) = doctor.native_code()
    assert row.verdict is doctor.Verdict.NOTE
    assert "others may write to" in row.found
    monkeypatch.setenv("CC", "no-such-compiler")
    (row,) = doctor.native_code()
    assert row.found == "no compiler of C"
