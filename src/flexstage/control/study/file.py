"""The set-up file of a loop: TOML with units, every key absent that the stage settles."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError
from flexstage.control.study.setup import LoopSetup
from flexstage.mechanism.store.decode import record_from
from flexstage.mechanism.store.file import parse_toml, read_text
from flexstage.mechanism.store.lines import with_lines
from flexstage.mechanism.store.schema import schema_of

FORMAT = "flexstage loop 1"


@check_arguments
def load_setup(path: str | os.PathLike[str]) -> LoopSetup:
    """Return the set-up in a file; the files that it names are looked for from its folder.

    Raises `DesignError` with everything that is wrong with it, each finding with file, line and key.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "loop.toml").write_text(example())
    ...     load_setup(f"{folder}/loop.toml") == LoopSetup()
    True
    """
    return read_setup(path, {})


@dataclass(frozen=True)
class Change:
    """A raw value that goes before the file's, or a function of the file's own; `option` names it in findings."""

    option: str
    value: Any


def read_setup(path: str | os.PathLike[str] | None, changes: Mapping[str, Change]) -> LoopSetup:
    """Return the set-up in a file, none: the default, with changes by address.

    >>> read_setup(None, {"controller.bandwidth": Change("--bandwidth", "30 Hz")}).controller.bandwidth
    30.0
    """
    text, where = ("", "set-up") if path is None else (read_text(path), os.fspath(path))
    raw: dict[str, Any] = {"format": FORMAT} if path is None else parse_toml(text, where)
    for part in (raw.get("hysteresis"), raw.get("trajectory")):
        if path is not None and isinstance(part, dict) and isinstance(part.get("file"), str):
            part["file"] = str(Path(path).resolve().parent / part["file"])
    for address, change in changes.items():
        *tables, key = address.split(".")
        table = raw
        for each in tables:
            table = table.setdefault(each, {})
            if not isinstance(table, dict):
                break
        else:
            table[key] = change.value(table.get(key)) if callable(change.value) else change.value
    return _setup_of(raw, text, where)


def loads_setup(text: str, *, where: str = "text") -> LoopSetup:
    r"""Return the set-up that a text means; `where` names it in findings.

    >>> loads_setup('format = "flexstage loop 1"\nrate = "5 kHz"').rate
    5000.0
    """
    return _setup_of(parse_toml(text, where), text, where)


def _setup_of(raw: dict[str, Any], text: str, where: str) -> LoopSetup:
    try:
        return record_from(LoopSetup, raw, FORMAT)
    except DesignError as error:
        raise DesignError(with_lines(error.findings, text, where)) from None


def setup_schema() -> dict[str, Any]:
    """The JSON Schema of a set-up file, for editors.

    >>> setup_schema()["properties"]["rate"]["examples"]
    ['4 kHz']
    """
    return schema_of(LoopSetup, FORMAT, "flexstage loop")


def example() -> str:
    """A commented file to start from: what is not commented out is the default.

    >>> example().splitlines()[0]
    'format = "flexstage loop 1"'
    """
    return resources.files("flexstage.control.study").joinpath("example.toml").read_text(encoding="utf-8")
