"""Load paths at large displacements in the studio."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexstage.analysis.loaded.course import DrivePath, course
from flexstage.analysis.loaded.stroke import stroke
from flexstage.apps.studio.design.reading import design, problems_of
from flexstage.apps.studio.protocol import Travel, Travelled, Underway
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.units.unit import parse
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.show.command.displaced import loads_of, quantity_of
from flexstage.show.viewer.animation import stroke_data

_MOST = 201
_FOUND = 0.1
"""Fraction of the work for the equilibria; the remainder is for results at each."""


def travelled(text: str, file: str, request: Travel, tell: Callable[[Underway], None]) -> Travelled:
    """Compute a load path of a design for the viewer, relative to the static equilibrium. `tell` receives its progress."""
    mechanism = design(text, file)
    model = nonlinear(mechanism)
    wanted = _stated(mechanism, request.path) if request.path else _own(model, request)
    count = len(wanted.values)
    rest = wanted.rest(model)
    found = wanted.path(model, rest)

    def done(points: int) -> None:
        tell(Underway(request.id, _FOUND + (1.0 - _FOUND) * points / count, f"{points} of {count} points"))

    done(0)
    told = stroke(found, rest, kinematics=ideal(mechanism) if wanted.drive in model.assembly.strokes else None)
    done(count)
    shown = stroke_data(mechanism, found, told).document()
    return Travelled(shown["motions"], problems_of(told.warnings, text, file))


def _stated(mechanism: Mechanism, name: str) -> DrivePath:
    if name not in mechanism.paths:
        raise refuse(f"paths.{name}", "unknown path", suggest_nearest(name, mechanism.paths))
    return course(mechanism, name)


def _own(model: Nonlinear, request: Travel) -> DrivePath:
    """A path defined by the page."""
    if not 2 <= request.points <= _MOST:
        raise refuse("points", f"number of points must be 2 to {_MOST} (got {request.points})", "Change the number")
    quantity = quantity_of(model, request.drive)
    low, high = (parse(value, quantity, where=where) if value else 0.0 for value, where in ((request.start, "from"), (request.end, "to")))
    return DrivePath(request.drive, np.linspace(low, high, request.points), loads_of(model, request.loads), (), 1.0)
