"""Writing figures: SVG small enough to stand inside a page, taking its colours and font from it; PNG for everything else."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from html import escape
from typing import Any

from flexstage.base.text import printable
from flexstage.show.figures.style import short, style_context

_STYLE = re.compile(r' style="([^"]+)"')
_PICTURE = re.compile(r"<svg .*?</svg>", re.DOTALL)
_SHEET = re.compile(r"<style>([^<]*)</style>")
_RULE = re.compile(r"\.([\w-]+)(\{[^}]*\})")
_CLASS = re.compile(r' class="([\w-]+)"(?=[^<>]*>)')
_REFERENCE = re.compile(r'(?: id="|href="#|url\(#)([\w-]+)(?=[^<>]*>)')
SCENERY = "scenery"
"""Artists with this `gid` say their own `markup`, which comes under everything else of a figure."""


def to_svg(figure: Any, name: str, description: str) -> str:
    """The figure as an SVG element to stand inside a page; `name` keeps its identifiers apart from those of other figures.

    The same figure always gives the same text. Colours of ink, rules and paper are the page's variables, with the style's own as default.
    `description` is read to those who cannot see the picture.

    >>> from flexstage.show.figures.style import canvas
    >>> to_svg(canvas(1.0, 1.0), "empty", "nothing")[:33]
    '<svg viewBox="0 0 72 72" role="im'
    """
    from flexstage.show.figures.pen import Pen  # loads matplotlib

    wide, high = 72.0 * figure.get_size_inches()
    dots, pen = figure.dpi, Pen(wide, high, name)
    scenery = [each for axes in figure.axes for each in axes.artists if each.get_gid() == SCENERY]
    with style_context():
        figure.dpi = 72.0
        for each in scenery:
            each.set_visible(False)
        figure.draw(pen)
        for each in scenery:
            each.set_visible(True)
        figure.dpi = dots
    under = "".join(each.markup(f"{name}-{number}") for number, each in enumerate(scenery))
    body, classes = _classes("".join(pen.said), name)
    return printable(f"{head((wide, high), description)}{under}{classes}{body}</svg>", keep="\n\t")


def to_png(figure: Any, *, dots_per_inch: int = 160) -> bytes:
    """The figure as PNG on white.

    >>> from flexstage.show.figures.style import canvas
    >>> to_png(canvas(1.0, 1.0))[1:4]
    b'PNG'
    """
    buffer = io.BytesIO()
    with style_context():
        figure.savefig(buffer, format="png", dpi=dots_per_inch, facecolor="white", metadata={"Software": None})
    return buffer.getvalue()


def share_styles(page: str) -> tuple[str, str]:
    """A page of HTML whose pictures of `to_svg` share one style sheet, which comes beside it: equal rules once, all names short.

    >>> one, other = (f'<svg ><style>.{name}-0{{fill:red}}</style><path class="{name}-0"/></svg>' for name in ("first", "second"))
    >>> share_styles(one + other)
    ('<svg ><path class="_0"/></svg><svg ><path class="_0"/></svg>', '._0{fill:red}')
    """
    classes: dict[str, str] = {}
    names: dict[str, str] = {}

    def shared(found: re.Match[str]) -> str:
        rules = [rule for sheet in _SHEET.findall(found[0]) for rule in _RULE.findall(sheet)]
        own = {name: classes.setdefault(rule, f"_{len(classes)}") for name, rule in rules}
        text = _CLASS.sub(lambda tag: f' class="{own.get(tag[1], tag[1])}"', _SHEET.sub("", found[0]))
        return _REFERENCE.sub(lambda tag: tag[0].replace(tag[1], names.setdefault(tag[1], f"_{len(names)}")), text)

    told = _PICTURE.sub(shared, page)
    return told, "".join(f".{name}{rule}" for rule, name in classes.items())


def head(size: Sequence[float], description: str) -> str:
    """How a picture of that size [pt] begins; `description` is read to those who cannot see it.

    >>> head((72.0, 36.0), "a < b")
    '<svg viewBox="0 0 72 36" role="img" aria-label="a &lt; b" style="--width:96px;max-width:96px">'
    """
    width = round(float(size[0]) * 96.0 / 72.0)
    box = " ".join(short(each) for each in (0.0, 0.0, *size))
    return f'<svg viewBox="{box}" role="img" aria-label="{escape(description)}" style="--width:{width}px;max-width:{width}px">'


def _classes(body: str, name: str) -> tuple[str, str]:
    """Styles used more than twice become classes of a style sheet of the figure's own, but for those that refer to something of it."""
    counts: dict[str, int] = {}
    for style in _STYLE.findall(body):
        counts[style] = counts.get(style, 0) + 1
    common = [style for style, count in counts.items() if count > 2 and "url(#" not in style]
    names = {style: f"{name}-{number}" for number, style in enumerate(common)}
    body = _STYLE.sub(lambda found: f' class="{names[found[1]]}"' if found[1] in names else found[0], body)
    rules = "".join(f".{names[style]}{{{style}}}" for style in common)
    return body, f"<style>{rules}</style>" if rules else ""
