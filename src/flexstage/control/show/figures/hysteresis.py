"""Figure of stack hysteresis: actual over requested stroke, with and without the inverse model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.control.show.figures.frequency import legend_above
from flexstage.show.display import display_unit_of, to_typography
from flexstage.show.figures.style import FULL, INK, SERIES, Margins, canvas, panels, style_context


def hysteresis_figure(wanted: Array, reached: Mapping[str, Array]) -> Any:
    """Plot named series of strokes `reached` (n,) [m], and their errors, over the requested strokes `wanted` (n,).

    >>> way = 1e-6 * np.sin(np.linspace(0.0, 6.0, 50))
    >>> len(hysteresis_figure(way, {"without inverse": 0.9 * way}).axes)
    2
    """
    largest = np.max(np.abs(wanted), initial=0.0)
    errors = max(np.max(np.abs(each - wanted), initial=0.0) for each in reached.values())
    form, fine, step = display_unit_of("m", largest), display_unit_of("m", errors), max(1, len(wanted) // 1500)
    with style_context():
        figure = canvas(FULL, 2.75)
        grid = panels(figure, 1, 2, Margins(left=0.6, top=0.32, across=0.72))
        span = form.factor * largest * np.array([-1.0, 1.0])
        grid[0, 0].plot(span, span, color=INK, linewidth=0.6, linestyle=":")
        for index, (name, each) in enumerate(reached.items()):
            look = {"color": SERIES[(1, 0, 2)[index % 3]], "linewidth": 1.0, "label": name}
            grid[0, 0].plot(form.factor * wanted[::step], form.factor * each[::step], **look)
            grid[0, 1].plot(form.factor * wanted[::step], fine.factor * (each - wanted)[::step], **look)
        for axes, label in zip(grid[0], (f"stroke [{form.unit}]", f"actual minus requested stroke [{fine.unit}]"), strict=True):
            axes.set(xlabel=to_typography(f"requested stroke [{form.unit}]"), ylabel=to_typography(label))
        legend_above(grid[0, 0], 3)
    return figure
