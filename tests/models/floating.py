"""A small stage that floats but for one mount, to move all bodies, joints and copies at once."""

from __future__ import annotations

from functools import cache

from flexstage.base.units.scale import X, Y, Z, deg, mm, um
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar, Pose
from flexstage.mechanism.mechanism import Link, Mechanism, Placement, Probe, Unit
from flexstage.parts.body import Block, Body, Inertia, Payload
from flexstage.parts.gauge import SensorSense
from flexstage.parts.neck import Neck
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Straight
from flexstage.parts.rod import Rod
from flexstage.solid.fea.jobs.parts import Ways
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.read import SolidRead, read_solid, solids
from tests.stock import ALUMINIUM, GAUGE, STEEL

COARSE = Reduction(Fineness(neck=2.5, block=2.5, grading=0.6, order=2), modes=4)
MOUNT = "mount"
STACK = Piezo(stroke=10 * um, stiffness=50e6, length=10 * mm, diameter=5 * mm, mass=1e-3, bending_rigidity=10.0)

PARTS = {
    "front": Neck("aluminium", thickness=2 * mm, width=3 * mm, profile=Straight(4 * mm)),
    "back": Neck("steel", thickness=3 * mm, width=2 * mm, profile=Straight(4 * mm)),
    "stack": STACK,
    "rod": Rod("steel", 6 * mm, 3 * mm),
}


def _unit() -> Unit:
    """Upwards: a neck on the frame, a block, a cased stack, a block with a lug to one side, a neck under the plate."""
    return Unit(
        bodies={
            "base": Body(solids={"block": Block("steel", (8 * mm, 9 * mm, 4 * mm), (0.0, 0.0, -20 * mm))}),
            "tip": Body(
                solids={
                    "block": Block("steel", (8 * mm, 9 * mm, 4 * mm), (0.0, 0.0, -6 * mm)),
                    "lug": Block("steel", (6 * mm, 4 * mm, 4 * mm), (7 * mm, 1 * mm, -6 * mm)),
                }
            ),
        },
        links={
            "back": Link(("frame", "base"), "back", (0.0, 0.0, -24 * mm), Z, bends=X),
            "pzt": Link(("base", "tip"), "stack", (0.0, 0.0, -13 * mm), Z),
            "front": Link(("tip", "platform"), "front", (0.0, 0.0, -2 * mm), Z, bends=Y),
        },
    )


def floating() -> Mechanism:
    """An elastic plate on three lifting units, turned by 20, 140 and 260 degrees, on a rigid frame that one rod mounts."""
    frame = Body(
        mass=0.2, centre=(1 * mm, 2 * mm, -30 * mm), inertia=Inertia(4e-5, 5e-5, 6e-5, 1e-5), reference=(3 * mm, -4 * mm, -35 * mm)
    )
    plate = Block("aluminium", (60 * mm, 50 * mm, 6 * mm), (2 * mm, 1 * mm, 3 * mm))
    return Mechanism(
        name="floating",
        materials={"steel": STEEL, "aluminium": ALUMINIUM},
        parts=PARTS,
        bodies={"platform": Body(solids={"plate": plate}, points={"corner": (30 * mm, 25 * mm, 6 * mm)}), "frame": frame},
        links={MOUNT: Link(("ground", "frame"), "rod", (0.0, 5 * mm, -40 * mm), Z)},
        units={"lift": _unit()},
        placements={"B1-B3": Placement("lift", Polar(15 * mm, 20 * deg, InstanceOrientation.TANGENT, 0.0))},
        payloads={"mirror": Payload("platform", 0.05, (5 * mm, 0.0, 10 * mm), Inertia(1e-6, 2e-6, 3e-6))},
        sensors={"probe": GAUGE},
        gauges={"S": Probe("probe", "platform", Pose((10 * mm, 0.0, 0.0), along=Z, up=X), SensorSense.OPENS, base="frame")},
    )


@cache
def read_floating() -> SolidRead:
    """The solid model of `floating`."""
    return read_solid(floating(), COARSE, solids(Ways(cache=None)))
