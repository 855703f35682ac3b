"""What the studio's processes compute, task by task: each a function of the text, so that a process that dies is simply started anew."""

from __future__ import annotations

import time
import traceback
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import import_module
from typing import Any

from flexstage.base.finding import DesignError, Finding
from flexstage.base.jobs import Line
from flexstage.base.threads import one_thread

_HERE = "flexstage.apps.studio"
TASKS: Mapping[str, str] = {
    "read": "reading:read",
    "problems": "reading:problems_of",
    "write": "writing:write",
    "insert": "palette:insert",
    "place": "questions:place",
    "fit": "dragging:fit",
    "drag": "dragging:drag",
    "figures": "results:figures",
    "verdicts": "results:verdicts",
    "reach": "results:reach",
    "scene": "results:scene",
    "cautions": "results:cautions",
    "card": "questions:card",
    "motion": "questions:motion",
    "posed": "questions:posed",
    "slopes": "questions:slopes",
    "freedoms": "questions:freedoms",
    "clearances": "questions:clearances",
    "compared": "results:all_figures",
}
"""Tasks by name: module and function, imported when first asked for."""


@dataclass(frozen=True)
class Outcome:
    """What came of a task: its value, or the findings that refused it; processor time spent [s]."""

    value: Any
    findings: tuple[Finding, ...]
    seconds: float


@one_thread
def work(_: Line, task: str, *arguments: Any) -> Outcome:
    """Do a task; what goes wrong is told, whatever it is."""
    start = time.process_time()
    try:
        value, findings = _function(task)(*arguments), ()
    except DesignError as error:
        value, findings = None, error.findings
    except MemoryError:
        value, findings = None, (Finding(task, "there is not enough memory for it", "Close other programs, or make the design smaller"),)
    except Exception as error:  # noqa: BLE001 (one question that fails is no reason to lose the others)
        traceback.print_exc()
        what = f"flexstage failed at it, and that is its fault, not your design's: {type(error).__name__}: {error}"
        value, findings = None, (Finding(task, what, "Save the design, and report it with this message"),)
    return Outcome(value, findings, time.process_time() - start)


@lru_cache
def _function(task: str) -> Any:
    module, _, name = TASKS[task].partition(":")
    return getattr(import_module(f"{_HERE}.{module}"), name)
