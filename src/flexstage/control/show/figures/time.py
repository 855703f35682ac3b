"""Time-domain figures of loops: steps, errors, plan views of paths with magnified error."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.control.show.figures.frequency import legend_above, legend_of_lines, plain_ticks, thin_out
from flexstage.control.simulation.result import Simulated
from flexstage.control.systems.system import names_of
from flexstage.show.display import display_unit_of, to_typography
from flexstage.show.figures.style import FULL, HALF, INK, MUTED, SERIES, Margins, canvas, panels, style_context

_ACROSS = 3
_OF_SIZE = 0.05
_BAND, _SHOWN = 0.02, 2.5
_FEW = 1.5
"""Decades; axes with fewer also have ticks between powers of ten."""


def step_figure(found: Sequence[tuple[str, Simulated]]) -> Any:
    """Plot step responses, one panel per coordinate: reference, true motion and, in grey, other coordinates of the same unit.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> from flexstage.control.simulation.run import simulate
    >>> example = integral_loop()
    >>> len(step_figure([("x", simulate(machine(example.plant, example.controller), np.full((200, 1), 1e-6)))]).axes)
    1
    """
    columns = min(_ACROSS, len(found))
    rows = -(-len(found) // columns)
    with style_context():
        width = FULL if columns > 1 else HALF
        figure = canvas(width, 0.55 + 1.65 * rows)
        grid = panels(figure, rows, columns, Margins(left=0.52, top=0.28, across=0.62, down=0.42))
        for axes, (name, test) in zip(grid.ravel(), found, strict=False):
            _step(axes, name, test)
        for axes in grid.ravel()[len(found) :]:
            axes.set_visible(False)
        for axes in grid.ravel():
            axes.tick_params(labelbottom=True)
            axes.set_xlim(0.0, 1e3 * max(_settling_band(test, name) for name, test in found))
        for axes in grid[-1]:
            axes.set_xlabel("time [ms]")
    return figure


def _step(axes: Any, name: str, test: Simulated) -> None:
    index = names_of(test.coordinates).index(name)
    unit = test.coordinates[index].unit
    form = display_unit_of(unit, np.max(np.abs(test.reference[:, index])))
    time = 1e3 * test.times
    true = form.factor * (test.reference - test.true_error)
    for other, channel in enumerate(test.coordinates):
        if other != index and channel.unit == unit:
            axes.plot(*thin_out(time, true[:, other]), color=MUTED, linewidth=0.6, alpha=0.7)
    axes.plot(time, form.factor * test.reference[:, index], color=INK, linewidth=0.7, linestyle="--", label="reference")
    axes.plot(*thin_out(time, true[:, index]), color=SERIES[0], linewidth=1.2, label="true")
    axes.set_title(to_typography(f"{name} [{form.unit}]"), fontsize=7.5, loc="left")
    axes.tick_params(labelsize=6.5)


def _settling_band(test: Simulated, name: str) -> float:
    """End time [s] of a step plot: a multiple of the 2 % settling time."""
    index = names_of(test.coordinates).index(name)
    outside = np.flatnonzero(np.abs(test.true_error[:, index]) > _BAND * np.max(np.abs(test.reference[:, index])))
    return float(min(_SHOWN * test.times[outside[-1]], test.times[-1]) if len(outside) else test.times[-1])


def error_figure(test: Simulated) -> Any:
    """Plot the true errors over time, in one panel for lengths and one for angles.

    >>> from flexstage.control.example import integral_loop
    >>> from flexstage.control.simulation.machine import machine
    >>> from flexstage.control.simulation.run import simulate
    >>> example = integral_loop()
    >>> len(error_figure(simulate(machine(example.plant, example.controller), np.full((200, 1), 1e-6))).axes)
    1
    """
    units = list(dict.fromkeys(channel.unit for channel in test.coordinates))
    scaled, noun = _clock(test.times)
    with style_context():
        figure = canvas(FULL, 0.65 + 1.25 * len(units))
        grid = panels(figure, len(units), 1, Margins(left=0.62, top=0.3, down=0.14))
        count = 0
        for axes, unit in zip(grid[:, 0], units, strict=True):
            chosen = [index for index, channel in enumerate(test.coordinates) if channel.unit == unit]
            error = test.true_error[:, chosen]
            form = display_unit_of(unit, np.max(np.abs(error), initial=0.0))
            for index, column in zip(chosen, error.T, strict=True):
                axes.plot(scaled, form.factor * column, color=SERIES[count % 7], linewidth=0.9, label=test.coordinates[index].name)
                count += 1
            axes.set(ylabel=to_typography(f"error [{form.unit}]"), xlim=scaled[[0, -1]])
        legend_of_lines(figure, grid[:, 0])
        grid[-1, 0].set_xlabel(noun)
    return figure


def lesson_figure(rms: Array, names: Sequence[str], units: Sequence[str], noun: str, floor: Array | None = None) -> Any:
    """Plot the rms errors (n, f) of f coordinates in n passes or periods; dotted lines are the non-repeating errors `floor` (f,).

    One panel is for lengths, one for angles.

    >>> len(lesson_figure(np.array([[1e-6], [1e-7]]), ["x"], ["m"], "pass").axes)
    1
    """
    kinds = list(dict.fromkeys(units))
    with style_context():
        figure = canvas(FULL * 0.62, 0.65 + 1.5 * len(kinds))
        grid = panels(figure, len(kinds), 1, Margins(left=0.62, top=0.3, down=0.14))
        for axes, unit in zip(grid[:, 0], kinds, strict=True):
            chosen = [index for index, each in enumerate(units) if each == unit]
            form = display_unit_of(unit, np.max(rms[:, chosen]))
            for index in chosen:
                axes.semilogy(range(len(rms)), form.factor * rms[:, index], color=SERIES[index % 7], linewidth=1.0, label=names[index])
                if floor is not None:
                    axes.axhline(form.factor * floor[index], color=SERIES[index % 7], linewidth=0.7, linestyle=":")
            axes.set(ylabel=to_typography(f"rms error [{form.unit}]"), xlim=(0.0, len(rms) - 1.0))
            axes.xaxis.get_major_locator().set_params(integer=True)
            plain_ticks(axes.yaxis, steps=(1.0, 2.0, 5.0) if np.ptp(np.log10(rms[:, chosen])) < _FEW else (1.0,))
        legend_of_lines(figure, grid[:, 0], 6)
        grid[-1, 0].set_xlabel(noun)
    return figure


def path_figure(test: Simulated, axes_shown: tuple[str, str]) -> Any:
    """Plot a plan view of the reference, and of the motion with magnified error; the legend contains the magnification.

    >>> from flexstage.show.figures.style import canvas
    """
    places = [names_of(test.coordinates).index(name) for name in axes_shown]
    asked, error = test.reference[:, places], test.true_error[:, places]
    size = np.max(np.ptp(asked, axis=0), initial=0.0)
    factor = magnification(size, error)
    forms = [display_unit_of(test.coordinates[place].unit, size) for place in places]
    factors = np.array([form.factor for form in forms])
    followed = asked - factor * error
    label = "motion" if factor == 1.0 else f"motion, error magnified {factor:g} times"
    with style_context():
        figure = canvas(FULL * 0.62, _height(followed))
        plan = panels(figure, 1, 1, Margins(left=0.6, top=0.32))[0, 0]
        plan.plot(*(factors * asked).T, color=MUTED, linewidth=0.9, label="reference")
        plan.plot(*(factors * followed).T, color=SERIES[0], linewidth=0.9, label=label)
        plan.set_aspect("equal", adjustable="datalim")
        x, y = (to_typography(f"{name} [{form.unit}]") for name, form in zip(axes_shown, forms, strict=True))
        plan.set(xlabel=x, ylabel=y)
        legend_above(plan, 2)
    return figure


def _height(path: Array) -> float:
    """Height of a figure with a path to scale."""
    across, up = np.ptp(path, axis=0)
    return float(np.clip(0.85 + (0.62 * FULL - 0.7) * up / max(across, 1e-12), 2.0, 5.2))


def magnification(size: float, error: Array) -> float:
    """Choose a magnification (1, 2 or 5 times a power of ten, at least 1) that shows the largest error as about 1/20 of `size`.

    >>> magnification(1.0, np.array([[0.001, 0.0]]))
    50.0
    """
    largest = np.max(np.linalg.norm(error, axis=1), initial=0.0)
    if largest == 0.0 or size == 0.0:
        return 1.0
    wanted = max(_OF_SIZE * size / largest, 1.0)
    steps = np.array([1.0, 2.0, 5.0]) * 10.0 ** np.floor(np.log10(wanted))
    return float(np.max(steps[steps <= wanted]))


def _clock(times: Array) -> tuple[Array, str]:
    return (1e3 * times, "time [ms]") if times[-1] < 1.0 else (times, "time [s]")
