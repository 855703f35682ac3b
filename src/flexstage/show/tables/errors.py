"""Tables of errors: drift per kelvin, and the error budget by axis and source."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.assessment.error_budget import STEPS, ErrorBudget
from flexstage.analysis.linear_statics.drift import Drift
from flexstage.base.labelled import Matrix
from flexstage.mechanism.assembly.expansion import Ground
from flexstage.show.display import number
from flexstage.show.table import Cell, Column, Mark, Table, first_design, make_table, matrix_table, short_names
from flexstage.show.tables.workspace import command_text
from flexstage.spatial.frame import COMPONENTS


def drift_table(drift: Drift) -> Table:
    """Motion of the platform and named points per kelvin, uniform and per gradient of 1 K/m.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.linear_statics.drift import drift
    >>> stage = double_triangle()
    >>> drift_table(drift(stage, fs.lumped(stage), ground="steel")).texts()[0][1]
    'uniform [per K]'
    """
    values = first_design(drift.motion.values, 2)
    scale = np.max(np.abs(values), axis=1, keepdims=True, initial=0.0)
    kept = np.where(np.abs(values) < 1e-9 * max(float(np.max(scale)), 1e-12), 0.0, values)
    rows = [
        (
            Cell(f"{name} [{'nrad' if name.rpartition('.')[2].startswith('r') else 'nm'}]", Mark.STRONG),
            *(_nano_cell(value) for value in line),
        )
        for name, line in zip(short_names(drift.motion.rows), kept, strict=True)
    ]
    heads = ["motion", Column("uniform", "per K"), *(Column(f"gradient {axis}", "per K/m") for axis in "xyz")]
    at = ", ".join(number(1e3 * float(value)) for value in first_design(drift.datum, 1))
    notes = [f"Strokes held. {ground_text(drift.ground)}; its point ({at}) mm stays."]
    return make_table("Thermal drift", heads, rows, notes=notes, provenance=drift.provenance)


def ground_text(ground: Ground) -> str:
    """What the ground was taken to be of, and why.

    >>> ground_text(Ground("steel", "as stated")), ground_text(Ground("steel", "all links that stand on it are of it"))
    ('Ground made of steel', 'Ground taken as steel: all links that stand on it are of it')
    """
    if ground.material is None:
        return "Ground does not grow"
    return f"Ground made of {ground.material}" if ground.stated else f"Ground taken as {ground.material}: {ground.source}"


def _nano_cell(value: float) -> Cell:
    text = number(1e9 * float(value), 4)
    return Cell(text, Mark.FAINT if text == "0" else Mark.PLAIN)


def error_budget_tables(budget: ErrorBudget) -> tuple[Table, ...]:
    """Largest errors by axis and source, without and with the lost-motion gains in the command.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.budget import budget
    >>> error_budget_tables(budget(double_triangle(), {"z": 1e-5}))[0].texts()[3][:2]
    ['z [nm]', '336.8']
    """
    sums = first_design(budget.sums.values, 2)
    titles = ("Error budget, ideal mapping commanded", "Error budget, lost motion corrected by command")
    return tuple(
        _budget_table(title, matrix, sums[:, 2 * index : 2 * index + 2], budget)
        for index, (title, matrix) in enumerate(zip(titles, (budget.ideal, budget.corrected), strict=True))
    )


def _budget_table(title: str, matrix: Matrix, sums: np.ndarray, budget: ErrorBudget) -> Table:
    rows = [
        (Cell(f"{axis} [{'nrad' if axis.startswith('r') else 'nm'}]", Mark.STRONG), *(_nano(value) for value in (*line, *totals)))
        for axis, line, totals in zip(COMPONENTS, first_design(matrix.values, 2), sums, strict=True)
    ]
    heads = ["along", *(Column(name) for name in matrix.columns), Column("linear sum"), Column("root sum square")]
    warm = number(float(np.real(np.ravel(budget.temperature)[0])))
    warmed = "" if "drift" in budget.reasons else f", and {warm} K of uniform temperature change"
    notes = [f"Largest errors over {command_text(budget.command)}, all at once{warmed}."]
    if not np.all(np.isnan(first_design(matrix.values, 2)[:, matrix.columns.index("gauge noise")])):
        notes += [f"Gauge noise: {budget.coverage:g} standard deviations. Quantisation: half a step of every gauge, signs at their worst."]
    notes += ["Actuator steps: half a step of every stepping drive, signs at their worst."] if STEPS in matrix.columns else []
    notes += [] if budget.ground is None else [f"{ground_text(budget.ground)}."]
    missing = [name for name in budget.missing if name not in budget.reasons]
    notes += [f"Not stated, so not counted: {', '.join(missing)}."] if missing else []
    notes += [f"Not known, so not counted: {name}, for {reason}." for name, reason in budget.reasons.items()]
    return make_table(title, heads, rows, notes=notes, provenance=budget.provenance)


def _nano(value: float) -> Cell:
    text = number(1e9 * float(value), 4) if not abs(value) < 1e-15 else "0"
    return Cell(text, Mark.FAINT if text in ("0", "-") else Mark.PLAIN)


def gauge_drift_table(drift: Drift) -> Table | None:
    """What the gauges read per kelvin; `None` without gauges.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.linear_statics.drift import drift
    >>> stage = double_triangle()
    >>> gauge_drift_table(drift(stage, fs.lumped(stage), ground="steel")).texts()[1][0]
    'S1 [um]'
    """
    return matrix_table("Gauge readings by temperature", drift.gauges) if drift.gauges.rows else None
