"""The `[optimise]` section of a study's file."""

from __future__ import annotations

from flexstage.base.finding import Finding, nearest, require
from flexstage.mechanism.store.file import parse_toml
from flexstage.studies.optimisation.wanted import Aim, Objective, Wanted
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.fields import Fields

_MOST = 2


def load_wanted(study: Study, where: str = "text") -> Wanted:
    """Read what is wanted from the study's own text. Raises `DesignError` with every finding, each at `where`.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> load_wanted(leaf_study()[0]).starts
    2
    """
    findings: list[Finding] = []
    table = Fields(parse_toml(study.text, where), "", findings).table("optimise")
    objectives = tuple(_objectives(table, study))
    wanted = Wanted(
        objectives,
        table.whole("starts", 1, 3),
        table.whole("seed", 0, 0),
        table.whole("pareto_points", 3, 9),
        table.raw("require", bool, "true or false", default=True),
    )
    table.done()
    require(Finding(f"{where}: {each.where}", each.what, each.advice) for each in findings)
    return wanted


def _objectives(table: Fields, study: Study) -> list[Objective]:
    found: list[Objective] = []
    for aim in Aim:
        several = isinstance(table.tree.get(aim.value), list)
        names = table.texts(aim.value) if several else tuple(filter(None, (table.text(aim.value),)))
        for name in names:
            if name not in study.responses:
                table.note(aim.value, f'there is no response "{name}"', nearest(name, study.responses))
            elif name in (each.name for each in found):
                table.note(aim.value, f'"{name}" is an objective already', "Name each once")
            elif (same := next((each for each in found if each.measure == study.responses[name]), None)) is not None:
                table.note(aim.value, f'"{name}" is the same measure as "{same.name}", an objective already', "Name each once")
            else:
                found.append(Objective(name, study.responses[name], aim))
    _counted(table, found, next(iter(study.responses), "f1"))
    return found


def _counted(table: Fields, found: list[Objective], example: str) -> None:
    if not found and not table.findings:
        table.findings.append(Finding("optimise", "no objective is named", f'Write for example maximise = "{example}" in [optimise]'))
    if len(found) > _MOST:
        what = f"these are {len(found)} objectives, a front is drawn of {_MOST}"
        table.findings.append(Finding("optimise", what, "Keep two, and set [limits] on the others"))
