"""Results of commands: a JSON document, tables on the terminal, or both."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from functools import wraps
from inspect import Parameter, Signature, signature
from itertools import chain, count
from pathlib import Path
from typing import Annotated, Any, ParamSpec, get_origin, get_type_hints

import typer
from rich.console import Console

from flexstage.analysis.caveats import Caveats, caveats
from flexstage.base.finding import Finding, combine_warnings
from flexstage.base.storage.document import Document, as_text
from flexstage.base.text import printable
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.theory import Model
from flexstage.show.command.design import DesignOptions, Lumped, LumpedOptions
from flexstage.show.command.failure import MISSED
from flexstage.show.command.options import Csv, Json, Report, Xlsx
from flexstage.show.command.output import STDOUT, announce, make_folder, require_writable, save, write
from flexstage.show.command.terminal import print_note, print_styled, print_warning
from flexstage.show.document import envelope
from flexstage.show.render import fold, to_rich
from flexstage.show.sheets import to_csv
from flexstage.show.table import Table
from flexstage.show.workbook import to_xlsx

_UNFOLDED = 1000
_LONGEST = 200
_HANG = 2
_MAPPING = "mapping: 0 strokes"
"""Reason for missing results that need the mapping of strokes to motions."""


@dataclass(frozen=True)
class CommandResult:
    """The result of a command: the `body` of its JSON document, its `tables`, and its `report` as HTML, each computed on request.

    `mechanism` is the description, or `None` if the command read only a record. `model` is the kind of model. `warnings` are warnings about
    the result; warnings about the description are listed before them.
    """

    mechanism: Mechanism | None
    body: Callable[[], Any]
    tables: Callable[[], Iterable[Table | str | None]]
    report: Callable[[], str] | None = None
    model: Model | None = None
    warnings: tuple[Finding, ...] = ()
    kind: str | None = None
    """Kind of the JSON document, if it differs from the name of the command."""
    failed: bool = False
    """Whether the command ends with exit code 1: it completed with a negative result, such as an unmet requirement."""


_OUTPUTS = {"json": Json, "csv": Csv, "xlsx": Xlsx, "report": Report}
_KINDS: Mapping[Any, Any] = {Mechanism: DesignOptions, Lumped: LumpedOptions}
_Given = ParamSpec("_Given")


def command(*files: str) -> Callable[[Callable[_Given, CommandResult | None]], Callable[_Given, None]]:
    """Make a command from a function that returns a `CommandResult`.

    The command writes the requested documents, or prints the tables. A parameter with a dataclass type is replaced by those fields of the
    dataclass that are options. A `Mechanism` parameter is read from the design file. `files` names further options for output files, such
    as `report` or a file that the function writes itself. All outputs are checked before the function is called. If an output is stdout, no
    tables are printed. A function that returns `None` must write its outputs itself.
    """

    def decorate(function: Callable[_Given, CommandResult | None]) -> Callable[_Given, None]:
        own = signature(function, eval_str=True).parameters
        kinds: dict[str, Any] = {name: _KINDS.get(each.annotation, each.annotation) for name, each in own.items()}
        groups: dict[str, Any] = {name: kind for name, kind in kinds.items() if is_dataclass(kind)}
        offered = [option for name, each in own.items() for option in (_options(groups[name]) if name in groups else [each])]
        known = {each.name for each in offered}
        common = {name: kind for name, kind in _OUTPUTS.items() if name not in known and (name != "report" or name in files)}
        offered += [Parameter(name, Parameter.KEYWORD_ONLY, default=None, annotation=kind) for name, kind in common.items()]

        @wraps(function)
        def run(*_: _Given.args, **options: _Given.kwargs) -> None:
            values: dict[str, Any] = {**options}
            outputs = {name: values[name] for name in ("json", "xlsx", *files)}
            read = [path for name, each in values.items() if name not in outputs and name != "csv" for path in _paths(each)]
            written = ((name, each) for name, target in outputs.items() for each in (target if isinstance(target, list) else [target]))
            require_writable([(f"--{name}", target) for name, target in written], read)
            made = {name: kind(**{each.name: values[each.name] for each in _options(kind)}) for name, kind in groups.items()}
            opened = {name: each.open() for name, each in made.items() if isinstance(each, DesignOptions)}
            called: Any = function
            found = called(**{name: ({**made, **values} | opened)[name] for name in own})
            if found is not None:
                write_result(found.kind or function.__name__.replace("_", "-"), found, outputs, values["csv"])
                if found.failed:
                    raise typer.Exit(MISSED)

        vars(run)["__signature__"] = Signature(offered)
        run.__annotations__ = {each.name: each.annotation for each in offered}
        return run

    return decorate


def _options(kind: type) -> list[Parameter]:
    """The fields of a dataclass that are annotated as options."""
    hints = get_type_hints(kind, include_extras=True)
    defaults = {each.name: Parameter.empty if each.default is MISSING else each.default for each in fields(kind)}
    return [
        Parameter(name, Parameter.KEYWORD_ONLY, default=value, annotation=hints[name])
        for name, value in defaults.items()
        if get_origin(hints[name]) is Annotated
    ]


def _paths(value: Any) -> list[Path]:
    """The files among the values of an option."""
    return [each for each in (value if isinstance(value, list | tuple) else [value]) if isinstance(each, Path)]


def write_result(kind: str, found: CommandResult, outputs: Mapping[str, Any], csv: Path | None) -> None:
    """Write the requested `outputs` (`json`, `xlsx`, `report`) and the `csv` folder; print the tables unless an output is stdout.

    `kind` is the kind of the JSON document.
    """
    json, xlsx, report = (outputs.get(name) for name in ("json", "xlsx", "report"))
    if report is not None and found.report is not None:
        save(report, found.report(), "--report")
    write_csv(csv, kind, found.body)
    write_workbook(xlsx, found.body, lambda: envelope(kind, found.mechanism, found.model, {}, found.warnings))
    if json is not None:
        write(json, as_text(envelope(kind, found.mechanism, found.model, found.body(), found.warnings)) + "\n", "--json")
        if json == STDOUT:
            return
        announce(f"Wrote {json}")
    if STDOUT in map(str, outputs.values()):
        for each in combine_warnings((*(() if found.mechanism is None else caveats(found.mechanism).warnings), *found.warnings)):
            print_warning(str(each))
        return
    show((*found.tables(), *list_caveats(kind, found.mechanism, found.warnings)))


def write_csv(folder: Path | None, kind: str, body: Callable[[], Any]) -> None:
    """Write the parts of a result into a folder, if requested, e.g. single values to `modes.csv`, part `twists` to `modes.twists.csv`."""
    if folder is None:
        return
    make_folder(folder)
    taken = set[str]()
    for path, text in to_csv(body()).items():
        name = re.sub(r"[^A-Za-z0-9_.-]", "_", f"{kind}.{path}".rstrip("."))[:_LONGEST]
        name = next(each for each in chain((name,), (f"{name}.{number}" for number in count(2))) if each not in taken)
        taken.add(name)
        write(folder / f"{name}.csv", text, "--csv")
    announce(f"Wrote {folder / kind}.*.csv")


def write_workbook(target: Path | None, body: Callable[[], Any], about: Callable[[], Document]) -> None:
    """Write the parts of a result as an Excel workbook, if requested; the last sheet contains the values of `about` (see `envelope`)."""
    if target is not None:
        save(target, to_xlsx(body(), {key: value for key, value in about().items() if value not in (None, [])}), "--xlsx")


def list_caveats(kind: str, mechanism: Mechanism | None, more: tuple[Finding, ...] = ()) -> Iterator[str]:
    """Yield texts: warnings about a description, `more` warnings about the result, and default values that affect the result.

    `kind` is the kind of the result. Without a description (`None`), only the warnings about the result are listed.
    """
    found = Caveats() if mechanism is None else caveats(mechanism)
    for title, findings in (("warning", combine_warnings((*found.warnings, *more))), ("default", found.defaults_of(kind))):
        if findings:
            yield "\n".join(f"{title}: {each}" for each in findings)


def print_missing(missing: Mapping[str, str], *, forced: bool = False) -> None:
    """Print the missing results and the reasons to stderr, one line for each reason. `forced` is true for a force-driven stage."""
    for reason in dict.fromkeys(missing.values()):
        names = ", ".join(name.replace("_", " ") for name, each in missing.items() if each == reason)
        text = reason.partition(". ")[0].rstrip(".")
        print_note(f"not computed for force-driven stages: {names}" if forced and _MAPPING in text else f"not computed: {names} ({text})")


def show(shown: Iterable[Table | str | None]) -> None:
    """Print tables and lines of text to stdout, separated by empty lines. `None` is ignored.

    Tables have the width of the terminal. If the output is not a terminal, tables are not folded and have no escape codes.
    """
    console = Console(file=sys.stdout, highlight=False, markup=False)
    width = console.width if console.is_terminal else _UNFOLDED
    console.width = max(width, _UNFOLDED)
    for number, each in enumerate(each for each in shown if each is not None):
        lines = _fold_lines(each, width) if isinstance(each, str) else _render(console, each, width)
        print_styled("\n".join(["", *lines][number == 0 :]).rstrip("\n") + "\n")


def _fold_lines(text: str, width: int) -> list[str]:
    """Lines of a text no wider than the terminal; continuation lines are indented."""
    lines = printable(text, keep="\n").splitlines()
    return lines if width == _UNFOLDED else [part for line in lines for part in _hang(line, width)]


def _hang(line: str, width: int) -> list[str]:
    start = line[: len(line) - len(line.lstrip())]
    first, *rest = fold(line.lstrip(), max(width - len(start) - _HANG, _HANG))
    return [start + first, *(f"{start}{' ' * _HANG}{each}" for each in rest)]


def _render(console: Console, table: Table, width: int) -> list[str]:
    with console.capture() as captured:
        for each in to_rich(table, width):
            console.print(each)
    return [line.rstrip() for line in captured.get().splitlines()]
