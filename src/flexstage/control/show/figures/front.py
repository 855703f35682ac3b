"""What controllers trade: rejection against noise, settling and delay margin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.show.figures.style import FULL, SERIES, Margins, canvas, panels, style_context


@dataclass(frozen=True, eq=False)
class FrontLine:
    """A controller by gain (g,), as tuned first: `rejection` [Hz], `noise` [m] (perhaps empty), `settling` and `delay_margin` [s].

    `kept`: no other beats it as it was tuned.
    """

    name: str
    kept: bool
    rejection: Array
    noise: Array
    settling: Array
    delay_margin: Array


def front_figure(lines: Sequence[FrontLine]) -> Any:
    """Each controller as it was tuned, a dot, and a line of what it comes to when it is turned down.

    >>> line = FrontLine("pi", True, np.array([300.0, 30.0]), np.zeros(0), np.array([0.02, 0.1]), np.array([2e-4, 2e-3]))
    >>> len(front_figure([line]).axes)
    2
    """
    told = {
        "noise [nm]": (lambda one: one.noise, 1e9),
        "settling [ms]": (lambda one: one.settling, 1e3),
        "delay margin [ms]": (lambda one: one.delay_margin, 1e3),
    }
    shown = {name: pair for name, pair in told.items() if all(len(pair[0](one)) for one in lines)}
    with style_context():
        figure = canvas(FULL, 2.6)
        grid = panels(figure, 1, len(shown), Margins(left=0.6, top=0.32, across=0.6))[0]
        for axes, (label, (values, factor)) in zip(grid, shown.items(), strict=True):
            for index, one in enumerate(lines):
                colour, y = SERIES[index % len(SERIES)], factor * np.asarray(values(one))
                axes.loglog(one.rejection, y, color=colour, linewidth=1.0, label=one.name)
                axes.plot(one.rejection[:1], y[:1], "o", color=colour, markersize=6.0, markerfacecolor=colour if one.kept else "none")
            axes.set_xlabel("rejects to [Hz]")
            axes.set_ylabel(label)
            _plain(axes)
        figure.legend(*grid[0].get_legend_handles_labels(), loc="upper left", ncols=7, handlelength=1.4, borderaxespad=0.2)
    return figure


def _plain(axes: Any) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        axis.set_major_locator(LogLocator(subs=(1.0,) if high > 300.0 * low else (1.0, 2.0, 5.0), numticks=10))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
