"""Interaction plots of the strongest pairs of variables."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.show.figures.style import FULL, SERIES, Margins, canvas, panels, style_context
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.effects import Effects
from flexstage.studies.sweeps.show.figures import display


def strongest_figure(study: Study, found: Effects) -> Any:
    """Plot the strongest interactions: the mean response as a function of one variable, for low, middle and high values of a second one."""
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
