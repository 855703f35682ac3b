"""Commands that write, killed at random moments: nothing half-written, no orphan, nothing left after the next run."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.conftest import FULL

KILLS = Path(__file__).parents[2] / "benchmarks" / "kills.py"


@pytest.mark.skipif(not hasattr(os, "fork"), reason="signals of POSIX")
@pytest.mark.parametrize(("only", "count"), [("modes", 2), *(pytest.param("", 15, marks=pytest.mark.full) for _ in range(FULL))])
def test_killed_commands_leave_nothing_behind(only: str, count: int) -> None:
    words = [sys.executable, str(KILLS), "--only", only, "--count", str(count), "--seed", "3"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert (done.returncode, "; 0 findings" in done.stdout) == (0, True), done.stdout + done.stderr
