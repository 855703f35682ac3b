"""The viewer within a page of HTML: its place, the stage's data once and the bundle once; nothing is loaded from anywhere.

A page holds any number of `element`s, one `data_script` for each stage and one `bundle_script`, which finds the elements by itself and
draws each when it comes into sight. Where there is no script or no WebGL, what stands in an element's place is what one sees.
"""

from __future__ import annotations

from functools import cache
from html import escape
from importlib import resources

from flexstage.show.viewer.data import StageData


def element(key: str, *, motion: str = "", instead: str = "") -> str:
    """The place of a viewer of the data called `key`; it begins with a `motion`, "mode 1" or "stroke B1", or at rest.

    `instead` is HTML that is taken as it is: what stands there without a script or without WebGL, and in print.

    >>> element("stage", motion="mode 1", instead="<p>a picture</p>")
    '<div data-flexstage="stage" data-motion="mode 1"><p>a picture</p></div>'
    """
    wanted = f' data-motion="{escape(motion)}"' if motion else ""
    return f'<div data-flexstage="{escape(key)}"{wanted}>{instead}</div>'


def data_script(key: str, data: StageData) -> str:
    """A stage's data, once a page: the viewers called `key` show it.

    No text in it ends the script: every "<" is escaped.
    """
    return f'<script type="application/json" id="{escape(key)}">{data.text().replace("<", chr(92) + "u003c")}</script>'


@cache
def bundle() -> str:
    """The viewer's program as it is shipped, its licence on top."""
    return resources.files("flexstage.show").joinpath("static/viewer.js").read_text(encoding="utf-8")


def bundle_script() -> str:
    """The viewer's program, once a page, behind all elements and data.

    >>> bundle_script().count("</script>")
    1
    """
    return f"<script>{bundle()}</script>"


def fragment(data: StageData, *, key: str = "stage", motion: str = "", instead: str = "") -> str:
    """All that a page with one viewer needs: element, data and program."""
    return element(key, motion=motion, instead=instead) + data_script(key, data) + bundle_script()
