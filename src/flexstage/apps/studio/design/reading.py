"""A design's text read for the studio: its numbers, or its errors and their positions."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from flexstage.analysis.assessment.requirements import requirements
from flexstage.analysis.loaded.course import path_findings
from flexstage.analysis.workspace.stroke import stroke_limits
from flexstage.apps.studio.design.answers import Reading
from flexstage.apps.studio.protocol import Amount, Channel, Problem
from flexstage.base.finding import DesignError, Finding, require
from flexstage.base.number import first_design
from flexstage.base.session import SESSION
from flexstage.base.units.quantity import Bound, Quantity
from flexstage.base.units.unit import show
from flexstage.mechanism.addresses.address import provenance
from flexstage.mechanism.addresses.locate import locate
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.grammar.grammar import node_of
from flexstage.mechanism.grammar.node import NumberNode
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.mechanism.store import loads
from flexstage.mechanism.store.lines import line_numbers, line_of, spot_of
from flexstage.show.display import field_unit, preferred_unit
from flexstage.show.viewer.parts import link_address
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS

_REACH = 0.5
"""Range of a slider in both directions, relative to the value."""
_FROM_NOUGHT = 10.0
"""Range of a slider from zero, in the display unit."""


@SESSION.keep(8)
def design(text: str, file: str) -> Mechanism:
    """Return the design in a text; raises `DesignError` with all errors."""
    return loads(text, where=Path(file).name, folder=Path(file).parent)


def read(text: str, file: str, stored: str) -> Reading:
    """Read the contents of a text; raises `DesignError` with all errors. The old values of numbers come from the `stored` text."""
    found = design(text, file)
    requirements(found)
    require(path_findings(found))
    lines, assembly = line_numbers(text), expand(found)
    return Reading(
        found.name,
        tuple(_amounts(found, lines, _stored_values(stored, file))),
        tuple(_actuators(found, assembly)),
        tuple(_channel(name, unit, None, None) for name, unit in zip(COMPONENTS, TWIST_UNITS, strict=True)),
        tuple(_gauges(assembly)),
        (*assembly.strokes, *assembly.thrusts, *_sixfold((GROUND,), COMPONENTS), *_sixfold((PLATFORM, *assembly.points), FORCES)),
        (*_sixfold((PLATFORM, *assembly.points), COMPONENTS), *assembly.gauges),
        link_lines(found, lines),
        tuple(found.paths),
    )


def problems_of(findings: Iterable[Finding], text: str, file: str) -> tuple[Problem, ...]:
    """Return the findings with their line and column in the text."""
    rows, lines = text.splitlines(), line_numbers(text)
    return tuple(_problem(each, rows, lines, Path(file).name) for each in findings)


def link_lines(mechanism: Mechanism, lines: Mapping[str, int]) -> dict[str, int | None]:
    """Return the line that defines each link."""
    assembly = expand(mechanism)
    found = {**assembly.links, **assembly.superelements}
    return {name: line_of(link_address(mechanism, link), lines) for name, link in found.items()}


def _problem(finding: Finding, rows: list[str], lines: Mapping[str, int], where: str) -> Problem:
    spot = spot_of(finding, where)
    line = spot.line or line_of(spot.address, lines)
    column = spot.column or (None if line is None or line > len(rows) else _column(rows[line - 1], spot.address))
    return Problem(spot.address or where, finding.what, finding.advice, line, column)


def _column(row: str, address: str) -> int:
    """Column of the innermost step of an address in a row; else of the start of its text."""
    for step in reversed(address.replace('"', "").replace("/", ".").split(".")):
        if step and (found := re.search(rf"(?<![\w-]){re.escape(step)}(?![\w-])", row)):
            return found.start() + 1
    return len(row) - len(row.lstrip()) + 1


def _numbers(mechanism: Mechanism) -> Iterator[tuple[str, float, NumberNode]]:
    """Every single number, by address."""
    yield from node_of(Mechanism).numbers(mechanism)
    for key, value in mechanism.overrides.items():
        place = locate(mechanism, key)
        yield from place.node.numbers(value, place.address)


@SESSION.keep(2)
def _stored_values(text: str, file: str) -> Mapping[str, float]:
    try:
        return {address: float(value) for address, value, _ in _numbers(design(text, file)) if np.ndim(value) == 0}
    except DesignError:
        return {}


def _amounts(mechanism: Mechanism, lines: Mapping[str, int], stored: Mapping[str, float]) -> Iterator[Amount]:
    tags, seen = provenance(mechanism), set[str]()
    for address, value, node in _numbers(mechanism):
        if address in seen or np.ndim(value):
            continue
        seen.add(address)
        quantity, number = node.quantity, float(np.real(value))
        unit, factor = _shown(quantity)
        low, high = _span(number, factor, node.bound)
        yield Amount(
            address,
            _group(address),
            number,
            show(number, quantity) if quantity.si not in {"1", "mixed"} else f"{number:.12g}",
            quantity.si,
            unit,
            factor,
            quantity.name,
            low,
            high,
            stored.get(address),
            mechanism.formulas.get(address),
            line_of(address, lines),
            tags.get(address, ""),
        )


def _shown(quantity: Quantity) -> tuple[str, float]:
    """The display unit of a quantity, and its value in SI."""
    form = field_unit(quantity)
    return form.text, 1.0 / form.factor


def _span(value: float, factor: float, bound: Bound | None) -> tuple[float, float]:
    """The range of a slider, within the bound."""
    reach = _REACH * abs(value) if value else _FROM_NOUGHT * factor
    low, high = value - reach, value + reach
    return (low, high) if bound is None else (max(low, bound.low), min(high, bound.high))


def _group(address: str) -> str:
    """The table of an address in the file."""
    if "/" in address.partition(".")[0]:
        return "overrides"
    steps = address.split(".")
    return ".".join(steps[:2]) if len(steps) > 2 else steps[0] if len(steps) > 1 else ""


def _channel(name: str, si: str, low: float | None, high: float | None) -> Channel:
    form = preferred_unit(si)
    return Channel(name, si, form.unit, 1.0 / form.factor, low, high)


def _actuators(mechanism: Mechanism, assembly: Assembly) -> Iterator[Channel]:
    if assembly.strokes:
        limits = stroke_limits(mechanism)
        for name, low, high in zip(limits.actuators, first_design(limits.low, 1), first_design(limits.high, 1), strict=True):
            yield _channel(name, "m", finite(low), finite(high))
    for name in assembly.thrusts:
        yield _channel(name, assembly.actuator(name).input.si, None, None)


def _gauges(assembly: Assembly) -> Iterator[Channel]:
    for name, gauge in assembly.gauges.items():
        half = finite(0.5 * np.asarray(gauge.gauge.range))
        yield _channel(name, gauge.unit, None if half is None else -half, half)


def finite(value: Any) -> float | None:
    """Return the value of the first design of a batch, or `None` if the value is absent or not finite."""
    found = np.nan if value is None else float(np.ravel(np.real(value))[0])
    return found if np.isfinite(found) else None


def _sixfold(places: Iterable[str], components: Iterable[str]) -> Iterator[str]:
    return (f"{place}.{component}" for place in places for component in components)
