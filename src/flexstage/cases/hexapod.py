"""A hexapod of six flexure struts: stacks with a neck at both ends, in three pairs around the platform.

Every strut pushes along its own line and lets everything else go, so the six strokes command the six freedoms of the platform, all struts
are equal, and no guide is needed. The slope of the struts divides the stiffness between the plane and the vertical: flat struts hold x, y
and yaw, steep ones z and the tilts. The necks' bending is what each motion works against; the spin of every strut about itself is idle.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.number import Number, Vector
from flexstage.base.units.quantity import ANGLE, LENGTH, NOT_NEGATIVE, POSITIVE
from flexstage.base.units.scale import deg, kHz, mm
from flexstage.cases.stock import ALUMINIUM, GAUGE, SOURCES, STEEL, STRONG_STACK, stock_tags
from flexstage.cases.strut import Strut
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar
from flexstage.mechanism.mechanism import Aperture, Mechanism, ModalDamping, Placement, Probe, Unit
from flexstage.parts.body import Body, Cylinder
from flexstage.parts.gauge import SensorSense
from flexstage.parts.neck import Neck
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular


@dataclass(frozen=True)
class Hexapod:
    """Parameters of a hexapod, SI.

    Three pairs of struts stand 120 degrees apart, their heads (front necks) on the circle `head_radius` at height 0, the two of a pair
    `gap` apart along the tangent. Both lean against one another, at `slope` to the horizontal. The platform is a disc of diameter
    `diameter`, thickness `thickness` and central bore `bore`, its lower face `rise` above the heads.
    """

    neck: Neck = Neck("steel", thickness=3 * mm, profile=Circular(4 * mm))
    stack: Piezo = STRONG_STACK
    head_radius: Annotated[Number, LENGTH, POSITIVE] = 55 * mm
    gap: Annotated[Number, LENGTH, POSITIVE] = 24 * mm
    slope: Annotated[Number, ANGLE] = 45 * deg
    diameter: Annotated[Number, LENGTH, POSITIVE] = 140 * mm
    thickness: Annotated[Number, LENGTH, POSITIVE] = 12 * mm
    bore: Annotated[Number, LENGTH, NOT_NEGATIVE] = 60 * mm
    rise: Annotated[Number, LENGTH] = 8 * mm


def hexapod(parameters: Hexapod | None = None) -> Mechanism:
    """The hexapod as a description.

    Mobility 6; a strut's row of R_a is (n, r x n): its direction n and the moment arm of its head r, here from the platform's centre of
    mass.

    >>> sorted(hexapod().placements)
    ['A1-A3', 'B1-B3']
    """
    p = Hexapod() if parameters is None else parameters
    around = Polar(p.head_radius, 90 * deg, InstanceOrientation.OUTWARD)
    disc = Cylinder("aluminium", p.diameter, p.thickness, (0.0, 0.0, p.rise + 0.5 * p.thickness), bore=p.bore)
    return Mechanism(
        name="hexapod",
        materials={"aluminium": ALUMINIUM, "steel": STEEL},
        parts={"neck": p.neck, "stack": p.stack},
        bodies={"platform": Body(solids={"disc": disc}, points={"sample": (0.0, 0.0, p.rise + p.thickness)})},
        units={"left": _strut(p, 1.0), "right": _strut(p, -1.0)},
        placements={"A1-A3": Placement("left", around), "B1-B3": Placement("right", around)},
        sensors={"probe": GAUGE},
        gauges=_gauges(p),
        damping=ModalDamping(0.01),
        envelope=(200 * mm, 200 * mm, 70 * mm),
        opening=Aperture((40 * mm, 40 * mm)),
        max_mode_frequency=5 * kHz,
        requirements=REQUIREMENTS,
        tags=stock_tags(("aluminium", "steel"), ("stack",), ("probe",)),
        sources=SOURCES,
    )


REQUIREMENTS = {
    "stroke.x": "at least 15 um",
    "stroke.y": "at least 15 um",
    "stroke.z": "at least 15 um",
    "frequency.platform.1": "at least 300 Hz",
    "safety": "at least 2",
}


def _strut(p: Hexapod, side: float) -> Unit:
    """One strut of a pair; the pair's x axis points outward, y along the tangent, the origin is midway between the two heads."""
    along: Vector = (0.0, -side * np.cos(p.slope), np.sin(p.slope))
    return Strut((0.0, 0.5 * side * p.gap, 0.0), along, p.neck, p.stack, "steel", 14 * mm).unit()


def _gauges(p: Hexapod) -> dict[str, Probe]:
    middle = p.rise + 0.5 * p.thickness
    level = Polar(0.5 * p.diameter, -90 * deg, InstanceOrientation.TANGENT, middle)
    upright = Polar(0.4 * p.diameter, 90 * deg, InstanceOrientation.AXIS, p.rise)
    return {
        "S1-S3": Probe("probe", "platform", level, SensorSense.OPENS),
        "S4-S6": Probe("probe", "platform", upright, SensorSense.OPENS),
    }
