"""Tables of frequency responses: low-frequency gain and highest peak."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.linear.frequency import Response
from flexstage.show.display import format_value, number
from flexstage.show.table import Cell, Column, Mark, Table, make_table

_NOISE = 1e-9


@dataclass(frozen=True, eq=False)
class Curve:
    """One entry of a response over frequency: `values` (f,) complex, output over input, in SI `unit`."""

    output: str
    input: str
    unit: str
    values: Array


def leading_curves(response: Response) -> tuple[Curve, ...]:
    """For each output the input that moves it most at the lowest frequency (first design).

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
    """The largest gain; among those within 2 % of it one that moves the output forward."""
    sizes = np.round(np.abs(gains) / (np.max(np.abs(gains)) or 1.0), 6)
    return int(np.argmax(np.where(sizes > 0.98, 1.0 + (np.real(gains) > 0.0), sizes)))


def response_table(response: Response) -> Table:
    """For each output its leading input: gain at the lowest frequency, highest magnitude and where; 0 for what is but rounding.

    >>> import numpy as np
    >>> from flexstage.models.linear.model import Channel
    >>> seen = Response(np.array([1.0, 2.0]), (Channel("x", "m"),), (Channel("a", "m"),), np.array([[[1.0]], [[5.0]]]), "")
    >>> response_table(seen).texts()[1]
    ['x', 'a', '1', '5', '2', '5']
    """
    curves = leading_curves(response)
    largest = {unit: max(np.max(np.abs(curve.values)) for curve in curves if curve.unit == unit) for unit in {each.unit for each in curves}}
    rows = [(Cell(curve.output, Mark.STRONG), *_numbers(curve, response.frequencies, _NOISE * largest[curve.unit])) for curve in curves]
    heads = ["output", "leading input", Column("low-frequency gain"), Column("highest magnitude"), Column("at", "Hz"), Column("rise")]
    band = f"From {number(float(response.frequencies[0]), 4)} to {number(float(response.frequencies[-1]), 4)} Hz."
    noise = ["0 stands for rounding noise: below 1e-9 of the largest magnitude in its unit."] if any("0" in row for row in rows) else []
    return make_table("Frequency responses", heads, rows, notes=[band, *noise], provenance=response.provenance)


def _numbers(curve: Curve, frequencies: Array, noise: float) -> Iterator[str]:
    """Input, gain, highest magnitude, where and the rise; magnitudes below `noise` are 0."""
    size = np.where(np.abs(curve.values) < noise, 0.0, np.abs(curve.values))
    peak = int(np.argmax(size))
    if size[peak] == 0.0:
        yield from ("-", "0", "0", "-", "-")
        return
    yield curve.input
    yield format_value(float(size[0]), curve.unit, 4) if size[0] > 0.0 else "0"
    yield format_value(float(size[peak]), curve.unit, 4)
    yield number(float(frequencies[peak]), 5)
    yield number(float(size[peak] / size[0]), 4) if size[0] > 0.0 else "-"
