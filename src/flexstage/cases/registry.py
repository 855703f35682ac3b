"""The shipped cases by name, with their parameters: for `flexstage new --case NAME`, for studies, and in Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.number import Number, Table
from flexstage.cases.bridge import Bridge, bridge
from flexstage.cases.case import Case, Shipped
from flexstage.cases.double_triangle import SM_REF_A, SM_REF_B, SM_REF_B_REFITTED, double_triangle
from flexstage.cases.file_case import FileCase
from flexstage.cases.hexapod import Hexapod, hexapod
from flexstage.cases.mirror_mount import MirrorMount, mirror_mount
from flexstage.cases.parallelogram import Parallelogram, parallelogram
from flexstage.cases.parameters import Stated, parameter, with_parameters
from flexstage.cases.telescope_mount import TelescopeMount, telescope_mount
from flexstage.cases.tilt_stage import TiltStage, tilt_stage
from flexstage.cases.tip_tilt import TipTilt, tip_tilt
from flexstage.cases.voice_coil_stage import VoiceCoilStage, voice_coil_stage
from flexstage.cases.xy_stage import XYStage, xy_stage
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import round_to_digits

CASES: Mapping[str, Shipped] = {
    "double-triangle": Case(
        double_triangle, SM_REF_B, "six axes: three direct units inside, three levers outside (Shin & Moon), buildable"
    ),
    "double-triangle-a": Case(double_triangle, SM_REF_A, "the same stage for checking formulas; cannot be built"),
    "double-triangle-refitted": Case(
        double_triangle, SM_REF_B_REFITTED, "the buildable stage with neck and lever notch fitted by FEA instead of beam theory"
    ),
    "parallelogram": Case(parallelogram, Parallelogram(), "one axis: a platform on two leaves, pushed by one stack"),
    "xy-stage": Case(xy_stage, XYStage(), "two axes: four carriages on leaves around a platform, two of them driven"),
    "xy-stage-floating": Case(xy_stage, XYStage(driven=1), "the XY stage with one stack only: under-actuated"),
    "bridge": Case(bridge, Bridge(), "one axis: a rhombus of leaf hinges amplifies one stack about nine times"),
    "hexapod": Case(hexapod, Hexapod(), "six axes: six flexure struts in three pairs"),
    "tip-tilt": Case(tip_tilt, TipTilt(), "tip, tilt and piston of a mirror: three stacks and a guide of three leaves"),
    "tip-tilt-four": Case(tip_tilt, TipTilt(posts=4), "the mirror mount on four stacks: redundant actuation"),
    "tilt-stage": Case(tilt_stage, TiltStage(), "one axis: an arm on two cross hinges, turned by a voice coil"),
    "voice-coil-stage": Case(
        voice_coil_stage, VoiceCoilStage(), "one axis: a platform between double parallelograms, pushed by a voice coil"
    ),
    "mirror-mount": Case(mirror_mount, MirrorMount(), "no axis: a mirror of one metre on three bipods of blades"),
    "telescope-mount": Case(
        telescope_mount, TelescopeMount(), "no axis: a mirror on three bipods of blades, a second one on struts above it"
    ),
    **{
        each.name: each
        for each in (
            FileCase("leaf-guide", "one axis: a platform on two wide leaves, as published with solid elements"),
            FileCase("resonator", "one axis: a plate of polysilicon on four straight legs, as published with formulas"),
            FileCase("quad-suspension", "one axis: four masses on blade springs and silica fibres, as published for a detector"),
            FileCase("voice-coil-xy", "two axes of long travel: carriages on double parallelograms, pushed by voice coils"),
            FileCase("long-travel-xy", "two axes of +-5 mm on plain leaves, which weight presses and pulls: for large displacements"),
            FileCase("three-rrr", "x, y and rz: a plate on three legs of notches, levers and stacks (3-RRR)"),
            FileCase("stewart", "six axes: a Stewart platform on six amplified actuators"),
            FileCase("scott-russell", "one axis: a stack amplified by a Scott Russell linkage of notches"),
            FileCase("scanner", "one fast axis: a stack in a bridge of leaf hinges"),
            FileCase("pointing-stage", "one rotation: an arm on two cartwheel hinges, pushed by a stack"),
            FileCase("spiral-stage", "one axis of millimetres: a shaft in two spiral flexures, pushed by a voice coil"),
            FileCase("steering-mirror", "tip and tilt: a mirror on a wire and a membrane, moved by four voice coils"),
            FileCase("z-stage", "one vertical axis: four leaves, a payload, a spring that carries its weight, a voice coil"),
        )
    },
}


@check_arguments
def case(name: str, parameters: Mapping[str, Stated] | None = None) -> Mechanism:
    """The description of a shipped case, its numbers as a file shows them; with some of its `parameters` stated otherwise.

    A parameter is named as `flexstage new --list-parameters` lists it, and is a text with its unit, or a number in SI. Arrays make
    the description a batch. Numbers that do not vary are rounded to twelve digits. Raises `DesignError` with the nearest name where there
    is no case or no parameter of this name, and for values that cannot be.

    >>> import numpy as np
    >>> case("hexapod", {"slope": "50 deg", "neck.thickness": np.array([2.5e-3, 3e-3])}).parts["neck"].thickness.tolist()
    [0.0025, 0.003]
    """
    return round_to_digits(shipped_case(name).build(parameters)) if parameters else _as_shipped(name)


@cache
def _as_shipped(name: str) -> Mechanism:
    return round_to_digits(shipped_case(name).build())


def shipped_case(name: str) -> Shipped:
    """The shipped case of that name. Raises `DesignError` with the nearest name where there is none.

    >>> shipped_case("hexapod").summary
    'six axes: six flexure struts in three pairs'
    """
    if name not in CASES:
        raise refuse(name, "there is no case of this name", suggest_nearest(name, CASES))
    return CASES[name]


@dataclass(frozen=True)
class Variant:
    """A shipped case by name, and the parameters in which it differs from that case: full names and SI values, choices as they are."""

    case: str
    stated: tuple[tuple[str, Any], ...] = ()

    @property
    def parameters(self) -> Any:
        """The dataclass of all its parameters."""
        return with_parameters(shipped_case(self.case).parameters, dict(self.stated))

    def value(self, name: str) -> Any:
        """What it has for a parameter [SI].

        >>> round(Variant("hexapod", (("rise", 0.01),)).value("rise"), 9)
        0.01
        """
        return parameter(self.parameters, name).value

    def mechanism_at(self, values: Mapping[str, Number]) -> Mechanism:
        """The description at other `values` of some parameters [SI], numbers or arrays: to the last bit, and without tags.

        >>> Variant("hexapod").mechanism_at({"neck.profile.radius": 0.005}).parts["neck"].profile
        Circular(radius=0.005)
        """
        return replace(shipped_case(self.case).draw(with_parameters(self.parameters, values)), tags=Table({}))
