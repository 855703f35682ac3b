"""The command `design`: stages for a specification, as design files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.options import output_option
from flexstage.show.command.output import announce, make_folder, write
from flexstage.show.command.progress import progress_bar
from flexstage.studies.synthesis.architecture import DESIGN
from flexstage.studies.synthesis.search import Answers, all_names
from flexstage.studies.synthesis.search import design as find_designs
from flexstage.studies.synthesis.show.report import answer_report
from flexstage.studies.synthesis.show.tables import answer_tables
from flexstage.studies.synthesis.specification import load_specification


@command("report")
def design(
    specification: Annotated[Path, typer.Argument(metavar="SPEC.TOML", help="Specification file.", show_default=False)],
    *,
    output: Annotated[Path | None, output_option("FOLDER", "Folder for the design files and their studies.")] = None,
    architecture: Annotated[
        list[str] | None, typer.Option("--architecture", metavar="NAME", help="Architecture to try. Repeatable. Default: all.")
    ] = None,
) -> CommandResult:
    """Design stages for a specification.

    Bounds exclude impossible pairs of architecture and actuator. The others are optimised within the requirements.

    Each answer is a design file with a study. Without an answer the exit code is 1.
    """
    spec = load_specification(specification)
    with progress_bar() as shown:
        found = find_designs(spec, tuple(architecture or ()), shown.share)
    if output is not None and found.answers:
        _write(found, output)
    tables, page = lambda: answer_tables(found), lambda: answer_report(found)
    return CommandResult(None, lambda: found, tables, page, Model.LUMPED, failed=found.best is None)


def _write(found: Answers, folder: Path) -> None:
    make_folder(folder)
    for name, answer in zip(all_names(found.answers), found.answers, strict=True):
        write(folder / f"{name}.toml", answer.design, "--output")
        write(folder / f"{name}.study.toml", answer.study.replace(f'"{DESIGN}"', f'"{name}.toml"'), "--output")
    announce(f"Wrote {len(found.answers)} design files and studies in {folder}")
