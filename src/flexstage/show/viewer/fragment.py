"""The viewer within an HTML page: its element, the stage's data once and the bundle once; nothing is loaded.

A page contains any number of `element`s, one `data_script` for each stage and one `bundle_script`. The script finds the elements and
draws each when it becomes visible. Without scripts or WebGL, the content of the element is shown.
"""

from __future__ import annotations

from functools import cache
from html import escape
from importlib import resources

from flexstage.show.viewer.data import StageData


def element(key: str, *, motion: str = "", instead: str = "") -> str:
    """The element of a viewer for the data named `key`; it begins with a `motion`, "mode 1" or "stroke B1", or undeformed.

    `instead` is unescaped HTML: the content without a script or WebGL, and in print.

    >>> element("stage", motion="mode 1", instead="<p>a picture</p>")
    '<div data-flexstage="stage" data-motion="mode 1"><p>a picture</p></div>'
    """
    wanted = f' data-motion="{escape(motion)}"' if motion else ""
    return f'<div data-flexstage="{escape(key)}"{wanted}>{instead}</div>'


def data_script(key: str, data: StageData) -> str:
    """A stage's data, once in a page, for all viewers of the `key`.

    No text in it ends the script: every "<" is escaped.
    """
    return f'<script type="application/json" id="{escape(key)}">{data.text().replace("<", chr(92) + "u003c")}</script>'


@cache
def bundle() -> str:
    """The viewer's program as shipped, its licence at the top."""
    return resources.files("flexstage.show").joinpath("static/viewer.js").read_text(encoding="utf-8")


def bundle_script() -> str:
    """The viewer's program, once in a page, after all elements and data.

    >>> bundle_script().count("</script>")
    1
    """
    return f"<script>{bundle()}</script>"


def fragment(data: StageData, *, key: str = "stage", motion: str = "", instead: str = "") -> str:
    """The content of a page with one viewer: element, data and program."""
    return element(key, motion=motion, instead=instead) + data_script(key, data) + bundle_script()
