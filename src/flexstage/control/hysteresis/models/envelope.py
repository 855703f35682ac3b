"""Envelopes: piecewise linear functions without memory, before and after the plays of a hysteresis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array, freeze


def freeze_rows(record: Any, *names: str) -> None:
    """Convert the named arrays of a frozen dataclass to read-only arrays (axes, m)."""
    for name in names:
        object.__setattr__(record, name, freeze(np.array(getattr(record, name), dtype=float, ndmin=2)))


@dataclass(frozen=True, eq=False)
class Envelope:
    """Piecewise linear function of each axis, through `values` (axes, m) at `knots` (axes, m), m >= 2, with extrapolated ends.

    With knots k_j, values y_j and slopes s_j = (y_{j+1} - y_j)/(k_{j+1} - k_j), the function is g(x) = y_0 + s_0 (x - k_0) +
    sum_{j=1}^{m-2} (s_j - s_{j-1}) max(x - k_j, 0). Generated code uses the same formula.

    The inverse of an ascending function swaps knots and values. An envelope of shape (m,) serves any number of axes. Raises `DesignError`
    for knots that do not ascend, different shapes, and values that are not finite.
    """

    knots: Array
    values: Array
    changes: Array = field(init=False)

    def __post_init__(self) -> None:
        freeze_rows(self, "knots", "values")
        require(_findings(self))
        slopes = self.slopes
        object.__setattr__(self, "changes", np.concatenate([slopes[:, :1], np.diff(slopes)], axis=1))

    @property
    def axes(self) -> int:
        """Number of distinct axes."""
        return len(self.knots)

    @property
    def slopes(self) -> Array:
        """Slopes (axes, m-1) of the pieces."""
        return np.diff(self.values) / np.diff(self.knots)

    def at(self, arguments: Array) -> Array:
        """Compute values (..., axes) at arguments (..., axes)."""
        if self is IDENTITY:
            return np.asarray(arguments, dtype=float)
        beyond = np.asarray(arguments, dtype=float)[..., None] - self.knots[:, :-1]
        np.maximum(beyond[..., 1:], 0.0, out=beyond[..., 1:])
        return self.values[:, 0] + np.vecdot(self.changes, beyond)


def _findings(envelope: Envelope) -> Iterator[Finding]:
    knots, values = envelope.knots, envelope.values
    if knots.shape != values.shape or knots.ndim != 2 or knots.shape[1] < 2:
        yield Finding(
            "envelope",
            f"different lengths (got knots {knots.shape}, values {values.shape})",
            "Use equal numbers of knots and values, at least two",
        )
    elif not np.all(np.isfinite([knots, values])):
        yield Finding("envelope", "a knot or a value is not finite", "Correct the knots and values")
    else:
        for axis, knot in np.argwhere(np.diff(knots) <= 0.0):
            what = f"knots must ascend (got knot {knot + 1} of axis {axis} at {knots[axis, knot + 1]:g} after {knots[axis, knot]:g})"
            yield Finding("envelope", what, "Sort the knots")


IDENTITY = Envelope(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
"""Identity function."""


def straight(slope: Sequence[float] | Array, start: Sequence[float] | Array | float = 0.0) -> Envelope:
    """Construct linear envelopes y = `start` + `slope` x, one per axis.

    >>> straight([2.0, 1.0], [1.0, 0.0]).at(np.array([3.0, 3.0])).tolist()
    [7.0, 3.0]
    """
    slope = np.atleast_1d(np.asarray(slope, dtype=float))
    start = np.broadcast_to(np.asarray(start, dtype=float), slope.shape)
    return Envelope(np.tile([0.0, 1.0], (len(slope), 1)), np.stack([start, start + slope], axis=1))


def invert(envelope: Envelope) -> Envelope:
    """Compute the inverse of an ascending envelope. Raises `DesignError` for each piece that does not ascend.

    >>> bent = Envelope([0.0, 1.0, 2.0], [0.0, 2.0, 3.0])
    >>> invert(bent).at(bent.at(np.array([[-1.0], [0.7], [5.0]]))).ravel().tolist()
    [-1.0, 0.7, 5.0]
    """
    require(descent_findings(envelope, "envelope"))
    return Envelope(envelope.values, envelope.knots)


def descent_findings(envelope: Envelope, where: str) -> list[Finding]:
    """Find the pieces of an envelope that do not ascend. There, the inverse is not unique.

    >>> descent_findings(Envelope([0.0, 1.0, 2.0], [0.0, 2.0, 1.0]), "envelope")[0].what
    'between 1 and 2 on axis 0 the value changes from 2 to 1 (expected ascending values)'
    """
    found = []
    for axis, piece in np.argwhere(np.diff(envelope.values) <= 0.0):
        (left, right), (low, high) = (each[axis, piece : piece + 2] for each in (envelope.knots, envelope.values))
        what = f"between {left:g} and {right:g} on axis {axis} the value changes from {low:g} to {high:g} (expected ascending values)"
        found.append(Finding(where, what, "Limit the input to the ascending range, or identify from a record with ascending strokes"))
    return found
