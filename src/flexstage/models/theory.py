"""Which theory a stage is read by. Light: the command line names the readings without loading them."""

from __future__ import annotations

from enum import Enum


class Reading(Enum):
    """The theories a stage can be read by: ideal kinematics, the paper's axial springs, lumped 6x6 hinges."""

    IDEAL = "ideal"
    MAPPED = "mapped"
    LUMPED = "lumped"
