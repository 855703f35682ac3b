"""Tables of a loop: controller, stability, margins, steps, trajectories, errors and noise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest

import numpy as np

from flexstage.base.labelled import Matrix
from flexstage.base.record import walked_fields
from flexstage.control.plant_models.retention import Retention
from flexstage.control.study.choices import ControllerKind
from flexstage.control.study.compare import Comparison
from flexstage.control.study.rest import RestErrors
from flexstage.control.study.runs import Run
from flexstage.control.study.study import LoopStudy
from flexstage.control.white_noise import Kind
from flexstage.show.display import number, percent
from flexstage.show.table import (
    Cell,
    Mark,
    Table,
    array_table,
    column_table,
    make_table,
    matrix_table,
    result_table,
    row_table,
    short_names,
)
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

_LEAST_DAMPED, _MOVED = 0.01, 1e-3
_TRACKING = ("measured rms", "measured peak", "true rms", "true peak")
_AIMS = ("rejection", "noise", "settling", "overshoot", "delay margin", "peak of S")
"""Compared quantities, in column order."""
_BY_COORDINATE = ("rejection", "noise", "settling", "overshoot")


def loop_tables(found: LoopStudy) -> list[Table | None]:
    """Tabulate the loop and its components: charge drive, force feedback, controller."""
    return [loop_table(found), *_charge_tables(found), *_damping_tables(found), *_controller_tables(found)]


def short_tables(found: LoopStudy) -> list[Table | str | None]:
    """Tabulate loop, bandwidth, margins, time responses, positioning noise and hysteresis, without notes.

    The loop table keeps the tuning note, which names missed limits. For an unstable loop, the loop table keeps all notes.
    """
    margins, noise = margin_tables(replace(found, disk_margin=None)), error_tables(replace(found, static_errors=None))
    parts = [*_charge_tables(found), *_damping_tables(found), *measured_tables(found), *time_tables(found.runs), *noise]
    shown = [replace(each, notes=()) for each in (loop_table(found), *margins, *parts) if each is not None]
    first = loop_table(found)
    shown[0] = first if not found.stability.stable else replace(first, notes=first.notes[: found.controller.tuning is not None])
    return [*shown, "Use --full for all tables and notes, --report FILE for a page with figures."]


def loop_table(found: LoopStudy) -> Table:
    """Tabulate the loop and its stability.

    Each row combines several results.
    """
    plant, hardware = found.plant, found.plant.hardware
    delay = f"{number(1e6 * hardware.delay, 4)} us"
    modes = f"{count_modes(len(plant.frequencies))} up to {number(plant.frequencies[-1], 4)} Hz, {plant.left_out} as static compliance"
    rows = [
        ("stability", Cell(stability_text(found), Mark.PASS if found.stability.stable else Mark.FAIL)),
        ("controller", controller_text(found)),
        ("coordinates", ", ".join(plant.coordinates.names)),
        ("sampling", f"{number(found.settled.rate, 5)} Hz, output delay {delay}, zero-order hold"),
        ("plant", f"{found.model_name}, {modes}"),
        ("feedforward", ", ".join(each.value for each in found.setup.compensate) or "none"),
    ]
    notes = [f"{found.stability.sentence[0].upper()}{found.stability.sentence[1:]}.", f"{plant.note[0].upper()}{plant.note[1:]}."]
    if found.peaks is not None:
        peaks = {"sensitivity Ms": found.peaks.sensitivity, "complementary sensitivity Mt": found.peaks.complementary}
        rows += [(f"peak {name}", f"{number(each.value, 4)} at {number(each.frequency, 4)} Hz") for name, each in peaks.items()]
        notes += [
            (
                "The sensitivity S is the error per disturbance; where S exceeds 1, the loop amplifies disturbances. The complementary "
                "sensitivity is T = 1 - S."
            ),
            "Peak sensitivities are computed without mode shifts.",
        ]
    if not found.retention.complete or found.retention.frequency is not None:
        notes.append(_retained(found.retention))
    if found.controller.tuning is not None:
        notes.insert(0, f"Tuned: {found.controller.tuning.reason}.")
    return make_table("Loop", ["", "value"], [(Cell(name, Mark.STRONG), value) for name, value in rows], notes=notes)


def stability_text(found: LoopStudy) -> str:
    """Return whether the loop is stable, as a word."""
    return "stable" if found.stability.stable else "unstable"


def _retained(found: Retention) -> str:
    """Number of retained modes, and the reason."""
    count = f"The plant retains {count_modes(found.retained)} of the model's {found.total}"
    if not found.complete:
        return (
            f"{count}, as specified. Omitted modes that are significant with this controller: {int(np.sum(found.wanted)) - found.retained}."
        )
    largest = f"{number(found.gain, 3)} at resonance ({number(found.frequency or 0.0, 4)} Hz)"
    change = "make a margin appear or vanish" if np.isinf(found.change) else f"change margins by at most {percent(found.change)}"
    why = "selected by their loop gain with this controller. Omitted modes contribute their static compliance"
    return f"{count}, {why}. The largest loop gain of an omitted mode is {largest}. All omitted modes together {change}."


def count_modes(count: int) -> str:
    """Format a number of modes.

    >>> count_modes(1), count_modes(18)
    ('1 mode', '18 modes')
    """
    return f"{count} mode" if count == 1 else f"{count} modes"


def controller_text(found: LoopStudy) -> str:
    """Describe the controller: its kind, coordinates and notch frequencies."""
    asked = found.setup.controller
    if asked.law is ControllerKind.NONE:
        return "none: open loop"
    where = f"{kind_name(asked.law.value)} in {asked.coordinates.value} coordinates"
    frequencies = sorted({round(each.frequency, 1) for each in found.controller.notches})
    return f"{where}, notches at {', '.join(f'{each:g}' for each in frequencies)} Hz" if frequencies else where


def _damping_tables(found: LoopStudy) -> list[Table | None]:
    """Integral force feedback by mode of the plant, and the remaining stiffness."""
    inner = found.damping
    if inner is None:
        return []
    corner = f"{number(inner.corner, 4)} Hz" + ("" if inner.rate is None else f", sampled at {number(1e-3 * inner.rate, 4)} kHz")
    note = f"Gain {number(inner.gain, 4)} 1/s, high-pass filter of order {inner.order} at {corner}, in the legs {', '.join(inner.legs)}."
    left_out = f"Modes with a maximum damping of {percent(_LEAST_DAMPED)} or less are omitted."
    return [result_table([each for each in inner.modes if each.most > _LEAST_DAMPED], notes=[note, left_out]), result_table(inner)]


def _charge_tables(found: LoopStudy) -> list[Table | None]:
    """Stacks at constant charge, and the modes changed by it."""
    held = found.charge
    if held is None:
        return []
    moved = held.rise > _MOVED
    shown = replace(held, by_volts=held.by_volts[moved], by_charge=held.by_charge[moved])
    note = f"Modes that change by {percent(_MOVED)} or less are omitted."
    return [result_table(held), array_table("Modes with charge drive", shown, "by_volts", "by_charge", "rise", notes=[note])]


def _controller_tables(found: LoopStudy) -> list[Table | None]:
    """Controller parameters, loop by loop, and its filters; none for other controllers than single loops."""
    loops = found.controller.loops
    if not loops:
        return []
    laws = {name: each.law for name, each in loops.items()}
    numbers = (each.name for each in walked_fields(type(next(iter(laws.values())))))
    note = "Gains are from the error of a loop to its command, both in metres; rotations are multiplied by the stage's length."
    filtered = {name: each for name, each in loops.items() if each.notches or each.prefilter}
    return [row_table("Controller", laws, *numbers, head="loop", notes=[note]), result_table(filtered)]


def margin_tables(found: LoopStudy) -> list[Table | None]:
    """Tabulate bandwidth and margins by coordinate; no tables in open loop."""
    margins = None if found.margins is None else found.margins.loops
    shifted = {percent(each.shift): each for each in found.shifted_peaks}
    return [result_table(each) for each in (found.bandwidths, margins, found.disk_margin, shifted or None) if each is not None]


def measured_tables(found: LoopStudy) -> list[Table]:
    """Tabulate margins from measured responses, the identified model and the design model; no tables without a test."""
    seen = found.measured
    if seen is None:
        return []
    low, high = seen.band
    notes = [
        f"Computed at {seen.lines} frequencies from {number(low, 4)} to {number(high, 4)} Hz; between them, a peak may be higher.",
        "Measurement noise lowers the computed gain margin where the response is small.",
        "The loop was tuned with the identified model. The design model does not include the identified delay.",
    ]
    readings = ("value", "low", "high", "fitted", "predicted")
    margins = {"Gain margin": "gain_high", "Phase margin": "phase", "Sensitivity crossover": "rejection"}
    return [
        row_table("Peak sensitivity Ms, measured responses", [seen.peak], *readings, notes=notes),
        *(
            row_table(f"{title}, measured responses", seen.loops, *(f"{field}.{each}" for each in readings), head="loop")
            for title, field in margins.items()
        ),
    ]


def time_tables(runs: Sequence[Run]) -> list[Table | None]:
    """Tabulate steps, tracking errors, learning, limits, and the load of actuators."""
    simulated = {run.course.name: run.simulated for run in runs}
    lost = {name: each for name, each in simulated.items() if np.any(each.out_of_range)}
    followed = {run.course.name: run.tracking for run in runs if run.figures is None}
    return [
        result_table({run.course.name: run.step for run in runs if run.step is not None}),
        *(column_table(f"Tracking error, {name}", replace(each, columns=_TRACKING), head="coordinate") for name, each in followed.items()),
        result_table({name: each for name, each in simulated.items() if np.any(each.saturated + each.slewing)}),
        row_table("Gauges out of range", lost, "out_of_range", head="trajectory, gauge") if lost else None,
        result_table({run.course.name: run.learned for run in runs if run.learned is not None}),
        result_table({run.course.name: run.repeated for run in runs if run.repeated is not None}),
        result_table({(run.course.name, name): each for run in runs for name, each in run.heat.items()}),
        result_table({(run.course.name, name): each for run in runs for name, each in run.legs.items()}),
    ]


def error_tables(found: LoopStudy) -> list[Table | None]:
    """Tabulate static errors in open loop, noise in closed loop, hysteresis of the stacks."""
    static = found.static_errors
    return [
        *([] if static is None else [*static_error_tables(static), _load_table(static)]),
        noise_table(found),
        None if found.hysteresis is None else result_table(found.hysteresis),
    ]


def static_error_tables(found: RestErrors) -> list[Table]:
    """Tabulate static errors in open loop, without and with correction of lost motion.

    Rows are the reached coordinates, columns the commanded coordinates.
    """
    errors = {"the ideal mapping R_a": found.ideal_map, "lost-motion gains": found.lost_motion_gains}
    if found.other_gains is not None:
        errors[f"lost-motion gains of the {found.other_model.value} model"] = found.other_gains
    largest = ", ".join(f"{percent(each.largest, 3)} with {name}" for name, each in errors.items())
    notes = [
        "The error is the commanded minus the reached pose, for strokes from the ideal mapping R_a.",
        f"The largest error, with rotations converted to lengths, is {largest}.",
    ]
    error, corrected = found.ideal_map.error, found.lost_motion_gains.error
    return [
        matrix_table("Static errors without the loop", error, notes=notes),
        matrix_table("Static errors with lost motion corrected", corrected, against=error),
    ]


def _load_table(found: RestErrors) -> Table | None:
    """Deflection of the platform by its loads; `None` without loads."""
    if not np.any(found.load):
        return None
    values, units = np.stack([found.load, found.load_left], axis=-1), tuple((unit, unit) for unit in TWIST_UNITS)
    moved = Matrix(values, COMPONENTS, ("actuators fixed", "with load feedforward"), units)
    return column_table("Deflection by loads", moved, head="along")


def noise_table(found: LoopStudy) -> Table:
    """Tabulate the rms positioning noise of every coordinate in regulation: in total, by kind of source, and from a simulation."""
    budget, resting = found.noise, found.resting
    columns = {"rms": budget.rms}
    if resting is not None:
        columns = {"rms": resting.rms, "95 %, low": resting.low, "95 %, high": resting.high, "white quantisation": budget.rms}
    columns |= dict(zip(budget.by_kind.columns, np.sqrt(np.asarray(budget.by_kind.values)).T, strict=True))
    if resting is None and found.simulated_rms is not None:
        columns["simulated"] = found.simulated_rms
    units = tuple((unit,) * len(columns) for unit in budget.units)
    matrix = Matrix(np.stack([*columns.values()], axis=-1), short_names(budget.output_names), tuple(columns), units)
    return column_table("Positioning noise, regulated", matrix, head="coordinate", notes=_noise_notes(found))


def _noise_notes(found: LoopStudy) -> tuple[str, ...]:
    budget, still, resting = found.noise, found.still, found.resting
    notes = ["Values are the rms of the platform's true motion relative to the ground. The mean squares of all sources add up."]
    if resting is not None:
        notes.append(f"The rms is from {resting.count} simulations of {number(resting.seconds, 3)} s, with rounding and amplifier limits.")
    elif still is not None:
        notes.append(f"Simulated values are from {number(still.times[-1], 3)} s of simulation, with rounding and amplifier limits.")
    if Kind.FLOOR in budget.kinds:
        notes.append(f"Floor vibration is included from {number(budget.band[0], 3)} to {number(budget.band[1], 4)} Hz.")
    return (*notes, *(f"{each[0].upper()}{each[1:]}." for each in budget.notes))


def comparison_tables(found: Comparison) -> list[Table | None]:
    """Tabulate the compared controllers, then the values of each controller by coordinate."""
    named = {kind_name(name): each for name, each in found.controllers.items()}
    best = "; ".join(f"{aim}: {kind_name(name)}" for aim, name in found.wins.items())
    slow = [name for name, each in named.items() if each.slowly_rounding]
    notes = [
        *([f"Quantisation is counted as white noise, but it is not white with {'; '.join(slow)}; see flexstage loop."] if slow else []),
        f"Best in {best}. The best noise is the lowest geometric mean of all coordinates.",
        f"Pareto-optimal in crossover, noise, settling and delay margin: {'; '.join(map(kind_name, found.front))}.",
        *(f"{kind_name(name)} is not possible: {reason}" for name, reason in found.reasons.items()),
    ]
    table = result_table(named, notes=notes)
    return [
        table and _mark_best(table, found),
        row_table("Comparison by coordinate", named, *_BY_COORDINATE, head="controller, coordinate"),
    ]


def _mark_best(table: Table, found: Comparison) -> Table:
    """Table of the comparison with the best value of each column marked."""
    wins = [found.wins.get(aim) for aim in _AIMS]
    rows = (
        (first, *(replace(cell, mark=Mark.PASS) if name == best else cell for cell, best in zip_longest(cells, wins)))
        for name, (first, *cells) in zip(found.controllers, table.rows, strict=True)
    )
    return replace(table, rows=tuple(rows))


def kind_name(name: str) -> str:
    """Return the printed name of a controller kind.

    >>> kind_name("pi, damped"), kind_name("resonant")
    ('PI, damped', 'resonant')
    """
    first, *rest = name.split(",")
    return ",".join([first.upper() if len(first) < 4 else first, *rest])
