"""The shipped cases by name, with their parameters: for `flexstage new --case NAME`, for studies, and in Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse, suggest_nearest
from flexstage.base.number import Number, Table
from flexstage.cases.case import Case
from flexstage.cases.parameters import Stated, parameter
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import round_to_digits

_SUMMARIES = {
    "double-triangle": "six axes: three direct units inside, three levers outside (Shin & Moon), buildable",
    "double-triangle-a": "the double-triangular stage for checking formulas; cannot be built",
    "double-triangle-refitted": "the double-triangular stage with neck and lever notch fitted to FEA instead of beam theory",
    "parallelogram": "one axis: a platform on two leaves, pushed by one stack",
    "xy-stage": "two axes: four carriages on leaves around a platform, two of them driven",
    "xy-stage-floating": "the XY stage with one stack only: under-actuated",
    "bridge": "one axis: a rhombus of leaf hinges amplifies one stack about nine times",
    "hexapod": "six axes: six flexure struts in three pairs",
    "tip-tilt": "tip, tilt and piston of a mirror: three stacks, and a guide with three leaves",
    "tip-tilt-four": "the mirror mount on four stacks: redundant actuation",
    "tilt-stage": "one axis: an arm on two cross hinges, turned by a voice coil",
    "voice-coil-stage": "one axis: a platform between double parallelograms, pushed by a voice coil",
    "mirror-mount": "no driven axis: a mirror of one metre on three bipods of blades",
    "telescope-mount": "no driven axis: a mirror on three bipods of blades, and a second mirror on struts above it",
    "leaf-guide": "one axis: a platform on two wide leaves, with published results of solid elements",
    "resonator": "one axis: a plate of polysilicon on four straight legs, with published formulas",
    "quad-suspension": "one axis: four masses on blade springs and silica fibres, as published for a detector",
    "voice-coil-xy": "two axes of long travel: carriages on double parallelograms, pushed by voice coils",
    "long-travel-xy": "two axes of +-5 mm on plain leaves, loaded by weight: for large displacements",
    "three-rrr": "x, y and rz: a plate on three legs of notches, levers and stacks (3-RRR)",
    "stewart": "six axes: a Stewart platform on six amplified actuators",
    "scott-russell": "one axis: a stack amplified by a Scott Russell linkage of notches",
    "scanner": "one fast axis: a stack in a bridge of leaf hinges",
    "pointing-stage": "one rotation: an arm on two cartwheel hinges, pushed by a stack",
    "spiral-stage": "one axis with millimetres of travel: a shaft in two spiral flexures, pushed by a voice coil",
    "steering-mirror": "tip and tilt: a mirror on a wire and a membrane, moved by four voice coils",
    "z-stage": "one vertical axis: four leaves, a payload, a spring that carries its weight, a voice coil",
}
CASES: Mapping[str, Case] = {name: Case(name, line) for name, line in _SUMMARIES.items()}


@check_arguments
def case(name: str, parameters: Mapping[str, Stated] | None = None) -> Mechanism:
    """Return the description of a shipped case with some changed `parameters`.

    `flexstage new --list-parameters` lists the names of the parameters. A value is a string with a unit, a number in SI units, or an array
    of such numbers; an array gives a batch of designs. All numbers that are not arrays are rounded to twelve digits. Raises `DesignError`
    with the nearest name for an unknown case or parameter, and for invalid values.

    >>> import numpy as np
    >>> case("hexapod", {"slope": "50 deg", "neck_thickness": np.array([2.5e-3, 3e-3])}).parts["neck"].thickness.tolist()
    [0.0025, 0.003]
    """
    return round_to_digits(shipped_case(name).build(parameters)) if parameters else _as_shipped(name)


@cache
def _as_shipped(name: str) -> Mechanism:
    return round_to_digits(shipped_case(name).build())


def shipped_case(name: str) -> Case:
    """Return the shipped case with this name. Raises `DesignError` with the nearest name for an unknown case.

    >>> shipped_case("hexapod").summary
    'six axes: six flexure struts in three pairs'
    """
    if name not in CASES:
        raise refuse(name, "unknown case", suggest_nearest(name, CASES))
    return CASES[name]


@dataclass(frozen=True)
class Variant:
    """Shipped case by name, with changed parameters: names and SI values."""

    case: str
    stated: tuple[tuple[str, Any], ...] = ()

    @property
    def start(self) -> Mechanism:
        """Description with the changed parameters."""
        return shipped_case(self.case).build(dict(self.stated))

    def value(self, name: str) -> Any:
        """Return the value of a parameter [SI].

        >>> round(Variant("hexapod", (("rise", 0.01),)).value("rise"), 9)
        0.01
        """
        return parameter(self.start, name).value

    def mechanism_at(self, values: Mapping[str, Number]) -> Mechanism:
        """Return the description with other `values` of some parameters [SI] (numbers or arrays), not rounded and without tags.

        >>> Variant("hexapod").mechanism_at({"neck_radius": 0.005}).parts["neck"].profile
        Circular(radius=0.005)
        """
        return replace(shipped_case(self.case).build({**dict(self.stated), **values}), tags=Table({}))
