"""Input and result of the computation of a hinge's compliance matrix. This module does not import the solver."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from flexstage.base.finding import Finding
from flexstage.base.number import Array
from flexstage.parts.material import Material
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.hinges.roots import Roots

NO_ESTIMATE = "an estimate needs two solutions, and the second would exceed the allowed number of unknowns"
LEAVE = "Compare it with beam theory (flexstage verify), or raise the limit in Python: hinge_compliance(..., Accuracy(freedoms=NUMBER))"


class HingeForm(NamedTuple):
    """Input of a hinge computation: the hinge's shape and material, and its `roots`, which are the ends attached to blocks."""

    part: Shaped
    material: Material
    roots: Roots


@dataclass(frozen=True, eq=False)
class HingeSolid:
    """6x6 matrices [SI] of a hinge between the ends of its arcs, computed by 3-D elasticity about its centre in the link frame.

    `compliance` and `stiffness` (6, 6) are for the twist (x, y, z, rx, ry, rz) of the second end relative to the first. `error` estimates
    the largest relative error of the compliance *at the hinge's end*, where the error of each entry ij is divided by sqrt(C_ii C_jj).
    `changes` (6,) are the relative changes of the compliance's diagonal about the centre between the last two solutions. The entries for y
    and z change more than the others, because they are differences of lever-arm terms. `whole` (6, 6) is the compliance including the stubs
    of length `stub` [m]. `freedoms`, `elements` and `order` are those of the last solution; `finding` is a warning if the required accuracy
    was not reached.
    """

    compliance: Array
    stiffness: Array
    error: float
    changes: Array
    whole: Array
    stub: float
    freedoms: int
    elements: int
    order: int
    finding: Finding | None = None
