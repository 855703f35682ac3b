"""How a table is printed on so many columns of a terminal, and what of it is broken there."""

from __future__ import annotations

import io
import re

from rich.console import Console

from flexstage.show.render import to_rich
from flexstage.show.table import Table

_NAME = re.compile(r"(?<=[./,_-])(?=[A-Za-z])")


def printed(table: Table, width: int) -> list[str]:
    """The lines of a table."""
    console = Console(file=io.StringIO(), width=1000, highlight=False, markup=False)
    for each in to_rich(table, width):
        console.print(each)
    return [line.rstrip() for line in console.file.getvalue().splitlines()]


def broken(table: Table, width: int) -> list[str]:
    """Words of heads, and words and numbers of cells, that are not there whole; of names longer than a third of the width their parts."""
    lines = printed(table, width)
    there = set(" ".join(lines).split())
    heads = [f"{column.head} [{column.unit}]" if column.unit else column.head for column in table.columns]
    words = [word for text in (*heads, *(cell.text for row in table.rows for cell in row)) for word in text.split()]
    pieces = [piece for word in words for piece in (_NAME.split(word) if len(word) > width // 3 and word not in there else [word])]
    wide = [f"{len(line)} columns: {line}" for line in lines if len(line) > width]
    parts = {part for word in there for part in _NAME.split(word)}
    return [*wide, *(piece for piece in pieces if piece not in there | parts)]
