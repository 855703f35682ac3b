"""Figures of studies: main effects, and designs as lines over parallel axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.analysis.assessment.measures import Measure
from flexstage.base.number import Array
from flexstage.base.units.unit import convert
from flexstage.show.display import display_unit_of
from flexstage.show.figures.style import FULL, GRID, INK, MUTED, SERIES, Margins, canvas, panels, style_context
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.effects import Effects
from flexstage.studies.sweeps.execution.store import Results
from flexstage.studies.sweeps.variable import Variable

_MOST_LINES = 400


@dataclass(frozen=True)
class Display:
    """Display form of a variable or a response: in percent of the design's value, or in a unit."""

    unit: str
    factor: float
    offset: float = 0.0

    def of(self, values: Any) -> Any:
        """Convert SI values to display units."""
        return (values - self.offset) * self.factor

    def label(self, name: str) -> str:
        """Return a name with its unit."""
        return name if self.unit == "1" else f"{name} [{self.unit}]"


def display(of: Variable | Measure, values: Array) -> Display:
    """Choose the display form of SI values of a variable or a response. Variables have the units of design files.

    >>> from flexstage.base.units.quantity import LENGTH
    >>> display(Variable("t", ("parts.neck.thickness",), LENGTH, 1e-3, 2e-3), np.array([1e-3])).unit
    'mm'
    """
    if isinstance(of, Measure):
        size = np.abs(values[np.isfinite(values)])
        form = display_unit_of(of.quantity.si, float(size.max(initial=0.0)))
        return Display(form.unit, form.factor)
    if of.relative:
        return Display("%", 100.0, 1.0)
    return Display(of.quantity.shown, float(convert(1.0, of.quantity)))


def effects_figure(study: Study, found: Effects) -> Any:
    """Plot the mean of each response as a function of each variable. Panels of a response have the same scale, to compare slopes."""
    rows, columns = len(found.responses), len(found.variables)
    with style_context():
        figure = canvas(FULL, 0.55 + 1.25 * rows)
        axes = panels(figure, rows, columns, Margins(left=0.75, across=0.3, down=0.12))
        for row, name in enumerate(found.responses):
            answer = display(study.columns[name], np.array([found.low[row], found.high[row]]))
            for column, variable in enumerate(study.variables):
                along, ax = display(variable, found.places[column]), axes[row, column]
                means = answer.of(found.means[column, :, row])
                ax.plot(along.of(found.places[column]), means, color=SERIES[0], marker="o", markersize=2)
                ax.set_ylim(*_scale(answer.of(found.means[:, :, row])))
                ax.axhline(answer.of(found.mean[row]), color=MUTED, linewidth=0.6)
                ax.tick_params(labelleft=column == 0)
                if row == rows - 1:
                    ax.set_xlabel(along.label(variable.name))
            axes[row, 0].set_ylabel(answer.label(name))
    return figure


def _scale(values: Array) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = 0.08 * (high - low) or max(abs(high), 1e-12) * 1e-3
    return low - room, high + room


def designs_figure(study: Study, results: Results) -> Any:
    """Plot designs as lines over parallel axes: the variables, then the responses, each from minimum to maximum.

    Lines are coloured by the first response. Infeasible designs are grey.
    """
    sound = np.flatnonzero(np.all(np.isfinite(results.responses), axis=1))
    chosen = sound[np.linspace(0, len(sound) - 1, min(len(sound), _MOST_LINES)).astype(int)] if len(sound) else sound
    values = np.hstack([results.variables, results.responses])
    low, high = (operation(values[sound], axis=0) if len(sound) else values[:0].sum(axis=0) for operation in (np.min, np.max))
    span = np.where(high > low, high - low, 1.0)
    heights = (values[chosen] - low) / span
    with style_context():
        figure = canvas(FULL, 3.0)
        ax = panels(figure, 1, 1, Margins(left=0.45, right=0.45, bottom=0.55, top=0.3))[0, 0]
        _lines(ax, heights, heights[:, results.variables.shape[1]], study.feasible(results.responses[chosen]))
        _axes(ax, study, low, high)
    return figure


def _lines(ax: Any, heights: Array, shade: Array, kept: Array) -> None:
    from matplotlib.collections import LineCollection

    places = np.arange(heights.shape[1])
    segments = np.stack([np.broadcast_to(places, heights.shape), heights], axis=-1)
    ax.add_collection(LineCollection(list(segments[~kept]), colors=GRID, linewidth=0.5))
    ax.add_collection(LineCollection(list(segments[kept]), cmap="viridis", array=shade[kept], clim=(0.0, 1.0), linewidth=0.5, alpha=0.7))


def _axes(ax: Any, study: Study, lows: Array, highs: Array) -> None:
    named: list[tuple[str, Variable | Measure]] = [*((each.name, each) for each in study.variables), *study.columns.items()]
    names = [name for name, _ in named]
    ax.set_xlim(-0.2, len(names) - 0.8)
    ax.set_ylim(-0.02, 1.02)
    ax.set_yticks([])
    ax.set_xticks(range(len(names)), ["" for _ in names])
    ax.grid(visible=False)
    for place, ((name, each), low, high) in enumerate(zip(named, lows, highs, strict=True)):
        form = display(each, np.array([low, high]))
        ax.axvline(place, color=INK, linewidth=0.8)
        ax.text(place, -0.05, f"{form.of(low):.4g}\n{form.label(name)}", ha="center", va="top", fontsize=7)
        ax.text(place, 1.04, f"{form.of(high):.4g}", ha="center", va="bottom", fontsize=7)
