"""A telescope on three bipods: a primary mirror on six legs of blades, a secondary mirror on three struts above it.

A leg is three blades in a row, the middle one turned by a right angle: it holds the mirror along itself and yields to all else, so six legs
hold the mirror exactly once, and neither it nor the ground bends the other as they expand. Nothing is driven and nothing moves ideally:
what counts are the frequencies. Geometry, masses and materials are those of a student project whose finite element model is public.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, MASS, POSITIVE
from flexstage.base.units.scale import GPa, X, deg, kHz, mm
from flexstage.cases.bipod import SIDES, Bipod
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar
from flexstage.mechanism.mechanism import PLATFORM, Link, Mechanism, ModalDamping, Placement, Unit
from flexstage.parts.body import Body, Inertia, Payload
from flexstage.parts.leaf import Leaf, LeafSection
from flexstage.parts.material import Material
from flexstage.parts.rod import Rod

PROJECT = "GitHub GardenerGeralt/ssd-2024-group-b at f1b61c4b, Bipod_FEA_model_v2.0/assembly_sim1-modal (MIT licence)"
"""Of the dimensions, and of the frequencies in tests/elsewhere/test_published_stages.py."""

BLADES = Material(young=121 * GPa, poisson=0.34, density=4430.0, source="titanium alloy as in that project")
STRUTS = Material(
    young=410 * GPa, poisson=0.14, density=29085.0, source="as in that project, which gives the struts a mass they do not have"
)


@dataclass(frozen=True)
class TelescopeMount:
    """Parameters of a telescope mount, SI.

    Each bipod lies in a plane at `radius` from the axis. Its legs run from the ground, `foot` on either side of the middle, to the ends of
    a bar at `height`, `head` on either side; the bar belongs to the primary mirror up to `clamp` from the middle, its ends yield a little.
    The struts, of diameter `strut`, run from `strut_foot` = (radius, height) to the secondary mirror on the axis at the height `apex`. The
    mirrors are points: the `primary` mass at `primary_height` and the `secondary` at the apex.
    """

    thickness: Annotated[Number, LENGTH, POSITIVE] = 2.5 * mm
    width: Annotated[Number, LENGTH, POSITIVE] = 30 * mm
    radius: Annotated[Number, LENGTH, POSITIVE] = 134.995 * mm
    foot: Annotated[Number, LENGTH, POSITIVE] = 127.478 * mm
    head: Annotated[Number, LENGTH, POSITIVE] = 20 * mm
    clamp: Annotated[Number, LENGTH, POSITIVE] = 16 * mm
    height: Annotated[Number, LENGTH, POSITIVE] = 172 * mm
    strut: Annotated[Number, LENGTH, POSITIVE] = 12 * mm
    strut_foot: Annotated[tuple[Number, Number], LENGTH, POSITIVE] = (134.886 * mm, 172.297 * mm)
    apex: Annotated[Number, LENGTH, POSITIVE] = 523.27 * mm
    primary: Annotated[Number, MASS, POSITIVE] = 4.5
    primary_height: Annotated[Number, LENGTH, POSITIVE] = 210.98 * mm
    secondary: Annotated[Number, MASS, POSITIVE] = 0.6


def telescope_mount(parameters: TelescopeMount | None = None) -> Mechanism:
    """The telescope mount as a description.

    Mobility 0, nothing held twice by the bipods. Blades are beams as in the project; the struts have modes of their own among the mount's.

    >>> sorted(telescope_mount().placements)
    ['B1-B3', 'S1-S3']
    """
    p = TelescopeMount() if parameters is None else parameters
    return Mechanism(
        name="telescope mount",
        materials={"titanium": BLADES, "ceramic": STRUTS},
        parts=_parts(p),
        bodies={
            PLATFORM: Body(points={"mirror": (0.0, 0.0, p.primary_height)}),
            "secondary": Body(mass=p.secondary, centre=(0.0, 0.0, p.apex), point=True),
        },
        payloads={"primary": Payload(PLATFORM, p.primary, (0.0, 0.0, p.primary_height), point=True), "bars": _bars(p)},
        units={"bipod": _bipod(p), "strut": _strut(p)},
        placements={
            "B1-B3": Placement("bipod", Polar(p.radius, 180 * deg, InstanceOrientation.OUTWARD)),
            "S1-S3": Placement("strut", Polar(0.0, 180 * deg, InstanceOrientation.OUTWARD)),
        },
        damping=ModalDamping(0.01),
        envelope=(400 * mm, 400 * mm, 540 * mm),
        max_mode_frequency=1 * kHz,
        requirements={"frequency.platform.1": "at least 150 Hz"},
        tags={f"parts.blade.{key}": "stated project" for key in ("length", "thickness", "width")},
        sources={"project": PROJECT},
    )


def _parts(p: TelescopeMount) -> dict[str, Leaf | Rod]:
    blade = np.hypot(p.foot - p.head, p.height) / 3.0
    strut = np.hypot(p.strut_foot[0], p.apex - p.strut_foot[1])
    return {
        "blade": Leaf("titanium", blade, p.thickness, p.width, LeafSection.BEAM),
        "end": Leaf("titanium", p.head - p.clamp, p.thickness, p.width, LeafSection.BEAM),
        "strut": Rod("ceramic", strut, p.strut, inner_modes=3),
    }


def _bars(p: TelescopeMount) -> Payload:
    """The clamped parts of the three bars, each (radial, along, high), as one rigid ring."""
    radial, along, high = p.width, 2.0 * p.clamp, p.thickness
    mass = BLADES.density * radial * along * high
    level = 1.5 * mass * (p.radius**2 + (radial**2 + along**2 + 2.0 * high**2) / 12.0)
    upright = 3.0 * mass * (p.radius**2 + (radial**2 + along**2) / 12.0)
    return Payload(PLATFORM, 3.0 * mass, (0.0, 0.0, p.height), Inertia(level, level, upright))


def _bipod(p: TelescopeMount) -> Unit:
    """A bipod, where x points outward, and the free ends of its bar, which let nothing move ideally."""
    bipod = Bipod(p.foot, 0.0, p.head, p.height)
    ends = {
        f"{name}_end": Link(
            (f"{name}_head", PLATFORM), "end", start=bipod.at(side, 1.0), end=(0.0, side * p.clamp, p.height), bends=X, free=()
        )
        for name, side in SIDES.items()
    }
    heads = {f"{name}_head": Body() for name in SIDES}
    return Unit({**bipod.bodies(), **heads}, {**bipod.links("head"), **ends})


def _strut(p: TelescopeMount) -> Unit:
    foot = (p.strut_foot[0], 0.0, p.strut_foot[1])
    return Unit(links={"strut": Link((PLATFORM, "secondary"), "strut", start=foot, end=(0.0, 0.0, p.apex))})
