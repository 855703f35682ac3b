"""Figures of studies: main effects, and designs as lines over parallel axes."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.present.display import shown
from flexstage.present.figures.style import FULL, INK, MUTED, SERIES, Margins, canvas, panels, styled
from flexstage.studies.study.definition import Study
from flexstage.studies.study.effects import Effects
from flexstage.studies.study.store import Results

_MOST_LINES = 400


def effects_figure(study: Study, found: Effects) -> Any:
    """Mean of each response over each variable, one panel each; all panels of a response have one scale, so that steep means strong.

    >>> effects_figure.__name__
    'effects_figure'
    """
    rows, columns = len(found.responses), len(found.variables)
    with styled():
        figure = canvas(FULL, 0.55 + 1.25 * rows)
        axes = panels(figure, rows, columns, Margins(left=0.75, across=0.3, down=0.12))
        for row, name in enumerate(found.responses):
            form = shown(study.columns[name].quantity.si, float(np.nanmax(np.abs([found.low[row], found.high[row]]))))
            for column, variable in enumerate(study.variables):
                unit = shown(variable.quantity.si, float(np.nanmax(np.abs(found.places[column]))))
                ax = axes[row, column]
                ax.plot(
                    found.places[column] * unit.factor, found.means[column, :, row] * form.factor, color=SERIES[0], marker="o", markersize=2
                )
                ax.set_ylim(*_scale(found.means[:, :, row] * form.factor))
                ax.axhline(found.mean[row] * form.factor, color=MUTED, linewidth=0.6)
                ax.tick_params(labelleft=column == 0)
                if row == rows - 1:
                    ax.set_xlabel(_label(variable.name, unit.unit))
            axes[row, 0].set_ylabel(_label(name, form.unit))
    return figure


def _scale(values: Array) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    room = 0.08 * (high - low) or max(abs(high), 1e-12) * 1e-3
    return low - room, high + room


def _label(name: str, unit: str) -> str:
    return name if unit == "1" else f"{name} [{unit}]"


def designs_figure(results: Results) -> Any:
    """Designs as lines over parallel axes, variables then responses, each from its least to its largest; coloured by the last response.

    >>> names, units = (("t",), ("f",)), (("m",), ("Hz",))
    >>> made = Results(np.arange(2), np.array([[1e-3], [2e-3]]), np.array([[1.0], [3.0]]), {}, names, units, 2, {}, "")
    >>> len(designs_figure(made).axes)
    1
    """
    sound = np.flatnonzero(np.all(np.isfinite(results.responses), axis=1))
    chosen = sound[np.linspace(0, len(sound) - 1, min(len(sound), _MOST_LINES)).astype(int)] if len(sound) else sound
    values = np.hstack([results.variables, results.responses])
    low, high = (operation(values[sound], axis=0) if len(sound) else values[:0].sum(axis=0) for operation in (np.min, np.max))
    span = np.where(high > low, high - low, 1.0)
    heights = (values[chosen] - low) / span
    with styled():
        figure = canvas(FULL, 3.0)
        ax = panels(figure, 1, 1, Margins(left=0.45, right=0.45, bottom=0.55, top=0.3))[0, 0]
        _lines(ax, heights)
        _axes(ax, results, (low, high))
    return figure


def _lines(ax: Any, heights: Array) -> None:
    from matplotlib.collections import LineCollection

    places = np.arange(heights.shape[1])
    segments = [np.column_stack([places, each]) for each in heights]
    lines = LineCollection(segments, cmap="viridis", array=heights[:, -1] if len(heights) else np.zeros(0), linewidth=0.5, alpha=0.6)
    ax.add_collection(lines)


def _axes(ax: Any, results: Results, ends: tuple[Array, Array]) -> None:
    names = sum(results.names, ())
    units = sum(results.units, ())
    ax.set_xlim(-0.2, len(names) - 0.8)
    ax.set_ylim(-0.02, 1.02)
    ax.set_yticks([])
    ax.set_xticks(range(len(names)), ["" for _ in names])
    ax.grid(visible=False)
    for place, (name, unit, low, high) in enumerate(zip(names, units, *ends, strict=True)):
        form = shown(unit, max(abs(low), abs(high)))
        ax.axvline(place, color=INK, linewidth=0.8)
        ax.text(place, -0.05, f"{low * form.factor:.4g}\n{_label(name, form.unit)}", ha="center", va="top", fontsize=7)
        ax.text(place, 1.04, f"{high * form.factor:.4g}", ha="center", va="bottom", fontsize=7)
