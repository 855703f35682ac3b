"""A tip-tilt-piston mirror mount: a mirror on vertical stacks around its axis, centred by three flat leaf springs.

The leaves lie in one plane along tangents: together they hold the mirror sideways and in yaw, and let it tip, tilt and rise. Each stack
stands between two necks, so the mirror tilts without bending it. Three stacks determine the motion; four (parameter `posts`) are
redundant: a command in which opposite pairs work against one another is internal stress and moves nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.base.units.scale import X, Y, Z, deg, kHz, mm
from flexstage.cases.stock import ALUMINIUM, GAUGE, GLASS_CERAMIC, SLIM_STACK, SOURCES, STEEL, stock_tags
from flexstage.cases.strut import Strut
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar
from flexstage.mechanism.mechanism import Link, Mechanism, ModalDamping, Placement, Probe, Unit
from flexstage.parts.body import Block, Body, Cylinder
from flexstage.parts.gauge import SensorSense
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular
from flexstage.parts.profile import length as hinge_length


@dataclass(frozen=True)
class TipTilt:
    """Parameters of a tip-tilt-piston mount, SI.

    `posts` stacks stand at `post_radius` around z. The holder is a disc of diameter `holder` and thickness `holder_thickness` centred at
    the origin, where also the three leaves lie, their middles at `leaf_radius`; the mirror, of diameter `mirror` and thickness
    `mirror_thickness`, is bonded on top.
    """

    posts: int = 3
    neck: Neck = Neck("steel", thickness=1.5 * mm, profile=Circular(4 * mm))
    stack: Piezo = SLIM_STACK
    leaf: Leaf = Leaf("steel", length=24 * mm, thickness=0.3 * mm, width=8 * mm)
    post_radius: Annotated[Number, LENGTH, POSITIVE] = 20 * mm
    leaf_radius: Annotated[Number, LENGTH, POSITIVE] = 36 * mm
    holder: Annotated[Number, LENGTH, POSITIVE] = 60 * mm
    holder_thickness: Annotated[Number, LENGTH, POSITIVE] = 6 * mm
    mirror: Annotated[Number, LENGTH, POSITIVE] = 60 * mm
    mirror_thickness: Annotated[Number, LENGTH, POSITIVE] = 10 * mm


def tip_tilt(parameters: TipTilt | None = None) -> Mechanism:
    """The mirror mount as a description.

    Mobility 3 (z, rx, ry); a post at position angle n has the row (1, rho sin n, -rho cos n) of R_a. The leaves hold the other three
    freedoms three times each: six redundant constraints.

    >>> sorted(tip_tilt(TipTilt(posts=4)).placements)
    ['L1-L3', 'P1-P4']
    """
    p = TipTilt() if parameters is None else parameters
    head = -0.5 * (p.holder_thickness + hinge_length(p.neck.profile))
    strut = Strut((0.0, 0.0, head), Z, p.neck, p.stack, "steel", 10.5 * mm)
    return Mechanism(
        name="tip-tilt mount" if p.posts == 3 else f"tip-tilt mount on {p.posts} posts",
        materials={"aluminium": ALUMINIUM, "steel": STEEL, "glass": GLASS_CERAMIC},
        parts={"neck": p.neck, "stack": p.stack, "leaf": p.leaf},
        bodies={"platform": _platform(p)},
        units={"post": strut.unit(), "leaf": _leaf(p)},
        placements={
            f"P1-P{p.posts}": Placement("post", Polar(p.post_radius, 90 * deg, InstanceOrientation.OUTWARD)),
            "L1-L3": Placement("leaf", Polar(p.leaf_radius, 30 * deg, InstanceOrientation.TANGENT)),
        },
        sensors={"probe": GAUGE},
        gauges={
            "S1-S3": Probe(
                "probe",
                "platform",
                Polar(0.45 * p.holder, 90 * deg, InstanceOrientation.AXIS, -0.5 * p.holder_thickness),
                SensorSense.OPENS,
            )
        },
        damping=ModalDamping(0.01),
        envelope=(100 * mm, 100 * mm, 80 * mm),
        max_mode_frequency=20 * kHz,
        requirements={
            "stroke.z": "at least 18 um",
            "stroke.rx": "at least 0.9 mrad",
            "frequency.platform.1": "at least 500 Hz",
            "safety": "at least 2",
        },
        tags=stock_tags(("aluminium", "steel", "glass"), ("stack",), ("probe",)),
        sources=SOURCES,
    )


def _leaf(p: TipTilt) -> Unit:
    """A leaf along the tangent x, y inward, and the holder's lug that it ends on: a riser outside the rim on a foot under the disc."""
    near, far = 0.5 * p.leaf.length, 0.5 * p.leaf.length + 8 * mm
    half, under = 0.5 * p.leaf.width + 0.5 * mm, 0.5 * p.holder_thickness
    reach = p.leaf_radius - 0.5 * p.holder + 7 * mm
    lug = {
        "riser": Block("aluminium", (far - near, 2.0 * half, 2.0 * under), (0.5 * (near + far), 0.0, 0.0)),
        "foot": Block("aluminium", (far - near, half + reach, 4 * mm), (0.5 * (near + far), 0.5 * (reach - half), -under - 2 * mm)),
    }
    link = Link(("ground", "platform"), "leaf", (0.0, 0.0, 0.0), X, bends=Y)
    return Unit({"lug": Body(solids=lug, of="platform")}, {"leaf": link})


def _platform(p: TipTilt) -> Body:
    face = 0.5 * p.holder_thickness + p.mirror_thickness
    holder = Cylinder("aluminium", p.holder, p.holder_thickness)
    mirror = Cylinder("glass", p.mirror, p.mirror_thickness, (0.0, 0.0, face - 0.5 * p.mirror_thickness))
    return Body(solids={"holder": holder, "mirror": mirror}, points={"vertex": (0.0, 0.0, face)})
