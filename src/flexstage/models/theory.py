"""The models of a stage by name. Light: the command line names them without loading them."""

from __future__ import annotations

from enum import Enum


class Model(Enum):
    """Models of theory: ideal kinematics, the paper's axial springs, lumped 6x6 hinges."""

    IDEAL = "ideal"
    MAPPED = "mapped"
    LUMPED = "lumped"
