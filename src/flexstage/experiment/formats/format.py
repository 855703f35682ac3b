"""Record file format: recognition, reading and writing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from flexstage.experiment.records.options import Options
from flexstage.experiment.records.record import Record, Responses


@dataclass(frozen=True)
class Format:
    """Record file format: its file name endings, and three functions.

    `claims` recognises a file from its first 4096 bytes and its ending. `read` returns the file's record, responses or both, according to
    the options. `write` writes a record or responses, completely or not at all; it is absent in formats that are only read. The functions
    raise `DesignError` for errors.
    """

    suffixes: tuple[str, ...]
    claims: Callable[[bytes, str], bool]
    read: Callable[[Path, Options], tuple[Record | Responses, ...]]
    write: Callable[[Path, Record | Responses], None] | None = None
