"""Caveats of results: warnings, and default values of unspecified fields."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from flexstage.analysis.assessment.measures import drift
from flexstage.analysis.assessment.requirements import requirements
from flexstage.analysis.linear_statics.body_effect import body_effects, body_findings
from flexstage.analysis.loaded.course import path_findings
from flexstage.analysis.loaded.seating import seating, seating_findings
from flexstage.analysis.loaded.standing import drawn, kinematics, load_factors, standing
from flexstage.analysis.validity import validity
from flexstage.analysis.workspace.clearance import bounds, clearance
from flexstage.analysis.workspace.load import load_share
from flexstage.analysis.workspace.small import small_motion
from flexstage.analysis.workspace.stops import single_strokes
from flexstage.analysis.workspace.strength import hinge_stress
from flexstage.analysis.workspace.stroke import StrokeLimits, stroke_limits
from flexstage.base.finding import DesignError, DesignWarning, Finding, name_first
from flexstage.base.number import stack
from flexstage.base.processes.threads import one_thread
from flexstage.base.record import INNER
from flexstage.base.session import SESSION
from flexstage.base.units.quantity import LENGTH
from flexstage.base.units.unit import show
from flexstage.beams.mass import mass
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.assembly.expansion import ground_of
from flexstage.mechanism.checks import check as find_errors
from flexstage.mechanism.drawn import as_drawn
from flexstage.mechanism.geometry.contact import contact_findings
from flexstage.mechanism.geometry.outline import outlines
from flexstage.mechanism.grammar.formulas import unused_findings
from flexstage.mechanism.mechanism import PLATFORM, Mechanism, StructuralDamping
from flexstage.models.flexible_bodies import body_flexibilities
from flexstage.models.linear.model import LinearModel
from flexstage.parts.body import Body
from flexstage.parts.compliance_matrix import ComplianceMatrix, Joint
from flexstage.parts.contact import Contact
from flexstage.parts.part import Restricted, material_of
from flexstage.parts.piezo import Piezo
from flexstage.parts.plausible import implausible


@dataclass(frozen=True)
class Default(Finding):
    """Default value of an unspecified field. `without` contains the kinds of results that do not depend on the field."""

    without: Annotated[frozenset[str], INNER] = frozenset()


_LEAST_FALL, _MOST_FALL = 0.16, 250.0
_FARTHEST = 10.0
_STILL = frozenset({"mapping", "lost-motion", "drift", "budget"})
_LINEAR = frozenset({"mapping", "stiffness", "lost-motion", "modes", "response", "drift", "sensitivities", "solid", "verify", "calibrate"})
_UNDAMPED = _STILL | {"stiffness", "workspace", "sensitivities", "calibrate"}
_MEASURED = frozenset({"rig", "identify", "compare", "update"})


@dataclass(frozen=True)
class Caveats:
    """Caveats of a result: `warnings`, and `defaults` of unspecified fields."""

    warnings: tuple[Finding, ...] = ()
    defaults: tuple[Default, ...] = ()

    def defaults_of(self, kind: str) -> tuple[Default, ...]:
        """Return the defaults on which a kind of result (e.g. `modes` or `workspace`) depends."""
        return tuple(each for each in self.defaults if kind not in each.without)


@SESSION.keep(8)
def caveats(mechanism: Mechanism) -> Caveats:
    """Return warnings and defaults of a description; the results for the last eight descriptions are cached.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [each.where for each in caveats(double_triangle()).warnings]
    ['B4/lever, B5/lever, B6/lever', 'platform']
    """
    return Caveats(design_warnings(mechanism), defaults(mechanism))


def defaults(mechanism: Mechanism) -> tuple[Default, ...]:
    """Return the default value of each unspecified field, with a hint that shows how to specify the field.

    >>> defaults(Mechanism("stage"))
    ()
    """
    return (
        *_stack_defaults(mechanism),
        *_massless_defaults(mechanism),
        *_sticking(mechanism),
        *_lossless(mechanism),
        *_ground_default(mechanism),
        *_rigid_bodies(mechanism),
    )


def _stack_defaults(mechanism: Mechanism) -> Iterator[Default]:
    for name, piezo in _shared_stacks(mechanism).items():
        if np.all(np.asarray(piezo.mass) == 0.0):
            advice = 'Specify the mass, which lowers frequencies: mass = "0.12 kg"'
            yield Default(f"parts.{name}", "stack mass 0 by default", advice, _STILL)
        if piezo.bias is None and piezo.voltage_low is not None and piezo.voltage_high is not None:
            middle = np.ravel(0.5 * (np.real(piezo.voltage_low) + np.real(piezo.voltage_high)))[0]
            what, advice = f"bias {middle:g} V (mid-range) by default", f'Specify the voltage of zero stroke: bias = "{middle:g} V"'
            yield Default(f"parts.{name}", what, advice, _LINEAR | _MEASURED)


def _massless_defaults(mechanism: Mechanism) -> Iterator[Default]:
    """Mass of restricted parts, which are massless springs."""
    masses: dict[str, float] = {}
    for link in expand(mechanism).links.values():
        if isinstance(link.part, Restricted) and not isinstance(link.part.part, Joint):
            try:
                own = np.real(mass(link.part.part, link.material))
            except DesignError:
                continue  # a material without density
            masses[f"parts.{link.link.part}"] = float(np.max(own[..., 0, 0] + 2.0 * own[..., 0, 6] + own[..., 6, 6]))
    for where, size in masses.items():
        if size > 0.0:
            advice = "Add this mass to the adjacent bodies"
            yield Default(where, f"mass of a restricted part omitted ({size:.4g} kg)", advice, _STILL | {"stiffness"})


def _sticking(mechanism: Mechanism) -> Iterator[Default]:
    """Contacts without specified friction."""
    for name, part in mechanism.parts.items():
        if isinstance(part, Contact) and part.friction is None:
            yield Default(f"parts.{name}", "no slip by default", "For a check of slip, specify friction = 0.15", frozenset({"mapping"}))


def _lossless(mechanism: Mechanism) -> Iterator[Default]:
    """Materials, stacks and matrices without a specified loss factor under structural damping."""
    if not isinstance(mechanism.damping, StructuralDamping):
        return
    hints: dict[str, str] = {}
    for link in expand(mechanism).links.values():
        part = as_drawn(mechanism, link).part
        inner = part.part if isinstance(part, Restricted) else part
        material = material_of(inner)
        holder = mechanism.materials[material] if material else inner
        if not isinstance(inner, Joint) and getattr(holder, "loss_factor", None) is None:
            where = f"materials.{material}" if material else f"parts.{link.link.part}"
            hints[where] = (
                "Specify the drawn part that the matrix replaces" if isinstance(inner, ComplianceMatrix) else "Specify loss_factor = 0.002"
            )
    for item in expand(mechanism).superelements.values():
        if item.part.loss_factor is None:
            hints[f"parts.{item.link.part}"] = "Specify loss_factor = 0.002"
    for where, advice in hints.items():
        yield Default(where, "loss factor 0 by default (structural damping)", advice, _UNDAMPED)


def _ground_default(mechanism: Mechanism) -> Iterator[Default]:
    """Default ground material, if a requirement is on drift."""
    try:
        requested = any(line.kind is drift for line in requirements(mechanism))
        ground = ground_of(mechanism) if requested else None
    except DesignError:
        return  # the requirement reports the missing field
    if ground is not None and not ground.stated:
        advice = f'Specify this material, because drift depends on it: ground = "{ground.material}"'
        yield Default(
            "ground",
            f"material {ground.material} by default: {ground.source}",
            advice,
            _LINEAR - {"drift"} | _MEASURED | {"workspace", "loop"},
        )


def _rigid_bodies(mechanism: Mechanism) -> Iterator[Default]:
    """Rigid bodies without an estimate of flexibility, by reason."""
    reasons = body_flexibilities(mechanism).reasons
    if mechanism.elastic_bodies:
        what = "the lumped model includes the flexibility of bodies, estimated from their outlines"
        yield Default("elastic_bodies", what, "Compare with flexstage verify", frozenset({"mapping"}))
    for reason in dict.fromkeys(reasons.values()):
        names = name_first([name for name, each in reasons.items() if each == reason])
        yield Default(names, f"rigid by default, flexibility unknown: {reason}", "Compare with flexstage verify", _STILL)


def _shared_stacks(mechanism: Mechanism) -> dict[str, Piezo]:
    """Stacks that links use, by the name of their part."""
    used = {link.link.part for link in expand(mechanism).links.values()}
    inner = {name: part.part if isinstance(part, Restricted) else part for name, part in mechanism.parts.items() if name in used}
    return {name: part for name, part in inner.items() if isinstance(part, Piezo)}


@one_thread
def design_warnings(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Return warnings about loads, parts outside the range of beam theory, blocked strokes and misplaced outlines.

    Outlines are misplaced if they interfere with each other, or enter the aperture. If a link overrides values of its part, a warning about
    this part names the link.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [each.where for each in design_warnings(double_triangle())]
    ['B4/lever, B5/lever, B6/lever', 'platform']
    """
    factors = load_factors(mechanism)
    return (
        *(() if factors is None else (*factors.refusals, *factors.warnings)),
        *_tension_findings(mechanism),
        *implausible(_catalogue_items(mechanism)),
        *_disproportions(mechanism),
        *_overload_findings(mechanism),
        *_points(mechanism),
        *part_warnings(mechanism),
        *_blockages(mechanism),
        *_large_motions(mechanism),
        *contact_findings(mechanism),
        *_room(mechanism),
        *_flexible_bodies(mechanism),
        *unused_findings(mechanism),
    )


def _large_motions(mechanism: Mechanism) -> Iterator[Finding]:
    """Single-axis strokes beyond small displacements; none if the strokes do not determine the platform."""
    with suppress(DesignError):
        result = kinematics(mechanism)
        yield from small_motion(mechanism, result).warnings(single_strokes(mechanism, result))


def _catalogue_items(mechanism: Mechanism) -> Iterator[tuple[str, Any]]:
    """Materials, parts, gauges, payloads, bodies and their outlines by address; also parts of single instances."""
    for name in ("materials", "parts", "sensors", "payloads"):
        yield from ((f"{name}.{key}", item) for key, item in getattr(mechanism, name).items())
    for link in expand(mechanism).links.values():
        if link.described.part != mechanism.parts[link.link.part]:
            yield link.name, link.part
    for where, body in _drawn_bodies(mechanism).items():
        yield where, body
        yield from ((f"{where}.solids.{name}", solid) for name, solid in body.solids.items())


def _drawn_bodies(mechanism: Mechanism) -> dict[str, Body]:
    """Bodies by address, those of units once."""
    bodies = {f"bodies.{name}": body for name, body in mechanism.bodies.items()}
    return bodies | {f"units.{unit}.bodies.{name}": body for unit, drawn in mechanism.units.items() for name, body in drawn.bodies.items()}


def _disproportions(mechanism: Mechanism) -> Iterator[Finding]:
    """Implausible gravity; envelope, aperture, inertias and points of an order of magnitude unlike the stage."""
    check = "Check the unit and the power of ten"
    fall = float(np.max(np.linalg.norm(np.real(stack(mechanism.gravity)), axis=-1)))
    if fall and not _LEAST_FALL <= fall <= _MOST_FALL:
        yield Finding("gravity", f"gravity not plausible (got {fall:.4g} m/s^2, expected {_LEAST_FALL:g} to {_MOST_FALL:g} m/s^2)", check)
    assembly = expand(mechanism)
    yield from _far_links(assembly)
    low, high, _ = bounds(outlines(assembly))
    extent = float(np.max(np.linalg.norm(high - low, axis=-1)))
    middle = 0.5 * (low + high)
    points = {f"{body}.points.{name}": float(np.max(np.linalg.norm(at - middle, axis=-1))) for name, (body, at) in assembly.points.items()}
    for where, size, least, most in (*_sizes(mechanism), *((name, distance, 0.0, 50.0) for name, distance in points.items())):
        if extent and not least * extent <= size <= most * extent:
            yield Finding(
                where, f"length not plausible (got {show(size, LENGTH, digits=4)} in a stage of {show(extent, LENGTH, digits=4)})", check
            )


def _far_links(assembly: Assembly) -> Iterator[Finding]:
    """Links implausibly far from the platform."""
    if PLATFORM not in assembly.bodies:
        return
    centre = assembly.bodies[PLATFORM].reference
    for name, link in assembly.links.items():
        distance = float(np.max(np.linalg.norm(np.real(link.frame.position - centre), axis=-1)))
        if distance > _FARTHEST:
            what = f"distance to the platform not plausible (got {distance:.4g} m, expected {_FARTHEST:g} m or less)"
            yield Finding(name, what, "Check the unit and the power of ten")


def _sizes(mechanism: Mechanism) -> Iterator[tuple[str, float, float, float]]:
    """Lengths by address with their plausible range relative to the stage size; radius of gyration for an inertia."""
    for axis, side in zip("xyz", mechanism.envelope or (), strict=False):
        yield f"envelope.{axis}", float(np.max(np.real(side))), 0.0, 50.0
    if mechanism.opening is not None:
        yield "opening.size", float(np.min(np.real(stack(mechanism.opening.size)))), 2e-3, np.inf
    for where, item in (_drawn_bodies(mechanism) | {f"payloads.{name}": load for name, load in mechanism.payloads.items()}).items():
        if item.mass is not None and item.inertia is not None and np.all(np.real(item.mass) > 0.0):
            largest = np.real(np.max(np.stack(np.broadcast_arrays(item.inertia.xx, item.inertia.yy, item.inertia.zz)), axis=0))
            yield f"{where}.inertia", float(np.max(np.sqrt(largest / np.real(item.mass)))), 0.0, 3.0


def _overload_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Yielding hinges, lifted balls and overloaded stacks under permanent load only."""
    for judged in (_stress_findings, _compression_findings, _seat_findings):
        with suppress(DesignError):
            yield from judged(mechanism, drawn(mechanism))


def _flexible_bodies(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Rigid bodies with a significant flexibility; none if the lumped or the ideal model is refused."""
    if mechanism.elastic_bodies:
        return ()
    try:
        return tuple(body_findings(body_effects(mechanism, drawn(mechanism), kinematics(mechanism))))
    except DesignError:
        return ()


def _stress_findings(mechanism: Mechanism, model: LinearModel) -> Iterator[Finding]:
    stress = hinge_stress(mechanism, model, StrokeLimits((), np.zeros(0), np.zeros(0)))
    safety = np.nan_to_num(np.real(stress.safety).reshape(-1, len(stress.links))[0], nan=np.inf)
    if np.min(safety, initial=np.inf) < 1.0:
        limit = stress.governing[stress.links.index(stress.weakest)]
        what = f"stress under weight, payloads and forces is {1.0 / float(np.min(safety)):.3g} times the {limit}"
        yield Finding(stress.weakest, what, "Check masses and forces, or strengthen the hinge")


def _seat_findings(mechanism: Mechanism, model: LinearModel) -> Iterator[Finding]:
    yield from seating_findings(seating(mechanism, model))


def _compression_findings(mechanism: Mechanism, model: LinearModel) -> Iterator[Finding]:
    share = load_share(mechanism, model)
    uses = np.real(share.usage(share.compression)).reshape(-1, len(share.actuators))[0]
    for name, use in zip(share.actuators, uses, strict=True):
        if use > 1.0:
            what = f"compression under preload, weight, payloads and forces is {use:.3g} times the maximum load of the stack"
            yield Finding(name, what, "Check masses and forces, or use a stronger stack")


def _points(mechanism: Mechanism) -> Iterator[Finding]:
    """Masses without inertia that are not marked as points."""
    bodies = _drawn_bodies(mechanism)
    loads = {f"payloads.{name}": load for name, load in mechanism.payloads.items()}
    for where, item in (bodies | loads).items():
        if item.mass is not None and np.any(np.real(item.mass) > 0.0) and item.inertia is None and not item.point:
            size = float(np.max(np.real(item.mass)))
            what = f"point mass of {size:.4g} kg without inertia: rotational frequencies are too high or missing"
            yield Finding(
                where,
                what,
                'Specify inertia = { xx = "...", yy = "...", zz = "..." } or an outline, or mark it as a point mass by point = true',
            )


def _tension_findings(mechanism: Mechanism) -> Iterator[Finding]:
    """Stacks in tension beyond their limits; none if their forces are unknown."""
    with suppress(DesignError):
        yield from load_share(mechanism, drawn(mechanism)).tension_findings(stroke_limits(mechanism).from_zero)


def _blockages(mechanism: Mechanism) -> Iterator[Finding]:
    """Blocked strokes or a blocked platform; none if the ideal model is refused."""
    with suppress(DesignError):
        result = kinematics(mechanism)
        yield from result.blockages
        if not result.mobility and not result.actuators:
            what = "links constrain all six degrees of freedom, and no ideal motion remains"
            yield Finding(PLATFORM, what, "Free the degrees of freedom of links for the required motion")


def model_findings(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Return the errors that prevent a model: actuators without a path to the platform, free internal modes, unreadable requirements.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> model_findings(double_triangle())
    ()
    """
    findings: list[Finding] = []
    for read in (requirements, kinematics, standing):
        try:
            read(mechanism)
        except DesignError as error:
            findings += error.findings
    return tuple(dict.fromkeys([*findings, *path_findings(mechanism)]))


def check(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Check a stage: return its errors, or its warnings if there is no error, as `flexstage check` lists them.

    `severity` of a finding distinguishes errors and warnings. The result is an empty tuple for a stage without errors and warnings.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> [finding.where for finding in check(double_triangle())]
    ['B4/lever, B5/lever, B6/lever', 'platform']
    >>> [finding.severity.value for finding in check(Mechanism("empty"))]
    ['error']
    """
    errors = find_errors(mechanism) or model_findings(mechanism)
    return errors or tuple(DesignWarning(each.where, each.what, each.advice) for each in caveats(mechanism).warnings)


def part_warnings(mechanism: Mechanism) -> tuple[Finding, ...]:
    """Return warnings about parts that are outside the validated range of beam theory, or not straight when free.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> part_warnings(double_triangle())
    ()
    """
    return (*(finding for each in validity(mechanism).values() for finding in each.findings), *_not_straight(mechanism))


def _not_straight(mechanism: Mechanism) -> Iterator[Finding]:
    """Flexures not straight when free, straight in linear models."""
    for name, part in mechanism.parts.items():
        if getattr(part, "is_bent", False):
            what = "not straight when free; all models except the model for large displacements assume a straight, stress-free flexure"
            yield Finding(f"parts.{name}", what, "Run flexstage stroke, or flexstage modes --at, to compute the effect")


def _room(mechanism: Mechanism) -> tuple[Finding, ...]:
    if mechanism.envelope is None and mechanism.opening is None:
        return ()
    try:
        return clearance(mechanism).findings
    except DesignError as error:
        return error.findings
