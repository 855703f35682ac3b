"""Creep of a stack after a voltage step: logarithm of time, and a sum of exponentials for simulation."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import scipy

from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.number import Array, freeze
from flexstage.base.record import Heading
from flexstage.base.units.quantity import TIME
from flexstage.control.hysteresis.models.envelope import freeze_rows
from flexstage.control.systems.system import System
from flexstage.models.linear.model import Channel


@dataclass(frozen=True)
class LogCreep(CheckedFields):
    """Logarithmic creep w(t) = w_0 (1 + gamma log10(t/t_0)) after a step at t = 0: `rate` gamma per decade, `reference` t_0 [s].

    w_0 is the stroke at t_0. The law is valid for times above about t_0 (Jung and Gweon, Rev. Sci. Instrum. 71, 2000, 3436-3440). It gives
    an unbounded stroke at very short and very long times.
    """

    rate: Annotated[float, Heading("creep per decade", digits=3, unit="%")]
    reference: Annotated[float, TIME] = 0.1

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (0.0 < self.reference < np.inf and np.isfinite(self.rate)):
            what = f"invalid creep law (got rate {self.rate:g} per decade, reference time {self.reference:g} s)"
            raise refuse("creep", what, "Use a finite rate and a positive reference time")

    def at(self, times: Array) -> Array:
        """Compute the relative stroke w/w_0 at `times` > 0 [s].

        >>> LogCreep(0.02, 0.1).at(np.array([0.1, 1.0, 10.0])).round(12).tolist()
        [1.0, 1.02, 1.04]
        """
        return 1.0 + self.rate * np.log10(np.asarray(times) / self.reference)


@dataclass(frozen=True, eq=False)
class Creep:
    """Creep operator from an input u to y = g_0 u + sum_i g_i s_i, with the states s_i of first-order lags: tau_i ds_i/dt + s_i = u.

    `instant` (axes,) is g_0; `gains` and `times` [s] (axes, m) are g_i and tau_i. The operator acts on the stroke between the hysteresis
    and the stage (Hammerstein model). If u is constant over the sampling period T, the exact state update is s_i <- s_i + (1 -
    e^{-T/tau_i}) (u - s_i), after y is computed. For a single axis the shape (m,) is also accepted. Raises `DesignError` for time constants
    that are not positive.
    """

    instant: Array
    gains: Array
    times: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "instant", freeze(np.array(self.instant, dtype=float, ndmin=1)))
        freeze_rows(self, "gains", "times")
        require(_findings(self))

    @property
    def axes(self) -> int:
        """Number of actuators."""
        return len(self.instant)

    def step_response(self, times: Array) -> Array:
        """Compute the step response y (k, axes) at `times` (k,) >= 0 [s] from zero state.

        >>> Creep([1.0], [0.1], [2.0]).step_response(np.array([0.0, 2.0])).ravel().round(6).tolist()  # 1, and 1 + 0.1 (1 - 1/e)
        [1.0, 1.063212]
        """
        risen = -np.expm1(-np.asarray(times, dtype=float)[:, None, None] / self.times)
        return self.instant + np.sum(self.gains * risen, axis=-1)

    def system(self, inputs: tuple[Channel, ...], outputs: tuple[Channel, ...]) -> System:
        """Return the creep operator as a linear system for loops; its states are ordered by axis.

        >>> found = Creep([1.0], [0.1], [2.0]).system((Channel("u", "m"),), (Channel("y", "m"),))
        >>> found.A.tolist(), found.C.tolist(), found.D.tolist()
        ([[-0.5]], [[0.1]], [[1.0]])
        """
        count = self.times.shape[1]
        column = np.repeat(np.eye(self.axes), count, axis=0)
        rates = 1.0 / self.times.ravel()
        return System(
            -np.diag(rates), rates[:, None] * column, (self.gains.ravel()[:, None] * column).T, np.diag(self.instant), inputs, outputs
        )


@dataclass(frozen=True, eq=False)
class CreepFit:
    """Exponential fit of logarithmic creep: the `creep`, the fitted `span` of times [s], and the largest relative `error` in this span."""

    creep: Creep
    span: tuple[float, float]
    error: float


@check_arguments
def exponentials(law: LogCreep, span: tuple[float, float], *, per_decade: int = 2) -> CreepFit:
    """Fit a sum of exponentials to logarithmic creep over a `span` of times [s], with `per_decade` terms per decade.

    The time constants tau_i are spaced evenly in log t, over the span and half a decade beyond both ends. The gains, all of one sign,
    follow from least squares at times that are also spaced evenly in log t. Raises `DesignError` for an empty span.

    >>> fit = exponentials(LogCreep(0.02, 0.1), (0.01, 100.0))
    >>> bool(fit.error < 1e-4), fit.creep.step_response(np.array([10.0])).round(3).tolist()
    (True, [[1.04]])
    """
    low, high = span
    if not (0.0 < low < high < np.inf and per_decade >= 1):
        raise refuse(
            "creep",
            f"invalid span or number of terms (got {low:g} s to {high:g} s, {per_decade} terms per decade)",
            "Use 0 < low < high, and at least one term per decade",
        )
    decades = np.log10(high / low)
    spread = np.logspace(np.log10(low) - 0.5, np.log10(high) + 0.5, 1 + int(np.ceil(per_decade * (decades + 1.0))))
    times = np.geomspace(low, high, 1 + int(40 * decades + 40))
    columns = np.column_stack([np.ones_like(times), -np.expm1(-times[:, None] / spread)])
    signs = np.concatenate([[1.0], np.full(len(spread), -1.0 if law.rate < 0.0 else 1.0)])
    lower = np.concatenate([[-np.inf], np.zeros(len(spread))])
    gains = signs * scipy.optimize.lsq_linear(columns * signs, law.at(times), (lower, np.inf), tol=1e-14).x
    creep = Creep(gains[:1], gains[1:], spread)
    fine = np.geomspace(low, high, 10 * len(times))
    error = np.max(np.abs(creep.step_response(fine)[:, 0] - law.at(fine)))
    return CreepFit(creep, span, float(error))


def _findings(creep: Creep) -> Iterator[Finding]:
    if creep.gains.shape != creep.times.shape or len(creep.instant) != len(creep.times):
        shapes = f"instant {creep.instant.shape}, gains {creep.gains.shape}, times {creep.times.shape}"
        yield Finding("creep", f"shapes do not match (got {shapes})", "Use (axes,), (axes, m) and (axes, m)")
    elif not np.all(creep.times > 0.0) or not all(map(np.all, map(np.isfinite, (creep.instant, creep.gains, creep.times)))):
        yield Finding("creep", "a time constant is not positive, or a value is not finite", "Correct the values")
