"""Tables of sensitivities: the most important parameters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.analysis.assessment.sensitivities import Sensitivities
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.show.table import Table, column_table

_MODES, _TOP = 6, 15


def frequency_sensitivity_table(found: Sensitivities) -> Table:
    """Tabulate the 15 parameters with the largest effect on the lowest frequencies: change in per cent for 1 % change of the parameter.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.sensitivities import sensitivities
    >>> seen = sensitivities(double_triangle(), ("materials.steel.young", "materials.steel.density"))
    >>> frequency_sensitivity_table(seen).rows[0][0].text
    'materials.steel.density'
    """
    relative = found.relative_frequency
    values = relative.values[:, :_MODES]
    heads = [f"{name} ({frequency:.5g} Hz)" for name, frequency in zip(relative.columns[:_MODES], found.frequencies, strict=False)]
    note = "Relative change of the frequency (for repeated modes, of their mean frequency) per relative change of the parameter."
    return _ranking_table("Sensitivities of the frequencies", found, values, heads=heads, note=note)


def loss_sensitivity_table(found: Sensitivities) -> Table | None:
    """Tabulate the 15 parameters with the largest effect on losses: change in per cent of the stroke for 1 % change of the parameter.

    Returns `None` without losses.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.sensitivities import sensitivities
    >>> seen = sensitivities(double_triangle(), ("lever_notch.thickness", "foot_notch.thickness"))
    >>> loss_sensitivity_table(seen).rows[0][0].text
    'lever_notch.thickness'
    """
    if not found.actuators:
        return None
    matrix = found.relative_loss
    note = "Change of the loss, as a fraction of the stroke, per relative change of the parameter."
    return _ranking_table("Sensitivities of the lost motion", found, matrix.values, heads=matrix.columns, note=note)


def _ranking_table(title: str, found: Sensitivities, values: Array, *, heads: Sequence[str], note: str) -> Table:
    largest = np.max(np.abs(values), axis=1, initial=0.0)
    order = [place for place in np.argsort(-np.round(largest, 9), kind="stable")[:_TOP] if largest[place] > 0.0]
    names, units = (tuple(each[place] for place in order) for each in (found.parameters, found.units))
    whole = np.column_stack([found.values, values])[order]
    ranked = Matrix(whole, names, ("value", *heads), tuple((unit, *("1",) * len(heads)) for unit in units))
    rest = len(found.parameters) - len(order)
    notes = [note, *([f"{rest} further parameters with smaller effects."] if rest > 0 else [])]
    return column_table(title, ranked, head="parameter", notes=notes, provenance=found.provenance)
