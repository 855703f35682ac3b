"""Results of a design for the panes of the studio, one at a time: figures, verdicts, workspace, geometry."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from flexstage.analysis.assessment.difference import (
    KeyFigure,
    frequency_figures,
    loss_figures,
    reach_figures,
    requirement_figures,
    stiffness_figures,
)
from flexstage.analysis.assessment.judge import bench_of, judge
from flexstage.analysis.assessment.requirements import Verdict
from flexstage.analysis.attempt import Attempts
from flexstage.analysis.bench import StageResults
from flexstage.analysis.dynamics.modes import Modes
from flexstage.analysis.dynamics.response import response
from flexstage.analysis.linear_statics.lost_motion import LostMotion
from flexstage.analysis.linear_statics.statics import Statics, statics
from flexstage.analysis.workspace.buckling import Buckling, buckling
from flexstage.analysis.workspace.stops import single_strokes, with_stops
from flexstage.analysis.workspace.strength import HingeStress, hinge_stress
from flexstage.analysis.workspace.stroke import SingleAxis, single_axis
from flexstage.apps.studio.design.reading import design, finite, problems_of
from flexstage.apps.studio.protocol import (
    Curve,
    Figure,
    Figures,
    Judgement,
    Loss,
    Matrix,
    ModeShape,
    Reach,
    Stroke,
    Verdicts,
    Warnings,
)
from flexstage.apps.studio.wire import floats
from flexstage.base.finding import DesignError, refuse, require
from flexstage.base.labelled import Matrix as Labelled
from flexstage.base.labelled import quiet
from flexstage.base.session import SESSION
from flexstage.mechanism.mechanism import PLATFORM
from flexstage.mechanism.store.lines import line_numbers, line_of
from flexstage.models.linear.frequency import Response
from flexstage.models.linear.model import LinearModel
from flexstage.show.display import display_unit_of, field_unit, preferred_unit
from flexstage.show.viewer.motions import strain_shares

if TYPE_CHECKING:
    from flexstage.show.viewer.data import StageData

_SHOWN = 0.01
"""Smallest share in a list."""
_LISTED = 12
"""Number of listed modes, and above them those of the platform."""
_POINTS = 400
"""Number of frequencies of a response with a specified band."""

Choice = tuple[tuple[str, ...], tuple[str, ...], float | None, float | None]
"""Inputs, outputs and band [Hz] of the shown frequency responses; without names, those of the first actuator."""


@SESSION.keep(8)
def bench(text: str, file: str) -> StageResults:
    """Return the results of a design, which are computed on first use."""
    return bench_of(design(text, file))


def figures(text: str, file: str, stored: str, choice: Choice) -> Figures:
    """Compute stiffness, modes, responses and lost motion. Results are for the loaded stage if its permanent load is significant.

    Old values are those of the text `stored` on disk.
    """
    known, attempt = bench(text, file), Attempts()
    found, stiff, lost = _linear_results(known, attempt)
    response = attempt.of("response", lambda: _response(known, choice))
    missing = {**attempt.missing, **({} if stiff is None else stiff.reasons)}
    return Figures(
        tuple(_with_old(_key_figures(found, stiff, lost), "figures", stored, text, file)),
        None if stiff is None else matrix(stiff.stiffness),
        None if stiff is None else matrix(stiff.compliance),
        ()
        if lost is None
        else tuple(
            Loss(name, float(each.gain), float(each.loss), {link: float(share) for link, share in each.budget_by_link.items()})
            for name, each in lost.actuators.items()
        ),
        () if found is None else tuple(_modes(known.under_load.model, found)),
        None if response is None else floats(response.frequencies),
        () if response is None else tuple(_curves(response)),
        "" if found is None else _loading(known),
        missing,
    )


def verdicts(text: str, file: str, stored: str) -> Verdicts:
    """Compute the verdicts on all requirements."""
    lines = line_numbers(text)
    old = {each.requirement.text: each for each in _stored_verdicts(stored, file)} if stored != text else {}
    return Verdicts(tuple(_judgement(each, old.get(each.requirement.text, each), lines) for each in judged(text, file)))


def reach(text: str, file: str, stored: str) -> Reach:
    """Compute the platform strokes, and the safety factors of hinges and columns."""
    (found, missing), known = _reached(text, file), bench(text, file)
    strokes = tuple(_held(known) if known.forced else () if found[0] is None else _strokes(found[0]))
    return Reach(tuple(_with_old(reach_figures(*found), "reach", stored, text, file)), strokes, missing)


def errors(text: str, file: str) -> None:
    """Raise `DesignError` with the errors that prevent a model of a readable design, as `flexstage check` prints them."""
    from flexstage.analysis.caveats import model_findings

    require(model_findings(design(text, file)))


@SESSION.keep(8)
def warnings(text: str, file: str) -> Warnings:
    """Return the warnings about a design, and the default values that it uses."""
    from flexstage.analysis.caveats import caveats

    told = caveats(design(text, file))
    return Warnings(problems_of((*told.warnings, *told.defaults), text, file))


def scene(text: str, file: str) -> Mapping[str, Any]:
    """Return a design and its motions as data for the viewer."""
    return drawn(text, file).document()


def still(text: str, file: str) -> Mapping[str, Any]:
    """Return a design without motions as data for the viewer."""
    return _still(text, file).document()


@SESSION.keep(4)
def _still(text: str, file: str) -> StageData:
    from flexstage.show.viewer.data import still_data

    return still_data(design(text, file), text=text)


@SESSION.keep(4)
def drawn(text: str, file: str) -> StageData:
    """Return the stage of a design, with its motions, for a viewer."""
    from flexstage.show.viewer.data import stage_data

    known = bench(text, file)
    model, kinematics, loaded = (Attempts().of(each, partial(getattr, known, each)) for each in ("model", "kinematics", "under_load"))
    weighed, found = (None if loaded is None else Attempts().of(each, partial(getattr, loaded, each)) for each in ("model", "modes"))
    stands = _still(text, file)
    return stage_data(known.mechanism, model=model, weighed=weighed, kinematics=kinematics, found=found, text=text, still=stands)


def matrix(found: Labelled) -> Matrix:
    """Convert a labelled matrix to a message, without rounding noise."""
    document = replace(found, values=quiet(found.values)).to_json()
    unit = document["unit"] if isinstance(document["unit"], str) else tuple(map(tuple, document["unit"]))
    return Matrix(tuple(document["rows"]), tuple(document["columns"]), unit, tuple(map(tuple, document["values"])))


def _loading(known: StageResults) -> str:
    """Note on figures of the loaded stage; else empty."""
    return known.loaded.text if known.under_load is not known and known.loaded is not None else ""


@SESSION.keep(8)
def judged(text: str, file: str) -> tuple[Verdict, ...]:
    """Return the verdicts on a design. Raises `DesignError` for a text with errors."""
    known = bench(text, file)
    return judge(known.mechanism, known)


def _stored_verdicts(stored: str, file: str) -> tuple[Verdict, ...]:
    return Attempts().of("verdicts", lambda: judged(stored, file)) or ()


@SESSION.keep(8)
def _reached(text: str, file: str) -> tuple[tuple[SingleAxis | None, HingeStress | None, Buckling | None], dict[str, str]]:
    """The shown part of the workspace: strokes, stress and buckling, as in `workspace`; with reasons for missing ones."""
    known, attempt = bench(text, file), Attempts()
    strokes = None if known.forced else attempt.of("workspace", lambda: single_strokes(known.mechanism, known.kinematics))
    if strokes is None:
        return (None, None, None), attempt.missing
    unloaded = known.limits.from_zero
    corrected = attempt.of("corrected", lambda: _corrected(known))
    stress = attempt.of("stress", lambda: hinge_stress(known.mechanism, known.model, unloaded) if known.assembly.thrusts else known.stress)
    buckled = attempt.of("buckling", lambda: buckling(known.mechanism, known.model, unloaded))
    return (corrected or strokes, stress, buckled), attempt.missing


def _corrected(known: StageResults) -> SingleAxis:
    """Strokes along single axes, lost motion corrected by command."""
    lost = known.under_load.lost
    return single_axis(*with_stops(known.mechanism, known.kinematics, lost.correction, known.limits), provenance=lost.provenance)


def _strokes(found: SingleAxis) -> Iterator[Stroke]:
    return map(Stroke, found.coordinates, np.real(found.low).tolist(), np.real(found.high).tolist(), found.limiting)


def _held(known: StageResults) -> Iterator[Stroke]:
    """Strokes of a force-driven stage: its continuous elastic motion."""
    found = known.force_workspace(PLATFORM)
    return map(Stroke, found.coordinates, np.ravel(-found.held).tolist(), np.ravel(found.held).tolist(), found.limited_by)


def _response(known: StageResults, choice: Choice) -> Response:
    inputs, outputs, low, high = choice
    model = known.under_load.model
    if low is not None and high is not None and not 0.0 < low < high < np.sqrt(np.finfo(float).max):
        raise refuse("response", f"{low:g} Hz to {high:g} Hz is not a band", "Use a low frequency above zero and a higher one")
    grid = None if low is None or high is None else np.geomspace(low, high, _POINTS)
    return response(model, outputs or ("platform",), inputs or (model.actuators or ("ground.z",))[:1], grid)


def _curves(response: Response) -> Iterator[Curve]:
    size, phase = np.abs(response.values), np.degrees(np.angle(response.values))
    for row, output in enumerate(response.outputs):
        for column, source in enumerate(response.inputs):
            values = floats(size[:, row, column]), floats(phase[:, row, column])
            yield Curve(source.name, output.name, response.units[row][column], *values)


def _modes(model: LinearModel, found: Modes) -> Iterator[ModeShape]:
    count = min(len(found.names), max(_LISTED, *(index + 1 for index in found.platform), 0))
    strained = strain_shares(model, found.shapes[:, :count])
    for index in range(count):
        yield ModeShape(
            index + 1,
            float(found.frequencies[index]),
            found.names[index],
            index in found.platform,
            index in found.local,
            float(found.share[index]),
            tuple(found.platform_shapes[:, index].tolist()),
            largest(zip(found.bodies, found.energies[:, index].tolist(), strict=True)),
            largest((name, float(shares[index])) for name, shares in strained.items()),
        )


def largest(shares: Iterable[tuple[str, float]]) -> dict[str, float]:
    """Return the fractions of at least one per cent, the largest first."""
    return dict(sorted(((name, share) for name, share in shares if share >= _SHOWN), key=lambda each: -round(each[1], 6)))


def _key_figures(found: Modes | None, stiff: Statics | None, lost: LostMotion | None) -> tuple[KeyFigure, ...]:
    return (*frequency_figures(found), *stiffness_figures(stiff), *loss_figures(lost))


def _with_old(found: Iterable[KeyFigure], kind: str, stored: str, text: str, file: str) -> Iterator[Figure]:
    rows = tuple(found)
    old = {each.name: each.value for each in (rows if stored == text else _stored_figures(kind, stored, file))}
    for each in rows:
        stood = old.get(each.name)
        form = display_unit_of(each.unit, abs(stood or each.value or 0.0))
        yield Figure(each.name, each.name.partition(".")[0], each.unit, form.text, 1.0 / form.factor, each.value, stood)


@SESSION.keep(4)
def _stored_figures(kind: str, stored: str, file: str) -> tuple[KeyFigure, ...]:
    try:
        known = bench(stored, file)
    except DesignError:
        return ()
    if kind == "reach":
        return tuple(reach_figures(*_reached(stored, file)[0]))
    return _key_figures(*_linear_results(known, Attempts()))


def _linear_results(known: StageResults, attempt: Attempts) -> tuple[Modes | None, Statics | None, LostMotion | None]:
    stiff = attempt.of("stiffness", lambda: statics(known.under_load.model))
    lost = attempt.of("loss", lambda: known.under_load.lost)
    return attempt.of("modes", lambda: known.under_load.modes), stiff, lost


def all_figures(text: str, file: str) -> tuple[KeyFigure, ...]:
    """Return all figures for the comparison of designs, requirements first. Returns an empty tuple for a text with errors."""
    rows = (
        *requirement_figures(_stored_verdicts(text, file)),
        *_stored_figures("figures", text, file),
        *_stored_figures("reach", text, file),
    )
    return tuple({each.name: each for each in reversed(rows)}.values())[::-1]


def _judgement(verdict: Verdict, old: Verdict, lines: Mapping[str, int]) -> Judgement:
    requirement = verdict.requirement
    fitting = display_unit_of(requirement.quantity.si, abs(requirement.limit))
    form = fitting if preferred_unit(requirement.quantity.si).factor != 1.0 else field_unit(requirement.quantity)
    value = finite(verdict.value)
    return Judgement(
        requirement.key,
        requirement.text,
        requirement.point,
        requirement.quantity.si,
        form.text,
        1.0 / form.factor,
        requirement.limit,
        value,
        finite(old.value),
        None if value is None else float(verdict.margin),
        bool(verdict.passed),
        verdict.reason,
        line_of(f"requirements.{requirement.text}", lines) or line_of(f"requirements.{requirement.key}", lines),
    )
