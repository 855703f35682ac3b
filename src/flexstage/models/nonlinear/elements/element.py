"""Single flexure at large displacements: residual of the mixed functional, and its derivatives (docs/nonlinear.md, 1 to 8).

All quantities are in the flexure's start frame. Lengths are divided by the flexure's length, forces by E I / L^2. Tables of a law have
leading axes of flexures. States have one more axis for the b load cases: amplitudes (..., b, q), force and moment (..., b, 3).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexstage.base.number import Array, matvec
from flexstage.beams.flexure.law import FlexureLaw
from flexstage.beams.flexure.modes import Rule, gauss
from flexstage.spatial.frame import cross_matrix
from flexstage.spatial.rotation import cross, exponential, magnus


@dataclass(frozen=True, eq=False)
class Shape:
    """Configuration of a flexure: curvatures (..., b, n, 3) and fields (..., b, n, 2) at its n points, rotations at points and end.

    `place` (..., b, n, 3) is the position r, `rate` (..., b, n, 3) is its derivative r' along the length, `end` (..., b, 3) is r at the
    end. `soft` (..., b, n, 3, 3) is the compliance R C_n R^T of stretch and shear, with the rotation R of the section and the compliance
    C_n in its axes; `tension` (..., b, n) is the axial force N. The loads are the `force` at the end and the `weight`.
    """

    rule: Rule
    curvature: Array
    plate: Array
    turn: Array
    end_turn: Array
    rate: Array
    place: Array
    end: Array
    soft: Array
    tension: Array
    force: Array
    weight: Array | None


@dataclass(frozen=True, eq=False)
class Tangent:
    """Residual `gradient` (..., b, q) of the amplitudes, and the blocks of its derivative (docs/nonlinear.md, 6).

    Derivatives with respect to the amplitudes: `hessian` H (..., b, q, q) of the residual, `reach` B_f (..., b, 3, q) of the end position,
    and `turning` J_th (..., b, 3, q) of the end rotation. `soft` F_n (..., b, 3, 3) is the derivative of the end position with respect to
    the end force.

    Only with weight: `hung` (..., b, 3, q) is the derivative of the mean position with respect to the amplitudes, and `swayed` (..., b, 2,
    3, 3) the derivative of the mean position with respect to end force and weight.
    """

    gradient: Array
    hessian: Array
    reach: Array
    turning: Array
    soft: Array
    hung: Array | None = None
    swayed: Array | None = None


def shape(law: FlexureLaw, strain: Array, force: Array, weight: Array | None = None) -> Shape:
    """Compute the configuration at given amplitudes and end force; `weight` (..., b, 3) is as in `graph.flexure_weight`."""
    rule = gauss(law.modes.shape[-3])
    count = law.modes.shape[-1]
    curvature = _apply(law.modes, strain[..., :count])
    turn, end_turn = _turns(rule, _apply(law.inner, strain[..., :count]))
    local = _local(turn, _forces(rule, force, weight))
    compliance = law.compliance[..., None, :, :]
    stretched = compliance * local
    twist = curvature[..., 0]
    stretched[..., 0] += 1.0 - 0.5 * law.trapeze[..., None, None] * twist * twist
    rate = matvec(turn, stretched)
    soft = (turn * compliance[..., None, :]) @ turn.mT
    plate = _apply(law.plate, strain[..., count:])
    end = rule.weights @ rate
    return Shape(rule, curvature, plate, turn, end_turn, rate, rule.running @ rate, end, soft, local[..., 0], force, weight)


def tangent(law: FlexureLaw, strain: Array, moment: Array, config: Shape) -> Tangent:
    """Compute residual and derivatives at a configuration (docs/nonlinear.md, 4 to 8)."""
    rule, modes = config.rule, law.modes[..., None, :, :, :]
    weights = rule.weights[:, None, None]
    size, count = modes.shape[-3], modes.shape[-1]
    forces = _forces(rule, config.force, config.weight)
    moments = moment[..., None, :] + _lever(config, forces)
    rates = config.turn @ modes
    flat = rates.reshape(*rates.shape[:-3], size, 3 * count)
    turning = (rule.weights @ flat).reshape(*rates.shape[:-3], 3, count)
    turned = (rule.running @ flat).reshape(rates.shape)
    axis = config.turn[..., 0]
    twist = law.trapeze[..., None, None, None] * config.curvature[..., 0, None] * modes[..., 0, :]
    lever = cross_matrix(forces)
    carried = (config.soft @ lever - cross_matrix(config.rate)) @ turned - axis[..., None] * twist[..., None, :]
    reach = np.sum(weights * carried, axis=-3)
    bending = _local(config.turn, moments)
    bending[..., 0] -= law.trapeze[..., None, None] * config.tension * config.curvature[..., 0]
    geometric = _product(rates, weights * (cross_matrix(moments) @ turned)) - _product(turned, weights * (lever @ carried))
    pulled = np.sum((cross(axis, forces)[..., None] * turned), axis=-2)
    narrow = modes[..., 0, :]
    tension = law.trapeze[..., None, None, None] * config.tension[..., None] * narrow
    geometric -= _product(narrow[..., None, :], weights * tension[..., None, :]) + _product(
        twist[..., None, :], weights * pulled[..., None, :]
    )
    gradient, hessian = _elastic(law, strain, config)
    gradient[..., :count] -= _project(modes, rule.weights[:, None] * bending)
    hessian[..., :count, :count] -= geometric
    none = np.zeros((*reach.shape[:-1], hessian.shape[-1] - count))
    reach, turning = np.concatenate([reach, none], -1), np.concatenate([turning, none], -1)
    whole = Tangent(gradient, hessian, reach, turning, np.sum(weights * config.soft, axis=-3))
    if config.weight is None:
        return whole
    left = (1.0 - rule.points)[:, None, None]
    sways = [np.sum(weights * left**power * config.soft, axis=-3) for power in (1, 2)]
    hung = np.concatenate([np.sum(weights * left * carried, axis=-3), none], -1)
    return replace(whole, hung=hung, swayed=np.stack(sways, axis=-3))


def mode_paths(law: FlexureLaw, config: Shape) -> tuple[Array, Array, Array]:
    """Compute displacements (..., b, n, 3, k) and rotations of the points per unit curvature amplitude, at constant end force.

    The start is fixed. Also returns the displacements of the points per unit end force and per unit weight, (..., b, 2, n, 3, 3), as
    integrals of the compliance R C_n R^T (see `Shape`, and docs/nonlinear.md, 25).
    """
    rule, modes = config.rule, law.modes[..., None, :, :, :]
    forces = _forces(rule, config.force, config.weight)
    rates = config.turn @ modes
    turned = _running(rule, rates)
    twist = law.trapeze[..., None, None, None] * config.curvature[..., 0, None] * modes[..., 0, :]
    carried = (config.soft @ cross_matrix(forces) - cross_matrix(config.rate)) @ turned - config.turn[..., 0, None] * twist[..., None, :]
    left = (1.0 - rule.points)[:, None, None]
    soft = np.stack([_running(rule, config.soft), _running(rule, left * config.soft)], axis=-4)
    return _running(rule, carried), turned, soft


def _running(rule: Rule, values: Array) -> Array:
    """Integrals (..., n, r, k) from the start to each point."""
    flat = values.reshape(*values.shape[:-2], values.shape[-2] * values.shape[-1])
    return (rule.running @ flat).reshape(values.shape)


def field_system(law: FlexureLaw, strain: Array) -> tuple[Array, Array]:
    """Build the matrix (..., b, e, e) and right side (..., b, e) of the plate fields at given curvatures (docs/nonlinear.md, 13)."""
    weights, count = gauss(law.modes.shape[-3]).weights[:, None], law.modes.shape[-1]
    curvature = _apply(law.modes, strain[..., :count])
    twist, bend = curvature[..., :1], curvature[..., 2:]
    stretch = weights * law.stretch[..., None, None, :] * bend
    plate = law.plate[..., None, :, :, :]
    matrix = law.form[..., None, count:, count:] + _product(plate, (stretch * bend)[..., None] * plate)
    right = _project(plate, stretch * twist * twist * [1.0, 0.0]) + law.rest[..., None, count:]
    return matrix, right - strain[..., :count] @ law.form[..., :count, count:]


def energy(law: FlexureLaw, strain: Array, config: Shape) -> Array:
    """Compute the strain energy (..., b) relative to the straight state, including stretch and shear, divided by E I / L.

    E I is the bending stiffness, L the length of the flexure.
    """
    quadratic = np.sum(strain * (0.5 * strain @ law.form - law.rest[..., None, :]), axis=-1)
    gauss_two, gauss_four = _gaussian(config)
    stretch = law.stretch[..., None, None, :]
    density = stretch[..., 0] * gauss_two * gauss_two + stretch[..., 1] * gauss_four * gauss_four
    forces = _forces(config.rule, config.force, config.weight)
    density = density + np.sum(forces * matvec(config.soft, forces), axis=-1)
    return quadratic + 0.5 * density @ config.rule.weights


def _apply(table: Array, amplitudes: Array) -> Array:
    """Values (..., b, n, c) of a table (..., n, c, k) at amplitudes (..., b, k)."""
    rows = table.reshape(*table.shape[:-3], table.shape[-3] * table.shape[-2], table.shape[-1])
    return (amplitudes @ rows.mT).reshape(*amplitudes.shape[:-1], *table.shape[-3:-1])


def _turns(rule: Rule, inner: Array) -> tuple[Array, Array]:
    """Rotations (..., n, 3, 3) at the points and (..., 3, 3) at the end."""
    steps = np.diff(rule.knots)
    values = inner.reshape(*inner.shape[:-2], len(steps), 3, 3)
    turns = exponential(magnus(steps, values[..., 0, :], values[..., 1, :], values[..., 2, :]))
    for step in range(1, len(steps)):
        turns[..., step, :, :] = turns[..., step - 1, :, :] @ turns[..., step, :, :]
    return turns[..., :-1, :, :], turns[..., -1, :, :]


def _forces(rule: Rule, force: Array, weight: Array | None) -> Array:
    """The force (..., b, n, 3) of the flexure beyond each point: end force and weight (docs/nonlinear.md, 16)."""
    if weight is None:
        return np.broadcast_to(force[..., None, :], (*force.shape[:-1], rule.size, 3))
    return force[..., None, :] + (1.0 - rule.points)[:, None] * weight[..., None, :]


def _lever(config: Shape, forces: Array) -> Array:
    """Integral from each point to the end of r' x f (..., b, n, 3)."""
    if config.weight is None:
        return cross(config.end[..., None, :] - config.place, forces)
    return (config.rule.weights - config.rule.running) @ cross(config.rate, forces)


def _local(turn: Array, vectors: Array) -> Array:
    return matvec(turn.mT, vectors)


def _product(one: Array, other: Array) -> Array:
    """Sum over points of one^T other, (..., n, r, k) each."""
    shape = np.broadcast_shapes(one.shape[:-3], other.shape[:-3])
    left = one.reshape(*one.shape[:-3], -1, one.shape[-1])
    right = other.reshape(*other.shape[:-3], -1, other.shape[-1])
    return (left.mT @ right).reshape(*shape, left.shape[-1], right.shape[-1])


def _project(table: Array, values: Array) -> Array:
    """Sum over points of table^T values: (..., 1, n, c, k) and (..., b, n, c) give (..., b, k)."""
    rows = table.reshape(*table.shape[:-3], -1, table.shape[-1])[..., 0, :, :]
    return values.reshape(*values.shape[:-2], -1) @ rows


def _gaussian(config: Shape) -> tuple[Array, Array]:
    """Gaussian curvature (..., b, n) in the shapes of P2 and P4 (docs/nonlinear.md, 13), without signs."""
    twist, bend = config.curvature[..., 0], config.curvature[..., 2]
    two, four = _plate(config)
    return twist * twist - bend * two, bend * four


def _plate(config: Shape) -> tuple[Array, Array]:
    return config.plate[..., 0], config.plate[..., 1]


def _elastic(law: FlexureLaw, strain: Array, config: Shape) -> tuple[Array, Array]:
    """First and second derivatives of the strain energy without stretch by forces (docs/nonlinear.md, 13)."""
    gradient = strain @ law.form - law.rest[..., None, :]
    hessian = np.broadcast_to(law.form[..., None, :, :], (*gradient.shape, gradient.shape[-1])).copy()
    if not np.any(law.stretch):
        return gradient, hessian
    rows, first, second = _stretching(law, config)
    weights = config.rule.weights
    gradient = gradient + _project(rows, weights[:, None] * first)
    hessian = hessian + _product(rows, weights[:, None, None] * (second @ rows))
    return gradient, hessian


def _stretching(law: FlexureLaw, config: Shape) -> tuple[Array, Array, Array]:
    """Stretching rows (..., 1, n, 4, q) of k_x, k_z, a2 and a4, and derivatives (..., b, n, 4), (..., 4, 4) of its energy by them."""
    count, fields = law.modes.shape[-1], law.plate.shape[-1]
    rows = np.zeros((*law.modes.shape[:-2], 4, count + fields))
    rows[..., 0, :count], rows[..., 1, :count] = law.modes[..., 0, :], law.modes[..., 2, :]
    rows[..., 2:, count:] = law.plate
    twist, bend = config.curvature[..., 0], config.curvature[..., 2]
    two, four = _plate(config)
    stiff_two, stiff_four = law.stretch[..., None, None, 0], law.stretch[..., None, None, 1]
    curve = stiff_two * (twist * twist - bend * two)
    first = np.stack(
        [2.0 * curve * twist, -curve * two + stiff_four * bend * four * four, -curve * bend, stiff_four * bend * bend * four], -1
    )
    second = np.zeros((*twist.shape, 4, 4))
    slope = np.stack([2.0 * twist, -two, -bend, np.zeros_like(twist)], -1)
    second += stiff_two[..., None, None] * slope[..., :, None] * slope[..., None, :]
    second[..., 0, 0] += 2.0 * curve
    second[..., 1, 2] -= curve
    second[..., 2, 1] -= curve
    second[..., 1, 1] += stiff_four * four * four
    second[..., 1, 3] += 2.0 * stiff_four * bend * four
    second[..., 3, 1] += 2.0 * stiff_four * bend * four
    second[..., 3, 3] += stiff_four * bend * bend
    return rows[..., None, :, :, :], first, second
