"""Writing of CSV files: a record with its times, or responses as real and imaginary parts."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Iterable, Mapping
from typing import IO

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.base.storage.files import Attribute
from flexstage.base.storage.store import atomic_write
from flexstage.experiment.formats.arrays import describe
from flexstage.experiment.formats.table.read import OWN
from flexstage.experiment.records.options import Arrays, matches
from flexstage.experiment.records.record import Channel, Record, Responses

BLOCK = 16_384


def write_table(path: str | os.PathLike[str], what: Record | Responses) -> None:
    """Write a CSV file: comments with rate, roles and name, then a header with channel names and units, then the numbers.

    Numbers have as many digits as needed for an exact round trip. Raises `DesignError` if the file cannot be written, and for
    channel names with line breaks, names reserved for times, and names that a spreadsheet would run as formulas.

    >>> import tempfile
    >>> from pathlib import Path
    >>> from flexstage.experiment.records.record import in_memory
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_table(Path(folder) / "a.csv", in_memory([Channel("S1", "um")], 4.0, np.array([[0.1], [0.2]])))
    ...     (Path(folder) / "a.csv").read_text().splitlines()[-3:]
    ['time [s],S1 [um]', '0.0,0.1', '0.25,0.2']
    """
    channels = what.channels if isinstance(what, Record) else (*what.outputs, *what.inputs)
    require(_name_findings(os.fspath(path), channels))
    with atomic_write(path) as place, place.open("w", encoding="utf-8", newline="") as stream:
        if isinstance(what, Record):
            _write_record(stream, what)
        else:
            _write_responses(stream, what)


def _name_findings(where: str, channels: Iterable[Channel]) -> Iterable[Finding]:
    for channel in channels:
        is_formula = channel.name.startswith(("=", "+", "-", "@"))  # spreadsheets would execute it
        is_line = channel.name.isprintable() and channel.name == channel.name.strip()
        if is_formula or not is_line or matches(channel.name, Arrays().time):
            yield Finding(f"{where}: {channel.name}", "its name is not allowed as a CSV column name", "Rename the channel")


def _write_record(stream: IO[str], record: Record) -> None:
    said = {name: value for name, value in describe(record).items() if name not in ("names", "units")}
    stream.write(_comment(said | {"length": float(record.length)}))
    stream.write(_row(["time [s]", *(_heading(channel.name, channel.unit) for channel in record.channels)]))
    for start in range(0, record.length, BLOCK):
        block = record.samples.read(start, min(start + BLOCK, record.length))
        times = record.start + np.arange(start, start + len(block)) / record.rate
        _write_numbers(stream, np.column_stack([times, block]))


def _write_responses(stream: IO[str], responses: Responses) -> None:
    stream.write(_comment(describe(responses)))
    parts = [np.real(responses.values), np.imag(responses.values), *([] if responses.coherence is None else [responses.coherence])]
    headings = [
        _heading(f"{output.name}/{input_.name} {ending}", unit if ending != "coherence" else "1")
        for output, units in zip(responses.outputs, responses.units, strict=True)
        for input_, unit in zip(responses.inputs, units, strict=True)
        for ending in ("re", "im", "coherence")[: len(parts)]
    ]
    stream.write(_row(["frequency [Hz]", *headings]))
    _write_numbers(stream, np.column_stack([responses.frequencies, np.stack(parts, axis=-1).reshape(len(responses.frequencies), -1)]))


def _comment(said: Mapping[str, Attribute]) -> str:
    return f"# {OWN}{json.dumps(said, ensure_ascii=False)}\n"


def _heading(name: str, unit: str) -> str:
    return f"{name} [{unit or '-'}]"


def _row(fields: Iterable[str]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(list(fields))
    return text.getvalue()


def _write_numbers(stream: IO[str], numbers: Array) -> None:
    stream.writelines(",".join(map(repr, line)) + "\n" for line in numbers.tolist())
