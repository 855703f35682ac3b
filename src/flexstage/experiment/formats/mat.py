"""MAT files: versions 4 and 5 as scipy reads them, version 7.3 block by block; records and responses written."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from flexstage.base.files import Attribute, Hdf, HdfArray, mat
from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.store import atomic_write
from flexstage.experiment.formats.hdf import BLOCK, NUMBERS, RESPONSES_FORM, Stored, recorded
from flexstage.experiment.formats.hdf_written import hdf_written
from flexstage.experiment.formats.variables import OWN_FORM, Contents, Held, Variable
from flexstage.experiment.record import Channel, Record, Responses

_LARGEST = 2**31 - 1
_HEAD = 512
_REFERENCES = "#refs#"


def is_version_73(start: bytes) -> bool:
    """Whether the first bytes are those of a MAT file of version 7.3, which is HDF5 behind a head of 512 bytes.

    >>> is_version_73(b"MATLAB 7.3 MAT-file, Platform: GLNXA64"), is_version_73(b"MATLAB 5.0 MAT-file")
    (True, False)
    """
    return start.startswith(b"MATLAB 7.3") or start[_HEAD : _HEAD + 8] == b"\x89HDF\r\n\x1a\n"


def mat_contents(path: Path) -> Contents:
    """What a MAT file holds: arrays and texts, structures flattened (`test.u`). Version 7.3 stays in the file, others are read at once.

    The text and numbers of a structure that has one array belong to that array (its name, its unit). Raises `DesignError` where the file
    is none or breaks off.

    >>> import scipy.io, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     scipy.io.savemat(Path(folder) / "a.mat", {"test": {"u": [1.0, 2.0], "fs": 50.0}, "units": ["V"]})
    ...     [(each.name, each.shape) for each in mat_contents(Path(folder) / "a.mat").variables]
    [('test.u', (1, 2)), ('test.fs', (1, 1))]
    """
    with path.open("rb") as stream:
        start = stream.read(_HEAD + 8)
    found = _version_73(path) if is_version_73(start) else _version_5(path)
    texts = {name: value for name, value in found if isinstance(value, tuple)}
    arrays = [(name, value) for name, value in found if not isinstance(value, tuple)]
    return Contents(str(path), tuple(_with_siblings(name, value, arrays, texts) for name, value in arrays), texts)


def _with_siblings(name: str, value: Variable, arrays: list[tuple[str, Variable]], texts: dict[str, tuple[str, ...]]) -> Variable:
    """The array with what stands beside it in its structure, if it is the only array there."""
    owner = name.rpartition(".")[0]
    beside = [each for each, array in arrays if each.rpartition(".")[0] == owner and np.prod(array.shape) > 1]
    if not owner or beside != [name]:
        return value
    words: dict[str, Attribute] = {
        each.rpartition(".")[2]: text[0] if len(text) == 1 else text for each, text in texts.items() if each.rpartition(".")[0] == owner
    }
    if isinstance(value, Held):
        return Held(name, value.values, words)
    return (
        Stored(value.file, name, value.shape, value.is_complex, words, value.dataset, turned=True) if isinstance(value, Stored) else value
    )


def _version_5(path: Path) -> list[tuple[str, Any]]:
    return [(name, value if isinstance(value, tuple) else Held(name, value)) for name, value in mat(path)]


def _version_73(path: Path) -> list[tuple[str, Any]]:
    file = recorded(path)
    outside = (array for name, array in file.arrays.items() if not name.startswith(f"{_REFERENCES}/"))
    return [each for array in outside for each in _node(file, array.name.replace("/", "."), array, (array.name,))]


def _node(file: Hdf, name: str, array: HdfArray, above: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
    """Arrays and texts of an array of a file of version 7.3; `name` is its path as MATLAB writes it, `above` what refers to it."""
    kind = array.attributes.get("MATLAB_class", "")
    if array.attributes.get("MATLAB_empty", 0):
        if kind == "char":
            yield name, ("",)
    elif kind == "char" and array.kind in NUMBERS:
        yield name, tuple("".join(map(_letter, line)).rstrip() for line in np.atleast_2d(file.read(array.name).T).tolist())
    elif array.kind == "r":
        yield from _referred(file, name, array, above)
    elif array.kind in (*NUMBERS, "c"):
        yield name, Stored(file, name, tuple(reversed(array.shape)), array.kind == "c", dataset=array.name, turned=True)


def _letter(code: float) -> str:
    """The character of a code, the sign of what is unknown for one that is none."""
    return chr(int(code)) if 0 <= code <= sys.maxunicode else "\ufffd"


def _referred(file: Hdf, name: str, array: HdfArray, above: tuple[str, ...]) -> Iterator[tuple[str, Any]]:
    """Members of a cell or of a structure's field, of a group all its arrays; texts alone are a list."""
    inner: list[tuple[str, Any]] = []
    for index, member in enumerate(array.references):
        if member in above:
            raise refuse(f"{file.path}: {array.name}", "a cell of it holds itself", "It is damaged: save it anew")
        for each in [member] if member in file.arrays else [each for each in file.arrays if each.startswith(f"{member}/")]:
            below = each[len(member) :].replace("/", ".")
            inner += _node(file, f"{name}({index + 1}){below}", file.arrays[each], (*above, each))
    if len(inner) == len(array.references) and all(isinstance(value, tuple) and len(value) == 1 for _, value in inner):
        yield name, tuple(value[0] for _, value in inner)
    else:
        yield from inner


def write_mat(path: str | os.PathLike[str], what: Record | Responses, *, version_73: bool = False) -> None:
    """Write a MAT file with `samples` (n, channels), `rate`, `start`, `names`, `units` and `roles`; or the like of responses.

    Version 5 holds two gigabytes and is made in memory; version 7.3 is written block by block. Numbers come back to the bit. Raises
    `DesignError` where a record is too large and where the file cannot be written.

    >>> import scipy.io, tempfile
    >>> from flexstage.experiment.record import in_memory
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_mat(Path(folder) / "a.mat", in_memory([Channel("S1", "um")], 3.0, np.array([[0.1], [0.2]])))
    ...     scipy.io.loadmat(Path(folder) / "a.mat")["samples"].tolist()
    [[0.1], [0.2]]
    """
    if version_73:
        _write_73(path, what)
        return
    size = 8 * what.length * len(what.channels) if isinstance(what, Record) else 16 * what.values.size
    if size > _LARGEST:
        raise refuse(
            os.fspath(path), f"the record has {size / 1e9:.3g} GB, MAT files of version 5 hold 2.1 GB", "Write version 7.3 or HDF5"
        )
    values = {name: _cells(value) if isinstance(value, tuple) else value for name, value in _fields(what)}
    if isinstance(what, Record):
        values["samples"] = what.values
    with atomic_write(path) as place, place.open("wb") as stream:
        scipy.io.savemat(stream, values, oned_as="column")
        stream.seek(0)  # scipy writes the time into the head: the same record is to be the same file
        stream.write(b"MATLAB 5.0 MAT-file, Platform: any".ljust(116))


def _fields(what: Record | Responses) -> Iterator[tuple[str, Any]]:
    """Names and values of a file's variables but for the samples."""
    if isinstance(what, Record):
        yield from {"format": OWN_FORM, "name": what.name, "rate": float(what.rate), "start": float(what.start)}.items()
        yield from _described("", what.channels)
        yield "roles", tuple(channel.role.value for channel in what.channels)
        return
    yield from {"format": RESPONSES_FORM, "name": what.name, "window": what.window, "averages": float(what.averages or 0)}.items()
    yield from _described("output_", what.outputs)
    yield from _described("input_", what.inputs)
    yield from {"frequencies": what.frequencies[:, None], "responses": what.values}.items()
    if what.coherence is not None:
        yield "coherence", what.coherence


def _described(side: str, channels: Iterable[Channel]) -> Iterator[tuple[str, tuple[str, ...]]]:
    known = tuple(channels)
    yield f"{side}names", tuple(channel.name for channel in known)
    yield f"{side}units", tuple(channel.unit for channel in known)


def _cells(texts: tuple[str, ...]) -> Array:
    cells = np.empty((1, len(texts)), dtype=object)
    cells[0, :] = texts
    return cells


def _write_73(path: str | os.PathLike[str], what: Record | Responses) -> None:
    head = b"MATLAB 7.3 MAT-file, Platform: any, HDF5 schema 1.00 .".ljust(116) + bytes(8) + b"\x00\x02IM"
    with hdf_written(path, head=head.ljust(_HEAD, b"\x00")) as file:
        for name, value in _fields(what):
            _put(file, name, value)
        if isinstance(what, Record):
            _put_samples(file, what)


def _put(file: Any, name: str, value: Any) -> Any:
    """One variable as MATLAB stores it: axes in the opposite order, texts as numbers of characters, cells as references."""
    if isinstance(value, tuple):
        return _put_cells(file, name, value)
    if isinstance(value, str):
        return _put_text(file, name, value)
    values = np.atleast_2d(np.asarray(value)).T
    if np.iscomplexobj(values):
        values = np.ascontiguousarray(values).view([("real", "<f8"), ("imag", "<f8")])
    found = file.create_dataset(name, data=values)
    found.attrs["MATLAB_class"] = np.bytes_("double")
    return found


def _put_text(file: Any, name: str, text: str) -> Any:
    codes = np.frombuffer(text.encode("utf-16-le"), "<u2")
    found = file.create_dataset(name, data=codes[:, None] if text else np.zeros(2, "<u8"))
    found.attrs["MATLAB_class"] = np.bytes_("char")
    if text:
        found.attrs["MATLAB_int_decode"] = np.int32(2)
    else:
        found.attrs["MATLAB_empty"] = np.uint8(1)
    return found


def _put_cells(file: Any, name: str, texts: tuple[str, ...]) -> Any:
    import h5py

    group = file.require_group(_REFERENCES)
    references = [_put_text(group, f"{name}_{number}", text).ref for number, text in enumerate(texts)]
    found = file.create_dataset(name, (len(texts), 1), dtype=h5py.ref_dtype)
    for number, reference in enumerate(references):
        found[number, 0] = reference
    found.attrs["MATLAB_class"] = np.bytes_("cell")
    return found


def _put_samples(file: Any, record: Record) -> None:
    shape = (len(record.channels), record.length)
    chunks = (shape[0], min(record.length, BLOCK // 4)) if record.length else None
    found = file.create_dataset("samples", shape, dtype="<f8", chunks=chunks)
    found.attrs["MATLAB_class"] = np.bytes_("double")
    for start in range(0, record.length, BLOCK):
        stop = min(start + BLOCK, record.length)
        found[:, start:stop] = record.samples.read(start, stop).T
