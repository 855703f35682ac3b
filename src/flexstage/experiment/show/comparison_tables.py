"""Theory, FEA and experiment as tables (the paper's Fig. 12)."""

from __future__ import annotations

import numpy as np

from flexstage.experiment.comparison import Compared, ComparedMode, Measured
from flexstage.experiment.show.tables import WIDENED, interval_texts, widening_cell
from flexstage.show.display import NO_VALUE, number, percent
from flexstage.show.table import Cell, Column, Content, Mark, Table, make_table

_TRUSTED = 0.9
_NEAR, _OFF = 0.02, 0.1


def compare_table(found: Compared) -> Table:
    """Platform modes by theory, FEA where there is one, and experiment: frequencies, differences, modal assurance."""
    with_fea = found.fea is not None
    rows = [_line(row, with_fea=with_fea) for row in found.modes]
    heads = ["mode", "name", Column(f"theory ({found.model.value})", "Hz")]
    heads += [Column("FEA", "Hz"), Column("FEA's error")] if with_fea else []
    heads += [Column("experiment", "Hz"), Column("95 % interval", "Hz"), Column("widened"), Column("theory off")]
    heads += [Column("FEA off")] if with_fea else []
    heads += [Column("MAC"), *([Column("MAC of FEA")] if with_fea else [])]
    heads += [Column("damping", "%")]
    notes = ["Off: relative to the experiment, which had damping; theory and FEA are undamped."]
    notes += ["MAC: modal assurance of theory and experiment at the sensors; of repeated modes, within their subspace."]
    notes += [WIDENED, *_fea_notes(found)]
    return make_table("Theory, FEA and experiment", heads, rows, notes=notes, provenance=found.provenance)


def _line(row: ComparedMode, *, with_fea: bool) -> list[Content]:
    error = NO_VALUE if row.fea_error is None else percent(row.fea_error, 2)
    fea: list[Content] = [_hertz(row.fea), error] if with_fea else []
    line: list[Content] = [Cell(str(row.number), Mark.STRONG), row.name, _hertz(row.theory), *fea, *_experiment(row.experiment)]
    line += [off_cell(row.difference, row.uncertainty), *([off_cell(row.fea_difference, row.uncertainty)] if with_fea else [])]
    line += [_assurance(row.assurance), *([_assurance(row.fea_assurance)] if with_fea else [])]
    return [*line, _damping(row.experiment)]


def _experiment(seen: Measured | None) -> list[Content]:
    if seen is None:
        return [Cell("not found", Mark.WARN), NO_VALUE, NO_VALUE]
    return [*interval_texts(np.array([seen.frequency]), np.array([seen.frequency_interval]))[0], widening_cell(seen.widening)]


def _damping(seen: Measured | None) -> str:
    if seen is None:
        return NO_VALUE
    return interval_texts(100.0 * np.array([seen.damping]), 100.0 * np.array([seen.damping_interval]))[0][0]


def _hertz(value: float | None) -> str:
    return NO_VALUE if value is None else f"{value:.2f}"


def off_cell(share: float | None, uncertainty: float | None) -> Cell:
    """A difference to the experiment with the experiment's own half interval.

    >>> off_cell(0.0123, 0.0001).text
    '1.230 % +- 0.010 %'
    """
    if share is None:
        return Cell(NO_VALUE, Mark.FAINT)
    mark = Mark.PASS if abs(share) <= _NEAR else Mark.WARN if abs(share) <= _OFF else Mark.FAIL
    if not uncertainty or not np.isfinite(uncertainty):
        return Cell(percent(share, 3), mark)
    decimals = int(np.clip(1 - np.floor(np.log10(100.0 * uncertainty)), 1, 4))
    shown = 0.0 if abs(share) < 0.5e-2 * 10.0**-decimals else share
    return Cell(f"{100.0 * shown:.{decimals}f} % +- {100.0 * uncertainty:.{decimals}f} %", mark)


def _assurance(value: float | None) -> Cell:
    if value is None:
        return Cell(NO_VALUE, Mark.FAINT)
    return Cell(f"{np.floor(1e3 * value) / 1e3:.3f}", Mark.PASS if value >= _TRUSTED else Mark.WARN)


def _fea_notes(found: Compared) -> list[str]:
    if found.fea is None:
        return []
    told = "its error estimated from the order before" if found.fea.errors else "no coarser result was at hand to estimate its error from"
    return [f"FEA: elements of order {found.fea.order}; {told}."]


def repeated_table(found: Compared) -> Table | None:
    """Repeated modes as subspaces: how many of them the experiment shows, and the largest angle; `None` where there is none."""
    if not found.repeated:
        return None
    rows = [
        (
            Cell(" and ".join(map(str, group.numbers)), Mark.STRONG),
            f"{group.seen} of {len(group.numbers)}",
            NO_VALUE if group.angle is None else f"{number(float(np.rad2deg(group.angle)), 3)}",
        )
        for group in found.repeated
    ]
    note = "Any combination of repeated modes is a mode: theory's and the measured ones span planes, compared by their largest angle."
    heads = ["modes", Column("seen in the experiment"), Column("largest angle", "°")]
    return make_table("Repeated modes", heads, rows, notes=[note])


def further_table(found: Compared) -> Table | None:
    """Measured modes that are none of the platform's, beside the local modes of theory they may be; `None` where there is none."""
    if not found.further:
        return None
    rows = [
        (
            Cell(str(mode.experiment.number), Mark.STRONG),
            *_experiment(mode.experiment),
            _damping(mode.experiment),
            mode.name or NO_VALUE,
            _hertz(mode.theory),
            _assurance(mode.assurance),
        )
        for mode in found.further
    ]
    heads = ["mode of the record", Column("experiment", "Hz"), Column("95 % interval", "Hz"), Column("widened"), Column("damping", "%")]
    heads += ["theory's nearest", Column("theory", "Hz"), Column("MAC")]
    note = "Modes of single units, of the ground or of what carries the stage; by the sensors alone local modes are told less surely."
    return make_table("Further measured modes", heads, rows, notes=[note])
