"""The command `optimise`: the best design within ranges and limits, as a new design file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from flexstage.base.finding import Finding, refuse, require
from flexstage.models.theory import Model
from flexstage.show.command import options
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.output import save
from flexstage.show.command.progress import progress_bar
from flexstage.studies.optimisation.file import load_optimisation
from flexstage.studies.optimisation.result import Front, Optimum
from flexstage.studies.optimisation.search.front import pareto_front
from flexstage.studies.optimisation.search.optimum import optimise as run_optimise
from flexstage.studies.optimisation.show.report import front_report, optimise_report
from flexstage.studies.optimisation.show.tables import contradiction_text, front_tables, optimise_tables
from flexstage.studies.optimisation.stage_text import design_path, design_text, write_optimum
from flexstage.studies.optimisation.values import values_of
from flexstage.studies.sweeps.file import load_study
from flexstage.studies.sweeps.loaded import loaded_findings, require_stable


@command("output", "report")
def optimise(
    study: options.Study,
    *,
    output: Annotated[Path | None, options.output_option("STAGE.TOML", "Design file to write.")] = None,
) -> CommandResult:
    """Find the best design within ranges and limits.

    The search uses exact derivatives and several initial designs. Prints the binding limits with their sensitivities, and the design with
    rounded values. For two objectives, computes a Pareto front.

    If limits contradict each other, the exit code is 2. An interrupted search ends with the best design found.
    """
    asked = load_study(study)
    definition = load_optimisation(asked, str(study))
    source = design_path(asked, study.parent)
    if source is not None and output is not None and source.resolve() == output.resolve():
        raise refuse("--output", f"{output} is the initial design of the study", "Choose another file")
    if len(definition.objectives) > 1 and output is not None:
        raise refuse("--output", "a Pareto front has many designs", "Set a limit on one objective, and optimise the other")
    run = run_optimise if len(definition.objectives) == 1 else pareto_front
    with progress_bar() as shown:
        found = run(asked, definition, lambda text: shown.share(text, 0.0))
    _require_solution(found)
    if isinstance(found, Optimum) and found.final is not None:
        values = values_of(asked, found.final.shares)
        warnings = require_stable(asked, values)
        if output is not None:
            save(output, write_optimum(design_text(asked, study.parent), asked, definition, values, where=str(source or study)), "--output")
    else:
        warnings = loaded_findings(asked)
    return CommandResult(
        asked.design,
        lambda: found,
        lambda: optimise_tables(found) if isinstance(found, Optimum) else front_tables(found),
        lambda: optimise_report(found) if isinstance(found, Optimum) else front_report(found),
        Model.LUMPED,
        warnings,
    )


def _require_solution(found: Optimum | Front) -> None:
    """Refuse a result without a feasible design, or without a feasible rounded one."""
    require(Finding("limits", *contradiction_text(each, found)) for each in found.contradictions)
    reason = found.failure
    if reason:
        raise refuse("optimise", reason, "Use more starts, wider ranges, or finer steps")
