"""The command `design`: stages for a specification, as design files."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from flexstage.base.finding import refuse
from flexstage.control.study.study import sensitivity_crossover
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.options import Resume, Workers, output_option
from flexstage.show.command.output import announce, make_folder, write
from flexstage.show.command.progress import progress_bar
from flexstage.solid.results.verification import required_values
from flexstage.studies.sweeps.execution.run import Run
from flexstage.studies.synthesis.answers import Answers, all_names
from flexstage.studies.synthesis.answers import design as find_designs
from flexstage.studies.synthesis.architecture import DESIGN
from flexstage.studies.synthesis.show.report import answer_report
from flexstage.studies.synthesis.show.tables import answer_tables, pair_row
from flexstage.studies.synthesis.specification import load_specification

_KEPT = ".pairs"


@command("report")
def design(
    specification: Annotated[Path, typer.Argument(metavar="SPEC.TOML", help="Specification file.", show_default=False)],
    *,
    output: Annotated[Path | None, output_option("FOLDER", "Folder for the design files and their studies.")] = None,
    architecture: Annotated[
        list[str] | None, typer.Option("--architecture", metavar="NAME", help="Architecture to try. Repeatable. Default: all.")
    ] = None,
    prove: Annotated[bool, typer.Option("--prove", help="Verify the first three answers by finite elements.")] = False,
    tolerance: Annotated[bool, typer.Option("--tolerance", help="Compute the production yield of the first three answers.")] = False,
    loop: Annotated[
        bool, typer.Option("--loop", help="Compute the lowest sensitivity crossover of the control loops of the first three answers.")
    ] = False,
    resume: Resume = False,
    workers: Workers = None,
) -> CommandResult:
    """Design stages for a specification.

    Theoretical bounds exclude impossible pairs of architecture and actuator. The other pairs are optimised within the requirements, with
    corrections for elastic bodies and large displacements. The designs found are called answers. Each answer is written as a design file
    with a study.

    If no answer is found, the exit code is 1. An interrupted search keeps its results in the output folder; --resume continues the search.
    """
    if resume and output is None:
        raise refuse("--resume", "output folder missing", "Specify the folder of the interrupted search with --output")
    spec = load_specification(specification)
    with progress_bar() as shown:
        found = find_designs(
            spec,
            tuple(architecture or ()),
            shown.share,
            verify=required_values if prove else None,
            tolerance=tolerance,
            close_loop=sensitivity_crossover if loop else None,
            keep=None if output is None else output / _KEPT,
            how=Run(workers, resume),
            finished=lambda result: shown.result("pair", pair_row(result)),
        )
        shown.result("tables", [(table.title, table.texts(), table.notes) for table in answer_tables(found)])
    if output is not None and found.answers:
        _write(found, output)
    if found.interrupted:
        raise KeyboardInterrupt(*["The designs found so far were written."] if output is not None and found.answers else [])
    tables, page = lambda: answer_tables(found), partial(answer_report, found)
    return CommandResult(None, lambda: found, tables, page, Model.LUMPED, failed=found.best is None)


def _write(found: Answers, folder: Path) -> None:
    make_folder(folder)
    for name, answer in zip(all_names(found.answers), found.answers, strict=True):
        write(folder / f"{name}.toml", answer.design, "--output")
        for ending, study in (("study", answer.study), ("tolerance", answer.scatter)):
            write(folder / f"{name}.{ending}.toml", study.replace(f'"{DESIGN}"', f'"{name}.toml"'), "--output")
    announce(f"Wrote {len(found.answers)} design file(s) in {folder}, each with a study and a tolerance study")
