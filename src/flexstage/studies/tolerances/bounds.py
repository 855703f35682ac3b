"""Numbers that scatter could move out of their bounds, e.g. a negative thickness."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import hypot

from flexstage.base.finding import Finding
from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.address import quantity_of
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.grammar.node import NumberNode
from flexstage.mechanism.mechanism import Mechanism
from flexstage.studies.tolerances.distribution import REACH
from flexstage.studies.tolerances.scatter import Deviation, Target


def bound_findings(design: Mechanism, reached: Iterable[Target], variables: tuple[Deviation, ...]) -> Iterator[Finding]:
    """Find numbers that scatter may move out of their bounds.

    Deviations are checked up to five standard deviations; for bounded distributions, up to the largest deviation. Of several numbers with
    scatter from the same entries of `[scatter]`, only the first is reported.

    >>> from flexstage.studies.tolerances.distribution import Distribution, Shape
    >>> from flexstage.base.units.quantity import LENGTH
    >>> from flexstage.cases.parallelogram import parallelogram
    >>> wide = Deviation("t", ("parts.leaf.thickness",), LENGTH, -1, 1, distribution=Distribution(Shape.NORMAL, 3e-4), scatter="t")
    >>> [each.what for each in bound_findings(parallelogram(), [Target("parts.leaf.thickness", 1e-3, ((0, 1.0),))], (wide,))]
    ['parts.leaf.thickness is 1 mm, and deviations reach 1.5 mm (5 standard deviations): it would be -0.5 mm, and must be greater than 0']
    """
    reported: set[tuple[str, ...]] = set()
    for target in reached:
        node = locate(design, target.address).node
        if not isinstance(node, NumberNode) or node.bound is None:
            continue
        low, high = _reach(target, variables)
        bound = node.bound
        if bound.low < target.nominal + low and target.nominal + high < bound.high:
            continue
        owners = tuple(dict.fromkeys(variables[number].scatter for number, _ in target.factors))
        if owners in reported:
            continue
        reported.add(owners)
        worst = low if target.nominal + low <= bound.low else high
        quantity = quantity_of(design, target.address)
        is_, far, there = (show(value, quantity, digits=4) for value in (target.nominal, abs(worst), target.nominal + worst))
        how = "" if all(variables[number].bounded for number, _ in target.factors) else f" ({REACH:g} standard deviations)"
        what = f"{target.address} is {is_}, and deviations reach {far}{how}: it would be {there}, and must be {bound.text()}"
        yield Finding(f"scatter.{', '.join(owners)}", what, 'Use a smaller deviation, or truncate it with within = "..."')


def _reach(target: Target, variables: tuple[Deviation, ...]) -> tuple[float, float]:
    """Lowest and highest deviation: the sums of bounded ones, with five standard deviations of the sum of the others."""
    low = high = spread = 0.0
    for number, factor in target.factors:
        variable = variables[number]
        if variable.bounded:
            below, above = sorted((factor * variable.low, factor * variable.high))
            low, high = low + below, high + above
        else:
            spread = hypot(spread, factor * variable.deviation)
    return low - REACH * spread, high + REACH * spread
