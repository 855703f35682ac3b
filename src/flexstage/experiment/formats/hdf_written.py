"""HDF5 files written so that a full disk is an error and no more: the library itself ends the whole program over it."""

from __future__ import annotations

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from flexstage.base.store import atomic_write


class Stream:
    """A file that takes bytes as if nothing were wrong once the disk has refused some; `settle` tells.

    The library keeps what it could not write, tries again at its end and crashes there: it must not learn of refusals.

    >>> stream = Stream(Path("/dev/full"))
    >>> stream.write(b"abc")
    3
    >>> stream.settle()
    Traceback (most recent call last):
    OSError: [Errno 28] No space left on device
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("w+b", buffering=0)
        self._refusal: OSError | None = None

    def seek(self, offset: int, whence: int = 0) -> int:
        """Go to a place."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """The place."""
        return self._file.tell()

    def read(self, size: int = -1) -> bytes | None:
        """Read so many bytes."""
        return self._file.read(size)

    def readinto(self, buffer: memoryview) -> int | None:
        """Read into a buffer; how many bytes."""
        return self._file.readinto(buffer)

    def write(self, data: bytes | memoryview) -> int:
        """Write, or skip as many bytes once the disk has refused."""
        rest = memoryview(data).cast("B")
        size = len(rest)
        try:
            while len(rest) and self._refusal is None:
                rest = rest[self._file.write(rest) :]
        except OSError as error:
            self._refusal = error
        return size

    def truncate(self, size: int | None = None) -> int:
        """Cut off or extend."""
        try:
            return self._file.truncate(size)
        except OSError as error:
            self._refusal = self._refusal or error
            return size or 0

    def flush(self) -> None:
        """Nothing: it is not buffered."""

    def settle(self) -> None:
        """Close; raises the first refusal of the disk."""
        self._file.close()
        if self._refusal is not None:
            raise self._refusal


@contextmanager
def hdf_written(path: str | os.PathLike[str], *, version: str | None = None, head: bytes = b"") -> Generator[Any]:
    """An HDF5 file to fill: there when the block ends, or not at all where it fails or the disk refuses (`DesignError`).

    `version` is that of the library which must be able to read it; `head` stands before the file's own content (512 bytes, or 1024, ...).

    >>> import h5py, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with hdf_written(Path(folder) / "a.h5") as file:
    ...         file["x"] = 3.0
    ...     float(h5py.File(Path(folder) / "a.h5")["x"][()])
    3.0
    """
    import h5py

    with atomic_write(path) as place:
        stream = Stream(place)
        try:
            with h5py.File(stream, "w", libver=None if version is None else (version, version), userblock_size=len(head)) as file:
                yield file
            stream.seek(0)
            stream.write(head)
        finally:
            stream.settle()
