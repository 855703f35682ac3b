"""Pieces of a study computed in processes of this machine: each takes a piece, writes it, and asks for the next.

Processes of their own modules, not copies of the caller's: it works alike from scripts without a guard, notebooks and tests. A process that
dies gives its piece back.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, cast

from flexstage.base.child import command, environment
from flexstage.base.finding import DesignError, refuse
from flexstage.base.store import temporary_folder
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.engine import Engine
from flexstage.studies.sweeps.evaluate import piece
from flexstage.studies.sweeps.store import write_piece

_LIVES = 3
"""How many processes may die over one piece before it is given up."""
_DONE, _REFUSED = "done", "refused"


def worked(study: Study, engine: Engine, ranges: Iterable[tuple[int, int]], folder: Path, workers: int) -> Iterator[int]:
    """Compute all ranges of designs into `folder`; yields the first design of each as it is there, in any order.

    All processes take the same `engine`. Raises `DesignError` where a piece cannot be written, or where processes die over it again and
    again. When the iteration is left, all processes end.

    >>> from flexstage.studies.sweeps.example import neck_study
    >>> from flexstage.studies.sweeps.engine import engine_of
    >>> list(worked(neck_study(), engine_of(neck_study()), [], Path("nowhere"), 2))
    []
    """
    with temporary_folder() as place:
        task = place / "study.pickle"
        task.write_bytes(pickle.dumps((study, engine)))
        crew = _Crew(task, folder)
        for each in ranges:
            crew.todo.put((*each, 0))
        count = crew.todo.qsize()
        try:
            crew.start(min(workers, count))
            for _ in range(count):
                found = crew.finished.get()
                if isinstance(found, Exception):
                    raise found
                yield found
        finally:
            crew.end()


@dataclass(eq=False)
class _Crew:
    """Processes at work, one thread watching each."""

    task: Path
    folder: Path
    todo: queue.SimpleQueue[tuple[int, int, int]] = field(default_factory=queue.SimpleQueue)
    finished: queue.SimpleQueue[int | Exception] = field(default_factory=queue.SimpleQueue)
    processes: list[subprocess.Popen[str]] = field(default_factory=list)
    threads: list[threading.Thread] = field(default_factory=list)
    ended: bool = False

    def start(self, workers: int) -> None:
        """Set all to work."""
        self.threads = [threading.Thread(target=self._watch, daemon=True) for _ in range(workers)]
        for each in self.threads:
            each.start()

    def end(self) -> None:
        """End all processes, whatever they do."""
        self.ended = True
        while not self.todo.empty():
            self.todo.get_nowait()
        for each in list(self.processes):
            each.kill()
        for each in self.threads:
            each.join()

    def _watch(self) -> None:
        """Give pieces to one process; a new one when it dies."""
        process = None
        try:
            while not self.ended and not self.todo.empty():
                start, stop, deaths = self.todo.get_nowait()
                process = process or self._begin()
                answer = _asked(process, start, stop)
                if answer == _DONE:
                    self.finished.put(start)
                elif answer.startswith(_REFUSED):
                    self.finished.put(refuse(f"designs {start} to {stop - 1}", answer.removeprefix(_REFUSED).strip(), "Mend it and resume"))
                elif not self.ended:
                    _dismissed(process)
                    process = None
                    self._give_back(start, stop, deaths + 1)
        except queue.Empty:
            pass
        except Exception as error:  # noqa: BLE001 whatever it is, the caller has to hear of it
            self.finished.put(error)
        finally:
            if process is not None:
                _dismissed(process)

    def _begin(self) -> subprocess.Popen[str]:
        words = command("flexstage.studies.sweeps.work", self.task, self.folder)
        process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment())
        self.processes.append(process)
        return process

    def _give_back(self, start: int, stop: int, deaths: int) -> None:
        if deaths < _LIVES:
            self.todo.put((start, stop, deaths))
        else:
            self.finished.put(refuse(f"designs {start} to {stop - 1}", f"{deaths} processes died over them", "Free memory and resume"))


def _pipes(process: subprocess.Popen[str]) -> tuple[IO[str], IO[str]]:
    return cast("IO[str]", process.stdin), cast("IO[str]", process.stdout)


def _asked(process: subprocess.Popen[str], start: int, stop: int) -> str:
    """The process's answer; nothing where it died."""
    to, back = _pipes(process)
    try:
        to.write(f"{start} {stop}\n")
        to.flush()
    except (BrokenPipeError, ValueError):
        return ""
    return back.readline().strip()


def _dismissed(process: subprocess.Popen[str]) -> None:
    to, back = _pipes(process)
    with contextlib.suppress(BrokenPipeError):
        to.close()
    process.wait()
    back.close()


def _main(task: str, folder: str) -> None:
    """Compute ranges that come on standard input, one a line. Interruptions are the affair of the process that started this one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    asked = queue.SimpleQueue[str]()
    threading.Thread(target=_listen, args=(asked,), daemon=True).start()
    study, engine = cast("tuple[Study, Engine]", pickle.loads(Path(task).read_bytes()))  # noqa: S301 written by this one's parent
    while True:
        start, stop = map(int, asked.get().split())
        try:
            write_piece(Path(folder), piece(study, start, stop, engine))
            answer = _DONE
        except DesignError as error:
            answer = f"{_REFUSED} {' '.join(str(error).split())}"
        sys.stdout.write(f"{answer}\n")
        sys.stdout.flush()


def _listen(asked: queue.SimpleQueue[str]) -> None:
    """Pass on what is asked, until standard input closes: then nobody waits for an answer, and this process ends whatever it does."""
    for line in sys.stdin:
        asked.put(line)
    os._exit(0)


if __name__ == "__main__":
    _main(*sys.argv[1:])
