"""A single-axis stage: a platform on a parallelogram of leaf springs, pushed by one stack.

Two (or more) equal leaves side by side let the platform move across them and hold everything else. The stack pushes through a strut with
a neck at each end, so that it neither bends nor twists the guide. What a designer trades: thick short leaves stiffen the other axes and
raise the frequencies, thin long ones take less of the stroke. The line of push through the middle of the leaves would turn the platform
least; here it passes through the platform itself, which is easier to build: the yaw this costs is listed as parasitic motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.base.units.scale import X, Z, kHz, mm
from flexstage.cases.stock import ALUMINIUM, GAUGE, SLIM_STACK, SOURCES, STEEL, stock_tags
from flexstage.cases.strut import Strut
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import Link, Mechanism, ModalDamping, Placement, Probe
from flexstage.parts.body import Block, Body
from flexstage.parts.gauge import SensorSense
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular
from flexstage.parts.profile import length as hinge_length


@dataclass(frozen=True)
class Parallelogram:
    """Parameters of a parallelogram stage, SI.

    The platform is a block of edges `size` centred at the origin and moves along x; two leaves stand on its +y face, `spacing` apart; the
    stack pushes on its -x face, `push_offset` towards +y from the middle.
    """

    leaf: Leaf = Leaf("aluminium", length=25 * mm, thickness=1.0 * mm, width=25 * mm)
    neck: Neck = Neck("steel", thickness=2 * mm, profile=Circular(4 * mm))
    stack: Piezo = SLIM_STACK
    size: Annotated[tuple[Number, Number, Number], LENGTH, POSITIVE] = (60 * mm, 40 * mm, 25 * mm)
    spacing: Annotated[Number, LENGTH, POSITIVE] = 50 * mm
    push_offset: Annotated[Number, LENGTH] = 0.0


def parallelogram(parameters: Parallelogram | None = None) -> Mechanism:
    """The parallelogram stage as a description.

    Mobility 1 (x), one stack, R_a = da/dx = 1; leaves of one pair hold rx twice: one redundant constraint.

    >>> sorted(parallelogram().links)
    ['left', 'right']
    """
    p = Parallelogram() if parameters is None else parameters
    head = (-0.5 * p.size[0] - 0.5 * hinge_length(p.neck.profile), p.push_offset, 0.0)
    strut = Strut(head, X, p.neck, p.stack, "steel", 10 * mm)
    return Mechanism(
        name="parallelogram",
        materials={"aluminium": ALUMINIUM, "steel": STEEL},
        parts={"leaf": p.leaf, "neck": p.neck, "stack": p.stack},
        bodies={"platform": Body(solids={"block": Block("aluminium", p.size)}, points={"corner": _corner(p)})},
        links={name: _leaf(p, side) for name, side in (("left", -0.5), ("right", 0.5))},
        units={"drive": strut.unit()},
        placements={"B": Placement("drive", Pose())},
        sensors={"probe": GAUGE},
        gauges={"S": Probe("probe", "platform", Pose((0.5 * p.size[0], 0.0, 0.0), along=X), SensorSense.OPENS)},
        damping=ModalDamping(0.01),
        envelope=(160 * mm, 80 * mm, 25 * mm),
        max_mode_frequency=10 * kHz,
        ground="aluminium",
        requirements={"stroke.x": "at least 18 um", "frequency.platform.1": "at least 500 Hz", "safety": "at least 2"},
        tags=stock_tags(("aluminium", "steel"), ("stack",), ("probe",)),
        sources=SOURCES,
    )


def _corner(p: Parallelogram) -> tuple[Number, Number, Number]:
    return (0.5 * p.size[0], -0.5 * p.size[1], 0.5 * p.size[2])


def _leaf(p: Parallelogram, side: float) -> Link:
    """A leaf along y, thin along x: its own x axis points from the ground to the platform, it bends about z."""
    return Link(("ground", "platform"), "leaf", (side * p.spacing, 0.5 * (p.size[1] + p.leaf.length), 0.0), (0.0, -1.0, 0.0), bends=Z)
