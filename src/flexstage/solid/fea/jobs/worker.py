"""Jobs of the solid model that run in a separate process: a crash or hang of CAD or mesher affects only that process."""

from __future__ import annotations

import faulthandler
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from flexstage.base.finding import Finding, require
from flexstage.base.processes.jobs import Line, limit_memory
from flexstage.solid.fea.jobs.install import require_solver
from flexstage.solid.fea.jobs.memory import Counts
from flexstage.solid.fea.jobs.progress import Report, Stage, silent

_SLACK, _SHARE = 5e8, 1.2
"""Memory [bytes] of libraries in addition to a job's planned memory, and the tolerance on the planned memory."""
USUAL_SECONDS = 2.0
"""Usual duration of a small job: a process that loads its libraries, draws and meshes."""
_PATIENCE = 60.0
"""Additional life time of a process without a caller [s]."""


@dataclass(frozen=True, eq=False)
class Call:
    """Environment of a job: the functions `report` for progress and `ask` for memory, and the number of the first `attempt` at a mesh.

    `ask` waits until enough memory for a mesh with the given counts is available.
    """

    report: Report = silent
    ask: Callable[[Counts], None] = lambda _counts: None
    attempt: int = 0


class Job(ABC):
    """Work for a separate process; the job and its result can be pickled."""

    attempts: int = 1
    """Number of attempts at a mesh: if an attempt crashes the process, the next attempt follows."""

    @property
    @abstractmethod
    def name(self) -> str:
        """The user's name for the component or hinge that the job computes."""

    @property
    def kin(self) -> str:
        """Key of similar jobs, which are faster in succession in one process; empty if there are no similar jobs."""
        return ""

    def seconds(self) -> float:
        """Return the usual CPU time [s]."""
        return USUAL_SECONDS

    @abstractmethod
    def work(self, call: Call) -> Any:
        """Compute the result."""

    def needed(self, _counts: Counts) -> float:
        """Return the memory [bytes] that the job needs for a mesh with the given counts."""
        return 0.0

    def refusal(self, _counts: Counts, _limit: float) -> Finding | None:
        """Return an error if the job does not fit into memory; the error names a smaller alternative."""
        return None


def work(line: Line, job: Job, attempt: int, memory: float, seconds: float) -> Any:
    """Run a job with limits of memory [bytes] and time [s]. Report the job's stages and mesh counts, and wait for memory for each mesh.

    Raises a `DesignError` with the remedy if the solver does not load.
    """

    def ask(counts: Counts) -> None:
        room = line.request_memory(job.needed(counts))
        require(filter(None, [None if room is None else job.refusal(counts, room)]))

    def report(stage: Stage, fraction: float) -> None:
        line.tell((stage, fraction))

    limit_memory(_SHARE * memory + _SLACK)
    faulthandler.dump_traceback_later(seconds + _PATIENCE, exit=True)  # in case compiled code holds the lock and the caller has ended
    try:
        return job.work(Call(report, ask, attempt))
    except (ImportError, OSError):
        require_solver()  # the missing module may be the solver
        raise
    finally:
        faulthandler.cancel_dump_traceback_later()
