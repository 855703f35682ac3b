"""The command `tolerance`: copies of a stage as manufacture and material make them, and what that allows."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexstage.apps.cli.options import Json
from flexstage.apps.cli.study import Report, Resume, Scheduler, StudyFile, Workers

if TYPE_CHECKING:
    from flexstage.studies.tolerance.run import Toleranced


def tolerance(
    study: StudyFile,
    *,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="RESULTS.H5", help="Results file to write: every copy.", show_default=False),
    ] = None,
    resume: Resume = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    report: Report = None,
    json: Json = None,
) -> None:
    """Scatter dimensions and materials: yield, allowances.

    The study's file says in [scatter] what deviates, and how far.

    Told are distributions, the yield line by line and together, what does it, what each dimension may deviate, and crosstalk.
    """
    from flexstage.apps.cli.bar import bar
    from flexstage.apps.cli.output import output_findings
    from flexstage.base.finding import refuse, require
    from flexstage.studies.study.run import Run
    from flexstage.studies.tolerance.file import load_tolerance
    from flexstage.studies.tolerance.run import tolerance as toleranced

    require(output_findings([("--output", output), ("--json", json), ("--report", report)], study))
    if resume and output is None:
        raise refuse("--resume", "no results file is named", "Name it with --output")
    asked = load_tolerance(study)
    with bar() as shown:
        found = toleranced(
            asked, output, Run(workers, resume, scheduler), lambda done, of: shown.share(f"{done} of {of} copies", done / max(of, 1))
        )
    _told(found, report, json)


def _told(found: Toleranced, report: Path | None, json: str | None) -> None:
    from flexstage.apps.cli.answer import Asked, answer
    from flexstage.apps.cli.opening import announce
    from flexstage.apps.cli.output import write
    from flexstage.present.documents.tolerance import tolerance_body
    from flexstage.present.tables.tolerance import tolerance_tables
    from flexstage.present.tolerance_report import tolerance_report
    from flexstage.studies.reading import Reading
    from flexstage.studies.study.loaded import loaded_findings

    if report is not None:
        write(report, tolerance_report(found), "--report")
        announce(report)
    asked = Asked("tolerance", found.study.design, Reading.LUMPED, json, loaded_findings(found.study))
    answer(asked, lambda: tolerance_body(found), lambda: tolerance_tables(found))
