"""A tolerance study run: copies computed, then told what they say and what they allow."""

from __future__ import annotations

import os
from dataclasses import dataclass

from flexstage.base.store import temporary_folder
from flexstage.studies.sweeps.run import DEFAULT, Progress, Run, sweep
from flexstage.studies.sweeps.store import Results
from flexstage.studies.tolerances.allowance import Allowance, allowance
from flexstage.studies.tolerances.definition import Tolerance
from flexstage.studies.tolerances.slopes import Slopes, slopes
from flexstage.studies.tolerances.summary import Summary, summary


@dataclass(frozen=True, eq=False)
class Toleranced:
    """A tolerance study with the `results` of all its copies, its `slopes`, what both say (`summary`) and what they allow (`allowance`)."""

    study: Tolerance
    results: Results
    slopes: Slopes
    summary: Summary
    allowance: Allowance


def tolerance(
    study: Tolerance, path: str | os.PathLike[str] | None = None, how: Run = DEFAULT, progress: Progress | None = None
) -> Toleranced:
    """Run a tolerance study, its copies kept in the results file at `path` (absent: nowhere), as `sweep` keeps the designs of any study.

    Raises `DesignError` as `sweep` does.

    >>> from flexstage.studies.tolerances.example import leaf_study
    >>> found = tolerance(leaf_study(), how=Run(workers=1))
    >>> found.summary.together.share, round(found.allowance.together, 1) > 10.0
    (1.0, True)
    """
    if path is None:
        with temporary_folder() as place:
            return tolerance(study, place / "copies.h5", how, progress)
    results = sweep(study, path, how, progress)
    found = slopes(study)
    said = summary(study, results, found)
    return Toleranced(study, results, found, said, allowance(study, results, found, said))
