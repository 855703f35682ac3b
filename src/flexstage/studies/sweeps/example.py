"""A small study, for examples."""

from __future__ import annotations

from flexstage.analysis.assessment.requirements import measure
from flexstage.base.number import Table
from flexstage.base.units.quantity import LENGTH
from flexstage.cases.double_triangle import double_triangle
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.plan import Plan, Sampling
from flexstage.studies.sweeps.variable import Variable


def neck_study(designs: int = 4) -> Study:
    """Return a study of the shipped stage: necks from 1.4 to 1.7 mm, and the frequency of its lowest mode.

    >>> neck_study().plan.designs
    4
    """
    stage = double_triangle()
    neck = Variable("neck", ("parts.neck.thickness",), LENGTH, 1.4e-3, 1.7e-3)
    tilt = measure(stage, "frequency.platform.1", "responses.tilt")
    return Study("neck", stage, (neck,), Table({"tilt": tilt}), (), Plan(Sampling.SOBOL, 1, count=designs))
