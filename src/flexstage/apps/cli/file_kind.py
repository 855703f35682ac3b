"""The kinds of files that have a schema, by the word of the option."""

from enum import Enum


class File(Enum):
    """Files that have a schema."""

    DESIGN = "design"
    STUDY = "study"
    LOOP = "loop"
    HYSTERESIS = "hysteresis"
