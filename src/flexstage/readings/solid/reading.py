"""Solid reading: the same description as 3-D elastic bodies, by substructures."""

from __future__ import annotations

from collections.abc import Callable

from flexstage.base.digest import digest
from flexstage.mechanism.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.readings.linear.model import LinearModel
from flexstage.readings.solid.assemble import linear_model
from flexstage.readings.solid.component import Component, components
from flexstage.readings.solid.content import content
from flexstage.readings.solid.reduce import Reduction, reduced
from flexstage.readings.solid.superelement import Superelement

Reducer = Callable[[Component, Reduction], Superelement]


def solid(mechanism: Mechanism, reduction: Reduction = Reduction(), reducer: Reducer = reduced) -> LinearModel:
    """Read a stage as 3-D elastic solids."""
    parts = components(mechanism)
    keys = [content(part) for part in parts]
    elements: dict[str, Superelement] = {}
    for key, part in zip(keys, parts, strict=True):
        if key not in elements:
            elements[key] = reducer(part, reduction)
    joined = tuple((part, elements[key]) for key, part in zip(keys, parts, strict=True))
    return linear_model(mechanism, expand(mechanism), joined, f"solid reading of {digest(mechanism, physics=True)[:16]}")
