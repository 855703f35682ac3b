"""Checks that numbers are finite and within bounds, and that batches have consistent sizes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from flexstage.base.finding import Finding
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import NumberNode, number_findings
from flexstage.mechanism.mechanism import Mechanism


def value_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors of single numbers, and of batches of inconsistent size.

    >>> from flexstage.parts.rod import Rod
    >>> print(*value_findings(Mechanism("", parts={"wire": Rod("steel", length=0.03, diameter=-0.001)})))
    parts.wire.diameter: must be greater than 0 mm (got -1 mm). Use e.g. "2 mm".
    """
    shapes: dict[tuple[int, ...], str] = {}
    for address, value, node in _all_numbers(mechanism):
        yield from number_findings(address, value, node)
        shapes.setdefault(np.shape(value), address)
    try:
        np.broadcast_shapes(*shapes)
    except ValueError:
        text = ", ".join(f"{address} {shape}" for shape, address in shapes.items() if shape)
        yield Finding("batch", f"arrays of different shapes ({text})", "Use arrays that broadcast")


def _all_numbers(mechanism: Mechanism) -> Iterator[tuple[str, Any, NumberNode]]:
    yield from node_of(Mechanism).numbers(mechanism)
    for key, value in mechanism.overrides.items():
        yield from locate(mechanism, key).node.numbers(value, f'overrides."{key}"')
