"""Misalignment of unit instances and gauges relative to their pattern."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Annotated, Any

import numpy as np

from flexstage.base.number import Vector, stack
from flexstage.base.storage.digest import Description
from flexstage.base.units.quantity import ANGLE, LENGTH
from flexstage.mechanism.addresses.path import replace_member
from flexstage.spatial.frame import Frame
from flexstage.spatial.rotation import exponential


@dataclass(frozen=True, eq=False)
class Misalignment(Description):
    """Misalignment of an instance in its own frame: `shift` of its origin, and `rotation` vector about its axes.

    The direction of the rotation vector is the axis, its length the angle. All bodies and links of a unit move together, including the
    hinge to the platform and its seat. The stage is manufactured in the misaligned position, so the misalignment causes no forces.
    """

    shift: Annotated[Vector, LENGTH] = (0.0, 0.0, 0.0)
    rotation: Annotated[Vector, ANGLE] = (0.0, 0.0, 0.0)


MISALIGNED = tuple(field.name for field in fields(Misalignment))


def misalignment_of(overrides: Mapping[str, Any], copy: str) -> Misalignment:
    """Return the misalignment of an instance or a gauge from overrides.

    >>> misalignment_of({"B2.shift.x": 1e-5}, "B2").shift
    (1e-05, 0.0, 0.0)
    """
    result = Misalignment()
    for address, value in overrides.items():
        name, _, rest = address.partition(".")
        path = tuple(rest.split("."))
        if name == copy and path[0] in MISALIGNED:
            result = replace_member(result, path, value)
    return result


def misalign(frame: Frame, overrides: Mapping[str, Any], copy: str) -> Frame:
    """Apply misalignment to the frame of an instance: the frame is shifted along its own axes and rotated about its origin.

    >>> at = Frame(np.eye(3), np.zeros(3))
    >>> misalign(at, {"B2.rotation.z": 0.5 * np.pi}, "B2").direction(np.array([1.0, 0.0, 0.0])).round(12).tolist()
    [0.0, 1.0, 0.0]
    """
    if not any(address.partition(".")[0] == copy for address in overrides):
        return frame
    result = misalignment_of(overrides, copy)
    return Frame(np.asarray(frame.rotation) @ exponential(stack(result.rotation)), frame.point(stack(result.shift)), frame.mirrored)
