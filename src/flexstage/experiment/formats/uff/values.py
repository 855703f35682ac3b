"""Values of a function in a universal file, read in any range from where they lie."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.experiment.formats.uff.function import Function


@dataclass(frozen=True)
class Layout:
    """How the numbers of a function follow one another: columns a value (abscissa, real, imaginary), bytes and printed widths of each."""

    columns: int
    bytes: tuple[int, ...]
    widths: tuple[int, ...]

    @property
    def size(self) -> int:
        """Bytes of one value in binary."""
        return sum(self.bytes)

    @staticmethod
    def of(function: Function, *, short_axis: bool = False) -> Layout:
        """The layout a head asks for; with `short_axis` the abscissa of double values is of single precision.

        >>> Layout(1, (8,), (20,) * 4).size
        8
        """
        own = [8 if function.is_double else 4] * (2 if function.is_complex else 1)
        axis = [] if function.is_even else [4 if short_axis else own[0]]
        if not function.is_double:
            widths = (13,) * 6
        elif function.is_even:
            widths = (20,) * 4
        else:
            widths = (13, 20, 20) if function.is_complex else (13, 20, 13, 20)
        return Layout(len(axis) + len(own), (*axis, *own), widths)


@dataclass(frozen=True, eq=False)
class BinaryValues:
    """Values of a binary function: (n, columns) floats."""

    path: Path
    start: int
    length: int
    layout: Layout
    big: bool

    def read(self, start: int, stop: int) -> Array:
        """Values `start` to `stop`, the latter excluded."""
        count = max(0, min(stop, self.length) - start)
        order = ">" if self.big else "<"
        kind = np.dtype([(str(number), f"{order}f{size}") for number, size in enumerate(self.layout.bytes)])
        with self.path.open("rb") as stream:
            stream.seek(self.start + start * kind.itemsize)
            found = np.frombuffer(_exactly(stream.read(count * kind.itemsize), count * kind.itemsize, self.path), kind)
        return np.stack([found[name].astype(float) for name in found.dtype.names or ()], axis=-1)


@dataclass(frozen=True, eq=False)
class PrintedValues:
    """Values of an ASCII function whose lines are all equally long: (n, columns) floats."""

    path: Path
    start: int
    length: int
    layout: Layout
    line: int

    @property
    def end(self) -> int:
        """Where the last line's last number ends, and trailing blanks and the mark begin."""
        return self.start + self._offset(self.length * self.layout.columns)

    def fits(self, first: bytes) -> bool:
        """Whether the first line has the widths it should: numbers end where columns end."""
        text = first.rstrip(b"\r\n")
        edges = np.cumsum(self.layout.widths[: self.length * self.layout.columns])
        full = len(edges) == len(self.layout.widths)
        inside = all(edge <= len(text) and text[edge - 1 : edge].isdigit() for edge in edges)
        return inside and (not full or not text[edges[-1] :].strip())

    def _offset(self, number: int) -> int:
        """Where a number begins, counted from the start; at the end of a line rather than at the beginning of the next."""
        lines, rest = divmod(number, len(self.layout.widths))
        if number and not rest:
            return (lines - 1) * self.line + sum(self.layout.widths)
        return lines * self.line + sum(self.layout.widths[:rest])

    def read(self, start: int, stop: int) -> Array:
        """Values `start` to `stop`, the latter excluded."""
        columns, each = self.layout.columns, len(self.layout.widths)
        begin, end = start * columns, max(start, min(stop, self.length)) * columns
        if end == begin:
            return np.zeros((0, columns))
        first, last = begin // each, -(-end // each)
        size = min((last - first) * self.line, self.end - self.start - first * self.line)
        with self.path.open("rb") as stream:
            stream.seek(self.start + first * self.line)
            raw = _exactly(stream.read(size), size, self.path)
        numbers = self._parse(raw.ljust((last - first) * self.line), first)
        return numbers[begin - first * each : end - first * each].reshape(-1, columns)

    def _parse(self, raw: bytes, first: int) -> Array:
        """All numbers of whole lines; those that a short last line does not have are not a number."""
        widths = self.layout.widths
        fields = [(str(number), f"S{width}") for number, width in enumerate(widths)]
        kind = np.dtype([*fields, ("rest", f"S{self.line - sum(widths)}")])
        lines = np.frombuffer(raw.replace(b"D", b"E").replace(b"d", b"e"), kind)
        try:
            return np.stack([_floats(lines[name]) for name, _ in fields], axis=-1).ravel()
        except ValueError as error:
            raise refuse(
                str(self.path), f"a value near line {first + 1} of a function cannot be read: {error}", "Export the file anew"
            ) from None


def _floats(texts: Array) -> Array:
    """Numbers of one column; the last line may have none."""
    stripped = np.char.strip(texts)
    if len(stripped) and not stripped[-1]:
        return np.append(stripped[:-1].astype(float), np.nan)
    return stripped.astype(float)


def _exactly(raw: bytes, size: int, path: Path) -> bytes:
    if len(raw) < size:
        raise refuse(str(path), f"it became shorter while it was read: {len(raw)} of {size} bytes", "Read it when it is written to its end")
    return raw
