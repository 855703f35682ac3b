"""Commands about workspace and accuracy of a stage: `workspace`, `drift`, `sensitivities`, `budget`."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, TypeAlias

import numpy as np

from flexstage.analysis.assessment import budget as budgeting
from flexstage.analysis.assessment import sensitivities as derivatives
from flexstage.analysis.complete import read, required_command
from flexstage.analysis.linear_statics import drift as drifting
from flexstage.analysis.linear_statics.lost_motion import lost_motion
from flexstage.analysis.workspace import workspace as study
from flexstage.analysis.workspace.force_workspace import force_workspace
from flexstage.analysis.workspace.small import SecondOrder, second_order
from flexstage.base.finding import refuse
from flexstage.base.record import SideBySide
from flexstage.base.units.quantity import TEMPERATURE
from flexstage.base.units.unit import parse
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command, print_missing
from flexstage.show.command.design import Lumped, elastic_model
from flexstage.show.command.displaced import OperatingPointOptions, command_stage
from flexstage.show.command.options import (
    InputDensities,
    ModelName,
    Point,
    band_option,
    modes_option,
    parameters_option,
    temperature_option,
    text_option,
)
from flexstage.show.command.values import band_limits, motions, names, spectra
from flexstage.show.table import Table, result_table
from flexstage.show.tables import workspace as tables
from flexstage.show.tables.errors import drift_table, error_budget_tables, gauge_drift_table
from flexstage.show.tables.force_workspace import force_workspace_tables
from flexstage.show.tables.sensitivities import frequency_sensitivity_table, loss_sensitivity_table

Commands: TypeAlias = Annotated[
    list[str] | None,
    text_option(
        "--command",
        "AXIS=VALUE",
        "Platform motion along an axis in both directions, e.g. x=50um for +-50 um. Repeatable. Default: the strokes that the design "
        "requires, or the largest stroke of each axis with the other axes at rest if the design requires no strokes.",
    ),
]


@command()
def workspace(
    mechanism: Lumped,
    *,
    model: ModelName = Model.LUMPED,
    command: Commands = None,
) -> CommandResult:
    """Compute strokes, forces, clearances and safety factors.

    Prints strokes, forces, voltages, gauge readings, clearance, kinematic error, stress, buckling and loads. For a force-driven stage,
    prints currents, voltages, heat, and strokes with the causes of their limits.
    """
    kinematics, linear = ideal(mechanism), read(mechanism, model)
    if kinematics.thrusts and not kinematics.actuated:
        reached = force_workspace(mechanism, kinematics, elastic_model(mechanism, model))
        small = second_order(mechanism, kinematics, motions(command or ()) or required_command(mechanism))
        return CommandResult(
            mechanism,
            lambda: _with_error(reached, small),
            lambda: [small and small.text, *force_workspace_tables(reached)],
            model=model,
        )
    stands = command_stage(mechanism, OperatingPointOptions(), model)
    lost = None if linear is None or not kinematics.actuated else lost_motion(kinematics, stands.links)
    asked = motions(command or ()) or required_command(mechanism)
    found = study.workspace(mechanism, kinematics, linear, lost=lost, command=asked)
    small = second_order(mechanism, kinematics, found.command)
    return stands.result(_with_error(stands.body(found), small), lambda: [small and small.text, *_workspace_tables(found)])


def _with_error(body: Any, small: SecondOrder | None) -> Any:
    """A result with the error of linear kinematics over its motions."""
    return body if small is None else SideBySide((body, {"second_order": small}))


def _workspace_tables(workspace: study.Workspace) -> Iterator[Table | None]:
    """The tables of motion first, then those of strength."""
    yield from tables.stroke_tables(workspace)
    yield from map(result_table, (workspace.polytope, workspace.map_error, workspace.drive))
    yield from tables.gauge_tables(workspace)
    yield result_table(workspace.clearance)
    yield from tables.strength_tables(workspace)


@command()
def drift(
    mechanism: Lumped,
    *,
    ground: Annotated[
        str | None,
        text_option(
            "--ground",
            "MATERIAL",
            'Ground material, or "none" for no thermal expansion. Default: the ground material that the design specifies; '
            "otherwise the material of the ground's outlines, or of the links on the ground.",
        ),
    ] = None,
) -> CommandResult:
    """Compute thermal drift of platform, points and gauges.

    Prints drift per kelvin of uniform temperature change and per K/m of temperature gradient, by the lumped model. If a permanent
    load such as the weight is significant, the model includes its effect on stiffness.
    """
    stands = command_stage(mechanism, OperatingPointOptions())
    found = drifting.drift(mechanism, stands.links, ground=ground)
    return stands.result(stands.body(found), lambda: [drift_table(found), gauge_drift_table(found)])


@command()
def sensitivities(
    mechanism: Mechanism,
    *,
    parameters: Annotated[list[str] | None, parameters_option("all numbers of the design")] = None,
    count: Annotated[int, modes_option(min=1)] = 12,
) -> CommandResult:
    """Compute sensitivities of frequencies and lost motion.

    Prints exact derivatives of frequencies, transmission ratios and lost motion with respect to parameters, by the lumped model. For
    force-driven stages, prints derivatives of frequencies only.
    """
    found = derivatives.sensitivities(mechanism, names(parameters) if parameters else None, modes=count)
    print_missing(found.missing)
    return CommandResult(
        mechanism,
        lambda: found,
        lambda: [frequency_sensitivity_table(found), loss_sensitivity_table(found)],
        model=Model.LUMPED,
    )


@command()
def budget(
    mechanism: Lumped,
    *,
    command: Commands = None,
    temperature: Annotated[str | None, temperature_option("1 K, or 0 K if drift cannot be computed")] = None,
    point: Point = PLATFORM,
    input_asd: InputDensities = None,
    band: Annotated[tuple[str, str] | None, band_option("the default of flexstage response")] = None,
) -> CommandResult:
    """Compute the error budget of each axis in nm and nrad.

    The contributions are lost motion, crosstalk, error of linear kinematics, gauge noise, quantisation and drift. The lumped model computes
    all contributions.

    For force-driven stages, the contributions in open loop are parasitic motion, gauge noise, quantisation and drift.

    For a stage without stiffness along its drive, prints the closed-loop positioning noise with the controller of flexstage loop --quick.
    Options such as --command are then refused.

    With --input-asd, also prints the motion due to actuator noise and floor vibration.
    """
    stands = command_stage(mechanism, OperatingPointOptions())
    if stands.links.floating is not None:
        return _closed_loop(mechanism, command or temperature or input_asd or band or point != PLATFORM)
    asked = motions(command or ()) or required_command(mechanism) or _reached(mechanism)
    warmth = None if temperature is None else parse(temperature, TEMPERATURE, where="--temperature")
    noise = spectra(stands.links, input_asd) if input_asd else None
    found = budgeting.budget(mechanism, asked, at=point, temperature=warmth, noise=noise, band=band_limits(band))
    small = second_order(mechanism, ideal(mechanism), asked)
    return stands.result(_with_error(stands.body(found), small), lambda: [small and small.text, *error_budget_tables(found)])


def _reached(mechanism: Mechanism) -> dict[str, float]:
    """Half of the single-axis strokes; of a stage that forces move the motions that they hold."""
    kinematics = ideal(mechanism)
    if kinematics.actuated or not kinematics.thrusts:
        return dict(study.all_strokes(mechanism))
    reach = force_workspace(mechanism, kinematics, elastic_model(mechanism, Model.LUMPED))
    return {name: float(held) for name, held in zip(reach.coordinates, reach.held, strict=True) if np.isfinite(held)}


def _closed_loop(mechanism: Mechanism, options: Any) -> CommandResult:
    """Positioning noise of the default loop, of a stage without stiffness along its drive; refuses any `options`."""
    from flexstage.control.show.tables import controller_text, noise_table  # loops take a second to load
    from flexstage.control.study.setup import ControllerSetup, LoopSetup
    from flexstage.control.study.study import loop_study

    if options:
        what = "these options do not apply: the drive direction has no stiffness, so the budget is computed for a closed loop"
        raise refuse("budget", what, "Remove --command, --temperature, --point, --input-asd and --band, or use flexstage loop")
    found = loop_study(mechanism, LoopSetup(controller=ControllerSetup(quick=True)))
    controller = f"the controller of flexstage loop --quick ({controller_text(found)})"
    text = f"The drive direction has no stiffness. Positioning noise is computed in closed loop, with {controller}."
    return CommandResult(mechanism, lambda: found.noise, lambda: [text, noise_table(found)], model=Model.LUMPED)
