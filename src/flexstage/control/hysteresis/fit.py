"""Least-squares fit of Prandtl-Ishlinskii models: play weights, and slopes of the envelope before the plays."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy

from flexstage.base.number import Array
from flexstage.control.hysteresis.models.envelope import IDENTITY, Envelope, straight
from flexstage.control.hysteresis.models.prandtl_ishlinskii import PrandtlIshlinskii

_ROUNDS = 40
_SETTLED = 1e-8
_LEAST_SLOPE = 0.05
_LEAST_WEIGHT = 1e-3


@dataclass(frozen=True, eq=False)
class Fit:
    """Fitted model: envelope with `knots` (m,) [V] and `slopes` (m-1,), then plays with `thresholds` (n,) [V] and `weights` (n,) [m/V].

    The slopes have a mean of 1, which sets the scale of the thresholds. `offset` [m] is added to the strokes.
    """

    thresholds: Array
    knots: Array
    slopes: Array
    weights: Array
    offset: float

    def effective(self, volts: Array) -> Array:
        """Compute the plays' input (k,) [V] for voltages (k,) [V] from the envelope. At the lowest knot, input and voltage are equal."""
        return self.knots[0] + _ramps(volts, self.knots) @ self.slopes

    def strokes(self, plays: Array) -> Array:
        """Compute strokes (k,) [m] for play outputs (k, n)."""
        return plays @ self.weights + self.offset

    def model(self) -> PrandtlIshlinskii:
        """Return the model with its envelope shifted to pass through 0, the unloaded state.

        The shift changes input and outputs of the plays equally, and the offset of the model compensates for it. Strokes therefore change
        only while play outputs depend on the initial state.
        """
        knots = self.knots
        values = knots[0] + np.concatenate([[0.0], np.cumsum(self.slopes * np.diff(knots))])
        before = IDENTITY if len(knots) == 2 else Envelope(knots, values - Envelope(knots, values).at(np.zeros(1)))
        shift = values[0] - before.at(knots[:1])[0]
        after = straight([1.0], self.offset + shift * np.sum(self.weights))
        return PrandtlIshlinskii(self.thresholds, self.weights, before, after)


def form_of(volts: tuple[float, float], plays: int, pieces: int, *, reach: float = 0.5) -> Fit:
    """Choose the thresholds of `plays` plays, and the knots of an envelope with `pieces` pieces of equal width.

    The thresholds are evenly spaced, from 0 up to but not including `reach` times the voltage range. The weights are zero.

    >>> form_of((0.0, 1000.0), 4, 1).thresholds.tolist()
    [0.0, 125.0, 250.0, 375.0]
    """
    span = volts[1] - volts[0]
    return Fit(reach * span * np.arange(plays) / plays, np.linspace(*volts, pieces + 1), np.ones(pieces), np.zeros(plays), 0.0)


def play_outputs(inputs: Array, thresholds: Array) -> Array:
    """Compute play outputs (k, n) for inputs (k,). All plays start at the first input.

    >>> play_outputs(np.array([0.0, 3.0, 2.0]), np.array([0.0, 1.0])).tolist()
    [[0.0, 0.0], [3.0, 2.0], [2.0, 2.0]]
    """
    above, found = inputs[:, None] + thresholds, inputs[:, None] - thresholds
    ways = np.sign(np.diff(inputs))
    ends = [*(1 + np.flatnonzero(ways[1:] != ways[:-1])), len(inputs) - 1]
    now, start = np.full(len(thresholds), inputs[0]), 0
    found[0] = now
    for end in ends:  # between reversals: rising inputs move plays by the lower bound only, falling inputs by the upper bound only
        rows = slice(start + 1, end + 1)
        found[rows] = np.maximum(found[rows], now) if ways[start] > 0.0 else np.minimum(above[rows], now)
        now, start = found[end], end
    return found


def known_from(inputs: Array, thresholds: Array) -> int:
    """Find the first sample at which the inputs have spanned twice the largest threshold.

    From this sample on, no play depends on its initial state.

    >>> known_from(np.array([0.0, 1.0, 5.0, 3.0, 0.0]), np.array([0.0, 2.0]))
    2
    """
    swing = np.maximum.accumulate(inputs) - np.minimum.accumulate(inputs)
    return int(np.searchsorted(swing, 2.0 * thresholds[-1]))


def fit_form(volts: Array, strokes: Array, fit: Fit, rows: Array, *, rounds: int = _ROUNDS) -> Fit:
    """Fit weights (0 or more) and envelope slopes (positive) to the samples `rows` of a record by least squares.

    Samples at which plays still depend on their initial state (`known_from`) are omitted.

    With a straight envelope, the fit is one linear problem. With several envelope pieces, the fit alternates between weights (with fixed
    slopes) and slopes (with fixed weights), at most `rounds` times. Each fit of weights or slopes is linear: a sticking play keeps the
    envelope's value at its last motion, which is linear in the slopes.

    >>> volts = np.concatenate([np.linspace(0, 100, 21), np.linspace(95, 0, 20), np.linspace(5, 100, 20)])
    >>> strokes = PrandtlIshlinskii([0.0, 25.0], [1e-7, 5e-8]).run(volts)
    >>> fit_form(volts, strokes, form_of((0.0, 100.0), 2, 1), np.arange(61) > 20).weights.round(12).tolist()
    [1e-07, 5e-08]
    """
    for _ in range(0 if len(fit.slopes) == 1 else rounds):
        plays, used = _known_plays(fit, volts, rows)
        before = fit.slopes
        fit = _with_weights(fit, plays[used], strokes[used])
        fit = _with_slopes(fit, volts, plays, strokes, used)
        if np.max(np.abs(fit.slopes - before)) < _SETTLED:
            break
    plays, used = _known_plays(fit, volts, rows)
    return _with_weights(fit, plays[used], strokes[used])


def _known_plays(fit: Fit, volts: Array, rows: Array) -> tuple[Array, Array]:
    effective = fit.effective(volts)
    known = np.arange(len(volts)) >= known_from(effective, fit.thresholds)
    return play_outputs(effective, fit.thresholds), rows & known


def _with_weights(fit: Fit, plays: Array, strokes: Array) -> Fit:
    span = np.ptp(fit.knots)
    size = np.ptp(strokes) / span or 1.0
    lower = np.concatenate([[_LEAST_WEIGHT], np.zeros(plays.shape[1] - 1), [-np.inf]])
    solved = _bounded_least_squares(np.column_stack([plays / span, np.ones(len(plays))]), strokes / (size * span), lower)
    return replace(fit, weights=size * solved[:-1], offset=size * span * solved[-1])


def _with_slopes(fit: Fit, volts: Array, plays: Array, strokes: Array, rows: Array) -> Fit:
    """Slopes for given weights, from the voltage and the side of each play's last motion."""
    moved = np.sign(np.diff(plays, axis=0, prepend=plays[:1]))
    last = np.maximum.accumulate(np.where(moved != 0.0, np.arange(len(plays))[:, None], 0), axis=0)[rows]
    side = np.take_along_axis(moved, last, axis=0)
    knots, span = fit.knots, np.ptp(fit.knots)
    columns = np.einsum("kij,i->kj", _ramps(volts, knots)[last], fit.weights)
    known = fit.offset + knots[0] * np.sum(fit.weights) - (side * fit.thresholds) @ fit.weights
    scale = np.sum(fit.weights) * span
    lower = np.concatenate([np.full(len(fit.slopes), _LEAST_SLOPE), [-np.inf]])
    solved = _bounded_least_squares(np.column_stack([columns / scale, np.ones(len(columns))]), (strokes[rows] - known) / scale, lower)
    return replace(fit, slopes=solved[:-1] * span / (solved[:-1] @ np.diff(knots)))


def _ramps(volts: Array, knots: Array) -> Array:
    """Distances (k, m-1) on each piece from the lowest knot to the voltage; the end pieces are extrapolated."""
    floors = np.concatenate([[-np.inf], np.zeros(len(knots) - 2)])
    tops = np.concatenate([np.diff(knots)[:-1], [np.inf]])
    return np.clip(volts[:, None] - knots[:-1], floors, tops)


def _bounded_least_squares(matrix: Array, target: Array, lower: Array) -> Array:
    """Bounded least squares on the triangular factor of the columns."""
    triangle = np.asarray(np.linalg.qr(np.column_stack([matrix, target]), mode="r"))
    return scipy.optimize.lsq_linear(triangle[:, :-1], triangle[:, -1], (lower, np.inf), method="bvls", tol=1e-14).x


def drift_of(plays: Array, strokes: Array) -> float:
    """Estimate drift [m] over a record: the part of the strokes (k,) that is linear in time and not explained by plays (k, n).

    The result is 0 if a fit without drift has an rms error at most 20 % larger than a fit with drift.

    >>> plays = np.array([[0.0], [1.0], [0.0], [1.0]])
    >>> round(drift_of(plays, np.array([0.0, 1.01, 0.02, 1.03])), 6)
    0.03
    """
    time = np.linspace(-0.5, 0.5, len(strokes))
    columns = np.column_stack([plays, np.ones(len(plays)), time])
    scale = np.maximum(np.max(np.abs(columns), axis=0), 1e-300)
    solved = np.linalg.lstsq(columns / scale, strokes, rcond=1e-10)[0]
    with_time = strokes - columns / scale @ solved
    without = strokes - columns[:, :-1] @ np.linalg.lstsq(columns[:, :-1], strokes, rcond=1e-10)[0]
    matters = np.sum(without**2) > 1.44 * np.sum(with_time**2) + 1e-24 * np.sum(strokes**2)
    return float(solved[-1] / scale[-1]) if matters else 0.0
