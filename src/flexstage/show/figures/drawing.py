"""A figure as a separate file: SVG, PDF or PNG according to the ending of its name."""

from __future__ import annotations

import io
from pathlib import PurePath
from typing import Any

from flexstage.base.finding import refuse
from flexstage.base.text import printable
from flexstage.show.figures.export import to_png
from flexstage.show.figures.style import style_context

FORMATS = (".svg", ".pdf", ".png")


def format_of(name: str) -> str:
    """Return the format of a figure file from the ending of its name. Raises `DesignError` for an unknown ending.

    >>> format_of("plan.SVG")
    '.svg'
    """
    ending = PurePath(name).suffix.lower()
    if ending not in FORMATS:
        raise refuse(name, f'unknown format "{ending}"', f"Use a file name that ends in {', '.join(FORMATS)}")
    return ending


def drawing(figure: Any, ending: str) -> bytes:
    """Return the content of a figure file in the format of an `ending`. Equal figures give identical files.

    >>> from flexstage.show.figures.style import canvas
    >>> drawing(canvas(1.0, 1.0), ".svg")[:5]
    b'<?xml'
    """
    if ending == ".png":
        return to_png(figure)
    buffer = io.BytesIO()
    with style_context():
        dates = {"Date": None} if ending == ".svg" else {"CreationDate": None}
        figure.savefig(buffer, format=ending.removeprefix("."), metadata=dates, facecolor="white")
    content = buffer.getvalue()
    return printable(content.decode(), keep="\n\t").encode() if ending == ".svg" else content
