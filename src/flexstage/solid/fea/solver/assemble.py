"""Assembly of superelements, rigid bodies and casings to one linear model with the inputs and outputs of every elastic model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink
from flexstage.mechanism.assembly.moving_mass import carried_masses, moving_inertia
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Mechanism
from flexstage.models.linear.channels import (
    Motions,
    absolute,
    exerted_wrenches,
    gauge_rows,
    imposed_strokes,
    input_channels,
    output_channels,
    place_twists,
    twist_places,
    wrench_places,
)
from flexstage.models.linear.model import Contribution, LinearModel, assemble
from flexstage.parts.part import actuator_of
from flexstage.solid.fea.meshing.fineness import WARPS
from flexstage.solid.fea.solver.casing import casing, end_face_twist
from flexstage.solid.fea.solver.component import Component, Joint, groups, is_elastic
from flexstage.solid.fea.solver.superelement import Superelement
from flexstage.solid.fea.solver.ties import (
    ShapelessContribution,
    in_words,
    inner_coordinates,
    link_tie,
    stated_links,
    stated_of,
    superelement_tie,
)
from flexstage.spatial.frame import COMPONENTS, Frame, rigid_inertia, spatial_rotation, transport, twist_transform

_SINGULAR = 1e-13


@dataclass(frozen=True, eq=False)
class Placed:
    """A component with its superelement and the operator (n, N) that maps the N model coordinates to its n own coordinates.

    The laws of the superelement have the names of this instance of the component.
    """

    component: Component
    element: Superelement
    operator: Array


@dataclass(frozen=True, eq=False)
class _Model:
    mechanism: Mechanism
    assembly: Assembly
    names: tuple[str, ...]
    blocks: Mapping[str, slice]
    placed: tuple[Placed, ...]
    twists: Mapping[str, Array]
    seats: Mapping[str, tuple[Array, Array]]

    @property
    def size(self) -> int:
        return len(self.names)

    def twist(self, body: str, frame: Frame) -> Array:
        """A body's twist (6, N) at a frame's origin in its axes."""
        if body == GROUND:
            return np.zeros((6, self.size))
        return twist_transform(frame, self.assembly.bodies[body].reference) @ self.twists[body]

    @property
    def motions(self) -> Motions:
        return Motions(self.twists, self.twist)

    def end(self, name: str, body: str, frame: Frame) -> Array:
        """The twist (6, N) at a frame at the end of a part without a shape: of the surface there, or of a rigid body."""
        if name not in self.seats:
            return self.twist(body, frame)
        point, twist = self.seats[name]
        return twist_transform(frame, point) @ twist

    @cached_property
    def ties(self) -> dict[str, ShapelessContribution]:
        """The parts without a shape, links before superelements."""
        links = {name: (link, stated_of(link)) for name, link in self.assembly.links.items()}
        found = {
            name: link_tie(link, stated, self.end, _loss_factor(self, name)) for name, (link, stated) in links.items() if stated is not None
        }
        rows = np.eye(self.size)
        return found | {
            name: superelement_tie(element, self.end, rows[self.blocks[name]]) for name, element in self.assembly.superelements.items()
        }


def linear_model(
    mechanism: Mechanism, assembly: Assembly, parts: tuple[tuple[Component, Superelement], ...], provenance: str
) -> LinearModel:
    """Join reduced components to one linear model.

    The coordinates are, in sequence: the twists of rigid bodies; the twists of joints between elastic components (at the joint, in stage
    axes); the warps of the joints' faces (in the joint's own axes); the internal coordinates of the components. Raises `DesignError` if the
    joined stage has a rigid-body motion.
    """
    model = _join(mechanism, assembly, parts)
    elastic, mass = dict(_stiffness(model)), dict(_inertia(model))
    _require_support(model, elastic)
    force, imposed = _inputs(model)
    output, feedthrough = _outputs(model, imposed)
    return LinearModel(
        coordinates=model.names,
        stiffness=elastic,
        inertia=mass,
        inputs=input_channels(assembly),
        force=force,
        imposed=imposed,
        outputs=output_channels(assembly),
        output=output,
        feedthrough=feedthrough,
        rigid=_rigid(model),
        rigid_output=_rigid_outputs(model),
        base_inertia=_carry_wrench(model),
        damping=mechanism.damping,
        idle=(),
        provenance=", ".join(text for text in (provenance, in_words(stated_links(assembly))) if text),
        viscous={name: tie.damping for name, tie in model.ties.items() if tie.damping is not None},
    )


def _join(mechanism: Mechanism, assembly: Assembly, parts: tuple[tuple[Component, Superelement], ...]) -> _Model:
    blocks, names = _coordinates(assembly, parts)
    placed = place_parts(assembly, parts)
    twists: dict[str, Array] = {}
    for body in assembly.bodies:
        if not is_elastic(assembly, body):
            twists[body] = np.eye(len(names))[blocks[body]]
    for item in placed:
        for body, mean in item.element.bodies.items():
            twists[body] = spatial_rotation(item.component.place.rotation) @ mean @ item.operator
    return _Model(mechanism, assembly, names, blocks, placed, twists, dict(_seats(placed)))


def _seats(placed: tuple[Placed, ...]) -> Iterator[tuple[str, tuple[Array, Array]]]:
    """Point (3,) and twist (6, N) in the stage's axes of the surface around every end of a part without a shape, by its name."""
    for item in placed:
        turn = spatial_rotation(item.component.place.rotation)
        for end, rows in zip(item.component.seats, item.element.seats.values(), strict=True):
            yield end.name, (item.component.place.point(end.point), turn @ rows @ item.operator)


def place_parts(assembly: Assembly, parts: tuple[tuple[Component, Superelement], ...]) -> tuple[Placed, ...]:
    """Return the components of a `linear_model` with operators that map the model's coordinates to the component's coordinates.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> place_parts(expand(parallelogram()), ())
    ()
    """
    blocks, names = _coordinates(assembly, parts)
    return tuple(
        Placed(component, _named(component, element), _operator(assembly, component, element, blocks, len(names)))
        for component, element in parts
    )


def _named(component: Component, element: Superelement) -> Superelement:
    """A superelement with the names of one instance."""
    names = dict(zip(element.stiffness, groups(component), strict=True))
    laws = ("stiffness", "inertia", "bodies", "body_inertia", "resultants", "strokes", "free_strokes")
    return replace(element, **{law: {names[name]: value for name, value in getattr(element, law).items()} for law in laws})


def _coordinates(assembly: Assembly, parts: tuple[tuple[Component, Superelement], ...]) -> tuple[dict[str, slice], tuple[str, ...]]:
    blocks: dict[str, slice] = {}
    names: list[str] = []

    def add(owner: str, own: list[str]) -> None:
        blocks[owner] = slice(len(names), len(names) + len(own))
        names.extend(own)

    for body in sorted(assembly.bodies, key=lambda name: name != PLATFORM):
        if not is_elastic(assembly, body):
            add(body, [f"{body}.{name}" for name in COMPONENTS])
    for component, element in parts:
        for item in component.interfaces:
            joint = item.joint
            if joint.name not in blocks and is_elastic(assembly, joint.body):
                add(joint.name, [f"{joint.name}.{name}" for name in COMPONENTS])
            if item.yields and element.warps and _warps(joint) not in blocks:
                add(_warps(joint), [f"{joint.name}.warp{number + 1}" for number in range(WARPS)])
        if component.floats:
            add(component.name, [f"{component.name}.{name}" for name in COMPONENTS])
        inner = element.size - element.boundary_coordinates
        add(f"{component.name}~", [f"{component.name}~{number + 1}" for number in range(inner)])
    for name, link in assembly.superelements.items():
        add(name, list(inner_coordinates(link)))
    return blocks, tuple(names)


def _warps(joint: Joint) -> str:
    return f"{joint.name} warps"


def _operator(assembly: Assembly, component: Component, element: Superelement, blocks: Mapping[str, slice], size: int) -> Array:
    result = np.zeros((element.size, size))
    for number, item in enumerate(component.interfaces):
        joint, rows = item.joint, slice(6 * number, 6 * number + 6)
        turn = spatial_rotation(component.place.rotation.T)
        if joint.name in blocks:
            result[rows, blocks[joint.name]] = turn
        else:
            at = component.place.point(joint.frame.position)
            result[rows, blocks[joint.body]] = turn @ transport(at - assembly.bodies[joint.body].reference)
    if component.floats:
        result[:6, blocks[component.name]] = spatial_rotation(component.place.rotation.T)
    yielding = [item.joint for item in component.interfaces if item.yields and element.warps]
    for number, joint in enumerate(yielding):
        start = 6 * element.interfaces + WARPS * number
        result[start : start + WARPS, blocks[_warps(joint)]] = np.eye(WARPS)
    result[element.boundary_coordinates :, blocks[f"{component.name}~"]] = np.eye(element.size - element.boundary_coordinates)
    return result


def _stiffness(model: _Model) -> Iterator[tuple[str, Contribution]]:
    for item in model.placed:
        for name, law in item.element.stiffness.items():
            label = name if name in model.assembly.links else f"{name} (body)"
            yield label, Contribution(item.operator, law, _loss_factor(model, name))
    for name, link in model.assembly.links.items():
        law = casing(link)
        if law is not None:
            yield f"{name} (casing)", Contribution(_across(_holder(model, name), link), law, _loss_factor(model, name))
    for name, tie in model.ties.items():
        yield name, tie.strain


def _across(item: Placed, link: PlacedLink) -> Array:
    """Relative twist (6, N) of a stack's two end faces."""
    return end_face_twist(item.component, link) @ item.operator[: 6 * item.element.interfaces]


def _loss_factor(model: _Model, name: str) -> float:
    if name in model.assembly.links:
        link = model.assembly.links[name]
        value = getattr(link.material if link.material is not None else link.part, "loss_factor", None)
    else:
        solids = model.assembly.bodies[name].solids.values()
        value = model.mechanism.materials[next(iter(solids)).solid.material].loss_factor
    return 0.0 if value is None else float(np.real(value))


def _inertia(model: _Model) -> Iterator[tuple[str, Contribution]]:
    for item in model.placed:
        for name, law in item.element.inertia.items():
            if name in model.assembly.links:
                yield f"{name} (link)", Contribution(item.operator, law)
            else:
                yield from _body_inertia(model, item, name)
    for name, body in model.assembly.bodies.items():
        if is_elastic(model.assembly, name):
            for number, load in enumerate(carried_masses(model.mechanism, body)[1:]):
                matrix = rigid_inertia(load.mass, load.inertia, load.centre, body.reference)
                yield f"{name} (payload {number + 1})", Contribution(model.twists[name], matrix)
        else:
            matrix = moving_inertia(model.mechanism, body)
            if matrix is not None:
                yield name, Contribution(model.twists[name], matrix)
    for name, tie in model.ties.items():
        yield f"{name} (link)", tie.inertia


def _body_inertia(model: _Model, item: Placed, name: str) -> Iterator[tuple[str, Contribution]]:
    """A body's inertia with its mean twist, and that of its elastic motion about it; the two are orthogonal."""
    mean, own = item.element.bodies[name], item.element.body_inertia[name]
    turn = spatial_rotation(item.component.place.rotation)
    yield name, Contribution(model.twists[name], turn @ own @ turn.T)
    yield f"{name} (elastic)", Contribution(item.operator, item.element.inertia[name] - mean.T @ own @ mean)


def _require_support(model: _Model, elastic: Mapping[str, Contribution]) -> None:
    stiffness = assemble(elastic, model.size)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(stiffness), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(stiffness * scale * scale[:, None])
    if values[0] <= _SINGULAR:
        motion = np.abs(vectors[:, 0] * scale)
        owners = dict.fromkeys(model.names[index].rpartition(".")[0] for index in np.argsort(motion)[::-1][:12])
        moving = ", ".join(name for name in owners if name)
        raise refuse(
            "stage",
            f"a motion has no stiffness (lowest scaled eigenvalue {values[0]:.2g}); it moves {moving}",
            "Connect these parts to the ground: check for links without contact, and units without a grounded link",
        )


def _inputs(model: _Model) -> tuple[Array, dict[str, Array]]:
    drives = model.assembly.actuators
    wrenches = [rows.T for rows in place_twists(wrench_places(model.assembly), model.motions)]
    force = np.hstack([np.zeros((model.size, len(drives))), *wrenches])
    for name, wrench in exerted_wrenches(model.assembly).items():
        force = force + model.ties[name].strain.operator.T @ np.real(wrench)
    return force, imposed_strokes(model.assembly, {link: _stroke(model, link) for link in model.assembly.strokes.values()})


def _stroke(model: _Model, link: str) -> Array:
    """Coordinates of a component (n,) imposed by a link's unit stroke, or the twist between its faces (6,) without a shape."""
    if link in model.ties:
        return np.real(actuator_of(model.assembly.links[link].part).free_deformation)
    return _holder(model, link).element.free_strokes[link]


def _holder(model: _Model, link: str) -> Placed:
    return next(item for item in model.placed if link in item.element.resultants)


def _outputs(model: _Model, imposed: Mapping[str, Array]) -> tuple[Array, Array]:
    rows = [*place_twists(twist_places(model.assembly), model.motions), *gauge_rows(model.assembly, model.motions)]
    inputs = len(input_channels(model.assembly))
    passed = [np.zeros((len(row), inputs)) for row in rows]
    exerted = exerted_wrenches(model.assembly)
    for name in (*model.assembly.links, *model.assembly.superelements):
        law, row = _resultant(model, name)
        rows.append(row)
        own = -law @ imposed[name] if name in imposed else np.zeros((len(row), inputs))
        passed.append(own - np.real(exerted[name]) if name in exerted else own)
    return np.vstack(rows), np.vstack(passed)


def _resultant(model: _Model, name: str) -> tuple[Array, Array]:
    """Matrix from a link's strains to its wrenches (w,), and from all coordinates (w, N)."""
    tie = model.ties.get(name)
    if tie is not None:
        law = tie.passed @ tie.strain.law
        return law, law @ tie.strain.operator
    item, link = _holder(model, name), model.assembly.links[name]
    law, sleeve = item.element.resultants[name], casing(link)
    own = law @ item.operator
    return law, own if sleeve is None else own + sleeve @ _across(item, link)


def _rigid(model: _Model) -> Array:
    """Motion (N, 6) of bodies and joints with the ground; internal coordinates are zero (exact if nothing inside is fixed)."""
    centre = model.assembly.bodies[PLATFORM].reference
    places = {name: body.reference for name, body in model.assembly.bodies.items()}
    for item in model.placed:
        places |= {each.joint.name: item.component.place.point(each.joint.frame.position) for each in item.component.interfaces}
    result = np.zeros((model.size, 6))
    for name, place in places.items():
        if name in model.blocks:
            result[model.blocks[name]] = transport(place - centre)
    return result


def _rigid_outputs(model: _Model) -> Array:
    """Outputs (p, 6) when everything moves with the ground: only absolute twists respond."""
    centre = model.assembly.bodies[PLATFORM].reference
    result = np.zeros((len(output_channels(model.assembly)), 6))
    result[absolute(model.assembly)] = np.vstack([transport(place.point - centre) for place in twist_places(model.assembly).values()])
    return result


def _carry_wrench(model: _Model) -> Array:
    """Inertial forces (N, 6) when everything, the ground included, is accelerated rigidly."""
    centre = model.assembly.bodies[PLATFORM].reference
    total = np.zeros((model.size, 6))
    for item in model.placed:
        total += item.operator.T @ item.element.carried @ twist_transform(item.component.place, centre)
    for name, body in model.assembly.bodies.items():
        loads = carried_masses(model.mechanism, body)
        for load in loads[1:] if is_elastic(model.assembly, name) else loads:
            matrix = rigid_inertia(load.mass, load.inertia, load.centre, body.reference)
            total += model.twists[name].T @ matrix @ transport(body.reference - centre)
    for tie in model.ties.values():
        total += tie.inertia.operator.T @ tie.inertia.law @ tie.carried @ transport(-centre)
    return total
