"""Comparison figure of model, finite elements and test (Fig. 12 of Shin & Moon)."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np

from flexstage.experiment.comparison import Compared, ComparedMode
from flexstage.show.figures.style import FULL, INK, MUTED, SERIES, Margins, canvas, panels, style_context

_Series: TypeAlias = tuple[str, str, list[float | None]]
_THEORY, _FEA, _EXPERIMENT = SERIES[0], SERIES[2], SERIES[1]


def compare_figure(found: Compared) -> Any:
    """Plot the frequencies of the platform's modes in model, finite elements and test as bars, and the differences below the bars.

    Whiskers are the test's 95 % intervals. The lower panel shows these intervals as bands about zero. Returns a matplotlib Figure.
    """
    series: list[_Series] = [("theory", _THEORY, [row.theory for row in found.modes])]
    if found.fea is not None:
        series.append(("FEA", _FEA, [row.fea for row in found.modes]))
    series.append(("experiment", _EXPERIMENT, [None if row.experiment is None else row.experiment.frequency for row in found.modes]))
    with style_context():
        figure = canvas(FULL, 3.9)
        grid = panels(figure, 2, 1, Margins(left=0.7, top=0.45, bottom=0.55, down=0.18), heights=[1.7, 1.0])
        _bars(grid[0, 0], series, found.modes)
        _differences(grid[1, 0], found)
        names = [f"{row.number}\n{row.name}" for row in found.modes]
        grid[1, 0].set_xticks(range(len(names)), names)
        grid[0, 0].tick_params(labelbottom=False)
        grid[1, 0].set_xlabel("mode of the platform")
        for axes in grid.ravel():
            axes.grid(visible=False, axis="x")
    return figure


def _bars(axes: Any, series: list[_Series], rows: tuple[ComparedMode, ...]) -> None:
    width = 0.78 / len(series)
    for number, (name, colour, values) in enumerate(series):
        places = np.arange(len(values)) + width * (number - 0.5 * (len(series) - 1))
        known = [index for index, value in enumerate(values) if value is not None]
        heights = [value for value in values if value is not None]
        seen = [row.experiment.frequency_interval for row in rows if row.experiment is not None] if name == "experiment" else []
        whiskers = np.abs(np.array(seen).T - np.array(heights)) if seen else None
        look = {"color": colour, "label": name, "error_kw": {"ecolor": INK, "elinewidth": 0.8, "capsize": 1.5}}
        bars = axes.bar(places[known], heights, 0.92 * width, yerr=whiskers, **look)
        axes.bar_label(bars, fmt="%.1f", padding=1.5, fontsize=5.5, color=INK)
    axes.set_ylabel("frequency [Hz]")
    axes.margins(y=0.12)
    axes.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=3, handlelength=1.2, borderaxespad=0.2)


def _differences(axes: Any, found: Compared) -> None:
    """Draw the differences as points, the test's intervals as bands, repeated modes connected below."""
    axes.axhline(0.0, color=MUTED, linewidth=0.6)
    seen = [index for index, row in enumerate(found.modes) if row.experiment is not None]
    width = [100.0 * (found.modes[index].uncertainty or 0.0) for index in seen]
    axes.bar(seen, [2.0 * each for each in width], 0.7, bottom=[-each for each in width], color=_EXPERIMENT, alpha=0.35)
    for name, colour, marker in (("difference", _THEORY, "o"), ("fea_difference", _FEA, "s")):
        points = [(index, 100.0 * value) for index in seen if (value := getattr(found.modes[index], name)) is not None]
        if points:
            axes.plot(*zip(*points, strict=True), marker, color=colour, markersize=4.0, linestyle="none")
    largest = max((abs(line) for each in axes.lines for line in np.ravel(each.get_ydata()).astype(float)), default=0.0)
    reach = 1.25 * max(largest, *width, 0.05) if width else 1.0
    axes.set_ylim(-reach, reach)
    axes.set_xlim(-0.6, len(found.modes) - 0.4)
    axes.set_ylabel("difference [%]")
