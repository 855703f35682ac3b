"""Files that others wrote: only regular ones; HDF5 and MAT files in a process of their own, with limits of processor time and memory.

The libraries that read these files can crash, run in circles beyond the reach of any exception, or take all memory. They run in a child,
this very module, which is asked by a line of JSON and answers by one, numbers behind it. A child serves many files; one that dies, hangs or
is interrupted is replaced. Limits are kept by the system, where it has them. Data that stand in other files are refused.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import math
import os
import signal
import stat
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias

import numpy as np
import scipy

from flexstage.base.child import command, environment
from flexstage.base.finding import refuse
from flexstage.base.memory import gigabytes, require_memory
from flexstage.base.number import Array

Attribute: TypeAlias = str | float | tuple[str, ...]
PATIENCE = 8.0
"""Processor time that one question about a file may take [s], and `_SLOW` more for every byte of what is asked."""
MEMORY = 1_000_000_000
"""What the child may take beside what is asked of it [B]."""
_SLOW = 1e-7
_COPIES = 3
_TEXTS = 100_000
_LENGTH = struct.Struct("<Q")
_NUMBERS = "fiub"
_COMPLEX_FIELDS = (("r", "i"), ("real", "imag"))


def require_regular(path: Path) -> None:
    """Raise `DesignError` where there is no file, or what is there is a folder, a device, a pipe: reading such may never end.

    >>> require_regular(Path("/dev/null"))
    Traceback (most recent call last):
    flexstage.base.finding.DesignError: /dev/null: it is a device, no regular file. Name a file, or save what it gives as one.
    """
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        raise refuse(str(path), "there is no such file", "Check the path") from None
    except (OSError, ValueError) as error:
        raise refuse(str(path), f"it cannot be read ({_said(error)})", "Name a file that can be read") from None
    if stat.S_ISREG(mode):
        return
    kinds = {stat.S_ISDIR: "a folder", stat.S_ISFIFO: "a pipe", stat.S_ISSOCK: "a socket"}
    kind = next((name for test, name in kinds.items() if test(mode)), "a device")
    raise refuse(str(path), f"it is {kind}, no regular file", "Name a file, or save what it gives as one")


@dataclass(frozen=True, eq=False)
class HdfArray:
    """An array of an HDF5 file: its path, its shape, the kind of its numbers (as numpy's, `t` for texts, `r` for references).

    `size` bytes has a number, `stored` have all of them in the file; `columns` are kinds by name where it is a table; `attributes` its own;
    `texts` what it says; `references` paths of what it refers to.
    """

    name: str
    shape: tuple[int, ...]
    kind: str
    size: int
    stored: int
    columns: Mapping[str, str]
    attributes: Mapping[str, Attribute]
    texts: tuple[str, ...] = ()
    references: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Hdf:
    """What an HDF5 file holds: attributes of groups by their paths ("" is the file), arrays by theirs, in the order of the file."""

    path: Path
    groups: Mapping[str, Mapping[str, Attribute]]
    arrays: Mapping[str, HdfArray]

    @property
    def attributes(self) -> Mapping[str, Attribute]:
        """The attributes of the file."""
        return self.groups[""]

    def read(self, name: str, spans: Sequence[tuple[int, int]] = (), column: str = "") -> Array:
        """An array or one column of a table, or what spans (start, stop) of its first axes hold; pairs of numbers as complex ones."""
        array = self.arrays[name]
        lengths = [max(0, min(stop, length) - max(start, 0)) for (start, stop), length in zip(spans, array.shape, strict=False)]
        needed = math.prod((*lengths, *array.shape[len(lengths) :])) * array.size
        require_memory(f"{self.path}: {name}", "its numbers", _COPIES * needed, _less)
        asked = {"task": "array", "path": str(self.path.absolute()), "name": name, "spans": list(map(list, spans)), "column": column}
        return _ask(self.path, asked, needed)[1][0]

    def texts(self, name: str, column: str = "") -> tuple[str, ...]:
        """An array of texts, or one column of a table."""
        asked = {"task": "texts", "path": str(self.path.absolute()), "name": name, "column": column}
        return tuple(map(str, _ask(self.path, asked, self.path.stat().st_size)[0]))


def hdf(path: Path) -> Hdf:
    """What an HDF5 file holds; no numbers are read. Raises `DesignError` where it is none, breaks off, is damaged or needs other files.

    >>> import h5py, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with h5py.File(Path(folder) / "a.h5", "w") as file:
    ...         file["test/u"] = [1.0, 2.0]
    ...         file["test"].attrs["fs"] = 50.0
    ...     found = hdf(Path(folder) / "a.h5")
    ...     dict(found.groups["test"]), found.read("test/u", [(1, 2)]).tolist()
    ({'fs': 50.0}, [2.0])
    """
    require_regular(path)
    told, _ = _ask(path, {"task": "look", "path": str(path.absolute())}, path.stat().st_size)
    groups = {name: _attributes(attributes) for name, attributes in told["groups"]}
    arrays = {each["name"]: _array(each) for each in told["arrays"]}
    return Hdf(path, groups, arrays)


def _array(told: dict[str, Any]) -> HdfArray:
    own = (told["name"], tuple(told["shape"]), told["kind"], told["size"], told["stored"], told["columns"])
    return HdfArray(*own, _attributes(told["attributes"]), tuple(told["texts"]), tuple(told["references"]))


def _attributes(told: Mapping[str, Any]) -> dict[str, Attribute]:
    return {name: tuple(value) if isinstance(value, list) else value for name, value in told.items()}


def mat(path: Path) -> list[tuple[str, Array | tuple[str, ...]]]:
    """Arrays and texts of a MAT file of version 4 or 5, those of structures by their paths (`test.u`). Raises `DesignError`.

    >>> import scipy.io, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     scipy.io.savemat(Path(folder) / "a.mat", {"test": {"fs": 50.0}, "units": ["V"]})
    ...     mat(Path(folder) / "a.mat")
    [('test.fs', array([[50.]])), ('units', ('V',))]
    """
    require_regular(path)
    size = path.stat().st_size
    require_memory(str(path), "its numbers", _COPIES * size, _less)
    told, arrays = _ask(path, {"task": "mat", "path": str(path.absolute())}, size)
    return [(name, tuple(value) if isinstance(value, list) else arrays[value]) for name, value in told]


def _less(there: float) -> str:
    return f"Read less of it, export it in parts, or free memory: {gigabytes(there / _COPIES)} of numbers would fit"


@contextlib.contextmanager
def new_hdf(place: Path, size: int) -> Generator[Any]:
    """An HDF5 file to fill, at most `size` bytes, whose room is taken first: on a full disk the library takes its process down.

    Raises `OSError` where there is no room, or where it cannot be written.

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
            file.close()  # room that is not used is given back
        except RuntimeError as error:  # of what was left to write
            raise OSError(str(error)) from None


# --- the child as the caller sees it ---


class Child:
    """A process that answers questions about files; started by the first one, and anew after one that ended it."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._owner = 0
        self._lock = threading.Lock()

    def ask(self, question: dict[str, Any]) -> tuple[dict[str, Any], list[Array]]:
        """The answer and its arrays; raises `EOFError` where the child ended over it, which is then replaced by the next question."""
        with self._lock:
            process = self._running()
            try:
                return _exchange(process, question)
            except EOFError:
                self.end(1.0)
                raise
            except BaseException:
                self.end()
                raise

    def code(self) -> int:
        """How the last process ended."""
        return self._process.returncode if self._process is not None else 0

    def _running(self) -> subprocess.Popen[bytes]:
        known = self._process
        if known is None or self._owner != os.getpid() or known.poll() is not None:
            words, pipe = command("flexstage.base.files"), subprocess.PIPE
            known = subprocess.Popen(words, env=environment(), stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL)
            self._process, self._owner = known, os.getpid()
        return known

    def end(self, patience: float = 0.0) -> None:
        """End the process, which may take some time to end by itself [s]."""
        process = self._process
        if process is not None and self._owner == os.getpid():
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(patience)
            process.kill()
            process.wait()
            for stream in _pipes(process):
                with contextlib.suppress(OSError):
                    stream.close()


CHILD = Child()
"""The one child of this process: starting it takes half a second, and so does its libraries' loading."""
atexit.register(CHILD.end)


def _pipes(process: subprocess.Popen[bytes]) -> tuple[Any, Any]:
    return process.stdin, process.stdout


def _exchange(process: subprocess.Popen[bytes], question: dict[str, Any]) -> tuple[dict[str, Any], list[Array]]:
    into, out = _pipes(process)
    try:
        into.write(json.dumps(question).encode() + b"\n")
        into.flush()
    except OSError:
        raise EOFError from None
    length = _LENGTH.unpack(_exactly(out, _LENGTH.size))[0]
    answer: dict[str, Any] = json.loads(_exactly(out, length))
    arrays = [np.empty(shape, np.dtype(kind)) for kind, shape in answer["arrays"]]
    for each in arrays:
        _into(out, each)
    return answer, arrays


def _exactly(stream: Any, size: int) -> bytes:
    found = stream.read(size)
    if len(found) < size:
        raise EOFError
    return found


def _bytes(array: Array) -> memoryview:
    plain: Any = np.ascontiguousarray(array).reshape(-1).view(np.uint8)
    return memoryview(plain)


def _into(stream: Any, array: Array) -> None:
    rest = _bytes(array)
    while rest:
        count = stream.readinto(rest)
        if not count:
            raise EOFError
        rest = rest[count:]


def _ask(path: Path, question: dict[str, Any], size: int) -> tuple[Any, list[Array]]:
    """What the child says about a file, at most `size` bytes of numbers; raises `DesignError` with what keeps it from being read."""
    seconds, memory = PATIENCE + _SLOW * size, MEMORY + _COPIES * size
    try:
        answer, arrays = CHILD.ask(question | {"seconds": seconds, "memory": memory})
    except (EOFError, ValueError, KeyError, TypeError):
        raise refuse(str(path), f"it is damaged: {_ended(CHILD.code(), seconds)}", "Copy or export it anew") from None
    if "wrong" in answer:
        where, what, advice = answer["wrong"]
        raise refuse(f"{path}: {where}" if where else str(path), what, advice)
    return answer["result"], arrays


def _ended(code: int, seconds: float) -> str:
    """How reading a file ended that gave no answer."""
    if -code == getattr(signal, "SIGXCPU", None):
        return f"reading it took more than {seconds:.3g} s of the processor"
    return "the library that reads it crashed" + (f" (signal {-code})" if code < 0 else "")


# --- the child itself ---


class _WrongError(Exception):
    """What is wrong: where in the file, what, and what to do."""


def serve(questions: BinaryIO, answers: BinaryIO) -> None:
    """Answer questions, one a line, until there are no more; a question that takes too long ends the process."""
    for line in questions:
        question = json.loads(line)
        _limit(question["seconds"], question["memory"])
        arrays: list[Array] = []
        try:
            answer: dict[str, Any] = {"result": _TASKS[question["task"]](question, arrays)}
        except Exception as error:  # noqa: BLE001 damaged files make the libraries stumble in ways of all kinds
            arrays, answer = [], {"wrong": _wrong(question, error)}
        _send(answers, answer, arrays)


def _limit(seconds: float, memory: int) -> None:
    """Let the system end this process beyond so much processor time, and refuse it more memory; nothing where it cannot."""
    with contextlib.suppress(ImportError):
        import resource

        limits = {resource.RLIMIT_CPU: math.ceil(time.process_time() + seconds), resource.RLIMIT_AS: memory}
        for kind, limit in limits.items():
            with contextlib.suppress(ValueError, OSError):  # the system knows the limit and does not keep it, or has a lower one
                resource.setrlimit(kind, (limit, resource.getrlimit(kind)[1]))


def _send(answers: BinaryIO, answer: dict[str, Any], arrays: list[Array]) -> None:
    text = json.dumps(answer | {"arrays": [[each.dtype.str, each.shape] for each in arrays]}).encode()
    answers.write(_LENGTH.pack(len(text)) + text)
    answers.writelines(map(_bytes, arrays))
    answers.flush()


def _said(error: Exception) -> str:
    return " ".join(str(getattr(error, "strerror", None) or error or type(error).__name__).split())[:300]


def _wrong(question: dict[str, Any], error: Exception) -> tuple[str, str, str]:
    if isinstance(error, _WrongError):
        return error.args[0], error.args[1], error.args[2]
    if isinstance(error, MemoryError):
        return "", f"reading it takes more than {gigabytes(question['memory'])} of memory", "Export it anew, or in parts"
    said = _said(error)
    if question["task"] == "mat":
        size = Path(question["path"]).stat().st_size
        advice = "It breaks off or is damaged: copy or save it anew (MAT files of version 5 cannot be read in part)"
        return "", f"it cannot be read as a MAT file ({said}); it has {size} bytes", advice
    if "truncated file" in said:
        numbers = said.partition("truncated file: ")[2].rstrip(")") or said
        return "", f"the file breaks off ({numbers})", "HDF5 cannot be read in part: copy or export it anew"
    return "", f"it cannot be read as HDF5 ({said})", "Check the file, or export it anew"


_ELSEWHERE = "its data stand in another file", "Only the file that is named is read: copy all data into it"


@contextlib.contextmanager
def _opened(question: dict[str, Any]) -> Generator[Any]:
    import h5py

    with h5py.File(question["path"], "r", locking=False) as file:
        yield file


def _look(question: dict[str, Any], _arrays: list[Array]) -> dict[str, Any]:
    """All groups and arrays of a file, each once."""
    with _opened(question) as file:
        groups: list[tuple[str, dict[str, Any]]] = []
        found: list[dict[str, Any]] = []
        waiting, seen = [("", file)], set[Any]()
        while waiting:
            name, thing = waiting.pop()
            if thing.id in seen:
                continue
            seen.add(thing.id)
            if hasattr(thing, "external"):  # committed types have a dtype and no data
                found.append(_told(file, name, thing))
            elif hasattr(thing, "keys"):
                groups.append((name, _plain_attributes(thing)))
                waiting += reversed([(f"{name}/{key}".lstrip("/"), each) for key, each in _members(name, thing)])
        return {"groups": groups, "arrays": [each for each in found if each["kind"]]}


def _members(name: str, group: Any) -> Iterator[tuple[str, Any]]:
    import h5py

    for key in group:
        if isinstance(key, bytes):
            raise ValueError("a name in it is no text")
        link = group.get(key, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            raise _WrongError(f"{name}/{key}".lstrip("/"), *_ELSEWHERE)
        if isinstance(link, h5py.HardLink):
            yield key, group[key]


def _told(file: Any, name: str, data: Any) -> dict[str, Any]:
    """An array: everything but its numbers. Raises where they stand in other files."""
    if data.external or data.is_virtual:
        raise _WrongError(name, *_ELSEWHERE)
    kind, columns = _kind(data)
    shape, size = data.shape or (), data.dtype.itemsize
    short = math.prod(shape) <= _TEXTS
    texts = _texts(data[()]) if kind == "t" and short else ()
    references = [(file[each].name or "").lstrip("/") for each in np.ravel(data[()].T) if each] if kind == "r" and short else ()
    own = {
        "name": name,
        "shape": shape,
        "kind": "" if data.shape is None else kind,
        "size": size,
        "stored": data.id.get_storage_size(),
        "columns": columns,
    }
    return own | {"attributes": _plain_attributes(data), "texts": texts, "references": references}


def _kind(data: Any) -> tuple[str, dict[str, str]]:
    """The kind of an array, "" for what is of none; kinds of the columns of a table."""
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


def _plain_attributes(thing: Any) -> dict[str, Any]:
    plain = {str(name): _plain(thing.attrs[name]) for name in thing.attrs}
    return {name: value for name, value in plain.items() if value is not None}


def _plain(value: Any) -> str | float | list[str] | None:
    """A text, a number, a list of texts; None for others."""
    if isinstance(value, (bytes, str)):
        return _text(value)
    array = np.asarray(value)
    if array.dtype.kind in "OSU":
        listed = _texts(array)
        return listed if array.ndim else listed[0]
    return float(array.ravel()[0]) if array.dtype.kind in _NUMBERS and array.size == 1 else None


def _texts(values: Any) -> list[str]:
    return [_text(each) for each in np.asarray(values).ravel().tolist()]


def _text(value: Any) -> str:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def _one_array(question: dict[str, Any], arrays: list[Array]) -> None:
    with _opened(question) as file:
        found = file[question["name"]]
        values = found[tuple(slice(*span) for span in question["spans"])]
    values = np.asarray(values[question["column"]] if question["column"] else values)
    names = values.dtype.names
    if names in _COMPLEX_FIELDS:
        whole = np.empty(values.shape, dtype=complex)
        np.real(whole)[...], np.imag(whole)[...] = values[names[0]], values[names[1]]  # to the bit: a sum would lose the sign of zeros
        values = whole
    arrays.append(_numbers(values))


def _numbers(values: Array) -> Array:
    if values.dtype.kind not in _NUMBERS + "c":
        raise ValueError(f"numbers of kind {values.dtype}")
    return values


def _some_texts(question: dict[str, Any], _arrays: list[Array]) -> list[str]:
    with _opened(question) as file:
        found = file[question["name"]]
        values = found[()]
    return _texts(values[question["column"]] if question["column"] else values)


def _mat(question: dict[str, Any], arrays: list[Array]) -> list[tuple[str, list[str] | int]]:
    content = scipy.io.loadmat(question["path"], appendmat=False)
    flat = [each for name, value in content.items() if not name.startswith("__") for each in _flat(name, value)]
    told: list[tuple[str, list[str] | int]] = []
    for name, value in flat:
        told.append((name, value if isinstance(value, list) else len(arrays)))
        arrays += [] if isinstance(value, list) else [_numbers(value)]
    return told


def _flat(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """Arrays, texts and lists of texts, those of a structure by their paths; nothing of what else there is."""
    array = np.asarray(value)
    if array.dtype.kind == "U":
        yield name, [text.rstrip() for text in array.ravel().tolist()] or [""]
    elif array.dtype.names and array.size == 1:
        for key in array.dtype.names:
            yield from _flat(f"{name}.{key}", array.ravel()[0][key])
    elif array.dtype.kind == "O":
        members = [np.asarray(each) for each in array.ravel()]
        if members and all(each.dtype.kind == "U" for each in members):
            yield name, [str(each.ravel()[0]).rstrip() if each.size else "" for each in members]
    elif array.dtype.kind in "fiubc":
        yield name, array


_TASKS = {"look": _look, "array": _one_array, "texts": _some_texts, "mat": _mat}


def main() -> None:
    """Serve on the standard streams; what libraries print goes nowhere, and an interrupt ends the process at once."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    answers = os.fdopen(os.dup(1), "wb")
    with open(os.devnull, "wb") as nowhere:  # noqa: PTH123
        os.dup2(nowhere.fileno(), 1)
    serve(sys.stdin.buffer, answers)


if __name__ == "__main__":
    main()
