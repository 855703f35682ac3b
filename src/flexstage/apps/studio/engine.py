"""Tasks of the studio's processes. Each is a function of the text, so that it can be repeated after a crash of its process."""

from __future__ import annotations

import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any

from flexstage.apps.studio.protocol import Problem
from flexstage.base.finding import DesignError, Finding
from flexstage.base.processes.jobs import Line
from flexstage.base.processes.threads import one_thread

_HERE = "flexstage.apps.studio"
_MODULES = {
    "design.reading": "read",
    "design.writing": "write",
    "design.palette": "insert gallery shipped",
    "dragging": "drag",
    "results": "figures verdicts errors reach scene still warnings all_figures",
    "questions": "place card motion posed slopes freedoms clearances",
    "travel": "travelled",
    "solids": "solid_modes",
    "forms": "form specify",
}
TASKS: Mapping[str, str] = {name: f"{module}:{name}" for module, names in _MODULES.items() for name in names.split()}
"""Tasks by name: module and function, imported at the first call."""
TELLING = frozenset({"travelled"})
"""Tasks with progress reports: their last argument receives them."""


@dataclass(frozen=True)
class Outcome:
    """Result of a task: its value, or the problems for which it was refused, and the CPU time [s]."""

    value: Any = None
    problems: tuple[Problem, ...] = ()
    seconds: float = 0.0


def problem(finding: Finding) -> Problem:
    """Return a finding as a message, without a position in the text."""
    return Problem(finding.where, finding.what, finding.advice)


def failure(task: str, error: Exception) -> Problem:
    """Return an error of the program itself as a message."""
    what = f"internal error of flexstage, not caused by your design: {type(error).__name__}: {error}"
    return Problem(task, what, "Save the design, and report it with this message")


@one_thread
def work(line: Line, task: str, *arguments: Any) -> Outcome:
    """Run a task and report any error."""
    start, value, problems = time.process_time(), None, ()
    try:
        own = (line.tell,) if task in TELLING else ()
        value = _function(task)(*arguments, *own)
    except DesignError as error:
        problems = _located(error, arguments)
    except MemoryError:
        problems = (Problem(task, "not enough memory", "Close other programs, or make the design smaller"),)
    except Exception as error:  # noqa: BLE001 (a failed task must not stop the others)
        traceback.print_exc()
        problems = (failure(task, error),)
    seconds = time.process_time() - start
    if value is not None and hasattr(value, "milliseconds"):
        value = replace(value, milliseconds=1e3 * seconds)
    return Outcome(value, problems, seconds)


def _located(error: DesignError, arguments: tuple[Any, ...]) -> tuple[Problem, ...]:
    """Findings with their lines in the text, the first argument of tasks; the file is the second."""
    from flexstage.apps.studio.design.reading import problems_of

    return problems_of(error.findings, str(arguments[0]), str(arguments[1])) if len(arguments) > 1 else tuple(map(problem, error.findings))


def _function(task: str) -> Any:
    module, _, name = TASKS[task].partition(":")
    return getattr(import_module(f"{_HERE}.{module}"), name)
