"""Requests about a design in the studio: a link's card, motions and their limits, sensitivities, DOFs, gaps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from flexstage.analysis.assessment.judge import bench_of, value_or_reason
from flexstage.analysis.assessment.measures import frequency, platform_frequency
from flexstage.analysis.assessment.requirements import Sense, Verdict
from flexstage.analysis.assessment.sensitivities import Sensitivities, sensitivities, slope, step_parameters, steppable
from flexstage.analysis.attempt import Attempts
from flexstage.analysis.bench import StageResults
from flexstage.analysis.caveats import part_warnings
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.workspace.strength import sized_links
from flexstage.analysis.workspace.stroke import stroke_limits
from flexstage.analysis.workspace.wrench import dead_wrenches
from flexstage.apps.studio.design.reading import design, finite, link_lines, problems_of
from flexstage.apps.studio.protocol import (
    Card,
    Clash,
    Clearances,
    Fact,
    Freedoms,
    Matrix,
    Motion,
    Place,
    Posed,
    Screw,
    Slope,
    Slopes,
)
from flexstage.apps.studio.results import bench, judged, largest, matrix
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.labelled import NOISE, ratio_units
from flexstage.base.labelled import Matrix as Labelled
from flexstage.base.number import Array, first_design
from flexstage.base.session import SESSION
from flexstage.beams.compliance import compliance, stiffness
from flexstage.beams.stress import stress
from flexstage.mechanism.addresses.address import addresses, get
from flexstage.mechanism.assembly.expand import PlacedLink, PlacedSuperelement, expand, unit_of_copy
from flexstage.mechanism.geometry.contact import gaps
from flexstage.mechanism.store.lines import line_numbers, line_of
from flexstage.models.ideal import free_freedoms
from flexstage.models.linear.static import input_motion, static_gain
from flexstage.parts.part import Elastic, inner
from flexstage.show.display import format_value, to_typography
from flexstage.show.viewer.motions import strain_shares
from flexstage.show.viewer.parts import body_address, link_address, part_facts
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS

_WITHIN = 2e-3
"""Largest reported gap [m]."""
_MOST_GAPS = 60
_PLATFORM = tuple(f"platform.{name}" for name in COMPONENTS)


def card(text: str, file: str, name: str) -> Card:
    """Return the card of a link."""
    from flexstage.apps.studio.solids import hinge_facts  # takes long to import

    known = bench(text, file)
    links: Mapping[str, PlacedLink | PlacedSuperelement] = {**known.assembly.links, **known.assembly.superelements}
    if name not in links:
        raise refuse(name, "unknown link", suggest_nearest(name, links))
    link, lines = links[name], line_numbers(text)
    attempt = Attempts()
    own = link if isinstance(link, PlacedLink) else None
    soft = attempt.of("compliance", lambda: _six(own, "compliance"))
    stiff = attempt.of("stiffness", lambda: _six(own, "stiffness"))
    borne = attempt.of("stress", lambda: _stress(known, name)) or (None, None, None)
    shares = attempt.of("shares", lambda: _shares(known, name)) or {}
    drawn, part = link_address(known.mechanism, link), f"parts.{link.link.part}"
    where = [line for line in (line_of(drawn, lines), line_of(part, lines)) if line]
    verified = () if own is None else hinge_facts(known.mechanism, own)
    told = (each for each in part_warnings(known.mechanism) if each.where.partition(".")[0] in (name, link.drawn, part, link.link.part))
    return Card(
        name,
        link.link.part,
        inner(link.part).kind,
        link.joins,
        tuple(dict.fromkeys(where)),
        tuple(each for each in addresses(known.mechanism) if each.startswith((f"{part}.", f"{drawn}.", f"{name}.", f"{link.drawn}."))),
        () if own is None else tuple(each.value for each in free_freedoms(own)),
        soft,
        stiff,
        *borne,
        shares,
        tuple(_facts(link)),
        verified,
        problems_of(told, text, file),
        attempt.missing | ({} if verified else {"verified": "no stored results of finite elements: verify the design"}),
    )


def place(text: str, file: str, line: int) -> Place:
    """Return the links, bodies and numbers that belong to a line."""
    found, lines = design(text, file), line_numbers(text)
    near = max((row for row in lines.values() if row <= line), default=0)
    heads = [address for address, row in lines.items() if row == near]
    links = [name for name, row in link_lines(found, lines).items() if row == near]
    parts = {head.split(".")[1] for head in heads if head.startswith("parts.") and len(head.split(".")) > 1}
    links += [name for name, link in expand(found).links.items() if link.link.part in parts and name not in links]
    copies = unit_of_copy(found)
    bodies = [name for name in expand(found).bodies if any(f"{head}.".startswith(f"{body_address(copies, name)}.") for head in heads)]
    inside = (each for each in addresses(found) if line_of(each, lines) == near)
    return Place(line, tuple(links), tuple(bodies), tuple(inside))


def motion(text: str, file: str) -> Motion:
    """Compute the linear maps between inputs, platform motion and gauge readings, and the stress of every link."""
    known, attempt = bench(text, file), Attempts()
    model = known.model
    inputs = model.actuators
    gauges = tuple(known.assembly.gauges)
    bearing = attempt.of("stress", lambda: _bearing(text, file))
    return Motion(
        matrix(static_gain(model, _PLATFORM, inputs)),
        attempt.of("inputs", lambda: _inputs(known)),
        attempt.of("ideal", lambda: _ideal(known)),
        attempt.of("gauges", lambda: matrix(static_gain(model, gauges, inputs))) if gauges else None,
        bearing and matrix(bearing.per_input),
        bearing.at(np.zeros(len(inputs))) if bearing else {},
        {name: finite(limit) for name, limit in bearing.limits.items()} if bearing else {},
        attempt.missing,
    )


def posed(text: str, file: str, inputs: Mapping[str, float]) -> Posed:
    """Compute motion, readings and stress for strokes and forces relative to the bias, and list exceeded limits."""
    known = bench(text, file)
    names, gauges = known.model.actuators, tuple(known.assembly.gauges)
    strange = [name for name in inputs if name not in names]
    if strange:
        raise refuse(strange[0], "unknown actuator", suggest_nearest(strange[0], names))
    values = np.array([inputs.get(name, 0.0) for name in names])
    twist = static_gain(known.model, _PLATFORM, names).values @ values
    readings = static_gain(known.model, gauges, names).values @ values if gauges else np.zeros(0)
    bearing = Attempts().of("stress", lambda: _bearing(text, file))
    found = bearing.at(values) if bearing else {}
    read = dict(zip(gauges, readings.tolist(), strict=True))
    beyond = dict(_beyond_strokes(known, dict(zip(names, values.tolist(), strict=True))))
    beyond |= dict(_beyond_gauges(known, read))
    for name, limit in bearing.limits.items() if bearing else ():
        if found[name] > limit:
            beyond[name] = f"stress {format_value(found[name], 'Pa')} exceeds the allowable {format_value(limit, 'Pa')}"
    return Posed(tuple(twist.tolist()), read, found, beyond)


def slopes(text: str, file: str) -> Slopes:
    """Compute exact derivatives of frequencies and losses, and the effect of a 1 % change of each number on the lowest margin."""
    known = bench(text, file)
    found = sensitivities(known.mechanism, modes=12)
    platform = known.modes.platform
    columns = [(f"frequency.platform.{number}", index) for number, index in enumerate(platform, start=1) if index < len(found.frequencies)]
    worst = min((each for each in judged(text, file) if each.value is not None), key=lambda each: float(each.margin), default=None)
    margins = _margin_slopes(known, worst, found)
    rows: list[Slope] = []
    for place_, address in enumerate(found.parameters):
        gained = {name: float(found.frequency[place_, index]) for name, index in columns}
        gained |= {f"loss.{name}": float(found.loss[place_, column]) for column, name in enumerate(found.actuators)}
        rows.append(Slope(address, found.units[place_], float(found.values[place_]), dict(gained), margins.get(address)))
    rows.sort(key=lambda each: -abs(each.worst or 0.0))
    missing = dict(found.missing) | ({} if worst is not None else {"worst": "no requirement has a value"})
    return Slopes("" if worst is None else worst.requirement.key, tuple(rows), missing)


def freedoms(text: str, file: str) -> Freedoms:
    """Compute the platform's free and locked motions as screws, redundant constraints, free internal modes and locked strokes."""
    known = bench(text, file)
    found = known.kinematics
    reference = known.assembly.bodies["platform"].reference
    free = tuple(
        _screw(name, first_design(found.motion, 2)[:, column], first_design(reference, 1), found.first_length, _bent(found.strains, column))
        for column, name in enumerate(found.coordinates)
    )
    redundant = tuple(Fact(f"redundant {number}", ", ".join(each.constraints)) for number, each in enumerate(found.redundant, start=1))
    idle = tuple(Fact(", ".join(each.bodies), f"moves freely in {', '.join(each.links)}") for each in found.idle)
    blocked = tuple(
        Fact(name, f"locked by {', '.join(each.against)}; to unlock it, free {(' and ' if each.together else ' or ').join(each.free)}")
        for name, each in found.blocked.items()
    )
    locked = tuple(_locked(found.motion, known))
    return Freedoms(found.mobility, free, redundant, idle, locked, blocked)


def clearances(text: str, file: str) -> Clearances:
    """Compute overlaps and gaps between separate outlines, and violations of aperture and envelope."""
    found = design(text, file)
    rows = sorted(gaps(found, _WITHIN), key=lambda each: each.distance)[:_MOST_GAPS]
    told = tuple(Clash(each.first, each.second, each.distance, _gap_text(each.distance)) for each in rows)
    return Clearances(told, problems_of(bench(text, file).clearance.findings, text, file))


def _gap_text(distance: float) -> str:
    return to_typography(f"overlap {format_value(-distance, 'm')}" if distance < 0.0 else f"gap {format_value(distance, 'm')}")


def _six(link: PlacedLink | None, what: str) -> Matrix:
    if link is None or not isinstance(link.part, Elastic):
        raise refuse("link", "has no 6x6 matrix of its own", "Use the matrices of the stage")
    ends = (tuple(COMPONENTS), TWIST_UNITS), (tuple(FORCES), WRENCH_UNITS)
    law, (rows, columns) = (compliance, ends) if what == "compliance" else (stiffness, ends[::-1])
    return matrix(Labelled(first_design(law(link.part, link.material), 2), rows[0], columns[0], ratio_units(rows[1], columns[1])))


def _stress(known: StageResults, name: str) -> tuple[float | None, float | None, float | None]:
    """Peak stress over all strokes, its limit, and the safety."""
    found = known.stress
    if name not in found.links:
        raise refuse(name, "stress unknown, because the link has no cross-section", "For stacks, use the load limits")
    index = found.links.index(name)
    return tuple(finite(np.ravel(each)[index]) for each in (found.peak, found.allowed, found.safety))  # type: ignore[return-value]


def _shares(known: StageResults, name: str) -> dict[str, float]:
    """Its share of each actuator's lost motion."""
    found = {actuator: float(np.real(each.budget_by_link.get(name, 0.0))) for actuator, each in known.under_load.lost.actuators.items()}
    return {actuator: share if abs(share) > NOISE else 0.0 for actuator, share in found.items()}


def _facts(link: PlacedLink | PlacedSuperelement) -> Iterator[Fact]:
    yield Fact("joins", " – ".join(link.joins))
    for name, text in part_facts(inner(link.part)):
        yield Fact(name, text)
    if isinstance(link, PlacedLink) and link.material is not None:
        yield Fact("material", getattr(inner(link.part), "material", ""))


class Bearing:
    """Stress of links as a function of all strokes and forces, relative to the bias. Link wrenches depend linearly on the inputs."""

    def __init__(self, known: StageResults) -> None:
        model = known.model
        self._known = sized_links(known.assembly)
        if not self._known:
            raise refuse("stress", "no link has a cross-section", "Use notches, necks, leaves or rods")
        self.links = tuple(self._known)
        self.inputs = model.actuators
        outputs = tuple(f"{link}.{force}" for link in self.links for force in FORCES)
        self._gain = static_gain(model, outputs, self.inputs).values
        self._units = tuple(model.inputs[index].unit for index in model.input_index(self.inputs))
        self._rest = dead_wrenches(known.mechanism, model, outputs) + self._gain @ self._bias(known)
        limits = {name: None if link.material is None else finite(link.material.limit) for name, link in self._known.items()}
        self.limits = {name: np.nan if limit is None else limit for name, limit in limits.items()}

    def at(self, values: Array) -> dict[str, float]:
        """Return the peak stress [Pa] of each link at inputs (m,)."""
        return dict(zip(self.links, self._peaks(self._rest + self._gain @ values).tolist(), strict=True))

    @property
    def per_input(self) -> Labelled:
        """Peak stress of each link per unit of each single input, without bias and permanent loads."""
        values = np.array([self._peaks(column) for column in self._gain.T]).T.reshape(len(self.links), len(self.inputs))
        return Labelled(values, self.links, self.inputs, ratio_units(("Pa",) * len(self.links), self._units))

    def _bias(self, known: StageResults) -> Array:
        """Strokes (m,) at the bias, relative to zero voltage, at which hinges are relaxed."""
        limits = stroke_limits(known.mechanism) if known.assembly.strokes else None
        zero = {} if limits is None else dict(zip(limits.actuators, limits.low if limits.zero is None else limits.zero, strict=True))
        return np.array([-float(zero.get(name, 0.0)) for name in self.inputs])

    def _peaks(self, wrenches: Array) -> Array:
        """Peak stress (L,) under wrenches (6 L,); links of one part together."""
        rows = wrenches.reshape(-1, 6)
        groups: dict[tuple[int, int], list[int]] = {}
        for index, link in enumerate(self._known.values()):
            groups.setdefault((id(link.part), id(link.material)), []).append(index)
        peaks = np.zeros(len(rows))
        for members in groups.values():
            first = self._known[self.links[members[0]]]
            found = stress(first.part, first.material, rows[members])
            peaks[members] = np.nan if found is None else found.peak
        return peaks


@SESSION.keep(2)
def _bearing(text: str, file: str) -> Bearing:
    return Bearing(bench(text, file))


def _inputs(known: StageResults) -> Matrix:
    """Inputs per motion of the platform, corrected for elasticity."""
    return matrix(known.force_workspace("platform").per_motion if known.forced else known.under_load.lost.correction)


def _ideal(known: StageResults) -> Matrix:
    """The platform's twist per stroke without elasticity: V R_a^+."""
    found = known.kinematics
    mapping = found.mapping
    values = first_design(found.motion, 2) @ np.linalg.pinv(first_design(mapping.values, 2))
    return matrix(Labelled(values, _PLATFORM, mapping.rows, ratio_units(TWIST_UNITS, ("m",) * len(mapping.rows))))


def _beyond_strokes(known: StageResults, values: Mapping[str, float]) -> Iterator[tuple[str, str]]:
    if not known.assembly.strokes:
        return
    limits = stroke_limits(known.mechanism)
    for name, low, high in zip(limits.actuators, limits.low, limits.high, strict=True):
        if not low <= values[name] <= high:
            yield name, f"stroke exceeds its limit {format_value(float(low if values[name] < low else high), 'm')}"


def _beyond_gauges(known: StageResults, readings: Mapping[str, float]) -> Iterator[tuple[str, str]]:
    for name, reading in readings.items():
        gauge = known.assembly.gauges[name]
        half = finite(0.5 * np.asarray(gauge.gauge.range)) or np.inf
        if abs(reading) > half:
            yield name, f"reading {format_value(reading, gauge.unit)} exceeds the range of ±{format_value(half, gauge.unit)}"


def _margin_slopes(known: StageResults, worst: Verdict | None, found: Sensitivities) -> dict[str, float | None]:
    """Change of the worst requirement's margin by one per cent of each number, by complex step if the measure has a derivative."""
    if worst is None:
        return {}
    requirement, names = worst.requirement, found.parameters
    sign = (1.0 if requirement.sense is Sense.AT_LEAST else -1.0) / abs(requirement.limit or 1.0)
    if requirement.kind in (frequency, platform_frequency):
        index = int(requirement.name) - 1
        place_ = known.modes.platform[index] if requirement.kind is platform_frequency else index
        if place_ >= len(found.frequencies):
            return {}
        relative = found.frequency[:, place_] * found.values
        return {name: 0.01 * sign * float(each) for name, each in zip(names, relative, strict=True)}
    result: dict[str, float | None] = {}
    for chunk in steppable(known.mechanism, names):
        own = tuple(names[position] for position in chunk)
        batch = bench_of(step_parameters(known.mechanism, own))
        batch.command = known.command
        try:
            value = value_or_reason(batch, requirement)
        except (TypeError, ValueError):  # no batch of such numbers is supported (gravity)
            value = ""
        if isinstance(value, str) or not np.iscomplexobj(value):
            result |= dict.fromkeys(own)
            continue
        gradient = np.broadcast_to(slope(value), (len(own),))
        result |= {name: 0.01 * sign * float(each) * float(get(known.mechanism, name)) for name, each in zip(own, gradient, strict=True)}
    return result


def _screw(name: str, twist: Array, reference: Array, length: float, links: tuple[str, ...]) -> Screw:
    """A motion of a point [m] as a screw: on its axis, points move only along it."""
    moving, turning = twist[:3], twist[3:]
    rate = float(turning @ turning)
    if rate * length**2 < 1e-12 * float(moving @ moving):
        direction = moving / (float(np.linalg.norm(moving)) or 1.0)
        return Screw(name, _floats(twist), _floats(reference), _floats(direction), None, links)
    point = reference + np.cross(turning, moving) / rate
    return Screw(name, _floats(twist), _floats(point), _floats(turning / np.sqrt(rate)), float(turning @ moving) / rate, links)


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(each) + 0.0 for each in values)


def _bent(strains: Mapping[str, Array], column: int) -> tuple[str, ...]:
    """The links that deform in a motion."""
    size = {name: float(np.linalg.norm(first_design(each, 2)[:, column])) for name, each in strains.items()}
    most = max(size.values(), default=0.0)
    return tuple(name for name, each in size.items() if each > 1e-6 * most)


def _locked(motion_: Array, known: StageResults) -> Iterator[Screw]:
    """The constrained motions of the platform, complementary to the ideal ones, with the links that store their strain energy."""
    from scipy.linalg import qr  # takes long to import

    free, length = first_design(motion_, 2), known.kinematics.first_length
    scale = np.array([1.0] * 3 + [length] * 3)
    basis, sizes, _ = np.linalg.svd(free * scale[:, None], full_matrices=True)
    rank = int(np.sum(sizes > 1e-9 * sizes.max(initial=0.0))) if sizes.size else 0
    kept: Any = qr(basis[:, rank:] @ basis[:, rank:].T, pivoting=True)  # coordinate axes first, if they are in the complement
    axes = kept[2]
    rest = np.where(np.abs(kept[0]) > 1e-12, kept[0] * np.sign(kept[0][axes, range(6)]), 0.0)[:, : 6 - rank] / scale[:, None]
    reference = first_design(known.assembly.bodies["platform"].reference, 1)
    links = Attempts().of("links", lambda: _strained(known, rest)) or [()] * (6 - rank)
    for axis, twist, names in zip(axes.tolist(), rest.T, links, strict=False):
        yield _screw(COMPONENTS[axis], twist, reference, length, names)


def _strained(known: StageResults, twists: Array) -> list[tuple[str, ...]]:
    """The links of each imposed platform twist (6, k) with at least one per cent of its strain energy, the largest share first."""
    model = known.model
    wrenches = statics(model).stiffness.values @ twists
    shapes = input_motion(model, model.input_index(tuple(f"platform.{name}" for name in FORCES)), wrenches)
    shares = strain_shares(model, shapes)
    return [tuple(largest((name, float(each[place])) for name, each in shares.items())) for place in range(twists.shape[1])]
