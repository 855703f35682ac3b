"""The command `tolerance`: samples of a stage with scatter of dimensions and materials, yield and allowable tolerances."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

from flexstage.base.finding import refuse
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.options import Resume, Study, Workers, output_option
from flexstage.show.command.progress import progress_bar
from flexstage.studies.sweeps.execution.run import Run
from flexstage.studies.sweeps.loaded import loaded_findings
from flexstage.studies.tolerances.file import load_tolerance
from flexstage.studies.tolerances.run import tolerance as run_tolerance
from flexstage.studies.tolerances.show.report import tolerance_report
from flexstage.studies.tolerances.show.tables import tolerance_tables


@command("output", "report")
def tolerance(
    study: Study,
    *,
    output: Annotated[Path | None, output_option("RESULTS.H5", "Results file of all samples.")] = None,
    resume: Resume = False,
    workers: Workers = None,
) -> CommandResult:
    """Compute production yield and allowable tolerances.

    The table [scatter] of the study file defines the distributions of dimensions and material properties.

    Prints distributions, yield, variance contributions, allowable tolerances and crosstalk.
    """
    if resume and output is None:
        raise refuse("--resume", "results file missing", "Specify the results file of the interrupted computation with --output")
    definition = load_tolerance(study)
    with progress_bar() as shown:
        found = run_tolerance(
            definition,
            output,
            Run(workers, resume),
            lambda done, of: shown.share(f"{done} of {of} samples", done / max(of, 1)),
        )
    page, warnings = partial(tolerance_report, found), loaded_findings(found.study)
    return CommandResult(found.study.design, lambda: found, lambda: tolerance_tables(found), page, Model.LUMPED, warnings)
