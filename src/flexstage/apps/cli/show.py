"""Tables on the terminal: at its width, without escape codes and without folding where the output is no terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexstage.present.table import Table

_UNFOLDED = 1000


def show(tables: Iterable[Table]) -> None:
    """Print tables to stdout, one after the other."""
    from rich.console import Console

    from flexstage.apps.cli.speech import styled
    from flexstage.present.render import to_rich

    console = Console(file=sys.stdout, highlight=False, markup=False)
    if not console.is_terminal:
        console.width = _UNFOLDED
    for number, table in enumerate(tables):
        with console.capture() as captured:
            console.print(to_rich(table))
        lines = [line.rstrip() for line in captured.get().splitlines()]
        styled("\n".join(["", *lines][number == 0 :]).rstrip("\n") + "\n")
