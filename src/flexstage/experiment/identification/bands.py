"""Frequency bands of the pole search and of the joint fits of modes."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array

_RATIO, _SHARED = 3.0, 1.3
TOGETHER, _REACH = 12.0, 24.0
_MOST = 12


@dataclass(frozen=True)
class Extent:
    """Frequency band of a fit: its limits `low` and `high` in Hz, and the indices of the candidate modes in it."""

    low: float
    high: float
    members: tuple[int, ...]


@dataclass(frozen=True)
class Sweep:
    """Band of one pole search, `low` to `high` in Hz; only poles from `first` to `last` in Hz are kept."""

    low: float
    high: float
    first: float
    last: float


def sweeps(low: float, high: float) -> list[Sweep]:
    """Divide `low` to `high` in Hz into slightly overlapping bands; the upper end of a band is at most three times its lower end.

    >>> [(round(band.low), round(band.first), round(band.last), round(band.high)) for band in sweeps(10.0, 200.0)]
    [(10, 10, 27, 31), (24, 27, 74, 84), (65, 74, 200, 200)]
    """
    count = max(1, int(np.ceil(np.log(high / low) / np.log(_RATIO))))
    limits = np.geomspace(low, high, count + 1)
    half = np.sqrt(_SHARED)
    return [Sweep(max(low, a / half), min(high, b * half), float(a), float(b)) for a, b in itertools.pairwise(limits)]


def extents(poles: Array, low: float, high: float, *, resolution: Array | float = 0.0, together: float = TOGETHER) -> list[Extent]:
    """Divide ascending poles (k,) in Hz into bands for joint fits.

    Two successive poles share a band if they are closer than `together` times the sum of their half-widths. A half-width is -Re(pole), or
    the lines' `resolution` in Hz if this is larger. A band extends 24 half-widths beyond its outer poles, within `low` and `high`. A band
    ends before the next group of poles, at a limit that divides the gap in proportion to the half-widths.

    >>> found = extents(np.array([-1 + 100j, -1 + 101j, -1 + 200j]), 1.0, 300.0)
    >>> [(round(band.low), round(band.high), band.members) for band in found]
    [(76, 125, (0, 1)), (176, 224, (2,))]
    """
    poles = np.minimum(np.real(poles), -resolution) + 1j * np.imag(poles)
    frequencies, widths = np.imag(poles), -np.real(poles)
    groups: list[list[int]] = []
    for index in range(len(poles)):
        if groups and frequencies[index] - frequencies[index - 1] < together * (widths[index] + widths[index - 1]):
            groups[-1].append(index)
        else:
            groups.append([index])
    groups = [part for group in groups for part in _divide(group, frequencies)]
    return [_extent(poles, group, low, high) for group in groups]


def _divide(group: list[int], frequencies: Array) -> list[list[int]]:
    """Split a group of too many modes for one fit at its widest gaps."""
    if len(group) <= _MOST:
        return [group]
    cut = 1 + int(np.argmax(np.diff(frequencies[group])))
    return _divide(group[:cut], frequencies) + _divide(group[cut:], frequencies)


def _extent(poles: Array, group: list[int], low: float, high: float) -> Extent:
    frequencies, widths = np.imag(poles), -np.real(poles)
    bottom = min(frequencies[index] - _REACH * widths[index] for index in group)
    top = max(frequencies[index] + _REACH * widths[index] for index in group)
    first, last = group[0], group[-1]
    if first > 0:
        bottom = max(bottom, _divide_gap(frequencies, widths, first - 1))
    if last + 1 < len(poles):
        top = min(top, _divide_gap(frequencies, widths, last))
    return Extent(max(low, bottom), min(high, top), tuple(group))


def _divide_gap(frequencies: Array, widths: Array, index: int) -> float:
    gap = frequencies[index + 1] - frequencies[index]
    return float(frequencies[index] + gap * widths[index] / (widths[index] + widths[index + 1]))
