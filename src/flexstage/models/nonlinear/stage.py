"""Nonlinear model of a stage: bodies, flexures in groups of one kind, links with a stiffness about a centre, and load points."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property, partial
from typing import ClassVar

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array, stack
from flexstage.base.storage.digest import digest
from flexstage.beams.compliance import law
from flexstage.beams.flexure.law import DEFAULT, FlexureLaw, Resolution
from flexstage.beams.flexure.of_part import flexure_law
from flexstage.beams.geometric import foreshortening
from flexstage.beams.mass import mass
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, PlacedSuperelement, by_part, expand
from flexstage.mechanism.assembly.expansion import expansion, ground_of
from flexstage.mechanism.assembly.incidence import layout
from flexstage.mechanism.assembly.moving_mass import carried_masses, moving_inertia
from flexstage.mechanism.drawn import as_drawn
from flexstage.mechanism.mechanism import EVERYWHERE, GROUND, Damping, Mechanism
from flexstage.models.linear.channels import exerted_wrenches, imposed_strokes, input_channels, wrench_places
from flexstage.models.linear.model import Channel
from flexstage.models.nonlinear.elements.corotated import Corotated
from flexstage.models.nonlinear.elements.hinge import Hinges
from flexstage.models.nonlinear.state import Loads, Pose
from flexstage.parts.condensation import condense
from flexstage.parts.part import push_of, span, strut_of
from flexstage.spatial.frame import spatial_rotation, transport


@dataclass(frozen=True, eq=False)
class Flexures:
    """Group of l flexures whose tables have the same shape.

    `first` and `second` (l,) are the numbers of the bodies at the flexures' starts and ends, `turn` (l, 3, 3) the nominal frames at the
    starts. `arm_first` (l, 3) is from the first body's reference point to the start, `arm_second` from the second body's reference point to
    the end.
    """

    names: tuple[str, ...]
    law: FlexureLaw
    first: Array
    second: Array
    turn: Array
    arm_first: Array
    arm_second: Array


@dataclass(frozen=True, eq=False)
class LoadPoints:
    """Points of d loads of constant direction: body numbers (d,), and nominal arms (d, 3) from the bodies' reference points."""

    body: Array
    arm: Array


@dataclass(frozen=True, eq=False)
class Nonlinear(InNotebook):
    """Nonlinear model of a stage; see `nonlinear`.

    `bodies` are the names of the n bodies in order; the ground has the number n. `reference` (n + 1, 3) are the nominal reference points.
    Loads act at d `places`: first the wrench inputs, then the specified forces, then the weights of masses. `stated` (d, 3) are the
    specified forces and `masses` (d,) the masses at these places (zero at the other places).

    `growth` (n + 1,) is the thermal expansion factor of the bodies.
    """

    WRITTEN: ClassVar[tuple[str, str]] = ("a nonlinear model", "fs.nonlinear(stage)")
    assembly: Assembly
    bodies: tuple[str, ...]
    reference: Array
    flexures: tuple[Flexures, ...]
    hinges: Hinges
    elements: tuple[Corotated, ...]
    inputs: tuple[Channel, ...]
    places: LoadPoints
    stated: Array
    masses: Array
    inertia: Mapping[str, Array]
    gravity: Array
    damping: Damping | None
    growth: Array
    provenance: str

    @cached_property
    def size(self) -> float:
        """Length scale of translations [m]: the length of the longest flexure or, without flexures, the largest arm."""
        lengths = [float(np.max(group.law.length)) for group in self.flexures]
        places = (self.hinges.arm_first, self.hinges.arm_second, *(each.place - each.place[0] for each in self.elements))
        arms = [np.max(np.abs(each), initial=0.0) for each in places]
        return max(lengths) if lengths else float(max(*arms, 1e-3))

    @cached_property
    def reach(self) -> float:
        """Length scale of translation steps [m]: the larger of `size` and the longest arm, because a rotation moves long arms far."""
        groups = (*self.flexures, self.hinges)
        arms = [np.max(np.linalg.norm(each, axis=-1), initial=0.0) for group in groups for each in (group.arm_first, group.arm_second)]
        return float(max(self.size, *arms))

    @property
    def freedoms(self) -> int:
        """Number of the coordinates of all bodies."""
        return 6 * len(self.bodies)

    def body(self, name: str) -> int:
        """Return the number of a body."""
        return len(self.bodies) if name == GROUND else self.bodies.index(name)

    def nominal_pose(self, cases: int) -> Pose:
        """Return the nominal, unloaded pose of b cases."""
        count = len(self.bodies) + 1
        sizes = [(len(group.names), cases, group.law.form.shape[-1]) for group in self.flexures]
        return Pose(
            np.broadcast_to(self.reference, (cases, count, 3)),
            np.broadcast_to(np.eye(3), (cases, count, 3, 3)),
            tuple(np.zeros(size) for size in sizes),
            tuple(np.zeros((*size[:2], 6)) for size in sizes),
            np.zeros((cases, len(self.hinges.locked))),
        )

    def constant_wrenches(self, loads: Loads) -> Array:
        """Return the wrenches of constant direction (b, d, 6) at the load points."""
        wrench = np.zeros((len(loads.inputs), len(self.places.body), 6))
        columns = [index for index, channel in enumerate(self.inputs) if "." in channel.name]
        count = len(columns) // 6
        wrench[:, :count] = loads.inputs[:, columns].reshape(-1, count, 6)
        wrench[..., :3] += loads.constant[:, None, None] * self.stated + self.masses[:, None] * loads.gravity[:, None]
        return wrench


@dataclass(frozen=True, eq=False)
class _Growth:
    """Thermal scale factors of `bodies` (n + 1,), and link `parts` of changed size."""

    bodies: Array
    parts: Mapping[str, float]

    def of(self, name: str) -> float:
        return self.parts.get(name, 1.0)


@dataclass(frozen=True, eq=False)
class _NominalBodies:
    """Nominal bodies: `number` of each by name, the ground last, `reference` (n + 1, 3), and their thermal growth."""

    number: Mapping[str, int]
    reference: Array
    growth: _Growth


@check_arguments
def nonlinear(mechanism: Mechanism, *, resolution: Resolution = DEFAULT, temperature: float = 0.0, ground: str | None = None) -> Nonlinear:
    """Build the nonlinear model of a stage: one spectral element per flexure, finite motions of bodies (docs/nonlinear.md).

    Leaves, rods, notches and necks are flexures that bend. All other links have a 6x6 stiffness. Superelements have their specified
    matrices in a corotated frame. The model is valid for small strains in the flexures. Batches of designs raise `DesignError`.

    `temperature` is a uniform temperature change [K] in addition to the `temperatures` of the description. Bodies and parts expand freely;
    a part has the mean temperature of its ends. The ground expands about the origin; `ground` names its material (default: as specified in
    the description, or the material of the parts on the ground). Incompatible expansion bends the parts. Moduli are constant. With a
    temperature change, every material must have an expansion coefficient.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> [group.names for group in nonlinear(parallelogram()).flexures]
    [('left', 'right'), ('B/back', 'B/front')]
    """
    if mechanism.elastic_bodies:
        raise refuse("elastic_bodies", "bodies are rigid at large displacements", "Remove elastic_bodies")
    assembly = expand(mechanism)
    bodies = layout(assembly).bodies
    reference = np.stack([*(_one(assembly.bodies[name].reference, name) for name in bodies), np.zeros(3)])
    laws = by_part(assembly.links, partial(flexure_law, resolution=resolution))
    number = {GROUND: len(bodies), **{name: index for index, name in enumerate(bodies)}}
    growth = _growth(mechanism, assembly, bodies, temperature, ground)
    drawn = _NominalBodies(number, reference, growth)
    flexures = _flexures(assembly, {name: item for name, item in laws.items() if item is not None}, drawn)
    centred = {name: assembly.links[name] for name, item in laws.items() if item is None}
    places, stated, masses = _places(mechanism, assembly, number, reference, centred)
    carried = {name: moving_inertia(mechanism, assembly_links) for name, assembly_links in assembly.bodies.items()}
    return Nonlinear(
        assembly=assembly,
        bodies=bodies,
        reference=reference,
        flexures=flexures,
        hinges=_hinges(mechanism, assembly, centred, drawn),
        elements=tuple(_element(item, number, reference) for item in assembly.superelements.values()),
        inputs=input_channels(assembly),
        places=LoadPoints(places.body, places.arm * growth.bodies[places.body, None]),
        stated=stated,
        masses=masses,
        inertia={name: item for name, item in carried.items() if item is not None},
        gravity=stack(mechanism.gravity),
        damping=mechanism.damping,
        growth=growth.bodies,
        provenance=f"nonlinear model of {digest(mechanism, physics=True)[:16]}" + (f" at {temperature:+g} K" if temperature else ""),
    )


def _growth(mechanism: Mechanism, assembly: Assembly, bodies: tuple[str, ...], change: float, ground: str | None) -> _Growth:
    """Thermal growth of bodies and parts at the temperatures of the description and a uniform change, on a ground of some material."""
    if ground is not None:
        ground_of(mechanism, ground)  # raises for an unknown material at any temperature
    stated = {name: float(np.real(value)) for name, value in mechanism.temperatures.items()}
    warmth = {name: change + stated.get(name, stated.get(EVERYWHERE, 0.0)) for name in (*bodies, GROUND)}
    if not any(warmth.values()):
        return _Growth(np.ones(len(bodies) + 1), {})
    growth = expansion(mechanism, ground)
    mean = {name: 0.5 * sum(warmth[body] for body in assembly.links[name].joins) for name in growth.parts}
    parts = {name: 1.0 + mean[name] * float(each) for name, (each, _) in growth.parts.items()}
    return _Growth(np.array([1.0 + warmth[name] * float(growth.bodies[name]) for name in (*bodies, GROUND)]), parts)


def _grow(law: FlexureLaw, ratio: float) -> FlexureLaw:
    """A flexure after uniform thermal growth: its relative tables are unchanged."""
    inertia = law.inertia * np.array([1.0 / ratio, ratio, ratio, ratio])
    return replace(law, length=law.length * ratio, rigidity=law.rigidity * ratio**4, inertia=inertia, half=law.half * ratio)


def _one(value: Array, name: str) -> Array:
    if np.asarray(value).ndim != 1:
        raise refuse(name, "a batch of designs is not supported at large displacements", "Analyse one design at a time")
    return np.asarray(value, dtype=float)


def _flexures(assembly: Assembly, laws: Mapping[str, FlexureLaw], drawn: _NominalBodies) -> tuple[Flexures, ...]:
    groups: dict[tuple[int, ...], list[str]] = {}
    for name, item in laws.items():
        groups.setdefault(item.signature, []).append(name)
    return tuple(_group(assembly, names, [laws[name] for name in names], drawn) for names in groups.values())


def _group(assembly: Assembly, names: list[str], laws: list[FlexureLaw], drawn: _NominalBodies) -> Flexures:
    reference, growth = drawn.reference, drawn.growth
    links = [assembly.links[name] for name in names]
    half = 0.5 * np.stack([item.length for item in laws])[:, None] * np.stack([link.frame.rotation[:, 0] for link in links])
    laws = [_grow(item, growth.of(name)) if name in growth.parts else item for name, item in zip(names, laws, strict=True)]
    together = FlexureLaw(**{each.name: np.stack([np.asarray(getattr(item, each.name)) for item in laws]) for each in fields(FlexureLaw)})
    first, second = _numbers(links, drawn.number)
    turn = np.stack([link.frame.rotation for link in links])
    centre = np.stack([_one(link.frame.position, link.name) for link in links])
    arms = ((centre + side * half - reference[body]) * growth.bodies[body, None] for side, body in ((-1.0, first), (1.0, second)))
    return Flexures(tuple(names), together, first, second, turn, *arms)


def _numbers(links: Iterable[PlacedLink], number: Mapping[str, int]) -> tuple[Array, Array]:
    first, second = ([number[link.joins[end]] for link in links] for end in (0, 1))
    return np.array(first, dtype=int), np.array(second, dtype=int)


def _hinges(mechanism: Mechanism, assembly: Assembly, links: Mapping[str, PlacedLink], drawn: _NominalBodies) -> Hinges:
    first, second = _numbers(links.values(), drawn.number)
    count, inputs = len(links), len(input_channels(assembly))
    reference, growth = drawn.reference, drawn.growth
    centre = np.array([_one(link.frame.position, link.name) for link in links.values()]).reshape(count, 3)
    laws = [law(link.part, link.material) for link in links.values()]
    free = {name: assembly.actuator(actuator).free_deformation for actuator, name in assembly.strokes.items()}
    strokes, thrusts = imposed_strokes(assembly, free), exerted_wrenches(assembly)
    none = np.zeros((6, inputs))
    pushes = [push_of(link.part) for link in links.values()]
    drawn_links = [as_drawn(mechanism, link) for link in links.values()]
    return Hinges(
        names=tuple(links),
        first=first,
        second=second,
        turn=np.array([link.frame.rotation for link in links.values()]).reshape(count, 3, 3),
        arm_first=(centre - reference[first]) * growth.bodies[first, None] + _halves_more(links, growth, first, 0.5),
        arm_second=(centre - reference[second]) * growth.bodies[second, None] + _halves_more(links, growth, second, -0.5),
        stiffness=np.array([item.stiffness for item in laws]).reshape(count, 6, 6),
        stroke=np.array([strokes.get(name, none) for name in links]).reshape(count, 6, inputs),
        thrust=np.array([thrusts.get(name, none) for name in links]).reshape(count, 6, inputs),
        push=np.array([[0.0 if push is None else push, 0, 0, 0, 0, 0] for push in pushes], dtype=float).reshape(count, 6),
        strut=np.array([strut_of(link.part) or 0.0 for link in links.values()], dtype=float),
        bow=np.array([foreshortening(each.part, each.material) for each in drawn_links]).reshape(count, 6, 6, 6),
        locked=np.array([(place, freedom.index) for place, item in enumerate(laws) for freedom in item.locked], dtype=int).reshape(-1, 2),
    )


def _element(placed: PlacedSuperelement, number: Mapping[str, int], reference: Array) -> Corotated:
    """A superelement by its matrices, with port motions in stage axes."""
    condensed = condense(placed.part, f"parts.{placed.link.part}")
    bodies = np.array([number[port.body] for port in placed.ports.values()], dtype=int)
    place = np.stack([_one(port.frame.position, placed.name) for port in placed.ports.values()])
    turns = np.stack([port.frame.rotation for port in placed.ports.values()])
    count = len(bodies)
    into = np.zeros((6 * count, 6 * count))
    relative = np.zeros((6 * count - 6, 6 * count))
    for port in range(count):
        own, rows = slice(6 * port, 6 * port + 6), slice(6 * port - 6, 6 * port)
        into[own, own] = spatial_rotation(turns[port]).T
        if port:
            relative[rows, own] = into[own, own]
            relative[rows, :6] = -into[own, own] @ transport(place[port] - place[0])
    whole = np.tile(np.eye(6)[:, :3], (count, 1))
    inertia, loss = condensed.inertia[: 6 * count, : 6 * count], placed.part.loss_factor
    return Corotated(
        name=placed.name,
        ports=tuple(placed.ports),
        bodies=bodies,
        arm=place - reference[bodies],
        axes=turns,
        place=place,
        relative=relative,
        stiffness=condensed.stiffness,
        squares=condensed.squares,
        inertia=condensed.inertia,
        damping=condensed.damping,
        loss=0.0 if loss is None else float(loss),
        mass=condensed.mass,
        centre=placed.frame.point(condensed.centre),
        share=into.T @ inertia @ into @ whole,
    )


def _halves_more(links: Mapping[str, PlacedLink], growth: _Growth, bodies: Array, side: float) -> Array:
    """Thermal growth (l, 3) of the half of a part at a body minus that of the body, at that end."""
    more = [
        side * float(span(link.part)) * (growth.of(name) - growth.bodies[body]) * link.frame.rotation[:, 0] * (name in growth.parts)
        for body, (name, link) in zip(bodies, links.items(), strict=True)
    ]
    return np.array(more).reshape(-1, 3)


def _places(
    mechanism: Mechanism, assembly: Assembly, number: Mapping[str, int], reference: Array, centred: Mapping[str, PlacedLink]
) -> tuple[LoadPoints, Array, Array]:
    """Points of wrench inputs, of specified forces and of masses: bodies, payloads and halves of links about centres."""
    inputs = [(number[place.body], place.point, np.zeros(3), 0.0) for place in wrench_places(assembly).values()]
    forces = [(number[item.body], stack(item.at), stack(item.force), 0.0) for item in mechanism.forces.values()]
    masses = [
        (number[name], item.centre, np.zeros(3), float(item.mass))
        for name, placed in assembly.bodies.items()
        for item in carried_masses(mechanism, placed)
    ]
    halves = [half for link in centred.values() for half in _halves(link, number)]
    rows = [*inputs, *forces, *masses, *halves]
    body = np.array([row[0] for row in rows], dtype=int)
    arms = np.array([row[1] for row in rows]).reshape(-1, 3) - reference[body]
    return LoadPoints(body, arms), np.array([row[2] for row in rows]).reshape(-1, 3), np.array([row[3] for row in rows])


def _halves(link: PlacedLink, number: Mapping[str, int]) -> list[tuple[int, Array, Array, float]]:
    """Mass of a link on each of its bodies, and its position."""
    matrix = mass(link.part, link.material)
    halves = []
    for end, body in enumerate(link.joins):
        share = matrix[6 * end : 6 * end + 6, :6] + matrix[6 * end : 6 * end + 6, 6:12]
        if share[0, 0] > 0.0:
            along = share[5, 1] / share[1, 1]
            halves.append((number[body], link.frame.position + along * link.frame.rotation[:, 0], np.zeros(3), float(share[0, 0])))
    return halves


def extent(model: Nonlinear) -> dict[str, float]:
    """Return the lengths of all links [m], by name."""
    return {name: float(span(link.part)) for name, link in model.assembly.links.items()}
