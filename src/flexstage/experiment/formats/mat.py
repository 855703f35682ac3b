"""MAT files: versions 4 and 5 are read by scipy, version 7.3 block by block; records and responses are written in version 5."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import scipy

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.base.storage.files import Hdf, HdfArray, MatlabObject, hdf, mat
from flexstage.base.storage.store import atomic_write
from flexstage.experiment.formats.arrays import Contents, Variable, describe, held_array, read_arrays, response_arrays
from flexstage.experiment.formats.format import Format
from flexstage.experiment.formats.hdf import NUMBERS, is_hdf, stored_array
from flexstage.experiment.records.options import Options
from flexstage.experiment.records.record import Record, Responses

_LARGEST = 2**31 - 1
_HEAD = 512
_REFERENCES = "#refs#/"


def is_mat(start: bytes, suffix: str) -> bool:
    """Recognise MAT files: versions 5 and 7.3 by their signature, version 4 by its file ending.

    >>> is_mat(b"MATLAB 5.0 MAT-file", ".dat"), is_mat(b"time,u1", ".csv")
    (True, False)
    """
    return start.startswith(b"MATLAB") or is_hdf(start[_HEAD:], suffix) or (suffix == ".mat" and not is_hdf(start, suffix))


def read_mat(path: Path, options: Options) -> tuple[Record | Responses, ...]:
    """Read a MAT file as arrays by name. Members of structures have paths as names (`test.u`). Lists of strings are cell arrays.

    MATLAB objects (`timeseries`, `table`, `idfrd`) cannot be read outside MATLAB: the error lists them, with a hint on export. Arrays of
    version 7.3 stay in the file; arrays of older versions are read at once. Raises `DesignError` for an invalid or truncated file, and
    whenever `read_arrays` raises it.

    >>> import scipy.io, tempfile
    >>> from flexstage.experiment.records.options import Arrays
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     scipy.io.savemat(Path(folder) / "a.mat", {"test": {"u": [1.0, 2.0], "fs": 50.0}, "units": ["V"]})
    ...     (found,) = read_mat(Path(folder) / "a.mat", Options(arrays=Arrays(samples=("test.u",), rate=("test.fs",))))
    ...     found.channels[0], found.rate
    (Channel(name='u', unit='V', role=<Role.INPUT: 'input'>), 50.0)
    """
    with path.open("rb") as stream:
        start = stream.read(_HEAD + 8)
    found = list(_version_73(path) if start.startswith(b"MATLAB 7.3") or is_hdf(start[_HEAD:], "") else _version_5(path))
    said = {name: value for name, value in found if isinstance(value, tuple)}
    objects = {name: value.kind for name, value in found if isinstance(value, MatlabObject)}
    arrays = tuple(value for _, value in found if not isinstance(value, (tuple, MatlabObject)))
    return read_arrays(Contents(str(path), arrays, said, objects), options)


def _version_5(path: Path) -> Iterator[tuple[str, Variable | tuple[str, ...] | MatlabObject]]:
    for name, value in mat(path):
        yield name, value if isinstance(value, (tuple, MatlabObject)) else held_array(name, value)


def _version_73(path: Path) -> Iterator[tuple[str, Variable | tuple[str, ...] | MatlabObject]]:
    """Arrays and texts of MATLAB's HDF5 files: reversed axes, texts as numbers, cells as references."""
    file = hdf(path)
    for array in file.arrays.values():
        name = array.name.replace("/", ".")
        if array.name.startswith(_REFERENCES):
            continue
        if "MATLAB_object_decode" in array.attributes:
            yield name, MatlabObject(str(array.attributes.get("MATLAB_class", "")))
        elif array.kind == "r":
            yield name, tuple(" ".join(_characters(file, file.arrays[each])) for each in array.references if each in file.arrays)
        elif array.attributes.get("MATLAB_class") == "char":
            yield name, _characters(file, array)
        elif array.kind in (*NUMBERS, "c") and not array.attributes.get("MATLAB_empty", 0):
            yield name, stored_array(file, array, name=name, turned=True)


def _characters(file: Hdf, array: HdfArray) -> tuple[str, ...]:
    """Lines of a text; empty for an array of another type."""
    if array.attributes.get("MATLAB_class") != "char" or array.kind not in NUMBERS or array.attributes.get("MATLAB_empty", 0):
        return ("",)
    return tuple("".join(map(_letter, line)).rstrip() for line in np.atleast_2d(file.read(array.name).T).tolist())


def _letter(code: float) -> str:
    """Character of a code, or the replacement character."""
    return chr(int(code)) if 0 <= code <= sys.maxunicode else "\ufffd"


def write_mat(path: str | os.PathLike[str], what: Record | Responses) -> None:
    """Write a MAT file of version 5: a record's `samples` (n, channels), `rate`, `start`, `names`, `units`, `roles`; or responses.

    The file is assembled in memory and has at most two gigabytes. Numbers are written in full precision. Raises `DesignError` for a record
    above two gigabytes, and if the file cannot be written.

    >>> import scipy.io, tempfile
    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_mat(Path(folder) / "a.mat", in_memory([Channel("S1", "um")], 3.0, np.array([[0.1], [0.2]])))
    ...     scipy.io.loadmat(Path(folder) / "a.mat")["samples"].tolist()
    [[0.1], [0.2]]
    """
    size = 8 * what.length * len(what.channels) if isinstance(what, Record) else 16 * what.values.size
    if size > _LARGEST:
        too_large = f"too large for a MAT file of version 5 (got {size / 1e9:.3g} GB, expected at most 2.1 GB)"
        raise refuse(os.fspath(path), too_large, "Write HDF5 (.h5), which MATLAB reads by h5read")
    values = {name: _cells(value) if isinstance(value, tuple) else value for name, value in describe(what).items()}
    values |= {"samples": what.values} if isinstance(what, Record) else response_arrays(what)
    with atomic_write(path) as place, place.open("wb") as stream:
        scipy.io.savemat(stream, values, oned_as="column")
        stream.seek(0)  # scipy writes the time into the header; equal records must give equal files
        stream.write(b"MATLAB 5.0 MAT-file, Platform: any".ljust(116))


def _cells(texts: tuple[str, ...]) -> Array:
    cells = np.empty((1, len(texts)), dtype=object)
    cells[0, :] = texts
    return cells


MAT = Format((".mat",), is_mat, read_mat, write_mat)
"""MAT format, written as version 5: numbers keep all bits, up to 2 GB."""
