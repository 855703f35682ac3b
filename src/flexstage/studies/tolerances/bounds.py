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
        reach = _reach(target, variables)
        bound = node.bound
        if bound.low < target.nominal - reach and target.nominal + reach < bound.high:
            continue
        owners = tuple(dict.fromkeys(variables[number].scatter for number, _ in target.factors))
        if owners in reported:
            continue
        reported.add(owners)
        worst = target.nominal - reach if target.nominal - reach <= bound.low else target.nominal + reach
        quantity = quantity_of(design, target.address)
        is_, far, there = (show(value, quantity, digits=4) for value in (target.nominal, reach, worst))
        how = "" if all(variables[number].bounded is not None for number, _ in target.factors) else f" ({REACH:g} standard deviations)"
        what = f"{target.address} is {is_}, and deviations reach {far}{how}: it would be {there}, and must be {bound.text()}"
        yield Finding(f"scatter.{', '.join(owners)}", what, 'Use a smaller deviation, or truncate it with within = "..."')


def _reach(target: Target, variables: tuple[Deviation, ...]) -> float:
    """Common reach of deviations: the sum of bounded ones, plus five standard deviations of the sum of the others."""
    bounded, spread = 0.0, 0.0
    for number, factor in target.factors:
        variable = variables[number]
        if variable.bounded is not None:
            bounded += abs(factor) * variable.bounded
        else:
            spread = hypot(spread, factor * variable.deviation)
    return bounded + REACH * spread
