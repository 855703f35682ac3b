"""Bring .venv to the state the lock files ask for: `python tools/setup.py runtime|dev|oracles`.

Run by the Makefile with any Python 3.11 or newer; standard library only. A stamp within .venv says what was installed, so that a second run
only looks whether it is there. Whatever is broken (half-made, moved, packages gone) is made anew rather than repaired.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "src"))
sys.dont_write_bytecode = True

from flexstage.apps import quadmath  # noqa: E402

VENV = ROOT / ".venv"
PYTHON = VENV / "bin" / "python"
COMMAND = VENV / "bin" / "flexstage"
LOCKS = {"runtime": ("runtime",), "dev": ("dev",), "oracles": ("dev", "oracles")}
"""The lock files that are installed, in this order; a later one pins nothing otherwise than an earlier one."""
COVERS = {"runtime": ("runtime",), "dev": ("dev", "runtime"), "oracles": ("oracles", "dev", "runtime")}
"""What an installation also satisfies."""


def main(wanted: str) -> int:
    """Set up what is `wanted`; return the exit code."""
    with (ROOT / "pyproject.toml").open() as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # two makes at a time take turns
        if is_current(wanted):
            quadmath.provide(site_packages())  # no package's file, so that no package misses it
            return 0
        try:
            set_up(wanted)
        except (subprocess.CalledProcessError, OSError) as error:
            print(f"Setting up .venv failed ({error}). Mend the cause told above and run the same command again.", file=sys.stderr)
            return 1
    return 0


def set_up(wanted: str) -> None:
    """Make .venv if it is not usable, and install the locked packages and flexstage itself."""
    if not is_usable():
        print("Setting up .venv (a minute or two, once) ...", flush=True)
        make_venv()
    for stamp in VENV.glob("*.stamp"):
        stamp.unlink()
    for lock in LOCKS[wanted]:
        print(f"Installing the packages of requirements/{lock}.txt ...", flush=True)
        pip("--require-hashes", "-r", str(ROOT / "requirements" / f"{lock}.txt"))
    pip("--no-deps", "--no-build-isolation", "-e", str(ROOT))
    if said := quadmath.provide(site_packages()):
        print(f"NGSolve, the solver of the solid model, may not load: {said}. Everything else works.", file=sys.stderr)
    present = sorted(installed())
    for covered in COVERS[wanted]:
        stamp_path(covered).write_text(json.dumps({"digest": digest(covered), "root": str(ROOT), "installed": present}, indent=1))


def make_venv() -> None:
    """Create .venv from nothing."""
    if VENV.is_symlink() or VENV.is_file():
        VENV.unlink()
    elif VENV.exists():
        shutil.rmtree(VENV)
    done = subprocess.run([sys.executable, "-m", "venv", str(VENV)], check=False, env=clean_environment())
    if done.returncode:
        raise OSError("this Python cannot make virtual environments (on Debian: apt-get install python3-venv)")


def pip(*arguments: str) -> None:
    """Run pip within .venv, quiet unless it fails. Python translates modules when they are first used: all of them would take long."""
    command = [str(PYTHON), "-m", "pip", "install", "-qq", "--disable-pip-version-check", "--no-input", "--no-compile", *arguments]
    subprocess.run(command, check=True, cwd=ROOT, env=clean_environment())


def clean_environment() -> dict[str, str]:
    """The environment without what would lead Python or pip astray; the settings of the registry stay."""
    astray = {"PYTHONPATH", "PYTHONHOME", "PIP_USER", "PIP_TARGET", "PIP_PREFIX", "VIRTUAL_ENV", "__PYVENV_LAUNCHER__"}
    return {name: value for name, value in os.environ.items() if name not in astray} | {"PYTHONNOUSERSITE": "1"}


def is_current(wanted: str) -> bool:
    """Whether .venv holds what `wanted` asks for."""
    stamp = read_stamp(stamp_path(wanted))
    return stamp.get("digest") == digest(wanted) and COMMAND.exists() and is_usable()


def is_usable() -> bool:
    """Whether .venv was once completed here (its scripts name their place) and still runs with its packages."""
    stamps = [read_stamp(path) for path in VENV.glob("*.stamp")]
    if not stamps or any(stamp.get("root") != str(ROOT) for stamp in stamps) or not interpreter_runs():
        return False
    present = installed()
    return all(present.issuperset(stamp.get("installed", ["nothing"])) for stamp in stamps)


def installed() -> set[str]:
    """What installers left in .venv for each package and version."""
    return {record.name for folder in site_packages() for record in folder.glob("*.dist-info")}


def site_packages() -> list[Path]:
    """Where .venv keeps its packages."""
    return list(VENV.glob("lib/python3*/site-packages"))


def interpreter_runs() -> bool:
    """Whether .venv's Python starts, is the version it was made for, and is new enough."""
    code = "import sys, pip; print(sys.prefix, *sys.version_info[:2])"
    try:
        done = subprocess.run([str(PYTHON), "-c", code], capture_output=True, text=True, check=False, timeout=60, env=clean_environment())
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.stdout.split() == [str(VENV), *map(str, sys.version_info[:2])]


def digest(wanted: str) -> str:
    """What .venv depends on: the lock files, the package's metadata and version, its kernels, how they are built, and the interpreter."""
    state = hashlib.sha256()
    locks = (ROOT / "requirements" / f"{lock}.txt" for lock in LOCKS[wanted])
    kernels = sorted(path for pattern in ("*.c", "*.h") for path in (ROOT / "src" / "flexstage" / "models").rglob(pattern))
    shared = ROOT / "src" / "flexstage" / "base" / "processes"
    kernels += [ROOT / "hatch_build.py", shared / "lanes.h", shared / "native.py"]
    for path in (*locks, ROOT / "pyproject.toml", ROOT / "src" / "flexstage" / "__init__.py", *kernels):
        state.update(path.read_bytes())
    state.update(str(sys.version_info[:2]).encode())
    return state.hexdigest()


def stamp_path(wanted: str) -> Path:
    """Where it is written what was installed."""
    return VENV / f"{wanted}.stamp"


def read_stamp(path: Path) -> dict[str, Any]:
    """A stamp's content; empty if there is none or it is damaged."""
    try:
        return dict(json.loads(path.read_text()))
    except (OSError, ValueError, TypeError):
        return {}


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] not in COVERS:
        sys.exit(f"usage: python tools/setup.py {'|'.join(COVERS)}")
    sys.exit(main(sys.argv[1]))
