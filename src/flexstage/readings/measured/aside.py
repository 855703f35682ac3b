"""Files written aside and then renamed: there whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from flexstage.base.finding import refuse


@contextmanager
def aside(path: str | os.PathLike[str]) -> Generator[Path]:
    """A path beside `path` to write to; renamed to it when the block ends, removed where it fails.

    Raises `DesignError` where the folder is missing or the disk refuses.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with aside(Path(folder) / "a.txt") as place:
    ...         _ = place.write_text("whole")
    ...     [each.name for each in Path(folder).iterdir()]
    ['a.txt']
    """
    target = Path(path)
    place = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
    try:
        yield place
        place.replace(target)
    except OSError as error:
        raise refuse(os.fspath(path), f"it cannot be written ({error.strerror or error})", "Choose another file or free space") from None
    finally:
        place.unlink(missing_ok=True)
