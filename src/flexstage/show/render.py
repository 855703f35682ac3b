"""Renderers: one table as plain text, Markdown, HTML, or for the terminal."""

from __future__ import annotations

import html
from typing import Any

from flexstage.base.text import printable
from flexstage.show.display import to_typography
from flexstage.show.table import Cell, Column, Mark, Table

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


def to_text(table: Table) -> str:
    """The table as lines of plain text, columns aligned.

    >>> from flexstage.show.table import make_table
    >>> print(to_text(make_table("Masses", ["body", Column("mass", "kg")], [("platform", "14"), ("lever", "0.5")])))
    Masses
    body      mass [kg]
    --------  ---------
    platform         14
    lever           0.5
    """
    lines = table.texts()
    widths = [max(len(line[index]) for line in lines) for index in range(len(table.columns))]
    rule = ["-" * width for width in widths]
    body = [_line(line, widths, table.columns) for line in (lines[0], rule, *lines[1:])]
    return "\n".join([table.title, *body, *table.notes])


def _line(cells: list[str], widths: list[int], columns: tuple[Column, ...]) -> str:
    padded = [
        cell.rjust(width) if column.numeric else cell.ljust(width) for cell, width, column in zip(cells, widths, columns, strict=True)
    ]
    return "  ".join(padded).rstrip()


def to_markdown(table: Table) -> str:
    r"""The table in GitHub's Markdown.

    >>> from flexstage.show.table import make_table
    >>> print(to_markdown(make_table("Masses", ["body", Column("mass", "kg")], [("a|b", "14")])))
    **Masses**
    <BLANKLINE>
    | body | mass [kg] |
    | :-- | --: |
    | a\|b | 14 |
    """
    lines = [[_markdown(cell) for cell in line] for line in table.texts()]
    rule = ["--:" if column.numeric else ":--" for column in table.columns]
    body = "\n".join(f"| {' | '.join(line)} |" for line in (lines[0], rule, *lines[1:]))
    notes = "".join(f"\n\n{_markdown(note)}" for note in table.notes)
    return f"**{_markdown(table.title)}**\n\n{body}{notes}"


def _markdown(text: str) -> str:
    for sign in "\\|*_`<":
        text = text.replace(sign, f"\\{sign}")
    return text.replace("\n", " ")


def to_html(table: Table) -> str:
    """The table as HTML without style of its own; classes say what cells mean, all texts are escaped.

    >>> from flexstage.show.table import make_table
    >>> to_html(make_table("a < b", ["x"], [("1",)]))
    '<table><caption>a &lt; b</caption><thead><tr><th>x</th></tr></thead><tbody><tr><td>1</td></tr></tbody></table>'
    """
    caption = f"<caption>{escape(table.title)}</caption>" if table.title else ""
    head = "".join(_html_head(column) for column in table.columns)
    body = "".join(f"<tr>{_html_row(row, table.columns)}</tr>" for row in table.rows)
    notes = "".join(f'<p class="note">{escape(note)}</p>' for note in table.notes)
    return f"<table>{caption}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{notes}"


def escape(text: str) -> str:
    """Text of anybody's making as HTML, units and numbers typeset.

    >>> escape('<b>"5 um"</b>')
    '&lt;b&gt;&quot;5 µm&quot;&lt;/b&gt;'
    """
    return html.escape(to_typography(text), quote=True)


def _html_head(column: Column) -> str:
    unit = f' <span class="unit">{escape(column.unit)}</span>' if column.unit else ""
    return f"<th{_class('number' if column.numeric else '')}>{escape(column.head)}{unit}</th>"


def _html_row(row: tuple[Cell, ...], columns: tuple[Column, ...]) -> str:
    return "".join(_html_cell(cell, column) for cell, column in zip(row, columns, strict=True))


def _html_cell(cell: Cell, column: Column) -> str:
    classes = ["number"] if column.numeric else []
    classes += [] if cell.mark is Mark.PLAIN else [cell.mark.value]
    classes += ["bar"] if cell.bar is not None else []
    style = f' style="--share:{min(max(cell.bar, 0.0), 1.0):.3f}"' if cell.bar is not None else ""
    return f"<td{_class(' '.join(classes))}{style}>{escape(cell.text)}</td>"


def _class(names: str) -> str:
    return f' class="{names}"' if names else ""


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
