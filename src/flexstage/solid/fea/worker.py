"""The process that does one job of the solid model: `python -m flexstage.solid.fea.worker FOLDER`.

CAD and mesher may crash or hang; here they take nothing with them. In the folder are `task` (read), `progress` (JSON lines, appended),
`result` or `findings` (written aside, then renamed). A byte on the standard input permits what was asked for; its
end says that the parent is gone.
"""

from __future__ import annotations

import contextlib
import errno
import faulthandler
import json
import os
import pickle
import shutil
import sys
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

from flexstage.base.finding import DesignError, Finding
from flexstage.solid.fea.memory import Counts
from flexstage.solid.fea.progress import Report, Stage
from flexstage.solid.fea.store import Versions

TASK, PROGRESS, RESULT, FINDINGS = "task", "progress", "result", "findings"
_SLACK, _SHARE = 5e8, 1.2
"""What libraries take beyond a job's own memory [bytes], and how much more it may take than was planned with."""
_TRIES = 100
_PATIENCE = 60.0
"""How much longer than allowed it lives if nobody ends it [s]."""


class Outcome(IntEnum):
    """Exit codes; anything else is a crash."""

    DONE = 0
    REFUSED = 2
    DISK_FULL = 3
    MEMORY_FULL = 4


@dataclass(frozen=True, eq=False)
class Call:
    """What a job is given where it works: whom to tell, whom to ask for memory, which attempt at a mesh to begin with.

    `ask` waits until there is room for a mesh, expected or made.
    """

    report: Report
    ask: Callable[[Counts], None]
    attempt: int
    made: Versions


class Job(ABC):
    """Work for a process of its own: a value that can be pickled, with a result in bytes."""

    attempts: int = 1
    """How many attempts at a mesh can be told apart by their number, so that one that takes the process down is followed by the next."""

    @property
    @abstractmethod
    def name(self) -> str:
        """What it works on, as the user knows it."""

    @property
    def weight(self) -> int:
        """How much work it is, against the others."""
        return 1

    @abstractmethod
    def work(self, call: Call) -> bytes:
        """Do it."""

    def needed(self, _counts: Counts) -> float:
        """Memory it is going to need for a mesh [bytes]."""
        return 0.0

    def refusal(self, _counts: Counts, _limit: float) -> Finding | None:
        """Why it does not fit into memory, with a smaller suggestion."""
        return None


@dataclass(frozen=True, eq=False)
class Task:
    """What a worker is told: the job, the attempt at its mesh to begin with, the memory [bytes] and time [s] it may take, who is asking."""

    job: Job
    attempt: int
    memory: float
    seconds: float
    made: Versions


@dataclass(frozen=True, eq=False)
class _Parent:
    """The process that asked: what it permits, whether it is gone, and who listens to it."""

    permitted: threading.Semaphore
    gone: threading.Event
    listener: threading.Thread


def _main(folder: Path) -> Outcome:
    """Work on the task in a folder; what is refused is left there as findings."""
    parent = _watch_parent(folder)
    try:
        return _outcome(folder, parent)
    finally:
        if parent.gone.is_set():
            parent.listener.join()  # the folder is being taken away, which may be what failed here: the listener ends the process


def _outcome(folder: Path, parent: _Parent) -> Outcome:
    try:
        _place(folder / RESULT, _work(folder, parent))
    except DesignError as error:
        told = [{"where": finding.where, "what": finding.what, "advice": finding.advice} for finding in error.findings]
        _place(folder / FINDINGS, json.dumps(told).encode())
        return Outcome.REFUSED
    return Outcome.DONE


def findings_in(folder: Path) -> tuple[Finding, ...]:
    """The findings a worker left.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / FINDINGS).write_text('[{"where": "lever", "what": "too thin", "advice": "Thicken it"}]')
    ...     print(*findings_in(Path(folder)))
    lever: too thin. Thicken it.
    """
    return tuple(Finding(**item) for item in json.loads((folder / FINDINGS).read_bytes()))


def _work(folder: Path, parent: _Parent) -> bytes:
    report = _reporter(folder / PROGRESS)
    report(Stage.STARTING, 0.0)
    task: Task = pickle.loads((folder / TASK).read_bytes())  # noqa: S301 (written by the parent process, into a folder only it can write to)
    _limit_memory(task.memory)
    faulthandler.dump_traceback_later(task.seconds + _PATIENCE, exit=True)  # should compiled code keep the lock and the parent be gone
    return task.job.work(Call(report, lambda counts: _ask(folder / PROGRESS, counts, parent.permitted), task.attempt, task.made))


def _ask(path: Path, counts: Counts, permitted: threading.Semaphore) -> None:
    """Tell the parent what is to be assembled, and wait until it permits it."""
    _append(path, {"counts": [counts.vertices, counts.edges, counts.faces, counts.elements]})
    permitted.acquire()


def _reporter(path: Path) -> Report:
    return lambda stage, fraction: _append(path, {"stage": stage.name, "fraction": fraction})


def _append(path: Path, line: object) -> None:
    with path.open("a", encoding="utf-8") as stream:
        stream.write(json.dumps(line) + "\n")


def _place(path: Path, data: bytes) -> None:
    aside = path.with_suffix(".part")
    aside.write_bytes(data)
    aside.replace(path)


def _watch_parent(folder: Path) -> _Parent:
    """Every byte of the standard input permits; this process ends with the parent, whose end of the pipe closes then.

    CAD, mesher and solver release the interpreter's lock while they work, so this thread is heard.
    """
    permitted, gone = threading.Semaphore(0), threading.Event()

    def listen() -> None:
        while os.read(sys.stdin.fileno(), 1):
            permitted.release()
        gone.set()
        _take_away(folder)
        os._exit(1)

    listener = threading.Thread(target=listen, daemon=True)
    listener.start()
    return _Parent(permitted, gone, listener)


def _take_away(folder: Path) -> None:
    """Remove a folder into which another thread may still be writing."""
    for _ in range(_TRIES):
        shutil.rmtree(folder, ignore_errors=True)
        if not folder.exists():
            return


def _limit_memory(most: float) -> None:
    """Let a mesh without end fail here rather than take the machine's memory; leave no core files."""
    with contextlib.suppress(ImportError, ValueError, OSError):  # not on Windows, and not above a limit set by others
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        if most != float("inf"):
            limit = int(_SHARE * most + _SLACK)
            resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))


def _run(arguments: Sequence[str]) -> int:
    faulthandler.enable()
    try:
        return _main(Path(arguments[0]))
    except MemoryError:
        return Outcome.MEMORY_FULL
    except OSError as error:
        if error.errno not in {errno.ENOSPC, errno.EDQUOT}:
            raise
        return Outcome.DISK_FULL


if __name__ == "__main__":
    outcome = _run(sys.argv[1:])
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(outcome)  # the result is placed: nothing is left to go wrong while libraries are taken down
