"""Tables of tests: records, identified modes, shapes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.records.record import Channel, Record, Responses
from flexstage.show.display import number, percent
from flexstage.show.table import Cell, Mark, Table, make_table, matrix_table, result_table


def recorded_table(test: Sequence[Record] | Responses) -> Table:
    """Tabulate the recorded data: every file with its channels, duration and sampling rate.

    >>> from flexstage.experiment.example import one_mode_record
    >>> recorded_table((one_mode_record(),)).texts()[1]
    ['record', 'u [V]', 'y [um]', '64 s at 64 Hz']
    """
    rows = [
        (Cell(each.source or each.name or "record", Mark.STRONG), _channels(each.inputs), _channels(each.outputs), _extent(each))
        for each in ([test] if isinstance(test, Responses) else test)
    ]
    return make_table("Recorded data", ["file", "inputs", "outputs", "extent"], rows)


def _extent(what: Record | Responses) -> str:
    if isinstance(what, Record):
        return f"{number(what.duration)} s at {number(what.rate)} Hz"
    low, high = what.band
    return f"{what.lines} frequencies, {number(low)} to {number(high)} Hz"


def _channels(channels: Sequence[Channel]) -> str:
    """Names, and the unit if common to all."""
    units = {channel.unit for channel in channels}
    names = ", ".join(channel.name if len(units) == 1 or not channel.unit else f"{channel.name} [{channel.unit}]" for channel in channels)
    return f"{names} [{units.pop()}]" if len(units) == 1 and "" not in units else names


def identified_table(found: Identified) -> Table:
    """Tabulate frequencies and damping ratios with 95 % intervals, with notes on close modes, for which only the subspace is known.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> identified_table(identify(one_mode_record())).texts()[0][:4]
    ['mode', 'frequency [Hz]', '95 % interval [Hz]', 'damping ratio']
    """
    table = result_table(found.modes, notes=found.notes, provenance=found.provenance)
    return table or make_table("Modes found", ["mode"], [], notes=found.notes, provenance=found.provenance)


def measured_shape_table(found: Identified) -> Table:
    """Tabulate the shapes, each rotated in phase to be as real as possible, with largest component 1.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> measured_shape_table(identify(one_mode_record())).texts()
    [['', '1'], ['y', '1']]
    """
    units = {channel.unit for channel in found.outputs}
    return matrix_table(
        "Shapes of the modes", found.shape_matrix, notes=["Each row is in the unit of its output."] if len(units) > 1 else []
    )


def data_warning_table(warnings: Sequence[str]) -> Table | None:
    """Tabulate the limits of the data; `None` if there are none.

    >>> data_warning_table([]) is None
    True
    """
    if not warnings:
        return None
    return make_table("Limits of the data", ["warning"], [(Cell(text, Mark.WARN),) for text in warnings])


def motion_explained_text(explained: Array) -> str:
    """Describe the fraction of the measured shapes that ideal stage motion explains.

    >>> motion_explained_text(np.array([0.999, 1.0]))
    'The drawn motion explains at least 99.9 % of every measured shape.'
    """
    if float(np.min(explained)) > 1.0 - 1e-9:
        return "The drawn motion cannot be checked: a check requires more outputs than degrees of freedom."
    return f"The drawn motion explains at least {percent(np.floor(1e3 * float(np.min(explained))) / 1e3)} of every measured shape."
