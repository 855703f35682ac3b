"""Pool of worker processes: calls run in parallel, with repetition after a crash, time limits, and permits for memory."""

from __future__ import annotations

import math
import queue
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, Self

from flexstage.base.processes.jobs import Heard, Word, Worker
from flexstage.base.processes.memory import available

_LIVES = 3
"""Number of processes that may fail in one call."""
_PAUSE = 0.02
"""Interval of the checks of time limits and memory [s]."""


@dataclass(frozen=True)
class CallError(Exception):
    """Failed call: its arguments, and its exception (`None` if its processes died repeatedly)."""

    arguments: Any
    error: Exception | None


class TimeLimitError(Exception):
    """Error for a call that exceeds a time limit [s], its argument."""


def results(function: Callable[..., Any], calls: Iterable[tuple[Any, ...]], workers: int) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """Yield (arguments, result) of each call of `function(line, *arguments)` in order of completion, from `workers` processes.

    Each process receives the function once, then the arguments of each call. If a process dies, another process repeats its call. Raises
    `CallError` for a failed call. All processes are ended when the iteration ends.

    >>> from flexstage.base.processes.jobs import Line
    >>> sorted(result for _, result in results(isinstance, [(Line,), (int,)], 2))
    [False, True]
    """
    with ProcessPool(function) as pool:
        yield from PoolRun(pool, calls, workers).results()


class ProcessPool:
    """Processes that call `function(line, *arguments)`, kept between runs; they end when the context of the pool is left."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self.function = function
        self.heard: Heard = queue.SimpleQueue()
        self.idle: list[Worker] = []
        self._lock = threading.Lock()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        for worker in self.idle:
            worker.end()

    def call(self, *arguments: Any) -> Any:
        """Call the function in a process that stays, one call at a time; returns the result or raises the errors of `Worker.call`."""
        with self._lock:
            worker = self.worker("")
            try:
                return worker.call(*arguments)
            finally:
                if worker.process.poll() is None:
                    self.idle.append(worker)

    def worker(self, kin: str) -> Worker:
        """Return an idle process, preferably one that had a call of the same `kin`, or a new one; raises `OSError` if none can start."""
        while self.idle:
            found = next((each for each in self.idle if kin in each.kins), self.idle[-1])
            self.idle.remove(found)
            if found.process.poll() is None:
                break
            found.end()
        else:
            found = Worker(self.function, self.heard)
        found.kins.add(kin)
        return found


@dataclass(eq=False)
class RunningCall:
    """A call in its process: the time of its start, its last message and the time of that message, requested and granted memory [bytes]."""

    call: Any
    attempt: int
    begun: float
    worker: Worker
    told: Any = None
    since: float = field(default_factory=time.monotonic)
    requested: float | None = None
    granted: float = 0.0


class PoolRun:
    """Calls in processes of a pool, at most `workers` at once. A process that dies is replaced, a call that fails raises `CallError`.

    `memory` [bytes] limits the memory that all calls request together (`None`: the free memory), `seconds` the time of each call.
    """

    def __init__(
        self, pool: ProcessPool, calls: Iterable[Any], workers: int, memory: float | None = None, seconds: float = math.inf
    ) -> None:
        self.pool, self.workers, self.memory, self.seconds = pool, workers, memory, seconds
        self.waiting = deque((call, 0, 0.0) for call in calls)
        self.running: list[RunningCall] = []

    def results(self) -> Iterator[tuple[Any, Any]]:
        """Yield each call with its result. After an exception, or if the iteration ends early, the busy processes are ended."""
        try:
            while self.waiting or self.running:
                while self.waiting and len(self.running) < self.workers:
                    self.start(*self.waiting.popleft())
                yield from self._hear()
                self.check()
        finally:
            for each in self.running:
                each.worker.end()

    def start(self, call: Any, attempt: int, begun: float) -> None:
        """Start a call in a process."""
        self.launch(call, attempt, begun, call)

    def launch(self, call: Any, attempt: int, begun: float, arguments: tuple[Any, ...], kin: str = "") -> None:
        """Start a call with `arguments` in a process, preferably after a call of the same `kin`."""
        worker = self.pool.worker(kin)
        self.running.append(RunningCall(call, attempt, begun if attempt else time.monotonic(), worker))
        worker.ask(*arguments)

    def again(self, running: RunningCall, attempt: int) -> None:
        """Repeat a call in another process."""
        self.waiting.appendleft((running.call, attempt, running.begun))

    def lost(self, running: RunningCall, cause: Exception | int) -> None:
        """Repeat a call or report its failure; `cause` is its exception, or the exit code of its process."""
        error = cause if isinstance(cause, Exception) else None
        if error is not None or running.attempt + 1 == _LIVES:
            raise CallError(running.call, error)
        self.again(running, running.attempt + 1)

    def time_limit(self, running: RunningCall) -> float | None:
        """Return the time limit [s] that a call exceeds, or `None`."""
        return self.seconds if time.monotonic() - running.begun > self.seconds else None

    def check(self) -> None:
        """End the calls that exceed their time; grant requested memory, and decline it if it is too much for a call alone."""
        for each in tuple(self.running):
            if (limit := self.time_limit(each)) is not None:
                self._drop(each, TimeLimitError(limit))
        for each in self.running:
            if each.requested is None:
                continue
            others = [other for other in self.running if other.granted]
            room = self.room(each, others)
            if fits := each.requested <= room:
                each.granted = each.requested
            if fits or not others:
                each.requested, each.since = None, time.monotonic()
                each.worker.ask(None if fits else room)

    def room(self, running: RunningCall, others: Iterable[RunningCall]) -> float:
        """Return the memory [bytes] that a call may have while `others` have theirs."""
        if self.memory is not None:
            return self.memory - sum(each.granted for each in others)
        return available() + running.worker.resident() - sum(max(0.0, each.granted - each.worker.resident()) for each in others)

    def _hear(self) -> Iterator[tuple[Any, Any]]:
        """Take a message of a worker, waiting briefly; yields the result of a finished call."""
        try:
            worker, word, value = self.pool.heard.get(timeout=_PAUSE)
        except queue.Empty:
            return
        running = next((each for each in self.running if each.worker is worker), None)
        if running is None:  # an idle process has ended
            return
        if word is Word.REQUEST:
            running.requested, running.granted = value, 0.0
        elif word is Word.TOLD:
            running.told, running.since = value, time.monotonic()
        elif word is Word.DONE:
            self.running.remove(running)
            self.pool.idle.append(worker)
            yield running.call, value
        else:
            self._drop(running, value)

    def _drop(self, running: RunningCall, cause: Exception | int) -> None:
        """Give up a running call, and end its process."""
        self.lost(running, cause)
        self.running.remove(running)
        running.worker.end()
