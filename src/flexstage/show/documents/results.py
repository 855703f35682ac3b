"""Bodies of documents about one analysis each: mapping, stiffness, lost motion, modes, response, drift."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from flexstage.analysis.deflection import Deflection
from flexstage.analysis.drift import Drift
from flexstage.analysis.lost_motion import LostMotion
from flexstage.analysis.omitted import Omitted
from flexstage.analysis.statics import DirectionalStiffness, Statics
from flexstage.analysis.unit_output import UnitOutput
from flexstage.analysis.units import UnitResult
from flexstage.base.document import Document
from flexstage.base.finding import DesignError
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.mechanism.mechanism import Damping, ModalDamping, RayleighDamping
from flexstage.models.linear.frequency import Response
from flexstage.models.linear.kinematics import Kinematics
from flexstage.models.linear.model import LinearModel
from flexstage.models.linear.static import static_gain
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS

LISTED_MODES = 24
_UNLUMPED = "deflection under dead load needs the lumped reading"
_LOCKED = "this reading locks freedoms of the platform: its stiffness is infinite along them"


def mapping_body(kinematics: Kinematics) -> Document:
    """R_a, R_s and what else the ideal kinematics say; `R_a` is null with its reason where strokes do not determine the platform.

    Raises nothing: an under-actuated stage is a result here.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> mapping_body(ideal(double_triangle()))["R_a"]["values"][0][:3]
    [1.0, 0.0, 0.0]
    """
    body: Document = {
        "R_a": None,
        "R_s": kinematics.gauge_mapping.to_json(),
        "jacobian": None,
        "mobility": kinematics.mobility,
        "coordinates": list(kinematics.coordinates),
        "actuators": list(kinematics.actuators),
        "gauges": list(kinematics.gauges),
        "actuated": kinematics.actuated,
        "motions": Matrix(kinematics.motion, COMPONENTS, kinematics.coordinates, _motion_units(kinematics)).to_json(),
        "idle": [{"bodies": list(item.bodies), "links": list(item.links)} for item in kinematics.idle],
        "redundant": [list(item.constraints) for item in kinematics.redundant],
        "free": {link: [freedom.value for freedom in freedoms] for link, freedoms in kinematics.free.items()},
        "length_m": kinematics.length,
    }
    try:
        body["R_a"] = kinematics.mapping.to_json()
    except DesignError as error:
        return {**body, "reasons": {"R_a": str(error), "jacobian": str(error)}}
    body["jacobian"] = Matrix(kinematics.jacobian, COMPONENTS, kinematics.actuators, _jacobian_units(kinematics)).to_json()
    return body


def _motion_units(kinematics: Kinematics) -> tuple[tuple[str, ...], ...]:
    return ratio_units(TWIST_UNITS, tuple(TWIST_UNITS[COMPONENTS.index(name)] for name in kinematics.coordinates))


def _jacobian_units(kinematics: Kinematics) -> tuple[tuple[str, ...], ...]:
    return ratio_units(TWIST_UNITS, ("m",) * len(kinematics.actuators))


def stiffness_body(statics: Statics, deflection: Deflection | None = None) -> Document:
    """Compliance and stiffness of the platform, in-plane tensors (others held, others free), their axes, centre of stiffness, dead load.

    What does not exist because the reading locks freedoms of the platform is null, with the reason.

    >>> from flexstage.analysis.statics import statics
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.mapped import mapped
    >>> stiffness_body(statics(mapped(double_triangle())))["in_plane_tensor"]["unit"]
    'N/m'
    """
    values = {
        "stiffness": statics.stiffness.to_json(),
        "in_plane_tensor": statics.held.tensor.to_json(),
        "in_plane_tensor_free": statics.free.tensor.to_json(),
        "principal": _principal(statics.held),
        "principal_free": _principal(statics.free),
        "centre_of_stiffness_m": statics.centre,
    }
    held, free = (bool(np.isnan(matrix.values).any()) for matrix in (statics.stiffness, statics.free.tensor))
    missing = [key for key in values if (free if key.endswith("_free") else held)]
    reasons = dict.fromkeys(missing, _LOCKED) | ({} if deflection is not None else {"dead_load": _UNLUMPED})
    return {
        "load_point": statics.load_point,
        "read_point": statics.read_point,
        "compliance": statics.compliance.to_json(),
        **{key: None if key in missing else value for key, value in values.items()},
        "dead_load": None if deflection is None else {"point": deflection.point, "by_cause": deflection.by_cause.to_json()},
        "provenance": statics.provenance,
        **({"reasons": reasons} if reasons else {}),
    }


def _principal(tensor: DirectionalStiffness) -> Document:
    return {"stiffness_n_per_m": tensor.principal, "stiffest_direction_rad": tensor.angle}


def lost_motion_body(lost: LostMotion) -> Document:
    """Per actuator gain, loss and budget (shares by link and axis that add up to the loss), and the matrices they come from.

    >>> from flexstage.analysis.lost_motion import lost_motion
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> body = lost_motion_body(lost_motion(ideal(double_triangle()), lumped(double_triangle())))
    >>> one = body["actuators"]["B4"]
    >>> bool(abs(sum(one["budget"].values()) - one["loss"]) < 1e-12)
    True
    """
    names = lost.loss.rows
    return {
        "actuators": {name: _actuator(lost, name) for name in names},
        "loss": lost.loss.to_json(),
        "transfer": lost.transfer.to_json(),
        "gain_matrix": lost.gain.to_json(),
        "parasitic": lost.parasitic.to_json(),
        "correction": lost.correction.to_json(),
        "crosstalk": _crosstalk(lost),
        "energy": lost.energy.to_json(),
        "length_m": lost.length,
        "provenance": lost.provenance,
    }


def _actuator(lost: LostMotion, name: str) -> Document:
    budget = lost.of(name)
    links: dict[str, Any] = {}
    for key, share in budget.items():
        link = key.rpartition(".")[0] or key
        links[link] = links.get(link, 0.0) + share
    return {
        "gain": lost.transfer.at(name, name),
        "loss": lost.loss.at(name, name),
        "budget": budget,
        "budget_by_link": links,
    }


def _crosstalk(lost: LostMotion) -> Document:
    """Per pair of actuators what the second's stroke makes of the first's motion: entries of the transfer outside its diagonal."""
    names = lost.loss.rows
    return {row: {column: lost.transfer.at(row, column) for column in names if column != row} for row in names}


def response_body(response: Response, damping: Damping | None) -> Document:
    """A frequency response as {frequency_hz, rows, columns, unit, real, imaginary}, H_ij = output i over input j, and its damping.

    >>> from flexstage.models.linear.model import Channel
    >>> one = Response(np.array([1.0]), (Channel("x", "m"),), (Channel("fx", "N"),), np.array([[[2j]]]), "")
    >>> response_body(one, ModalDamping(0.01))["damping"]
    {'law': 'modal', 'ratio': 0.01}
    """
    return {**response.to_json(), "damping": _damping(damping), "provenance": response.provenance}


def _damping(damping: Damping | None) -> Document | None:
    if damping is None:
        return None
    if isinstance(damping, ModalDamping):
        return {"law": "modal", "ratio": damping.ratio}
    if isinstance(damping, RayleighDamping):
        return {"law": "rayleigh", "mass_factor_per_s": damping.mass_factor, "stiffness_factor_s": damping.stiffness_factor}
    return {"law": "structural"}


def elastic_jacobian(kinematics: Kinematics, model: LinearModel) -> Document:
    """T = dx/da by an elastic reading, beside the ideal one of `mapping_body`.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.ideal import ideal
    >>> from flexstage.models.lumped import lumped
    >>> elastic_jacobian(ideal(double_triangle()), lumped(double_triangle()))["columns"][:2]
    ['B1', 'B2']
    """
    return static_gain(model, tuple(f"platform.{name}" for name in COMPONENTS), kinematics.actuators).to_json()


def units_body(found: Mapping[str, UnitResult]) -> Document:
    """Each distinct unit alone: stiffness at its output along and across its direction, gain and loss, and its springs if it is a lever.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.units import units
    >>> round(units_body(units(double_triangle()))["horizontal"]["axial_stiffness_n_per_m"] / 1e6, 2)
    10.3
    """
    return {name: _unit(unit) for name, unit in found.items()}


def _unit(unit: UnitResult) -> Document:
    lever = (
        None
        if unit.lever is None
        else {
            "drive_n_per_m": unit.lever.drive,
            "pivot_nm_per_rad": unit.lever.pivot,
            "pole_n_per_m": unit.lever.pole,
            "short_arm_m": unit.lever.short_arm,
            "long_arm_m": unit.lever.long_arm,
            "gain": unit.lever.gain,
            "tip_compliance_m_per_n": unit.lever.tip_compliance,
        }
    )
    return {
        **output_body(unit),
        "loss": unit.loss,
        "load_compliance_m_per_n": unit.load_compliance,
        "mapped_stiffness_n_per_m": unit.series,
        "lever": lever,
        "omitted": None if unit.omitted is None else _omitted(unit.omitted),
        "stiffness": unit.stiffness.to_json(),
    }


def output_body(unit: UnitOutput) -> Document:
    """What is said of a unit alone by whichever reading.

    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.analysis.units import units
    >>> list(output_body(units(double_triangle())["horizontal"]))[:3]
    ['copy', 'direction', 'axial_stiffness_n_per_m']
    """
    return {
        "copy": unit.copy,
        "direction": unit.direction,
        "axial_stiffness_n_per_m": unit.axial,
        "lateral_stiffness_n_per_m": unit.lateral,
        "ideal_gain": unit.ideal_gain,
        "gain": unit.gain,
    }


def _omitted(found: Omitted) -> Document:
    return {
        "output": found.output,
        "input": found.input,
        "simple": found.simple,
        "full": found.full,
        "changes": dict(found.changes),
        "interaction": found.interaction,
        "unexplained": found.unexplained,
    }


def drift_body(drift: Drift) -> Document:
    """Motion, gauge readings and link forces per unit of uniform and linear temperature fields, and what was assumed.

    >>> from flexstage.analysis.drift import drift
    >>> from flexstage.cases.double_triangle import double_triangle
    >>> from flexstage.models.lumped import lumped
    >>> drift_body(drift(double_triangle(), lumped(double_triangle())))["motion"]["columns"][0]
    'uniform'
    """
    return {
        "motion": drift.motion.to_json(),
        "gauges": drift.gauges.to_json(),
        "forces": drift.forces.to_json(),
        "ground": drift.ground.material,
        "ground_source": drift.ground.source,
        "datum_m": drift.datum,
        "taken": dict(drift.taken),
        "provenance": drift.provenance,
    }
