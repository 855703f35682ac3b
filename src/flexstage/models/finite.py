"""Finite motion of the ideal model: inverse kinematics (pose to strokes) and forward kinematics (strokes to pose) on SE(3).

The unknowns are the poses of all bodies. The locked components of the relative pose of every link are zero. For an actuator, the locked
components equal its free deformation times its stroke. Force actuators do not constrain motion. Any topology is supported, including closed
loops. Free internal modes are determined by steps of least norm. Redundant constraints are satisfied by least squares.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.arguments import CheckedFields, check_arguments
from flexstage.base.finding import refuse
from flexstage.base.number import Array, Number
from flexstage.mechanism.assembly.expand import Assembly, PlacedLink, expand
from flexstage.mechanism.assembly.incidence import free_deformations, layout
from flexstage.mechanism.mechanism import GROUND, Mechanism
from flexstage.models.linear.kinematics import Kinematics
from flexstage.parts.freedom import ALL
from flexstage.parts.part import inner
from flexstage.parts.shape import Shaped
from flexstage.spatial.frame import COMPONENTS, cross_matrix
from flexstage.spatial.rotation import exponential, logarithm, logarithm_rate

_STEPS = 60
_SETTLED = 1e-14
_STALLED = 1e-9
_CONSISTENT = 1e-10
_SLOW = 0.1
_AWAY = 1e3
_RANK = 1e-9


@dataclass(frozen=True, eq=False)
class FinitePose(CheckedFields):
    """Pose after finite motion: `displacement` (..., 3) [m] of the reference point, `rotation_vector` (..., 3) [rad], in stage axes.

    Displacement and rotation vector are relative to the nominal position. For small motions, these vectors are the components of a twist.
    """

    displacement: Array
    rotation_vector: Array

    @property
    def vector(self) -> Array:
        """Six components (x, y, z, rx, ry, rz), comparable with a small twist."""
        return np.concatenate(np.broadcast_arrays(self.displacement, self.rotation_vector), axis=-1)


@dataclass(frozen=True, eq=False)
class FiniteMotion:
    """Solution of finite kinematics.

    - `strokes` (..., n) [m] in the order of `actuators`;
    - `pose` of the platform at its reference point;
    - `bodies`: poses of all bodies at their reference points. The pose of a body with a free internal mode has the smallest possible
      rotation, and does not determine the reading of a gauge on this body (see `Kinematics.sensing`).
    - `residual` (...): largest constraint error [m]; errors in rotation are multiplied by `length`;
    - `iterations`: number of steps.
    """

    actuators: tuple[str, ...]
    strokes: Array
    pose: FinitePose
    bodies: Mapping[str, FinitePose]
    residual: Array
    iterations: int
    length: Number
    provenance: str

    @property
    def consistent(self) -> Array:
        """Whether redundant constraints permit this finite motion; if not, the motion strains the links by about `residual`."""
        return self.residual <= _CONSISTENT * self.length


@dataclass(frozen=True, eq=False)
class _Links:
    """All links as arrays: body indices (the ground last), arms from the body references to the joint, frames, locked components."""

    bodies: tuple[str, ...]
    first: list[int]
    second: list[int]
    first_arm: Array
    second_arm: Array
    axes: Array
    locked: list[int]
    drives: Array
    beams: list[int]
    spans: Array
    both_ways: Array
    posed: tuple[int, ...]
    length: Array

    @property
    def shape(self) -> tuple[int, ...]:
        own = (self.first_arm.shape[:-2], self.second_arm.shape[:-2], self.axes.shape[:-3], self.spans.shape[:-1])
        return np.broadcast_shapes(*own, self.drives.shape[:-2], self.length.shape)

    @property
    def row_weights(self) -> Array:
        """Weights (..., m) that scale the errors to lengths."""
        own = _weights(self.length)
        return np.concatenate([np.tile(own, len(self.first))[..., self.locked], own[..., list(self.posed)]], axis=-1)


@dataclass(frozen=True, eq=False)
class _State:
    """Displacements (..., N + 1, 3) and rotations (..., N + 1, 3, 3) of the bodies, the ground last; strokes; target pose components."""

    shift: Array
    turn: Array
    strokes: Array
    wanted: Array


@dataclass(frozen=True, eq=False)
class _Relative:
    """Relative pose of every link: offset in stage axes, joint axes of the first body, translation and rotation in those axes."""

    offset: Array
    axes: Array
    translation: Array
    rotation: Array
    vector: Array


@check_arguments
def forward_kinematics(mechanism: Mechanism, kinematics: Kinematics, strokes: Array) -> FiniteMotion:
    """Compute the platform pose for strokes (..., n) [m] in the order of `kinematics.actuators`, from the nominal position.

    The poses of all bodies are computed by Newton's method. Leaves and rods of length L with end deflection w and slope t shorten by 0.6
    w^2/L - 0.1 w t + L t^2/15, as in the beam constraint model (Awtar, Slocum & Sevincer 2007). All other links are modelled with fixed
    pivots.

    Raises `DesignError` if the strokes do not determine the platform's motion or the iteration does not converge.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> lifted = forward_kinematics(stage, ideal(stage), np.array([0, 0, 0, 50e-6, 50e-6, 50e-6]))
    >>> round(1e6 * float(lifted.pose.displacement[2]), 1)
    150.0
    """
    strokes = np.asarray(strokes)
    return _solve(mechanism, kinematics, strokes, None)


@check_arguments
def inverse_kinematics(mechanism: Mechanism, kinematics: Kinematics, pose: FinitePose) -> FiniteMotion:
    """Compute the strokes for which the platform has the components of `pose` that `kinematics.coordinates` names.

    The method, the model of the links and the possible errors are those of `forward_kinematics`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> lifted = FinitePose(np.array([0.0, 0.0, 150e-6]), np.zeros(3))
    >>> (1e6 * inverse_kinematics(stage, ideal(stage), lifted).strokes[3:]).round(1).tolist()
    [50.0, 50.0, 50.0]
    """
    target = pose.vector[..., [COMPONENTS.index(name) for name in kinematics.coordinates]]
    strokes = np.zeros((*target.shape[:-1], len(kinematics.actuators)))
    return _solve(mechanism, kinematics, strokes, target)


def design_shape(mechanism: Mechanism, kinematics: Kinematics) -> tuple[int, ...]:
    """Return the batch shape of the designs; the leading axes of strokes and poses must be broadcastable to this shape.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> design_shape(double_triangle(), ideal(double_triangle()))
    ()
    """
    return _links(mechanism, kinematics, posed=False).shape


def _solve(mechanism: Mechanism, kinematics: Kinematics, strokes: Array, target: Array | None) -> FiniteMotion:
    _ = kinematics.mapping  # raises for under-actuated stages
    links = _links(mechanism, kinematics, posed=target is not None)
    state, iterations = _newton(links, _state_at(links, strokes, target))
    names = (*links.bodies, GROUND)
    poses = {name: FinitePose(state.shift[..., index, :], logarithm(state.turn[..., index, :, :])) for index, name in enumerate(names)}
    return FiniteMotion(
        actuators=kinematics.actuators,
        strokes=state.strokes,
        pose=poses[links.bodies[0]],
        bodies={name: poses[name] for name in links.bodies},
        residual=np.max(np.abs(_residual(links, state, _relative(links, state))), axis=-1),
        iterations=iterations,
        length=links.length,
        provenance=f"finite motion of the {kinematics.provenance}",
    )


def _newton(links: _Links, state: _State) -> tuple[_State, int]:
    """Newton steps; the pseudo-inverse at the nominal position is used while convergence is fast."""
    relative = _relative(links, state)
    slope = _first_slope(links, state)
    before = size = np.inf
    for iteration in range(1, _STEPS + 1):
        step = -_times(slope, _residual(links, state, relative))
        state = _move(links, state, step)
        relative = _relative(links, state)
        size = float(np.max(np.abs(step) * _step_weights(links, state) / links.length[..., None], initial=0.0))
        if size < _SETTLED or 0.5 * before < size < _STALLED:
            return state, iteration
        if not np.isfinite(size) or size > _AWAY:
            break
        if size > _SLOW * before:
            slope = _pseudo_inverse(links, state, relative)
        before = size
    raise refuse(
        "finite motion",
        f"no convergence: the last step was {size:.3g} times the stage's size of {np.max(links.length):.3g} m",
        "The links cannot be connected in this pose; use smaller strokes or poses",
    )


def _links(mechanism: Mechanism, kinematics: Kinematics, *, posed: bool) -> _Links:
    assembly = expand(mechanism).welded
    bodies = layout(assembly).bodies
    index = {name: number for number, name in enumerate((*bodies, GROUND))}
    placed_links = tuple(assembly.links.values())
    parts = [inner(link.part) for link in placed_links]
    beams = [number for number, part in enumerate(parts) if isinstance(part, Shaped) and part.slender]
    slender = [part for part in parts if isinstance(part, Shaped) and part.slender]
    return _Links(
        bodies=bodies,
        first=[index[link.joins[0]] for link in placed_links],
        second=[index[link.joins[1]] for link in placed_links],
        first_arm=_together([_arm(assembly, link, link.joins[0]) for link in placed_links], 1),
        second_arm=_together([_arm(assembly, link, link.joins[1]) for link in placed_links], 1),
        axes=_together([link.frame.rotation for link in placed_links], 2),
        locked=_locked_rows(placed_links, kinematics),
        drives=free_deformations(assembly),
        beams=beams,
        spans=_together([np.asarray(part.span) for part in slender], 0),
        both_ways=np.array([part.bends_both_ways for part in slender], dtype=float),
        posed=tuple(COMPONENTS.index(name) for name in kinematics.coordinates) if posed else (),
        length=np.asarray(np.real(kinematics.length)),
    )


def _locked_rows(placed_links: tuple[PlacedLink, ...], kinematics: Kinematics) -> list[int]:
    return [
        6 * number + freedom.index
        for number, link in enumerate(placed_links)
        for freedom in ALL
        if freedom not in kinematics.free[link.name]
    ]


def _arm(assembly: Assembly, link: PlacedLink, body: str) -> Array:
    return link.frame.position - (np.zeros(3) if body == GROUND else assembly.bodies[body].reference)


def _together(arrays: list[Array], depth: int) -> Array:
    """Stack arrays of single links along a link axis before their last `depth` axes."""
    if not arrays:
        return np.zeros(0)
    batch = np.broadcast_shapes(*(array.shape[: array.ndim - depth] for array in arrays))
    return np.stack([np.broadcast_to(array, batch + array.shape[array.ndim - depth :]) for array in arrays], axis=-1 - depth)


def _state_at(links: _Links, strokes: Array, target: Array | None) -> _State:
    lead = np.broadcast_shapes(strokes.shape[:-1], links.shape)
    kind = np.result_type(strokes, float if target is None else target, links.first_arm, links.axes)
    count = len(links.bodies) + 1
    return _State(
        shift=np.zeros((*lead, count, 3), dtype=kind),
        turn=np.broadcast_to(np.eye(3, dtype=kind), (*lead, count, 3, 3)),
        strokes=np.broadcast_to(strokes.astype(kind), (*lead, strokes.shape[-1])),
        wanted=np.zeros((*lead, 0)) if target is None else np.broadcast_to(target, (*lead, target.shape[-1])),
    )


def _relative(links: _Links, state: _State) -> _Relative:
    first, second = state.turn[..., links.first, :, :], state.turn[..., links.second, :, :]
    carried = ((second - np.eye(3)) @ links.second_arm[..., None] - (first - np.eye(3)) @ links.first_arm[..., None])[..., 0]
    offset = state.shift[..., links.second, :] - state.shift[..., links.first, :] + carried
    axes = first @ links.axes
    back = axes.mT
    rotation = back @ (second @ links.axes)
    return _Relative(offset, axes, (back @ offset[..., None])[..., 0], rotation, logarithm(rotation))


def _residual(links: _Links, state: _State, relative: _Relative) -> Array:
    """Weighted constraint errors (..., m): locked components less strokes and shortening, then pose components less their targets."""
    values = np.concatenate([relative.translation, relative.vector], axis=-1)
    flat = values.reshape(*values.shape[:-2], -1)
    flat = flat - (links.drives @ state.strokes[..., None])[..., 0]
    if links.beams:
        flat[..., [6 * number for number in links.beams]] += _shortening(links, relative)
    errors = flat[..., links.locked]
    if links.posed:
        pose = np.concatenate([state.shift[..., 0, :], logarithm(state.turn[..., 0, :, :])], axis=-1)
        errors = np.concatenate([errors, pose[..., list(links.posed)] - state.wanted], axis=-1)
    return errors * links.row_weights


def _shortening(links: _Links, relative: _Relative) -> Array:
    """Shortening of leaves and rods due to their deflection, at their centres."""
    half = 0.5 * links.spans
    turn, vector = relative.rotation[..., links.beams, :, :], relative.vector[..., links.beams, :]
    end = relative.translation[..., links.beams, :] + half[..., None] * turn[..., :, 0]
    bent = _bend(end[..., 1], vector[..., 2], links.spans) + links.both_ways * _bend(end[..., 2], -vector[..., 1], links.spans)
    return bent + half * (turn[..., 0, 0] - 1.0)


def _bend(deflection: Array, slope: Array, span: Array) -> Array:
    return 0.6 * deflection**2 / span - 0.1 * deflection * slope + span * slope**2 / 15.0


def _first_slope(links: _Links, state: _State) -> Array:
    """The pseudo-inverse at the nominal position, one for all points."""
    drawn = _state_at(links, np.zeros(state.strokes.shape[-1]), np.zeros(state.wanted.shape[-1]))
    return _pseudo_inverse(links, drawn, _relative(links, drawn))


def _times(matrix: Array, vectors: Array) -> Array:
    """Matrix times vectors (..., m), as one product for a single matrix."""
    return vectors @ matrix.T if matrix.ndim == 2 else (matrix @ vectors[..., None])[..., 0]


def _pseudo_inverse(links: _Links, state: _State, relative: _Relative) -> Array:
    """Least-norm, least-squares inverse of the weighted constraint slopes, rotations weighted with the length scale."""
    slopes = np.real(_slopes(links, state, relative))
    scale = 1.0 / _step_weights(links, state)
    return scale[..., None] * np.linalg.pinv(links.row_weights[..., None] * slopes * scale[..., None, :], rcond=_RANK)


def _slopes(links: _Links, state: _State, relative: _Relative) -> Array:
    """Jacobian (..., m, 6 N [+ n]) of the errors by the body twists at their references and, for a pose, the strokes."""
    count, bodies = len(links.first), len(links.bodies)
    lead = relative.offset.shape[:-2]
    blocks = np.zeros((*lead, count, 6, bodies + 1, 6), dtype=relative.offset.dtype)
    first, second = _end_slopes(links, state, relative)
    blocks[..., range(count), :, links.first, :] += np.moveaxis(first, -3, 0)
    blocks[..., range(count), :, links.second, :] += np.moveaxis(second, -3, 0)
    slopes = blocks[..., :bodies, :].reshape(*lead, 6 * count, 6 * bodies)[..., links.locked, :]
    if not links.posed:
        return slopes
    driven = np.broadcast_to(-links.drives[..., links.locked, :], (*lead, len(links.locked), links.drives.shape[-1]))
    pose = np.zeros((*lead, 6, 6 * bodies + links.drives.shape[-1]), dtype=slopes.dtype)
    pose[..., :3, :3] = np.eye(3)
    pose[..., 3:, 3:6] = logarithm_rate(logarithm(state.turn[..., 0, :, :]))
    return np.concatenate([np.concatenate([slopes, driven], axis=-1), pose[..., list(links.posed), :]], axis=-2)


def _end_slopes(links: _Links, state: _State, relative: _Relative) -> tuple[Array, Array]:
    """Derivatives (..., L, 6, 6) of the relative poses by the twist of the first and of the second body."""
    back = relative.axes.mT
    arms = [
        cross_matrix((state.turn[..., ends, :, :] @ arm[..., None])[..., 0])
        for ends, arm in ((links.first, links.first_arm), (links.second, links.second_arm))
    ]
    rate = logarithm_rate(relative.vector) @ back
    first = _block(-back, back @ (arms[0] + cross_matrix(relative.offset)), -rate)
    return first, _block(back, -back @ arms[1], rate)


def _block(shift: Array, lever: Array, turn: Array) -> Array:
    lead = np.broadcast_shapes(shift.shape[:-2], lever.shape[:-2], turn.shape[:-2])
    result = np.zeros((*lead, 6, 6), dtype=np.result_type(shift, lever, turn))
    result[..., :3, :3], result[..., :3, 3:], result[..., 3:, 3:] = shift, lever, turn
    return result


def _move(links: _Links, state: _State, step: Array) -> _State:
    bodies = len(links.bodies)
    twist = step[..., : 6 * bodies].reshape(*step.shape[:-1], bodies, 6)
    shift, turn = state.shift.copy(), state.turn.copy()
    shift[..., :bodies, :] += twist[..., :3]
    turn[..., :bodies, :, :] = exponential(twist[..., 3:]) @ turn[..., :bodies, :, :]
    strokes = state.strokes + step[..., 6 * bodies :] if links.posed else state.strokes
    return replace(state, shift=shift, turn=turn, strokes=strokes)


def _weights(length: Array) -> Array:
    """Weights (..., 6): 1 for translations, the length for rotations."""
    return np.where(np.arange(6) < 3, 1.0, length[..., None])


def _step_weights(links: _Links, state: _State) -> Array:
    """Weights (..., k) that scale the unknowns to lengths."""
    twists = np.tile(_weights(links.length), len(links.bodies))
    strokes = np.ones((*twists.shape[:-1], state.strokes.shape[-1] if links.posed else 0))
    return np.concatenate([twists, strokes], axis=-1)
