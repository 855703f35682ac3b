"""Noise of a loop: whose it is, and at which frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.control.show.figures.frequency import thin_out
from flexstage.show.display import display_unit_of, format_value, to_typography
from flexstage.show.figures.style import FULL, INK, SERIES, Margins, canvas, panels, style_context, text_width

_ROW = 0.24


@dataclass(frozen=True, eq=False)
class Shares:
    """Mean squares (f, k) of coordinates by source, in the coordinates' squared units (f,)."""

    coordinates: tuple[str, ...]
    units: tuple[str, ...]
    sources: tuple[str, ...]
    squares: Array


@dataclass(frozen=True, eq=False)
class Densities:
    """One-sided densities (n, f) [unit^2/Hz] of coordinates over `frequencies` (n,) [Hz]."""

    coordinates: tuple[str, ...]
    units: tuple[str, ...]
    frequencies: Array
    density: Array


def noise_share_figure(found: Shares) -> Any:
    """The share of every source in the mean square of each coordinate, and its rms beside.

    >>> shares = Shares(("x",), ("m",), ("gauges", "floor"), np.array([[4e-18, 1e-18]]))
    >>> len(noise_share_figure(shares).axes)
    1
    """
    total = np.sum(found.squares, axis=1)
    with style_context():
        figure = canvas(FULL, 0.85 + _ROW * len(total))
        right = text_width(["100.0 nrad"]) + 0.15
        axes = panels(figure, 1, 1, Margins(left=text_width(found.coordinates) + 0.25, right=right, top=0.32))[0, 0]
        rows = np.arange(len(total))[::-1]
        left = np.zeros(len(total))
        for index, source in enumerate(found.sources):
            share = 100.0 * found.squares[:, index] / np.where(total > 0.0, total, 1.0)
            axes.barh(rows, share, left=left, height=0.66, color=SERIES[index % len(SERIES)], label=to_typography(source))
            left = left + share
        for row, name, unit, square in zip(rows, found.coordinates, found.units, total, strict=True):
            axes.text(-1.5, row, name, ha="right", va="center", fontsize=8.0)
            axes.text(
                101.5, row, to_typography(format_value(float(np.sqrt(square)), unit, 3)), ha="left", va="center", fontsize=7.5, color=INK
            )
        axes.set_xlim(0.0, 100.0)
        axes.set_ylim(-0.6, len(total) - 0.4)
        axes.set_yticks([])
        axes.grid(axis="y", visible=False)
        axes.set_xlabel("share of the mean square [%]")
        axes.legend(loc="lower left", bbox_to_anchor=(-0.01, 1.0), ncols=6, borderaxespad=0.1, handlelength=1.0, columnspacing=1.2)
    return figure


def noise_spectrum_figure(found: Densities) -> Any:
    """Amplitude densities above, rms summed up from the lowest frequency below; lengths left, angles right.

    >>> lines = np.geomspace(1.0, 1000.0, 40)
    >>> len(noise_spectrum_figure(Densities(("x",), ("m",), lines, 1e-20 / lines[:, None])).axes)
    2
    """
    units = tuple(dict.fromkeys(found.units))
    with style_context():
        figure = canvas(FULL, 3.5)
        grid = panels(figure, 2, len(units), Margins(left=0.68, top=0.32, across=0.85, down=0.14))
        for column, unit in enumerate(units):
            chosen = [index for index, each in enumerate(found.units) if each == unit]
            _column(grid[:, column], found, chosen, unit)
        handles = [line for axes in grid[0] for line in axes.get_lines()]
        figure.legend(handles, [line.get_label() for line in handles], loc="upper left", ncols=8, handlelength=1.4, borderaxespad=0.2)
    return figure


def _column(grid: Any, found: Densities, chosen: Sequence[int], unit: str) -> None:
    density = found.density[:, chosen]
    steps = 0.5 * (density[1:] + density[:-1]) * np.diff(found.frequencies)[:, None]
    summed = np.sqrt(np.concatenate([np.zeros((1, len(chosen))), np.cumsum(steps, axis=0)]))
    form = display_unit_of(unit, float(np.max(summed, initial=0.0)))
    for index, column, total in zip(chosen, density.T, summed.T, strict=True):
        x, y = thin_out(found.frequencies, np.sqrt(column))
        look = {"color": SERIES[index % 7], "linewidth": 1.0, "linestyle": (0, (4.0, 2.0)) if index % 2 else "-"}
        grid[0].loglog(x, form.factor * np.maximum(y, 1e-300), label=found.coordinates[index], **look)
        x, y = thin_out(found.frequencies, total)
        grid[1].semilogx(x, form.factor * y, **look)
    largest = form.factor * float(np.sqrt(np.max(density, initial=0.0)))
    grid[0].set_ylim(1e-4 * largest, 3.0 * largest)
    grid[0].set_ylabel(to_typography(f"density [{form.unit}/Hz^0.5]"))
    grid[1].set_ylabel(to_typography(f"rms summed up [{form.unit}]"))
    grid[1].set_ylim(0.0, None)
    grid[1].set_xlabel("frequency [Hz]")
    grid[1].set_xlim(float(found.frequencies[0]), float(found.frequencies[-1]))
    grid[0].tick_params(labelbottom=False)
    _plain(grid)


def _plain(grid: Any) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    for axis in (grid[0].xaxis, grid[1].xaxis, grid[0].yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0,), numticks=10))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(NullLocator())
