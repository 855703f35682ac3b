"""Writing figures: SVG that stands inside a page and takes its colours and font from it; PNG for everything else."""

from __future__ import annotations

import io
import re
from base64 import b64decode, b64encode
from collections import Counter
from html import escape
from typing import Any

import numpy as np

from flexstage.base.text import printable
from flexstage.show.figures.style import THEME, style_context

_TAG = re.compile(r"<[^<>]+>")
_ITS_OWN = re.compile(r' id="[\w.]+_\d+"|xlink:(?=href)|; font-family: [^;"]+| style="image-rendering[^"]+"|\n')
"""In a tag of matplotlib's what a page has no use for: numbers of groups, an old name space, a font, lines."""
_PNG = re.compile(r"(?<=data:image/png;base64,)[\w+/=]+")
_STYLE, _SEVERAL = re.compile(r' style="([^"]+)"'), 4
_DIGITS = re.compile(r"(?<=\.\d)\d+(?=[ \"])")
"""Those beyond a tenth of a point."""
_BETWEEN = re.compile(r">\s*(?:<defs>\s*<style.*?</defs>)?\s*(?=<|$)", re.DOTALL)
"""Between tags white space, and a style of all that is on a page."""


def to_svg(figure: Any, name: str, description: str) -> str:
    """The figure as an SVG element to stand inside a page; `name` keeps its identifiers apart from those of other figures.

    The same figure always gives the same text. Colours of ink, rules and paper are the page's variables, with the style's own as default.
    `description` is read to those who cannot see the picture.

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
    return printable(f'{head} style="--width:{width};max-width:{width}">{_with_classes(body, name)}', keep="\n\t")


def _with_classes(body: str, name: str) -> str:
    """The drawn elements, with a class for each style that several have."""
    counts = Counter(_STYLE.findall(body))
    known = {style: f"{name}-{number}" for number, (style, count) in enumerate(counts.items()) if count > _SEVERAL}
    rules = "".join(f".{own}{{{style}}}" for style, own in known.items())

    def with_class(tag: re.Match[str]) -> str:
        return _STYLE.sub(lambda found: f' class="{known[found[1]]}"' if found[1] in known else found[0], tag[0])

    return f"<style>{rules}</style>{_TAG.sub(with_class, body)}"


def _tag_of_page(found: re.Match[str]) -> str:
    """A tag in the page's colours and font."""
    tag = _ITS_OWN.sub("", found[0])
    if tag.startswith("<image"):
        return _PNG.sub(lambda data: _with_palette(b64decode(data[0])), tag)
    tag = _DIGITS.sub("", tag)
    for colour, name in THEME.items():
        tag = tag.replace(colour, f"var(--{name},{colour})")
    return tag


def _with_palette(data: bytes) -> str:
    """A PNG in base64, its colours in a table where there are few."""
    from PIL import Image

    pixels = np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))
    colours, index = np.unique(pixels.view(np.uint32), return_inverse=True)
    buffer = io.BytesIO()
    if len(colours) <= 256:
        image = Image.fromarray(index.reshape(pixels.shape[:2]).astype(np.uint8), "P")
        image.putpalette(colours.tobytes(), "RGBA")
        image.save(buffer, format="png")
    return b64encode(buffer.getvalue() or data).decode()


def to_png(figure: Any, *, dots_per_inch: int = 200) -> bytes:
    """The figure as PNG on white.

    >>> from flexstage.show.figures.style import canvas
    >>> to_png(canvas(1.0, 1.0))[1:4]
    b'PNG'
    """
    buffer = io.BytesIO()
    with style_context():
        figure.savefig(buffer, format="png", dpi=dots_per_inch, facecolor="white", metadata={"Software": None})
    return buffer.getvalue()
