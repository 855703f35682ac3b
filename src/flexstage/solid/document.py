"""Bodies of documents of the solid model: hinges, units, stage, verification."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from flexstage.analysis.trust import Trust
from flexstage.base.document import Document
from flexstage.show.document import stiffness_body

if TYPE_CHECKING:
    from flexstage.solid.calibration import Calibration
    from flexstage.solid.hinges import SolidHinge
    from flexstage.solid.resolution import Resolved
    from flexstage.solid.stage import SolidStage
    from flexstage.solid.units import SolidUnit
    from flexstage.solid.verification import Row, Verification


def hinges_body(found: Mapping[str, SolidHinge]) -> Document:
    """The 6x6 compliance and stiffness of every distinct hinge, with the error estimated.

    >>> hinges_body({})
    {}
    """
    return {
        name: {
            "links": list(hinge.links),
            "roots": {"first": hinge.roots.first, "second": hinge.roots.second},
            "compliance": hinge.compliance.to_json(),
            "stiffness": hinge.stiffness.to_json(),
            "separable": list(hinge.separable),
            "error": hinge.found.error,
            "errors": hinge.errors,
            "order": hinge.found.order,
            "elements": hinge.found.elements,
            "freedoms": hinge.found.freedoms,
        }
        for name, hinge in found.items()
    }


def solid_units_body(found: Resolved[dict[str, SolidUnit]]) -> Document:
    """Every distinct unit alone: K_a, K_l, gain, loss, outputs by command, stress at the full stroke."""
    return {"order": found.order, "errors": dict(found.errors), "units": found.result}


def solid_stage_body(found: Resolved[SolidStage]) -> Document:
    """Stiffness, modes and stress of the whole stage, with the errors estimated."""
    stage = found.result
    platform = list(stage.modes.platform)
    return {
        "order": found.order,
        "errors": dict(found.errors),
        "stiffness": stiffness_body(stage.statics, None),
        "modes": stage.modes,
        "bodies": {"strain_energy_share": stage.blocks[platform], "cost_in_frequency": stage.flexible[platform]},
        "stress": stage.stress,
        "elements": stage.read.elements,
        "freedoms": stage.read.freedoms,
        "coordinates": len(stage.read.model.coordinates),
        "provenance": stage.read.model.provenance,
    }


def verification_body(found: Verification) -> Document:
    """Theory beside FEA, row by row, and the verdicts in words."""
    return {
        "verdicts": found.verdicts,
        "rows": [row_body(row) for row in found.rows],
        "reasons": dict(found.missing),
    }


def row_body(row: Row) -> Document:
    """One compared number.

    >>> from flexstage.solid.verification import Row
    >>> row_body(Row("stage", "mode 1", "Hz", 101.0, 100.0, 0.001))["trust"]
    'theory will do'
    """
    return {
        "group": row.group,
        "figure": row.figure,
        "unit": row.unit,
        "mapped": row.mapped,
        "theory": row.theory,
        "calibrated": row.calibrated,
        "fea": row.fea,
        "fea_error": row.error,
        "difference": row.difference,
        "calibrated_difference": row.calibrated_difference,
        "independent": not row.calibration,
        "calibration": list(row.calibration),
        "modal_assurance": row.assurance,
        "trust": None if row.trust is Trust.UNKNOWN else row.trust.value,
        "reason": row.reason or None,
    }


def calibration_body(found: Calibration) -> Document:
    """What calibration computed and by how much it differs from beam theory."""
    softer = found.softer
    return {"parts": {name: {**body, "over_beam_theory": softer[name]} for name, body in hinges_body(found.hinges).items()}}
