"""Figures of the distributions of responses in a tolerance study, with their limits."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.analysis.assessment.requirements import Requirement, Sense
from flexstage.base.number import Array
from flexstage.show.display import display_unit_of, number
from flexstage.show.figures.style import FAIL, FULL, INK, SERIES, canvas, style_context
from flexstage.studies.tolerances.run import Toleranced
from flexstage.studies.tolerances.summary import ROUNDING

_ACROSS = 3
_BINS = 40
_FEWEST = 12


def distributions_figure(found: Toleranced) -> Any:
    """Plot a histogram of each response, with the nominal value and the limits. Violations are red."""
    names = list(found.study.measures)
    rows = -(-len(names) // _ACROSS)
    with style_context():
        figure = canvas(FULL, 0.3 + 1.35 * rows)
        axes = separate_panels(figure, rows)
        for ax, name in zip(axes, names, strict=False):
            _distribution(ax, found, name)
        for ax in axes[len(names) :]:
            ax.set_visible(False)
    return figure


def separate_panels(figure: Any, rows: int) -> list[Any]:
    """Add panels in rows of three, each with its own axes.

    >>> len(separate_panels(canvas(7.0, 3.0), 2))
    6
    """
    width, height = figure.get_size_inches()
    grid = figure.subplots(rows, _ACROSS, squeeze=False)
    figure.subplots_adjust(
        left=0.15 / width, right=1.0 - 0.15 / width, bottom=0.42 / height, top=1.0 - 0.18 / height, wspace=0.12, hspace=0.75
    )
    return [ax for row in grid for ax in row]


def _distribution(ax: Any, found: Toleranced, name: str) -> None:
    column = list(found.study.columns).index(name)
    values = found.results.responses[found.results.designs < found.study.copies, column]
    values = values[np.isfinite(values)]
    nominal = float(found.slopes.values[column])
    form = display_unit_of(found.study.measures[name].quantity.si, max(float(np.max(np.abs(values), initial=0.0)), abs(nominal)))
    limits = [line for own, line in found.study.lines if own == name]
    count = int(np.clip(np.sqrt(len(values)), _FEWEST, _BINS))
    low, high = float(np.min(values, initial=nominal)), float(np.max(values, initial=nominal))
    aside = 1e-3 * abs(nominal) or 1.0 if high - low <= ROUNDING * abs(nominal) else 0.0  # equal values have no bins
    drawn = ((low - aside) * form.factor, (high + aside) * form.factor)
    _, edges, bars = ax.hist(values * form.factor, bins=count, range=drawn, color=SERIES[0], linewidth=0.0)
    for left, right, bar in zip(edges[:-1], edges[1:], bars, strict=True):
        if any(_misses(line, 0.5 * (left + right) / form.factor) for line in limits):
            bar.set_facecolor(FAIL)
    ax.axvline(nominal * form.factor, color=INK, linewidth=0.9)
    for line in limits:
        _limit(ax, line.limit * form.factor, edges)
    ax.set_yticks([])
    ax.grid(visible=False)
    ax.spines["left"].set_visible(False)
    ax.set_xlabel(name if form.unit == "1" else f"{name} [{form.unit}]", labelpad=1.0)
    ax.tick_params(labelsize=6.5, pad=1.5)
    ax.locator_params(axis="x", nbins=5)


def _misses(line: Requirement, value: float) -> bool:
    return value < line.limit if line.sense is Sense.AT_LEAST else value > line.limit


def _limit(ax: Any, limit: float, edges: Array) -> None:
    """A limit, or an arrow towards a distant one."""
    low, high = edges[0], edges[-1]
    room = 0.6 * (high - low)
    if low - room <= limit <= high + room:
        ax.axvline(limit, color=FAIL, linewidth=0.9, linestyle=(0, (4, 2)))
        return
    side = 0.0 if limit < low else 1.0
    text = f"\N{LEFTWARDS ARROW} {number(limit, 4)}" if side == 0.0 else f"{number(limit, 4)} \N{RIGHTWARDS ARROW}"
    ax.text(side, 1.0, text, transform=ax.transAxes, ha="left" if side == 0.0 else "right", va="bottom", fontsize=6.5, color=FAIL)
