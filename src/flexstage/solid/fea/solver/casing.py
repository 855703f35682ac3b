"""Casings of encapsulated stacks: sleeves that slide along the axis and provide the bending stiffness in excess of the ceramic's."""

from __future__ import annotations

import numpy as np

from flexstage.base.finding import refuse
from flexstage.base.number import Array
from flexstage.mechanism.assembly.expand import PlacedLink
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.geometry.piece import stack_medium
from flexstage.solid.fea.solver.component import Component
from flexstage.spatial.frame import twist_transform


def is_encased(form: object) -> bool:
    """Return whether a form is a stack with a specified bending rigidity, which includes a casing.

    >>> is_encased(Piezo(stroke=1e-4, stiffness=17e6, length=0.162, diameter=0.01))
    False
    """
    return isinstance(form, Piezo) and form.bending_rigidity is not None


def casing(link: PlacedLink) -> Array | None:
    """Return the stiffness (6, 6) of a stack's casing about its centre: 12 B/L^3 across, B/L in bending, B/((1 + nu) L) in torsion.

    B is the specified bending rigidity minus E I of the ceramic; L is the length and nu the Poisson's ratio of the stack. The stiffness
    along the axis is zero, because the casing slides. The axes are those of the stack. The result is `None` if the stack has no casing.
    Raises `DesignError` if the specified rigidity is below that of the ceramic.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.mechanism.assembly.expand import expand
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
            "Use the rigidity of the encapsulated stack, or remove bending_rigidity",
        )
    extra = stated - own
    across, bending = 12.0 * extra / length**3, extra / length
    return np.diag([0.0, across, across, bending / (1.0 + float(np.real(part.poisson))), bending, bending])


def end_face_twist(component: Component, link: PlacedLink) -> Array:
    """Return the operator (6, 6 m) that maps twists of m interfaces to the twist of a stack's second end face relative to its first.

    The relative twist is at the stack's centre, in the stack's frame.

    >>> from flexstage.cases.parallelogram import parallelogram
    >>> from flexstage.mechanism.assembly.expand import expand
    >>> from flexstage.solid.fea.solver.component import components
    >>> stage = parallelogram()
    >>> stack = next(part for part in components(stage) if part.name == "B/pzt")
    >>> apart = end_face_twist(stack, expand(stage).links["B/pzt"])
    >>> [float(value) for value in apart[0, [0, 6]]]  # along the stack
    [-1.0, 1.0]
    """
    frame = next(piece.frame for piece in component.pieces if piece.name == link.name)
    rows = np.zeros((6, 6 * len(component.interfaces)))
    for number, item in enumerate(component.interfaces):
        if item.joint.link == link.name:
            sign = 1.0 if item.joint.body == link.joins[1] else -1.0
            rows[:, 6 * number : 6 * number + 6] = sign * twist_transform(frame, item.joint.frame.position)
    return rows
