"""Tables of sensitivities: which numbers of a design move its frequencies and losses."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.present.display import number
from flexstage.present.table import Cell, Column, Mark, Table, build
from flexstage.studies.sensitivities import Sensitivities

_SHOWN = 1e-3
_ROWS, _COLUMNS = 24, 8


def sensitivity_tables(found: Sensitivities) -> tuple[Table, ...]:
    """Relative change of the lowest frequencies, and change of every loss, per relative change of each parameter; the strongest first.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.studies.sensitivities import sensitivities
    >>> table = sensitivity_tables(sensitivities(double_triangle(), ("parts.neck.thickness",), modes=4))[0]
    >>> table.rows[0][0].text
    'parts.neck.thickness'
    """
    clusters = [group for group in found.clusters if len(group) > 1]
    note = [f"Modes {', '.join(str(index + 1) for index in group)} are repeated: theirs is the mean's." for group in clusters]
    frequencies = found.relative_frequency
    shown = min(_COLUMNS, len(frequencies.columns))
    hertz = [f"mode {index + 1}: {number(float(found.frequencies[index]))} Hz" for index in range(shown)]
    return (
        _table("Relative change of frequency per relative change of a value", frequencies, hertz, note),
        _table("Change of loss per relative change of a value", found.relative_loss, list(found.relative_loss.columns), []),
    )


def _table(title: str, matrix: Matrix, heads: list[str], notes: Iterable[str]) -> Table:
    values = matrix.values[:, : len(heads)]
    strength = np.max(np.abs(values), axis=1, initial=0.0)
    order = [int(index) for index in np.argsort(-np.round(strength, 12), kind="stable") if strength[index] >= _SHOWN][:_ROWS]
    weakest = number(float(strength[order[-1]]), 2) if order else f"{_SHOWN:g}"
    rest = len(strength) - len(order)
    said = [f"{rest} further values of {weakest} or less are not listed; --json gives all."] if rest else []
    rows = [(Cell(matrix.rows[index], Mark.STRONG), *_cells(values[index])) for index in order]
    return build(title, ["value", *(Column(head) for head in heads)], rows, notes=[*notes, *said])


def _cells(values: Array) -> list[Cell]:
    faint = 0.1 * _SHOWN
    return [Cell("0", Mark.FAINT) if abs(value) < faint else Cell(number(float(value), 3)) for value in values]
