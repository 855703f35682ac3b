"""Jobs of the solid model in separate processes with time limits; as many jobs run at once as cores and memory allow.

One loop in the caller's thread starts, watches and ends the processes, so that an interruption ends all of them.
"""

from __future__ import annotations

import errno
import queue
import signal
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from typing import Any, Generic, Self, TypeVar

from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.processes.jobs import Heard, Word, Worker, cores
from flexstage.base.processes.memory import available
from flexstage.base.processes.progress import Progress, Step, seconds_left
from flexstage.solid.fea.jobs.memory import Counts
from flexstage.solid.fea.jobs.progress import Stage, fraction_done
from flexstage.solid.fea.jobs.worker import Job, work

_MOST_WORKERS = 2
_PAUSE = 0.02
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


class Pool:
    """Processes kept between groups of jobs, because loading the solver takes longer than a small job; `results` maps keys to results.

    The processes end when the context of the pool is left.

    >>> with Pool() as pool:
    ...     work_all([], print, Limits(), pool=pool)
    """

    def __init__(self) -> None:
        self.results: dict[str, Any] = {}
        self.heard: Heard = queue.SimpleQueue()
        self.idle: list[Worker] = []
        self._latest: dict[str, Worker] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        for worker in tuple(self.idle):
            self.end(worker)

    def worker(self, job: Job) -> Worker:
        """Return an idle process (preferably after a similar job) or a new process for a job. Raises `OSError` if no process can start."""
        for each in self.idle:
            if each.process.poll() is not None:
                self.end(each)
        found = self._latest.get(job.kin)
        if found is None or found not in self.idle:
            found = self.idle[-1] if self.idle else Worker(work, self.heard)
        self.idle = [each for each in self.idle if each is not found]
        if job.kin:
            self._latest[job.kin] = found
        return found

    def end(self, worker: Worker) -> None:
        """End a process, or remove it if it has ended already."""
        self.idle = [each for each in self.idle if each is not worker]
        self._latest = {kin: each for kin, each in self._latest.items() if each is not worker}
        worker.end()


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
        run = _Run(tuple(jobs), done, limits, progress or _ignore, used)
        try:
            run.finish()
        finally:
            run.end()
    require(dict.fromkeys(run.findings))


def _ignore(_step: Step) -> None:
    """Ignore the progress."""


def workers(limits: Limits) -> int:
    """Return the number of simultaneous jobs.

    >>> workers(Limits(workers=1))
    1
    """
    return limits.workers or min(_MOST_WORKERS, cores())


@dataclass(eq=False)
class _Child(Generic[AnyJob]):
    """A running worker and its last report."""

    job: AnyJob
    attempt: int
    begun: float
    worker: Worker
    stage: Stage = Stage.STARTING
    fraction: float = 0.0
    since: float = field(default_factory=time.monotonic)
    counts: Counts | None = None
    granted: float | None = None

    def note(self, report: Counts | tuple[Stage, float]) -> None:
        """Store its report."""
        if isinstance(report, Counts):
            self.counts, self.granted = report, None
        else:
            (self.stage, self.fraction), self.since = report, time.monotonic()

    @property
    def waits(self) -> bool:
        """Whether it waits for permission."""
        return self.counts is not None and self.granted is None

    @property
    def wanted(self) -> float:
        """Memory it will need [bytes]."""
        return 0.0 if self.counts is None else self.job.needed(self.counts)

    def permit(self) -> None:
        """Permit the assembly."""
        self.granted, self.since = self.wanted, time.monotonic()
        self.worker.ask()


class _Run(Generic[AnyJob]):
    """The jobs of one call: waiting, running, finished."""

    def __init__(self, jobs: Sequence[AnyJob], done: Callable[[AnyJob, Any], None], limits: Limits, progress: Progress, pool: Pool) -> None:
        self.done, self.limits, self.progress, self.pool = done, limits, progress, pool
        self.waiting = [(job, 0, time.monotonic()) for job in jobs]
        self.children: list[_Child[AnyJob]] = []
        self.findings: list[Finding] = []
        self.planned = {job.mark: job.seconds() for job in jobs}
        self.finished: list[str] = []
        self.begun, self.told, self.text, self.fraction = time.monotonic(), 0.0, "", 0.0

    def finish(self) -> None:
        """Run until no job waits or runs."""
        while self.waiting or self.children:
            while self.waiting and len(self.children) < workers(self.limits):
                self._start(*self.waiting.pop(0))
            self._hear()
            for child in tuple(self.children):
                self._check_time(child)
            self._permit()
            self._tell()

    def end(self) -> None:
        """End all processes."""
        for child in self.children:
            self.pool.end(child.worker)

    def _start(self, job: AnyJob, attempt: int, begun: float) -> None:
        memory = available() if self.limits.memory is None else self.limits.memory
        try:
            worker = self.pool.worker(job)
        except OSError as error:
            raise _refuse_start(job.name, error) from error
        self.children.append(_Child(job, attempt, begun if attempt else time.monotonic(), worker))
        worker.ask(job, attempt, memory, self.limits.seconds)

    def _hear(self) -> None:
        """Receive the reports of the workers, waiting briefly."""
        try:
            worker, word, value = self.pool.heard.get(timeout=_PAUSE)
        except queue.Empty:
            return
        for child in self.children:
            if child.worker is worker:
                self._take(child, word, value)
                return
        if word is Word.ENDED:
            self.pool.end(worker)

    def _take(self, child: _Child[AnyJob], word: Word, value: Any) -> None:
        match word:
            case Word.TOLD:
                child.note(value)
            case Word.DONE:
                self.done(child.job, value)
                self._leave(child)
                self.pool.idle.append(child.worker)
            case Word.FAILED:
                self._close(child, *_failure_findings(child, value))
            case Word.ENDED:
                if value == 1 or not self._again(child):
                    self._close(child, _failure(child, value))

    def _check_time(self, child: _Child[AnyJob]) -> None:
        now = time.monotonic()
        if child.stage is Stage.MESHING and not child.waits and now - child.since > self.limits.mesh_seconds:
            if not self._again(child):
                self._close(child, _out_of_time(child, self.limits.mesh_seconds))
        elif now - child.begun > self.limits.seconds:
            self._close(child, _out_of_time(child, self.limits.seconds))

    def _again(self, child: _Child[AnyJob]) -> bool:
        """Start the next attempt at a mesh after a crash or a timeout of one."""
        attempt = round(child.fraction * child.job.attempts) + 1
        if child.stage is not Stage.MESHING or attempt >= child.job.attempts:
            return False
        self.children.remove(child)
        self.pool.end(child.worker)
        self.waiting.insert(0, (child.job, attempt, child.begun))
        return True

    def _close(self, child: _Child[AnyJob], *findings: Finding) -> None:
        self.findings += findings
        self._leave(child)
        self.pool.end(child.worker)

    def _leave(self, child: _Child[AnyJob]) -> None:
        self.finished.append(child.job.mark)
        self.children.remove(child)

    def _permit(self) -> None:
        """Permit jobs that fit next to the running ones; refuse those that do not fit alone."""
        for child in tuple(self.children):
            if child.counts is None or not child.waits:
                continue
            others = [each for each in self.children if each.granted is not None]
            finding = child.job.refusal(child.counts, self._room(child, others))
            if finding is None:
                child.permit()
            elif not others:
                self._close(child, finding)

    def _room(self, child: _Child[AnyJob], others: list[_Child[AnyJob]]) -> float:
        if self.limits.memory is not None:
            return self.limits.memory - sum(each.granted or 0.0 for each in others)
        return available() + child.worker.resident() - sum(max(0.0, (each.granted or 0.0) - each.worker.resident()) for each in others)

    def _tell(self) -> None:
        text = ", ".join(f"{child.job.name}: {child.stage.value}" for child in self.children) or "done"
        now = time.monotonic()
        if text != self.text or now - self.told > _TELL_EVERY:
            self.text, self.told = text, now
            self.fraction = max(self.fraction, self._fraction_done())
            self.progress(Step(text, self.fraction, seconds_left(self.fraction, now - self.begun)))

    def _fraction_done(self) -> float:
        """Completed fraction of the time of all jobs, by their usual durations."""
        done = sum(self.planned[mark] for mark in self.finished)
        done += sum(self.planned[child.job.mark] * fraction_done(child.stage, child.fraction) for child in self.children)
        return done / sum(self.planned.values())


def _failure_findings(child: _Child[AnyJob], error: Exception) -> tuple[Finding, ...]:
    """Errors of a job reported by its process."""
    if isinstance(error, DesignError):
        return error.findings
    if isinstance(error, MemoryError):
        return (_memory_full(child),)
    if isinstance(error, OSError) and error.errno in {errno.ENOSPC, errno.EDQUOT}:
        return (_disk_full(child.job.name),)
    return (_fault(child, f"{type(error).__name__}: {error}"),)


def _failure(child: _Child[AnyJob], code: int) -> Finding:
    doing = child.stage.value
    if code == 1:
        return _fault(child, child.worker.last_words())
    tried = f", with {child.attempt + 1} sizes of elements" if child.attempt else ""
    advice = "Use elements of another size or order; if the crash recurs, report it with the design file"
    if child.stage in {Stage.DRAWING, Stage.MESHING}:
        advice = "Change the outline or the elements' sizes a little: slivers and nearly touching faces crash the mesher"
    elif code == -signal.SIGKILL:
        advice = "Use larger elements or a lower order, or a smaller --memory: the system probably ran out of memory"
    return Finding(child.job.name, f"its process crashed while {doing} ({_reason(code)}){tried}", advice)


def _fault(child: _Child[AnyJob], message: str) -> Finding:
    advice = "Report this fault of flexstage or its solver with the design file; other element sizes may avoid it"
    return Finding(child.job.name, f"its process failed while {child.stage.value} ({message})", advice)


def _reason(code: int) -> str:
    names = {-number.value: number.name for number in signal.Signals}
    return names.get(code, f"exit code {code}")


def _out_of_time(child: _Child[AnyJob], seconds: float) -> Finding:
    advice = "Use larger elements or a lower order, allow more time, or remove slivers, which can block the mesher"
    return Finding(child.job.name, f"it was still {child.stage.value} after the {seconds:.4g} s allowed", advice)


def _memory_full(child: _Child[AnyJob]) -> Finding:
    advice = "Use larger elements or a lower order, or allow more memory"
    return Finding(child.job.name, f"it exceeded its memory while {child.stage.value}", advice)


def _disk_full(name: str) -> Finding:
    advice = "Free space, or set the environment variable TMPDIR to a folder with more space"
    return Finding(name, f"no space is left in the folder for temporary files, {tempfile.gettempdir()}", advice)


def _refuse_start(name: str, error: OSError) -> Exception:
    where = tempfile.gettempdir()
    advice = "Check that Python starts, and that the folder for temporary files (environment variable TMPDIR) has space"
    return refuse(name, f"no process could be started for it in {where} ({error.strerror})", advice)
