"""The stages that are compared, and short names for what is asked of them."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass, replace

import flexstage as fs
from flexstage.analysis.linear_statics.omitted import Restrictions
from flexstage.analysis.linear_statics.units import UnitResult
from flexstage.analysis.linear_statics.units import units as units_of
from flexstage.base.number import Array
from flexstage.beams.compliance import compliance
from flexstage.cases.double_triangle import SM_REF_A, SM_REF_B, double_triangle
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.restrict import isolate, restrict
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.static import static_gain
from flexstage.models.mapped import LeverStiffness, lever_stiffness

UP = (0.0, 0.0, 1.0)
SETS: Mapping[str, str] = {"A": SM_REF_A, "B": SM_REF_B}


@dataclass(frozen=True)
class Known:
    """One parameter set: its stage and what is often asked of it."""

    letter: str
    stage: fs.Mechanism

    @functools.cached_property
    def ideal(self) -> Kinematics:
        """Its kinematics."""
        return fs.ideal(self.stage)

    @functools.cached_property
    def units(self) -> Mapping[str, UnitResult]:
        """Each unit alone."""
        return units_of(self.stage)

    @functools.cached_property
    def lever(self) -> LeverStiffness:
        """The springs of a vertical unit."""
        return lever_stiffness(expand(self.stage), "B4/pzt")

    def part(self, name: str) -> Array:
        """The diagonal of a part's compliance."""
        part = self.stage.parts[name]
        return compliance(part, self.stage.materials["steel"]).diagonal()  # type: ignore[arg-type]

    def restricted(self, known: Restrictions) -> fs.LinearModel:
        """One vertical unit, guided upwards, restricted to what a theory knows."""
        unit = self.vertical()
        return fs.lumped(restrict(unit, {name: kept for name, kept in known.items() if name in unit.parts}))

    def vertical(self) -> fs.Mechanism:
        """One vertical unit alone, its output guided upwards."""
        return isolate(self.stage, "B4", guide=UP)


def gain(model: fs.LinearModel) -> float:
    """Output per stroke of a vertical unit alone."""
    return float(static_gain(model, ("platform.z",), ("B4",)).values[0, 0])


def load_term(model: fs.LinearModel) -> float:
    """Output per force of a vertical unit alone [m/N]."""
    return float(static_gain(model, ("platform.z",), ("platform.fz",)).values[0, 0])


@functools.cache
def known(letter: str) -> Known:
    """The parameter set of that letter."""
    return Known(letter, double_triangle(SETS[letter]))


def with_plate(stage: fs.Mechanism, edge: float, thickness: float, hole: float) -> fs.Mechanism:
    """The stage under another square plate, centred at its origin."""
    plate = fs.Block("steel", (edge, edge, thickness), hole=(hole, hole))
    return replace(stage, bodies={"platform": fs.Body(solids={"plate": plate})}, tags={}, envelope=None, opening=None)
