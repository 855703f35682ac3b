"""The command `sweep`: many designs of a stage, and the effects of the variables."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Annotated

from flexstage.base.finding import refuse
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.options import Resume, Study, Workers, output_option
from flexstage.show.command.progress import progress_bar
from flexstage.studies.sweeps.effects import effects
from flexstage.studies.sweeps.execution.run import Run
from flexstage.studies.sweeps.execution.run import sweep as run_sweep
from flexstage.studies.sweeps.file import load_study
from flexstage.studies.sweeps.loaded import loaded_findings
from flexstage.studies.sweeps.result import Sweep
from flexstage.studies.sweeps.show.report import sweep_report
from flexstage.studies.sweeps.show.tables import study_tables


@command("output", "report")
def sweep(
    study: Study,
    *,
    output: Annotated[Path, output_option("RESULTS.H5", "Results file of all designs.")],
    resume: Resume = False,
    workers: Workers = None,
) -> CommandResult:
    """Analyse many designs with varied parameters.

    The study file selects a grid, a Latin hypercube, a Sobol sequence, or Saltelli's plan for Sobol indices.

    --resume continues an interrupted sweep.
    """
    definition = load_study(study)
    with _resumable(output), progress_bar() as shown:
        results = run_sweep(
            definition,
            output,
            Run(workers, resume),
            lambda done, of: shown.share(f"{done} of {of} designs", done / max(of, 1)),
        )
    found = Sweep(definition, results, effects(results, definition.plan))
    page, warnings = partial(sweep_report, found), loaded_findings(definition)
    return CommandResult(definition.design, lambda: found, lambda: study_tables(found), page, Model.LUMPED, warnings)


@contextmanager
def _resumable(output: Path) -> Generator[None]:
    """Report after an interruption that results are kept."""
    try:
        yield
    except KeyboardInterrupt:
        raise refuse(str(output), "interrupted; results are kept", "Continue with --resume") from None
