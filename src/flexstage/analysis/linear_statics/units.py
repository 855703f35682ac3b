"""Analysis of each isolated unit: output stiffness, gain, lost motion, and errors of simpler theories."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.analysis.linear_statics.omitted import Omitted, lever_theory, omitted
from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.linear_statics.unit_output import UnitOutput
from flexstage.base.finding import DesignError
from flexstage.base.number import Array, Vector
from flexstage.base.record import Heading, Layout
from flexstage.base.session import SESSION
from flexstage.base.units.quantity import COMPLIANCE, SHARE, STIFFNESS
from flexstage.mechanism.assembly.expand import copies, expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.restrict import isolate
from flexstage.models.ideal import ideal
from flexstage.models.linear.static import static_gain
from flexstage.models.lumped import lumped
from flexstage.models.mapped import LeverStiffness, computed_stiffness, lever_stiffness

_DISPLACEMENTS = ("platform.x", "platform.y", "platform.z")
_FORCES = ("platform.fx", "platform.fy", "platform.fz")


@dataclass(frozen=True, eq=False)
class UnitResult(UnitOutput):
    """Properties of one isolated unit by the lumped model.

    `loss` and `load_compliance` [m/N] are computed with the output guided along its direction. `series` is the unit's stiffness in actuator
    coordinates for the mapped model (`None` if this model does not support the unit). For a lever unit, `lever` has the spring stiffnesses
    of lever theory. `omitted` has the errors of the gain that equation 3 of Shin & Moon gives, one for each degree of freedom that the
    equation neglects.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Isolated units",
        "copy axial softest_lateral stiffest_lateral ideal_gain gain loss series",
        head="unit",
        notes=("Stiffness is for fixed actuators. Gain and loss are for an output that is guided along its direction.",),
    )

    loss: Annotated[float, SHARE]
    load_compliance: Annotated[float, COMPLIANCE]
    series: Annotated[float | None, STIFFNESS, Heading("in actuator coordinates")]
    lever: LeverStiffness | None
    omitted: Omitted | None


def units(mechanism: Mechanism, *, omissions: bool = True) -> dict[str, UnitResult]:
    """Isolate and analyse, for every unit, the first instance with exactly one actuator at its output. Batches are not supported.

    A unit that does not work in isolation (a carriage guided by neighbouring units) is omitted. If `omissions` is true, the errors of lever
    theory are also computed, which takes most of the time.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(units(double_triangle())["horizontal"].axial / 1e6, 2)  # N/um
    10.3
    """
    return {
        unit: unit_alone(mechanism, copy, unit, direction, omissions=omissions)
        for unit, (copy, direction) in driven_units(mechanism).items()
    }


def driven_units(mechanism: Mechanism) -> dict[str, tuple[str, Array]]:
    """Return, for each unit, the first instance with exactly one actuator at its output, and the direction (3,) of the output.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> {unit: copy for unit, (copy, _) in driven_units(double_triangle()).items()}
    {'horizontal': 'B1', 'vertical': 'B4'}
    """
    actuators = expand(mechanism).strokes
    mapping = ideal(mechanism).mapping
    first: dict[str, tuple[str, Array]] = {}
    for copy, unit, frame in copies(mechanism):
        if copy in actuators and unit not in first:
            row = mapping.values[mapping.rows.index(copy)]
            pushed = np.zeros(3)
            for value, name in zip(row, mapping.columns, strict=True):
                if name in ("x", "y", "z"):
                    pushed["xyz".index(name)] = value
            reach = np.linalg.norm(pushed)
            if not 0.0 < reach < np.inf:
                continue  # it rotates the platform without translation
            direction = frame.rotation.T @ pushed / reach
            if ideal(isolate(mechanism, copy, guide=as_vector(direction))).actuated:
                first[unit] = copy, direction
    return first


def as_vector(direction: Array) -> Vector:
    """Return a direction (3,) as a tuple of numbers.

    >>> as_vector(np.array([0.0, 0.0, 1.0]))
    (0.0, 0.0, 1.0)
    """
    return (float(direction[0]), float(direction[1]), float(direction[2]))


def unit_alone(mechanism: Mechanism, copy: str, unit: str, direction: Array, *, omissions: bool = True) -> UnitResult:
    """Analyse one isolated instance of a unit with output along a direction (3,).

    If `omissions` is true, the result includes the errors of lever theory.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(unit_alone(double_triangle(), "B4", "vertical", np.array([0.0, 0.0, 1.0])).gain, 1)
    2.9
    """
    guided = isolate(mechanism, copy, guide=as_vector(direction))
    model, kinematics = lumped(guided), ideal(guided)
    gain = direction @ static_gain(model, _DISPLACEMENTS, (copy,)).values[:, 0]
    load = direction @ static_gain(model, _DISPLACEMENTS, _FORCES).values @ direction
    ideal_gain = direction @ kinematics.jacobian.values[:3, 0]
    lever = _lever(mechanism, copy)
    output = _DISPLACEMENTS[int(np.argmax(np.abs(direction)))]
    return UnitResult(
        unit=unit,
        copy=copy,
        direction=direction,
        stiffness=statics(lumped(isolate(mechanism, copy))).stiffness,
        gain=float(gain),
        ideal_gain=float(ideal_gain),
        loss=float(lost_motion(kinematics, model).loss.values[0, 0]),
        load_compliance=float(load),
        series=_series(mechanism, copy),
        lever=lever,
        omitted=None if lever is None or not omissions else _omitted(guided, unit, output, copy),
    )


@SESSION.keep(8)
def _omitted(guided: Mechanism, unit: str, output: str, actuator: str) -> Omitted:
    """Errors of lever theory, cached by unit."""
    return omitted(guided, lever_theory(guided, unit), (output, actuator))


def _series(mechanism: Mechanism, copy: str) -> float | None:
    assembly = expand(mechanism)
    try:
        return float(computed_stiffness(assembly, assembly.actuators[copy]))
    except DesignError:
        return None


def _lever(mechanism: Mechanism, copy: str) -> LeverStiffness | None:
    assembly = expand(mechanism)
    try:
        return lever_stiffness(assembly, assembly.actuators[copy])
    except DesignError:
        return None
