"""Look through an HDF5 file and say nothing: `python hdf_look.py FILE`, in a process that may crash; it needs nothing of the project."""

from __future__ import annotations

import contextlib
import sys
from pathlib import Path
from typing import Any

_SMALL = 1_000_000


def look_through(path: Path) -> None:
    """Visit everything there is: names, attributes, texts, small arrays, the index of large ones.

    >>> import tempfile, h5py
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     h5py.File(Path(folder) / "a.h5", "w").close()
    ...     look_through(Path(folder) / "a.h5")
    """
    import h5py

    with h5py.File(path, "r") as file:
        dict(file.attrs.items())
        file.visititems(_visit)


def _visit(_name: str, thing: Any) -> None:
    with contextlib.suppress(Exception):  # what is wrong but harmless is told where it is read
        dict(thing.attrs.items())
        if hasattr(thing, "dtype"):
            _touch(thing)


def _touch(dataset: Any) -> None:
    if dataset.chunks is not None:
        dataset.id.get_num_chunks()
    if dataset.size is not None and (dataset.size <= _SMALL or dataset.dtype.kind == "O"):
        dataset[()]


if __name__ == "__main__":
    with contextlib.suppress(Exception):
        look_through(Path(sys.argv[1]))
