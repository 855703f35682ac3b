"""Cures: what `flexstage doctor --mend` does about a finding."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TypeAlias

from flexstage.apps import quadmath
from flexstage.apps.pins import pins


@dataclass(frozen=True)
class Reinstall:
    """Install a package anew into the running environment: its tested version if that is known, else one of the `versions` that will do."""

    name: str
    versions: str = ""

    def __str__(self) -> str:
        return f"package {self.name}"


@dataclass(frozen=True)
class MakeFolder:
    """Make a folder, or make it writable."""

    path: Path

    def __str__(self) -> str:
        return f"folder {self.path}"


@dataclass(frozen=True)
class ProvideLibrary:
    """Give NGSolve the library its packages leave out, from the copy that numpy carries."""

    def __str__(self) -> str:
        return "libquadmath.so.0 beside NGSolve"


Cure: TypeAlias = Reinstall | MakeFolder | ProvideLibrary


@dataclass(frozen=True)
class Outcome:
    """What a cure came to: whether it `worked`, and `said`, the reason if it did not."""

    cure: Cure
    worked: bool
    said: str = ""


def carry_out(cure: Cure) -> Outcome:
    """Carry out one cure and say what it came to; a failure is an outcome, not an exception.

    >>> carry_out(MakeFolder(Path(tempfile.mkdtemp()) / "cache")).worked
    True
    """
    try:
        said = _carried_out(cure)
    except (OSError, subprocess.SubprocessError) as error:
        said = str(error)
    return Outcome(cure, not said, said)


def _carried_out(cure: Cure) -> str:
    match cure:
        case Reinstall():
            return _reinstall(cure) or quadmath.provide(sys.path)  # a package installed anew lacks the library anew
        case MakeFolder():
            return _make_folder(cure)
        case ProvideLibrary():
            return quadmath.provide(sys.path)


def _make_folder(cure: MakeFolder) -> str:
    cure.path.mkdir(parents=True, exist_ok=True)
    cure.path.chmod(cure.path.stat().st_mode | 0o700)
    return ""


def _reinstall(cure: Reinstall) -> str:
    if find_spec("pip") is None:
        subprocess.run([sys.executable, "-m", "ensurepip"], capture_output=True, check=True)
    pin = pins().get(cure.name)
    with tempfile.TemporaryDirectory() as folder:
        wanted = Path(folder) / "requirements.txt"
        wanted.write_text(f"{pin or cure.name + cure.versions}\n", encoding="utf-8")
        # A pin stands for one of a set that was resolved together: its own requirements have pins of their own.
        exact = ["--no-deps", "--require-hashes"] if pin else []
        command = [sys.executable, "-m", "pip", "install", "-q", "--disable-pip-version-check", "--no-input", "--force-reinstall"]
        done = subprocess.run([*command, *exact, "-r", str(wanted)], capture_output=True, text=True, check=False)
    errors = [line for line in done.stderr.splitlines() if line.startswith("ERROR")] or done.stderr.splitlines()[-1:]
    return "" if done.returncode == 0 else " ".join(errors) or f"pip ended with code {done.returncode}"
