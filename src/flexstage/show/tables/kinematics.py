"""Tables of ideal kinematics: mobility and mappings."""

from __future__ import annotations

from collections.abc import Iterator

from flexstage.base.labelled import Matrix, ratio_units
from flexstage.models.linear.kinematics import Kinematics
from flexstage.show.display import number
from flexstage.show.table import Column, Table, make_table, matrix_table, merge_rows, text_table
from flexstage.show.tables.overview import count_text
from flexstage.spatial.frame import COMPONENTS, FORCES, TWIST_UNITS, WRENCH_UNITS


def mobility_table(kinematics: Kinematics) -> Table | None:
    """Tabulate the numbers and names of the platform's DOFs and of the strokes.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> mobility_table(ideal(double_triangle())).texts()[1]
    ['platform DOFs', '6', 'x, y, z, rx, ry, rz']
    """
    named = {
        "platform DOFs": kinematics.coordinates,
        "actuators": kinematics.actuators,
        "force actuators": kinematics.thrusts,
        "gauges": kinematics.gauges,
    }
    rows = {name: (str(len(each)), ", ".join(each)) for name, each in named.items() if each or name != "force actuators"}
    rows["free internal modes"] = str(len(kinematics.idle)), "move neither platform nor actuators"
    rows["redundant constraints"] = str(len(kinematics.redundant)), "stress the stage if parts do not fit exactly"
    notes = [actuation_text(kinematics)]
    return text_table("Mobility", ["", Column("number"), "which"], rows, notes=notes, provenance=kinematics.provenance)


def kinematics_tables(kinematics: Kinematics) -> Iterator[Table | None]:
    """Tabulate mobility, and the mappings of actuators and gauges that the stage has.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> len([table for table in kinematics_tables(ideal(double_triangle())) if table])
    3
    """
    yield mobility_table(kinematics)
    yield mapping_table(kinematics) if kinematics.actuated else None
    yield force_table(kinematics)
    yield gauge_table(kinematics) if kinematics.gauges else None


def actuation_text(kinematics: Kinematics) -> str:
    """Describe whether the strokes determine the platform's pose, and along which coordinates forces can act individually.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> actuation_text(ideal(double_triangle()))
    '6 strokes, 6 DOFs: the strokes determine the platform, and every command is free of stress in the ideal stage.'
    """
    if kinematics.thrusts and not kinematics.actuators:
        return _command_text(kinematics)
    strokes, mobility = len(kinematics.actuators), kinematics.mobility
    counted = f"{count_text(strokes, 'stroke')}, {count_text(mobility, 'DOF')}"
    if kinematics.thrusts and not kinematics.actuated:
        return f"{counted}: the strokes do not determine the platform, so there is no mapping R_a. {_command_text(kinematics)}"
    if not kinematics.actuated:
        held = f", but the links lock {', '.join(kinematics.immobile)}" if kinematics.immobile and mobility else ""
        return f"{counted}{held}: the strokes do not determine the platform, so there is no mapping R_a."
    if strokes > mobility:
        return f"{counted}: redundant actuation. Stroke combinations outside the range of R_a only stress the stage."
    return f"{counted}: the strokes determine the platform, and every command is free of stress in the ideal stage."


def _command_text(kinematics: Kinematics) -> str:
    """Ideal motions that forces, with the strokes, can command."""
    known = kinematics.commanded
    left = [name for name in kinematics.coordinates if name not in known]
    reach = f"they can command {', '.join(known)} independently" if known else "they can command no coordinate independently"
    rest = f", but not {', '.join(left)}" if known and left else ""
    forces = count_text(len(kinematics.thrusts), "force actuator")
    return f"{forces}: forces do not determine motions; {reach}{rest}. The elastic model computes the travel."


def force_table(kinematics: Kinematics) -> Table | None:
    """Tabulate V^T W, the generalised forces along the ideal motions V; W contains the wrench per unit input of each force actuator.

    Returns `None` without force actuators.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> force_table(ideal(double_triangle())) is None
    True
    """
    if not kinematics.thrusts or not kinematics.mobility:
        return None
    whole = kinematics.mobility == len(COMPONENTS)
    note = "Wrench on the platform at its reference point." if whole else "Generalised forces along the ideal motions only."
    found = kinematics.force_map
    rows = tuple(f"{name} [{WRENCH_UNITS[FORCES.index(name)]}]" for name in found.rows)
    columns = tuple(f"{name} [{unit}]" for name, unit in zip(found.columns, kinematics.thrust_inputs, strict=True))
    return matrix_table("Force map W" if whole else "Force map V^T W", Matrix(found.values, rows, columns, "1"), notes=[note])


def mapping_table(kinematics: Kinematics) -> Table:
    """Tabulate the mapping R_a = da/dxi: the strokes a of the actuators per ideal platform motion xi.

    Raises `DesignError` if the stage is under-actuated.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> mapping_table(ideal(double_triangle())).texts()[1][:4]
    ['B1 [um]', '1', '0', '0']
    """
    return matrix_table("Actuator mapping R_a", kinematics.mapping, units=("mrad",))


def gauge_table(kinematics: Kinematics) -> Table:
    """Tabulate the mapping R_s = ds/dx: the readings s of the gauges per platform motion x.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> gauge_table(ideal(double_triangle())).texts()[4][:4]
    ['S4 [um]', '0', '0', '1']
    """
    return matrix_table("Gauge mapping R_s", kinematics.gauge_mapping, units=("mrad",))


def motion_table(kinematics: Kinematics) -> Table | None:
    """Tabulate V, the ideal motions of a platform with fewer than six DOFs. Returns `None` for platforms with six DOFs.

    Each column is named after a coordinate; the rows of all other coordinates contain parasitic motions.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> motion_table(ideal(double_triangle())) is None
    True
    """
    if kinematics.mobility in (0, 6):
        return None
    units = ratio_units(TWIST_UNITS, tuple(TWIST_UNITS[COMPONENTS.index(name)] for name in kinematics.coordinates))
    note = f"Rotations are multiplied by {number(1e3 * kinematics.first_length, 4)} mm to compare them with translations."
    return matrix_table(
        "Ideal motions V", Matrix(kinematics.motion, COMPONENTS, kinematics.coordinates, units), units=("mrad",), notes=[note]
    )


def freedom_table(kinematics: Kinematics) -> Table:
    """Tabulate the free DOFs of each link in the ideal model; equal links in instances of a unit share a row.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> freedom_table(ideal(double_triangle())).texts()[1]
    ['back (B1, B2, B3)', 'rx, ry, rz']
    """
    free = {link: ", ".join(freedom.value for freedom in freedoms) or "none" for link, freedoms in kinematics.free.items()}
    notes = ["DOFs are in the frame of each link, with x along the part."]
    return merge_rows(make_table("Free DOFs of the links in the ideal model", ["link", "free"], free.items(), notes=notes))
