"""Streams that are closed, full or gone, a folder that is gone, signals: the exit code is right, and nothing is left behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

import psutil
import pytest

from flexstage.apps.cli import run
from flexstage.apps.cli.commands import COMMANDS
from tests.apps.command import Command, design_in

NAMES = [each.name for each in COMMANDS]
FULL = Path("/dev/full")
STREAMS = ("closed", "full", "gone")
EVERY = [
    *((name, "full") for name in NAMES),
    *(pytest.param(name, "closed", marks=() if name == "check" else pytest.mark.full) for name in NAMES),
    ("check", "gone"),
]
"""Every command writes where nothing is taken; the streams themselves are told apart by one."""
STUDY = """format = "flexstage study 1"
case = "parallelogram"
variables.t = { address = "parts.leaf.thickness", from = "0.7 mm", to = "1.3 mm" }
responses.f = "frequency.platform.1"
sweep = { sampling = "sobol", designs = 100000 }
"""


@contextmanager
def stream(number: int, how: str) -> Generator[None]:
    """Standard output (1) or error (2) of this process, closed, full, or a pipe without a reader."""
    kept, flushed = os.dup(number), (sys.stdout, sys.stderr)
    for each in flushed:
        each.flush()
    if how == "closed":
        os.close(number)
    elif how == "full":
        full = os.open(FULL, os.O_WRONLY)
        os.dup2(full, number)
        os.close(full)
    else:
        reader, writer = os.pipe()
        os.close(reader)
        os.dup2(writer, number)
        os.close(writer)
    name = ("stdout", "stderr")[number - 1]
    before = getattr(sys, name)
    own = None if how == "closed" else os.fdopen(os.dup(number), "w")
    setattr(sys, name, own)
    try:
        yield
    finally:
        if own is not None:
            own.close()
        setattr(sys, name, before)
        os.dup2(kept, number)
        os.close(kept)


@pytest.mark.parametrize(("name", "how"), EVERY)
def test_results_that_cannot_be_written_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, how: str, capfd) -> None:
    """Every command has its help as a result: a finding and 2 where stdout takes nothing; a reader that has gone has read enough."""
    monkeypatch.chdir(tmp_path)
    with stream(1, how):
        code = run([name, "--help"])
    assert code == (0 if how == "gone" else 2)
    assert ("stdout: cannot be written" in capfd.readouterr().err) == (how != "gone")


@pytest.mark.parametrize(("name", "how"), EVERY)
def test_bad_input_is_2_whoever_listens(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, how: str, capfd) -> None:
    monkeypatch.chdir(tmp_path)
    with stream(2, how):
        assert run([name, "--no-such-option"]) == 2


@pytest.mark.parametrize("how", STREAMS)
def test_exit_codes_do_not_depend_on_stderr(flexstage: Command, tmp_path: Path, how: str) -> None:
    flexstage("version")  # in the folder of the design
    for arguments, code in (
        (("modes", "stage.toml", "--json", "out.json"), 0),
        (("analyse", "stage.toml", "--model", "ideal", "--require", "stroke.x = at least 1 m", "--strict"), 2),
        (("check", "nowhere.toml"), 2),
    ):
        with stream(2, how):
            assert run(arguments) == code, arguments


@pytest.mark.parametrize("how", ["closed", "full"])
@pytest.mark.parametrize(
    "arguments", [("modes", "stage.toml"), ("modes", "stage.toml", "--json", "-"), ("mapping", "stage.toml", "--json", "-")]
)
def test_files_appear_only_with_what_stdout_takes(flexstage: Command, tmp_path: Path, how: str, arguments: tuple[str, ...]) -> None:
    flexstage("version")
    with stream(1, how):
        assert run(arguments) == 2
        assert run(("analyse", "stage.toml", "--model", "ideal", "--json", "-", "--mat", "out.mat")) == 2
    assert [each.name for each in tmp_path.iterdir()] == ["stage.toml"]


def started(folder: Path, *arguments: str, **how: object) -> subprocess.Popen[str]:
    environment = {**os.environ, "TMPDIR": str(folder / "temporary"), "FLEXSTAGE_KERNEL": "off"}
    (folder / "temporary").mkdir(exist_ok=True)
    command = [sys.executable, "-P", "-m", "flexstage", *arguments]
    return subprocess.Popen(command, cwd=folder, env=environment, text=True, **{"stdout": -1, "stderr": -1, **how})


@pytest.mark.skipif(os.name != "posix", reason="streams of POSIX")
def test_streams_closed_from_the_start(tmp_path: Path) -> None:
    """As a shell closes them: the interpreter itself begins without."""
    design_in(tmp_path, "parallelogram")
    line = f'"{sys.executable}" -P -m flexstage check stage.toml >&- 2>&- <&-'
    assert subprocess.run(["sh", "-c", line], cwd=tmp_path, check=False).returncode == 2


def test_a_folder_that_is_gone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd) -> None:
    design = design_in(tmp_path, "parallelogram")
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert run(["modes", str(design)]) == 0
    capfd.readouterr()
    for arguments in (["modes", "stage.toml"], ["new", "a.toml"], ["analyse", str(design), "--report", "a.html"], ["doctor"]):
        assert run(arguments) == 2, arguments
        assert "current folder: has been removed" in capfd.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGTERM, pytest.param(signal.SIGHUP, marks=pytest.mark.full)])
def test_signals_end_a_command_with_all_it_started(tmp_path: Path, number: signal.Signals) -> None:
    if signal.getsignal(number) is signal.SIG_IGN:
        pytest.skip("signals ignored from outside (nohup) stay ignored")
    (tmp_path / "study.toml").write_text(STUDY)
    process = started(tmp_path, "sweep", "study.toml", "-o", "results.h5", "--workers", "2")
    watched = psutil.Process(process.pid)
    while len(children := watched.children()) < 2:
        assert process.poll() is None
        time.sleep(0.1)  # to look at all processes takes time itself
    process.send_signal(number)
    _, told = process.communicate(timeout=600)
    assert process.returncode == 128 + number, told
    assert "Ended by a signal" in told
    assert psutil.wait_procs(children, timeout=10)[1] == []
    assert list((tmp_path / "temporary").iterdir()) == []
    assert {each.name for each in tmp_path.iterdir()} <= {"study.toml", "temporary", "results.h5", "results.h5.pieces"}
    assert not list(tmp_path.glob("results.h5.pieces/.*"))


@pytest.mark.full  # the usual tests end one by a signal
@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_workers_do_not_outlive_a_killed_command(tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(STUDY)
    process = started(tmp_path, "sweep", "study.toml", "-o", "results.h5", "--workers", "2")
    watched = psutil.Process(process.pid)
    while len(children := watched.children()) < 2:
        assert process.poll() is None
        time.sleep(0.1)  # to look at all processes takes time itself
    process.kill()
    process.communicate()
    assert psutil.wait_procs(children, timeout=10)[1] == []
    assert list((tmp_path / "temporary").iterdir()) == []


STEERING = "\x1b\x9b\u202e\u2066\x07"


def test_nothing_steers_the_terminal(flexstage: Command, tmp_path: Path) -> None:
    """Names of files, options, designs and columns, in tables, findings, usage and JSON."""
    design = tmp_path / "stage.toml"
    text = design.read_text()
    escaped = "".join(f"\\U{ord(each):08x}" for each in STEERING)
    design.write_text(text.replace('name = "double triangle"', f'name = "double triangle {escaped}"', 1))
    assert design.read_text() != text
    for arguments in (
        ("check", "stage.toml"),
        ("analyse", "stage.toml", "--model", "ideal"),
        ("analyse", "stage.toml", "--model", "ideal", "--json", "-"),
        ("modes", f"no{STEERING}where.toml"),
        (f"mo{STEERING}des",),
        ("modes", f"--no{STEERING}option"),
        ("modes", "stage.toml", f"extra{STEERING}"),
        ("modes", "stage.toml", "--set", f"parts.n{STEERING}=1 mm"),
        ("modes", "stage.toml", "--json", f"o{STEERING}.json"),
    ):
        ended = flexstage(*arguments)
        assert not set(STEERING) & set(ended.out + ended.err), arguments
    assert flexstage("analyse", "stage.toml", "--model", "ideal", "--json", "-").document["name"].endswith(STEERING)
    assert (tmp_path / f"o{STEERING}.json").exists()
