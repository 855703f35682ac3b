"""Tables of optimisations."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.assessment.requirements import Verdict
from flexstage.base.number import Array
from flexstage.show.display import format_value
from flexstage.show.table import Cell, Column, Mark, Table, make_table, result_table
from flexstage.show.tables.requirements import answer_text, is_met, margin_text
from flexstage.studies.optimisation.result import Contradiction, Front, Optimum, Start
from flexstage.studies.optimisation.values import Point, values_of
from flexstage.studies.sweeps.definition import Study


def optimise_tables(found: Optimum) -> list[Table | None]:
    """Tabulate objective and variables before and after, limits, binding limits with their sensitivities, and starts.

    >>> from flexstage.studies.optimisation.example import leaf_study
    >>> from flexstage.studies.optimisation.search.optimum import optimise
    >>> [table.title for table in optimise_tables(optimise(*leaf_study())) if table]
    ['Objective', 'Variables', 'Limits', 'Binding limits', 'Starts']
    """
    return [_objective(found), _variables(found), _limits(found), result_table(found.binding), result_table(_starts(found))]


def front_tables(found: Front) -> list[Table]:
    """Tabulate the objectives and variables of the designs of a front."""
    objectives = found.definition.objectives
    heads = [f"{each.name} ({each.direction.value})" for each in objectives]
    rows = []
    for index, point in enumerate(found.points):
        cells = [format_value(float(point.values[number]), each.measure.quantity.si, 6) for number, each in enumerate(objectives)]
        rows.append((str(index + 1), *cells, *_value_texts(found.study, values_of(found.study, point.shares))))
    columns = ["design", *(Column(head) for head in heads), *(Column(each.name) for each in found.study.variables)]
    notes = [f"All these designs are Pareto-optimal. {found.evaluated} designs were evaluated with derivatives."]
    return [make_table("Front", columns, rows, notes=[*notes, *_notes(interrupted=found.interrupted, idle=found.idle)])]


def _notes(*, interrupted: bool, idle: tuple[str, ...]) -> list[str]:
    notes = ["The search was interrupted; these are the best results so far."] if interrupted else []
    return [*notes, *([f"Variables without effect at the nominal design: {', '.join(idle)}."] if idle else [])]


def _value_texts(study: Study, values: Array) -> list[str]:
    return [each.text(float(value)) for each, value in zip(study.variables, values, strict=True)]


def _objective(found: Optimum) -> Table:
    objective = found.definition.objectives[0]
    unit = objective.measure.quantity.si
    rows = [("nominal", format_value(found.value(found.before), unit, 6), "")]
    for title, point in (("optimum", found.point), ("rounded", None if found.rounded is None else found.rounded.point)):
        if point is not None:
            change = found.value(point) / (found.value(found.before) or np.nan) - 1.0
            rows.append((title, format_value(found.value(point), unit, 6), f"{100.0 * change:+.2f} %"))
    notes = [f"{found.agreeing} of {len(found.starts)} starts agree. {found.evaluated} designs were evaluated with derivatives."]
    if found.rounded is not None and found.rounded.point is not None:
        notes.append(f"Loss by rounding: {format_value(found.rounded.loss, unit, 3)} ({found.rounded.tried} rounded designs evaluated).")
    elif found.rounded is not None:
        notes.append(f"Not rounded: {found.rounded.reason}.")
    notes += _notes(interrupted=found.interrupted, idle=found.idle)
    heads = [f"{objective.direction.value} {objective.name}", Column(objective.measure.key), Column("change")]
    return make_table("Objective", heads, rows, notes=notes)


def _variables(found: Optimum) -> Table:
    study = found.study
    columns = [values_of(study, found.before.shares)]
    heads = [Column("nominal")]
    if found.point is not None:
        columns.append(values_of(study, found.point.shares))
        heads.append(Column("optimum"))
    if found.rounded is not None and found.rounded.values is not None:
        columns.append(found.rounded.values)
        heads.append(Column("rounded"))
    shown = [_value_texts(study, values) for values in columns]
    rows = []
    for index, each in enumerate(study.variables):
        rows.append((Cell(each.name, Mark.STRONG), each.text(each.low), *(texts[index] for texts in shown), each.text(each.high)))
    return make_table("Variables", ["variable", Column("from"), *heads, Column("to")], rows)


def _limits(found: Optimum) -> Table:
    first = len(found.definition.objectives)
    point = found.final or found.point or found.before
    rows = []
    for index, each in enumerate(found.limits):
        verdict = Verdict(each, np.asarray(point.values[first + index]))
        kept = is_met(verdict)
        values = [format_value(float(at.values[first + index]), each.quantity.si, 5) for at in (found.before, point)]
        mark = Cell(answer_text(verdict), Mark.PASS if kept else Mark.FAIL)
        rows.append((Cell(each.key, Mark.STRONG), each.text, *values, margin_text(verdict), mark))
    heads = ["limit", "required", Column("nominal"), Column("final"), Column("margin"), "verdict"]
    return make_table("Limits", heads, rows)


def _starts(found: Optimum) -> dict[str, Start]:
    return {f"Sobol {index}" if index else "nominal": each for index, each in enumerate(found.starts)}


def contradiction_text(each: Contradiction, found: Optimum | Front) -> tuple[str, str]:
    """Return a text and an advice on a contradiction. The text contains the nearest possible values of the limited measures."""
    said = [f"'{limit.key} {limit.text}'" for limit in each.limits]
    at = [_nearest_value(limit.key, limit.point, each.point, found) for limit in each.limits]
    least = f"the smallest violation is {100.0 * each.violation:.3g} %, with {', '.join(at)}"
    if len(said) == 1:
        return f"{said[0]} cannot hold within these ranges; {least}", "Relax this limit, or widen the ranges"
    both = "both " if len(said) == 2 else "all "
    joined = f"{', '.join(said[:-1])} and {said[-1]}"
    return f"{joined} cannot {both}hold within these ranges; {least}", "Relax one of these limits, or widen the ranges"


def _nearest_value(key: str, point: str, at: Point, found: Optimum | Front) -> str:
    index = next(number for number, limit in enumerate(found.limits) if (limit.key, limit.point) == (key, point))
    value = float(at.values[len(found.definition.objectives) + index])
    return f"{key} {format_value(value, found.limits[index].quantity.si, 5)}"
