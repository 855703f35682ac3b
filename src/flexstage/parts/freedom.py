"""Six relative degrees of freedom of a link in its frame (x along the part)."""

from __future__ import annotations

from enum import Enum


class Freedom(Enum):
    """Degree of freedom: a component of the relative twist at a link, in the link's frame. The translations come before the rotations.

    >>> [freedom.value for freedom in Freedom]
    ['x', 'y', 'z', 'rx', 'ry', 'rz']
    """

    X = "x"
    Y = "y"
    Z = "z"
    RX = "rx"
    RY = "ry"
    RZ = "rz"

    @property
    def index(self) -> int:
        """Index (0 to 5) of the degree of freedom in a twist."""
        return ALL.index(self)


ALL = tuple(Freedom)
ROTATIONS = (Freedom.RX, Freedom.RY, Freedom.RZ)


def others(freedoms: tuple[Freedom, ...]) -> tuple[Freedom, ...]:
    """Return all other degrees of freedom, in the order of `ALL`.

    >>> [freedom.value for freedom in others(ROTATIONS)]
    ['x', 'y', 'z']
    """
    return tuple(freedom for freedom in ALL if freedom not in freedoms)
