"""The main commands where POSIX is not: without fcntl, resource, pwd, grp and termios, and without /proc."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.apps.command import design_in

HIDDEN = """
import builtins, io, os, pathlib, sys, warnings

class Nowhere:
    def find_spec(self, name, path=None, target=None):
        if name in {"fcntl", "resource", "pwd", "grp", "termios", "posixshmem", "_posixshmem"}:
            raise ImportError(f"{name} is hidden")

for name in ("fcntl", "resource", "pwd", "grp", "termios"):
    sys.modules.pop(name, None)
sys.meta_path.insert(0, Nowhere())

def hiding(function):
    def hidden(path, *rest, **named):
        if isinstance(path, (str, bytes, os.PathLike)) and os.fsdecode(path).startswith(("/proc", "/sys")):
            raise FileNotFoundError(2, "No such file or directory", path)
        return function(path, *rest, **named)
    return hidden

builtins.open = io.open = hiding(open)
for name in ("stat", "lstat", "open", "listdir", "scandir", "readlink"):
    setattr(os, name, hiding(getattr(os, name)))
"""
PLAIN = """
import sys
from flexstage.apps.cli import run
words = "new {0}.toml --case parallelogram", "check {0}.toml --json {0}.json", "plan {0}.toml -o {0}.svg", "modes {0}.toml --csv {0}"
sys.exit(max(run(each.format(sys.argv[1]).split()) for each in words))
"""
COMMANDS = (
    "check stage.toml",
    "analyse stage.toml --report a.html --json a.json",
    "modes stage.toml",
    "rig stage.toml --seconds 2 --model mapped -o record.h5",
    "sweep study.toml -o s.h5 --workers 1",
    "identify record.h5",
    "loop stage.toml",
)
RUN = """
from flexstage.apps.cli import run
for words in sys.argv[1:]:
    code = run(words.split())
    if code:
        sys.exit(f"{words}: {code}")
missing = {"fcntl", "resource", "pwd", "grp", "termios"} & set(sys.modules)
sys.exit(f"imported: {missing}" if missing else 0)
"""
STUDY = """format = "flexstage study 1"
case = "parallelogram"
variables.t = { address = "parts.leaf.thickness", from = "0.7 mm", to = "1.3 mm" }
responses.f = "frequency.platform.1"
sweep = { sampling = "sobol", designs = 4 }
"""


@pytest.mark.full
def test_the_main_commands_need_nothing_of_posix(tmp_path: Path) -> None:
    """Their workers neither: what is hidden here is hidden there, before anything else is imported."""
    design_in(tmp_path, "parallelogram")
    (tmp_path / "study.toml").write_text(STUDY)
    hooks = tmp_path / "hooks"
    hooks.mkdir()
    (hooks / "sitecustomize.py").write_text(HIDDEN)
    environment = {**os.environ, "PYTHONPATH": str(hooks), "FLEXSTAGE_DEBUG": "1", "FLEXSTAGE_KERNEL": "off"}
    words = [sys.executable, "-P", "-c", f"import sys\n{RUN}", *COMMANDS]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr


def test_names_that_the_locale_does_not_know_are_written(tmp_path: Path) -> None:
    """Without UTF-8 in the locale, names of files are bytes; temporary ones next to them too."""
    name = "gl\u00fch\u2192" + 40 * "\u00e9"
    environment = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    words = [sys.executable, "-c", PLAIN, name.encode()]
    done = subprocess.run(words, cwd=tmp_path, env=environment, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode(errors="replace")
    written = {os.fsencode(each.name) for each in tmp_path.iterdir()}
    assert {f"{name}{ending}".encode() for ending in (".toml", ".json", ".svg", "")} <= written
