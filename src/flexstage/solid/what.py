"""What of a stage is read as solids. Light: the command line names it without loading anything."""

from __future__ import annotations

from enum import Enum


class What(Enum):
    """The scope of a solid study: every distinct hinge, every distinct unit alone, or the whole stage."""

    HINGE = "hinge"
    UNIT = "unit"
    STAGE = "stage"
