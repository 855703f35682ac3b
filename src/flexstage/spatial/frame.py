"""Frames, twists and wrenches: component order, reference point and 6x6 transport are defined here only.

Twists and wrenches are 6-vectors (x, y, z, rx, ry, rz): translations then rotations, forces then moments, at a named reference point.
Motions are small. All arrays may have leading batch axes and may be complex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexstage.base.number import Array, Number, Vector, stack
from flexstage.base.record import UnitOf

COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")
FORCES = ("fx", "fy", "fz", "mx", "my", "mz")
TWIST_UNITS = ("m", "m", "m", "rad", "rad", "rad")
WRENCH_UNITS = ("N", "N", "N", "N m", "N m", "N m")

MOTION = UnitOf(lambda name: TWIST_UNITS[COMPONENTS.index(name)])
"""Annotation of twists, with the unit of each coordinate: x in m, rz in rad."""

WRENCH = UnitOf(lambda name: WRENCH_UNITS[COMPONENTS.index(name)])
"""Annotation of loads, with the unit of each coordinate: force x in N, moment rz in N m."""

_UNIT = np.eye(6)


@dataclass(frozen=True, eq=False)
class Frame:
    """Frame relative to an outer frame: `rotation` (..., 3, 3) has its axes as columns, `position` (..., 3) [m] is its origin.

    If `mirrored`, the axes are left-handed, as in a mirror image. Points, directions and inertias transform as usual. Twists need a
    right-handed frame: convert a mirrored frame with `right_handed` first.
    """

    rotation: Array
    position: Array
    mirrored: bool = False

    def within(self, outer: Frame) -> Frame:
        """Return this frame relative to the parent frame of `outer`.

        >>> inner = Frame(np.eye(3), np.array([1.0, 0.0, 0.0]))
        >>> inner.within(Frame(turn_z(np.pi / 2), np.zeros(3))).position.round(12).tolist()
        [0.0, 1.0, 0.0]
        """
        return Frame(outer.rotation @ self.rotation, outer.point(self.position), self.mirrored != outer.mirrored)

    @property
    def right_handed(self) -> Frame:
        """The frame itself if it is right-handed; otherwise the frame with reversed y axis.

        >>> reflection(0).right_handed.rotation.diagonal().tolist()
        [-1.0, -1.0, 1.0]
        """
        return Frame(self.rotation * np.array([1.0, -1.0, 1.0]), self.position) if self.mirrored else self

    def point(self, point: Array) -> Array:
        """Transform a point (..., 3) of this frame to the outer frame."""
        return self.position + (self.rotation @ point[..., None])[..., 0]

    def direction(self, direction: Array) -> Array:
        """Transform a direction (..., 3) of this frame to the outer frame."""
        return (self.rotation @ direction[..., None])[..., 0]


def identity() -> Frame:
    """Return the identity frame.

    >>> identity().position.tolist()
    [0.0, 0.0, 0.0]
    """
    return Frame(np.eye(3), np.zeros(3))


def reflection(axis: int) -> Frame:
    """Return the left-handed frame whose given axis (0, 1, 2) is reversed.

    >>> reflection(1).point(np.array([1.0, 2.0, 3.0])).tolist()
    [1.0, -2.0, 3.0]
    """
    return Frame(np.diag(np.where(np.arange(3) == axis, -1.0, 1.0)), np.zeros(3), mirrored=True)


def cross_matrix(vector: Array) -> Array:
    """Build the cross-product matrix [v]x with [v]x w = v x w.

    >>> (cross_matrix(np.array([0.0, 0.0, 1.0])) @ np.array([1.0, 0.0, 0.0])).tolist()
    [0.0, 1.0, 0.0]
    """
    vector = np.asarray(vector)
    result = np.zeros((*vector.shape, 3), dtype=vector.dtype)
    back = -vector
    result[..., 1, 2], result[..., 2, 0], result[..., 0, 1] = back[..., 0], back[..., 1], back[..., 2]
    result[..., 2, 1], result[..., 0, 2], result[..., 1, 0] = vector[..., 0], vector[..., 1], vector[..., 2]
    return result


def transport(arm: Array) -> Array:
    """Build the 6x6 matrix X that moves a twist from a point P to the point P + arm: v' = v + w x arm.

    Wrenches transform in the opposite direction: w_P = X^T w_(P + arm).

    >>> (transport(np.array([1.0, 0.0, 0.0])) @ np.array([0, 0, 0, 0, 0, 1.0])).tolist()
    [0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    """
    arm = np.asarray(arm)
    result = np.zeros((*arm.shape[:-1], 6, 6), dtype=arm.dtype)
    result[...] = _UNIT
    result[..., :3, 3:] = cross_matrix(-arm)
    return result


def mirror(axis: int) -> Array:
    """Build the 6x6 matrix that mirrors a twist in the plane that contains the origin and is normal to an axis (0, 1, 2).

    The mirror reverses the translation along the axis and the rotations about the two other axes.

    >>> mirror(0).diagonal().tolist()
    [-1.0, 1.0, 1.0, 1.0, -1.0, -1.0]
    """
    along = np.arange(3) == axis
    return np.diag(np.concatenate([np.where(along, -1.0, 1.0), np.where(along, 1.0, -1.0)]))


def spatial_rotation(rotation: Array) -> Array:
    """Build the 6x6 matrix diag(R, R) that rotates twists and wrenches from a frame with the axes R (columns) to the outer axes.

    >>> spatial_rotation(np.eye(3)).shape
    (6, 6)
    """
    result = np.zeros((*rotation.shape[:-2], 6, 6), dtype=rotation.dtype)
    result[..., :3, :3] = rotation
    result[..., 3:, 3:] = rotation
    return result


def twist_transform(frame: Frame, reference: Array) -> Array:
    """Build the 6x6 matrix that transforms a body's twist at the point `reference`, in outer axes, to the frame's origin and axes.

    >>> twist_transform(identity(), np.zeros(3)).tolist() == np.eye(6).tolist()
    True
    """
    back = frame.rotation.mT
    lever = back @ cross_matrix(reference - frame.position)
    result = np.zeros((*lever.shape[:-2], 6, 6), dtype=lever.dtype)
    result[..., :3, :3] = back
    result[..., 3:, 3:] = back
    result[..., :3, 3:] = lever
    return result


def turn_z(angle: Number) -> Array:
    """Build the rotation matrix about z by `angle` [rad].

    >>> turn_z(0.0).tolist()
    [[1.0, -0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    cosine, sine = np.cos(angle), np.sin(angle)
    zero, one = np.zeros_like(cosine), np.ones_like(cosine)
    return np.stack([np.stack([cosine, -sine, zero], -1), np.stack([sine, cosine, zero], -1), np.stack([zero, zero, one], -1)], -2)


def normalise(vector: Array) -> Array:
    """Normalise a vector (..., 3) to unit length. Complex numbers are not conjugated, so that complex steps remain valid.

    >>> normalise(np.array([3.0, 0.0, 4.0])).tolist()
    [0.6, 0.0, 0.8]
    """
    return vector / np.sqrt(np.add.reduce(vector * vector, axis=-1, keepdims=True))


def axes(along: Vector | Array, up: Vector | Array | None = None) -> Array:
    """Build the rotation matrix with the x axis `along` and the z axis `up`. Vectors are normalised; z is made perpendicular to x.

    Without `up`, z is the stage's z axis, made perpendicular to x. If `along` is within 5 degrees of the stage's z axis, its y axis is used
    instead.

    >>> axes((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)).tolist()
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    x = normalise(stack(along) if isinstance(along, tuple) else along)
    if up is None:
        steep = np.abs(np.real(x[..., 2:3])) > np.cos(np.deg2rad(5.0))
        z = np.where(steep, np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    else:
        z = stack(up) if isinstance(up, tuple) else up
    z = normalise(z - np.add.reduce(z * x, axis=-1, keepdims=True) * x)
    x, z = np.broadcast_arrays(x, z)
    return np.stack([x, (cross_matrix(z) @ x[..., None])[..., 0], z], axis=-1)


def rigid_inertia(mass: Number, inertia: Array, centre: Array, reference: Array) -> Array:
    """Build the 6x6 inertia of a rigid body for its twist at `reference`; `inertia` (..., 3, 3) is about the centre of mass `centre` [SI].

    The result is X^T diag(m I, J) X, with the mass m, the inertia J, and the transport X from the reference to the centre of mass.

    >>> rigid_inertia(2.0, np.eye(3), np.zeros(3), np.zeros(3)).diagonal().tolist()
    [2.0, 2.0, 2.0, 1.0, 1.0, 1.0]
    """
    lever = cross_matrix(centre - reference)
    mass = np.asarray(mass)[..., None, None]
    shape = np.broadcast_shapes(mass.shape[:-2], inertia.shape[:-2], lever.shape[:-2])
    result = np.zeros((*shape, 6, 6), dtype=np.result_type(mass, inertia, lever))
    moment = mass * lever
    result[..., :3, :3], result[..., 3:, :3], result[..., :3, 3:] = mass * np.eye(3), moment, -moment
    result[..., 3:, 3:] = inertia + lever.mT @ moment
    return result
