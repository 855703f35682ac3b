"""HDF5 files: their arrays, texts and attributes, read block by block; records and responses written."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.number import Array
from flexstage.base.storage.files import Attribute, Hdf, HdfArray, hdf, new_hdf
from flexstage.base.storage.store import atomic_write
from flexstage.experiment.formats.arrays import RECORD_FORM, RESPONSES_FORM, Contents, Variable, read_arrays
from flexstage.experiment.formats.format import Format
from flexstage.experiment.records.options import Options
from flexstage.experiment.records.record import ComputedSamples, Record, Responses, Samples

BLOCK = 65_536
NUMBERS = frozenset("fiub")
"""Kinds of real numbers, as numpy calls them."""
_FRAME = 1_000_000
"""Bytes of a file beside its numbers, at most: names, units, the tree of chunks."""


@dataclass(frozen=True, eq=False)
class StoredArray:
    """An array in an HDF5 file, or one `column` of a table; `turned` where the file keeps axes in the opposite order, as MAT files do."""

    file: Hdf
    name: str
    shape: tuple[int, ...]
    is_complex: bool
    attributes: Mapping[str, Attribute] = field(default_factory=dict[str, Attribute])
    dataset: str = ""
    column: str = ""
    turned: bool = False

    def whole(self) -> Array:
        """The array."""
        return self._read(())

    def samples(self, axis: int) -> Samples:
        """The array as samples along an axis, left in the file, as floats (n, channels)."""

        def read(start: int, stop: int) -> Array:
            chosen = [(0, length) for length in self.shape]
            chosen[axis] = (start, min(stop, self.shape[axis]))
            values = np.moveaxis(self._read(tuple(reversed(chosen)) if self.turned else tuple(chosen)), axis, 0)
            return values.reshape(len(values), int(np.prod(values.shape[1:]))).astype(float, copy=False)

        return ComputedSamples(self.shape[axis], read)

    def _read(self, spans: tuple[tuple[int, int], ...]) -> Array:
        values = self.file.read(self.dataset or self.name, spans, self.column)
        return values.T if self.turned else values


def is_hdf(start: bytes, _suffix: str) -> bool:
    """Whether a file begins as HDF5 files do."""
    return start.startswith(b"\x89HDF\r\n\x1a\n")


def read_hdf(path: Path, options: Options) -> tuple[Record | Responses, ...]:
    """What an HDF5 file holds, by the names of its arrays, which stay in the file. Columns of tables are arrays of their own.

    Lists of names, units and roles are attributes of the array they belong to, or arrays themselves; single values attributes of the file.
    Raises `DesignError` where it is none, breaks off or is damaged, and as `read_arrays` does.

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
    """The array; of a table its columns; nothing for what has no numbers."""
    name, attributes = array.name, array.attributes
    if array.kind == "V":
        return [
            StoredArray(file, f"{name}/{column}", array.shape, is_complex=False, attributes=attributes, dataset=name, column=column)
            for column, kind in array.columns.items()
            if kind in NUMBERS
        ]
    return [StoredArray(file, name, array.shape, array.kind == "c", attributes)] if array.kind in (*NUMBERS, "c") else []


def write_hdf(path: str | os.PathLike[str], what: Record | Responses) -> None:
    """Write an HDF5 file: the array `samples` (n, channels), or `frequencies` and `responses` (f, outputs, inputs) with `coherence`.

    Names, units and roles stand in attributes. Numbers come back to the bit; a record is written block by block. Raises `DesignError`
    where the file cannot be written.

    >>> import h5py, tempfile
    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_hdf(Path(folder) / "a.h5", in_memory([Channel("S1", "um")], 3.0, np.array([[0.1], [0.2]])))
    ...     with h5py.File(Path(folder) / "a.h5") as file:
    ...         file["samples"][:, 0].tolist(), file["samples"].attrs["names"].tolist(), float(file.attrs["rate"])
    ([0.1, 0.2], ['S1'], 3.0)
    """
    size = 8 * (what.length + BLOCK) * len(what.channels) if isinstance(what, Record) else 3 * what.values.nbytes
    with atomic_write(path) as place, new_hdf(place, size + _FRAME) as file:
        if isinstance(what, Record):
            _write_record(file, what)
        else:
            _write_responses(file, what)


def _write_record(file: Any, record: Record) -> None:
    file.attrs.update({"format": RECORD_FORM, "rate": float(record.rate), "start": float(record.start), "name": record.name})
    shape = (record.length, len(record.channels))
    samples = file.create_dataset(
        "samples", shape, dtype="<f8", chunks=(max(1, min(record.length, BLOCK // 4)), shape[1]) if record.length else None
    )
    samples.attrs["names"] = _texts(record.names)
    samples.attrs["units"] = _texts(channel.unit for channel in record.channels)
    samples.attrs["roles"] = _texts(channel.role.value for channel in record.channels)
    for start in range(0, record.length, BLOCK):
        stop = min(start + BLOCK, record.length)
        samples[start:stop] = record.samples.read(start, stop)


def _write_responses(file: Any, responses: Responses) -> None:
    file.attrs.update({"format": RESPONSES_FORM, "name": responses.name, "window": responses.window, "averages": responses.averages or 0})
    for side, channels in (("output", responses.outputs), ("input", responses.inputs)):
        file.attrs[f"{side}_names"] = _texts(channel.name for channel in channels)
        file.attrs[f"{side}_units"] = _texts(channel.unit for channel in channels)
    file["frequencies"] = responses.frequencies
    file["responses"] = responses.values
    if responses.coherence is not None:
        file["coherence"] = responses.coherence


def _texts(texts: Iterable[str]) -> Any:
    import h5py

    return np.array(list(texts), dtype=h5py.string_dtype())


HDF5 = Format((".h5", ".hdf5", ".hdf"), is_hdf, read_hdf, write_hdf)
"""HDF5 file: to the bit, of any size."""
