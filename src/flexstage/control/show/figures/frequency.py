"""Frequency-domain figures of loops: open loops, sensitivities, poles."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.control.robustness.measured_margins import ReadLines
from flexstage.control.systems.curves import Curves
from flexstage.show.figures.reading import Spot
from flexstage.show.figures.style import FULL, INK, MUTED, PAPER, SERIES, Margins, canvas, panels, style_context

_POINTS = 260
_TURN = 360.0
_FLOOR, _CEILING = 1e-4, 1e3
_LEAST = 1e-300
_NEAR = 4.0
"""Largest loop gain of a Nyquist plot."""


def open_loop_figure(found: Curves, marks: Array, spots: Sequence[Spot] = ()) -> Any:
    """Plot each open loop, with the other loops closed, as a Bode plot with modes (`marks`) and margins (`spots`).

    Lines mark the magnitude 1 and the phase -180 degrees.
    """
    with style_context():
        figure = canvas(FULL, 3.9)
        grid = panels(figure, 2, 1, Margins(left=0.68, top=0.32, down=0.12), heights=[1.6, 1.0])
        (upper, lower), loops = grid[:, 0], found.loops
        named = dict(enumerate(found.names))
        draw_curves(upper.loglog, found.frequencies, np.maximum(np.abs(loops), _LEAST), named)
        draw_curves(lower.semilogx, found.frequencies, _phase(loops), named)
        upper.axhline(1.0, color=INK, linewidth=0.7)
        lower.axhline(-180.0, color=INK, linewidth=0.7)
        finite = np.abs(loops)[np.isfinite(loops)]
        upper.set_ylim(max(_FLOOR, 0.3 * np.min(finite, initial=1.0)), min(_CEILING, 3.0 * np.max(finite, initial=1.0)))
        for mark in marks[(marks > found.frequencies[0]) & (marks < found.frequencies[-1])]:
            upper.axvline(mark, color=MUTED, linewidth=0.5, linestyle=":")
        places = np.array([(each.x, each.y) for each in spots if each.y is not None]).reshape(-1, 2)
        upper.plot(*places.T, "o", color=INK, markersize=3.0, markerfacecolor=PAPER, markeredgewidth=0.7, zorder=5)
        upper.set_ylabel("open loop L")
        upper.tick_params(labelbottom=False)
        _phase_ticks(lower)
        plain_ticks(lower.xaxis, upper.yaxis)
        lower.set(xlabel="frequency [Hz]", ylabel="phase [°]", xlim=_span(found.frequencies, loops))
        legend_above(upper)
    return figure


def nyquist_figure(found: Curves, highest: float, points: Array) -> Any:
    """Plot open loops near -1 (Nyquist plot), the unit circle, the circle of the `highest` permitted abs(S), and the margin `points` (m,).

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.systems.closed import LoopBreak
    >>> from flexstage.control.systems.curves import curves
    >>> len(nyquist_figure(curves(integral_loop(), LoopBreak.POSE), 2.0, np.array([-0.5 + 0.0j])).axes)
    1
    """
    turn = np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
    with style_context():
        figure = canvas(FULL, 3.6)
        axes = panels(figure, 1, 1, Margins(left=0.62, top=0.32))[0, 0]
        for circle, drawn in ((turn, {"color": MUTED, "linestyle": ":"}), (turn / highest - 1.0, {"color": SERIES[3], "linestyle": "--"})):
            axes.plot(np.real(circle), np.imag(circle), linewidth=0.8, **drawn)
        for index, name in enumerate(found.names):
            near = np.where(np.abs(found.loops[:, index]) < _NEAR, found.loops[:, index], np.nan)
            axes.plot(np.real(near), np.imag(near), linewidth=1.1, label=name, **look(index))
        axes.plot(-1.0, 0.0, "+", color=INK, markersize=7.0)
        axes.plot(np.real(points), np.imag(points), "o", color=INK, markersize=3.0, markerfacecolor=PAPER, markeredgewidth=0.7, zorder=5)
        axes.set_aspect("equal", adjustable="box")
        axes.set(xlim=(-2.6, 1.4), ylim=(-1.5, 1.5), xlabel="Re L", ylabel="Im L")
        legend_above(axes)
    return figure


def sensitivity_figure(found: Curves, highest: float) -> Any:
    """Plot the sensitivity |S| and complementary sensitivity |T| of each loop, with the `highest` permitted peak of S."""
    own = np.diagonal(found.sensitivity, axis1=1, axis2=2)
    with style_context():
        figure = canvas(FULL, 2.5)
        grid = panels(figure, 1, 2, Margins(left=0.62, top=0.42, across=0.68))
        for axes, values, title in ((grid[0, 0], own, "sensitivity |S|"), (grid[0, 1], 1.0 - own, "complementary sensitivity |T|")):
            draw_curves(axes.loglog, found.frequencies, np.maximum(np.abs(values), _LEAST), dict(enumerate(found.names)))
            axes.axhline(1.0, color=INK, linewidth=0.7)
            axes.set(xlabel="frequency [Hz]", ylabel=title, xlim=_span(found.frequencies, values), ylim=(1e-3, 10.0))
            plain_ticks(axes.xaxis, axes.yaxis)
        grid[0, 0].axhline(highest, color=SERIES[3], linewidth=0.8, linestyle="--")
        left = _span(found.frequencies, own)[0] * 1.15
        grid[0, 0].text(left, highest * 1.1, f"{highest:.3g}", color=SERIES[3], fontsize=6.5)
        legend_above(grid[0, 0])
    return figure


def measured_figure(found: ReadLines, names: tuple[str, ...]) -> Any:
    """Plot |S| of every loop: from measured responses with the 95 % interval, from the identified model, and from the design model."""
    columns = min(3, len(names))
    rows = -(-len(names) // columns)
    with style_context():
        figure = canvas(FULL, 0.55 + 1.55 * rows)
        grid = panels(figure, rows, columns, Margins(left=0.55, top=0.34, across=0.42, down=0.36))
        for index, axes in enumerate(grid.ravel()):
            if index >= len(names):
                axes.set_visible(False)
                continue
            _measured_panel(axes, found, index)
            axes.set_title(names[index], loc="right")
            axes.set(xlabel="frequency [Hz]" if index + columns >= len(names) else "", ylabel="|S|" if index % columns == 0 else "")
        legend_of_lines(figure, grid[:1, 0])
    return figure


def _measured_panel(axes: Any, found: ReadLines, index: int) -> None:
    x = found.frequencies
    if found.low is not None and found.high is not None:
        axes.fill_between(x, found.low[:, index], found.high[:, index], color=SERIES[0], alpha=0.3, linewidth=0.0)
    axes.loglog(*thin_out(x, found.measured[:, index]), color=SERIES[0], linewidth=1.3, label="measured, 95 %")
    axes.loglog(*thin_out(x, found.fitted[:, index]), color=INK, linewidth=0.7, label="fitted")
    axes.loglog(*thin_out(x, found.predicted[:, index]), color=SERIES[1], linewidth=0.9, linestyle="--", label="model")
    axes.axhline(1.0, color=MUTED, linewidth=0.5)
    axes.set_xlim(x[[0, -1]])
    plain_ticks(axes.xaxis, axes.yaxis)


def pole_figure(poles: Array, step: float, alone: Array | None = None) -> Any:
    """Plot closed-loop `poles` (n,) in the z plane; plot damping ratios over frequency for `poles` and for open-loop poles `alone`.

    >>> len(pole_figure(np.array([0.9 + 0.1j, 0.9 - 0.1j]), 1e-4).axes)
    2
    """
    with style_context():
        figure = canvas(FULL, 2.95)
        grid = panels(figure, 1, 2, Margins(left=0.55, top=0.3, across=0.75))
        plane, damped = grid[0, 0], grid[0, 1]
        _circles(plane)
        outside = np.abs(poles) >= 1.0
        inner, outer = poles[~outside], poles[outside]
        plane.plot(np.real(inner), np.imag(inner), "x", color=SERIES[0], markersize=3.5, markeredgewidth=0.8)
        plane.plot(np.real(outer), np.imag(outer), "x", color=SERIES[3], markersize=5.5, markeredgewidth=1.3)
        plane.set_aspect("equal", adjustable="box")
        plane.set(xlim=(-1.08, 1.08), ylim=(-1.08, 1.08), xlabel="Re z", ylabel="Im z", title="z plane")
        _damping_panel(damped, poles, step, alone)
    return figure


def _damping_panel(axes: Any, poles: Array, step: float, alone: Array | None) -> None:
    """Plot damping ratio over frequency."""
    if alone is not None:
        look = {"color": MUTED, "markersize": 3.5, "markerfacecolor": "none", "markeredgewidth": 0.6}
        axes.plot(*_damping(alone, step), "o", label="stage in open loop", **look)
    frequencies, ratios = _damping(poles, step)
    axes.plot(frequencies, ratios, "x", color=SERIES[0], markersize=4.0, markeredgewidth=0.9, label="closed loop", linestyle="none")
    least = min(0.3 * np.min(ratios[ratios > 0.0], initial=1.0), 0.5)
    axes.set(xscale="log", yscale="log", ylim=(least, 130.0), xlabel="frequency [Hz]", ylabel="damping ratio [%]")
    plain_ticks(axes.xaxis, axes.yaxis)
    legend_above(axes, 2)


def thin_out(x: Array, y: Array) -> tuple[Array, Array]:
    """Reduce the points (n,) of a curve to the minima and maxima in a fixed number of intervals."""
    if len(x) <= 2 * _POINTS:
        return x, y
    stretches = np.array_split(np.arange(len(x)), _POINTS)
    places = np.unique([0, len(x) - 1, *(part[pick(y[part])] for part in stretches for pick in (np.argmin, np.argmax))])
    return x[places], y[places]


def draw_curves(plot: Callable[..., Any], x: Array, values: Array, named: Mapping[int, str]) -> None:
    """Draw the columns of values (n, k) over x (n,) by a function of a panel; `named` are the names of the series by number."""
    for column, (index, name) in zip(values.T, named.items(), strict=True):
        plot(*thin_out(x, column), linewidth=1.1, label=name, **look(index))


def _phase(values: Array) -> Array:
    """Phases (f, n) unwrapped from the lowest frequency [deg], starting between -270 and 90."""
    angle = np.rad2deg(np.unwrap(np.angle(values), axis=0))
    return angle - _TURN * np.ceil((angle[0] - 90.0) / _TURN)


def look(index: int) -> dict[str, Any]:
    """Return the line style of series number `index`: its colour, and dashes for every second series."""
    return {"color": SERIES[index % (len(SERIES) - 1)], "linestyle": (0, (4.0, 2.0)) if index % 2 else "-"}


def _span(frequencies: Array, values: Array) -> tuple[float, float]:
    """Frequency range from a loop gain of about a hundred to the end."""
    high = np.flatnonzero(np.max(np.abs(values), axis=1) > _CEILING)
    first = min(high[-1], len(values) - 2) if 0 < len(high) < len(values) else 0
    return max(frequencies[first], 1e-5 * frequencies[-1]), frequencies[-1]


def _phase_ticks(axes: Any) -> None:
    low, high = axes.get_ylim()
    low, high = max(low, -4.0 * _TURN), min(high, _TURN)
    axes.set_ylim(low, high)
    step = 90.0 if high - low < 600.0 else 180.0 if high - low < 1100.0 else 360.0
    axes.set_yticks(np.arange(step * np.ceil(low / step), high + 1.0, step))


def plain_ticks(*axes: Any, steps: tuple[float, ...] = (1.0,)) -> None:
    """Set ticks of logarithmic axes at the multiples `steps` of powers of ten, as plain numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    for axis in axes:
        axis.set_major_locator(LogLocator(subs=steps, numticks=12))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(NullLocator())


def legend_of_lines(figure: Any, panels: Iterable[Any], columns: int = 8) -> None:
    """Add one legend above all panels, for all lines with a label."""
    handles = [line for axes in panels for line in axes.get_lines() if not line.get_label().startswith("_")]
    figure.legend(handles, [line.get_label() for line in handles], loc="upper left", ncols=columns, handlelength=1.4, borderaxespad=0.2)


def legend_above(axes: Any, columns: int = 8) -> None:
    """Add a legend above a panel."""
    axes.legend(loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=columns, handlelength=1.6, columnspacing=1.1, borderaxespad=0.2)


def _circles(axes: Any) -> None:
    angle = np.linspace(0.0, np.pi, 181)
    for sign in (1.0, -1.0):
        axes.plot(np.cos(angle), sign * np.sin(angle), color=INK, linewidth=0.8)
        for ratio in (0.1, 0.3, 0.6):
            size = np.exp(-ratio / np.sqrt(1.0 - ratio**2) * angle)
            axes.plot(size * np.cos(angle), sign * size * np.sin(angle), color=MUTED, linewidth=0.5, linestyle=":")


def _damping(poles: Array, step: float) -> tuple[Array, Array]:
    """Frequency [Hz] and damping ratio [%] of the poles of the upper half plane, without registers at 0."""
    poles = poles[(np.abs(poles) > 1e-6) & (np.imag(poles) >= 0.0)]
    rates = np.log(poles.astype(complex)) / step
    size = np.abs(rates)
    kept = size > 0.0
    return size[kept] / (2.0 * np.pi), 100.0 * np.maximum(-rates.real[kept] / size[kept], 0.0)
