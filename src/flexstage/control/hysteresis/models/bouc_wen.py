"""The Bouc-Wen model: a hysteresis of another kind, to test compensation honestly."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.control.hysteresis.models.protocol import Hysteresis, freeze_by_axis
from flexstage.control.hysteresis.models.shape import Range, major_loop


@dataclass(frozen=True, eq=False)
class BoucWen(Hysteresis):
    """w = offset + d v - h,  dh/dt = A dv/dt - beta |dv/dt| h - gamma dv/dt |h|, each (axes,); h(v = 0) = 0 at rest.

    (Low and Guo, J. Microelectromech. Syst. 4, 1995, 230-237, exponent 1.) `gain` d and `lag` A in m/V, `beta` and `gamma` in 1/V. Rate
    independent; where the volts move monotonically by e = |dv|, with s = sign(dv) and g = s h, dg/de = A - (beta -+ gamma) g for g below
    and above 0, hence exactly, c = beta - gamma and C = beta + gamma:

        g < 0:   g <- g e^{-c e} + A (1 - e^{-c e})/c   up to e* = ln(1 - c g/A)/c, where g is 0
        g >= 0:  g <- g e^{-C e} + A (1 - e^{-C e})/C   over the rest

    The state (axes, 2) is (v, h). Its inner loops do not close, which no Prandtl-Ishlinskii model follows. Raises `DesignError` for
    -beta < gamma <= beta broken (loops would not dissipate), and where the stroke would fall while the volts rise.
    """

    gain: Array
    lag: Array
    beta: Array
    gamma: Array
    offset: Array | float = 0.0

    def __post_init__(self) -> None:
        """Make all (axes,) and read-only, and check them."""
        freeze_by_axis(self)
        require(_findings(self))

    @property
    def axes(self) -> int:
        """Number of actuators."""
        return len(self.gain)

    def start(self, value: Array) -> Array:
        """The state (axes, 2) after a monotone travel from rest at 0 V to the volts (axes,)."""
        kernel = BoucWenStepper(self, np.zeros((self.axes, 2)))
        kernel(np.broadcast_to(np.asarray(value, dtype=float), (self.axes,)), np.empty(self.axes))
        return kernel.state

    def stepper(self, state: Array) -> BoucWenStepper:
        """A kernel for simulations that starts from `state`."""
        return BoucWenStepper(self, state)


class BoucWenStepper:
    """A Bouc-Wen model that runs: holds its state."""

    __slots__ = ("_lagging", "_model", "_relax_ahead", "_relax_behind", "_volts", "_way_to_zero")

    def __init__(self, model: BoucWen, state: Array) -> None:
        self._model = model
        self._volts, self._lagging = np.array(state, dtype=float).T
        slow, fast = model.beta - model.gamma, model.beta + model.gamma
        self._relax_behind, self._relax_ahead = _relaxation(slow, model.lag), _relaxation(fast, model.lag)
        self._way_to_zero = _way_to_zero(-slow, model.lag)

    @property
    def state(self) -> Array:
        """Volts and lag (axes, 2) now, a copy."""
        return np.stack([self._volts, self._lagging], axis=1)

    def __call__(self, value: Array, out: Array) -> Array:
        """Take the volts (axes,) of the next sample, write the strokes into `out` (axes,) and return it."""
        model = self._model
        travel = value - self._volts
        sign, way = np.sign(travel), np.abs(travel)
        lagging = sign * self._lagging
        behind = np.minimum(lagging, 0.0)
        before = np.minimum(way, -self._way_to_zero(behind))
        ahead = np.where(before < way, np.maximum(lagging, 0.0), lagging)
        first = self._relax_behind(behind, before)
        passed = self._relax_ahead(ahead, way - before)
        moved = np.where((lagging < 0.0) & (before >= way), first, passed)
        self._lagging = np.where(way > 0.0, sign * moved, self._lagging)
        self._volts = np.array(value, dtype=float)
        np.multiply(model.gain, value, out=out)
        np.subtract(out, self._lagging, out=out)
        return np.add(model.offset, out, out=out)


def _relaxation(rate: Array, lag: Array) -> Callable[[Array, Array], Array]:
    """Of g and e: g e^{-c e} + A (1 - e^{-c e})/c, and g + A e where c is 0."""
    level = rate == 0.0
    some, safe, fall = bool(np.any(level)), np.where(level, 1.0, rate), -rate

    def relax(start: Array, way: Array) -> Array:
        exponent = fall * way
        gained = -np.expm1(exponent) / safe
        return start * np.exp(exponent) + lag * (np.where(level, way, gained) if some else gained)

    return relax


def _way_to_zero(rate: Array, lag: Array) -> Callable[[Array], Array]:
    """Of g: ln(1 + c g/A)/c, and g/A where c is 0: minus the way to g = 0 for c = -(beta - gamma)."""
    level = rate == 0.0
    some, safe = bool(np.any(level)), np.where(level, 1.0, rate)

    def way(start: Array) -> Array:
        curved = np.log1p(rate * start / lag) / safe
        return np.where(level, start / lag, curved) if some else curved

    return way


def _findings(model: BoucWen) -> Iterator[Finding]:
    for axis in range(model.axes):
        gain, lag, beta, gamma = (float(getattr(model, name)[axis]) for name in ("gain", "lag", "beta", "gamma"))
        where = f"Bouc-Wen model of axis {axis}"
        if not np.all(np.isfinite([gain, lag, beta, gamma])) or lag <= 0.0:
            yield Finding(where, f"lag is {lag:g} m/V, or a number is not finite", "Give finite numbers, the lag above 0")
        elif not -beta < gamma <= beta:
            what = f"gamma is {gamma:g} 1/V, not above {-beta:g} and at most {beta:g} (beta): its loops would not dissipate"
            yield Finding(where, what, "Choose -beta < gamma <= beta")
        elif 2.0 * lag * beta / (beta + gamma) > gain * (1.0 + 1e-12):
            what = f"just after a reversal h moves by {2.0 * lag * beta / (beta + gamma):g} m/V, more than the gain {gain:g} m/V"
            yield Finding(where, f"{what}: the stroke would fall while the volts rise", "Choose a smaller lag, which makes narrower loops")


@check_arguments
def bouc_wen(stroke: float, volts: Range, width: float, *, sharpness: float = 4.0, skew: float = 0.5) -> BoucWen:
    """A Bouc-Wen stack of this `stroke` [m] between `volts`, whose settled major loop is `width` (0.15 for 15 %) of the stroke wide.

    `sharpness` is beta times the range (the larger, the sooner h saturates), `skew` is gamma/beta. All loops scale with the lag, so that
    lag and gain follow from two linear equations. Raises `DesignError` where no such loop rises everywhere.

    >>> model = bouc_wen(150e-6, (0.0, 1000.0), 0.15)
    >>> loop = major_loop(model, (0.0, 1000.0), count=101)
    >>> round(float(loop.stroke[0]) * 1e6, 6), round(float(loop.width[0]), 3)
    (150.0, 0.15)
    """
    span = volts[1] - volts[0]
    if not (stroke > 0.0 and span > 0.0 and 0.0 < width < 1.0):
        what = f"stroke {stroke:g} m, {volts[0]:g} V to {volts[1]:g} V and width {width:g} make no loop"
        raise refuse("Bouc-Wen model", what, "Give a stroke above 0, volts that ascend, and a width between 0 and 1")
    beta = sharpness / span
    largest = 0.5 * (1.0 + skew)
    unit = major_loop(_stack(1.0, largest, beta, skew), volts, count=201, cycles=6)
    lagging = span - float(unit.stroke[0])
    lag = stroke * width / float(unit.width[0] * unit.stroke[0])
    gain = (stroke + lag * lagging) / span
    return _stack(gain, lag * largest, beta, skew)


def _stack(gain: float, lag: float, beta: float, skew: float) -> BoucWen:
    return BoucWen(np.array([gain]), np.array([lag]), np.array([beta]), np.array([skew * beta]))
