"""Consistent mass of parts by the static shape functions of their own beams."""

from __future__ import annotations

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.beam import Beam
from flexstage.beams.compliance import beam_of
from flexstage.beams.given import given_mass
from flexstage.parts.given import Given, Joint
from flexstage.parts.material import Material
from flexstage.parts.part import Part, Restricted
from flexstage.spatial.frame import transport


def mass(part: Part, material: Material | None) -> Array:
    """Mass (..., 12, 12) of a part for the twists of its first and its second end, both taken at its centre, in the link frame [SI].

    The section at x moves by v(x) = X_x (q_a + Gamma(x) (q_b - q_a)), Gamma(x) = S(x) K: S the compliance accumulated from the first end to
    x, K = S(end)^-1. M = integral of N^T diag(rho A, rho A, rho A, rho I_p, rho I_y, rho I_z) N dx with N = [X (1 - Gamma), X Gamma].
    It holds the material between the arc ends and gives a rigid motion the inertia of the solid exactly. A `Given`
    part has half its mass at each end; `Joint` and `Restricted` parts have none.

    >>> steel = Material(young=200e9, poisson=0.3, density=8000.0)
    >>> from flexstage.parts.leaf import Leaf
    >>> matrix = mass(Leaf("steel", length=0.1, thickness=0.001, width=0.01), steel)
    >>> round(float(matrix[0, 0] + 2.0 * matrix[0, 6] + matrix[6, 6]), 12)
    0.008
    """
    if isinstance(part, (Joint, Restricted)):
        return np.zeros((12, 12))
    if isinstance(part, Given):
        return given_mass(part)
    return consistent_mass(beam_of(part, material))


def consistent_mass(beam: Beam) -> Array:
    """Consistent mass (..., 12, 12) of a beam, as `mass` says.

    >>> from flexstage.beams.piezo import piezo_beam
    >>> from flexstage.parts.piezo import Piezo
    >>> bar = piezo_beam(Piezo(stroke=1e-4, stiffness=1e7, length=0.1, diameter=0.01, mass=6.0))
    >>> consistent_mass(bar)[[0, 0, 6], [0, 6, 6]].round(9).tolist()
    [2.0, 1.0, 2.0]
    """
    shares = _shares(beam)
    position = np.concatenate([-beam.points.position, beam.points.position], axis=-1)
    carry = transport(np.stack([position, np.zeros_like(position), np.zeros_like(position)], axis=-1))
    second = carry @ shares
    shapes = np.concatenate([carry - second, second], axis=-1)
    weight = beam.points.rule.weights * beam.points.rate
    density = weight[..., None] * beam.inertia
    density = np.concatenate([density, density], axis=-2)
    rows = (*np.broadcast_shapes(shapes.shape[:-3], density.shape[:-2]), -1)
    flat = np.broadcast_to(shapes, (*rows[:-1], *shapes.shape[-3:])).reshape(*rows, 12)
    weighted = np.broadcast_to(density, (*rows[:-1], *density.shape[-2:])).reshape(*rows, 1) * flat
    return np.swapaxes(flat, -1, -2) @ weighted


def _shares(beam: Beam) -> Array:
    """Gamma (..., 2m, 6, 6): the part of a relative twist that has accumulated at the stations -x and +x."""
    points, flexibility = beam.points, beam.flexibility
    position = points.position
    even = [flexibility[..., index] for index in range(6)]
    even[1] = even[1] + position * position * flexibility[..., 5]
    even[2] = even[2] + position * position * flexibility[..., 4]
    halves = [points.running(values) for values in even]
    totals = [2.0 * half[..., -1:] for half in halves]
    coupling_y = _odd_from_end(beam, position * flexibility[..., 5])
    coupling_z = -_odd_from_end(beam, position * flexibility[..., 4])
    size = np.broadcast_shapes(*(item.shape for item in (*halves, coupling_y, coupling_z)))
    result = np.zeros((*size[:-1], 2 * size[-1], 6, 6), dtype=np.result_type(position, flexibility))
    for index, (half, total) in enumerate(zip(halves, totals, strict=True)):
        result[..., index, index] = np.concatenate(np.broadcast_arrays(0.5 - half / total, 0.5 + half / total), axis=-1)
    for row, column, values in ((1, 5, coupling_y), (2, 4, coupling_z)):
        both = np.concatenate([values, values], axis=-1)
        result[..., row, column] = both / totals[column]
        result[..., column, row] = both / totals[row]
    return result


def _odd_from_end(beam: Beam, values: Array) -> Array:
    """-integral of an odd function from the first end to -x or x, both alike: its integral from x to the second end."""
    running = beam.points.running(values)
    return running[..., -1:] - running
