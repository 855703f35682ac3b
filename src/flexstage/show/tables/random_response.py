"""Table of a random response."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.dynamics.random_response import RandomResponse
from flexstage.show.display import format_value, number, percent
from flexstage.show.table import Cell, Column, Mark, Table, first_design, make_table

_SILENT = 1e-9


def random_table(found: RandomResponse) -> Table:
    """Rms value of every output over the band, and the share of its mean square that comes from each input.

    >>> from flexstage.analysis.dynamics.random_response import Spectrum, random_response
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> shaken = random_response(mapped(double_triangle()), ("platform.z",), {"ground.z": Spectrum(1e-18)}, (1.0, 1000.0))
    >>> random_table(shaken).texts()[1]
    ['platform.z', '0.103 um', '100 %']
    """
    rms, shares = first_design(found.rms, 1), first_design(found.shares, 2)
    heads = ["output", Column("rms"), *(Column(f"from {channel.name}") for channel in found.inputs)]
    rows = [
        (
            Cell(channel.name, Mark.STRONG),
            Cell(format_value(float(value), channel.unit, 4)),
            *(_share(float(share)) for share in row / (np.sum(row) or 1.0)),
        )
        for channel, value, row in zip(found.outputs, rms, shares, strict=True)
    ]
    band = f"From {number(found.band[0], 4)} to {number(found.band[1], 4)} Hz; inputs uncorrelated. {found.method}."
    return make_table("Random response", heads, rows, notes=[band], provenance=found.provenance)


def _share(share: float) -> Cell:
    return Cell(percent(share, 3)) if share >= _SILENT else Cell("0", Mark.FAINT)
