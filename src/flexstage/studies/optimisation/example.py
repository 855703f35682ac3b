"""A small optimisation, for examples."""

from __future__ import annotations

from flexstage.studies.optimisation.problem import Objective, ObjectiveDirection, OptimisationProblem
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.file import loads_study

_TEXT = """
format = "flexstage study 1"
name = "thicker leaves"
case = "parallelogram"
variables.leaf = { address = "parts.leaf.thickness", from = "0.6 mm", to = "2 mm", step = "10 um" }
responses.f1 = "frequency.platform.1"
optimise = { maximise = "f1", starts = 2 }
"""


def leaf_study() -> tuple[Study, OptimisationProblem]:
    """Return a study and its optimisation problem: find the leaf thickness of the parallelogram with the highest frequency.

    >>> leaf_study()[1].objectives[0].name
    'f1'
    """
    study = loads_study(_TEXT)
    return study, OptimisationProblem((Objective("f1", study.responses["f1"], ObjectiveDirection.MAXIMISE),), starts=2)
