"""Plausibility: the range in which the numbers of real materials, stacks, gauges and hinges lie, and where that range is from.

One table. A value outside is a caution, never refused: most often its unit has slipped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.finding import Finding
from flexstage.parts.gauge import Gauge
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.rod import Rod

CATALOGUE = "the shipped catalogue"
_SOLIDS = "material-properties.org, elasticity of materials: polyethylene 1 GPa to diamond 1050 GPa"
_GROWTH = "the shipped catalogue, -5e-6 1/K (PIC255), to polyethylene, 170e-6 1/K (lon-so.com, coefficient of thermal expansion)"


@dataclass(frozen=True)
class Rule:
    """A number of a class, the plausible range of its size in `unit`, and the `source` of the range; zero and absent values pass."""

    field: str
    value: Callable[[Any], Any]
    low: float
    high: float
    unit: str
    source: str

    def finding(self, where: str, item: Any) -> Finding | None:
        """What is told of an item outside the range."""
        value = self.value(item)
        if value is None:
            return None
        sizes = np.abs(np.real(np.ravel(value)))
        outside = (sizes > 0.0) & ~((sizes >= self.low) & (sizes <= self.high))
        if not np.any(outside):
            return None
        told = float(np.real(np.ravel(value))[int(np.argmax(outside))])
        what = f"{told:.4g} {self.unit} is not plausible: real ones have {self.low:.3g} to {self.high:.3g} ({self.source})"
        return Finding(f"{where}.{self.field}" if where else self.field, what, "Check the unit and the power of ten")


def _stack_modulus(stack: Piezo) -> Any:
    return stack.stiffness * stack.length / (0.25 * np.pi * stack.diameter**2)


def _within(factor: float, low: str, high: str) -> str:
    return f"{CATALOGUE} has {low} to {high}; a factor of {factor:g} more either way"


_FLEXURES = "resonator legs of 2 um (COMSOL application 477) to blade springs of 4.6 mm (aLIGO in GWINC); a factor of 10 more either way"


def _thickness(field: str) -> Rule:
    return Rule(field, lambda each: getattr(each, field), 0.2e-6, 0.046, "m", _FLEXURES)


RULES: Mapping[type, tuple[Rule, ...]] = {
    **dict.fromkeys((Leaf, Notch, Neck), (_thickness("thickness"),)),
    Rod: (_thickness("diameter"),),
    Material: (
        Rule("young", lambda each: each.young, 1e9, 1.05e12, "Pa", _SOLIDS),
        Rule("density", lambda each: each.density, 2530.0 / 3.0, 3.0 * 8250.0, "kg/m^3", _within(3.0, "2530 (Zerodur)", "8250 (C17200)")),
        Rule("expansion", lambda each: each.expansion, 0.0, 170e-6, "1/K", _GROWTH),
        Rule(
            "yield_stress",
            lambda each: None if each.yield_stress is None else each.yield_stress / each.young,
            7e-5,
            0.1,
            "of Young's modulus",
            _within(10.0, "0.7e-3", "1e-2"),
        ),
    ),
    Piezo: (
        Rule(
            "stroke",
            lambda each: each.stroke / each.length,
            0.926e-3 / 3.0,
            3.0 * 1.667e-3,
            "of the stack's length",
            _within(3.0, "0.93e-3", "1.67e-3"),
        ),
        Rule("stiffness", _stack_modulus, 3.3e9, 360e9, "Pa as modulus k L/A", _within(10.0, "33 GPa", "36 GPa")),
        Rule("voltage_low", lambda each: each.voltage_low, 3.0, 1e4, "V", _within(10.0, "30 V", "1000 V")),
        Rule("voltage_high", lambda each: each.voltage_high, 3.0, 1e4, "V", _within(10.0, "30 V", "1000 V")),
        Rule("capacitance", lambda each: each.capacitance, 4e-9, 1e-3, "F", _within(100.0, "0.4 uF", "10 uF")),
        Rule(
            "mass",
            lambda each: each.mass / (0.25 * np.pi * each.diameter**2 * each.length),
            1.2e3,
            1.2e5,
            "kg/m^3 of its ceramic's volume",
            _within(10.0, "7.3e3", "1.3e4"),
        ),
    ),
    Gauge: (
        Rule("range", lambda each: each.range, 1e-6, 0.05, "m", _within(100.0, "100 um", "500 um")),
        Rule(
            "resolution",
            lambda each: each.resolution / each.range,
            2e-8,
            2e-2,
            "of its range",
            _within(1000.0, "2e-5", "2e-5"),
        ),
        Rule("noise_density", lambda each: each.noise_density, 5e-15, 7.5e-8, "m/Hz^0.5", _within(1000.0, "5e-12", "7.5e-11")),
    ),
}


def implausible(items: Iterable[tuple[str, Any]]) -> Iterator[Finding]:
    """Findings about named items whose numbers lie outside the table.

    >>> [finding.where for finding in implausible([("materials.steel", Material(young=200e6, poisson=0.3, density=7800.0))])]
    ['materials.steel.young']
    """
    for where, each in items:
        item = each.part if isinstance(each, Restricted) else each
        found = (rule.finding(where, item) for rule in RULES.get(type(item), ()))
        yield from (finding for finding in found if finding is not None)
