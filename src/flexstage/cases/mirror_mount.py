"""A mirror of one metre on three bipods: held exactly once, with nothing driven.

Every leg is three blades, the middle one turned by a right angle. The lines of a bipod's legs meet at a point, and where these points lie
in the plane of the mirror's centre of mass, a weight across the axis does not tilt it. Blades, angle and mass are those of Kihm, Yang &
Lee (Rev. Sci. Instrum. 85, 125101, 2014); what they do not print, as the modulus of the blades, is assumed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.number import Number
from flexstage.base.units.quantity import ANGLE, LENGTH, MASS, POSITIVE
from flexstage.base.units.scale import GPa, MPa, deg, kHz, mm
from flexstage.cases.bipod import Bipod
from flexstage.cases.stock import SOURCES
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar
from flexstage.mechanism.mechanism import PLATFORM, Mechanism, ModalDamping, Placement, Unit
from flexstage.parts.body import Body, Inertia
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material

INVAR = Material(
    young=141 * GPa, poisson=0.29, density=8050.0, yield_stress=276 * MPa, expansion=1.3e-6, source="Invar 36, annealed, typical"
)


@dataclass(frozen=True)
class MirrorMount:
    """Parameters of a mirror mount, SI.

    The bipods stand at `radius`; their legs enclose `angle`, end `head` on either side of their middle, and point to the plane z = 0 of the
    mirror's centre of mass. The mirror weighs `mass` and has the inertia of a disc of that `diameter` and `thickness`.
    """

    blade: Leaf = Leaf("invar", length=50 * mm, thickness=1.8 * mm, width=30 * mm)
    angle: Annotated[Number, ANGLE, POSITIVE] = 64 * deg
    radius: Annotated[Number, LENGTH, POSITIVE] = 350 * mm
    head: Annotated[Number, LENGTH, POSITIVE] = 25 * mm
    mass: Annotated[Number, MASS, POSITIVE] = 46.0
    diameter: Annotated[Number, LENGTH, POSITIVE] = 1000 * mm
    thickness: Annotated[Number, LENGTH, POSITIVE] = 100 * mm


def mirror_mount(parameters: MirrorMount | None = None) -> Mechanism:
    """The mirror mount as a description.

    Mobility 0, nothing held twice. Across the axis K = 3 (E t w / 3 l) sin^2(angle / 2) of thin blades, whose bending adds (t/l)^2.

    >>> sorted(mirror_mount().placements)
    ['B1-B3']
    """
    p = MirrorMount() if parameters is None else parameters
    level = p.mass * (p.diameter**2 / 16.0 + p.thickness**2 / 12.0)
    mirror = Body(mass=p.mass, centre=(0.0, 0.0, 0.0), inertia=Inertia(level, level, p.mass * p.diameter**2 / 8.0))
    bipod = _bipod(p)
    return Mechanism(
        name="mirror mount",
        materials={"invar": INVAR},
        parts={"blade": p.blade},
        bodies={PLATFORM: mirror},
        units={"bipod": Unit(bipod.bodies(), bipod.links())},
        placements={"B1-B3": Placement("bipod", Polar(p.radius, 90 * deg, InstanceOrientation.OUTWARD))},
        damping=ModalDamping(0.01),
        envelope=(1000 * mm, 1000 * mm, 300 * mm),
        max_mode_frequency=1 * kHz,
        requirements={"frequency.platform.1": "at least 120 Hz"},
        tags={f"parts.blade.{key}": "stated kihm" for key in ("length", "thickness", "width")} | {"bodies.platform.mass": "stated kihm"},
        sources={**SOURCES, "kihm": "Kihm, Yang & Lee, Rev. Sci. Instrum. 85, 125101 (2014), Table I"},
    )


def _bipod(p: MirrorMount) -> Bipod:
    half, leg = 0.5 * p.angle, 3.0 * p.blade.length
    top = -p.head / np.tan(half)
    return Bipod(foot=p.head + leg * np.sin(half), base=top - leg * np.cos(half), head=p.head, top=top)
