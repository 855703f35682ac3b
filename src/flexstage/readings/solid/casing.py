"""Casings: the bending stiffness that an encapsulated stack has beyond its ceramic's, as a sleeve that slides along the axis."""

from __future__ import annotations

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.mechanism.expand import PlacedLink
from flexstage.parts.piezo import Piezo
from flexstage.readings.solid.piece import stack_medium


def casing(link: PlacedLink) -> Array | None:
    """Stiffness (6, 6) of a stack's casing about its centre, in its frame: 12 B/L^3 across, B/L in bending, B/((1 + nu) L) in torsion.

    B is the stated bending rigidity less the ceramic's E I; nothing along the axis, where the casing slides. `None` without a stated one.
    Raises `DesignError` when the stated rigidity is below the ceramic's own.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.expand import expand
    >>> law = casing(expand(double_triangle()).links["B1/pzt"])  # B 387.2 N m^2, of which the ceramic has 17.2
    >>> float(law[0, 0]), round(float(law[4, 4]) * 0.162, 1)
    (0.0, 370.0)
    """
    part = link.part
    if not isinstance(part, Piezo) or part.bending_rigidity is None:
        return None
    length, diameter = float(np.real(part.length)), float(np.real(part.diameter))
    own = stack_medium(part).young * np.pi * diameter**4 / 64.0
    stated = float(np.real(part.bending_rigidity))
    if stated < own:
        raise refuse(
            link.name,
            f"its bending rigidity {stated:.4g} N m^2 is below the {own:.4g} N m^2 of its ceramic alone",
            "State the encapsulated stack's rigidity, or leave it out",
        )
    extra = stated - own
    across, bending = 12.0 * extra / length**3, extra / length
    return np.diag([0.0, across, across, bending / (1.0 + float(np.real(part.poisson))), bending, bending])
