"""What a form of record files is: which files are of it, how they are read and written."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from flexstage.experiment.records.options import Options
from flexstage.experiment.records.record import Record, Responses


@dataclass(frozen=True)
class Format:
    """A form of record files: the endings of its files' names, and three functions.

    `claims` says of a file's first 4096 bytes and of its ending whether it is of this form. `read` gives the record, the responses or both
    that it holds, as the options say; `write` writes either, whole or not at all. All raise `DesignError`.
    """

    suffixes: tuple[str, ...]
    claims: Callable[[bytes, str], bool]
    read: Callable[[Path, Options], tuple[Record | Responses, ...]]
    write: Callable[[Path, Record | Responses], None] | None = None
