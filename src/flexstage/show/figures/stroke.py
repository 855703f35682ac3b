"""Results over a stroke: a panel for each quantity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.show.figures.style import FAIL, FULL, SERIES, Margins, canvas, panels, style_context
from flexstage.show.viewer.motions import Curve

_ACROSS = 3
_HEIGHT = 1.45
_LEAST_SPAN = 1e-3
"""Smallest range of an axis relative to the largest value: smaller changes are drawn as a nearly straight line."""


def stroke_figure(curves: Sequence[Curve], beyond: Array) -> Any:
    """Plot curves as functions of the first curve, in panels of a matplotlib Figure. Points over a limit (`beyond` (p,)) are shaded.

    >>> curves = (Curve("platform.x", "mm", np.array([0.0, 1.0])), Curve("force", "N", np.array([0.0, 2.0])))
    >>> len(stroke_figure(curves, np.array([False, True])).axes)
    3
    """
    from matplotlib.ticker import MaxNLocator

    along, shown = curves[0], curves[1:]
    rows = -(-len(shown) // _ACROSS)
    with style_context():
        figure = canvas(FULL, _HEIGHT * rows + 0.3)
        axes = panels(figure, rows, _ACROSS, Margins(left=0.62, across=0.75, down=0.46, bottom=0.42)).ravel()
        for each in axes[len(shown) :]:
            each.set_visible(False)
        for each, curve in zip(axes, shown, strict=False):
            each.plot(along.values, curve.values, color=SERIES[0])
            for point in np.flatnonzero(beyond):
                each.axvspan(*_around(along.values, int(point)), color=FAIL, alpha=0.15, linewidth=0.0)
            each.set_ylabel(_title(curve), fontsize=7)
            each.set_xlabel(_title(along), fontsize=7)
            each.tick_params(labelbottom=True)
            each.xaxis.set_major_locator(MaxNLocator(4))
            each.yaxis.set_major_locator(MaxNLocator(4))
            each.yaxis.get_major_formatter().set_useOffset(False)
            each.set_ylim(*_span(each.get_ylim()))
    return figure


def _title(curve: Curve) -> str:
    return f"{curve.name} [{curve.unit}]" if curve.unit else curve.name


def _span(limits: tuple[float, float]) -> tuple[float, float]:
    """Limits of an axis, wide enough for short tick labels."""
    middle, half = 0.5 * (limits[0] + limits[1]), 0.5 * max(limits[1] - limits[0], _LEAST_SPAN * max(map(abs, limits)))
    return middle - half, middle + half


def _around(place: Array, point: int) -> tuple[float, float]:
    """The interval up to half-way to the neighbours."""
    before, after = place[max(point - 1, 0)], place[min(point + 1, len(place) - 1)]
    return 0.5 * float(place[point] + before), 0.5 * float(place[point] + after)
