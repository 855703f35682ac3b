"""Bench: models and results of a stage, computed on first use."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flexstage.analysis.dynamics.modes import Modes, modes
from flexstage.analysis.linear_statics.deflection import Deflection, deflection
from flexstage.analysis.linear_statics.drift import Drift, drift
from flexstage.analysis.linear_statics.lost_motion import LostMotion, lost_motion
from flexstage.analysis.loaded.course import course
from flexstage.analysis.loaded.load_effect import LoadEffect, load_effect
from flexstage.analysis.loaded.stability import Stability, stability
from flexstage.analysis.loaded.standing import drawn, kinematics, standing, under_load
from flexstage.analysis.workspace.buckling import Buckling, buckling
from flexstage.analysis.workspace.clearance import Clearance, bounds, clearance
from flexstage.analysis.workspace.force_workspace import ForceWorkspace, force_workspace, input_limits
from flexstage.analysis.workspace.load import LoadShare, load_share
from flexstage.analysis.workspace.map_error import linear_map_error
from flexstage.analysis.workspace.small import SmallMotion, small_motion
from flexstage.analysis.workspace.stops import with_stops
from flexstage.analysis.workspace.strength import FROM_ZERO, HingeStress, hinge_stress
from flexstage.analysis.workspace.stroke import StrokeLimits, mapping_at, stroke_limits
from flexstage.analysis.workspace.wrench import Command
from flexstage.base.finding import refuse
from flexstage.base.labelled import Matrix
from flexstage.base.lazy import LazyModule
from flexstage.base.number import Array, stack
from flexstage.mechanism.assembly.expand import Assembly, expand
from flexstage.mechanism.design import design
from flexstage.mechanism.geometry.outline import outlines
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel

if TYPE_CHECKING:
    from flexstage.analysis.loaded import stroke as strokes
    from flexstage.models.nonlinear import linearise
    from flexstage.models.nonlinear import stage as displaced
else:
    strokes = LazyModule("flexstage.analysis.loaded.stroke")
    linearise = LazyModule("flexstage.models.nonlinear.linearise")
    displaced = LazyModule("flexstage.models.nonlinear.stage")


KEPT = 48
"""Largest number of cached benches, each of a single design of a batch; a bench uses about a megabyte."""
_TOGETHER = 3
"""Largest number of required strokes for which all corners of their box are computed; with more, only both ends of each stroke."""


class StageResults:
    """Models and results of one stage, computed on first use. `command` contains the required stroke of each coordinate."""

    def __init__(self, mechanism: Mechanism, command: Mapping[str, float]) -> None:
        self.mechanism = mechanism
        self.command = command
        self._corrections: dict[str, Matrix] = {}
        self._force_workspaces: dict[str, ForceWorkspace] = {}
        self._points: dict[tuple[str, float | None], strokes.Points] = {}
        self._ones: dict[tuple[int, float], StageResults] = {}
        self._along: dict[str, StageResults] = {}

    @cached_property
    def nonlinear(self) -> displaced.Nonlinear:
        """Model for large displacements."""
        return displaced.nonlinear(self.mechanism)

    def along(self, name: str, at: float | None = None) -> strokes.Points:
        """Stroke characteristics along a path of the design, or at one value `at` of the driven coordinate."""
        if (name, at) not in self._points:
            result = course(self.mechanism, name)
            self._points[name, at] = result.points(self.nonlinear, None if at is None else np.array([at]))
        return self._points[name, at]

    @staticmethod
    def all_along(benches: Sequence[StageResults], name: str, at: float | None = None) -> None:
        """Compute and store the results of `along` for several designs of the same structure together."""
        new = [each for each in benches if (name, at) not in each._points]  # noqa: SLF001
        if not new:
            return
        result = course(new[0].mechanism, name)
        points = result.points_of_designs([each.nonlinear for each in new], None if at is None else np.array([at]))
        for bench, each in zip(new, points, strict=True):
            bench._points[name, at] = each  # noqa: SLF001

    def one(self, place: int, share: float) -> StageResults:
        """Return the results of one design of a batch. Recent results are cached.

        Each complex number of the design is replaced by its real part plus `share` times its imaginary part.
        """
        if (place, share) not in self._ones:
            if len(self._ones) >= KEPT:
                self._ones.clear()
            self._ones[place, share] = StageResults(design(self.mechanism, place, share), self.command)
        return self._ones[place, share]

    def over(self, name: str) -> StageResults:
        """Return the results of the stage linearised about every point of a path; each point is one design of a batch."""
        if name not in self._along:
            result = course(self.mechanism, name)
            states = result.path(self.nonlinear, result.rest(self.nonlinear)).state
            lost = int(np.sum(~states.converged))
            if lost:
                raise refuse(f"paths.{name}", f"no equilibrium found at {lost} of {states.converged.size} points", "Reduce the stroke")
            self._along[name] = self.with_model(linearise.linearise(states, locked=result.locked))
        return self._along[name]

    def force_workspace(self, point: str) -> ForceWorkspace:
        """Force workspace of a point, for the nominal stage."""
        if point not in self._force_workspaces:
            self._force_workspaces[point] = force_workspace(self.mechanism, self.kinematics, self.drawn, point=point)
        return self._force_workspaces[point]

    @property
    def forced(self) -> bool:
        """Whether the stage is force-driven."""
        return bool(self.kinematics.thrusts) and not self.kinematics.actuated

    def correction(self, point: str) -> Matrix:
        """Actuator strokes per unit motion of a point, with lost motion corrected."""
        if point not in self._corrections:
            self._corrections[point] = mapping_at(self.mechanism, self.kinematics, point, mapping=self.lost.correction)
        return self._corrections[point]

    def stopped(self, point: str) -> tuple[Matrix, StrokeLimits]:
        """Return the actuator strokes and the motions at stops per unit motion of a point, and the limits of both (see `with_stops`).

        Lost motion is corrected.
        """
        return with_stops(self.mechanism, self.kinematics, self.correction(point), self.limits, point)

    @cached_property
    def assembly(self) -> Assembly:
        """Expanded description."""
        return expand(self.mechanism)

    @cached_property
    def kinematics(self) -> Kinematics:
        """Ideal model."""
        return kinematics(self.mechanism)

    @cached_property
    def small_motion(self) -> SmallMotion:
        """Limits within which the theory of small displacements is valid."""
        return small_motion(self.mechanism, self.kinematics)

    @cached_property
    def drawn(self) -> LinearModel:
        """Lumped model. Raises `DesignError` if the stage is unstable under its permanent load."""
        return standing(self.mechanism)

    @cached_property
    def model(self) -> LinearModel:
        """Linear model: the lumped model, or the model linearised about a state."""
        return self.drawn

    @cached_property
    def links(self) -> LinearModel:
        """Linear model with separate link stiffnesses, for lost motion and drift."""
        return self.model

    @cached_property
    def loaded(self) -> LoadEffect | None:
        """Effect of the permanent load; `None` for a batch."""
        return load_effect(self.mechanism)

    @cached_property
    def under_load(self) -> StageResults:
        """Results of the loaded stage (stiffness, modes, lost motion, drift) if the permanent load is significant; else this object."""
        point = None if self.loaded is None else self.loaded.point
        if point is None:
            return self
        other = self.with_model(point.linear)
        other.__dict__ |= {"links": point.links, "kinematics": self.kinematics}
        return other

    def with_model(self, model: LinearModel) -> StageResults:
        """Return a bench of the same stage with another linear model."""
        other = StageResults(self.mechanism, self.command)
        other.__dict__["model"] = model
        return other

    @cached_property
    def stability(self) -> Stability:
        """Buckling load factors of the permanent load."""
        return under_load(self.mechanism) or stability(self.mechanism, self.model)

    @cached_property
    def limits(self) -> StrokeLimits:
        """Stroke limits of the actuators, relative to their bias."""
        return stroke_limits(self.mechanism)

    @cached_property
    def lost(self) -> LostMotion:
        """Lost motion."""
        return lost_motion(self.kinematics, self.links)

    @cached_property
    def modes(self) -> Modes:
        """Modes, including the platform modes."""
        return modes(self.model)

    @cached_property
    def stress(self) -> HingeStress:
        """Largest hinge stresses over all strokes and forces; hinges are stress-free at zero voltage."""
        condition = "of all strokes and forces (coils at their limits in short use)" if self.assembly.thrusts else FROM_ZERO
        return hinge_stress(self.mechanism, self.model, self._loaded, condition=condition)

    @cached_property
    def stress_at_strokes(self) -> HingeStress:
        """Largest hinge stresses over all combinations of required strokes; hinges are stress-free at zero voltage."""
        box = self._driven_box()
        start = np.zeros(len(self.limits.actuators)) if self.limits.zero is None else -self.limits.zero
        mapping = self.per_motion
        known = dict(zip(self.limits.actuators, np.moveaxis(start, -1, 0), strict=True))
        start = stack([known.get(name, 0.0) for name in mapping.rows])
        half = stack(list(box.values()))
        limits, command = StrokeLimits(tuple(box), -half, half), Command(mapping, start)
        return hinge_stress(self.mechanism, self.model, limits, command=command, condition="of the required strokes")

    @property
    def per_motion(self) -> Matrix:
        """Inputs per unit displacement of the platform, with lost motion corrected."""
        return self.force_workspace(PLATFORM).per_motion if self.forced else self.lost.correction

    def corners(self) -> tuple[tuple[str, ...], Array]:
        """Return the k axes and the c corners (c, k) of the box of required strokes.

        For more than three axes, the corners are replaced by the two ends of each single stroke.
        """
        box = self._driven_box()
        half = np.array(list(box.values()))
        alone = np.concatenate([np.diag(half), -np.diag(half)])
        return tuple(box), StrokeLimits(tuple(box), -half, half).corners if len(box) <= _TOGETHER else alone

    def _driven_box(self) -> dict[str, float]:
        """Box of the required strokes; refuses those that no actuator drives."""
        box, driven = {name: value for name, value in self.box().items() if value > 0.0}, self.per_motion.columns
        for name in box.keys() - set(driven):
            raise refuse(f"stroke.{name}", "no actuator moves the platform along this axis", f"Require strokes along {', '.join(driven)}")
        return box

    @cached_property
    def _loaded(self) -> StrokeLimits:
        """Strokes from zero voltage, and forces."""
        return input_limits(self.mechanism, self.model) if self.assembly.thrusts else self.limits.from_zero

    @cached_property
    def drift(self) -> Drift:
        """Thermal drift."""
        return drift(self.mechanism, self.links)

    @cached_property
    def buckling(self) -> Buckling:
        """Buckling of columns and the whole stage over all strokes from zero voltage."""
        return buckling(self.mechanism, drawn(self.mechanism), self._loaded)

    def deflection(self, point: str) -> Deflection:
        """Deflection of a point under gravity and specified forces, with strokes fixed."""
        return deflection(self.mechanism, self.model, point=point)

    @cached_property
    def load_share(self) -> LoadShare:
        """Axial forces of the stacks."""
        return load_share(self.mechanism, self.model)

    @cached_property
    def clearance(self) -> Clearance:
        """Clearance of the stage."""
        return clearance(self.mechanism)

    @cached_property
    def size(self) -> Array:
        """Edge lengths (..., 3) [m] of the box around the stage."""
        low, high, _ = bounds(outlines(self.assembly))
        return high - low

    @cached_property
    def map_error(self) -> Array:
        """Largest error of the linear map from strokes to platform twist, in each component (..., 6)."""
        return linear_map_error(self.mechanism, self.kinematics, self.limits).worst

    def arm(self, point: str) -> Array:
        """Vector from the platform's reference point to another point of the platform; raises `DesignError` for points of other bodies."""
        if point == PLATFORM:
            return np.zeros(3)
        body, position = self.assembly.points[point]
        if body != PLATFORM:
            raise refuse(point, f"this point belongs to {body}, not to the platform", "Use a point of the platform")
        return position - self.assembly.bodies[PLATFORM].reference

    def box(self) -> Mapping[str, float]:
        """Required stroke of each coordinate."""
        if not self.command:
            raise refuse("requirements", "required strokes missing", 'Add e.g. "stroke.x" = "at least 50 um"')
        return self.command
