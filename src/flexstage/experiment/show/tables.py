"""Tables of tests: what was recorded, the modes found in it, their shapes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.identification.confidence import NORMAL_95
from flexstage.experiment.identification.diagnosis.peaks import Peak
from flexstage.experiment.identification.identified import Identified
from flexstage.experiment.records.record import Channel, Record, Responses
from flexstage.show.display import NO_VALUE, align_numbers, number, percent
from flexstage.show.table import Cell, Column, Mark, Table, make_table

_COMPLEX = 0.1
_WEAK = 3.0
_SILENT = 5e-4
WIDENED = "Widened: how many times wider intervals are than noise makes them, because the fit leaves more than noise near the mode."


def recorded_table(test: Sequence[Record] | Responses) -> Table:
    """What was measured: every file with its channels, and how long and how fast it was sampled.

    >>> from flexstage.experiment.example import one_mode_record
    >>> recorded_table((one_mode_record(),)).texts()[1]
    ['record', 'u [V]', 'y [um]', '64 s at 64 Hz']
    """
    if isinstance(test, Responses):
        low, high = float(test.frequencies[0]), float(test.frequencies[-1])
        extent = f"{len(test.frequencies)} lines, {number(low)} to {number(high)} Hz"
        rows = [(_source(test), _channels(test.inputs), _channels(test.outputs), extent)]
    else:
        rows = [
            (_source(each), _channels(each.inputs), _channels(each.outputs), f"{number(each.duration)} s at {number(each.rate)} Hz")
            for each in test
        ]
    return make_table("What was measured", ["file", "inputs", "outputs", "extent"], rows)


def _source(what: Record | Responses) -> Cell:
    return Cell(what.source or what.name or "record", Mark.STRONG)


def _channels(channels: Sequence[Channel]) -> str:
    """Names, and the unit where it is the same for all."""
    units = {channel.unit for channel in channels}
    names = ", ".join(channel.name if len(units) == 1 or not channel.unit else f"{channel.name} [{channel.unit}]" for channel in channels)
    return f"{names} [{units.pop()}]" if len(units) == 1 and "" not in units else names


def identified_table(found: Identified) -> Table:
    """Frequencies and damping ratios with their 95 % intervals, and which modes lie so close that only their subspace can be told.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> identified_table(identify(one_mode_record())).texts()[0]
    ['mode', 'frequency [Hz]', '95 % interval [Hz]', 'damping [%]', '95 % interval [%]', 'widened', 'complexity', 'close to', 'evidence']
    """
    partners = {index: [other + 1 for other in group if other != index] for group in found.close for index in group}
    frequencies = interval_texts(found.frequencies, found.frequency_intervals)
    damping = interval_texts(100.0 * found.damping, 100.0 * found.damping_intervals)
    rows = [
        (
            Cell(str(index + 1), Mark.STRONG),
            *frequencies[index],
            *damping[index],
            widening_cell(float(found.widening[index])),
            Cell(number(float(complexity), 2), Mark.WARN if complexity > _COMPLEX else Mark.PLAIN),
            ", ".join(map(str, partners.get(index, []))) or NO_VALUE,
            Cell(number(float(strength), 3), Mark.WARN if strength < _WEAK else Mark.PLAIN),
        )
        for index, (complexity, strength) in enumerate(zip(found.complexity, found.significance, strict=True))
    ]
    heads = [
        "mode",
        *(Column("frequency", "Hz"), Column("95 % interval", "Hz"), Column("damping", "%"), Column("95 % interval", "%")),
        *(Column("widened"), Column("complexity"), Column("close to"), Column("evidence")),
    ]
    notes = [
        WIDENED,
        "Complexity: 0 where all outputs move in phase or opposite, 1 for a travelling wave.",
        "Close: nearer than the half-widths of the peaks; of such modes the subspace is known better than each shape.",
        "Evidence: chi-square by which the data ask for the mode, over what noise would reach once in 1e9 tries.",
        f"Looked for between {number(found.band[0], 4)} and {number(found.band[1], 4)} Hz.",
    ]
    if found.delay:
        late, spread = 1e3 * found.delay, 1e3 * NORMAL_95 * found.delay_deviation
        notes.append(f"All outputs come {number(late, 4)} ms late (95 %: +-{number(spread, 2)} ms): taken out before modes were fitted.")
    if not rows:
        notes = [f"No mode was found between {number(found.band[0], 4)} and {number(found.band[1], 4)} Hz."]
    return make_table("Modes found", heads, rows, notes=notes, provenance=found.provenance)


def widening_cell(factor: float) -> Cell:
    """By how much a mode's intervals are wider than those of noise.

    >>> widening_cell(1.0).text, widening_cell(4.71).text
    ('1', '4.7')
    """
    return Cell(number(factor, 2), Mark.WARN if factor > 1.0 else Mark.PLAIN)


def interval_texts(values: Array, intervals: Array) -> list[tuple[str, str]]:
    """Values with as many decimals as their intervals ask for, and those intervals.

    >>> interval_texts(np.array([118.01234]), np.array([[118.0101, 118.0145]]))
    [('118.0123', '118.0101 to 118.0145')]
    """
    found: list[tuple[str, str]] = []
    for value, (low, high) in zip(values, intervals, strict=True):
        width = float(high - low)
        decimals = 4 if not (np.isfinite(width) and width > 0.0) else int(np.clip(1 - np.floor(np.log10(width)), 0, 6))
        interval = f"{low:.{decimals}f} to {high:.{decimals}f}" if np.isfinite(width) else NO_VALUE
        found.append((f"{value:.{decimals}f}", interval))
    return found


def measured_shape_table(found: Identified) -> Table:
    """The shapes, each turned to be as real as it can be, over their largest component.

    >>> from flexstage.experiment.example import one_mode_record
    >>> from flexstage.experiment.identification.identify import identify
    >>> measured_shape_table(identify(one_mode_record())).texts()
    [['output', '1'], ['y', '1']]
    """
    shapes = found.real_shapes
    shown = [align_numbers(np.where(np.abs(column) < _SILENT, 0.0, column), 4) for column in shapes.T]
    rows = [
        (Cell(channel.name, Mark.STRONG), *(Cell(column[row], Mark.FAINT if column[row] == "0" else Mark.PLAIN) for column in shown))
        for row, channel in enumerate(found.outputs)
    ]
    units = {channel.unit for channel in found.outputs}
    notes = ["Rows in different units, as recorded."] if len(units) > 1 else []
    heads = ["output", *(Column(str(index + 1)) for index in range(shapes.shape[1]))]
    return make_table("Shapes of the modes", heads, rows, notes=notes)


def peak_table(peaks: Sequence[Peak]) -> Table | None:
    """Peaks that are seen and are no modes, with the reason; `None` where there are none.

    >>> from flexstage.experiment.identification.diagnosis.peaks import Doubt
    >>> table = peak_table([Peak(50.0, Doubt.TONE, 1e-12, None, 0.1, ("S1", "S2"))])
    >>> [] if table is None else table.texts()[1][:5]
    ['50', 'S1, S2', 'below a line', '0.1', '1.0e-12']
    """
    if not peaks:
        return None
    rows = [
        (
            number(peak.frequency, 5),
            ", ".join(peak.outputs) or NO_VALUE,
            "below a line" if peak.width is None or peak.width < 1e-3 * peak.resolution else number(peak.width, 3),
            number(peak.resolution, 3),
            f"{peak.chance:.1e}",
            Cell(peak.reason, Mark.WARN),
        )
        for peak in peaks
    ]
    heads = [
        Column("frequency", "Hz"),
        "seen in",
        Column("width", "Hz"),
        Column("lines apart", "Hz"),
        Column("by chance"),
        "why it is no mode",
    ]
    notes = ["By chance: how likely there would be as much without a mode. A mode needs 1e-9, and lines within its width."]
    return make_table("Peaks seen, not confirmed as modes", heads, rows, notes=notes)


def data_warning_table(warnings: Sequence[str]) -> Table | None:
    """What the data cannot tell; `None` where there is nothing of the kind.

    >>> data_warning_table([]) is None
    True
    """
    if not warnings:
        return None
    return make_table("What the data cannot tell", ["warning"], [(Cell(text, Mark.WARN),) for text in warnings])


def motion_explained_text(explained: Array) -> str:
    """How much of the measured shapes is motion of the ideal stage.

    >>> motion_explained_text(np.array([0.999, 1.0]))
    'The motion drawn explains 99.9 % or more of every measured shape.'
    """
    if float(np.min(explained)) > 1.0 - 1e-9:
        return "As many outputs as freedoms: nothing could contradict the motion drawn."
    return f"The motion drawn explains {percent(np.floor(1e3 * float(np.min(explained))) / 1e3)} or more of every measured shape."
