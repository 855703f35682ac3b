"""Tables of the solid model: hinges, units and the stage by finite elements, compared with theory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexstage.show.display import NO_VALUE, number, percent, preferred_unit
from flexstage.show.table import Cell, Column, Mark, Table, array_table, make_table, matrix_table, result_table, row_table
from flexstage.solid.fea.hinges.hinge_form import NO_ESTIMATE
from flexstage.solid.fea.solver.ties import in_words
from flexstage.solid.results.stress import SHARP_CORNERS, SILENT
from flexstage.spatial.frame import COMPONENTS

if TYPE_CHECKING:
    from flexstage.solid.results.calibration import Calibration
    from flexstage.solid.results.hinges import SolidHinge
    from flexstage.solid.results.resolution import Converged
    from flexstage.solid.results.stage import SolidStage
    from flexstage.solid.results.stress import LinkStress
    from flexstage.solid.results.units import SolidUnit
    from flexstage.solid.results.verification import Row, Verification

_LISTED = 12


def hinge_table(found: Mapping[str, SolidHinge]) -> Table:
    """Tabulate every distinct hinge: support of each end (block or rigid), direct compliances about the centre, and estimated error.

    >>> hinge_table({}).texts()[0][:4]
    ['part', 'links', 'ends on', 'x [um/N]']
    """
    forms = [preferred_unit("m/N")] * 3 + [preferred_unit("rad/(N m)")] * 3
    rows = [
        (
            Cell(name, Mark.STRONG),
            ", ".join(hinge.links),
            ", ".join("block" if grows else "rigid" for grows in (hinge.roots.first, hinge.roots.second)),
            *(
                number(form.factor * value, 5) if known else NO_VALUE
                for form, value, known in zip(forms, np.diag(hinge.found.compliance), hinge.separable, strict=True)
            ),
            _error(hinge.error),
        )
        for name, hinge in found.items()
    ]
    heads = [*(Column(axis, form.unit) for axis, form in zip(COMPONENTS, forms, strict=True)), Column("error")]
    note = (
        "Compliance of the hinge between the ends of its arcs, about its centre, in its link frame. Error: largest estimate for any entry. "
        "The compliance of roots at blocks is included; the ground and bodies without outlines are rigid. "
        f"{NO_VALUE}: compliance that cannot be separated from the adjacent blocks."
    )
    notes = [note, *([f"Error {NO_VALUE}: {NO_ESTIMATE}."] if any(hinge.error is None for hinge in found.values()) else [])]
    return make_table("Compliance of hinges as solids", ["part", "links", "ends on", *heads], rows, notes=notes)


def hinge_matrices(found: Mapping[str, SolidHinge]) -> Iterator[Table]:
    """Make a table of the 6x6 compliance matrix of every distinct hinge.

    >>> list(hinge_matrices({}))
    []
    """
    for name, hinge in found.items():
        yield matrix_table(f"Compliance of {name}", hinge.compliance)


def _largest_error(name: str, found: Converged[dict[str, SolidUnit]]) -> float | None:
    """The largest error of a unit's figures, if all are estimated."""
    if any(figure.startswith(f"{name}: ") for figure in found.unestimated):
        return None
    return max((error for figure, error in found.errors.items() if figure.startswith(f"{name}: ")), default=None)


def solid_unit_table(found: Converged[dict[str, SolidUnit]]) -> Table | None:
    """Tabulate the isolated units: axial stiffness K_a, lateral stiffness K_l, gain, lost motion, and highest stress at the full stroke.

    >>> from flexstage.solid.results.resolution import Converged
    >>> solid_unit_table(Converged({}, {}, 3)) is None
    True
    """
    errors = ", ".join(f"{name} {_error(_largest_error(name, found))}" for name in found.result)
    note = f"Elements of order {found.order}; largest estimated error of K_a, K_l and gain: {errors}."
    return result_table(found.result, notes=[note])


def command_table(name: str, unit: SolidUnit) -> Table:
    """Tabulate the output and the lost motion of a unit over its stroke (as in Table 2 of Shin & Moon)."""
    return array_table(f"Output and lost motion of the {name} unit over its stroke", unit, "strokes", "commands", "outputs", "lost")


def stress_table(title: str, stress: LinkStress | None) -> Table | None:
    """Tabulate the highest von Mises stress of links and bodies, highest first; `None` without significant stress."""
    if stress is None or not np.max(stress.highest) >= SILENT:
        return None
    notes = [f"Von Mises stress on the surface; stacks are left out. {SHARP_CORNERS}"]
    if len(stress.names) > _LISTED:
        notes.append(f"Not listed: {len(stress.names) - _LISTED} more links or bodies with lower stress.")
    return row_table(title, stress.largest(_LISTED), "highest", "yield_stress", "safety", head="link or body", notes=notes)


def block_table(stage: SolidStage) -> Table:
    """Tabulate the effect of the elasticity of bodies on each platform mode, compared with rigid bodies."""
    found = stage.modes
    names = {"platform mode": range(1, len(found.platform) + 1), "name": [found.names[index] for index in found.platform]}
    notes = ["Frequency change: to first order, relative to rigid bodies.", *_stated_note(stage.as_stated)]
    return array_table("Elasticity of the bodies", stage.bodies, "strain_energy_share", "cost_in_frequency", names=names, notes=notes)


def _stated_note(stated: Mapping[str, str]) -> list[str]:
    """Note on links that are not meshed."""
    return [f"Not meshed: {in_words(stated)} ({', '.join(stated)})."] if stated else []


def verification_table(rows: tuple[Row, ...]) -> Table | None:
    """Tabulate theory and FEA for one group of rows, with their difference, the estimated FEA error and the verdict.

    >>> from flexstage.solid.results.verification import Row
    >>> table = verification_table((Row("stage", "mode 1", "Hz", 101.0, 100.0, 0.001),))
    >>> [] if table is None else table.texts()[1]
    ['mode 1', '101', '100', '0.1 %', '1 %', 'theory suffices']
    """
    return result_table(rows, notes=[f"{row.figure}: {row.reason}." for row in rows if row.reason])


def _error(error: float | None) -> str:
    return NO_VALUE if error is None or not np.isfinite(error) else percent(error, 2)


def verdict_table_of(found: Verification) -> Table:
    """Tabulate the verdict on theory by group, as text."""
    rows = [(Cell(name, Mark.STRONG), text) for name, text in found.verdicts.items()]
    notes = [
        "Theory: beam theory for hinges, the lumped model for units and stage.",
        "Calibrated: the lumped model with compliance matrices of its hinges from FEA; it is therefore not independent of FEA.",
        "The error of FEA is an estimate from two resolutions, not a bound.",
        *_stated_note(found.as_stated),
        *(f"Not compared: {name}: {reason}" for name, reason in found.reasons.items()),
    ]
    return make_table("Verdicts", ["subject", "verdict"], rows, notes=notes)


def calibration_table(found: Calibration) -> Table:
    """Tabulate the relative difference in compliance between FEA and beam theory, one column for each axis."""
    rows = [
        (
            Cell(name, Mark.STRONG),
            ", ".join(found.hinges[name].links),
            *(percent(float(value), 3) for value in values),
            _error(found.hinges[name].error),
        )
        for name, values in found.over_beam_theory.items()
    ]
    heads = ["part", "links", *(Column(axis) for axis in COMPONENTS), Column("FEA error")]
    note = "Positive: FEA is softer. - %: value of beam theory, because FEA cannot separate the hinge from the adjacent blocks."
    return make_table("Difference in compliance between FEA and beam theory", heads, rows, notes=[note])
