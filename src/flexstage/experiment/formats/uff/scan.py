"""Index of a universal file: its functions, with the positions of binary values or with the ASCII values."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.number import Array
from flexstage.experiment.formats.uff.function import HEAD_LINES, Function, parse_head
from flexstage.experiment.formats.uff.values import Layout, binary_values
from flexstage.experiment.records.record import InMemory, Samples

_END = re.compile(rb"[ ]*\r?\n?[ ]{4}-1[ ]*(\r?\n|$)")
_SLACK = 96


@dataclass(frozen=True, eq=False)
class DataSet:
    """One function of a file: its header, its values as samples of one to three columns, and its line number in the file.

    `problem` describes the missing part of a truncated function.
    """

    function: Function
    values: Samples
    line: int
    problem: str | None = None


def scan(path: Path) -> tuple[list[DataSet], list[Finding]]:
    r"""Scan the functions of a file in order, with errors for unreadable functions; other data sets are skipped.

    Binary values stay in the file; ASCII values are read at once. A truncated function contains its available values and a description of
    the missing part.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "empty.uff"
    ...     _ = path.write_text("    -1\n   151\nmodel\n    -1\n")
    ...     scan(path)
    ([], [])
    """
    found: list[DataSet] = []
    findings: list[Finding] = []
    with path.open("rb") as stream:
        for line, start in _starts(stream):
            try:
                found.append(_read(path, stream, line, start))
            except ValueError as error:
                where = f"{path}:{line}: function {len(found) + len(findings) + 1}"
                findings.append(Finding(where, str(error), "Export the file again"))
                _skip(stream)
    return found, findings


def decode(raw: bytes) -> str:
    r"""Decode header text: UTF-8, else Latin-1, which is common on instruments.

    >>> decode("m/s²".encode()), decode(b"m/s\xb2")
    ('m/s²', 'm/s²')
    """
    try:
        return raw.decode("utf-8")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _starts(stream: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """Line number of every function's first record and its opening line, with the stream behind it."""
    line = 0
    while raw := stream.readline():
        line += 1
        if raw.strip() != b"-1":
            continue
        opening = stream.readline()
        line += 1
        if opening[:6].strip() == b"58":
            yield line, opening
        elif opening.strip() == b"-1":
            stream.seek(-len(opening), 1)
        else:
            _skip(stream)


def _skip(stream: BinaryIO) -> None:
    while raw := stream.readline():
        if raw.strip() == b"-1":
            return


def _read(path: Path, stream: BinaryIO, line: int, opening: bytes) -> DataSet:
    begin = stream.tell()
    lines = [stream.readline() for _ in range(HEAD_LINES)]
    if not all(raw.endswith(b"\n") for raw in lines):
        raise ValueError("the file ends within its header")
    try:
        function = parse_head([decode(raw).rstrip("\r\n") for raw in lines])
    except ValueError:
        stream.seek(begin)
        raise
    if opening[6:7].lower() == b"b":
        return _read_binary(path, stream, line, (function, opening))
    return _read_printed(stream, line, function)


def _read_binary(path: Path, stream: BinaryIO, line: int, head: tuple[Function, bytes]) -> DataSet:
    function, opening = head
    words = opening[7:].split()
    if len(words) < 2:
        raise ValueError("its first line is truncated")
    order, form = (int(word) for word in words[:2])
    if form != 2:
        raise ValueError(f"unsupported number format (got {form}, expected 2: IEEE; 1 is VAX, 3 is IBM)")
    start = stream.tell()
    layouts = [Layout.of(function, short_axis=short) for short in (False, True)]
    layout = next((each for each in layouts if _closes(stream, start + each.size * function.count)), None)
    if layout is not None:
        stream.seek(start + layout.size * function.count)
        _skip(stream)
        return DataSet(function, binary_values(path, start, function.count, layout, big=order == 2), line)
    return _read_part(path, stream, line, function, (start, layouts[0], order == 2))


def _closes(stream: BinaryIO, position: int) -> bool:
    """Whether the end mark of a data set, or the end of the file, is at this position."""
    stream.seek(0, 2)
    if position > stream.tell():
        return False
    stream.seek(position)
    rest = stream.read(_SLACK)
    return not rest.strip() or _END.match(rest) is not None


def _read_part(path: Path, stream: BinaryIO, line: int, function: Function, data: tuple[int, Layout, bool]) -> DataSet:
    """Available part of a function without its announced end."""
    start, layout, big = data
    end = _next_mark(stream, start)
    count = max(0, min(function.count, (end - start) // layout.size))
    stream.seek(end)
    needed = f"{function.count * layout.size} bytes for {function.count} values"
    problem = f"{end - start} bytes of values (expected {needed} by its header)"
    if count == function.count:
        raise ValueError(f"it has {problem}: the file was altered, probably by a transfer as text")
    _skip(stream)
    return DataSet(function, binary_values(path, start, count, layout, big=big), line, f"it is truncated: it has {problem}")


def _next_mark(stream: BinaryIO, start: int) -> int:
    """Position of the next mark; the file's end without one."""
    stream.seek(start)
    position, tail = start, b""
    while block := stream.read(1 << 20):
        found = re.search(rb"[ ]{4}-1[ ]*\r?\n|[ ]{4}-1$", tail + block)
        if found:
            return position - len(tail) + found.start()
        position += len(block)
        tail = (tail + block)[-_SLACK:]
    return position


def _read_printed(stream: BinaryIO, line: int, function: Function) -> DataSet:
    """Values of any spacing, up to the mark, without an incomplete last value."""
    layout, chunks = Layout.of(function), [np.zeros(0)]
    while (raw := stream.readline()) and raw.strip() != b"-1":
        chunks.append(_numbers(raw if raw.endswith(b"\n") else re.sub(rb"\S+\s*$", b"", raw), layout))
    numbers = np.concatenate(chunks)
    count = min(function.count, len(numbers) // layout.columns)
    if np.any(numbers[function.count * layout.columns :]):  # zeros may fill the last line
        raise ValueError(f"it has {len(numbers) // layout.columns} values (expected {function.count} by its header)")
    problem = f"it is truncated: it has {count} values (expected {function.count} by its header)" if count < function.count else None
    return DataSet(function, InMemory(numbers[: count * layout.columns].reshape(count, layout.columns)), line, problem)


def _numbers(raw: bytes, layout: Layout) -> Array:
    """Numbers of a line: its words, or its columns without separators."""
    text = raw.decode("latin-1").rstrip()
    words = text.split()
    if any(re.search(r"\d[-+]\d", word) for word in words):
        words = [text[begin:end].strip() for begin, end in pairwise(np.cumsum([0, *layout.widths])) if text[begin:end].strip()]
    return np.array([_number(word) for word in words])


def _number(word: str) -> float:
    try:
        return float(word.lower().replace("d", "e"))
    except ValueError:
        raise ValueError(f'a value cannot be read: "{word[:40]}"') from None
