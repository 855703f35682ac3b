"""Pairs of an architecture and an actuator, and the bounds that exclude them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from flexstage.base.units.expression import evaluate, parse_expression
from flexstage.base.units.quantity import RATIO
from flexstage.studies.synthesis import bounds
from flexstage.studies.synthesis.architecture import Architecture, CatalogueActuator, catalogue_entry, scope
from flexstage.studies.synthesis.specification import FREQUENCY_KEYS, Specification


@dataclass(frozen=True)
class Shortfall:
    """A bound that excludes a pair: the requirement, the best possible value and the required value [SI], and the reason.

    If `universal` is true, the bound holds for every mechanism with these actuators; otherwise, it holds for this architecture only.
    """

    requirement: str
    best: float
    required: float
    unit: str
    reason: str
    universal: bool = False

    @property
    def ratio(self) -> float:
        """Ratio of the best possible value to the required value."""
        return self.best / self.required


@dataclass(frozen=True)
class CandidatePair:
    """An architecture with an actuator."""

    architecture: Architecture
    actuator: CatalogueActuator

    @property
    def name(self) -> str:
        """Name of the pair: architecture and actuator."""
        return f"{self.architecture.name} with {self.actuator.name}"


@dataclass(frozen=True)
class ImpossiblePair:
    """A pair that bounds exclude. `shortfall` is the bound with the smallest `ratio`; universal bounds take precedence."""

    architecture: str
    actuator: str
    shortfall: Shortfall


def _energy(pair: CandidatePair) -> float | None:
    """Stroke energy of all actuators of a pair [J]; `None` of coils."""
    actuator = pair.actuator
    if actuator.kind == "voice_coil":
        return None
    return bounds.stroke_energy(actuator.stroke, actuator.stiffness, pair.architecture.count)


def energy_groups(spec: Specification, pair: CandidatePair) -> list[tuple[float, dict[str, float]]]:
    """Return energies [J] of actuators with the displacements that they reach at once: one energy for each axis, or one for all axes."""
    energy, moved = _energy(pair) or math.inf, spec.displacements
    if pair.architecture.own:
        return [(energy / len(moved), {axis: value}) for axis, value in moved.items()]
    return [(energy, moved)] if spec.together else [(energy, {axis: value}) for axis, value in moved.items()]


def demand(spec: Specification, pair: CandidatePair) -> float:
    """Return the ratio of the required energy to the energy of the actuators. Pairs with a small energy ratio are searched first."""
    frequency = spec.least(FREQUENCY_KEYS[0])
    return 0.0 if frequency is None else max(bounds.efficiency(frequency, *each, spec.masses) for each in energy_groups(spec, pair))


def shortfalls(spec: Specification, pair: CandidatePair) -> Iterator[Shortfall]:
    """Yield the bounds that a pair cannot meet.

    >>> from flexstage.studies.synthesis.architecture import architectures, catalogue_actuators
    >>> from flexstage.studies.synthesis.specification import example
    >>> spec = example()
    >>> pairs = [CandidatePair(architectures()["carriages"], each) for each in catalogue_actuators(spec)["piezo"]]
    >>> [each.actuator.name for each in pairs if next(shortfalls(spec, each), None) is None]
    ['PSt 1000/10/150 VS18', 'PSt 1000/16/200 VS25']
    """
    frequency = spec.least(FREQUENCY_KEYS[0])
    if frequency is not None and pair.actuator.kind != "voice_coil":
        yield from _energy_shortfalls(spec, pair, frequency)
    elif frequency is not None:
        yield from _force_shortfalls(spec, pair, frequency)
    yield from _stroke_shortfalls(spec, pair)
    yield from _leaf_shortfalls(spec, pair)


def _energy_shortfalls(spec: Specification, pair: CandidatePair, frequency: float) -> Iterator[Shortfall]:
    whole = _energy(pair)
    for energy, moved in ((each, moved) for own, moved in energy_groups(spec, pair) for each in dict.fromkeys((whole, own)) if each):
        best = bounds.frequency_bound(energy, moved, spec.masses)
        if best < frequency:
            factor = bounds.displacement_factor(energy, moved, spec.masses, frequency)
            needed = bounds.required_energy(moved, spec.masses, frequency)
            reason = (
                f"{', '.join(moved)}: the actuators store {energy:.3g} J, but {needed:.3g} J is needed; "
                f"only {100 * factor:.0f} % of the displacement, or a frequency of {best:.4g} Hz, is possible"
            )
            yield Shortfall("frequency", best, frequency, "Hz", reason, universal=energy == whole)


def _force_shortfalls(spec: Specification, pair: CandidatePair, frequency: float) -> Iterator[Shortfall]:
    source = bounds.ForceSource(pair.actuator.force, float(pair.actuator.part.mass), pair.actuator.stroke, pair.architecture.count)
    for axis, value in spec.displacements.items():
        if axis.startswith("r"):
            continue  # the arm of the force is a matter of the box
        best = bounds.force_frequency_bound(source, value, spec.masses[axis])
        if best < frequency:
            reason = f"the continuous force of {source.count} coils, {source.force:.3g} N each, is too small even with the best lever"
            yield Shortfall("frequency", best, frequency, "Hz", reason, universal=True)


def _stroke_shortfalls(spec: Specification, pair: CandidatePair) -> Iterator[Shortfall]:
    stroke, moved = pair.actuator.stroke, spec.displacements
    if pair.architecture.direct:
        for axis, value in moved.items():
            if value > 0.5 * stroke:
                yield Shortfall(f"motion.{axis}", 0.5 * stroke, value, "m", "the actuator pushes the platform without a lever")
    if pair.architecture.struts:
        flat = max(moved["x"], moved["y"])
        least = 1.0 / math.hypot(0.5 / moved["z"], 0.5 / (flat * math.cos(math.pi / 6.0)))
        if stroke < least:
            reason = f"the strut stroke is {1e6 * stroke:.4g} um, but x and z need {1e6 * least:.4g} um with struts of any slope"
            yield Shortfall("motion.z", moved["z"] * stroke / least, moved["z"], "m", reason)


def _leaf_shortfalls(spec: Specification, pair: CandidatePair) -> Iterator[Shortfall]:
    rule = pair.architecture.leaf
    if rule is None:
        return
    material = catalogue_entry(spec, "materials", spec.make.flexures)
    if material.yield_stress is None:
        return
    travel = rule.share * max(value for axis, value in spec.displacements.items() if axis in "xyz")
    stress = float(material.yield_stress) / (spec.least("safety", RATIO) or 2.0)
    needed = bounds.leaf_length(spec.make.thinnest, travel, float(material.young or 0.0), float(material.contraction), stress)
    room = float(evaluate(parse_expression(rule.room), scope(pair.architecture, spec, pair.actuator)).value)
    if needed > room:
        reason = f"the thinnest leaves must be {1e3 * needed:.3g} mm long to bend by {1e3 * travel:.3g} mm"
        yield Shortfall("box", room, needed, "m", reason)
