"""Tasks of the studio's processes. Each is a function of the text, so that it can be repeated after a crash of its process."""

from __future__ import annotations

import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from importlib import import_module
from typing import Any

from flexstage.apps.studio.protocol import Problem
from flexstage.base.finding import DesignError, Finding
from flexstage.base.processes.jobs import Line
from flexstage.base.processes.threads import one_thread

_HERE = "flexstage.apps.studio"
TASKS: Mapping[str, str] = {
    "read": "design.reading:read",
    "write": "design.writing:write",
    "insert": "design.palette:insert",
    "gallery": "design.palette:gallery",
    "shipped": "design.palette:shipped",
    "place": "questions:place",
    "drag": "dragging:drag",
    "figures": "results:figures",
    "verdicts": "results:verdicts",
    "errors": "results:errors",
    "reach": "results:reach",
    "scene": "results:scene",
    "still": "results:still",
    "warnings": "results:warnings",
    "card": "questions:card",
    "motion": "questions:motion",
    "posed": "questions:posed",
    "slopes": "questions:slopes",
    "travelled": "travel:travelled",
    "freedoms": "questions:freedoms",
    "clearances": "questions:clearances",
    "solid_modes": "solids:solid_modes",
    "compared": "results:all_figures",
    "form": "forms:form",
    "specify": "forms:specify",
}
"""Tasks by name: module and function, imported at the first call."""
TELLING = frozenset({"travelled"})
"""Tasks with progress reports: their last argument receives them."""


@dataclass(frozen=True)
class Outcome:
    """Result of a task: its value, or the problems for which it was refused, and the CPU time [s]."""

    value: Any
    problems: tuple[Problem, ...]
    seconds: float


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
    start = time.process_time()
    try:
        own = (line.tell,) if task in TELLING else ()
        value, problems = _function(task)(*arguments, *own), ()
    except DesignError as error:
        value, problems = None, _located(error, arguments)
    except MemoryError:
        value, problems = None, (Problem(task, "not enough memory", "Close other programs, or make the design smaller"),)
    except Exception as error:  # noqa: BLE001 (a failed task must not stop the others)
        traceback.print_exc()
        value, problems = None, (failure(task, error),)
    seconds = time.process_time() - start
    if value is not None and hasattr(value, "milliseconds"):
        value = replace(value, milliseconds=1e3 * seconds)
    return Outcome(value, problems, seconds)


def _located(error: DesignError, arguments: tuple[Any, ...]) -> tuple[Problem, ...]:
    """Findings with their lines in the text, the first argument of tasks; the file is the second."""
    from flexstage.apps.studio.design.reading import problems_of

    return problems_of(error.findings, str(arguments[0]), str(arguments[1])) if len(arguments) > 1 else tuple(map(problem, error.findings))


@lru_cache
def _function(task: str) -> Any:
    module, _, name = TASKS[task].partition(":")
    return getattr(import_module(f"{_HERE}.{module}"), name)
