"""Tables of a loop: what it is, whether it is stable, how far from the edge, how it steps and follows."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from flexstage.base.storage.sheet import rows_of
from flexstage.control.controllers.notch import Notch
from flexstage.control.controllers.prefilter import Prefilter
from flexstage.control.plant_models.retention import Retention
from flexstage.control.robustness.disk import DiskMargin
from flexstage.control.robustness.measured_margins import Reading
from flexstage.control.simulation.result import Excursion
from flexstage.control.study.choices import ControllerKind
from flexstage.control.study.compare import Comparison, Rival
from flexstage.control.study.runs import Run, StepAnswer
from flexstage.control.study.study import LoopStudy
from flexstage.show.display import NO_VALUE, format_value, number, percent
from flexstage.show.table import Cell, Column, Content, Mark, Table, field_column, make_table

_SMALL, _NOTHING = 1e-12, 1e-16
_LEAST_DAMPED = 0.01
_MOVED = 1e-3
_FORCE_NOTE = (
    "Without stacks: frequency z without their axial stiffness. Most: (w - z)/(2 z), of one leg or decoupled ones. Alone: by this gain, "
    "no other mode near, none of its own damping and no lag of the amplifier."
)
_BANDWIDTH_NOTE = "Follows to: the true motion is 3 dB below its reference. Rejects to: |S| passes 1, disturbances above it are made worse."
_MARGIN_NOTE = (
    "Margins of one loop at a time, cut at the pose, the others closed. Disk margin alpha: gain and phase together may change by "
    "(1 + d/2)/(1 - d/2), |d| < alpha; 2 is the most there is."
)


def loop_table(found: LoopStudy) -> Table:
    """What the loop is, and whether it is stable."""
    plant, hardware = found.plant, found.plant.hardware
    delay = f"{number(1e6 * hardware.delay, 4)} us"
    modes = f"{count_modes(len(plant.frequencies))} up to {number(float(plant.frequencies[-1]), 4)} Hz, {plant.left_out} as a static term"
    rows = [
        ("stability", Cell("stable" if found.stability.stable else "unstable", Mark.PASS if found.stability.stable else Mark.FAIL)),
        ("controller", _controller(found)),
        ("coordinates", ", ".join(plant.coordinates.names)),
        ("clock", f"{number(found.settled.rate, 5)} Hz, outputs {delay} after the samples, held"),
        ("plant", f"{found.model_name}, {modes}"),
        ("fed forward", ", ".join(each.value for each in found.setup.compensate) or "nothing"),
    ]
    if found.peaks is not None:
        seen = found.peaks
        peak = f"S {number(seen.sensitivity.value, 4)} at {number(seen.sensitivity.frequency, 4)} Hz"
        rows.append(("highest peaks", f"{peak}, T {number(seen.complementary.value, 4)} at {number(seen.complementary.frequency, 4)} Hz"))
    notes = [f"{found.stability.sentence[0].upper()}{found.stability.sentence[1:]}.", f"{plant.note[0].upper()}{plant.note[1:]}."]
    if found.peaks is not None:
        notes.append("S: what the loop leaves of a disturbance, above 1 it adds to it. T: what it follows of a reference.")
        notes.append("Highest peaks: of modes as modelled.")
    if not found.retention.complete or found.retention.frequency is not None:
        notes.append(_retained(found.retention))
    if found.controller.tuning is not None:
        notes.insert(0, f"Tuned: {found.controller.tuning.reason}.")
    return make_table("Loop", ["what", "value"], [(Cell(name, Mark.STRONG), value) for name, value in rows], notes=notes)


def _retained(found: Retention) -> str:
    """How many modes are retained, and why no more."""
    count = f"Of the model's {count_modes(found.total)} {found.retained} are retained"
    if not found.complete:
        return f"{count}, as stated; {int(np.sum(found.wanted)) - found.retained} more matter to the loop with this controller."
    largest = f"a loop gain of {number(found.gain, 3)} at resonance ({number(found.frequency or 0.0, 4)} Hz)"
    change = "a margin appear or vanish" if np.isinf(found.change) else f"{percent(found.change)} of a margin"
    why = "by loop gain with this controller; of the others the static compliance"
    return f"{count}, {why}. Left out is {largest} at most; all that is left out changes {change} at most."


def count_modes(count: int) -> str:
    """How many modes.

    >>> count_modes(1), count_modes(18)
    ('1 mode', '18 modes')
    """
    return f"{count} mode" if count == 1 else f"{count} modes"


def _controller(found: LoopStudy) -> str:
    asked = found.setup.controller
    if asked.law is ControllerKind.NONE:
        return "none: open loop"
    where = f"{asked.law.value.upper() if len(asked.law.value) < 4 else asked.law.value} in {asked.coordinates.value} coordinates"
    frequencies = sorted({round(each.frequency, 1) for each in found.controller.notches})
    return f"{where}, notches at {', '.join(f'{each:g}' for each in frequencies)} Hz" if frequencies else where


def damping_table(found: LoopStudy) -> Table | None:
    """What force feedback does to each mode of the plant; `None` where there is none."""
    inner = found.damping
    if inner is None:
        return None
    rows = [
        (
            Cell(f"{number(each.frequency, 4)}", Mark.STRONG),
            number(each.zero, 4),
            percent(each.ratio),
            percent(each.most),
            percent(each.alone),
            number(each.damped_frequency, 4),
            percent(each.damped_ratio),
        )
        for each in inner.modes
        if each.most > _LEAST_DAMPED
    ]
    heads = [
        Column("mode", "Hz"),
        Column("without stacks", "Hz"),
        Column("damping"),
        Column("most"),
        Column("alone"),
        Column("becomes", "Hz"),
        Column("damping"),
    ]
    rest = ", ".join(f"{name} {percent(share)}" for name, share in zip(inner.coordinates, inner.left_at_rest, strict=True))
    least = ", ".join(f"{name} {percent(share)}" for name, share in zip(inner.coordinates, inner.softest, strict=True))
    corner = f"{number(inner.corner, 4)} Hz" + ("" if inner.rate is None else f", sampled at {number(1e-3 * inner.rate, 4)} kHz")
    notes = [
        f"Gain {number(inner.gain, 4)} 1/s, high pass of order {inner.order} at {corner}: {', '.join(inner.legs)}.",
        _FORCE_NOTE,
        f"Static stiffness left at rest: {rest}. Left at least, below the first mode: {least}.",
    ]
    return make_table("Force feedback in the legs", heads, rows, notes=notes)


def charge_table(found: LoopStudy) -> Table | None:
    """What holding the stacks' charge does to the modes of the plant; `None` where volts are driven."""
    held = found.charge
    if held is None:
        return None
    moved = [pair for pair in zip(held.by_volts, held.by_charge, strict=True) if pair[1] / pair[0] - 1.0 > _MOVED]
    rows = [(Cell(number(volts, 4), Mark.STRONG), number(charge, 4), percent(charge / volts - 1.0, 3)) for volts, charge in moved]
    stacks = ", ".join(
        f"{name} {number(stiffer, 4)} times above {number(corner, 3)} Hz"
        for name, stiffer, corner in zip(held.actuators, held.stiffer, held.corners, strict=True)
    )
    notes = [
        f"Stacks are stiffer by 1/(1 - k^2) while their charge is held: {stacks}. Far below, and at rest, they are on volts.",
        f"Modes that move by {percent(_MOVED)} and less are left out.",
        f"Residual hysteresis and creep: {percent(float(np.max(held.residual_hysteresis)))}.",
    ]
    return make_table("Charge drive", [Column("mode on volts", "Hz"), Column("on charge", "Hz"), "higher by"], rows, notes=notes)


def heat_table(runs: Sequence[Run]) -> Table | None:
    """What force actuators bear in each course run over and over; `None` where there are none."""
    rows = [
        (
            run.course.name,
            Cell(name, Mark.STRONG),
            format_value(each.rms, each.unit, 3),
            NO_VALUE if each.held is None else format_value(each.held, each.unit, 3),
            NO_VALUE if each.power is None else format_value(each.power, "W", 3),
            NO_VALUE if each.warming is None else f"{number(each.warming, 3)} K",
        )
        for run in runs
        for name, each in run.heat.items()
    ]
    heads = ["course", "actuator", *(Column(head) for head in ("rms", "held for ever", "heat", "warms by"))]
    note = "Each course as simulated, over and over, without heat carried off by motion; what the data do not tell is absent."
    return make_table("Heat of force actuators", heads, rows, notes=[note]) if rows else None


def leg_table(runs: Sequence[Run]) -> Table | None:
    """What force feedback takes of the amplifiers in each course; `None` where there is none."""
    rows = [
        (
            run.course.name,
            Cell(name, Mark.STRONG),
            format_value(each.added, "m", 3),
            percent(each.largest / each.reach, 3),
            NO_VALUE if np.isinf(each.slew) else percent(each.fastest / each.slew, 3),
            Cell("yes" if each.is_held else "no", Mark.PASS if each.is_held else Mark.FAIL),
        )
        for run in runs
        for name, each in run.legs.items()
    ]
    heads = ["course", "actuator", *(Column(head) for head in ("added at most", "of the stroke", "of the speed")), "held"]
    note = "Of stroke and speed that the amplifier gives, what both loops take together. Beyond, the simulation goes on as if it gave them."
    return make_table("Force feedback and amplifiers", heads, rows, notes=[note]) if rows else None


def learning_table(runs: Sequence[Run]) -> Table | None:
    """What passes over a path have taught, by motion; `None` where nothing was learned."""
    rows, notes = [], []
    for run in runs:
        seen = run.learned
        if seen is None:
            continue
        for index, (name, unit) in enumerate(zip(seen.coordinates, seen.units, strict=True)):
            values = (seen.rms[0, index], seen.rms[-1, index], seen.noise[index], seen.beyond[index])
            rows.append((run.course.name, Cell(name, Mark.STRONG), *(format_value(float(value), unit, 3) for value in values)))
        passes, end = len(seen.rms) - 1, number(seen.band, 4)
        contraction = f"a pass leaves {percent(seen.contraction, 3)} at most of what repeats, all modes up to {percent(seen.spread)} off"
        notes.append(f"{run.course.name}: {passes} passes of gain {seen.gain:g} up to {end} Hz; {contraction}.")
    if not rows:
        return None
    heads = ["path", "motion", *(Column(head) for head in ("before", "learned", "does not repeat", "beyond the band"))]
    last = (
        "Rms errors as the gauges tell them, the first three in the band. What is beyond it is not learnable: there the loop is not known."
    )
    return make_table("Learning", heads, rows, notes=[*notes, last])


def repetition_table(runs: Sequence[Run]) -> Table | None:
    """What repetitive control came to along a path, by motion; `None` where there is none."""
    rows, notes = [], []
    for run in runs:
        if (seen := run.repeated) is None:
            continue
        for index, (name, unit) in enumerate(zip(seen.coordinates, seen.units, strict=True)):
            values = (seen.rms[0, index], seen.rms[len(seen.rms) // 2, index], seen.rms[-1, index], seen.beyond[index])
            rows.append((run.course.name, Cell(name, Mark.STRONG), *(format_value(float(value), unit, 3) for value in values)))
        period, end = number(seen.period, 4), number(seen.band, 4)
        left = f"a period leaves {percent(seen.contraction, 3)} at most of what repeats, all modes up to {percent(seen.spread)} off"
        notes.append(f"{run.course.name}: {len(seen.rms)} periods of {period} s, gain {seen.gain:g} up to {end} Hz; {left}.")
        notes.append(f"What does not repeat is made up to {number(seen.amplifies, 3)} times as large between the harmonics of {period} s.")
    heads = ["path", "motion", *(Column(head) for head in ("first period", "halfway", "last period", "beyond the band"))]
    last = (
        "Rms errors as the gauges tell them, the first three in the band. What is beyond it is not learnable: there the loop is not known."
    )
    return make_table("Repetitive control", heads, rows, notes=[*notes, last]) if rows else None


def law_table(found: LoopStudy) -> Table | None:
    """The controller's numbers, loop by loop; `None` of one that is not made of single loops."""
    loops = found.controller.loops
    if not loops:
        return None
    numbers = rows_of([each.law for each in loops.values()]).columns.items()
    known = [field_column(each, values) for each, values in numbers if any(value is not None for value in values)]
    notches = [_notches(each.notches) for each in loops.values()]
    shaped = [_prefilter(each.prefilter) for each in loops.values()] if any(each.prefilter for each in loops.values()) else None
    extra = () if shaped is None else (shaped,)
    rows = zip([Cell(name, Mark.STRONG) for name in loops], *(cells for _, cells in known), notches, *extra, strict=True)
    columns = ["loop", *(column for column, _ in known), "notches", *(["prefilter"] if extra else [])]
    note = "From the loop's error to its command, both in metres: rotations times the stage's length."
    return make_table("Controller", columns, list(rows), notes=[note])


def _prefilter(found: Prefilter | None) -> str:
    if found is None:
        return "none"
    lead = "" if found.lead is None else f", lead at {number(found.lead, 4)} Hz"
    return f"{number(found.frequency, 4)} Hz, damping {number(found.damping, 3)}{lead}"


def _notches(group: Sequence[Notch]) -> str:
    return ", ".join(f"{number(each.frequency, 5)} Hz to {number(each.depth, 3)}" for each in group)


def margin_table(found: LoopStudy) -> Table | None:
    """Bandwidth and margins by coordinate; `None` in open loop."""
    if found.margins is None or found.bandwidths is None:
        return None
    rows = [
        (
            Cell(each.channel, Mark.STRONG),
            number(float(found.bandwidths.tracking[index]), 4),
            number(float(found.bandwidths.rejection[index]), 4),
            _range(each.gain_low.value, each.gain_high.value),
            number(float(np.rad2deg(each.phase.value)), 4),
            number(1e3 * each.delay.value, 4),
            _alpha(each.disk.value),
        )
        for index, each in enumerate(found.margins.channels)
    ]
    heads = [
        "motion",
        Column("follows to", "Hz"),
        Column("rejects to", "Hz"),
        Column("gain may be", "times"),
        Column("phase margin", "deg"),
        Column("delay margin", "ms"),
        Column("disk margin"),
    ]
    return make_table("Bandwidth and margins", heads, rows, notes=[_BANDWIDTH_NOTE, _MARGIN_NOTE, *_disk_margin_notes(found.disk_margin)])


def _disk_margin_notes(found: DiskMargin | None) -> Iterator[str]:
    if found is not None:
        span = f"{number(found.gain_low, 3)} to {number(found.gain_high, 3)}"
        turn = number(float(np.rad2deg(found.phase)), 3)
        yield f"All loops at once: disk margin {number(found.guaranteed, 3)}, that is every gain by {span}, or every phase by {turn} deg."


def measured_table(found: LoopStudy) -> Table | None:
    """Margins read off the responses of a test, beside what the plants of fit and model give at the same lines; `None` without a test."""
    seen = found.measured
    if seen is None:
        return None
    rows = [("peak of S", "", *_reading(seen.peak, 1.0))]
    for each in seen.channels:
        rows += [
            ("gain up to", each.channel, *_reading(each.gain_high, 1.0)),
            ("phase [deg]", each.channel, *_reading(each.phase, float(np.rad2deg(1.0)))),
            ("rejects to [Hz]", each.channel, *_reading(each.rejection, 1.0)),
        ]
    low, high = seen.band
    notes = [
        f"Read off {seen.lines} lines from {number(low, 4)} to {number(high, 4)} Hz; between them a peak may be higher.",
        "Where little moves, noise makes the gain that is left look smaller.",
        "Fitted: of the modes found, on which the loop was tuned. Model: of the design, without the delay that was found.",
    ]
    heads = ["what", "loop", "measured", "95 % interval", "fitted", "model"]
    return make_table("Margins on the measured responses", heads, rows, notes=notes)


def _reading(each: Reading, factor: float) -> tuple[str, str, str, str]:
    known = each.low is not None and each.high is not None and np.isfinite(each.low)
    interval = f"{number(factor * (each.low or 0.0), 4)} to {number(factor * (each.high or 0.0), 4)}" if known else NO_VALUE
    return number(factor * each.value, 4), interval, number(factor * each.fitted, 4), number(factor * each.predicted, 4)


def _range(low: float, high: float) -> str:
    lower = "0" if low == 0.0 else number(low, 3)
    return f"{lower} to {'any' if np.isinf(high) else number(high, 3)}"


def _alpha(value: float) -> Cell:
    return Cell(number(value, 3), Mark.PLAIN if value > 0.5 else Mark.WARN)


def step_table(tests: Sequence[Run]) -> Table | None:
    """Answers to steps; `None` where none was simulated.

    >>> step_table([]) is None
    True
    """
    stepped = [(test, test.step) for test in tests if test.step is not None]
    if not stepped:
        return None
    heads = [
        "step of",
        Column("by"),
        Column("settled in", "ms"),
        Column("overshoot"),
        Column("error at the end"),
        Column("others move"),
        "limits",
    ]
    note = (
        "Settled: the true error stays within 2 % of the step. Others: the largest motion in metres and the largest in radians along all "
        "other axes of the platform, at any time, and along which."
    )
    return make_table("Steps", heads, [tuple(_step(test, step)) for test, step in stepped], notes=[note])


def _step(test: Run, step: StepAnswer) -> Iterator[Content]:
    yield Cell(test.course.name, Mark.STRONG)
    yield format_value(step.size, step.unit, 4)
    yield Cell("not", Mark.FAIL) if np.isinf(step.settling) else number(1e3 * step.settling, 4)
    yield percent(step.overshoot, 3)
    yield _length(step.residual, step.size, step.unit)
    yield _others(step.others)
    yield limits_text(test)


def _others(known: Mapping[str, Excursion]) -> Cell:
    """The largest motion of each unit, and its axis; what is far below an atom is rounding."""
    units = dict.fromkeys(each.unit for each in known.values())
    largest = {unit: max((each.largest, name) for name, each in known.items() if each.unit == unit) for unit in units}
    told = [f"{format_value(value, unit, 3)} {name}" for unit, (value, name) in largest.items() if value > _NOTHING]
    if not told:
        return Cell("0" if known else NO_VALUE, Mark.FAINT)
    return Cell(", ".join(told))


def _length(value: float, size: float, unit: str) -> Cell:
    return Cell("0", Mark.FAINT) if abs(value) < _SMALL * abs(size) else Cell(format_value(value, unit, 3))


def limits_text(test: Run) -> str:
    """Which actuators ran into their limits, and which gauges out of their range, for which share of the time."""
    seen = test.simulated
    words = [
        f"{name} {noun} {percent(float(share), 3)}"
        for noun, names, shares in (
            ("saturated", seen.actuators, seen.saturated),
            ("slewing", seen.actuators, seen.slewing),
            ("out of range", seen.gauges, seen.out_of_range),
        )
        for name, share in zip(names, shares, strict=True)
        if share > 0.0
    ]
    return ", ".join(words)


def motion_cell(value: float, unit: str) -> Cell:
    """A motion or its rms value with its unit; what is far below an atom is rounding, and told as 0.

    >>> motion_cell(3.3e-9, "m").text, motion_cell(5e-24, "m").text
    ('3.3 nm', '0')
    """
    return Cell("0", Mark.FAINT) if abs(value) < _NOTHING else Cell(format_value(value, unit, 3))


def tracking_table(tests: Sequence[Run]) -> Table | None:
    """Errors along trajectories that are no steps, by coordinate; `None` where none was simulated.

    >>> tracking_table([]) is None
    True
    """
    followed = [test for test in tests if test.figures is None]
    if not followed:
        return None
    rows: list[tuple[Content, ...]] = []
    for test in followed:
        for name, values, units in zip(test.tracking.rows, test.tracking.values, test.tracking.unit, strict=True):
            numbers = [motion_cell(float(value), unit) for value, unit in zip(values, units, strict=True)]
            rows.append((Cell(test.course.name, Mark.STRONG), name, *numbers))
    heads = ["trajectory", "motion", *(Column(head) for head in ("rms seen", "peak seen", "true rms", "true peak"))]
    limits = [f"{test.course.name}: {limits_text(test)}." for test in followed if limits_text(test)]
    note = "Reference less pose: as the gauges tell it, and against the platform's true pose."
    return make_table("Tracking", heads, rows, notes=[note, *limits])


def comparison_table(found: Comparison) -> Table:
    """Controllers side by side, the best of each column marked."""
    wins = found.wins
    rows = [[Cell(kind_name(name), Mark.STRONG), *_rival_cells(each, wins, name)] for name, each in found.controllers.items()]
    best = "; ".join(f"{aim}: {kind_name(name)}" for aim, name in wins.items())
    front = "; ".join(map(kind_name, found.front))
    slow = [kind_name(name) for name, each in found.controllers.items() if each.slowly_rounding]
    notes = [
        "Worst of all motions: the lowest frequency up to which disturbances are rejected, the longest time to 2 % of a step.",
        "Noise: the largest rms at rest. Of gauges: the largest share of their noise and steps in a mean square.",
        *([f"Rounding is counted as white noise, and is none with {'; '.join(slow)}: flexstage loop simulates its rms."] if slow else []),
        f"Best in {best}. No other is better at once in rejection, noise, settling and delay margin than {front}.",
        *(f"{kind_name(name)}: {each.tuned}." for name, each in found.controllers.items()),
        *(f"Not to be had: {kind_name(name)}: {reason}" for name, reason in found.reasons.items()),
    ]
    heads = [
        "controller",
        Column("rejects to", "Hz"),
        "noise",
        Column("settles", "ms"),
        "overshoot",
        Column("delay margin", "ms"),
        "peak of S",
        "of gauges",
    ]
    return make_table("Controllers side by side", heads, rows, notes=notes)


def rivals_table(found: Comparison) -> Table:
    """What every controller comes to, motion by motion."""
    rows = [
        [
            Cell(kind_name(name), Mark.STRONG),
            coordinate,
            number(float(each.rejection[place]), 4),
            format_value(float(each.noise[place]), each.units[place], 3),
            number(1e3 * float(each.settling[place]), 4) if np.isfinite(each.settling[place]) else "not",
            percent(float(each.overshoot[place]), 3),
        ]
        for name, each in found.controllers.items()
        for place, coordinate in enumerate(each.coordinates)
    ]
    heads = ["controller", "motion", Column("rejects to", "Hz"), "noise", Column("settles", "ms"), "overshoot"]
    return make_table("Motion by motion", heads, rows)


def kind_name(name: str) -> str:
    """The name of a kind of controller as it is read.

    >>> kind_name("pi, damped"), kind_name("resonant")
    ('PI, damped', 'resonant')
    """
    first, *rest = name.split(",")
    return ",".join([first.upper() if len(first) < 4 else first, *rest])


def _rival_cells(one: Rival, wins: Mapping[str, str], name: str) -> list[Content]:
    settling = float(np.max(one.settling))
    shown = {
        "rejection": number(float(np.min(one.rejection)), 4),
        "noise": _worst_noise(one),
        "settling": number(1e3 * settling, 4) if np.isfinite(settling) else "not",
        "overshoot": percent(float(np.max(one.overshoot)), 3),
        "delay margin": number(1e3 * one.delay_margin, 4),
        "peak of S": number(one.peak, 4),
    }
    cells: list[Content] = [Cell(text, Mark.PASS) if wins.get(aim) == name else text for aim, text in shown.items()]
    return [*cells, NO_VALUE if one.gauge_share is None else percent(one.gauge_share, 2)]


def _worst_noise(one: Rival) -> str:
    """The largest rms of translations and of rotations."""
    turns = [each.startswith("r") for each in one.coordinates]
    kinds = [(one.noise[[turn is kind for turn in turns]], unit) for kind, unit in ((False, "m"), (True, "rad"))]
    return ", ".join(format_value(float(np.max(values)), unit, 3) for values, unit in kinds if len(values))
