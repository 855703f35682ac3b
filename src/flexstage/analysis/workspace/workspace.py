"""Workspace of a stage: strokes, forces, voltages, stress, buckling, loads, gauges, clearance, map errors."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Annotated

from flexstage.analysis.attempt import Attempts
from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.analysis.workspace.blocking import PlatformLine, StackLine, platform_lines, stack_lines
from flexstage.analysis.workspace.buckling import Buckling, buckling
from flexstage.analysis.workspace.clearance import Clearance, clearance
from flexstage.analysis.workspace.drive import Drive, drive
from flexstage.analysis.workspace.gauging import GaugeRange, PoseResolution, gauge_range, pose_resolution
from flexstage.analysis.workspace.load import LoadRange, LoadShare, load_share
from flexstage.analysis.workspace.map_error import MapError, linear_map_error
from flexstage.analysis.workspace.polytope import Polytope, reachable
from flexstage.analysis.workspace.stops import single_strokes, with_stops
from flexstage.analysis.workspace.strength import HingeStress, hinge_stress
from flexstage.analysis.workspace.stroke import SingleAxis, StrokeLimits, Utilisation, single_axis, stroke_limits, utilisation
from flexstage.base.arguments import check_arguments
from flexstage.base.notebook import Result
from flexstage.base.number import Number, Table
from flexstage.base.processes.threads import one_thread
from flexstage.base.record import VIEW
from flexstage.mechanism.assembly.expand import expand
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.spatial.frame import MOTION

_RIGID = "the ideal model has no elasticity"
_HINGELESS = "the model has no single hinges; use the lumped model"
_FURTHER = frozenset({"worst_case", "polytope", "drive", "map_error", "gauges", "clearance", "platform_lines", "stack_lines", "loads"})


class Workspace(Result):
    """Workspace of one design. A field without a result is `None`; `reasons` has the reason by field name.

    `single_axis` are ideal strokes; `corrected` are strokes with lost motion corrected. `command` is a box of motions (half widths by
    coordinate, all at once). `worst_case` is the actuators' demand for this box, and `gauges` are the gauge readings in this box. Stress,
    buckling and loads are for a stage that is stress-free at zero voltage, over all strokes and under permanent load.
    """

    command: Annotated[Mapping[str, Number], MOTION]
    limits: StrokeLimits
    single_axis: SingleAxis
    corrected: SingleAxis | None
    worst_case: Utilisation | None
    polytope: Polytope | None
    drive: Drive | None
    map_error: MapError | None
    gauges: GaugeRange | None
    resolution: PoseResolution | None
    clearance: Clearance | None
    platform_lines: PlatformLine | None
    stack_lines: StackLine | None
    stress: HingeStress | None
    buckling: Buckling | None
    loads: LoadShare | None
    reasons: Mapping[str, str]

    @property
    def bearing(self) -> Annotated[LoadRange | None, VIEW]:
        """Load range of the stacks over all strokes, which start at zero voltage."""
        return None if self.loads is None else self.loads.over(self.limits.from_zero)


@check_arguments
@one_thread
def workspace(
    mechanism: Mechanism,
    kinematics: Kinematics,
    model: LinearModel | None,
    *,
    lost: LostMotion | None = None,
    command: Mapping[str, Number] | None = None,
    whole: bool = True,
) -> Workspace:
    """Compute the workspace of one design, and the demand of a box of displacements `command` on actuators and gauges.

    `command` contains the half widths of the box by coordinate [m, rad] (default: the ideal single-axis strokes of all coordinates). If
    `whole` is false, only strokes, resolution, stress and buckling are computed (in two thirds of the time). The other fields are then
    `None`, and `reasons` does not list them. Raises `DesignError` if the strokes do not determine the platform's motion.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> stage = double_triangle()
    >>> (1e6 * workspace(stage, ideal(stage), None).single_axis.symmetric[:3]).round(1).tolist()
    [75.0, 86.6, 300.0]
    """
    attempt, limits, mapping = Attempts(() if whole else _FURTHER), stroke_limits(mechanism), kinematics.mapping
    single = single_strokes(mechanism, kinematics)
    requested = _symmetric(single) if command is None else command
    hinged = model if model is not None and set(expand(mechanism).links) <= set(model.stiffness) else None
    unloaded, stopped = limits.from_zero, partial(with_stops, mechanism, kinematics, limits=limits)
    return Workspace(
        command=Table(requested),
        limits=limits,
        single_axis=single,
        corrected=attempt.of_ground(
            "corrected", lost, _RIGID, lambda known: single_axis(*stopped(known.correction), provenance=known.provenance)
        ),
        worst_case=attempt.of("worst_case", lambda: utilisation(*stopped(mapping), requested, provenance=kinematics.provenance)),
        polytope=attempt.of("polytope", lambda: reachable(*stopped(mapping), provenance=kinematics.provenance)),
        drive=attempt.of("drive", lambda: drive(mechanism)),
        map_error=attempt.of("map_error", lambda: linear_map_error(mechanism, kinematics, limits)),
        gauges=attempt.of("gauges", lambda: gauge_range(mechanism, kinematics, requested)),
        resolution=attempt.of("resolution", lambda: pose_resolution(mechanism, kinematics)),
        clearance=attempt.of("clearance", lambda: clearance(mechanism)),
        platform_lines=attempt.of_ground("platform_lines", model, _RIGID, lambda known: platform_lines(mapping, known, limits)),
        stack_lines=attempt.of_ground("stack_lines", hinged, _HINGELESS, lambda known: stack_lines(mechanism, known)),
        stress=attempt.of_ground("stress", hinged, _HINGELESS, lambda known: hinge_stress(mechanism, known, unloaded)),
        buckling=attempt.of_ground("buckling", hinged, _HINGELESS, lambda known: buckling(mechanism, known, unloaded)),
        loads=attempt.of_ground("loads", hinged, _HINGELESS, lambda known: load_share(mechanism, known)),
        reasons=Table(attempt.missing),
    )


def all_strokes(mechanism: Mechanism) -> Mapping[str, float]:
    """Return the ideal single-axis strokes by coordinate [m, rad], as half widths of a box.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> round(1e6 * all_strokes(double_triangle())["z"], 6)
    300.0
    """
    return _symmetric(single_strokes(mechanism, ideal(mechanism)))


def _symmetric(single: SingleAxis) -> dict[str, float]:
    return {name: float(value) for name, value in zip(single.coordinates, single.symmetric, strict=True)}
