"""Choices of options."""

from enum import Enum


class File(Enum):
    """Kinds of files that have a schema."""

    DESIGN = "design"
    STUDY = "study"
    LOOP = "loop"
    SPECIFICATION = "specification"
    HYSTERESIS = "hysteresis"


class BranchSide(Enum):
    """The two post-buckling branches: along the buckling mode, or against it."""

    ALONG = "along"
    AGAINST = "against"
