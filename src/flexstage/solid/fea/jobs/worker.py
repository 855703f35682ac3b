"""Jobs of the solid model, and what a process does with one: CAD and mesher may crash or hang; there they take nothing with them."""

from __future__ import annotations

import faulthandler
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from flexstage.base.finding import Finding
from flexstage.base.processes.jobs import Line, limit_memory
from flexstage.solid.fea.jobs.install import require_solver
from flexstage.solid.fea.jobs.memory import Counts
from flexstage.solid.fea.jobs.progress import Report, Stage, silent

_SLACK, _SHARE = 5e8, 1.2
"""What libraries take beyond a job's own memory [bytes], and how much more it may take than was planned with."""
USUAL_SECONDS = 2.0
"""What a small job takes: a process that loads its libraries, draws and meshes."""
_PATIENCE = 60.0
"""How much longer than allowed it lives if nobody ends it [s]."""


@dataclass(frozen=True, eq=False)
class Call:
    """What a job is given where it works: whom to tell, whom to ask for memory, which attempt at a mesh to begin with.

    `ask` waits until there is room for a mesh, expected or made.
    """

    report: Report = silent
    ask: Callable[[Counts], None] = lambda _counts: None
    attempt: int = 0


class Job(ABC):
    """Work for a process of its own: a value that can be pickled, with a result that can be."""

    attempts: int = 1
    """How many attempts at a mesh can be told apart by their number, so that one that takes the process down is followed by the next."""

    @property
    @abstractmethod
    def name(self) -> str:
        """What it works on, as the user knows it."""

    @property
    def mark(self) -> str:
        """What it is told apart by from all others."""
        return self.name

    @property
    def kin(self) -> str:
        """What it shares with jobs that a process does sooner when it did the like before; nothing where that does not matter."""
        return ""

    def seconds(self, _counts: Counts | None = None) -> float:
        """What it usually takes on one core [s], before or after its mesh is known."""
        return USUAL_SECONDS

    def spared(self) -> float:
        """How much less it usually takes [s] by a process that did the like before."""
        return 0.0

    @abstractmethod
    def work(self, call: Call) -> Any:
        """Do it."""

    def needed(self, _counts: Counts) -> float:
        """Memory it is going to need for a mesh [bytes]."""
        return 0.0

    def refusal(self, _counts: Counts, _limit: float) -> Finding | None:
        """Why it does not fit into memory, with a smaller suggestion."""
        return None


def work(line: Line, job: Job, attempt: int, memory: float, seconds: float) -> Any:
    """Do a job within a memory [bytes] and a time [s]: report stages and counts of meshes, and wait for room for each mesh.

    Raises a `DesignError` that names the remedy if the solver does not load.
    """

    def ask(counts: Counts) -> None:
        line.tell(counts)
        line.hear()

    def report(stage: Stage, fraction: float) -> None:
        line.tell((stage, fraction))

    limit_memory(_SHARE * memory + _SLACK)
    faulthandler.dump_traceback_later(seconds + _PATIENCE, exit=True)  # should compiled code keep the lock and the caller be gone
    try:
        return job.work(Call(report, ask, attempt))
    except (ImportError, OSError):
        require_solver()  # what did not load may be the solver
        raise
    finally:
        faulthandler.cancel_dump_traceback_later()
