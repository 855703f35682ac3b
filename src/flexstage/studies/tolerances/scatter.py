"""Scatter: deviations of a design's numbers due to manufacture and material, common to all instances or individual."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import reduce
from typing import Annotated

import numpy as np

from flexstage.analysis.assessment.sensitivities import override_level
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Called
from flexstage.base.units.quantity import Quantity
from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.address import get, set_value
from flexstage.mechanism.mechanism import Mechanism
from flexstage.studies.sweeps.numbers import Numbers
from flexstage.studies.sweeps.variable import Variable
from flexstage.studies.tolerances.distribution import NONE, REACH, Distribution


@dataclass(frozen=True)
class Scatter:
    """An entry of a study's `[scatter]`: a `distribution` of deviations of numbers, in the SI unit of `quantity`.

    `members` are groups of addresses with a common deviation. Common scatter has one group; individual scatter has one group for each
    instance. If `relative` is true, deviations are fractions of the design's value. `source` is the value of `address` in the file.
    """

    name: str
    source: Annotated[tuple[str, ...], Called("address")]
    quantity: Annotated[Quantity, INNER]
    distribution: Distribution
    members: Annotated[tuple[tuple[str, ...], ...], Called("numbers")]
    independent: bool
    relative: bool = False

    @property
    def unit(self) -> Annotated[str, VIEW]:
        """The SI unit of the deviations; 1 for relative deviations, which are fractions of the design's value."""
        return self.quantity.si

    def variables(self) -> tuple[Deviation, ...]:
        """Return the entry's variables, one for each member. If there are several, each name ends with the address or component."""
        reach = REACH * self.distribution.size
        low, high = self.distribution.ends or (-reach, reach)
        several = len(self.members) > 1
        names = [f"{self.name}.{self._label(member)}" if several else self.name for member in self.members]
        return tuple(
            Deviation(name, member, self.quantity, low, high, relative=self.relative, distribution=self.distribution, scatter=self.name)
            for name, member in zip(names, self.members, strict=True)
        )

    def _label(self, member: tuple[str, ...]) -> str:
        """Identifier of a member: the instance, or the component of common scatter."""
        return member[0] if self.independent else member[0].rpartition(".")[2]


@dataclass(frozen=True)
class Deviation(Variable):
    """A random deviation of one or more numbers, with a `distribution`. `scatter` is the name of the entry of `[scatter]`.

    Bounded deviations are between `low` and `high`; for an unbounded normal distribution, `low` and `high` are -5 and 5 standard
    deviations. If `relative` is true, deviations are fractions of the design's value (0.01 is one per cent).
    """

    distribution: Distribution = NONE
    scatter: str = ""

    def at(self, shares: Array) -> Array:
        """Compute the deviations at the cumulative probabilities `shares` (n,)."""
        return self.distribution.quantile(shares)

    def text(self, value: float) -> str:
        """Format a deviation with its unit, or in percent of the design's value."""
        return f"{100.0 * value:+.4g} %" if self.relative else show(value, self.quantity, digits=6)

    def nominal(self, mechanism: Mechanism) -> float:  # noqa: ARG002 - of every variable
        """Return the deviation of the nominal design, 0."""
        return 0.0

    @property
    def deviation(self) -> float:
        """Standard deviation."""
        return self.distribution.deviation

    @property
    def bounded(self) -> bool:
        """Whether deviations are between `low` and `high`."""
        return self.distribution.ends is not None


@dataclass(frozen=True)
class Target:
    """A number with scatter at `address`: the `nominal` value plus a sum of variables times `factors`.

    `factors` contains pairs of the index of a variable and its factor.
    """

    address: str
    nominal: float
    factors: tuple[tuple[int, float], ...]


def targets(design: Mechanism, variables: Iterable[Variable], shared: dict[str, str]) -> tuple[Target, ...]:
    """List all numbers with deviations. Numbers of shared parts precede the numbers of instances that override them.

    `shared` maps the address of a number in a single instance to the address in the shared part. If all instances have equal deviations,
    the shared number is changed instead, because fewer different parts are faster to compute.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.base.units.quantity import LENGTH
    >>> both = {"links.left.thickness": "parts.leaf.thickness", "links.right.thickness": "parts.leaf.thickness"}
    >>> [each.address for each in targets(parallelogram(), [Variable("t", tuple(both), LENGTH, -1e-5, 1e-5)], both)]
    ['parts.leaf.thickness']
    """
    reached = dict[str, tuple[tuple[int, float], ...]]()
    for number, variable in enumerate(variables):
        for address in dict.fromkeys(variable.addresses):
            factor = float(get(design, address)) if variable.relative else 1.0
            reached[address] = (*reached.get(address, ()), (number, factor))
    found = _merge_copies(design, reached, shared)
    return tuple(sorted(found, key=lambda target: override_level(design, target.address)))


def _merge_copies(design: Mechanism, reached: dict[str, tuple[tuple[int, float], ...]], shared: dict[str, str]) -> list[Target]:
    copies = dict[str, list[str]]()
    for address, origin in shared.items():
        copies.setdefault(origin, []).append(address)
    alike = {
        origin: members[0]
        for origin, members in copies.items()
        if len({reached.get(each) for each in members}) == 1
        and members[0] in reached
        and {float(get(design, each)) for each in members} == {float(get(design, origin))}
    }
    written = {origin: reached[first] for origin, first in alike.items()}
    written |= {address: factors for address, factors in reached.items() if shared.get(address) not in alike}
    return [Target(address, float(get(design, address)), factors) for address, factors in written.items()]


def apply_deviations(design: Mechanism, reached: tuple[Target, ...], values: Array) -> Mechanism:
    """Build the design with deviations (..., d) added to its numbers. Leading axes of the deviations make the design a batch.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> leaf = Target("parts.leaf.thickness", 1e-3, ((0, 1.0), (1, 1e-3)))
    >>> float(apply_deviations(parallelogram(), (leaf,), np.array([1e-5, 0.02])).parts["leaf"].thickness)
    0.00103
    """
    plain = replace(design, tags={})
    return reduce(lambda stage, target: set_value(stage, target.address, _value(target, values)), reached, plain)


def _value(target: Target, values: Array) -> Array:
    numbers, factors = (list(part) for part in zip(*target.factors, strict=True))
    return np.asarray(target.nominal + values[..., numbers] @ np.array(factors))


def sums(reached: tuple[Target, ...], count: int) -> Numbers:
    """Express the numbers of the targets as linear functions of the deviations of all `count` variables.

    >>> sums((Target("a", 1.0, ((0, 1.0), (1, 2.0))),), 2).at(np.array([[0.1, 0.2]])).round(9).tolist()
    [[1.5]]
    """
    matrix = np.zeros((count, len(reached)))
    for place, target in enumerate(reached):
        for number, factor in target.factors:
            matrix[number, place] = factor
    nominal = np.array([target.nominal for target in reached])
    return Numbers(tuple(target.address for target in reached), nominal, matrix)
