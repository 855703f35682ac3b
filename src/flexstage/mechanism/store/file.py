"""File input with checks of size and form."""

from __future__ import annotations

import os
import re
import stat
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.storage.files import require_regular

FORMAT = "flexstage 1"
"""Value of `format` in a design file."""
LARGEST = 5_000_000
"""Size limit of a file [bytes]: a thousand times a usual design."""
LONGEST_LINE = 4_000
_LEAST, _MOST = -(2**63), 2**63 - 1
_OPEN_STREAMS = ("/dev/stdin", "/dev/fd/")


def read_text(path: str | os.PathLike[str]) -> str:
    """Read the text of a design file.

    Raises `DesignError` if the file is missing, not a regular file, too large or not UTF-8.

    Open streams of a shell (`/dev/stdin`, `/dev/fd/63`) are accepted. A named pipe is refused, because opening it could block.

    >>> read_text("nowhere/stage.toml")
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: nowhere/stage.toml: file not found. Check the path.
    """
    where = os.fspath(path)
    try:
        if not where.startswith(_OPEN_STREAMS) and not stat.S_ISDIR(Path(path).stat().st_mode):
            require_regular(Path(path))
        with Path(path).open("rb") as stream:
            raw = stream.read(LARGEST + 1)
    except DesignError:
        raise
    except (OSError, ValueError) as error:
        raise _unreadable(where, error) from None
    if len(raw) > LARGEST:
        raise _too_large(where)
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise refuse(f"{where}:{line}", f"not UTF-8 (byte {error.start})", "Save the file as UTF-8 text") from None


def parse_toml(text: str, where: str) -> dict[str, Any]:
    """Parse a TOML text; raises `DesignError` with line and column if the text is invalid.

    >>> parse_toml('name = "a"', "stage.toml")
    {'name': 'a'}
    """
    if len(text) > LARGEST:
        raise _too_large(where)
    for number, line in enumerate(text.split("\n"), start=1):
        if len(line) > LONGEST_LINE:
            what = f"line too long (got {len(line)} characters, expected at most {LONGEST_LINE})"
            raise refuse(f"{where}:{number}", what, "Break the line")
    try:
        tree = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _not_toml(where, str(error)) from None
    except (RecursionError, ValueError) as error:
        reason = "nested too deeply" if isinstance(error, RecursionError) else "a number has too many digits"
        raise refuse(where, reason, "Check that this is a design file") from None
    require(Finding(f"{where}: {key}", "integer of more than 64 bits", "Use a smaller number") for key in _vast(tree, ""))
    return tree


def _vast(value: Any, where: str) -> Iterator[str]:
    """Keys of whole numbers beyond the 64 bits of TOML."""
    if isinstance(value, int) and not _LEAST <= value <= _MOST:
        yield where
    members = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in members:
        yield from _vast(item, f"{where}.{key}" if where else str(key))


def _unreadable(where: str, error: OSError | ValueError) -> DesignError:
    if isinstance(error, FileNotFoundError):
        return refuse(where, "file not found", "Check the path")
    if isinstance(error, IsADirectoryError):
        return refuse(where, "not a file but a folder", "Use the design file in it")
    return refuse(where, f"cannot be read: {getattr(error, 'strerror', None) or error}", "Check the path and its permissions")


def _too_large(where: str) -> DesignError:
    what = f"file too large (expected at most {LARGEST / 1e6:g} MB)"
    return refuse(where, what, "Check that this is a design file")


def _not_toml(where: str, message: str) -> DesignError:
    match = re.fullmatch(r"(.*) \(at (line \d+, column \d+|end of document)\)", message, re.DOTALL)
    reason, place = (match[1], match[2]) if match else (message, "")
    at = ":".join([where, *re.findall(r"\d+", place)])
    if reason.startswith(("Cannot overwrite", "Cannot declare", "Cannot mutate", "Duplicate")):
        return refuse(at, f"duplicate name ({reason})", "Rename or remove one of the two")
    return refuse(
        at, f"not TOML: {reason}", "Correct the line; put strings and values with units in quotes, and tables on one line in braces"
    )
