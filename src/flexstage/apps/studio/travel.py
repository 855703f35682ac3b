"""Paths at large displacements that somebody asks of a design in the studio."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.stroke import stroke
from flexstage.apps.studio.protocol import Travel, Travelled
from flexstage.apps.studio.reading import design, problems_of
from flexstage.base.finding import refuse
from flexstage.base.unit import parse
from flexstage.models.nonlinear.path import path
from flexstage.models.nonlinear.stage import nonlinear
from flexstage.show.command.displaced import loads_of, quantity_of
from flexstage.show.viewer.course import stroke_data

_MOST = 201


def travelled(text: str, file: str, to: int, revision: int, asked: Travel) -> Travelled:
    """A path of the design that a text says, as the viewer plays it."""
    if not 2 <= asked.points <= _MOST:
        raise refuse("points", f"{asked.points} points were asked for", f"Ask for 2 to {_MOST}")
    mechanism = design(text, file)
    model = nonlinear(mechanism)
    quantity = quantity_of(model, asked.drive)
    low, high = (parse(value, quantity, where=where) if value else 0.0 for value, where in ((asked.start, "from"), (asked.end, "to")))
    found = path(model, asked.drive, np.linspace(low, high, asked.points), loads=loads_of(model, asked.loads))
    told = stroke(found)
    shown = stroke_data(mechanism, found, told).document()
    return Travelled(to, revision, shown["motions"], problems_of(told.cautions, text, file))
