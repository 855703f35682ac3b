"""The command `optimise`: the best design within ranges and limits, as a new design file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexstage.apps.cli.options import Json
from flexstage.apps.cli.output import STDOUT
from flexstage.apps.cli.study import Report, StudyFile

if TYPE_CHECKING:
    from flexstage.studies.optimise.result import Front, Optimum
    from flexstage.studies.optimise.wanted import Wanted
    from flexstage.studies.study.definition import Study


def optimise(
    study: StudyFile,
    *,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="STAGE.TOML", help="Design file to write.", show_default=False)
    ] = None,
    report: Report = None,
    json: Json = None,
) -> None:
    """Find the best design within ranges and limits.

    By exact derivatives, from several starts: what binds, what it costs, values that can be made. Two objectives: a front.

    Limits that contradict each other are named (exit code 2). Interrupted, it ends with the best design so far.
    """
    from flexstage.apps.cli.output import output_findings
    from flexstage.base.finding import refuse, require
    from flexstage.studies.optimise.file import load_wanted
    from flexstage.studies.optimise.stage_text import design_path
    from flexstage.studies.study.file import load_study

    require(output_findings([("--output", output), ("--json", json), ("--report", report)], study))
    asked = load_study(study)
    wanted = load_wanted(asked, str(study))
    source = design_path(asked, study.parent)
    if source is not None and output is not None and source.resolve() == output.resolve():
        raise refuse("--output", f"{output} is the design that the study starts from", "Choose another file")
    if len(wanted.objectives) > 1 and output is not None:
        raise refuse("--output", "a front has many designs", "Set a limit on one objective, optimise the other, and write that design")
    if len(wanted.objectives) > 1:
        _front(asked, wanted, report, json)
    else:
        _one(asked, wanted, (study, output, report), json)


def _one(asked: Study, wanted: Wanted, files: tuple[Path, Path | None, Path | None], json: str | None) -> None:
    from flexstage.apps.cli.answer import Asked, answer
    from flexstage.apps.cli.bar import bar
    from flexstage.apps.cli.opening import announce
    from flexstage.apps.cli.output import announced, write
    from flexstage.present.documents.optimise import optimise_body
    from flexstage.present.optimise_report import optimise_report
    from flexstage.present.tables.optimise import optimise_tables
    from flexstage.studies.optimise.optimum import optimise as optimised
    from flexstage.studies.optimise.rounding import values_of
    from flexstage.studies.optimise.stage_text import design_text, optimised_text
    from flexstage.studies.reading import Reading
    from flexstage.studies.study.loaded import require_holding

    study, output, report = files
    with bar() as shown:
        found = optimised(asked, wanted, lambda text: shown.share(text, 0.0))
    _refused(found)
    cautions = () if found.final is None else require_holding(asked, values_of(asked, found.final.shares))
    if output is not None and found.final is not None:
        text = design_text(asked, study.parent)
        write(output, optimised_text(text, asked, wanted, values_of(asked, found.final.shares), where=str(study)), "--output")
        if str(output) != STDOUT:
            announced(f"Wrote {output}")
    if report is not None:
        write(report, optimise_report(found), "--report")
        announce(report)
    if str(output) != STDOUT:
        answered = Asked("optimise", asked.design, Reading.LUMPED, json, cautions)
        answer(answered, lambda: optimise_body(found), lambda: optimise_tables(found))


def _front(asked: Study, wanted: Wanted, report: Path | None, json: str | None) -> None:
    from flexstage.apps.cli.answer import Asked, answer
    from flexstage.apps.cli.bar import bar
    from flexstage.apps.cli.opening import announce
    from flexstage.apps.cli.output import write
    from flexstage.present.documents.optimise import front_body
    from flexstage.present.optimise_report import front_report
    from flexstage.present.tables.optimise import front_tables
    from flexstage.studies.optimise.front import pareto_front
    from flexstage.studies.reading import Reading
    from flexstage.studies.study.loaded import loaded_findings

    with bar() as shown:
        found = pareto_front(asked, wanted, lambda text: shown.share(text, 0.0))
    _refused(found)
    if report is not None:
        write(report, front_report(found), "--report")
        announce(report)
    answered = Asked("optimise", asked.design, Reading.LUMPED, json, loaded_findings(asked))
    answer(answered, lambda: front_body(found), lambda: front_tables(found))


def _refused(found: Optimum | Front) -> None:
    """Refuse what has no design that keeps the limits, or none that can be made."""
    from flexstage.base.finding import Finding, refuse, require
    from flexstage.present.tables.optimise import contradiction_text

    require(Finding("limits", *contradiction_text(each, found)) for each in found.contradictions)
    reason = found.unfinished
    if reason:
        raise refuse("optimise", reason, "Give more starts, widen the ranges, or make the steps finer")
