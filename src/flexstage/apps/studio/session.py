"""An open design in the studio: requests of pages, computations, and messages."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable, Coroutine, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from flexstage.apps.studio import protocol as say
from flexstage.apps.studio.design.answers import Reading
from flexstage.apps.studio.design.history import History, Stored
from flexstage.apps.studio.design.journal import Draft, Journal, discard, drafts
from flexstage.apps.studio.design.palette import snippets
from flexstage.apps.studio.engine import Outcome, failure, problem
from flexstage.apps.studio.helper import Helper, Urgency, always, nobody
from flexstage.apps.studio.jobs import Jobs
from flexstage.base.finding import DesignError, refuse, suggest_nearest
from flexstage.base.storage.store import write

_QUIET = 0.3
"""Duration up to which a computation is not announced [s]."""
_STALE = 3.0
"""Time after which a computation of an outdated text is ended with its process [s]."""
_STAGES: tuple[tuple[str, str, float], ...] = (
    ("figures", "stiffness, lost motion, modes and responses", 0.1),
    ("verdicts", "requirements", 0.05),
    ("errors", "errors", 0.1),
    ("reach", "strokes and stress", 0.1),
    ("scene", "the geometry", 0.2),
    ("warnings", "warnings", 0.2),
)
"""Steps of the computation of a design, in this sequence, with their names, and the assumed durations for a design of thirty links before
the first measurement [s] (benchmarks/studio.py)."""

_TASKS: Mapping[type[Any], str] = {
    say.Part: "card",
    say.Line: "place",
    say.Jog: "motion",
    say.Free: "freedoms",
    say.Gaps: "clearances",
    say.Solid: "solid_modes",
}
"""Requests with one task as answer."""
_PANES = ("stage", "motions", "reach")

Tell = Callable[[say.Said], None]


class RefusedError(Exception):
    """A task was refused by its process; the exception's argument contains the problems."""


class Session:
    """One open design for all pages. `tell` sends a message to all pages."""

    def __init__(self, stored: Stored, tell: Tell) -> None:
        self.stored = stored
        self.journal = Journal(stored.path)
        self.drafts = self._found_drafts()
        """Unsaved texts of ended studios, by the name of their journal."""
        self._unprotected = ""
        self._specification = ""
        """The last text of a specification."""
        self.history = History(stored.text)
        self.reading: Reading | None = None
        self.problems: tuple[say.Problem, ...] = ()
        self.sound = ""
        """The last valid text."""
        self.shown: dict[type[say.Said], say.Said] = {}
        """Messages to a new page, by kind."""
        self._tell = tell
        self._helpers = [Helper(self._died) for _ in range(4)]
        self._model, self._reader, self._slow, self._far = self._helpers
        self._choice: tuple[Any, ...] = ((), (), None, None)
        self._newest: dict[type[Any], Any] = {}
        """The last request of each kind."""
        self._computed = 0
        self._warnings: tuple[say.Problem, ...] = ()
        self._failures: dict[str, tuple[say.Problem, ...]] = {}
        """Errors by step of the computation."""
        self._pages: dict[int, tuple[str, ...]] = {}
        self._last: dict[str, tuple[Any, ...]] = {}
        """Last input of each step of the computation."""
        self._took: dict[str, tuple[float, int]] = {}
        self._work: set[asyncio.Task[Any]] = set()
        self._changing, self._computing = asyncio.Lock(), asyncio.Lock()
        self.jobs = Jobs(stored.path, self._push, self._keep_optimum)

    # --- start and end ---

    async def open(self) -> None:
        """Read the text and compute its results."""
        self._push(say.Engine("starts", "The computing process starts"))
        await self._read()

    async def close(self) -> None:
        """End all processes."""
        for each in tuple(self._work):
            each.cancel()
        await self.jobs.close()
        for helper in self._helpers:
            await helper.close()

    @property
    def spent(self) -> float:
        """CPU time of the computations [s]."""
        return sum(each.spent for each in self._helpers)

    @property
    def processes(self) -> tuple[int, ...]:
        """Identifiers (PID) of the computing processes."""
        return tuple(each.process for each in self._helpers if each.process is not None)

    # --- requests ---

    async def answer(self, request: Any, page: int, tell: Tell) -> None:
        """Answer a request of a page through `tell`: with its result, a refusal, or `Done` if the request has no result."""
        computed = self._computed
        try:
            handle = getattr(self, f"answer_{type(request).__name__.lower()}", self._ask)
            told = await handle(request, page, tell) or say.Done(self.history.revision)
        except RefusedError as error:
            told = say.Refusal(error.args[0])
        except DesignError as error:
            told = say.Refusal(tuple(map(problem, error.findings)), stale=isinstance(request, say.Edit | say.Save))
        except Exception as error:  # noqa: BLE001 (a failed request must not stop the others)
            told = say.Refusal((failure(type(request).__name__.lower(), error),))
        known = {"revision": computed} if isinstance(told, say.DesignAnswer) else {}
        tell(replace(told, to=request.id, **known))

    async def answer_edit(self, request: say.Edit, page: int, _: Tell) -> None:
        """Accept the page's text; refused after a change by another page unknown to this one."""
        self.history.require_known(request.revision, page)
        self._take(self.history.change(request.text.replace("\r\n", "\n"), page))

    async def answer_set(self, request: say.Set | say.Rest, page: int, _: Tell) -> None:
        """Write a number into the text; refused if the text was changed meanwhile."""
        value = request.text if isinstance(request, say.Set) else request.value
        async with self._changing:
            text, revision = self.history.text, self.history.revision
            written = await self._task_value(self._quick, "write", text, self._file, request.address, value)
            if self.history.revision != revision:
                raise refuse(request.address, "the text was changed in the meantime", "Set the value again")
            self._take(self.history.change(written, page))

    answer_rest = answer_set

    async def answer_insert(self, request: say.Insert, page: int, _: Tell) -> None:
        """Insert a snippet."""
        async with self._changing:
            written = await self._task_value(self._quick, "insert", self.history.text, request.snippet, request.fields)
            self._take(self.history.change(written, page))

    async def answer_undo(self, request: say.Undo | say.Redo, page: int, _: Tell) -> None:
        """Restore the previous text, or the next one."""
        self._take(self.history.undo(page) if isinstance(request, say.Undo) else self.history.redo(page))

    answer_redo = answer_undo

    async def answer_save(self, request: say.Save, *_: Any) -> None:
        """Write the text to a file of the folder."""
        path = self._in_folder(request.file) if request.file else self.stored.path
        if path == self.stored.path:
            self.stored = self.stored.write(self.history.text, over=request.over)
        else:
            if path.exists() and not request.over:
                raise refuse(path.name, "file exists", "Choose another name, or overwrite it")
            self._turn_to(replace(self.stored, path=path).write(self.history.text, over=True))
        self._protect()
        self._start(self._read())

    async def answer_browse(self, *_: Any) -> say.Said:
        """List the files of the folder and the shipped cases."""
        paths = sorted(each for each in self.stored.path.parent.glob("[!.]*.toml") if each.is_file())
        specifications = tuple(each.name for each in paths if b'"flexstage specification ' in each.read_bytes())
        return say.Folder(tuple(each.name for each in paths), specifications, await self._task_value(self._quick, "gallery"))

    async def answer_open(self, request: say.Open, *_: Any) -> None:
        """Open another file; refused if unsaved changes would be lost."""
        path = self._in_folder(request.file)
        if self.history.text != self.stored.text and not request.discard:
            raise refuse(self.stored.path.name, "has unsaved changes", "Save or discard them first")
        if request.case or request.pair:
            text = self.jobs.answer(request.job, request.pair) if request.pair else None
            if path.exists():
                raise refuse(path.name, "file exists", "Choose another name")
            write(path, text or await self._task_value(self._quick, "shipped", request.case))
        elif not path.is_file():
            raise refuse(path.name, "file not found", "Choose a file of this folder")
        self._turn_to(Stored.read(path))
        self.history = History(self.stored.text, revision=self.history.revision + 1)
        self.reading, self.sound, self._warnings = None, "", ()
        self.shown = {kind: each for kind, each in self.shown.items() if kind is say.Jobs}
        for each in (self._failures, self._last):
            each.clear()
        await self.open()

    def _in_folder(self, name: str) -> Path:
        """The path of a design file next to the present one; raises `DesignError` for another kind of name."""
        folder = self.stored.path.parent
        if not name.isprintable() or Path(name).name != name or not name.endswith(".toml") or name.startswith("."):
            raise refuse("file", f'must be a name that ends in .toml, without a folder (got "{name}")', "Use e.g. stage2.toml")
        return folder / name

    def _turn_to(self, stored: Stored) -> None:
        """Continue with another file."""
        self.journal.clear()
        self.stored, self.jobs.path = stored, stored.path
        self.journal = replace(self.journal, path=stored.path)
        self.drafts = self._found_drafts()

    async def answer_reload(self, _: say.Reload, page: int, __: Tell) -> None:
        """Read the text of the file, which may have changed; the present one remains in the history."""
        self.stored = Stored.read(self.stored.path)
        same = self.stored.text == self.history.text
        self._take(self.history.change(self.stored.text, page))
        self._protect()
        if same:
            self._start(self._read())

    async def answer_recover(self, request: say.Recover, page: int, _: Tell) -> None:
        """Restore an unsaved text of an ended studio, or discard it; this studio then protects a restored one."""
        draft = self.drafts.get(request.draft)
        if draft is None:
            raise refuse(request.draft, "unknown unsaved text", "Reload the page")
        if request.keep:
            self.history = replace(self.history, pins={**draft.pins, **self.history.pins})
            self._take(self.history.change(draft.text, page))
            self._protect()
        if not (request.keep and self._unprotected):
            discard(self._journals[request.draft])
        self.drafts = {name: each for name, each in self.drafts.items() if name != request.draft}
        self._push_state()

    async def answer_pin(self, request: say.Pin, *_: Any) -> None:
        """Pin the present design, or remove a pinned one."""
        if request.keep and request.name not in self.history.pins and len(self.history.pins) >= 12:
            raise refuse(request.name, "twelve designs are pinned already", "Remove a pinned design first")
        self.history = self.history.pin(request.name, keep=request.keep)
        self._protect()
        self._push_state()

    async def answer_recall(self, request: say.Recall, page: int, _: Tell) -> None:
        """Restore the text of the file, or of a pinned design."""
        texts = {"": self.stored.text, **self.history.pins}
        if request.name not in texts:
            raise refuse(request.name, "no design is pinned under this name", suggest_nearest(request.name, self.history.pins))
        self._take(self.history.change(texts[request.name], page))

    async def answer_compare(self, *_: Any) -> say.Said:
        """Figures of the file, of all pinned designs and of the present one."""
        texts = {"file": self.stored.text, **self.history.pins, "now": self._design}
        tables = [await self._task_value(self._model, "all_figures", text, self._file) for text in texts.values()]
        known = {each.name: each for table in tables for each in table}
        by_name = [{each.name: each.value for each in table} for table in tables]
        rows = tuple(_row(each, by_name[-1].get(name), by_name[0].get(name)) for name, each in known.items())
        values = tuple(tuple(table.get(name) for table in by_name) for name in known)
        return say.Comparison(tuple(texts), rows, values)

    async def answer_drag(self, request: say.Drag, *_: Any) -> say.Said | None:
        """Frequencies at a slider's position; for requests faster than the answers, the newest."""
        call = ("drag", self._design, self._file, request.address, request.value)
        outcome = await self._quick.ask(*call, wanted=self._is_newest(request))
        return outcome and say.Frequencies(request.address, request.value, outcome.value or (), outcome.problems)

    async def answer_pose(self, request: say.Pose, *_: Any) -> say.Said | None:
        """Displacement at the newest strokes."""
        return await self._task_value(self._model, "posed", self._design, self._file, request.inputs, wanted=self._is_newest(request))

    async def _ask(self, request: Any, *_: Any) -> say.Said:
        """The result of one task, for the request or the computed design."""
        helper = self._quick if isinstance(request, say.Line) else self._model
        _id, *own = vars(request).values()
        return await self._task_value(helper, _TASKS[type(request)], self._design, self._file, *own)

    async def answer_respond(self, request: say.Respond, *_: Any) -> None:
        """Change the choice of responses; refused if the stage has none of that name."""
        choice, computed = (request.inputs, request.outputs, request.low, request.high), self._computed
        found = await self._task_value(self._model, "figures", self._design, self._file, self.stored.text, choice)
        if "response" in found.missing:
            raise refuse("response", found.missing["response"].rstrip("."), "Choose among its inputs and outputs")
        self._choice = choice
        self._push(replace(found, revision=computed))

    async def answer_derive(self, *_: Any) -> say.Said | None:
        """Run in a separate process, because of its duration; nothing for an outdated text."""
        revision = self._computed
        return await self._task_value(self._slow, "slopes", self._design, self._file, wanted=lambda: self._computed == revision)

    async def answer_travel(self, request: say.Travel, _: int, tell: Tell) -> say.Said:
        """Run in a separate process, which ends with an abort, because of its duration; a new path replaces the running one."""
        self._far.start_anew()
        return await self._task_value(self._far, "travelled", self._design, self._file, request, heard=tell)

    async def answer_halt(self, *_: Any) -> None:
        """Abort the load path."""
        self._far.start_anew()

    async def answer_palette(self, *_: Any) -> say.Said:
        """List the snippets."""
        return say.Snippets(snippets())

    async def answer_look(self, request: say.Look, page: int, _: Tell) -> None:
        """Compute the panes that a page shows."""
        self._pages[page] = request.panes
        if self.sound and "figures" in self._last:
            self._start(self._compute(self._computed, self.sound))

    async def answer_jobform(self, request: say.JobForm, *_: Any) -> say.Said:
        """Form of a command."""
        return say.Blank(request.command, await self._task_value(self._quick, "form", request.command))

    async def answer_specify(self, request: say.Specify, *_: Any) -> say.Said:
        """Values and errors of a specification."""
        path = self._in_folder(request.file) if request.file else self.stored.path
        text = request.text or (Stored.read(path).text if request.file else self._specification)
        found = await self._task_value(self._quick, "specify", text, str(path), request.values)
        self._specification = found.text
        return found

    async def answer_savespecification(self, request: say.SaveSpecification, *_: Any) -> None:
        """Write a specification to a new file."""
        path = self._in_folder(request.file)
        if path.exists() and (path == self.stored.path or not request.over):
            raise refuse(path.name, "file exists", "Choose another name")
        replace(self.stored, path=path).write(request.text, over=True)

    async def answer_run(self, request: say.Run, *_: Any) -> say.Said:
        """Start a job."""
        return say.Done(self.history.revision, self.jobs.start(request, self.history.text))

    async def answer_cancel(self, request: say.Cancel, *_: Any) -> None:
        """End a job."""
        self.jobs.cancel(request.job)

    def _take(self, history: History) -> None:
        """Accept another text: it is read, then computed."""
        changed = history.revision != self.history.revision
        self.history = history
        if changed:
            self._protect()
            self._start(self._read())

    def _protect(self) -> None:
        """Write unsaved changes to the disk before they are acknowledged; pages show a failure."""
        try:
            if self.history.text == self.stored.text:
                self.journal.clear()
            else:
                self.journal.keep(self.history.text, self.history.pins, self.stored.digest)
            self._unprotected = ""
        except DesignError as error:
            self._unprotected = str(error)

    def _found_drafts(self) -> dict[str, Draft]:
        """Unsaved texts of earlier studios; a journal with the text of the file is removed."""
        found = drafts(self.stored.path)
        self._journals = {place.name: place for place in found}
        for place in [place for place, draft in found.items() if draft.text == self.stored.text]:
            discard(place)
        return {place.name: draft for place, draft in found.items() if draft.text != self.stored.text}

    async def _read(self) -> None:
        revision = self.history.revision
        text = self.history.text
        call = ("read", text, self._file, self.stored.text)
        outcome = await self._quick.ask(*call, wanted=lambda: self.history.revision == revision)
        if outcome is None or self.history.revision != revision:
            return
        self.problems = outcome.problems
        if outcome.value is not None:
            self.reading, self.sound, self._computed = outcome.value, text, revision
        self._push_state()
        if self.problems:
            self._push(say.Engine("ready"))
        else:
            self._start(self._compute(revision, text))

    async def _compute(self, revision: int, text: str) -> None:
        """Compute all shown stages of a revision, until it is outdated."""
        if self._model.busy(Urgency.SOON) > _STALE:
            self._model.start_anew()
        async with self._computing:
            links = len(self.reading.links) if self.reading else 0
            for stage, called, assumed in _STAGES:
                work = self._work_of(stage, text)
                if work is None or self._last.get(stage) == (work, revision):
                    self._report(stage, () if work is None else self._failures.get(stage, ()))
                    continue
                left = expected(links, *self._took.get(stage, (assumed, 30)))
                outcome = await self._announced(called, left, work, lambda: self.sound == text and self._computed == revision)
                if outcome is None:
                    return
                self._took[stage] = (outcome.seconds, links)
                self._report(stage, outcome.problems)
                if not outcome.problems or (stage == "errors" and outcome.seconds):
                    self._last[stage] = work, revision
                if outcome.value is not None:
                    self._push(replace(say.Scene(outcome.value) if stage == "scene" else outcome.value, revision=revision))
                if stage == "warnings" and outcome.value and outcome.value.warnings != self._warnings:
                    self._warnings = outcome.value.warnings
                    self._push_state()

    def _report(self, stage: str, problems: tuple[say.Problem, ...]) -> None:
        """Show the errors of a stage of the computation, in place of its earlier ones."""
        if problems != self._failures.get(stage, ()):
            self._failures[stage] = problems
            self._push_state()

    @property
    def _errors(self) -> tuple[say.Problem, ...]:
        """Errors of the text, else those of its computation, each once."""
        return self.problems or tuple(dict.fromkeys(each for found in self._failures.values() for each in found))

    def _work_of(self, stage: str, text: str) -> tuple[Any, ...] | None:
        """Task and arguments of a stage; nothing if no page shows its result."""
        if stage == "figures":
            return stage, text, self._file, self.stored.text, self._choice
        if stage in {"errors", "warnings"}:
            return stage, text, self._file
        if stage == "scene":
            moving = stage not in self._last or self._looks("motions")
            return ("scene" if moving else "still", text, self._file) if self._looks("stage") else None
        return (stage, text, self._file, self.stored.text) if stage == "verdicts" or self._looks("reach") else None

    def _looks(self, pane: str) -> bool:
        """Whether a page shows a pane; before the first page, everything is computed."""
        return not self._pages or any(pane in panes for panes in self._pages.values())

    def enter(self, page: int) -> None:
        """Add a page; until the page reports its panes, all panes are assumed to be shown."""
        self._pages[page] = _PANES

    def leave(self, page: int) -> None:
        """Remove a page."""
        self._pages.pop(page, None)

    async def _announced(self, called: str, left: float, work: tuple[Any, ...], wanted: Callable[[], bool]) -> Outcome | None:
        """Compute a stage; announce a long one at its start, and that it is ready after that, a start or an end of the process."""
        if left > _QUIET:
            self._push(say.Engine("computes", called, left))
        outcome = await self._model.ask(*work, urgency=Urgency.SOON, wanted=wanted)
        told = self.shown[say.Engine]
        if left > _QUIET or (isinstance(told, say.Engine) and told.state in {"starts", "ended"}):
            self._push(say.Engine("ready"))
        return outcome

    def _push_state(self) -> None:
        reading, history = self.reading or Reading(), self.history
        self._push(
            say.State(
                **vars(reading),
                revision=history.revision,
                page=history.page,
                file=os.fsencode(self.stored.path.name).decode(errors="replace"),
                text=history.text,
                digest=self.stored.digest,
                saved=history.text == self.stored.text,
                sound=not self._errors,
                changed=sum(each.old is None or each.old != each.value for each in reading.amounts),
                undo=bool(history.past),
                redo=bool(history.future),
                problems=self._errors,
                warnings=self._warnings,
                pins=tuple(history.pins),
                unprotected=self._unprotected,
                drafts=tuple(say.Draft(name, each.time, each.digest != self.stored.digest) for name, each in self.drafts.items()),
            )
        )

    def _push(self, message: say.Said) -> None:
        self.shown[type(message)] = message
        self._tell(message)

    def _keep_optimum(self, text: str) -> None:
        """Pin a better design from a job."""
        self.history = replace(self.history, pins={**self.history.pins, "optimum": text})
        self._protect()
        self._push_state()

    def _died(self, words: str) -> None:
        self._push(say.Engine("ended", f"The computing process ended and is restarted: {words}"))

    # --- requests to the processes ---

    @property
    def _file(self) -> str:
        return str(self.stored.path)

    @property
    def _design(self) -> str:
        """The computed text: the last valid one."""
        return self.sound or self.history.text

    @property
    def _quick(self) -> Helper:
        """The process for reading texts and for sliders: the other one until the first figures, because a start takes processor time."""
        return self._reader if "figures" in self._took else self._model

    async def _task_value(
        self, helper: Helper, *call: Any, wanted: Callable[[], bool] | None = None, heard: Callable[[Any], None] = nobody
    ) -> Any:
        """The value of a task, `None` if it is no longer wanted at its turn; raises `RefusedError` after a refusal."""
        outcome = await helper.ask(*call, wanted=wanted or always, heard=heard)
        if outcome is None and wanted:
            return None
        if outcome is None or outcome.problems:
            raise RefusedError(outcome.problems if outcome else ())
        return outcome.value

    def _is_newest(self, request: Any) -> Callable[[], bool]:
        """Whether no later request of this kind exists."""
        self._newest[type(request)] = request
        return lambda: self._newest[type(request)] is request

    def _start(self, work: Coroutine[Any, Any, None]) -> None:
        """Run in the background until the end of the session."""
        task = asyncio.create_task(work)
        self._work.add(task)
        task.add_done_callback(self._work.discard)


def expected(links: int, seconds: float, size: int) -> float:
    """Estimate the duration of a step [s] for a number of links, from its duration for another number `size`.

    >>> expected(300, 0.1, 30), expected(10, 2.0, 20)
    (10.0, 0.5)
    """
    return seconds * (links / max(size, 1)) ** 2


def _row(figure: Any, value: float | None, old: float | None) -> say.Figure:
    """A figure of several designs."""
    return say.Figure(figure.name, figure.name.partition(".")[0], figure.unit, figure.unit, 1.0, value, old)
