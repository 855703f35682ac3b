"""Figures of interactions: shares of pairs as a map, and how the strongest pairs act."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.show.figures.style import FULL, INK, PAPER, SERIES, Margins, canvas, panels, style_context, text_width
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.effects import Effects
from flexstage.studies.sweeps.show.figures import display

_WIDE = 4
_DARK = 0.5


def pairs_figure(found: Effects) -> Any:
    """Shares of each response's variance: of single variables on the diagonal, of what pairs add to them below it."""
    varying = [number for number in range(len(found.responses)) if np.any(np.isfinite(found.pairs[:, :, number]))]
    count, names = len(varying), found.variables
    columns = min(_WIDE if len(names) <= _WIDE else 2, count)
    rows = -(-count // columns)
    left = 0.25 + text_width(names, 7.0)
    with style_context():
        figure = canvas(FULL, 0.1 + rows * (0.5 + left + 0.26 * len(names)))
        axes = panels(figure, rows, columns, Margins(left=left, right=0.1, bottom=left + 0.1, top=0.3, across=0.25, down=left + 0.4))
        for place, ax in enumerate(axes.flat):
            if place < count:
                _map(ax, names, _shares(found, varying[place]), labelled=place % columns == 0)
                ax.set_title(found.responses[varying[place]])
            else:
                ax.set_axis_off()
    return figure


def _shares(found: Effects, number: int) -> Array:
    """What the map shows (d, d): NaN above the diagonal."""
    pairs = np.where(np.tri(len(found.variables), k=-1, dtype=bool), found.pairs[:, :, number], np.nan)
    np.fill_diagonal(pairs, found.first[:, number])
    return pairs


def _map(ax: Any, names: tuple[str, ...], shares: Array, *, labelled: bool) -> None:
    ax.pcolormesh(np.ma.masked_invalid(np.clip(shares, 0.0, 1.0)), cmap="Blues", vmin=0.0, vmax=1.0, edgecolors=PAPER, linewidth=1.0)
    for row, column in np.argwhere(np.isfinite(shares)):
        share = float(shares[row, column])
        colour = PAPER if share > _DARK else INK
        ax.text(column + 0.5, row + 0.5, f"{100.0 * max(share, 0.0):.0f}", ha="center", va="center", fontsize=6.5, color=colour)
    ax.set_xticks(np.arange(len(names)) + 0.5, names, rotation=90, fontsize=7)
    ax.set_yticks(np.arange(len(names)) + 0.5, names if labelled else [""] * len(names), fontsize=7)
    ax.invert_yaxis()
    ax.grid(visible=False)
    ax.tick_params(length=0)
    for side in ("left", "bottom"):
        ax.spines[side].set_visible(False)


def strongest_figure(study: Study, found: Effects) -> Any:
    """The strongest pairs: the mean response over one variable where the other is low, in the middle, and high."""
    with style_context():
        figure = canvas(FULL, 2.1)
        axes = panels(figure, 1, len(found.strongest), Margins(left=0.6, across=0.62, bottom=0.4, top=0.3))[0]
        for ax, each in zip(axes, found.strongest, strict=True):
            over, by = study.variables[each.over], study.variables[each.by]
            along, beside = display(over, each.places), display(by, each.levels)
            measure = study.columns[found.responses[each.response]]
            answer = display(measure, each.means)
            levels = beside.of(each.levels)
            shown_levels = np.where(np.abs(levels) < 0.01 * np.ptp(levels), 0.0, levels)
            for level, means, colour in zip(shown_levels, answer.of(each.means), SERIES, strict=False):
                ax.plot(along.of(each.places), means, color=colour, marker="o", markersize=2, label=f"{level:.3g}")
            ax.set_xlabel(along.label(over.name))
            ax.set_ylabel(answer.label(found.responses[each.response]))
            ax.legend(title=beside.label(by.name), title_fontsize=6.5, fontsize=6.5, handlelength=1.0)
            ax.set_title(f"{100.0 * each.share:.1f} %")
    return figure
