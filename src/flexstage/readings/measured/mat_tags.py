"""Tags of MAT files of version 5, followed before scipy reads them: an unknown type takes its reader and the whole process down.

The form is that of MathWorks' "MAT-File Format": elements of a tag (type, number of bytes) and data, matrices nested in them.
"""

from __future__ import annotations

import math
import mmap
import struct
from collections.abc import Iterator
from pathlib import Path

_HEAD = 128
_NAME, _DIMENSIONS, _MATRIX, _COMPRESSED = 1, 5, 14, 15
_BYTES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8, 14: 0, 15: 0, 16: 1, 17: 2, 18: 4}
"""Types of elements there are, and the bytes of one number or character."""
_CELL, _TEXT, _NUMBERS, _COMPLEX = 1, 4, range(6, 16), 0x800
_DEEPEST = 50


def tag_problem(path: Path) -> str | None:
    """What is wrong with the tags of a file of version 5; None if they can be followed to its end, and for files of version 4.

    Compressed elements are left to their check sums.

    >>> import scipy.io, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "a.mat"
    ...     scipy.io.savemat(path, {"u": [1.0, 2.0]})
    ...     whole = path.read_bytes()
    ...     sound = tag_problem(path)
    ...     _ = path.write_bytes(whole[:-4])
    ...     sound, tag_problem(path)
    (None, 'the element at byte 128 has 64 bytes, 60 are left')
    """
    with path.open("rb") as stream:
        if 0 in stream.read(4) or stream.seek(0, 2) <= _HEAD:
            return None
        with mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as whole:
            order = ">" if whole[126:128] == b"MI" else "<"
            try:
                _follow(whole, (_HEAD, len(whole)), order, 0)
            except ValueError as error:
                return str(error)
    return None


def _follow(whole: mmap.mmap, span: tuple[int, int], order: str, depth: int) -> None:
    for kind, begin, size in _elements(whole, span, order):
        if kind == _MATRIX and size:
            _check_matrix(whole, (begin, begin + size), order, depth)


def _elements(whole: mmap.mmap, span: tuple[int, int], order: str) -> Iterator[tuple[int, int, int]]:
    """Type, first byte and number of bytes of the elements that fill a span."""
    position, end = span
    while position < end:
        if end - position < 8:
            raise ValueError(f"{end - position} bytes at byte {position} are no element")
        kind, size = struct.unpack_from(f"{order}II", whole, position)
        small = kind >> 16
        begin = position + (4 if small else 8)
        kind, size = (kind & 0xFFFF, small) if small else (kind, size)
        if kind not in _BYTES or small > 4:
            raise ValueError(f"the element at byte {position} has the type {kind}, which there is not")
        if begin + size > end:
            raise ValueError(f"the element at byte {position} has {size} bytes, {max(0, end - begin)} are left")
        yield kind, begin, size
        position = position + 8 if small else begin + size + (0 if kind == _COMPRESSED else -size % 8)


def _check_matrix(whole: mmap.mmap, span: tuple[int, int], order: str, depth: int) -> None:
    """A matrix: flags, dimensions, name, then as many elements as its class has; those of cells and structures are matrices again."""
    parts = list(_elements(whole, span, order))
    where = f"the matrix at byte {span[0]}"
    if depth > _DEEPEST:
        raise ValueError(f"{where} is nested more than {_DEEPEST} deep")
    if not parts or parts[0][0::2] != (6, 8):
        raise ValueError(f"{where} does not begin with its flags")
    flags = struct.unpack_from(f"{order}I", whole, parts[0][1])[0]
    if flags & 0xFF in (_CELL, _TEXT, *_NUMBERS):
        if len(parts) < 3 or parts[1][0] != _DIMENSIONS or parts[1][2] < 8 or parts[1][2] % 4 or parts[2][0] != _NAME:
            raise ValueError(f"{where} has no dimensions or no name")
        size = math.prod(struct.unpack_from(f"{order}{parts[1][2] // 4}i", whole, parts[1][1]))
        _check_content(where, flags, size, parts[3:])
    for kind, begin, count in parts:
        if kind == _MATRIX and count:
            _check_matrix(whole, (begin, begin + count), order, depth + 1)


def _check_content(where: str, flags: int, size: int, parts: list[tuple[int, int, int]]) -> None:
    own = flags & 0xFF
    expected = size if own == _CELL else 2 if flags & _COMPLEX else 1
    if len(parts) != expected or any((kind == _MATRIX) != (own == _CELL) for kind, _, _ in parts):
        raise ValueError(f"{where} has {len(parts)} elements where {expected} are expected")
    if own in _NUMBERS and any(count != size * _BYTES[kind] for kind, _, count in parts):
        raise ValueError(f"{where} has not as many numbers as its dimensions say, {size}")
