"""A stage that is read as solids in seconds: the parallelogram with a rigid platform, its leaves and its drive elastic."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from flexstage.beams.compliance import compliance
from flexstage.cases.parallelogram import parallelogram
from flexstage.mechanism.mechanism import Mechanism
from flexstage.parts.body import Body, Inertia
from flexstage.parts.material import Material
from flexstage.parts.shape import Shaped
from flexstage.solid.fea.hinges.hinge_form import HingeSolid
from flexstage.solid.fea.hinges.roots import Roots
from flexstage.solid.fea.meshing.fineness import Fineness, Reduction
from flexstage.solid.results.hinges import Hinges
from flexstage.solid.results.stage import SolidStage, solid_stage
from flexstage.solid.results.units import SolidUnit, solid_units

COARSE = Reduction(Fineness(neck=2.5, block=2.5, order=2), modes=4)


def small() -> Mechanism:
    """The parallelogram stage, its platform rigid."""
    stage = parallelogram()
    body = Body(mass=0.17, centre=(0.0, 0.0, 0.0), inertia=Inertia(3e-5, 6e-5, 7e-5), points=stage.bodies["platform"].points)
    return replace(stage, bodies={"platform": body})


@cache
def small_stage() -> SolidStage:
    """The small stage as a solid."""
    return solid_stage(small(), COARSE)


@cache
def small_unit() -> SolidUnit:
    """Its unit alone; the components are those of the stage."""
    return solid_units(small(), COARSE)["drive"]


def softened(factor: float, *, error: float = 0.001, stubs: float = 0.0) -> Hinges:
    """Hinges as beam theory has them, softer by a factor: stands in for finite elements where only what is made of them is tested.

    `stubs` is their share of the whole twist about x.
    """

    def one(part: Shaped, material: Material, _roots: Roots) -> HingeSolid:
        own = factor * compliance(part, material)
        whole = own.copy()
        whole[3, 3] = own[3, 3] / (1.0 - stubs)
        return HingeSolid(own, np.linalg.inv(own), error, np.full(6, error), whole, 0.0, 1000, 100, 3)

    return lambda forms: {name: one(*form) for name, form in forms.items()}
