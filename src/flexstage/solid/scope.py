"""The scope of a solid study. Light: the command line names it without loading anything."""

from __future__ import annotations

from enum import Enum


class Scope(Enum):
    """Each distinct hinge, each distinct unit isolated, or the whole stage."""

    HINGE = "hinge"
    UNIT = "unit"
    STAGE = "stage"
