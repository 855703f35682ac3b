"""Commands of one analysis each: `mapping`, `stiffness`, `lost-motion`, `modes`, `response`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from flexstage.analysis.attempt import Attempts
from flexstage.analysis.complete import platform_modes, read
from flexstage.analysis.dynamics import response as responses
from flexstage.analysis.dynamics.modes import Modes
from flexstage.analysis.dynamics.random_response import random_response
from flexstage.analysis.linear_statics import lost_motion as losses
from flexstage.analysis.linear_statics.deflection import Deflection, deflection
from flexstage.analysis.linear_statics.drive_force import drive_force
from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.analysis.linear_statics.mass_matrix import MassMatrix, mass_matrix
from flexstage.analysis.linear_statics.statics import FreedomStiffness, Statics, freedom_stiffness, statics
from flexstage.analysis.loaded.standing import standing
from flexstage.analysis.workspace.force_workspace import force_workspace
from flexstage.base.finding import Finding, refuse, require
from flexstage.base.record import SideBySide, walk
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.linear.damping import damping_law
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import static_gain
from flexstage.models.theory import Model
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.design import Lumped, known_point
from flexstage.show.command.displaced import OperatingPointOptions, command_stage
from flexstage.show.command.options import ElasticModelName, InputDensities, ModelName, Point, band_option, text_option
from flexstage.show.command.output import save
from flexstage.show.command.values import band_limits, spectra
from flexstage.show.document import response_body, stiffness_body
from flexstage.show.table import Table, optional, result_table
from flexstage.show.tables import kinematics as motion_tables
from flexstage.show.tables.deflection import deflection_table
from flexstage.show.tables.force_workspace import drive_force_tables
from flexstage.show.tables.lost_motion import (
    budget_table,
    correction_table,
    crosstalk_table,
    energy_table,
    gain_table,
    loss_table,
    parasitic_table,
)
from flexstage.show.tables.modes import mode_table
from flexstage.show.tables.random_response import random_table
from flexstage.show.tables.response import response_table
from flexstage.show.tables.statics import (
    centre_table,
    compliance_table,
    direction_table,
    freedom_stiffness_table,
    mass_tables,
    principal_table,
    stiffness_table,
)
from flexstage.show.viewer.animation import modes_at_data
from flexstage.show.viewer.data import stage_data
from flexstage.show.viewer.view import view_of
from flexstage.solid.show.moving import glb_of
from flexstage.spatial.frame import COMPONENTS


@command()
def mapping(mechanism: Mechanism, *, model: ModelName = Model.IDEAL) -> CommandResult:
    """Compute mobility, redundancy and kinematic mappings.

    The mapping R_a converts platform motion to strokes. The mapping R_s converts platform motion to gauge readings.

    With --model mapped or lumped, output files also contain the platform motion per stroke of the elastic stage.
    """
    kinematics, linear = ideal(mechanism), read(mechanism, model)
    twist = tuple(f"platform.{name}" for name in COMPONENTS)
    return CommandResult(
        mechanism,
        lambda: walk(kinematics) | ({} if linear is None else {"elastic_jacobian": static_gain(linear, twist, linear.actuators)}),
        lambda: _mapping_tables(kinematics),
        model=model,
    )


def _mapping_tables(kinematics: Kinematics) -> Iterator[Table | None]:
    yield from motion_tables.kinematics_tables(kinematics)
    yield motion_tables.motion_table(kinematics)
    yield motion_tables.freedom_table(kinematics)
    yield from map(result_table, (kinematics.idle, kinematics.redundant))


@command()
def stiffness(
    mechanism: Lumped,
    *,
    model: ElasticModelName = Model.LUMPED,
    point: Point = PLATFORM,
    load_point: Annotated[
        str, text_option("--load-point", "POINT", "Point at which the unit load acts. Default: the point of --point.")
    ] = "",
    place: OperatingPointOptions,
) -> CommandResult:
    """Compute compliance and stiffness of the platform.

    Prints the 6x6 matrices, stiffness by direction and by DOF, the centre of stiffness, and the mass. Strokes are fixed.

    With --at, --load, --fixed or --temperature, the model is linearised about that operating point. The operating point is computed with
    the weight and large displacements.
    """
    require(
        Finding(f"--at {text}", "the value is missing", f"Use --point {text} for a point") for text in place.at or () if "=" not in text
    )
    there = command_stage(mechanism, place, model)
    linear = there.linear
    read_point = known_point(linear, point, "--point")
    found = statics(linear, load_point=known_point(linear, load_point or point, "--load-point"), read_point=read_point)
    sagging = deflection(mechanism, linear, point=point) if model is Model.LUMPED and there.operating_point is None else None
    mass = mass_matrix(mechanism, linear, point=point)
    attempt = Attempts()  # a stage without ideal kinematics may have a stiffness
    freedoms = attempt.of("freedoms", lambda: freedom_stiffness(found, ideal(mechanism))) if mass.body == PLATFORM else None
    body = there.body(stiffness_body(found, sagging, freedoms=freedoms, mass=mass, missing=attempt.missing))
    return there.result(body, lambda: _stiffness_tables(found, freedoms, mass, sagging))


def _stiffness_tables(
    found: Statics, freedoms: FreedomStiffness | None, mass: MassMatrix, sagging: Deflection | None
) -> Iterator[Table | None]:
    yield stiffness_table(found)
    yield compliance_table(found)
    yield optional(freedom_stiffness_table, freedoms)
    yield principal_table(found)
    yield direction_table(found)
    yield centre_table(found)
    yield from mass_tables(mass)
    yield optional(deflection_table, sagging)


@command()
def lost_motion(
    mechanism: Lumped,
    *,
    model: ElasticModelName = Model.LUMPED,
    place: OperatingPointOptions,
) -> CommandResult:
    """Compute lost motion, crosstalk, and their correction.

    Prints transmission ratio, lost motion of each part, parasitic motion, and the gains that correct the lost motion.

    With --at, --load, --fixed or --temperature, the model is linearised about that operating point. The ideal motion is still computed in
    the undeformed configuration.

    For force-driven stages, prints the drive force per displacement of the stage and of the ideal guide. The flexures of the ideal guide
    are rigid except in their ideal DOFs.
    """
    there, kinematics = command_stage(mechanism, place, model), ideal(mechanism)
    if kinematics.thrusts and not kinematics.actuated:
        pushed = drive_force(kinematics, there.links, force_workspace(mechanism, kinematics, there.links))
        return there.result(there.body(pushed), lambda: drive_force_tables(pushed))
    found = losses.lost_motion(kinematics, there.links)
    return there.result(there.body(found), lambda: _loss_tables(found))


def _loss_tables(found: LostMotion) -> Iterator[Table | None]:
    yield loss_table(found)
    yield budget_table(found)
    yield gain_table(found)
    yield crosstalk_table(found)
    yield parasitic_table(found)
    yield correction_table(found)
    yield energy_table(found)


@command("view")
def modes(
    mechanism: Lumped,
    *,
    model: ElasticModelName = Model.LUMPED,
    view: Annotated[
        Path | None,
        text_option("--view", "STAGE.HTML", "Animated stage: HTML page (.html) or GLB file (.glb)."),
    ] = None,
    place: OperatingPointOptions,
) -> CommandResult:
    """Compute natural frequencies, mode names and shapes.

    Prints platform modes and local modes. For each mode, prints the fraction of kinetic energy in the platform, and the contribution of the
    mode to the static compliance of the platform. --view writes an animation.

    With --at, --load, --fixed or --temperature, the model is linearised about that operating point. The operating point is computed with
    the weight and large displacements.
    """
    ending = None if view is None else _view_ending(view)
    if ending == ".glb" and place:
        raise refuse("--view", "a GLB file shows the undeformed stage only", f"Remove {place.options}, or write a page (.html)")
    there = command_stage(mechanism, place, model)
    linear = there.linear
    found = platform_modes(mechanism, linear)
    if view is not None:
        save(
            view,
            _moving(mechanism, linear, found, ending, model)
            if there.operating_point is None
            else view_of(mechanism, modes_at_data(mechanism, there.operating_point, found, "about the operating point"), "state 1").html,
            "--view",
        )
    return there.result(there.body(found), lambda: [mode_table(found)])


def _view_ending(path: Path) -> str:
    """The kind of the output file, by its ending; refuses other endings."""
    ending = path.suffix.lower()
    if ending not in {".html", ".glb"}:
        raise refuse("--view", f'"{path}" ends neither in .html nor in .glb', "Use a file name such as stage.html or stage.glb")
    return ending


def _moving(mechanism: Mechanism, linear: LinearModel, found: Modes, ending: str | None, model: Model) -> str | bytes:
    """The stage with its modes, as a page or as a GLB file; strokes and deflections belong to the undeformed stage."""
    drawn = standing(mechanism) if model is Model.LUMPED else linear
    shown = stage_data(mechanism, model=drawn, weighed=linear, found=found)
    return glb_of(shown) if ending == ".glb" else view_of(mechanism, shown).html


@command()
def response(
    mechanism: Lumped,
    *,
    model: ElasticModelName = Model.LUMPED,
    inputs: Annotated[
        list[str] | None,
        text_option("--input", "NAME", "Input: stroke (B1), force (platform.fx) or ground motion (ground). Default: strokes. Repeatable."),
    ] = None,
    outputs: Annotated[
        list[str] | None,
        text_option(
            "--output",
            "NAME",
            "Output: motion (chuck.x), gauge (S1) or load in a link (B4/pivot.mz). Default: platform and all gauges. Repeatable.",
        ),
    ] = None,
    band: Annotated[tuple[str, str] | None, band_option("f1/50 to 2 f12 (f1, f12: first and twelfth natural frequency)")] = None,
    input_asd: InputDensities = None,
    place: OperatingPointOptions,
) -> CommandResult:
    """Compute frequency responses of outputs to inputs.

    By default, computes the responses of platform motion and gauge readings to strokes.

    With --input ground, computes the transmissibility. With --input-asd, also prints the rms values of the outputs.

    With --at, --load, --fixed or --temperature, the model is linearised about that operating point.
    """
    there = command_stage(mechanism, place, model)
    linear = there.linear
    law = damping_law(linear)
    grid = responses.default_frequencies(linear, band_limits(band), damping=law)
    chosen = outputs or ["platform", *(channel.name for channel in linear.outputs if "." not in channel.name)]
    found = responses.response(linear, chosen, inputs or linear.actuators, grid, damping=law)
    limits = (float(grid[0]), float(grid[-1]))
    shaken = random_response(linear, chosen, spectra(linear, input_asd), limits, damping=law) if input_asd else None
    body = there.body(SideBySide((response_body(found, law), {} if shaken is None else {"random": shaken})))
    return there.result(body, lambda: [response_table(found), optional(random_table, shaken)])
