"""Tables of studies of many designs."""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np

from flexstage.show.display import number
from flexstage.show.table import Cell, Column, Mark, Table, make_table, result_table
from flexstage.studies.sweeps.definition import Study
from flexstage.studies.sweeps.effects import Effects
from flexstage.studies.sweeps.execution.store import Results
from flexstage.studies.sweeps.result import Sweep

_MOST_FAILURES = 8
_MOST_PAIRS = 6
_LEAST = 0.01
_NUMBER = re.compile(r"-?\d+(\.\d+)?(e[+-]?\d+)?")


def study_tables(sweep: Sweep) -> list[Table | None]:
    """Tabulate variables, distributions of the responses, variance contributions, and failed designs."""
    study, results, found = sweep.study, sweep.results, sweep.effects
    tables: list[Table | None] = [
        variable_table(study, results),
        result_table(sweep.responses, notes=limit_notes(study, results)),
        share_table(found),
    ]
    tables += [pair_table(found)] if np.any(np.isfinite(found.pairs)) else []
    return tables + ([failure_table(results)] if results.failures else [])


def variable_table(study: Study, results: Results) -> Table:
    """Tabulate variables with their ranges, and the number of designs."""
    rows = [
        (
            Cell(each.name, Mark.STRONG),
            ", ".join(each.addresses) if each.variant is None else f"parameter {', '.join(each.addresses)}",
            each.text(each.low),
            each.text(each.high),
        )
        for each in study.variables
    ]
    plan = study.plan
    note = f"{len(results.designs)} of {results.planned} designs, {plan.sampling.value}" + ("" if plan.levels else f", seed {plan.seed}")
    return make_table("Varied", ["variable", "number", "from", "to"], rows, notes=[f"{note}."])


def limit_notes(study: Study, results: Results) -> list[str]:
    """Report the fraction of feasible designs. If no design is feasible, name the single limits or pairs of limits that no design meets."""
    kept = study.feasible(results.responses)
    if not study.limits or not len(kept):
        return []
    if np.any(kept):
        return [f"{number(100.0 * float(np.mean(kept)), 4)} % of the designs meet all limits."]
    alone = {f"{each.key} {each.text}": study.feasible(results.responses, (each,)) for each in study.limits}
    never = [text for text, met in alone.items() if not np.any(met)]
    if never:
        return [f"No design meets {' or '.join(never)}. Widen the ranges, or relax these limits."]
    pairs = [pair for pair in combinations(alone, 2) if not np.any(alone[pair[0]] & alone[pair[1]])]
    pair_text = "; ".join(f"{first} and {second}" for first, second in pairs)
    return [f"No design meets all limits{f'; no design meets both {pair_text}' if pair_text else ''}."]


def share_table(found: Effects) -> Table:
    """Tabulate first-order indices and, if they are known, total indices."""
    columns: list[Column | str] = ["variable"]
    for name in found.responses:
        columns += [Column(name, "first order")] + ([] if found.total is None else [Column(name, "total")])
    rows = []
    for row, variable in enumerate(found.variables):
        cells: list[Cell | str] = [Cell(variable, Mark.STRONG)]
        for column in range(len(found.responses)):
            cells.append(share_cell(float(found.first[row, column])))
            cells += [] if found.total is None else [share_cell(float(found.total[row, column]))]
        rows.append(cells)
    note = "First order: fraction of the response's variance due to the variable alone. "
    note += (
        "Total: fraction due to the variable and its interactions."
        if found.total is not None
        else "The remainder is due to interactions, and to variation within bins."
    )
    return make_table(
        "Variance contributions", columns, rows, notes=[note, f"Method: {found.method}, with {found.used} designs.", *_error_note(found, 0)]
    )


def _error_note(found: Effects, order: int) -> list[str]:
    """Standard errors of indices."""
    texts = [
        f"{name} {100.0 * error:.1g} %" for name, error in zip(found.responses, found.errors[order], strict=True) if np.isfinite(error)
    ]
    return [f"Largest standard errors: {', '.join(texts)}."] if texts else []


def pair_table(found: Effects) -> Table:
    """Tabulate pairs of variables that only together explain at least 1 % of a response's variance, the strongest first."""
    known = np.nan_to_num(found.pairs).max(axis=2)
    ranked = sorted(combinations(range(len(found.variables)), 2), key=lambda pair: -known[pair])
    shown_pairs = [pair for pair in ranked if known[pair] >= _LEAST][:_MOST_PAIRS]
    rows = [
        [
            Cell(f"{found.variables[first]}, {found.variables[second]}", Mark.STRONG),
            *(share_cell(float(each)) for each in found.pairs[first, second]),
        ]
        for first, second in shown_pairs
    ]
    less = "No pair" if not rows else "No other pair"
    notes = ["Fraction of the variance that only both variables together explain."]
    notes += [f"{less} explains at least 1 % of the variance of a response."] if len(rows) < _MOST_PAIRS else []
    notes += _error_note(found, 1)
    return make_table("Interactions", ["variables", *(Column(name) for name in found.responses)], rows, notes=notes)


def share_cell(value: float, form: str = "{:.1f} %") -> Cell:
    """Format a fraction of a variance in percent, with a bar of proportional length.

    >>> share_cell(0.25).text, share_cell(float("nan")).text
    ('25.0 %', '-')
    """
    if not np.isfinite(value):
        return Cell("-", Mark.FAINT)
    text = form.format(round(100.0 * value, 1) + 0.0)
    return Cell(text, Mark.STRONG if value > 0.1 else Mark.PLAIN, bar=float(np.clip(value, 0.0, 1.0)))


def failure_table(results: Results) -> Table:
    """Tabulate the reasons for failed designs, the most frequent first."""
    reasons = dict[str, list[int]]()
    for design, reason in results.failures.items():
        reasons.setdefault(_NUMBER.sub("", reason), []).append(design)
    ranked = sorted(reasons.values(), key=lambda designs: -len(designs))
    rows = [(number(len(designs)), str(designs[0]), results.failures[designs[0]]) for designs in ranked[:_MOST_FAILURES]]
    rest = len(ranked) - _MOST_FAILURES
    notes = ["Reasons that differ only in numbers are listed once. The results file contains all reasons."]
    notes += [f"{rest} further reasons are in the results file."] if rest > 0 else []
    return make_table("Designs without values", [Column("designs"), Column("first"), "reason"], rows, notes=notes)
