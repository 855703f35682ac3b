"""The document of a whole analysis: the documents of its parts under their commands' names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from flexstage.analysis.complete import Analysis
from flexstage.analysis.difference import Change
from flexstage.base.document import Document, plain
from flexstage.show.documents.reach import buckling_body, budget_body, requirements_body, workspace_body
from flexstage.show.documents.results import (
    drift_body,
    lost_motion_body,
    mapping_body,
    response_body,
    stiffness_body,
    units_body,
)

_KEYS = {"statics": "stiffness", "lost_motion": "lost-motion", "error_budget": "budget"}
"""Fields of an analysis whose document has another name."""


def analysis_body(analysis: Analysis) -> Document:
    """Requirements first, then every analysis under its command's name; null with a reason where the reading or the stage gives none.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.complete import Reading, analyse
    >>> body = analysis_body(analyse(double_triangle(), Reading.IDEAL))
    >>> body["modes"] is None, body["reasons"]["modes"]
    (True, 'the ideal reading has no elasticity')
    """
    damping = None if analysis.model is None else analysis.model.damping
    found: dict[str, Any] = {
        "mapping": mapping_body(analysis.kinematics),
        "stiffness": None if analysis.statics is None else stiffness_body(analysis.statics, analysis.deflection),
        "lost-motion": None if analysis.lost_motion is None else lost_motion_body(analysis.lost_motion),
        "modes": analysis.modes,
        "response": None if analysis.response is None else response_body(analysis.response, damping),
        "transmissibility": None if analysis.transmissibility is None else response_body(analysis.transmissibility, damping),
        "workspace": None if analysis.workspace is None else workspace_body(analysis.workspace),
        "buckling": None if analysis.buckling is None else buckling_body(analysis.buckling),
        "drift": None if analysis.drift is None else drift_body(analysis.drift),
        "budget": None if analysis.error_budget is None else budget_body(analysis.error_budget),
        "units": None if analysis.units is None else units_body(analysis.units),
    }
    reasons = {_KEYS.get(name, name): reason for name, reason in analysis.missing.items() if name != "deflection"}  # see stiffness
    documents = {name: None if document is None else plain(document) for name, document in found.items()}
    return {"requirements": requirements_body(analysis.verdicts), **documents, **({"reasons": reasons} if reasons else {})}


def changes_body(changes: Iterable[Change]) -> list[Document]:
    """Changes as {name, unit, old, new, relative}, SI.

    >>> changes_body([Change("platform mode 1", "Hz", 100.0, 90.0)])[0]["old"]
    100.0
    """
    return [
        {"name": each.name, "unit": each.unit, "old": each.old, "new": each.new, "relative": each.relative if each.old else None}
        for each in changes
    ]
