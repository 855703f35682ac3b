"""Answers: one result as a JSON document, as tables on the terminal, or both."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import chain, count
from pathlib import Path
from typing import Any

from rich.console import Console

from flexstage.analysis.caveats import Caveats, caveats
from flexstage.base.finding import Finding
from flexstage.base.storage.document import Document, as_text
from flexstage.base.text import printable
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.theory import Model
from flexstage.show.command.output import STDOUT, announce, make_folder, save, write
from flexstage.show.command.terminal import print_note, print_styled, print_warning
from flexstage.show.document import envelope
from flexstage.show.render import fold, to_rich
from flexstage.show.sheets import to_csv
from flexstage.show.table import Table
from flexstage.show.workbook import to_xlsx

_UNFOLDED = 1000
_LONGEST = 200
_HANG = 2


def answer(  # noqa: PLR0913 (all that a command can ask for)
    kind: str,
    mechanism: Mechanism | None,
    body: Callable[[], Any],
    tables: Callable[[], Iterable[Table | str | None]],
    *,
    json: str | None,
    csv: Path | None = None,
    xlsx: Path | None = None,
    model: Model | None = None,
    warnings: tuple[Finding, ...] = (),
    beside: tuple[Path | None, ...] = (),
) -> None:
    """Write the JSON document, CSV files and workbook that are asked for, and show the tables unless stdout is one of them.

    `kind` is that of the document, `mechanism` the description it is about (`None`: none, a record alone). `warnings` are the result's
    own, told after those about the description. `beside` are the command's other outputs: where one of them goes to stdout, tables do not,
    and warnings go to stderr.
    """
    write_csv(csv, kind, body)
    write_workbook(xlsx, body, lambda: envelope(kind, mechanism, model, {}, warnings))
    if json is not None:
        write(json, as_text(envelope(kind, mechanism, model, body(), warnings)) + "\n", "--json")
        if json == STDOUT:
            return
        announce(f"Wrote {json}")
    if STDOUT in map(str, (*beside, xlsx)):
        for each in (*(() if mechanism is None else caveats(mechanism).warnings), *warnings):
            print_warning(str(each))
        return
    show((*list_caveats(kind, mechanism, warnings), *tables()))


def write_csv(folder: Path | None, kind: str, body: Callable[[], Any]) -> None:
    """Write the parts of a result into a folder, if one is named: `modes.csv` what is single, `modes.twists.csv` what is at `twists`."""
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
    """Write the parts of a result as an Excel workbook, if one is named; its last sheet says what the document's envelope says."""
    if target is not None:
        save(target, to_xlsx(body(), {key: value for key, value in about().items() if value not in (None, [])}), "--xlsx")


def list_caveats(kind: str, mechanism: Mechanism | None, more: tuple[Finding, ...] = ()) -> Iterator[str]:
    """Warnings about a description (none: a record alone) and `more` about the result, and what this kind of result takes by default."""
    found = Caveats() if mechanism is None else caveats(mechanism)
    for title, findings in (("Warnings", (*found.warnings, *more)), ("Taken by default", found.defaults_of(kind))):
        if findings:
            yield "\n".join([title, "", *(f"  {each}" for each in findings)])


def print_missing(missing: Mapping[str, str]) -> None:
    """Say on stderr which results are not given, and why; a reason that several share once."""
    for reason in dict.fromkeys(missing.values()):
        names = ", ".join(name.replace("_", " ") for name, each in missing.items() if each == reason)
        print_note(f"not given: {names}: {reason}")


def show(shown: Iterable[Table | str | None]) -> None:
    """Print tables, and lines as they are, to stdout, with an empty line between; what is absent is left out.

    Tables have the terminal's width; where the output is no terminal they are not folded and have no escape codes.
    """
    console = Console(file=sys.stdout, highlight=False, markup=False)
    width = console.width if console.is_terminal else _UNFOLDED
    console.width = max(width, _UNFOLDED)
    for number, each in enumerate(each for each in shown if each is not None):
        lines = _fold_lines(each, width) if isinstance(each, str) else _render(console, each, width)
        print_styled("\n".join(["", *lines][number == 0 :]).rstrip("\n") + "\n")


def _fold_lines(text: str, width: int) -> list[str]:
    """Lines of a text, on a terminal no wider than it, what follows of one further in."""
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
