"""Random numbers by stream and block: reproducible for any block of any stream, in any order."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from flexstage.base.number import Array
from flexstage.base.stream import generator


class Stream(IntEnum):
    """Kind of noise source. Different kinds use different random numbers."""

    DRIVE = 0
    GAUGE = 1
    DRIFT = 2
    DRIFT_ENDS = 3


def white(seed: int, stream: Stream, channel: int, block: int, size: int) -> Array:
    """Generate white Gaussian noise (size,) of unit variance for a block of a channel's stream. The first block has the number -1.

    >>> first = white(7, Stream.DRIVE, 0, 0, 3)
    >>> bool(np.all(first == white(7, Stream.DRIVE, 0, 0, 3))), bool(np.any(first == white(7, Stream.DRIVE, 1, 0, 3)))
    (True, False)
    """
    return generator(seed, int(stream), channel, block + 1).standard_normal(size)


def walk(seed: int, channel: int, block: int, size: int) -> Array:
    """Generate a block (size,) of a random walk with steps of unit variance; successive blocks are continuous.

    The walk's values at the blocks' ends are drawn first, and each block is a Brownian bridge between them: blocks are independent.

    >>> steps = np.diff(np.concatenate([walk(7, 0, block, 1000) for block in range(4)]))
    >>> 0.9 < float(np.std(steps)) < 1.1, bool(np.max(np.abs(steps)) < 5.0)
    (True, True)
    """
    ends = np.sqrt(size) * generator(seed, int(Stream.DRIFT_ENDS), channel, 0).standard_normal(block + 1)
    free = np.cumsum(white(seed, Stream.DRIFT, channel, block, size))
    share = np.arange(1, size + 1) / size
    return np.sum(ends[:-1]) + free - share * (free[-1] - ends[-1])
