"""A small tolerance study, for examples."""

from __future__ import annotations

from flexstage.studies.tolerances.definition import Tolerance
from flexstage.studies.tolerances.file import loads_tolerance


def leaf_study(copies: int = 64) -> Tolerance:
    """Return a study of the parallelogram: common and individual scatter of leaf thickness, and the stiffness along x.

    >>> leaf_study().plan.count
    64
    """
    return loads_tolerance(
        f"""
format = "flexstage study 1"
name = "leaves"
case = "parallelogram"
responses = {{ guide = "stiffness.x" }}
limits = {{ "stiffness.x" = "at least 10 N/um" }}
tolerance = {{ copies = {copies}, requirements = false, crosstalk = false }}
[scatter]
wire = {{ address = "parts.leaf.thickness", normal = "5 um" }}
wear = {{ address = "links.left.thickness", uniform = "5 um" }}
"""
    )
