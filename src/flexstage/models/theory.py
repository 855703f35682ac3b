"""Names of the models of a stage; this module does not import the models (for the command line)."""

from __future__ import annotations

from enum import Enum


class Model(Enum):
    """Models: ideal kinematics, axial springs (the paper's mapped model), lumped 6x6 hinges."""

    IDEAL = "ideal"
    MAPPED = "mapped"
    LUMPED = "lumped"
