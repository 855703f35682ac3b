"""Measures that other packages offer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexstage.base.number import Array
from flexstage.base.quantity import Quantity
from flexstage.base.register import Register

if TYPE_CHECKING:
    from flexstage.analysis.judge import Bench


@dataclass(frozen=True)
class OfferedMeasure:
    """A measure by its `meaning` in a few words, its `quantity`, and its `value` (...) in SI of a stage on the bench.

    The bench has the stage and its models and results, each worked out when first asked for; numbers may have batch axes, and the value has
    them then too.
    """

    meaning: str
    quantity: Quantity
    value: Callable[[Bench], Array]


MEASURES: Register[OfferedMeasure] = Register("flexstage.measures", {})
"""Measures by the key that `[require]` lines and studies call them by."""
