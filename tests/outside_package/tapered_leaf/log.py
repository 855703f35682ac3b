"""Files of a data logger: a line of its rate in Hz, one of names, one of units, then a line a sample."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from flexstage.base.finding import refuse
from flexstage.experiment.formats.format import Format
from flexstage.experiment.records.options import Options, assign
from flexstage.experiment.records.record import Channel, Record, in_memory


def is_log(start: bytes, _suffix: str) -> bool:
    """Whether a file begins with the logger's mark."""
    return start.startswith(b"LOG ")


def read_log(path: Path, options: Options) -> tuple[Record]:
    """Its one record, in memory."""
    try:
        rate, names, units, *rows = path.read_text().splitlines()
        values = np.array([[float(word) for word in row.split()] for row in rows])
        channels = [Channel(name, unit) for name, unit in zip(names.split(), units.split(), strict=True)]
        known = options.rate or float(rate.removeprefix("LOG "))
    except ValueError as error:
        raise refuse(str(path), f"it is no log: {error}", "Export it anew") from None
    return (replace(in_memory(assign(channels, options, str(path)), known, values), source=str(path)),)


LOG = Format((".log",), is_log, read_log)
