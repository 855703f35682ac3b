"""Tables of statics: stiffness, compliance, stiffness by DOF and by direction, mass."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from flexstage.analysis.linear_statics.mass_matrix import MassMatrix
from flexstage.analysis.linear_statics.statics import DirectionalStiffness, FreedomStiffness, Statics, by_freedom
from flexstage.base.labelled import Matrix
from flexstage.base.number import Array
from flexstage.show.display import number
from flexstage.show.table import Table, column_table, first_design, matrix_table, result_table, short_names

_LOAD = 100.0
_STEP = 15


def stiffness_table(statics: Statics) -> Table:
    """Tabulate the stiffness matrix K of the platform with fixed actuators.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.analysis.linear_statics.statics import statics
    >>> stiffness_table(statics(mapped(double_triangle()))).texts()[1][:2]
    ['fx [N]', '15.45']
    """
    return matrix_table(f"Stiffness at {_points(statics)}", statics.stiffness)


def compliance_table(statics: Statics) -> Table:
    """Tabulate the compliance matrix C of the platform with fixed actuators.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.analysis.linear_statics.statics import statics
    >>> compliance_table(statics(mapped(double_triangle()))).texts()[3][3]
    '0.099083'
    """
    return matrix_table(f"Compliance at {_points(statics)}", statics.compliance)


def freedom_stiffness_table(freedoms: FreedomStiffness) -> Table:
    """Tabulate the stiffness by DOF: along free ideal motions, then along constrained motions.

    >>> import flexstage as fs
    >>> stage = fs.case("parallelogram")
    >>> table = freedom_stiffness_table(fs.freedom_stiffness(fs.statics(fs.lumped(stage)), fs.ideal(stage)))
    >>> [row[0] for row in table.texts()[1:3]]
    ['x, free motion', 'y, constrained']
    """
    left, rest = freedoms.motions, freedoms.constraints
    names = (*(f"{name}, free motion" for name in left.rows), *(f"{name}, constrained" for name in rest.rows))
    whole = by_freedom(np.concatenate([left.values, rest.values], axis=-2), (*left.rows, *rest.rows))
    note = "Actuators are fixed. Others free: other motions are free, as in a push test, including parasitic motion along other axes."
    locked = [f"{reason[:1].upper()}{reason[1:]}." for reason in sorted(set(freedoms.reasons.values()))]
    found = replace(whole, rows=names, columns=("others free", "others fixed"))
    return column_table(f"Stiffness by DOF at {freedoms.point}", found, head="DOF", notes=(note, *locked))


def mass_tables(mass: MassMatrix) -> Iterator[Table]:
    """Tabulate two mass matrices at a point: of the point's rigid body with payloads, and of the whole stage by static condensation.

    >>> import flexstage as fs
    >>> stage = fs.case("parallelogram")
    >>> [table.title for table in mass_tables(fs.mass_matrix(stage, fs.lumped(stage)))]
    ['Mass at platform, platform with payloads', 'Mass at platform, whole stage']
    """
    if mass.rigid is not None:
        yield matrix_table(f"Mass at {mass.point}, {mass.body} with payloads", _short(mass.rigid))
    if mass.reduced is not None:
        note = "Static (Guyan) condensation with fixed actuators: all other masses follow quasi-statically."
        yield matrix_table(f"Mass at {mass.point}, whole stage", _short(mass.reduced), notes=[note])


def _short(matrix: Matrix) -> Matrix:
    return replace(matrix, rows=short_names(matrix.rows), columns=short_names(matrix.columns))


def _points(statics: Statics) -> str:
    same = statics.load_point == statics.read_point
    return statics.read_point if same else f"{statics.read_point}, loaded at {statics.load_point}"


def direction_table(statics: Statics) -> Table:
    """Tabulate displacement and stiffness for several directions of a force of 100 N in the plane, as in Table 1 of Shin & Moon.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.analysis.linear_statics.statics import statics
    >>> direction_table(statics(mapped(double_triangle()))).texts()[1]
    ['0', '7.3326', '13.638', '15.45']
    """
    degrees = np.arange(0, 180, _STEP)
    free, held = (_along(item, np.deg2rad(degrees)) for item in (statics.free, statics.held))
    heads = (f"displacement at {number(_LOAD)} N", "stiffness, others free", "stiffness, others fixed")
    with np.errstate(divide="ignore"):
        values = np.stack([_LOAD / free, free, held], axis=-1)
    found = Matrix(values, tuple(map(str, degrees)), heads, (("m", "N/m", "N/m"),) * len(degrees))
    return column_table("Stiffness by direction in the plane", found, head="direction [deg]", notes=["Measured from x towards y."])


def _along(stiffness: DirectionalStiffness, angles: Array) -> Array:
    return np.array([first_design(np.atleast_1d(stiffness.along(float(angle))), 1)[0] for angle in angles])


def principal_table(statics: Statics) -> Table | None:
    """Tabulate principal stiffnesses in the plane and their directions, with other DOFs free and fixed.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.analysis.linear_statics.statics import statics
    >>> principal_table(statics(mapped(double_triangle()))).texts()[1]
    ['free', '13.638', '13.638', '-', '0 %']
    """
    return result_table({"free": statics.free, "held": statics.held})


def centre_table(statics: Statics) -> Table:
    """Tabulate the position of the centre of stiffness relative to the load point.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> from flexstage.analysis.linear_statics.statics import statics
    >>> centre_table(statics(mapped(double_triangle()))).texts()[1]
    ['platform', '0', '0', '-25']
    """
    values = first_design(statics.centre, 1)[None]
    found = Matrix(np.where(np.abs(values) < 1e-9, 0.0, values), (statics.load_point,), ("x", "y", "z"), "m")
    return column_table("Centre of stiffness", found, head="relative to", unit="mm")
