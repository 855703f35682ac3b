"""Jobs of the solid model in processes of their own: as many at once as cores and memory allow, with time limits, watched and cleaned up.

One loop in the caller's thread starts, watches and ends them, so that it works from bare scripts, notebooks and tests alike, and so that
an interruption, wherever it comes, ends every process and removes every file of a job that is not finished.
"""

from __future__ import annotations

import contextlib
import json
import pickle
import shutil
import signal
import subprocess
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Generic, TypeVar, cast

from flexstage.base.child import command, cores, environment
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.memory import available
from flexstage.base.progress import Progress, Step, seconds_left
from flexstage.base.store import temporary
from flexstage.solid.fea.memory import Counts
from flexstage.solid.fea.progress import Stage, gathered
from flexstage.solid.fea.store import versions
from flexstage.solid.fea.worker import FINDINGS, PROGRESS, RESULT, TASK, Job, Outcome, Task, findings_in

_MOST_WORKERS = 2
_PAUSE = 0.02
_TELL_EVERY = 0.5


@dataclass(frozen=True)
class Limits:
    """What jobs may take.

    `memory` in all [bytes] (absent: what the machine has left), `seconds` each, `mesh_seconds` for one attempt at a mesh, and
    `workers` at once (absent: one a core, two at most).
    """

    memory: float | None = None
    seconds: float = 3600.0
    mesh_seconds: float = 600.0
    workers: int | None = None


AnyJob = TypeVar("AnyJob", bound=Job)


def work_all(jobs: Iterable[AnyJob], done: Callable[[AnyJob, bytes], None], limits: Limits, progress: Progress | None = None) -> None:
    """Do jobs in processes of their own; `done` is told of each as it is finished, with its result.

    Raises `DesignError` with the findings of all that failed, after the others are done: refused by themselves, crashed, out of time,
    without room. Raising from `progress` or an interruption ends all.

    >>> work_all([], print, Limits())
    """
    run = _Run(deque((job, 0, time.monotonic()) for job in jobs), done, limits, progress or _nobody)
    try:
        run.finish()
    finally:
        run.end()
    require(run.findings)


def _nobody(_step: Step) -> None:
    """Nobody is told."""


def workers(limits: Limits) -> int:
    """How many jobs are done at once.

    >>> workers(Limits(workers=1))
    1
    """
    return limits.workers or min(_MOST_WORKERS, cores())


@dataclass(eq=False)
class _Child(Generic[AnyJob]):
    """A running worker and what it said last."""

    job: AnyJob
    attempt: int
    begun: float
    folder: Path
    process: subprocess.Popen[bytes]
    stage: Stage = Stage.STARTING
    fraction: float = 0.0
    since: float = field(default_factory=time.monotonic)
    counts: Counts | None = None
    granted: float | None = None
    offset: int = 0

    def listen(self) -> None:
        """Take in the whole lines that came since."""
        path = self.folder / PROGRESS
        text = path.read_bytes()[self.offset :] if path.is_file() else b""
        for line in text.splitlines(keepends=True):
            if not line.endswith(b"\n"):
                return
            self.offset += len(line)
            said = json.loads(line)
            if "counts" in said:
                self.counts, self.granted = Counts(*said["counts"]), None
            else:
                self.stage, self.fraction, self.since = Stage[said["stage"]], said["fraction"], time.monotonic()

    @property
    def waits(self) -> bool:
        """Whether it waits for the permission it asked for."""
        return self.counts is not None and self.granted is None

    @property
    def wanted(self) -> float:
        """Memory it is going to need [bytes]."""
        return 0.0 if self.counts is None else self.job.needed(self.counts)

    @property
    def held(self) -> float:
        """Memory it has already [bytes], where the system tells."""
        try:
            import psutil

            return float(psutil.Process(self.process.pid).memory_info().rss)
        except Exception:  # noqa: BLE001 the system does not tell, in whatever way
            return 0.0

    @property
    def voice(self) -> IO[bytes]:
        """Its standard input."""
        return cast("IO[bytes]", self.process.stdin)

    def permit(self) -> None:
        """Let it assemble."""
        self.granted, self.since = self.wanted, time.monotonic()
        with contextlib.suppress(OSError):  # it died meanwhile: seen at the next look
            self.voice.write(b"!")

    def last_words(self) -> str:
        """The last line it wrote to its log."""
        lines = (self.folder / "log").read_text(encoding="utf-8", errors="replace").strip().splitlines()
        return lines[-1][:300] if lines else "it said nothing"

    def remove(self) -> None:
        """End the process, remove its folder."""
        self.process.kill()
        self.process.wait()
        self.voice.close()
        shutil.rmtree(self.folder, ignore_errors=True)


class _Run(Generic[AnyJob]):
    """The jobs of one call: those to come, those running, those done."""

    def __init__(
        self, waiting: deque[tuple[AnyJob, int, float]], done: Callable[[AnyJob, bytes], None], limits: Limits, progress: Progress
    ) -> None:
        self.waiting, self.done, self.limits, self.progress = waiting, done, limits, progress
        self.children: list[_Child[AnyJob]] = []
        self.findings: list[Finding] = []
        total = sum(job.weight for job, _, _ in waiting)
        self.shares = {job.name: job.weight / total for job, _, _ in waiting}
        self.finished: list[str] = []
        self.begun, self.told, self.text, self.fraction = time.monotonic(), 0.0, "", 0.0

    def finish(self) -> None:
        """Go on until nothing waits and nothing runs."""
        while self.waiting or self.children:
            while self.waiting and len(self.children) < workers(self.limits):
                self._start(*self.waiting.popleft())
            for child in tuple(self.children):
                self._look(child)
            self._permit()
            self._tell()
            time.sleep(_PAUSE)

    def end(self) -> None:
        """Leave no process and no file behind."""
        for child in self.children:
            child.remove()

    def _start(self, job: AnyJob, attempt: int, begun: float) -> None:
        memory = available() if self.limits.memory is None else self.limits.memory
        task = Task(job, attempt, memory, self.limits.seconds, versions())
        self.children.append(_Child(job, attempt, begun if attempt else time.monotonic(), *_started(task)))

    def _look(self, child: _Child[AnyJob]) -> None:
        code = child.process.poll()
        child.listen()
        if code is None:
            self._check_time(child)
        elif code == Outcome.DONE:
            self.done(child.job, (child.folder / RESULT).read_bytes())
            self._close(child)
        elif code == Outcome.REFUSED and (child.folder / FINDINGS).is_file():
            self._close(child, *findings_in(child.folder))
        elif code == Outcome.DISK_FULL:
            self._close(child, _disk_full(child.job.name))
        elif code == Outcome.MEMORY_FULL:
            self._close(child, _memory_full(child))
        elif not self._again(child):
            self._close(child, _failed(child, code))

    def _check_time(self, child: _Child[AnyJob]) -> None:
        now = time.monotonic()
        if child.stage is Stage.MESHING and not child.waits and now - child.since > self.limits.mesh_seconds:
            if not self._again(child):
                self._close(child, _hung(child, self.limits.mesh_seconds))
        elif now - child.begun > self.limits.seconds:
            self._close(child, _hung(child, self.limits.seconds))

    def _again(self, child: _Child[AnyJob]) -> bool:
        """Begin with the next attempt at a mesh, where one took the process down or did not end."""
        attempt = round(child.fraction * child.job.attempts) + 1
        if child.stage is not Stage.MESHING or attempt >= child.job.attempts or child.process.poll() == 1:
            return False
        self.children.remove(child)
        child.remove()
        self.waiting.appendleft((child.job, attempt, child.begun))
        return True

    def _close(self, child: _Child[AnyJob], *findings: Finding) -> None:
        self.findings += findings
        self.finished.append(child.job.name)
        self.children.remove(child)
        child.remove()

    def _permit(self) -> None:
        """Permit what fits beside those that run; refuse what does not fit even alone."""
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
        return available() + child.held - sum(max(0.0, (each.granted or 0.0) - each.held) for each in others)

    def _tell(self) -> None:
        running = {child.job.name: (child.stage, child.fraction) for child in self.children}
        text = ", ".join(f"{name}: {stage.value}" for name, (stage, _) in running.items()) or "done"
        self.fraction = min(1.0, max(self.fraction, gathered(running, self.shares, self.finished)))
        now = time.monotonic()
        if text != self.text or now - self.told > _TELL_EVERY:
            self.text, self.told = text, now
            self.progress(Step(text, self.fraction, seconds_left(self.fraction, now - self.begun)))


def _started(task: Task) -> tuple[Path, subprocess.Popen[bytes]]:
    folder: Path | None = None
    try:
        folder = temporary()
        (folder / TASK).write_bytes(pickle.dumps(task))
        with (folder / "log").open("wb") as log:
            process = subprocess.Popen(
                command("flexstage.solid.fea.worker", folder),
                stdin=subprocess.PIPE,
                bufsize=0,
                stdout=log,
                stderr=log,
                cwd=folder,
                env=environment(),
                start_new_session=True,  # an interruption from the keyboard reaches the parent alone, which ends the child
            )
    except BaseException as error:
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)
        if isinstance(error, OSError):
            raise _unstarted(task.job.name, error) from error
        raise
    return folder, process


def _failed(child: _Child[AnyJob], code: int) -> Finding:
    doing = child.stage.value
    if code == 1:
        advice = "This is a fault of flexstage or its solver: please report it with the design; other sizes of elements may get around it"
        return Finding(child.job.name, f"its process failed while {doing} ({child.last_words()})", advice)
    tried = f", at {child.attempt + 1} sizes of elements" if child.attempt else ""
    advice = "Ask for elements of another size or order, and report it with the design if it happens again"
    if child.stage in {Stage.DRAWING, Stage.MESHING}:
        advice = "Change the outline or the elements' sizes a little: slivers and faces that nearly touch bring the mesher down"
    elif code == -signal.SIGKILL:
        advice = "Something ended it, as systems do when memory runs out: ask for larger elements or a lower order, or state less memory"
    return Finding(child.job.name, f"its process crashed while {doing} ({_reason(code)}){tried}", advice)


def _reason(code: int) -> str:
    names = {-number.value: number.name for number in signal.Signals}
    return names.get(code, f"exit code {code}")


def _hung(child: _Child[AnyJob], seconds: float) -> Finding:
    advice = "Ask for larger elements or a lower order, allow more time, or look for slivers, which can keep the mesher busy for ever"
    return Finding(child.job.name, f"it was still {child.stage.value} after the {seconds:.4g} s allowed", advice)


def _memory_full(child: _Child[AnyJob]) -> Finding:
    advice = "Ask for larger elements or a lower order, or let it have more"
    return Finding(child.job.name, f"it took more memory while {child.stage.value} than it may", advice)


def _disk_full(name: str) -> Finding:
    advice = "Free some of it, or let the environment variable TMPDIR name a folder with more room"
    return Finding(name, f"no room is left in the folder for temporary files, {tempfile.gettempdir()}", advice)


def _unstarted(name: str, error: OSError) -> Exception:
    where = tempfile.gettempdir()
    advice = "See that Python can be started and that the folder for temporary files (environment variable TMPDIR) has room"
    return refuse(name, f"no process could be started for it in {where} ({error.strerror})", advice)
