"""What a stage does over its stroke, drawn: a panel a quantity."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.show.display import display_unit_of, to_typography
from flexstage.show.figures.style import FAIL, FULL, SERIES, Margins, canvas, panels, style_context

_ACROSS = 3
_HEIGHT = 1.35


def stroke_figure(columns: tuple[str, ...], units: tuple[str, ...], values: Array, beyond: Array) -> Any:
    """Columns of `values` (p, c) over the first one, as a matplotlib Figure; points that are `beyond` (p,) a limit are shaded.

    >>> len(stroke_figure(("platform.x", "force"), ("m", "N"), np.array([[0.0, 0.0], [1e-3, 2.0]]), np.array([False, True])).axes)
    3
    """
    count = len(columns) - 1
    rows = -(-count // _ACROSS)
    with style_context():
        figure = canvas(FULL, _HEIGHT * rows + 0.3)
        axes = panels(figure, rows, _ACROSS, Margins(left=0.62, across=0.62, down=0.34, bottom=0.42)).ravel()
        along = display_unit_of(units[0], float(np.nanmax(np.abs(values[:, 0]))))
        place = values[:, 0] * along.factor
        for number, each in enumerate(axes):
            if number >= count:
                each.set_visible(False)
                continue
            known = values[:, number + 1]
            form = display_unit_of(units[number + 1], float(np.nanmax(np.abs(known))) if np.isfinite(known).any() else 0.0)
            each.plot(place, known * form.factor, color=SERIES[0])
            for point in np.flatnonzero(beyond):
                each.axvspan(*_around(place, int(point)), color=FAIL, alpha=0.15, linewidth=0.0)
            unit = "" if form.unit == "1" else f" [{to_typography(form.unit)}]"
            each.set_ylabel(f"{columns[number + 1]}{unit}", fontsize=7)
            each.set_xlabel(f"{columns[0]} [{to_typography(along.unit)}]", fontsize=7)
            each.tick_params(labelbottom=True)
    return figure


def _around(place: Array, point: int) -> tuple[float, float]:
    """Half-way to the neighbours."""
    before, after = place[max(point - 1, 0)], place[min(point + 1, len(place) - 1)]
    return 0.5 * float(place[point] + before), 0.5 * float(place[point] + after)
