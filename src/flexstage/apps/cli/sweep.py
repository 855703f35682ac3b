"""The command `sweep`: many designs of a stage computed, and what makes them differ."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

from flexstage.base.finding import refuse
from flexstage.present.command.answer import answer
from flexstage.present.command.options import Json, Report, Resume, Scheduler, Study, Workers, output_option
from flexstage.present.command.output import require_writable, save
from flexstage.present.command.progress import progress_bar
from flexstage.present.documents.study import sweep_body
from flexstage.present.study_report import sweep_report
from flexstage.present.tables.study import study_tables
from flexstage.studies.reading import Reading
from flexstage.studies.study.effects import effects
from flexstage.studies.study.file import load_study
from flexstage.studies.study.loaded import loaded_findings
from flexstage.studies.study.run import Run
from flexstage.studies.study.run import sweep as run_sweep


def sweep(
    study: Study,
    *,
    output: Annotated[Path, output_option("RESULTS.H5", "Results file to write: every design.")],
    resume: Resume = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    report: Report = None,
    json: Json = None,
) -> None:
    """Compute many designs; show what varies with what.

    Grid, Latin hypercube, Sobol sequence, or Saltelli's plan for Sobol indices, as the study's file says.

    Interrupted at any moment, --resume goes on without loss or repetition.
    """
    require_writable([("--output", output), ("--json", json), ("--report", report)], study)
    asked = load_study(study)
    with _resumable(output), progress_bar() as shown:
        results = run_sweep(
            asked, output, Run(workers, resume, scheduler), lambda done, of: shown.share(f"{done} of {of} designs", done / max(of, 1))
        )
    found = effects(results, asked.plan)
    if report is not None:
        save(report, sweep_report(asked, results, found), "--report")
    answer(
        "sweep",
        asked.design,
        lambda: sweep_body(asked, results, found),
        lambda: study_tables(asked, results, found),
        reading=Reading.LUMPED,
        json=json,
        cautions=loaded_findings(asked),
        beside=(report,),
    )


@contextmanager
def _resumable(output: Path) -> Generator[None]:
    """Tell of an interruption what is kept."""
    try:
        yield
    except KeyboardInterrupt:
        raise refuse(str(output), "interrupted; what was computed is kept", "Go on with --resume") from None
