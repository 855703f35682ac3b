"""The double-triangular stage of Shin & Moon: three direct horizontal units inside, three lever-amplified vertical units outside.

The paper prints strokes, stiffnesses, hinge thicknesses and the amplification; radii, widths, masses and the modulus are not published. Two
parameter sets fill the gaps consistently: `SM_REF_A` for formulas (it cannot be built) and `SM_REF_B`, buildable, the shipped case.
Every value is tagged stated, derived or assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from flexstage.base.number import Number
from flexstage.base.scale import X, Y, Z, deg, kHz, mm, um
from flexstage.mechanism.mechanism import Link, Mechanism, ModalDamping, Opening, Placement, Probe, Unit
from flexstage.mechanism.pattern import Facing, Polar
from flexstage.parts.body import Block, Body
from flexstage.parts.freedom import ROTATIONS, Freedom
from flexstage.parts.gauge import Gauge, Positive
from flexstage.parts.material import Material
from flexstage.parts.neck import Neck
from flexstage.parts.notch import Notch
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Circular, Straight


@dataclass(frozen=True)
class DoubleTriangle:
    """Parameters of a double-triangular stage, SI.

    Horizontal units lie tangentially at `horizontal_radius`, `horizontal_height` above the stage's origin, their front necks at
    `front_offset` along the line of action, necks `horizontal_span` apart. Vertical units have their poles at `pole_radius`, the upper
    pole hinge at `pole_height`, the lower one `pole_span` below; `short_arm` r1, `long_arm` r2; their push is turned by `vertical_turn`
    from the tangent.
    """

    name: str
    neck: Neck
    front_offset: Number
    horizontal_span: Number
    horizontal_radius: Number
    horizontal_height: Number
    horizontal_stack: Piezo
    foot_notch: Notch
    lever_notch: Notch
    pole_neck: Neck
    vertical_stack: Piezo
    short_arm: Number
    long_arm: Number
    pole_span: Number
    pole_radius: Number
    pole_height: Number
    vertical_turn: Number
    back_distance: Number
    gauge_radius: Number
    gauge_height: Number
    platform_height: Number
    blocks: bool


STEEL = Material(
    young=200e9,
    poisson=0.3,
    density=7750.0,
    yield_stress=1360e6,
    expansion=10.3e-6,
    loss_factor=0.002,
    source="SUS420: yield stress from Shin & Moon 2.1; modulus, Poisson ratio, density assumed",
)


def _cased(outer: float, inner: float) -> float:
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
        bending_rigidity=_cased(18 * mm, 16 * mm),
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
        bending_rigidity=_cased(25 * mm, 22 * mm),
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
    platform_height=0.0,
    blocks=False,
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
    platform_height=105 * mm,
    blocks=True,
)


def double_triangle(parameters: DoubleTriangle = SM_REF_B) -> Mechanism:
    """The double-triangular stage as a description.

    >>> sorted(double_triangle().place)
    ['B1-B3', 'B4-B6']
    """
    p = parameters
    plate = Block("steel", size=(320 * mm, 320 * mm, 20 * mm), at=(0.0, 0.0, p.platform_height), hole=(110 * mm, 110 * mm))
    tangent = Polar(p.horizontal_radius, -90 * deg, Facing.TANGENT, p.horizontal_height)
    poles = Polar(p.pole_radius, 90 * deg, Facing.TANGENT, p.pole_height, turn=p.vertical_turn)
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
        bodies={"platform": Body(solids={"plate": plate})},
        units={"horizontal": _horizontal(p), "vertical": _vertical(p)},
        place={"B1-B3": Placement("horizontal", tangent), "B4-B6": Placement("vertical", poles)},
        sensors={"C36": Gauge(range=500 * um, resolution=0.01 * um, source="Lion Precision C36, Shin & Moon 2.1")},
        gauges=_gauges(p),
        damping=ModalDamping(0.01),
        envelope=(380 * mm, 380 * mm, 115 * mm),
        opening=Opening((110 * mm, 110 * mm)),
        mode_limit=1 * kHz,
        requirements=REQUIREMENTS,
        tags=_tags(p),
        sources=SOURCES,
    )


def _gauges(p: DoubleTriangle) -> dict[str, Probe]:
    level = Polar(p.gauge_radius, -90 * deg, Facing.TANGENT, p.gauge_height)
    upright = Polar(p.gauge_radius, 90 * deg, Facing.AXIS, p.gauge_height)
    return {
        "S1-S3": Probe("C36", "platform", level, Positive.OPENS),
        "S4-S6": Probe("C36", "platform", upright, Positive.OPENS),
    }


def _horizontal(p: DoubleTriangle) -> Unit:
    """x = push; origin on the line of action, nearest to the stage's axis."""
    back = p.front_offset - p.horizontal_span
    middle = p.front_offset - 0.5 * p.horizontal_span
    inset = 0.5 * (p.horizontal_span - p.horizontal_stack.length) - 4 * mm
    size = (8 * mm, 26 * mm, 24 * mm)
    base = Body(solids={"block": Block("steel", size, (back + inset, 0.0, 0.0))}) if p.blocks else Body()
    tip = Body(solids={"block": Block("steel", size, (p.front_offset - inset, 0.0, 0.0))}) if p.blocks else Body()
    return Unit(
        bodies={"base": base, "tip": tip},
        links={
            "back": Link(("ground", "base"), "neck", (back, 0.0, 0.0), X, bends=Y),
            "pzt": Link(("base", "tip"), "stack_horizontal", (middle, 0.0, 0.0), X),
            "front": Link(("tip", "platform"), "neck", (p.front_offset, 0.0, 0.0), X, bends=Y),
        },
    )


def _vertical(p: DoubleTriangle) -> Unit:
    """x = push; origin at the upper pole hinge; the stack, through the pole, turns the lever about the pivot below the front hinge."""
    bottom = -p.pole_span
    line = bottom + p.short_arm
    rear = p.long_arm - p.back_distance
    middle = p.long_arm - 0.5 * p.back_distance
    return Unit(
        bodies=_vertical_blocks(p, line) if p.blocks else {name: Body() for name in ("base", "tip", "lever", "pole")},
        links={
            "back": Link(("ground", "base"), "foot_notch", (rear, 0.0, line), X, bends=Y),
            "pzt": Link(("base", "tip"), "stack_vertical", (middle, 0.0, line), X),
            "front": Link(("tip", "lever"), "foot_notch", (p.long_arm, 0.0, line), X, bends=Y),
            "pivot": Link(("ground", "lever"), "lever_notch", (p.long_arm, 0.0, bottom), X, bends=Y),
            "lower": Link(("lever", "pole"), "pole_neck", (0.0, 0.0, bottom), Z, bends=Y),
            "upper": Link(("pole", "platform"), "pole_neck", (0.0, 0.0, 0.0), Z, bends=Y),
        },
    )


def _vertical_blocks(p: DoubleTriangle, line: Number) -> dict[str, Body]:
    """Blocks of a buildable unit: stack adapters, a lever of two cheeks astride the stack, a pole pierced by the stack (all assumed)."""
    adapter = (8 * mm, 26 * mm, 26 * mm)
    front, back = p.long_arm - 9 * mm, p.long_arm - p.back_distance + 9 * mm
    cheek = (93 * mm, 8 * mm, 35 * mm)
    lever = {
        "left": Block("steel", cheek, (36.5 * mm, 25 * mm, -p.pole_span)),
        "right": Block("steel", cheek, (36.5 * mm, -25 * mm, -p.pole_span)),
        "head": Block("steel", (12 * mm, 58 * mm, 50 * mm), (89 * mm, 0.0, line - 11 * mm)),
        "foot": Block("steel", (20 * mm, 42 * mm, 8 * mm), (0.0, 0.0, -p.pole_span - 12 * mm)),
    }
    pole = {
        "bottom": Block("steel", (20 * mm, 40 * mm, 4.5 * mm), (0.0, 0.0, line - 15.75 * mm)),
        "left": Block("steel", (20 * mm, 6.5 * mm, 27 * mm), (0.0, 16.75 * mm, line)),
        "right": Block("steel", (20 * mm, 6.5 * mm, 27 * mm), (0.0, -16.75 * mm, line)),
        "top": Block("steel", (20 * mm, 20 * mm, 12.5 * mm), (0.0, 0.0, line + 19.75 * mm)),
    }
    return {
        "base": Body(solids={"block": Block("steel", adapter, (back, 0.0, line))}),
        "tip": Body(solids={"block": Block("steel", adapter, (front, 0.0, line))}),
        "lever": Body(solids=lever),
        "pole": Body(solids=pole),
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
    return {key: f"stated {value}" for key, value in stated.items()} | dict.fromkeys(derived, "derived fit")
