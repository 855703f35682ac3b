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
    frequencies, widths = np.imag(poles), np.maximum(-np.real(poles), resolution)
    gaps, both = np.diff(frequencies), widths[1:] + widths[:-1]
    limits = np.array([low, *(frequencies[:-1] + gaps * widths[:-1] / both), high])
    bottom, top = frequencies - _REACH * widths, frequencies + _REACH * widths
    return [
        Extent(
            float(max(low, limits[group[0]], np.min(bottom[group]))),
            float(min(high, limits[group[-1] + 1], np.max(top[group]))),
            tuple(group.tolist()),
        )
        for whole in np.split(np.arange(len(poles)), 1 + np.flatnonzero(gaps >= together * both))
        for group in _divide(whole, frequencies)
    ]


def _divide(group: Array, frequencies: Array) -> list[Array]:
    """Split a group of too many modes for one fit at its widest gaps."""
    if len(group) <= _MOST:
        return [group]
    cut = 1 + int(np.argmax(np.diff(frequencies[group])))
    return _divide(group[:cut], frequencies) + _divide(group[cut:], frequencies)
