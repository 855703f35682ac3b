"""Resolution of a solid study: which order of elements, and the error estimated from the results at two resolutions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Generic, TypeVar

import numpy as np

from flexstage.base.finding import DesignError
from flexstage.base.record import INNER
from flexstage.solid.fea.fineness import Fineness, Reduction
from flexstage.solid.read import coarsen

_Result = TypeVar("_Result")
HIGHEST = 4
_AT_ORDER_TWO = 0.25
"""Order one is far off: on hinges and blocks order two left a tenth of the change from it, never a quarter."""


@dataclass(frozen=True)
class Resolution:
    """What is asked: the relative error of stiffnesses, gains and frequencies, or, instead, a fixed `order` of elements."""

    accuracy: float = 0.01
    order: int | None = None


DEFAULT = Resolution()


@dataclass(frozen=True, eq=False)
class Converged(Generic[_Result]):
    """A result with the relative error estimated of each of its figures. An estimate, no bound; a figure that is not there is unknown.

    It is the change from the order before, at order two a quarter of it.
    `stopped` says why the order was not raised further although the accuracy asked was not reached.
    """

    result: Annotated[_Result, INNER]
    errors: Mapping[str, float]
    order: int
    stopped: Annotated[str, INNER] = ""

    @property
    def error(self) -> float:
        """The largest of the errors; infinite where none is known."""
        return max(self.errors.values(), default=float("inf"))


def converge(
    work: Callable[[Reduction], _Result], figures: Callable[[_Result], Mapping[str, float]], asked: Resolution
) -> Converged[_Result]:
    """Work at rising orders (2, 3, 4) until the figures change by less than the accuracy, or at one order and the next coarser way.

    >>> found = converge(lambda way: 1.0 + 0.1 ** way.fineness.order, lambda value: {"value": value}, Resolution(0.02))
    >>> found.order, round(found.error, 4)
    (3, 0.009)
    """
    orders = orders_of(asked)
    before = figures(work(first_reductions(asked)[0]))
    found: Converged[_Result] | None = None
    for order in orders:
        try:
            result = work(reduction_of_order(order))
        except DesignError as error:  # of a higher order than one that went: what it needs is not there
            if found is None:
                raise
            return replace(found, stopped=str(error))
        now = figures(result)
        found = Converged(result, estimates(before, now, order), order)
        if found.error <= asked.accuracy:
            return found
        before = now
    assert found is not None  # noqa: S101  there is at least one order
    return found


def orders_of(asked: Resolution) -> tuple[int, ...]:
    """Orders that are tried one after the other.

    >>> orders_of(Resolution()), orders_of(Resolution(order=2))
    ((3, 4), (2,))
    """
    return tuple(range(3, HIGHEST + 1)) if asked.order is None else (asked.order,)


def first_reductions(asked: Resolution) -> tuple[Reduction, Reduction]:
    """The two ways that are worked in any case: what an error is estimated against, and the lowest order asked for.

    >>> [way.fineness.order for way in first_reductions(Resolution())]
    [2, 3]
    """
    first = reduction_of_order(orders_of(asked)[0])
    return coarsen(first), first


def reduction_of_order(order: int) -> Reduction:
    """The standard reduction with elements of an order.

    >>> reduction_of_order(2).fineness.order
    2
    """
    return Reduction(Fineness(order=order))


def estimates(before: Mapping[str, float], after: Mapping[str, float], order: int) -> dict[str, float]:
    """Relative errors estimated of the figures at an order, from those of the order below.

    >>> estimates({"a": 1.0}, {"a": 2.0}, order=2)
    {'a': 0.125}
    """
    share = _AT_ORDER_TWO if order == 2 else 1.0
    return {name: share * change for name, change in changes(before, after).items()}


def changes(before: Mapping[str, float], after: Mapping[str, float]) -> dict[str, float]:
    """Relative changes of the figures that both have, where they are numbers.

    >>> changes({"a": 1.0, "b": 1.0, "c": float("nan")}, {"a": 2.0, "c": 1.0})
    {'a': 0.5}
    """
    found = {name: abs(value - before[name]) / (abs(value) or 1.0) for name, value in after.items() if name in before}
    return {name: change for name, change in found.items() if np.isfinite(change)}
