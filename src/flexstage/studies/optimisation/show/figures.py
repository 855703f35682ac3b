"""Figures of optimisations: convergence of searches, variables before and after, Pareto fronts."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.show.display import display_unit_of
from flexstage.show.figures.style import FULL, INK, MUTED, SERIES, Margins, canvas, panels, style_context
from flexstage.studies.optimisation.result import Front, Optimum


def convergence_figure(found: Optimum) -> Any:
    """Plot the objective of accepted designs, one line for each start (open marks are infeasible), and the variables in their ranges.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> from flexstage.studies.optimisation.search.optimum import optimise
    >>> len(convergence_figure(optimise(*leaf_study())).axes)
    2
    """
    with style_context():
        figure = canvas(FULL, 2.9)
        axes = panels(figure, 1, 2, Margins(left=0.65, across=1.1, bottom=0.5, right=0.2))
        _histories(axes[0, 0], found)
        _ranges(axes[0, 1], found)
    return figure


def _histories(ax: Any, found: Optimum) -> None:
    objective = found.definition.objectives[0]
    values = np.concatenate([start.history[:, 0] for start in found.starts])
    form = display_unit_of(objective.measure.quantity.si, float(np.max(np.abs(values), initial=0.0)))
    for index, start in enumerate(found.starts):
        heights, kept = start.history[:, 0] * form.factor, start.history[:, 1] <= 1e-8
        color, places = SERIES[index % len(SERIES)], np.arange(len(heights))
        ax.plot(places, heights, color=color, linewidth=1.0, label="nominal" if index == 0 else f"Sobol {index}")
        ax.plot(places[kept], heights[kept], "o", color=color, markersize=3)
        ax.plot(places[~kept], heights[~kept], "o", markerfacecolor="none", markeredgecolor=color, markersize=3)
    ax.set_xlabel("accepted designs")
    ax.set_ylabel(f"{objective.name} [{form.unit}]")
    ax.legend()


def _ranges(ax: Any, found: Optimum) -> None:
    """Every variable's range as a bar from end to end."""
    names = [each.name for each in found.study.variables]
    final = found.final or found.point
    for row, before in enumerate(found.before.shares):
        ax.plot([0.0, 1.0], [row, row], color=MUTED, linewidth=0.8)
        ax.plot(before, row, "o", markerfacecolor="none", markeredgecolor=INK, markersize=4)
        if final is not None:
            arrow = {"arrowstyle": "-|>", "color": SERIES[0], "shrinkA": 3, "shrinkB": 0}
            ax.annotate("", (final.shares[row], row), (before, row), arrowprops=arrow)
    ax.set_yticks(range(len(names)), names)
    ax.set_ylim(len(names) - 0.5, -0.5)
    ax.set_xlim(-0.04, 1.04)
    ax.set_xticks([0.0, 0.5, 1.0], ["from", "", "to"])
    ax.grid(visible=False)


def front_figure(found: Front) -> Any:
    """Plot both objectives of the designs of a front, and of the nominal design."""
    forms = [
        display_unit_of(each.measure.quantity.si, float(np.max(np.abs([*found.values[:, number], found.before.values[number]]))))
        for number, each in enumerate(found.definition.objectives)
    ]
    with style_context():
        figure = canvas(FULL, 3.0)
        ax = panels(figure, 1, 1, Margins(left=0.7, bottom=0.5))[0, 0]
        across, up = found.values[:, 1] * forms[1].factor, found.values[:, 0] * forms[0].factor
        ax.plot(across, up, "o-", color=SERIES[0], markersize=4, label="front")
        stands = found.before.values[:2] * np.array([forms[0].factor, forms[1].factor])
        ax.plot(stands[1], stands[0], "o", markerfacecolor="none", markeredgecolor=INK, label="nominal")
        for axis, number in ((ax.set_xlabel, 1), (ax.set_ylabel, 0)):
            each = found.definition.objectives[number]
            axis(f"{each.name} [{forms[number].unit}], {each.direction.value}")
        ax.legend()
    return figure
