"""A stage to turn and to play with, in a notebook or as a page of its own."""

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
    """A stage that turns, with its motions: notebooks show it, `save` writes it as a page that stands alone.

    `motion` is the one that it begins with, `height` that of its frame in a notebook, in pixels; `picture` (HTML) is what stands there
    in print and where nothing can turn.
    """

    data: StageData = field(repr=False)
    motion: str = ""
    height: int = 560
    picture: str = field(default="", repr=False)

    @property
    def html(self) -> str:
        """The page: one file, nothing loaded from anywhere, the same bytes for the same stage."""
        name = escape(self.data.name)
        head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>{name}</title>'
        body = f"<main><h1>{name}</h1>{fragment(self.data, motion=self.motion, instead=self.picture)}</main>"
        return f'<!doctype html><html lang="en"><head>{head}<style>{_STYLE}</style></head><body>{body}</body></html>\n'

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page; the file is there whole or not at all."""
        return write(path, self.html)

    def _repr_html_(self) -> str:
        return f'<iframe srcdoc="{escape(self.html)}" width="100%" height="{self.height}" style="border:0"></iframe>'


@check_arguments
def view(mechanism: Mechanism, *, motion: str = _FIRST) -> View:
    """The stage of a description as it turns and moves, of the first design of a batch.

    It begins with `motion`: "stroke B1", "axis x", "deflection own weight", or, at first, "mode 1" (at rest where it has none). Modes,
    unit strokes and deflections are those of the lumped model, motions of the platform those of the ideal one; what the stage has not got
    is left out, and the viewer says why. Motions are small ones, drawn exaggerated: the factor stands beside them. Raises `DesignError`
    where the stage cannot be drawn.

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
    """The view of a stage whose data is known, with the stage's picture."""
    from flexstage.show.notebook import to_html  # loads matplotlib

    return View(data, motion, picture=to_html(mechanism))
