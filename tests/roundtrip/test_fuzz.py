"""Fuzzing the readers of files: whatever stands in one, it is read or refused by findings."""

from __future__ import annotations

import contextlib
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from flexstage.base.finding import DesignError
from flexstage.base.storage import files
from flexstage.mechanism.store import load
from tests.conftest import FULL
from tests.roundtrip.fuzzed import KINDS, one_input, sound, tried

COUNTS = {"designs": 200, "studies": 50, "setups": 60, "results": 10, "tables": 80, "universal": 70, "hdf5": 15, "mat": 15}
"""Inputs of each kind in the quick tests."""
FULL_COUNTS = {"designs": 10_000, "studies": 170, "setups": 170, "results": 160, "tables": 1000, "universal": 1000, "hdf5": 125, "mat": 125}


@pytest.mark.parametrize("kind", KINDS)
def test_an_altered_file_is_read_or_refused(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(files, "PATIENCE", 2.0)  # nothing is lost by it where files are small
    for number in range((FULL_COUNTS if FULL else COUNTS)[kind]):
        with contextlib.suppress(DesignError):
            tried(kind, one_input(kind, 7, number), tmp_path)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_altered_is_sound_before(kind: str, tmp_path: Path) -> None:
    for content in sound(kind):
        tried(kind, content, tmp_path)


@given(data=st.binary(max_size=200))
def test_any_bytes_are_refused(data: bytes, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "noise.toml"
    path.write_bytes(data)
    with pytest.raises(DesignError):
        load(path)


def test_the_fuzzer_says_what_came_out_and_keeps_what_must_not_be(tmp_path: Path) -> None:
    script = Path(__file__).parents[2] / "benchmarks" / "fuzz.py"
    options = ["--kind", "tables,setups", "--count", "5", "--seed", "3", "--start", "10", "--keep", str(tmp_path / "kept")]
    done = subprocess.run([sys.executable, str(script), *options], capture_output=True, text=True, check=True)
    assert [line.partition(":")[0] for line in done.stdout.splitlines()] == ["tables", "setups"]
    assert "seed 3, 10 to 14" in done.stdout
    assert not (tmp_path / "kept").exists()


def test_an_input_follows_from_its_number() -> None:
    assert one_input("tables", 1, 5) == one_input("tables", 1, 5) != one_input("tables", 1, 6)
