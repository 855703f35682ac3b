"""A tilt stage: an arm on two cross hinges, one above the other, turned by a voice coil at its end.

The arm turns about the line where the leaves of a hinge cross, and two hinges some way apart hold its other two tilts. The coil pushes
near the end of the arm, across it. Leaves that cross in their middles are softest (Wittrick 1951); crossing at their ends they are four
times as stiff, and at 0.127 of their length the centre shifts least. Of the type of single-axis beam steerers; all values are assumed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.base.units.scale import X, Y, Z, kHz, mm
from flexstage.cases.stock import ALUMINIUM, COIL, SCALE, SOURCES, STEEL, stock_tags
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, ModalDamping, Probe
from flexstage.parts.body import Body, Extrusion
from flexstage.parts.cross_hinge import CrossHinge
from flexstage.parts.voice_coil import VoiceCoil


@dataclass(frozen=True)
class TiltStage:
    """Parameters of a tilt stage, SI.

    The arm turns about z. It is `size` = (wide along y, high along z), ends on two faces square to the leaves of the hinges, whose
    middles are `apart`, and reaches to `reach` along x. The coil pushes along y, `lever` away from the axis.
    """

    hinge: CrossHinge = CrossHinge("steel", length=30 * mm, thickness=0.5 * mm, width=8 * mm, spacing=10 * mm)
    coil: VoiceCoil = COIL
    apart: Annotated[Number, LENGTH, POSITIVE] = 30 * mm
    size: Annotated[tuple[Number, Number], LENGTH, POSITIVE] = (36 * mm, 50 * mm)
    reach: Annotated[Number, LENGTH, POSITIVE] = 70 * mm
    lever: Annotated[Number, LENGTH, POSITIVE] = 60 * mm


def tilt_stage(parameters: TiltStage | None = None) -> Mechanism:
    """The tilt stage as a description.

    Mobility 1 (rz); the force map is k_f times the lever, the stiffness that of two cross hinges,
    K = 16 (E I / L) (3 lambda^2 - 3 lambda + 1) without plate action.

    >>> sorted(tilt_stage().links)
    ['lower', 'motor', 'upper']
    """
    p = TiltStage() if parameters is None else parameters
    side = 0.5 * p.size[0]
    hinges = {
        name: Link((GROUND, PLATFORM), "hinge", (0.0, 0.0, sign * 0.5 * p.apart), X, bends=Z)
        for name, sign in (("lower", -1.0), ("upper", 1.0))
    }
    return Mechanism(
        name="tilt stage",
        materials={"aluminium": ALUMINIUM, "steel": STEEL},
        parts={"hinge": p.hinge, "coil": p.coil},
        bodies={PLATFORM: Body(solids={"arm": _arm(p)}, points={"tip": (p.reach, 0.0, 0.0)}, reference=(0.0, 0.0, 0.0))},
        links={**hinges, "motor": Link((GROUND, PLATFORM), "coil", (p.lever, -side, 0.0), Y)},
        sensors={"scale": SCALE},
        gauges={"S": Probe("scale", PLATFORM, Pose((p.lever, side, 0.0), along=Y))},
        damping=ModalDamping(0.01),
        envelope=(120 * mm, 60 * mm, 60 * mm),
        max_mode_frequency=2 * kHz,
        ground="aluminium",
        requirements=REQUIREMENTS,
        tags=stock_tags(("aluminium", "steel"), (), ()),
        sources=SOURCES,
    )


REQUIREMENTS = {
    "stroke.rz": "at least 20 mrad",
    "heating.rz": "at most 5 K",
    "frequency.platform.1": "at least 6 Hz",
    "safety": "at least 2",
}


def _arm(p: TiltStage) -> Extrusion:
    """A bar along x, notched at its near end by two faces that the leaves meet squarely."""
    side, half = 0.5 * p.size[0], 0.5 * p.hinge.angle
    along = (1.0 - p.hinge.crossing) * p.hinge.length
    deep = along / np.cos(half)
    near = deep - side * np.tan(half)
    corners = ((deep, 0.0), (near, side), (p.reach, side), (p.reach, -side), (near, -side))
    return Extrusion("aluminium", corners, p.size[1])
