"""The double-triangular stage of Shin & Moon: three direct horizontal units inside, three lever-amplified vertical units outside.

The paper prints strokes, stiffnesses, hinge thicknesses and the amplification; radii, widths, masses and the modulus are not published. Two
parameter sets fill the gaps consistently: `SM_REF_A` for formulas (it cannot be built) and `SM_REF_B`, buildable, the shipped case.
Every value is tagged stated, derived or assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum
from typing import Annotated

import numpy as np

from flexstage.base.number import Number, Vector
from flexstage.base.units.quantity import ANGLE, LENGTH, NOT_NEGATIVE, POSITIVE
from flexstage.base.units.scale import X, Y, Z, deg, kHz, mm, um
from flexstage.mechanism.assembly.pattern import InstanceOrientation, Polar
from flexstage.mechanism.mechanism import Aperture, Link, Mechanism, ModalDamping, Placement, Probe, Unit
from flexstage.parts.body import Block, Body, Cylinder, Solid
from flexstage.parts.freedom import ROTATIONS, Freedom
from flexstage.parts.gauge import Gauge, SensorSense
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular, Straight, length


class Bodies(Enum):
    """What the bodies but the plate are."""

    SOLID = "solid"
    MASSLESS = "massless"


@dataclass(frozen=True)
class Plate:
    """The platform's square plate: `side`, `thickness`, `height` of its middle; squares of side `corner` are cut from its corners."""

    side: Annotated[Number, LENGTH, POSITIVE]
    thickness: Annotated[Number, LENGTH, POSITIVE]
    height: Annotated[Number, LENGTH]
    corner: Annotated[Number, LENGTH, NOT_NEGATIVE] = 0.0


@dataclass(frozen=True)
class DoubleTriangle:
    """Parameters of a double-triangular stage, SI.

    Horizontal units lie tangentially at `horizontal_radius`, `horizontal_height` above the stage's origin, their front necks at
    `front_offset` along the line of action, necks `horizontal_span` apart. Vertical units have their poles at `pole_radius`, the upper
    pole hinge at `pole_height`, the lower one `pole_span` below; `short_arm` r1, `long_arm` r2; their push is turned by `vertical_turn`
    from the tangent. `bodies`: solids that touch where links join them, or massless ones but for the plate.
    """

    name: str
    neck: Neck
    front_offset: Annotated[Number, LENGTH]
    horizontal_span: Annotated[Number, LENGTH, POSITIVE]
    horizontal_radius: Annotated[Number, LENGTH, POSITIVE]
    horizontal_height: Annotated[Number, LENGTH]
    horizontal_stack: Piezo
    foot_notch: Notch
    lever_notch: Notch
    pole_neck: Neck
    vertical_stack: Piezo
    short_arm: Annotated[Number, LENGTH, POSITIVE]
    long_arm: Annotated[Number, LENGTH, POSITIVE]
    pole_span: Annotated[Number, LENGTH, POSITIVE]
    pole_radius: Annotated[Number, LENGTH, POSITIVE]
    pole_height: Annotated[Number, LENGTH]
    vertical_turn: Annotated[Number, ANGLE]
    back_distance: Annotated[Number, LENGTH, POSITIVE]
    gauge_radius: Annotated[Number, LENGTH, POSITIVE]
    gauge_height: Annotated[Number, LENGTH]
    plate: Plate
    bodies: Bodies
    fit: str = "fit"


STEEL = Material(
    young=200e9,
    poisson=0.3,
    density=7750.0,
    yield_stress=1360e6,
    expansion=10.3e-6,
    loss_factor=0.002,
    source="SUS420: yield stress from Shin & Moon 2.1; modulus, Poisson ratio, density assumed",
)


def _casing_rigidity(outer: float, inner: float) -> float:
    """Bending rigidity of a steel casing tube [N m^2]."""
    return round(200e9 * math.pi / 64.0 * (outer**4 - inner**4), 1)


def _stack_mass(diameter: float, outer: float, inner: float, length: float) -> float:
    ceramic = 7800.0 * math.pi / 4.0 * diameter**2 * length
    return round(ceramic + 7850.0 * math.pi / 4.0 * (outer**2 - inner**2) * length, 4)


def _horizontal_stack(length: float) -> Piezo:
    return Piezo(
        stroke=150 * um,
        stiffness=17e6,
        length=length,
        diameter=10 * mm,
        mass=_stack_mass(10 * mm, 18 * mm, 16 * mm, length),
        bending_rigidity=_casing_rigidity(18 * mm, 16 * mm),
        maximum_load=5000.0,
        tensile_limit=500.0,
        resonance=5 * kHz,
        voltage_low=0.0,
        voltage_high=1000.0,
        bias=500.0,
        capacitance=0.4e-6,
        expansion=-3e-6,
        loss_factor=0.02,
        source="PSt 1000/10/150 VS18",
    )


def _vertical_stack(length: float) -> Piezo:
    return Piezo(
        stroke=200 * um,
        stiffness=35e6,
        length=length,
        diameter=16 * mm,
        mass=_stack_mass(16 * mm, 25 * mm, 22 * mm, length),
        bending_rigidity=_casing_rigidity(25 * mm, 22 * mm),
        maximum_load=15000.0,
        tensile_limit=1500.0,
        resonance=4 * kHz,
        voltage_low=0.0,
        voltage_high=1000.0,
        bias=500.0,
        capacitance=1.3e-6,
        expansion=-3e-6,
        loss_factor=0.02,
        source="PSt 1000/16/200 VS25",
    )


SM_REF_A = DoubleTriangle(
    name="double triangle, SM-REF-A (calculation set)",
    neck=Neck("steel", thickness=1.54 * mm, profile=Circular(14.367 * mm)),
    front_offset=0.0,
    horizontal_span=141.7 * mm,
    horizontal_radius=85 * mm,
    horizontal_height=0.0,
    horizontal_stack=_horizontal_stack(125.7 * mm),
    foot_notch=Notch("steel", thickness=0.85 * mm, width=11 * mm, profile=Circular(5 * mm)),
    lever_notch=Notch("steel", thickness=1.0 * mm, width=60 * mm, profile=Circular(5 * mm)),
    pole_neck=Neck("steel", thickness=2.37 * mm, profile=Circular(14.367 * mm)),
    vertical_stack=_vertical_stack(201 * mm),
    short_arm=22.6 * mm,
    long_arm=67.8 * mm,
    pole_span=60 * mm,
    pole_radius=130 * mm,
    pole_height=0.0,
    vertical_turn=0.0,
    back_distance=227 * mm,
    gauge_radius=150 * mm,
    gauge_height=0.0,
    plate=Plate(320 * mm, 20 * mm, 0.0),
    bodies=Bodies.MASSLESS,
)

SM_REF_B = DoubleTriangle(
    name="double triangle",
    neck=Neck("steel", thickness=1.54 * mm, width=2.246 * mm, profile=Straight(13.235 * mm)),
    front_offset=95.6175 * mm,
    horizontal_span=191.235 * mm,
    horizontal_radius=85 * mm,
    horizontal_height=80 * mm,
    horizontal_stack=_horizontal_stack(162 * mm),
    foot_notch=Notch("steel", thickness=0.85 * mm, width=14.9 * mm, profile=Circular(5 * mm)),
    lever_notch=Notch("steel", thickness=1.0 * mm, width=50.3 * mm, profile=Circular(2 * mm)),
    pole_neck=Neck("steel", thickness=2.37 * mm, profile=Circular(8 * mm)),
    vertical_stack=_vertical_stack(201 * mm),
    short_arm=26 * mm,
    long_arm=78 * mm,
    pole_span=60 * mm,
    pole_radius=120 * mm,
    pole_height=80 * mm,
    vertical_turn=-math.asin(33.5 / 120.0),
    back_distance=227 * mm,
    gauge_radius=130 * mm,
    gauge_height=80 * mm,
    plate=Plate(side=340.64498 * mm, thickness=18.96433 * mm, height=105.21508 * mm, corner=49.91874 * mm),
    bodies=Bodies.SOLID,
)

SM_REF_B_REFITTED = replace(
    SM_REF_B,
    name="double triangle, refitted to FEA",
    neck=replace(SM_REF_B.neck, profile=Straight(12.13 * mm)),
    front_offset=95.065 * mm,
    horizontal_span=190.13 * mm,
    lever_notch=replace(SM_REF_B.lever_notch, width=47.5 * mm),
    fit="refit",
)
"""SM-REF-B with the neck's length and the lever notch's width fitted by the solid model instead of beam theory.

So that a unit alone, as a solid, has the paper's K_a,h = 10.30 N/um and the 581.3 um of 600 um of Table 2's FEA.
"""


def double_triangle(parameters: DoubleTriangle = SM_REF_B) -> Mechanism:
    """The double-triangular stage as a description.

    >>> sorted(double_triangle().placements)
    ['B1-B3', 'B4-B6']
    """
    p = parameters
    tangent = Polar(p.horizontal_radius, -90 * deg, InstanceOrientation.TANGENT, p.horizontal_height)
    poles = Polar(p.pole_radius, 90 * deg, InstanceOrientation.TANGENT, p.pole_height, turn=p.vertical_turn)
    return Mechanism(
        name=p.name,
        materials={"steel": STEEL},
        parts={
            "neck": p.neck,
            "stack_horizontal": p.horizontal_stack,
            "foot_notch": p.foot_notch,
            "lever_notch": p.lever_notch,
            "pole_neck": p.pole_neck,
            "stack_vertical": p.vertical_stack,
        },
        bodies={"platform": Body(solids=_plate(p.plate))},
        units={"horizontal": _horizontal(p), "vertical": _vertical(p)},
        placements={"B1-B3": Placement("horizontal", tangent), "B4-B6": Placement("vertical", poles)},
        sensors={"C36": Gauge(range=500 * um, resolution=0.01 * um, source="Lion Precision C36, Shin & Moon 2.1")},
        gauges=_gauges(p),
        damping=ModalDamping(0.01),
        envelope=(380 * mm, 380 * mm, 115 * mm),
        opening=Aperture((110 * mm, 110 * mm)),
        max_mode_frequency=1 * kHz,
        requirements=REQUIREMENTS,
        tags=_tags(p),
        sources=SOURCES,
    )


def _plate(plate: Plate) -> dict[str, Block]:
    """The plate with its hole, in three pieces where its corners are cut off."""
    opening = (110 * mm, 110 * mm)
    if not np.any(plate.corner):
        return {"plate": Block("steel", (plate.side, plate.side, plate.thickness), (0.0, 0.0, plate.height), opening)}
    across = plate.side - 2.0 * plate.corner
    strip, reach = (across, plate.corner, plate.thickness), 0.5 * (plate.side - plate.corner)
    return {
        "plate": Block("steel", (plate.side, across, plate.thickness), (0.0, 0.0, plate.height), opening),
        "left": Block("steel", strip, (0.0, reach, plate.height)),
        "right": Block("steel", strip, (0.0, -reach, plate.height)),
    }


def _gauges(p: DoubleTriangle) -> dict[str, Probe]:
    level = Polar(p.gauge_radius, -90 * deg, InstanceOrientation.TANGENT, p.gauge_height)
    upright = Polar(p.gauge_radius, 90 * deg, InstanceOrientation.AXIS, p.gauge_height)
    return {
        "S1-S3": Probe("C36", "platform", level, SensorSense.OPENS),
        "S4-S6": Probe("C36", "platform", upright, SensorSense.OPENS),
    }


def _horizontal(p: DoubleTriangle) -> Unit:
    """x = push; origin on the line of action, nearest to the stage's axis."""
    back = p.front_offset - p.horizontal_span
    middle = p.front_offset - 0.5 * p.horizontal_span
    return Unit(
        bodies=_horizontal_blocks(p) if p.bodies is Bodies.SOLID else {"base": Body(), "tip": Body()},
        links={
            "back": Link(("ground", "base"), "neck", (back, 0.0, 0.0), X, bends=Y),
            "pzt": Link(("base", "tip"), "stack_horizontal", (middle, 0.0, 0.0), X),
            "front": Link(("tip", "platform"), "neck", (p.front_offset, 0.0, 0.0), X, bends=Y),
        },
    )


def _horizontal_blocks(p: DoubleTriangle) -> dict[str, Body]:
    """Adapters between stack and necks, and the platform's lug that the front neck ends on (all assumed)."""
    half = 0.5 * length(p.neck.profile)
    tip = 0.5 * (p.horizontal_span - p.horizontal_stack.length) - half
    middle = p.front_offset - 0.5 * p.horizontal_span
    reach = 0.5 * (p.horizontal_stack.length + tip)
    under = p.plate.height - 0.5 * p.plate.thickness - p.horizontal_height
    return {
        "base": Body(solids={"block": Block("steel", (tip, 26 * mm, 24 * mm), (middle - reach, 0.0, 0.0))}),
        "tip": Body(solids={"block": Block("steel", (tip, 26 * mm, 24 * mm), (middle + reach, 0.0, 0.0))}),
        "lug": Body(solids=_lug(p.front_offset + half, under), of="platform"),
    }


def _lug(face: Number, under: Number) -> dict[str, Block]:
    """A nose for the neck and a longer root under the plate."""
    step = 4 * mm
    return {
        "nose": _between((face, -6 * mm, -3 * mm), (face + 16 * mm, 6 * mm, step)),
        "root": _between((face, -7 * mm, step), (face + 24 * mm, 7 * mm, under)),
    }


def _between(low: Vector, high: Vector) -> Block:
    """The steel block between two opposite corners."""
    size = tuple(end - start for start, end in zip(low, high, strict=True))
    middle = tuple(0.5 * (start + end) for start, end in zip(low, high, strict=True))
    return Block("steel", size, middle)  # type: ignore[arg-type]


def _vertical(p: DoubleTriangle) -> Unit:
    """x = push; origin at the upper pole hinge; the stack, through the pole, turns the lever about the pivot below the front hinge."""
    bottom = -p.pole_span
    line = bottom + p.short_arm
    rear = p.long_arm - p.back_distance
    middle = p.long_arm - 0.5 * p.back_distance
    return Unit(
        bodies=_vertical_blocks(p) if p.bodies is Bodies.SOLID else {name: Body() for name in ("base", "tip", "lever", "pole")},
        links={
            "back": Link(("ground", "base"), "foot_notch", (rear, 0.0, line), X, bends=Y),
            "pzt": Link(("base", "tip"), "stack_vertical", (middle, 0.0, line), X),
            "front": Link(("tip", "lever"), "foot_notch", (p.long_arm, 0.0, line), X, bends=Y),
            "pivot": Link(("lever", "ground"), "lever_notch", (p.long_arm, 0.0, bottom), X, bends=Y),
            "lower": Link(("lever", "pole"), "pole_neck", (0.0, 0.0, bottom), Z, bends=Y),
            "upper": Link(("pole", "platform"), "pole_neck", (0.0, 0.0, 0.0), Z, bends=Y),
        },
    )


def _vertical_blocks(p: DoubleTriangle) -> dict[str, Body]:
    """Blocks of a buildable unit: stack adapters, a lever astride the stack, a pole around the stack, the platform's pad (all assumed)."""
    line = p.short_arm - p.pole_span
    half = 0.5 * length(p.foot_notch.profile)
    tip = 0.5 * (p.back_distance - p.vertical_stack.length) - half
    middle = p.long_arm - 0.5 * p.back_distance
    reach = 0.5 * (p.vertical_stack.length + tip)
    adapter = (tip, 26 * mm, 26 * mm)
    neck = 0.5 * length(p.pole_neck.profile)
    under = p.plate.height - 0.5 * p.plate.thickness - p.pole_height
    return {
        "base": Body(solids={"block": Block("steel", adapter, (middle - reach, 0.0, line))}),
        "tip": Body(solids={"block": Block("steel", adapter, (middle + reach, 0.0, line))}),
        "lever": Body(solids=_lever(p, line)),
        "pole": Body(solids=_pole(line, neck - p.pole_span, -neck)),
        "pad": Body(solids={"disc": _upright(neck, under)}, of="platform"),
    }


def _lever(p: DoubleTriangle, line: Number) -> dict[str, Block]:
    """Two cheeks astride the stack and the pole, deep near the pivot; they stand on a saddle that the pivot's notch ends on.

    Ears lead past the pivot to the head under the front hinge, above the pivot's foot on the ground; a foot under the pole joins the tips.
    """
    face = p.long_arm - 0.5 * length(p.lever_notch.profile)
    front = p.long_arm + 0.5 * length(p.foot_notch.profile)
    sole, seat = -p.pole_span - 18 * mm, -p.pole_span - 0.5 * length(p.pole_neck.profile)
    saddle, step, end, low, top = face - 14 * mm, 24 * mm, front + 16 * mm, line - 15 * mm, line + 18 * mm
    ear, inner, outer = 15 * mm, 21 * mm, 29 * mm
    solids = {
        "saddle": _between((saddle, -outer, sole), (face, outer, low)),
        "head": _between((front, -ear, line - 20 * mm), (end, ear, top)),
        "foot": _between((-14 * mm, -inner, sole), (14 * mm, inner, seat)),
    }
    for side in ("left", "right"):
        near, far = _beside(side, inner, outer)
        solids |= {
            side: _between((step, near, sole), (saddle, far, top)),
            f"{side}_tip": _between((-14 * mm, near, sole), (step, far, line - 12 * mm)),
        }
        near, far = _beside(side, ear, outer)
        solids[f"{side}_ear"] = _between((saddle, near, low), (end, far, top))
    return solids


def _beside(side: str, inner: Number, outer: Number) -> tuple[Number, Number]:
    """From low to high y on one side of the unit's line."""
    return (inner, outer) if side == "left" else (-outer, -inner)


def _upright(bottom: Number, top: Number) -> Cylinder:
    """A disc around the pole's axis that a pole neck ends on."""
    return Cylinder("steel", 21 * mm, top - bottom, (0.0, 0.0, 0.5 * (bottom + top)))


def _pole(line: Number, bottom: Number, top: Number) -> dict[str, Solid]:
    """A frame around the stack, and a seat that stays clear of the inner units, between the heights of the necks' ends."""
    wide, deep, bore = 20 * mm, 13 * mm, 13.5 * mm
    return {
        "bottom": _between((-deep, -wide, bottom), (deep, wide, line - bore)),
        "left": _between((-deep, bore, line - bore), (deep, wide, line + bore)),
        "right": _between((-deep, -wide, line - bore), (deep, -bore, line + bore)),
        "top": _between((-deep, -wide, line + bore), (deep, wide, top - 4.5 * mm)),
        "seat": _upright(top - 4.5 * mm, top),
    }


EQUATION_3: dict[str, tuple[tuple[Freedom, ...], tuple[Freedom, ...]]] = {
    "foot_notch": ((Freedom.X,), (Freedom.RZ,)),
    "lever_notch": ((Freedom.RZ,), ()),
    "pole_neck": ((Freedom.X,), ROTATIONS),
    "stack_vertical": ((Freedom.X,), ()),
}
"""What Eq. 3 of the paper knows of a vertical unit: (elastic, free) freedoms of each part, the rest locked."""

TABLE_2_FEA = EQUATION_3 | {"foot_notch": ((Freedom.X, Freedom.RZ), ()), "pole_neck": ((Freedom.X, Freedom.RY, Freedom.RZ), (Freedom.RX,))}
"""Eq. 3 with the bending of front and pole hinges added, which closes the gap to the FEA column of Table 2."""

EQUATION_18 = EQUATION_3 | {"neck": ((Freedom.X,), ROTATIONS), "stack_horizontal": ((Freedom.X,), ())}
"""What Eq. 18 of the paper knows of the whole stage: axial springs and lever pivots."""

SOURCES = {
    "paper": "Shin & Moon, Static and Dynamic Analyses of a 6-DOF Ultra-Precision Parallel Mechanism",
    "fit": "derived from the paper's unit stiffnesses, Table 2 and the stacks' lengths",
    "refit": "derived as before, but with units read as solids instead of by beam theory",
    "trim": "the plate is trimmed so that with lugs and pads it has mass, inertia and centre of one of 320 x 320 x 20 mm at 105 mm height",
    "layout": "a layout that fits 380 x 380 x 115 mm, chosen here",
}

REQUIREMENTS = {
    "stroke.x": "at least 50 um",
    "stroke.y": "at least 50 um",
    "stroke.z": "at least 150 um",
    "stroke.rx": "at least 733 urad",
    "stroke.ry": "at least 733 urad",
    "stroke.rz": "at least 244 urad",
    "frequency.platform.1": "at least 100 Hz",
    "safety": "at least 2",
}


def _tags(p: DoubleTriangle) -> dict[str, str]:
    stated = {
        "materials.steel.yield_stress": "paper 2.1",
        "parts.neck.thickness": "paper 2.2",
        "parts.foot_notch.thickness": "paper 2.2",
        "parts.lever_notch.thickness": "paper 2.2",
        "parts.pole_neck.thickness": "paper 2.2",
        "sensors.C36.range": "paper 2.1",
        "sensors.C36.resolution": "paper 2.1",
        "envelope": "paper 2.1",
    }
    for stack in ("stack_horizontal", "stack_vertical"):
        stated |= {f"parts.{stack}.{name}": "paper 2.1" for name in ("stroke", "stiffness", "maximum_load", "resonance")}
    profile = "radius" if isinstance(p.neck.profile, Circular) else "length"
    derived = [f"parts.neck.profile.{profile}", "parts.foot_notch.width", "parts.lever_notch.width", "parts.pole_neck.profile.radius"]
    derived += ["parts.neck.width"] if p.neck.width is not None else []
    derived += ["units.horizontal.links.back.at", "units.vertical.links.front.at", "units.vertical.links.pivot.at"]
    derived += ["parts.stack_horizontal.length", "parts.stack_vertical.length"]
    solid = _plate(p.plate) if p.bodies is Bodies.SOLID else {}
    trimmed = [f"bodies.platform.solids.{name}.{field}" for name in solid for field in ("size", "at")]
    return (
        {key: f"stated {value}" for key, value in stated.items()}
        | dict.fromkeys(derived, f"derived {p.fit}")
        | dict.fromkeys(trimmed, "derived trim")
    )
