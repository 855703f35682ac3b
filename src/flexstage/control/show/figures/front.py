"""Trade-offs between controllers: sensitivity crossover, noise, settling and delay margin."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np

from flexstage.control.show.figures.frequency import legend_of_lines, plain_ticks
from flexstage.control.study.compare import DetunedController
from flexstage.show.figures.style import FULL, SERIES, Margins, canvas, panels, style_context


def front_figure(found: Mapping[str, DetunedController], front: Collection[str]) -> Any:
    """Plot each tuned controller as a dot (filled on the Pareto `front`), with a line for the same controller at reduced gains."""
    told = {"noise [nm]": ("noise", 1e9), "settling [ms]": ("settling", 1e3), "delay margin [ms]": ("delay_margin", 1e3)}
    shown = {label: pair for label, pair in told.items() if all(len(getattr(one, pair[0])) for one in found.values())}
    with style_context():
        figure = canvas(FULL, 2.6)
        grid = panels(figure, 1, len(shown), Margins(left=0.6, top=0.32, across=0.6))[0]
        for axes, (label, (quantity, factor)) in zip(grid, shown.items(), strict=True):
            for index, (name, one) in enumerate(found.items()):
                colour, y = SERIES[index % len(SERIES)], factor * np.asarray(getattr(one, quantity))
                axes.loglog(one.rejection, y, color=colour, linewidth=1.0, label=name)
                axes.plot(one.rejection[:1], y[:1], "o", color=colour, markersize=6.0, markerfacecolor=colour if name in front else "none")
            axes.set(xlabel="sensitivity crossover [Hz]", ylabel=label)
            for axis in (axes.xaxis, axes.yaxis):
                low, high = axis.get_view_interval()
                plain_ticks(axis, steps=(1.0,) if high > 300.0 * low else (1.0, 2.0, 5.0))
        legend_of_lines(figure, grid[:1], 7)
    return figure
