"""Mapped model: the axial-spring model of Shin & Moon (Eqs. 17-28).

The stiffness is K = R_a^T diag(K_i) R_a, with the stiffness K_i of each unit in actuator coordinates. Only the platform has mass. Hinges
have no bending stiffness.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import scipy

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import DesignError, Finding, refuse, require
from flexstage.base.number import Array, Number, join, matvec, same_batch
from flexstage.base.record import Heading, Layout
from flexstage.base.storage.digest import digest
from flexstage.base.units.quantity import COMPLIANCE, LENGTH, RATIO, ROTATIONAL_STIFFNESS, STIFFNESS
from flexstage.beams.compliance import compliance
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, copies, expand
from flexstage.mechanism.assembly.incidence import deformation, layout, twist_at
from flexstage.mechanism.assembly.moving_mass import moving_inertia
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.elimination import null_space
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import Channel, Contribution, LinearModel
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.freedom import ALL, Freedom
from flexstage.parts.part import Restricted, actuator_of
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS, Frame, transport

_COLLINEAR = 1e-6


@dataclass(frozen=True, eq=False)
class LeverStiffness:
    """Springs of a lever unit in SI units (figure 7 and equations 3 to 11 of Shin & Moon).

    The stiffnesses are `drive` K_1 (stack and its hinges), `pivot` K_theta2 and `pole` K_3; the arms are `short_arm` r_1 and `long_arm`
    r_2.
    """

    TABLE: ClassVar[Layout] = Layout("Springs of the lever units", "drive pivot pole short_arm long_arm gain tip_compliance", head="unit")

    drive: Annotated[Number, STIFFNESS, Heading("drive K_1")]
    pivot: Annotated[Number, ROTATIONAL_STIFFNESS, Heading("pivot K_theta2")]
    pole: Annotated[Number, STIFFNESS, Heading("pole K_3")]
    short_arm: Annotated[Number, LENGTH, Heading("arm r_1")]
    long_arm: Annotated[Number, LENGTH, Heading("arm r_2")]

    @property
    def softness(self) -> Number:
        """Stiffness ratio of pivot and drive, eps = K_theta2 / (r_1^2 K_1)."""
        return self.pivot / (self.short_arm**2 * self.drive)

    @property
    def gain(self) -> Annotated[Number, RATIO]:
        """Output per stroke, the first term of equation 11: (r_2 / r_1) / (1 + eps), with the arms r_1 and r_2 and eps = `softness`."""
        return self.long_arm / self.short_arm / (1.0 + self.softness)

    @property
    def tip_compliance(self) -> Annotated[Number, COMPLIANCE]:
        """Compliance at the tip, the load term of equation 11: r_2^2 / (K_theta2 + r_1^2 K_1) + 1 / K_3 [m/N]."""
        return self.long_arm**2 / (self.pivot + self.short_arm**2 * self.drive) + 1.0 / self.pole

    @property
    def stiffness(self) -> Number:
        """Stiffness K_v in actuator coordinates [N/m]: (r_2 / r_1)^2 divided by the tip compliance."""
        return (self.long_arm / self.short_arm) ** 2 / self.tip_compliance


@check_arguments
def mapped(mechanism: Mechanism) -> LinearModel:
    """Build the model of Shin & Moon: axial springs in actuator coordinates under a rigid platform.

    The stiffness of each unit is specified in the description, or computed by `unit_stiffness`. Raises `DesignError` if a stiffness is not
    specified and cannot be computed. The error names the key for specifying this stiffness.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> (mapped(double_triangle()).stiffness_matrix[0, 0] / 1e6).round(2).item()  # 1.5 K_a
    15.45
    """
    kinematics = ideal(mechanism)
    kinematics.mapping  # noqa: B018  (refuses under-actuated stages)
    assembly = expand(mechanism).welded
    springs = unit_stiffness(mechanism, assembly, kinematics)
    mass = moving_inertia(mechanism, assembly.bodies[PLATFORM])
    if mass is None:
        raise refuse("bodies.platform", "mass missing", "Specify mass, centre and inertia, or add solids")
    return _model(mechanism, kinematics, springs, mass, _points(assembly, kinematics))


def _points(assembly: Assembly, kinematics: Kinematics) -> dict[str, tuple[Array, Array]]:
    """Ideal motions (..., 6, f) of the platform and of every named point, and their rigid motion (..., 6, 6) with the ground."""
    order, centre = layout(assembly), assembly.bodies[PLATFORM].reference
    motions = {PLATFORM: (kinematics.motion, np.eye(6))}
    for name, (body, point) in assembly.points.items():
        motions[name] = twist_at(assembly, order, body, Frame(np.eye(3), point)) @ kinematics.bodies, transport(point - centre)
    return motions


def _model(
    mechanism: Mechanism, kinematics: Kinematics, springs: Mapping[str, Number], mass: Array, places: Mapping[str, tuple[Array, Array]]
) -> LinearModel:
    count, freedoms = len(kinematics.actuators), kinematics.mobility
    outputs = join(motion for motion, _ in places.values())
    loads, carried = 6 * len(places), [rigid for _, rigid in places.values()]
    sensing = kinematics.sensing @ kinematics.motion
    channels = [Channel(f"{place}.{name}", unit) for place in places for name, unit in zip(COMPONENTS, TWIST_UNITS, strict=True)]
    channels += [Channel(name, unit) for name, unit in zip(kinematics.gauges, kinematics.reading_units, strict=True)]
    inputs = [Channel(name, "m") for name in kinematics.actuators]
    inputs += [Channel(f"{place}.{name}", unit) for place in places for name, unit in zip(FORCES, WRENCH_UNITS, strict=True)]
    transposed = kinematics.motion.mT
    return LinearModel(
        coordinates=tuple(f"{PLATFORM}.{name}" for name in kinematics.coordinates),
        stiffness={
            name: Contribution(kinematics.actuation[..., index : index + 1, :], np.asarray(springs[name])[..., None, None])
            for index, name in enumerate(kinematics.actuators)
        },
        inertia={PLATFORM: Contribution(kinematics.motion, mass)},
        inputs=tuple(inputs),
        force=np.concatenate([np.zeros((*outputs.shape[:-2], freedoms, count)), outputs.mT], axis=-1),
        imposed={name: np.eye(count + loads)[index : index + 1] for index, name in enumerate(kinematics.actuators)},
        outputs=tuple(channels),
        output=join([outputs, sensing]),
        feedthrough=np.zeros((len(channels), count + loads)),
        rigid=kinematics.projection,
        rigid_output=join([*carried, np.zeros((len(kinematics.gauges), 6))]),
        base_inertia=transposed @ mass,
        damping=mechanism.damping,
        idle=(),
        provenance=f"mapped model of {digest(mechanism, physics=True)[:16]}",
    )


def unit_stiffness(mechanism: Mechanism, assembly: Assembly, kinematics: Kinematics | None = None) -> dict[str, Number]:
    """Return the specified or computed stiffness of every actuator's unit in actuator coordinates [N/m].

    If a unit is neither a straight strut nor a lever, the stiffness is computed for the chain of links that carry the unit's load
    (`chain_compliance`). The chain must be statically determinate, and `kinematics` is required.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> round(float(unit_stiffness(stage, expand(stage))["B1"]) / 1e6, 3)
    10.3
    """
    unit_of = {copy: unit for copy, unit, _ in copies(mechanism)}
    findings: list[Finding] = []
    result: dict[str, Number] = {}
    for name, drive in assembly.strokes.items():
        owner = drive.rpartition("/")[0]
        copy = owner if owner in unit_of else ""
        specified = mechanism.units[unit_of[copy]].stiffness if copy else None
        try:
            result[name] = specified if specified is not None else computed_stiffness(assembly, drive)
        except DesignError as error:
            if kinematics is not None and (from_chain := chain_compliance(assembly, kinematics, name)) is not None:
                result[name] = 1.0 / from_chain
                continue
            key = f"Specify units.{unit_of[copy]}.stiffness" if copy else "Place the actuator in a unit with a specified stiffness"
            findings += [Finding(item.where, item.what, f"{key}, or use the lumped model") for item in error.findings]
    require(findings)
    return result


def chain_compliance(assembly: Assembly, kinematics: Kinematics, actuator: str) -> Number | None:
    """Compute the compliance [m/N] of all links that carry an actuator's load, in actuator coordinates, by virtual work.

    The compliance is the sum of f^T C f over the links. With strokes fixed, f is the equilibrium wrench in the locked DOFs of a link; C is
    the link's compliance. The platform wrench w loads only this actuator and no guide: V^T w = R_a^T e. Here V contains the platform's
    ideal motions, R_a the strokes per ideal motion; e is 1 for this actuator and 0 for the others. Free DOFs carry no load; ideal joints
    are rigid.

    Returns `None` if statics does not determine the wrenches (redundant constraints or a guide), if a link has no known compliance, or if
    all links are rigid.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> round(1e-6 / float(chain_compliance(expand(stage), ideal(stage), "B1")), 2)  # as its straight strut
    10.3
    """
    order = layout(assembly)
    locked = {name: [axis for axis, each in enumerate(ALL) if each not in free] for name, free in kinematics.free.items()}
    strains = [deformation(assembly, order, assembly.links[name])[..., axes, :] for name, axes in locked.items()]
    row = kinematics.actuation[..., kinematics.actuators.index(actuator), :, None]
    wrenches = same_batch(kinematics.projection.mT @ row, _idle_wrenches(kinematics))
    loads = order.selector(PLATFORM).T @ np.concatenate(wrenches, axis=-1)
    rigid = np.array([isinstance(assembly.links[name].part, Joint) for name, axes in locked.items() for _ in axes])
    rows, loads = same_batch(join(strains), loads)
    forces = _equilibrium(rows, loads, rigid, kinematics.length)
    return None if forces is None else _work(assembly, locked, forces)


def _idle_wrenches(kinematics: Kinematics) -> Array:
    """Wrenches (..., 6, 6 - f) without work in any ideal motion."""
    complement = np.eye(6) - kinematics.projection.mT @ kinematics.motion.mT
    count = 6 - kinematics.mobility
    chosen = np.array([scipy.linalg.qr(each, pivoting=True)[2][:count] for each in np.real(complement).reshape(-1, 6, 6)], dtype=int)
    return np.take_along_axis(complement, chosen.reshape(*complement.shape[:-2], 1, count), axis=-1)


def _work(assembly: Assembly, locked: Mapping[str, list[int]], forces: Array) -> Number | None:
    """f^T C f of all loaded links; `None` if a compliance is unknown, or nothing is elastic."""
    total, start = np.zeros(()), 0
    largest = np.max(np.abs(np.real(forces)), axis=-1, keepdims=True)
    for name, axes in locked.items():
        wrench = forces[..., start : start + len(axes)]
        start += len(axes)
        if np.any(np.abs(np.real(wrench)) > _COLLINEAR * largest) and not isinstance(assembly.links[name].part, Joint):
            matrix = _known_compliance(assembly.links[name])
            if matrix is None:
                return None
            total = total + np.einsum("...i,...ij,...j", wrench, matrix[..., axes, :][..., axes], wrench)
    return None if np.all(np.real(total) == 0.0) else total


def _known_compliance(link: PlacedLink) -> Array | None:
    try:
        return _compliance(link)
    except DesignError:
        return None


def _equilibrium(rows: Array, loads: Array, rigid: Array, length: Number) -> Array | None:
    """Forces (..., m) of constraints (..., m, N) that balance the first load (..., N, k), plus any amount of the others.

    Elastic constraints with undetermined force carry nothing: redundant ones, and guides, which the other loads would load. `rigid` (m,)
    constraints carry the balance, which is not returned.

    `None` if the first load of a design cannot be balanced this way. Every design of a batch has its own choice.
    """
    batch, (count, size) = rows.shape[:-2], rows.shape[-2:]
    full = np.concatenate([rows.mT, loads[..., 1:], loads[..., :1]], axis=-1).reshape(-1, size, count + loads.shape[-1])
    turns = np.broadcast_to(1.0 / np.real(length), batch).ravel()
    scaled = np.real(full) * np.where(np.arange(size) % 6 < 3, 1.0, turns[:, None])[..., None]
    forces, bearing = np.zeros((len(full), full.shape[-1]), dtype=full.dtype), None
    for number, design in enumerate(full):
        if number == 0 or not np.array_equal(scaled[number], scaled[number - 1]):
            bearing = _carrying_columns(scaled[number], rigid)
        if bearing is None:
            return None
        equations, chosen = bearing
        forces[number, chosen] = np.linalg.solve(design[np.ix_(equations, chosen)], design[equations, -1])
    return forces[:, :count].reshape(*batch, count)


def _carrying_columns(system: Array, rigid: Array) -> tuple[Array, Array] | None:
    """Equations and columns of the constraints and other loads in one design (N, m + k) that balance the load in the last column."""
    count, target = len(rigid), system[:, -1]
    columns = _normal(system[:, :-1].T).T
    open_ = np.max(np.abs(null_space(columns)), axis=1, initial=0.0)[:count] > _COLLINEAR
    candidates = np.append(np.flatnonzero(rigid | ~open_), np.arange(count, columns.shape[1]))
    _, triangle, order = scipy.linalg.qr(columns[:, candidates], pivoting=True)
    diagonal = np.abs(np.diag(triangle))
    chosen = candidates[order[: int(np.sum(diagonal > _COLLINEAR * diagonal[0]))]]
    missed = target - columns[:, chosen] @ np.linalg.lstsq(columns[:, chosen], target, rcond=None)[0]
    if np.max(np.abs(missed)) > _COLLINEAR * np.max(np.abs(target)):
        return None
    return scipy.linalg.qr(columns[:, chosen].T, pivoting=True)[2][: len(chosen)], chosen


def _normal(rows: Array) -> Array:
    """Rows scaled to unit length; zero rows are unchanged."""
    norms = np.linalg.norm(rows, axis=1)
    return rows / np.where(norms > 0.0, norms, 1.0)[:, None]


def computed_stiffness(assembly: Assembly, drive: str) -> Number:
    """Compute the stiffness in actuator coordinates of a direct or a lever unit, by the name of its actuator's link.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(float(computed_stiffness(expand(double_triangle()), "B4/pzt")) / 1e6, 2)
    30.28
    """
    if np.any(np.real(actuator_of(assembly.links[drive].part).free_deformation)[..., 1:]):
        raise refuse(drive, "the actuator's stroke is not only along its axis, but this model has springs only along the axis", "")
    ways = _links_at_bodies(assembly, drive)
    levers = [body for body, links in ways.items() if len(links) > 2 and body not in (GROUND, PLATFORM)]
    if levers:
        return lever_stiffness(assembly, drive).stiffness
    chain = _chain(ways, assembly, drive, frozenset({GROUND, PLATFORM}))
    ends = _ends(chain)
    if sorted(ends) != sorted((GROUND, PLATFORM)):
        raise refuse(drive, f"the actuator's strut ends at {' and '.join(ends)}, not at ground and platform", "")
    return 1.0 / _series(chain, assembly.links[drive])


def lever_stiffness(assembly: Assembly, drive: str) -> LeverStiffness:
    """Compute the springs and arms of a lever unit.

    The drive and one pivot connect the ground and the lever; a pole connects the lever and the platform.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(float(lever_stiffness(expand(double_triangle()), "B4/pzt").gain) / 3, 3)  # Table 2: 585 of 600
    0.975
    """
    ways = _links_at_bodies(assembly, drive)
    levers = [body for body, links in ways.items() if len(links) > 2 and body not in (GROUND, PLATFORM)]
    stop = frozenset({GROUND, PLATFORM, *levers})
    driving = _chain(ways, assembly, drive, stop)
    if len(levers) != 1 or sorted(_ends(driving)) != sorted((GROUND, levers[0])):
        raise refuse(drive, f"its unit is neither a straight strut nor a single lever (branching bodies: {', '.join(levers)})", "")
    others = [link for link in ways[levers[0]] if link not in driving]
    pivots = [link for link in others if GROUND in link.joins]
    poles = [link for link in others if GROUND not in link.joins]
    if len(pivots) != 1 or len(poles) != 1:
        raise refuse(drive, f"its lever has {len(pivots)} pivots to ground and {len(poles)} output poles, expected one of each", "")
    pole = _chain(ways, assembly, poles[0].name, stop)
    pivot = pivots[0]
    turning = 1.0 / _compliance(pivot)[..., 5, 5]
    centre = pivot.frame.position
    return LeverStiffness(
        drive=1.0 / _series(driving, assembly.links[drive]),
        pivot=turning,
        pole=1.0 / _series(pole, poles[0]),
        short_arm=_distance(centre, assembly.links[drive]),
        long_arm=_distance(centre, poles[0]),
    )


def _links_at_bodies(assembly: Assembly, drive: str) -> dict[str, list[PlacedLink]]:
    """Links at each body, within the unit of the actuator."""
    owner = drive.rpartition("/")[0]
    ways: dict[str, list[PlacedLink]] = {}
    for link in assembly.links.values():
        if link.name.rpartition("/")[0] == owner and (owner or link.name == drive):
            for body in link.joins:
                ways.setdefault(body, []).append(link)
    return ways


def _chain(ways: Mapping[str, list[PlacedLink]], assembly: Assembly, start: str, stop: frozenset[str]) -> list[PlacedLink]:
    """The links in series with one link, up to bodies of `stop` or dead ends."""
    chain = [assembly.links[start]]
    for body in assembly.links[start].joins:
        body_reached, last = body, chain[0] if body == assembly.links[start].joins[0] else assembly.links[start]
        while body_reached not in stop:
            onward = [link for link in ways[body_reached] if link.name != last.name]
            if len(onward) != 1:
                break
            last = onward[0]
            chain.append(last)
            body_reached = last.joins[1] if last.joins[0] == body_reached else last.joins[0]
    return chain


def _ends(chain: list[PlacedLink]) -> list[str]:
    joined = [body for link in chain for body in link.joins]
    return [body for body in dict.fromkeys(joined) if joined.count(body) == 1]


def _series(chain: list[PlacedLink], line: PlacedLink) -> Array:
    """Series compliance along the line of one link; every link must be on that line."""
    axis = line.frame.rotation[..., :, 0]
    total: Array = np.zeros(())
    for link in chain:
        offset = np.max(np.abs(np.real(_perpendicular(link.frame.position - line.frame.position, axis))))
        if offset > _COLLINEAR:
            raise refuse(link.name, f"offset from the line of {line.name} (got {offset * 1e3:.4g} mm, expected 0)", "")
        local = matvec(link.frame.rotation.mT, axis)
        matrix = _compliance(link)[..., :3, :3]
        total = total + (local[..., None, :] @ matrix @ local[..., :, None])[..., 0, 0]
    return total


def _compliance(link: PlacedLink) -> Array:
    """Compliance of a link's part; for a restricted part only of its elastic DOFs, as freed ones have no stiffness."""
    part = link.part
    if isinstance(part, Joint) or (isinstance(part, Restricted) and Freedom.X in part.free):
        raise refuse(link.name, "the link has no axial stiffness, so the unit's stiffness is undefined", "")
    try:
        whole = compliance(part.part if isinstance(part, Restricted) else part, link.material)
    except DesignError as error:
        raise DesignError(replace(finding, where=link.name) for finding in error.findings) from error
    if isinstance(part, Restricted):
        elastic = np.array([freedom in part.elastic for freedom in ALL])
        return np.where(elastic[:, None] & elastic, whole, 0.0)
    return whole


def _perpendicular(arm: Array, axis: Array) -> Array:
    return arm - np.sum(arm * axis, axis=-1, keepdims=True) * axis


def _distance(point: Array, line: PlacedLink) -> Array:
    arm = _perpendicular(line.frame.position - point, line.frame.rotation[..., :, 0])
    return np.sqrt(np.sum(arm * arm, axis=-1))
