"""Bodies of documents of the solid reading: hinges, units, stage, verification."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from flexstage.analysis.trust import Trust
from flexstage.base.document import Document
from flexstage.show.documents.results import output_body, stiffness_body

if TYPE_CHECKING:
    from flexstage.solid.calibration import Calibration
    from flexstage.solid.hinges import SolidHinge
    from flexstage.solid.resolution import Resolved
    from flexstage.solid.stage import SolidStage
    from flexstage.solid.stress import LinkStress
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
    """Every distinct unit alone: K_a, K_l, gain, loss, outputs by command, stress at the full stroke.

    >>> from flexstage.solid.resolution import Resolved
    >>> solid_units_body(Resolved({}, {}, 3))["order"]
    3
    """
    return {"order": found.order, "errors": dict(found.errors), "units": {name: _unit(unit) for name, unit in found.result.items()}}


def _unit(unit: SolidUnit) -> Document:
    return {
        **output_body(unit),
        "loss": unit.loss,
        "load_compliance_m_per_n": unit.load_compliance,
        "stroke_m": unit.strokes,
        "command_m": unit.commands,
        "output_m": unit.outputs,
        "stress": None if unit.stress is None else stress_body(unit.stress),
        "stiffness": unit.stiffness.to_json(),
        "elements": unit.read.elements,
        "freedoms": unit.read.freedoms,
    }


def stress_body(stress: LinkStress) -> Document:
    """The highest von Mises stress of every link and body, and what is left to yield.

    >>> from flexstage.solid.stress import LinkStress
    >>> found = stress_body(LinkStress(("pivot",), np.array([1e8]), np.array([0]), np.array([4e8])))
    >>> found["pivot"]["safety"]
    4.0
    """
    rows = zip(stress.names, stress.highest, stress.yield_stress, stress.safety, strict=True)
    return {
        name: {
            "von_mises_pa": float(highest),
            "yield_pa": None if np.isnan(limit) else float(limit),
            "safety": None if np.isnan(limit) or highest == 0.0 else float(safety),
        }
        for name, highest, limit, safety in rows
    }


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
        "stress": None if stage.stress is None else stress_body(stage.stress),
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
