"""Figure of a stack's test: loops with the model, the model error, and the voltage of the inverse model over the applied voltage."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexstage.control.hysteresis.stack_test import StackTest
from flexstage.control.show.figures.frequency import legend_above
from flexstage.show.display import display_unit_of, to_typography
from flexstage.show.figures.style import FULL, INK, SERIES, Margins, canvas, panels, style_context

_DATA, _MODEL, _UNDONE = "#9aa5b1", SERIES[0], SERIES[2]


def stack_figure(test: StackTest) -> Any:
    """Plot stroke (record and model), model error [% of stroke] and the inverse model's voltage, each against the applied voltage.

    >>> from flexstage.control.hysteresis.example import example_test
    >>> len(stack_figure(example_test()).axes)
    3
    """
    found = test.hysteresis
    form = display_unit_of("m", np.max(np.abs(found.strokes)))
    rows = test.valid_samples
    with style_context():
        figure = canvas(FULL, 2.6)
        axes = panels(figure, 1, 3, Margins(left=0.52, top=0.32, across=0.62))[0]
        axes[0].plot(found.volts[rows], form.factor * found.strokes[rows], color=_DATA, linewidth=2.0, label="record")
        axes[0].plot(found.volts[rows], form.factor * found.modelled[rows], color=_MODEL, linewidth=0.8, label="model")
        axes[1].plot(found.volts[rows], 100.0 * (found.modelled - found.strokes)[rows] / found.stroke, color=_MODEL, linewidth=0.8)
        axes[2].plot(found.range, found.range, color=INK, linewidth=0.6, linestyle=":")
        axes[2].plot(found.volts[rows], test.inverse_volts[rows], color=_UNDONE, linewidth=0.8, label="inverse of the record")
        labels = (f"stroke [{form.unit}]", "error [% of stroke]", "inverse model [V]")
        for panel, label in zip(axes, labels, strict=True):
            panel.set_xlabel("applied voltage [V]")
            panel.set_ylabel(to_typography(label), labelpad=1.0)
        for panel in (axes[0], axes[2]):
            legend_above(panel, 2)
    return figure
