"""Plausibility check: usual ranges of properties of materials, stacks, gauges, hinges and bodies (`plausible.toml`).

A value outside its range is a warning, not an error. The usual cause is a wrong unit.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from fractions import Fraction
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from flexstage.base.finding import Finding
from flexstage.base.units.dimension import Dimension
from flexstage.base.units.expression import Amount, ExpressionError, UnknownAmountError, evaluate, parse_expression
from flexstage.parts.body import Body, Payload, Solid
from flexstage.parts.gauge import Gauge
from flexstage.parts.material import Material
from flexstage.parts.part import Restricted

_GLASS = 2700.0  # kg/m^3: glass ceramics, ULE and cordierite are lighter


@cache
def _rules() -> list[dict[str, Any]]:
    text = resources.files("flexstage.parts").joinpath("plausible.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)["rules"]


def _dense_expansion(material: Material) -> Any:
    """Expansion of materials denser than glass ceramics, which have no lower limit."""
    return None if material.expansion is None else np.where(np.real(material.density) > _GLASS, np.real(material.expansion), 0.0)


def _noise_steps(gauge: Gauge) -> Any:
    """Standard deviation of the noise within the bandwidth, in steps of the resolution; `None` if there is none."""
    if gauge.noise_density is None or gauge.bandwidth is None:
        return None
    noise, step = np.broadcast_arrays(np.real(gauge.noise_density * gauge.bandwidth**0.5), np.real(gauge.resolution))
    return np.divide(noise, step, out=np.zeros(noise.shape), where=step > 0.0)


def _slenderness(solid: Solid) -> Any:
    """Ratio of the shortest to the longest side."""
    sides = np.real(solid.sides)
    return np.min(sides, axis=-1) / np.max(sides, axis=-1)


def _least_density(each: Body | Payload) -> Any:
    """Density of the ball with this mass and inertia: the body of least inertia for its density."""
    if each.mass is None or each.inertia is None:
        return None
    trace = np.real(each.inertia.xx) + np.real(each.inertia.yy) + np.real(each.inertia.zz)
    mass, trace = np.broadcast_arrays(np.real(each.mass), trace)
    radius = np.sqrt(np.divide(trace, 1.2 * mass, out=np.zeros(mass.shape), where=mass > 0.0))
    return np.divide(mass, 4.0 / 3.0 * np.pi * radius**3, out=np.zeros(mass.shape), where=radius > 0.0)


_WORKED_OUT: Mapping[str, Callable[[Any], Any]] = {
    "[dense_expansion]": _dense_expansion,
    "[noise_steps]": _noise_steps,
    "[slenderness]": _slenderness,
    "[least_density]": _least_density,
}


def _value(rule: Mapping[str, Any], item: Any) -> Any:
    """Value of an item compared by a rule; `None` if unspecified."""
    text = rule.get("value", rule["field"])
    if text in _WORKED_OUT:
        return _WORKED_OUT[text](item)
    known = {each.name: getattr(item, each.name) for each in fields(item)}
    if "area" in text:
        known["area"] = 0.25 * np.pi * item.diameter**2
    ratio = Dimension(Fraction(1))
    scope = {name: None if value is None else Amount(value, ratio) for name, value in known.items()}
    try:
        return evaluate(parse_expression(text), scope).value
    except (UnknownAmountError, ExpressionError):
        return None


def _finding(rule: Mapping[str, Any], where: str, item: Any) -> Finding | None:
    """Warning for an item outside the range; zero and absent values pass."""
    value = _value(rule, item)
    if value is None:
        return None
    sizes = np.abs(np.real(np.ravel(value)))
    outside = (sizes > 0.0) & ~((sizes >= rule["low"]) & (sizes <= rule["high"]))
    if not np.any(outside):
        return None
    number = float(np.real(np.ravel(value))[int(np.argmax(outside))])
    what = f"not plausible (got {number:.4g} {rule['unit']}, expected {rule['low']:.3g} to {rule['high']:.3g}; {rule['source']})"
    return Finding(f"{where}.{rule['field']}" if where else rule["field"], what, "Check the unit and the power of ten")


def implausible(items: Iterable[tuple[str, Any]]) -> Iterator[Finding]:
    """Return a warning for each value of the named items that is outside its usual range.

    >>> [finding.where for finding in implausible([("materials.steel", Material(young=200e6, poisson=0.3, density=7800.0))])]
    ['materials.steel.young']
    """
    for where, each in items:
        item = each.part if isinstance(each, Restricted) else each
        own = [rule for rule in _rules() if type(item).__name__ in rule["classes"]]
        results = [finding for rule in own if (finding := _finding(rule, where, item)) is not None]
        yield from {finding.where: finding for finding in reversed(results)}.values()
