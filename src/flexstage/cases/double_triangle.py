"""The double-triangular stage of Shin & Moon, for examples: three direct horizontal units inside, three vertical lever units outside.

Two consistent parameter sets complete the values that the paper does not print: `SM_REF_A` for checking formulas (it cannot be built), and
`SM_REF_B`, the case `double-triangle`, which can be built. Every value is tagged stated, derived or assumed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from flexstage.base.number import Table
from flexstage.cases.parameters import Stated
from flexstage.cases.registry import case
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.store import round_to_digits
from flexstage.parts.freedom import ROTATIONS, Freedom

SM_REF_A, SM_REF_B, SM_REF_B_REFITTED = "double-triangle-a", "double-triangle", "double-triangle-refitted"


def double_triangle(name: str = SM_REF_B, parameters: Mapping[str, Stated] | None = None) -> Mechanism:
    """Return the case with this name and some changed `parameters`; formulas are replaced by their values.

    >>> double_triangle(parameters={"long_arm": "80 mm"}).units["vertical"].links["front"].at[0]
    0.08
    """
    return round_to_digits(replace(case(name, parameters), numbers=Table({}), formulas=Table({})))


EQUATION_3: dict[str, tuple[tuple[Freedom, ...], tuple[Freedom, ...]]] = {
    "foot_notch": ((Freedom.X,), (Freedom.RZ,)),
    "lever_notch": ((Freedom.RZ,), ()),
    "pole_neck": ((Freedom.X,), ROTATIONS),
    "stack_vertical": ((Freedom.X,), ()),
}
"""DOFs of a vertical unit in Eq. 3 of the paper: (elastic, free) DOFs of each part; all other DOFs are locked."""

TABLE_2_FEA = EQUATION_3 | {"foot_notch": ((Freedom.X, Freedom.RZ), ()), "pole_neck": ((Freedom.X, Freedom.RY, Freedom.RZ), (Freedom.RX,))}
"""DOFs of Eq. 3 plus bending of front and pole hinges. This bending closes the gap to the FEA column of Table 2."""

EQUATION_18 = EQUATION_3 | {"neck": ((Freedom.X,), ROTATIONS), "stack_horizontal": ((Freedom.X,), ())}
"""DOFs of the whole stage in Eq. 18 of the paper: axial springs and lever pivots."""
