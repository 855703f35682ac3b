"""A small specification, for examples."""

from __future__ import annotations

from flexstage.studies.synthesis.specification import Specification, loads_specification

_TEXT = """
format = "flexstage specification 1"
name = "scanner"
motion = { x = "50 um", y = "50 um" }
payload = { mass = "30 g", size = ["30 mm", "30 mm", "5 mm"] }
box = { size = ["260 mm", "260 mm", "40 mm"] }
actuators = { kinds = ["piezo"] }
requirements.frequency = "at least 500 Hz"
"""


def scanner() -> Specification:
    """Return the specification of an XY scanner.

    >>> scanner().displacements
    {'x': 5e-05, 'y': 5e-05}
    """
    return loads_specification(_TEXT)
