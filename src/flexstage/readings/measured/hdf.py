"""HDF5 files: their arrays, texts and attributes, read block by block; records and responses written."""

from __future__ import annotations

import os
from collections.abc import Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Array
from flexstage.readings.measured.hdf_sound import require_sound
from flexstage.readings.measured.hdf_written import hdf_written
from flexstage.readings.measured.record import Record, Responses
from flexstage.readings.measured.variables import OWN_FORM, Attribute, Contents, Variable, complex_of

RESPONSES_FORM = "flexstage responses 1"
BLOCK = 65_536
_COMPLEX_FIELDS = (("r", "i"), ("real", "imag"))
_NUMBERS = "fiub"


@dataclass(frozen=True, eq=False)
class Stored:
    """An array in an HDF5 file, or one `column` of a table; `turned` where the file keeps axes in the opposite order, as MAT files do."""

    path: Path
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
        chosen = [slice(None)] * len(self.shape)
        chosen[axis] = slice(start, stop)
        return self._read(tuple(reversed(chosen)) if self.turned else tuple(chosen))

    def _read(self, chosen: tuple[slice, ...]) -> Array:
        with opened(self.path) as file:
            found: Any = file[self.dataset or self.name]
            values = np.asarray(found[chosen])
        values = _as_complex(values[self.column]) if self.column else _as_complex(values)
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
    """What an HDF5 file holds; nothing is read but texts and attributes.

    Raises `DesignError` where it is none, breaks off, or would take the library down.

    An array has the attributes of its groups too, but for names, which belong to the group.

    >>> import h5py, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with h5py.File(Path(folder) / "a.h5", "w") as file:
    ...         file["test/u"] = [1.0, 2.0]
    ...         file["test"].attrs["fs"] = 50.0
    ...     [(each.name, dict(each.attributes)) for each in hdf_contents(Path(folder) / "a.h5").variables]
    [('test/u', {'fs': 50.0})]
    """
    require_sound(path)
    with opened(path) as file:
        own = attributes_of(file)
        variables: list[Variable] = []
        texts = {name: (value,) for name, value in own.items() if isinstance(value, str)}
        texts |= {name: value for name, value in own.items() if isinstance(value, tuple)}
        for name, dataset in _datasets(file):
            if _is_text(dataset):
                texts[name] = _texts(dataset)
            else:
                variables += _variables(path, name, dataset, _inherited(file, name) | attributes_of(dataset))
        return Contents(str(path), tuple(variables), texts, own)


@contextmanager
def opened(path: Path) -> Generator[Any]:
    """The file, open for reading. Raises `DesignError` where it is no HDF5 file, breaks off, or proves damaged while it is read.

    >>> import h5py, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     h5py.File(Path(folder) / "a.h5", "w").close()
    ...     with opened(Path(folder) / "a.h5") as file:
    ...         file.mode
    'r'
    """
    import h5py

    try:
        with h5py.File(path, "r") as file:
            yield file
    except DesignError:
        raise
    except Exception as error:  # noqa: BLE001 damaged files make the library stumble in ways of all kinds
        said = str(error)
        if "truncated file" in said:
            numbers = said.partition("truncated file: ")[2].rstrip(")") or said
            raise refuse(str(path), f"the file breaks off ({numbers})", "HDF5 cannot be read in part: copy or export it anew") from None
        raise refuse(
            str(path), f"it cannot be read as HDF5 ({said or type(error).__name__})", "Check the file, or export it anew"
        ) from None


def attributes_of(thing: Any) -> dict[str, Attribute]:
    """Attributes of a file, group or array as texts, floats and tuples of texts; others are left out.

    >>> class Thing:
    ...     attrs = {"fs": np.array([50]), "unit": b"um", "names": np.array([b"a", b"b"]), "matrix": np.eye(2)}
    >>> attributes_of(Thing())
    {'fs': 50.0, 'unit': 'um', 'names': ('a', 'b')}
    """
    found: dict[str, Attribute] = {}
    for name, value in thing.attrs.items():
        plain = _plain(value)
        if plain is not None:
            found[str(name)] = plain
    return found


def _plain(value: Any) -> Attribute | None:
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, str):
        return value
    array = np.asarray(value)
    if array.dtype.kind in "OSU":
        listed = tuple(each.decode("utf-8", "replace") if isinstance(each, bytes) else str(each) for each in array.ravel().tolist())
        return listed if array.ndim else listed[0]
    if array.dtype.kind in _NUMBERS and array.size == 1:
        return float(array.ravel()[0])
    return None


def _datasets(file: Any) -> Iterator[tuple[str, Any]]:
    """Arrays of a file by their paths, in the order of the file."""
    import h5py

    found: list[tuple[str, Any]] = []
    file.visititems(lambda name, thing: found.append((name, thing)) if isinstance(thing, h5py.Dataset) else None)
    if any(isinstance(name, bytes) for name, _ in found):
        raise ValueError("a name in it is no text")
    return iter(found)


def _inherited(file: Any, name: str) -> dict[str, Attribute]:
    parts = name.split("/")[:-1]
    found: dict[str, Attribute] = {}
    for depth in range(1, len(parts) + 1):
        group = file["/".join(parts[:depth])]
        alone = len(group) == 1
        found |= {key: value for key, value in attributes_of(group).items() if alone or "name" not in key.lower()}
    return found


def _is_text(dataset: Any) -> bool:
    return dataset.dtype.kind in "OSU"


def _texts(dataset: Any) -> tuple[str, ...]:
    plain = _plain(dataset[()]) if dataset.shape is not None else ()
    return (plain,) if isinstance(plain, str) else plain if isinstance(plain, tuple) else ()


def _variables(path: Path, name: str, dataset: Any, attributes: dict[str, Attribute]) -> list[Variable]:
    """The array; of a table its columns; nothing for what has no numbers."""
    kind = dataset.dtype
    if dataset.shape is None:
        return []
    if kind.names and tuple(kind.names) not in _COMPLEX_FIELDS:
        columns = [column for column in kind.names if kind[column].kind in _NUMBERS and kind[column].shape == ()]
        return [
            Stored(path, f"{name}/{column}", dataset.shape, is_complex=False, attributes=attributes, dataset=name, column=column)
            for column in columns
        ]
    is_complex = kind.kind == "c" or bool(kind.names)
    return [Stored(path, name, dataset.shape, is_complex, attributes)] if is_complex or kind.kind in _NUMBERS else []


def _as_complex(values: Array) -> Array:
    names = values.dtype.names
    return complex_of(values[names[0]], values[names[1]]) if names in _COMPLEX_FIELDS else values


def write_hdf(path: str | os.PathLike[str], what: Record | Responses) -> None:
    """Write an HDF5 file: the array `samples` (n, channels), or `frequencies` and `responses` (f, outputs, inputs) with `coherence`.

    Names, units and roles stand in attributes. Numbers come back to the bit; a record is written block by block. Raises `DesignError`
    where the file cannot be written.

    >>> import h5py, tempfile
    >>> from flexstage.readings.measured.record import Channel, in_memory
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
