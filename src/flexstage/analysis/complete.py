"""Complete analysis of a stage: all analyses of one model, for reports and applications."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from flexstage.analysis.assessment.budget import budget
from flexstage.analysis.assessment.error_budget import ErrorBudget
from flexstage.analysis.assessment.judge import bench_of, judge
from flexstage.analysis.assessment.measures import stroke
from flexstage.analysis.assessment.requirements import Sense, Verdict, asked_factor, requirements
from flexstage.analysis.attempt import Attempts
from flexstage.analysis.dynamics.modes import Modes, modes
from flexstage.analysis.dynamics.response import response, transmissibility
from flexstage.analysis.linear_statics.deflection import Deflection, deflection
from flexstage.analysis.linear_statics.drift import Drift, drift
from flexstage.analysis.linear_statics.drive_force import DriveForce, drive_force
from flexstage.analysis.linear_statics.lost_motion import LostMotion, lost_motion
from flexstage.analysis.linear_statics.mass_matrix import MassMatrix, mass_matrix
from flexstage.analysis.linear_statics.statics import FreedomStiffness, Statics, freedom_stiffness, statics
from flexstage.analysis.linear_statics.units import UnitResult, units
from flexstage.analysis.loaded.load_effect import LoadEffect, load_effect
from flexstage.analysis.loaded.standing import require_standing, standing
from flexstage.analysis.workspace.buckling import Buckling, buckling
from flexstage.analysis.workspace.force_workspace import ForceWorkspace
from flexstage.analysis.workspace.force_workspace import force_workspace as reach_of
from flexstage.analysis.workspace.small import SecondOrder, second_order
from flexstage.analysis.workspace.strength import HingeStress
from flexstage.analysis.workspace.stroke import stroke_limits
from flexstage.analysis.workspace.workspace import Workspace, workspace
from flexstage.base.arguments import check_arguments
from flexstage.base.lazy import LazyModule
from flexstage.base.notebook import InNotebook
from flexstage.base.number import Table
from flexstage.base.processes.threads import one_thread
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.frequency import Response
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.mapped import mapped
from flexstage.models.theory import Model

if TYPE_CHECKING:
    from flexstage.analysis.loaded import load_cases
else:
    load_cases = LazyModule("flexstage.analysis.loaded.load_cases")

__all__ = ["Analysis", "Model", "analyse", "loaded_model", "platform_modes", "read", "required_command"]

_RIGID = "the ideal model has no elasticity"
_UNLUMPED = "only the lumped model computes this result"


@dataclass(frozen=True, eq=False)
class Analysis(InNotebook):
    """All results of one model of a stage. A field without a result is `None`; `missing` has the reason by field name.

    `response` is the frequency response from the actuators' inputs to the platform's twist and all gauges; `transmissibility` is the
    frequency response from the ground to the platform. Only the lumped model gives drift, error budget, `units` (results of each distinct
    unit in isolation), and `deflection` and `buckling` under permanent load. The `verdicts` on requirements are always computed by the
    lumped model.

    `loaded` is the effect of the permanent load. If this effect is significant, these results and the verdicts on them are for the loaded
    stage: statics, `freedoms`, `mass`, deflection, modes, responses, lost motion, drift and error budget. All other results and the linear
    model `linear` belong to the nominal stage. `second_order` is the small-displacement error for the required strokes. If no strokes are
    required, `second_order` is for the available strokes. `ends` contains the critical load factors at both ends of each load path,
    computed up to the required factor (None if the design has no load path). The error budget is for 1 K and the required strokes. If no
    strokes are required, the error budget is for all single-axis strokes at once.

    `freedoms` contains the stiffness along ideal motions and constraints (None for a stage with six ideal motions). `mass` is the
    platform's effective mass. `stress` is the hinge stress at the required strokes. If a force-driven stage has no required strokes,
    `stress` is the hinge stress at the limits of short use.
    """

    WRITTEN: ClassVar[tuple[str, str]] = ("an analysis", "fs.analyse(stage)")
    mechanism: Mechanism
    model: Model
    kinematics: Kinematics
    linear: LinearModel | None
    statics: Statics | None
    deflection: Deflection | None
    buckling: Buckling | None
    lost_motion: LostMotion | None
    modes: Modes | None
    response: Response | None
    transmissibility: Response | None
    workspace: Workspace | None
    drift: Drift | None
    error_budget: ErrorBudget | None
    units: Mapping[str, UnitResult] | None
    verdicts: tuple[Verdict, ...]
    missing: Mapping[str, str]
    force_workspace: ForceWorkspace | None = None
    freedoms: FreedomStiffness | None = None
    mass: MassMatrix | None = None
    loaded: LoadEffect | None = None
    second_order: SecondOrder | None = None
    ends: load_cases.CaseFactors | None = None
    stress: HingeStress | None = None
    drive_force: DriveForce | None = None

    @property
    def under_load(self) -> LinearModel | None:
        """Model of statics, modes and responses: `linear`, or the model linearised about the loaded state."""
        return self.linear if self.loaded is None or self.loaded.model is None else self.loaded.model


def loaded_model(mechanism: Mechanism, model: Model) -> LinearModel | None:
    """Return the linear model of a stage. If the permanent load is significant, the lumped model is linearised about the loaded state.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> "geometric" in loaded_model(double_triangle(), Model.LUMPED).stiffness
    False
    """
    known = read(mechanism, model)
    changed = load_effect(mechanism) if model is Model.LUMPED else None
    return known if changed is None or changed.model is None else changed.model


def read(mechanism: Mechanism, model: Model) -> LinearModel | None:
    """Return the nominal linear model of a stage; `None` for the ideal model.

    Raises `DesignError` for an unstable nominal position.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> len(read(double_triangle(), Model.MAPPED).coordinates)
    6
    """
    if model is Model.IDEAL:
        return None
    if model is Model.LUMPED:
        return standing(mechanism)
    linear = mapped(mechanism)
    require_standing(mechanism)
    return linear


@check_arguments
@one_thread
def analyse(mechanism: Mechanism, model: Model = Model.LUMPED, *, whole: bool = True) -> Analysis:
    """Return all analyses of one model or, if `whole` is false, only the analyses of the short form (in half the time).

    The short form omits responses, the results of isolated actuation units, and most of the workspace. A result that cannot be computed
    (e.g. lost motion of an under-actuated stage) is `None`, and `missing` contains the reason. Raises `DesignError` if the model cannot be
    built.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(float(analyse(double_triangle(), Model.MAPPED).modes.frequencies[0]), 2)
    110.91
    """
    bench = bench_of(mechanism)
    verdicts = judge(mechanism, bench)
    kinematics = ideal(mechanism)
    linear, loading = read(mechanism, model), load_effect(mechanism) if model is Model.LUMPED else None
    point = None if loading is None else loading.point
    weighed, linked = (linear, linear) if point is None else (point.linear, point.links)
    attempt = Attempts()
    lost = attempt.of_ground("lost_motion", linked, _RIGID, lambda known: lost_motion(kinematics, known))
    seen = (PLATFORM, *kinematics.gauges)
    command = required_command(mechanism)
    reach = attempt.of("workspace", lambda: workspace(mechanism, kinematics, linear, lost=lost, command=command, whole=whole))
    hinged = linear if model is Model.LUMPED else None

    def responded(known: LinearModel) -> Response | None:
        return response(known, seen, known.actuators) if whole or not known.actuators else None  # requires an input

    def alone() -> Mapping[str, UnitResult] | None:
        return units(mechanism) if whole or not kinematics.mapping.rows else None  # requires strokes

    forced = kinematics if kinematics.thrusts and not kinematics.actuated else None
    pushed = (
        None
        if forced is None
        else attempt.of_ground("force_workspace", hinged, _UNLUMPED, lambda known: reach_of(mechanism, forced, known))
    )
    stiff = attempt.of_ground("statics", weighed, _RIGID, statics)
    drifted = attempt.of_ground("drift", linked if model is Model.LUMPED else None, _UNLUMPED, lambda known: drift(mechanism, known))
    return Analysis(
        mechanism=mechanism,
        model=model,
        kinematics=kinematics,
        linear=linear,
        statics=stiff,
        deflection=attempt.of_ground(
            "deflection", None if hinged is None else weighed, _UNLUMPED, lambda known: deflection(mechanism, known)
        ),
        buckling=attempt.of_ground("buckling", hinged, _UNLUMPED, lambda known: _buckling(mechanism, known, reach)),
        lost_motion=lost,
        modes=attempt.of_ground("modes", weighed, _RIGID, lambda known: platform_modes(mechanism, known)),
        response=attempt.of_ground("response", weighed, _RIGID, responded),
        transmissibility=attempt.of_ground("transmissibility", weighed, _RIGID, lambda known: transmissibility(known) if whole else None),
        workspace=reach,
        drift=drifted,
        error_budget=attempt.of_ground("error_budget", hinged, _UNLUMPED, lambda _: _errors(mechanism, command, reach, drifted)),
        units=attempt.of_ground("units", hinged, _UNLUMPED, lambda _: alone()),
        verdicts=verdicts,
        force_workspace=pushed,
        drive_force=None
        if pushed is None or hinged is None
        else attempt.of("drive_force", lambda: drive_force(kinematics, hinged, pushed)),
        freedoms=None if stiff is None else freedom_stiffness(stiff, kinematics),
        mass=None if stiff is None or weighed is None else mass_matrix(mechanism, weighed),
        loaded=loading,
        second_order=second_order(mechanism, kinematics, command if command or reach is None else reach.command),
        ends=attempt.of_ground("ends", hinged, _UNLUMPED, lambda _: _ends(mechanism)) if mechanism.paths else None,
        stress=attempt.of("stress", lambda: bench.stress_at_strokes if bench.command else bench.stress)
        if model is Model.LUMPED and (bench.command or forced is not None)
        else None,
        missing=Table(attempt.missing),
    )


def _ends(mechanism: Mechanism) -> load_cases.CaseFactors:
    """Load cases at the ends of paths, up to the required factor."""
    cases = [each for name in mechanism.paths for each in load_cases.path_cases(mechanism, name)]
    demand = asked_factor(mechanism)
    return load_cases.buckling_factors(mechanism, cases, most=max(demand, 1.0), demand=demand)


def _buckling(mechanism: Mechanism, model: LinearModel, reach: Workspace | None) -> Buckling:
    known = None if reach is None else reach.buckling
    return buckling(mechanism, model, stroke_limits(mechanism).from_zero) if known is None else known


def _errors(mechanism: Mechanism, command: Mapping[str, float] | None, reach: Workspace | None, drifted: Drift | None) -> ErrorBudget:
    requested = command if command is not None or reach is None else reach.command
    return budget(mechanism, requested or {}, temperature=None, drifted=drifted)


def required_command(mechanism: Mechanism) -> Mapping[str, float] | None:
    """Return the required platform strokes by coordinate, as half widths of a box [m, rad]; `None` if no stroke is required.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> required_command(double_triangle())["z"]
    0.00015
    """
    lines = (line for line in requirements(mechanism) if line.kind is stroke and line.sense is Sense.AT_LEAST)
    result = {line.name: line.limit for line in lines if line.point == PLATFORM}
    return result or None


def platform_modes(mechanism: Mechanism, model: LinearModel) -> Modes:
    """Compute the modes of a stage; the result lists all modes below the `max_mode_frequency` of the description.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> platform_modes(double_triangle(), mapped(double_triangle())).limit
    1000.0
    """
    limit = mechanism.max_mode_frequency
    return modes(model, limit=np.inf if limit is None else float(np.max(limit)))
