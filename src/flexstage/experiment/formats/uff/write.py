"""Universal files written: a record as time histories, responses as frequency response functions, in binary or ASCII."""

from __future__ import annotations

import os
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
_LINE = 4
_LONGEST = 80
_EMPTY = Axis(0, "", "")


def write_uff(path: str | os.PathLike[str], what: Record | Responses, *, binary: bool = True) -> None:
    """Write a universal file, one function a channel or pair of channels: numbers of double precision.

    In binary they come back to the bit; ASCII has 13 digits. What the head has no room for (rate to all digits, roles) stands in its lines
    of text. Raises `DesignError` for names that do not fit and where the file cannot be written.

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
            _write_record(stream, what, binary=binary)
        else:
            _write_responses(stream, what, binary=binary)


def _name_findings(where: str, channels: tuple[Channel, ...]) -> list[Finding]:
    long = [channel.name for channel in channels if not _fits(channel.name)]
    advice = (
        f"Universal files hold names of one line and at most {_LONGEST} bytes that do not begin or end with a blank: rename the channel"
    )
    wide = [channel for channel in channels if len(channel.unit) > 20]
    return [Finding(f"{where}: {name}", "its name does not fit into a universal file", advice) for name in long] + [
        Finding(
            f"{where}: {channel.name}",
            f'its unit "{channel.unit}" has {len(channel.unit)} characters, room is for 20',
            "Write the unit shorter",
        )
        for channel in wide
    ]


def _fits(name: str) -> bool:
    return len(name.encode()) <= _LONGEST and name.isprintable() and name == name.strip() and name != "NONE"


def _write_record(stream: BinaryIO, record: Record, *, binary: bool) -> None:
    """All channels side by side: each block of samples goes to every channel's place, so that the record is read once."""
    kinds = {Role.INPUT: 13, Role.OUTPUT: 8, Role.UNKNOWN: 0}
    starts: list[int] = []
    position = 0
    for number, channel in enumerate(record.channels):
        own = f"flexstage {channel.role.value}; rate {float(record.rate)!r} Hz; start {float(record.start)!r} s"
        ordinate = Axis(kinds[channel.role], "", channel.unit)
        place = channel.name, number + 1, 0
        texts = (channel.name, record.name[:_LONGEST], "", count_function("", number + 1, len(record.channels)), own)
        axes = (Axis(17, "time", "s"), ordinate, _EMPTY)
        form = (REAL_DOUBLE, record.length, True, record.start, 1.0 / record.rate, 0.0)
        begin = head(Function(texts, TIME, place, ("", 0, 0), *form, *axes), binary_bytes=8 * record.length if binary else None)
        stream.seek(position)
        stream.write(begin)
        starts.append(position + len(begin))
        position += len(begin) + _size(record.length, binary=binary)
        stream.seek(position)
        stream.write(_END)
        position += len(_END)
    for start in range(0, record.length, BLOCK):
        block = record.samples.read(start, min(start + BLOCK, record.length))
        for column, origin in enumerate(starts):
            stream.seek(origin + _size(start, binary=binary))
            stream.write(_encode(block[:, column], binary=binary))


def _size(count: int, *, binary: bool) -> int:
    """Bytes of that many numbers; ASCII lines end after four."""
    return 8 * count if binary else 20 * count + -(-count // _LINE)


def _encode(numbers: Array, *, binary: bool) -> bytes:
    if binary:
        return np.ascontiguousarray(numbers, dtype="<f8").tobytes()
    words = [f"{number:20.12E}" for number in numbers.tolist()]
    return "".join("".join(words[begin : begin + _LINE]) + "\n" for begin in range(0, len(words), _LINE)).encode()


def _write_responses(stream: BinaryIO, responses: Responses, *, binary: bool) -> None:
    first, step = _even(responses.frequencies)
    own = f"flexstage response; first {first!r} Hz; step {step!r} Hz; averages {responses.averages or 0}"
    number, kinds = 0, 1 if responses.coherence is None else 2
    for row, output in enumerate(responses.outputs):
        for column, input_ in enumerate(responses.inputs):
            number += kinds
            counts = count_function(responses.window[: _LONGEST // 2], number, kinds * len(responses.outputs) * len(responses.inputs))
            texts = (output.name, input_.name, responses.name[:_LONGEST], counts, own)
            places = ((output.name, row + 1, 0), (input_.name, column + 1, 0))
            units = (Axis(18, "frequency", "Hz"), Axis(8, "", output.unit), Axis(13, "", input_.unit))
            form = (len(responses.frequencies), bool(step), first if step else 0.0, step, 0.0)
            response = Function(texts, RESPONSE, *places, COMPLEX_DOUBLE, *form, *units)
            _write_function(stream, response, responses.frequencies, responses.values[:, row, column], binary=binary)
            if responses.coherence is not None:
                coherence = Function(texts, COHERENCE, *places, REAL_DOUBLE, *form, units[0], _EMPTY, _EMPTY)
                _write_function(stream, coherence, responses.frequencies, responses.coherence[:, row, column], binary=binary)


def _even(frequencies: Array) -> tuple[float, float]:
    """First frequency and step where they give the others to the bit; else a step of zero."""
    if len(frequencies) < 2:
        return float(frequencies[0]) if len(frequencies) else 0.0, 0.0
    first = float(frequencies[0])
    step = (float(frequencies[-1]) - first) / (len(frequencies) - 1)
    return first, step if np.array_equal(first + step * np.arange(len(frequencies)), frequencies) else 0.0


def _write_function(stream: BinaryIO, function: Function, frequencies: Array, values: Array, *, binary: bool) -> None:
    columns = ([] if function.is_even else [frequencies]) + ([np.real(values), np.imag(values)] if function.is_complex else [values])
    numbers = np.stack(columns, axis=-1)
    stream.write(head(function, binary_bytes=8 * numbers.size if binary else None))
    if binary or function.is_even:
        stream.write(_encode(numbers.ravel(), binary=binary))
    else:
        stream.write(_encode_uneven(numbers))
    stream.write(_END)


def _encode_uneven(numbers: Array) -> bytes:
    """Lines with frequencies of 6 digits: one complex value a line, or two real ones."""
    form = "{:13.5E}" + "{:20.12E}" * (numbers.shape[1] - 1)
    words = [form.format(*line) for line in numbers.tolist()]
    each = 1 if numbers.shape[1] == 3 else 2
    return "".join("".join(words[begin : begin + each]) + "\n" for begin in range(0, len(words), each)).encode()
