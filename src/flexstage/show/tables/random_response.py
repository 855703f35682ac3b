"""Table of a random response."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.dynamics.random_response import RandomResponse
from flexstage.base.labelled import Matrix
from flexstage.show.display import number
from flexstage.show.table import Table, column_table, first_design


def random_table(found: RandomResponse) -> Table:
    """Tabulate the rms value of every output over the band, and the contribution of each input to the mean square.

    >>> from flexstage.analysis.dynamics.random_response import Spectrum, random_response
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> shaken = random_response(mapped(double_triangle()), ("platform.z",), {"ground.z": Spectrum(1e-18)}, (1.0, 1000.0))
    >>> random_table(shaken).texts()[1]
    ['platform.z', '0.10304', '100 %']
    """
    rms, shares = first_design(found.rms, 1), first_design(found.shares, 2)
    sums = np.sum(shares, axis=1, keepdims=True)
    values = np.column_stack([rms, shares / np.where(sums > 0.0, sums, 1.0)])
    units = tuple((channel.unit, *("%",) * len(found.inputs)) for channel in found.outputs)
    table = Matrix(values, found.responding, ("rms", *(f"from {name}" for name in found.disturbing)), units)
    band = f"From {number(found.band[0], 4)} to {number(found.band[1], 4)} Hz, for uncorrelated inputs. {found.method}."
    return column_table("Random response", table, head="output", notes=[band], provenance=found.provenance)
