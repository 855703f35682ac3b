"""A bridge-amplified single-axis stage: one stack in a rhombus of four inclined arms, the platform on a parallelogram guide.

The stack spreads the two ends of the rhombus; its arms, inclined by a small angle alpha, turn that into cot(alpha) times as much motion
across, by which the platform is drawn towards the ground (a positive stroke moves it along -y). Eight leaf hinges, two an arm. A smaller
angle amplifies more until the arms' own axial compliance eats the gain; the amplified motion is soft (by the square of the gain) and
slow. Taken as ideal hinges about z (an override: a leaf by itself would also be free to shear and twist), the eight hinges hold the plane
many times over.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from flexstage.base.number import Number, Vector
from flexstage.base.units.quantity import ANGLE, LENGTH, POSITIVE
from flexstage.base.units.scale import X, Y, Z, deg, kHz, mm, nm, um
from flexstage.cases.stock import ALUMINIUM, GAUGE, SLIM_STACK, SOURCES, stock_tags
from flexstage.mechanism.assembly.pattern import Pose
from flexstage.mechanism.mechanism import Link, Mechanism, ModalDamping, Placement, Probe, Unit
from flexstage.parts.body import Block, Body
from flexstage.parts.freedom import Freedom
from flexstage.parts.gauge import SensorSense
from flexstage.parts.leaf import Leaf
from flexstage.parts.piezo import Piezo


@dataclass(frozen=True)
class Bridge:
    """Parameters of a bridge-amplified stage, SI.

    Each arm is a leaf, a rigid bar of length `bar`, and a leaf, in one line inclined by `angle` against the stack. Their outer ends lie
    at (+- `half_span`, +- `half_gap`), the stack between end blocks along x. The platform (`size`, on the upper arms) is guided along y
    by four `guide` leaves along x, `guide_spacing` apart.
    """

    leaf: Leaf = Leaf("aluminium", length=4 * mm, thickness=0.35 * mm, width=10 * mm)
    bar: Annotated[Number, LENGTH, POSITIVE] = 12 * mm
    angle: Annotated[Number, ANGLE] = 6 * deg
    half_span: Annotated[Number, LENGTH, POSITIVE] = 23 * mm
    half_gap: Annotated[Number, LENGTH, POSITIVE] = 4 * mm
    guide: Leaf = Leaf("aluminium", length=25 * mm, thickness=0.3 * mm, width=10 * mm)
    guide_spacing: Annotated[Number, LENGTH, POSITIVE] = 8 * mm
    size: Annotated[tuple[Number, Number, Number], LENGTH, POSITIVE] = (30 * mm, 12 * mm, 10 * mm)
    stack: Piezo = SLIM_STACK


def bridge(parameters: Bridge | None = None) -> Mechanism:
    """The bridge-amplified stage as a description.

    Mobility 1 (y), R_a = da/dy = -tan(alpha): both halves of the rhombus give cot(alpha) times half a stroke.

    >>> sorted(bridge().placements)
    ['LL', 'LR', 'UL', 'UR']
    """
    p = Bridge() if parameters is None else parameters
    arms = {f"{level}-{side}": (side, level) for level in ("upper", "lower") for side in ("left", "right")}
    top = _platform_height(p)
    return Mechanism(
        name="bridge",
        materials={"aluminium": ALUMINIUM},
        parts={"leaf": p.leaf, "guide": p.guide, "stack": p.stack},
        bodies={"platform": Body(solids={"block": Block("aluminium", p.size, (0.0, top, 0.0))}), "left": _end(p, -1), "right": _end(p, 1)},
        links={"pzt": Link(("left", "right"), "stack", (0.0, 0.0, 0.0), X), **_guides(p, top)},
        units={name: _arm(p, *ends) for name, ends in arms.items()},
        placements={_copy(name): Placement(name, _arm_pose(p, *ends)) for name, ends in arms.items()},
        sensors={"probe": replace(GAUGE, range=500 * um, resolution=1 * nm, source="capacitive gauge of 500 um range, typical")},
        gauges={"S": Probe("probe", "platform", Pose((0.0, top + 0.5 * p.size[1], 0.0), along=Y), SensorSense.OPENS)},
        damping=ModalDamping(0.01),
        envelope=(90 * mm, 50 * mm, 10 * mm),
        max_mode_frequency=5 * kHz,
        requirements={"stroke.y": "at least 160 um", "frequency.platform.1": "at least 150 Hz", "safety": "at least 2"},
        tags=stock_tags(("aluminium",), ("stack",), ("probe",)),
        sources=SOURCES,
    )


def _copy(unit: str) -> str:
    """The initials of a unit's name, UL for upper-left."""
    return "".join(word[0].upper() for word in unit.split("-"))


def _end(p: Bridge, side: int) -> Body:
    """End block between the stack and the outer ends of two arms."""
    inner = 0.5 * p.stack.length
    width = p.half_span - inner
    return Body(solids={"block": Block("aluminium", (width, 2.0 * p.half_gap, p.leaf.width), (side * (inner + 0.5 * width), 0.0, 0.0))})


def _platform_height(p: Bridge) -> Number:
    """Height of the platform's centre above the stack's axis: it stands on the inner ends of the upper arms."""
    return p.half_gap + (p.bar + 2.0 * p.leaf.length) * np.sin(p.angle) + 0.5 * p.size[1]


def _arm_pose(p: Bridge, side: str, level: str) -> Pose:
    """An arm's own x axis runs from its outer to its inner end."""
    right, up = (1 if side == "right" else -1), (1 if level == "upper" else -1)
    along = (-right * np.cos(p.angle), up * np.sin(p.angle), 0.0)
    return Pose((right * p.half_span, up * p.half_gap, 0.0), along, Z)


def _arm(p: Bridge, side: str, level: str) -> Unit:
    leaf, inner = p.leaf.length, "platform" if level == "upper" else "ground"
    bar = Block("aluminium", (p.bar, 10.0 * p.leaf.thickness, p.leaf.width), (leaf + 0.5 * p.bar, 0.0, 0.0))
    joints: dict[str, tuple[tuple[str, str], Vector]] = {
        "outer": ((side, "bar"), (0.5 * leaf, 0.0, 0.0)),
        "inner": (("bar", inner), (1.5 * leaf + p.bar, 0.0, 0.0)),
    }
    links = {name: Link(joins, "leaf", at, X, bends=Z, free=(Freedom.RZ,)) for name, (joins, at) in joints.items()}
    return Unit(bodies={"bar": Body(solids={"bar": bar})}, links=links)


def _guides(p: Bridge, top: Number) -> dict[str, Link]:
    reach = 0.5 * (p.size[0] + p.guide.length)
    places = {f"guide{number + 1}": (side, level) for number, (side, level) in enumerate([(-1, -1), (-1, 1), (1, -1), (1, 1)])}
    heights = {level: top + 0.5 * level * p.guide_spacing for level in (-1, 1)}
    return {
        name: Link(("ground", "platform"), "guide", (side * reach, heights[level], 0.0), (-1.0 * side, 0.0, 0.0), bends=Z)
        for name, (side, level) in places.items()
    }
