"""Tables of sensitivities: which numbers matter most."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.analysis.assessment.sensitivities import Sensitivities
from flexstage.base.number import Array
from flexstage.show.display import format_value, number
from flexstage.show.table import Cell, Column, Mark, Table, make_table


def frequency_sensitivity_table(found: Sensitivities, *, modes: int = 6, top: int = 15) -> Table:
    """The parameters that move the lowest frequencies most: change in per cent per per cent of the parameter.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.sensitivities import sensitivities
    >>> seen = sensitivities(double_triangle(), ("materials.steel.young", "materials.steel.density"))
    >>> frequency_sensitivity_table(seen, modes=1).rows[0][0].text
    'materials.steel.density'
    """
    relative = found.relative_frequency
    values = relative.values[:, :modes]
    heads = [f"{name} ({frequency:.5g} Hz)" for name, frequency in zip(relative.columns[:modes], found.frequencies, strict=False)]
    note = "Relative change of the frequency per relative change of the parameter; for repeated modes that of their mean."
    return _ranking_table("What moves the frequencies", found, values, heads=heads, top=top, note=note)


def loss_sensitivity_table(found: Sensitivities, *, top: int = 15) -> Table | None:
    """The parameters that change the actuators' losses most: loss in per cent of stroke per per cent of the parameter; `None` without any.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.sensitivities import sensitivities
    >>> seen = sensitivities(double_triangle(), ("lever_notch.thickness", "foot_notch.thickness"))
    >>> loss_sensitivity_table(seen).rows[0][0].text
    'lever_notch.thickness'
    """
    if not found.actuators:
        return None
    matrix = found.relative_loss
    note = "Change of the loss (a share of the stroke) per relative change of the parameter."
    return _ranking_table("What changes the lost motion", found, matrix.values, heads=matrix.columns, top=top, note=note)


def _ranking_table(title: str, found: Sensitivities, values: Array, *, heads: Sequence[str], top: int, note: str) -> Table:
    largest = np.max(np.abs(values), axis=1, initial=0.0)
    order = np.argsort(-np.round(largest, 9), kind="stable")[:top]
    rows = [
        (
            Cell(found.parameters[index], Mark.STRONG),
            format_value(float(found.values[index]), found.units[index]),
            *(_cell(float(value), float(largest[index])) for value in values[index]),
        )
        for index in order
        if largest[index] > 0.0
    ]
    rest = len(found.parameters) - len(rows)
    notes = [note, *([f"{rest} further parameters matter less."] if rest > 0 else [])]
    columns = ["parameter", Column("value"), *(Column(head) for head in heads)]
    return make_table(title, columns, rows, notes=notes, provenance=found.provenance)


def _cell(value: float, scale: float) -> Cell:
    if abs(value) < 1e-9 * scale:
        return Cell("0", Mark.FAINT)
    return Cell(f"{'+' if value > 0.0 else ''}{number(value, 3)}", Mark.FAINT if abs(value) < 0.01 * scale else Mark.PLAIN)
