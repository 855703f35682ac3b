"""Design file: text form of a description. A file that is written and read again gives an equal description."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError
from flexstage.base.storage.store import write
from flexstage.mechanism.catalogue import shipped_catalogue
from flexstage.mechanism.checks import require_valid
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store.anchor import anchor_paths, beside, outline_text, part_text
from flexstage.mechanism.store.decode import mechanism_from
from flexstage.mechanism.store.encode import tree_of
from flexstage.mechanism.store.file import parse_toml, read_text
from flexstage.mechanism.store.lines import with_lines
from flexstage.mechanism.store.patch import patch
from flexstage.mechanism.store.schema import schema
from flexstage.mechanism.store.tidy import round_to_digits
from flexstage.mechanism.store.toml import text_of

__all__ = [
    "dump",
    "dumps",
    "load",
    "loads",
    "outline_text",
    "part_text",
    "patch",
    "round_to_digits",
    "schema",
    "shipped_catalogue",
    "write",
]


@check_arguments
def load(path: str | os.PathLike[str], *, checked: bool = True) -> Mechanism:
    """Read a design file and return the description.

    Raises `DesignError` with all errors of the file; with `checked`, also with errors of the description (see `checks.check`). Relative
    paths to imported solids and to part files start at the folder of the design file. The returned description has absolute paths.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     load(dump(Mechanism("empty"), f"{folder}/stage.toml"), checked=False) == Mechanism("empty")
    True
    """
    return loads(read_text(path), where=os.fspath(path), checked=checked, folder=Path(path).parent)


@check_arguments
def loads(text: str, *, where: str = "text", checked: bool = True, folder: Path | None = None) -> Mechanism:
    """Read the text of a design file and return the description.

    `where` is the name of the text in error messages. Relative paths are relative to `folder`. `checked` has the same meaning as in `load`.

    >>> loads("format = 'flexstage 1'; name = 'empty'".replace("; ", chr(10)), checked=False).name
    'empty'
    """
    raw = parse_toml(text, where)
    try:
        drawn = mechanism_from(raw, where if folder is None else str(folder / Path(where).name))
        mechanism = drawn if folder is None else anchor_paths(drawn, folder)
        return require_valid(mechanism) if checked else mechanism
    except DesignError as error:
        raise DesignError(with_lines(error.findings, text, where)) from None


@check_arguments
def dump(mechanism: Mechanism, path: str | os.PathLike[str], comments: Mapping[str, str] | None = None) -> Path:
    """Write a description as a design file and return its path; see `dumps`.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     dump(Mechanism("empty"), f"{folder}/stage.toml").name
    'stage.toml'
    """
    return write(path, dumps(beside(mechanism, Path(path).parent), comments))


@check_arguments
def dumps(mechanism: Mechanism, comments: Mapping[str, str] | None = None) -> str:
    """Return the text of a description's design file.

    Numbers are written in display units, as the shortest strings that give the same bits when they are read. `comments` has a comment for
    each address (`parts.neck`, or "" for the whole file), which is written above the table or value. Raises `DesignError` for a batch of
    designs and for complex numbers.

    >>> print(dumps(Mechanism("empty"), {"": "Nothing yet."}), end="")
    # Nothing yet.
    format = "flexstage 1"
    name = "empty"
    gravity = ["0 m/s^2", "0 m/s^2", "-9.80665 m/s^2"]
    """
    return text_of(tree_of(mechanism), comments or {})
