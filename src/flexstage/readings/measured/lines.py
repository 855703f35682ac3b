"""Transform lines of whole records, and their sums over cells of frequency: all that a fit of modes needs to know of the data.

A record's block of N samples, transformed without a window, obeys Y(f) = H(f) U(f) + T(f) + V(f) line by line, where T, the block's
transient, has the poles of H (Pintelon & Schoukens, System Identification, 2nd ed., 2012, ch. 2): carried along as a response to one more
"input" that is 1 at every line, it leaves no leakage. Within a cell, narrow beside the distance to the nearest pole, H is a polynomial of
degree 4; sums of products of the lines with its powers are sufficient then.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.readings.measured.record import Record
from flexstage.readings.measured.spectra import Tell

DEGREE = 4
_FINENESS = 0.4
_BLOCK = 12_000_000


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines of one block: `frequencies` (k,) in Hz, `inputs` (k, m) and `outputs` (k, p); white noise has its variance per line."""

    frequencies: Array
    inputs: Array
    outputs: Array


@dataclass(frozen=True, eq=False)
class Cells:
    """Sums over cells of frequency: `low` and `high` (c,) in Hz, the block (c,) and number of lines (c,) of each.

    With Z = (P_a(x) U_i, P_a(x)) the Legendre polynomials a = 0..4 times inputs and transient: `own` (c, 5, m+1, 5, m+1) = Z^H Z,
    `cross` (c, 5, m+1, p) = Z^H Y, `power` (c, p) = diag Y^H Y.
    """

    low: Array
    high: Array
    block: Array
    count: Array
    own: Array
    cross: Array
    power: Array

    @property
    def middle(self) -> Array:
        """Middles of the cells (c,) in Hz."""
        return 0.5 * (self.low + self.high)

    @property
    def blocks(self) -> int:
        """Number of blocks, each with a transient of its own."""
        return int(np.max(self.block, initial=-1)) + 1


def record_lines(record: Record, tell: Tell | None = None) -> Iterator[Lines]:
    """Transforms of a record's blocks, as long as memory allows: Y(f_k) = N^-1/2 sum y_n exp(-2 pi j k n/N), the mean taken out.

    >>> from flexstage.readings.measured.record import Channel, Role, in_memory
    >>> both = in_memory([Channel("u", "V", Role.INPUT), Channel("y", "um", Role.OUTPUT)], 8.0, np.eye(8)[:, :2])
    >>> [lines] = record_lines(both)
    >>> lines.frequencies.tolist(), abs(lines.inputs[1, 0]).round(6).item()
    ([0.0, 1.0, 2.0, 3.0, 4.0], 0.353553)
    """
    inputs = [channel.name for channel in record.inputs]
    chosen = record.select([*inputs, *(channel.name for channel in record.outputs)])
    parts = -(-record.length * len(chosen.channels) // _BLOCK)
    size = record.length // parts
    for part in range(parts):
        block = chosen.samples.read(part * size, (part + 1) * size)
        lines = np.empty((size // 2 + 1, block.shape[1]), dtype=complex)
        for column in range(block.shape[1]):
            lines[:, column] = np.fft.rfft(block[:, column] - np.mean(block[:, column])) / np.sqrt(size)
        yield Lines(np.fft.rfftfreq(size, 1.0 / record.rate), lines[:, : len(inputs)], lines[:, len(inputs) :])
        if tell is not None:
            tell((part + 1) / parts)


def edges(poles: Array, low: float, high: float) -> Array:
    """Limits in Hz of cells between `low` and `high`, each about as wide as half the distance to the nearest of `poles` (in Hz, complex).

    >>> edges(np.array([-1.0 + 10j]), 9.0, 11.0).round(2).tolist()
    [9.0, 9.81, 10.39, 11.0]
    """
    found = [low]
    while found[-1] < high:
        away = float(np.min(np.abs(1j * found[-1] - poles)))
        found.append(found[-1] + 2.0 * _FINENESS / (1.0 + _FINENESS) * away)
    return low + (np.array(found) - low) * (high - low) / (found[-1] - low)


def gathered(blocks: Sequence[Lines] | Iterator[Lines], bounds: Sequence[Array]) -> list[Cells]:
    """Cells of every band, whose limits are `bounds` in Hz, gathered from the blocks one after the other.

    >>> lines = Lines(np.arange(8.0), np.ones((8, 1)), 2.0 * np.ones((8, 1)))
    >>> [cells] = gathered([lines], [np.array([2.0, 4.0, 6.0])])
    >>> cells.count.tolist(), cells.cross[:, 0, 0, 0].real.tolist()
    ([2, 2], [4.0, 4.0])
    """
    rows: list[list[tuple[Array, ...]]] = [[] for _ in bounds]
    for number, lines in enumerate(blocks):
        for band, limits in enumerate(bounds):
            rows[band] += _band_sums(lines, limits, number)
    return [Cells(*(np.stack(column) for column in zip(*band, strict=True))) for band in rows]


def _band_sums(lines: Lines, limits: Array, number: int) -> list[tuple[Array, ...]]:
    places = np.searchsorted(lines.frequencies, limits)
    found: list[tuple[Array, ...]] = []
    for low, high, start, stop in zip(limits[:-1], limits[1:], places[:-1], places[1:], strict=True):
        if stop == start:
            continue
        x = (2.0 * lines.frequencies[start:stop] - low - high) / (high - low)
        polynomials = np.polynomial.legendre.legvander(x, DEGREE)
        inputs = np.concatenate([lines.inputs[start:stop], np.ones((stop - start, 1))], axis=1)
        terms = (polynomials[:, :, None] * inputs[:, None, :]).reshape(stop - start, -1)
        outputs = lines.outputs[start:stop]
        shape = (DEGREE + 1, inputs.shape[1])
        own = (np.conj(terms.T) @ terms).reshape(*shape, *shape)
        cross = (np.conj(terms.T) @ outputs).reshape(*shape, -1)
        found.append((low, high, np.array(number), np.array(stop - start), own, cross, np.sum(np.abs(outputs) ** 2, axis=0)))
    return found


def expanded(values: Array) -> Array:
    """Legendre coefficients (..., 5) of functions known at the cells' `nodes` (..., 7).

    >>> expanded(nodes(np.array([1.0]), np.array([3.0]))).round(12).tolist()
    [[2.0, 1.0, 0.0, 0.0, 0.0]]
    """
    return values @ _PROJECTION


def nodes(low: Array, high: Array) -> Array:
    """Frequencies (c, 7) in Hz at which functions are taken in each cell (Gauss's).

    >>> nodes(np.array([1.0]), np.array([3.0]))[0, 3].item()
    2.0
    """
    return 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * _NODES


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(DEGREE + 3)
_PROJECTION = _WEIGHTS[:, None] * np.polynomial.legendre.legvander(_NODES, DEGREE) * (np.arange(DEGREE + 1) + 0.5)
