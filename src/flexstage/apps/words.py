"""Words that options of commands choose from."""

from enum import Enum


class File(Enum):
    """Files that have a schema."""

    DESIGN = "design"
    STUDY = "study"
    LOOP = "loop"
    HYSTERESIS = "hysteresis"


class Side(Enum):
    """The two ways of a branch: with the shape that gives way, or the other way."""

    ALONG = "along"
    AGAINST = "against"
