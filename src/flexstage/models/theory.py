"""Models of a stage by name, without import of their modules (for the command line)."""

from __future__ import annotations

from enum import Enum


class Model(Enum):
    """Models of theory: ideal kinematics, axial springs of the paper, lumped 6x6 hinges."""

    IDEAL = "ideal"
    MAPPED = "mapped"
    LUMPED = "lumped"
