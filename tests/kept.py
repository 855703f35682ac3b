"""Processes for jobs that tests keep for one another: to start one takes longer than most of the jobs it does."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from typing import Any

from flexstage.base.jobs import Heard, Word, Worker

_MOST, _LARGE = 2, 4e8
"""How many wait at a time, and none that has more memory than this [bytes]."""


class _Ear:
    """Passes on what a process says to the run that has it now; the process is free until it is asked, and when that is done."""

    def __init__(self, whom: Heard) -> None:
        self.whom, self.free = whom, True

    def put(self, said: tuple[Worker, Word, Any]) -> None:
        self.free = said[1] is Word.DONE
        self.whom.put(said)


class _Call:
    """Read in a process, the function that calls the function it is asked with."""

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[str]]:
        return eval, ("lambda line, function, *arguments: function(line, *arguments)",)


class KeptWorker(Worker):
    """A process that, ended when its job is done, waits for the next run instead."""

    def __init__(self, workers: Workers, function: Callable[..., Any], heard: Heard) -> None:
        self.workers, self.function, self.surroundings, self.ear = workers, function, _surroundings(), _Ear(heard)
        super().__init__(_Call(), self.ear)  # type: ignore[arg-type]

    def ask(self, *arguments: Any) -> None:
        begins, self.ear.free = self.ear.free, False
        super().ask(*(self.function,) * begins, *arguments)

    def end(self) -> None:
        if not self.workers.keeps(self):
            super().end()


class Workers:
    """Stands for `Worker`; those that wait are handed out again where nothing that a process has of this one has changed."""

    def __init__(self) -> None:
        self.surroundings, self.waiting, self.open = _surroundings(), list[KeptWorker](), True

    def __call__(self, function: Callable[..., Any], heard: Heard) -> Worker:
        while self.waiting and self.surroundings == _surroundings():
            worker = self.waiting.pop()
            if worker.process.poll() is None:
                worker.function, worker.ear.whom = function, heard
                return worker
            Worker.end(worker)
        return KeptWorker(self, function, heard)

    def keeps(self, worker: KeptWorker) -> bool:
        """Let it wait, if it can be of use."""
        useful = worker.ear.free and worker.surroundings == self.surroundings and worker.resident() < _LARGE
        if useful and self.open and len(self.waiting) < _MOST:
            self.waiting.append(worker)
            return True
        return False

    def end(self) -> None:
        """End those that wait, and from now on all."""
        self.open = False
        for worker in self.waiting:
            worker.end()


def _surroundings() -> dict[str, str]:
    """What a process has of this one, but for whose turn it is and where results are cached, which no job asks."""
    return {**os.environ, "PYTEST_CURRENT_TEST": "", "FLEXSTAGE_CACHE": "", "folder": tempfile.gettempdir()}
