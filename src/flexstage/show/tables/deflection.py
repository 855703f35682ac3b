"""Table of the deflection under permanent load."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexstage.analysis.linear_statics.deflection import Deflection
from flexstage.show.table import Table, first_design, matrix_table

_NOISE = 1e-9


def deflection_table(deflection: Deflection) -> Table:
    """Tabulate the deflection of a point due to own weight, each payload and each specified force.

    Rounding noise, relative to the largest translation or rotation, is shown as 0.

    >>> from flexstage.analysis.linear_statics.deflection import deflection
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> deflection_table(deflection(double_triangle(), lumped(double_triangle()))).texts()[1]
    ['x [um]', '0']
    """
    values = np.array(first_design(deflection.by_cause.values, 2))
    for block in (values[:3], values[3:]):
        block[np.abs(block) < _NOISE * np.max(np.abs(block), initial=0.0)] = 0.0
    note = "Actuators are fixed. In closed loop, the controller compensates the deflection that the gauges measure."
    return matrix_table(f"Deflection of {deflection.point} under permanent load", replace(deflection.by_cause, values=values), notes=[note])
