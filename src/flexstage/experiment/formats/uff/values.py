"""Values of a function in a universal file; any range of values can be read."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.experiment.formats.uff.function import Function
from flexstage.experiment.records.record import ComputedSamples, Samples


@dataclass(frozen=True)
class Layout:
    """Layout of a function's values: number of columns (abscissa, real, imaginary), and bytes and printed width of each column."""

    columns: int
    bytes: tuple[int, ...]
    widths: tuple[int, ...]

    @property
    def size(self) -> int:
        """Bytes of one value in binary."""
        return sum(self.bytes)

    @staticmethod
    def of(function: Function, *, short_axis: bool = False) -> Layout:
        """Return the layout for a header; with `short_axis`, the abscissa has single precision even if the values are double.

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


def binary_values(path: Path, start: int, length: int, layout: Layout, *, big: bool) -> Samples:
    """Read values (n, columns) of a binary function from their position in the file."""
    kind = np.dtype([(str(number), f"{'>' if big else '<'}f{size}") for number, size in enumerate(layout.bytes)])

    def read(first: int, stop: int) -> Array:
        needed = max(0, min(stop, length) - first) * kind.itemsize
        with path.open("rb") as stream:
            stream.seek(start + first * kind.itemsize)
            raw = stream.read(needed)
        if len(raw) < needed:
            what = f"the file shrank during reading: {len(raw)} of {needed} bytes"
            raise refuse(str(path), what, "Read it after writing is complete")
        found = np.frombuffer(raw, kind)
        return np.stack([found[name].astype(float) for name in found.dtype.names or ()], axis=-1)

    return ComputedSamples(length, read)
