"""Conversion of figures: SVG with the colours and font of an HTML page; PNG for other uses."""

from __future__ import annotations

import io
import re
from html import escape
from typing import Any

from flexstage.base.text import printable
from flexstage.show.figures.style import THEME, style_context

_TAG = re.compile(r"<[^<>]+>")
_ITS_OWN = re.compile(r' id="[\w.]+_\d+"|xlink:(?=href)|; font-family: [^;"]+| style="image-rendering[^"]+"|\n')
"""Parts of matplotlib's tags without use in a page: numbers of groups, an old name space, a font, lines."""
_DIGITS = re.compile(r"(?<=\.\d)\d+(?=[ \"])")
"""Digits beyond a tenth of a point."""
_BETWEEN = re.compile(r">\s*(?:<defs>\s*<style.*?</defs>)?\s*(?=<|$)", re.DOTALL)
"""White space between tags, and a style that the page has already."""


def to_svg(figure: Any, name: str, description: str) -> str:
    """Convert a figure to an SVG element for an HTML page. `name` makes the identifiers in the SVG element unique.

    Equal figures give identical SVG. The colours of text, lines and background are CSS variables of the page; their defaults are the
    colours of the style. `description` is the text for screen readers.

    >>> from flexstage.show.figures.style import canvas
    >>> to_svg(canvas(1.0, 1.0), "empty", "nothing")[:33]
    '<svg viewBox="0 0 72 72" role="im'
    """
    content, (wide, high) = io.StringIO(), figure.get_size_inches()
    with style_context(f"flexstage {name}"):
        figure.savefig(content, format="svg", metadata=dict.fromkeys(("Creator", "Date", "Format", "Type")))
    drawn = content.getvalue()
    body = _TAG.sub(_tag_of_page, _BETWEEN.sub(">", drawn[drawn.index("<svg ") :]).partition(">")[2])
    head = f'<svg viewBox="0 0 {72.0 * wide:g} {72.0 * high:g}" role="img" aria-label="{escape(description)}"'
    width = f"{96.0 * wide:.0f}px"
    return printable(f'{head} style="--width:{width};max-width:{width}">{body}', keep="\n\t")


def _tag_of_page(found: re.Match[str]) -> str:
    """A tag with the page's colours and font."""
    tag = _ITS_OWN.sub("", found[0])
    if tag.startswith("<image"):
        return tag
    tag = _DIGITS.sub("", tag)
    for colour, name in THEME.items():
        tag = tag.replace(colour, f"var(--{name},{colour})")
    return tag


def to_png(figure: Any, *, dots_per_inch: int = 200) -> bytes:
    """Convert a figure to PNG on a white background.

    >>> from flexstage.show.figures.style import canvas
    >>> to_png(canvas(1.0, 1.0))[1:4]
    b'PNG'
    """
    buffer = io.BytesIO()
    with style_context():
        figure.savefig(buffer, format="png", dpi=dots_per_inch, facecolor="white", metadata={"Software": None})
    return buffer.getvalue()
