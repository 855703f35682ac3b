"""Tables of the workspace: what the platform reaches, what that asks of actuators and gauges, forces and clearance."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexstage.analysis.workspace.clearance import Clearance
from flexstage.analysis.workspace.gauging import GaugeRange, PoseResolution
from flexstage.analysis.workspace.map_error import MapError
from flexstage.analysis.workspace.polytope import Polytope
from flexstage.analysis.workspace.stroke import Utilisation
from flexstage.analysis.workspace.workspace import Workspace
from flexstage.base.labelled import NOISE, Matrix
from flexstage.base.number import Array, Number
from flexstage.show.display import NO_VALUE, display_unit_of, format_value, number, percent
from flexstage.show.table import Cell, Column, Mark, Table, first_design, make_table, row_table, unit_row_table
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

_ARM = 0.1
"""Arm [m] at which rotations are compared with strokes."""


def unit_of(coordinate: str) -> str:
    """SI unit of a platform coordinate.

    >>> unit_of("x"), unit_of("platform.rz")
    ('m', 'rad')
    """
    return TWIST_UNITS[COMPONENTS.index(coordinate.rpartition(".")[2])]


def command_text(command: Mapping[str, Number]) -> str:
    """A box of commands in words.

    >>> command_text({"x": 50e-6, "rz": 244e-6})
    'x +-50 um, rz +-244 urad'
    """
    return ", ".join(f"{name} +-{format_value(float(np.real(np.ravel(value)[0])), unit_of(name))}" for name, value in command.items())


def stroke_table(workspace: Workspace) -> Table:
    """Strokes of the platform along one coordinate at a time, ideal and with lost motion corrected by command.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.analysis.workspace.workspace import workspace
    >>> stroke_table(workspace(double_triangle(), ideal(double_triangle()), None)).texts()[3]
    ['z', 'um', '-300', '300', '300', '-', 'B4']
    """
    single, corrected = workspace.single_axis, workspace.corrected
    low, high, both = (first_design(values, 1) for values in (single.low, single.high, single.symmetric))
    rows: list[tuple[Cell | str, ...]] = []
    for index, name in enumerate(single.coordinates):
        form = display_unit_of(unit_of(name), float(max(abs(low[index]), abs(high[index]))))
        real = "-" if corrected is None else number(form.factor * float(first_design(corrected.symmetric, 1)[index]))
        texts = [number(form.factor * float(value)) for value in (low[index], high[index], both[index])]
        rows.append((Cell(name, Mark.STRONG), form.unit, *texts, real, single.limiting[index]))
    heads = ["along", "unit", Column("from"), Column("to"), Column("both ways"), Column("corrected, both ways"), "limited by"]
    note = "One coordinate at a time, the others held at zero. Corrected: lost motion made up by command, at the cost of stroke."
    return make_table("Single-axis strokes", heads, rows, notes=[note], provenance=single.provenance)


def corner_table(corner: Utilisation) -> Table:
    """What all commanded strokes at once ask of the actuators.

    >>> import numpy as np
    >>> corner_table(Utilisation(("B1",), {"x": 5e-05}, np.array([5e-5]), np.array([7.5e-5]), "")).texts()[1]
    ['B1', '50', '75', '66.67 %']
    """
    scale = float(first_design(np.atleast_1d(corner.scale), 1)[0])
    verdict = "within reach" if scale >= 1.0 else "out of reach"
    note = f"{command_text(corner.command)}, all at once: {verdict}; the whole box may be scaled by {number(scale, 4)}."
    return row_table("Simultaneous strokes", corner, notes=[note])


def _share_cell(share: float) -> Cell:
    """A share of a limit; more than the whole is marked."""
    return Cell(percent(share), Mark.FAIL if share > 1.0 + 1e-9 else Mark.PLAIN, bar=share)


def extent_table(polytope: Polytope) -> Table:
    """Least and largest value of each coordinate when all others may follow.

    >>> import numpy as np
    >>> box = Polytope(("z",), np.ones((2, 1)), np.ones(2), np.array([[-1e-6], [2e-6]]), np.array(3e-6), "m", "")
    >>> extent_table(box).texts()[1]
    ['z', 'um', '-1', '2']
    """
    title = "Reachable extents, other coordinates free to follow"
    return unit_row_table(title, polytope.extent, heads=("least", "largest"))


def map_error_table(error: MapError) -> Table:
    """Largest error of the linear map over all strokes, by axis.

    >>> import numpy as np
    >>> zero = MapError((), np.zeros((1, 0)), np.zeros((1, 6)), np.zeros(6), np.zeros((6, 0)), np.array(0.0), "")
    >>> map_error_table(zero).texts()[1]
    ['x', '0', '']
    """
    worst, strokes = first_design(error.worst, 1), first_design(error.worst_strokes, 2)
    noise = NOISE * np.max(np.abs(error.strokes), initial=0.0) / np.array([1.0, 1.0, 1.0, *[_ARM] * 3])
    rows = [
        (
            Cell(name, Mark.STRONG),
            Cell(format_value(float(value), unit, 4) if value > least else "0"),
            _strokes_text(error.actuators, line) if value > least else "",
        )
        for name, unit, value, line, least in zip(COMPONENTS, TWIST_UNITS, worst, strokes, noise, strict=True)
    ]
    tried = f"Finite less linear kinematics at {error.strokes.shape[0]} combinations of strokes."
    rule = f"0 stands for rounding noise: below a billionth of the largest stroke (rotations: of one at an arm of {_ARM:g} m)."
    notes = [tried, rule] if any(row[1].text == "0" for row in rows) else [tried]
    return make_table("Error of the linear map", ["along", Column("worst"), "at strokes [um]"], rows, notes=notes)


def _strokes_text(actuators: tuple[str, ...], strokes: Array) -> str:
    return ", ".join(f"{name} {number(1e6 * float(at), 4)}" for name, at in zip(actuators, strokes, strict=True))


def gauge_range_table(gauges: GaugeRange) -> Table:
    """Swing of every gauge at the commanded corner against half its range, and how far out it could sit.

    >>> import numpy as np
    >>> one = np.ones(1)
    >>> seen = GaugeRange(("S1",), {}, 1e-4 * one, 2.5e-4 * one, 0.13 * one, 0.3 * one, np.inf * one, "")
    >>> gauge_range_table(seen).texts()[1]
    ['S1', '100', '250', '40 %', '130', '300', 'any']
    """
    swing, limit = first_design(gauges.swing, 1), first_design(gauges.limit, 1)
    places = (gauges.radius, gauges.largest_here, gauges.largest_anywhere)
    units = ["" if unit == "m" else f" u{unit}" for unit in gauges.units or ("m",) * len(gauges.gauges)]
    radii = [[_radius(float(value)) for value in first_design(each, 1)] for each in places]
    rows = [
        (
            Cell(name, Mark.STRONG),
            *(number(1e6 * float(each[index])) + unit for each in (swing, limit)),
            _share_cell(float(swing[index] / limit[index])),
            *(column[index] for column in radii),
        )
        for (index, name), unit in zip(enumerate(gauges.gauges), units, strict=True)
    ]
    heads = ["gauge", Column("swing", "um"), Column("half range", "um"), Column("used")]
    heads += [Column("radius", "mm"), Column("largest, same angle", "mm"), Column("largest, any angle", "mm")]
    return make_table("Gauge ranges", heads, rows, notes=[f"{command_text(gauges.command)}, all at once."])


def _radius(value: float) -> str:
    return "any" if np.isinf(value) else NO_VALUE if np.isnan(value) else number(1e3 * value, 4)


def resolution_table(resolution: PoseResolution) -> Table:
    """Pose error of one resolution step of every gauge, and of its noise.

    >>> import numpy as np
    >>> none = Matrix(np.zeros((6, 0)), COMPONENTS, (), "1")
    >>> empty = PoseResolution(none, np.zeros(0), np.zeros(0), np.full(6, 1e-8), np.full(6, 1e-8), np.full(6, np.nan), "")
    >>> resolution_table(empty).texts()[1]
    ['x', 'nm', '10', '10', '-']
    """
    notes = ("Worst: all gauges one step off with the worst signs. Rms: independent steps.",)
    fine = Matrix(resolution.table.values, COMPONENTS, resolution.table.columns, resolution.table.unit)
    return unit_row_table("Pose resolution of the gauges", fine, heads=("worst", "rms", "noise, rms"), notes=notes)


def clearance_table(found: Clearance) -> Table:
    """The bounding box of the stage against its envelope.

    >>> import numpy as np
    >>> clearance_table(Clearance((), np.zeros(3), np.full(3, 0.1), None, ("a",) * 6)).texts()[1]
    ['x', '0', '100', '100', '-', 'a, a']
    """
    table = first_design(found.table.values, 2)
    rows: list[tuple[Cell | str, ...]] = []
    for index, axis in enumerate("xyz"):
        line = [number(1e3 * float(value)) for value in table[index]]
        limit = line[3] if len(line) > 3 else NO_VALUE
        fits = len(line) < 4 or table[index][2] <= table[index][3] + 1e-9
        size = Cell(line[2], Mark.PLAIN if fits else Mark.FAIL)
        rows.append((Cell(axis, Mark.STRONG), line[0], line[1], size, limit, f"{found.extreme[index]}, {found.extreme[3 + index]}"))
    heads = ["axis", Column("from", "mm"), Column("to", "mm"), Column("size", "mm"), Column("envelope", "mm"), "reached by"]
    clear = [f"{item.name} enters the clear opening by {number(1e3 * float(np.max(item.depth)), 4)} mm." for item in found.intrusions]
    kept = clear or ([] if found.opening is None else ["Nothing enters the clear opening."])
    return make_table("Clearance", heads, rows, notes=kept)
