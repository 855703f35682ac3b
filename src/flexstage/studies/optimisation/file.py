"""The `[optimise]` section of a study's file."""

from __future__ import annotations

from flexstage.base.arguments import check_arguments
from flexstage.base.finding import Finding, require, suggest_nearest
from flexstage.mechanism.store.lines import with_lines
from flexstage.studies.form import OptimiseTable, study_file
from flexstage.studies.optimisation.problem import Objective, ObjectiveDirection, OptimisationProblem
from flexstage.studies.sweeps.definition import Study

_MOST = 2


@check_arguments
def load_optimisation(study: Study, where: str = "text") -> OptimisationProblem:
    """Read the optimisation problem from the text of the study's file. Raises one `DesignError` with all errors; `where` names the file.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> load_optimisation(leaf_study()[0]).starts
    2
    """
    table = study_file(study.text, where).optimise
    findings = list[Finding]()
    definition = OptimisationProblem(_objectives(table, study, findings), table.starts, table.seed, table.pareto_points, table.requirements)
    require(with_lines(findings, study.text, where))
    return definition


def _objectives(table: OptimiseTable, study: Study, findings: list[Finding]) -> tuple[Objective, ...]:
    found = list[Objective]()
    for aim, names in ((ObjectiveDirection.MAXIMISE, table.maximise), (ObjectiveDirection.MINIMISE, table.minimise)):
        for name in names or ():
            at = f"optimise.{aim.value}"
            if name not in study.responses:
                findings.append(Finding(at, f'unknown response "{name}"', suggest_nearest(name, study.responses)))
            elif name in (each.name for each in found):
                findings.append(Finding(at, f'"{name}" is listed twice', f'Remove one "{name}"'))
            elif (same := next((each for each in found if each.measure == study.responses[name]), None)) is not None:
                findings.append(Finding(at, f'"{name}" is the same measure as the objective "{same.name}"', f'Remove "{name}"'))
            else:
                found.append(Objective(name, study.responses[name], aim))
    if not found and not findings:
        example = next(iter(study.responses), "f1")
        findings.append(Finding("optimise", "objective missing", f'Use e.g. maximise = "{example}" in [optimise]'))
    if len(found) > _MOST:
        what = f"too many objectives (got {len(found)}, expected at most {_MOST})"
        findings.append(Finding("optimise", what, "Keep two of them, and set [limits] on the other responses"))
    return tuple(found)
