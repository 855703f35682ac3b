"""The tapered leaf by beam theory."""

from __future__ import annotations

import numpy as np

from flexstage.beams.beam import Beam, beam
from flexstage.beams.law import PartLaw
from flexstage.beams.quadrature import stations
from flexstage.parts.material import Material
from flexstage.parts.profile import Straight
from flexstage.parts.section import Rectangle
from tapered_leaf.part import Taper


def taper_beam(part: Taper, material: Material) -> Beam:
    """The leaf as a Timoshenko beam of section t(x) x b, t(x) = t + (t_e - t) 2 |x| / L, without plate action."""
    points = stations(Straight(part.length), part.thickness)
    thickness, ends, long = (np.asarray(each)[..., None] for each in (part.thickness, part.end_thickness, part.length))
    height = thickness + (ends - thickness) * 2.0 * points.position / long
    return beam(points, Rectangle(height, np.asarray(part.width)[..., None]), material)


TAPER = PartLaw(taper_beam, concentration=lambda _: 1.0)
