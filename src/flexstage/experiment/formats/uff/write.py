"""Writing of universal files: records as time histories, responses as frequency response functions, in binary."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import BinaryIO

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.base.storage.store import atomic_write
from flexstage.experiment.formats.uff.function import (
    COHERENCE,
    COMPLEX_DOUBLE,
    REAL_DOUBLE,
    RESPONSE,
    TIME,
    Axis,
    Function,
    count_function,
    head,
)
from flexstage.experiment.records.record import Channel, Record, Responses, Role

BLOCK = 65_536
_END = f"{-1:6d}\n".encode()
_LONGEST = 80
_EMPTY = Axis(0, "", "")


def write_uff(path: str | os.PathLike[str], what: Record | Responses) -> None:
    """Write a universal file, one function per channel or pair of channels, in double precision.

    Numbers are written in full precision. The header's lines of text contain data for which the format has no field (full-precision rate,
    roles). Raises `DesignError` for channel names and units that the format does not support, and if the file cannot be written.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from flexstage.experiment.records.options import Options
    >>> from flexstage.experiment.records.record import in_memory
    >>> from flexstage.experiment.formats.uff.read import read_uff
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_uff(Path(folder) / "a.uff", in_memory([Channel("S1", "um", Role.OUTPUT)], 3.0, np.array([[0.1], [0.2]])))
    ...     (again,) = read_uff(Path(folder) / "a.uff", Options())
    ...     again.rate, again.channels[0].unit, again.values.tolist()
    (3.0, 'um', [[0.1], [0.2]])
    """
    channels = what.channels if isinstance(what, Record) else (*what.outputs, *what.inputs)
    require(_name_findings(os.fspath(path), channels))
    with atomic_write(path) as place, place.open("wb") as stream:
        if isinstance(what, Record):
            _write_record(stream, what)
        else:
            stream.writelines(_response_functions(what))


def _name_findings(where: str, channels: tuple[Channel, ...]) -> Iterator[Finding]:
    advice = f"Rename the channel: universal files need single-line names of at most {_LONGEST} bytes without outer blanks"
    for channel in channels:
        if not _fits(channel.name):
            yield Finding(f"{where}: {channel.name}", "its name does not fit into a universal file", advice)
    for channel in channels:
        if len(channel.unit) > 20:
            what = f'its unit "{channel.unit}" is too long (got {len(channel.unit)} characters, expected at most 20)'
            yield Finding(f"{where}: {channel.name}", what, "Shorten the unit")


def _fits(name: str) -> bool:
    return len(name.encode()) <= _LONGEST and name.isprintable() and name == name.strip() and name != "NONE"


def _write_record(stream: BinaryIO, record: Record) -> None:
    """Write all channels together: each block of samples goes to every channel's position, so that the record is read once."""
    kinds = {Role.INPUT: 13, Role.OUTPUT: 8, Role.UNKNOWN: 0}
    form = (REAL_DOUBLE, record.length, True, record.start, 1.0 / record.rate, 0.0)
    starts: list[int] = []
    for number, channel in enumerate(record.channels, start=1):
        own = f"flexstage {channel.role.value}; rate {float(record.rate)!r} Hz; start {float(record.start)!r} s"
        texts = (channel.name, record.name[:_LONGEST], "", count_function("", number, len(record.channels)), own)
        axes = (Axis(17, "time", "s"), Axis(kinds[channel.role], "", channel.unit), _EMPTY)
        stream.write(head(Function(texts, TIME, (channel.name, number, 0), ("", 0, 0), *form, *axes), 8 * record.length))
        starts.append(stream.tell())
        stream.seek(8 * record.length, os.SEEK_CUR)
        stream.write(_END)
    for first in range(0, record.length, BLOCK):
        block = record.samples.read(first, min(first + BLOCK, record.length))
        for column, start in enumerate(starts):
            stream.seek(start + 8 * first)
            stream.write(block[:, column].astype("<f8").tobytes())


def _response_functions(responses: Responses) -> Iterator[bytes]:
    """Each response, followed by its coherence, if any."""
    first, step = _even(responses.frequencies)
    own = f"flexstage response; first {first!r} Hz; step {step!r} Hz; averages {responses.averages or 0}"
    number, kinds = 0, 1 if responses.coherence is None else 2
    form = (len(responses.frequencies), bool(step), first if step else 0.0, step, 0.0)
    for row, output in enumerate(responses.outputs):
        for column, input_ in enumerate(responses.inputs):
            number += kinds
            counts = count_function(responses.window[: _LONGEST // 2], number, kinds * len(responses.outputs) * len(responses.inputs))
            texts = (output.name, input_.name, responses.name[:_LONGEST], counts, own)
            places = ((output.name, row + 1, 0), (input_.name, column + 1, 0))
            units = (Axis(18, "frequency", "Hz"), Axis(8, "", output.unit), Axis(13, "", input_.unit))
            values = responses.values[:, row, column]
            response = Function(texts, RESPONSE, *places, COMPLEX_DOUBLE, *form, *units)
            yield _function(response, responses.frequencies, np.real(values), np.imag(values))
            if responses.coherence is not None:
                coherence = Function(texts, COHERENCE, *places, REAL_DOUBLE, *form, units[0], _EMPTY, _EMPTY)
                yield _function(coherence, responses.frequencies, responses.coherence[:, row, column])


def _even(frequencies: Array) -> tuple[float, float]:
    """First frequency and step if they reproduce the others exactly; else a step of zero."""
    if len(frequencies) < 2:
        return float(frequencies[0]) if len(frequencies) else 0.0, 0.0
    first = float(frequencies[0])
    step = (float(frequencies[-1]) - first) / (len(frequencies) - 1)
    return first, step if np.array_equal(first + step * np.arange(len(frequencies)), frequencies) else 0.0


def _function(function: Function, frequencies: Array, *values: Array) -> bytes:
    numbers = np.stack([*(() if function.is_even else (frequencies,)), *values], axis=-1)
    return head(function, 8 * numbers.size) + numbers.astype("<f8").tobytes() + _END
