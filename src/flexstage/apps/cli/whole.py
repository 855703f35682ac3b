"""The command `analyse`: everything at once, with report, JSON, MATLAB file and the effect of changes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexstage.apps.cli.answer import caveat_lines, tell_missing
from flexstage.apps.cli.failure import MISSED
from flexstage.apps.cli.options import Changes, Design, Json, Theory
from flexstage.apps.cli.output import STDOUT, announced, output_findings, write
from flexstage.apps.cli.speech import tell
from flexstage.studies.reading import Reading

if TYPE_CHECKING:
    from flexstage.present.documents.envelope import Document
    from flexstage.present.table import Table
    from flexstage.studies.complete import Analysis
    from flexstage.studies.difference import Comparison


def analyse(
    design: Design,
    *,
    reading: Theory = Reading.LUMPED,
    report: Annotated[Path | None, typer.Option(metavar="FILE", help="Write a self-contained HTML report.", show_default=False)] = None,
    changes: Changes = None,
    json: Json = None,
    mat: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write R_a, R_s, K, M, B, C, D and the state space for MATLAB.", show_default=False)
    ] = None,
    strict: Annotated[bool, typer.Option("--strict", help="Exit with code 1 if a requirement is missed.")] = False,
) -> None:
    """Analyse a stage: everything at once.

    Requirements first, then kinematics, stiffness, lost motion, modes, response, workspace, drift, error budget.

    With --set, the key figures are shown as old, new and change, in the report too.
    """
    analysis, compared = _worked_out(design, reading, changes or [], [("--json", json), ("--report", report), ("--mat", mat)])
    _write_files(analysis, compared, (report, mat))
    if json is not None:
        write(json, _json_text(analysis, compared), "--json")
        _announce(json)
    if STDOUT not in (json, str(report), str(mat)):
        _show(analysis, compared)
    missed = [verdict for verdict in analysis.verdicts if not verdict.passed]
    if strict and missed:
        tell(f"{len(missed)} of {len(analysis.verdicts)} requirements are missed.")
        raise typer.Exit(MISSED)


def _worked_out(
    design: Path, reading: Reading, changes: list[str], outputs: list[tuple[str, str | Path | None]]
) -> tuple[Analysis, Comparison | None]:
    """The analysis of the design with its changes, and their effect if there are any."""
    from flexstage.base.finding import require

    require(output_findings(outputs, design))
    from flexstage.apps.cli.opening import changed
    from flexstage.mechanism.store import load
    from flexstage.studies.complete import analyse as analysed
    from flexstage.studies.difference import Comparison, difference

    stated = load(design)
    mechanism = changed(stated, changes)
    analysis = analysed(mechanism, reading)
    if not changes:
        return analysis, None
    addresses = tuple(change.partition("=")[0].strip() for change in changes)
    return analysis, Comparison(stated, addresses, difference(analysed(stated, reading), analysis))


def _write_files(analysis: Analysis, compared: Comparison | None, files: tuple[Path | None, Path | None]) -> None:
    report, mat = files
    if mat is not None:
        from flexstage.present.matlab import as_mat

        write(mat, as_mat(analysis), "--mat")
        _announce(mat)
    if report is not None:
        from flexstage.present.report import report as composed

        write(report, composed(analysis, compared), "--report")
        _announce(report)


def _announce(target: str | Path) -> None:
    if str(target) != STDOUT:
        announced(f"Wrote {target}")


def _json_text(analysis: Analysis, compared: Comparison | None) -> str:
    from flexstage.present.documents.envelope import as_text, enveloped
    from flexstage.present.documents.whole import analysis_body, changes_body
    from flexstage.studies.difference import set_values

    body: Document = analysis_body(analysis)
    if compared is not None:
        values = set_values(compared.stated, analysis.mechanism, compared.addresses)
        body = {"changes": {"set": changes_body(values), "figures": changes_body(compared.figures)}, **body}
    return as_text(enveloped("analyse", analysis.mechanism, analysis.reading, body)) + "\n"


def _show(analysis: Analysis, compared: Comparison | None) -> None:
    from flexstage.apps.cli.show import show

    show(_tables(analysis, compared))
    tell_missing(analysis.missing)


def _tables(analysis: Analysis, compared: Comparison | None) -> Iterator[Table | str | None]:
    from flexstage.apps.cli.grouped import analysis_tables
    from flexstage.present.tables.change import change_table, set_table
    from flexstage.present.tables.requirements import verdict_table

    yield verdict_table(analysis.verdicts)
    yield from caveat_lines("analyse", analysis.mechanism)
    if compared is not None:
        yield set_table(compared.stated, analysis.mechanism, compared.addresses)
        yield change_table(compared.figures)
    yield from analysis_tables(analysis)
