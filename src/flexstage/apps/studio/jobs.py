"""Jobs of the studio: commands of the command line in separate processes, one after another, with progress and reports."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import secrets
import signal
import sys
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from flexstage.apps.studio import protocol as say
from flexstage.apps.studio.design.history import Stored
from flexstage.apps.studio.forms import key_figures
from flexstage.base.finding import DesignError, refuse
from flexstage.base.processes.jobs import environment
from flexstage.base.processes.progress import LINE, LINES, RESULT
from flexstage.base.storage.store import make_temporary_folder, write

_WRITING = ("--report", "--json", "--csv", "--mat", "--output", "-o", "--export", "--xlsx", "--hardware", "--example")
_STUDIES, _DESIGN = ("sweep", "optimise"), "design"
_MISSING = {
    **dict.fromkeys(_STUDIES, ("study missing", "Write a study, see docs/studies.md")),
    _DESIGN: ("specification missing", "Fill in the form"),
}
"""Errors of commands without their text."""
_ENDS = {"optimise": "done; the optimum is pinned in the comparison of figures"}
_LINES = 12
"""Number of stored last output lines of a job."""
_PATIENCE = 3.0
"""Time limit for the cleanup of an ended job [s]."""
_MOST = 50
_LONGEST = 2**27
"""Largest number of bytes of a line of output; the design of an answer is one line."""


@dataclass
class _Job:
    """A job: its request, its state, its running process, its temporary files."""

    number: int
    request: say.Run
    path: Path
    """Its design file."""
    text: str
    state: say.JobState
    process: asyncio.subprocess.Process | None = None
    files: list[Path] = field(default_factory=list[Path])
    designs: dict[str, str] = field(default_factory=dict[str, str])
    """Texts of the answers of a design job by pair."""
    names: dict[str, str] = field(default_factory=dict[str, str])
    """Names of the studio's temporary files, and their replacements for the user; longer ones first."""

    def as_read(self, text: str) -> str:
        """Output of the command, with the names known to the user."""
        for own, known in self.names.items():
            text = text.replace(own, known)
        return text


class Jobs:
    """All jobs of a session. `tell` receives the states of the jobs; `optimum` receives the text of a better design."""

    def __init__(self, path: Path, tell: Callable[[say.Said], None], optimum: Callable[[str], None]) -> None:
        self.path, self._tell, self._optimum = path, tell, optimum
        self.program: tuple[str, ...] = ("-P", "-m", "flexstage")
        """Arguments of the Python interpreter that precede the command."""
        self._jobs: dict[int, _Job] = {}
        self._folder: Path | None = None
        self._turn = asyncio.Lock()
        self._work: set[asyncio.Task[None]] = set()
        self.reports: dict[str, Path] = {}
        """Reports by their names."""

    def start(self, request: say.Run, text: str) -> int:
        """Start a job on a text and return its number. Refused if the command or an option is not allowed."""
        running = [each for each in self._jobs.values() if each.state.state in ("waits", "runs")]
        if len(running) >= _MOST:
            raise refuse(request.command, f"{_MOST} jobs are waiting", "Cancel some of them")
        if request.study is None and request.command in _MISSING:
            raise refuse(request.command, *_MISSING[request.command])
        if (request.record or request.command == "identify") and not (request.record and self._is_file(request.record)):
            raise refuse(request.command, "record not found", "Name a file, relative to the folder of the design")
        for option in request.options:
            if "\0" in option:
                raise refuse(request.command, "an option has a null character", "Remove the option")
            if option.partition("=")[0] in _WRITING:
                raise refuse(request.command, f"the studio itself sets {option}", "Remove this option")
        number = len(self._jobs) + 1
        job = _Job(
            number, request, self.path, text, say.JobState(number, request.command, "waits", "waits for its turn", None, None, (), None)
        )
        self._jobs[number] = job
        task = asyncio.create_task(self._run(job))
        self._work.add(task)
        task.add_done_callback(self._work.discard)
        self._push()
        return number

    def _is_file(self, record: str) -> bool:
        with contextlib.suppress(OSError, ValueError):  # an invalid name
            return (self.path.parent / record).is_file()
        return False

    def answer(self, number: int | None, pair: str) -> str:
        """Return the design that a job found for a pair of architecture and actuator; refused for an unknown job or pair."""
        job = self._jobs.get(number or 0)
        if job is None or pair not in job.designs:
            raise refuse(pair, "unknown answer", "Choose an answer of a design job")
        return job.designs[pair]

    def cancel(self, number: int) -> None:
        """End a job; refused for an unknown number."""
        job = self._jobs.get(number)
        if job is None:
            raise refuse(f"job {number}", "unknown job", "Choose a job of the list")
        if job.state.state in ("waits", "runs"):
            self._set(job, replace(job.state, state="cancelled", text="cancelled"))
            if job.process is not None:
                self._end(job.process)

    async def close(self) -> None:
        """End all jobs, and remove their files."""
        for number in self._jobs:
            self.cancel(number)
        if self._work:
            await asyncio.wait(self._work, timeout=_PATIENCE)
        for each in self._jobs.values():
            if each.process is not None:
                _kill(each.process)
            self._remove(each)
        if self._folder is not None:
            import shutil

            shutil.rmtree(self._folder, ignore_errors=True)

    async def _run(self, job: _Job) -> None:
        async with self._turn:
            if job.state.state != "waits":
                return
            try:
                await self._follow(job)
            except DesignError as error:
                self._set(job, replace(job.state, state="failed", text=str(error)))
            except OSError as error:
                self._set(job, replace(job.state, state="failed", text=f"the system cannot start a process: {error}"))
            except ValueError as error:  # a line of its output is too long
                self._set(job, replace(job.state, state="failed", text=f"its output cannot be read: {error}"))
                if job.process is not None:
                    self._end(job.process)
            finally:
                self._remove(job)

    async def _follow(self, job: _Job) -> None:
        """Run a job from start to end."""
        if self._folder is None:
            self._folder = make_temporary_folder()
        report, document = (self._folder / f"{job.number}.{ending}" for ending in ("html", "json"))
        arguments = [*self._arguments(job), *job.request.options, "--report", str(report), "--json", str(document)]
        self._set(job, replace(job.state, state="runs", text="starts"))
        job.process = process = await asyncio.create_subprocess_exec(
            *(sys.executable, *self.program, job.request.command, *arguments),
            limit=_LONGEST,
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.PIPE,
            stderr=asyncio.subprocess.STDOUT,
            env={**environment(), LINES: "1", "NO_COLOR": "1", "COLUMNS": "120"},
            start_new_session=True,
        )
        if process.stdout is not None:
            async for line in process.stdout:
                self._hear(job, line.decode(errors="replace").rstrip("\r\n"))
        code = await process.wait()
        if job.state.state == "cancelled":
            return
        if report.is_file():
            report.write_text(job.as_read(report.read_text(encoding="utf-8")), encoding="utf-8")
            name = f"{secrets.token_urlsafe(18)}.html"
            self.reports[name] = report
            job.state = replace(job.state, report=f"/report/{name}")
        if document.is_file():
            job.state = replace(job.state, figures=key_figures(json.loads(document.read_text(encoding="utf-8"))))
        better = self._folder / f"{job.number}.toml"
        if code == 0 and better.is_file():
            self._optimum(job.as_read(better.read_text(encoding="utf-8")))
        state, text = ("done", _ENDS.get(job.request.command, "done")) if code in (0, 1) else ("failed", f"ended with exit code {code}")
        self._set(job, replace(job.state, state=state, text=text, fraction=1.0 if state == "done" else None, left=None))

    def _arguments(self, job: _Job) -> list[str]:
        """The files for its command; an unsaved text is stored temporarily next to its file."""
        request, folder = job.request, self._folder or Path()
        if request.command == _DESIGN:
            return [str(self._beside(job, "specification.toml", "specification", request.study or ""))]
        design = job.path
        if not design.is_file() or Stored.read(design).text != job.text:
            design = self._beside(job, "toml", job.path.name, job.text)
        if request.command == "identify":
            return [str(job.path.parent / (request.record or "")), "--stage", str(design)]
        if request.command == "loop":
            seen = ["--record", str(job.path.parent / request.record)] if request.record else []
            setup = ["--setup", str(self._beside(job, "loop.toml", "set-up", request.study))] if request.study is not None else []
            return [str(design), *setup, *seen]
        if request.command not in _STUDIES:
            return [str(design)]
        study = self._beside(job, "study.toml", "study", _study(request.study or "", design, job.path.stem))
        ending = "h5" if request.command == "sweep" else "toml"
        return [str(study), "--output", str(folder / f"{job.number}.{ending}")]

    def _beside(self, job: _Job, ending: str, known: str, text: str) -> Path:
        """A temporary file next to the design, with a `known` name for the user."""
        path = job.path.parent / f".{job.path.stem}.studio-{os.getpid()}-{job.number}.{ending}"
        job.files.append(path)
        job.names |= {str(path): known, path.name: known}
        return write(path, text)

    def _hear(self, job: _Job, line: str) -> None:
        if line.startswith(f"{RESULT} "):
            with contextlib.suppress(ValueError):  # the output of another process in this line
                self._take(job, **json.loads(line.partition(" ")[2]))
            return
        if not line.startswith(f"{LINE} "):
            if line.strip() and not (self._folder and line.startswith(f"Wrote {self._folder}")):  # the page shows its results
                job.state = replace(job.state, said=(*job.state.said, job.as_read(line))[-_LINES:])
            return
        _, fraction, left, text = [*job.as_read(line).split(" ", 3), ""][:4]
        with contextlib.suppress(ValueError):
            self._set(job, replace(job.state, text=text, fraction=float(fraction), left=None if left == "-" else float(left)))

    def _take(self, job: _Job, pair: Mapping[str, str] | None = None, tables: Iterable[tuple[Any, ...]] = ()) -> None:
        """Take a pair of a design job, in place of its earlier result, or the tables at its end."""
        pairs = job.state.pairs
        if pair is not None:
            row = say.PairRow(**{key: value for key, value in pair.items() if key != "design"})
            names = row.architecture, row.actuator
            job.designs[" with ".join(names)] = pair["design"]
            pairs = (*(each for each in pairs if (each.architecture, each.actuator) != names), row)
        self._set(job, replace(job.state, pairs=pairs, tables=tuple(say.ResultTable(title, rows, notes) for title, rows, notes in tables)))

    def _set(self, job: _Job, state: say.JobState) -> None:
        if job.state.state != "cancelled":
            job.state = state
            self._push()

    def _push(self) -> None:
        self._tell(say.Jobs(tuple(each.state for each in self._jobs.values())))

    def _end(self, process: asyncio.subprocess.Process) -> None:
        """Ask a process and its children to end, once."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            if sys.platform == "win32":
                process.terminate()
            else:
                os.killpg(process.pid, signal.SIGTERM)
        loop = asyncio.get_running_loop()
        loop.call_later(_PATIENCE, _kill, process)

    def _remove(self, job: _Job) -> None:
        for path in job.files:
            path.unlink(missing_ok=True)


def _kill(process: asyncio.subprocess.Process) -> None:
    if process.returncode is None:
        with contextlib.suppress(ProcessLookupError):
            process.kill()


def _study(text: str, design: Path, name: str) -> str:
    """A study's text about that design; with that name if it has none."""
    import tomlkit  # takes long to import
    from tomlkit.exceptions import TOMLKitError

    try:
        document = tomlkit.parse(text)
    except TOMLKitError as error:
        raise refuse("study", f"not valid TOML: {error}", "Correct that line") from None
    document["design"] = design.name
    document.setdefault("name", name)
    return tomlkit.dumps(document)
