"""Names of the models of a stage; this module does not import the models (for the command line)."""

from __future__ import annotations

from enum import Enum


class Model(Enum):
    """Models: `ideal` for rigid bodies, `mapped` for axial springs (Shin & Moon), `lumped` for hinges with 6x6 stiffness matrices."""

    IDEAL = "ideal"
    MAPPED = "mapped"
    LUMPED = "lumped"
