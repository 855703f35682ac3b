"""Superelements at large displacements: linear in a corotated frame that follows their ports (docs/nonlinear.md, 31).

The frame R is the mean rotation of the port bodies: the sum of log(R^T R_i) is zero. In this frame, the ports have the displacements u_i =
R^T (x_i - x) - (X_i - X) and the rotations log(R^T R_i). x and X are the means of the current port positions x_i and the nominal port
positions X_i, and R_i is the rotation of port body i. The linear stiffness acts on the non-rigid part of these motions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, matvec
from flexstage.spatial.frame import cross_matrix
from flexstage.spatial.rotation import cross, exponential, logarithm, logarithm_rate

_STEP = 1e-30
_TURNS = 8


@dataclass(frozen=True, eq=False)
class Corotated:
    """Superelement with p ports: body numbers (p,), nominal arms (p, 3) from bodies to ports, port axes (p, 3, 3), in stage axes.

    - `place` (p, 3): nominal positions of the ports.
    - `relative` (6 (p - 1), 6 p): matrix from port motions in stage axes to strains, as in the linear model. `stiffness` (6 (p - 1), 6 (p -
      1)) converts strains to forces.
    - `squares` (m,): squared angular frequencies of the inner modes.
    - `inertia` (6 p + m, 6 p + m): mass matrix for the port motions in port axes and the m inner modes.
    - `mass`; `centre` (3,): nominal centre of mass.
    - `share` (6 p, 3): loads on the ports per unit acceleration of the element.
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
class PortMotion:
    """Motions (..., 6 p) of the ports in the corotated frame, and their derivatives (..., 6 p, 6 p) with respect to the body motions.

    `frame` (..., 3, 3) is the corotated frame. `turning` and `drift` (..., 3, 6 p) are the derivatives of the rotation of this frame and of
    the mean position of the ports.
    """

    motion: Array
    rows: Array
    frame: Array
    turning: Array
    drift: Array


def port_motion(element: Corotated, position: Array, turn: Array) -> PortMotion:
    """Compute the port motions at positions (..., p, 3) and rotations (..., p, 3, 3) of their bodies."""
    count = len(element.bodies)
    frame = _mean(turn)
    angle = logarithm(frame.mT[..., None, :, :] @ turn)
    arm = matvec(turn, element.arm)
    place = position + arm
    middle = np.mean(place, axis=-2, keepdims=True)
    shift = matvec(frame.mT[..., None, :, :], place - middle) - (element.place - np.mean(element.place, axis=0))
    rate = logarithm_rate(angle) @ frame.mT[..., None, :, :]
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
    back = frame.mT[..., None, :, :]
    shifted = back @ (own - drift[..., None, :, :] + cross_matrix(place - middle) @ turning[..., None, :, :])
    turned = rate @ (spun - turning[..., None, :, :])
    motion = np.concatenate([shift, angle], axis=-1)
    rows = np.concatenate([shifted, turned], axis=-2)
    flat = (*motion.shape[:-2], 6 * count)
    return PortMotion(motion.reshape(flat), rows.reshape(*flat, 6 * count), frame, turning, drift)


def resist(element: Corotated, position: Array, turn: Array, gravity: Array) -> Array:
    """Compute the internal forces (..., 6 p) on the port bodies, minus the element's weight under `gravity` (..., 3) [m/s^2]."""
    ports = port_motion(element, position, turn)
    strain = matvec(element.relative, ports.motion)
    force = (element.relative.T @ (element.stiffness @ strain[..., None]))[..., 0]
    pulled = matvec(ports.frame.mT, gravity)
    force = force - matvec(element.share, pulled)
    hanging = element.mass * (element.centre - np.mean(element.place, axis=0)) + (ports.motion @ element.share)
    lever = matvec(ports.frame, hanging)
    weight = element.mass * gravity
    own = matvec(ports.rows.mT, force)
    return own - matvec(ports.drift.mT, weight) - matvec(ports.turning.mT, cross(lever, gravity))


def stiffen_ports(element: Corotated, position: Array, turn: Array, gravity: Array) -> tuple[Array, Array]:
    """Compute the internal forces and their derivative (..., 6 p, 6 p), by complex steps."""
    count = 6 * len(element.bodies)
    step = 1j * _STEP * np.eye(count).reshape(count, *([1] * (position.ndim - 2)), -1, 6)
    stepped = resist(element, position + step[..., :3], exponential(step[..., 3:]) @ turn, gravity)
    return resist(element, position, turn, gravity), np.moveaxis(np.imag(stepped), 0, -1) / _STEP


def _mean(turn: Array) -> Array:
    """The mean (..., 3, 3) of rotations (..., p, 3, 3) by H. Karcher's definition, iterated from the first."""
    mean = turn[..., 0, :, :]
    for _ in range(_TURNS):
        away = np.mean(logarithm(mean.mT[..., None, :, :] @ turn), axis=-2)
        mean = mean @ exponential(away)
    return mean
