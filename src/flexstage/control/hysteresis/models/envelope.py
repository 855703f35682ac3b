"""Envelopes: piecewise straight functions without memory, before and after the plays of a hysteresis."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from flexstage.base.finding import Finding, require
from flexstage.base.number import Array, freeze

Function = Callable[[Array, Array], Array]
"""Takes an argument (..., axes) and a place of the same shape for the value, which it returns."""


@dataclass(frozen=True, eq=False)
class Envelope:
    """A piecewise straight function for each axis: through `values` (axes, m) at `knots` (axes, m), m >= 2, end slopes carried on.

    With slopes s_j = (y_{j+1} - y_j)/(k_{j+1} - k_j) it is computed, here and wherever else it is, as
    g(x) = y_0 + s_0 (x - k_0) + sum_{j=1}^{m-2} (s_j - s_{j-1}) max(x - k_j, 0).

    The inverse of an ascending one swaps knots and values. One axis may be given as (m,); it then serves any number of axes alike. Raises
    `DesignError` for knots that do not ascend, shapes that differ and numbers that are not finite.
    """

    knots: Array
    values: Array

    def __post_init__(self) -> None:
        """Make both (axes, m) and read-only, and check them."""
        for name in ("knots", "values"):
            object.__setattr__(self, name, freeze(np.atleast_2d(np.asarray(getattr(self, name), dtype=float))))
        require(_findings(self))

    @property
    def axes(self) -> int:
        """Number of axes it tells apart."""
        return len(self.knots)

    @property
    def slopes(self) -> Array:
        """Slopes (axes, m-1) of the pieces."""
        return np.diff(self.values) / np.diff(self.knots)

    @property
    def is_straight(self) -> bool:
        """Whether it has no bend on any axis."""
        return self.knots.shape[1] == 2

    def at(self, arguments: Array) -> Array:
        """Values (..., axes) at arguments (..., axes)."""
        arguments = np.asarray(arguments, dtype=float)
        return self.function(arguments.shape)(arguments, np.empty(arguments.shape))

    def function(self, shape: tuple[int, ...]) -> Function:
        """The function with buffers of its own, for arguments of one shape (..., axes)."""
        first, slope, start = self.knots[:, 0], self.slopes[:, 0], self.values[:, 0]
        if not self.is_straight:
            return self._piecewise(shape)
        if not np.any(first) and not np.any(start) and np.all(slope == 1.0):
            return _copy

        def straight(argument: Array, out: Array) -> Array:
            np.subtract(argument, first, out=out)
            np.multiply(slope, out, out=out)
            return np.add(start, out, out=out)

        return straight

    def _piecewise(self, shape: tuple[int, ...]) -> Function:
        slopes = self.slopes
        knots, start = self.knots[:, :-1], self.values[:, 0]
        floors = np.where(np.arange(slopes.shape[1]) == 0, -np.inf, 0.0)
        changes = np.concatenate([slopes[:, :1], np.diff(slopes)], axis=1)
        beyond = np.empty((*shape, slopes.shape[1]))

        def bent(argument: Array, out: Array) -> Array:
            np.subtract(argument[..., None], knots, out=beyond)
            np.maximum(beyond, floors, out=beyond)
            np.vecdot(changes, beyond, out=out)
            return np.add(start, out, out=out)

        return bent


def _copy(argument: Array, out: Array) -> Array:
    np.copyto(out, argument)
    return out


def _findings(envelope: Envelope) -> Iterator[Finding]:
    knots, values = envelope.knots, envelope.values
    if knots.shape != values.shape or knots.ndim != 2 or knots.shape[1] < 2:
        yield Finding("envelope", f"its knots are {knots.shape} and its values {values.shape}", "Give as many of both, at least two")
    elif not np.all(np.isfinite(knots)) or not np.all(np.isfinite(values)):
        yield Finding("envelope", "a knot or a value is not finite", "Mend the numbers")
    else:
        for axis, knot in np.argwhere(np.diff(knots) <= 0.0):
            what = f"knot {knot + 1} of axis {axis} at {knots[axis, knot + 1]:g} follows {knots[axis, knot]:g}"
            yield Finding("envelope", what, "Let the knots ascend")


IDENTITY = Envelope(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
"""Passes all on as it is."""


def straight(slope: Sequence[float] | Array, start: Sequence[float] | Array | float = 0.0) -> Envelope:
    """Straight envelopes y = `start` + `slope` x, one an axis.

    >>> straight([2.0, 1.0], [1.0, 0.0]).at(np.array([3.0, 3.0])).tolist()
    [7.0, 3.0]
    """
    slope = np.atleast_1d(np.asarray(slope, dtype=float))
    start = np.broadcast_to(np.asarray(start, dtype=float), slope.shape)
    return Envelope(np.tile([0.0, 1.0], (len(slope), 1)), np.stack([start, start + slope], axis=1))


def invert(envelope: Envelope) -> Envelope:
    """The inverse of an ascending envelope. Raises `DesignError` naming the piece that does not ascend.

    >>> bent = Envelope([0.0, 1.0, 2.0], [0.0, 2.0, 3.0])
    >>> invert(bent).at(bent.at(np.array([[-1.0], [0.7], [5.0]]))).ravel().tolist()
    [-1.0, 0.7, 5.0]
    """
    require(descent_findings(envelope, "envelope"))
    return Envelope(envelope.values, envelope.knots)


def descent_findings(envelope: Envelope, where: str) -> list[Finding]:
    """A finding for each piece of an envelope that does not ascend: there no value has one argument.

    >>> descent_findings(Envelope([0.0, 1.0, 2.0], [0.0, 2.0, 1.0]), "envelope")[0].what
    'from 1 to 2 on axis 0 it goes from 2 to 1, and only what ascends can be inverted'
    """
    found = []
    for axis, piece in np.argwhere(np.diff(envelope.values) <= 0.0):
        (left, right), (low, high) = (each[axis, piece : piece + 2] for each in (envelope.knots, envelope.values))
        what = f"from {left:g} to {right:g} on axis {axis} it goes from {low:g} to {high:g}, and only what ascends can be inverted"
        found.append(Finding(where, what, "Keep the input to where it ascends, or identify from a record that ascends"))
    return found
