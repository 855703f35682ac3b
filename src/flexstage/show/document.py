"""JSON documents of commands: the envelope, and the contents of documents that combine several results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial
from typing import Any

from flexstage.analysis.assessment.requirements import Verdict
from flexstage.analysis.caveats import Caveats, caveats
from flexstage.analysis.complete import Analysis
from flexstage.analysis.linear_statics.deflection import Deflection
from flexstage.analysis.linear_statics.mass_matrix import MassMatrix
from flexstage.analysis.linear_statics.statics import FreedomStiffness, Statics
from flexstage.base.finding import Finding
from flexstage.base.record import SideBySide, walk
from flexstage.base.storage.digest import digest
from flexstage.base.storage.document import Document, plain
from flexstage.base.version import __version__
from flexstage.mechanism.mechanism import Damping, Mechanism, ModalDamping, RayleighDamping, StructuralDamping
from flexstage.models.linear.frequency import Response
from flexstage.models.theory import Model
from flexstage.show.table import optional

FORMAT = "flexstage result 3"
_UNLUMPED = "deflection under permanent load needs the lumped model"
_UNSORTED = "requires a platform with fewer than six ideal motions, and a load at its output point"
_KEYS = {"statics": "stiffness", "lost_motion": "lost-motion", "error_budget": "budget"}
"""Fields of an analysis whose documents are named after a command: the command of each field."""
_OF_SOME_STAGES = {"force_workspace", "drive_force", "stress", "ends"}
"""Results that a document contains only if the stage has them."""


def envelope(kind: str, mechanism: Mechanism | None, model: Model | None, body: Any, more: Iterable[Finding] = ()) -> Document:
    """Build a JSON document: kind, description, model, version, warnings, default values, then the `body`.

    `mechanism` is `None` if a record is the only input. `body` is one result, or maps names to results. `more` are warnings about the
    result.

    >>> envelope("mapping", Mechanism("stage"), None, {"mobility": 6})["name"]
    'stage'
    """
    known = Caveats() if mechanism is None else caveats(mechanism)
    return {
        "format": FORMAT,
        "kind": kind,
        "version": __version__,
        "name": None if mechanism is None else mechanism.name,
        "model": None if model is None else model.value,
        "physics_digest": None if mechanism is None else digest(mechanism, physics=True),
        "warnings": [*known.warnings, *more],
        "defaults": list(known.defaults),
        **walk(body),
    }


def check_document(mechanism: Mechanism | None, errors: Iterable[Finding] = ()) -> Document:
    """Build the document of a check: whether the design is sound, and its errors.

    `mechanism` is `None` for a design with errors: the document then has no digest and no warnings.

    >>> check_document(None, [Finding("B4/pivot", "it is thin", "Thicken it")])["sound"]
    False
    """
    found = list(errors)
    body: Document = {"sound": not found, "errors": found}
    if mechanism is None:
        return {"format": FORMAT, "kind": "check", "version": __version__, **body, "warnings": [], "defaults": []}
    return envelope("check", mechanism, None, body)


def analysis_results(analysis: Analysis) -> Mapping[str, Any]:
    """Return the results of an analysis, by name of the command; results that the model or the stage does not have are `None`."""
    respond = partial(response_body, damping=None if analysis.linear is None else analysis.linear.damping)
    results = {
        "mapping": analysis.kinematics,
        "stiffness": None
        if analysis.statics is None
        else stiffness_body(analysis.statics, analysis.deflection, freedoms=analysis.freedoms, mass=analysis.mass),
        "lost-motion": analysis.lost_motion,
        "modes": analysis.modes,
        "response": optional(respond, analysis.response),
        "transmissibility": optional(respond, analysis.transmissibility),
        "workspace": analysis.workspace,
        "force_workspace": analysis.force_workspace,
        "drive_force": analysis.drive_force,
        "stress": analysis.stress,
        "buckling": analysis.buckling,
        "ends": analysis.ends,
        "drift": analysis.drift,
        "budget": analysis.error_budget,
        "units": analysis.units,
    }
    return {name: found for name, found in results.items() if found is not None or name not in _OF_SOME_STAGES}


def analysis_body(analysis: Analysis) -> Document:
    """Build the body of a complete analysis: requirements, then every result under the name of its command.

    A result that the model or the stage does not have is null, with a reason.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Model, analyse
    >>> body = analysis_body(analyse(double_triangle(), Model.IDEAL))
    >>> body["modes"] is None, body["reasons"]["modes"]
    (True, 'the ideal model has no elasticity')
    """
    reasons = {_KEYS.get(name, name): reason for name, reason in analysis.missing.items() if name != "deflection"}  # see stiffness
    results = {"loaded": analysis.loaded, "second_order": analysis.second_order, **analysis_results(analysis)}
    documents = {name: optional(plain, found) for name, found in results.items()}
    body = {"requirements": requirements_body(analysis.verdicts), **documents}
    return body | ({"reasons": reasons} if reasons else {})


def stiffness_body(
    statics: Statics,
    deflection: Deflection | None = None,
    *,
    freedoms: FreedomStiffness | None = None,
    mass: MassMatrix | None = None,
    missing: Mapping[str, str] | None = None,
) -> SideBySide:
    """Return the JSON body of statics, mass, deflection under permanent load and, with fewer than six ideal motions, stiffness by DOF."""
    reasons = {} if freedoms is not None else {"freedoms": (missing or {}).get("freedoms", _UNSORTED)}
    reasons |= {} if deflection is not None else {"dead_load": _UNLUMPED}
    return SideBySide((statics, {"freedoms": freedoms, "mass": mass, "dead_load": deflection, "reasons": reasons}))


def response_body(response: Response, damping: Damping | None) -> SideBySide:
    """Return the JSON body of a frequency response, with its damping."""
    laws: dict[type, str] = {ModalDamping: "modal", RayleighDamping: "rayleigh", StructuralDamping: "structural"}
    return SideBySide((response, {"damping": None if damping is None else {"law": laws[type(damping)], **walk(damping)}}))


def requirements_body(verdicts: Iterable[Verdict]) -> list[Document]:
    """List the verdicts on the design's requirements: limit and value in SI, relative margin, and whether the requirement is met."""
    return [_verdict(verdict) for verdict in verdicts]


def _verdict(verdict: Verdict) -> Document:
    requirement = verdict.requirement
    return {
        "key": requirement.key,
        "text": requirement.text,
        "passed": bool(verdict.passed),
        "value": verdict.value,
        "limit": requirement.limit,
        "unit": requirement.quantity.si,
        "sense": requirement.sense.value,
        "point": requirement.point,
        "margin": None if verdict.value is None else verdict.margin,
        **({"reason": verdict.reason} if verdict.reason else {}),
    }
