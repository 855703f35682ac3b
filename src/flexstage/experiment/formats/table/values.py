"""Numbers of a CSV file: any range of lines is read with an index of line positions."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.experiment.formats.table.layout import MISSING, NUMBER, Layout

STRIDE = 4096
_PIECE = 1 << 22
_LISTED = 60


def index_table(path: Path, layout: Layout) -> TableSamples:
    r"""Index the lines of a table, so that samples of all columns can be read; blank lines at the end are omitted.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "a.csv").write_text("1\n2\n3\n\n")
    ...     found = index_table(Path(folder) / "a.csv", Layout(("u",), ("V",), ",", ".", 0, 1, "utf-8", ()))
    ...     found.length, found.end, found.offsets.tolist(), found.read(1, 3).tolist()
    (3, 5, [0], [[2.0], [3.0]])
    """
    start, end = layout.start, _end(path, layout.start)
    offsets, count, position = [start] if end > start else [], 0, start
    with path.open("rb") as stream:
        stream.seek(start)
        while position < end and (piece := stream.read(min(_PIECE, end - position))):
            breaks = np.flatnonzero(np.frombuffer(piece, np.uint8) == ord("\n"))
            numbers = np.arange(count + 1, count + 1 + len(breaks))
            offsets += (position + breaks[numbers % STRIDE == 0] + 1).tolist()
            count, position = count + len(breaks), position + len(piece)
    columns = tuple(range(len(layout.names)))
    return TableSamples(path, layout, columns, count + (end > start), np.array(offsets, dtype=np.int64), end)


def _end(path: Path, start: int) -> int:
    """End of the last line that is not blank."""
    with path.open("rb") as stream:
        end = stream.seek(0, 2)
        while end > start:
            begin = max(start, end - STRIDE)
            stream.seek(begin)
            kept = len(stream.read(end - begin).rstrip())
            if kept:
                return begin + kept
            end = begin
    return start


@dataclass(frozen=True, eq=False)
class TableSamples:
    """Columns of a CSV file as samples (n, columns); a missing field is NaN.

    `offsets` are the byte offsets of every `STRIDE`th line; `end` is the byte offset of the end of the last line.
    """

    path: Path
    layout: Layout
    columns: tuple[int, ...]
    length: int
    offsets: Array
    end: int

    def read(self, start: int, stop: int) -> Array:
        """Read samples `start` to `stop` (excluded)."""
        stop = min(stop, self.length)
        if stop <= start:
            return np.zeros((0, len(self.columns)))
        first = start // STRIDE
        last = min(-(-stop // STRIDE), len(self.offsets))
        begin = int(self.offsets[first])
        end = int(self.offsets[last]) if last < len(self.offsets) else self.end
        with self.path.open("rb") as stream:
            stream.seek(begin)
            raw = stream.read(end - begin)
        texts = raw.decode(self.layout.encoding, "replace").split("\n")[start - first * STRIDE : stop - first * STRIDE]
        return self._numbers(texts, start)

    def _numbers(self, texts: list[str], start: int) -> Array:
        plain = [text.replace(",", ".") for text in texts] if self.layout.decimal == "," else texts
        source = io.StringIO("\n".join(plain), newline="\n")
        try:
            found = np.loadtxt(source, comments=None, delimiter=self.layout.delimiter, usecols=self.columns, ndmin=2, quotechar='"')
        except ValueError:
            found = np.zeros((0, 0))
        if found.shape == (len(texts), len(self.columns)) and all(map(self.layout.fits, texts)):
            return found
        return np.array([self._line(text, start + number) for number, text in enumerate(texts)]).reshape(-1, len(self.columns))

    def _line(self, text: str, number: int) -> list[float]:
        """One line, field by field; raises `DesignError` with its number if invalid."""
        fields, expected = self.layout.fields(text), len(self.layout.names)
        where = f"{self.path}:{self.layout.line + number}"
        if len(fields) != expected:
            what = f'wrong number of fields (got {len(fields)}, expected {expected}): "{text.strip()[:_LISTED]}"'
            raise refuse(where, what, "Correct the line, or remove it")
        return [self._field(fields[column], f"{where}: {self.layout.names[column]}") for column in self.columns]

    def _field(self, text: str, where: str) -> float:
        plain = text.replace(",", ".") if self.layout.decimal == "," else text
        if NUMBER.fullmatch(plain) and "," not in plain:
            return float(plain.lower().replace("d", "e"))
        if plain.lower() in MISSING:
            return float("nan")
        raise refuse(where, f'"{text[:_LISTED]}" is not a number', 'Use "nan" for a missing sample')
