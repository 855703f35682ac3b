"""Tables and lines on the terminal: tables at its width, without escape codes and without folding where the output is no terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from flexstage.present.table import Table

_UNFOLDED = 1000


def show(shown: Iterable[Table | str | None]) -> None:
    """Print tables, and lines as they are, to stdout, with an empty line between; what is absent is left out."""
    from rich.console import Console

    from flexstage.apps.cli.speech import styled
    from flexstage.base.text import printable

    console = Console(file=sys.stdout, highlight=False, markup=False)
    if not console.is_terminal:
        console.width = _UNFOLDED
    for number, each in enumerate(each for each in shown if each is not None):
        lines = printable(each, keep="\n").splitlines() if isinstance(each, str) else _rendered(console, each)
        styled("\n".join(["", *lines][number == 0 :]).rstrip("\n") + "\n")


def _rendered(console: Console, table: Table) -> list[str]:
    from flexstage.present.render import to_rich

    with console.capture() as captured:
        console.print(to_rich(table))
    return [line.rstrip() for line in captured.get().splitlines()]
