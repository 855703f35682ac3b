"""Random numbers by seed and key: any stream, in any order, is always the same."""

from __future__ import annotations

import numpy as np


def generator(seed: int, *key: int) -> np.random.Generator:
    """The generator of a stream: the same seed and key give the same numbers, other keys independent ones.

    >>> first, again, other = (generator(7, *key).standard_normal() for key in ((1, 0), (1, 0), (1, 1)))
    >>> first == again, first == other
    (True, False)
    """
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))
