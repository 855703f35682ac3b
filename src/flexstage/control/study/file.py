"""The set-up file of a loop: TOML with units, every key absent that the stage settles."""

from __future__ import annotations

import os
from dataclasses import replace
from importlib import resources
from pathlib import Path
from typing import Any

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError
from flexstage.control.study.setup import FileMotion, LoopSetup
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
    found = loads_setup(read_text(path), where=os.fspath(path))
    root = Path(path).resolve().parent
    if found.hysteresis is not None and found.hysteresis.file is not None:
        found = replace(found, hysteresis=replace(found.hysteresis, file=str(root / found.hysteresis.file)))
    if isinstance(found.trajectory, FileMotion):
        found = replace(found, trajectory=replace(found.trajectory, file=str(root / found.trajectory.file)))
    return found


def loads_setup(text: str, *, where: str = "text") -> LoopSetup:
    r"""Return the set-up that a text means; `where` names it in findings.

    >>> loads_setup('format = "flexstage loop 1"\nrate = "5 kHz"').rate
    5000.0
    """
    raw = parse_toml(text, where)
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
