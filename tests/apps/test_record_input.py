"""Bad input to the commands that read and write records: exit code 2, a reason, nothing half-written."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from flexstage.cases.double_triangle import double_triangle
from flexstage.experiment.formats.write import write
from tests.apps.command import Command, Ended
from tests.models.stage_records import stage_record

UPDATE = ("update", "stage.toml", "--parameters", "horizontal/front.thickness", "-o", "new.toml", "--record")


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("record") / "record.uff"
    write(path, stage_record(double_triangle()))
    return path.read_bytes()


@pytest.fixture
def recorded(flexstage: Command, tmp_path: Path, content: bytes) -> Command:
    (tmp_path / "record.uff").write_bytes(content)
    return flexstage


@contextmanager
def untouched(folder: Path) -> Generator[None]:
    """All files as they were, and none besides."""
    before = {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    yield
    assert {path: path.read_bytes() for path in folder.iterdir() if path.is_file()} == before


def refused(ended: Ended, said: str) -> None:
    assert (ended.code, ended.out) == (2, ""), ended
    assert said in ended.err
    assert "Traceback" not in ended.err
    assert "warning: " not in ended.err


@pytest.mark.parametrize("command", [("identify",), ("compare", "stage.toml", "--record"), UPDATE])
@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("missing.uff", None, "missing.uff: file not found"),
        ("folder", None, "folder: not a regular file (got a folder)"),
        ("empty.h5", b"", "empty.h5: it is empty"),
        ("junk.uff", np.random.default_rng(0).bytes(20_000), "junk.uff: it is neither text nor in a supported format"),
        ("junk.h5", b"\x89HDF\r\n\x1a\n" + np.random.default_rng(0).bytes(20_000), "junk.h5: it cannot be read as HDF5"),
        (
            "junk.mat",
            b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + np.random.default_rng(0).bytes(20_000),
            "junk.mat: it cannot be read",
        ),
        ("stage.toml", None, "no line of numbers was found"),
    ],
)
def test_what_is_no_record_is_refused(
    recorded: Command, tmp_path: Path, command: tuple[str, ...], name: str, data: bytes | None, said: str
) -> None:
    (tmp_path / "folder").mkdir()
    if data is not None:
        (tmp_path / name).write_bytes(data)
    with untouched(tmp_path):
        refused(recorded(*command, name), said)


@pytest.mark.parametrize("command", [("identify",), ("compare", "stage.toml", "--record"), UPDATE])
@pytest.mark.parametrize(
    ("option", "target", "said"),
    [
        ("--json", "record.uff", "record.uff is also an input of this command"),
        ("--json", "missing/out.json", "folder missing not found"),
        ("--json", "folder", "it is a folder"),
        ("--json", "/dev/full", "No space left on device"),
    ],
)
def test_outputs_that_cannot_be_written_are_refused(
    recorded: Command, tmp_path: Path, command: tuple[str, ...], option: str, target: str, said: str
) -> None:
    if not Path("/dev/full").exists() and target == "/dev/full":
        pytest.skip("this system has no /dev/full")
    (tmp_path / "folder").mkdir()
    ended = recorded(*command, "record.uff", option, target)
    assert ended.code == 2
    assert said in ended.err
    assert "Traceback" not in ended.err
    assert (tmp_path / "record.uff").read_bytes()[:6].strip() == b"-1"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("identify", "record.uff", "./record.uff"), "it is given 2 times"),
        (("identify", "record.uff", "--array", "sample=u"), "--array sample=u: unknown meaning, or array missing (known: samples, time"),
        (("identify", "record.uff", "--array", "samples=u"), "samples=u: universal files have no named arrays"),
        (("identify", "record.uff", "--band", "100 Hz", "100.2 Hz"), "too few lines from 100 to 100.2 Hz"),
        (("identify", "record.uff", "--band", "100 Hz", "106 Hz"), "too few lines from 100 to 106 Hz"),
        (("identify", "record.uff", "--band", "0 Hz", "0.1 Hz"), "the data reach from"),
        ((*UPDATE, "record.uff", "--gain-error", "200 %"), "--gain-error"),
        (("rig", "stage.toml", "--seconds", "2", "-o", "new.uff", "--resolution", "1 m"), "are below half of a step, 1e+06 um"),
    ],
)
def test_questions_without_an_answer_are_refused(recorded: Command, tmp_path: Path, arguments: tuple[str, ...], said: str) -> None:
    with untouched(tmp_path):
        refused(recorded(*arguments), said)


FULL_DISK = """
import resource, sys
from flexstage.apps.cli import run
codes = []
for name in sys.argv[1:]:
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, resource.RLIM_INFINITY))
    codes.append(run(["rig", "stage.toml", "--seconds", "5", "-o", name]))
print(*codes)
"""


def test_a_full_disk_leaves_no_part_of_a_record(flexstage: Command, tmp_path: Path) -> None:
    """In a process of its own: the HDF5 library crashed at its very end over what it could not write, with `Wrote record.h5` said."""
    pytest.importorskip("resource")
    assert flexstage("check", "stage.toml").code == 0
    names = ["a.uff", "a.mat", "a.h5", "a.csv"]
    with untouched(tmp_path):
        ended = subprocess.run(
            [sys.executable, "-c", FULL_DISK, *names], check=False, capture_output=True, text=True, cwd=tmp_path, env=os.environ
        )
    assert (ended.returncode, ended.stdout.split()) == (0, ["2"] * len(names)), ended.stderr
    assert ended.stderr.count("it cannot be written: File too large") == len(names)
