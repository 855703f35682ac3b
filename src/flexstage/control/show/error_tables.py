"""Tables of what a loop is there for: errors at rest without it, noise with it, hysteresis with and without inverse."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from flexstage.base.number import Array
from flexstage.control.compensation import StaticError
from flexstage.control.noise import NoiseBudget
from flexstage.control.show.tables import motion_cell
from flexstage.control.simulation.result import Simulated
from flexstage.control.study.rest import RestErrors
from flexstage.control.study.runs import RestRms
from flexstage.control.study.stacks import Sweep
from flexstage.control.study.study import LoopStudy
from flexstage.control.white_noise import Kind
from flexstage.show.display import NO_VALUE, format_value, number, percent
from flexstage.show.table import Cell, Column, Mark, Table, make_table, row_table
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

_SILENT = 1e-12
_STANDS_OUT = 1e-3


def rest_table(found: RestErrors) -> Table:
    """Errors at rest in open loop by coordinate: its own, and its largest crosstalk, by the ideal map and by corrected gains."""
    pairs = (("by R_a", found.ideal_map), ("corrected", found.lost_motion_gains))
    heads = ["command", *(head for noun, _ in pairs for head in (Column(f"error {noun}"), Column("crosstalk")))]
    names, errors = found.ideal_map.error.rows, [each for _, each in pairs]
    rows = [(Cell(name, Mark.STRONG), *_error_and_crosstalk(errors, index)) for index, name in enumerate(names)]
    return make_table("Static errors without the loop", heads, rows, notes=list(_rest_notes(found)))


def _rest_notes(found: RestErrors) -> Iterator[str]:
    yield (
        "Commanded less reached, per unit commanded, by strokes R_a x and by those that correct lost motion; crosstalk: the largest motion "
        "elsewhere in every unit, and which."
    )
    if found.other_gains is not None:
        yield (
            f"With the gains of the {found.other_model.value} model the largest error is {percent(found.other_gains.largest, 3)}, by R_a "
            f"{percent(found.ideal_map.largest, 3)}, rotations as lengths."
        )
    if np.any(np.abs(found.load) > 0.0):
        yield f"Loads, strokes held: {_twist(found.load, found.load)}; their strokes fed forward: {_twist(found.load_left, found.load)}."


def _error_and_crosstalk(found: Sequence[StaticError], column: int) -> Iterator[Cell]:
    for each in found:
        values = np.asarray(each.error.values)
        yield _share(float(values[column, column]))
        units = [row[column] for row in each.error.unit]
        largest = [_largest_elsewhere(values[:, column], units, unit, column) for unit in dict.fromkeys(units)]
        told = [f"{_with_unit(float(values[row, column]), units[row])} {each.error.rows[row]}" for row in largest if row is not None]
        yield Cell(", ".join(told)) if told else Cell(NO_VALUE, Mark.FAINT)


def _largest_elsewhere(values: Array, units: Sequence[str], unit: str, own: int) -> int | None:
    """Where the largest of a unit stands, but for its own; `None` where there is none. Metres and radians are not compared."""
    places = [row for row, each in enumerate(units) if each == unit and row != own and abs(values[row]) >= _SILENT]
    return max(places, key=lambda row: abs(float(values[row])), default=None)


def _with_unit(value: float, unit: str) -> str:
    return percent(value, 3) if unit == "1" else format_value(value, unit, 3)


def _share(value: float) -> Cell:
    return Cell("0", Mark.FAINT) if abs(value) < _SILENT else Cell(percent(value, 4))


def _twist(values: Array, against: Array) -> str:
    """The components of a twist that stand out against another."""
    scale = {unit: max(abs(float(value)) for value, each in zip(against, TWIST_UNITS, strict=True) if each == unit) for unit in TWIST_UNITS}
    parts = [
        f"{name} {format_value(float(value), unit, 3)}"
        for name, value, unit in zip(COMPONENTS, values, TWIST_UNITS, strict=True)
        if abs(value) > _STANDS_OUT * scale[unit]
    ]
    return ", ".join(parts) or "nothing"


def noise_table(found: LoopStudy) -> Table:
    """The rms of every coordinate at rest by kind of source, and as simulated."""
    budget, resting = found.noise, found.resting
    squares = np.asarray(budget.by_kind.values)
    simulated = None if found.still is None else found.simulated_rms
    heads = ["motion", Column("rms"), *([] if resting is None else [Column("interval"), Column("as if white")])]
    heads += [Column(kind.value) for kind in budget.kinds]
    heads += [Column("simulated")] if simulated is not None and resting is None else []
    rows = []
    for index, channel in enumerate(budget.outputs):
        cells = [motion_cell(float(np.sqrt(value)), channel.unit) for value in squares[index]]
        total = motion_cell(float(budget.rms[index]), channel.unit)
        if resting is not None:
            ends = (format_value(float(each[index]), channel.unit, 3) for each in (resting.low, resting.high))
            told = [motion_cell(float(resting.rms[index]), channel.unit), Cell(" to ".join(ends)), replace(total, mark=Mark.FAINT), *cells]
        else:
            told = [total, *cells, *([] if simulated is None else [motion_cell(float(simulated[index]), channel.unit)])]
        rows.append((Cell(channel.name.removeprefix("relative."), Mark.STRONG), replace(told[0], mark=Mark.STRONG), *told[1:]))
    return make_table("Noise at rest", heads, rows, notes=_noise_notes(budget, found.still, resting))


def _noise_notes(budget: NoiseBudget, still: Simulated | None, resting: RestRms | None) -> Sequence[str]:
    first = "Rms of the platform's true motion against the ground; squares add up."
    if resting is not None:
        first = (
            f"Rms of the platform's true motion against the ground, of {resting.count} simulations of {number(resting.seconds, 3)} s "
            "with all noise, rounding and limits, and the interval that holds it by 95 %. Squares of the sources add up to what is told "
            "as if rounding were white, not to the rms."
        )
    first += f" The floor from {number(budget.band[0], 3)} to {number(budget.band[1], 4)} Hz." if Kind.FLOOR in budget.kinds else ""
    more = []
    if still is not None and resting is None:
        seconds = number(float(still.times[-1]), 3)
        more = [f"Simulated: {seconds} s of the same noise, rounding and limits included; chance parts it from the budget."]
    return [first, *more, *(f"{each[0].upper()}{each[1:]}." for each in budget.notes)]


def hysteresis_table(sweep: Sweep) -> Table:
    """Stacks with hysteresis: width of their loops, error in open loop without and with the inverse."""
    note = "Stacks alone, in open loop: strokes that came less those wanted, as a share of the range swept."
    return row_table("Hysteresis of the stacks", sweep, "width", "range", "rms_error", "rms_error_inverse", "improvement", notes=[note])
