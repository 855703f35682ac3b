"""Consistent mass of parts by the static shape functions of their beams."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from flexstage.base.number import Array
from flexstage.base.storage.digest import keep
from flexstage.beams.beam import Beam
from flexstage.beams.compliance import Law, beam_of, fixed_end_modes, law, law_of
from flexstage.beams.fixed_end_modes import FixedEndModes, join
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.material import Material
from flexstage.parts.part import Part, Restricted, inner


@keep
def mass(part: Part, material: Material | None) -> Array:
    """Compute the mass matrix (..., 12, 12) of a part for the twists of its first and second end, at its centre, in the link frame [SI].

    The twist of the section at x is v(x) = X_x (q_a + Gamma(x) (q_b - q_a)), with the twists q_a, q_b of the ends and Gamma(x) = S(x) K.
    X_x transports a twist from the centre to x. S is the compliance accumulated from the first end to x, and K = S(end)^-1. The mass matrix
    is M = integral of N^T diag(rho A, rho A, rho A, rho I_p, rho I_y, rho I_z) N dx with N = X_x [1 - Gamma, Gamma]. The matrix includes
    the material between the ends of the profile. For rigid motions, the mass matrix is the exact inertia of the solid. A `ComplianceMatrix`
    part has half its mass at each end; `Joint` and `Restricted` parts are massless.

    For a part with m fixed-end modes, the matrix is (..., 12 + m, 12 + m). The matrix contains the unit masses of the modes, and the
    coupling of the modes to the motion of the ends.

    >>> steel = Material(young=200e9, poisson=0.3, density=8000.0)
    >>> from flexstage.parts.leaf import Leaf
    >>> matrix = mass(Leaf("steel", length=0.1, thickness=0.001, width=0.01), steel)
    >>> round(float(matrix[0, 0] + 2.0 * matrix[0, 6] + matrix[6, 6]), 12)
    0.008
    """
    if isinstance(part, (Joint, Restricted)):
        return np.zeros((12, 12))
    part_law = law_of(part)
    if part_law is not None and part_law.mass is not None:
        return part_law.mass(part)
    beam = beam_of(part, material)
    return _with_modes(beam, consistent_mass(beam), fixed_end_modes(part, material))


@keep
def law_and_mass(part: Part, material: Material | None) -> tuple[Law, Array]:
    """Compute the law and the mass matrix of a part (see `law` and `mass`) with a single integration of its beam.

    >>> steel = Material(young=200e9, poisson=0.3, density=8000.0)
    >>> from flexstage.parts.rod import Rod
    >>> rod = Rod("steel", length=0.1, diameter=0.002)
    >>> bool(np.all(law_and_mass(rod, steel)[0].stiffness == law(rod, steel).stiffness))
    True
    """
    entry, modes = law_of(part), getattr(inner(part), "inner_modes", 0)
    if entry is None or entry.beam is None or entry.diagonal is not None or isinstance(part, Restricted) or modes:
        return law(part, material), mass(part, material)
    beam = beam_of(part, material)
    return Law((1.0 / beam.diagonal())[..., None] * np.eye(6)), consistent_mass(beam)


def consistent_mass(beam: Beam) -> Array:
    """Compute the consistent mass (..., 12, 12) of a beam; see `mass`.

    The motions along the axis, about the axis, and in two planes are decoupled. If the beam is symmetric about its centre, the mean of the
    end motions is decoupled from their difference. Only the nonzero entries are integrated, over half the beam.

    >>> from flexstage.beams.piezo import piezo_beam
    >>> from flexstage.parts.piezo import Piezo
    >>> bar = piezo_beam(Piezo(stroke=1e-4, stiffness=1e7, length=0.1, diameter=0.01, mass=6.0))
    >>> consistent_mass(bar)[[0, 0, 6], [0, 6, 6]].round(9).tolist()
    [2.0, 1.0, 2.0]
    """
    weight = _weights(beam)
    entries: dict[tuple[int, int], Array] = {}
    for motions in _motions(beam):
        for one, other in itertools.combinations_with_replacement(motions, 2):
            shared = (_sum(weight[..., row], moved, motions[other][row]) for row, moved in motions[one].items() if row in motions[other])
            entries[one, other] = entries[other, one] = functools.reduce(np.add, shared)
    batch = np.broadcast_shapes(*(entry.shape for entry in entries.values()))
    result = np.zeros((*batch, 12, 12), dtype=np.result_type(*entries.values()))
    for (one, other), entry in entries.items():
        for (row, factor), (column, times) in itertools.product(_END_SHARES[one], _END_SHARES[other]):
            result[..., row, column] += factor * times * entry
    return result


_END_SHARES = tuple(((place, 0.5), (place + 6, 0.5)) if place < 6 else ((place - 6, -1.0), (place, 1.0)) for place in range(12))
"""Coefficients of the mean (0 to 5) and the difference (6 to 11) of the end motions in the first and the second one."""


def _sum(*numbers: Array) -> Array:
    """Sum over the stations (..., s) of a product; factors without stations are 1."""
    factors = [each for each in numbers if each.ndim]
    return np.einsum(",".join(["...s"] * len(factors)) + "->...", *factors)


def _of_ends(rows: Array) -> Array:
    """Transform rows (..., 12, n) by mean and difference of the end motions to rows by the end motions."""
    mean, apart = 0.5 * rows[..., :6, :], rows[..., 6:, :]
    return np.concatenate([mean - apart, mean + apart], axis=-2)


def _weights(beam: Beam) -> Array:
    """Inertia (..., s, 6) at the stations -x and x."""
    return (2.0 * beam.points.rule.weights * beam.points.rate)[..., None] * beam.inertia


def _with_modes(beam: Beam, ends: Array, modes: tuple[FixedEndModes, ...]) -> Array:
    """Mass (..., 12 + m, 12 + m) of the ends and of the fixed-end modes, of unit mass each."""
    if not modes:
        return ends
    between = join(_shared(beam, mode) for mode in modes)
    size = 12 + between.shape[-1]
    batch = np.broadcast_shapes(ends.shape[:-2], between.shape[:-2])
    result = np.zeros((*batch, size, size), dtype=np.result_type(ends, between))
    result[..., :12, :12], result[..., :12, 12:], result[..., 12:, :12] = ends, between, between.mT
    result[..., range(12, size), range(12, size)] = 1.0
    return result


def _shared(beam: Beam, fixed_end: FixedEndModes) -> Array:
    """Coupling mass (..., 12, n) of modes and end motions: integral of N^T w phi dx, phi (v, dv/dx), N the end motions."""
    turning, sign = {1: (5, 1.0), 2: (4, -1.0), 3: (3, 1.0)}[fixed_end.axis]  # a slope of w along z turns about -y
    modes = {fixed_end.axis: fixed_end.moved} | ({} if fixed_end.turned is None else {turning: sign * fixed_end.turned})
    half, weight = fixed_end.moved.shape[-1] // 2, 0.5 * _weights(beam)
    result = np.zeros((12, fixed_end.moved.shape[-2]))
    for motions in _motions(beam):
        for place, rows in motions.items():
            for row in rows.keys() & modes.keys():
                even = 1.0 if (place < 6) == (place % 6 == row) else -1.0
                mode = modes[row][..., half:] + even * modes[row][..., :half]
                own = np.sum((weight[..., row] * rows[row])[..., None, :] * mode, axis=-1)
                result = result + (np.arange(12) == place)[:, None] * own[..., None, :]
    return _of_ends(result)


_Motions: TypeAlias = dict[int, dict[int, Array]]
"""Section motions at x (along x, y, z; about x, y, z) by the means (0 to 5) and differences (6 to 11) of the end motions.

At -x a mean moves a section along or about itself as at x, else with opposite sign; a difference does the opposite.
"""


def _motions(beam: Beam) -> Iterator[_Motions]:
    """Decoupled motions: the rows of X, and of X (Gamma - 1/2)."""
    x, f, one = beam.points.position, beam.flexibility, np.ones(())
    planes = [each for across, turn in ((1, 5), (2, 4)) for each in (f[..., across] + x * x * f[..., turn], f[..., turn], x * f[..., turn])]
    pulled, twisted, *bent = beam.points.runnings(f[..., 0], f[..., 3], *planes)
    for axis, grown in ((0, pulled), (3, twisted)):
        yield {axis: {axis: one}}
        yield {6 + axis: {axis: grown * _per_whole(grown)}}
    for across, turn, sign, (moved, turned, odd) in ((1, 5, 1.0, bent[:3]), (2, 4, -1.0, bent[3:])):
        left = odd[..., -1:] - odd
        by_turning, by_moving = _per_whole(turned), _per_whole(moved)
        yield {across: {across: one}, 6 + turn: {across: (left + x * turned) * (sign * by_turning), turn: turned * by_turning}}
        yield {
            turn: {across: sign * x, turn: one},
            6 + across: {across: (moved + x * left) * by_moving, turn: left * (sign * by_moving)},
        }


def _per_whole(grown: Array) -> Array:
    """Reciprocal whole (..., 1) of an even flexibility accumulated up to the stations x."""
    return 0.5 / grown[..., -1:]
