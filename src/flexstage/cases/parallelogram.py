"""The shipped parallelogram stage, for examples."""

from __future__ import annotations

from dataclasses import replace

from flexstage.base.number import Table
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism


def parallelogram() -> Mechanism:
    """Return the case `parallelogram`, a platform on two leaves pushed by one stack; its values are numbers without formulas.

    >>> sorted(parallelogram().links)
    ['left', 'right']
    """
    return replace(case("parallelogram"), numbers=Table({}), formulas=Table({}))
