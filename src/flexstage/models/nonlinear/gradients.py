"""Results of many designs at large displacements, and their gradients by numbers of the description (docs/nonlinear.md, 33)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array, Number
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.design import design, designs
from flexstage.mechanism.grammar.node import NumberNode
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.nonlinear.equilibrium import State, corrected, equilibria, equilibrium
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear

_SHARE = 1e-3
"""Relative step of the number, or step over the flexure length if the number is zero."""
_STENCIL: Mapping[float, float] = {-2.0: 1.0 / 12.0, -1.0: -2.0 / 3.0, 1.0: 2.0 / 3.0, 2.0: -1.0 / 12.0}
"""Weights of a central difference with four points, of fourth order."""

_AT_ONCE = 32
"""Designs whose models are in memory at once."""

Results = Callable[[State], Any]
"""Function that computes results from a state, e.g. `State.twist`, frequencies, or a buckling load factor."""


@check_arguments
def evaluate_designs(
    mechanism: Mechanism,
    results: Results,
    loads: Mapping[str, Number] | None = None,
    *,
    hold: Mapping[str, Number] | None = None,
    weight: Number = 1.0,
    stated: Number = 1.0,
) -> Array:
    """Evaluate results for a single design, or for a batch of d designs (one description with arrays as values).

    The results of a batch have the shape (d, ...), and those of a single design (...).

    The other arguments are those of `equilibrium`; axes of cases come after the axis of designs. For a design without an equilibrium, the
    state and the results are NaN.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.addresses.address import set_value
    >>> several = set_value(parallelogram(), "materials.steel.young", np.array([200e9, 210e9]))
    >>> evaluate_designs(several, State.twist, weight=0.0).shape
    (2, 6)
    """
    count = designs(mechanism)
    result: list[Array] = []
    for first in range(0, count or 1, _AT_ONCE):
        places = range(first, min(first + _AT_ONCE, count or 1))
        models = [nonlinear(mechanism if count is None else design(mechanism, place)) for place in places]
        result += [np.asarray(results(each)) for each in equilibria(models, loads, hold=hold, weight=weight, stated=stated)]
    return result[0] if count is None else np.stack(result)


@check_arguments
def gradients(
    mechanism: Mechanism,
    names: Iterable[str],
    results: Results,
    loads: Mapping[str, Number] | None = None,
    *,
    hold: Mapping[str, Number] | None = None,
    weight: Number = 1.0,
    stated: Number = 1.0,
) -> Array:
    """Compute gradients (a, ...) of results under constant loads, with respect to the numbers [SI] at the addresses `names` (a,).

    By the implicit function theorem, the derivative of the equilibrium coordinates q with respect to a number p is - K^-1 dF/dp. K is the
    tangent stiffness, including the inner unknowns of flexures. F is the residual; its derivative is computed at the known state. Residual
    and results are differentiated by a fourth-order central difference with four points. The error of a gradient is about 1e-8 times the
    ratio of the result to the number. If there is no equilibrium, the gradients are NaN. Raises `DesignError` for addresses whose value is
    not a single number.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> stage = parallelogram()
    >>> result = gradients(stage, ["materials.steel.young"], lambda state: state.displacement()[0], {"platform.fx": 100.0}, weight=0.0)
    >>> bool(result[0] < 0.0)
    True
    """
    begin = equilibrium(nonlinear(mechanism), loads, hold=hold, weight=weight, stated=stated)

    def evaluate_near(model: Nonlinear) -> Array:
        return np.asarray(results(corrected(model, begin, loads, hold=hold, weight=weight, stated=stated)))

    return np.stack([_slope(mechanism, name, begin.model.size, evaluate_near) for name in names])


def _slope(mechanism: Mechanism, name: str, size: float, evaluate_near: Callable[[Nonlinear], Array]) -> Array:
    value = get(mechanism, name)
    if value is None or not isinstance(locate(mechanism, name).node, NumberNode):
        raise refuse(name, "not a single number of the description", "Specify the number, or use another address")
    step = _SHARE * (abs(float(value)) or size)
    models = (nonlinear(set_value(mechanism, name, float(value) + place * step)) for place in _STENCIL)
    return np.sum([weight * evaluate_near(model) for model, weight in zip(models, _STENCIL.values(), strict=True)], axis=0) / step
