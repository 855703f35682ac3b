"""A parallel-kinematic XY stage: four carriages around a platform, each on its own parallelogram, two of them pushed by stacks.

A carriage slides along its own axis on two leaves and takes the platform along by two further leaves, which are stiff along that axis and
yield across it: x and y do not disturb one another, and both stacks stand on the ground. Opposite carriages make the stage symmetric, so
that heat expands it about its centre. The price is redundancy: out of the plane, and in yaw, the platform is held many times over.
Those constraints are listed by name; they must be met by accuracy of manufacture (one piece, cut by wire), else they show as stress.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.base.units.scale import X, Z, deg, kHz, mm
from flexstage.cases.stock import ALUMINIUM, GAUGE, SLIM_STACK, SOURCES, STEEL, stock_tags
from flexstage.cases.strut import Strut
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar, Pose
from flexstage.mechanism.mechanism import Link, Mechanism, ModalDamping, Placement, Probe, Unit
from flexstage.parts.body import Block, Body
from flexstage.parts.gauge import SensorSense
from flexstage.parts.leaf import Leaf
from flexstage.parts.neck import Neck
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular
from flexstage.parts.profile import length as hinge_length


@dataclass(frozen=True)
class XYStage:
    """Parameters of an XY stage, SI.

    The platform is a square block of edge `edge` and height `height`. In every carriage's own frame x points inward, towards the
    platform: two `coupling` leaves along x at y = +- `coupling_offset`, then the carriage, `carriage` = (along x, along y), held by two
    `guide` leaves along y at its two ends. `driven` says how many axes have stacks: 2, or 1 for a stage whose y axis floats
    (under-actuated). A carriage must be short enough for the guides of neighbours not to cross: half its length and a guide reach less far
    than the guides' own distance from the axis.
    """

    coupling: Leaf = Leaf("aluminium", length=20 * mm, thickness=0.6 * mm, width=15 * mm)
    guide: Leaf = Leaf("aluminium", length=25 * mm, thickness=0.6 * mm, width=15 * mm)
    neck: Neck = Neck("steel", thickness=2 * mm, profile=Circular(4 * mm))
    stack: Piezo = SLIM_STACK
    edge: Annotated[Number, LENGTH, POSITIVE] = 60 * mm
    height: Annotated[Number, LENGTH, POSITIVE] = 15 * mm
    coupling_offset: Annotated[Number, LENGTH, POSITIVE] = 20 * mm
    carriage: Annotated[tuple[Number, Number], LENGTH, POSITIVE] = (12 * mm, 46 * mm)
    driven: int = 2


def xy_stage(parameters: XYStage | None = None) -> Mechanism:
    """The XY stage as a description.

    Mobility 2 (x, y), R_a = da/d(x, y) = the unit matrix; the platform's other four freedoms are held four times over.

    >>> sorted(xy_stage().placements)
    ['A1-A2', 'P1-P2']
    """
    p = XYStage() if parameters is None else parameters
    pushed = Polar(0.0, 180 * deg, InstanceOrientation.INWARD, step=90 * deg)
    first = Placement("pushed", pushed) if p.driven == 2 else Placement("pushed", Pose())
    placed = {"A1-A2" if p.driven == 2 else "A1": first}
    free = Polar(0.0, 0.0 if p.driven == 2 else -90 * deg, InstanceOrientation.INWARD, step=90 * deg)
    placed["P1-P2" if p.driven == 2 else "P1-P3"] = Placement("following", free)
    return Mechanism(
        name="xy stage" if p.driven == 2 else "xy stage, y floating",
        materials={"aluminium": ALUMINIUM, "steel": STEEL},
        parts={"coupling": p.coupling, "guide": p.guide, "neck": p.neck, "stack": p.stack},
        bodies={"platform": _platform(p)},
        units={"pushed": _pushed_unit(p), "following": _following(p)},
        placements=placed,
        sensors={"probe": GAUGE},
        gauges={
            "S1-S2": Probe("probe", "platform", Polar(0.5 * p.edge, 0.0, InstanceOrientation.OUTWARD, step=90 * deg), SensorSense.OPENS)
        },
        damping=ModalDamping(0.01),
        envelope=(280 * mm, 280 * mm, 15 * mm),
        max_mode_frequency=5 * kHz,
        ground="aluminium",
        requirements=_requirements(p),
        tags=stock_tags(("aluminium", "steel"), ("stack",), ("probe",)),
        sources=SOURCES,
    )


def _requirements(p: XYStage) -> dict[str, str]:
    """With one stack only, no stroke is demanded: nothing determines where the platform goes."""
    strokes = {f"stroke.{axis}": "at least 18 um" for axis in ("x", "y")} if p.driven == 2 else {}
    return strokes | {"frequency.platform.1": "at least 150 Hz", "safety": "at least 2"}


def _platform(p: XYStage) -> Body:
    block = Block("aluminium", (p.edge, p.edge, p.height))
    return Body(solids={"block": block}, points={"sample": (0.0, 0.0, 0.5 * p.height)})


def _following(p: XYStage) -> Unit:
    """A carriage with its four leaves; x points from the carriage to the platform, the origin is the platform's centre."""
    middle = _middle(p)
    near = -0.5 * (p.edge + p.coupling.length)
    side = 0.5 * (p.carriage[1] + p.guide.length)
    ends = 0.5 * (p.carriage[0] - p.guide.thickness)
    links = {
        "left": Link(("carriage", "platform"), "coupling", (near, p.coupling_offset, 0.0), X, bends=Z),
        "right": Link(("carriage", "platform"), "coupling", (near, -p.coupling_offset, 0.0), X, bends=Z),
    }
    for name, sign, x in (("guide1", 1.0, -ends), ("guide2", 1.0, ends), ("guide3", -1.0, -ends), ("guide4", -1.0, ends)):
        links[name] = Link(("ground", "carriage"), "guide", (middle + x, sign * side, 0.0), (0.0, -sign, 0.0), bends=Z)
    block = Block("aluminium", (*p.carriage, p.height), (middle, 0.0, 0.0))
    return Unit(bodies={"carriage": Body(solids={"block": block})}, links=links)


def _pushed_unit(p: XYStage) -> Unit:
    """The same with a strut that pushes on the outer face of the carriage."""
    carriage = _following(p)
    head = (_middle(p) - 0.5 * (p.carriage[0] + hinge_length(p.neck.profile)), 0.0, 0.0)
    strut = Strut(head, X, p.neck, p.stack, "steel", 10 * mm)
    return Unit(bodies={**carriage.bodies, **strut.bodies()}, links={**carriage.links, **strut.links(("ground", "carriage"))})


def _middle(p: XYStage) -> Number:
    """Place of the carriage's centre along x."""
    return -0.5 * (p.edge + p.carriage[0]) - p.coupling.length
