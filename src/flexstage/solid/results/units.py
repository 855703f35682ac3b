"""Results of isolated units as solids: output stiffness, gain, lost motion (Table 2 of Shin & Moon) and stress at full stroke."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np

from flexstage.analysis.linear_statics.statics import statics
from flexstage.analysis.linear_statics.unit_output import UnitOutput
from flexstage.analysis.linear_statics.units import as_vector, driven_units
from flexstage.base.arguments import check_arguments
from flexstage.base.finding import refuse
from flexstage.base.labelled import NOISE
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Array
from flexstage.base.record import INNER, VIEW, Heading, Layout
from flexstage.base.units.quantity import COMPLIANCE, LENGTH, RATIO
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.mechanism.restrict import isolate
from flexstage.models.ideal import ideal
from flexstage.models.linear.static import displacement, static_gain
from flexstage.parts.piezo import Piezo
from flexstage.solid.fea.meshing.fineness import Reduction
from flexstage.solid.results.read import STANDARD_REDUCTION, STANDARD_SOLIDS, SolidRead, Solids, read_solid
from flexstage.solid.results.stress import SHARP_CORNERS, LinkStress, link_stress
from flexstage.spatial.frame import COMPONENTS

_TWIST = tuple(f"platform.{name}" for name in COMPONENTS)
_STEPS = 5


@dataclass(frozen=True, eq=False)
class SolidUnit(UnitOutput, InNotebook):
    """Results of one isolated unit without load by the linear solid model; the unit's output is guided along `direction`.

    `strokes` (k,) [m] are steps up to the full stroke, and `outputs` (k,) [m] are the output displacements at these strokes. `stress` is
    the highest stress of every link at the full stroke. For pictures, `motion` (N,) are the coordinates of the unit's model `read` at the
    full stroke.
    """

    TABLE: ClassVar[Layout] = Layout(
        "Isolated units as solids",
        "copy axial lateral gain ideal_gain loss stress.weakest stress.peak stress.least_safety",
        head="unit",
        notes=(
            "Each unit is isolated; its output is a rigid face.",
            "Axial (K_a) and lateral (K_l) stiffness: with fixed actuators, and with all other motions of the output prevented.",
            f"Gain and stress: at full stroke without load, with the output guided along its direction. {SHARP_CORNERS}",
        ),
    )

    strokes: Annotated[Array, LENGTH, Heading("stroke", unit="um")]
    stress: LinkStress | None
    motion: Array
    read: Annotated[SolidRead, INNER]

    @property
    def elements(self) -> Annotated[int, VIEW]:
        """Number of elements."""
        return self.read.elements

    @property
    def freedoms(self) -> Annotated[int, VIEW]:
        """Number of DOFs before reduction."""
        return self.read.freedoms

    @property
    def loss(self) -> Annotated[float, RATIO, Heading(unit="%")]:
        """Lost motion divided by the ideal output."""
        return 1.0 - self.gain / self.ideal_gain

    @property
    def load_compliance(self) -> Annotated[float, COMPLIANCE]:
        """Compliance of the guided output under a force along its direction [m/N]."""
        return 1.0 / self.axial

    @property
    def commands(self) -> Annotated[Array, LENGTH, Heading("ideal output", unit="um")]:
        """Commanded outputs (k,) [m]: the ideal outputs for the strokes."""
        return self.ideal_gain * self.strokes

    @property
    def outputs(self) -> Annotated[Array, LENGTH, Heading("output", unit="um")]:
        """Output displacements (k,) [m] for the strokes."""
        return self.gain * self.strokes

    @property
    def lost(self) -> Annotated[Array, INNER, LENGTH, Heading("lost motion", unit="um")]:
        """Lost motion (k,) [m]: commanded output minus output; differences within rounding error are zero."""
        found = self.commands - self.outputs
        return np.where(np.abs(found) < NOISE * np.abs(self.commands), 0.0, found)


@check_arguments
def solid_units(mechanism: Mechanism, reduction: Reduction = STANDARD_REDUCTION, reduce: Solids = STANDARD_SOLIDS) -> dict[str, SolidUnit]:
    """Compute solid models of all units that have one actuator at their output, isolated from the stage. Return the results by unit name.

    The first instance of a unit that has exactly one actuator at its output is used. Outlines of bodies outside the unit are left out. The
    output is the end face of the link to the platform; this face remains plane. Raises `DesignError` if the stage has no unit with one
    actuator.

    >>> from flexstage.cases.registry import case
    >>> solid_units(case("bridge"))
    Traceback (most recent call last):
        ...
    flexstage.base.finding.DesignError: units: no unit of the stage drives its own output by one actuator. ...
    """
    found = driven_units(mechanism)
    if not found:
        raise refuse(
            "units",
            "no unit of the stage drives its own output by one actuator",
            "Use --scope stage",
        )
    return {unit: _unit(mechanism, unit, copy, direction, reduction=reduction, reduce=reduce) for unit, (copy, direction) in found.items()}


def _unit(mechanism: Mechanism, unit: str, copy: str, direction: Array, *, reduction: Reduction, reduce: Solids) -> SolidUnit:
    alone = isolate(mechanism, copy)
    read = read_solid(alone, reduction, reduce)
    stiffness = statics(read.model).stiffness
    along = np.concatenate([direction, np.zeros(3)])
    driven = static_gain(read.model, _TWIST, (copy,)).values[:, 0]
    axial = float(along @ stiffness.values @ along)
    gain = float(along @ stiffness.values @ driven) / axial
    guide = stiffness.values @ (along * gain - driven)
    full = full_stroke(mechanism, copy)
    platform = read.model.output[read.model.output_index(_TWIST)]
    load = read.model.input_matrix[:, read.model.input_index((copy,))[0]] + platform.T @ guide
    motion = full * displacement(read.model, load[:, None])[:, 0]
    return SolidUnit(
        unit=unit,
        copy=copy,
        direction=direction,
        stiffness=stiffness,
        gain=gain,
        ideal_gain=float(direction @ ideal(isolate(mechanism, copy, guide=as_vector(direction))).jacobian.values[:3, 0]),
        strokes=full * np.arange(1, _STEPS + 1) / _STEPS,
        stress=link_stress(read, motion[:, None], {copy: np.array([full])}),
        motion=motion,
        read=read,
    )


def full_stroke(mechanism: Mechanism, copy: str) -> float:
    """Return the full stroke of the stack of an instance [m]; NaN without a stack.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(full_stroke(double_triangle(), "B4"), 9)
    0.0002
    """
    assembly = expand(mechanism)
    part = assembly.links[assembly.actuators[copy]].part
    return float(np.real(part.stroke)) if isinstance(part, Piezo) else np.nan
