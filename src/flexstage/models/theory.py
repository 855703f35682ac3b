"""Names of the models of a stage; this module does not import the models (for the command line)."""

from __future__ import annotations

from enum import Enum


class Model(Enum):
    """Models: ideal kinematics, axial springs (the paper's mapped model), hinges with 6x6 stiffness matrices (lumped model)."""

    IDEAL = "ideal"
    MAPPED = "mapped"
    LUMPED = "lumped"
