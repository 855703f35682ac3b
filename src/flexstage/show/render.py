"""Rendering of tables: as HTML from templates, and for the terminal."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rich.cells import cell_len

from flexstage.base.lazy import LazyModule
from flexstage.base.text import printable
from flexstage.show.display import to_typography
from flexstage.show.table import PAGE_ROWS, Cell, Column, Mark, Table, first_rows

if TYPE_CHECKING:
    import jinja2
else:
    jinja2 = LazyModule("jinja2")  # not needed for a terminal

_STYLES = {
    Mark.STRONG: "bold",
    Mark.FAINT: "dim",
    Mark.PASS: "green",
    Mark.FAIL: "bold red",
    Mark.WARN: "yellow",
    Mark.STATED: "green",
    Mark.DERIVED: "cyan",
    Mark.ASSUMED: "yellow",
}


def to_html(table: Table) -> str:
    """Render a table as HTML without style. CSS classes give the meaning of cells; all texts are escaped.

    >>> from flexstage.show.table import make_table
    >>> to_html(make_table("a < b", ["x"], [("1",)]))
    '<table><caption>a &lt; b</caption><thead><tr><th scope="col">x</th></tr></thead><tbody><tr><th scope="row">1</th></tr></tbody></table>'
    """
    return str(templates().table(table))


@functools.cache
def templates() -> Any:
    """Load the macros of `static/page.html`; they typeset and escape every inserted text."""
    loader = jinja2.PackageLoader("flexstage.show", "static")
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, finalize=_typeset)
    environment.filters |= _FILTERS
    return environment.get_template("page.html").module


def _typeset(value: Any) -> Any:
    return value if hasattr(value, "__html__") else to_typography(str(value))


def _anchor(title: str) -> str:
    return "".join(sign if sign.isalnum() else "-" for sign in title.lower()).strip("-")


_WORDY = 28
"""Length of a cell next to a name [characters] from which a table is stacked on narrow screens."""
_LONG = 12
"""Length of a name [characters] from which it may be broken on narrow screens."""


def _has_long_names(table: Table) -> bool:
    return any(len(row[0].text) > _LONG for row in table.rows if row)


def _is_wordy(table: Table) -> bool:
    return any(len(cell.text) > _WORDY for row in table.rows for cell in row[1:])


def _kind(block: object) -> str:
    return type(block).__name__.lower()


def _attributes(cell: Cell, column: Column) -> str:
    """Attributes for the style of a cell."""
    marked = {"number": column.numeric, cell.mark.value: cell.mark is not Mark.PLAIN, "bar": cell.bar is not None}
    classes = " ".join(name for name, told in marked.items() if told)
    share = "" if cell.bar is None else f' style="--share:{cell.length:.3f}"'
    return (f' class="{classes}"' if classes else "") + share


_FILTERS: dict[str, Callable[..., Any]] = {
    "anchor": _anchor,
    "attributes": _attributes,
    "kind": _kind,
    "wordy": _is_wordy,
    "named": _has_long_names,
    "beginning": functools.partial(first_rows, most=PAGE_ROWS),
}

_GAP = 3
_NARROWEST = 40
_CAPTION = 80
_BREAKS = re.compile(r"(?<!\d) +(?!m\b|\[)| +(?=[+-]?\d|to |and |\()")
_INNER_BREAKS = re.compile(r"(?<=[./,_-])(?=[A-Za-z])")


@dataclass(frozen=True)
class _Span:
    """Width of a column: at least its longest word, at most its longest line."""

    least: int
    most: int


def to_rich(table: Table, width: int) -> Iterator[Any]:
    """Render a table for a terminal that is `width` characters wide: title, table, notes.

    Lines are broken only between words, not between a number and its unit. Columns that do not fit are printed in further tables below,
    with the row names repeated.

    >>> from flexstage.show.table import make_table
    >>> [type(each).__name__ for each in to_rich(make_table("Masses", ["body"], [("platform",)]), 80)]
    ['Text', 'Table']
    """
    from rich.text import Text

    width = max(width, _NARROWEST)
    spans = [_span(table, index) for index in range(len(table.columns))]
    if _total(each.least for each in spans) > width:
        spans = [_span(table, index, longest=width // 3) for index in range(len(table.columns))]
    panels = [_fit(panel, width) for panel in _panels(spans, width)]
    if table.title:
        yield Text(_fill(table.title, width), style="bold")
    for panel in panels:
        yield _rich_table(table, panel)
    if table.notes:
        wide = max((_total(panel.values()) for panel in panels), default=0)
        notes = "\n".join(table.notes)
        yield Text(_fill(notes, min(width, max(wide, _CAPTION))), style="dim")


def _rich_table(table: Table, widths: Mapping[int, int]) -> Any:
    """The columns of these indices with these widths."""
    from rich import box
    from rich.table import Table as RichTable
    from rich.text import Text

    result = RichTable(box=box.SIMPLE_HEAD, pad_edge=False)
    for index, width in widths.items():
        column = table.columns[index]
        justify = "right" if column.numeric else "left"
        head = f"{_fill(column.head, width)}\n[{printable(column.unit)}]" if column.unit else _fill(column.head, width)
        result.add_column(Text(head), justify=justify, width=width, no_wrap=True, overflow="crop")
    for row in table.rows:
        result.add_row(*(Text(_fill(row[index].text, width), style=_STYLES.get(row[index].mark, "")) for index, width in widths.items()))
    return result


def _span(table: Table, index: int, longest: int | None = None) -> _Span:
    """A column's span; names longer than `longest` may be broken."""
    column = table.columns[index]
    texts = [column.head, *(printable(row[index].text, keep="\n") for row in table.rows)]
    unit = cell_len(f"[{column.unit}]") if column.unit else 0
    most = max((cell_len(line) for text in texts for line in text.splitlines()), default=0)
    words = [word for text in texts for line in text.splitlines() for word in _BREAKS.split(line)]
    if longest is not None:
        words = [piece for word in words for piece in (_INNER_BREAKS.split(word) if cell_len(word) > longest else [word])]
    return _Span(max(*map(cell_len, words), unit), max(most, unit))


def _panels(spans: Sequence[_Span], width: int) -> list[dict[int, _Span]]:
    """The columns in as many tables as the width requires; the first column, with the row names, is in each."""
    panels: list[dict[int, _Span]] = []
    for index, span in enumerate(spans):
        if panels and _total([*(each.least for each in panels[-1].values()), span.least]) <= width:
            panels[-1][index] = span
        else:
            panels.append({0: spans[0], index: span})
    return panels[1:] if len(panels) > 1 and len(panels[0]) == 1 and len(spans) > 1 else panels


def _total(widths: Iterable[int]) -> int:
    widths = list(widths)
    return sum(widths) + _GAP * (len(widths) - 1) + 2


def _fit(spans: Mapping[int, _Span], width: int) -> dict[int, int]:
    """Widths of columns that fit, reduced from the widest."""
    found = {index: span.most for index, span in spans.items()}
    while _total(found.values()) > width:
        able = [index for index, span in spans.items() if found[index] > span.least]
        if not able:
            break
        found[max(able, key=lambda index: found[index])] -= 1
    return found


def _fill(text: str, width: int) -> str:
    """The text on lines of at most this width, broken between words, within long names after a dot or a slash."""
    return "\n".join(line for each in printable(text, keep="\n").split("\n") for line in fold(each, width))


def fold(text: str, width: int) -> list[str]:
    """Break a line into lines of at most `width` characters, between words, but not between a number and its unit.

    Names longer than a line are broken after a dot or a slash.

    >>> fold("at least 50 um at parts.neck.thickness", 15)
    ['at least 50 um', 'at parts.neck.', 'thickness']
    """
    lines = [""]
    pieces = [(" ", word) for word in _BREAKS.split(text)] if cell_len(text) > width else [("", text)]
    for gap, word in pieces:
        for number, piece in enumerate(_INNER_BREAKS.split(word) if cell_len(word) > width else [word]):
            joint = gap if number == 0 and lines[-1] else ""
            if lines[-1] and cell_len(lines[-1] + joint + piece) > width:
                lines.append(piece)
            else:
                lines[-1] += joint + piece
    return lines
