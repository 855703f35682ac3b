"""Run of a tolerance study: samples, their summary, and allowable tolerances."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Annotated

from flexstage.base.arguments import check_arguments
from flexstage.base.record import INNER, VIEW, Called
from flexstage.base.storage.store import temporary_folder
from flexstage.studies.sweeps.execution.run import DEFAULT, Progress, Run, sweep
from flexstage.studies.sweeps.result import StudyResult
from flexstage.studies.tolerances.allowance import Allowance, allowance
from flexstage.studies.tolerances.definition import Tolerance
from flexstage.studies.tolerances.scatter import Scatter
from flexstage.studies.tolerances.slopes import Slopes, slopes
from flexstage.studies.tolerances.summary import PERCENTILES, Crosstalk, ResponseSpread, Summary, Yields, summary


@dataclass(frozen=True)
class CopyCount:
    """Numbers of computed and failed samples."""

    computed: int
    failed: int


@dataclass(frozen=True, eq=False)
class Toleranced(StudyResult):
    """A tolerance study with the `results` of all its samples, its `slopes`, its `summary` and its `allowance`."""

    study: Annotated[Tolerance, INNER]
    slopes: Annotated[Slopes, INNER]
    summary: Annotated[Summary, INNER]
    allowance: Annotated[Allowance, INNER]

    @property
    def copies(self) -> Annotated[CopyCount, VIEW]:
        """Numbers of samples."""
        return CopyCount(self.summary.copies, self.summary.failed)

    @property
    def scatter(self) -> Annotated[tuple[Scatter, ...], VIEW]:
        """The entries of `[scatter]`."""
        return self.study.scatters

    @property
    def yields(self) -> Annotated[Yields | None, VIEW, Called("yield")]:
        """Yields of the requirements; null without a specification."""
        return None if self.summary.together is None else Yields(self.summary.together, self.summary.lines)

    @property
    def responses(self) -> Annotated[tuple[ResponseSpread, ...], VIEW]:
        """Distributions of the responses and of the measures of the requirements."""
        return tuple(self._response(column, name) for column, name in enumerate(self.study.measures))

    @property
    def allowed(self) -> Annotated[Allowance | None, VIEW]:
        """Allowable tolerances; null without a specification."""
        return self.allowance if self.summary.lines else None

    @property
    def crosstalk(self) -> Annotated[tuple[Crosstalk, ...], VIEW]:
        """Pose errors of the samples if the nominal mapping commands the strokes (open loop) or measures the pose (closed loop)."""
        return self.summary.crosstalk

    def _response(self, column: int, name: str) -> ResponseSpread:
        spread, entries = self.summary.spread, [each.name for each in self.study.scatters]
        return ResponseSpread(
            name=name,
            measure=self.study.measures[name],
            nominal=float(spread.nominal[column]),
            mean=float(spread.mean[column]),
            deviation=float(spread.deviation[column]),
            percentiles={str(at): value for at, value in zip(PERCENTILES, spread.percentiles[:, column].tolist(), strict=True)},
            linear_deviation=float(spread.linear[column]),
            linear=bool(spread.trusted[column]),
            share_by_derivatives=dict(zip(entries, spread.by_slope[:, column].tolist(), strict=True)),
            share_by_copies=dict(zip(entries, spread.by_sample[:, column].tolist(), strict=True)),
            derivatives=dict(zip((each.name for each in self.study.variables), self.slopes.gradient[column].tolist(), strict=True)),
        )


@check_arguments
def tolerance(
    study: Tolerance,
    path: str | os.PathLike[str] | None = None,
    how: Run = DEFAULT,
    progress: Progress | None = None,
) -> Toleranced:
    """Run a tolerance study. If a `path` is specified, the samples are stored in this results file.

    Raises `DesignError` in the same cases as `sweep`.

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
    statistics = summary(study, results, found)
    return Toleranced(study, results, found, statistics, allowance(study, results, found, statistics))
