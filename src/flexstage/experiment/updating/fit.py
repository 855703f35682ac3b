"""Bayesian least squares, with residuals in standard deviations of the data and parameters in prior standard deviations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from flexstage.base.finding import DesignError, refuse
from flexstage.base.number import Array

_State = TypeVar("_State")

_MOST_STEPS = 40
_HALVINGS = 8
_STILL = 1e-5
"""Step length, in prior standard deviations, that ends the iteration."""
_NEAR = 1e-3
"""Step length that also ends it if no step lowers the cost: only rounding remains."""


@dataclass(frozen=True)
class Problem(Generic[_State]):
    """Least-squares problem, defined by three functions.

    `state` computes the model's state at parameters (P,), starting from the previous state. `residuals` (n,) of a state are (data -
    model)/deviation, where deviation is the standard deviation of the data. `slopes` (n, P) are the derivatives of the model with respect
    to the parameters, divided by the same standard deviations. The parameters are in prior standard deviations, so that their prior
    covariance is the unit matrix.
    """

    state: Callable[[Array, _State], _State]
    residuals: Callable[[_State], Array]
    slopes: Callable[[_State], Array]


@dataclass(frozen=True, eq=False)
class Fitted(Generic[_State]):
    """Solution: most probable parameters (P,), model state, residuals (n,) and slopes (n, P) of this state, and number of steps."""

    parameters: Array
    state: _State
    residuals: Array
    slopes: Array
    steps: int

    @property
    def cost(self) -> float:
        """Chi-squared of data and priors: |r|^2 + |u|^2, with residuals r and parameters u."""
        return _cost(self.residuals, self.parameters)


def gauss_newton(problem: Problem[_State], start: Array, state: _State) -> Fitted[_State]:
    """Minimise |r|^2 + |u|^2 by Gauss-Newton steps with step halving, from the parameters `start` and their model `state`.

    Here r are the residuals and u the parameters. Raises `DesignError` if the iteration does not converge, or if steps lead to invalid
    designs.

    >>> line = Problem(lambda u, _: u, lambda u: 3.0 * (1.0 - u), lambda u: np.array([[3.0]]))
    >>> gauss_newton(line, np.zeros(1), np.zeros(1)).parameters.round(9).tolist()  # 9 / (9 + 1)
    [0.9]
    """
    here, residuals = start, problem.residuals(state)
    slopes = problem.slopes(state)
    length, count = np.inf, 0
    while count < _MOST_STEPS:
        step = _step(slopes, residuals, here)
        count, length = count + 1, float(np.max(np.abs(step)))
        taken = _descend(problem, here, state, residuals, step) if np.isfinite(length) else None
        if taken is None and not length < _NEAR:
            break
        if taken is not None:
            here, state, residuals = taken
            slopes = problem.slopes(state)
        if taken is None or length < _STILL:
            return Fitted(here, state, residuals, slopes, count)
    what = f"no convergence: after {count} steps, parameters still change by {length:.2g} prior standard deviations"
    raise refuse("update", what, "Specify narrower priors, update fewer parameters, or start with a design nearer to the test")


def _step(slopes: Array, residuals: Array, here: Array) -> Array:
    stacked = np.concatenate([slopes, np.eye(len(here))])
    return np.linalg.lstsq(stacked, np.concatenate([residuals, -here]), rcond=None)[0]


def _descend(problem: Problem[_State], here: Array, state: _State, residuals: Array, step: Array) -> tuple[Array, _State, Array] | None:
    """First of decreasing steps that lowers the cost; `None` without one."""
    cost = _cost(residuals, here)
    for halving in range(_HALVINGS):
        there = here + step * 0.5**halving
        try:
            reached = problem.state(there, state)
        except DesignError:
            continue
        found = problem.residuals(reached)
        if _cost(found, there) < cost:  # false for NaN too
            return there, reached, found
    return None


def _cost(residuals: Array, parameters: Array) -> float:
    return float(residuals @ residuals + parameters @ parameters)
