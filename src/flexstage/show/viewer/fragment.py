"""The viewer in an HTML page: HTML elements, the data of stages, and the viewer's program. No other file is loaded.

A page contains any number of `element`s, one `data_script` for each stage, and the program (`bundle`) in one script. The script finds the
elements and draws each when it becomes visible. Without scripts or WebGL, the content of the element is shown.
"""

from __future__ import annotations

from functools import cache
from html import escape
from importlib import resources

from flexstage.show.viewer.data import StageData


def element(key: str, *, motion: str = "", instead: str = "") -> str:
    """Write the HTML element of a viewer for the data named `key`.

    The viewer starts with a `motion` such as "mode 1" or "stroke B1", by default with the undeformed stage. `instead` is HTML that is shown
    in print, and without scripts or WebGL; it is inserted without escapes.

    >>> element("stage", motion="mode 1", instead="<p>a picture</p>")
    '<div data-flexstage="stage" data-motion="mode 1"><p>a picture</p></div>'
    """
    attribute = f' data-motion="{escape(motion)}"' if motion else ""
    return f'<div data-flexstage="{escape(key)}"{attribute}>{instead}</div>'


def data_script(key: str, data: StageData) -> str:
    """Write the script element with a stage's data, which a page needs once for all viewers with this `key`.

    Every "<" in the data is escaped, so that no text can end the script.
    """
    return f'<script type="application/json" id="{escape(key)}">{data.text().replace("<", chr(92) + "u003c")}</script>'


@cache
def read_static(name: str) -> str:
    """Read a shipped file of pages."""
    return resources.files("flexstage.show").joinpath(f"static/{name}").read_text(encoding="utf-8")


def bundle() -> str:
    """Read the viewer's program as shipped, with its licence at the top."""
    return read_static("viewer.js")


def fragment(data: StageData, *, motion: str = "", instead: str = "") -> str:
    """Write the content of a page with one viewer: element, data and program."""
    return element("stage", motion=motion, instead=instead) + data_script("stage", data) + f"<script>{bundle()}</script>"
