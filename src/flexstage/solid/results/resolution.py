"""Resolution of a solid study: order of elements, and the error estimated from the results at two resolutions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Generic, TypeVar

import numpy as np

from flexstage.base.arguments import CheckedFields
from flexstage.base.finding import DesignError
from flexstage.base.number import Array
from flexstage.base.record import INNER
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.read import coarsen

_Result = TypeVar("_Result")
HIGHEST = 4
_LEFT, _MATTERS = 0.5, 0.1
"""Expected share of a component's change remaining at the next order, on the shipped stage 0.05 to 0.45. And the smallest relevant
change of a figure divided by the largest one of any component."""
_AT_ORDER_TWO = 0.25
"""Order one is inaccurate: on hinges and blocks order two had a tenth of its error, never a quarter."""
_LOCKED = 0.5
"""Largest change from order one to two that estimates the error of order two: elements of order one lock in bending of thin parts."""
NOT_ESTIMATED = "the error of FEA is unknown: order two is compared with order one, which locks in bending of thin parts. Use --order 3"


@dataclass(frozen=True)
class Resolution(CheckedFields):
    """Required relative error `accuracy` of stiffnesses, gains and frequencies by FEA; `order` fixes the element order."""

    accuracy: float = 0.01
    order: int | None = None


DEFAULT = Resolution()


@dataclass(frozen=True, eq=False)
class Converged(Generic[_Result]):
    """A result with the estimated relative error of each value. Errors are estimates, not bounds; unlisted errors are unknown.

    The estimated error is the change from the previous order; at order two, it is a quarter of this change. The errors of the `unestimated`
    values are unknown, because these values changed by more than half from order one to order two. `stopped` is the reason why the order
    was not raised further, although the required accuracy was not reached. `raised` is the number of components with elements of one order
    more.
    """

    result: Annotated[_Result, INNER]
    errors: Mapping[str, float]
    order: int
    stopped: Annotated[str, INNER] = ""
    raised: Annotated[int, INNER] = 0
    unestimated: Annotated[tuple[str, ...], INNER] = ()

    @property
    def error(self) -> float:
        """Largest error; infinite if a value is `unestimated` or no error is known."""
        return float("inf") if self.unestimated else max(self.errors.values(), default=float("inf"))


def converge(
    work: Callable[[Reduction], _Result],
    figures: Callable[[_Result], Mapping[str, float]],
    asked: Resolution,
    sizes: Callable[[_Result], Mapping[str, float]] | None = None,
    measure: Callable[[Reduction], Mapping[str, float]] | None = None,
) -> Converged[_Result]:
    """Raise the element order (3, 4) until the estimated errors are within the accuracy; if `asked` fixes the order, use only this order.

    Errors are estimated by a computation at the next lower order. The function `sizes` returns the number of unknowns of each component.
    With `sizes`, components that cause a large fraction of the change get a higher order first. The function `measure` computes only the
    values with estimated errors (`figures`).

    >>> found = converge(lambda way: 1.0 + 0.1 ** way.fineness.order, lambda value: {"value": value}, Resolution(0.02))
    >>> found.order, round(found.error, 4)
    (3, 0.009)
    """
    figured = measure or (lambda way: figures(work(way)))
    orders = orders_of(asked)
    before = figured(first_reductions(asked)[0])
    found: Converged[_Result] | None = None
    for order in orders:
        try:
            result = work(reduction_of_order(order))
            now = figures(result)
            found = _converged(result, before, now, order)
            if found.error <= asked.accuracy:
                return found
            if sizes is not None and order < orders[-1]:
                for way in _raise_parts(figured, now, sizes(result), order, asked.accuracy):
                    result = work(way)
                    found = _converged(result, figured(coarsen(way)), figures(result), order, len(way.raised))
                    if found.error <= asked.accuracy:
                        return found
        except DesignError as error:  # a higher order needs more than is available
            if found is None:
                raise
            return replace(found, stopped=str(error))
        before = now
    assert found is not None  # noqa: S101  orders are never empty
    return found


def _converged(result: _Result, before: Mapping[str, float], now: Mapping[str, float], order: int, raised: int = 0) -> Converged[_Result]:
    errors = estimates(before, now, order)
    return Converged(result, errors, order, raised=raised, unestimated=tuple(name for name in changes(before, now) if name not in errors))


def _raise_parts(
    figured: Callable[[Reduction], Mapping[str, float]], now: Mapping[str, float], sizes: Mapping[str, float], order: int, accuracy: float
) -> Iterator[Reduction]:
    """Reductions with the order raised in more and more components, first those with the largest share of the change for their unknowns.

    A component's share is the change of the figures if only its order is lowered by one.
    """
    lower, everything = coarsen(reduction_of_order(order)), frozenset(sizes)
    shares = {part: _share(figured(replace(lower, raised=everything - {part})), now) for part in sizes}
    raised: frozenset[str] = frozenset()
    while raised != everything:
        raised |= _next_part(shares, sizes, raised) or everything
        while raised != everything and np.max(np.abs(_left(shares, raised))) > accuracy:
            more = _next_part(shares, sizes, raised)
            if not more:
                break
            raised |= more
        if raised != everything:  # all of them are the next order
            yield replace(reduction_of_order(order), raised=raised)


def _share(before: Mapping[str, float], after: Mapping[str, float]) -> Array:
    """Relative changes of figures, zero if one is absent."""
    found = np.array([(value - before.get(name, np.nan)) / (abs(value) or 1.0) for name, value in after.items()])
    return np.where(np.isfinite(found), found, 0.0)


def _left(shares: Mapping[str, Array], raised: frozenset[str]) -> Array:
    """The expected remaining change of each figure from one order less in every component."""
    return sum((share * (_LEFT if part in raised else 1.0) for part, share in shares.items()), np.zeros(1))


def _next_part(shares: Mapping[str, Array], sizes: Mapping[str, float], raised: frozenset[str]) -> frozenset[str]:
    """The component with the largest effect on the worst figure for its unknowns; none if the others are insignificant."""
    worst = int(np.argmax(np.abs(_left(shares, raised))))
    most = max(abs(float(share[worst])) for share in shares.values())
    waiting = {part: abs(float(share[worst])) for part, share in shares.items() if part not in raised}
    able = [part for part, share in waiting.items() if share >= _MATTERS * most]
    return frozenset({max(able, key=lambda part: waiting[part] / sizes[part])}) if able and most else frozenset()


def orders_of(asked: Resolution) -> tuple[int, ...]:
    """Return the element orders to compute, the lowest first.

    >>> orders_of(Resolution()), orders_of(Resolution(order=2))
    ((3, 4), (2,))
    """
    return tuple(range(3, HIGHEST + 1)) if asked.order is None else (asked.order,)


def first_reductions(asked: Resolution) -> tuple[Reduction, Reduction]:
    """Return the two reductions that are always needed: at the lowest order of the study, and one order below it for the error estimate.

    >>> [way.fineness.order for way in first_reductions(Resolution())]
    [2, 3]
    """
    first = reduction_of_order(orders_of(asked)[0])
    return coarsen(first), first


def reduction_of_order(order: int) -> Reduction:
    """Return the standard reduction with elements of this `order`.

    >>> reduction_of_order(2).fineness.order
    2
    """
    return Reduction(Fineness(order=order))


def estimates(before: Mapping[str, float], after: Mapping[str, float], order: int) -> dict[str, float]:
    """Estimate the relative errors of the values `after`, computed at this `order`, from the values `before`, computed one order lower.

    At order two, a value that differs from order one by more than half has no estimate.

    >>> estimates({"a": 1.0, "b": 4.0}, {"a": 2.0, "b": 1.0}, order=2)
    {'a': 0.125}
    """
    share, most = (_AT_ORDER_TWO, _LOCKED) if order == 2 else (1.0, np.inf)
    return {name: share * change for name, change in changes(before, after).items() if change <= most}


def changes(before: Mapping[str, float], after: Mapping[str, float]) -> dict[str, float]:
    """Compute the relative changes of values that are finite in both results.

    >>> changes({"a": 1.0, "b": 1.0, "c": float("nan")}, {"a": 2.0, "c": 1.0})
    {'a': 0.5}
    """
    found = {name: abs(value - before[name]) / (abs(value) or 1.0) for name, value in after.items() if name in before}
    return {name: change for name, change in found.items() if np.isfinite(change)}
