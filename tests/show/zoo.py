"""A stage with one link of every kind that has no file of its own, and bodies of every shape: what pictures must be able to show."""

from __future__ import annotations

import numpy as np

from flexstage.base.units.scale import mm
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import Link, Mechanism, Probe
from flexstage.parts.amplified import Amplified, SteppingDrive
from flexstage.parts.body import Block, Body, Cylinder, Extrusion, Sphere
from flexstage.parts.cartwheel import Cartwheel
from flexstage.parts.contact import Contact
from flexstage.parts.cross_hinge import CrossHinge
from flexstage.parts.folded_leaf import FoldedLeaf
from flexstage.parts.gauge import Gauge, SensorSense
from flexstage.parts.leaf import Leaf
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.part import Part
from flexstage.parts.profile import Circular, Filleted
from flexstage.parts.reinforced_leaf import ReinforcedLeaf
from flexstage.parts.rod import Rod
from flexstage.parts.shear_piezo import ShearPiezo
from flexstage.parts.spring import Spring
from flexstage.parts.voice_coil import VoiceCoil

PARTS: dict[str, Part] = {
    "notch": Notch("steel", 1 * mm, 12 * mm, Circular(5 * mm)),
    "neck": Neck("steel", 2 * mm, Filleted(10 * mm, 2 * mm)),
    "leaf": Leaf("steel", 30 * mm, 0.5 * mm, 10 * mm),
    "reinforced": ReinforcedLeaf("steel", 40 * mm, 0.5 * mm, 10 * mm, flexure_length=8 * mm, reinforced_thickness=4 * mm),
    "rod": Rod("steel", 40 * mm, 2 * mm),
    "cross": CrossHinge("steel", 20 * mm, 0.4 * mm, 5 * mm, 6 * mm),
    "wheel": Cartwheel("steel", 24 * mm, 0.4 * mm, 8 * mm, 1.2, hub_diameter=4 * mm, hub_mass=0.01),
    "folded": FoldedLeaf("steel", 20 * mm, 0.4 * mm, 8 * mm),
    "coil": VoiceCoil(force_constant=10.0, mass=0.02),
    "spring": Spring(stiffness=1e4, length=20 * mm),
    "ball": Contact("steel", "steel", radius=5 * mm, preload=10.0),
    "shear": ShearPiezo(stroke=3e-6, stiffness=2e8, axial_stiffness=6e8, length=10 * mm, width=10 * mm, depth=10 * mm),
    "amplified": Amplified(stroke=1e-4, diagonal=(1e6, 1e6, 1e6, 100.0, 100.0, 100.0)),
    "stepper": SteppingDrive(travel=1e-3, diagonal=(1e6, 1e6, 1e6, 100.0, 100.0, 100.0)),
}


def zoo() -> Mechanism:
    """Links of all parts side by side between the ground and the platform, a gauge, and a sphere and an extrusion on the platform."""
    ell = ((0.0, 0.0), (0.04, 0.0), (0.04, 0.01), (0.01, 0.01), (0.01, 0.03), (0.0, 0.03))
    solids = {
        "block": Block("steel", (0.05, 0.4, 0.02), at=(0.06, 0.16, 0.0), hole=(0.01, 0.02)),
        "ball": Sphere("steel", 0.02, at=(0.06, 0.0, 0.02)),
        "ell": Extrusion("steel", ell, 0.01, at=(0.06, 0.2, 0.02)),
        "tube": Cylinder("steel", 0.02, 0.03, at=(0.06, 0.3, 0.03), bore=0.01),
    }
    links = {
        name: Link(("ground", "platform"), name, (0.0, 0.03 * place, 0.0), (1.0, 0.0, 0.0), bends=(0.0, 0.0, 1.0))
        for place, name in enumerate(PARTS)
    }
    return Mechanism(
        "a link of each kind",
        materials={"steel": Material(young=200e9, poisson=0.3, density=7750.0)},
        parts=PARTS,
        bodies={"platform": Body(solids=solids)},
        links=links,
        sensors={"probe": Gauge(range=100e-6)},
        gauges={"S": Probe("probe", "platform", Pose((0.1, 0.0, 0.0), (1.0, 0.0, 0.0)), positive=SensorSense.OPENS)},
    )


def many(count: int) -> Mechanism:
    """A plate on a square of wires."""
    side = int(np.ceil(np.sqrt(count)))
    places = [(0.01 * (number % side), 0.01 * (number // side), 0.0) for number in range(count)]
    links = {
        f"w{number}": Link(("ground", "platform"), "wire", place, (0.0, 0.0, 1.0), bends=(1.0, 0.0, 0.0))
        for number, place in enumerate(places)
    }
    extent = 0.01 * side
    return Mechanism(
        f"a plate on {count} wires",
        materials={"steel": Material(young=200e9, poisson=0.3, density=7750.0)},
        parts={"wire": Leaf("steel", 30 * mm, 1 * mm, 4 * mm)},
        bodies={"platform": Body(solids={"plate": Block("steel", (extent, extent, 0.005), at=(0.5 * extent, 0.5 * extent, 0.0175))})},
        links=links,
    )
