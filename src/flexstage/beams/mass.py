"""Consistent mass of parts by the static shape functions of their own beams."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import numpy as np

from flexstage.base.digest import keep
from flexstage.base.number import Array
from flexstage.beams.beam import Beam
from flexstage.beams.compliance import Law, beam_of, held_modes, law, law_of
from flexstage.beams.held import Held, join
from flexstage.parts.given import Joint
from flexstage.parts.material import Material
from flexstage.parts.part import Elastic, Part, Restricted, inner


@keep
def mass(part: Part, material: Material | None) -> Array:
    """Mass (..., 12, 12) of a part for the twists of its first and its second end, both taken at its centre, in the link frame [SI].

    The section at x moves by v(x) = X_x (q_a + Gamma(x) (q_b - q_a)), Gamma(x) = S(x) K: S the compliance accumulated from the first end to
    x, K = S(end)^-1. M = integral of N^T diag(rho A, rho A, rho A, rho I_p, rho I_y, rho I_z) N dx with N = [X (1 - Gamma), X Gamma].
    It holds the material between the arc ends and gives a rigid motion the inertia of the solid exactly. A `Given`
    part has half its mass at each end; `Joint` and `Restricted` parts have none. A part with m modes of its own has (..., 12 + m, 12 + m):
    their unit masses, and what they share with the motion of its ends.

    >>> steel = Material(young=200e9, poisson=0.3, density=8000.0)
    >>> from flexstage.parts.leaf import Leaf
    >>> matrix = mass(Leaf("steel", length=0.1, thickness=0.001, width=0.01), steel)
    >>> round(float(matrix[0, 0] + 2.0 * matrix[0, 6] + matrix[6, 6]), 12)
    0.008
    """
    if isinstance(part, (Joint, Restricted)):
        return np.zeros((12, 12))
    known = law_of(part)
    if known is not None and known.mass is not None:
        return known.mass(part)
    beam = beam_of(part, material)
    return _with_modes(beam, consistent_mass(beam), held_modes(part, material))


@keep
def law_and_mass(part: Part, material: Material | None) -> tuple[Law, Array]:
    """Law and mass of a part, its beam integrated once for both; as `law` and `mass` give them.

    >>> steel = Material(young=200e9, poisson=0.3, density=8000.0)
    >>> from flexstage.parts.rod import Rod
    >>> rod = Rod("steel", length=0.1, diameter=0.002)
    >>> bool(np.all(law_and_mass(rod, steel)[0].stiffness == law(rod, steel).stiffness))
    True
    """
    known = law_of(part)
    if known is None or known.beam is None or known.diagonal is not None or isinstance(part, Restricted) or _asks_for_modes(part):
        return law(part, material), mass(part, material)
    beam = beam_of(part, material)
    return Law((1.0 / beam.diagonal())[..., None] * np.eye(6)), consistent_mass(beam)


def _asks_for_modes(part: Part) -> bool:
    own = inner(part)
    return isinstance(own, Elastic) and own.inner_modes > 0


def consistent_mass(beam: Beam) -> Array:
    """Consistent mass (..., 12, 12) of a beam, as `mass` says.

    A straight symmetric section moves along, about its axis, and in two planes, and none of the four feels another: only their entries
    are integrated.

    >>> from flexstage.beams.piezo import piezo_beam
    >>> from flexstage.parts.piezo import Piezo
    >>> bar = piezo_beam(Piezo(stroke=1e-4, stiffness=1e7, length=0.1, diameter=0.01, mass=6.0))
    >>> consistent_mass(bar)[[0, 0, 6], [0, 6, 6]].round(9).tolist()
    [2.0, 1.0, 2.0]
    """
    weight = _weights(beam)
    blocks = [(columns, _total([_product(rows[row], weight[..., row, :]) for row in rows])) for columns, rows in _motions(beam)]
    batch = np.broadcast_shapes(*(block.shape[:-2] for _, block in blocks))
    result = np.zeros((*batch, 12, 12), dtype=np.result_type(*(block for _, block in blocks)))
    for columns, block in blocks:
        both = np.concatenate([columns, columns + 6])
        result[..., both[:, None], both] = block
    return result


def _weights(beam: Beam) -> Array:
    """Inertia (..., 6, s) of what stands for each station -x and x."""
    weight = (beam.points.rule.weights * beam.points.rate)[..., None, :] * np.swapaxes(beam.inertia, -1, -2)
    return np.concatenate([weight, weight], axis=-1)


def _with_modes(beam: Beam, ends: Array, held: tuple[Held, ...]) -> Array:
    """The mass (..., 12 + m, 12 + m) of the ends and of the modes that a part has while they are held, of unit mass each."""
    if not held:
        return ends
    between = join(_shared(beam, mode) for mode in held)
    size = 12 + between.shape[-1]
    batch = np.broadcast_shapes(ends.shape[:-2], between.shape[:-2])
    result = np.zeros((*batch, size, size), dtype=np.result_type(ends, between))
    result[..., :12, :12], result[..., :12, 12:], result[..., 12:, :12] = ends, between, np.swapaxes(between, -1, -2)
    result[..., range(12, size), range(12, size)] = 1.0
    return result


def _shared(beam: Beam, held: Held) -> Array:
    """Mass (..., 12, n) that modes share with the motion of the ends: integral of N^T w phi dx, phi (v, dv/dx), of the ends' motion N."""
    weight = _weights(beam)
    columns, rows = next((columns, rows) for columns, rows in _motions(beam) if held.axis in columns)
    turning = int(columns[-1])
    block = (weight[..., held.axis, None, :] * _shape(rows[held.axis])) @ np.swapaxes(held.moved, -1, -2)
    if held.turned is not None:
        sign = 1.0 if held.axis == 1 else -1.0  # a slope of w along z turns about -y
        block = block + sign * (weight[..., turning, None, :] * _shape(rows[turning])) @ np.swapaxes(held.turned, -1, -2)
    result = np.zeros((*block.shape[:-2], 12, block.shape[-1]), dtype=block.dtype)
    result[..., np.concatenate([columns, columns + 6]), :] = block
    return result


_Rows: TypeAlias = dict[int, list[tuple[Array, Array]]]
"""For the freedoms of a section, as (along x, y, z; about x, y, z): the pairs of entries of its twist per motion of both ends, and per
relative motion, one pair for each column."""


def _total(items: list[Array]) -> Array:
    return items[0] if len(items) == 1 else items[0] + items[1]


def _product(entries: list[tuple[Array, Array]], weight: Array) -> Array:
    """Integral of N^T w N over the stations for one row of N."""
    shape = _shape(entries)
    return (weight[..., None, :] * shape) @ np.swapaxes(shape, -1, -2)


def _shape(entries: list[tuple[Array, Array]]) -> Array:
    """One row of N = [X - second, second] at the stations."""
    rows = [carry - second for carry, second in entries] + [second for _, second in entries]
    return np.stack(np.broadcast_arrays(*rows), axis=-2)


def _motions(beam: Beam) -> Iterator[tuple[Array, _Rows]]:
    """Columns of the motions that do not feel one another, and their rows of X and of X Gamma at the stations -x and +x."""
    points, flexibility = beam.points, beam.flexibility
    position = points.position
    both = np.concatenate([-position, position], axis=-1)
    one, none = np.ones_like(both), np.zeros_like(both)
    for axis in (0, 3):
        share = _share(points.running(flexibility[..., axis]))[0]
        yield np.array([axis]), {axis: [(one, share)]}
    for across, turning, sign in ((1, 5, 1.0), (2, 4, -1.0)):
        bending = flexibility[..., turning]
        moved, moving = _share(points.running(flexibility[..., across] + position * position * bending))
        turned, turns = _share(points.running(bending))
        odd = sign * _odd_from_end(beam, position * bending)
        odd = np.concatenate([odd, odd], axis=-1)
        arm = sign * both
        rows = {
            across: [(one, moved + arm * odd / moving), (arm, odd / turns + arm * turned)],
            turning: [(none, odd / moving), (one, turned)],
        }
        yield np.array([across, turning]), rows


def _share(half: Array) -> tuple[Array, Array]:
    """The part of an even flexibility that has accumulated at the stations -x and +x, and the whole (..., 1)."""
    total = 2.0 * half[..., -1:]
    return np.concatenate([0.5 - half / total, 0.5 + half / total], axis=-1), total


def _odd_from_end(beam: Beam, values: Array) -> Array:
    """-integral of an odd function from the first end to -x or x, both alike: its integral from x to the second end."""
    running = beam.points.running(values)
    return running[..., -1:] - running
