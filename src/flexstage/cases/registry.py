"""The shipped cases by name, for `flexstage new --case NAME`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

from flexstage.base.finding import nearest, refuse
from flexstage.cases.bridge import bridge
from flexstage.cases.double_triangle import SM_REF_A, SM_REF_B, SM_REF_B_REFITTED, double_triangle
from flexstage.cases.hexapod import hexapod
from flexstage.cases.parallelogram import parallelogram
from flexstage.cases.tip_tilt import TipTilt, tip_tilt
from flexstage.cases.xy_stage import XYStage, xy_stage
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import tidied


@dataclass(frozen=True)
class Case:
    """A shipped case: `build` makes its description, `summary` says in one line what it is."""

    build: Callable[[], Mechanism]
    summary: str


CASES: Mapping[str, Case] = {
    "double-triangle": Case(
        partial(double_triangle, SM_REF_B), "six axes: three direct units inside, three levers outside (Shin & Moon), buildable"
    ),
    "double-triangle-a": Case(partial(double_triangle, SM_REF_A), "the same stage for checking formulas; cannot be built"),
    "double-triangle-refitted": Case(
        partial(double_triangle, SM_REF_B_REFITTED), "the buildable stage with neck and lever notch fitted by FEA instead of beam theory"
    ),
    "parallelogram": Case(parallelogram, "one axis: a platform on two leaves, pushed by one stack"),
    "xy-stage": Case(xy_stage, "two axes: four carriages on leaves around a platform, two of them driven"),
    "xy-stage-floating": Case(partial(xy_stage, XYStage(driven=1)), "the XY stage with one stack only: under-actuated"),
    "bridge": Case(bridge, "one axis: a rhombus of leaf hinges amplifies one stack about nine times"),
    "hexapod": Case(hexapod, "six axes: six flexure struts in three pairs"),
    "tip-tilt": Case(tip_tilt, "tip, tilt and piston of a mirror: three stacks and a guide of three leaves"),
    "tip-tilt-four": Case(partial(tip_tilt, TipTilt(posts=4)), "the mirror mount on four stacks: redundant actuation"),
}


def case(name: str) -> Mechanism:
    """The description of a shipped case, its numbers as a file shows them.

    Raises `DesignError` with the nearest name where there is none of this name.

    >>> case("hexapod").name
    'hexapod'
    """
    if name not in CASES:
        raise refuse(name, "there is no case of this name", nearest(name, CASES))
    return tidied(CASES[name].build())
