"""A self-contained HTML page: sections of text, tables and pictures, with inline style and without external files."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeAlias

from flexstage.base.text import printable
from flexstage.show.figures.export import to_svg
from flexstage.show.render import templates
from flexstage.show.table import Table
from flexstage.show.viewer.data import StageData
from flexstage.show.viewer.fragment import bundle, data_script, read_static


@dataclass(frozen=True)
class Prose:
    """A paragraph of plain text."""

    text: str


@dataclass(frozen=True)
class Picture:
    """An SVG element with a caption (plain text). `plays` names the shown motion as the page's viewer does ("mode 1").

    `reading` is the data for the cursor over the picture, from `show.figures.reading`.
    """

    svg: str
    caption: str = ""
    plays: str = ""
    reading: str = ""


def picture(figure: Any, name: str, description: str, caption: str, *, reading: str = "") -> Picture:
    """Convert a figure to a picture; `name` and `description` are those of `to_svg`.

    >>> from flexstage.show.figures.style import canvas
    >>> picture(canvas(1.0, 1.0), "empty", "nothing", "An empty figure.").caption
    'An empty figure.'
    """
    return Picture(to_svg(figure, name, description), caption, reading=reading)


@dataclass(frozen=True)
class Viewer:
    """An animated stage, starting with a `motion` ("mode 1").

    `key` names the stage's data in the page; `ghost` names the data of another stage that is drawn behind this stage. `instead` replaces
    the animation in print, and without scripts or WebGL.
    """

    key: str
    instead: tuple[Block, ...]
    motion: str = ""
    ghost: str = ""


@dataclass(frozen=True)
class JoinedViewers:
    """Two viewers side by side. If a motion is chosen in one viewer, the other shows the motion that `partners` pairs with it."""

    viewers: tuple[Viewer, Viewer]
    partners: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Fact:
    """A summary value: name, value with unit, remark."""

    name: str
    value: str
    remark: str = ""


@dataclass(frozen=True)
class Facts:
    """Summary values side by side."""

    items: tuple[Fact, ...]


@dataclass(frozen=True)
class BlockRow:
    """Blocks side by side if the page is wide enough, in three columns if `narrow`, else in two."""

    blocks: tuple[Block, ...]
    narrow: bool = False


@dataclass(frozen=True)
class Folded:
    """Blocks that are shown on demand (and always in print)."""

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Legend:
    """Legend of colours: pairs of a CSS colour and its meaning."""

    entries: tuple[tuple[str, str], ...]


Block: TypeAlias = Prose | Picture | Viewer | JoinedViewers | Facts | BlockRow | Folded | Legend | Table


@dataclass(frozen=True)
class Section:
    """Section of a page, with a heading."""

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Headline:
    """The summary of a page in one line. `good` is true if the requirements are met, false if not, `None` if there are no requirements."""

    text: str
    good: bool | None = None


@dataclass(frozen=True)
class Head:
    """The head of a page: title, kind of page and headline. `origin` contains name and value of each source listed at the page's end."""

    title: str
    kind: str
    origin: tuple[tuple[str, str], ...]
    headline: Headline | None = None


def section(title: str, blocks: Iterable[Block | None]) -> Section | None:
    """Make a section from the blocks that are not `None`. Returns `None` if all blocks are `None`.

    >>> section("Empty", [None]) is None
    True
    """
    kept = tuple(block for block in blocks if block is not None)
    return Section(title, kept) if kept else None


def fold(title: str, *blocks: Block | None) -> Folded | None:
    """Make a collapsed part from the blocks that are not `None`; a reader can expand it. Returns `None` if all are `None`.

    >>> fold("Empty", None) is None
    True
    """
    found = section(title, blocks)
    return found and Folded(title, found.blocks)


def page(head: Head, sections: Iterable[Section | None], stages: Mapping[str, StageData] = MappingProxyType({})) -> str:
    """Write the HTML page with the sections that are not `None`. Texts are escaped; SVG is inserted unchanged.

    `stages` maps the keys of the page's viewers to their data. The content security policy permits only the scripts in the page, and
    forbids loading other files.

    >>> "<h1>a &lt; b</h1>" in page(Head("a < b", "report", ()), [Section("One", (Prose("x"),))])
    True
    """
    scripts = [read_static("report.js"), *([bundle()] if stages else [])]
    kept = [each for each in sections if each is not None]
    text = printable(str(templates().page(head, kept, read_static("report.css"), _policy(scripts))), keep="\n\t")
    data = "".join(data_script(key, each) for key, each in stages.items())
    return text + data + "".join(f"<script>{each}</script>" for each in scripts) + "</body></html>\n"


def _policy(scripts: Iterable[str]) -> str:
    """Content security policy: these scripts, inline styles and inline pictures; no loading."""
    sums = " ".join(f"'sha256-{base64.b64encode(hashlib.sha256(each.encode()).digest()).decode()}'" for each in scripts)
    return f"default-src 'none'; script-src {sums}; style-src 'unsafe-inline'; img-src data: blob:"
