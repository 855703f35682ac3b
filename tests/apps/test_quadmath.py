"""The library NGSolve's wheels leave out: put where it is wanted, once, whole, and found there by the loader before any other."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from flexstage.apps import doctor
from flexstage.apps.doctor import Verdict, examine_package
from flexstage.apps.quadmath import COMMAND, missing_place, provide

NEED = Requirement("ngsolve; extra == 'solid'")


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """A `site-packages` folder with what matters of numpy's and NGSolve's packages."""
    for folder in ("numpy.libs", "ngsolve_openblas"):
        (tmp_path / folder).mkdir()
    (tmp_path / "numpy.libs" / "libquadmath-0123.so.0.0.0").write_bytes(b"the library")
    (tmp_path / "ngsolve_openblas" / "libgfortran.so.5.0.0").write_bytes(b"\x7fELF libquadmath.so.0\0 libm.so.6\0")
    return tmp_path


def beside(site: Path) -> Path:
    return site / "ngsolve_openblas" / "libquadmath.so.0"


def test_the_library_is_put_where_it_is_wanted(site: Path) -> None:
    assert missing_place([site]) == beside(site)
    assert provide([site]) == ""
    assert beside(site).read_bytes() == b"the library"
    assert missing_place([site]) is None


def test_providing_twice_changes_nothing(site: Path) -> None:
    provide([site])
    beside(site).write_bytes(b"kept")
    assert provide([site]) == ""
    assert beside(site).read_bytes() == b"kept"
    assert len(list(beside(site).parent.iterdir())) == 2


def test_numpy_may_be_in_another_folder(site: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (site / "numpy.libs").rename(elsewhere / "numpy.libs")
    assert provide([site, elsewhere]) == ""
    assert beside(site).exists()


def test_libraries_that_do_not_want_it_get_nothing(site: Path) -> None:
    (site / "ngsolve_openblas" / "libgfortran.so.5.0.0").write_bytes(b"\x7fELF libm.so.6\0")
    assert provide([site]) == ""
    assert not beside(site).exists()


def test_no_copy_to_take(site: Path) -> None:
    (site / "numpy.libs" / "libquadmath-0123.so.0.0.0").unlink()
    assert "apt-get install libquadmath0" in provide([site])


def test_a_folder_that_cannot_be_written(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("flexstage.apps.quadmath.shutil.copyfile", refuse)
    assert provide([site]).endswith("Permission denied")
    assert [path.name for path in beside(site).parent.iterdir()] == ["libgfortran.so.5.0.0"]  # nothing half-made is left


def test_the_doctor_names_the_command(site: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [str(site), *sys.path[1:]])
    monkeypatch.setattr(doctor, "_import_error", lambda _: "" if beside(site).exists() else "ImportError: libquadmath.so.0")
    broken = examine_package(NEED)
    assert broken is not None
    assert (broken.verdict, COMMAND in broken.remedy) == (Verdict.BAD, True)
    subprocess.run([sys.executable, *COMMAND.split()[1:]], env={**os.environ, "PYTHONPATH": str(site)}, check=True)
    mended = examine_package(NEED)
    assert mended is not None
    assert mended.verdict is Verdict.GOOD


def test_another_reason_not_to_import_has_another_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor, "_import_error", lambda _: "ImportError: libc.so.6: version not found")
    row = examine_package(NEED)
    assert row is not None
    assert "pip install" in row.remedy


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads what the Linux loader has mapped")
def test_the_loader_finds_the_copy_before_any_other() -> None:
    # So it matters not whether this machine has a library of its own.
    specification = find_spec("ngsolve_openblas")
    assert specification is not None
    folder = Path(str(specification.origin)).parent
    (library,) = folder.glob("libgfortran.so*")
    code = f"import ctypes; ctypes.CDLL({str(library)!r}); print(open('/proc/self/maps').read())"
    mapped = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    found = {line.split(maxsplit=5)[-1] for line in mapped.splitlines() if "quadmath" in line}  # the path last: it may hold spaces
    assert found == {str((folder / "libquadmath.so.0").resolve())}
