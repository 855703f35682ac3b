"""Progress bar of a long computation on stderr: step, fraction, remaining time. If stderr is not a terminal, nothing is printed."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Generator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

from flexstage.base.processes.progress import LINE, LINES, RESULT, Step, seconds_left
from flexstage.base.text import printable


class ProgressBar:
    """A progress bar; `left` is the remaining time at the last step [s]."""

    def __init__(self, shown: Any | None) -> None:
        self._shown = shown
        self._task = None if shown is None else shown.add_task("starting", total=1.0, left="")
        self._begun = time.monotonic()
        self.left: float | None = None

    def step(self, step: Step) -> None:
        """Show a step of a computation."""
        self.left = step.left
        self._show(step.text, step.fraction)

    def share(self, text: str, share: float) -> None:
        """Show the completed fraction of a computation, and the remaining time estimated from it."""
        self.step(Step(text, share, seconds_left(share, time.monotonic() - self._begun)))

    def result(self, name: str, value: Any) -> None:
        """Ignore a partial result, which `ProgressLines` prints."""

    def _show(self, text: str, fraction: float) -> None:
        if self._shown is not None:
            left = "" if self.left is None else f"{_clock(self.left)} left"
            self._shown.update(self._task, description=printable(text), completed=fraction, left=left)


class ProgressLines(ProgressBar):
    """Progress as lines on stderr for other programs: the word `progress`, the fraction, remaining seconds or a dash, and a text.

    A partial result is a line with the word `result` and JSON.
    """

    def __init__(self) -> None:
        super().__init__(None)

    def result(self, name: str, value: Any) -> None:
        """Print a partial result."""
        print(f"{RESULT} {json.dumps({name: value})}", file=sys.stderr, flush=True)  # noqa: T201

    def _show(self, text: str, fraction: float) -> None:
        left = "-" if self.left is None else f"{self.left:.1f}"
        print(f"{LINE} {fraction:.4f} {left} {printable(text)}", file=sys.stderr, flush=True)  # noqa: T201


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"


@contextmanager
def progress_bar() -> Generator[ProgressBar]:
    """Provide a progress bar that is removed at the end, or `ProgressLines` if the environment contains `FLEXSTAGE_PROGRESS=lines`."""
    if os.environ.get(LINES):
        yield ProgressLines()
        return
    console = Console(file=sys.stderr)
    if not console.is_terminal:
        yield ProgressBar(None)
        return
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TaskProgressColumn(), TextColumn("{task.fields[left]}"))
    with Progress(*columns, console=console, transient=True) as shown:
        yield ProgressBar(shown)
