"""Set-up file of a loop: TOML with units; missing keys have defaults from the stage."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding
from flexstage.control.study.setup import LoopSetup
from flexstage.mechanism.store.decode import record_from
from flexstage.mechanism.store.file import parse_toml, read_text
from flexstage.mechanism.store.lines import with_lines
from flexstage.mechanism.store.schema import schema_of

FORMAT = "flexstage loop 1"


@check_arguments
def load_setup(path: str | os.PathLike[str]) -> LoopSetup:
    """Return the set-up in a file. Relative file names in the set-up file refer to its folder.

    Raises `DesignError` with all errors of the file; each error names file, line and key.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "loop.toml").write_text(example())
    ...     load_setup(f"{folder}/loop.toml") == LoopSetup()
    True
    """
    return read_setup(path, {})[0]


@dataclass(frozen=True)
class SetupChange:
    """Override of a key of a set-up: `value` is a new raw value, or a function of the value in the file.

    Errors name the command-line `option`, for example --bandwidth.
    """

    option: str
    value: Any


def read_setup(path: str | os.PathLike[str] | None, changes: Mapping[str, SetupChange]) -> tuple[LoopSetup, list[Finding]]:
    """Return the set-up in a file (default: the default set-up) with overrides by address, and findings for invalid overrides.

    >>> read_setup(None, {"controller.bandwidth": SetupChange("--bandwidth", "30 Hz")})[0].controller.bandwidth
    30.0
    """
    text, where = ("", "") if path is None else (read_text(path), os.fspath(path))
    kept, wrong = dict(changes), list[Finding]()
    while True:
        raw: dict[str, Any] = {"format": FORMAT} if path is None else parse_toml(text, where)
        for part in (raw.get("hysteresis"), raw.get("trajectory")):
            if path is not None and isinstance(part, dict) and isinstance(part.get("file"), str):
                part["file"] = str(Path(path).resolve().parent / part["file"])
        for address, change in kept.items():
            _apply(raw, address.split("."), change.value)
        try:
            return record_from(LoopSetup, raw, FORMAT), wrong
        except DesignError as error:
            refused = {address: each for each in error.findings for address in kept if each.where.startswith(address)}
            if not refused:
                raise DesignError([*wrong, *with_lines(error.findings, text, where)]) from None
            wrong += [Finding(kept.pop(address).option, each.what, each.advice) for address, each in refused.items()]


def _apply(table: Any, keys: list[str], value: Any) -> None:
    """Set a value in nested tables; another type is left for its own finding."""
    if isinstance(table, dict) and len(keys) > 1:
        _apply(table.setdefault(keys[0], {}), keys[1:], value)
    elif isinstance(table, dict):
        table[keys[0]] = value(table.get(keys[0])) if callable(value) else value


def loads_setup(text: str, *, where: str = "text") -> LoopSetup:
    r"""Parse the text of a set-up file; findings refer to the file as `where`.

    >>> loads_setup('format = "flexstage loop 1"\nrate = "5 kHz"').rate
    5000.0
    """
    try:
        return record_from(LoopSetup, parse_toml(text, where), FORMAT)
    except DesignError as error:
        raise DesignError(with_lines(error.findings, text, where)) from None


def setup_schema() -> dict[str, Any]:
    """Return the JSON Schema of a set-up file, for editors.

    >>> setup_schema()["properties"]["rate"]["examples"]
    ['4 kHz']
    """
    return schema_of(LoopSetup, FORMAT, "flexstage loop")


def example() -> str:
    """Return a commented example file; lines that are not commented out contain the defaults.

    >>> example().splitlines()[0]
    'format = "flexstage loop 1"'
    """
    return resources.files("flexstage.control.study").joinpath("example.toml").read_text(encoding="utf-8")
