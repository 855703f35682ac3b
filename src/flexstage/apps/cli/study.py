"""The command `sweep`: many designs of a stage computed, and what makes them differ."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from flexstage.apps.cli.options import Json

if TYPE_CHECKING:
    from flexstage.studies.study.definition import Study
    from flexstage.studies.study.effects import Effects
    from flexstage.studies.study.store import Results

StudyFile: TypeAlias = Annotated[Path, typer.Argument(help="File of the study (TOML).", metavar="STUDY.TOML", show_default=False)]
Resume: TypeAlias = Annotated[bool, typer.Option("--resume", help="Go on with a results file that is not complete.")]
Workers: TypeAlias = Annotated[
    int | None, typer.Option("--workers", metavar="N", help="Processes. Default: one a core.", show_default=False)
]
Scheduler: TypeAlias = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="Dask scheduler of a cluster, e.g. tcp://host:8786.", show_default=False),
]
Report: TypeAlias = Annotated[
    Path | None, typer.Option("--report", metavar="FILE.html", help="Write a report with pictures.", show_default=False)
]


def sweep(
    study: StudyFile,
    *,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="RESULTS.H5", help="Results file to write: every design.", show_default=False)
    ],
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
    from flexstage.apps.cli.bar import bar
    from flexstage.apps.cli.output import output_findings
    from flexstage.base.finding import require
    from flexstage.studies.study.effects import effects
    from flexstage.studies.study.file import load_study
    from flexstage.studies.study.run import Run
    from flexstage.studies.study.run import sweep as swept

    require(output_findings([("--output", output), ("--json", json), ("--report", report)], study))
    asked = load_study(study)
    with resumable(output), bar() as shown:
        results = swept(
            asked, output, Run(workers, resume, scheduler), lambda done, of: shown.share(f"{done} of {of} designs", done / max(of, 1))
        )
    found = effects(results, asked.plan)
    _told(asked, results, found, report, json)


@contextmanager
def resumable(output: Path) -> Generator[None]:
    """Tell of an interruption what is kept."""
    try:
        yield
    except KeyboardInterrupt:
        from flexstage.base.finding import refuse

        raise refuse(str(output), "interrupted; what was computed is kept", "Go on with --resume") from None


def _told(asked: Study, results: Results, found: Effects, report: Path | None, json: str | None) -> None:
    from flexstage.apps.cli.answer import Asked, answer
    from flexstage.apps.cli.opening import announce
    from flexstage.apps.cli.output import write
    from flexstage.present.documents.study import sweep_body
    from flexstage.present.study_report import sweep_report
    from flexstage.present.tables.study import study_tables
    from flexstage.studies.reading import Reading
    from flexstage.studies.study.loaded import loaded_findings

    if report is not None:
        write(report, sweep_report(asked, results, found), "--report")
        announce(report)
    design = asked.design
    answer(
        Asked("sweep", design, Reading.LUMPED, json, loaded_findings(asked)),
        lambda: sweep_body(asked, results, found),
        lambda: study_tables(asked, results, found),
    )
