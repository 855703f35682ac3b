"""Tracked files say nothing of the machine they were made on, hold no unfinished marks, and reach the wheel."""

from __future__ import annotations

import re
import subprocess
import sys
import venv
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.hygiene.source import ROOT, SRC, expect_none, modules, tracked

# Put together from pieces, so that this file does not find itself.
ABSOLUTE = re.compile(r"(?<![\w./-])/(?:work|root|farm|home|Users|opt)/\w|\b[A-Z]:\\" + r"Users\\")
UNFINISHED = re.compile(r"\b(?:TO" + r"DO|FIX" + r"ME|XX" + r"X)\b|^(?:<{7}|>{7}) |\bbreak" + r"point\(\)", re.MULTILINE)
INDEX_LINE = re.compile(r"://|^\s*(?:-i|-f|--index-url|--extra-index-url|--find-links|--trusted-host)\b", re.MULTILINE)


def texts() -> Iterator[tuple[str, str]]:
    for path in tracked():
        try:
            yield str(path.relative_to(ROOT)), path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # a picture or a record


def registry_hosts() -> set[str]:
    """Hosts of the package registry, asked of pip: they are not written here. The public registry's own name is no secret."""
    done = subprocess.run([sys.executable, "-m", "pip", "config", "list"], capture_output=True, text=True, check=False)
    hosts = re.findall(r"[a-z+]+://(?:[^/@'\s]*@)?([^/:'\s]+)", done.stdout)
    return {host for host in hosts if "." in host} - {"pypi.org"}


def test_no_absolute_paths() -> None:
    expect_none((f"{name}: {found[0]}" for name, text in texts() if (found := ABSOLUTE.search(text))), "make the path relative")


def test_no_registry_hosts() -> None:
    hosts = registry_hosts()
    expect_none((f"{name}: {host}" for name, text in texts() for host in hosts if host in text), "remove the host")


def test_locks_name_no_index_and_pin_by_hash() -> None:
    locks = [(name, text) for name, text in texts() if name.startswith("requirements/") and name.endswith(".txt")]
    assert {name for name, _ in locks} >= {"requirements/dev.txt", "requirements/runtime.txt"}
    for name, text in locks:
        assert not INDEX_LINE.search(text), name
        pins = re.split(r"\n(?=\S)", text.strip())
        expect_none((f"{name}: {pin.splitlines()[0]}" for pin in pins if "==" not in pin or "--hash=sha256:" not in pin), "make lock")


def test_nothing_unfinished() -> None:
    expect_none((f"{name}: {found[0]}" for name, text in texts() if (found := UNFINISHED.search(text))), "finish it, or file an issue")


def test_every_folder_of_modules_is_a_package() -> None:
    # Without __init__.py pytest and import-linter take the modules for others of the same name.
    folders = {path.parent for path in modules()}
    expect_none((str(folder.relative_to(ROOT)) for folder in folders if not (folder / "__init__.py").exists()), "add __init__.py")


def test_no_file_is_large() -> None:
    large = (f"{path.relative_to(ROOT)}: {size} bytes" for path in tracked() if (size := path.stat().st_size) > 1_000_000)
    expect_none(large, "keep data small, or make it when it is needed")


def build_wheel(folder: Path) -> Path:
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, capture_output=True, check=True)
    (wheel,) = folder.glob("*.whl")
    return wheel


def test_the_wheel_holds_the_whole_package(tmp_path: Path) -> None:
    # Files that git ignores are left out of a wheel silently, unless pyproject.toml lists them as artifacts.
    wheel = build_wheel(tmp_path)
    packed = set(zipfile.ZipFile(wheel).namelist())
    here = {path.relative_to(SRC.parent).as_posix() for path in SRC.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
    expect_none(here - packed, "list it under [tool.hatch.build] artifacts")


@pytest.mark.full
def test_the_wheel_works_in_a_fresh_environment(tmp_path: Path) -> None:
    """Installed with what it requires from the package index; its small twin is the comparison of the wheel with the source."""
    wheel, folder = build_wheel(tmp_path), tmp_path / "fresh"
    venv.create(folder, with_pip=True)
    scripts = folder / ("Scripts" if sys.platform == "win32" else "bin")
    for command in (
        ["python", "-m", "pip", "install", "-q", str(wheel)],
        ["flexstage", "--version"],
        ["flexstage", "new", "stage.toml"],
        ["flexstage", "check", "stage.toml"],
        ["flexstage", "analyse", "stage.toml", "--report", "stage.html"],
    ):
        done = subprocess.run([scripts / command[0], *command[1:]], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
    assert (tmp_path / "stage.html").stat().st_size > 100_000
