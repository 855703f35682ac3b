"""Bending of long leaves to a uniform curvature: what finite displacements of leaves are compared with."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Number
from flexstage.beams.flexure.modes import across
from flexstage.beams.flexure.strip import STRETCH_FOUR, STRETCH_TWO


def secant(beta: Number, poisson: Number, *, shapes: int = 2) -> Number:
    """M / (E I k) of a long leaf bent to the uniform curvature k (docs/nonlinear.md, 12), I = b t^3 / 12; beta = b^2 k / t.

    From 1 (a beam, beta = 0) towards 1 / (1 - nu^2); with P2 and P4 within 0.04 % of Ashwell's strip to beta = 20 (D. G. Ashwell,
    J. Roy. Aero. Soc. 54, 1950), 0.2 % at 40.

    >>> round(float(secant(10.0, 0.3)), 4)
    1.0638
    """
    width_wise, squared = across((2, 4)), poisson * poisson
    stretch = 12.0 * (1.0 - squared) * beta * beta * np.diag([STRETCH_TWO, STRETCH_FOUR])
    form = (width_wise.curved + stretch)[:shapes, :shapes]
    pull = -poisson * np.array([1.0, 10.0 / 3.0])[:shapes]
    found = np.linalg.solve(form, pull)
    # energy by k at the fields that minimise it: D b (k + nu (a2 + 10/3 a4) + stretch of the fields)
    return (1.0 - pull @ found + found @ stretch[:shapes, :shapes] @ found) / (1.0 - squared)
