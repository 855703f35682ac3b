"""Renderers: tables as HTML, by templates, and for the terminal."""

from __future__ import annotations

import functools
from typing import Any

import jinja2

from flexstage.base.text import printable
from flexstage.show.display import to_typography
from flexstage.show.table import Mark, Table

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
    """The table as HTML without style of its own; classes say what cells mean, all texts are escaped.

    >>> from flexstage.show.table import make_table
    >>> to_html(make_table("a < b", ["x"], [("1",)]))
    '<table><caption>a &lt; b</caption><thead><tr><th>x</th></tr></thead><tbody><tr><td>1</td></tr></tbody></table>'
    """
    return str(templates().table(table))


@functools.cache
def templates() -> Any:
    """The macros of `static/page.html`: every text that comes in is typeset and escaped."""
    loader = jinja2.PackageLoader("flexstage.show", "static")
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined, finalize=_typeset)
    environment.filters |= {"anchor": _anchor, "kind": lambda block: type(block).__name__.lower()}
    return environment.get_template("page.html").module


def _typeset(value: Any) -> Any:
    return value if hasattr(value, "__html__") else to_typography(str(value))


def _anchor(title: str) -> str:
    return "".join(sign if sign.isalnum() else "-" for sign in title.lower()).strip("-")


def to_rich(table: Table) -> Any:
    """The table as a `rich.table.Table` for the terminal.

    >>> from flexstage.show.table import make_table
    >>> to_rich(make_table("Masses", ["body"], [("platform",)])).row_count
    1
    """
    from rich import box
    from rich.table import Table as RichTable
    from rich.text import Text

    caption = Text(printable("\n".join(table.notes), keep="\n"), style="dim", justify="left") if table.notes else None
    result = RichTable(
        title=Text(printable(table.title), style="bold"),
        title_justify="left",
        caption=caption,
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        pad_edge=False,
    )
    for column in table.columns:
        head = Text(printable(f"{column.head}\n[{column.unit}]" if column.unit else column.head, keep="\n"))
        result.add_column(head, justify="right" if column.numeric else "left", overflow="fold")
    for row in table.rows:
        result.add_row(*(Text(printable(cell.text, keep="\n"), style=_STYLES.get(cell.mark, "")) for cell in row))
    return result
