"""Residual and stiffness of the stage at a pose, with links condensed to six unknowns per body (docs/nonlinear.md, 17 to 20)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from flexstage.base.number import Array, matvec
from flexstage.beams.flexure.law import FlexureLaw
from flexstage.models.nonlinear.elements.condense import FlexureResponse, condense, relax_fields
from flexstage.models.nonlinear.elements.corotated import stiffen_ports
from flexstage.models.nonlinear.elements.element import Shape, Tangent, shape, tangent
from flexstage.models.nonlinear.elements.fixed_coordinates import FixedCoordinates, gradients
from flexstage.models.nonlinear.elements.hinge import Ends, Hinges, imposed, stiffen
from flexstage.models.nonlinear.stage import Flexures, Nonlinear
from flexstage.models.nonlinear.state import Loads, Pose
from flexstage.models.nonlinear.summed import Dense, Sum, empty_sum, solved
from flexstage.spatial.frame import cross_matrix
from flexstage.spatial.rotation import cross, exponential, logarithm


@dataclass(frozen=True, eq=False)
class FlexureState:
    """State of a group of l flexures at a pose of b cases: frames and arms (l, b, ...) in space, configurations, and responses.

    Vectors in space: from the first body's reference point, `onset` (a_i) points to the start and `lever` (h) to the end; `arm` (a_j)
    points from the second body's reference point to the end. `weight` (l, b, 3) is the weight per length in the start frames, divided by E
    I / L^3 with the bending stiffness E I and the length L of a flexure (without gravity: `None`). `gap` (l, b, 6) contains the gaps in
    translation and rotation between the end and the second body.

    `wrench` (l, b, 6) is the wrench that the second body exerts on the flexure's end, after the flexure's own unknowns are solved.
    """

    frame: Array
    onset: Array
    lever: Array
    arm: Array
    weight: Array | None
    lies: Shape
    tangent: Tangent
    gap: Array
    answer: FlexureResponse
    wrench: Array


@dataclass(frozen=True, eq=False)
class OtherTerms:
    """Terms of all elements except flexures (see `other_terms`): `residual` (b, n) and `stiffness` (b, n, n)."""

    residual: Array
    stiffness: Array


@dataclass(frozen=True, eq=False)
class ResidualSum:
    """Residual (b, n) and stiffness during assembly; both include rows of the ground."""

    residual: Array
    stiffness: Sum


@dataclass(frozen=True, eq=False)
class System:
    """System of equations of b cases: residual (b, n) and stiffness for body DOFs and reactions, and the state of the flexures.

    The stiffness is one array, or one sparse matrix per case.
    """

    residual: Array
    matrix: Array | tuple[Any, ...]
    bent: tuple[FlexureState, ...]

    @property
    def stiffness(self) -> Array:
        """Dense stiffness (b, n, n)."""
        return self.matrix if isinstance(self.matrix, np.ndarray) else np.stack([each.toarray() for each in self.matrix])

    def solved(self, right: Array) -> Array:
        """Solve the system for right sides (b, n); returns (b, n), NaN if a case is singular."""
        return solved(self.matrix, right)


def assemble(model: Nonlinear, pose: Pose, loads: Loads, hold: FixedCoordinates) -> System:
    """Assemble residual and stiffness of the stage at a pose. The inner unknowns of each flexure are first computed for the pose."""
    residual, kept = _nothing(model, pose, hold)
    tally = ResidualSum(residual, empty_sum(*residual.shape))
    bent = tuple(flexure_state(group, pose, number, loads) for number, group in enumerate(model.flexures))
    for group, terms in zip(model.flexures, bent, strict=True):
        force, own = _flexure_terms(group.law, terms)
        _scatter(tally, group, force, own)
    _add_loads(model, pose, loads, tally)
    _add_rest(model, pose, loads, hold, tally)
    return System(residual[:, kept], tally.stiffness.total(kept), bent)


def other_terms(model: Nonlinear, pose: Pose, loads: Loads, hold: FixedCoordinates) -> OtherTerms | None:
    """Assemble the terms of links with a 6x6 stiffness, superelements and fixed coordinates; `None` if the stage has none."""
    if not model.hinges.names and not model.elements and not len(hold.body):
        return None
    residual, kept = _nothing(model, pose, hold)
    stiffness = Dense(*residual.shape)
    _add_rest(model, pose, loads, hold, ResidualSum(residual, stiffness))
    return OtherTerms(residual[:, kept], stiffness.total(kept))


def _nothing(model: Nonlinear, pose: Pose, hold: FixedCoordinates) -> tuple[Array, Array]:
    """A zero residual, including the ground rows, and the rows to keep at the end."""
    cases, size, count = len(pose.position), model.freedoms + 6, len(model.hinges.locked) + len(hold.body)
    kept = np.r_[: model.freedoms, size : size + count]
    return np.zeros((cases, size + count)), kept


def _add_rest(model: Nonlinear, pose: Pose, loads: Loads, hold: FixedCoordinates, tally: ResidualSum) -> None:
    _add_hinges(model, pose, loads, tally)
    _add_elements(model, pose, loads, tally)
    _add_holds(hold, pose, tally, model.freedoms + 6 + len(model.hinges.locked))


def flexure_state(group: Flexures, pose: Pose, number: int, loads: Loads) -> FlexureState:
    """Compute the state of a group of flexures for a pose of its bodies."""
    law = group.law
    turn, other = _gather(pose.turn, group.first), _gather(pose.turn, group.second)
    frame = turn @ group.turn[:, None]
    onset, arm = (matvec(each, arms[:, None]) for each, arms in ((turn, group.arm_first), (other, group.arm_second)))
    across = _gather(pose.position, group.second) + arm - _gather(pose.position, group.first) - onset
    length = law.length[:, None, None]
    weight = flexure_weight(law, frame, loads)
    strain, force, moment = pose.strain[number], pose.wrench[number][..., :3], pose.wrench[number][..., 3:]
    lies = shape(law, strain, force, weight)
    slope = tangent(law, strain, moment, lies)
    twisted = logarithm(lies.end_turn @ (other @ group.turn[:, None]).mT @ frame)
    gap = np.concatenate([lies.end - matvec(frame.mT, across) / length, twisted], axis=-1)
    answer = condense(slope, gap)
    wrench = pose.wrench[number] + answer.still[..., -6:]
    return FlexureState(frame, onset, across + onset, arm, weight, lies, slope, gap, answer, wrench)


def end_motion(law: FlexureLaw, bent: FlexureState) -> Array:
    """Compute the matrix T (l, b, 6, 12) from both bodies' motions to the end's motion relative to the start (docs/nonlinear.md, 17).

    The relative motion is in the start frame, with the translation divided by the flexure length.
    """
    back = bent.frame.mT
    none, eye = np.zeros_like(back), np.broadcast_to(np.eye(3), back.shape)
    place = back @ np.concatenate([-eye, cross_matrix(bent.lever), eye, -cross_matrix(bent.arm)], axis=-1)
    turn = np.concatenate([none, -back, none, back], axis=-1)
    return np.concatenate([place / law.length[:, None, None, None], turn], axis=-2)


def weight_motion(bent: FlexureState) -> Array:
    """Compute the change of the weight (l, b, 3, 12) in the start frame per rotation of the first body."""
    assert bent.weight is not None  # noqa: S101  (asked for only where there is weight)
    back = bent.frame.mT
    result = np.zeros((*back.shape[:-1], 12))
    result[..., 3:6] = cross_matrix(bent.weight) @ back
    return result


def geometric(law: FlexureLaw, bent: FlexureState, force: Array, moment: Array) -> Array:
    """Compute the stiffness (l, b, 12, 12) that results from rotation of the arms under the end forces (docs/nonlinear.md, 18)."""
    scale = (law.rigidity / law.length)[:, None, None]
    force_hat = cross_matrix(matvec(bent.frame, force) * scale / law.length[:, None, None])
    moment_hat = cross_matrix(matvec(bent.frame, moment) * scale)
    lever, arm, none = cross_matrix(bent.lever), cross_matrix(bent.arm), np.zeros_like(force_hat)
    result = np.block(
        [
            [none, force_hat, none, none],
            [-force_hat, lever @ force_hat + moment_hat, force_hat, -force_hat @ arm],
            [none, -force_hat, none, none],
            [none, -arm @ force_hat - moment_hat, none, force_hat @ arm],
        ]
    )
    if bent.weight is not None:
        weight, hanging = _weight_of(law, bent)
        result[..., 3:6, 3:6] -= cross_matrix(weight) @ cross_matrix(hanging)
    return result


def _weight_of(law: FlexureLaw, bent: FlexureState) -> tuple[Array, Array]:
    """The weight (l, b, 3) [N] in space, and the arm of its centre from the first body's reference [m]."""
    assert bent.weight is not None  # noqa: S101
    rule = bent.lies.rule
    mean = np.einsum("n,lbnc->lbc", rule.weights * (1.0 - rule.points), bent.lies.rate)
    weight = matvec(bent.frame, bent.weight) * (law.rigidity / law.length**2)[:, None, None]
    return weight, bent.onset + law.length[:, None, None] * matvec(bent.frame, mean)


def _flexure_terms(law: FlexureLaw, bent: FlexureState) -> tuple[Array, Array]:
    """Residual (l, b, 12) and stiffness (l, b, 12, 12) of flexures on their two bodies."""
    count = law.form.shape[-1]
    motion = end_motion(law, bent)
    unit = (law.rigidity / law.length)[:, None, None]
    wrench = bent.wrench
    residual = matvec(motion.mT, unit * wrench)
    moved = bent.answer.moved
    whole = moved[..., count:, :6] @ motion
    result = motion.mT @ (unit[..., None] * whole)
    if bent.weight is not None:
        residual, result = _add_weight(law, bent, motion, residual, result)
    return residual, result + geometric(law, bent, wrench[..., :3], wrench[..., 3:])


def _add_weight(law: FlexureLaw, bent: FlexureState, motion: Array, residual: Array, stiffness: Array) -> tuple[Array, Array]:
    """Add the weight of the flexures (docs/nonlinear.md, 16)."""
    count, moved, element = law.form.shape[-1], bent.answer.moved, bent.tangent
    assert element.hung is not None  # noqa: S101
    assert element.swayed is not None  # noqa: S101
    sway = weight_motion(bent)
    unit = (law.rigidity / law.length)[:, None, None, None]
    down = moved[..., :6] @ motion + moved[..., 6:] @ sway
    mean = (
        element.hung @ down[..., :count, :]
        + element.swayed[..., 0, :, :] @ down[..., count : count + 3, :]
        + element.swayed[..., 1, :, :] @ sway
    )
    stiffness = stiffness + unit * (motion.mT @ (moved[..., count:, 6:] @ sway) - sway.mT @ mean)
    weight, hanging = _weight_of(law, bent)
    residual = residual.copy()
    residual[..., :3] -= weight
    residual[..., 3:6] -= cross(hanging, weight)
    return residual, stiffness


def _add_hinges(model: Nonlinear, pose: Pose, loads: Loads, tally: ResidualSum) -> None:
    hinges, size = model.hinges, model.freedoms + 6
    if not hinges.names:
        return
    links, freedoms = hinges.locked.T
    held = np.zeros((len(hinges.names), len(pose.position), 6))
    held[links, :, freedoms] = pose.held[:, : len(links)].T
    ends = hinge_ends(model, pose)
    force, own, deformation, rows = stiffen(hinges, ends, loads.inputs, loads.constant, held)
    _scatter(tally, hinges, force, own)
    free = imposed(hinges, loads.inputs)
    for place, (link, freedom) in enumerate(hinges.locked):
        tally.residual[:, size + place] = deformation[link, :, freedom] - free[link, :, freedom]
        for body, part in ((hinges.first[link], slice(0, 6)), (hinges.second[link], slice(6, 12))):
            columns = slice(6 * body, 6 * body + 6)
            at = slice(size + place, size + place + 1)
            tally.stiffness.add(at, columns, rows[link, :, freedom, None, part])
            tally.stiffness.add(columns, at, rows[link, :, freedom, part, None])


def _add_elements(model: Nonlinear, pose: Pose, loads: Loads, tally: ResidualSum) -> None:
    """Add superelements, including their weight (docs/nonlinear.md, 31)."""
    for element in model.elements:
        force, own = stiffen_ports(element, pose.position[:, element.bodies], pose.turn[:, element.bodies], loads.gravity)
        for row, body in enumerate(element.bodies):
            rows, at = slice(6 * body, 6 * body + 6), slice(6 * row, 6 * row + 6)
            tally.residual[:, rows] += force[:, at]
            for column, other in enumerate(element.bodies):
                tally.stiffness.add(rows, slice(6 * other, 6 * other + 6), own[:, at, 6 * column : 6 * column + 6])


def hinge_ends(model: Nonlinear, pose: Pose) -> Ends:
    """Return the poses of both bodies of each link in `model.hinges`."""
    first, second = model.hinges.first, model.hinges.second
    return Ends(*(_gather(each, which) for which in (first, second) for each in (pose.position, pose.turn)))


def _add_loads(model: Nonlinear, pose: Pose, loads: Loads, tally: ResidualSum) -> None:
    """Add constant-direction forces at points of bodies, and constant couples (docs/nonlinear.md, 19)."""
    dead = model.constant_wrenches(loads)
    arms = matvec(pose.turn[:, model.places.body], model.places.arm)
    moment = cross(arms, dead[..., :3]) + dead[..., 3:]
    turning = -cross_matrix(dead[..., :3]) @ cross_matrix(arms)
    start = 6 * model.places.body
    wrench = np.concatenate([dead[..., :3], moment], axis=-1).reshape(len(dead), -1)
    np.subtract.at(tally.residual.T, (start[:, None] + np.arange(6)).ravel(), wrench.T)
    tally.stiffness.spread(start + 3, start + 3, np.moveaxis(turning, 1, 0))


def exerted_by(model: Nonlinear, pose: Pose, rate: Loads) -> Array:
    """Compute the generalised forces (b, n) of input loads on bodies and locked DOFs at a pose; the forces are linear in the loads."""
    cases, size = len(pose.position), model.freedoms + 6 + len(model.hinges.locked)
    result = []
    for inputs in (0.0 * rate.inputs, rate.inputs):
        tally = ResidualSum(np.zeros((cases, size)), empty_sum(cases, size))
        loads = Loads(inputs, np.zeros((cases, 3)), np.zeros(cases))
        _add_hinges(model, pose, loads, tally)
        _add_loads(model, pose, loads, tally)
        result.append(tally.residual)
    kept = np.r_[: model.freedoms, model.freedoms + 6 : size]
    return (result[0] - result[1])[:, kept]


def _add_holds(hold: FixedCoordinates, pose: Pose, tally: ResidualSum, start: int) -> None:
    for place in range(len(hold.body)):
        first = 6 * hold.body[place]
        columns, row = slice(first, first + 6), start + place
        reaction = pose.held[:, pose.held.shape[1] - len(hold.body) + place]
        value, along, curved = gradients(hold, place, pose)
        tally.residual[:, row] = value - hold.value[:, place]
        tally.residual[:, columns] += reaction[:, None] * along
        tally.stiffness.add(slice(row, row + 1), columns, along[:, None])
        tally.stiffness.add(columns, slice(row, row + 1), along[..., None])
        tally.stiffness.add(columns, columns, reaction[:, None, None] * curved)


def _scatter(tally: ResidualSum, links: Flexures | Hinges, force: Array, own: Array) -> None:
    """Add link terms (l, b, 12) and (l, b, 12, 12) to their two bodies."""
    freedoms, ends = np.arange(6), ((links.first, slice(0, 6)), (links.second, slice(6, 12)))
    for bodies, rows in ends:
        places = (6 * bodies[:, None] + freedoms).ravel()
        np.add.at(tally.residual.T, places, np.swapaxes(force[..., rows], 1, 2).reshape(len(places), -1))
        for others, columns in ends:
            tally.stiffness.spread(6 * bodies, 6 * others, own[..., rows, columns])


def advance(model: Nonlinear, pose: Pose, bent: tuple[FlexureState, ...], step: Array, share: Array) -> tuple[Pose, Array]:
    """Advance the pose by a fraction (b,) of a step (b, n), including the inner unknowns of flexures.

    The second result is the largest step (b,) of the inner unknowns.
    """
    cases = len(pose.position)
    moved = np.concatenate([step[:, : model.freedoms], np.zeros((cases, 6))], axis=1).reshape(cases, -1, 6)
    strain, wrench, largest = [], [], np.zeros(cases)
    for number, group in enumerate(model.flexures):
        inner = follow(group, bent[number], moved) * share[:, None]
        count = group.law.form.shape[-1]
        strain.append(relax_fields(group.law, pose.strain[number] + inner[..., :count]))
        wrench.append(pose.wrench[number] + inner[..., count:])
        largest = np.maximum(largest, np.max(np.abs(inner[..., :count]), axis=(0, 2)))
    moved = moved * share[:, None, None]
    turn = exponential(moved[..., 3:]) @ pose.turn
    held = pose.held + share[:, None] * step[:, model.freedoms :]
    return Pose(pose.position + moved[..., :3], turn, tuple(strain), tuple(wrench), held), largest


def end_displacement(model: Nonlinear, bent: tuple[FlexureState, ...], step: Array) -> Array:
    """Return the largest relative motion (b,) of flexure ends in a step (b, n): translations divided by flexure length, and rotations."""
    moved = np.concatenate([step[:, : model.freedoms], np.zeros((len(step), 6))], axis=1).reshape(len(step), -1, 6)
    largest = [np.zeros(len(step))]
    for group, each in zip(model.flexures, bent, strict=True):
        both = np.concatenate([np.moveaxis(moved[:, bodies], 1, 0) for bodies in (group.first, group.second)], axis=-1)[..., None]
        largest.append(np.max(np.abs(end_motion(group.law, each) @ both), axis=(0, 2, 3)))
    return np.max(np.stack(largest), axis=0)


def follow(group: Flexures, bent: FlexureState, moved: Array) -> Array:
    """Compute the step (l, b, q + 6) of the flexures' inner unknowns that results from body motions (b, n + 1, 6)."""
    both = np.concatenate([np.moveaxis(moved[:, each], 1, 0) for each in (group.first, group.second)], axis=-1)[..., None]
    step = bent.answer.moved[..., :6] @ (end_motion(group.law, bent) @ both)
    if bent.weight is not None:
        step = step + bent.answer.moved[..., 6:] @ (weight_motion(bent) @ both)
    return bent.answer.still + step[..., 0]


def flexure_weight(law: FlexureLaw, frame: Array, loads: Loads) -> Array | None:
    """Return the weight per length of flexures, divided by E I / L^3, in their start frames; `None` without gravity.

    E I is the bending stiffness, L the length of a flexure.
    """
    if not np.any(loads.gravity):
        return None
    density = law.line_mass * law.length**3 / law.rigidity
    return density[:, None, None] * matvec(frame.mT, loads.gravity)


def _gather(array: Array, bodies: Array) -> Array:
    """Gather (b, n, ...) of bodies (l,) to (l, b, ...)."""
    return np.moveaxis(array[:, bodies], 1, 0)
