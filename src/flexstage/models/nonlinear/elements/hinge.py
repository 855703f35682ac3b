"""Links with a 6x6 stiffness about a centre, at large displacements: springs, stacks, specified matrices, joints (docs/nonlinear.md, 15).

Both bodies are rigidly extended to frames a and b at the centre. The deformation is psi = log(R_a^T R_b) and d = R_m^T (x_b - x_a) in the
half-way frame R_m = R_a exp(psi / 2). The half-way frame does not depend on the order of the ends. A strut (a spring with a length L) turns
about both ends: d_x = |x_b - x_a + (R_a + R_b) e_1 L / 2| - L. Here e_1 is the x axis of the link frame. The force of a strut acts along
the line between its ends.

A part with a length also shortens by its own bending: 1/2 e^T G e is added to e = (d, psi) (`beams.geometric.foreshortening`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, matvec
from flexstage.spatial.frame import cross_matrix
from flexstage.spatial.rotation import cross, exponential, exponential_rate, logarithm, logarithm_rate

_STEP = 1e-30


@dataclass(frozen=True, eq=False)
class Hinges:
    """l links with a 6x6 stiffness about a centre: body numbers, nominal link axes `turn` (l, 3, 3), arms (l, 3) from reference points.

    - `stiffness` (l, 6, 6).
    - `stroke` (l, 6, m): free deformation per unit of each input; `thrust` (l, 6, m): wrench on the second body per unit of each input.
    - `push` (l, 6): nominal wrench on the second body.
    - `strut` (l,): length [m] of a strut, which turns about both ends; zero for another link, whose stiffness is about its centre.
    - `bow` (l, 6, 6, 6): a matrix G for each of the six deformations d; foreshortening adds d^T G d / 2 to the deformation.
    - `locked` (c, 2): link number and DOF number of each DOF without deformation.

    If the cases belong to different designs, all arrays except `first`, `second` and `locked` have an axis of cases, (l, b, ...).
    """

    names: tuple[str, ...]
    first: Array
    second: Array
    turn: Array
    arm_first: Array
    arm_second: Array
    stiffness: Array
    stroke: Array
    thrust: Array
    push: Array
    strut: Array
    bow: Array
    locked: Array


@dataclass(frozen=True, eq=False)
class Ends:
    """Poses of the two bodies of links: positions (..., 3) and rotations (..., 3, 3)."""

    first: Array
    first_turn: Array
    second: Array
    second_turn: Array


def deform(hinges: Hinges, ends: Ends) -> tuple[Array, Array]:
    """Compute deformations (..., l, b, 6), and derivatives (..., l, b, 6, 12) with respect to the motions of both bodies."""
    turn = _by_case(hinges.turn, 2)
    frame, other = ends.first_turn @ turn, ends.second_turn @ turn
    arm = matvec(ends.first_turn, _by_case(hinges.arm_first, 1))
    other_arm = matvec(ends.second_turn, _by_case(hinges.arm_second, 1))
    gap = ends.second + other_arm - ends.first - arm
    angle = logarithm(frame.mT @ other)
    back = (frame @ exponential(0.5 * angle)).mT
    turning = logarithm_rate(angle) @ frame.mT
    half = 0.5 * frame @ exponential_rate(0.5 * angle) @ turning
    lever = cross_matrix(gap)
    eye = np.broadcast_to(np.eye(3), back.shape)
    # d = R_m^T gap: its change is R_m^T (d gap + gap x w_m), w_m = th_i + half (th_j - th_i)
    moved = back @ np.concatenate([-eye, cross_matrix(arm) + lever @ (eye - half), eye, lever @ half - cross_matrix(other_arm)], axis=-1)
    none = np.zeros_like(turning)
    turned = np.concatenate([none, -turning, none, turning], axis=-1)
    strain = np.concatenate([matvec(back, gap), angle], axis=-1)
    rows = np.concatenate([moved, turned], axis=-2)
    struts = np.flatnonzero(np.any(_by_case(hinges.strut, 0), axis=1))
    if len(struts):
        length, axis, other_axis = (_of(each, struts) for each in (_by_case(hinges.strut, 0)[..., None], frame[..., 0], other[..., 0]))
        line = _of(gap, struts) + 0.5 * length * (axis + other_axis)
        span = np.sqrt(np.sum(line * line, axis=-1, keepdims=True))
        along = line / span
        one, two = _of(arm, struts) - 0.5 * length * axis, _of(other_arm, struts) + 0.5 * length * other_axis
        strain[..., struts, :, :1] = span - length
        rows[..., struts, :, :1, :] = np.concatenate([-along, cross(along, one), along, cross(two, along)], axis=-1)[..., None, :]
    bow = _by_case(hinges.bow, 3)
    bowed = np.flatnonzero(np.any(bow, axis=(1, 2, 3, 4)))
    if len(bowed):
        own = _of(strain, bowed)
        slope = (bow[bowed] @ own[..., None, :, None])[..., 0]
        strain[..., bowed, :, :] = own + 0.5 * matvec(slope, own)
        rows[..., bowed, :, :, :] += slope @ rows[..., bowed, :, :, :]
    return strain, rows


def _of(values: Array, links: Array) -> Array:
    """Vectors (..., l, b, c) of some links."""
    return values[..., links, :, :]


def exerted(hinges: Hinges, deformation: Array, inputs: Array, pushing: Array, held: Array) -> Array:
    """Compute link wrenches (..., l, b, 6): elastic, minus those of inputs (b, m) and preloads, plus reactions `held` of locked DOFs."""
    own = _by_input(hinges.thrust, inputs) + pushing[:, None] * _by_case(hinges.push, 1)
    return matvec(_by_case(hinges.stiffness, 2), deformation - imposed(hinges, inputs)) - own + held


def imposed(hinges: Hinges, inputs: Array) -> Array:
    """Compute the free deformation (l, b, 6) that inputs (b, m) impose."""
    return _by_input(hinges.stroke, inputs)


def _by_input(table: Array, inputs: Array) -> Array:
    return matvec(_by_case(table, 2), inputs)


def _by_case(table: Array, axes: int) -> Array:
    """Reshape a table of links (l, ...), with entries of so many axes, to links and cases (l, 1 or b, ...)."""
    return table if table.ndim == axes + 2 else table[:, None]


def stiffen(hinges: Hinges, ends: Ends, inputs: Array, pushing: Array, held: Array) -> tuple[Array, Array, Array, Array]:
    """Compute the residual (l, b, 12) on both bodies, its derivative (l, b, 12, 12), deformations and their derivatives."""
    deformation, rows = deform(hinges, ends)
    residual = _work(rows, exerted(hinges, deformation, inputs, pushing, held))
    stepped, stepped_rows = deform(hinges, _nudge(ends))
    work = _work(stepped_rows, exerted(hinges, stepped, inputs, pushing, held))
    return residual, np.moveaxis(np.imag(work), 0, -1) / _STEP, deformation, rows


def _work(rows: Array, wrench: Array) -> Array:
    return matvec(rows.mT, wrench)


def _nudge(ends: Ends) -> Ends:
    """The ends after a complex step in each of their twelve motions, on a new first axis."""
    step = 1j * _STEP * np.eye(12)[:, None, None, :]
    return Ends(
        ends.first + step[..., :3],
        exponential(step[..., 3:6]) @ ends.first_turn,
        ends.second + step[..., 6:9],
        exponential(step[..., 9:]) @ ends.second_turn,
    )
