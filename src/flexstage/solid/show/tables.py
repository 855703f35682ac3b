"""Tables of the solid model: hinges, units and the stage by finite elements, and theory beside them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexstage.analysis.trust import Trust
from flexstage.base.labelled import NOISE
from flexstage.show.display import NO_VALUE, align_numbers, format_value, number, percent, preferred_unit
from flexstage.show.table import Cell, Column, Mark, Table, make_table, matrix_table, row_table
from flexstage.solid.fea.hinges.hinge_form import NO_ESTIMATE
from flexstage.solid.fea.solver.ties import in_words

if TYPE_CHECKING:
    from flexstage.solid.results.calibration import Calibration
    from flexstage.solid.results.hinges import SolidHinge
    from flexstage.solid.results.resolution import Converged
    from flexstage.solid.results.stage import SolidStage
    from flexstage.solid.results.stress import LinkStress
    from flexstage.solid.results.units import SolidUnit
    from flexstage.solid.results.verification import Row, Verification

_AXES = ("x", "y", "z", "rx", "ry", "rz")
_LISTED = 12
_SILENT = 1e3
"""Stress [Pa] below which there is none."""
_CORNERS = "At sharp inner corners the true stress has no limit: there it grows with the resolution."
_MARKS = {
    Trust.DEPENDENT: Mark.FAINT,
    Trust.EITHER: Mark.PASS,
    Trust.THEORY: Mark.PASS,
    Trust.CALIBRATED: Mark.WARN,
    Trust.UNCLEAR: Mark.WARN,
    Trust.FEA: Mark.FAIL,
}


def hinge_table(found: Mapping[str, SolidHinge]) -> Table:
    """Every distinct hinge: what it grows on, the six direct compliances about its centre, and the error estimated.

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
    heads = [*(Column(axis, form.unit) for axis, form in zip(_AXES, forms, strict=True)), Column("error")]
    note = (
        "Compliance about the centre of the hinge between the ends of its arcs, in its link frame. Error: of any entry, estimated. "
        "Where a hinge ends on a block, it includes what the block yields at its root; the ground and bodies without outlines are rigid. "
        f"{NO_VALUE}: it cannot be told from that of the blocks beside the hinge."
    )
    notes = [note, *([f"Error {NO_VALUE}: {NO_ESTIMATE}."] if any(hinge.error is None for hinge in found.values()) else [])]
    return make_table("Hinges as solids", ["part", "links", "ends on", *heads], rows, notes=notes)


def hinge_matrices(found: Mapping[str, SolidHinge]) -> Iterator[Table]:
    """The 6x6 compliance of every distinct hinge.

    >>> list(hinge_matrices({}))
    []
    """
    for name, hinge in found.items():
        yield matrix_table(f"Compliance of {name}", hinge.compliance)


def _largest_error(name: str, found: Converged[dict[str, SolidUnit]]) -> float | None:
    """The largest error of a unit's figures, where all are estimated."""
    if any(figure.startswith(f"{name}: ") for figure in found.unestimated):
        return None
    return max((error for figure, error in found.errors.items() if figure.startswith(f"{name}: ")), default=None)


def solid_unit_table(found: Converged[dict[str, SolidUnit]]) -> Table:
    """Every distinct unit alone: K_a, K_l, gain, loss, and the highest stress at the full stroke.

    >>> from flexstage.solid.results.resolution import Converged
    >>> solid_unit_table(Converged({}, {}, 3)).texts()[0][:3]
    ['unit', 'copy', 'axial K_a']
    """
    rows = [
        (
            Cell(name, Mark.STRONG),
            unit.copy,
            format_value(unit.axial, "N/m"),
            " to ".join(format_value(value, "N/m", 4) for value in unit.lateral),
            f"{number(unit.gain)} of {number(unit.ideal_gain)}",
            percent(unit.loss if abs(unit.loss) > 1e-6 else 0.0),
            *_weakest(unit.stress),
            _error(_largest_error(name, found)),
        )
        for name, unit in found.result.items()
    ]
    heads = ["unit", "copy", Column("axial K_a"), Column("lateral K_l"), Column("gain"), Column("loss")]
    heads += ["weakest", Column("stress", "MPa"), Column("safety"), Column("error")]
    notes = [
        "Each unit alone, output on a rigid face. Stiffness: strokes held, all other motions of the output prevented.",
        "Gain and stress: output guided along its direction and not loaded, full stroke. " + _CORNERS,
        f"Elements of order {found.order}; error: the largest of K_a, K_l and gain, estimated.",
    ]
    return make_table("Units alone as solids", heads, rows, notes=notes)


def _weakest(stress: LinkStress | None) -> tuple[str, str, str]:
    if stress is None:
        return NO_VALUE, NO_VALUE, NO_VALUE
    at = stress.names.index(stress.weakest)
    safety = float(stress.safety[at])
    low = stress.highest[at] < _SILENT
    return (
        NO_VALUE if low else stress.names[at],
        number(1e-6 * float(stress.highest[at]), 4) if not low else "0",
        NO_VALUE if low or np.isnan(safety) else number(safety, 4),
    )


def command_table(name: str, unit: SolidUnit) -> Table:
    """Output of a unit by command, and what is lost (the form of the paper's Table 2)."""
    lost = unit.commands - unit.outputs
    lost = np.where(np.abs(lost) < NOISE * np.abs(unit.commands), 0.0, lost)
    columns = [align_numbers(1e6 * values) for values in (unit.strokes, unit.commands, unit.outputs, lost)]
    heads = [Column("stroke", "um"), Column("commanded output", "um"), Column("output", "um"), Column("lost", "um")]
    return make_table(f"Output of the {name} unit by command", heads, list(zip(*columns, strict=True)))


def stress_table(title: str, stress: LinkStress | None, listed: int = _LISTED) -> Table | None:
    """The highest von Mises stress of links and bodies, highest first; `None` where there is none worth a line."""
    if stress is None or np.max(stress.highest) < _SILENT:
        return None
    notes = [f"Von Mises stress on the surface, stacks left out. {_CORNERS}"]
    if len(stress.names) > listed:
        notes.append(f"{len(stress.names) - listed} more with less stress are not listed.")
    return row_table(title, stress.largest(listed), "highest", "yield_stress", "safety", head="link or body", notes=notes)


def block_table(stage: SolidStage) -> Table:
    """What the elasticity of the bodies, rigid in all other models, takes from each platform mode."""
    rows = [
        (
            Cell(f"{number + 1}", Mark.STRONG),
            stage.modes.names[index],
            f"{stage.modes.frequencies[index]:.2f}",
            percent(float(stage.blocks[index]), 3),
            percent(float(stage.flexible[index]), 3),
        )
        for number, index in enumerate(stage.modes.platform)
    ]
    heads = ["platform mode", "name", Column("frequency", "Hz"), Column("strain energy in bodies"), Column("cost in frequency")]
    notes = ["Cost: what bodies of infinite stiffness would give back, to first order of the share.", *_stated_note(stage.as_stated)]
    return make_table("Elasticity of the bodies", heads, rows, notes=notes)


def _stated_note(stated: Mapping[str, str]) -> list[str]:
    """What is said of links that no finite elements were made of."""
    return [f"Not meshed: {in_words(stated)} ({', '.join(stated)})."] if stated else []


def verification_table(name: str, rows: tuple[Row, ...]) -> Table:
    """Theory beside FEA for one group of rows, with both errors and which to trust.

    >>> from flexstage.solid.results.verification import Row
    >>> verification_table("stage", (Row("stage", "mode 1", "Hz", 101.0, 100.0, 0.001),)).texts()[1]
    ['mode 1', '101 Hz', '100 Hz', '0.1 %', '1 %', 'theory will do']
    """
    columns: dict[str, list[str] | None] = {
        "mapped": _values(rows, [row.mapped for row in rows]),
        "theory": _values(rows, [row.theory for row in rows]),
        "calibrated": _values(rows, [row.calibrated for row in rows]),
        "FEA": _values(rows, [row.fea for row in rows]),
        "FEA's error": [_error(row.fea_error) for row in rows],
        "theory off": _differences([row.difference for row in rows]),
        "calibrated off": _differences([row.calibrated_difference for row in rows]),
    }
    known = {head: texts for head, texts in columns.items() if texts is not None}
    lines = [
        (Cell(row.figure, Mark.STRONG), *(texts[number] for texts in known.values()), _trust(row.trust)) for number, row in enumerate(rows)
    ]
    heads = ["figure", *(Column(head) for head in known), "trust"]
    shared = [row.modal_assurance for row in rows if row.modal_assurance is not None]
    notes = [f"Modes are paired by shape: modal assurance {np.floor(1e3 * min(shared)) / 1e3:.3f} and more."] if shared else []
    notes += [f"{row.figure}: {row.reason}." for row in rows if row.reason]
    return make_table(f"{name[:1].upper()}{name[1:]}: theory and finite elements", heads, lines, notes=notes)


def _trust(trust: Trust | None) -> Cell:
    return Cell("no verdict", Mark.WARN) if trust is None else Cell(trust.value, _MARKS[trust])


def _error(error: float | None) -> str:
    return NO_VALUE if error is None or not np.isfinite(error) else percent(error, 2)


def _values(rows: tuple[Row, ...], values: list[float | None]) -> list[str] | None:
    """A column of values, `None` where there is none at all."""
    if all(value is None for value in values):
        return None
    return [_value(row, value) for row, value in zip(rows, values, strict=True)]


def _value(row: Row, value: float | None) -> str:
    if value is None:
        return NO_VALUE
    return percent(value) if row.figure == "loss" else format_value(value, row.unit)


def _differences(values: list[float | None]) -> list[str] | None:
    if all(value is None for value in values):
        return None
    return [NO_VALUE if value is None else _signed(value) for value in values]


def _signed(share: float) -> str:
    text = percent(share, 2 if abs(share) < 0.1 else 3)
    return "0 %" if abs(share) < 5e-7 else text


def verdict_table_of(found: Verification) -> Table:
    """For every group, in words, which theory to trust."""
    rows = [(Cell(name, Mark.STRONG), text) for name, text in found.verdicts.items()]
    notes = [
        "Theory: beam theory for hinges, the lumped model for units and stage.",
        "Calibrated: the same with the 6x6 of its hinges from FEA, and so not independent of it.",
        "FEA's error is estimated from two resolutions: it is no bound.",
        *_stated_note(found.as_stated),
        *(f"Not compared: {name}: {reason}" for name, reason in found.reasons.items()),
    ]
    return make_table("Which to trust", ["what", "verdict"], rows, notes=notes)


def calibration_table(found: Calibration) -> Table:
    """By how much FEA finds the hinges softer than beam theory has them."""
    rows = [
        (
            Cell(name, Mark.STRONG),
            ", ".join(found.hinges[name].links),
            *(_signed(float(value)) for value in values),
            _error(found.hinges[name].error),
        )
        for name, values in found.over_beam_theory.items()
    ]
    heads = ["part", "links", *(Column(axis) for axis in _AXES), Column("FEA's error")]
    return make_table("Compliance by FEA over beam theory", heads, rows, notes=["Positive: softer than beam theory."])
