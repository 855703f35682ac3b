"""Tables of lost motion: transmission ratios, the budget by part, crosstalk, parasitic motion, and strain energy."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.base.labelled import NOISE, Matrix
from flexstage.show.display import number, percent
from flexstage.show.scene.primitives import first_value
from flexstage.show.table import Cell, Column, Mark, Table, first_design, make_table, matrix_table

_SHOWN = 1e-4
_LARGEST = 3
_NAMED, _MOST_NAMED = 0.02, 16
"""Smallest fraction of an actuator's loss for which a link of another unit is named, and the largest number of such links."""


def loss_table(lost: LostMotion) -> Table:
    """Tabulate the transmission ratio and the loss of every actuator, with the links that contribute most.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> loss_table(fs.lost_motion(fs.ideal(stage), fs.lumped(stage))).texts()[4][:3]
    ['B4', '0.96632', '3.368 %']
    """
    rows = [_loss_row(lost, name) for name in lost.loss.rows]
    heads = ["actuator", Column("gain"), Column("loss"), Column("coupling from others"), "largest contributions"]
    note = "Gain: transmission ratio, actual / ideal motion. Coupling: the largest response to the command of another actuator."
    return make_table("Lost motion", heads, rows, notes=[note], provenance=lost.provenance)


def _loss_row(lost: LostMotion, name: str) -> tuple[Cell, ...]:
    index = lost.loss.rows.index(name)
    line = first_design(lost.loss.values, 2)[index]
    own = _zero_if_noise(float(line[index]))
    others = np.delete(np.abs(line), index)
    least = max(NOISE, 0.02 * abs(own))
    ranked = named_budget(lost, name).items()
    largest = ", ".join(f"{part} {percent(share, 3)}" for part, share in list(ranked)[:_LARGEST] if abs(share) > least)
    gain = float(first_design(lost.transfer.values, 2)[index, index])
    return (
        Cell(name, Mark.STRONG),
        Cell(number(gain)),
        Cell(percent(own), bar=min(1.0, 10.0 * abs(own))),
        Cell(percent(_zero_if_noise(float(np.max(others, initial=0.0))), 3)),
        Cell(largest),
    )


def _zero_if_noise(share: float) -> float:
    """A share without rounding noise."""
    return 0.0 if abs(share) < NOISE else share


def budget_table(lost: LostMotion) -> Table | None:
    """Tabulate the contributions of links to every actuator's loss; each column adds up to the loss.

    Links of the actuator's unit are listed by axis, links of other units by name. Returns `None` for a stage at an operating point, because
    the model of this stage has no budget.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> budget_table(fs.lost_motion(fs.ideal(stage), fs.lumped(stage))).texts()[-1][4]
    '3.368 %'
    """
    if not lost.budget:
        return None
    budgets = {name: named_budget(lost, name) for name in lost.loss.rows}
    notes = [f"{_OWN_AND_OTHERS}; their axes are added up. Negative contributions increase the gain."]
    return make_table("Lost-motion budget", ["link", *(Column(name) for name in budgets)], share_rows(budgets, "loss"), notes=notes)


_OWN_AND_OTHERS = "Links without a unit's name belong to the actuator's own unit; links with a unit's name belong to another unit"


def named_budget(lost: LostMotion, actuator: str) -> dict[str, float]:
    """Return the contributions to an actuator's loss, the largest first. Links in other instances have one entry for all axes.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> next(iter(named_budget(fs.lost_motion(fs.ideal(stage), fs.lumped(stage)), "B4")))
    'pivot.rz'
    """
    shares = {name: float(first_design(np.asarray(value)[..., None], 1)[0]) for name, value in lost.of(actuator).items()}
    found = name_links(shares, actuator, lambda name: name.rpartition(".")[0] or name)
    return dict(sorted(found.items(), key=lambda item: -abs(round(item[1], 9))))


def name_links(shares: Mapping[str, float], actuator: str, link: Callable[[str], str]) -> dict[str, float]:
    """Rename contributions to one actuator's loss: names of links in the actuator's instance are shortened to `link.axis`.

    Contributions of links in other instances are added up under the name that the function `link` returns.

    >>> name_links({"B1/front.rz": 1.0, "B2/front.ry": 2.0, "B2/front.rz": 3.0, "guide.y": 4.0}, "B1", lambda name: name.partition(".")[0])
    {'front.rz': 1.0, 'B2/front': 5.0, 'guide.y': 4.0}
    """
    result: dict[str, float] = {}
    owner = actuator.rpartition("/")[0] if "/" in actuator else actuator
    for name, share in shares.items():
        copy, slash, own = name.partition("/")
        key = own if slash and copy == owner else link(name) if slash else name
        result[key] = result.get(key, 0.0) + share
    return result


def share_rows(columns: Mapping[str, Mapping[str, float]], total: str) -> list[tuple[Cell, ...]]:
    """Make a row of contributions for each link, the largest first, with a column for each actuator.

    Negligible links are combined in one row. The last row contains the sums under the name `total`.
    """
    size = largest_shares(columns)
    ranked = sorted(size, key=lambda part: -round(size[part], 9))
    foreign = foreign_links(ranked, columns)
    kept = [part for part in ranked if size[part] >= _SHOWN and ("/" not in part or part in foreign)]
    small = [part for part in ranked if part not in kept and size[part] >= NOISE]
    rows = [_share_row(part, [shares.get(part) for shares in columns.values()]) for part in kept]
    if small:
        label = f"{len(small)} more, at most {percent(size[small[0]], 2)} each"
        rows.append(_share_row(label, [sum(shares.get(part, 0.0) for part in small) for shares in columns.values()]))
    sums = [_zero_if_noise(sum(shares.values())) for shares in columns.values()]
    return [*rows, (Cell(total, Mark.STRONG), *(Cell(percent(value), Mark.STRONG) for value in sums))]


def largest_shares(columns: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    """Return the largest magnitude of each contribution in the columns.

    >>> largest_shares({"B1": {"front": 0.1}, "B2": {"front": -0.2, "back": 0.0}})
    {'front': 0.2, 'back': 0.0}
    """
    parts = dict.fromkeys(part for shares in columns.values() for part in shares)
    return {part: max(abs(shares.get(part, 0.0)) for shares in columns.values()) for part in parts}


def foreign_links(ranked: Iterable[str], columns: Mapping[str, Mapping[str, float]]) -> list[str]:
    """From links `ranked` by contribution, select the links in unit instances with a significant contribution to a loss in `columns`.

    >>> foreign_links(["front.rz", "B2/front", "B2/back"], {"B1": {"front.rz": 0.02, "B2/front": 0.01, "B2/back": 0.0002}})
    ['B2/front']
    """
    return [part for part in ranked if "/" in part and _matters(part, columns)][:_MOST_NAMED]


def _matters(part: str, columns: Mapping[str, Mapping[str, float]]) -> bool:
    """Whether a link has a significant share of an actuator's loss."""
    return any(abs(shares.get(part, 0.0)) >= max(_SHOWN, _NAMED * abs(sum(shares.values()))) for shares in columns.values())


def _share_row(part: str, shares: Iterable[float | None]) -> tuple[Cell, ...]:
    cells = [Cell("") if share is None else _share_cell(share) for share in shares]
    return Cell(part, Mark.STRONG), *cells


def _share_cell(share: float) -> Cell:
    share = _zero_if_noise(share)
    text = percent(share, 3 if abs(share) >= 1e-3 else 2)
    return Cell("0" if share == 0.0 else text, Mark.FAINT if abs(share) < _SHOWN else Mark.PLAIN)


def gain_table(lost: LostMotion) -> Table:
    """Tabulate T = dx/da: the platform motion x per actuator stroke a in the elastic model.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> gain_table(fs.lost_motion(fs.ideal(stage), fs.lumped(stage))).texts()[3][4]
    '0.96838'
    """
    return matrix_table("Elastic platform motion per stroke, T", lost.gain)


def crosstalk_table(lost: LostMotion) -> Table:
    """Tabulate R_a V^+ T: the achieved fractions of commanded strokes (diagonal), and the coupling between actuators.

    T is the elastic motion per stroke, V are the ideal motions, V^+ is the pseudoinverse, and R_a are the strokes per ideal motion.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> crosstalk_table(fs.lost_motion(fs.ideal(stage), fs.lumped(stage))).texts()[4][4]
    '0.96632'
    """
    note = "Rows: motion, converted to actuator strokes. Columns: commanded actuator. Without elasticity, the table is the identity matrix."
    return matrix_table("Gain and crosstalk, R_a V+ T", lost.transfer, notes=[note])


def parasitic_table(lost: LostMotion) -> Table | None:
    """Tabulate the parasitic motion per stroke: platform motion outside the ideal motions; `None` without parasitic motion.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> parasitic_table(fs.lost_motion(fs.ideal(stage), fs.lumped(stage))) is None
    True
    """
    values, scale = first_design(lost.parasitic.values, 2), first_design(lost.gain.values, 2)
    length = first_value(lost.length)
    weight = np.array([1.0, 1.0, 1.0, *[length] * 3])[:, None]
    if np.max(np.abs(values * weight), initial=0.0) < NOISE * np.max(np.abs(scale * weight), initial=0.0):
        return None
    note = f"Rotations are multiplied by {number(1e3 * length, 4)} mm to compare them with translations."
    return matrix_table("Parasitic motion per stroke", lost.parasitic, against=lost.gain, notes=[note])


def correction_table(lost: LostMotion) -> Table:
    """Tabulate the strokes for a required motion xi, corrected for elasticity: a = (R_a V^+ T)^-1 R_a xi.

    R_a are the strokes per ideal motion; `crosstalk_table` shows the matrix R_a V^+ T.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> correction_table(fs.lost_motion(fs.ideal(stage), fs.lumped(stage))).texts()[4][3]
    '0.34422'
    """
    return matrix_table("Corrected mapping: strokes per required motion", lost.correction, units=("mrad",))


def energy_table(lost: LostMotion) -> Table:
    """Tabulate the strain-energy fractions of parts when one actuator expands and no other load acts.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> energy_table(fs.lost_motion(fs.ideal(stage), fs.lumped(stage))).texts()[1][0]
    'pivot'
    """
    energies = energy_shares(lost)
    totals = first_design(lost.energy.values, 2).sum(axis=0)
    rows = share_rows(energies, "all")
    whole = [Cell("energy [uJ/um^2]", Mark.STRONG), *(Cell(number(1e-6 * float(total), 4)) for total in totals)]
    heads = ["part", *(Column(name) for name in lost.energy.columns)]
    return make_table("Strain energy by part", heads, [*rows, tuple(whole)], notes=[f"{_OWN_AND_OTHERS}."])


def energy_shares(lost: LostMotion) -> dict[str, dict[str, float]]:
    """Return the strain-energy fraction of each part, for each expanding actuator.

    >>> import flexstage as fs
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> stage = double_triangle()
    >>> round(sum(energy_shares(fs.lost_motion(fs.ideal(stage), fs.lumped(stage)))["B1"].values()), 12)
    1.0
    """
    values = first_design(lost.energy.values, 2)
    shares = {name: _shares(lost.energy, values[:, column]) for column, name in enumerate(lost.energy.columns)}
    return {name: name_links(own, name, str) for name, own in shares.items()}


def _shares(energy: Matrix, column: np.ndarray) -> dict[str, float]:
    total = float(column.sum()) or 1.0
    return {part: float(value) / total for part, value in zip(energy.rows, column, strict=True)}
