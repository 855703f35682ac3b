"""An interactive view of a stage, in a notebook or as a separate page."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from html import escape
from pathlib import Path

from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.storage.store import write
from flexstage.mechanism.mechanism import Mechanism
from flexstage.show.viewer.data import StageData, stage_data
from flexstage.show.viewer.fragment import fragment

_FIRST = "mode 1"
_STYLE = (
    ":root{color-scheme:light dark}html,body{margin:0;height:100%;background:Canvas;color:CanvasText;font:14px system-ui,sans-serif}"
    "main{box-sizing:border-box;padding:8px;max-width:1500px;margin:auto}h1{font-size:16px;font-weight:600;margin:0 0 8px}"
)


@dataclass(frozen=True, eq=False)
class View(CheckedFields):
    """Interactive view of a stage with its motions. Notebooks show the view; `save` writes it as a self-contained page.

    `motion` is the first motion shown. `height` is the height of the frame in a notebook, in pixels. `picture` (HTML) replaces the view in
    print and without WebGL.
    """

    data: StageData = field(repr=False)
    motion: str = ""
    height: int = 560
    picture: str = field(default="", repr=False)

    @property
    def html(self) -> str:
        """HTML page of the view in one file, which loads no other file. Equal stages give identical pages."""
        name = escape(self.data.name)
        head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>{name}</title>'
        body = f"<main><h1>{name}</h1>{fragment(self.data, motion=self.motion, instead=self.picture)}</main>"
        return f'<!doctype html><html lang="en"><head>{head}<style>{_STYLE}</style></head><body>{body}</body></html>\n'

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page to a file, completely or not at all. Returns the path."""
        return write(path, self.html)

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{escape(self.html)}" width="100%" height="{self.height}" style="border:0"></iframe>'


@check_arguments
def view(mechanism: Mechanism, *, motion: str = _FIRST) -> View:
    """Return an interactive view of a stage with its motions (for a batch, of the first design).

    The view starts with `motion`, e.g. "stroke B1", "axis x" or "deflection own weight". By default, it starts with "mode 1", or with the
    undeformed stage if there are no modes. Modes, unit strokes and deflections are computed with the lumped model, motions of the platform
    with the ideal model. The viewer lists the reasons for missing motions. Small motions are magnified by the displayed factor. Raises
    `DesignError` if the stage cannot be drawn.

    >>> import flexstage as fs
    >>> fs.view(fs.case("parallelogram")).html[:15]
    '<!doctype html>'
    """
    data = stage_data(mechanism)
    names = [f"{each.group.value} {each.name}" for each in data.motions]
    if motion not in (_FIRST, *names):
        raise refuse(motion, "unknown motion", suggest_nearest(motion, names))
    return view_of(mechanism, data, motion)


def view_of(mechanism: Mechanism, data: StageData, motion: str = _FIRST) -> View:
    """Return the view of a stage whose viewer data are known, with the stage's picture."""
    from flexstage.show.notebook import to_html  # loads matplotlib

    return View(data, motion, picture=to_html(mechanism))
