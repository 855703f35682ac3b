"""Import of files of other programs; only regular files are read. HDF5 and MAT files are read in a separate process with limits.

The HDF5 and MAT libraries may crash, hang without an exception, or exhaust memory. They run in a worker process that reads many files. The
worker is replaced if it dies, hangs or is interrupted. If the operating system supports it, CPU time and memory are limited. HDF5 data in
external files are refused.
"""

from __future__ import annotations

import atexit
import contextlib
import math
import os
import signal
import stat
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import scipy

from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Array
from flexstage.base.processes.jobs import Line, limit_memory, limit_processor
from flexstage.base.processes.memory import gigabytes, require_memory
from flexstage.base.processes.pool import ProcessPool

Attribute: TypeAlias = str | float | tuple[str, ...]
PATIENCE = 8.0
"""CPU time limit of one request [s]; `_SLOW` per requested byte is added."""
MEMORY = 1_000_000_000
"""Memory limit of the worker in addition to requested data [B]."""
_SLOW = 1e-7
_COPIES = 3
_TEXTS = 100_000
_FULL = 4000
"""Largest number of rows of sparse arrays read as dense."""
_NUMBERS = "fiub"
_COMPLEX_FIELDS = (("r", "i"), ("real", "imag"))


def require_regular(path: Path) -> None:
    """Raise `DesignError` for a missing file, a folder, a device or a pipe, because reading a device or a pipe may never end.

    >>> require_regular(Path("/dev/null"))
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: /dev/null: not a regular file (got a device). Use a file, or save the data to a file.
    """
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        raise refuse(str(path), "file not found", "Check the path") from None
    except (OSError, ValueError) as error:
        raise refuse(str(path), f"it cannot be read ({_error_text(error)})", "Use a readable file") from None
    if stat.S_ISREG(mode):
        return
    kinds = {stat.S_ISDIR: "a folder", stat.S_ISFIFO: "a pipe", stat.S_ISSOCK: "a socket"}
    kind = next((name for test, name in kinds.items() if test(mode)), "a device")
    raise refuse(str(path), f"not a regular file (got {kind})", "Use a file, or save the data to a file")


@dataclass(frozen=True, eq=False)
class HdfArray:
    """Array of an HDF5 file: path, shape, and kind of numbers (numpy's letter, `t` for strings, `r` for references).

    `size` is the number of bytes per number. For a table, `columns` maps column names to kinds of numbers. `attributes`, `texts` and
    `references` (paths of referenced objects) are the other contents of the array.
    """

    name: str
    shape: tuple[int, ...]
    kind: str
    size: int
    columns: Mapping[str, str]
    attributes: Mapping[str, Attribute]
    texts: tuple[str, ...] = ()
    references: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Hdf:
    """Content of an HDF5 file: attributes of groups by path ("" is the file), and arrays by path, in file order."""

    path: Path
    groups: Mapping[str, Mapping[str, Attribute]]
    arrays: Mapping[str, HdfArray]

    @property
    def attributes(self) -> Mapping[str, Attribute]:
        """Attributes of the file."""
        return self.groups[""]

    def read(self, name: str, spans: Sequence[tuple[int, int]] = (), column: str = "") -> Array:
        """Read an array, a column of a table, or `spans` (start, stop) of its first axes. Pairs of numbers become complex numbers."""
        array = self.arrays[name]
        lengths = [max(0, min(stop, length) - max(start, 0)) for (start, stop), length in zip(spans, array.shape, strict=False)]
        needed = math.prod((*lengths, *array.shape[len(lengths) :])) * array.size
        require_memory(f"{self.path}: {name}", "its numbers", _COPIES * needed, _advise_less)
        return _ask(_one_array, self.path, needed, name, tuple(spans), column)

    def texts(self, name: str, column: str = "") -> tuple[str, ...]:
        """Read an array of strings, or a column of a table."""
        return tuple(_ask(_some_texts, self.path, self.path.stat().st_size, name, column))


def hdf(path: Path) -> Hdf:
    """Return the structure of an HDF5 file; `Hdf.read` reads the numbers.

    Raises `DesignError` for an invalid, truncated or damaged file, or for external data.

    >>> import h5py, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with h5py.File(Path(folder) / "a.h5", "w") as file:
    ...         file["test/u"] = [1.0, 2.0]
    ...         file["test"].attrs["fs"] = 50.0
    ...     result = hdf(Path(folder) / "a.h5")
    ...     dict(result.groups["test"]), result.read("test/u", [(1, 2)]).tolist()
    ({'fs': 50.0}, [2.0])
    """
    require_regular(path)
    return Hdf(path, *_ask(_look, path, path.stat().st_size))


@dataclass(frozen=True)
class MatlabObject:
    """Object of a MATLAB class in a MAT file; only MATLAB can read its content."""

    kind: str


def mat(path: Path) -> list[tuple[str, Array | tuple[str, ...] | MatlabObject]]:
    """Read (name, value) of all arrays, strings and objects of a MAT file of version 4 or 5; structures have paths (`test.u`).

    Raises `DesignError` for an unreadable file.

    >>> import scipy.io, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     scipy.io.savemat(Path(folder) / "a.mat", {"test": {"fs": 50.0}, "units": ["V"]})
    ...     mat(Path(folder) / "a.mat")
    [('test.fs', array([[50.]])), ('units', ('V',))]
    """
    require_regular(path)
    size = path.stat().st_size
    require_memory(str(path), "its numbers", _COPIES * size, _advise_less)
    return _ask(_mat, path, size)


def _advise_less(there: float) -> str:
    return f"Read less data, export the file in parts, or free memory: {gigabytes(there / _COPIES)} of numbers would fit"


@contextlib.contextmanager
def new_hdf(place: Path, size: int) -> Generator[Any]:
    """Open a new HDF5 file of at most `size` bytes. The space is allocated first, because the library crashes on a full disk.

    Raises `OSError` if the space is insufficient or the file cannot be written.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with new_hdf(Path(folder) / "a.h5", 1_000_000) as file:
    ...         file["x"] = [1.0, 2.0]
    ...     hdf(Path(folder) / "a.h5").read("x").tolist(), (Path(folder) / "a.h5").stat().st_size < 5000
    ([1.0, 2.0], True)
    """
    import h5py

    with h5py.File("empty", "w", driver="core", backing_store=False, libver="v110") as file:
        file.flush()
        image = file.id.get_file_image()
    with place.open("xb") as stream:
        stream.write(image)
        stream.flush()
        if hasattr(os, "posix_fallocate"):
            os.posix_fallocate(stream.fileno(), 0, max(size, len(image)))
    file = h5py.File(place, "r+", libver="v110", locking=False)
    try:
        yield file
    finally:
        try:
            file.close()  # release unused space
        except RuntimeError as error:  # during the final write
            raise OSError(str(error)) from None


def _ask(read: Callable[..., Any], requested: Path, size: int, *arguments: Any) -> Any:
    """Answer of the worker about a file, at most `size` bytes of numbers; raises `DesignError` if unreadable."""
    path, seconds = str(requested), PATIENCE + _SLOW * size
    try:
        return POOL.call(partial(read, requested.absolute(), *arguments), path, seconds, MEMORY + _COPIES * size)
    except EOFError as error:
        raise refuse(path, f"it is damaged: {_how_it_ended(error.args[0], seconds)}", "Copy or export it again") from None


def _how_it_ended(code: int, seconds: float) -> str:
    """Reason of a failed request without an answer."""
    if -code == getattr(signal, "SIGXCPU", None):
        return f"reading it took more than {seconds:.3g} s of CPU time"
    return "the library that reads it crashed" + (f" (signal {-code})" if code < 0 else "")


# --- worker process ---


def _answer(_line: Line, read: partial[Any], shown: str, seconds: float, memory: float) -> Any:
    """Answer to a request about a file, which errors call `shown`: damaged files raise exceptions of all kinds."""
    limit_processor(seconds)
    limit_memory(memory)
    try:
        return read()
    except DesignError as error:  # at a place in the file
        raise DesignError(replace(each, where=f"{shown}: {each.where}") for each in error.findings) from None
    except MemoryError:
        raise refuse(shown, f"reading it takes more than {gigabytes(memory)} of memory", "Export the file again, or in parts") from None
    except Exception as error:  # noqa: BLE001
        raise refuse(shown, *_reason(error, read.args[0], is_mat=read.func is _mat)) from None


POOL = ProcessPool(_answer)
"""Pool with the only file worker of this process; starting it and importing its libraries takes half a second each."""
atexit.register(POOL.__exit__)


def _error_text(error: Exception) -> str:
    return " ".join(str(getattr(error, "strerror", None) or error or type(error).__name__).split())[:300]


def _reason(error: Exception, path: Path, *, is_mat: bool) -> tuple[str, str]:
    said = _error_text(error)
    if is_mat:
        size = path.stat().st_size
        advice = "The file is truncated or damaged: copy or save it again (MAT files of version 5 cannot be read in part)"
        return (f"it cannot be read as a MAT file ({said}); it has {size} bytes", advice)
    if "truncated file" in said:
        numbers = said.partition("truncated file: ")[2].rstrip(")") or said
        return (f"truncated file ({numbers})", "HDF5 files cannot be read in part: copy or export the file again")
    return (f"it cannot be read as HDF5 ({said})", "Check the file, or export it again")


_ELSEWHERE = "its data are in another file", "Copy all data into this file: other files are not read"


@contextlib.contextmanager
def _open(path: Path) -> Generator[Any]:
    import h5py

    with h5py.File(path, "r", locking=False) as file:
        yield file


def _look(path: Path) -> tuple[dict[str, dict[str, Attribute]], dict[str, HdfArray]]:
    """All groups and arrays of a file, without repetition."""
    with _open(path) as file:
        groups: dict[str, dict[str, Attribute]] = {}
        result: dict[str, HdfArray] = {}
        waiting, seen = [("", file)], set[Any]()
        while waiting:
            name, thing = waiting.pop()
            if thing.id in seen:
                continue
            seen.add(thing.id)
            if hasattr(thing, "external"):  # committed types have a dtype and no data
                if thing.shape is not None and (array := _array(file, name, thing)).kind:
                    result[name] = array
            elif hasattr(thing, "keys"):
                groups[name] = _attributes(thing)
                waiting += reversed([(f"{name}/{key}".lstrip("/"), each) for key, each in _members(name, thing)])
        return groups, result


def _members(name: str, group: Any) -> Iterator[tuple[str, Any]]:
    import h5py

    for key in group:
        if isinstance(key, bytes):
            raise ValueError("a name in the file is not a string")
        link = group.get(key, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            raise refuse(f"{name}/{key}".lstrip("/"), *_ELSEWHERE)
        if isinstance(link, h5py.HardLink):
            yield key, group[key]


def _array(file: Any, name: str, data: Any) -> HdfArray:
    """An array without its numbers. Refuses external data."""
    if data.external or data.is_virtual:
        raise refuse(name, *_ELSEWHERE)
    kind, columns = _kind(data)
    short = math.prod(data.shape) <= _TEXTS
    texts = tuple(_texts(data[()])) if kind == "t" and short else ()
    references = tuple((file[each].name or "").lstrip("/") for each in np.ravel(data[()].T) if each) if kind == "r" and short else ()
    return HdfArray(name, data.shape, kind, data.dtype.itemsize, columns, _attributes(data), texts, references)


def _kind(data: Any) -> tuple[str, dict[str, str]]:
    """Kind of an array ("" if unsupported), and kinds of the columns of a table."""
    import h5py

    kind = data.dtype
    if kind.names and tuple(kind.names) in _COMPLEX_FIELDS:
        return "c", {}
    if kind.names:
        return "V", {name: _text_kind(kind[name].kind) for name in kind.names if kind[name].shape == ()}
    if h5py.check_ref_dtype(kind) is h5py.Reference:
        return "r", {}
    return _text_kind(kind.kind), {}


def _text_kind(kind: str) -> str:
    return "t" if kind in "OSU" else kind if kind in _NUMBERS + "c" else ""


def _attributes(thing: Any) -> dict[str, Attribute]:
    plain = {str(name): _plain(thing.attrs[name]) for name in thing.attrs}
    return {name: value for name, value in plain.items() if value is not None}


def _plain(value: Any) -> Attribute | None:
    """A text, a number, or several texts; else None."""
    if isinstance(value, (bytes, str)):
        return _text(value)
    array = np.asarray(value)
    if array.dtype.kind in "OSU":
        listed = _texts(array)
        return tuple(listed) if array.ndim else listed[0]
    return float(array.ravel()[0]) if array.dtype.kind in _NUMBERS and array.size == 1 else None


def _texts(values: Any) -> list[str]:
    return [_text(each) for each in np.asarray(values).ravel().tolist()]


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _one_array(path: Path, name: str, spans: tuple[tuple[int, int], ...], column: str) -> Array:
    with _open(path) as file:
        values = file[name][tuple(slice(*span) for span in spans)]
    values = np.asarray(values[column] if column else values)
    names = values.dtype.names
    if names in _COMPLEX_FIELDS:
        whole = np.empty(values.shape, dtype=complex)
        np.real(whole)[...], np.imag(whole)[...] = values[names[0]], values[names[1]]  # exact: a sum would lose the sign of zeros
        values = whole
    return _numbers(values)


def _numbers(values: Array) -> Array:
    if values.dtype.kind not in _NUMBERS + "c":
        raise ValueError(f"numbers of kind {values.dtype}")
    return values


def _some_texts(path: Path, name: str, column: str) -> list[str]:
    with _open(path) as file:
        values = file[name][()]
    return _texts(values[column] if column else values)


def _mat(path: Path) -> list[tuple[str, Array | tuple[str, ...] | MatlabObject]]:
    content = scipy.io.loadmat(path, appendmat=False)
    flat = [each for name, value in content.items() if not name.startswith("__") for each in _flatten(name, value)]
    return [(name, value if isinstance(value, (tuple, MatlabObject)) else _numbers(value)) for name, value in flat]


def _opaque(name: str, value: Any) -> tuple[str, MatlabObject]:
    """An object by its name (stored within it for a variable), and its class."""
    inner, _, kind = (bytes(value.ravel()[0][key]).decode("latin-1") if key in value.dtype.names else "" for key in ("s0", "s1", "s2"))
    return inner if name == "None" and inner else name, MatlabObject(kind)


def _flatten(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Arrays, texts, lists of texts and objects by path in structures; sparse arrays as dense; others omitted."""
    sparse = scipy.sparse.issparse(value) and max(value.shape) <= _FULL
    array = value.toarray() if sparse else np.asarray(value)
    if isinstance(value, scipy.io.matlab.MatlabOpaque):
        yield _opaque(name, value)
    elif array.dtype.kind == "U":
        yield name, tuple(text.rstrip() for text in array.ravel().tolist()) or ("",)
    elif array.dtype.names and array.size == 1:
        for key in array.dtype.names:
            yield from _flatten(f"{name}.{key}", array.ravel()[0][key])
    elif array.dtype.kind == "O":
        yield from (_opaque(name, each) for each in array.ravel()[:1] if isinstance(each, scipy.io.matlab.MatlabOpaque))
        members = [np.asarray(each) for each in array.ravel()]
        if members and all(each.dtype.kind == "U" for each in members):
            yield name, tuple(str(each.ravel()[0]).rstrip() if each.size else "" for each in members)
    elif array.dtype.kind in "fiubc":
        yield name, array
