"""Documents: results as plain JSON values for machines, one document a command (described in `docs/json.md`).

Matrices are {rows, columns, unit, values}; a scalar's unit stands in its key (`frequency_hz`). Numbers that are not finite become null,
with the reason under `reasons`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from enum import Enum
from typing import Any, TypeAlias

import numpy as np

import flexstage
from flexstage.analysis.lost_motion import LostMotion
from flexstage.analysis.modes import Modes
from flexstage.analysis.statics import DirectionalStiffness, Statics
from flexstage.base.digest import digest
from flexstage.base.finding import DesignError
from flexstage.base.labelled import Matrix, ratio_units
from flexstage.base.number import Array
from flexstage.mechanism.mechanism import Mechanism
from flexstage.readings.linear.kinematics import Kinematics
from flexstage.spatial.frame import COMPONENTS, TWIST_UNITS
from flexstage.studies.reading import Reading

FORMAT = "flexstage result 1"
LISTED_MODES = 24
_LOCKED = "this reading locks freedoms of the platform: its stiffness is infinite along them"

Document: TypeAlias = dict[str, Any]


def enveloped(kind: str, mechanism: Mechanism, reading: Reading | None, body: Mapping[str, Any]) -> Document:
    """A document: what it is, of which description, by which reading and version, then its `body`.

    >>> enveloped("mapping", Mechanism("stage"), None, {"mobility": 6})["name"]
    'stage'
    """
    return {
        "format": FORMAT,
        "kind": kind,
        "version": flexstage.__version__,
        "name": mechanism.name,
        "reading": None if reading is None else reading.value,
        "physics_digest": digest(mechanism, physics=True),
        **body,
    }


def as_text(document: Mapping[str, Any]) -> str:
    """The document as JSON text: finite numbers only, every other one null with its reason under `reasons`.

    >>> print(as_text({"gain": float("nan")}))
    {
     "gain": null,
     "reasons": {
      "gain": "not a number"
     }
    }
    """
    reasons: dict[str, str] = dict(document.get("reasons") or {})
    plain = _plain({key: value for key, value in document.items() if key != "reasons"}, "", reasons)
    if reasons:
        plain["reasons"] = reasons
    return json.dumps(plain, indent=1, ensure_ascii=False, allow_nan=False)


def _plain(value: Any, where: str, reasons: dict[str, str]) -> Any:
    """Plain JSON values; what is not finite is noted in `reasons` under its path (`modes.3.frequency_hz`)."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item, f"{where}.{key}" if where else str(key), reasons) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist(), where, reasons)
    if isinstance(value, (list, tuple)):
        return [_plain(item, f"{where}.{number}", reasons) for number, item in enumerate(value)]
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.generic):
        return _plain(value.item(), where, reasons)
    if isinstance(value, float) and not math.isfinite(value):
        reasons[where] = "not a number" if math.isnan(value) else "infinite"
        return None
    return value + 0.0 if isinstance(value, float) else value  # no -0.0


def mapping_body(kinematics: Kinematics) -> Document:
    """R_a, R_s and what else the ideal kinematics say; `R_a` is null with its reason where strokes do not determine the platform.

    Raises nothing: an under-actuated stage is a result here.
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


def stiffness_body(statics: Statics) -> Document:
    """Compliance and stiffness of the platform, the in-plane tensors (others held, others free), their axes, the centre of stiffness.

    What does not exist because the reading locks freedoms of the platform is null, with the reason.
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
    return {
        "load_point": statics.load_point,
        "read_point": statics.read_point,
        "compliance": statics.compliance.to_json(),
        **{key: None if key in missing else value for key, value in values.items()},
        "method": statics.provenance,
        **({"reasons": dict.fromkeys(missing, _LOCKED)} if missing else {}),
    }


def _principal(tensor: DirectionalStiffness) -> Document:
    return {"stiffness_n_per_m": tensor.principal, "stiffest_direction_rad": tensor.angle}


def lost_motion_body(lost: LostMotion) -> Document:
    """Per actuator gain, loss and budget (shares by link and axis that add up to the loss), and the matrices they come from."""
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
        "method": lost.provenance,
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


def modes_body(modes: Modes) -> Document:
    """Frequencies ascending, names, shares and shapes; all modes below the limit, at least the first 24; which are the platform's."""
    listed = _listed(modes)
    columns = tuple(str(number + 1) for number in range(listed))
    units = tuple((f"{unit}/kg^0.5",) * listed for unit in TWIST_UNITS)
    return {
        "modes": list(_each_mode(modes, listed)),
        "platform_modes": list(modes.platform),
        "local": list(modes.local),
        "margin": modes.margin,
        "limit_hz": modes.limit,
        "listed": listed,
        "computed": len(modes.names),
        "platform_shapes": Matrix(modes.platform_shapes[:, :listed], COMPONENTS, columns, units).to_json(),
        "method": modes.provenance,
    }


def _listed(modes: Modes) -> int:
    """How many modes are listed: those below the limit, at least the first 24, and every local mode."""
    below = int(np.sum(modes.frequencies < modes.limit))
    local = max((*modes.local, *modes.platform), default=-1) + 1
    return min(len(modes.names), max(below, local, LISTED_MODES))


def _each_mode(modes: Modes, count: int) -> Iterator[Document]:
    for index in range(count):
        yield {
            "number": index + 1,
            "frequency_hz": modes.frequencies[index],
            "name": modes.names[index],
            "platform_share": modes.share[index],
            "in_plane": modes.in_plane[index],
            "platform": index in modes.platform,
            "local": index in modes.local,
            "energy_share": _largest(modes.bodies, modes.energies[:, index]),
        }


def _largest(names: tuple[str, ...], shares: Array) -> Document:
    """Kinetic-energy shares of one per cent and more, largest first."""
    order = np.argsort(-shares, kind="stable")
    return {names[index]: shares[index] for index in order if shares[index] >= 0.01}
