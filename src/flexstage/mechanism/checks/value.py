"""Checks of numbers: finite, within bounds, consistent batches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.units.quantity import RATIO, Bound
from flexstage.base.units.unit import convert, example, parse, show
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import NumberNode
from flexstage.mechanism.mechanism import Mechanism

LARGEST = 1e40
"""Largest plausible number in SI (least nonzero: its reciprocal); powers of others exceed the range of floats."""


def value_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Return errors of single numbers.

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
        told = ", ".join(f"{address} {shape}" for shape, address in shapes.items() if shape)
        yield Finding("batch", f"arrays of different shapes ({told})", "Use arrays that broadcast")


def first_failing(failing: Any, *values: Any) -> tuple[str, tuple[Any, ...]]:
    """Return the index of the first failure of a batch (`" at index 3"`, empty for one design), and the values there.

    >>> first_failing(np.array([False, True]), np.array([1.0, 2.0]), 3.0)
    (' at index 1', (2.0, 3.0))
    """
    shape = np.shape(failing)
    index = tuple(int(axis) for axis in np.argwhere(failing)[0]) if shape else ()
    picked = tuple(float(np.broadcast_to(np.real(value), shape)[index]) for value in values)
    return (f" at index {', '.join(map(str, index))}" if shape else ""), picked


def _all_numbers(mechanism: Mechanism) -> Iterator[tuple[str, Any, NumberNode]]:
    yield from node_of(Mechanism).numbers(mechanism)
    for key, value in mechanism.overrides.items():
        yield from locate(mechanism, key).node.numbers(value, f'overrides."{key}"')


def number_findings(where: str, value: Any, node: NumberNode) -> Iterator[Finding]:
    """Return errors of a number with the quantity and bound of its node.

    >>> from flexstage.base.units.quantity import FREQUENCY, POSITIVE, RATIO, Bound
    >>> print(*number_findings("rate", 0.0, NumberNode(FREQUENCY, POSITIVE)))
    rate: must be greater than 0 Hz (got 0 Hz). Use e.g. "4 kHz".
    >>> print(*number_findings("peak", 0.5, NumberNode(RATIO, Bound(1.0, open_low=True))))
    peak: must be greater than 1 (got 0.5). Use a number greater than 1.
    """
    hint, real = f"Use e.g. {example(node.quantity)}", np.real(value)
    size = np.abs(real)
    extreme = (size > LARGEST) | ((size < 1.0 / LARGEST) & (size > 0.0))
    if np.any(extreme):
        at, (found,) = first_failing(extreme, real)
        told = show(found, node.quantity, digits=6)
        yield Finding(f"{where}{at}", f"implausible size (got {told})", "Check the exponent and the unit")
        return
    bound = node.bound
    if bound is not None and np.any(outside := _outside(real, bound)):
        at, (found,) = first_failing(outside, real)
        fits = node.quantity is not RATIO or not _outside(parse(RATIO.example, RATIO), bound)
        limits = replace(bound, **{name: float(convert(getattr(bound, name), node.quantity)) for name in ("low", "high")})
        text = limits.text() if node.quantity.shown == "1" else f"{limits.text()} {node.quantity.shown}"
        advice = hint if fits else f"Use a number {text}"
        yield Finding(f"{where}{at}", f"must be {text} (got {show(found, node.quantity, digits=6)})", advice)


def _outside(real: Any, bound: Bound) -> Any:
    low = real <= bound.low if bound.open_low else real < bound.low
    high = real >= bound.high if bound.open_high else real > bound.high
    return low | high
