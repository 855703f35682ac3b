"""Noise of a loop by source and frequency."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from flexstage.control.noise import NoiseBudget
from flexstage.control.show.figures.frequency import draw_curves, legend_above, legend_of_lines, plain_ticks
from flexstage.show.display import display_unit_of, format_value, to_typography
from flexstage.show.figures.style import FULL, INK, SERIES, Margins, canvas, panels, style_context, text_width
from flexstage.show.table import short_names

_ROW = 0.24


def noise_share_figure(found: NoiseBudget) -> Any:
    """Plot which fraction of each coordinate's mean square is due to each source, and print the coordinate's rms."""
    squares, coordinates = np.asarray(found.by_kind.values), short_names(found.output_names)
    total = np.sum(squares, axis=1)
    with style_context():
        figure = canvas(FULL, 0.85 + _ROW * len(total))
        right = text_width(["100.0 nrad"]) + 0.15
        axes = panels(figure, 1, 1, Margins(left=text_width(coordinates) + 0.25, right=right, top=0.32))[0, 0]
        rows = np.arange(len(total))[::-1]
        left = np.zeros(len(total))
        for index, source in enumerate(found.by_kind.columns):
            share = 100.0 * squares[:, index] / np.where(total > 0.0, total, 1.0)
            axes.barh(rows, share, left=left, height=0.66, color=SERIES[index % len(SERIES)], label=to_typography(source))
            left = left + share
        for row, name, unit, square in zip(rows, coordinates, found.units, total, strict=True):
            axes.text(-1.5, row, name, ha="right", va="center", fontsize=8.0)
            axes.text(101.5, row, to_typography(format_value(np.sqrt(square), unit, 3)), ha="left", va="center", fontsize=7.5, color=INK)
        axes.set(xlim=(0.0, 100.0), ylim=(-0.6, len(total) - 0.4), yticks=[], xlabel="fraction of the mean square [%]")
        axes.grid(axis="y", visible=False)
        legend_above(axes, 6)
    return figure


def noise_spectrum_figure(found: NoiseBudget) -> Any:
    """Plot the amplitude density of each coordinate, and its rms accumulated from the lowest frequency; each unit has its own panels."""
    units = tuple(dict.fromkeys(found.units))
    with style_context():
        figure = canvas(FULL, 3.5)
        grid = panels(figure, 2, len(units), Margins(left=0.68, top=0.32, across=0.85, down=0.14))
        for column, unit in enumerate(units):
            chosen = [index for index, each in enumerate(found.units) if each == unit]
            _column(grid[:, column], found, chosen, unit)
        legend_of_lines(figure, grid[0])
    return figure


def _column(grid: Any, found: NoiseBudget, chosen: Sequence[int], unit: str) -> None:
    names, density = short_names(found.output_names), np.sum(found.density, axis=2)[:, chosen]
    steps = 0.5 * (density[1:] + density[:-1]) * np.diff(found.frequencies)[:, None]
    summed = np.sqrt(np.concatenate([np.zeros((1, len(chosen))), np.cumsum(steps, axis=0)]))
    form = display_unit_of(unit, np.max(summed, initial=0.0))
    named = {index: names[index] for index in chosen}
    draw_curves(grid[0].loglog, found.frequencies, form.factor * np.maximum(np.sqrt(density), 1e-300), named)
    draw_curves(grid[1].semilogx, found.frequencies, form.factor * summed, named)
    largest = form.factor * np.sqrt(np.max(density, initial=0.0))
    grid[0].set(ylim=(1e-4 * largest, 3.0 * largest), ylabel=to_typography(f"density [{form.unit}/Hz^0.5]"))
    grid[1].set(
        ylim=(0.0, None), xlim=found.frequencies[[0, -1]], xlabel="frequency [Hz]", ylabel=to_typography(f"cumulative rms [{form.unit}]")
    )
    grid[0].tick_params(labelbottom=False)
    plain_ticks(grid[0].xaxis, grid[1].xaxis, grid[0].yaxis)
