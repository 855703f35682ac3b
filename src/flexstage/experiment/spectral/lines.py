"""Transform lines of whole records, and their sums over frequency cells: sufficient statistics for a fit of modes.

A record's block of N samples, transformed without a window, satisfies Y(f) = H(f) U(f) + T(f) + V(f) at every line, with outputs Y,
responses H, inputs U and noise V. T is the block's transient. It has the poles of H (Pintelon & Schoukens, System Identification, 2nd ed.,
2012, ch. 2). T is fitted as the response to a further "input" that is 1 at every line, so that it causes no leakage. A cell is narrow
compared with the distance to the nearest pole. In a cell, a polynomial of degree 7 therefore represents H to six digits. Sums of products
of lines and polynomials are sufficient for the fit.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array
from flexstage.experiment.records.record import Record, names_of

DEGREE = 7
_FINENESS = 0.25
BLOCK = 12_000_000


@dataclass(frozen=True, eq=False)
class Lines:
    """Fourier transform of one block of a record at its `frequencies` (k,) in Hz: `drive` (k, n) and `outputs` (k, p).

    The transform is scaled so that white noise has the same mean square at every frequency as in the time domain. The columns of `drive`
    are the inputs and a transient; `columns` (n,) are their indices among the columns of all blocks.
    """

    frequencies: Array
    drive: Array
    outputs: Array
    columns: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class Cells:
    """Sums over frequency cells from `low` to `high` (c,) in Hz, with the block number (c,) and the `count` of lines (c,) of each cell.

    The columns of Z are the products P_a(x) U_i of a Legendre polynomial P_a, a = 0..7, and a drive U_i of the block; x increases from -1
    to 1 in the cell. Y are the outputs. The sums are `own` (c, 8, n, 8, n) = Z^H Z, `cross` (c, 8, n, p) = Z^H Y, and `power` (c, p, p) =
    Y^H Y. `width` is the number of drives of all blocks; `columns[block]` are the indices of the drives of one block.
    """

    low: Array
    high: Array
    block: Array
    count: Array
    own: Array
    cross: Array
    power: Array
    columns: tuple[tuple[int, ...], ...]

    @property
    def own_power(self) -> Array:
        """Power (c, p) of every output in every cell."""
        return auto_powers(self.power)

    @property
    def width(self) -> int:
        """Number of columns of all drives: the inputs, and the transients of all blocks."""
        return 1 + max(max(columns) for columns in self.columns)

    @property
    def middle(self) -> Array:
        """Midpoints of the cells (c,) in Hz."""
        return 0.5 * (self.low + self.high)

    def select_cells(self, chosen: Array) -> Cells:
        """Return a subset of the cells, by index."""
        names = ("low", "high", "block", "count", "own", "cross", "power")
        return replace(self, **{name: getattr(self, name)[chosen] for name in names})


def record_lines(record: Record, inputs: tuple[int, ...], first: int, least: int = 1) -> Iterator[Lines]:
    """Compute Fourier transforms of a record's blocks, Y(f_k) = N^-1/2 sum over n of y_n exp(-2 pi j k n/N).

    Here y_n are the N samples of a channel in a block, minus their mean. The record is divided into `least` blocks, or into more blocks if
    memory requires them. `inputs` are the column indices of the record's inputs in the drive. The transient of the first block has the
    column index `first`, the transient of the next block `first` + 1, and so on.

    >>> from flexstage.experiment.records.record import Channel, Role, in_memory
    >>> both = in_memory([Channel("u", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT)], 8.0, np.eye(8)[:, :2])
    >>> [lines] = record_lines(both, (0,), 1)
    >>> lines.frequencies.tolist(), abs(lines.drive[1, 0]).round(6).item()
    ([0.0, 1.0, 2.0, 3.0, 4.0], 0.353553)
    """
    chosen = record.select(names_of((*record.inputs, *record.outputs)))
    parts = block_count(record, least)
    size = record.length // parts
    for part in range(parts):
        block = chosen.samples.read(part * size, (part + 1) * size)
        drive = np.ones((size // 2 + 1, len(inputs) + 1), dtype=complex)
        outputs = np.empty((size // 2 + 1, block.shape[1] - len(inputs)), dtype=complex)
        for column, values in enumerate(block.T):
            place = (drive, column) if column < len(inputs) else (outputs, column - len(inputs))
            place[0][:, place[1]] = np.fft.rfft(values - np.mean(values)) / np.sqrt(size)
        yield Lines(np.fft.rfftfreq(size, 1.0 / record.rate), drive, outputs, (*inputs, first + part))


def auto_powers(matrices: Array) -> Array:
    """Return the real diagonals (f, n) of matrices (f, n, n) of powers and cross powers.

    >>> auto_powers(np.array([[[1.0 + 0j, 2j], [-2j, 4.0]]])).tolist()
    [[1.0, 4.0]]
    """
    return np.real(np.diagonal(matrices, axis1=1, axis2=2))


def in_band(frequencies: Array, band: tuple[float, float]) -> Array:
    """Return which of the `frequencies` lie within a band, limits included.

    >>> in_band(np.array([1.0, 2.0, 3.0]), (2.0, 3.0)).tolist()
    [False, True, True]
    """
    return (frequencies >= band[0]) & (frequencies <= band[1])


def block_count(record: Record, least: int = 1) -> int:
    """Compute the number of blocks for a record's transform: the larger of `least` and the number that memory requires.

    >>> from flexstage.experiment.records.record import Channel, in_memory
    >>> block_count(in_memory([Channel("y")], 8.0, np.ones((16, 1))))
    1
    """
    return max(least, -(-record.length * len(record.channels) // BLOCK))


def edges(poles: Array, low: float, high: float) -> Array:
    """Compute limits of cells [Hz] from `low` to `high`.

    The width of a cell is a fixed fraction of the distance between the cell and the nearest of the `poles` (complex, in Hz).

    >>> edges(np.array([-1.0 + 10j]), 9.0, 11.0).round(2).tolist()
    [9.0, 9.57, 10.0, 10.4, 10.83, 11.0]
    """
    found = [low]
    while found[-1] < high:
        away = float(np.min(np.abs(1j * found[-1] - poles)))
        found.append(found[-1] + 2.0 * _FINENESS / (1.0 + _FINENESS) * away)
    return np.array([*found[:-1], high])


def gather_cells(blocks: Iterable[Lines], bounds: Sequence[Array]) -> list[Cells]:
    """Sum the products of lines (see `Cells`) in the cells of every band, block by block; `bounds` are each band's cell limits in Hz.

    >>> lines = Lines(np.arange(8.0), np.ones((8, 1)), 2.0 * np.ones((8, 1)), (0,))
    >>> [cells] = gather_cells([lines], [np.array([2.0, 4.0, 6.0])])
    >>> cells.count.tolist(), cells.cross[:, 0, 0, 0].real.tolist()
    ([2, 2], [4.0, 4.0])
    """
    rows: list[list[tuple[Array, ...]]] = [[] for _ in bounds]
    columns: list[tuple[int, ...]] = []
    for number, lines in enumerate(blocks):
        columns.append(lines.columns)
        for band, limits in enumerate(bounds):
            rows[band] += _band_sums(lines, limits, number)
    return [Cells(*(np.stack(column) for column in zip(*band, strict=True)), columns=tuple(columns)) for band in rows]


def _band_sums(lines: Lines, limits: Array, number: int) -> list[tuple[Array, ...]]:
    places = np.searchsorted(lines.frequencies, limits)
    found: list[tuple[Array, ...]] = []
    for low, high, start, stop in zip(limits[:-1], limits[1:], places[:-1], places[1:], strict=True):
        if stop == start:
            continue
        x = (2.0 * lines.frequencies[start:stop] - low - high) / (high - low)
        polynomials = np.polynomial.legendre.legvander(x, DEGREE)
        terms = (polynomials[:, :, None] * lines.drive[start:stop, None, :]).reshape(stop - start, -1)
        outputs = lines.outputs[start:stop]
        shape = (DEGREE + 1, len(lines.columns))
        own = (np.conj(terms.T) @ terms).reshape(*shape, *shape)
        cross = (np.conj(terms.T) @ outputs).reshape(*shape, -1)
        found.append((low, high, np.array(number), np.array(stop - start), own, cross, np.conj(outputs.T) @ outputs))
    return found


def legendre_coefficients(values: Array) -> Array:
    """Compute Legendre coefficients (..., 8) of functions from their `values` (..., 10) at the cells' Gauss `nodes`.

    >>> (legendre_coefficients(nodes(np.array([1.0]), np.array([3.0]))).round(12) + 0.0).tolist()
    [[2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]]
    """
    return values @ _PROJECTION


def nodes(low: Array, high: Array) -> Array:
    """Compute the Gauss nodes (c, 10) in Hz of each cell.

    >>> nodes(np.array([1.0]), np.array([3.0])).mean().round(12).item()
    2.0
    """
    return 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * _NODES


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(DEGREE + 3)
_PROJECTION = _WEIGHTS[:, None] * np.polynomial.legendre.legvander(_NODES, DEGREE) * (np.arange(DEGREE + 1) + 0.5)
