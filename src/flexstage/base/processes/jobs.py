"""Jobs in worker processes, which isolate crashes, hangs and memory exhaustion from the caller.

A `Worker` is a process that calls one function repeatedly. The process runs this module, not a copy of the caller. A worker thus works in
notebooks, tests and scripts without a `__main__` guard. A worker always ends when its caller ends, and leaves no file.
"""

from __future__ import annotations

import contextlib
import faulthandler
import math
import os
import pickle
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Callable
from enum import Enum
from pathlib import Path
from typing import IO, Any, TypeAlias, cast

from flexstage.base.finding import DesignError

_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NGS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_KEPT = {"hugetlb": 1, "mmap_threshold": 2**25, "trim_threshold": 2**28}
_MEMORY = {"GLIBC_TUNABLES": ":".join(f"glibc.malloc.{name}={value}" for name, value in _KEPT.items())}
"""GNU C library: large pages for large matrices, and up to a quarter of a gigabyte of freed memory is kept for reuse (sparse fronts)."""
_MAIN = "from flexstage.base.processes.jobs import main; main()"
_END = (EOFError, pickle.UnpicklingError)
"""Errors at the end of a stream, and within the last message of a process that died."""


class Word(Enum):
    """Kind of a worker's message: intermediate, request for memory, result, exception of the function, end of the process."""

    TOLD = "told"
    REQUEST = "request"
    DONE = "done"
    FAILED = "failed"
    ENDED = "ended"


Heard: TypeAlias = "queue.SimpleQueue[tuple[Worker, Word, Any]]"
"""Queue of (worker, kind, value) messages in order. For `ENDED`, the value is the exit code, negative for a signal."""


def cores() -> int:
    """Return the number of cores available to this process.

    >>> cores() >= 1
    True
    """
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else (os.cpu_count() or 1)


def environment() -> dict[str, str]:
    """Return environment variables for a single-threaded process: the caller's import path, and memory settings (large pages).

    >>> environment()["OMP_NUM_THREADS"]
    '1'
    """
    root = str(Path(__file__).resolve().parents[3])
    paths = [root, *map(os.path.abspath, filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep)))]
    return {**_MEMORY, **os.environ, **dict.fromkeys(_ONE_THREAD, "1"), "PYTHONPATH": os.pathsep.join(paths)}


class Worker:
    """Process that calls `function(line, *arguments)` and puts its messages in the queue `heard`.

    Raises `OSError` if the process cannot be started. Exceptions `DesignError`, `MemoryError` and `OSError` of the function reach the
    caller unchanged. Any other exception ends the process with code 1; `last_words` returns its message.

    >>> worker = Worker(isinstance)
    >>> worker.call(Line), worker.end()
    (True, None)
    """

    def __init__(self, function: Callable[..., Any], heard: Heard | None = None) -> None:
        self.heard: Heard = queue.SimpleQueue() if heard is None else heard
        self.kins = set[str]()
        """Kinds of its earlier calls in a pool."""
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 (open as long as the process)
        try:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", _MAIN],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._log,
                env=environment(),
                cwd=tempfile.gettempdir(),  # for files left by libraries
                start_new_session=True,  # a keyboard interrupt reaches only the caller, which ends the process
            )
        except BaseException:
            self._log.close()
            raise
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()
        self._send(function)

    def ask(self, *arguments: Any) -> None:
        """Send arguments to the worker. Arguments start a call, or answer a message of the function. An ended worker reports `ENDED`."""
        self._send(arguments)

    def call(self, *arguments: Any) -> Any:
        """Call the function and return its result, or raise its exception; messages of other workers in its queue are dropped.

        Raises `EOFError` with the exit code if the process crashed or was ended. After this error or an interrupt, the process has ended.
        """
        try:
            self.ask(*arguments)
            _, word, value = next(message for message in iter(self.heard.get, None) if message[0] is self)
            if word is Word.ENDED:
                raise EOFError(value)
        except BaseException:
            self.end()
            raise
        if word is Word.FAILED:
            raise value
        return value

    def resident(self) -> float:
        """Return the resident memory of the process [bytes]; 0 if unknown."""
        try:
            import psutil

            return float(psutil.Process(self.process.pid).memory_info().rss)
        except Exception:  # noqa: BLE001 the system does not tell, in whatever way
            return 0.0

    def last_words(self) -> str:
        """Return the last line of the standard error of the process."""
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").strip().splitlines()
        return lines[-1][:300] if lines else "no error output"

    def end(self) -> None:
        """End the process at once."""
        self.process.kill()
        self._listener.join()
        with contextlib.suppress(OSError):
            _as_pipe(self.process.stdin).close()
        self._log.close()

    def _send(self, value: Any) -> None:
        data = pickle.dumps(value)
        with contextlib.suppress(OSError, ValueError):  # it died, or was ended by another thread: reported soon
            _write(_as_pipe(self.process.stdin), data)

    def _listen(self) -> None:
        with _as_pipe(self.process.stdout) as answers, contextlib.suppress(*_END):
            while True:
                self.heard.put((self, *pickle.loads(pickle.load(answers))))  # noqa: S301 (written by this module)
        self.heard.put((self, Word.ENDED, self.process.wait()))


# --- worker process ---


class Line:
    """Connection of a function in a worker to its caller, for intermediate messages and answers."""

    def __init__(self, asked: queue.SimpleQueue[bytes], answers: IO[bytes]) -> None:
        self._asked, self._answers = asked, answers

    def tell(self, value: Any) -> None:
        """Send a message to the caller."""
        self.say(Word.TOLD, value)

    def say(self, word: Word, value: Any) -> None:
        """Send a message of the given kind to the caller."""
        _write(self._answers, pickle.dumps((word, value)))

    def request_memory(self, needed: float) -> float | None:
        """Wait for a permit for `needed` memory [bytes]. Returns `None`, or the available memory if there is never enough."""
        self.say(Word.REQUEST, needed)
        return self.hear()[0]

    def hear(self) -> Any:
        """Return the next message of the caller."""
        return pickle.loads(self._asked.get())  # noqa: S301 (written by the caller, whose process this is)


def limit_memory(most: float) -> None:
    """Limit the memory of this process to `most` [bytes], and disable core files."""
    _limit("RLIMIT_CORE", 0)
    if most != float("inf"):
        _limit("RLIMIT_DATA", int(most))


def limit_processor(seconds: float) -> None:
    """Limit the additional CPU time of this process [s]; at the limit the signal SIGXCPU ends it."""
    _limit("RLIMIT_CPU", math.ceil(time.process_time() + seconds))


def _limit(name: str, most: int) -> None:
    """Set a limit if the system supports it, not above an existing one."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        kind = getattr(resource, name)
        resource.setrlimit(kind, (most, resource.getrlimit(kind)[1]))


def main() -> None:
    """Serve calls from standard input. Output printed by libraries is sent to standard error."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    faulthandler.enable()
    requested: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    line = Line(requested, os.fdopen(os.dup(1), "wb"))
    os.dup2(2, 1)
    threading.Thread(target=_listen, args=(requested,), daemon=True).start()
    try:
        _serve(line)
    except BaseException:  # noqa: BLE001 (whatever it is, this process is lost)
        traceback.print_exc()
        os._exit(1)  # a regular exit would wait for the listener thread


def _serve(line: Line) -> None:
    function = line.hear()
    while True:
        try:
            line.say(Word.DONE, function(line, *line.hear()))
        except (DesignError, MemoryError, OSError) as error:
            line.say(Word.FAILED, error)


def _listen(requested: queue.SimpleQueue[bytes]) -> None:
    """Forward messages until standard input closes; then end this process."""
    with contextlib.suppress(*_END):
        while True:
            requested.put(pickle.load(sys.stdin.buffer))  # noqa: S301 (bytes)
    os._exit(0)


def _write(stream: IO[bytes], data: bytes) -> None:
    """Send a message; the inner pickle is read by the function's thread."""
    pickle.dump(data, stream)
    stream.flush()


def _as_pipe(stream: IO[bytes] | None) -> IO[bytes]:
    return cast("IO[bytes]", stream)
