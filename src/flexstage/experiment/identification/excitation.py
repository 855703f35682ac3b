"""What moves a stage while it is recorded."""

from enum import Enum


class Excitation(Enum):
    """What moved the stage."""

    RECORDED = "recorded"
    """Inputs that were recorded."""
    FLOOR = "floor"
    """The floor, or other noise that nobody recorded, all along."""
    DECAY = "decay"
    """Nothing: it was left to itself after a blow or a release."""
