"""Old, new and change: two complete analyses side by side, as `analyse --set` shows them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexstage.base.digest import digest
from flexstage.present.display import NO_VALUE, number, shown, value_with_unit
from flexstage.present.table import Cell, Column, Mark, Table, build, first_design
from flexstage.present.tables.requirements import met
from flexstage.studies.complete import Analysis

_SAME = 1e-9


@dataclass(frozen=True)
class Headline:
    """A number that sums a stage up: its name, SI value and SI unit."""

    name: str
    value: float
    unit: str


def headlines(analysis: Analysis) -> tuple[Headline, ...]:
    """The numbers that sum an analysis up: frequencies, stiffnesses, losses, strokes, safety.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.studies.complete import Reading, analyse
    >>> headlines(analyse(double_triangle(), Reading.IDEAL))[0].name
    'stroke x'
    """
    return (*_modes(analysis), *_statics(analysis), *_losses(analysis), *_reach(analysis))


def comparison_table(before: Analysis, after: Analysis) -> Table:
    """Old, new and change of every headline number that both analyses have, requirements included.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.studies.complete import Reading, analyse
    >>> one = analyse(double_triangle(), Reading.MAPPED)
    >>> comparison_table(one, one).texts()[1]
    ['mode 1 (tilt)', '110.91 Hz', '110.91 Hz', '0', '']
    """
    old = {line.name: line for line in headlines(before)}
    rows = [_row(old[line.name], line) for line in headlines(after) if line.name in old]
    rows += [_gone(line) for line in old.values() if line.name not in {other.name for other in headlines(after)}]
    rows += list(_verdicts(before, after))
    names = f"Old: {digest(before.mechanism, physics=True)[:16]}, new: {digest(after.mechanism, physics=True)[:16]}."
    heads = ["", Column("old"), Column("new"), Column("change"), Column("relative")]
    return build("Old and new", heads, rows, notes=[names])


def _row(old: Headline, new: Headline) -> tuple[Cell, ...]:
    form = shown(new.unit, max(abs(old.value), abs(new.value)))
    unit = "" if form.unit == "1" else f" {form.unit}"
    change = new.value - old.value
    same = abs(change) <= _SAME * max(abs(old.value), abs(new.value))
    relative = "" if same or old.value == 0.0 else f"{change / abs(old.value):+.2%}".replace("%", " %")
    text = "0" if same else f"{'+' if change > 0.0 else ''}{number(change * form.factor, 4)}{unit}"
    values = [Cell(f"{number(value * form.factor)}{unit}") for value in (old.value, new.value)]
    mark = Mark.FAINT if same else Mark.STRONG
    return Cell(new.name, Mark.STRONG), *values, Cell(text, mark), Cell(relative, mark)


def _gone(line: Headline) -> tuple[Cell, ...]:
    return Cell(line.name, Mark.STRONG), Cell(value_with_unit(line.value, line.unit)), Cell(NO_VALUE), Cell(""), Cell("")


def _verdicts(before: Analysis, after: Analysis) -> Iterator[tuple[Cell, ...]]:
    old = {verdict.requirement.key: verdict for verdict in before.verdicts}
    for verdict in after.verdicts:
        if verdict.requirement.key in old:
            was, now = met(old[verdict.requirement.key]), met(verdict)
            cells = [Cell("met" if good else "not met", Mark.PASS if good else Mark.FAIL) for good in (was, now)]
            change = "" if was == now else "now met" if now else "now fails"
            yield Cell(f"require {verdict.requirement.key}", Mark.STRONG), *cells, Cell(change, Mark.STRONG), Cell("")


def _modes(analysis: Analysis) -> Iterator[Headline]:
    if analysis.modes is not None:
        frequencies = first_design(analysis.modes.frequencies, 1)
        for number_of, index in enumerate(analysis.modes.platform):
            yield Headline(f"mode {number_of + 1} ({analysis.modes.names[index]})", float(frequencies[index]), "Hz")


def _statics(analysis: Analysis) -> Iterator[Headline]:
    if analysis.statics is not None:
        compliance = first_design(analysis.statics.compliance.values, 2)
        units = ("N/m", "N/m", "N/m", "N m/rad", "N m/rad", "N m/rad")
        for index, (axis, unit) in enumerate(zip(("x", "y", "z", "rx", "ry", "rz"), units, strict=True)):
            yield Headline(f"stiffness {axis}", float(1.0 / compliance[index, index]), unit)


def _losses(analysis: Analysis) -> Iterator[Headline]:
    if analysis.lost_motion is not None:
        values = np.diagonal(first_design(analysis.lost_motion.loss.values, 2))
        for name, value in zip(analysis.lost_motion.loss.rows, values, strict=True):
            yield Headline(f"loss {name}", 0.0 if abs(value) < _SAME else float(value), "1")


def _reach(analysis: Analysis) -> Iterator[Headline]:
    if analysis.workspace is None:
        return
    single = analysis.workspace.corrected or analysis.workspace.single
    for name, value in zip(single.coordinates, first_design(single.symmetric, 1), strict=True):
        yield Headline(f"stroke {name}", float(value), "rad" if name.startswith("r") else "m")
    if analysis.workspace.stress is not None:
        yield Headline("least safety", float(first_design(np.atleast_1d(analysis.workspace.stress.least), 1)[0]), "1")
