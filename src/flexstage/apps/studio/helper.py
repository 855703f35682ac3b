"""A process of the studio's server. It runs one task after another, the most urgent first, and is restarted after a crash."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import queue
import threading
import time
from collections.abc import Callable
from enum import IntEnum
from typing import Any, NamedTuple

from flexstage.apps.studio.engine import Outcome, problem, work
from flexstage.apps.studio.protocol import Problem
from flexstage.base.processes.jobs import Heard, Word, Worker

_AGAIN = "The process is restarted; try again, and report a second failure"


class Urgency(IntEnum):
    """Priority of a task."""

    NOW = 0
    """Tasks with a waiting user."""
    SOON = 1
    """Figures of the present design."""
    LATER = 2
    """Tasks without urgency."""


class _Task(NamedTuple):
    """A task, sorted by its urgency, then by its unique number."""

    urgency: Urgency
    number: int
    call: tuple[Any, ...]
    answer: asyncio.Future[Outcome | None]
    wanted: Callable[[], bool]
    heard: Callable[[Any], None]


def always() -> bool:
    """Run a task in any case."""
    return True


def nobody(_: Any) -> None:
    """Ignore the reports of a task."""


class Helper:
    """A process that runs tasks. If the process crashes, `died` is called with its last message."""

    def __init__(self, died: Callable[[str], None]) -> None:
        self._died = died
        self._numbers = itertools.count()
        self._waiting: asyncio.PriorityQueue[_Task] = asyncio.PriorityQueue()
        self._worker: Worker | None = None
        self._now: tuple[_Task, asyncio.Future[Outcome]] | None = None
        self._since = 0.0
        self._given_up = False
        self._runner: asyncio.Task[None] | None = None
        self.spent = 0.0
        """Processor time of all tasks [s]."""

    @property
    def process(self) -> int | None:
        """Identifier of the process (PID), or None if it does not run."""
        return None if self._worker is None else self._worker.process.pid

    def busy(self, urgency: Urgency) -> float:
        """Return the time since the start of the present task [s]; zero if the present task has another urgency."""
        return time.monotonic() - self._since if self._now is not None and self._now[0].urgency == urgency else 0.0

    async def ask(
        self,
        *call: Any,
        urgency: Urgency = Urgency.NOW,
        wanted: Callable[[], bool] = always,
        heard: Callable[[Any], None] = nobody,
    ) -> Outcome | None:
        """Run a task with its arguments, after more urgent tasks, and return its outcome.

        Returns None if the task is no longer `wanted` when its turn comes. `heard` is called with the reports of the task.
        """
        if self._runner is None:
            self._runner = asyncio.create_task(self._run())
        answer: asyncio.Future[Outcome | None] = asyncio.get_running_loop().create_future()
        self._waiting.put_nowait(_Task(urgency, next(self._numbers), call, answer, wanted, heard))
        return await answer

    def start_anew(self) -> None:
        """Abort the present task: the process is killed, and started again for the next task."""
        if self._worker is not None and self._now is not None:
            self._given_up = True
            self._worker.process.kill()

    async def close(self) -> None:
        """End the process."""
        if self._runner is not None:
            self._runner.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._runner
        worker, self._worker = self._worker, None
        if worker is not None:
            await asyncio.to_thread(worker.end)

    async def _run(self) -> None:
        while True:
            task = await self._waiting.get()
            if task.answer.cancelled():
                continue
            if not task.wanted():
                task.answer.set_result(None)
                continue
            outcome = await self._do(task)
            self.spent += 0.0 if outcome is None else outcome.seconds
            if not task.answer.done():
                task.answer.set_result(outcome)

    async def _do(self, task: _Task) -> Outcome | None:
        """The result of a task; after a crash of the process, a problem; nothing for an aborted task.

        A crash after other tasks may have another cause: the task is then repeated in a new process.
        """
        is_new = self._worker is None
        try:
            return await self._attempt(task)
        except EOFError as error:
            if self._given_up:
                return None
            if not is_new:
                return await self._do(task)
            return _failed(task, f"the computing process ended: {error}")
        except OSError as error:
            return _failed(task, f"the system cannot start a computing process: {error}")
        finally:
            self._now, self._given_up = None, False

    async def _attempt(self, task: _Task) -> Outcome:
        """The result of a task; raises `EOFError` if the process ends during it, `OSError` if none starts."""
        done: asyncio.Future[Outcome] = asyncio.get_running_loop().create_future()
        self._now, self._since = (task, done), time.monotonic()
        if self._worker is None:
            self._worker = self._start()
        await asyncio.to_thread(self._worker.ask, *task.call)
        return await done

    def _start(self) -> Worker:
        heard: Heard = queue.SimpleQueue()
        loop = asyncio.get_running_loop()
        worker = Worker(work, heard)
        threading.Thread(target=_pass_on, args=(heard, loop, self._hear), daemon=True).start()
        return worker

    def _hear(self, worker: Worker, word: Word, value: Any) -> None:
        """Handle a report of a process, in the loop's thread."""
        waits = self._now[1] if self._now is not None and worker is self._worker else None
        if word is Word.ENDED and worker is self._worker:
            self._worker, words = None, worker.last_words()
            worker.end()
            if not self._given_up:
                self._died(words)
            if waits is not None and not waits.done():
                waits.set_exception(EOFError(words))
        elif word is Word.TOLD and self._now is not None and worker is self._worker:
            self._now[0].heard(value)
        elif waits is not None and not waits.done():
            waits.set_result(value if word is Word.DONE else Outcome(problems=tuple(map(problem, getattr(value, "findings", ())))))


def _failed(task: _Task, what: str) -> Outcome:
    return Outcome(problems=(Problem(str(task.call[0]), what, _AGAIN),))


def _pass_on(heard: Heard, loop: asyncio.AbstractEventLoop, hear: Callable[[Worker, Word, Any], None]) -> None:
    """Forward the reports of a process to the loop, until it ends."""
    while True:
        worker, word, value = heard.get()
        with contextlib.suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(hear, worker, word, value)
        if word is Word.ENDED:
            return
