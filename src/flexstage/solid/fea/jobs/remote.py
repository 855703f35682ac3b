"""Jobs of the solid model in separate processes with time limits; as many jobs run at once as cores and memory allow.

One loop in the caller's thread starts, watches and ends the processes, so that an interruption ends all of them.
"""

from __future__ import annotations

import errno
import signal
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any, TypeVar

from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.processes.jobs import cores
from flexstage.base.processes.memory import available
from flexstage.base.processes.pool import PoolRun, ProcessPool, RunningCall, TimeLimitError
from flexstage.base.processes.progress import Progress, Step, seconds_left
from flexstage.solid.fea.jobs.progress import Stage, fraction_done
from flexstage.solid.fea.jobs.worker import Job, work

_MOST_WORKERS = 2
_TELL_EVERY = 0.5


@dataclass(frozen=True)
class Limits:
    """Limits of the resources of jobs.

    `memory` [bytes] limits the memory of all jobs together (default: the free memory). `seconds` limits the time of each job, and
    `mesh_seconds` the time of each attempt at a mesh. `workers` is the number of simultaneous jobs (default: one for each core, at most
    two).
    """

    memory: float | None = None
    seconds: float = 3600.0
    mesh_seconds: float = 600.0
    workers: int | None = None


AnyJob = TypeVar("AnyJob", bound=Job)


class Pool(ProcessPool):
    """Processes kept between groups of jobs, because loading the solver takes longer than a small job; `results` maps keys to results.

    The processes end when the context of the pool is left.

    >>> with Pool() as pool:
    ...     work_all([], print, Limits(), pool=pool)
    """

    def __init__(self) -> None:
        super().__init__(work)
        self.results: dict[str, Any] = {}


def work_all(
    jobs: Iterable[AnyJob],
    done: Callable[[AnyJob, Any], None],
    limits: Limits,
    progress: Progress | None = None,
    pool: Pool | None = None,
) -> None:
    """Run jobs in separate processes; `done` is called with each finished job and its result.

    The processes remain in the `pool` if one is specified. After all jobs, raises `DesignError` with the jobs that were refused, crashed,
    or exceeded time or memory. An exception from `progress` or an interruption ends all processes.

    >>> work_all([], print, Limits())
    """
    with nullcontext(pool) if pool is not None else Pool() as used:
        run = _Run(used, tuple(jobs), limits, progress)
        for job, found in run.results():
            done(job, found)
    require(dict.fromkeys(run.findings))


def workers(limits: Limits) -> int:
    """Return the number of simultaneous jobs.

    >>> workers(Limits(workers=1))
    1
    """
    return limits.workers or min(_MOST_WORKERS, cores())


class _Run(PoolRun):
    """The jobs of one call. Failures are collected; a mesh is attempted again after a crash or a timeout."""

    def __init__(self, pool: Pool, jobs: Sequence[Job], limits: Limits, progress: Progress | None) -> None:
        super().__init__(pool, jobs, workers(limits), limits.memory, limits.seconds)
        self.limits, self.progress = limits, progress
        self.findings: list[Finding] = []
        self.planned = sum(job.seconds() for job in jobs)
        self.begun, self.reported, self.text, self.fraction = time.monotonic(), 0.0, "", 0.0

    def start(self, call: Any, attempt: int, begun: float) -> None:
        """Start a job with limits of memory and time."""
        memory = available() if self.memory is None else self.memory
        try:
            self.launch(call, attempt, begun, (call, attempt, memory, self.seconds), call.kin)
        except OSError as error:
            what = f"no process could be started for it in {tempfile.gettempdir()} ({error.strerror})"
            advice = "Check that Python starts, and that the folder for temporary files (environment variable TMPDIR) has space"
            raise refuse(call.name, what, advice) from error

    def lost(self, running: RunningCall, cause: Exception | int) -> None:
        """Attempt a mesh again after a crash or a timeout of one, else keep the errors of the job."""
        stage, fraction = _stage(running)
        attempt = round(fraction * running.call.attempts) + 1
        repeatable = isinstance(cause, TimeLimitError) or (isinstance(cause, int) and cause != 1)
        in_time = super().time_limit(running) is None
        if repeatable and in_time and stage is Stage.MESHING and attempt < running.call.attempts:
            self.again(running, attempt)
        else:
            self.findings += _failure_findings(running, cause)

    def time_limit(self, running: RunningCall) -> float | None:
        """Return the time limit that an attempt at a mesh, or a job, exceeds."""
        meshes = _stage(running)[0] is Stage.MESHING and running.requested is None
        if meshes and time.monotonic() - running.since > self.limits.mesh_seconds:
            return self.limits.mesh_seconds
        return super().time_limit(running)

    def check(self) -> None:
        """Check times and memory, and report the progress."""
        super().check()
        text = ", ".join(f"{each.call.name}: {_stage(each)[0].value}" for each in self.running) or "done"
        now = time.monotonic()
        if self.progress is not None and (text != self.text or now - self.reported > _TELL_EVERY):
            left = sum(job.seconds() for job, _, _ in self.waiting)
            left += sum(each.call.seconds() * (1.0 - fraction_done(*_stage(each))) for each in self.running)
            self.text, self.reported, self.fraction = text, now, max(self.fraction, 1.0 - left / self.planned)
            self.progress(Step(text, self.fraction, seconds_left(self.fraction, now - self.begun)))


def _stage(running: RunningCall) -> tuple[Stage, float]:
    """The stage of a job that its process reported last, and its completed fraction."""
    return running.told or (Stage.STARTING, 0.0)


def _failure_findings(running: RunningCall, cause: Exception | int) -> tuple[Finding, ...]:
    """Errors of a job: those of its process, or the reason of its end."""
    name, doing = running.call.name, _stage(running)[0].value
    match cause:
        case DesignError():
            return cause.findings
        case TimeLimitError():
            what = f"it was still {doing} after the {cause.args[0]:.4g} s allowed"
            advice = "Use larger elements or a lower order, allow more time, or remove slivers, which can block the mesher"
        case MemoryError():
            what, advice = f"it exceeded its memory while {doing}", "Use larger elements or a lower order, or allow more memory"
        case OSError(errno=errno.ENOSPC | errno.EDQUOT):
            what = f"no space is left in the folder for temporary files, {tempfile.gettempdir()}"
            advice = "Free space, or set the environment variable TMPDIR to a folder with more space"
        case int() if cause != 1:
            tried = f", with {running.attempt + 1} sizes of elements" if running.attempt else ""
            what, advice = f"its process crashed while {doing} ({_reason(cause)}){tried}", _crash_advice(running, cause)
        case _:
            message = running.worker.last_words() if cause == 1 else f"{type(cause).__name__}: {cause}"
            what = f"its process failed while {doing} ({message})"
            advice = "Report this fault of flexstage or its solver with the design file; other element sizes may avoid it"
    return (Finding(name, what, advice),)


def _crash_advice(running: RunningCall, code: int) -> str:
    if _stage(running)[0] in {Stage.DRAWING, Stage.MESHING}:
        return "Change the outline or the elements' sizes a little: slivers and nearly touching faces crash the mesher"
    if code == -signal.SIGKILL:
        return "Use larger elements or a lower order, or a smaller --memory: the system probably ran out of memory"
    return "Use elements of another size or order; if the crash recurs, report it with the design file"


def _reason(code: int) -> str:
    names = {-number.value: number.name for number in signal.Signals}
    return names.get(code, f"exit code {code}")
