"""Linearisation about a state, giving a `LinearModel` of body motions and flexure amplitudes (docs/nonlinear.md, 25)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.number import Array, matvec
from flexstage.beams.compliance import viscous_damping
from flexstage.beams.flexure.law import FlexureLaw
from flexstage.beams.mass import mass
from flexstage.mechanism.mechanism import GROUND, PLATFORM
from flexstage.models.linear.channels import (
    Motions,
    absolute,
    gauge_rows,
    output_channels,
    twist_places,
    wrench_owners,
    wrench_places,
)
from flexstage.models.linear.elimination import eliminate
from flexstage.models.linear.model import Contribution, LinearModel, strain_forces
from flexstage.models.nonlinear.elements.corotated import Corotated, port_motion, stiffen_ports
from flexstage.models.nonlinear.elements.element import mode_paths
from flexstage.models.nonlinear.elements.fixed_coordinates import gradients
from flexstage.models.nonlinear.elements.hinge import stiffen
from flexstage.models.nonlinear.equilibrium import State
from flexstage.models.nonlinear.graph import FlexureState, assemble, end_motion, geometric, hinge_ends, weight_motion
from flexstage.models.nonlinear.stage import Flexures, Nonlinear
from flexstage.parts.part import inner
from flexstage.spatial.frame import COMPONENTS, FORCES, Frame, cross_matrix, spatial_rotation, transport, twist_transform

_SHAKEN = " (link)"
_MATRICES, MEMORY = 6.0, 8e9
"""Number of full matrices in memory at once, and their maximum size in bytes."""


@dataclass(frozen=True, eq=False)
class _Linear:
    """A link's matrices (b, 12 + m, 12 + m) for the motions of its bodies and its m own amplitudes."""

    elastic: Array
    geometric: Array
    mass: Array
    rows: Array | None = None
    """Operator of `elastic` (b, r, 12 + m); absent: identity."""


@dataclass(frozen=True, eq=False)
class _Coordinates:
    """Offsets of the coordinates: body DOFs, then the own amplitudes of every flexure, in order."""

    model: Nonlinear
    own: Mapping[str, int]

    @property
    def size(self) -> int:
        return self.model.freedoms + sum(self.own.values())

    @property
    def names(self) -> tuple[str, ...]:
        bodies = (f"{body}.{component}" for body in self.model.bodies for component in COMPONENTS)
        return (*bodies, *(f"{link}.mode{number + 1}" for link, count in self.own.items() for number in range(count)))

    def body(self, number: int) -> Array:
        """Selector (6, n) of the DOFs of a body, zero for the ground."""
        result = np.zeros((6, self.size))
        if 0 <= number < len(self.model.bodies):
            result[:, 6 * number : 6 * number + 6] = np.eye(6)
        return result

    def ports(self, name: str, bodies: Array) -> Array:
        """Selector (6 p + m, n) of the port bodies of a superelement and its own modes."""
        return np.concatenate([*(self.body(int(each)) for each in bodies), self.link(name, (-1, -1))[12:]])

    def link(self, name: str, joins: tuple[int, int]) -> Array:
        """Selector (12 + m, n) of the two bodies of a link and its own amplitudes."""
        before = list(self.own)[: list(self.own).index(name)] if name in self.own else list(self.own)
        start = self.model.freedoms + sum(self.own[each] for each in before)
        inside = np.eye(self.own.get(name, 0), self.size, k=start)
        return np.concatenate([self.body(joins[0]), self.body(joins[1]), inside])


@check_arguments
def linearise(state: State, *, locked: Sequence[str] = (), inner: bool = True) -> LinearModel:
    """Linearise about a state; returns a linear model for modes, responses and lost motion of a displaced or loaded stage.

    The cases of the state are the batch axes of the model.

    - Fixed coordinates are released: their reactions act as loads of constant direction on the free stage. The reaction at a fixed rotation
      is the moment conjugate to the component of the rotation vector. Fixed coordinates in `locked` remain fixed.
    - The transverse deformations of plates (plate fields) are quasi-static, without mass.
    - The stiffness is symmetrised. It is the sum of one contribution per link and the contribution `geometric`.
    - Forces inside flexures are not computed: the model lists them as `unknown` outputs. Gauges measure along their nominal lines.
    - Without `inner` coordinates, each flexure is a 6x6 stiffness about its middle, in the frame of its start. Lost motion and drift use
      this form. The mass is reduced by Guyan's method, so that static results are unchanged and modes are approximate.

    Raises `DesignError` if no case has an equilibrium, if a name in `locked` is not fixed, or if matrices need more than 8 GB.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.models.nonlinear.equilibrium import equilibrium
    >>> from flexstage.models.nonlinear.stage import nonlinear
    >>> model = linearise(equilibrium(nonlinear(parallelogram()), {"B": 10e-6}))
    >>> model.coordinates[0], "geometric" in model.stiffness
    ('platform.x', True)
    """
    if not np.any(state.converged):
        raise refuse("stage", "no case has an equilibrium", "Check the status of the state, or reduce the load")
    for name in locked:
        if name not in state.held:
            raise refuse(name, "not fixed at this state", suggest_nearest(name, state.held))
    model = state.model
    _require_memory(state, inner=inner)
    whole = assemble(model, state.pose, state.loads, state.hold)
    links = {
        name: item if inner else _follow_statically(item, bent, group.law, place)
        for group, bent in zip(model.flexures, whole.bent, strict=True)
        for place, (name, item) in enumerate(_flexures(group, bent).items())
    }
    own = {name: item.mass.shape[-1] - 12 for name, item in links.items()} | {each.name: len(each.squares) for each in model.elements}
    order = _Coordinates(model, own)
    return _assembled(state, order, _joins(model), links, [state.held.index(name) for name in locked])


def _require_memory(state: State, *, inner: bool) -> None:
    """Refuse models whose dense matrices exceed the memory of common computers."""
    model, cases = state.model, len(state.pose.position)
    own = sum(len(group.names) * (group.law.form.shape[-1] - 3) for group in model.flexures) if inner else 0
    size = model.freedoms + own + sum(len(each.squares) for each in model.elements)
    needed, most = (f"{each / 1e9:.0f} GB" for each in (8.0 * _MATRICES * cases * size**2, MEMORY))
    if 8.0 * _MATRICES * cases * size**2 > MEMORY:
        what = f"linearisation about {cases} states has {size:,} coordinates; its dense matrices need {needed} (expected at most {most})"
        raise refuse("stage", what, "Use fewer states at once (state.case), or omit coordinates inside flexures (inner=False)")


def _joins(model: Nonlinear) -> dict[str, tuple[int, int]]:
    """The bodies of all links by number."""
    return {
        name: (int(one), int(other))
        for group in (*model.flexures, model.hinges)
        for name, one, other in zip(group.names, group.first, group.second, strict=True)
    }


def _assembled(
    state: State, order: _Coordinates, joins: Mapping[str, tuple[int, int]], links: Mapping[str, _Linear], locked: list[int]
) -> LinearModel:
    model, assembly = state.model, state.model.assembly
    stiffness: dict[str, Contribution] = {}
    bending = np.zeros((len(state.pose.position), order.size, order.size))
    for name, item in links.items():
        select = order.link(name, joins[name])
        stiffness[name] = Contribution(select if item.rows is None else item.rows @ select, item.elastic, _loss(model, name))
        _add(bending, select, item.geometric)
    rows, remains = _hinges(state)
    for place, name in enumerate(model.hinges.names):
        select = order.link(name, joins[name])
        stiffness[name] = Contribution(rows[place] @ select, model.hinges.stiffness[place], _loss(model, name))
        _add(bending, select, remains[place])
    for element in model.elements:
        stiffness[element.name], remainder = _strained(state, order, element)
        bending += remainder
    bending[:, : model.freedoms, : model.freedoms] += _turning(model, state)
    stiffness["geometric"] = Contribution(np.eye(order.size), 0.5 * (bending + bending.mT))
    inertia, carriers = _inertia(state, order, joins, links)
    force, output, feedthrough = _channels(state, order, rows, joins)
    basis, kept = _free(_locked(state, order, rows, locked), order)
    known = 1.0 if state.converged.all() else np.where(state.converged.ravel(), 1.0, np.nan)[:, None, None]
    imposed = {name: model.hinges.stroke[place] for place, name in enumerate(model.hinges.names) if np.any(model.hinges.stroke[place])}
    rigid = np.zeros((len(state.pose.position), order.size, 6))
    rigid[:, : model.freedoms] = _rigid(state)
    carried = strain_forces(inertia, carriers) if inertia else np.zeros_like(rigid)
    names = order.names
    return _shaped(
        state,
        LinearModel(
            coordinates=tuple(names[index] for index in kept),
            stiffness={name: Contribution(known * (item.operator @ basis), item.law, item.loss_factor) for name, item in stiffness.items()},
            inertia={name: Contribution(item.operator @ basis, item.law) for name, item in inertia.items()},
            inputs=model.inputs,
            force=basis.mT @ force,
            imposed=imposed,
            outputs=output_channels(assembly),
            output=output @ basis,
            feedthrough=feedthrough,
            rigid=rigid[:, list(kept)],
            rigid_output=np.where(absolute(assembly)[:, None], output @ rigid, 0.0),
            base_inertia=basis.mT @ carried,
            damping=model.damping,
            idle=(),
            provenance=f"about a state of the {model.provenance}",
            unknown=tuple(f"{name}.{force}" for name in _unknown_outputs(model) for force in FORCES),
            viscous=_viscous(model),
        ),
    )


def _add(matrix: Array, select: Array, own: Array) -> None:
    """Add link terms (b, k, k) to the DOFs (b, n, n) of its selector (k, n), for two different bodies; the ground has no rows."""
    rows, columns = np.nonzero(select)
    matrix[:, columns[:, None], columns] += own[:, rows[:, None], rows]


def _shaped(state: State, model: LinearModel) -> LinearModel:
    """Reshape the cases of the model to the shape of the state."""
    cases = len(state.pose.position)

    def reshape(value: object) -> object:
        if isinstance(value, Contribution):
            return replace(value, operator=reshape(value.operator), law=reshape(value.law))
        if isinstance(value, dict):
            return {name: reshape(each) for name, each in value.items()}
        if isinstance(value, np.ndarray) and value.ndim == 3 and len(value) == cases:
            return value.reshape(*state.shape, *value.shape[1:])
        return value

    return replace(model, **{each.name: reshape(getattr(model, each.name)) for each in fields(LinearModel)})


def _flexures(group: Flexures, bent: FlexureState) -> dict[str, _Linear]:
    """Every flexure of a group, by name."""
    law, element, inside = group.law, bent.tangent, _inner_response(group, bent)
    amplitudes, swayed = inside.amplitudes, inside.swayed
    unit = (law.rigidity / law.length)[:, None, None, None]
    elastic = amplitudes.mT @ (law.form[:, None] @ amplitudes) + inside.gap.mT @ inside.hung
    remainder = amplitudes.mT @ ((element.hessian - law.form[:, None]) @ amplitudes)
    if element.hung is not None and element.swayed is not None:
        mixed = swayed.mT @ (element.hung @ amplitudes)
        remainder = remainder - mixed - mixed.mT - swayed.mT @ (element.swayed[..., 1, :, :] @ swayed)
    turned = geometric(law, bent, bent.wrench[..., :3], bent.wrench[..., 3:])
    remainder = unit * remainder
    remainder[..., :12, :12] += turned
    masses = _mass(group, bent, inside)
    return {
        name: _Linear(unit[place] * elastic[place], 0.5 * (remainder[place] + remainder[place].mT), masses[place])
        for place, name in enumerate(group.names)
    }


def _follow_statically(item: _Linear, bent: FlexureState, law: FlexureLaw, place: int) -> _Linear:
    """A flexure of a group without own coordinates: its 6x6 about its middle, and a `geometric` remainder."""
    whole = item.elastic + item.geometric
    follow = -np.linalg.solve(whole[..., 12:, 12:], whole[..., 12:, :12])
    basis = np.concatenate([np.broadcast_to(np.eye(12), (*follow.shape[:-2], 12, 12)), follow], axis=-2)
    condensed = basis.mT @ whole @ basis
    turned = geometric(law, bent, bent.wrench[..., :3], bent.wrench[..., 3:])[place]
    length = law.length[place]
    back = transport(np.array([-0.5 * length, 0.0, 0.0]))  # from the end to the middle
    rows = back @ (np.repeat([length, 1.0], 3)[:, None] * end_motion(law, bent)[place])
    second = np.linalg.inv(rows[..., 6:])
    elastic = second.mT @ (condensed - 0.5 * (turned + turned.mT))[..., 6:, 6:] @ second
    return _Linear(elastic, condensed - rows.mT @ elastic @ rows, basis.mT @ item.mass @ basis, rows)


@dataclass(frozen=True, eq=False)
class _InnerResponse:
    """Dependent quantities of a flexure by its body and own coordinates: amplitudes (l, b, q, 12 + m), gap, force, weight."""

    amplitudes: Array
    gap: Array
    hung: Array
    swayed: Array


def _inner_response(group: Flexures, bent: FlexureState) -> _InnerResponse:
    law, element = group.law, bent.tangent
    motion = end_motion(law, bent)
    sway = weight_motion(bent) if bent.weight is not None else np.zeros((*motion.shape[:-2], 3, 12))
    follow, own = _constrain(law.form[:, None], element.turning, motion[..., 3:, :])
    amplitudes = np.concatenate([follow, own], axis=-1)
    padding = np.zeros((*motion.shape[:-2], 6, own.shape[-1]))
    ends, swayed = np.concatenate([motion, padding], -1), np.concatenate([sway, padding[..., :3, :]], -1)
    gap = element.reach @ amplitudes - ends[..., :3, :]
    if element.swayed is not None:
        gap = gap + element.swayed[..., 0, :, :] @ swayed
    return _InnerResponse(amplitudes, gap, np.linalg.solve(element.soft, gap), swayed)


def _constrain(form: Array, turning: Array, turned: Array) -> tuple[Array, Array]:
    """Amplitudes that rotate the end with its body (..., q, 12), and amplitudes (..., q, q - 3) without rotation, scaled by stiffness."""
    root = 1.0 / np.sqrt(np.linalg.diagonal(form))
    scaled = turning * root[..., None, :]
    follow = root[..., None] * (scaled.mT @ np.linalg.solve(scaled @ scaled.mT, turned))
    _, _, vectors = np.linalg.svd(scaled)
    return follow, root[..., None] * vectors[..., 3:, :].mT


def _mass(group: Flexures, bent: FlexureState, inside: _InnerResponse) -> Array:
    """Mass (l, b, 12 + m, 12 + m) of flexures: every point moves with the start, and by bending and stretch amplitudes."""
    law, lies = group.law, bent.lies
    place, turn = _points(group, bent, inside)
    local = lies.turn.mT @ (bent.frame[..., None, :, :].mT @ turn)
    weights = law.length[:, None, None] * lies.rule.weights
    along, about = (weights[..., None] * law.inertia[:, None, :, part] for part in (slice(0, 1), slice(1, 4)))
    moved = np.einsum("lbnci,lbncj->lbij", place, along[..., None] * place)
    return moved + np.einsum("lbnci,lbncj->lbij", local, about[..., None] * local)


def _points(group: Flexures, bent: FlexureState, inside: _InnerResponse) -> tuple[Array, Array]:
    """Displacement and rotation of flexure points (l, b, n, 3, 12 + m) in stage axes by the flexure coordinates."""
    law, lies, amplitudes = group.law, bent.lies, inside.amplitudes
    paths, turned, soft = mode_paths(law, lies)
    frame = bent.frame[..., None, :, :]
    count = amplitudes.shape[-1]
    moved = paths @ amplitudes[..., None, : paths.shape[-1], :] - soft[..., 0, :, :, :] @ inside.hung[..., None, :, :]
    moved = moved + soft[..., 1, :, :, :] @ inside.swayed[..., None, :, :]
    place = law.length[:, None, None, None, None] * (frame @ moved)
    turn = frame @ (turned @ amplitudes[..., None, : paths.shape[-1], :])
    arm = _arms(group, bent)
    place = place + _pad(np.concatenate([np.broadcast_to(np.eye(3), (*arm.shape, 3)), -cross_matrix(arm)], axis=-1), count)
    return place, turn + _pad(np.concatenate([np.zeros((*arm.shape, 3)), np.broadcast_to(np.eye(3), (*arm.shape, 3))], axis=-1), count)


def _arms(group: Flexures, bent: FlexureState) -> Array:
    """Arms (l, b, n, 3) from the first body references to the points of flexures."""
    reach = group.law.length[:, None, None, None] * matvec(bent.frame[..., None, :, :], bent.lies.place)
    return bent.onset[..., None, :] + reach


def modal_motions(state: State, shapes: Array, locked: Sequence[str] = ()) -> tuple[Array, dict[str, Array]]:
    """Compute the motions of bodies and flexures for mode shapes (n, k) of `linearise(state, locked=locked)`, in the first case.

    Returns the twists of bodies at their reference points (k, bodies, 6), and the twists of flexure centre lines by name (k, points + 2,
    6), including both ends.
    """
    model = state.model
    whole = assemble(model, state.pose, state.loads, state.hold)
    inside = [_inner_response(group, bent) for group, bent in zip(model.flexures, whole.bent, strict=True)]
    own = {name: each.amplitudes.shape[-1] - 12 for group, each in zip(model.flexures, inside, strict=True) for name in group.names}
    own |= {each.name: len(each.squares) for each in model.elements}
    order, joins, (rows, _) = _Coordinates(model, own), _joins(model), _hinges(state)
    basis, _ = _free(_locked(state, order, rows, [state.held.index(name) for name in locked]), order)
    full = basis.reshape(-1, *basis.shape[-2:])[0] @ shapes
    lines: dict[str, Array] = {}
    for group, bent, each in zip(model.flexures, whole.bent, inside, strict=True):
        place, turn = _points(group, bent, each)
        for number, name in enumerate(group.names):
            moved = order.link(name, joins[name]) @ full
            points = np.concatenate([place[number, 0], turn[number, 0]], axis=-2) @ moved
            lines[name] = np.moveaxis(np.concatenate(_with_ends(bent, number, points, moved)), -1, 0)
    return np.moveaxis(full[: model.freedoms].reshape(-1, 6, full.shape[-1]), -1, 0), lines


def _with_ends(bent: FlexureState, number: int, points: Array, moved: Array) -> tuple[Array, Array, Array]:
    """Twists of the start, the points and the end of a flexure, (..., 6, k), by motions (12 + m, k) of its coordinates."""
    start, end = (transport(arm[number, 0]) @ moved[part] for arm, part in ((bent.onset, slice(0, 6)), (bent.arm, slice(6, 12))))
    return start[None], points, end[None]


def flexure_motions(group: Flexures, bent: FlexureState, moved: Array, inner: Array) -> dict[str, Array]:
    """Compute twists (points + 2, 6) of centre lines in the first case, from body twists (n + 1, 6) and inner unknowns (l, q + 6)."""
    law = group.law
    paths, turned, soft = (each[:, 0] for each in mode_paths(law, bent.lies))
    frame, arms = bent.frame[:, 0, None], _arms(group, bent)[:, 0]
    size, count = paths.shape[-1], law.form.shape[-1]
    bent_by, force = inner[:, None, :size, None], inner[:, None, count : count + 3, None]
    place = law.length[:, None, None] * (frame @ (paths @ bent_by + soft[:, 0] @ force))[..., 0]
    turn = (frame @ (turned @ bent_by))[..., 0]
    element: dict[str, Array] = {}
    for number, name in enumerate(group.names):
        both = np.concatenate([moved[group.first[number]], moved[group.second[number]]])[:, None]
        carried = transport(arms[number]) @ both[:6]
        points = carried + np.concatenate([place[number], turn[number]], axis=-1)[..., None]
        element[name] = np.concatenate(_with_ends(bent, number, points, both))[..., 0]
    return element


def _pad(matrix: Array, count: int) -> Array:
    return np.concatenate([matrix, np.zeros((*matrix.shape[:-1], count - matrix.shape[-1]))], axis=-1)


def _hinges(state: State) -> tuple[Array, Array]:
    """Deformations of links about centres by the motions of their bodies (l, b, 6, 12), and the non-elastic part of their stiffness."""
    model = state.model
    hinges, cases = model.hinges, len(state.pose.position)
    if not hinges.names:
        return np.zeros((0, cases, 6, 12)), np.zeros((0, cases, 12, 12))
    links, freedoms = hinges.locked.T
    held = np.zeros((len(hinges.names), cases, 6))
    held[links, :, freedoms] = state.pose.held[:, : len(links)].T
    _, own, _, rows = stiffen(hinges, hinge_ends(model, state.pose), state.loads.inputs, state.loads.constant, held)
    return rows, own - rows.mT @ hinges.stiffness[:, None] @ rows


def _turning(model: Nonlinear, state: State) -> Array:
    """Stiffness of bodies (b, n, n) due to rotation of the arms of constant-direction forces and of reactions."""
    cases = len(state.pose.position)
    result = np.zeros((cases, model.freedoms + 6, model.freedoms + 6))
    dead = model.constant_wrenches(state.loads)
    arms = matvec(state.pose.turn[:, model.places.body], model.places.arm)
    turning = -cross_matrix(dead[..., :3]) @ cross_matrix(arms)
    for place, number in enumerate(model.places.body):
        part = slice(6 * number + 3, 6 * number + 6)
        result[:, part, part] += turning[:, place]
    first = state.pose.held.shape[1] - len(state.held)
    for place, number in enumerate(state.hold.body):
        part = slice(6 * number, 6 * number + 6)
        result[:, part, part] += state.pose.held[:, first + place, None, None] * gradients(state.hold, place, state.pose)[2]
    return result[:, : model.freedoms, : model.freedoms]


def _rigid(state: State) -> Array:
    """Motion (b, n, 6) of bodies with the ground, whose twist is at the platform's reference."""
    position = state.pose.position
    centre = position[:, state.model.body(PLATFORM)]
    carries = [transport(position[:, number] - centre) for number in range(len(state.model.bodies))]
    return np.concatenate(carries, axis=-2)


def _inertia(
    state: State, order: _Coordinates, joins: Mapping[str, tuple[int, int]], links: Mapping[str, _Linear]
) -> tuple[dict[str, Contribution], dict[str, Array]]:
    """Masses of bodies and links, and their motions with the ground."""
    model, pose = state.model, state.pose
    centre = pose.position[:, model.body(PLATFORM)]
    inertia: dict[str, Contribution] = {}
    carriers: dict[str, Array] = {}
    for name, matrix in model.inertia.items():
        number = model.body(name)
        turn = spatial_rotation(pose.turn[:, number])
        inertia[name] = Contribution(order.body(number), turn @ matrix @ turn.mT)
        carriers[name] = transport(pose.position[:, number] - centre)
    for name, item in links.items():
        carries = [transport(pose.position[:, number] - centre) for number in joins[name]]
        still = np.zeros((len(centre), item.mass.shape[-1] - 12, 6))
        inertia[name + _SHAKEN] = Contribution(order.link(name, joins[name]), item.mass)
        carriers[name + _SHAKEN] = np.concatenate([*carries, still], axis=-2)
    for place, name in enumerate(model.hinges.names):
        matrix = mass(model.assembly.links[name].part, model.assembly.links[name].material)
        ends = _hinge_twists(state, place)
        both = np.zeros((len(centre), 12, 12))
        both[:, :6, :6], both[:, 6:, 6:] = ends
        carries = [transport(pose.position[:, number] - centre) for number in joins[name]]
        inertia[name + _SHAKEN] = Contribution(both @ order.link(name, joins[name]), matrix)
        carriers[name + _SHAKEN] = both @ np.concatenate(carries, axis=-2)
    for element in model.elements:
        twists = _port_twists(state, element)
        select = order.ports(element.name, element.bodies)
        inertia[element.name + _SHAKEN] = Contribution(twists @ select, element.inertia)
        carries = np.concatenate([transport(pose.position[:, body] - centre) for body in element.bodies], axis=-2)
        still = np.zeros((len(centre), len(element.squares), 6))
        carriers[element.name + _SHAKEN] = twists @ np.concatenate([carries, still], axis=-2)
    return inertia, carriers


def _strained(state: State, order: _Coordinates, element: Corotated) -> tuple[Contribution, Array]:
    """Own stiffness of a superelement over its strains and modes, and all its other terms (b, n, n)."""
    position, turn = state.pose.position[:, element.bodies], state.pose.turn[:, element.bodies]
    rows = element.relative @ port_motion(element, position, turn).rows
    _, whole = stiffen_ports(element, position, turn, state.loads.gravity)
    ports, strained, modes = rows.shape[-1], rows.shape[-2], len(element.squares)
    select = order.ports(element.name, element.bodies)
    law, operator = np.zeros((strained + modes,) * 2), np.zeros((len(rows), strained + modes, ports + modes))
    law[:strained, :strained], law[strained:, strained:] = element.stiffness, np.diag(element.squares)
    operator[:, :strained, :ports], operator[:, strained:, ports:] = rows, np.eye(modes)
    remainder = select[:ports].T @ (whole - rows.mT @ element.stiffness @ rows) @ select[:ports]
    return Contribution(operator @ select, law, element.loss), remainder


def _port_twists(state: State, element: Corotated) -> Array:
    """Port twists of a superelement in port axes, and modes (b, 6 p + m, 6 p + m), by motions of bodies and modes."""
    turn = state.pose.turn[:, element.bodies]
    count, modes = len(element.bodies), len(element.squares)
    result = np.zeros((len(turn), 6 * count + modes, 6 * count + modes))
    result[:, 6 * count :, 6 * count :] = np.eye(modes)
    for port in range(count):
        own = slice(6 * port, 6 * port + 6)
        axes = spatial_rotation(turn[:, port] @ element.axes[port])
        result[:, own, own] = axes.mT @ transport(matvec(turn[:, port], element.arm[port]))
    return result


def _hinge_twists(state: State, place: int) -> tuple[Array, Array]:
    """Twists (b, 6, 6) of the ends of a link at its centre, in the frames of each body, by the body twists."""
    hinges, pose = state.model.hinges, state.pose
    twists = []
    for bodies, arms in ((hinges.first, hinges.arm_first), (hinges.second, hinges.arm_second)):
        turn = pose.turn[:, bodies[place]]
        arm = turn @ arms[place]
        twists.append(spatial_rotation(turn @ hinges.turn[place]).mT @ transport(arm))
    return twists[0], twists[1]


def _channels(state: State, order: _Coordinates, rows: Array, joins: Mapping[str, tuple[int, int]]) -> tuple[Array, Array, Array]:
    """Forces of inputs (b, n, m), and outputs (b, p, n) with their feed-through (p, m)."""
    model, assembly = state.model, state.model.assembly
    cases, inputs = len(state.pose.position), len(model.inputs)
    motions = Motions(
        {name: np.broadcast_to(order.body(model.body(name)), (cases, 6, order.size)) for name in model.bodies}, _at(state, order)
    )
    force = np.zeros((cases, order.size, inputs))
    start = inputs - 6 * len(wrench_places(assembly))
    for place, twist in enumerate(_moved_twists(state, order, wrench_places(assembly))):
        force[:, :, start + 6 * place : start + 6 * place + 6] += twist.mT
    for place, name in enumerate(model.hinges.names):
        force += (rows[place] @ order.link(name, joins[name])).mT @ model.hinges.thrust[place]
    output_rows = [*_moved_twists(state, order, twist_places(assembly)), *gauge_rows(assembly, motions)]
    passed = [np.zeros((row.shape[-2], inputs)) for row in output_rows]
    for name in wrench_owners(assembly):
        place = model.hinges.names.index(name) if name in model.hinges.names else None
        law = np.zeros((6, 6)) if place is None else model.hinges.stiffness[place]
        output_rows.append(np.zeros((6, order.size)) if place is None else law @ rows[place] @ order.link(name, joins[name]))
        passed.append(np.zeros((6, inputs)) if place is None else -law @ model.hinges.stroke[place] - model.hinges.thrust[place])
    output = np.concatenate([np.broadcast_to(row, (cases, *row.shape[-2:])) for row in output_rows], axis=-2)
    return force, output, np.concatenate(passed)


def _moved_twists(state: State, order: _Coordinates, places: Mapping[str, object]) -> list[Array]:
    """Twist (b, 6, n) of every point in its current position, in stage axes."""
    twists = []
    for name in places:
        number, arm = state.place(name)
        twists.append(transport(state.pose.turn[:, number] @ (state.model.growth[number] * arm)) @ order.body(number))
    return twists


def _at(state: State, order: _Coordinates) -> Callable[[str, Frame], Array]:
    def twist(body: str, frame: Frame) -> Array:
        if body == GROUND:
            return np.zeros((6, order.size))
        number = state.model.body(body)
        return twist_transform(frame, state.pose.position[:, number]) @ order.body(number)

    return twist


def _locked_rows(model: Nonlinear, rows: Array, order: _Coordinates, joins: Mapping[str, tuple[int, int]]) -> Array:
    """Locked DOFs of links by all coordinates (b, c, n)."""
    names = model.hinges.names
    locked_rows = [rows[link, :, freedom, None] @ order.link(names[link], joins[names[link]]) for link, freedom in model.hinges.locked]
    return np.concatenate(locked_rows, axis=-2) if locked_rows else np.zeros((rows.shape[1], 0, order.size))


def _held_rows(state: State, order: _Coordinates, locked: list[int]) -> list[Array]:
    """Coordinates that stay fixed, by all coordinates (b, 1, n) each."""
    return [gradients(state.hold, place, state.pose)[1][:, None] @ order.body(int(state.hold.body[place])) for place in locked]


def _locked(state: State, order: _Coordinates, rows: Array, locked: list[int]) -> Array:
    """Constraint rows (b, c, n): locked DOFs of links, and coordinates, by number, that stay fixed."""
    return np.concatenate([_locked_rows(state.model, rows, order, _joins(state.model)), *_held_rows(state, order, locked)], axis=-2)


def _free(locked: Array, order: _Coordinates) -> tuple[Array, tuple[int, ...]]:
    """Null space of the locked DOFs (b, c, n): motions (..., n, k) and the names of their coordinates."""
    if not locked.shape[-2]:
        return np.eye(order.size), tuple(range(order.size))
    scale = np.array([10.0 if name.rpartition(".")[2].startswith("r") else 1.0 for name in order.names])
    solution = eliminate(locked, scale, keep=tuple(range(6)))
    return solution.basis, solution.independent


def _loss(model: Nonlinear, name: str) -> float:
    link = model.assembly.links[name]
    holder = inner(link.part) if link.material is None else link.material
    value = getattr(holder, "loss_factor", None)
    return 0.0 if value is None else value


def _unknown_outputs(model: Nonlinear) -> Iterator[str]:
    """Flexures, and ports of superelements, whose forces the model does not determine."""
    yield from (name for group in model.flexures for name in group.names)
    yield from (f"{each.name}.{port}" for each in model.elements for port in each.ports)


def _viscous(model: Nonlinear) -> dict[str, Array]:
    dampers = {name: viscous_damping(model.assembly.links[name].part) for name in model.hinges.names}
    dampers |= {each.name: each.damping for each in model.elements}
    return {name: damping for name, damping in dampers.items() if damping is not None}
