"""Excitation of a stage during a record."""

from enum import Enum


class Excitation(Enum):
    """Type of excitation of the stage."""

    RECORDED = "recorded"
    """Recorded inputs."""
    FLOOR = "floor"
    """Continuous floor motion, or other unrecorded noise."""
    DECAY = "decay"
    """Free decay after an impact or a release."""
