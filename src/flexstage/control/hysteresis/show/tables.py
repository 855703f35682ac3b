"""Tables of a stack's test: how well its hysteresis is known, and its plays."""

from __future__ import annotations

import numpy as np

from flexstage.control.hysteresis.stack_test import StackTest
from flexstage.show.display import align_numbers, format_value, number, percent
from flexstage.show.table import Cell, Column, Mark, Table, make_table

_LARGE = 0.02


def stack_table(test: StackTest) -> Table:
    """What a record covers and how well the model follows it; errors as parts of the stroke range.

    >>> from flexstage.control.hysteresis.example import example_test
    >>> stack_table(example_test()).texts()[1]
    ['volts', '0 to 1000 V', 'u']
    """
    found = test.hysteresis
    plays, pieces = found.model.thresholds.shape[1], found.model.before.knots.shape[1] - 1
    rows = [
        ("volts", f"{number(found.range[0])} to {number(found.range[1])} V", test.channels.volts or ""),
        ("stroke", format_value(found.stroke, "m"), test.channels.stroke or ""),
        ("loop width", percent(found.width, 3), "of the stroke, largest distance of the branches"),
        ("branches", str(found.branches), f"{found.inner} of them inner ones"),
        ("model", f"{plays} plays", f"envelope of {pieces} piece{'s' if pieces > 1 else ''}; chosen among {len(found.trials)}"),
        ("error, rms", _error(found.rms), format_value(found.rms * found.stroke, "m", 3)),
        ("error, largest", _error(found.largest, 5.0), format_value(found.largest * found.stroke, "m", 3)),
        ("error, kept parts", _error(found.validation), "rms over parts of the record that were not fitted"),
        ("inverse", _error(test.inverse_rms), "rms of its volts against those applied, of their range"),
        ("drift", percent(found.drift, 3), "of the stroke over the record"),
    ]
    if test.creep is not None:
        span = f"{number(test.creep.span[0], 3)} to {number(test.creep.span[1], 3)} s after the step"
        rows.append(("creep", f"{percent(test.creep.law.rate, 3)} a decade", span))
    strong = [(Cell(name, Mark.STRONG), value, remark) for name, value, remark in rows]
    return make_table("Hysteresis of the stack", ["", "value", ""], strong, provenance=test.source)


def _error(share: float, allowed: float = 1.0) -> Cell:
    return Cell(percent(share, 3), Mark.WARN if share > allowed * _LARGE else Mark.PLAIN)


def plays_table(test: StackTest) -> Table:
    """Thresholds, weights and their sums: the slope of the stroke from rest beyond each threshold.

    >>> from flexstage.control.hysteresis.example import example_test
    >>> plays_table(example_test()).texts()[0]
    ['threshold [V]', 'weight [nm/V]', 'sum of weights [nm/V]']
    """
    plays = test.hysteresis.plays
    columns = (
        align_numbers(plays.thresholds.tolist()),
        align_numbers((1e9 * plays.weights).tolist(), 4),
        align_numbers((1e9 * np.cumsum(plays.weights)).tolist(), 4),
    )
    heads = [Column("threshold", "V"), Column("weight", "nm/V"), Column("sum of weights", "nm/V")]
    return make_table("Plays", heads, list(zip(*columns, strict=True)))
