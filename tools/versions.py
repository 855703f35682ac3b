"""Other versions of what flexstage needs: its wheel in fresh environments, with the lowest versions declared, and with the newest.

    python -m tools.versions       (part of `make check-all`)

The lowest versions are tried on the oldest Python that is supported, the newest on every Python from 3.11 to 3.14 that is here. Extras are
installed but for those of developers, and for the solver of solids, which is declared in one version only.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
UV = str(Path(sys.executable).with_name("uv"))
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
EXTRAS = ("tables", "control")
_TOOLS = ("pytest", "hypothesis", "pyuff", "pint")
_TESTS = (*(f"tests/roundtrip/test_{each}.py" for each in ("store", "units", "sheets", "records")), "tests/apps/test_outputs.py")
"""Files of all formats, and the outputs of commands."""
_WITHOUT_SOLIDS = "not glb"


def main() -> int:
    """Run the tests in every environment; the exit code is the first failure's."""
    here = {version: path for version in PYTHONS if (path := interpreter(version))}
    print("Python", ", ".join(here), "are here; not tried:", ", ".join(set(PYTHONS) - {*here}) or "none", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([UV, "build", "-q", "--wheel", "-o", folder, str(ROOT)], check=True)
        (wheel,) = Path(folder).glob("*.whl")
        for version, path in here.items():
            for resolution in ("lowest-direct", "highest") if version == PYTHONS[0] else ("highest",):
                print(f"== {resolution} versions on Python {version}", flush=True)
                if code := run_tests(Path(folder) / f"{version}-{resolution}", path, f"{wheel}[{','.join(EXTRAS)}]", resolution):
                    return code
    return 0


def interpreter(version: str) -> str | None:
    """The path of a Python of that version, or None where there is none; none is downloaded."""
    done = subprocess.run([UV, "python", "find", "--no-python-downloads", version], capture_output=True, text=True, check=False)
    path = done.stdout.strip() or shutil.which(f"python{version}")
    return path if path and not subprocess.run([path, "-c", ""], capture_output=True, check=False).returncode else None


def run_tests(venv: Path, python: str, package: str, resolution: str) -> int:
    """Install the package with what the resolution chooses, and the locked tools of tests, and run the tests; the exit code."""
    subprocess.run([UV, "venv", "-q", "--python", python, str(venv)], check=True)
    inside = str(venv / "bin" / "python")
    subprocess.run([UV, "pip", "install", "-q", "--python", inside, "--resolution", resolution, package, *locked_tools()], check=True)
    environment = {name: value for name, value in os.environ.items() if name not in ("VIRTUAL_ENV", "PYTHONPATH")}
    options = [
        "-q",
        "-p",
        "no:cacheprovider",
        "-o",
        "filterwarnings=default",
        "--confcutdir",
        str(ROOT),
        "-k",
        _WITHOUT_SOLIDS,
    ]  # old packages use what newer ones deprecate
    return subprocess.run([inside, "-m", "pytest", *options, *_TESTS], cwd=ROOT, env=environment, check=False).returncode


def locked_tools() -> list[str]:
    """The tools of the tests in the versions of the lock file."""
    lines = re.findall(r"^([A-Za-z0-9_.-]+)==([^ ;\\]+)", (ROOT / "requirements" / "dev.txt").read_text(), flags=re.MULTILINE)
    pinned = dict(reversed(lines))  # of several versions the first, for the oldest Python
    return [f"{name}=={pinned[name]}" for name in _TOOLS if name in pinned]


if __name__ == "__main__":
    sys.exit(main())
