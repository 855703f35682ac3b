"""Small assemblies of leaves with closed forms of their own: a cross-axis pivot and a bridge amplifier."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import cast

import numpy as np

import flexstage as fs
from flexstage.cases.registry import case
from flexstage.models.linear.static import static_gain
from tools.validation.row import Row, Section, Tolerance, relative

_SLENDER = 1e-4


def sections() -> list[Section]:
    """The sections on assemblies."""
    return [_pivot(), _bridge()]


def cross_axis_pivot(crossing: float, angle: float = 45 * fs.deg, width: float = 1e-3, poisson: float = 0.0) -> float:
    """Rotational stiffness in units of E I/L of two leaves that cross at `crossing` of their length, each `angle` off the symmetry axis.

    They are beams without plate action.
    """
    length = 1.0
    thickness = _SLENDER * length
    leaf = fs.Leaf("soft", length, thickness, width, fs.LeafSection.BEAM)
    directions = {"left": (math.cos(angle), math.sin(angle), 0.0), "right": (math.cos(angle), -math.sin(angle), 0.0)}
    arm = (0.5 - crossing) * length
    links = {
        name: fs.Link(("ground", "platform"), "leaf", (arm * way[0], arm * way[1], 0.0), way, bends=fs.Z)
        for name, way in directions.items()
    }
    pivot = fs.Mechanism(
        "pivot",
        materials={"soft": fs.Material(young=1e12, poisson=poisson, density=1.0)},
        parts={"leaf": leaf},
        bodies={"platform": fs.Body(mass=1.0, reference=(0.0, 0.0, 0.0))},
        links=links,
    )
    turned = fs.statics(fs.lumped(pivot)).compliance.at("platform.rz", "platform.mz")
    return 1.0 / float(turned) / (1e12 * width * thickness**3 / 12.0 / length)


def _pivot() -> Section:
    closed = {part: f"{8.0 * (3.0 * part * part - 3.0 * part + 1.0):.6g}" for part in (0.0, 0.12732, 0.25, 0.5, 1.0)}
    rows = tuple(
        Row(f"crossing at {part}{what}", "Wittrick 1951", value, cross_axis_pivot(part, **sizes), "EI/L", relative(1e-6))
        for part, value in closed.items()
        for what, sizes in (("", {}), (", b = L, nu = 0.3", {"width": 1.0, "poisson": 0.3}))
    )
    text = (
        "Rotational stiffness of a cross-axis pivot without load, K = 8 (EI/L)(3 lambda^2 - 3 lambda + 1), from two leaves and the "
        'lumped model (t/L = 1e-4, section = "beam": as plates wide leaves are stiffer). The load term and the shift of the centre are '
        "nonlinear: no model here knows them."
    )
    return Section("Cross-axis pivot", text, rows)


def _amplifier(angle: float, *, slender: bool) -> fs.Mechanism:
    """The worked bridge without guide stiffness; `slender`: its leaves are given by Euler and Bernoulli instead of our leaf."""
    sizes = {"leaf": 5 * fs.mm, "leaf_thickness": 0.5 * fs.mm, "rod": 20 * fs.mm, "half_span": 40 * fs.mm}
    stage = case("bridge", {**sizes, "angle": angle})
    leaf = cast("fs.Leaf", stage.parts["leaf"])
    material = replace(stage.materials["aluminium"], young=70 * fs.GPa)
    area, second = leaf.thickness * leaf.width, leaf.width * leaf.thickness**3 / 12.0
    stiff = float(leaf.length / (material.young * area))
    turning = float(leaf.length / (material.young * second))
    diagonal = (stiff, turning * float(leaf.length) ** 2 / 12.0, stiff, 1.0, 1.0, turning)
    compliance = tuple(tuple(value if row == column else 0.0 for column in range(6)) for row, value in enumerate(diagonal))
    parts = {**stage.parts, "guide": fs.Joint((fs.Freedom.Y,))}
    if slender:
        parts["leaf"] = fs.ComplianceMatrix(compliance, free=(fs.Freedom.RZ,))
    return replace(stage, parts=parts, materials={"aluminium": material}, tags={})


def amplification(angle: float, *, slender: bool) -> float:
    """Motion of the platform over the spread of the bridge's ends."""
    moved = static_gain(fs.lumped(_amplifier(angle, slender=slender)), ("platform.y", "left.x", "right.x"), ("pzt",)).values[:, 0]
    return float(-moved[0] / (moved[2] - moved[1]))


def _bridge() -> Section:
    published = ((1.0, "40.0056"), (3.0, "18.2064"), (6.0, "9.401136"), (10.0, "5.6466"))
    rows = [
        Row(f"{angle:g} deg, Euler-Bernoulli leaves", "Ling et al. 2016", value, amplification(angle * fs.deg, slender=True))
        for angle, value in published
    ]
    for angle, value in published:
        tenth = Tolerance(0.1 * (1.0 / math.tan(math.radians(angle)) - float(value)))
        rows.append(Row(f"{angle:g} deg, our leaf", "the same", value, amplification(angle * fs.deg, slender=False), "1", tenth))
    rigid = fs.ideal(case("bridge"))
    rows.append(Row("6 deg, ideal", "cot(angle)", "9.5144", float(np.abs(rigid.jacobian.values[1, 0]))))
    text = (
        "E = 70 GPa, leaves 5 x 0.5 x 10 mm, bars of 20 mm. The closed form is Euler-Bernoulli; our leaf has shear and plate action "
        "besides, which may change what the bridge loses against the ideal by a tenth."
    )
    return Section("Bridge amplifier", text, tuple(rows))
