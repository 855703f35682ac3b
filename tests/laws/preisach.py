"""The Preisach model with a smooth density that no sum of plays has: a plant to test compensation honestly."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.control.hysteresis.models.protocol import Hysteresis, freeze_by_axis
from flexstage.control.hysteresis.models.shape import Range, major_loop

_SLOTS = 16


@dataclass(frozen=True, eq=False)
class Preisach(Hysteresis):
    """w = offset + kappa v + integral of mu over the relays that are on, relays (alpha, beta) going on at alpha and off at beta < alpha.

    mu = mu_0 e^{-(alpha - beta)/lambda} (1 - c m - d m^2), where m = (alpha + beta - low - high)/(high - low) lies between -1 and 1. A
    density that depends on m is of no play type: those (the Prandtl-Ishlinskii model) depend on alpha - beta alone. Its integral over a
    triangle is exact (Everett's function; D = alpha - beta, H = (high - low)/2, J_n = integral over 0..D of e^{-t/lambda} (D - t)^n):

        E(alpha, beta) = mu_0 [J_1 (1 - c m - d m^2) - d J_3/(12 H^2)],
        J_0 = lambda (1 - e^{-D/lambda}),   J_n = lambda (D^n - n J_{n-1})

    and the output is the sum of E over the extremes that are not wiped out (Mayergoyz, Mathematical Models of Hysteresis, 1991, 1.3).
    `slope` kappa in m/V, `density` mu_0 in m/V^2, `decay` lambda in V, `tilt` c, `bulge` d, `offset` in m: each (axes,); `low` and `high`
    in V, beyond which only kappa acts. All relays are off at rest. Raises `DesignError` for a density below 0 anywhere.
    """

    slope: Array
    density: Array
    decay: Array
    tilt: Array
    bulge: Array
    low: Array
    high: Array
    offset: Array | float = 0.0

    def __post_init__(self) -> None:
        """Make all (axes,) and read-only, and check them."""
        freeze_by_axis(self)
        require(_findings(self))

    @property
    def axes(self) -> int:
        """Number of actuators."""
        return len(self.slope)

    def everett(self, alpha: Array, beta: Array) -> Array:
        """Rise of the stroke (axes, ...) while the volts rise from beta to alpha, both (axes, ...), with all relays between off before."""
        shape = (self.axes,) + (1,) * (np.ndim(alpha) - 1)
        decay, tilt, bulge, density = (each.reshape(shape) for each in (self.decay, self.tilt, self.bulge, self.density))
        low, high = self.low.reshape(shape), self.high.reshape(shape)
        width, middle = alpha - beta, (alpha + beta - low - high) / (high - low)
        zeroth = -decay * np.expm1(-width / decay)
        first = decay * (width - zeroth)
        second = decay * (width**2 - 2.0 * first)
        third = decay * (width**3 - 3.0 * second)
        return density * (first * (1.0 - tilt * middle - bulge * middle**2) - bulge * third / (3.0 * (high - low) ** 2))

    def start(self, value: Array) -> Array:
        """The state after the volts rose from rest, all relays off, to (axes,): the extremes that are remembered."""
        return self.step(_memory(self.low, self.low, _SLOTS), np.broadcast_to(np.asarray(value, dtype=float), (self.axes,)))[0]

    def step(self, state: Array, value: Array) -> tuple[Array, Array]:
        """The next state and the strokes (axes,) for the next volts (axes,)."""
        kernel = PreisachStepper(self, state)
        out = kernel(value, np.empty(self.axes))
        return kernel.state, out


def _memory(peaks: Array, valleys: Array, slots: int) -> Array:
    """A state (axes, 1 + 2 slots) with one rise and fall: number of the slot in use, peaks, valleys; slots not in use hold the input."""
    return np.concatenate([np.zeros((len(peaks), 1)), *([np.tile(each[:, None], (1, slots)) for each in (peaks, valleys)])], axis=1)


class PreisachStepper:
    """A Preisach model that runs: holds the extremes it remembers, rises to `peaks` followed by falls to `valleys`."""

    __slots__ = ("_model", "_peaks", "_slot", "_valleys")

    def __init__(self, model: Preisach, state: Array) -> None:
        self._model = model
        slots = (state.shape[1] - 1) // 2
        self._slot = state[:, 0].astype(int)
        self._peaks, self._valleys = state[:, 1 : 1 + slots].copy(), state[:, 1 + slots :].copy()

    @property
    def state(self) -> Array:
        """Slots in use, peaks and valleys (axes, 1 + 2 slots) now, a copy."""
        return np.concatenate([self._slot[:, None], self._peaks, self._valleys], axis=1)

    def __call__(self, value: Array, out: Array) -> Array:
        """Take the volts (axes,) of the next sample, write the strokes into `out` (axes,) and return it."""
        model = self._model
        self._remember(np.clip(value, model.low, model.high))
        floors = np.concatenate([model.low[:, None], self._valleys[:, :-1]], axis=1)
        used = 1 + int(np.max(self._slot))
        rises = model.everett(self._peaks[:, :used], floors[:, :used])
        falls = model.everett(self._peaks[:, :used], self._valleys[:, :used])
        np.sum(rises - falls, axis=1, out=out)
        return np.add(out, model.offset + model.slope * value, out=out)

    def _remember(self, value: Array) -> None:
        """Open a slot where a fall ends; wipe out what the input passes; hold the input in the slot in use and in those beyond."""
        rows = np.arange(len(value))
        now = self._valleys[rows, self._slot]
        rising = value > now
        self._slot += rising & (self._peaks[rows, self._slot] > now)
        if np.max(self._slot) >= self._peaks.shape[1] - 1:
            self._make_room()
        order, current = np.arange(self._peaks.shape[1]), value[:, None]
        np.maximum(self._peaks, np.where(rising, value, -np.inf)[:, None], out=self._peaks)
        np.minimum(self._valleys, np.where(value < now, value, np.inf)[:, None], out=self._valleys)
        np.copyto(self._peaks, current, where=order > self._slot[:, None])
        np.copyto(self._valleys, current, where=order >= self._slot[:, None])

    def _make_room(self) -> None:
        """Drop the slots that were wiped out; where that is not enough, have twice as many."""
        kept = [_turning_points(*each) for each in zip(self._peaks, self._valleys, self._slot, strict=True)]
        slots = self._peaks.shape[1] * (2 if max(len(each) for each in kept) > self._peaks.shape[1] // 2 else 1)
        rows = np.arange(len(kept))
        now = self._valleys[rows, self._slot]
        self._peaks, self._valleys = (np.repeat(now[:, None], slots, axis=1) for _ in range(2))
        for row, pairs in enumerate(kept):
            self._slot[row] = len(pairs) - 1
            self._peaks[row, : len(pairs)], self._valleys[row, : len(pairs)] = np.transpose(pairs)


def _turning_points(peaks: Array, valleys: Array, slot: int) -> list[tuple[float, float]]:
    """Pairs (peak, valley) of which something is left: peaks fall and valleys rise from each to the next; the slot in use is the last."""
    kept: list[tuple[float, float]] = []
    for place, (peak, valley) in enumerate(zip(peaks[: slot + 1], valleys[: slot + 1], strict=True)):
        while kept and kept[-1][0] <= peak:
            kept.pop()
        if place == slot or not kept or valley > kept[-1][1]:
            kept.append((float(peak), float(valley)))
    return kept


def _findings(model: Preisach) -> Iterator[Finding]:
    for axis in range(model.axes):
        density, decay, tilt, bulge = (float(getattr(model, name)[axis]) for name in ("density", "decay", "tilt", "bulge"))
        where = f"Preisach model of axis {axis}"
        if not (density >= 0.0 and decay > 0.0 and model.high[axis] > model.low[axis]):
            what = f"density {density:g} m/V^2, decay {decay:g} V, {model.low[axis]:g} V to {model.high[axis]:g} V make none"
            yield Finding(where, what, "Give a density of 0 or more, a decay above 0, and volts that ascend")
        if not (bulge >= 0.0 and abs(tilt) + bulge <= 1.0):
            what = f"with tilt {tilt:g} and bulge {bulge:g} its density falls to {1.0 - abs(tilt) - bulge:g} of its middle"
            yield Finding(where, what, "Choose a bulge of 0 or more, and |tilt| + bulge at most 1")


@check_arguments
def preisach(stroke: float, volts: Range, width: float, *, decay: float = 0.5, tilt: float = 0.4, bulge: float = 0.5) -> Preisach:
    """A Preisach stack of this `stroke` [m] between `volts`, whose settled major loop is `width` (0.15 for 15 %) of the stroke wide.

    `decay` is lambda as a part of the range, `tilt` and `bulge` say how the density varies over it. Raises `DesignError` where the relays
    alone would make more than the stroke.

    >>> loop = major_loop(preisach(150e-6, (0.0, 1000.0), 0.15), (0.0, 1000.0), cycles=1)
    >>> round(float(loop.stroke[0]) * 1e6, 6), round(float(loop.width[0]), 6)
    (150.0, 0.15)
    """
    span = volts[1] - volts[0]
    if not (stroke > 0.0 and span > 0.0 and 0.0 < width < 1.0):
        what = f"stroke {stroke:g} m, {volts[0]:g} V to {volts[1]:g} V and width {width:g}: no loop"
        raise refuse("Preisach model", what, "Give a stroke above 0, volts that ascend, and a width between 0 and 1")

    def stack(slope: float, density: float) -> Preisach:
        numbers = (slope, density, decay * span, tilt, bulge, *volts)
        return Preisach(*(np.array([number]) for number in numbers))

    unit = major_loop(stack(0.0, 1.0), volts, cycles=1)
    density = stroke * width / float(unit.width[0] * unit.stroke[0])
    slope = (stroke - density * float(unit.stroke[0])) / span
    if slope < 0.0:
        what = (
            f"relays that make a loop {width:.1%} wide alone make a stroke of {density * float(unit.stroke[0]):g} m, more than {stroke:g} m"
        )
        raise refuse("Preisach model", what, "Choose a narrower loop, or a larger decay")
    return stack(slope, density)
