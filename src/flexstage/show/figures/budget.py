"""Stacked bars: the lost-motion budget and the energy by part and actuator, the error budget by source and axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from flexstage.analysis.assessment.error_budget import ErrorBudget
from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.base.number import Array
from flexstage.show.display import display_unit_of, number, percent, to_typography
from flexstage.show.figures.style import FULL, INK, MUTED, SERIES, Margins, canvas, panels, style_context, text_width
from flexstage.show.table import first_design
from flexstage.show.tables.lost_motion import energy_shares, foreign_links, named_budget

_REST = "rest"
_COLOURED = 6
_LEGEND = {"handlelength": 0.9, "handleheight": 0.9, "columnspacing": 1.4, "borderaxespad": 0.0}
_REST_COLOUR = "#ccd3da"
_TINTS = (0.4, 0.66, 0.53, 0.79)
"""How much white is in the colours of another unit's links, one after the other."""


def loss_figure(lost: LostMotion) -> Any:
    """Every actuator's lost motion divided among the links and axes of its unit and links of others, as a Figure [% of stroke].

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> len(loss_figure(fs.lost_motion(fs.ideal(stage), fs.lumped(stage))).axes)
    1
    """
    budgets = {name: named_budget(lost, name) for name in lost.loss.rows}
    totals = {name: percent(sum(shares.values()), 3) for name, shares in budgets.items()}
    return _share_figure(budgets, totals, "lost motion [% of the stroke]")


def energy_figure(lost: LostMotion) -> Any:
    """Where the stroke goes: strain energy by part of the unit when one actuator expands, as a matplotlib Figure.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> len(energy_figure(fs.lost_motion(fs.ideal(stage), fs.lumped(stage))).axes)
    1
    """
    totals = first_design(lost.energy.values, 2).sum(axis=0)
    texts = {
        name: to_typography(f"{number(1e-6 * float(total), 3)} uJ/um^2") for name, total in zip(lost.energy.columns, totals, strict=True)
    }
    return _share_figure(energy_shares(lost), texts, "share of the strain energy [%]")


def _share_figure(shares: Mapping[str, Mapping[str, float]], totals: Mapping[str, str], label: str) -> Any:
    parts = _largest_parts(shares)
    colours = _colours(parts)
    across = max(1, int(FULL / (text_width(parts, 7.5) + 0.24)))
    with style_context():
        top = 0.1 + 0.16 * -(-len(parts) // across)
        figure = canvas(FULL, 0.5 + top + 0.27 * len(shares))
        axes = panels(figure, 1, 1, Margins(left=0.15 + text_width(shares), top=top))[0, 0]
        left, right = np.zeros(len(shares)), np.zeros(len(shares))
        names, rows = list(shares), np.arange(len(shares))
        for part in parts:
            widths = 100.0 * np.array([_share(shares[name], part, parts) for name in names])
            starts = np.where(widths >= 0.0, right, left)
            axes.barh(rows, widths, 0.62, starts, color=colours[part], label=part)
            right, left = right + np.maximum(widths, 0.0), left + np.minimum(widths, 0.0)
        for row, name in enumerate(names):
            _place_beside(axes, (right[row], row), totals[name], INK)
        axes.set_yticks(rows, names)
        _format_axes(axes, label)
        _widen_right(axes, 1.13)
        if parts:  # massless axial springs lose nothing: there is nothing to name
            figure.legend(loc="upper left", ncols=across, **_LEGEND)
    return figure


def _largest_parts(shares: Mapping[str, Mapping[str, float]]) -> list[str]:
    """The parts that get a colour, largest first: the unit's own, then those of others that the tables name; then the rest."""
    parts = dict.fromkeys(part for each in shares.values() for part in each)
    size = {part: max(abs(each.get(part, 0.0)) for each in shares.values()) for part in parts}
    least = 2e-3 * max(size.values(), default=0.0)
    ranked = sorted((part for part in parts if size[part] > least), key=lambda part: -round(size[part], 12))
    chosen = [*[part for part in ranked if "/" not in part][:_COLOURED], *sorted(foreign_links(ranked, shares))]
    return [*chosen, *([_REST] if len(parts) > len(chosen) else [])]


def _share(shares: Mapping[str, float], part: str, parts: Sequence[str]) -> float:
    if part == _REST:
        return sum(value for name, value in shares.items() if name not in parts)
    return shares.get(part, 0.0)


def _colours(parts: Sequence[str]) -> dict[str, str]:
    """Full colours for the unit's own links; for those of others a hue a unit, lighter link by link."""
    own = [part for part in parts if "/" not in part and part != _REST]
    units = list(dict.fromkeys(part.partition("/")[0] for part in parts if "/" in part))
    links = {unit: [part for part in parts if part.startswith(f"{unit}/")] for unit in units}
    return {
        **{part: SERIES[index % len(SERIES)] for index, part in enumerate(own)},
        **{
            part: _tinted(SERIES[index % len(SERIES)], _TINTS[place % len(_TINTS)])
            for index, unit in enumerate(units)
            for place, part in enumerate(links[unit])
        },
        _REST: _REST_COLOUR,
    }


def _tinted(colour: str, white: float) -> str:
    """A colour mixed with so much white."""
    from matplotlib.colors import to_hex, to_rgb

    red, green, blue = (part + white * (1.0 - part) for part in to_rgb(colour))
    return to_hex((red, green, blue))


def _format_axes(axes: Any, label: str) -> None:
    axes.invert_yaxis()
    axes.set_xlabel(label)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0.0)
    axes.axvline(0.0, color=MUTED, linewidth=0.6)


def _widen_right(axes: Any, factor: float) -> None:
    low, high = axes.get_xlim()
    axes.set_xlim(low, high * factor if high > 0.0 else 1.0)


def error_figure(budget: ErrorBudget) -> Any:
    """The error budget by axis and source, ideal and corrected command, linear sums, as a matplotlib Figure.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.budget import budget
    >>> len(error_figure(budget(double_triangle(), {"z": 1e-5})).axes)
    2
    """
    with style_context():
        figure = canvas(FULL, 2.5)
        row = panels(figure, 1, 2, Margins(left=0.25, top=0.28, across=0.45))[0]
        for axes, rows, unit in zip(row, (slice(0, 3), slice(3, 6)), ("m", "rad"), strict=True):
            _error_panel(axes, budget, rows, unit)
        handles, labels = row[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="upper left", ncols=6, **_LEGEND)
    return figure


def _error_panel(axes: Any, budget: ErrorBudget, rows: slice, unit: str) -> None:
    """Two bars an axis: ideal mapping above, corrected command below."""
    pairs = [np.nan_to_num(first_design(matrix.values, 2)[rows]) for matrix in (budget.ideal, budget.corrected)]
    form = display_unit_of(unit, float(max(values.sum(axis=1).max() for values in pairs)))
    places = np.arange(3)
    for offset, values, name in zip((-0.19, 0.19), pairs, ("ideal", "corrected"), strict=True):
        start = np.zeros(3)
        for index, source in enumerate(budget.ideal.columns):
            widths = form.factor * values[:, index]
            label = source if name == "ideal" else ""
            axes.barh(places + offset, widths, 0.32, start, color=SERIES[index % len(SERIES)], label=label)
            start = start + widths
        _bar_texts(axes, places + offset, start, name)
    axes.set_yticks(places, budget.ideal.rows[rows])
    _format_axes(axes, to_typography(f"largest error [{form.unit}]"))
    _widen_right(axes, 1.3)


def _bar_texts(axes: Any, places: Array, ends: Array, name: str) -> None:
    for place, end in zip(places, ends, strict=True):
        _place_beside(axes, (end, place), f"{number(float(end), 3)} {name}", MUTED)


def _place_beside(axes: Any, point: tuple[float, float], text: str, colour: str) -> None:
    axes.annotate(text, point, xytext=(3.0, 0.0), textcoords="offset points", va="center", ha="left", fontsize=7.0, color=colour)
