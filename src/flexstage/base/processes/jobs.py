"""Jobs in processes beside the caller: what crashes, hangs or takes all memory there takes nothing with it.

A `Worker` is a process that has one function and calls it as often as it is asked. It runs this very module, not a copy of the caller: that
works alike from scripts without a guard, notebooks and tests. It ends with its caller, however that ends, and leaves no file.
"""

from __future__ import annotations

import contextlib
import faulthandler
import math
import os
import pickle
import queue
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import IO, Any, TypeAlias, cast

from flexstage.base.finding import DesignError

_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NGS_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
_KEPT = {"hugetlb": 1, "mmap_threshold": 2**25, "trim_threshold": 2**28}
_MEMORY = {"GLIBC_TUNABLES": ":".join(f"glibc.malloc.{name}={value}" for name, value in _KEPT.items())}
"""Where the C library is GNU's, large matrices come in pages of megabytes, of which there are fewer to hand out, and what is freed is kept
for the next ones, up to a quarter of a gigabyte: fronts come and go by the thousand."""
_MAIN = "from flexstage.base.processes.jobs import main; main()"
_LENGTH = struct.Struct("<Q")
_LIVES = 3
"""How many processes may die over one call before it is given up."""


class Word(Enum):
    """What is heard of a worker: something it tells on the way, the result, an exception that the function raised, its end."""

    TOLD = "told"
    DONE = "done"
    FAILED = "failed"
    ENDED = "ended"


Heard: TypeAlias = "queue.SimpleQueue[tuple[Worker, Word, Any]]"
"""Where workers are heard: what each tells, in order; with `ENDED` comes the exit code, negative for a signal."""


def cores() -> int:
    """Cores this process may use.

    >>> cores() >= 1
    True
    """
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else (os.cpu_count() or 1)


def environment() -> dict[str, str]:
    """The caller's environment for a process of one thread that finds this package where the caller found it, with large pages of memory.

    >>> environment()["OMP_NUM_THREADS"]
    '1'
    """
    root = str(Path(__file__).resolve().parents[3])
    paths = [root, *map(os.path.abspath, filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep)))]
    return {**_MEMORY, **os.environ, **dict.fromkeys(_ONE_THREAD, "1"), "PYTHONPATH": os.pathsep.join(paths)}


class Worker:
    """A process that calls `function(line, *arguments)`; what it says is put into `heard`. Raises `OSError` where it cannot be started.

    `DesignError`, `MemoryError` and `OSError` come back as they are. Other exceptions end the process with code 1, and `last_words` tell.

    >>> worker = Worker(isinstance)
    >>> worker.call(Line), worker.end()
    (True, None)
    """

    def __init__(self, function: Callable[..., Any], heard: Heard | None = None) -> None:
        self.heard: Heard = queue.SimpleQueue() if heard is None else heard
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 (open as long as the process)
        try:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-c", _MAIN],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._log,
                env=environment(),
                cwd=tempfile.gettempdir(),  # for what libraries may leave there
                start_new_session=True,  # an interruption from the keyboard reaches the caller alone, which ends the process
            )
        except BaseException:
            self._log.close()
            raise
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()
        self._send(function)

    def ask(self, *arguments: Any) -> None:
        """Let it call its function, or answer what it waits for; heard at once where it has ended."""
        self._send(arguments)

    def call(self, *arguments: Any) -> Any:
        """The function's result, or the exception it raised, waited for by a worker that is heard by nobody else.

        Raises `EOFError` where it crashed or was ended. The process has ended then, as it has after an interruption.
        """
        try:
            self.ask(*arguments)
            _, word, value = self.heard.get()
            if word is Word.ENDED:
                raise EOFError
        except BaseException:
            self.end()
            raise
        if word is Word.FAILED:
            raise value
        return value

    def resident(self) -> float:
        """Memory it has [bytes]; 0 where the system does not tell."""
        try:
            import psutil

            return float(psutil.Process(self.process.pid).memory_info().rss)
        except Exception:  # noqa: BLE001 the system does not tell, in whatever way
            return 0.0

    def last_words(self) -> str:
        """The last line it wrote to its standard error."""
        self._log.seek(0)
        lines = self._log.read().decode(errors="replace").strip().splitlines()
        return lines[-1][:300] if lines else "it said nothing"

    def end(self) -> None:
        """End the process, whatever it does."""
        self.process.kill()
        self._listener.join()
        with contextlib.suppress(OSError):
            _as_pipe(self.process.stdin).close()
        self._log.close()

    def _send(self, value: Any) -> None:
        data = pickle.dumps(value)
        with contextlib.suppress(OSError, ValueError):  # it died, or was ended by another thread: heard soon
            _write(_as_pipe(self.process.stdin), data)

    def _listen(self) -> None:
        with _as_pipe(self.process.stdout) as answers, contextlib.suppress(EOFError):
            while True:
                self.heard.put((self, *pickle.loads(_read_frame(answers))))  # noqa: S301 (written by this module)
        self.heard.put((self, Word.ENDED, self.process.wait()))


@dataclass(frozen=True)
class CallError(Exception):
    """A call that failed: its arguments, and the exception; none where processes died over it again and again."""

    arguments: tuple[Any, ...]
    error: Exception | None


def results(function: Callable[..., Any], calls: Iterable[tuple[Any, ...]], workers: int) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """Arguments and result of each call of `function(line, *arguments)`, as it is done, by so many processes.

    The function is sent to each process once, the arguments as they come. A process that dies gives its call to another. Raises `CallError`
    where a call failed. When the iteration is left, all processes end.

    >>> sorted(result for _, result in results(isinstance, [(Line,), (int,)], 2))
    [False, True]
    """
    todo = deque((call, 0) for call in calls)
    heard: Heard = queue.SimpleQueue()
    busy: dict[Worker, tuple[tuple[Any, ...], int]] = {}

    def give(worker: Worker) -> None:
        busy[worker] = todo.popleft()
        worker.ask(*busy[worker][0])

    try:
        while todo or busy:
            while todo and len(busy) < workers:
                give(Worker(function, heard))
            worker, word, value = heard.get()
            if worker not in busy or word is Word.TOLD:
                continue
            call, deaths = busy.pop(worker)
            if word is Word.DONE and todo:
                give(worker)
            else:
                worker.end()
            if word is Word.DONE:
                yield call, value
            elif word is Word.FAILED or deaths + 1 == _LIVES:
                raise CallError(call, value if word is Word.FAILED else None)
            else:
                todo.append((call, deaths + 1))
    finally:
        for worker in busy:
            worker.end()


# --- the process itself ---


class Line:
    """What a function has of its caller: it may tell something on the way, and wait for an answer."""

    def __init__(self, asked: queue.SimpleQueue[bytes], answers: IO[bytes]) -> None:
        self._asked, self._answers = asked, answers

    def tell(self, value: Any) -> None:
        """Tell the caller."""
        self.say(Word.TOLD, value)

    def say(self, word: Word, value: Any) -> None:
        """Tell the caller, and what it is."""
        _write(self._answers, pickle.dumps((word, value)))

    def hear(self) -> Any:
        """What the caller sends next."""
        return pickle.loads(self._asked.get())  # noqa: S301 (written by the caller, whose process this is)


def limit_memory(most: float) -> None:
    """Let this process fail at so much memory [bytes] rather than take the machine's; it leaves no core files."""
    _limit("RLIMIT_CORE", 0)
    if most != float("inf"):
        _limit("RLIMIT_DATA", int(most))


def limit_processor(seconds: float) -> None:
    """Let the system end this process, by SIGXCPU, after so much more processor time [s]; a busy machine makes it live longer."""
    _limit("RLIMIT_CPU", math.ceil(time.process_time() + seconds))


def _limit(name: str, most: int) -> None:
    """Not where the system sets no such limits, and not above one that others set."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        kind = getattr(resource, name)
        resource.setrlimit(kind, (most, resource.getrlimit(kind)[1]))


def main() -> None:
    """Call as asked on standard input; what libraries print goes to standard error."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    faulthandler.enable()
    asked: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    line = Line(asked, os.fdopen(os.dup(1), "wb"))
    os.dup2(2, 1)
    threading.Thread(target=_listen, args=(asked,), daemon=True).start()
    try:
        _serve(line)
    except BaseException:  # noqa: BLE001 (whatever it is, this process is lost)
        traceback.print_exc()
        os._exit(1)  # an orderly end would wait for the thread that listens


def _serve(line: Line) -> None:
    function = line.hear()
    while True:
        try:
            line.say(Word.DONE, function(line, *line.hear()))
        except (DesignError, MemoryError, OSError) as error:
            line.say(Word.FAILED, error)


def _listen(asked: queue.SimpleQueue[bytes]) -> None:
    """Pass on what is asked until standard input closes: then nobody waits, and this process ends whatever it does."""
    with contextlib.suppress(EOFError):
        while True:
            asked.put(_read_frame(sys.stdin.buffer))
    os._exit(0)


def _read_frame(stream: IO[bytes]) -> bytes:
    return _read_exactly(stream, _LENGTH.unpack(_read_exactly(stream, _LENGTH.size))[0])


def _read_exactly(stream: IO[bytes], size: int) -> bytes:
    found = stream.read(size)
    if len(found) < size:
        raise EOFError
    return found


def _write(stream: IO[bytes], data: bytes) -> None:
    stream.write(_LENGTH.pack(len(data)))
    stream.write(data)
    stream.flush()


def _as_pipe(stream: IO[bytes] | None) -> IO[bytes]:
    return cast("IO[bytes]", stream)
