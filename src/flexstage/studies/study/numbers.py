"""The numbers of the description that a study's designs differ in, where its variables are addresses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.mechanism.address import get
from flexstage.mechanism.mechanism import Mechanism
from flexstage.studies.sensitivities import departure
from flexstage.studies.study.variable import Variable

_BEYOND = 1e-9
"""How much of a range is added at its ends, so that rounding leads no design out of it."""


@dataclass(frozen=True, eq=False)
class Numbers:
    """P numbers at `addresses`: each is variable `of` (P,) times `factor` (P,); shared parts before departures from them."""

    addresses: tuple[str, ...]
    of: Array
    factor: Array

    def at(self, values: Array) -> Array:
        """The numbers (n, P) of designs with `values` (n, d) of the variables.

        >>> Numbers(("a", "b"), np.array([0, 0]), np.array([1.0, 3.0])).at(np.array([[2.0]])).tolist()
        [[2.0, 6.0]]
        """
        return values[..., self.of] * self.factor

    def ranges(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Least and largest numbers (P,) for variables from `low` to `high` (d,).

        >>> low, high = Numbers(("a",), np.array([0]), np.array([-2.0])).ranges(np.array([1.0]), np.array([2.0]))
        >>> low.round(6).tolist(), high.round(6).tolist()
        ([-4.0], [-2.0])
        """
        ends = np.stack([self.at(low), self.at(high)])
        more = _BEYOND * np.ptp(ends, axis=0)
        return ends.min(axis=0) - more, ends.max(axis=0) + more


def numbers_moved(mechanism: Mechanism, variables: tuple[Variable, ...]) -> Numbers | None:
    """The numbers that variables move, as `varied` writes them; `None` where one of them is no number of the description.

    >>> from flexstage.base.quantity import RATIO
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> neck = Variable("neck", ("parts.neck.thickness",), RATIO, 0.9, 1.1, relative=True)
    >>> numbers_moved(double_triangle(), (neck,)).at(np.array([[0.5]])).round(9).tolist()
    [[0.00077]]
    """
    if any(variable.variant is not None for variable in variables):
        return None
    moves = [(address, number, each.relative) for number, each in enumerate(variables) for address in each.addresses]
    moves.sort(key=lambda move: departure(mechanism, move[0]))
    factors = [float(get(mechanism, address)) if relative else 1.0 for address, _, relative in moves]
    return Numbers(tuple(address for address, _, _ in moves), np.array([number for _, number, _ in moves]), np.array(factors))
