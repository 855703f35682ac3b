"""Piezo stacks as uniform round rods."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexstage.base.number import Number
from flexstage.beams.beam import Beam, flexibility, inertia
from flexstage.beams.law import PartLaw
from flexstage.beams.quadrature import stations
from flexstage.beams.torsion import free_twist
from flexstage.parts.piezo import Piezo
from flexstage.parts.profile import Straight
from flexstage.parts.section import Circle, circle, cowper_circle


@dataclass(frozen=True, eq=False)
class _CasedStack(Circle):
    """A stack's ceramic in a casing, with the second moment that matches its bending rigidity."""

    moment: Number = 0.0

    @cached_property
    def inertia_y(self) -> Number:
        """As specified [m^4]."""
        return self.moment


def piezo_beam(part: Piezo) -> Beam:
    """Build the uniform round rod of a stack at constant stroke, with the stack's `effective_modulus` and mass.

    A specified `bending_rigidity` replaces the bending rigidity. The torsional rigidity is then the bending rigidity divided by one plus
    Poisson's ratio, as for a round section. The shear stiffness remains that of the ceramic.

    >>> stack = Piezo(stroke=150e-6, stiffness=17e6, length=0.162, diameter=0.01)
    >>> round(float(1e-6 / piezo_beam(stack).diagonal()[0]), 9)
    17.0
    """
    points = stations(Straight(part.length), part.diameter)
    ceramic = circle(np.asarray(part.diameter)[..., None] + points.growth, np.asarray(cowper_circle(part.poisson))[..., None])
    young = np.asarray(effective_modulus(part))[..., None]
    shear = young / (2.0 * (1.0 + np.asarray(part.poisson)[..., None]))
    density = np.asarray(part.mass / part.length)[..., None] / ceramic.area
    cased: Circle = ceramic
    if part.bending_rigidity is not None:
        moment = np.asarray(part.bending_rigidity)[..., None] / young
        cased = _CasedStack(ceramic.height, ceramic.width, ceramic.shear, moment)
    twisting = free_twist(cased, shear)
    return Beam(points, cased, flexibility(cased, young, shear, twisting), inertia(ceramic, density), twisting)


def effective_modulus(part: Piezo) -> Number:
    """Compute the modulus k L / A [Pa] of a uniform rod with the stack's axial stiffness k and length L, and the ceramic's section A.

    >>> round(effective_modulus(Piezo(stroke=150e-6, stiffness=17e6, length=0.162, diameter=0.01)) / 1e9, 2)
    35.07
    """
    return part.stiffness * part.length / (0.25 * np.pi * part.diameter * part.diameter)


PIEZO = PartLaw(lambda part, _: piezo_beam(part), needs_material=False)
