"""A page of HTML that stands alone: sections of prose, tables and pictures, style inside, nothing loaded from anywhere."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib import resources
from typing import TypeAlias

from flexstage.base.text import printable
from flexstage.show.render import escape, to_html
from flexstage.show.table import Table


@dataclass(frozen=True)
class Prose:
    """A paragraph of plain text."""

    text: str


@dataclass(frozen=True)
class Picture:
    """An SVG element with a caption (plain text)."""

    svg: str
    caption: str = ""


@dataclass(frozen=True)
class Fact:
    """A number that sums something up: what it is, its value with unit, a remark."""

    name: str
    value: str
    remark: str = ""


@dataclass(frozen=True)
class Facts:
    """Facts side by side."""

    items: tuple[Fact, ...]


@dataclass(frozen=True)
class Abreast:
    """Blocks side by side where there is room: `narrow` in columns of a third, else of a half."""

    blocks: tuple[Block, ...]
    narrow: bool = False


@dataclass(frozen=True)
class Folded:
    """Blocks that are shown on demand (and always in print)."""

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Legend:
    """Names of colours: pairs of a CSS colour and what it stands for."""

    entries: tuple[tuple[str, str], ...]


Block: TypeAlias = Prose | Picture | Facts | Abreast | Folded | Legend | Table


@dataclass(frozen=True)
class Section:
    """A part of a page with a heading."""

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Head:
    """What stands on top of a page: the title, what kind of page it is, and what it was made from, as pairs of a name and a value."""

    title: str
    kind: str
    origin: tuple[tuple[str, str], ...]


def section(title: str, blocks: Iterable[Block | None]) -> Section | None:
    """A section of the blocks that exist; `None` where there are none.

    >>> section("Empty", [None]) is None
    True
    """
    kept = tuple(block for block in blocks if block is not None)
    return Section(title, kept) if kept else None


def fold(title: str, *blocks: Block | None) -> Folded | None:
    """The blocks that exist, shown on demand; `None` where there are none.

    >>> fold("Empty", None) is None
    True
    """
    kept = tuple(block for block in blocks if block is not None)
    return Folded(title, kept) if kept else None


def page(head: Head, sections: Sequence[Section]) -> str:
    """The whole page as HTML; every text that comes in is escaped, SVG is taken as it is.

    >>> "<h1>a &lt; b</h1>" in page(Head("a < b", "report", ()), [Section("One", (Prose("x"),))])
    True
    """
    style = resources.files("flexstage.show").joinpath("static/report.css").read_text(encoding="utf-8")
    contents = "".join(f'<li><a href="#{_anchor(each.title)}">{escape(each.title)}</a></li>' for each in sections)
    text = "".join(
        [
            '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{escape(head.title)}: {escape(head.kind)}</title>\n<style>{style}</style></head>\n<body>",
            f'<header><p class="kind">{escape(head.kind)}</p><h1>{escape(head.title)}</h1>{_origin(head)}</header>',
            f"\n<nav><ul>{contents}</ul></nav>\n<main>",
            *(_section(each) for each in sections),
            "</main></body></html>\n",
        ]
    )
    return printable(text, keep="\n\t")


def _origin(head: Head) -> str:
    items = "".join(f"<div><dt>{escape(name)}</dt><dd>{escape(value)}</dd></div>" for name, value in head.origin)
    return f'<dl class="origin">{items}</dl>' if items else ""


def _anchor(title: str) -> str:
    return "".join(sign if sign.isalnum() else "-" for sign in title.lower()).strip("-")


def _section(each: Section) -> str:
    return f'\n<section id="{_anchor(each.title)}"><h2>{escape(each.title)}</h2>{"".join(_blocks(each.blocks))}</section>'


def _blocks(blocks: Iterable[Block]) -> Iterator[str]:
    for block in blocks:
        if isinstance(block, Table):
            yield f'<div class="table">{to_html(block)}</div>'
        elif isinstance(block, Prose):
            yield f"<p>{escape(block.text)}</p>"
        elif isinstance(block, Picture):
            caption = f"<figcaption>{escape(block.caption)}</figcaption>" if block.caption else ""
            yield f"<figure>{block.svg}{caption}</figure>"
        else:
            yield _group(block)


def _group(block: Facts | Abreast | Folded | Legend) -> str:
    if isinstance(block, Facts):
        return f'<div class="facts">{"".join(_fact(item) for item in block.items)}</div>'
    if isinstance(block, Legend):
        entries = "".join(f'<span><i style="background:{colour}"></i>{escape(name)}</span>' for colour, name in block.entries)
        return f'<p class="legend">{entries}</p>'
    inner = "".join(_blocks(block.blocks))
    if isinstance(block, Folded):
        return f"<details><summary>{escape(block.title)}</summary>{inner}</details>"
    return f'<div class="abreast{" narrow" if block.narrow else ""}">{inner}</div>'


def _fact(item: Fact) -> str:
    remark = f"<small>{escape(item.remark)}</small>" if item.remark else ""
    return f"<div><dt>{escape(item.name)}</dt><dd>{escape(item.value)}</dd>{remark}</div>"
