"""A single-axis stage of long travel: a platform between two double parallelograms, pushed by a voice coil.

Each double parallelogram folds back on itself: what its inner leaves shorten the platform's height by as they bend, its outer leaves make
up for, so that the platform runs straight and no leaf is stretched. The price is the bar between them, which nothing holds along the
motion but the leaves' own stiffness: its mode is among the lowest. The coil has no stiffness of its own, so that the leaves' is the
stage's, and holding a position takes current and makes heat. Of the type of flexure-guided voice coil stages; all values are assumed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from flexstage.base.number import Number
from flexstage.base.units.quantity import LENGTH, POSITIVE
from flexstage.base.units.scale import X, Z, deg, kHz, mm
from flexstage.cases.stock import ALUMINIUM, COIL, SCALE, SOURCES, STEEL, stock_tags
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar, Pose
from flexstage.mechanism.mechanism import GROUND, PLATFORM, Link, Mechanism, ModalDamping, Placement, Probe, Unit
from flexstage.parts.body import Block, Body
from flexstage.parts.leaf import Leaf
from flexstage.parts.voice_coil import VoiceCoil


@dataclass(frozen=True)
class VoiceCoilStage:
    """Parameters of a voice coil stage, SI.

    The platform is a block of edges `size` that moves along x. On each of its faces across y stand two leaves, `inner` apart; they end on
    a bar of height `bar`, from whose ends two more, `outer` apart, run back to the ground. The coil pushes on the middle of the -x face.
    """

    leaf: Leaf = Leaf("steel", length=50 * mm, thickness=0.3 * mm, width=25 * mm)
    coil: VoiceCoil = COIL
    size: Annotated[tuple[Number, Number, Number], LENGTH, POSITIVE] = (60 * mm, 50 * mm, 25 * mm)
    inner: Annotated[Number, LENGTH, POSITIVE] = 50 * mm
    outer: Annotated[Number, LENGTH, POSITIVE] = 80 * mm
    bar: Annotated[Number, LENGTH, POSITIVE] = 10 * mm


def voice_coil_stage(parameters: VoiceCoilStage | None = None) -> Mechanism:
    """The voice coil stage as a description.

    Mobility 1 (x); the force map is k_f along x, the stiffness 24 E I / L^3 as of two leaves, and each bar floats along x.

    >>> sorted(voice_coil_stage().placements)
    ['G1-G2']
    """
    p = VoiceCoilStage() if parameters is None else parameters
    end = 0.5 * p.size[0]
    return Mechanism(
        name="voice coil stage",
        materials={"aluminium": ALUMINIUM, "steel": STEEL},
        parts={"leaf": p.leaf, "coil": p.coil},
        bodies={PLATFORM: Body(solids={"block": Block("aluminium", p.size)}, points={"sample": (0.0, 0.0, 0.5 * p.size[2])})},
        links={"motor": Link((GROUND, PLATFORM), "coil", (-end, 0.0, 0.0), X)},
        units={"guide": _guide(p)},
        placements={"G1-G2": Placement("guide", Polar(0.5 * p.size[1], 90 * deg, InstanceOrientation.OUTWARD))},
        sensors={"scale": SCALE},
        gauges={"S": Probe("scale", PLATFORM, Pose((end, 0.0, 0.0), along=X))},
        damping=ModalDamping(0.01),
        envelope=(160 * mm, 180 * mm, 25 * mm),
        max_mode_frequency=2 * kHz,
        ground="aluminium",
        requirements=REQUIREMENTS,
        tags=stock_tags(("aluminium", "steel"), (), ()),
        sources=SOURCES,
    )


REQUIREMENTS = {"stroke.x": "at least 2 mm", "heating.x": "at most 15 K", "frequency.platform.1": "at least 8 Hz", "safety": "at least 2"}


def _guide(p: VoiceCoilStage) -> Unit:
    """A double parallelogram: x points away from the platform, from the face of which it stands."""
    length, half = p.leaf.length, 0.5 * (p.outer + p.leaf.thickness)
    block = Block("aluminium", (p.bar, 2.0 * half, p.leaf.width), (length + 0.5 * p.bar, 0.0, 0.0))
    feet = {"inner": (PLATFORM, 0.5 * p.inner), "outer": (GROUND, 0.5 * p.outer)}
    links = {
        f"{name}_{side}": Link((foot, "bar"), "leaf", (0.5 * length, sign * place, 0.0), X, bends=Z)
        for name, (foot, place) in feet.items()
        for side, sign in (("left", 1.0), ("right", -1.0))
    }
    return Unit(bodies={"bar": Body(solids={"block": block})}, links=links)
