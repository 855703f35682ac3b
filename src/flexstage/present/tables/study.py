"""Tables of studies of many designs."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.requirements import Verdict
from flexstage.base.quantity import Quantity
from flexstage.base.unit import show
from flexstage.present.display import number, value_with_unit
from flexstage.present.table import Cell, Column, Mark, Table, build
from flexstage.studies.study.definition import Study
from flexstage.studies.study.effects import Effects
from flexstage.studies.study.store import Results

_MOST_FAILURES = 8


def study_tables(study: Study, results: Results, found: Effects) -> list[Table]:
    """What was varied, how the responses are distributed, what does it, and designs that failed.

    >>> study_tables.__name__
    'study_tables'
    """
    tables = [_variables(study, results), _responses(study, results, found), _shares(found)]
    return [*tables, *([_failures(results)] if results.failures else [])]


def _variables(study: Study, results: Results) -> Table:
    rows = [
        (
            Cell(each.name, Mark.STRONG),
            ", ".join(each.addresses) if each.variant is None else f"parameter {', '.join(each.addresses)}",
            _end(each.low, each.quantity, relative=each.relative),
            _end(each.high, each.quantity, relative=each.relative),
        )
        for each in study.variables
    ]
    plan = study.plan
    note = f"{len(results.designs)} of {results.planned} designs, {plan.sampling.value}" + ("" if plan.levels else f", seed {plan.seed}")
    return build("Varied", ["variable", "number", "from", "to"], rows, notes=[f"{note}."])


def _end(value: float, quantity: Quantity, *, relative: bool) -> str:
    return f"{100.0 * (value - 1.0):+.4g} %" if relative else show(value, quantity, digits=6)


def _responses(study: Study, results: Results, found: Effects) -> Table:
    rows = []
    for index, (name, measure) in enumerate(study.columns.items()):
        unit = measure.quantity.si
        cells = [value_with_unit(float(each[index]), unit, 5) for each in (found.low, found.mean, found.deviation, found.high)]
        rows.append((Cell(name, Mark.STRONG), f"{measure.key} at {measure.point}", *cells, _met(study, results, name)))
    heads = ["least", "mean", "deviation", "largest"]
    return build("Responses", ["response", "measure", *(Column(head) for head in heads), Column("limit met by", "%")], rows)


def _met(study: Study, results: Results, name: str) -> str:
    """Share of all designs that keep the limits on a measure; a failed design keeps none."""
    measure, values = study.columns[name], results.column(name)
    verdicts = [Verdict(each, values) for each in study.limits if (each.key, each.point) == (measure.key, measure.point)]
    if not verdicts or not len(values):
        return ""
    return number(100.0 * float(np.mean(np.all([verdict.passed for verdict in verdicts], axis=0))), 4)


def _shares(found: Effects) -> Table:
    """First-order and, where known, total indices."""
    columns: list[Column | str] = ["variable"]
    for name in found.responses:
        columns += [Column(name, "alone")] + ([] if found.total is None else [Column(name, "in all")])
    rows = []
    for row, variable in enumerate(found.variables):
        cells: list[Cell | str] = [Cell(variable, Mark.STRONG)]
        for column in range(len(found.responses)):
            cells.append(_share(float(found.first[row, column])))
            cells += [] if found.total is None else [_share(float(found.total[row, column]))]
        rows.append(cells)
    note = "Alone: share of the response's variance by the variable alone"
    note += "; in all: with its interactions." if found.total is not None else "; what is left is interaction."
    return build("What does it", columns, rows, notes=[note, f"By {found.method}, {found.used} designs."])


def _share(value: float) -> Cell:
    if not np.isfinite(value):
        return Cell("-", Mark.FAINT)
    return Cell(f"{round(100.0 * value, 1) + 0.0:.1f} %", Mark.STRONG if value > 0.1 else Mark.PLAIN, bar=float(np.clip(value, 0.0, 1.0)))


def _failures(results: Results) -> Table:
    """Reasons of failed designs, the most frequent first."""
    reasons: dict[str, list[int]] = {}
    for design, reason in results.failures.items():
        reasons.setdefault(reason, []).append(design)
    ranked = sorted(reasons.items(), key=lambda item: -len(item[1]))
    rows = [(number(len(designs)), str(designs[0]), reason) for reason, designs in ranked[:_MOST_FAILURES]]
    rest = len(ranked) - _MOST_FAILURES
    notes = [f"{rest} further reasons are in the results file."] if rest > 0 else []
    return build("Designs without values", [Column("designs"), Column("first"), "reason"], rows, notes=notes)
