"""Commands of stages away from their drawn position: `stroke`, `buckle`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
import typer

from flexstage.analysis.assessment.requirements import asked_factor
from flexstage.analysis.loaded.course import Course, course, drive_quantity
from flexstage.analysis.loaded.load_cases import REST, CaseFactor, CaseFactors, LoadCase, buckling_factors, load_cases
from flexstage.analysis.loaded.misalign import misalign as misaligned
from flexstage.analysis.loaded.misalign import misalignments
from flexstage.analysis.loaded.operating_point import require_consistent
from flexstage.analysis.loaded.stroke import Beyond
from flexstage.analysis.loaded.stroke import stroke as over_stroke
from flexstage.apps.words import Side
from flexstage.base.finding import Finding, refuse, require, suggest_nearest
from flexstage.base.labelled import Matrix
from flexstage.base.units.quantity import ANGLE, LENGTH, RATIO, Quantity
from flexstage.base.units.unit import parse
from flexstage.mechanism.mechanism import Mechanism
from flexstage.models.ideal import ideal
from flexstage.models.nonlinear.paths.load_path import beyond as follow
from flexstage.models.nonlinear.stage import Nonlinear, nonlinear
from flexstage.models.nonlinear.state import WEIGHT
from flexstage.parts.actuator import StrokeActuator
from flexstage.show.command.answer import answer
from flexstage.show.command.design import open_design
from flexstage.show.command.displaced import At, Held, Load, Place, Warmth, loads_of, place
from flexstage.show.command.options import Changes, Csv, Design, Json, Report, Xlsx, text_option
from flexstage.show.command.output import announce, save
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


def stroke(  # noqa: PLR0913 (its options)
    design: Design,
    *,
    named: Annotated[str, text_option("--path", "NAME", "A path of the design, [paths.NAME]. Default: the first that it states.")] = "",
    drive: Annotated[
        str, text_option("--drive", "NAME", "What is driven: a coordinate, a stroke (B1), a force. Default: platform.x, without paths.")
    ] = "",
    start: Annotated[str, text_option("--from", "VALUE", "Where the drive begins. Default: at rest.")] = "",
    end: Annotated[str, text_option("--to", "VALUE", 'Where it ends, e.g. "5 mm". Default: the actuator\'s stroke, 0.1 mm, 1 mrad.')] = "",
    points: Annotated[
        int | None, typer.Option("--points", metavar="N", min=2, help="Points of it. Default: as the path states, 11.")
    ] = None,
    load: Load = None,
    report: Report = None,
    changes: Changes = None,
    json: Json = None,
    csv: Csv = None,
    xlsx: Xlsx = None,
) -> None:
    """Force, stiffness, parasitic motion, frequencies over a stroke.

    At large displacements, under the stage's weight and the loads that are named: every point is an equilibrium, and its frequencies and
    stiffness are those of the stage there. Strokes count from where the stage sags to.
    """
    mechanism = open_design(design, changes, [("--json", json), ("--xlsx", xlsx), ("--report", report)])
    model = nonlinear(mechanism)
    elsewhere, loads = bool(drive or start or end), loads_of(model, load or ())
    if named and elsewhere:
        raise refuse(f"--path {named}", "a path states its drive and its ends, and so do --drive, --from or --to", "Leave one of them out")
    stated = named or ("" if elsewhere else _first_path(mechanism))
    asked = (
        _stated(mechanism, stated, points, loads)
        if stated
        else _asked(model, drive or "platform.x", start=start, end=end, points=points or 11, loads=loads)
    )
    rest = asked.rest(model)
    along = asked.path(model, rest)
    found = over_stroke(along, rest, kinematics=ideal(mechanism) if asked.drive in model.assembly.strokes else None)
    if report is not None:
        save(report, stroke_report(mechanism, along, found), "--report")
    answer(
        "stroke",
        mechanism,
        lambda: found,
        lambda: stroke_tables(found),
        json=json,
        csv=csv,
        xlsx=xlsx,
        warnings=found.warnings,
        beside=(report,),
    )


def _first_path(mechanism: Mechanism) -> str:
    """The first path of a design, "" without one; others are told of."""
    first, *others = mechanism.paths or ("",)
    if others:
        announce(f"Path {first}; of the others: {', '.join(f'--path {each}' for each in others)}")
    return first


def _stated(mechanism: Mechanism, name: str, points: int | None, loads: dict[str, float]) -> Course:
    """A path of a design, under `loads` too."""
    if name not in mechanism.paths:
        raise refuse(f"--path {name}", "the design states no such path", suggest_nearest(name, mechanism.paths))
    found = course(mechanism, name)
    values = found.values if points is None else np.linspace(found.values[0], found.values[-1], points)
    return replace(found, values=values, loads=found.loads | loads)


def _asked(model: Nonlinear, drive: str, *, start: str, end: str, points: int, loads: dict[str, float]) -> Course:
    quantity = drive_quantity(model.assembly, drive, "--drive")
    low = parse(start, quantity, where="--from") if start else 0.0
    high = parse(end, quantity, where="--to") if end else _end(model, drive, quantity)
    if low == high:
        raise refuse("--to", f"{drive} goes from {start or '0'} to {end or start}: a drive that does nothing", "Name two places")
    return Course(drive, np.linspace(low, high, points), loads, (), 1.0)


def _end(model: Nonlinear, drive: str, quantity: Quantity) -> float:
    """Where a drive ends that is not told: a stack at its full stroke, a coordinate near rest."""
    own = model.assembly.actuator(drive) if drive in model.assembly.strokes else None
    if isinstance(own, StrokeActuator):
        return float(np.real(own.stroke))
    if quantity not in (LENGTH, ANGLE):
        raise refuse("--to", f"it is not said where {drive} ends", f'Write for example --to "{quantity.example}"')
    return 1e-4 if quantity is LENGTH else 1e-3


@dataclass(frozen=True, eq=False)
class Buckling:
    """The `factor` on a `load` at which the stage gives way: how (`kind`), which flexure by itself (`link`), and its `shape` by body.

    `cases` are all load cases and stroke ends that were asked for, the first of them this one.
    """

    load: str
    factor: Annotated[float, RATIO]
    kind: str
    link: str
    shape: Matrix
    cases: tuple[CaseFactor, ...]
    beyond: Matrix | None = None
    """Equilibria from there on, a row a point, along the factor."""


def buckle(  # noqa: PLR0913 (its options)
    design: Design,
    *,
    load: Annotated[
        list[str] | None,
        text_option("--load", "NAME=VALUE", 'The load that grows: "platform.fx=-20 N". Several grow together. Default: every load case.'),
    ] = None,
    at: At = None,
    hold: Held = None,
    temperature: Warmth = None,
    beyond: Annotated[
        int, typer.Option("--beyond", metavar="N", min=0, help="Points to follow from where the least gives way, on its branch or on.")
    ] = 0,
    side: Annotated[
        Side, typer.Option("--side", help="Which way the branch goes: along the shape that is told, or against it.")
    ] = Side.ALONG,
    report: Report = None,
    changes: Changes = None,
    json: Json = None,
    csv: Csv = None,
    xlsx: Xlsx = None,
) -> None:
    """How far a load may grow until the stage gives way.

    At large displacements: a limit, which the load cannot pass, a bifurcation into another motion, or a sharp bend of the path beside one.
    All else stays, the weight too.
    Without --load and --at of every load case (weight, stated forces, what paths hold) at rest and at every end of paths and strokes.
    """
    mechanism = open_design(design, changes, [("--json", json), ("--xlsx", xlsx), ("--report", report)])
    asked = place(at, load, hold, temperature)
    cases = (_case(mechanism, asked),) if load or at or hold else load_cases(mechanism)
    found = buckling_factors(mechanism, cases, temperature=asked.warmth, demand=asked_factor(mechanism))
    require(_unanswered(found))
    after = _beyond(found, cases, side, beyond) if beyond else None
    told = _buckling(found, after)
    if report is not None:
        save(report, buckling_report(mechanism, found, after), "--report")
    answer(
        "buckle",
        mechanism,
        lambda: told,
        lambda: buckling_tables(found, after),
        json=json,
        csv=csv,
        xlsx=xlsx,
        warnings=found.warnings if after is None else (*found.warnings, *after.stroke.warnings),
        beside=(report,),
    )


def _beyond(found: CaseFactors, cases: Sequence[LoadCase], side: Side, points: int) -> Beyond:
    """From where the least case gives way on; refused where that needs something held."""
    least = found.least
    if least is None or least.found is None:
        raise refuse("--beyond", "nothing gives way", "Leave it out, or name a larger load")
    if least.found.state.held:
        raise refuse(
            "--beyond", f"the least factor is that of {least.load} at {least.place}, where force holds the stage", "Leave out --at"
        )
    grows = next(case.grows for case, told in zip(cases, found.cases, strict=True) if told is least)
    path = follow(least.found, grows, side=1.0 if side is Side.ALONG else -1.0, points=points)
    return Beyond(path, over_stroke(path))


def _case(mechanism: Mechanism, asked: Place) -> LoadCase:
    """What the options name: the load that grows, else the weight, and where."""
    model = nonlinear(mechanism)
    grows, there = loads_of(model, asked.load), asked.brought(model)
    require_consistent(model, there, grows, asked.locked)
    text, where = (", ".join(asked.load) or WEIGHT), ", ".join([*asked.at, *(f"{name} locked" for name in asked.locked)])
    return LoadCase(text, where or REST, grows or {WEIGHT: 1.0}, at=there, locked=asked.locked)


def _unanswered(found: CaseFactors) -> Iterator[Finding]:
    """Why there is no answer at all: nothing loads the stage, or the one case that was asked for has no factor."""
    if not found.cases:
        what = "it has no weight, no stated forces and no paths that hold loads: nothing grows"
        yield Finding("stage", what, 'Name a load: --load "platform.fz=-20 N"')
    elif len(found.cases) == 1 and not np.isfinite(found.cases[0].factor) and found.least_bound is None:
        yield Finding(found.cases[0].load, found.cases[0].why, "Name another load, or another place")


def misalign(  # noqa: PLR0913 (its options)
    design: Design,
    *,
    copy: Annotated[str, text_option("--copy", "NAME", "A copy of a unit, or a link on the ground. Default: each of them.")] = "",
    about: Annotated[
        str, text_option("--about", "AXIS", "Its own axis about which it is turned: x, y or z. Default: y; without --copy all.")
    ] = "",
    shift: Annotated[str, text_option("--along", "AXIS", "Axis along which it is shifted instead: x, y or z.")] = "",
    size: Annotated[str, text_option("--size", "VALUE", 'How far it is misaligned: "1 mrad", "10 um". Default: 1 mrad, 0.1 mm.')] = "",
    points: Annotated[int, typer.Option("--points", metavar="N", min=2, help="Points from none to all of it.")] = 11,
    report: Report = None,
    changes: Changes = None,
    json: Json = None,
    csv: Csv = None,
    xlsx: Xlsx = None,
) -> None:
    """What a misaligned copy does to an over-constrained stage.

    A copy or link is forced into a seat on the ground that is turned, or shifted: the loads that this leaves in all flexures, the
    stage's frequencies over it, and the misalignment at which the stage gives way. Without --copy: where it gives way, load and stress copy
    by copy, about all axes or the one that is named; the worst of them is played in the report.
    """
    mechanism = open_design(design, changes, [("--json", json), ("--xlsx", xlsx), ("--report", report)])
    axis = _axis(about, shift)
    quantity = ANGLE if axis.startswith("r") else LENGTH
    wanted = parse(size, quantity, where="--size") if size else (1e-3 if quantity is ANGLE else 1e-4)
    if not wanted:
        raise refuse("--size", "a misalignment of zero does nothing", "Give it a size")
    if not copy:
        told = misalignments(mechanism, (axis,) if about or shift else COMPONENTS[3:], size=wanted)
        if told.worst is None:
            raise refuse("stage", "no copy of a unit and no link joins the ground: nothing can be misaligned", "Draw what holds it")
        if report is not None:
            save(report, misalignments_report(mechanism, told), "--report")
        answer(
            "misalign",
            mechanism,
            lambda: told,
            lambda: [*misalignment_tables(told), f"{misalignments_text(told)}. What happens on the way: --copy NAME."],
            json=json,
            csv=csv,
            xlsx=xlsx,
            warnings=told.warnings,
            beside=(report,),
        )
        return
    found = misaligned(mechanism, copy, axis, wanted, points=points)
    if report is not None:
        save(report, misalign_report(mechanism, found), "--report")
    answer(
        "misalign",
        mechanism,
        lambda: found,
        lambda: misaligned_tables(found),
        json=json,
        csv=csv,
        xlsx=xlsx,
        warnings=found.warnings,
        beside=(report,),
    )


def _axis(about: str, shift: str) -> str:
    if about and shift:
        raise refuse("--along", f"it is turned about {about} already", "Leave out --about, or --along")
    option, axis = ("--along", shift) if shift else ("--about", about or "y")
    if axis not in COMPONENTS[:3]:
        raise refuse(option, f'"{axis}" is no axis', "Write x, y or z")
    return axis if shift else f"r{axis}"


def _buckling(found: CaseFactors, after: Beyond | None) -> Buckling:
    first, along = found.cases[0], None if after is None else after.stroke.along
    link = "" if first.found is None else first.found.link
    return Buckling(first.load, first.factor, first.kind, link, shape_of(first), found.cases, along)
