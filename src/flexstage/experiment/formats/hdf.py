"""HDF5 files: their arrays, texts and attributes, read block by block; records and responses written."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.files import Attribute, Hdf, HdfArray, hdf
from flexstage.base.finding import Finding, require
from flexstage.base.number import Array
from flexstage.experiment.formats.hdf_written import hdf_written
from flexstage.experiment.formats.variables import OWN_FORM, Contents, Variable
from flexstage.experiment.record import Record, Responses

RESPONSES_FORM = "flexstage responses 1"
BLOCK = 65_536
_UNWRITTEN, _HARMLESS = 2000, 16_000_000
"""How many times more numbers an array may have than the file holds (zeros are pressed a thousandfold), and bytes that do no harm."""
NUMBERS = frozenset("fiub")
"""Kinds of real numbers, as numpy calls them."""


@dataclass(frozen=True, eq=False)
class Stored:
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

    def samples(self, axis: int) -> StoredSamples:
        """The array as samples along an axis, left in the file."""
        return StoredSamples(self, axis)

    def part(self, axis: int, start: int, stop: int) -> Array:
        """The array from `start` to `stop` of an axis, the latter excluded."""
        chosen = [(0, length) for length in self.shape]
        chosen[axis] = (start, stop)
        return self._read(tuple(reversed(chosen)) if self.turned else tuple(chosen))

    def _read(self, spans: tuple[tuple[int, int], ...]) -> Array:
        values = self.file.read(self.dataset or self.name, spans, self.column)
        return values.T if self.turned else values


@dataclass(frozen=True, eq=False)
class StoredSamples:
    """Samples along an axis of an array in an HDF5 file."""

    array: Stored
    axis: int

    @property
    def length(self) -> int:
        """Number of samples of each channel."""
        return self.array.shape[self.axis]

    def read(self, start: int, stop: int) -> Array:
        """Samples `start` to `stop`, the latter excluded, as floats (n, channels)."""
        values = np.moveaxis(self.array.part(self.axis, start, min(stop, self.length)), self.axis, 0)
        return values.reshape(len(values), int(np.prod(values.shape[1:]))).astype(float, copy=False)


def hdf_contents(path: Path) -> Contents:
    """What an HDF5 file holds; nothing is read but texts and attributes. Raises `DesignError` where it is none, breaks off or is damaged.

    An array has the attributes of its groups too, but for names, which belong to the group.

    >>> import h5py, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with h5py.File(Path(folder) / "a.h5", "w") as file:
    ...         file["test/u"] = [1.0, 2.0]
    ...         file["test"].attrs["fs"] = 50.0
    ...     [(each.name, dict(each.attributes)) for each in hdf_contents(Path(folder) / "a.h5").variables]
    [('test/u', {'fs': 50.0})]
    """
    file = recorded(path)
    own = file.attributes
    texts = {name: (value,) for name, value in own.items() if isinstance(value, str)}
    texts |= {name: value for name, value in own.items() if isinstance(value, tuple)}
    texts |= {each.name: each.texts for each in file.arrays.values() if each.kind == "t"}
    variables = [variable for each in file.arrays.values() for variable in _variables(file, each)]
    return Contents(str(path), tuple(variables), texts, own)


def recorded(path: Path) -> Hdf:
    """The HDF5 file; raises `DesignError` where its arrays are said to be far larger than what of them was written.

    >>> import h5py, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with h5py.File(Path(folder) / "a.h5", "w") as file:
    ...         found = file.create_dataset("u", 4_000_000_000, dtype="f4", chunks=(1000,))
    ...     recorded(Path(folder) / "a.h5")
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: ...a.h5: u: it is said to have 4e+09 numbers (16 GB), 0 bytes of which are in the file. ...
    """
    file = hdf(path)
    require(
        Finding(f"{path}: {each.name}", _unwritten(each), "They were never written, or pressed beyond belief: export it anew")
        for each in file.arrays.values()
        if math.prod(each.shape) * each.size > max(_HARMLESS, _UNWRITTEN * each.stored)
    )
    return file


def _unwritten(array: HdfArray) -> str:
    count = math.prod(array.shape)
    return f"it is said to have {count:.4g} numbers ({count * array.size / 1e9:.3g} GB), {array.stored} bytes of which are in the file"


def _inherited(file: Hdf, name: str) -> dict[str, Attribute]:
    """The attributes of an array's groups."""
    parts = name.split("/")[:-1]
    found: dict[str, Attribute] = {}
    for depth in range(1, len(parts) + 1):
        group = "/".join(parts[:depth])
        alone = sum(each.rpartition("/")[0] == group for each in (*file.groups, *file.arrays)) == 1
        found |= {key: value for key, value in file.groups[group].items() if alone or "name" not in key.lower()}
    return found


def _variables(file: Hdf, array: HdfArray) -> list[Variable]:
    """The array; of a table its columns; nothing for what has no numbers."""
    name, attributes = array.name, _inherited(file, array.name) | dict(array.attributes)
    if array.kind == "V":
        return [
            Stored(file, f"{name}/{column}", array.shape, is_complex=False, attributes=attributes, dataset=name, column=column)
            for column, kind in array.columns.items()
            if kind in NUMBERS
        ]
    return [Stored(file, name, array.shape, array.kind == "c", attributes)] if array.kind in (*NUMBERS, "c") else []


def write_hdf(path: str | os.PathLike[str], what: Record | Responses) -> None:
    """Write an HDF5 file: the array `samples` (n, channels), or `frequencies` and `responses` (f, outputs, inputs) with `coherence`.

    Names, units and roles stand in attributes. Numbers come back to the bit; a record is written block by block. Raises `DesignError`
    where the file cannot be written.

    >>> import h5py, tempfile
    >>> from flexstage.experiment.record import Channel, in_memory
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_hdf(Path(folder) / "a.h5", in_memory([Channel("S1", "um")], 3.0, np.array([[0.1], [0.2]])))
    ...     with h5py.File(Path(folder) / "a.h5") as file:
    ...         file["samples"][:, 0].tolist(), file["samples"].attrs["names"].tolist(), float(file.attrs["rate"])
    ([0.1, 0.2], ['S1'], 3.0)
    """
    with hdf_written(path, version="v110") as file:  # its metadata have check sums
        if isinstance(what, Record):
            _write_record(file, what)
        else:
            _write_responses(file, what)


def _write_record(file: Any, record: Record) -> None:
    file.attrs.update({"format": OWN_FORM, "rate": float(record.rate), "start": float(record.start), "name": record.name})
    shape = (record.length, len(record.channels))
    samples = file.create_dataset(
        "samples", shape, dtype="<f8", chunks=(max(1, min(record.length, BLOCK // 4)), shape[1]) if record.length else None
    )
    samples.attrs["names"] = _listed(record.names)
    samples.attrs["units"] = _listed(channel.unit for channel in record.channels)
    samples.attrs["roles"] = _listed(channel.role.value for channel in record.channels)
    for start in range(0, record.length, BLOCK):
        stop = min(start + BLOCK, record.length)
        samples[start:stop] = record.samples.read(start, stop)


def _write_responses(file: Any, responses: Responses) -> None:
    file.attrs.update({"format": RESPONSES_FORM, "name": responses.name, "window": responses.window, "averages": responses.averages or 0})
    for side, channels in (("output", responses.outputs), ("input", responses.inputs)):
        file.attrs[f"{side}_names"] = _listed(channel.name for channel in channels)
        file.attrs[f"{side}_units"] = _listed(channel.unit for channel in channels)
    file["frequencies"] = responses.frequencies
    file["responses"] = responses.values
    if responses.coherence is not None:
        file["coherence"] = responses.coherence


def _listed(texts: Iterator[str] | tuple[str, ...] | Any) -> Any:
    import h5py

    return np.array(list(texts), dtype=h5py.string_dtype())
