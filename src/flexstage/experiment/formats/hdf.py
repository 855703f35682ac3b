"""HDF5 files: arrays, strings and attributes are read block by block; records and responses are written."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.base.storage.files import Hdf, HdfArray, hdf, new_hdf
from flexstage.base.storage.store import atomic_write
from flexstage.experiment.formats.arrays import Contents, Spans, Variable, describe, read_arrays, response_arrays
from flexstage.experiment.formats.format import Format
from flexstage.experiment.records.options import Options
from flexstage.experiment.records.record import Record, Responses

BLOCK = 65_536
NUMBERS = frozenset("fiub")
"""Codes of numpy's kinds of real numbers."""
_FRAME = 1_000_000
"""Maximum bytes of a file in addition to its numbers: names, units, the tree of chunks."""


def stored_array(file: Hdf, array: HdfArray, *, name: str = "", column: str = "", turned: bool = False) -> Variable:
    """Wrap an array in an HDF5 file, or one `column` of a table, as a variable; `turned` reverses the order of the axes (for MAT files)."""

    def read(spans: Spans) -> Array:
        values = file.read(array.name, tuple(reversed(spans)) if turned else spans, column)
        return values.T if turned else values

    return Variable(name or array.name, array.shape[::-1] if turned else array.shape, read, array.kind == "c", array.attributes)


def is_hdf(start: bytes, _suffix: str) -> bool:
    """Recognise the signature of HDF5 files."""
    return start.startswith(b"\x89HDF\r\n\x1a\n")


def read_hdf(path: Path, options: Options) -> tuple[Record | Responses, ...]:
    """Read an HDF5 file as arrays by name. Samples stay in the file. Columns of tables are separate arrays.

    Lists of names, units and roles are attributes of the array, or separate arrays. Single values may be attributes of the file. Raises
    `DesignError` for an invalid, truncated or damaged file, and whenever `read_arrays` raises it.

    >>> import h5py, tempfile
    >>> from flexstage.experiment.records.options import Arrays
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with h5py.File(Path(folder) / "a.h5", "w") as file:
    ...         file["test/u"], file["test/y"], file.attrs["fs"] = [1.0, 2.0], [3.0, 4.0], 50.0
    ...     (found,) = read_hdf(Path(folder) / "a.h5", Options(arrays=Arrays(samples=("test/*",), rate=("fs",))))
    ...     found.names, found.rate, found.values.tolist()
    (('u', 'y'), 50.0, [[1.0, 3.0], [2.0, 4.0]])
    """
    file = hdf(path)
    said = dict(file.attributes) | {each.name: each.texts for each in file.arrays.values() if each.kind == "t"}
    variables = [variable for each in file.arrays.values() for variable in _variables(file, each)]
    return read_arrays(Contents(str(path), tuple(variables), said), options)


def _variables(file: Hdf, array: HdfArray) -> list[Variable]:
    """Array, or columns of a table; empty without numbers."""
    columns = [column for column, kind in array.columns.items() if kind in NUMBERS] if array.kind == "V" else []
    whole = [stored_array(file, array)] if array.kind in (*NUMBERS, "c") else []
    return whole + [stored_array(file, array, name=f"{array.name}/{column}", column=column) for column in columns]


def write_hdf(path: str | os.PathLike[str], what: Record | Responses) -> None:
    """Write an HDF5 file: a record as the array `samples` (n, channels), responses as `frequencies` and `responses` (f, outputs, inputs).

    `coherence` is a separate array. Names, units and roles are attributes. Numbers are written in full precision, and a record is written
    block by block. Raises `DesignError` if the file cannot be written.

    >>> import h5py, tempfile
    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_hdf(Path(folder) / "a.h5", in_memory([Channel("S1", "um")], 3.0, np.array([[0.1], [0.2]])))
    ...     with h5py.File(Path(folder) / "a.h5") as file:
    ...         file["samples"][:, 0].tolist(), file.attrs["names"].tolist(), float(file.attrs["rate"])
    ([0.1, 0.2], ['S1'], 3.0)
    """
    size = 8 * (what.length + BLOCK) * len(what.channels) if isinstance(what, Record) else 3 * what.values.nbytes
    with atomic_write(path) as place, new_hdf(place, size + _FRAME) as file:
        for name, value in describe(what).items():
            file.attrs[name] = _texts(value) if isinstance(value, tuple) else value
        if isinstance(what, Responses):
            for name, values in response_arrays(what).items():
                file[name] = values
            return
        shape = (what.length, len(what.channels))
        chunks = (max(1, min(what.length, BLOCK // 4)), shape[1]) if what.length else None
        samples = file.create_dataset("samples", shape, dtype="<f8", chunks=chunks)
        for start in range(0, what.length, BLOCK):
            samples[start : start + BLOCK] = what.samples.read(start, min(start + BLOCK, what.length))


def _texts(texts: tuple[str, ...]) -> Any:
    import h5py

    return np.array(texts, dtype=h5py.string_dtype())


HDF5 = Format((".h5", ".hdf5", ".hdf"), is_hdf, read_hdf, write_hdf)
"""HDF5 format: numbers keep all bits; files may have any size."""
