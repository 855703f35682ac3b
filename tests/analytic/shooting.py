"""Plane beams at any displacement by shooting: a second author, without modes and points, of what flexures at large displacements do.

Beams of unit length, forces over E I / L^2, moments over E I / L. The section turns by psi' = m; the centre line follows it, stretched and
sheared by the force in its axes (Haringx); m' = y' f_x - x' f_y under the force f of the end, which keeps its direction.
"""

from __future__ import annotations

import numpy as np
import scipy
from scipy.optimize import root

from flexstage.base.number import Array


def beam_end(force: Array, moment: float, stretch: float, shear: float) -> Array:
    """Place, rotation and moment (4,) at the end of a beam along x that has `moment` at its start; `stretch` is 1/EA, `shear` k/GA."""

    def slope(_: float, state: Array) -> Array:
        cosine, sine = np.cos(state[2]), np.sin(state[2])
        along = 1.0 + stretch * (cosine * force[0] + sine * force[1])
        across = shear * (cosine * force[1] - sine * force[0])
        dx, dy = cosine * along - sine * across, sine * along + cosine * across
        return np.array([dx, dy, state[3], dy * force[0] - dx * force[1]])

    return scipy.integrate.solve_ivp(slope, (0.0, 1.0), [0.0, 0.0, 0.0, moment], method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]


def cross_pivot(angle: float, crossing: float, load: Array, stretch: float, shear: float) -> tuple[float, Array]:
    """Moment and displacement (2,) of a platform turned by `angle` under a `load` (2,), on two beams at 45 degrees to x, one on each side.

    They cross at the share `crossing` of their length, where the platform is loaded and looked at.
    """
    axes = [_turn(side * 0.25 * np.pi) for side in (1.0, -1.0)]
    arms = [(1.0 - crossing) * _turn(angle) @ axis[:, 0] for axis in axes]

    def ends(unknown: Array) -> list[Array]:
        return [beam_end(start[:2], start[2], stretch, shear) for start in unknown[:6].reshape(2, 3)]

    def forces(unknown: Array) -> list[Array]:
        return [axis @ start[:2] for axis, start in zip(axes, unknown[:6].reshape(2, 3), strict=True)]

    def gaps(unknown: Array) -> Array:
        wanted = [axis.T @ (unknown[6:] + crossing * axis[:, 0] + arm) for axis, arm in zip(axes, arms, strict=True)]
        missed = [end[:3] - [*place, angle] for end, place in zip(ends(unknown), wanted, strict=True)]
        return np.concatenate([*missed, np.add(*forces(unknown)) - load])

    guess = np.concatenate([*([*(0.5 * axis.T @ load), angle] for axis in axes), np.zeros(2)])
    found = root(gaps, guess, tol=1e-12)
    if not found.success:
        raise ArithmeticError(found.message)
    turning = [arm[0] * force[1] - arm[1] * force[0] for arm, force in zip(arms, forces(found.x), strict=True)]
    return float(sum(end[3] for end in ends(found.x)) + sum(turning)), found.x[6:]


def _turn(angle: float) -> Array:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
