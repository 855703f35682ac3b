"""The command `analyse`: everything at once, with report, JSON, MATLAB file and the effect of changes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import accumulate
from pathlib import Path
from typing import Annotated, Any

import typer

from flexstage.analysis import complete
from flexstage.analysis.assessment.difference import Comparison, difference, set_values
from flexstage.analysis.caveats import caveats
from flexstage.analysis.complete import Analysis
from flexstage.base.finding import combine_warnings
from flexstage.base.storage.document import Document, as_text
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.theory import Model
from flexstage.show.command.answer import list_caveats, print_missing, show, write_csv, write_workbook
from flexstage.show.command.design import change, open_design, with_elastic_bodies
from flexstage.show.command.failure import MISSED
from flexstage.show.command.options import Changes, Csv, Design, ElasticBodies, Full, Json, ModelName, Report, Xlsx, text_option
from flexstage.show.command.output import STDOUT, save
from flexstage.show.command.terminal import print_note
from flexstage.show.document import analysis_body, analysis_results, envelope, requirements_body
from flexstage.show.table import Table, optional, result_table
from flexstage.show.tables import errors, kinematics, lost_motion, statics, workspace
from flexstage.show.tables.change import set_table
from flexstage.show.tables.force_workspace import drive_force_tables, force_workspace_tables
from flexstage.show.tables.modes import mode_table
from flexstage.show.tables.overview import closing_text, count_text, floating_line, load_line, overview_tables, small_line, stage_text
from flexstage.show.tables.requirements import verdict_table
from flexstage.show.tables.units import omitted_table

_WARNINGS, _WIDTH = 3, 80
"""Lines of warnings in the short form, and width of the terminal."""


def analyse(  # noqa: PLR0913 (its options)
    design: Design,
    *,
    model: ModelName = Model.LUMPED,
    report: Report = None,
    changes: Changes = None,
    elastic_bodies: ElasticBodies = False,
    json: Json = None,
    csv: Csv = None,
    xlsx: Xlsx = None,
    mat: Annotated[
        Path | None,
        text_option(
            "--mat", "FILE", "MATLAB file with the mappings R_a and R_s, the second-order model (K, M, B, C, D) and the state-space model."
        ),
    ] = None,
    strict: Annotated[bool, typer.Option("--strict", help="Exit with code 1 if the stage misses a requirement.")] = False,
    full: Full = False,
) -> None:
    """Run the main analyses of a stage.

    Prints requirements, strokes, stiffness, modes, lost motion, warnings and the verdict. With --full, also prints kinematics, workspace,
    drift and error budget. Output files always contain all results.

    With --set, also prints key figures before and after the change.
    """
    outputs: list[tuple[str, str | Path | None]] = [("--json", json), ("--xlsx", xlsx), ("--report", report), ("--mat", mat)]
    whole = full or csv is not None or any(each is not None for _, each in outputs)
    stated = with_elastic_bodies(open_design(design, (), outputs), chosen=elastic_bodies)
    analysis, compared = _worked_out(stated, model, changes or [], whole=whole)
    if mat is not None:
        from flexstage.show.matlab import as_mat

        save(mat, as_mat(analysis), "--mat")
    if report is not None:
        from flexstage.show.report import report as whole_report

        save(report, whole_report(analysis, compared), "--report")
    write_csv(csv, "analyse", lambda: _results(analysis))
    write_workbook(xlsx, lambda: _results(analysis), lambda: envelope("analyse", analysis.mechanism, analysis.model, {}))
    if json is not None:
        save(json, _json_text(analysis, compared), "--json")
    if STDOUT not in (json, str(report), str(mat), str(xlsx)):
        show(_tables(analysis, compared) if full else _short_tables(analysis, compared))
        print_missing(analysis.missing, forced=bool(analysis.kinematics.thrusts))
    missed = [verdict for verdict in analysis.verdicts if not verdict.passed]
    if strict and missed:
        print_note(f"{len(missed)} of {len(analysis.verdicts)} requirements are missed.")
        raise typer.Exit(MISSED)


def _worked_out(stated: Mechanism, model: Model, changes: list[str], *, whole: bool) -> tuple[Analysis, Comparison | None]:
    """The analysis of the design with its changes, and their effect if there are any."""
    analysis = complete.analyse(change(stated, changes), model, whole=whole)
    if not changes:
        return analysis, None
    addresses = tuple(each.partition("=")[0].strip() for each in changes)
    return analysis, Comparison(stated, addresses, difference(complete.analyse(stated, model, whole=whole), analysis))


def _results(analysis: Analysis) -> dict[str, Any]:
    return {"requirements": requirements_body(analysis.verdicts), **analysis_results(analysis)}


def _json_text(analysis: Analysis, compared: Comparison | None) -> str:
    body: Document = analysis_body(analysis)
    if compared is not None:
        values = set_values(compared.stated, analysis.mechanism, compared.addresses)
        body = {"changes": {"set": values, "figures": compared.figures}, **body}
    return as_text(envelope("analyse", analysis.mechanism, analysis.model, body)) + "\n"


def _short_tables(analysis: Analysis, compared: Comparison | None) -> Iterator[Table | str | None]:
    yield stage_text(analysis)
    yield from _change_tables(analysis, compared)
    yield from overview_tables(analysis)
    yield from _short_caveats(analysis)
    yield closing_text(analysis, whole=False)


def _short_caveats(analysis: Analysis) -> Iterator[str]:
    warnings = [f"warning: {each}" for each in combine_warnings(caveats(analysis.mechanism).warnings)]
    shown = _first_lines(warnings)
    counts = {"more warning": len(warnings) - len(shown), "default value": len(caveats(analysis.mechanism).defaults_of("analyse"))}
    lines = [*shown, *(f"{count_text(count, thing)}: --full" for thing, count in counts.items() if count)]
    if lines:
        yield "\n".join(lines)


def _first_lines(texts: list[str]) -> list[str]:
    """The first of some texts, at least one, as many as leave room for the other results on a screen of 80 columns."""
    used = accumulate(math.ceil(len(each) / _WIDTH) for each in texts)
    return [each for place, (each, lines) in enumerate(zip(texts, used, strict=True)) if place == 0 or lines <= _WARNINGS]


def _tables(analysis: Analysis, compared: Comparison | None) -> Iterator[Table | str | None]:
    yield stage_text(analysis)
    yield verdict_table(analysis.verdicts)
    yield floating_line(analysis.linear)
    yield from _change_tables(analysis, compared)
    yield from _analysis_tables(analysis)
    yield load_line(analysis)
    yield small_line(analysis)
    yield from list_caveats("analyse", analysis.mechanism)
    yield closing_text(analysis, whole=True)


def _change_tables(analysis: Analysis, compared: Comparison | None) -> Iterator[Table | None]:
    if compared is not None:
        yield set_table(compared.stated, analysis.mechanism, compared.addresses)
        yield result_table(compared.figures)


def _analysis_tables(analysis: Analysis) -> Iterator[Table | None]:
    """Main tables, one or two for each analysis; the commands of one analysis print more."""
    yield from kinematics.kinematics_tables(analysis.kinematics)
    if analysis.statics is not None:
        yield statics.stiffness_table(analysis.statics)
        yield optional(statics.freedom_stiffness_table, analysis.freedoms)
        yield statics.principal_table(analysis.statics)
    yield result_table(analysis.units or {})
    if analysis.lost_motion is not None:
        yield lost_motion.loss_table(analysis.lost_motion)
        yield lost_motion.budget_table(analysis.lost_motion)
    for unit in (analysis.units or {}).values():
        yield optional(omitted_table, unit.omitted)
    yield optional(mode_table, analysis.modes)
    if analysis.force_workspace is not None:
        yield from force_workspace_tables(analysis.force_workspace)
    yield from drive_force_tables(analysis.drive_force)
    yield workspace.weakest_first(analysis.stress)
    if analysis.workspace is not None:
        yield from workspace.stroke_tables(analysis.workspace)
        yield from workspace.strength_tables(analysis.workspace)
    elif analysis.buckling is not None:
        yield from map(result_table, (analysis.buckling.stage, analysis.buckling))
    yield optional(errors.drift_table, analysis.drift)
    if analysis.error_budget is not None:
        yield from errors.error_budget_tables(analysis.error_budget)
