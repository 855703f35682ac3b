"""Commands of stages away from their undeformed configuration: `stroke`, `buckle`, `misalign`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np
import typer

from flexstage.analysis.assessment.judge import bench_of
from flexstage.analysis.assessment.requirements import asked_factor
from flexstage.analysis.loaded.course import DrivePath, course, drive_quantity
from flexstage.analysis.loaded.load_cases import REST, CaseFactor, CaseFactors, LoadCase, buckling_factors, load_cases
from flexstage.analysis.loaded.misalign import misalign as misaligned
from flexstage.analysis.loaded.misalign import misalignments
from flexstage.analysis.loaded.operating_point import OperatingPoint
from flexstage.analysis.loaded.stroke import PostBuckling
from flexstage.analysis.loaded.stroke import stroke as over_stroke
from flexstage.apps.words import BranchSide
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.units.quantity import ANGLE, LENGTH, RATIO, Quantity
from flexstage.base.units.unit import parse
from flexstage.mechanism.mechanism import PLATFORM, Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.nonlinear.paths.load_path import beyond as follow
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.models.nonlinear.state import WEIGHT
from flexstage.parts.actuator import StrokeActuator
from flexstage.show.command.answer import CommandResult, command
from flexstage.show.command.displaced import Load, OperatingPointOptions, loads_of
from flexstage.show.command.options import STEPS, text_option
from flexstage.show.command.output import announce
from flexstage.show.displaced import (
    buckling_report,
    buckling_tables,
    misalign_report,
    misaligned_tables,
    misalignment_tables,
    misalignments_report,
    misalignments_text,
    shape_of,
    stroke_report,
    stroke_tables,
)
from flexstage.spatial.frame import COMPONENTS


@command("report")
def stroke(
    mechanism: Mechanism,
    *,
    named: Annotated[
        str,
        text_option(
            "--path", "NAME", "Load path [paths.NAME] of the design file. Default: the first path, unless --drive, --from or --to is used."
        ),
    ] = "",
    drive: Annotated[
        str,
        text_option(
            "--drive", "NAME", "Driven coordinate, stroke (B1) or force. Default: the axis of the first required stroke, or platform.x."
        ),
    ] = "",
    start: Annotated[str, text_option("--from", "VALUE", "First value of the drive. Default: 0, the static equilibrium.")] = "",
    end: Annotated[
        str,
        text_option(
            "--to",
            "VALUE",
            'Last value of the drive, e.g. "5 mm". Default: the required stroke; if no stroke is required, '
            "the full stroke of a driven stack, 0.1 mm for another length, or 1 mrad for an angle.",
        ),
    ] = "",
    steps: Annotated[int | None, STEPS] = None,
    load: Load = None,
) -> CommandResult:
    """Compute force, stiffness and frequencies over a stroke.

    The model includes large displacements, the weight and the loads that --load specifies. Force, stiffness and frequencies are computed at
    a series of equilibria along the stroke. Displacements are relative to the static equilibrium under these loads.
    """
    model = nonlinear(mechanism)
    elsewhere, loads = bool(drive or start or end), loads_of(model, load or ())
    if named and elsewhere:
        what = "given together with --drive, --from or --to, but the path already defines the drive and its ends"
        raise refuse(f"--path {named}", what, "Remove --path, or the other options")
    required = {f"{PLATFORM}.{axis}": value for axis, value in bench_of(mechanism).command.items()}
    stated = named or ("" if elsewhere else _first_path(mechanism))
    asked = (
        _stated(mechanism, stated, steps, loads)
        if stated
        else _asked(model, drive or next(iter(required), "platform.x"), required, (start, end), steps=steps or 11, loads=loads)
    )
    rest = asked.rest(model)
    along = asked.path(model, rest)
    found = over_stroke(along, rest, kinematics=ideal(mechanism) if asked.drive in model.assembly.strokes else None)
    page = partial(stroke_report, mechanism, along, found)
    return CommandResult(mechanism, lambda: found, lambda: stroke_tables(found), page, warnings=found.warnings)


def _first_path(mechanism: Mechanism) -> str:
    """The first path of a design, "" without one; prints a note about the others."""
    first, *others = mechanism.paths or ("",)
    if others:
        announce(f"Load path: {first}. To choose another: {', '.join(f'--path {each}' for each in others)}")
    return first


def _stated(mechanism: Mechanism, name: str, steps: int | None, loads: dict[str, float]) -> DrivePath:
    """A path of a design, with additional `loads`."""
    if name not in mechanism.paths:
        raise refuse(f"--path {name}", "unknown path", suggest_nearest(name, mechanism.paths))
    found = course(mechanism, name)
    values = found.values if steps is None else np.linspace(found.values[0], found.values[-1], steps)
    return replace(found, values=values, loads=found.loads | loads)


def _asked(
    model: Nonlinear, drive: str, required: Mapping[str, float], ends: tuple[str, str], *, steps: int, loads: dict[str, float]
) -> DrivePath:
    quantity = drive_quantity(model.assembly, drive, "--drive")
    start, end = ends
    low = parse(start, quantity, where="--from") if start else 0.0
    high = parse(end, quantity, where="--to") if end else required.get(drive) or _end(model, drive, quantity)
    if low == high:
        raise refuse(
            "--to", f"first and last value of {drive} are equal (got {start or '0'} and {end or start})", "Use two different values"
        )
    return DrivePath(drive, np.linspace(low, high, steps), loads, (), 1.0)


def _end(model: Nonlinear, drive: str, quantity: Quantity) -> float:
    """Default end of a drive without a required stroke: the full stroke of a stack, a small displacement of a coordinate."""
    own = model.assembly.actuator(drive) if drive in model.assembly.strokes else None
    if isinstance(own, StrokeActuator):
        return float(np.real(own.stroke))
    if quantity not in (LENGTH, ANGLE):
        raise refuse("--to", f"the last value of {drive} is missing", f'Use e.g. --to "{quantity.example}"')
    return 1e-4 if quantity is LENGTH else 1e-3


@dataclass(frozen=True, eq=False)
class Buckling:
    """Buckling of a stage under a growing `load`. `cases` are the requested load cases, also at stroke ends; the most critical is first.

    `factor` is the critical load factor of the first case. `kind` is the kind of instability, `link` is the name of a flexure that buckles
    individually, and `shape` is the motion of each body.
    """

    load: str
    factor: Annotated[float, RATIO]
    kind: str
    link: str
    shape: Matrix
    cases: tuple[CaseFactor, ...]
    beyond: Matrix | None = None
    """Equilibria of the post-buckling path, one row each."""


@command("report")
def buckle(
    mechanism: Mechanism,
    *,
    scale_load: Annotated[
        list[str] | None,
        text_option(
            "--scale-load",
            "NAME=VALUE",
            'Load to increase until buckling, e.g. "platform.fx=-20 N". Several loads grow by the same factor. Repeatable. '
            "Default: every load case; with --at, --load or --fixed, the weight.",
        ),
    ] = None,
    place: OperatingPointOptions,
    post_buckling: Annotated[
        int, typer.Option("--post-buckling", metavar="N", min=0, help="Number of equilibria beyond the lowest critical load.")
    ] = 0,
    branch: Annotated[
        BranchSide, typer.Option("--branch", help="Post-buckling branch: along the buckling mode, or against it.")
    ] = BranchSide.ALONG,
) -> CommandResult:
    """Find the load at which the stage buckles.

    The model includes large displacements. The critical point is a limit point, a bifurcation, or an imperfect bifurcation. Loads that are
    not scaled remain constant.

    Without --scale-load, --at, --load and --fixed, each load case of the design is analysed at rest and at both ends of every load path. If
    the design has no load paths, the stroke ends of the actuators replace the path ends.
    """
    cases = (_case(mechanism, place, scale_load or ()),) if scale_load or place.at or place.load or place.fixed else load_cases(mechanism)
    found = buckling_factors(mechanism, cases, temperature=place.warmth, demand=asked_factor(mechanism))
    require(_unanswered(found))
    after = _beyond(found, cases, branch, post_buckling) if post_buckling else None
    first = found.cases[0]
    link = "" if first.found is None else first.found.link
    along = None if after is None else after.stroke.along
    told = Buckling(first.load, first.factor, first.kind, link, shape_of(first), found.cases, along)
    return CommandResult(
        mechanism,
        lambda: told,
        lambda: buckling_tables(found, after),
        partial(buckling_report, mechanism, found, after),
        warnings=found.warnings if after is None else (*found.warnings, *after.stroke.warnings),
    )


def _beyond(found: CaseFactors, cases: Sequence[LoadCase], branch: BranchSide, points: int) -> PostBuckling:
    """The post-buckling path of the lowest critical case; refused if it requires prescribed coordinates."""
    least = found.least
    if least is None or least.found is None:
        raise refuse("--post-buckling", "the stage does not buckle", "Remove --post-buckling, or specify a larger load")
    if least.found.state.held:
        what = f"coordinates are prescribed at {least.place}, where the load factor (of {least.load}) is lowest"
        raise refuse("--post-buckling", what, "Remove --at")
    grows = next(case.grows for case, told in zip(cases, found.cases, strict=True) if told is least)
    path = follow(least.found, grows, side=1.0 if branch is BranchSide.ALONG else -1.0, points=points)
    return PostBuckling(path, over_stroke(path))


def _case(mechanism: Mechanism, place: OperatingPointOptions, scaled: Sequence[str]) -> LoadCase:
    """The load case of the options: the scaled load, else the weight, and the operating point."""
    model = nonlinear(mechanism)
    grows, stays, there = loads_of(model, scaled, "--scale-load"), loads_of(model, place.load or ()), place.brought(model)
    require(OperatingPoint(model, {**grows, **stays}, there, place.locked).contradictions())
    text, where = (
        (", ".join(scaled) or WEIGHT),
        ", ".join([*(place.at or ()), *(place.load or ()), *(f"{name} fixed" for name in place.locked)]),
    )
    return LoadCase(text, where or REST, grows or {WEIGHT: 1.0}, stays=stays, at=there, locked=place.locked)


def _unanswered(found: CaseFactors) -> Iterator[Finding]:
    """Reasons for a missing result: the stage has no load, or the only requested case has no factor."""
    if not found.cases:
        what = "the stage has no weight, no specified forces and no paths with loads"
        yield Finding("stage", what, 'Specify a load, e.g. --scale-load "platform.fz=-20 N"')
    elif len(found.cases) == 1 and not np.isfinite(found.cases[0].factor) and found.least_bound is None:
        yield Finding(found.cases[0].load, found.cases[0].why, "Specify another load, or another operating point")


@command("report")
def misalign(
    mechanism: Mechanism,
    *,
    instance: Annotated[
        str, text_option("--instance", "NAME", "Misaligned instance of a unit, or link to the ground. Default: each of them, separately.")
    ] = "",
    rotation: Annotated[
        str,
        text_option(
            "--rotation",
            "AXIS",
            "Axis of rotation in the frame of the instance or link: x, y or z. Default: y; without --instance, all three axes.",
        ),
    ] = "",
    translation: Annotated[
        str, text_option("--translation", "AXIS", "Axis of translation, instead of a rotation: x, y or z. Default: none.")
    ] = "",
    amount: Annotated[
        str,
        text_option(
            "--amount", "VALUE", 'Amount of misalignment, e.g. "1 mrad" or "10 um". Default: 1 mrad of rotation, or 0.1 mm of translation.'
        ),
    ] = "",
    steps: Annotated[int, STEPS] = 11,
) -> CommandResult:
    """Compute loads of a misaligned, over-constrained stage.

    The connection of one instance of a unit, or of one link, to the ground is rotated or translated. Prints loads in all flexures,
    frequencies as functions of the misalignment, and the critical misalignment at which the stage buckles.

    Without --instance, every instance and link on the ground is misaligned separately. Prints the critical misalignment, load and stress of
    each, for rotations about x, y and z or for the specified axis.
    """
    axis = _axis(rotation, translation)
    quantity = ANGLE if axis.startswith("r") else LENGTH
    wanted = parse(amount, quantity, where="--amount") if amount else (1e-3 if quantity is ANGLE else 1e-4)
    if not wanted:
        raise refuse("--amount", "must not be zero", 'Use e.g. --amount "1 mrad"')
    if not instance:
        told = misalignments(mechanism, (axis,) if rotation or translation else COMPONENTS[3:], size=wanted)
        if told.worst is None:
            raise refuse("stage", "no instance of a unit and no link is connected to the ground", "Add a link to the ground")
        return CommandResult(
            mechanism,
            lambda: told,
            lambda: [*misalignment_tables(told), f"{misalignments_text(told)}. For details, use --instance NAME."],
            partial(misalignments_report, mechanism, told),
            warnings=told.warnings,
        )
    found = misaligned(mechanism, instance, axis, wanted, points=steps)
    page = partial(misalign_report, mechanism, found)
    return CommandResult(mechanism, lambda: found, lambda: misaligned_tables(found), page, warnings=found.warnings)


def _axis(rotation: str, translation: str) -> str:
    if rotation and translation:
        raise refuse("--translation", f"given together with --rotation {rotation}", "Remove --rotation, or --translation")
    option, axis = ("--translation", translation) if translation else ("--rotation", rotation or "y")
    if axis not in COMPONENTS[:3]:
        raise refuse(option, f'must be x, y or z (got "{axis}")', "Use one of them")
    return axis if translation else f"r{axis}"
