"""Tables of what the parts bear: forces, stress, buckling, loads on the stacks."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from flexstage.analysis.loaded.stability import Stability
from flexstage.analysis.workspace.blocking import PlatformLine
from flexstage.analysis.workspace.buckling import Buckling
from flexstage.analysis.workspace.load import LoadShare
from flexstage.analysis.workspace.strength import HingeStress
from flexstage.analysis.workspace.stroke import StrokeLimits
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.number import Array
from flexstage.show.display import NO_VALUE, format_value, number, percent
from flexstage.show.table import Cell, Column, Content, Mark, Table, first_design, make_table, result_table

_WEAK, _POOR = 1.0, 1.5


def strength_tables(workspace: Workspace) -> Iterator[Table | None]:
    """All tables of what the parts bear; absent what the workspace does not tell."""
    yield None if workspace.platform_lines is None else platform_line_table(workspace.platform_lines)
    yield result_table(workspace.stack_lines)
    yield None if workspace.stress is None else stress_table(workspace.stress)
    yield None if workspace.buckling is None else buckling_table(workspace.buckling)
    yield None if workspace.loads is None else load_table(workspace.loads, workspace.limits.from_zero)


def platform_line_table(lines: PlatformLine) -> Table:
    """Travel, stiffness and blocking force of the platform along each coordinate.

    >>> import numpy as np
    >>> one = np.ones(1)
    >>> platform_line_table(PlatformLine(("x",), 5e-5 * one, 15e6 * one, 750.0 * one, "")).texts()[1]
    ['x', '50 um', '15 N/um', '750 N']
    """
    matrix = lines.table
    units = matrix.unit if not isinstance(matrix.unit, str) else ((matrix.unit,) * 3,) * len(matrix.rows)
    rows = [
        (Cell(name, Mark.STRONG), *(format_value(float(value), unit, 4) for value, unit in zip(line, own, strict=True)))
        for name, line, own in zip(matrix.rows, first_design(matrix.values, 2), units, strict=True)
    ]
    heads = ["along", Column("travel without load"), Column("stiffness"), Column("blocking force")]
    note = "A command along one coordinate ends where the first actuator does; the load acts along it alone."
    return make_table("Forces of the platform", heads, rows, notes=[note])


def stress_table(stress: HingeStress) -> Table:
    """Largest stress of the hinges over the corners of the strokes, copies alike in one row, the weakest first.

    >>> import numpy as np
    >>> two = np.ones(2)
    >>> seen = HingeStress(("B1/a", "B2/a"), (), 1e8 * two, 2e8 * two, 1e9 * two, np.zeros((2, 0)), (), "")
    >>> stress_table(seen).texts()[1]
    ['a', '2', 'B1', '100', '200', '1000', '5']
    """
    nominal, peak, limit, safety = (first_design(each, 1) for each in (stress.nominal, stress.peak, stress.allowed, stress.safety))
    other = {link: name for link, name in zip(stress.links, stress.governing, strict=False) if name not in ("", "yield stress")}
    rows: list[tuple[Content, ...]] = []
    for name, members in _rank_by_factor(stress.links, safety):
        worst = members[0]
        stresses = [number(1e-6 * float(values[worst]), 4) for values in (nominal, peak, limit)]
        rows.append(
            (Cell(name, Mark.STRONG), str(len(members)), _owner(stress.links[worst]), *stresses, _safety_cell(float(safety[worst])))
        )
    heads = [
        "hinge",
        Column("copies"),
        "first in",
        Column("nominal", "MPa"),
        Column("peak", "MPa"),
        Column("limit" if other else "yield", "MPa"),
        Column("safety"),
    ]
    notes = ["Von Mises stress at the worst corner of all strokes from no voltage, dead load included; peak: with the notch factor."]
    notes += [f"Not checked: {', '.join(stress.unchecked)}."] if stress.unchecked else []
    notes += [f"Yield stress not stated: {', '.join(stress.unknown)}."] if stress.unknown else []
    notes += [f"What limits: {', '.join(f'{link} {name}' for link, name in other.items())}; else yield."] if other else []
    return make_table("Stress in the hinges", heads, rows, notes=notes)


def _rank_by_factor(links: tuple[str, ...], factors: Array) -> list[tuple[str, list[int]]]:
    """Links of one name whose factors agree to three digits together, ascending by factor; unknown factors first."""
    known = np.nan_to_num(factors, nan=-1.0, posinf=1e300)
    groups: dict[tuple[str, str], list[int]] = {}
    for index, link in enumerate(links):
        groups.setdefault((link.rpartition("/")[2], f"{known[index]:.2e}"), []).append(index)
    ranked = np.round(known, 6)
    named = [(name, members) for (name, _), members in groups.items()]
    return sorted(named, key=lambda item: float(ranked[item[1][0]]))


def _owner(link: str) -> str:
    return link.rpartition("/")[0]


def _safety_cell(factor: float) -> Cell:
    if np.isinf(factor):
        return Cell("in tension", Mark.FAINT)
    mark = Mark.FAIL if not factor >= _WEAK else Mark.WARN if factor < _POOR else Mark.PLAIN
    return Cell(number(factor, 4), mark)


def buckling_table(buckling: Buckling) -> Table:
    """Critical against largest compression, copies alike in one row, the weakest first.

    >>> import numpy as np
    >>> from flexstage.analysis.workspace.buckling import Ends
    >>> one = np.ones(1)
    >>> stage = Stability(one[0], one[0], np.zeros(0), one[0], (), "")
    >>> buckling_table(Buckling(("B1/a",), 1e3 * one, 100.0 * one, 0.01 * one, (Ends.GUIDED,), "", stage)).texts()[3]
    ['a', '1', 'B1', '100', '1000', 'guided', '10']
    """
    factor = first_design(buckling.factor, 1)
    compression, critical = (first_design(each, 1) for each in (buckling.compression, buckling.critical))
    rows: list[tuple[Content, ...]] = [(Cell(name, Mark.STRONG), "", "", "", "", "", cell) for name, cell in _of_stage(buckling.stage)]
    for name, members in _rank_by_factor(buckling.links, factor):
        worst = members[0]
        forces = [number(float(values[worst]), 4) for values in (compression, critical)]
        ends = buckling.ends[worst].value
        rows.append(
            (Cell(name, Mark.STRONG), str(len(members)), _owner(buckling.links[worst]), *forces, ends, _safety_cell(float(factor[worst])))
        )
    heads = ["part", Column("copies"), "first in", Column("compression", "N"), Column("critical", "N"), "ends", Column("load factor")]
    notes = [
        "The stage: by how much its loads could grow until it gives way as a whole (linearised; every column with its real ends).",
        "Parts: Euler's load of each one alone, its ends taken as said.",
    ]
    return make_table("Buckling", heads, rows, notes=notes)


def _of_stage(stage: Stability) -> Iterator[tuple[str, Cell]]:
    factors = {"stage, dead load": stage.dead, "stage, worst strokes": stage.worst}
    for name, values in factors.items():
        factor = float(first_design(np.atleast_1d(values), 1)[0])
        yield name, Cell("never", Mark.FAINT) if np.isinf(factor) else _safety_cell(factor)


def load_table(loads: LoadShare, limits: StrokeLimits) -> Table:
    """Axial forces of the stacks (positive in compression): dead load, range over all strokes, use of the limits.

    >>> import numpy as np
    >>> from flexstage.base.labelled import Matrix
    >>> one = Matrix(np.ones((1, 1)), ("B1",), ("gravity",), "N")
    >>> per_stroke, unknown = Matrix(np.array([[1e6]]), ("B1",), ("B1",), "N/m"), np.full(1, np.nan)
    >>> share = LoadShare(("B1",), one, one, per_stroke, np.array([5e3]), unknown, unknown, np.zeros(3), "")
    >>> load_table(share, StrokeLimits(("B1",), np.zeros(1), np.array([1e-4]))).texts()[1]
    ['B1', '1', '1', '101', '-', '-', '5000', '2.02 %']
    """
    least, largest = (first_design(values, 1) for values in loads.range(limits))
    usage = first_design(loads.use(limits), 1)
    dead = first_design(loads.loads.values, 2)
    rows: list[tuple[Content, ...]] = []
    for index, name in enumerate(loads.actuators):
        own = [number(float(value), 4) for value in dead[index]]
        limit = [_limit(loads.preload, index), _limit(loads.tensile, index), _limit(loads.maximum, index)]
        used = Cell(NO_VALUE) if np.isnan(usage[index]) else Cell(percent(float(usage[index])), bar=float(usage[index]))
        rows.append((Cell(name, Mark.STRONG), *own, number(float(least[index]), 4), number(float(largest[index]), 4), *limit, used))
    heads = ["actuator", *(Column(name, "N") for name in loads.loads.columns), Column("least", "N"), Column("largest", "N")]
    heads += [Column("preload", "N"), Column("tensile", "N"), Column("limit", "N"), Column("used")]
    return make_table("Axial forces of the stacks", heads, rows, notes=_load_notes(loads, least))


def _limit(values: Array, index: int) -> str:
    return number(float(first_design(np.atleast_1d(values), 1)[index]))


def _load_notes(loads: LoadShare, least: Iterable[float]) -> list[str]:
    pulled = [name for name, force in zip(loads.actuators, least, strict=True) if force < 0.0]
    note = [
        "Compression is positive. Least and largest over all strokes from no voltage, dead load included, preload not counted.",
        "Used: of the limit, or of preload and tensile limit where that is more.",
    ]
    return note + ([f"In tension at some corner: {', '.join(pulled)}."] if pulled else [])
