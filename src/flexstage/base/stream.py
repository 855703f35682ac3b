"""Reproducible random numbers: independent streams by seed and key, in any order."""

from __future__ import annotations

import numpy as np


def generator(seed: int, *key: int) -> np.random.Generator:
    """Return the random generator of a stream. The same seed and key give the same numbers; different keys give independent numbers.

    >>> first, again, other = (generator(7, *key).standard_normal() for key in ((1, 0), (1, 0), (1, 1)))
    >>> first == again, first == other
    (True, False)
    """
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))
