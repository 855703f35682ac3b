"""Tables of errors: thermal drift, and the error budget by axis and source."""

from __future__ import annotations

import numpy as np

from flexstage.analysis.assessment.error_budget import NOISES, STEPS, ErrorBudget
from flexstage.analysis.linear_statics.drift import Drift
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.number import Array
from flexstage.mechanism.assembly.expansion import Ground
from flexstage.parts.profile import single
from flexstage.show.display import number
from flexstage.show.table import Table, first_design, matrix_table
from flexstage.show.tables.workspace import command_text
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

_NANO = ("nm", "nrad")


def drift_table(drift: Drift) -> Table:
    """Tabulate the thermal drift of the platform and named points: per kelvin of uniform warming, and per temperature gradient of 1 K/m.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.linear_statics.drift import drift
    >>> stage = double_triangle()
    >>> drift_table(drift(stage, fs.lumped(stage), ground="steel")).texts()[0][1]
    'uniform [K]'
    """
    at = ", ".join(number(1e3 * float(value)) for value in first_design(drift.datum, 1))
    notes = [f"Actuators are fixed. {ground_text(drift.ground)}. Fixed point of the ground: ({at}) mm."]
    return matrix_table("Thermal drift", drift.motion, units=_NANO, notes=notes, provenance=drift.provenance)


def ground_text(ground: Ground) -> str:
    """Describe the material of the ground, and its source.

    >>> ground_text(Ground("steel", "as specified")), ground_text(Ground("steel", "material of all links on it"))
    ('Ground made of steel', 'Ground assumed to be steel: material of all links on it')
    """
    if ground.material is None:
        return "Ground without expansion"
    return f"Ground made of {ground.material}" if ground.stated else f"Ground assumed to be {ground.material}: {ground.source}"


def error_budget_tables(budget: ErrorBudget) -> tuple[Table, ...]:
    """Tabulate the largest errors by axis and source, without and with correction of lost motion in the command.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.assessment.budget import budget
    >>> error_budget_tables(budget(double_triangle(), {"z": 1e-5}))[0].texts()[3][:2]
    ['z [nm]', '336.76']
    """
    sums = first_design(budget.sums.values, 2)
    titles = {"Error budget, command by ideal mapping": budget.ideal, "Error budget, command corrected for lost motion": budget.corrected}
    shown = {"Error budget in open loop, with forces from the elastic model": budget.ideal} if budget.forced else titles
    return tuple(
        _budget_table(title, matrix, sums[:, 2 * index : 2 * index + 2], budget) for index, (title, matrix) in enumerate(shown.items())
    )


def _budget_table(title: str, matrix: Matrix, sums: Array, budget: ErrorBudget) -> Table:
    values = np.concatenate([first_design(matrix.values, 2), sums], axis=1)
    columns = (*matrix.columns, "linear sum", "root sum square")
    warm = number(single(budget.temperature))
    warmed = "" if "drift" in budget.reasons else f", with {warm} K of uniform temperature change"
    notes = [f"Largest errors over all combinations of {command_text(budget.command)}{warmed}."]
    known = {name: not np.all(np.isnan(values[:, place])) for place, name in enumerate(matrix.columns)}
    if known["gauge noise"]:
        notes += [f"Gauge noise: {budget.coverage:g} standard deviations. Quantisation: half a step of every gauge, with the worst signs."]
    if any(known.get(name) for name in NOISES):
        notes += [f"Actuator noise and floor vibration: {budget.coverage:g} standard deviations of the motion relative to the ground."]
    notes += ["Actuator steps: half a step of every stepping drive, with the worst signs."] if STEPS in matrix.columns else []
    notes += [] if budget.ground is None else [f"{ground_text(budget.ground)}."]
    missing = [name for name in budget.missing if name not in budget.reasons]
    notes += [f"Not included, because not specified: {', '.join(missing)}."] if missing else []
    for reason in dict.fromkeys(budget.reasons.values()):
        unknown = ", ".join(name for name, each in budget.reasons.items() if each == reason)
        notes += [f"Not included, because unknown: {unknown} ({reason})."]
    found = Matrix(values, COMPONENTS, columns, ratio_units(TWIST_UNITS, ("1",) * len(columns)))
    return matrix_table(title, found, units=_NANO, notes=notes, provenance=budget.provenance)


def gauge_drift_table(drift: Drift) -> Table | None:
    """Tabulate the drift of gauge readings per kelvin; `None` without gauges.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.linear_statics.drift import drift
    >>> stage = double_triangle()
    >>> gauge_drift_table(drift(stage, fs.lumped(stage), ground="steel")).texts()[1][0]
    'S1 [um]'
    """
    return matrix_table("Change of gauge readings with temperature", drift.gauges) if drift.gauges.rows else None
