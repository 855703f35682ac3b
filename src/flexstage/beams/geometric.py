"""Geometric stiffness of a part: the additional stiffness between its ends due to the forces in the part."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.base.storage.digest import keep
from flexstage.beams.beam import Beam
from flexstage.beams.compliance import beam_of, law_of
from flexstage.parts.compliance_matrix import Joint
from flexstage.parts.material import Material
from flexstage.parts.part import Part, inner, strut_of
from flexstage.parts.shape import Shaped

ENDS = 12
_SLENDER, _STOUT = (12, 12, 12), (0, 2, 2)
"""Numbers of inner shapes of twist about x and of bending about y and z: for leaves and rods; for all other parts."""
_CROSS = np.zeros((3, 3, 3))
_CROSS[[0, 1, 2], [1, 2, 0], [2, 0, 1]], _CROSS[[0, 1, 2], [2, 0, 1], [1, 2, 0]] = 1.0, -1.0


@dataclass(frozen=True, eq=False)
class Geometric:
    """Geometric stiffness of a part for the twists of both ends about its centre, and for k inner shapes of twist and bending.

    `per_force` (..., 6, 12 + k, 12 + k) is the geometric stiffness per unit of each component of the wrench on the second end. The wrench
    is about the centre, in the link frame. `inner` (..., k) are the elastic stiffnesses of the inner shapes, which do not move the ends.
    `half` (...) is half the length [m].
    """

    per_force: Array
    inner: Array
    half: Array


@keep
def geometric(part: Part, material: Material | None) -> Geometric:
    """Compute the geometric stiffness of any part; a part without length (a compliance matrix, a joint) is treated as a point.

    >>> from flexstage.parts.leaf import Leaf
    >>> leaf = Leaf("steel", length=0.06, thickness=0.0003, width=0.02)
    >>> result = geometric(leaf, Material(young=200e9, poisson=0.0, density=8000.0))
    >>> round(float(result.per_force[0, 1, 1] * 0.06), 3)  # 6 N / (5 L) of the consistent matrix
    1.2
    """
    own = inner(part)
    part_law = law_of(own)
    if isinstance(own, Joint) or (part_law is not None and part_law.beam is None):
        length = strut_of(own)
        return _of_point() if length is None else _of_strut(np.asarray(length))
    return _of_beam(beam_of(own, material), _SLENDER if isinstance(own, Shaped) and own.slender else _STOUT)


def foreshortening(part: Part, material: Material | None) -> Array:
    """Compute the foreshortening matrices G (6, 6, 6): a relative twist e of the ends causes the second-order deformations 1/2 e^T G_i e.

    The twist is about the part's centre. The deformation is due to bending and twist; the axial stretch is neglected. The geometric
    stiffness under the wrench w is that of a part without length plus the sum of w_i G_i over the components i. G is zero for parts without
    length.
    """
    own, axis = geometric(part, material), np.eye(3)[0]
    result = own.per_force[..., 6:ENDS, 6:ENDS] - _of_point().per_force[:, 6:, 6:]
    if not np.any(own.half):
        return np.zeros_like(result)
    both = np.einsum("ia,b->iab", np.eye(3), axis)  # end forces on the bodies at +-half
    result[..., :3, 3:, 3:] -= own.half * (axis[:, None, None] * np.eye(3) - 0.5 * (both + both.mT))
    result[..., 0, :] = result[..., :, 0] = 0.0
    return result


def _of_point() -> Geometric:
    """Bushing: its force acts in the mean frame of both ends, its moment across the step of rotation."""
    mean, step = np.zeros((3, ENDS)), np.zeros((3, ENDS))
    mean[:, 3:6] = mean[:, 9:] = 0.5 * np.eye(3)
    step[:, :3], step[:, 6:9] = -np.eye(3), np.eye(3)
    turn = np.zeros((3, ENDS))
    turn[:, 3:6], turn[:, 9:] = -np.eye(3), np.eye(3)
    forces = -2.0 * np.einsum("ijk,ja,kb->iab", _CROSS, mean, step)
    moments = -np.einsum("ijk,ja,kb->iab", _CROSS, mean, turn)
    return Geometric(_symmetric(np.concatenate([forces, moments])), np.zeros(0), np.asarray(0.0))


def _of_strut(length: Array) -> Geometric:
    """Strut that turns about both ends, at +-L/2: its axial force F moves with them, F/L |D|^2 / 2, D the transverse shift between them.

    Ends are taken at the centre: the arms to the ends turn too and add -F L/4 theta^2 each. All other components act as in `_of_point`.
    """
    arm = 0.5 * length[..., None, None]
    step, lever = np.zeros((2, ENDS)), np.zeros((2, ENDS))
    step[[0, 1], [1, 2]], step[[0, 1], [7, 8]] = -1.0, 1.0
    lever[0, [5, 11]], lever[1, [4, 10]] = 1.0, -1.0
    shift = step + arm * lever
    turns = np.zeros(ENDS)
    turns[[4, 5, 10, 11]] = 1.0
    axial = shift.mT @ shift / length[..., None, None] - arm * np.diag(turns)
    point = _of_point()
    others = np.broadcast_to(point.per_force[1:], (*length.shape, 5, ENDS, ENDS))
    return Geometric(np.concatenate([axial[..., None, :, :], others], axis=-3), point.inner, point.half)


def _of_beam(beam: Beam, inner: tuple[int, int, int]) -> Geometric:
    """Second variation of the exact beam's energy about the straight, loaded beam.

    The rotation theta(x) of the sections has the shapes of linear bending and torsion, with resultants N, Q, m(x) = m_c - x e_x x Q:

    1/2 int N (theta_y^2 + theta_z^2 + r^2 theta_x'^2) - theta_x (Q . theta) - m . (theta x theta') dx,

    with r the polar radius of the section.
    """
    position, weight, turn, bend, stiffness = _shapes(beam, inner)
    outer, mixed, moved = _sum(weight, turn, turn), _sum(weight, turn, bend), _sum(weight * position, turn, bend)
    polar = _both(np.broadcast_to(beam.section.polar / beam.section.area, beam.flexibility.shape[:-1]))
    wagner = _sum(weight * polar, bend[..., :1, :], bend[..., :1, :])[..., 0, 0, :, :]
    moments = [-np.einsum("jk,...jkab->...ab", _CROSS[axis], mixed) for axis in range(3)]
    along_y, along_z = (-np.einsum("jk,...jkab->...ab", _CROSS[axis], moved) for axis in (1, 2))
    rows = np.broadcast_arrays(
        outer[..., 1, 1, :, :] + outer[..., 2, 2, :, :] + wagner,
        -outer[..., 0, 1, :, :] - along_z,
        -outer[..., 0, 2, :, :] + along_y,
        *moments,
    )
    return Geometric(_symmetric(np.stack(rows, axis=-3)), stiffness, position[..., -1])


def _sum(weight: Array, first: Array, second: Array) -> Array:
    """Sum over the stations of weights (..., s) times products of shapes (..., s, i, a) and (..., s, j, b): (..., i, j, a, b)."""
    weighed = weight[..., None, None] * first
    wide, across = (each.reshape(*each.shape[:-2], -1) for each in (weighed, second))
    total = wide.mT @ across
    return np.swapaxes(total.reshape(*total.shape[:-2], *first.shape[-2:], *second.shape[-2:]), -3, -2)


def _shapes(beam: Beam, inner: tuple[int, int, int]) -> tuple[Array, Array, Array, Array, Array]:
    """Stations and weights (..., s), rotation and rate (..., s, 3, 12 + k) of sections, stiffness (..., k) of the inner shapes.

    Bending by both ends is f (a + b x) with f the flexibility, twist is f a. The inner shapes f p(x) move no end: p are the next
    polynomials orthogonal to the former under f.

    Their error is 1e-4 for column loads. For lateral buckling, in which bending in two planes and twist are coupled, it is 5e-3, mostly
    1e-4. Without inner shapes columns are wrong by 1 % if one end is guided, by 20 % if both ends are pinned.
    """
    points = beam.points
    half = points.position
    position = np.concatenate([-half, half], axis=-1)
    weight = _both(points.rate * points.rule.weights)
    batch = np.broadcast_shapes(beam.flexibility.shape[:-2], position.shape[:-1])
    turn = np.zeros((*batch, position.shape[-1], 3, ENDS + sum(inner)), dtype=np.result_type(beam.flexibility, position))
    bend = np.zeros_like(turn)
    turn[..., [0, 1, 2], [3, 4, 5]] = 1.0
    stiffness: list[Array] = []
    for axis in range(3):
        angles, rates = _of_step(beam, 3 + axis)
        _step(turn, bend, angles, rates, axis=axis, column=3 + axis)
    for axis, across, sign in ((1, 2, 1.0), (2, 1, -1.0)):
        flexible = beam.flexibility[..., 3 + axis]
        lever = points.whole(flexible * half**2)[..., None]
        angles = sign * _integral(beam, flexible * half, odd=True) / lever
        _step(turn, bend, angles, sign * _both(flexible) * position / lever, axis=axis, column=across)
    column = ENDS
    for axis, count in enumerate(inner):
        flexible = beam.flexibility[..., 3 + axis]
        first = 1 if axis == 0 else 2
        for degree, shape, size in _inner(beam, flexible, range(first, first + count)):
            odd = degree % 2 == 1
            turn[..., axis, column], bend[..., axis, column] = (
                _integral(beam, flexible * shape, odd=odd),
                _mirror(flexible * shape, odd=odd),
            )
            stiffness.append(size)
            column += 1
    return position, weight, turn, bend, np.stack(np.broadcast_arrays(*stiffness), axis=-1)


def _inner(beam: Beam, flexible: Array, degrees: range) -> Iterator[tuple[int, Array, Array]]:
    """Inner shapes of the rotation rate over the flexibility at the stations, and their elastic stiffness.

    Each shape is orthogonal to all polynomials of lower degree: those of the part's ends, and the previous inner ones.
    """
    points, half = beam.points, beam.points.position
    known: list[Array] = []
    for degree in range(degrees.stop):
        shape = half**degree
        for each in known[degree % 2 :: 2]:
            shape = shape - (points.whole(flexible * shape * each) / points.whole(flexible * each * each))[..., None] * each
        known.append(shape)
        if degree in degrees:
            yield degree, shape, points.whole(flexible * shape * shape)


def _integral(beam: Beam, rate: Array, *, odd: bool) -> Array:
    """Integral from the first end, at -x and x, of an even or odd rate whose whole integral is zero."""
    running = beam.points.running(rate)
    return _both(running - running[..., -1:]) if odd else np.concatenate([-running, running], axis=-1)


def _mirror(half: Array, *, odd: bool) -> Array:
    return np.concatenate([-half if odd else half, half], axis=-1)


def _of_step(beam: Beam, axis: int) -> tuple[Array, Array]:
    """Accumulated fraction from the first end, and its rate, of a unit step of rotation between the ends."""
    flexible = beam.flexibility[..., axis]
    running = beam.points.running(flexible)
    share = running / (2.0 * running[..., -1:])
    return np.concatenate([0.5 - share, 0.5 + share], axis=-1), _both(flexible / (2.0 * running[..., -1:]))


def _step(turn: Array, bend: Array, angles: Array, rates: Array, *, axis: int, column: int) -> None:
    """Enter a shape of the relative motion `column` with a rotation about `axis`: plus for the second end, minus for the first."""
    for target, values in ((turn, angles), (bend, rates)):
        target[..., axis, column] -= values
        target[..., axis, column + 6] += values


def _both(even: Array) -> Array:
    return np.concatenate([even, even], axis=-1)


def _symmetric(matrix: Array) -> Array:
    return 0.5 * (matrix + matrix.mT)
