"""Plausibility: the range in which the numbers of real materials, stacks, gauges and hinges lie, and where that range is from.

One table. A value outside is a warning, never refused: most often its unit has slipped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.finding import Finding
from flexstage.parts.body import Block, Body, Cylinder, Extrusion, Payload, Solid
from flexstage.parts.gauge import Gauge
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Restricted
from flexstage.parts.piezo import Piezo
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod

CATALOGUE = "the shipped catalogue"
_SOLIDS = "material-properties.org, elasticity of materials: polyethylene 1 GPa to diamond 1050 GPa"
_GLASS = 2700.0  # kg/m^3: glass ceramics, ULE and cordierite are lighter
_SUPER_INVAR = "materials above 2700 kg/m^3: Super Invar 0.3e-6 1/K, a factor of 6 less; glass ceramics are lighter"
_LOSSES = "single crystals 1e-6 to damping polymers 2"
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


def _strength(field: str) -> Callable[[Any], Any]:
    """A force that a stack bears, over the section of its ceramic."""
    return lambda each: None if (force := getattr(each, field)) is None else force / (0.25 * np.pi * each.diameter**2)


def _energy_density(stack: Piezo) -> Any:
    """Energy between both ends of the voltage range over the ceramic's volume."""
    if stack.capacitance is None or stack.voltage_low is None or stack.voltage_high is None:
        return None
    return 0.5 * stack.capacitance * (stack.voltage_high - stack.voltage_low) ** 2 / (0.25 * np.pi * stack.diameter**2 * stack.length)


def _bias_share(stack: Piezo) -> Any:
    if stack.bias is None or stack.voltage_low is None or stack.voltage_high is None:
        return None
    return stack.bias / (stack.voltage_high - stack.voltage_low)


def _dense_expansion(material: Material) -> Any:
    """The expansion of what is heavier than glass ceramic, whose own may be as small as it likes."""
    return None if material.expansion is None else np.where(np.real(material.density) > _GLASS, np.real(material.expansion), 0.0)


def _noise_steps(gauge: Gauge) -> Any:
    """Deviation of the noise within the bandwidth, in steps of the resolution; nothing where it has none."""
    if gauge.noise_density is None or gauge.bandwidth is None:
        return None
    noise, step = np.broadcast_arrays(np.real(gauge.noise_density * gauge.bandwidth**0.5), np.real(gauge.resolution))
    return np.divide(noise, step, out=np.zeros(noise.shape), where=step > 0.0)


def _slenderness(solid: Solid) -> Any:
    """The shortest over the longest side."""
    sides = np.real(solid.sides)
    return np.min(sides, axis=-1) / np.max(sides, axis=-1)


def _least_density(each: Body | Payload) -> Any:
    """The density of the ball that has this mass and inertia: no body of that density has less inertia."""
    if each.mass is None or each.inertia is None:
        return None
    trace = np.real(each.inertia.xx) + np.real(each.inertia.yy) + np.real(each.inertia.zz)
    mass, trace = np.broadcast_arrays(np.real(each.mass), trace)
    radius = np.sqrt(np.divide(trace, 1.2 * mass, out=np.zeros(mass.shape), where=mass > 0.0))
    return np.divide(mass, 4.0 / 3.0 * np.pi * radius**3, out=np.zeros(mass.shape), where=radius > 0.0)


def _ratio(of: str, to: str) -> Callable[[Any], Any]:
    return lambda each: None if getattr(each, of) is None or getattr(each, to) is None else getattr(each, of) / getattr(each, to)


def _within(factor: float, low: str, high: str) -> str:
    return f"{CATALOGUE} has {low} to {high}; a factor of {factor:g} more either way"


_RIGID = "a thinner one is no rigid body"
_BALL = "osmium, and a ball, which has the least inertia of all bodies of its mass"
_FLEXURES = "resonator legs of 2 um (COMSOL application 477) to blade springs of 4.6 mm (aLIGO in GWINC); a factor of 10 more either way"


def _thickness(field: str) -> Rule:
    return Rule(field, lambda each: getattr(each, field), 0.2e-6, 0.046, "m", _FLEXURES)


RULES: Mapping[type, tuple[Rule, ...]] = {
    **dict.fromkeys((Leaf, ReinforcedLeaf, Notch, Neck), (_thickness("thickness"),)),
    Rod: (_thickness("diameter"),),
    Material: (
        Rule("young", lambda each: each.young, 1e9, 1.05e12, "Pa", _SOLIDS),
        Rule("density", lambda each: each.density, 2530.0 / 3.0, 3.0 * 8250.0, "kg/m^3", _within(3.0, "2530 (Zerodur)", "8250 (C17200)")),
        Rule("expansion", lambda each: each.expansion, 1e-9, 170e-6, "1/K", _GROWTH),
        Rule("expansion", _dense_expansion, 5e-8, 170e-6, "1/K", _SUPER_INVAR),
        Rule("loss_factor", lambda each: each.loss_factor, 1e-6, 2.0, "of the energy", _LOSSES),
        Rule(
            "yield_stress",
            _ratio("yield_stress", "young"),
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
        Rule("capacitance", _energy_density, 1.6e3, 7.9e5, "J/m^3 at full range", _within(10.0, "1.6e4", "7.9e4")),
        Rule("maximum_load", _strength("maximum_load"), 6.4e6, 7.5e8, "Pa", _within(10.0, "64 MPa", "75 MPa")),
        Rule("tensile_limit", _strength("tensile_limit"), 3.6e5, 7.5e7, "Pa", _within(10.0, "3.6 MPa", "7.5 MPa")),
        Rule("preload", _ratio("preload", "maximum_load"), 1e-3, 1.0, "of the maximum load", "less could not be told from none"),
        Rule("bias", _bias_share, 1e-3, 1e3, "of the voltage range", "less could not be told from none"),
        Rule(
            "resonance",
            lambda each: None if each.resonance is None else 4.0 * each.resonance * each.length,
            320.0,
            60e3,
            "m/s as speed of sound, 4 f L",
            _within(10.0, "3200 m/s", "6050 m/s"),
        ),
        Rule("expansion", lambda each: each.expansion, 1e-7, 1e-4, "1/K", "PZT has -6e-6 to 9e-6; a factor of 10 more either way"),
        Rule("loss_factor", lambda each: each.loss_factor, 2e-4, 1.0, "of the energy", _within(100.0, "0.02", "0.02")),
        Rule(
            "mass",
            lambda each: each.mass / (0.25 * np.pi * each.diameter**2 * each.length),
            1.2e3,
            1.2e5,
            "kg/m^3 of its ceramic's volume",
            _within(10.0, "7.3e3", "1.3e4"),
        ),
    ),
    **dict.fromkeys((Block, Cylinder, Extrusion), (Rule("size", _slenderness, 1.0 / 250.0, 1.0, "of its longest side", _RIGID),)),
    **dict.fromkeys((Body, Payload), (Rule("inertia", _least_density, 0.0, 22.6e3, "kg/m^3 at least", _BALL),)),
    Gauge: (
        Rule("range", lambda each: each.range, 1e-6, 0.05, "m", _within(100.0, "100 um", "500 um")),
        Rule("resolution", _ratio("resolution", "range"), 2e-8, 4e-3, "of its range", f"8 bits to a thousandth of {CATALOGUE}'s 2e-5"),
        Rule("bandwidth", lambda each: each.bandwidth, 10.0, 2.5e6, "Hz", _within(500.0, "5 kHz", "5 kHz")),
        Rule("noise_density", _noise_steps, 1e-2, 1e2, "steps of its resolution in its bandwidth", "noise and resolution go together"),
        Rule("noise_density", lambda each: each.noise_density, 5e-15, 7.5e-8, "m/Hz^0.5", _within(1000.0, "5e-12", "7.5e-11")),
    ),
}


def implausible(items: Iterable[tuple[str, Any]]) -> Iterator[Finding]:
    """Findings about named items whose numbers lie outside the table, one a number.

    >>> [finding.where for finding in implausible([("materials.steel", Material(young=200e6, poisson=0.3, density=7800.0))])]
    ['materials.steel.young']
    """
    for where, each in items:
        item = each.part if isinstance(each, Restricted) else each
        found = [finding for rule in RULES.get(type(item), ()) if (finding := rule.finding(where, item)) is not None]
        yield from {finding.where: finding for finding in reversed(found)}.values()
