"""Tables of frequency responses: low-frequency gain and highest peak."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.models.linear.frequency import Response
from flexstage.show.display import number
from flexstage.show.table import Table, column_table

_NOISE = 1e-9


@dataclass(frozen=True, eq=False)
class Curve:
    """One entry of a frequency response: the complex ratios `values` (f,) of output to input at f frequencies, in the SI unit `unit`."""

    output: str
    input: str
    unit: str
    values: Array


def leading_curves(response: Response) -> tuple[Curve, ...]:
    """Select, for each output, the response to the input with the largest effect at the lowest frequency (first design of a batch).

    >>> import numpy as np
    >>> from flexstage.models.linear.model import Channel
    >>> seen = Response(np.ones(1), (Channel("x", "m"),), (Channel("a", "m"), Channel("b", "m")), np.array([[[1.0, 2.0]]]), "")
    >>> [(curve.output, curve.input) for curve in leading_curves(seen)]
    [('x', 'b')]
    """
    values = response.values.reshape(-1, *response.values.shape[-3:])[0]
    result: list[Curve] = []
    for row, output in enumerate(response.outputs):
        column = _leading_input(values[0, row])
        result.append(Curve(output.name, response.inputs[column].name, response.units[row][column], values[:, row, column]))
    return tuple(result)


def _leading_input(gains: Array) -> int:
    """The largest gain; among those within 2 % of it a positive one."""
    sizes = np.round(np.abs(gains) / (np.max(np.abs(gains)) or 1.0), 6)
    return int(np.argmax(np.where(sizes > 0.98, 1.0 + (np.real(gains) > 0.0), sizes)))


def response_table(response: Response) -> Table:
    """Tabulate low-frequency gain, highest magnitude and its frequency for each output and its leading input (see `leading_curves`).

    Rounding noise is shown as 0.

    >>> import numpy as np
    >>> from flexstage.models.linear.model import Channel
    >>> seen = Response(np.array([1.0, 2.0]), (Channel("x", "m"),), (Channel("a", "m"),), np.array([[[1.0]], [[5.0]]]), "")
    >>> response_table(seen).texts()[1]
    ['x, a', '1', '5', '2', '5']
    """
    curves = leading_curves(response)
    sizes = np.array([np.abs(curve.values) for curve in curves])
    units = np.array([curve.unit for curve in curves])
    largest = np.array([np.max(sizes[units == unit]) for unit in units])
    sizes = np.where(sizes < _NOISE * largest[:, None], 0.0, sizes)
    low, highest = sizes[:, 0], np.max(sizes, axis=1)
    there = np.where(highest > 0.0, response.frequencies[np.argmax(sizes, axis=1)], np.nan)
    rise = np.where(low > 0.0, highest / np.where(low > 0.0, low, 1.0), np.nan)
    found = Matrix(
        np.column_stack([low, highest, there, rise]),
        tuple(f"{curve.output}, {curve.input}" for curve in curves),
        ("low-frequency gain", "highest magnitude", "at frequency", "ratio"),
        tuple((curve.unit, curve.unit, "Hz", "1") for curve in curves),
    )
    band = f"From {number(float(response.frequencies[0]), 4)} to {number(float(response.frequencies[-1]), 4)} Hz."
    noise = ["0: rounding noise, below 1e-9 of the largest magnitude with the same unit."] if not np.all(low) else []
    notes, provenance = [band, *noise], response.provenance
    return column_table("Frequency responses", found, head="output, leading input", notes=notes, provenance=provenance)
