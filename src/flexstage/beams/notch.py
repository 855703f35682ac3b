"""One-axis notch hinges by beam theory."""

from __future__ import annotations

import numpy as np

from flexstage.beams.beam import Beam, beam
from flexstage.beams.law import PartLaw, Range, ratio
from flexstage.beams.profiled import concentration, proportions
from flexstage.beams.quadrature import stations
from flexstage.parts.material import Material
from flexstage.parts.notch import Notch
from flexstage.parts.profile import Contour, Filleted, Straight
from flexstage.parts.section import Rectangle


def notch_beam(part: Notch, material: Material) -> Beam:
    """Build the Timoshenko beam of a notch with rigid ends and restrained warping.

    The section is (t + 2 w(x)) x b, with least thickness t, growth w(x) on each side and width b. The shear factor is 6/5.

    >>> from flexstage.parts.profile import Circular
    >>> steel = Material(young=200e9, poisson=0.3, density=7750.0)
    >>> hinge = notch_beam(Notch("steel", thickness=0.001, width=0.01, profile=Circular(0.005)), steel)
    >>> round(float(hinge.diagonal()[5]), 8)  # reference B1: 1.539997e-5 rad/(N mm)
    0.01539997
    """
    points = stations(part.profile, part.thickness)
    thickness = np.asarray(part.thickness)[..., None] + 2.0 * points.growth
    return beam(points, Rectangle(thickness, np.asarray(part.width)[..., None]), material)


def _ranges(part: Notch) -> tuple[Range, ...]:
    return Range("width over thickness", ratio(part.width, part.thickness), low=1.0), *proportions(part.profile, part.thickness, "notch")


def _family(part: Notch) -> str | None:
    if isinstance(part.profile, Contour):
        return None
    return "bar" if isinstance(part.profile, Straight) else "fillet" if isinstance(part.profile, Filleted) else "notch"


NOTCH = PartLaw(notch_beam, concentration=lambda part: concentration(part.profile, part.thickness), ranges=_ranges, family=_family)
