"""Geometric stiffness of parts: what the forces they carry add to the stiffness between their ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.beams.beam import Beam
from flexstage.beams.compliance import beam_of
from flexstage.parts.given import Given, Joint
from flexstage.parts.material import Material
from flexstage.parts.part import Part, Restricted

ENDS = 12
_CROSS = np.zeros((3, 3, 3))
_CROSS[[0, 1, 2], [1, 2, 0], [2, 0, 1]], _CROSS[[0, 1, 2], [2, 0, 1], [1, 2, 0]] = 1.0, -1.0


@dataclass(frozen=True, eq=False)
class Geometric:
    """Geometric stiffness of a part for the twists of its first and second end, both taken at its centre, and its inner bending.

    `per_force` (..., 6, 12 + k, 12 + k) per unit of each component of the wrench at its centre on the second end, in the link frame;
    `inner` (..., k) is the elastic stiffness of the k inner bending shapes, which no end feels. `half` (...) is half the length [m].
    """

    per_force: Array
    inner: Array
    half: Array


def geometric(part: Part, material: Material | None) -> Geometric:
    """Geometric stiffness of any part; one without a drawn length (a given matrix, a joint) is taken as a point.

    >>> from flexstage.parts.leaf import Leaf
    >>> leaf = Leaf("steel", length=0.06, thickness=0.0003, width=0.02)
    >>> found = geometric(leaf, Material(young=200e9, poisson=0.0, density=8000.0))
    >>> round(float(found.per_force[0, 1, 1] * 0.06), 3)  # 6 N / (5 L) of the consistent matrix
    1.2
    """
    inner = part.part if isinstance(part, Restricted) else part
    return _of_point() if isinstance(inner, (Given, Joint)) else _of_beam(beam_of(inner, material))


def _of_point() -> Geometric:
    """A bushing: its force acts in the mean of the frames of both ends, its moment across the step of the rotation."""
    mean, step = np.zeros((3, ENDS)), np.zeros((3, ENDS))
    mean[:, 3:6] = mean[:, 9:] = 0.5 * np.eye(3)
    step[:, :3], step[:, 6:9] = -np.eye(3), np.eye(3)
    turn = np.zeros((3, ENDS))
    turn[:, 3:6], turn[:, 9:] = -np.eye(3), np.eye(3)
    forces = -2.0 * np.einsum("ijk,ja,kb->iab", _CROSS, mean, step)
    moments = -np.einsum("ijk,ja,kb->iab", _CROSS, mean, turn)
    return Geometric(_symmetric(np.concatenate([forces, moments])), np.zeros(0), np.asarray(0.0))


def _of_beam(beam: Beam) -> Geometric:
    """Second variation of the exact beam's energy about the straight, loaded beam.

    With the rotation theta(x) of its sections in the shapes of linear bending and torsion, and resultants N, Q, m(x) = m_c - x e_x x Q:
    1/2 int N (theta_y^2 + theta_z^2 + r^2 theta_x'^2) - theta_x (Q . theta) - m . (theta x theta') dx, r the polar radius of the section.
    """
    position, weight, turn, bend, stiffness = _shapes(beam)
    outer = np.einsum("...s,...sia,...sjb->...ijab", weight, turn, turn)
    mixed = np.einsum("...s,...sia,...skb->...ikab", weight, turn, bend)
    moved = np.einsum("...s,...sia,...skb->...ikab", weight * position, turn, bend)
    polar = np.asarray(beam.section.polar / beam.section.area)
    wagner = np.einsum("...s,...sa,...sb->...ab", weight * np.concatenate([polar, polar], axis=-1), bend[..., 0, :], bend[..., 0, :])
    moments = [-np.einsum("jk,...jkab->...ab", _CROSS[axis], mixed) for axis in range(3)]
    along_y, along_z = (-np.einsum("jk,...jkab->...ab", _CROSS[axis], moved) for axis in (1, 2))
    rows = np.broadcast_arrays(
        outer[..., 1, 1, :, :] + outer[..., 2, 2, :, :] + wagner,
        -outer[..., 0, 1, :, :] - along_z,
        -outer[..., 0, 2, :, :] + along_y,
        *moments,
    )
    return Geometric(_symmetric(np.stack(rows, axis=-3)), stiffness, position[..., -1])


def _shapes(beam: Beam) -> tuple[Array, Array, Array, Array, Array]:
    """Stations and weights (..., s), rotation and its rate (..., s, 3, 16) of the sections, and the stiffness of the inner shapes (..., 4).

    Bending by both ends is f (a + b x) with f the flexibility; the inner shapes f (x^2 - F2/F0) and f (x^3 - x F4/F2) move no end. With
    them the column loads of a uniform beam come out to 1e-4, with the ends' shapes alone to 1 % (one end guided) and 20 % (both pinned).
    """
    points = beam.points
    half = points.position
    position = np.concatenate([-half, half], axis=-1)
    weight = np.concatenate([points.rate * points.rule.weights] * 2, axis=-1)
    batch = np.broadcast_shapes(beam.flexibility.shape[:-2], position.shape[:-1])
    turn = np.zeros((*batch, position.shape[-1], 3, ENDS + 4), dtype=np.result_type(beam.flexibility, position))
    bend = np.zeros_like(turn)
    stiffness: list[Array] = []
    turn[..., [0, 1, 2], [3, 4, 5]] = 1.0
    rates, angles = _of_step(beam, 3)
    _step(turn, bend, (0, 3), angles, rates)
    for axis, across, sign, column in ((1, 2, 1.0, ENDS), (2, 1, -1.0, ENDS + 2)):
        flexible = beam.flexibility[..., 3 + axis]
        whole, second, fourth, sixth = (points.whole(flexible * half**power)[..., None] for power in (0, 2, 4, 6))
        rates, angles = _of_step(beam, 3 + axis)
        _step(turn, bend, (axis, 3 + axis), angles, rates)
        odd = points.running(flexible * half) - points.running(flexible * half)[..., -1:]
        _step(turn, bend, (axis, across), *(sign * each / second for each in (_both(odd), _both(flexible) * position)))
        cubic = points.running(flexible * half**2) - second / whole * points.running(flexible)
        turn[..., axis, column] = np.concatenate([-cubic, cubic], axis=-1)
        bend[..., axis, column] = _both(flexible * (half**2 - second / whole))
        even = points.running(flexible * half**3) - fourth / second * points.running(flexible * half)
        turn[..., axis, column + 1] = _both(even - even[..., -1:])
        bend[..., axis, column + 1] = _both(flexible * (half**2 - fourth / second)) * position
        stiffness += [(fourth - second**2 / whole)[..., 0], (sixth - fourth**2 / second)[..., 0]]
    return position, weight, turn, bend, np.stack(np.broadcast_arrays(*stiffness), axis=-1)


def _of_step(beam: Beam, axis: int) -> tuple[Array, Array]:
    """Rate, and share accumulated from the first end, of a unit step of rotation between the ends."""
    flexible = beam.flexibility[..., axis]
    running = beam.points.running(flexible)
    share = running / (2.0 * running[..., -1:])
    return _both(flexible / (2.0 * running[..., -1:])), np.concatenate([0.5 - share, 0.5 + share], axis=-1)


def _step(turn: Array, bend: Array, place: tuple[int, int], angles: Array, rates: Array) -> None:
    """Enter a shape of the relative motion `place` (axis turned, column): plus for the second end, minus for the first."""
    axis, column = place
    for target, values in ((turn, angles), (bend, rates)):
        target[..., axis, column] -= values
        target[..., axis, column + 6] += values


def _both(even: Array) -> Array:
    return np.concatenate([even, even], axis=-1)


def _symmetric(matrix: Array) -> Array:
    return 0.5 * (matrix + np.swapaxes(matrix, -1, -2))
