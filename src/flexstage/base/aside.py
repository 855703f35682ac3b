"""Files written aside and then renamed: there whole or not at all."""

from __future__ import annotations

import errno
import os
import secrets
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from flexstage.base.finding import refuse

_LONGEST = 60


def beside(target: Path) -> Path:
    """A new name beside a file, to write to and rename. Raises `PermissionError` for a file that is write-protected.

    A rename would replace even that.

    >>> beside(Path("a.txt")).name[:7]
    '.a.txt.'
    """
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, "the file is write-protected")
    return target.with_name(f".{stem_of(target)}.{secrets.token_hex(4)}.part")


def stem_of(target: Path) -> str:
    """How names beside a file begin, after a dot: its own name, cut so that they do not become too long for a disk.

    >>> len(stem_of(Path(100 * "a")))
    60
    """
    return target.name[:_LONGEST]


def put(place: Path, target: Path) -> None:
    """Rename what was written to its target, with the mode of the file that it replaces.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = Path(folder, "new").write_text("whole")
    ...     put(Path(folder, "new"), Path(folder, "a.txt"))
    ...     [each.name for each in Path(folder).iterdir()]
    ['a.txt']
    """
    if target.exists():
        place.chmod(target.stat().st_mode & 0o777)
    place.replace(target)


@contextmanager
def aside(path: str | os.PathLike[str]) -> Generator[Path]:
    """A path beside `path` to write to; renamed to it when the block ends, removed where it fails.

    Raises `DesignError` where the folder is missing, the file is write-protected, or the disk refuses.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with aside(Path(folder) / "a.txt") as place:
    ...         _ = place.write_text("whole")
    ...     [each.name for each in Path(folder).iterdir()]
    ['a.txt']
    """
    target, place = Path(path), None
    try:
        place = beside(target)
        yield place
        put(place, target)
    except OSError as error:
        raise refuse(os.fspath(path), f"it cannot be written ({error.strerror or error})", "Choose another file or free space") from None
    finally:
        if place is not None:
            place.unlink(missing_ok=True)
