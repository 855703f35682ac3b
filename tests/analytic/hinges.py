"""What the analytic tests share: the reference's steel and unit block in N and mm, and errors in percent."""

from __future__ import annotations

import numpy as np

from flexstage.beams.compliance import compliance
from flexstage.parts.material import Material
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Circular

STEEL = Material(young=200e3, poisson=0.3, density=7.75e-9)
"""Of the worked examples, in N, mm, tonne: E = 200 GPa, nu = 0.3."""

UNIT = Material(young=1.0, poisson=0.3, density=1.0)
"""Of the tables: E = 1, nu = 0.3, scaled by E, b and R."""

PERCENT_DIGIT = 0.006
"""Half of the last digit of an error printed in percent to 0.01, and what the rounding of the compliance beside it adds."""


def diagonal(part, material=STEEL):
    """The six compliances about the centre."""
    return np.diagonal(compliance(part, material), axis1=-2, axis2=-1)


def circular(ratio, radius=1.0, width=1.0):
    """The right-circular notch of thickness over radius `ratio`."""
    return Notch("m", thickness=ratio * radius, width=width, profile=Circular(radius))


def error(stated, true):
    """How far a stated value is off, in percent."""
    return 100.0 * (stated / true - 1.0)
