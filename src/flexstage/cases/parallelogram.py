"""The shipped parallelogram stage, for examples."""

from __future__ import annotations

from dataclasses import replace

from flexstage.base.number import Table
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism


def parallelogram() -> Mechanism:
    """A platform on two leaves, pushed by one stack: the case `parallelogram`, its numbers without their formulas.

    >>> sorted(parallelogram().links)
    ['left', 'right']
    """
    return replace(case("parallelogram"), numbers=Table({}), formulas=Table({}))
