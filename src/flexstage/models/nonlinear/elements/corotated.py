"""Superelements at large displacements: linear in a frame that turns with their ports (docs/nonlinear.md, 31).

The frame R turns as the mean of the ports' bodies: the sum of log(R^T R_i) is zero. In it ports have moved by
u_i = R^T (x_i - x) - (X_i - X), x and X the means of their places now and drawn, and turned by log(R^T R_i); the linear stiffness counts
what is not rigid of that.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.spatial.frame import cross_matrix
from flexstage.spatial.rotation import cross, exponential, logarithm, logarithm_rate

_STEP = 1e-30
_TURNS = 8


@dataclass(frozen=True, eq=False)
class Corotated:
    """A superelement: bodies of its p ports by number (p,), drawn arms (p, 3) to them, axes of the ports (p, 3, 3), in the stage's axes.

    `place` (p, 3) is where ports are drawn, `relative` (6 (p - 1), 6 p) takes their motions in the stage's axes to what `stiffness`
    (6 (p - 1), 6 (p - 1)) strains, as in the linear model. `squares` (m,) are those of the inner modes' angular frequencies, `inertia`
    (6 p + m, 6 p + m) over the ports in their axes and the modes; `mass`, its `centre` (3,) as drawn, and `share` (6 p, 3): what of an
    acceleration of the whole each port carries.
    """

    name: str
    ports: tuple[str, ...]
    bodies: Array
    arm: Array
    axes: Array
    place: Array
    relative: Array
    stiffness: Array
    squares: Array
    inertia: Array
    damping: Array | None
    loss: float
    mass: float
    centre: Array
    share: Array


@dataclass(frozen=True, eq=False)
class Moved:
    """Ports in their turned frame: motions (..., 6 p), and their derivatives (..., 6 p, 6 p) by the motions of the bodies.

    `frame` (..., 3, 3), its turning (..., 3, 6 p) and the motion of the mean place (..., 3, 6 p) by the same.
    """

    motion: Array
    rows: Array
    frame: Array
    turning: Array
    drift: Array


def moved(element: Corotated, position: Array, turn: Array) -> Moved:
    """The ports at positions (..., p, 3) and rotations (..., p, 3, 3) of their bodies."""
    count = len(element.bodies)
    frame = _mean(turn)
    angle = logarithm(_transpose(frame)[..., None, :, :] @ turn)
    arm = (turn @ element.arm[..., None])[..., 0]
    place = position + arm
    middle = np.mean(place, axis=-2, keepdims=True)
    shift = (_transpose(frame)[..., None, :, :] @ (place - middle)[..., None])[..., 0] - (element.place - np.mean(element.place, axis=0))
    rate = logarithm_rate(angle) @ _transpose(frame)[..., None, :, :]
    following = np.linalg.solve(np.sum(rate, axis=-3)[..., None, :, :], rate)
    wide = (*angle.shape[:-2], 3, 6 * count)
    turning, drift = np.zeros(wide, dtype=angle.dtype), np.zeros(wide, dtype=angle.dtype)
    own = np.zeros((*angle.shape[:-2], count, 3, 6 * count), dtype=angle.dtype)
    spun = np.zeros_like(own)
    for port in range(count):
        start = 6 * port
        own[..., port, :, start : start + 3] = np.eye(3)
        own[..., port, :, start + 3 : start + 6] = -cross_matrix(arm[..., port, :])
        spun[..., port, :, start + 3 : start + 6] = np.eye(3)
        turning[..., start + 3 : start + 6] = following[..., port, :, :]
    drift = np.mean(own, axis=-3)
    back = _transpose(frame)[..., None, :, :]
    shifted = back @ (own - drift[..., None, :, :] + cross_matrix(place - middle) @ turning[..., None, :, :])
    turned = rate @ (spun - turning[..., None, :, :])
    motion = np.concatenate([shift, angle], axis=-1)
    rows = np.concatenate([shifted, turned], axis=-2)
    flat = (*motion.shape[:-2], 6 * count)
    return Moved(motion.reshape(flat), rows.reshape(*flat, 6 * count), frame, turning, drift)


def resist(element: Corotated, position: Array, turn: Array, gravity: Array) -> Array:
    """What the element resists with (..., 6 p) on the bodies of its ports, its weight under `gravity` (..., 3) taken off."""
    found = moved(element, position, turn)
    strain = (element.relative @ found.motion[..., None])[..., 0]
    force = (element.relative.T @ (element.stiffness @ strain[..., None]))[..., 0]
    pulled = (_transpose(found.frame) @ gravity[..., None])[..., 0]
    force = force - (element.share @ pulled[..., None])[..., 0]
    hanging = element.mass * (element.centre - np.mean(element.place, axis=0)) + (found.motion @ element.share)
    lever = (found.frame @ hanging[..., None])[..., 0]
    weight = element.mass * gravity
    own = (_transpose(found.rows) @ force[..., None])[..., 0]
    return (
        own - (_transpose(found.drift) @ weight[..., None])[..., 0] - (_transpose(found.turning) @ cross(lever, gravity)[..., None])[..., 0]
    )


def stiffen_ports(element: Corotated, position: Array, turn: Array, gravity: Array) -> tuple[Array, Array]:
    """The same, and its derivative (..., 6 p, 6 p), by complex steps."""
    count = 6 * len(element.bodies)
    step = 1j * _STEP * np.eye(count).reshape(count, *([1] * (position.ndim - 2)), -1, 6)
    stepped = resist(element, position + step[..., :3], exponential(step[..., 3:]) @ turn, gravity)
    return resist(element, position, turn, gravity), np.moveaxis(np.imag(stepped), 0, -1) / _STEP


def _mean(turn: Array) -> Array:
    """The mean (..., 3, 3) of rotations (..., p, 3, 3): of H. Karcher, found from the first."""
    found = turn[..., 0, :, :]
    for _ in range(_TURNS):
        away = np.mean(logarithm(_transpose(found)[..., None, :, :] @ turn), axis=-2)
        found = found @ exponential(away)
    return found


def _transpose(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)
