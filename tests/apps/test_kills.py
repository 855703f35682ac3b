"""Commands that write, killed at random moments: nothing half-written, no orphan, nothing left after the next run."""

from __future__ import annotations

import os
import subprocess
import sys
from inspect import signature
from pathlib import Path

import pytest

from benchmarks.kills import SCENES
from flexstage.apps.cli.commands import COMMANDS

KILLS = Path(__file__).parents[2] / "benchmarks" / "kills.py"
OUTPUTS = {"json", "report", "output", "mat", "export", "mesh", "gltf"}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="signals of POSIX")
@pytest.mark.parametrize("words", [("--only", "modes", "--count", "2"), pytest.param((), marks=pytest.mark.full)])
def test_killed_commands_leave_nothing_behind(words: tuple[str, ...]) -> None:
    done = subprocess.run([sys.executable, str(KILLS), *words, "--seed", "3"], capture_output=True, text=True, check=False)
    assert (done.returncode, "; 0 findings" in done.stdout) == (0, True), done.stdout + done.stderr


def test_every_command_that_writes_is_killed() -> None:
    writing = {each.name for each in COMMANDS if OUTPUTS & set(signature(each.load()).parameters)}
    assert {scene.words.split()[0] for scene in SCENES} == writing | {"new"}
