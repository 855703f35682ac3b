"""Frequency responses: magnitude and phase as functions of frequency, with the platform's modes marked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from flexstage.analysis.dynamics.modes import Modes
from flexstage.models.linear.frequency import Response
from flexstage.show.display import preferred_unit, to_typography
from flexstage.show.figures.style import FULL, MUTED, SERIES, Margins, canvas, panels, style_context
from flexstage.show.table import first_design
from flexstage.show.tables.response import Curve, leading_curves

_SHOWN = 6
_DECADES = 1e-4


def response_figure(response: Response, modes: Modes | None = None) -> Any:
    """Plot magnitude and phase (Bode plot) of the first outputs, each for the input with the largest effect, as a matplotlib Figure.

    Curves of the same unit are in one column. The phase follows the convention e^{+j omega t}, and is unwrapped from the lowest frequency.

    >>> import flexstage as fs
    >>> from flexstage.analysis.dynamics.response import response
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> seen = response(fs.mapped(double_triangle()), ["platform"], ["B1", "B2", "B3", "B4", "B5", "B6"])
    >>> len(response_figure(seen).axes)
    4
    """
    groups: dict[str, list[Curve]] = {}
    for curve in leading_curves(response)[:_SHOWN]:
        if np.any(np.abs(curve.values) > 0.0):
            groups.setdefault(curve.unit, []).append(curve)
    with style_context():
        figure = canvas(FULL, 3.7)
        margins = Margins(left=0.6, top=0.45, across=0.7, down=0.15)
        grid = panels(figure, 2, len(groups) or 1, margins, heights=[1.7, 1.0])
        for column, (unit, curves) in enumerate(groups.items()):
            _magnitudes(grid[0, column], curves, response, unit)
            _phases(grid[1, column], curves, response)
            _mode_marks(grid[0, column], modes, response)
        for axes in grid.ravel():
            _plain_ticks(axes.xaxis, (1.0, 2.0, 5.0))
        for axes in grid[0]:
            _plain_ticks(axes.yaxis, (1.0,))
            axes.tick_params(labelbottom=False)
        for axes in grid[1]:
            axes.set_xlabel("frequency [Hz]")
            axes.set_xlim(_start(response, modes), float(response.frequencies[-1]))
        grid[1, 0].set_ylabel("phase [°]")
    return figure


def _magnitudes(axes: Any, curves: Sequence[Curve], response: Response, unit: str) -> None:
    form = preferred_unit(unit)
    largest = 0.0
    for index, curve in enumerate(curves):
        size = form.factor * np.abs(curve.values)
        largest = max(largest, float(size.max()))
        axes.loglog(response.frequencies, size, color=SERIES[index], label=f"{_short(curve.output)} / {curve.input}", linewidth=1.2)
    low, _ = axes.get_ylim()
    axes.set_ylim(max(low, _DECADES * largest), 4.0 * largest)
    axes.set_ylabel(f"magnitude [{to_typography(form.unit)}]" if form.unit != "1" else to_typography("magnitude [um/um]"))
    axes.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=3, handlelength=1.2, columnspacing=1.2, borderaxespad=0.2)


def _phases(axes: Any, curves: Sequence[Curve], response: Response) -> None:
    from matplotlib.ticker import MultipleLocator

    for index, curve in enumerate(curves):
        phase = np.rad2deg(np.unwrap(np.angle(curve.values)))
        turns = 360.0 * np.round(phase[0] / 360.0)
        axes.semilogx(response.frequencies, phase - turns, color=SERIES[index], linewidth=1.0)
    low, high = axes.get_ylim()
    axes.set_ylim(180.0 * np.floor(low / 180.0), 180.0 * np.ceil(high / 180.0))
    axes.yaxis.set_major_locator(MultipleLocator(180.0))


def _mode_marks(axes: Any, modes: Modes | None, response: Response) -> None:
    """Thin lines at the platform's modes, repeated ones once, with their names."""
    if modes is None:
        return
    frequencies = first_design(modes.frequencies, 1)
    low, high = float(response.frequencies[0]), float(response.frequencies[-1])
    marks: dict[str, list[str]] = {}
    for index in modes.platform:
        if low < frequencies[index] < high:
            marks.setdefault(f"{frequencies[index]:.4g}", []).append(modes.names[index])
    for frequency, names in marks.items():
        axes.axvline(float(frequency), color=MUTED, linewidth=0.5, linestyle=":")
        text = ", ".join(dict.fromkeys(names))
        axes.text(
            float(frequency),
            0.985,
            text,
            transform=axes.get_xaxis_transform(),
            rotation=90,
            ha="right",
            va="top",
            fontsize=6.5,
            color=MUTED,
        )


def _plain_ticks(axis: Any, steps: tuple[float, ...]) -> None:
    """Ticks of a logarithmic axis as plain numbers, only at these multiples of powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    axis.set_major_locator(LogLocator(subs=steps, numticks=12))
    axis.set_major_formatter(FuncFormatter(lambda value, _: to_typography(f"{value:.4g}" if 1e-3 <= value < 1e5 else f"{value:.0e}")))
    axis.set_minor_locator(NullLocator())


def _start(response: Response, modes: Modes | None) -> float:
    """The lowest frequency shown: a decade below the first mode; lower responses are constant."""
    low = float(response.frequencies[0])
    return low if modes is None else max(low, 0.12 * float(first_design(modes.frequencies, 1)[0]))


def _short(name: str) -> str:
    return name.removeprefix("platform.")
