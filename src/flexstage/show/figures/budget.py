"""Stacked bars: lost motion and strain energy by part and actuator, and the error budget by source and axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from flexstage.analysis.assessment.error_budget import ErrorBudget
from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.show.display import display_unit_of, number, percent, to_typography
from flexstage.show.figures.style import FULL, INK, MUTED, SERIES, Margins, canvas, panels, style_context, text_width
from flexstage.show.table import first_design
from flexstage.show.tables.lost_motion import energy_shares, foreign_links, largest_shares, named_budget

_REST = "rest"
_COLOURED = 6
_REST_COLOUR = "#ccd3da"
_Shares = Mapping[str, Mapping[str, float]]


def loss_figure(lost: LostMotion) -> Any:
    """Plot the lost motion of every actuator as a stacked bar of contributions, as a matplotlib Figure."""
    budgets = {name: named_budget(lost, name) for name in lost.loss.rows}
    totals = [percent(sum(shares.values()), 3) for shares in budgets.values()]
    return _bar_figure([(_percents(budgets), totals, "lost motion [% of the stroke]")])


def energy_figure(lost: LostMotion) -> Any:
    """Plot the strain energy of the parts when one actuator expands and no other load acts, as stacked bars in a matplotlib Figure."""
    totals = first_design(lost.energy.values, 2).sum(axis=0)
    texts = [to_typography(f"{number(1e-6 * float(total), 3)} uJ/um^2") for total in totals]
    return _bar_figure([(_percents(energy_shares(lost)), texts, "fraction of the strain energy [%]")])


def error_figure(budget: ErrorBudget) -> Any:
    """Plot the error budget by source, for translations and rotations, with ideal and with corrected mapping, as a matplotlib Figure."""
    return _bar_figure([_errors(budget, rows, unit) for rows, unit in ((slice(0, 3), "m"), (slice(3, 6), "rad"))])


def _errors(budget: ErrorBudget, rows: slice, unit: str) -> tuple[_Shares, list[str], str]:
    """Errors by axis, command and source, with the sum of each bar and the label of the axis."""
    kinds = {"open loop": budget.ideal} if budget.forced else {"ideal": budget.ideal, "corrected": budget.corrected}
    values = {kind: np.nan_to_num(first_design(matrix.values, 2)[rows]) for kind, matrix in kinds.items()}
    form = display_unit_of(unit, float(max(each.sum(axis=1).max() for each in values.values())))
    shares = {
        f"{axis}, {kind}": dict(zip(budget.ideal.columns, (form.factor * each[place]).tolist(), strict=True))
        for place, axis in enumerate(budget.ideal.rows[rows])
        for kind, each in values.items()
    }
    return shares, [number(sum(each.values()), 3) for each in shares.values()], to_typography(f"largest error [{form.unit}]")


def _percents(shares: _Shares) -> _Shares:
    return {name: {part: 100.0 * share for part, share in each.items()} for name, each in shares.items()}


def _bar_figure(groups: Sequence[tuple[_Shares, Sequence[str], str]]) -> Any:
    """Stacked bars, one panel for each group: bars by name, the text at the end of each, and the label of the axis."""
    parts = _largest_parts({f"{place} {name}": each for place, (shares, _, _) in enumerate(groups) for name, each in shares.items()})
    across = max(1, int(FULL / (text_width(parts, 7.5) + 0.24)))
    with style_context():
        top, left = 0.1 + 0.16 * -(-len(parts) // across), 0.15 + text_width(name for shares, _, _ in groups for name in shares)
        figure = canvas(FULL, 0.5 + top + 0.27 * max(len(shares) for shares, _, _ in groups))
        row = panels(figure, 1, len(groups), Margins(left=left, top=top, across=left))[0]
        for axes, group in zip(row, groups, strict=True):
            _stack_bars(axes, *group, parts)
        if parts:  # massless axial springs have no lost motion
            handles, labels = row[0].get_legend_handles_labels()
            style = {"handlelength": 0.9, "handleheight": 0.9, "columnspacing": 1.4, "borderaxespad": 0.0}
            figure.legend(handles, labels, loc="upper left", ncols=across, **style)
    return figure


def _stack_bars(axes: Any, shares: _Shares, totals: Sequence[str], label: str, parts: Mapping[str, Any]) -> None:
    names, rows = list(shares), np.arange(len(shares))
    left, right = np.zeros(len(shares)), np.zeros(len(shares))
    for part, colour in parts.items():
        widths = np.array([_share(shares[name], part, parts) for name in names])
        axes.barh(rows, widths, 0.62, np.where(widths >= 0.0, right, left), color=colour, label=part)
        right, left = right + np.maximum(widths, 0.0), left + np.minimum(widths, 0.0)
    text = {"textcoords": "offset points", "va": "center", "ha": "left", "fontsize": 7.0, "color": INK}
    for end, row, total in zip(right, rows, totals, strict=True):
        axes.annotate(total, (end, row), xytext=(3.0, 0.0), **text)
    axes.set_yticks(rows, names)
    axes.invert_yaxis()
    axes.set_xlabel(label)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0.0)
    axes.axvline(0.0, color=MUTED, linewidth=0.6)
    low, high = axes.get_xlim()
    axes.set_xlim(low, 1.13 * high if high > 0.0 else 1.0)


def _largest_parts(shares: _Shares) -> dict[str, Any]:
    """The largest parts and links of other units, the sum of the others last, with their colours."""
    largest = largest_shares(shares)
    size = {part: largest[part] for each in shares.values() for part, share in each.items() if share}
    least = 2e-3 * max(size.values(), default=0.0)
    ranked = sorted((part for part in size if size[part] > least), key=lambda part: -round(size[part], 12))
    chosen = [*[part for part in ranked if "/" not in part][:_COLOURED], *sorted(foreign_links(ranked, shares))]
    colours = {part: _tinted(SERIES[place % _COLOURED], 0.4 * (place // _COLOURED)) for place, part in enumerate(chosen)}
    return colours | ({_REST: _REST_COLOUR} if len(size) > len(chosen) else {})


def _share(shares: Mapping[str, float], part: str, parts: Mapping[str, Any]) -> float:
    if part == _REST:
        return sum(value for name, value in shares.items() if name not in parts)
    return shares.get(part, 0.0)


def _tinted(colour: str, white: float) -> tuple[float, ...]:
    from matplotlib.colors import to_rgb

    return tuple(part + min(white, 0.85) * (1.0 - part) for part in to_rgb(colour))
