"""The shipped parallelogram stage, for examples."""

from __future__ import annotations

from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism


def parallelogram() -> Mechanism:
    """A platform on two leaves, pushed by one stack: the case `parallelogram`.

    >>> sorted(parallelogram().links)
    ['left', 'right']
    """
    return case("parallelogram")
