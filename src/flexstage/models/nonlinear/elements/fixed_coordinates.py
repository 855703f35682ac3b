"""Fixed (constrained) coordinates of bodies, and their reactions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array
from flexstage.models.nonlinear.state import Pose
from flexstage.spatial.rotation import exponential, logarithm, logarithm_rate

_STEP = 1e-30


@dataclass(frozen=True, eq=False)
class FixedCoordinates:
    """h fixed coordinates: body numbers (h,), nominal arms (h, 3) of the points, `component` (h,) 0 to 5, and `value` (b, h) [m, rad].

    A translation is the displacement of the point; a rotation is a component of the rotation vector v = log R. The reaction to a fixed
    rotation is a moment along T^-T e. Here e is the unit vector of the component, and T dv/dt is the angular velocity. `origin` (h, 3) are
    the nominal points. If the cases belong to different designs, arms and origins have the shape (b, h, 3).
    """

    body: Array
    arm: Array
    component: Array
    origin: Array
    value: Array

    def of(self, cases: Array) -> FixedCoordinates:
        """Return the fixed coordinates of some cases."""
        return FixedCoordinates(self.body, self.arm, self.component, self.origin, self.value[cases])


def no_coordinates(cases: int) -> FixedCoordinates:
    """Return an empty set of fixed coordinates."""
    none = np.zeros(0, dtype=int)
    return FixedCoordinates(none, np.zeros((0, 3)), none, np.zeros((0, 3)), np.zeros((cases, 0)))


def values(hold: FixedCoordinates, place: int, pose: Pose) -> Array:
    """Compute the value (b,) of the fixed coordinate with index `place` at a pose."""
    body = hold.body[place]
    return _coordinate(hold, place, pose.position[:, body], pose.turn[:, body])[0]


def gradients(hold: FixedCoordinates, place: int, pose: Pose) -> tuple[Array, Array, Array]:
    """Compute value (b,), gradient (b, 6) and second derivative (b, 6, 6) of a fixed coordinate with respect to the body motion."""
    position, turn = pose.position[:, hold.body[place]], pose.turn[:, hold.body[place]]
    value, along = _coordinate(hold, place, position, turn)
    step = 1j * _STEP * np.eye(6)[:, None]
    _, stepped = _coordinate(hold, place, position + step[..., :3], exponential(step[..., 3:]) @ turn)
    return value, along, np.moveaxis(np.imag(stepped), 0, -1) / _STEP


def _coordinate(hold: FixedCoordinates, place: int, position: Array, turn: Array) -> tuple[Array, Array]:
    component = int(hold.component[place])
    if component > 2:
        angle = logarithm(turn)
        rows = logarithm_rate(angle)[..., component - 3, :]
        return angle[..., component - 3], np.concatenate([np.zeros_like(rows), rows], axis=-1)
    arm = (turn @ hold.arm[..., place, :, None])[..., 0]
    value = position[..., component] + arm[..., component] - hold.origin[..., place, component]
    unit = np.broadcast_to(np.eye(3)[component], arm.shape)
    return value, np.concatenate([unit, np.cross(arm, unit)], axis=-1)
