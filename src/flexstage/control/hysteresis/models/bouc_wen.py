"""The Bouc-Wen model: a hysteresis model that is independent of the play model, for tests of compensation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array
from flexstage.control.hysteresis.models.protocol import Hysteresis, freeze_by_axis
from flexstage.control.hysteresis.models.shape import Range, major_loop

_TINY = 1e-300
"""Value that replaces a rate of 0, small enough to give the limits of the formulas to rounding error."""


@dataclass(frozen=True, eq=False)
class BoucWen(Hysteresis):
    """Bouc-Wen hysteresis w = offset + d v - h with dh/dt = A dv/dt - beta |dv/dt| h - gamma dv/dt |h|; initially v = h = 0.

    w is the stroke, v the voltage and h the lag of the stroke (Low and Guo, J. Microelectromech. Syst. 4, 1995, 230-237, exponent 1). All
    are (axes,). `gain` d and `lag` A are in m/V, `beta` and `gamma` in 1/V. The model is rate independent. A monotonic voltage change dv
    has the size e = |dv| and the sign s. With g = s h, c = beta - gamma and C = beta + gamma, dg/de is A - c g for g < 0, and A - C g for g
    > 0. The exact solution is

        g < 0:   g <- g e^{-c e} + A (1 - e^{-c e})/c   up to e* = ln(1 - c g/A)/c, where g reaches 0
        g >= 0:  g <- g e^{-C e} + A (1 - e^{-C e})/C   for the remaining change

    The state (axes, 2) is (v, h). Inner loops do not close; those of every Prandtl-Ishlinskii model do. Raises `DesignError` unless -beta <
    gamma <= beta, because loops would not dissipate energy, and if the stroke would fall with rising voltage.
    """

    gain: Array
    lag: Array
    beta: Array
    gamma: Array
    offset: Array | float = 0.0

    def __post_init__(self) -> None:
        freeze_by_axis(self)
        require(_findings(self))

    @property
    def axes(self) -> int:
        """Number of actuators."""
        return len(self.gain)

    def start(self, value: Array) -> Array:
        """Return the state (axes, 2) after a monotonic change from 0 V to the voltages (axes,)."""
        return self.step(np.zeros((self.axes, 2)), np.broadcast_to(np.asarray(value, dtype=float), (self.axes,)))[0]

    def step(self, state: Array, value: Array) -> tuple[Array, Array]:
        """Return the next state (voltage and h in two columns) and the strokes (axes,), for the next voltages (axes,)."""
        volts, lag = state.T
        slow, fast = np.maximum(self.beta - self.gamma, _TINY), self.beta + self.gamma
        sign, way = np.sign(value - volts), np.abs(value - volts)
        lagging = sign * lag
        behind = np.minimum(lagging, 0.0)
        before = np.minimum(way, np.log1p(-slow * behind / self.lag) / slow)
        ahead = np.where(before < way, np.maximum(lagging, 0.0), lagging)
        first, passed = self._relax(behind, before, slow), self._relax(ahead, way - before, fast)
        moved = np.where((lagging < 0.0) & (before >= way), first, passed)
        lag = np.where(way > 0.0, sign * moved, lag)
        return np.stack([value, lag], axis=1), self.offset + (self.gain * value - lag)

    def _relax(self, start: Array, way: Array, rate: Array) -> Array:
        """g e^{-c e} + A (1 - e^{-c e})/c of g, e and c."""
        return start * np.exp(-rate * way) + self.lag * (-np.expm1(-rate * way) / rate)


def _findings(model: BoucWen) -> Iterator[Finding]:
    for axis in range(model.axes):
        gain, lag, beta, gamma = (float(getattr(model, name)[axis]) for name in ("gain", "lag", "beta", "gamma"))
        where = f"Bouc-Wen model of axis {axis}"
        if not np.all(np.isfinite([gain, lag, beta, gamma])) or lag <= 0.0:
            yield Finding(where, f"a value is not finite, or lag is not positive (got {lag:g} m/V)", "Use finite values and a positive lag")
        elif not -beta < gamma <= beta:
            what = f"gamma is {gamma:g} 1/V (expected above {-beta:g} and at most beta, {beta:g}): loops would not dissipate energy"
            yield Finding(where, what, "Choose -beta < gamma <= beta")
        elif 2.0 * lag * beta / (beta + gamma) > gain * (1.0 + 1e-12):
            what = f"just after a reversal, the lag h changes by {2.0 * lag * beta / (beta + gamma):g} m/V, more than the gain {gain:g} m/V"
            yield Finding(where, f"{what}: the stroke would fall with rising voltage", "Choose a smaller lag, which makes narrower loops")


@check_arguments
def bouc_wen(stroke: float, volts: Range, width: float, *, sharpness: float = 4.0, skew: float = 0.5) -> BoucWen:
    """Construct the Bouc-Wen model of a stack from `stroke` [m] and relative `width` (0.15: 15 %) of its settled major loop over `volts`.

    The symbols A, beta, gamma, d and h are those of `BoucWen`. `sharpness` is beta times the voltage range; with a large value, the lag h
    saturates early. `skew` is gamma/beta. The lag h is proportional to A. Therefore, A and the gain d follow from two linear equations for
    stroke and width. Raises `DesignError` if the stroke of the constructed loop would not rise with the voltage everywhere.

    >>> model = bouc_wen(150e-6, (0.0, 1000.0), 0.15)
    >>> loop = major_loop(model, (0.0, 1000.0), count=101)
    >>> round(float(loop.stroke[0]) * 1e6, 6), round(float(loop.width[0]), 3)
    (150.0, 0.15)
    """
    span = volts[1] - volts[0]
    if not (stroke > 0.0 and span > 0.0 and 0.0 < width < 1.0):
        what = f"invalid loop (got stroke {stroke:g} m, {volts[0]:g} V to {volts[1]:g} V, width {width:g})"
        raise refuse("Bouc-Wen model", what, "Use a stroke above 0, ascending volts, and a width between 0 and 1")
    beta = sharpness / span
    largest = 0.5 * (1.0 + skew)
    unit = major_loop(_stack(1.0, largest, beta, skew), volts, count=201, cycles=6)
    lagging = span - unit.stroke[0]
    lag = stroke * width / (unit.width[0] * unit.stroke[0])
    gain = (stroke + lag * lagging) / span
    return _stack(gain, lag * largest, beta, skew)


def _stack(gain: float, lag: float, beta: float, skew: float) -> BoucWen:
    return BoucWen(np.array([gain]), np.array([lag]), np.array([beta]), np.array([skew * beta]))
